"""Finds and loads the shared library, when it is first needed, and calls it."""
from __future__ import annotations

import ctypes
import os
import pathlib
import threading
from typing import Any, List, Optional, Type, TypeVar

from . import _c
from .errors import LibraryNotFoundError, PointskinError, error_of

NAME = "libpointskin.so.0"
_lock = threading.Lock()
_loaded: Optional[ctypes.CDLL] = None
Struct = TypeVar("Struct", bound=ctypes.Structure)


def _candidates() -> List[str]:
    named = os.environ.get("POINTSKIN_LIBRARY")
    if named:
        return [named]
    here = pathlib.Path(__file__).resolve().parent
    return [str(path) for path in (here / NAME, here / "lib" / NAME) if path.exists()] + [NAME]


def _load() -> ctypes.CDLL:
    tried = []
    for candidate in _candidates():
        try:
            library = ctypes.CDLL(candidate)
            break
        except OSError as error:
            tried.append(str(error))
    else:
        raise LibraryNotFoundError(f"{NAME} cannot be loaded ({'; '.join(tried)}); install libpointskin0 or the wheel, "
                                   "or say where it is: POINTSKIN_LIBRARY=/path/to/libpointskin.so.0")
    library.psk_c_abi.restype = ctypes.c_int32
    if library.psk_c_abi() != 0:
        raise LibraryNotFoundError(f"{library._name} has another binary interface than this package; update both")
    for name, (result, arguments) in _c.FUNCTIONS.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


def library() -> Any:
    """The shared library. @raises LibraryNotFoundError"""
    global _loaded
    if _loaded is None:
        with _lock:
            if _loaded is None:
                _loaded = _load()
    return _loaded


def call(name: str, *arguments: Any) -> None:
    """Calls a function whose last parameter is the error, and raises what it says. The GIL is free meanwhile."""
    error = _c.psk_error()
    code = getattr(library(), name)(*arguments, ctypes.byref(error))
    if code != 0:
        raise error_of(code, error.message.decode("utf-8", "replace"))


def make(name: str, *arguments: Any) -> int:
    """Calls a function that makes a handle, by its last parameter but the error."""
    handle = ctypes.c_void_p()
    call(name, *arguments, ctypes.byref(handle))
    if handle.value is None:
        raise PointskinError(f"{name} made nothing")
    return handle.value


def struct(kind: Type[Struct]) -> Struct:
    """A struct with its defaults."""
    value = kind()
    call("psk_init", _c.KINDS[kind], ctypes.byref(value), ctypes.sizeof(value))
    return value


def encoded(path: Any) -> bytes:
    """A path as the system has it."""
    return os.fsencode(os.fspath(path))


class Handle:
    """Owns an object of the library, and frees it once. Given to a function as it is, it lives until the call returns."""

    _free_name = ""

    def __init__(self, pointer: int):
        self._pointer: Optional[int] = pointer
        self._free = getattr(library(), self._free_name)

    @property
    def pointer(self) -> int:
        if self._pointer is None:
            raise PointskinError("this object was closed")
        return self._pointer

    @property
    def _as_parameter_(self) -> ctypes.c_void_p:  # what ctypes passes on
        return ctypes.c_void_p(self.pointer)

    def close(self) -> None:
        """Frees it now. What was taken from it before must not be used any more."""
        pointer, self._pointer = getattr(self, "_pointer", None), None
        if pointer is not None:
            self._free(pointer)

    def __del__(self) -> None:
        self.close()
