"""Normals, comparisons, problems, and set operations."""
from __future__ import annotations

import ctypes
import warnings
from typing import Any, Dict, List, Union

import numpy as np

from . import _c
from ._arrays import NumpyArray
from ._library import Handle, call, encoded, make, struct
from ._options import Filled, as_dict, choice, normal_options, render_options, run_options
from ._progress import Progress, Watch
from ._workspaces import workspace_for
from .clouds import Cloud, cloud_of
from .errors import PointskinWarning, UsageError
from .files import Path
from .meshes import Mesh, measures_of
from .pictures import Image, pair
from .reconstruction import EXTRACT, SOLVE, Device, _named

Surface = Union[Mesh, Cloud]


def orient(points: Any, normals: Any = None, *, device: Device = "auto", threads: int = 0, progress: Progress = None,
           **options: Any) -> Cloud:
    """A copy of the points with outward unit normals, estimated and oriented, or given ones repaired.

    points: a Cloud, or shape (n, 3). Options: method ("auto", "sensor", "propagate", "iterate", "repair"), sensors (shape
    (k, 3), world coordinates of the scanners), random_start, seed, max_rounds, time_limit_s, keep_within_degrees,
    confidence (the attribute "confidence", on unless 0), curvature. `report` of the result says what was done.
    Raises UsageError, NoNormalsError, EmptyResultError, OverLimitError. O(n log n) and some solves; deterministic."""
    cloud = points.copy() if isinstance(points, Cloud) else cloud_of(points, normals)
    report = struct(_c.psk_normal_report)
    workspace = workspace_for(device, threads)
    with workspace, Watch(progress) as watch:
        filled = normal_options(options, watch)
        call("psk_orient", workspace.pointer, cloud.handle, filled, ctypes.byref(report))
    cloud.report = as_dict(report, ("size", "assumed", "warning"))
    cloud.report["assumed"] = (report.assumed or b"").decode()
    if report.warning:
        warnings.warn(report.warning.decode(), PointskinWarning, stacklevel=2)
    return cloud


def compare(surface: Surface, reference: Surface, **options: Any) -> Dict[str, Any]:
    """Distances both ways between two surfaces (mean, rms, p95, max; world units), normal consistency and F-score.
    Options: samples (500,000), tau (0.01 of the reference's diagonal), threads. Deterministic."""
    found = struct(_c.psk_comparison)
    filled = Filled(_c.psk_compare_options).set(options, "compare")
    call("psk_compare", *pair(surface), *pair(reference), filled, ctypes.byref(found))
    report = as_dict(found)
    for name in ("to_reference", "from_reference", "two_sided"):
        report[name] = dict(zip(("mean", "rms", "p95", "max"), report[name]))
    report["has_normals"] = bool(report["has_normals"])
    return report


def distances(surface: Surface, reference: Surface, *, with_sign: bool = False, threads: int = 0) -> NumpyArray:
    """Shape (v,) or (n,), float64: the distance of every vertex or point from the reference, world units; with_sign:
    negative inside of the reference, which must be watertight then."""
    count = len(surface.local_vertices) if isinstance(surface, Mesh) else len(surface)
    found = np.empty(count, dtype=np.float64)
    call("psk_distances", *pair(surface), *pair(reference), int(with_sign), threads,
         found.ctypes.data_as(ctypes.POINTER(ctypes.c_double)))
    return found


def measure(mesh: Union[Mesh, Path], threads: int = 0, *, max_memory: int = 0) -> Dict[str, Any]:
    """Counts and measures of a mesh, or of the mesh in a file; see Mesh.measure().

    max_memory: bytes that measuring a file may take, 0: no limit. Where the limit does not hold the mesh, a binary PLY file of
    triangles is read in parts: the same numbers, to the last bit. Raises InvalidInputError, OverLimitError (which says how much
    would do), UsageError for a limit with a mesh that is in memory already. O(t log t) and readings of the file."""
    if isinstance(mesh, Mesh):
        if max_memory:
            raise UsageError("max_memory is for a mesh in a file; this one is in memory already")
        return mesh.measure(threads)
    report = struct(_c.psk_mesh_report)
    options = Filled(_c.psk_scale_options).set({"max_memory_bytes": max_memory, "threads": threads}, "measure")
    call("psk_measure_file", encoded(mesh), options, ctypes.byref(report))
    return measures_of(report)


def check(mesh: Union[Mesh, Path], threads: int = 0, *, max_memory: int = 0) -> bool:
    """True if the mesh, or that in a file, is watertight: closed, 2-manifold, oriented and not inside out; see measure()."""
    return bool(measure(mesh, threads, max_memory=max_memory)["watertight"])


class _ProblemsHandle(Handle):
    _free_name = "psk_problems_free"


class Problem:
    """A region of a mesh whose topology is doubtful: score, peak, area, triangles, centroid, lower, upper, mean_normal and
    views, a list of cameras that see it."""

    def __init__(self, handle: _ProblemsHandle, index: int, mesh: Mesh, found: Any):
        self._handle, self._index, self._mesh = handle, index, mesh
        values = as_dict(found, ("size", "views", "view_count"))
        self.score: float = values["score"]
        self.peak: float = values["peak"]
        self.area: float = values["area"]
        self.triangles: int = values["triangles"]
        self.centroid, self.lower, self.upper, self.mean_normal = (
            np.array(values[name]) for name in ("centroid", "lower", "upper", "mean_normal"))
        self.views: List[Dict[str, Any]] = [as_dict(found.views[i], ()) for i in range(found.view_count)]

    def render(self, view: int = 0, caption: str = "", **options: Any) -> Image:
        """A picture of the region by one of its views."""
        filled = render_options(options)
        return Image(make("psk_problems_render", self._handle, self._index, view, self._mesh.handle, filled,
                          caption.encode()))

    def __repr__(self) -> str:
        return f"<pointskin.Problem of {self.triangles} triangles, score {self.score:.3g}>"


def problems(mesh: Mesh, **options: Any) -> List[Problem]:
    """Regions where the surface is a guess, the worst first. mesh: made with weakness=True. Options: threshold, least_area,
    up, threads. Raises UsageError for a mesh without the attribute "weakness"."""
    filled = Filled(_c.psk_problem_options).set(options, "problems")
    handle = _ProblemsHandle(make("psk_find_problems", mesh.handle, filled))
    from ._library import library
    found = []
    for index in range(library().psk_problems_count(handle)):
        problem = struct(_c.psk_problem)
        call("psk_problems_get", handle, index, ctypes.byref(problem))
        found.append(Problem(handle, index, mesh, problem))
    return found


def boolean(a: Surface, b: Surface, operation: str = "unite", *, device: Device = "auto", threads: int = 0,
            creases: bool = True, coincidence_cells: float = 0.5, progress: Progress = None, **options: Any) -> Mesh:
    """Combines two solids, closed meshes or oriented points: "unite", "intersect", "subtract", "symmetric_difference".

    creases: samples are added where the surfaces cross. Other options: those of reconstruct(). `mesh.report` says what
    became of the points, and `mesh.report["cloud"]` is the Cloud of the result. Three reconstructions; deterministic.
    Raises UsageError, NoNormalsError, InvalidInputError, EmptyResultError, OverLimitError."""
    workspace = workspace_for(device, threads)
    report, mesh, cloud = struct(_c.psk_boolean_report), ctypes.c_void_p(), ctypes.c_void_p()
    with workspace, Watch(progress) as watch:
        filled = Filled(_c.psk_boolean_options)
        inner = filled.keep(run_options(_named(options, SOLVE + EXTRACT, "boolean"), watch))
        filled.value.reconstruction = ctypes.pointer(inner.value)
        filled.set({"creases": int(creases), "coincidence_cells": coincidence_cells}, "boolean")
        call("psk_boolean", workspace.pointer, *pair(a), *pair(b), choice("operation", operation), filled,
             ctypes.byref(mesh), ctypes.byref(cloud), ctypes.byref(report))
    made = Mesh._of(mesh.value or 0, None, as_dict(report))
    made.report["cloud"] = Cloud._of(cloud.value or 0)
    return made
