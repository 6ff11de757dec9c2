"""Points with normals and attributes."""
from __future__ import annotations

import ctypes
import os
from typing import Any, Dict, Iterator, List, Mapping, Optional, Tuple

import numpy as np

from . import _c
from ._arrays import host_view, Input, NumpyArray, table, taken
from ._library import Handle, call, encoded, library, make
from ._options import read_options, write_options
from .errors import InvalidInputError, UsageError

_GROUPS = {"rgb": ("red", "green", "blue"), "rgba": ("red", "green", "blue", "alpha")}


def split_names(name: str, count: int) -> List[str]:
    """What the columns of an array (n, count) are called: rgb is red, green and blue; others are numbered."""
    if name in _GROUPS and len(_GROUPS[name]) == count:
        return list(_GROUPS[name])
    return [name] if count == 1 else [f"{name}_{i}" for i in range(count)]


class Points:
    """Arrays as psk_points; keeps them alive. All must be on the host, or all on one GPU."""

    def __init__(self, positions: Any, normals: Any = None, attributes: Optional[Mapping[str, Any]] = None,
                 origin: Any = (0.0, 0.0, 0.0)):
        self.inputs: List[Input] = [table(positions, "points")]
        self.names: List[bytes] = []
        self.value = _c.psk_points(size=ctypes.sizeof(_c.psk_points))
        self.value.positions = self.inputs[0].c_array()
        if normals is not None:
            self._check(table(normals, "normals"), "normals")
            self.value.normals = self.inputs[-1].c_array()
        columns: List[_c.psk_attribute] = []
        for name, values in (attributes or {}).items():
            columns += self._columns(name, values)
        self._list = (_c.psk_attribute * len(columns))(*columns)
        self.value.attributes = ctypes.cast(self._list, ctypes.POINTER(_c.psk_attribute))
        self.value.attribute_count = len(columns)
        self.value.origin[:] = [float(value) for value in origin]

    def _check(self, found: Input, what: str) -> None:
        first = self.inputs[0]
        if found.rows != first.rows:
            raise UsageError(f"{what} must be as many as the points, {first.rows}, not {found.rows}")
        if found.gpu != first.gpu:
            raise UsageError(f"{what} must be where the points are: all on the host, or all on one GPU")
        self.inputs.append(found)

    def _columns(self, name: str, values: Any) -> List[_c.psk_attribute]:
        mask = getattr(values, "mask", None)
        whole = taken(values.data if isinstance(values, np.ma.MaskedArray) else values, f"the attribute {name!r}")
        self._check(whole, f"the attribute {name!r}")
        if len(whole.shape) > 2:
            raise UsageError(f"the attribute {name!r} must have the shape (n,) or (n, k), not {whole.shape}")
        parts = [whole] if len(whole.shape) == 1 else [whole.column(i) for i in range(whole.shape[1])]
        missing = None
        if isinstance(mask, np.ndarray) and mask.any():
            missing = np.ascontiguousarray(mask.reshape(whole.rows, -1).any(axis=1), dtype=np.uint8)
            self.inputs.append(taken(missing, "a mask"))
        columns = []
        for part, label in zip(parts, split_names(str(name), len(parts))):
            self.inputs.append(part)
            self.names.append(label.encode())
            column = _c.psk_attribute(name=self.names[-1], values=part.c_array())
            if missing is not None and part.type[0] != "f":
                column.missing = ctypes.cast(missing.ctypes.data, ctypes.POINTER(ctypes.c_uint8))
            columns.append(column)
        return columns

    @property
    def gpu(self) -> int:
        return self.inputs[0].gpu

    @property
    def stream(self) -> Optional[int]:
        return next((found.stream for found in self.inputs if found.stream is not None), None)

    @property
    def _as_parameter_(self) -> Any:
        return ctypes.byref(self.value)


class Attributes(Mapping[str, Any]):
    """Scalars of points or vertices by name, each of shape (n,): arrays of the library's own memory, not copies. Where some
    integers are missing they are masked arrays. `rgb` and `rgba` join red, green and blue (and alpha) to a copy of shape
    (n, 3) or (n, 4); names such as color_0, color_1 join as color."""

    def __init__(self, owner: Any, count: int, get: Any, view: Any):
        self._found: Dict[str, Any] = {}
        for i in range(count):
            attribute = get(i)
            values = view(attribute.values)
            if attribute.missing and isinstance(values, np.ndarray):
                mask = np.ctypeslib.as_array(attribute.missing, shape=(attribute.values.rows,)).astype(bool)
                values = np.ma.MaskedArray(values, mask=mask)  # type: ignore[no-untyped-call]
            self._found[attribute.name.decode("utf-8", "replace")] = values
        self._owner = owner

    def _parts(self, name: str) -> List[str]:
        if name in _GROUPS:
            return [part for part in _GROUPS[name] if part in self._found]
        parts: List[str] = []
        while f"{name}_{len(parts)}" in self._found:
            parts.append(f"{name}_{len(parts)}")
        return parts

    def __getitem__(self, name: str) -> Any:
        if name in self._found:
            return self._found[name]
        parts = self._parts(name)
        if not parts or (name in _GROUPS and len(parts) != len(_GROUPS[name])):
            raise KeyError(f"{name!r}; there are {', '.join(self._found) or 'none'}")
        columns = [self._found[part] for part in parts]
        stack: Any = np.ma.stack if any(isinstance(column, np.ma.MaskedArray) for column in columns) else np.stack
        return stack(columns, axis=1)

    def __contains__(self, name: object) -> bool:
        try:
            self[str(name)]
        except KeyError:
            return False
        return True

    def __iter__(self) -> Iterator[str]:
        return iter(self._found)

    def __len__(self) -> int:
        return len(self._found)

    def __repr__(self) -> str:
        return f"<attributes {', '.join(self._found) or 'none'}>"


class CloudHandle(Handle):
    _free_name = "psk_cloud_free"


class Cloud:
    """Points on the host, with optional normals and attributes.

    points: shape (n, 3), world units, any type; doubles of large coordinates keep their digits (`origin`). Rows that are
    not finite are left out and counted in `dropped`. normals: shape (n, 3), outward, any length. attributes: name to
    shape (n,) or (n, k). origin: added to the points. The arrays are copied.
    Raises UsageError. O(n).
    """

    def __init__(self, points: Any, normals: Any = None, attributes: Optional[Mapping[str, Any]] = None, *,
                 origin: Any = (0.0, 0.0, 0.0), shift: Any = None, threads: int = 0):
        given = Points(points, normals, attributes, origin)
        if given.gpu >= 0:
            raise UsageError("a Cloud is on the host; reconstruct(), solve() and Fluid take arrays of a GPU as they are")
        self.handle = CloudHandle(make("psk_cloud_create", given, read_options(shift, threads)))
        #: What the last orient() did.
        self.report: Dict[str, Any] = {}

    @classmethod
    def _of(cls, pointer: int) -> "Cloud":
        cloud = cls.__new__(cls)
        cloud.handle, cloud.report = CloudHandle(pointer), {}
        return cloud

    def __len__(self) -> int:
        return int(library().psk_cloud_size(self.handle))

    @property
    def dropped(self) -> int:
        """Points that were left out because a coordinate was not finite."""
        return int(library().psk_cloud_dropped(self.handle))

    @property
    def origin(self) -> NumpyArray:
        """Shape (3,): what was taken off large coordinates."""
        three = (ctypes.c_double * 3)()
        library().psk_cloud_origin(self.handle, three)
        return np.array(three)

    @property
    def local_points(self) -> NumpyArray:
        """Shape (n, 3), float32, relative to `origin`; the cloud's own memory."""
        return host_view(self.handle, library().psk_cloud_positions(self.handle), 3)

    @property
    def points(self) -> NumpyArray:
        """Shape (n, 3), world units: the cloud's own float32 where the origin is zero, else a copy in float64."""
        origin = self.origin
        world: NumpyArray = self.local_points if not origin.any() else self.local_points + origin
        return world

    @property
    def normals(self) -> Optional[NumpyArray]:
        """Shape (n, 3), float32, the cloud's own memory; None without normals."""
        array = library().psk_cloud_normals(self.handle)
        return host_view(self.handle, array, 3) if array.data else None

    @property
    def attributes(self) -> Attributes:
        pointer = self.handle.pointer
        return Attributes(self.handle, library().psk_cloud_attribute_count(pointer),
                          lambda i: library().psk_cloud_attribute(pointer, i), lambda array: host_view(self.handle, array, 1))

    def save(self, path: "os.PathLike[str] | str", **options: Any) -> None:
        """Writes a file; the format follows the extension. Options: ascii, double_coordinates (PLY), threads.
        Raises OutputNotWrittenError."""
        call("psk_cloud_write", self.handle, encoded(path), write_options(options))

    def copy(self) -> "Cloud":
        return Cloud._of(make("psk_cloud_copy", self.handle))

    def merged(self, *more: "Cloud") -> "Cloud":
        """This one and others behind it. Attributes of one name become one; points that lack it have none."""
        whole = self.copy()
        for other in more:
            call("psk_cloud_merge", whole.handle, other.handle)
        return whole

    def keep(self, mask: Any) -> "Cloud":
        """The points where `mask`, shape (n,), is true. The others count as dropped."""
        flags = np.ascontiguousarray(np.asarray(mask, dtype=bool).astype(np.uint8))
        if flags.shape != (len(self),):
            raise UsageError(f"the mask must have the shape ({len(self)},), not {flags.shape}")
        kept = self.copy()
        call("psk_cloud_keep", kept.handle, flags.ctypes.data_as(ctypes.POINTER(ctypes.c_uint8)), len(flags))
        return kept

    def render(self, **options: Any) -> Any:
        """A picture; see pointskin.render()."""
        from .pictures import render
        return render(self, **options)

    def _repr_png_(self) -> bytes:
        return bytes(self.render(width=640, height=480).png())

    def to_open3d(self) -> Any:
        """An open3d.geometry.PointCloud, with normals and colours."""
        from .interop import cloud_to_open3d
        return cloud_to_open3d(self)

    @classmethod
    def from_open3d(cls, cloud: Any) -> "Cloud":
        from .interop import cloud_from_open3d
        return cloud_from_open3d(cloud)

    def to_pyvista(self) -> Any:
        """A pyvista.PolyData of points."""
        from .interop import cloud_to_pyvista
        return cloud_to_pyvista(self)

    def to_trimesh(self) -> Any:
        """A trimesh.PointCloud."""
        from .interop import cloud_to_trimesh
        return cloud_to_trimesh(self)

    def __getstate__(self) -> Tuple[Any, ...]:
        return (self.local_points, self.normals, dict(self.attributes), self.origin)

    def __setstate__(self, state: Tuple[Any, ...]) -> None:
        points, normals, attributes, origin = state
        Cloud.__init__(self, points, normals, attributes, origin=origin)

    def __repr__(self) -> str:
        parts = [f"{len(self)} points"] + ["normals"] * (self.normals is not None) + list(self.attributes)
        return f"<pointskin.Cloud of {', '.join(parts)}>"


def cloud_of(points: Any, normals: Any = None, attributes: Optional[Mapping[str, Any]] = None) -> Cloud:
    """A Cloud as it is, or one of arrays."""
    if isinstance(points, Cloud):
        if normals is not None or attributes is not None:
            raise UsageError("normals and attributes are those of the Cloud; make another one to change them")
        return points
    if points is None:
        raise InvalidInputError("there are no points")
    return Cloud(points, normals, attributes)
