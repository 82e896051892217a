"""Numba's one door, and how the functions of the kernels come to be what they are: plain or compiled."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any, TypeVar, cast

from rockcli.kernels import ahead, places

F = TypeVar("F", bound=Callable[..., Any])

PLAIN, JUST_IN_TIME, AHEAD = "plain Python", "compiled just in time", "compiled ahead of time"
"""How kernels run."""

_way = PLAIN
_cached = False

entries: dict[str, tuple[Any, tuple[Any, ...], Any]] = {}
"""Just-in-time functions that Python calls, by name, with what they take and give."""


def decide(way: str, *, keep: bool = True) -> None:
    """Say, before a kernel module is imported, what becomes of its functions.

    What is compiled just in time is kept in the cache, if asked and if there is a place for it.  Without one numba
    would keep it beside the sources, where it does not notice that a callee in another file has changed.
    """
    global _way, _cached
    _way = way
    if way == JUST_IN_TIME:
        from numba import config

        _cached = keep and places.cache_takes_files()
        setattr(config, "CACHE_DIR", str(places.cache_dir()))  # noqa: B010 - the checker does not know it


def compiling() -> bool:
    """Whether functions are compiled as they are called."""
    return _way == JUST_IN_TIME


def ahead_of_time() -> bool:
    """Whether functions were compiled before they are called."""
    return _way == AHEAD


def is_cold() -> bool:
    """Whether nothing compiled just in time is in the cache."""
    return next(places.cache_dir().rglob("*.nbi"), None) is None


def jit(function: F, *, inlined: bool = False) -> F:
    """Compile a kernel, cached on disk, or leave it as it is.

    No fast-math: the same operations in the same order give the same bits compiled or not.  Other threads may run
    meanwhile, such as the one that hears an interrupt.  A kernel makes no arrays: those it is given are not counted, as
    that costs more than its work.
    """
    if not compiling():
        return function
    from numba import njit

    options: dict[str, Any] = {"cache": _cached, "error_model": "numpy", "nogil": True, "_nrt": False}
    options["forceinline"] = inlined
    compiled: Any = njit(**options)(function)
    if _cached:
        _forgive(compiled._cache)
    return cast(F, compiled)


def jit_part(function: F) -> F:
    """`jit` for a part of a loop, compiled into it: a call with so many arguments would take as long as its work."""
    return jit(function, inlined=True)


def entry(*takes: Any, gives: Any = None) -> Callable[[F], F]:
    """`jit` for a function that Python calls: only such a one can be compiled ahead of time, for these arguments.

    takes: bool, int, float, an `ahead.Array`, or a tuple of these, a class of named values among them; gives: a scalar.
    """

    def made(function: F) -> F:
        if _way == AHEAD:
            return cast(F, ahead.Entry(function, takes, gives))
        compiled = jit(function)
        if compiling():
            entries[ahead.name_of(function)] = compiled, takes, gives
        return compiled

    return made


def _forgive(cache: Any) -> None:
    """Let a kernel be used that cannot be kept, as the disk is full by now, or that was kept and is damaged."""
    load, save = cache.load_overload, cache.save_overload

    def load_if_whole(signature: Any, context: Any) -> Any:
        try:
            return load(signature, context)
        except Exception:  # whatever bytes that mean nothing make of the reader
            with contextlib.suppress(OSError):
                cache.flush()
            return None

    def save_if_possible(signature: Any, kernel: Any) -> None:
        with contextlib.suppress(Exception):  # a list of kernels that is damaged and cannot be replaced, too
            save(signature, kernel)

    cache.load_overload, cache.save_overload = load_if_whole, save_if_possible


def room(n: int) -> Any:
    """Work space of n numbers: an array for compiled code, a list (three times faster) for plain Python."""
    if _way == PLAIN:
        return [0.0] * n
    import numpy as np

    return np.zeros(n)


def rows(n_rows: int, n: int) -> Any:
    """The same in rows of n numbers each."""
    if _way == PLAIN:
        return [[0.0] * n for _ in range(n_rows)]
    import numpy as np

    return np.zeros((n_rows, n))
