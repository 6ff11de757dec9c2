"""DLPack capsules, read and made without any library. Source: dmlc/dlpack, dlpack.h, version 0.8."""
from __future__ import annotations

import ctypes
from ctypes import c_char_p, c_int32, c_int64, c_uint16, c_uint64, c_uint8, c_void_p, py_object
from typing import Any, Dict, List, Optional, Tuple

CPU, CUDA = 1, 2
_KINDS = {0: "i", 1: "u", 2: "f"}
_CODES = {kind: code for code, kind in _KINDS.items()}


class _Tensor(ctypes.Structure):
    _fields_ = (("data", c_void_p), ("device_type", c_int32), ("device_id", c_int32), ("ndim", c_int32), ("code", c_uint8),
                ("bits", c_uint8), ("lanes", c_uint16), ("shape", ctypes.POINTER(c_int64)), ("strides", ctypes.POINTER(c_int64)),
                ("byte_offset", c_uint64))


class _Managed(ctypes.Structure):
    pass


_Deleter = ctypes.CFUNCTYPE(None, ctypes.POINTER(_Managed))
_Managed._fields_ = (("tensor", _Tensor), ("manager", c_void_p), ("deleter", _Deleter))

_api = ctypes.pythonapi
_capsule_new = _api.PyCapsule_New
_capsule_new.restype, _capsule_new.argtypes = py_object, (c_void_p, c_char_p, c_void_p)
_is_valid = ctypes.PYFUNCTYPE(c_int32, c_void_p, c_char_p)(("PyCapsule_IsValid", _api))
_pointer_of = ctypes.PYFUNCTYPE(c_void_p, c_void_p, c_char_p)(("PyCapsule_GetPointer", _api))
_set_name = ctypes.PYFUNCTYPE(c_int32, c_void_p, c_char_p)(("PyCapsule_SetName", _api))
_NAME, _USED = b"dltensor", b"used_dltensor"  # the names must outlive every capsule

#: What exported capsules keep alive, by the address of their tensor.
_exported: Dict[int, Tuple[Any, ...]] = {}


class Imported:
    """A tensor of another library, until it is closed."""

    def __init__(self, capsule: Any):
        address = id(capsule)
        if not _is_valid(address, _NAME):
            raise TypeError("not a DLPack capsule, or one that was used before")
        self._managed: Any = ctypes.cast(_pointer_of(address, _NAME), ctypes.POINTER(_Managed))
        _set_name(address, _USED)
        tensor = self._managed.contents.tensor
        if tensor.lanes != 1 or tensor.code not in _KINDS:
            self.close()
            raise TypeError(f"a tensor of type code {tensor.code} with {tensor.lanes} lanes cannot be read")
        self.device = (tensor.device_type, tensor.device_id)
        self.pointer = (tensor.data or 0) + tensor.byte_offset
        self.shape = tuple(tensor.shape[i] for i in range(tensor.ndim))
        self.typestr = f"<{_KINDS[tensor.code]}{tensor.bits // 8}"
        itemsize = tensor.bits // 8
        self.strides: Optional[Tuple[int, ...]] = None
        if tensor.strides:
            self.strides = tuple(tensor.strides[i] * itemsize for i in range(tensor.ndim))

    def close(self) -> None:
        managed, self._managed = self._managed, None
        if managed is not None and managed.contents.deleter:
            managed.contents.deleter(managed)

    def __del__(self) -> None:
        if getattr(self, "_managed", None) is not None:
            self.close()


def _drop(managed: Any) -> None:
    _exported.pop(ctypes.addressof(managed.contents), None)


_release = _Deleter(_drop)


def _drop_unused(capsule: int) -> None:
    if _is_valid(capsule, _NAME):  # nobody took it
        _exported.pop(_pointer_of(capsule, _NAME), None)


_forget = ctypes.CFUNCTYPE(None, c_void_p)(_drop_unused)


def export(owner: Any, pointer: int, shape: Tuple[int, ...], typestr: str, device: Tuple[int, int]) -> Any:
    """A capsule for a packed array that `owner` keeps alive."""
    managed = _Managed()
    sizes = (c_int64 * len(shape))(*shape)
    steps: List[int] = [1] * len(shape)
    for i in range(len(shape) - 2, -1, -1):
        steps[i] = steps[i + 1] * shape[i + 1]
    strides = (c_int64 * len(shape))(*steps)
    tensor = managed.tensor
    tensor.data, (tensor.device_type, tensor.device_id) = pointer, device
    tensor.ndim, tensor.shape, tensor.strides = len(shape), sizes, strides
    tensor.code, tensor.bits, tensor.lanes = _CODES[typestr[1]], 8 * int(typestr[2:]), 1
    managed.deleter = _release
    address = ctypes.addressof(managed)
    _exported[address] = (managed, sizes, strides, owner)
    return _capsule_new(address, _NAME, ctypes.cast(_forget, c_void_p))
