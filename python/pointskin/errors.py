"""Exceptions, one a kind of failure, and the category of warnings."""
from __future__ import annotations

from typing import Dict, Type


class PointskinError(Exception):
    """Anything that went wrong. `code` is the exit code that the program has for it."""

    code: int = 1


class UsageError(PointskinError, ValueError):
    """An argument or option outside of its range."""

    code = 2


class InvalidInputError(PointskinError, ValueError):
    """A file or an array that is not what it claims to be."""

    code = 3


class NoNormalsError(PointskinError, ValueError):
    """Points without usable normals."""

    code = 4


class EmptyResultError(PointskinError):
    """Nothing to reconstruct, or a surface without triangles."""

    code = 5


class OverLimitError(PointskinError, MemoryError):
    """More memory or more indices than allowed."""

    code = 6


class DeviceUnavailableError(PointskinError, RuntimeError):
    """The device that was asked for does not exist, or failed."""

    code = 7


class OutputNotWrittenError(PointskinError, OSError):
    """The output could not be written; nothing was replaced."""

    code = 8


class CancelledError(PointskinError):
    """`progress` returned False."""

    code = 130


class LibraryNotFoundError(PointskinError, ImportError):
    """The shared library libpointskin.so.0 is not where it is looked for."""


class PointskinWarning(UserWarning):
    """What should be looked at: points that were left out, normals that contradict each other, a depth too coarse."""


_BY_CODE: Dict[int, Type[PointskinError]] = {
    kind.code: kind
    for kind in (UsageError, InvalidInputError, NoNormalsError, EmptyResultError, OverLimitError, DeviceUnavailableError,
                 OutputNotWrittenError, CancelledError)
}


def error_of(code: int, message: str) -> PointskinError:
    """The exception for a code of the library."""
    return _BY_CODE.get(code, PointskinError)(message)
