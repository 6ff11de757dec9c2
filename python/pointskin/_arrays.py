"""Arrays of other libraries as the library of Pointskin takes them, and its own as they take them."""
from __future__ import annotations

import ctypes
import sys
from typing import TYPE_CHECKING, Any, Dict, Optional, Tuple

import numpy as np

from . import _c, _dlpack
from .errors import UsageError

if TYPE_CHECKING:
    NumpyArray = np.ndarray[Any, Any]
else:
    NumpyArray = np.ndarray

_TYPES = {"i1": _c.PSK_INT8, "u1": _c.PSK_UINT8, "i2": _c.PSK_INT16, "u2": _c.PSK_UINT16, "i4": _c.PSK_INT32,
          "u4": _c.PSK_UINT32, "i8": _c.PSK_INT64, "u8": _c.PSK_UINT64, "f4": _c.PSK_FLOAT32, "f8": _c.PSK_FLOAT64}
_NAMES = {number: name for name, number in _TYPES.items()}


def _packed(shape: Tuple[int, ...], size: int) -> Tuple[int, ...]:
    """Strides in bytes of an array whose last index runs fastest."""
    strides = []
    for extent in reversed(shape):
        strides.append(size)
        size *= extent
    return tuple(reversed(strides))


class Input:
    """An array that was passed in: where it is, its shape and strides, and what keeps it alive."""

    def __init__(self, owner: Any, pointer: int, shape: Tuple[int, ...], strides: Optional[Tuple[int, ...]], typestr: str,
                 gpu: int = -1, stream: Optional[int] = None):
        self.owner, self.pointer, self.shape, self.gpu, self.stream = owner, pointer, shape, gpu, stream
        self.type = typestr[1:]
        self.strides = _packed(shape, int(typestr[2:])) if strides is None else strides

    @property
    def rows(self) -> int:
        return self.shape[0] if self.shape else 0

    def column(self, index: int) -> "Input":
        """One column of a table, without a copy."""
        return Input(self.owner, self.pointer + index * self.strides[1], self.shape[:1], self.strides[:1], f"<{self.type}",
                     self.gpu, self.stream)

    def c_array(self) -> _c.psk_array:
        """As C has it. It must not outlive this object."""
        array = _c.psk_array()
        array.data = self.pointer if self.rows > 0 else None
        array.rows = self.rows
        array.components = self.shape[1] if len(self.shape) > 1 else 1
        array.row_stride = self.strides[0] if self.strides else 0
        array.component_stride = self.strides[1] if len(self.strides) > 1 else int(self.type[1:])
        array.type = _TYPES[self.type]
        array.memory = _c.PSK_DEVICE if self.gpu >= 0 else _c.PSK_HOST
        return array


def _of_numpy(values: NumpyArray, what: str) -> Input:
    kind = values.dtype.kind + str(values.dtype.itemsize)
    if values.dtype.kind == "b":
        values, kind = values.astype(np.uint8), "u1"
    elif kind == "f2":
        values, kind = values.astype(np.float32), "f4"
    if kind not in _TYPES:
        raise UsageError(f"{what} must be numbers, not {values.dtype}")
    if not values.dtype.isnative:
        values = values.astype(values.dtype.newbyteorder("="))
    return Input(values, values.ctypes.data, values.shape, values.strides, f"<{kind}")


def _of_cuda_interface(values: Any, described: Dict[str, Any], what: str) -> Input:
    typestr = described["typestr"]
    if typestr[0] == ">" and sys.byteorder == "little" or typestr[1:] not in _TYPES:
        raise UsageError(f"{what} must be numbers of this machine, not {typestr}")
    if described.get("mask") is not None:
        raise UsageError(f"{what} must not have a mask")
    pointer = described["data"][0]
    stream = described.get("stream")
    stream = _stream_of_framework(values) if stream is None else {1: 0, 2: 2}.get(stream, stream)
    return Input(values, pointer, tuple(described["shape"]), described.get("strides"), typestr, _gpu_of(values), stream)


def _gpu_of(values: Any) -> int:
    device = getattr(values, "__dlpack_device__", None)
    if device is not None:
        kind, index = device()
        if kind == _dlpack.CUDA:
            return int(index)
    index = getattr(getattr(values, "device", None), "id", 0)
    return int(index) if isinstance(index, int) else 0


def _stream_of_framework(values: Any) -> Optional[int]:
    """The stream that the array's library works on now."""
    module = sys.modules.get(type(values).__module__.split(".")[0])
    name = getattr(module, "__name__", "")
    if name == "torch":
        return int(module.cuda.current_stream(values.device).cuda_stream)  # type: ignore[union-attr]
    if name == "cupy":
        return int(module.cuda.get_current_stream().ptr)  # type: ignore[union-attr]
    return None


def _of_dlpack(values: Any, what: str) -> Input:
    tensor = _dlpack.Imported(values.__dlpack__())
    if tensor.typestr[1:] not in _TYPES:
        raise UsageError(f"{what} must be numbers, not {tensor.typestr}")
    kind, index = tensor.device
    if kind not in (_dlpack.CPU, _dlpack.CUDA):
        raise UsageError(f"{what} must be in the memory of the host or of a CUDA device, not of DLPack's device type {kind}")
    gpu = index if kind == _dlpack.CUDA else -1
    return Input((values, tensor), tensor.pointer, tensor.shape, tensor.strides, tensor.typestr, gpu,
                 _stream_of_framework(values) if gpu >= 0 else None)


def taken(values: Any, what: str) -> Input:
    """Whatever is an array: `__cuda_array_interface__`, `__dlpack__`, `__array_interface__`, the buffer protocol, lists.

    Nothing is copied where the numbers have a type that the library knows. Raises UsageError."""
    if getattr(values, "requires_grad", False):
        values = values.detach()
    described = getattr(values, "__cuda_array_interface__", None)
    if described is not None:
        return _of_cuda_interface(values, described, what)
    if isinstance(values, np.ndarray):
        return _of_numpy(values, what)
    if hasattr(values, "__dlpack__"):
        return _of_dlpack(values, what)
    try:
        return _of_numpy(np.asarray(values), what)
    except (TypeError, ValueError) as error:
        raise UsageError(f"{what} must be an array of numbers: {error}") from None


def table(values: Any, what: str, columns: int = 3) -> Input:
    """The same, of shape (n, columns). Raises UsageError for any other shape."""
    found = taken(values, what)
    if found.shape == (0,):
        found.shape, found.strides = (0, columns), (columns, 1)
    if len(found.shape) != 2 or found.shape[1] != columns:
        raise UsageError(f"{what} must have the shape (n, {columns}), not {found.shape}")
    return found


class _View:
    """Memory of the library, for numpy; keeps its owner alive."""

    def __init__(self, owner: Any, array: _c.psk_array, components: int):
        self.owner = owner
        shape = (array.rows,) if components == 1 else (array.rows, components)
        self.__array_interface__ = {"shape": shape, "typestr": f"<{_NAMES[array.type]}", "data": (array.data, False), "version": 3}


class DeviceArray:
    """Numbers in the memory of a GPU, shape (n, 3) or (n,). Goes to torch, cupy and jax without a copy, by
    `__cuda_array_interface__` or `__dlpack__`, and lives as long as any of them has it.

    Ready in the order of `stream`; who takes it by DLPack on another stream waits for that one here."""

    def __init__(self, owner: Any, array: _c.psk_array, components: int, gpu: int, workspace: Any):
        self._owner, self._workspace, self._pointer = owner, workspace, array.data or 0
        self.shape = (array.rows,) if components == 1 else (array.rows, components)
        self.dtype = np.dtype(f"<{_NAMES[array.type]}")
        self.gpu, self.stream = gpu, workspace.stream

    def __len__(self) -> int:
        return int(self.shape[0])

    @property
    def nbytes(self) -> int:
        return int(np.prod(self.shape)) * self.dtype.itemsize

    @property
    def __cuda_array_interface__(self) -> Dict[str, Any]:
        return {"shape": self.shape, "typestr": self.dtype.str, "data": (self._pointer, False), "strides": None, "version": 3,
                "stream": self.stream or 1}

    def __dlpack_device__(self) -> Tuple[int, int]:
        return (_dlpack.CUDA, self.gpu)

    def __dlpack__(self, stream: Optional[int] = None, **_: Any) -> Any:
        if stream != -1 and {None: 0, 1: 0}.get(stream, stream) != self.stream:
            self._workspace.synchronize()
        return _dlpack.export(self, self._pointer, self.shape, self.dtype.str, self.__dlpack_device__())

    def __array__(self, dtype: Any = None, copy: Any = None) -> NumpyArray:
        raise TypeError("this array is in the memory of a GPU; take mesh.to_host() first, or torch.as_tensor(), cupy.asarray()")

    def __repr__(self) -> str:
        return f"<pointskin.DeviceArray {self.shape} {self.dtype} on GPU {self.gpu}>"


def host_view(owner: Any, array: _c.psk_array, components: Optional[int] = None) -> NumpyArray:
    """A numpy array over memory of the library, without a copy."""
    components = array.components if components is None else components
    if array.rows == 0 or not array.data:
        return np.empty((0,) if components == 1 else (0, components), dtype=np.dtype(f"<{_NAMES[array.type]}"))
    return np.asarray(_View(owner, array, components))


def doubles(values: Any, count: int, what: str) -> Any:
    """So many numbers, as C takes them. Raises UsageError."""
    flat = np.asarray(values, dtype=np.float64).reshape(-1)
    if flat.size != count:
        raise UsageError(f"{what} must be {count} numbers, not {flat.size}")
    return (ctypes.c_double * count)(*flat)
