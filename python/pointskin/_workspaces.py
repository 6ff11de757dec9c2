"""Where work is done: a workspace a device and thread, made when it is first needed."""
from __future__ import annotations

import threading
from typing import Any, Dict, List, Optional, Tuple

from ._library import Handle, call, encoded, library, make
from .errors import UsageError


class _Reconstructor(Handle):
    _free_name = "psk_reconstructor_free"


class Workspace(Handle):
    """A device with a stream and a pool of memory that is used again from run to run.

    Functions make one for themselves, for every thread and device; pass one as `device=` where several objects are to
    share it, or to work on a stream of your own. Calls in one workspace wait for each other.

    device: "auto" (the first GPU if one answers, else the CPU), "cpu", "cuda", "cuda:N", or several GPUs as one:
    "cuda:N,M", "cuda:all". threads: of the CPU, 0: all.
    stream: a cudaStream_t as an int, or an object with `cuda_stream` (torch) or `ptr` (cupy); None: one of its own.
    Raises DeviceUnavailableError, UsageError.
    """

    _free_name = "psk_workspace_free"

    def __init__(self, device: str = "auto", threads: int = 0, stream: Any = None):
        if stream is None:
            super().__init__(make("psk_workspace_create", encoded(device), threads))
        else:
            number = device.partition(":")[2] or "0"
            if not number.isdigit():
                raise UsageError(f"a stream belongs to one GPU; '{device}' is not cuda or cuda:N")
            gpu = int(number)
            super().__init__(make("psk_workspace_create_on_stream", gpu, stream_pointer(stream)))
        self.lock = threading.RLock()
        self._reconstructor: Optional[_Reconstructor] = None
        self._dead: List[Tuple[Any, int]] = []

    @property
    def gpu(self) -> int:
        """The GPU's number, of several as one the first's; -1 for the CPU."""
        return int(library().psk_workspace_gpu(self.pointer))

    @property
    def name(self) -> str:
        """Such as "NVIDIA H200" or "CPU, 2 threads"."""
        return str(library().psk_workspace_device_name(self.pointer).decode())

    @property
    def stream(self) -> int:
        """The cudaStream_t, 0 for the default stream and on the CPU."""
        return int(library().psk_workspace_stream(self.pointer) or 0)

    @property
    def held_bytes(self) -> int:
        """What all arrays hold now."""
        return int(library().psk_workspace_held_bytes(self.pointer))

    @property
    def reconstructor(self) -> int:
        if self._reconstructor is None:
            self._reconstructor = _Reconstructor(make("psk_reconstructor_create", self.pointer))
        return self._reconstructor.pointer

    def synchronize(self) -> None:
        """Waits until the stream's work is done."""
        with self.lock:
            call("psk_workspace_synchronize", self.pointer)

    def release_memory(self) -> None:
        """Gives memory that is kept for the next run back to the system."""
        with self.lock:
            library().psk_workspace_release_memory(self.pointer)

    def free_later(self, function: Any, pointer: int) -> None:
        """Frees an object whose memory is this workspace's: now, or when a call of another thread has ended."""
        self._dead.append((function, pointer))
        if self.lock.acquire(blocking=False):
            try:
                self.bury()
            finally:
                self.lock.release()

    def bury(self) -> None:
        """Frees what waits for it. Holds the lock."""
        while self._dead:
            function, pointer = self._dead.pop()
            function(pointer)

    def __enter__(self) -> "Workspace":
        self.lock.acquire()
        self.bury()
        return self

    def __exit__(self, *_: Any) -> None:
        self.bury()
        self.lock.release()

    def close(self) -> None:
        if getattr(self, "_pointer", None) is None:
            return
        self.bury()
        if self._reconstructor is not None:
            self._reconstructor.close()
        super().close()

    def __repr__(self) -> str:
        return f"<pointskin.Workspace on {self.name}>"


def stream_pointer(stream: Any) -> int:
    """The cudaStream_t of whatever stands for one."""
    for name in ("cuda_stream", "ptr", "handle"):
        value = getattr(stream, name, None)
        if value is not None:
            return int(value)
    return int(stream)


_threads = threading.local()


def workspace_for(device: Any = "auto", threads: int = 0, stream: Any = None) -> Workspace:
    """The calling thread's workspace on a device; `device` itself if it is one."""
    if isinstance(device, Workspace):
        return device
    pointer = None if stream is None else stream_pointer(stream)
    key = (str(device), threads, pointer)
    known: Dict[Any, Workspace] = _threads.__dict__.setdefault("workspaces", {})
    if key not in known:
        known[key] = Workspace(str(device), threads, pointer)
    return known[key]
