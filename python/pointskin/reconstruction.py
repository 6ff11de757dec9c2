"""Points to field to mesh."""
from __future__ import annotations

import ctypes
import warnings
from typing import Any, Callable, Dict, Mapping, Optional, Union

import numpy as np

from . import _c
from ._arrays import NumpyArray, table
from ._library import Handle, call, library, make, struct
from ._options import Filled, as_dict, run_options
from ._progress import Progress, Watch
from ._workspaces import Workspace, workspace_for
from .clouds import Cloud, Points, cloud_of
from .errors import PointskinWarning, UsageError
from .meshes import Mesh

#: What `device=` takes: "auto", "cpu", "cuda", "cuda:1", or a Workspace.
Device = Union[str, Workspace]

SOLVE = ("depth", "point_normals", "normal_estimation", "field", "screening", "fixed_screening", "iterations", "scale",
         "samples_per_node", "confidence", "boundary", "envelope", "offset", "keep_strays")
EXTRACT = ("isovalue", "normals", "linear_fit", "domain_faces", "trim", "island_ratio", "largest", "min_component", "density",
           "weakness", "attributes")


def _named(options: Mapping[str, Any], allowed: Any, what: str) -> Dict[str, Any]:
    """Options that were given. `vertex_normals` is here what ExtractOptions calls normals."""
    found = {}
    for name, value in options.items():
        name = "normals" if name == "vertex_normals" else name
        if name not in allowed:
            shown = ", ".join("vertex_normals" if word == "normals" else word for word in allowed)
            raise UsageError(f"{what} has no option {name!r}; there are {shown}")
        if value is not None:
            found[name] = value
    return found


def warn(text: str, level: int = 4) -> None:
    warnings.warn(text, PointskinWarning, stacklevel=level)


def _drop_unusable(cloud: Cloud, options: Mapping[str, Any]) -> Cloud:
    """As the program does it: points whose normal has no length are left out, unless normals are made."""
    if cloud.dropped:
        warn(f"{cloud.dropped} points were dropped: their coordinates are not finite", 5)
    normals = cloud.normals
    if normals is None or options.get("point_normals") in ("repair", "estimate"):
        return cloud
    usable = normals.any(axis=1)
    if usable.all() or not usable.any():
        return cloud
    warn(f"{int(len(usable) - usable.sum())} points were dropped: their normal has zero length", 5)
    return cloud.keep(usable)


def _is_usable(points: Points, options: Mapping[str, Any]) -> bool:
    """True for arrays that the library takes as they are: nothing would be left out."""
    for found in points.inputs[:2]:
        owner = found.owner
        if found.type != "f4" or not isinstance(owner, np.ndarray) or not owner.flags.c_contiguous or not np.isfinite(owner).all():
            return False
    return bool(points.value.normals.data) and bool(np.any(points.inputs[1].owner, axis=1).all())


def _copy_of(rows: Any, count: int) -> Any:
    """An array of structs that is not the library's."""
    kind = rows._type_ * count
    return kind.from_buffer_copy(ctypes.string_at(rows, ctypes.sizeof(kind))) if count else kind()


def _reported(workspace: Workspace, chose_depth: bool) -> Callable[[], Dict[str, Any]]:
    """The report of the last run, whose warnings are passed on: made when it is asked for, as it costs a tenth of a fast
    run on a GPU."""
    raw = struct(_c.psk_run_report)
    call("psk_reconstructor_report", workspace.reconstructor, ctypes.byref(raw))
    told = [{"kind": raw.warnings[i].kind.decode(), "text": raw.warnings[i].text.decode(), "share": raw.warnings[i].share}
            for i in range(raw.warning_count)]
    for warning in told:
        if warning["kind"] != "coarse_depth" or not chose_depth:
            warn(warning["text"], 4)
    levels, normals_done, device = _copy_of(raw.levels, raw.level_count), raw.normals_done, workspace.name

    def report() -> Dict[str, Any]:
        found = as_dict(raw, ("size", "warnings", "levels", "warning_count", "level_count", "normals_done"))
        found["ms"] = {name[:-3]: found.pop(name) for name in list(found) if name.endswith("_ms") and name != "offset_ms"}
        found.update(normals_done=normals_done.decode(), warnings=told, levels=[as_dict(level) for level in levels], device=device)
        return found

    return report


class _Run:
    """What reconstruct() and solve() have in common: where the points are, where work is done, the options."""

    def __init__(self, points: Any, normals: Any, attributes: Any, device: Device, threads: int, stream: Any):
        named = attributes if isinstance(attributes, Mapping) else None
        self.arrays = None if isinstance(points, Cloud) else Points(points, normals, named)
        if self.arrays is None:
            self.cloud: Optional[Cloud] = cloud_of(points, normals, named)
        else:
            self.cloud = None
        if self.arrays is not None and self.arrays.gpu >= 0:
            if not isinstance(device, Workspace):
                device = f"cuda:{self.arrays.gpu}"
            stream = stream if stream is not None else self.arrays.stream
        self.workspace = workspace_for(device, threads, stream)

    def settle(self, options: Dict[str, Any], points: Any, normals: Any, attributes: Any) -> None:
        """Arrays on the host become a cloud unless they can be used as they are."""
        if self.arrays is None:
            self.cloud = _drop_unusable(self.cloud, options) if self.cloud is not None else None
        elif self.arrays.gpu < 0 and (self.workspace.gpu >= 0 or not _is_usable(self.arrays, options) or options.get("depth") == "auto"):
            self.cloud = _drop_unusable(Cloud(points, normals, attributes if isinstance(attributes, Mapping) else None), options)
            self.arrays = None
        if options.get("depth") == "auto" and self.cloud is not None:
            options["depth"] = suggest_depth(self.cloud, device=self.workspace)["depth"]


def reconstruct(points: Any, normals: Any = None, *, attributes: Union[None, bool, Mapping[str, Any]] = None,
                depth: Union[None, int, str] = None, trim: Union[None, float, str] = None, device: Device = "auto",
                threads: int = 0, stream: Any = None, max_memory: int = 0, progress: Progress = None, **options: Any) -> Mesh:
    """A watertight mesh of oriented points: screened Poisson reconstruction on a data-parallel octree.

    points: a Cloud, or an array of shape (n, 3), world units, of any type and strides, on the host or on a GPU: numpy,
    torch, cupy, jax and whatever else has `__cuda_array_interface__`, `__dlpack__` or the buffer protocol. Arrays on a GPU
    are used where they are and give a mesh there.
    normals: shape (n, 3), outward, any length; None: see point_normals.
    attributes: name to shape (n,) or (n, k), carried to the vertices; True: those of the Cloud.
    depth: 1 to 20, or "auto"; cells are cube / 2^depth wide; 8 where nothing is said.
    trim: in [0, 1), or "auto": cut where samples end; 0, closed, where nothing is said.
    device: "auto", "cpu", "cuda", "cuda:N", "cuda:N,M" and "cuda:all" (several GPUs as one) or a Workspace; arrays on a GPU decide
    themselves. threads: of the CPU, 0: all.
    stream: a CUDA stream to work on; None: that of the array's library.
    max_memory: bytes on the device, 0: no limit.
    progress: a function of phase and share, which may return False to cancel, or True for a bar.
    options: point_normals ("auto", "given", "repair", "estimate"), normal_estimation (a dict, see orient()), field ("poisson",
    "distance"), screening, fixed_screening, iterations, scale, samples_per_node, confidence, boundary ("free", "dirichlet"),
    envelope (a Mesh), offset, keep_strays; isovalue, vertex_normals, linear_fit, domain_faces ("closed", "open"),
    island_ratio, largest, min_component, density, weakness: as in include/pointskin/reconstruct.hpp.

    Raises UsageError, InvalidInputError, NoNormalsError, EmptyResultError, OverLimitError, DeviceUnavailableError;
    KeyboardInterrupt on Ctrl-C. Warns (PointskinWarning) of points that were left out, and of what the run found wrong.
    O(n log n + nodes). The same bytes for any number of threads, any order of the points, CPU or GPU.
    """
    given = _named({"depth": depth, "trim": trim, **options}, SOLVE + EXTRACT, "reconstruct")
    run = _Run(points, normals, attributes, device, threads, stream)
    chose_depth = "depth" in given
    run.settle(given, points, normals, attributes)
    given.update({"attributes": int(bool(attributes)), "max_memory": max_memory})
    workspace = run.workspace
    with workspace, Watch(progress) as watch:
        filled = run_options(given, watch)
        pointer = _reconstruct(run, filled)
        return Mesh._of(pointer, workspace, _reported(workspace, chose_depth))


def _reconstruct(run: _Run, filled: Filled) -> int:
    if run.arrays is None:
        assert run.cloud is not None
        return make("psk_reconstruct", run.workspace.reconstructor, run.cloud.handle, filled)
    memory = _c.PSK_DEVICE if run.arrays.gpu >= 0 else _c.PSK_HOST
    return make("psk_reconstruct_points", run.workspace.reconstructor, run.arrays, filled, memory)


class _FieldHandle(Handle):
    _free_name = "psk_field_free"

    def __init__(self, pointer: int, workspace: Workspace):
        super().__init__(pointer)
        self.workspace = workspace

    def close(self) -> None:
        pointer, self._pointer = getattr(self, "_pointer", None), None
        if pointer is not None:
            self.workspace.free_later(self._free, pointer)


class Field:
    """The implicit function of solve(): about 1 inside, 0 outside; with field="distance" or an offset minus a signed
    distance in finest cells."""

    def __init__(self, pointer: int, workspace: Workspace, on_gpu: bool, report: Dict[str, Any]):
        self.handle, self._on_gpu, self.report = _FieldHandle(pointer, workspace), on_gpu, report

    @property
    def isovalue(self) -> float:
        """The mean over the samples, where the surface lies unless another value is asked for."""
        return float(library().psk_field_isovalue(self.handle))

    @property
    def cube(self) -> Any:
        """Lower corner, shape (3,), and side of the working cube, world units."""
        lower, side = (ctypes.c_double * 3)(), ctypes.c_double()
        library().psk_field_cube(self.handle, lower, ctypes.byref(side))
        return np.array(lower), side.value

    def __call__(self, points: Any) -> NumpyArray:
        """Values at points of shape (n, 3), or one of shape (3,), in world coordinates: float32, shape (n,). Points outside
        of the cube get the value of its nearest point. O(n depth)."""
        places = np.asarray(points, dtype=np.float64)
        single = places.ndim == 1
        array = table(places.reshape(1, 3) if single else places, "points")
        values = np.empty(array.rows, dtype=np.float32)
        with self.handle.workspace:
            call("psk_field_values", self.handle, ctypes.byref(array.c_array()),
                 values.ctypes.data_as(ctypes.POINTER(ctypes.c_float)))
        result: NumpyArray = values[0] if single else values
        return result

    def extract(self, isovalue: Optional[float] = None, *, trim: Union[None, float, str] = None, **options: Any) -> Mesh:
        """The surface as a mesh, again and again with other options; where solve() had its points. The same bytes as
        reconstruct() with the same ones. Options: those of reconstruct() from isovalue on, attributes=True.
        Raises UsageError, EmptyResultError."""
        given = _named({"isovalue": isovalue, "trim": trim, **options}, EXTRACT, "extract")
        memory = _c.PSK_DEVICE if self._on_gpu else _c.PSK_HOST
        with self.handle.workspace as workspace:
            return Mesh._of(make("psk_field_extract", self.handle, run_options(given), memory), workspace, self.report)

    def __repr__(self) -> str:
        return f"<pointskin.Field, isovalue {self.isovalue:.4g}>"


def solve(points: Any, normals: Any = None, *, attributes: Optional[Mapping[str, Any]] = None,
          depth: Union[None, int, str] = None, device: Device = "auto", threads: int = 0, stream: Any = None, max_memory: int = 0,
          progress: Progress = None, **options: Any) -> Field:
    """Fits the implicit function to oriented points. Parameters as reconstruct(), without those of the extraction. Keeps the
    attributes of a Cloud for extract(attributes=True)."""
    given = _named({"depth": depth, **options}, SOLVE, "solve")
    run = _Run(points, normals, attributes, device, threads, stream)
    chose_depth = "depth" in given
    run.settle(given, points, normals, attributes)
    given["max_memory"] = max_memory
    workspace = run.workspace
    with workspace, Watch(progress) as watch:
        filled = run_options(given, watch)
        on_gpu = run.arrays is not None and run.arrays.gpu >= 0
        if run.arrays is not None:
            pointer = make("psk_solve_points", workspace.reconstructor, run.arrays, filled)
        else:
            assert run.cloud is not None
            pointer = make("psk_solve", workspace.reconstructor, run.cloud.handle, filled)
        return Field(pointer, workspace, on_gpu, _reported(workspace, chose_depth)())


def suggest_depth(cloud: Any, *, device: Device = "auto", threads: int = 0, **options: Any) -> Dict[str, Any]:
    """The depth whose cells are as wide as the points resolve: depth, supported, spacing and noise (world units)."""
    workspace = workspace_for(device, threads)
    found = struct(_c.psk_depth_suggestion)
    with workspace:
        call("psk_suggest_depth", workspace.pointer, cloud_of(cloud).handle, run_options(options), ctypes.byref(found))
    return as_dict(found)


def estimate_bytes(cloud: Any, *, threads: int = 0, **options: Any) -> int:
    """Bytes that reconstruct() takes on its device, within 15 %."""
    found = ctypes.c_int64()
    given = run_options(_named(options, SOLVE + EXTRACT, "estimate_bytes"))
    call("psk_estimate_device_bytes", cloud_of(cloud).handle, given, threads, ctypes.byref(found))
    return found.value


