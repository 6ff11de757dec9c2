"""Objects that stay: editing sessions, deformations and fluids, frame after frame."""
from __future__ import annotations

import ctypes
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from . import _c
from ._arrays import doubles
from ._library import Handle, call, make, struct
from ._options import Filled, as_dict, choice, run_options
from ._progress import Progress, Watch
from ._workspaces import Workspace, workspace_for
from .clouds import Cloud, Points, cloud_of
from .meshes import Mesh
from .reconstruction import EXTRACT, SOLVE, Device, _named

Camera = Dict[str, Any]


class _Owned(Handle):
    """A handle whose memory is a workspace's."""

    def __init__(self, pointer: int, workspace: Workspace, kept: Any = None):
        super().__init__(pointer)
        self.workspace, self.kept = workspace, kept

    def close(self) -> None:
        pointer, self._pointer = getattr(self, "_pointer", None), None
        if pointer is not None:
            self.workspace.free_later(self._free, pointer)


class _EditHandle(_Owned):
    _free_name = "psk_edit_free"


class _DeformerHandle(_Owned):
    _free_name = "psk_deformer_free"


class _FluidHandle(_Owned):
    _free_name = "psk_fluid_free"


def _set_camera(target: Any, camera: Camera) -> None:
    target.view[:] = np.asarray(camera["view"], dtype=np.float64).reshape(16)
    target.projection[:] = np.asarray(camera["projection"], dtype=np.float64).reshape(16)
    target.width, target.height = camera["width"], camera["height"]


def _pixels(filled: Filled, points: Any) -> Tuple[Any, int]:
    array = np.ascontiguousarray(np.asarray(points, dtype=np.float64).reshape(-1, 2))
    filled.keep(array)
    return ctypes.cast(array.ctypes.data, ctypes.POINTER(ctypes.c_double)), len(array)


def _set_area(filled: Filled, area: Any) -> None:
    """One polygon (k, 2), or a list of them, which are even-odd: polygons in polygons are holes."""
    if area is None:
        return
    polygons: Sequence[Any] = [area] if np.ndim(area[0][0]) == 0 else area
    list_of = (_c.psk_polygon * len(polygons))()
    for entry, polygon in zip(list_of, polygons):
        entry.pixels, entry.count = _pixels(filled, polygon)
    filled.keep(list_of)
    filled.value.area, filled.value.area_count = ctypes.cast(list_of, ctypes.POINTER(_c.psk_polygon)), len(polygons)


class EditSession:
    """Reconstruction under the user's hand: guides, removals, copied parts, turned normals; undo and redo of all.

    base: a Cloud, or shape (n, 3) with normals. Options: those of reconstruct(), and topology, warm_start, continued,
    keep_attributes, states_kept, undo_bytes of EditOptions (edit.hpp). Cameras are those of pointskin.camera(); places are
    pixels, (0, 0) the upper left corner. The same bytes whenever the operations were the same."""

    _OWN = ("topology", "warm_start", "continued", "keep_attributes", "states_kept", "undo_bytes")

    def __init__(self, base: Any, normals: Any = None, *, device: Device = "auto", threads: int = 0, progress: Progress = None,
                 **options: Any):
        workspace = workspace_for(device, threads)
        own = {name: options.pop(name) for name in self._OWN if name in options}
        self._watch = Watch(progress)
        filled = Filled(_c.psk_edit_options).set(own, "EditSession")
        inner = filled.keep(run_options(_named(options, SOLVE + EXTRACT, "EditSession"), self._watch))
        filled.value.reconstruction = ctypes.pointer(inner.value)
        with workspace, self._watch:
            pointer = make("psk_edit_create", workspace.pointer, cloud_of(base, normals).handle, filled)
        self.handle = _EditHandle(pointer, workspace, self._watch)
        self._options = filled  # an envelope is read again with every surface

    def operation(self, kind: str, camera: Optional[Camera] = None, *, stroke: Any = None, area: Any = None,
                  part: Optional[Cloud] = None, **more: Any) -> Filled:
        """An operation for preview() and apply(). kind: "guide", "remove", "insert" or "flip"."""
        filled = Filled(_c.psk_operation)
        filled.value.kind = ("guide", "remove", "insert", "flip").index(kind)
        if camera is not None:
            _set_camera(filled.value.camera, camera)
        _set_area(filled, area)
        if stroke is not None:
            filled.value.stroke, filled.value.stroke_count = _pixels(filled, stroke)
        if part is not None:
            filled.value.part = filled.keep(part).handle.pointer
        for name, count in (("lower", 3), ("upper", 3), ("rotation", 9), ("translation", 3)):
            if name in more:
                getattr(filled.value, name)[:] = list(doubles(more.pop(name), count, name))
        return filled.set(more, kind)

    def apply(self, operation: Filled) -> Dict[str, Any]:
        """Does it. Returns what it did: added, removed, flipped, points, triangles, components and genus before and after.
        Raises UsageError, EmptyResultError, OverLimitError; the session then stays as it was."""
        report = struct(_c.psk_step_report)
        with self.handle.workspace, self._watch:
            call("psk_edit_apply", self.handle, operation, ctypes.byref(report))
        return as_dict(report)

    def preview(self, operation: Filled) -> Tuple[Cloud, Cloud]:
        """The points that it would add, and those that it would remove."""
        added, removed = ctypes.c_void_p(), ctypes.c_void_p()
        with self.handle.workspace:
            call("psk_edit_preview", self.handle, operation, ctypes.byref(added), ctypes.byref(removed))
        return Cloud._of(added.value or 0), Cloud._of(removed.value or 0)

    def guide(self, camera: Camera, stroke: Any = None, *, area: Any = None, **options: Any) -> Dict[str, Any]:
        """Adds points along a stroke, shape (k, 2) pixels, through the whole depth of the cloud, or fills an area. Options:
        interval (world units), stroke_normals, inside_only."""
        return self.apply(self.operation("guide", camera, stroke=stroke, area=area, **options))

    def remove(self, camera: Camera, area: Any, **options: Any) -> Dict[str, Any]:
        """Removes what the view shows in an area: a polygon of shape (k, 2), or several. Options: originals, front_layer."""
        return self.apply(self.operation("remove", camera, area=area, **options))

    def insert(self, part: Cloud, **options: Any) -> Dict[str, Any]:
        """Adds a part of another cloud. Options: lower, upper (3), camera and area, scale, rotation (3, 3), translation (3),
        snap."""
        return self.apply(self.operation("insert", options.pop("camera", None), part=part, **options))

    def flip(self, camera: Camera, area: Any, **options: Any) -> Dict[str, Any]:
        """Turns the normals of what the view shows in an area. Options: front_layer."""
        return self.apply(self.operation("flip", camera, area=area, **options))

    def _step(self, name: str) -> bool:
        done = ctypes.c_int32()
        with self.handle.workspace, self._watch:
            call(name, self.handle, ctypes.byref(done))
        return bool(done.value)

    def undo(self) -> bool:
        """Takes the last operation back. False if there is none."""
        return self._step("psk_edit_undo")

    def redo(self) -> bool:
        """Does the last one that was taken back again. False if there is none."""
        return self._step("psk_edit_redo")

    @property
    def mesh(self) -> Mesh:
        """A copy of the present surface."""
        with self.handle.workspace:
            return Mesh._of(make("psk_edit_mesh", self.handle))

    @property
    def cloud(self) -> Cloud:
        """A copy of the present points, with the attribute "added": 0 original, 1 guide, 2 inserted."""
        with self.handle.workspace:
            return Cloud._of(make("psk_edit_cloud", self.handle))


def handle(region: str, *, angle: float = 0.0, axis: Any = (0, 0, 1), axis_point: Any = (0, 0, 0), translation: Any = (0, 0, 0),
           matrix: Any = None, pivot: Any = (0, 0, 0), **where: Any) -> Filled:
    """A region and how it moves, for Deformer. region and its place: "half_space" (point, normal), "ball" (centre, radius),
    "box" (lower, upper), "capsule" (start, end, radius), "points" (points: indices in the rest cloud).

    A rigid motion: angle in radians about an axis through axis_point, then a translation; or matrix (3, 4), an affine map,
    with its pivot. Nothing: the region stays where it is."""
    filled = Filled(_c.psk_handle)
    value = filled.value
    value.region = choice("region", region)
    for member, names in (("a", ("point", "centre", "lower", "start")), ("b", ("normal", "upper", "end"))):
        for name in names:
            if name in where:
                getattr(value, member)[:] = list(doubles(where.pop(name), 3, name))
    if "points" in where:
        indices = np.ascontiguousarray(np.asarray(where.pop("points"), dtype=np.int64).reshape(-1))
        filled.keep(indices)
        value.points, value.point_count = ctypes.cast(indices.ctypes.data, ctypes.POINTER(ctypes.c_int64)), len(indices)
    value.angle = angle
    for name, numbers in (("axis", axis), ("axis_point", axis_point), ("translation", translation), ("pivot", pivot)):
        getattr(value, name)[:] = list(doubles(numbers, 3, name))
    if matrix is not None:
        value.affine, value.matrix[:] = 1, list(doubles(matrix, 12, "matrix"))
    return filled.set(where, "handle")


def lattice(origin: Any, axes: Any, spans: Any = (1, 1, 1), control: Any = None, *, stay: bool = False) -> Filled:
    """A block of control points for Deformer. origin (3,), axes (3, 3): its edges; spans: l, m, n; control: shape (l+1, m+1,
    n+1, 3), world coordinates, None: at rest. stay: points outside of the block stay."""
    filled = Filled(_c.psk_lattice)
    value = filled.value
    value.origin[:], value.axes[:] = list(doubles(origin, 3, "origin")), list(doubles(axes, 9, "axes"))
    value.spans[:] = [int(span) for span in spans]
    value.stay = int(stay)
    if control is not None:
        count = 3 * int(np.prod([int(span) + 1 for span in spans]))
        value.control = ctypes.cast(filled.keep(doubles(control, count, "control")), ctypes.POINTER(ctypes.c_double))
    return filled


def _row(kind: Any, parts: List[Filled]) -> Any:
    return (kind * len(parts))(*[part.value for part in parts])


class Deformer:
    """A cloud that is deformed frame after frame by handles and lattices, always from its rest pose. Options: those of
    reconstruct(). The same deformation gives the same bytes, whatever came before."""

    def __init__(self, rest: Any, normals: Any = None, *, device: Device = "auto", threads: int = 0, **options: Any):
        workspace = workspace_for(device, threads)
        self._options = run_options(_named(options, SOLVE + EXTRACT, "Deformer"))
        with workspace:
            pointer = make("psk_deformer_create", workspace.pointer, cloud_of(rest, normals).handle, self._options)
        self.handle = _DeformerHandle(pointer, workspace)

    def deform(self, handles: Sequence[Filled] = (), lattices: Sequence[Filled] = (), share: float = 1.0) -> None:
        """Moves the rest cloud: first the handles, then the lattices. share: 0 is the rest pose, 1 all of it."""
        first, second = list(handles), list(lattices)
        with self.handle.workspace:
            call("psk_deformer_deform", self.handle, _row(_c.psk_handle, first), len(first), _row(_c.psk_lattice, second),
                 len(second), share)

    def mesh(self) -> Mesh:
        """The surface of the deformed cloud. Costs a reconstruction."""
        with self.handle.workspace:
            return Mesh._of(make("psk_deformer_mesh", self.handle))

    @property
    def cloud(self) -> Cloud:
        """A copy of the deformed points."""
        with self.handle.workspace:
            return Cloud._of(make("psk_deformer_cloud", self.handle))

    @property
    def report(self) -> Dict[str, Any]:
        """Points, inserted, thinned, and times of the last deformation."""
        found = struct(_c.psk_deform_report)
        call("psk_deformer_report", self.handle, ctypes.byref(found))
        return as_dict(found)


class Fluid:
    """Makes surfaces of particles, frame after frame.

    particle_radius: world units, half the distance of particles at rest. Options, in particle radii: smoothing_length,
    cube_size, surface_threshold, min_component; kernel ("isotropic", "anisotropic"), smoothing_iterations,
    smoothing_weights, normals, attributes (on): as in include/pointskin/fluid.hpp."""

    def __init__(self, particle_radius: float, *, device: Device = "auto", threads: int = 0, stream: Any = None, **options: Any):
        self._device, self._threads, self._stream = device, threads, stream
        self._options = Filled(_c.psk_fluid_options).set({"particle_radius": particle_radius, **options}, "Fluid")
        self._handles: Dict[int, _FluidHandle] = {}
        self.report: Dict[str, Any] = {}

    def _handle(self, workspace: Workspace) -> _FluidHandle:
        if id(workspace) not in self._handles:
            with workspace:
                self._handles[id(workspace)] = _FluidHandle(make("psk_fluid_create", workspace.pointer), workspace)
        return self._handles[id(workspace)]

    def surface(self, particles: Any, attributes: Any = None) -> Mesh:
        """The closed surface of one frame. particles: a Cloud, or shape (n, 3), on the host, or on a GPU for a mesh there.
        Raises UsageError, InvalidInputError, EmptyResultError, OverLimitError."""
        arrays = None if isinstance(particles, Cloud) else Points(particles, None, attributes)
        if arrays is not None and arrays.gpu >= 0:
            stream = self._stream if self._stream is not None else arrays.stream
            device = self._device if isinstance(self._device, Workspace) else f"cuda:{arrays.gpu}"
            workspace = workspace_for(device, self._threads, stream)
        else:
            workspace = workspace_for(self._device, self._threads, self._stream)
        owner = self._handle(workspace)
        with workspace:
            if arrays is not None and arrays.gpu >= 0:
                pointer = make("psk_fluid_surface_points", owner.pointer, arrays, self._options, _c.PSK_DEVICE)
            else:
                cloud = cloud_of(particles, None, attributes if arrays is not None else None)
                pointer = make("psk_fluid_surface", owner.pointer, cloud.handle, self._options)
            found = struct(_c.psk_fluid_report)
            call("psk_fluid_get_report", owner.pointer, ctypes.byref(found))
            self.report = as_dict(found)
            return Mesh._of(pointer, workspace, self.report)


def fluid(particles: Any, particle_radius: float, attributes: Any = None, **options: Any) -> Mesh:
    """The surface of one frame of particles; see Fluid."""
    return Fluid(particle_radius, **options).surface(particles, attributes)
