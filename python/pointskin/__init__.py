"""Pointskin: oriented points in, watertight triangle mesh out, on a GPU in milliseconds, on a CPU in a second.

    import pointskin as ps
    mesh = ps.reconstruct(points, normals, depth=9)
    mesh.save("mesh.glb")

Lengths are in world units, the unit of the points. Results are the same bytes for any number of threads, any order of the
points, on CPU and GPU. The shared library is loaded when it is first needed.
"""
from .analysis import Problem, boolean, check, compare, distances, measure, orient, problems
from ._arrays import DeviceArray
from ._workspaces import Workspace
from .clouds import Attributes, Cloud
from .errors import (CancelledError, DeviceUnavailableError, EmptyResultError, InvalidInputError, LibraryNotFoundError,
                     NoNormalsError, OutputNotWrittenError, OverLimitError, PointskinError, PointskinWarning, UsageError)
from .files import formats, merge, read, read_cloud, read_mesh, write
from .meshes import Mesh
from .pictures import Image, camera, render
from .reconstruction import Field, estimate_bytes, reconstruct, solve, suggest_depth
from .sessions import Deformer, EditSession, Fluid, fluid, handle, lattice

__version__ = "0.1.0"

__all__ = [
    "Attributes", "CancelledError", "Cloud", "Deformer", "DeviceArray", "DeviceUnavailableError", "EditSession",
    "EmptyResultError", "Field", "Fluid", "Image", "InvalidInputError", "LibraryNotFoundError", "Mesh", "NoNormalsError",
    "OutputNotWrittenError", "OverLimitError", "PointskinError", "PointskinWarning", "Problem", "UsageError", "Workspace",
    "boolean", "built_with_cuda", "camera", "check", "compare", "distances", "estimate_bytes", "fluid", "formats", "handle",
    "lattice", "measure", "merge", "orient", "problems", "read", "read_cloud", "read_mesh", "reconstruct", "render", "solve",
    "suggest_depth", "write",
]


def built_with_cuda() -> bool:
    """True if the library was built with CUDA. Says nothing about GPUs being present."""
    from ._library import library
    return bool(library().psk_built_with_cuda())
