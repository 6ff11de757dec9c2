"""Pictures of meshes and clouds, drawn on the CPU without any display, and cameras."""
from __future__ import annotations

import ctypes
import os
from typing import Any, Dict, Union

import numpy as np

from . import _c
from ._arrays import host_view, NumpyArray
from ._library import Handle, call, encoded, library, struct
from ._options import as_dict, render_options
from .errors import UsageError


class _ImageHandle(Handle):
    _free_name = "psk_image_free"


class Image:
    """An sRGB picture. `numpy.asarray(image)` is its pixels, shape (height, width, 3), uint8, rows from top to bottom."""

    def __init__(self, pointer: int, report: Any = None):
        self.handle = _ImageHandle(pointer)
        #: What is seen: covered, behind, low, high, point_size_world, strays.
        self.report: Dict[str, Any] = as_dict(report) if report is not None else {}

    @property
    def pixels(self) -> NumpyArray:
        width, height = ctypes.c_int32(), ctypes.c_int32()
        array = library().psk_image_pixels(self.handle, ctypes.byref(width), ctypes.byref(height))
        return host_view(self.handle, array, 3).reshape(height.value, width.value, 3)

    def __array__(self, dtype: Any = None, copy: Any = None) -> NumpyArray:
        return self.pixels if dtype is None else self.pixels.astype(dtype)

    def png(self) -> bytes:
        """The bytes of a PNG file."""
        data, count = ctypes.POINTER(ctypes.c_uint8)(), ctypes.c_int64()
        call("psk_image_png", self.handle, ctypes.byref(data), ctypes.byref(count))
        return ctypes.string_at(data, count.value)

    _repr_png_ = png

    def save(self, path: "Union[str, os.PathLike[str]]") -> None:
        """Writes a PNG, whatever the extension. Raises OutputNotWrittenError."""
        call("psk_image_write_png", self.handle, encoded(path))

    def __repr__(self) -> str:
        height, width, _ = self.pixels.shape
        return f"<pointskin.Image {width} x {height}>"


def pair(what: Any) -> Any:
    """Handles of a mesh and of a cloud, one of them None. Raises UsageError for anything else."""
    from .clouds import Cloud
    from .meshes import Mesh
    if isinstance(what, Mesh):
        return what.handle, None
    if isinstance(what, Cloud):
        return None, what.handle
    raise UsageError(f"a Mesh or a Cloud is needed, not {type(what).__name__}")


def render(what: Any, **options: Any) -> Image:
    """Draws a Mesh or a Cloud.

    Options: width, height (pixels), azimuth_degrees, elevation_degrees, target (3), up ("y", "z", "x", "-x", "-y", "-z"),
    projection ("perspective", "orthographic"), fit ("box", "sphere"), fit_world (6), zoom, field_of_view_degrees, smooth,
    back_faces, colours, shadows, wireframe, point_size, point_size_world, colour_by, range (2), colour_map ("auto",
    "sequential", "diverging"), colour_bar, threads: as in include/pointskin/render.hpp. Deterministic."""
    report = struct(_c.psk_render_report)
    filled = render_options(options)
    return Image(make_image(what, filled, report), report)


def make_image(what: Any, filled: Any, report: Any) -> int:
    image = ctypes.c_void_p()
    call("psk_render", *pair(what), filled, ctypes.byref(image), ctypes.byref(report))
    return image.value or 0


def camera(what: Any, **options: Any) -> Dict[str, Any]:
    """The camera of the picture that render() draws: view and projection, shape (4, 4), width and height. For
    EditSession."""
    found = _c.psk_camera()
    call("psk_camera_of", *pair(what), render_options(options), ctypes.byref(found))
    return {"view": np.array(found.view).reshape(4, 4), "projection": np.array(found.projection).reshape(4, 4),
            "width": found.width, "height": found.height}


