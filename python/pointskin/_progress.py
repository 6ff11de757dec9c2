"""Progress, Ctrl-C and a bar."""
from __future__ import annotations

import signal
import sys
import threading
import time
from typing import Any, Callable, Optional, TextIO, Union

from . import _c

#: What `progress=` takes: a function of phase and share done, which may return False to cancel; True for a bar.
Progress = Union[None, bool, Callable[[str, float], Optional[bool]]]


class _Bar:
    """A line such as ` 43%|████▎     | solve [00:01<00:02]`, of a terminal or a notebook; elsewhere nothing."""

    WIDTH = 24
    PARTS = " ▏▎▍▌▋▊▉█"

    def __init__(self, out: Optional[TextIO] = None):
        self.out = out if out is not None else sys.stderr
        self.shown = _is_interactive(self.out)
        self.start = time.monotonic()
        self.drawn = 0

    def __call__(self, phase: str, fraction: float) -> None:
        if not self.shown:
            return
        eighths = int(round(fraction * self.WIDTH * 8))
        full, part = divmod(min(eighths, self.WIDTH * 8), 8)
        bar = ("█" * full + (self.PARTS[part] if part else "")).ljust(self.WIDTH)
        spent = time.monotonic() - self.start
        left = _clock(spent / fraction - spent) if fraction > 0.02 else "?"
        line = f"{fraction:4.0%}|{bar}| {phase} [{_clock(spent)}<{left}]"
        self.out.write("\r" + line.ljust(self.drawn))
        self.out.flush()
        self.drawn = len(line)

    def end(self) -> None:
        if self.shown and self.drawn:
            self.out.write("\r" + " " * self.drawn + "\r")
            self.out.flush()


def _is_interactive(out: Any) -> bool:
    return bool(getattr(out, "isatty", lambda: False)()) or type(out).__module__.startswith("ipykernel")


def _clock(seconds: float) -> str:
    return f"{int(seconds) // 60:02d}:{int(seconds) % 60:02d}"


class Watch:
    """The callback of a call: tells progress and notices Ctrl-C. Use as a context; exceptions of it are raised at its end.

    The library calls back a few times a run, between its steps, on the calling thread. Ctrl-C is noted by a handler of its
    own meanwhile, since an exception in the middle of a callback would be lost."""

    def __init__(self, progress: Progress):
        self.bar = _Bar() if progress is True else None
        self.tell = self.bar if progress is True else (progress if callable(progress) else None)
        self.error: Optional[BaseException] = None
        self.interrupted = False
        self._before: Any = None
        self.function = _c.psk_progress(self._called)

    def _called(self, phase: bytes, fraction: float, _user: Any) -> int:
        try:
            answer = self.tell(phase.decode(), fraction) if self.tell is not None else None
            return 0 if answer is False or self.interrupted else 1
        except BaseException as error:  # no exception may cross the library
            self.error = error
            return 0

    def _note(self, _number: int, _frame: Any) -> None:
        self.interrupted = True

    def __enter__(self) -> "Watch":
        self.error, self.interrupted, self._before = None, False, None
        if threading.current_thread() is threading.main_thread() and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            self._before = signal.signal(signal.SIGINT, self._note)
        return self

    def __exit__(self, kind: Any, error: Any, trace: Any) -> None:
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)
        if self.bar is not None:
            self.bar.end()
        if self.error is not None:
            raise self.error from None
        if self.interrupted:
            raise KeyboardInterrupt from None
