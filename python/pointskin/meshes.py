"""Triangle meshes, on the host or on a GPU."""
from __future__ import annotations

import ctypes
import os
from typing import Any, Callable, Dict, Mapping, Optional, Tuple, Union

import numpy as np

from . import _c
from ._arrays import DeviceArray, host_view, NumpyArray, table
from ._library import Handle, call, encoded, library, make, struct
from ._options import as_dict, read_options, write_options
from ._workspaces import Workspace
from .clouds import Attributes, Cloud, Points
from .errors import UsageError

#: A report, or what makes it when it is asked for.
Report = Union[Dict[str, Any], Callable[[], Dict[str, Any]]]

Array = Union[NumpyArray, DeviceArray]


def measures_of(report: _c.psk_mesh_report) -> Dict[str, Any]:
    """What Mesh.measure() returns."""
    found = as_dict(report)
    found.update({name: bool(found[name]) for name in ("closed", "manifold", "oriented", "watertight")})
    return found


class MeshHandle(Handle):
    """A mesh, and the workspace whose memory it is in, if it is on a GPU."""

    _free_name = "psk_mesh_free"

    def __init__(self, pointer: int, workspace: Optional[Workspace] = None):
        super().__init__(pointer)
        self.workspace = workspace if workspace is not None and library().psk_mesh_gpu(pointer) >= 0 else None

    def close(self) -> None:
        pointer, self._pointer = getattr(self, "_pointer", None), None
        if pointer is None:
            return
        if self.workspace is not None:
            self.workspace.free_later(self._free, pointer)
        else:
            self._free(pointer)


class Mesh:
    """An indexed triangle mesh.

    vertices: shape (v, 3), world units. faces: shape (t, 3), integers in [0, v), counter-clockwise seen from outside.
    normals: shape (v, 3). attributes: name to shape (v,) or (v, k). The arrays are copied.
    Raises UsageError, InvalidInputError. O(v + t).
    """

    def __init__(self, vertices: Any, faces: Any, normals: Any = None, attributes: Optional[Mapping[str, Any]] = None, *,
                 origin: Any = (0.0, 0.0, 0.0), shift: Any = None, threads: int = 0):
        given, corners = Points(vertices, normals, attributes, origin), table(faces, "faces")
        if given.gpu >= 0 or corners.gpu >= 0:
            raise UsageError("a Mesh is made of arrays on the host")
        triangles = struct(_c.psk_triangles)
        triangles.vertices = ctypes.pointer(given.value)
        triangles.triangles = corners.c_array()
        self._take(make("psk_mesh_create", ctypes.byref(triangles), read_options(shift, threads)), None, {})

    def _take(self, pointer: int, workspace: Optional[Workspace], report: Report) -> None:
        self.handle = MeshHandle(pointer, workspace)
        self._report: Report = report
        self._world: Optional[NumpyArray] = None

    @classmethod
    def _of(cls, pointer: int, workspace: Optional[Workspace] = None, report: Optional[Report] = None) -> "Mesh":
        mesh = cls.__new__(cls)
        mesh._take(pointer, workspace, report or {})
        return mesh

    @property
    def report(self) -> Dict[str, Any]:
        """What the run that made the mesh did and cost; empty for meshes that were not made by one."""
        if not isinstance(self._report, dict):
            self._report = self._report()
        return self._report

    # ---- arrays

    @property
    def gpu(self) -> int:
        """The GPU that holds the mesh, -1 for the host."""
        return int(library().psk_mesh_gpu(self.handle))

    def _array(self, array: _c.psk_array, components: int) -> Array:
        if self.gpu < 0:
            return host_view(self.handle, array, components)
        return DeviceArray(self.handle, array, components, self.gpu, self.handle.workspace)

    @property
    def origin(self) -> NumpyArray:
        """Shape (3,): world position of a vertex is origin + local_vertices. Zero but for large coordinates."""
        three = (ctypes.c_double * 3)()
        library().psk_mesh_origin(self.handle, three)
        return np.array(three)

    @property
    def local_vertices(self) -> Array:
        """Shape (v, 3), float32, relative to `origin`; the mesh's own memory."""
        return self._array(library().psk_mesh_vertices(self.handle), 3)

    @property
    def vertices(self) -> Array:
        """Shape (v, 3), world units: the mesh's own float32 where the origin is zero, and on a GPU; else float64, made once."""
        local = self.local_vertices
        if isinstance(local, DeviceArray) or not self.origin.any():
            return local
        if self._world is None:
            self._world = local + self.origin
        return self._world

    @property
    def faces(self) -> Array:
        """Shape (t, 3), int32; the mesh's own memory."""
        return self._array(library().psk_mesh_triangles(self.handle), 3)

    triangles = faces

    @property
    def normals(self) -> Optional[Array]:
        """Shape (v, 3), float32, unit length, outward; None without normals."""
        array = library().psk_mesh_normals(self.handle)
        return self._array(array, 3) if array.rows else None

    @property
    def attributes(self) -> Attributes:
        pointer = self.handle.pointer
        return Attributes(self.handle, library().psk_mesh_attribute_count(pointer),
                          lambda i: library().psk_mesh_attribute(pointer, i), lambda array: self._array(array, 1))

    # ---- copies and files

    def to_host(self) -> "Mesh":
        """This mesh if it is on the host, else a copy there."""
        if self.gpu < 0:
            return self
        with self._busy():
            return Mesh._of(make("psk_mesh_to_host", self.handle), None, self._report)

    def _busy(self) -> Any:
        import contextlib
        return self.handle.workspace if self.handle.workspace is not None else contextlib.nullcontext()

    def copy(self) -> "Mesh":
        """A copy on the host."""
        with self._busy():
            return Mesh._of(make("psk_mesh_to_host", self.handle), None, self._report)

    def save(self, path: "os.PathLike[str] | str", **options: Any) -> None:
        """Writes a file; the format follows the extension. Options: ascii, double_coordinates (PLY), compress (GLB), threads.
        Raises OutputNotWrittenError."""
        with self._busy():
            call("psk_mesh_write", self.handle, encoded(path), write_options(options))

    def cloud(self) -> Cloud:
        """The vertices as a Cloud, with normals and attributes."""
        with self._busy():
            return Cloud._of(make("psk_mesh_cloud", self.handle))

    def with_normals(self) -> "Mesh":
        """A copy whose normals are the area-weighted means of the faces' around."""
        mesh = self.copy()
        call("psk_mesh_add_normals", mesh.handle)
        return mesh

    # ---- measures

    def measure(self, threads: int = 0) -> Dict[str, Any]:
        """Counts and measures: vertices, triangles, edges, components, euler, volume, area, closed, manifold, oriented,
        watertight and more. O(t log t)."""
        report = struct(_c.psk_mesh_report)
        with self._busy():
            call("psk_mesh_measure", self.handle, threads, ctypes.byref(report))
        return measures_of(report)

    @property
    def is_watertight(self) -> bool:
        """Closed, 2-manifold, oriented and not inside out."""
        return bool(self.measure()["watertight"])

    def self_intersections(self, threads: int = 0) -> Tuple[int, int]:
        """Pairs of triangles that meet elsewhere than in what they share, and how many of them only touch. Exact."""
        pairs, touching = ctypes.c_int64(), ctypes.c_int64()
        with self._busy():
            call("psk_mesh_self_intersections", self.handle, threads, ctypes.byref(pairs), ctypes.byref(touching))
        return pairs.value, touching.value

    def components(self, threads: int = 0) -> NumpyArray:
        """Shape (v,), int32: the connected piece of every vertex, -1 where no triangle uses it."""
        pieces = np.empty(len(self.local_vertices), dtype=np.int32)
        with self._busy():
            call("psk_mesh_components", self.handle, threads, pieces.ctypes.data_as(ctypes.POINTER(ctypes.c_int32)), None)
        return pieces

    # ---- pictures and other libraries

    def render(self, **options: Any) -> Any:
        """A picture; see pointskin.render()."""
        from .pictures import render
        return render(self, **options)

    def _repr_png_(self) -> bytes:
        return bytes(self.render(width=640, height=480).png())

    def show(self) -> Any:
        """Opens the studio on the vertices, in the browser, and returns its process. Raises PointskinError where the program
        or its studio is missing."""
        from .program import show
        return show(self)

    def to_open3d(self) -> Any:
        """An open3d.geometry.TriangleMesh, with normals and colours."""
        from .interop import mesh_to_open3d
        return mesh_to_open3d(self)

    @classmethod
    def from_open3d(cls, mesh: Any) -> "Mesh":
        from .interop import mesh_from_open3d
        return mesh_from_open3d(mesh)

    def to_trimesh(self) -> Any:
        """A trimesh.Trimesh, with vertex normals and colours, not processed."""
        from .interop import mesh_to_trimesh
        return mesh_to_trimesh(self)

    @classmethod
    def from_trimesh(cls, mesh: Any) -> "Mesh":
        from .interop import mesh_from_trimesh
        return mesh_from_trimesh(mesh)

    def to_pyvista(self) -> Any:
        """A pyvista.PolyData with all attributes as point data."""
        from .interop import mesh_to_pyvista
        return mesh_to_pyvista(self)

    @classmethod
    def from_pyvista(cls, mesh: Any) -> "Mesh":
        from .interop import mesh_from_pyvista
        return mesh_from_pyvista(mesh)

    def __getstate__(self) -> Tuple[Any, ...]:
        mesh = self.to_host()
        return (mesh.local_vertices, mesh.faces, mesh.normals, dict(mesh.attributes), mesh.origin, mesh.report)

    def __setstate__(self, state: Tuple[Any, ...]) -> None:
        vertices, faces, normals, attributes, origin, report = state
        Mesh.__init__(self, vertices, faces, normals, attributes, origin=origin)
        self._report = report

    def __len__(self) -> int:
        return int(library().psk_mesh_triangle_count(self.handle))

    def __repr__(self) -> str:
        where = f" on GPU {self.gpu}" if self.gpu >= 0 else ""
        vertices = library().psk_mesh_vertex_count(self.handle)
        return f"<pointskin.Mesh of {vertices} vertices, {len(self)} faces{where}>"
