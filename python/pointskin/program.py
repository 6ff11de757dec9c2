"""The program `pointskin`, as it comes with the package or is on the path."""
from __future__ import annotations

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
from typing import Any, List, Optional

from .errors import PointskinError


def path() -> str:
    """Where the program is: $POINTSKIN_PROGRAM, the package's own folder, the PATH. Raises PointskinError."""
    named = os.environ.get("POINTSKIN_PROGRAM")
    if named:
        return named
    own = pathlib.Path(__file__).resolve().parent / "bin" / "pointskin"
    found: Optional[str] = str(own) if own.exists() else shutil.which("pointskin")
    if found is None:
        raise PointskinError("the program pointskin is not installed; say where it is: POINTSKIN_PROGRAM=/path/to/pointskin")
    return found


def main(arguments: Optional[List[str]] = None) -> int:
    """Becomes the program, with this process's arguments."""
    given = sys.argv[1:] if arguments is None else arguments
    try:
        program = path()
    except PointskinError as error:
        print(f"pointskin: {error}", file=sys.stderr)
        return 1
    sys.stdout.flush()
    os.execv(program, [program, *given])


def show(mesh: Any) -> "subprocess.Popen[bytes]":
    """Opens the studio on the mesh's vertices; the folder with the file goes when the studio ends."""
    program = path()
    if subprocess.run([program, "studio", "--help"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode:
        raise PointskinError("this build of the program has no studio")
    folder = tempfile.mkdtemp(prefix="pointskin-")
    file = os.path.join(folder, "mesh.ply")
    mesh.save(file)
    script = 'program="$1"; folder="$2"; "$program" studio "$folder/mesh.ply"; rm -r "$folder"'
    return subprocess.Popen(["/bin/sh", "-c", script, "sh", program, folder])
