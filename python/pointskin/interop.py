"""Meshes and clouds of open3d, trimesh and pyvista. None of them is imported unless its function is called."""
from __future__ import annotations

from typing import Any, Dict, Optional

import numpy as np

from ._arrays import NumpyArray
from .clouds import Cloud
from .errors import UsageError
from .meshes import Mesh


def _library(name: str) -> Any:
    import importlib
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise UsageError(f"{name} is not installed: {error}") from None


def _shares(what: Any) -> Optional[NumpyArray]:
    """Colours as shares of 1, shape (n, 3); None without any."""
    if "rgb" not in what.attributes:
        return None
    colours = np.asarray(what.attributes["rgb"])
    largest = {np.dtype(np.uint8): 255.0, np.dtype(np.uint16): 65535.0}.get(colours.dtype, 1.0)
    shares: NumpyArray = np.clip(colours / largest, 0, 1)
    return shares


def _bytes(colours: Any) -> NumpyArray:
    """Shares of 1, or numbers up to 255, as uint8."""
    values = np.asarray(colours)
    if values.dtype == np.uint8:
        return values
    whole: NumpyArray = np.clip(np.rint(values * 255.0), 0, 255).astype(np.uint8)
    return whole


def _colour_attributes(colours: Any) -> Dict[str, Any]:
    values = np.asarray(colours)
    return {"rgb": _bytes(values)[:, :3]} if values.ndim == 2 and values.shape[0] else {}


# ---- open3d


def mesh_to_open3d(mesh: Mesh) -> Any:
    o3d = _library("open3d")
    mesh = mesh.to_host()
    made = o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(np.asarray(mesh.vertices, dtype=np.float64)),
                                     o3d.utility.Vector3iVector(np.asarray(mesh.faces)))
    if mesh.normals is not None:
        made.vertex_normals = o3d.utility.Vector3dVector(np.asarray(mesh.normals, dtype=np.float64))
    colours = _shares(mesh)
    if colours is not None:
        made.vertex_colors = o3d.utility.Vector3dVector(colours)
    return made


def mesh_from_open3d(mesh: Any) -> Mesh:
    normals = np.asarray(mesh.vertex_normals) if mesh.has_vertex_normals() else None
    colours = _colour_attributes(mesh.vertex_colors) if mesh.has_vertex_colors() else {}
    return Mesh(np.asarray(mesh.vertices), np.asarray(mesh.triangles), normals, colours)


def cloud_to_open3d(cloud: Cloud) -> Any:
    o3d = _library("open3d")
    made = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(np.asarray(cloud.points, dtype=np.float64)))
    if cloud.normals is not None:
        made.normals = o3d.utility.Vector3dVector(np.asarray(cloud.normals, dtype=np.float64))
    colours = _shares(cloud)
    if colours is not None:
        made.colors = o3d.utility.Vector3dVector(colours)
    return made


def cloud_from_open3d(cloud: Any) -> Cloud:
    normals = np.asarray(cloud.normals) if cloud.has_normals() else None
    colours = _colour_attributes(cloud.colors) if cloud.has_colors() else {}
    return Cloud(np.asarray(cloud.points), normals, colours)


# ---- trimesh


def mesh_to_trimesh(mesh: Mesh) -> Any:
    trimesh = _library("trimesh")
    mesh = mesh.to_host()
    colours = _shares(mesh)
    return trimesh.Trimesh(np.asarray(mesh.vertices), np.asarray(mesh.faces), vertex_normals=mesh.normals,
                           vertex_colors=None if colours is None else _bytes(colours), process=False)


def mesh_from_trimesh(mesh: Any) -> Mesh:
    visual = getattr(mesh, "visual", None)
    has_colours = getattr(visual, "kind", None) == "vertex"
    return Mesh(np.asarray(mesh.vertices), np.asarray(mesh.faces), np.asarray(mesh.vertex_normals),
                _colour_attributes(visual.vertex_colors) if visual is not None and has_colours else {})


def cloud_to_trimesh(cloud: Cloud) -> Any:
    trimesh = _library("trimesh")
    colours = _shares(cloud)
    return trimesh.PointCloud(np.asarray(cloud.points), colors=None if colours is None else _bytes(colours))


# ---- pyvista


def _with_point_data(made: Any, what: Any) -> Any:
    if what.normals is not None:
        made.point_data["Normals"] = np.asarray(what.normals)
    for name, values in what.attributes.items():
        made.point_data[name] = np.asarray(values)
    if "rgb" in what.attributes:
        made.point_data["RGB"] = np.asarray(what.attributes["rgb"])
    return made


def mesh_to_pyvista(mesh: Mesh) -> Any:
    pyvista = _library("pyvista")
    mesh = mesh.to_host()
    faces = np.asarray(mesh.faces)
    cells = np.hstack([np.full((len(faces), 1), 3, dtype=faces.dtype), faces])
    return _with_point_data(pyvista.PolyData(np.asarray(mesh.vertices), cells.ravel()), mesh)


def mesh_from_pyvista(mesh: Any) -> Mesh:
    triangles = mesh if mesh.is_all_triangles else mesh.triangulate()
    faces = np.asarray(triangles.faces).reshape(-1, 4)[:, 1:]
    data = {name: np.asarray(triangles.point_data[name]) for name in triangles.point_data.keys()}
    normals = data.pop("Normals", None)
    data.pop("RGB", None)
    return Mesh(np.asarray(triangles.points), faces, normals, {name: values for name, values in data.items() if values.ndim <= 2})


def cloud_to_pyvista(cloud: Cloud) -> Any:
    pyvista = _library("pyvista")
    return _with_point_data(pyvista.PolyData(np.asarray(cloud.points)), cloud)
