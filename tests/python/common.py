"""What the tests of the Python package share: shapes, files, the program."""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import pointskin as ps

PROGRAM = os.environ.get("POINTSKIN_PROGRAM", "")
DATA = pathlib.Path(__file__).resolve().parents[3] / "shared" / "data"


def sphere(count, radius=1.0, centre=(0, 0, 0), dtype=np.float32):
    """Points on a sphere by the golden angle, and their outward normals."""
    i = np.arange(count)
    z = 1 - (2 * i + 1) / count
    r, angle = np.sqrt(1 - z * z), 2.399963229728653 * i
    normals = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)
    return (radius * normals + np.asarray(centre)).astype(dtype), normals.astype(np.float32)


def bytes_of(mesh):
    """All arrays of a mesh as bytes, so that differences of one bit are seen."""
    mesh = mesh.to_host()
    arrays = [mesh.local_vertices, mesh.faces, mesh.origin] + ([mesh.normals] if mesh.normals is not None else [])
    return b"".join(np.asarray(array).tobytes() for array in arrays + [mesh.attributes[name] for name in mesh.attributes])


def has(module):
    return importlib.util.find_spec(module) is not None


class Case(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self._folder.name)
        self.addCleanup(self._folder.cleanup)

    def program(self, *arguments):
        """Runs the program, which must succeed. @returns its stdout"""
        if not PROGRAM:
            self.skipTest("POINTSKIN_PROGRAM is not set")
        done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, f"{arguments}: {done.stderr}")
        return done.stdout

    def file(self, name):
        return str(self.folder / name)


def run_python(code, timeout=120):
    """Another interpreter with the same package."""
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=timeout, check=False)


__all__ = ["Case", "DATA", "PROGRAM", "bytes_of", "has", "np", "ps", "run_python", "sphere", "unittest"]
