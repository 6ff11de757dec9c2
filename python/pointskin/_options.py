"""Keyword arguments as the structs of C."""
from __future__ import annotations

import ctypes
import functools
from typing import Any, Dict, FrozenSet, List, Optional, Sequence, Tuple

import numpy as np

from . import _c
from ._library import encoded, struct
from .errors import UsageError

CHOICES: Dict[str, Tuple[str, ...]] = {
    "point_normals": ("auto", "given", "repair", "estimate"),
    "field": ("poisson", "distance"),
    "boundary": ("free", "dirichlet"),
    "domain_faces": ("closed", "open"),
    "method": ("auto", "sensor", "propagate", "iterate", "repair"),
    "kernel": ("isotropic", "anisotropic"),
    "up": ("y", "z", "x", "-x", "-y", "-z"),
    "colour_map": ("auto", "sequential", "diverging"),
    "operation": ("unite", "intersect", "subtract", "symmetric_difference"),
    "region": ("half_space", "ball", "box", "capsule", "points"),
}


def choice(name: str, value: Any) -> int:
    """The number of one of CHOICES. Raises UsageError, listing them."""
    words = CHOICES[name]
    if name == "boundary" and value == "neumann":
        value = "free"
    if value not in words:
        raise UsageError(f"{name} must be one of {', '.join(map(repr, words))}, not {value!r}")
    return words.index(value)


@functools.lru_cache(maxsize=None)
def _members(kind: Any) -> FrozenSet[str]:
    return frozenset(field[0] for field in kind._fields_) - {"size", "progress", "user"}


class Filled:
    """A struct of C with what its pointers point to. Given to a function as it is, all of it lives until the call returns."""

    def __init__(self, kind: Any, kept: Sequence[Any] = ()):
        self.value = struct(kind)
        self.kept: List[Any] = list(kept)

    def keep(self, thing: Any) -> Any:
        self.kept.append(thing)
        return thing

    def set(self, given: Dict[str, Any], what: str) -> "Filled":
        """Sets members by their names. Raises UsageError for a name that there is not, or a value of a wrong type."""
        names = _members(type(self.value))
        for name, value in given.items():
            if name not in names:
                raise UsageError(f"{what} has no option {name!r}; there are {', '.join(sorted(names))}")
            if name in CHOICES:
                value = choice(name, value)
            try:
                setattr(self.value, name, value)
            except (TypeError, ctypes.ArgumentError):
                raise UsageError(f"{name} must be a number, not {value!r}") from None
        return self

    @property
    def _as_parameter_(self) -> Any:  # what ctypes passes on
        return ctypes.byref(self.value)


def normal_options(given: Dict[str, Any], watch: Any = None) -> Filled:
    """psk_normal_options. `sensors`: shape (k, 3)."""
    given = dict(given)
    sensors = given.pop("sensors", None)
    filled = Filled(_c.psk_normal_options)
    if sensors is not None:
        places = np.ascontiguousarray(np.asarray(sensors, dtype=np.float64).reshape(-1, 3))
        filled.keep(places)
        filled.value.sensors = ctypes.cast(places.ctypes.data, ctypes.POINTER(ctypes.c_double))
        filled.value.sensor_count = len(places)
    if watch is not None:
        filled.value.progress = filled.keep(watch.function)
    return filled.set(given, "orient")


def run_options(given: Dict[str, Any], watch: Any = None) -> Filled:
    """psk_options. Some members have other forms here: depth and trim may be "auto", isovalue None, envelope a Mesh,
    normal_estimation a dict, max_memory is in bytes."""
    given = dict(given)
    filled = Filled(_c.psk_options)
    options = filled.value
    if given.get("depth") == "auto":
        given["depth"] = 0
    if given.get("trim") == "auto":
        given["trim"] = -1.0
    isovalue = given.pop("isovalue", None)
    if isovalue is not None:
        options.has_isovalue, options.isovalue = 1, isovalue
    envelope = given.pop("envelope", None)
    if envelope is not None:
        options.envelope = filled.keep(envelope).handle.pointer
    estimation: Optional[Dict[str, Any]] = given.pop("normal_estimation", None)
    if estimation is not None:
        normals = filled.keep(normal_options(estimation))
        options.normal_estimation = ctypes.pointer(normals.value)
    if "max_memory" in given:
        given["max_memory_bytes"] = given.pop("max_memory")
    if watch is not None:
        options.progress = filled.keep(watch.function)
    return filled.set(given, "reconstruct")


def read_options(shift: Any, threads: int) -> Filled:
    """psk_read_options. shift: None for the automatic one, or three numbers."""
    filled = Filled(_c.psk_read_options)
    if shift is not None:
        three = (ctypes.c_double * 3)(*np.asarray(shift, dtype=np.float64).reshape(3))
        filled.value.shift = ctypes.cast(filled.keep(three), ctypes.POINTER(ctypes.c_double))
    filled.value.threads = threads
    return filled


def write_options(given: Dict[str, Any]) -> Filled:
    return Filled(_c.psk_write_options).set(given, "save")


def render_options(given: Dict[str, Any]) -> Filled:
    """psk_render_options. projection: "perspective" or "orthographic"; fit: "box" or "sphere"."""
    given = dict(given)
    filled = Filled(_c.psk_render_options)
    for name, (word, count) in {"target": ("target", 3), "fit_world": ("fit_world", 6), "range": ("range", 2)}.items():
        values = given.pop(name, None)
        if values is not None:
            numbers = (ctypes.c_double * count)(*np.asarray(values, dtype=np.float64).reshape(count))
            setattr(filled.value, word, ctypes.cast(filled.keep(numbers), ctypes.POINTER(ctypes.c_double)))
    colour_by = given.pop("colour_by", None)
    if colour_by is not None:
        filled.value.colour_by = filled.keep(encoded(colour_by))
    for name, member, words in (("projection", "orthographic", ("perspective", "orthographic")), ("fit", "fit_sphere", ("box", "sphere"))):
        if name in given:
            value = given.pop(name)
            if value not in words:
                raise UsageError(f"{name} must be one of {words}, not {value!r}")
            given[member] = words.index(value)
    return filled.set(given, "render")


def as_dict(value: Any, skip: Sequence[str] = ("size",)) -> Dict[str, Any]:
    """The members of a report."""
    out: Dict[str, Any] = {}
    for field in value._fields_:
        if field[0] not in skip:
            member = getattr(value, field[0])
            out[field[0]] = list(member) if isinstance(member, ctypes.Array) else member
    return out
