"""Reading files, and what formats there are."""
from __future__ import annotations

import ctypes
import os
import warnings
from typing import Any, Dict, List, Union

from ._library import call, encoded, library, make
from ._options import read_options
from .clouds import Cloud
from .errors import PointskinWarning
from .meshes import Mesh

Path = Union[str, "os.PathLike[str]"]


def _warn_of_dropped(cloud: Cloud, path: Path) -> Cloud:
    if cloud.dropped:
        warnings.warn(f"{os.fspath(path)}: {cloud.dropped} points were left out: their coordinates are not finite", PointskinWarning, stacklevel=3)
    return cloud


def read(path: Path, *, shift: Any = None, threads: int = 0) -> Union[Cloud, Mesh]:
    """A Mesh where the file has faces, else a Cloud. Any format of docs/formats.md, found by its first bytes or its extension.

    shift: three numbers to take off the coordinates before float is used; None: chosen, 0 unless coordinates are large.
    Raises InvalidInputError, with the line or byte. O(n)."""
    cloud, mesh = ctypes.c_void_p(), ctypes.c_void_p()
    call("psk_read", encoded(path), read_options(shift, threads), ctypes.byref(cloud), ctypes.byref(mesh))
    return Mesh._of(mesh.value) if mesh.value else _warn_of_dropped(Cloud._of(cloud.value or 0), path)


def read_cloud(path: Path, *, shift: Any = None, threads: int = 0) -> Cloud:
    """The points of a file, or the vertices of a mesh."""
    return _warn_of_dropped(Cloud._of(make("psk_cloud_read", encoded(path), read_options(shift, threads))), path)


def read_mesh(path: Path, *, shift: Any = None, threads: int = 0) -> Mesh:
    """The mesh of a file. Raises InvalidInputError for a file of points."""
    return Mesh._of(make("psk_mesh_read", encoded(path), read_options(shift, threads)))


def write(path: Path, what: Union[Cloud, Mesh], **options: Any) -> None:
    """Writes a Cloud or a Mesh; the format follows the extension. The file appears whole or not at all.
    Options: ascii, threads. Raises OutputNotWrittenError, UsageError for an unknown extension."""
    what.save(path, **options)


def merge(*clouds: Cloud) -> Cloud:
    """The points of all, in their order. Attributes of one name become one; points that lack it have none; normals are
    kept where all have them."""
    first = clouds[0] if clouds else None
    if first is None:
        raise ValueError("there is nothing to merge")
    return first.merged(*clouds[1:])


def formats() -> List[Dict[str, Any]]:
    """The file formats of this build: name, extensions, and what can be done with them."""
    found = []
    for i in range(library().psk_format_count()):
        entry = library().psk_format_get(i)
        found.append({"name": entry.name.decode(), "extensions": entry.extensions.decode().split(),
                      **{name: bool(getattr(entry, name)) for name in ("reads_clouds", "reads_meshes", "writes_clouds", "writes_meshes")}})
    return found


