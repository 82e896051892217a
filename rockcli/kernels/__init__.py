"""Scalar physics: floats in, floats out; one source that runs compiled by numba or as plain Python.

Where the kernels were compiled ahead of time, with the program or by `rock cache --fill`, they need no compiler; else
they are compiled just in time, which costs half a second from a warm cache and far more from a cold one.  Little work
is done sooner by plain Python: `pays` knows from when on.  `load` is the only way in: it decides before the kernels are
first imported.
"""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Callable
from types import ModuleType

compiled: bool | None = None
"""Whether the kernels in use were loaded compiled; None before the first `load`."""

announce: Callable[[str], None] | None = None
"""Told when kernels are about to be compiled of which nothing is in the cache."""

COMPILING = "compiling the kernels, once: 15 to 60 s (`rock cache --fill` does it beforehand)"
COMPILING_ALWAYS = "compiling the kernels: 15 to 60 s in every run, as there is no place to keep them (ROCK_CACHE_DIR)"

COMPILE_ABOVE = 2.0
"""Work for plain Python above which kernels are compiled just in time [s]."""

LOAD_ABOVE = 0.1
"""Work for plain Python above which kernels compiled ahead of time are loaded [s]: about what that takes."""

ENTRIES = (
    "lanes.records.slipping", "lanes.records.vertical", "lanes.records.march", "contact.march", "lanes.pulses.march",
    "column.automaton", "rolling.march", "rigid.march", "frame.march", "frame.newmark", "frame.elements",
    "lanes.records.layout", "reading.decimals", "reading.peaks",
)  # fmt: skip
"""Modules with functions that Python calls, those first that take long to compile."""


def load(name: str = "rigid.march", *, compile_them: bool) -> ModuleType:
    """A module of kernels by its name below this package, compiled if asked; once compiled, so for the process's life.

    The environment variable ROCK_KERNELS overrules the caller: interpreted, compiled, or compiled in one way only, jit
    or ahead.

    Raises:
        ImportError: kernels compiled ahead of time are demanded, and there are none for this machine.
    """
    global compiled
    word = os.environ.get("ROCK_KERNELS", "")
    wish = {"compiled": True, "jit": True, "ahead": True, "interpreted": False}.get(word, compile_them)
    if compiled is None or (wish and not compiled):
        jit = importlib.import_module(f"{__name__}.jit")
        way = _way(word) if wish else jit.PLAIN
        forget()
        compiled = wish
        jit.decide(way)
        if way == jit.JUST_IN_TIME and announce is not None and jit.is_cold():
            announce(COMPILING if jit.places.cache_takes_files() else COMPILING_ALWAYS)
    return importlib.import_module(f"{__name__}.{name}")


def in_use_ahead(name: str) -> ModuleType | None:
    """A module of kernels by its name if those in use were compiled ahead of time; None: none are loaded for it."""
    jit = sys.modules.get(f"{__name__}.jit")
    return (
        importlib.import_module(f"{__name__}.{name}") if compiled and jit is not None and jit.ahead_of_time() else None
    )


def pays(seconds: float) -> bool:
    """Whether kernels had better be compiled, or are, for work that takes plain Python about so long [s]."""
    return bool(compiled) or seconds > COMPILE_ABOVE or (seconds > LOAD_ABOVE and compiled_ahead())


def compiled_ahead() -> bool:
    """Whether kernels that are loaded compiled are there already, so that nobody waits for a compiler."""
    word = os.environ.get("ROCK_KERNELS", "")
    return word not in ("interpreted", "jit") and importlib.import_module(f"{__name__}.ahead").objects() is not None


def _way(word: str) -> str:
    """How kernels are to be compiled that ROCK_KERNELS says this of."""
    jit = importlib.import_module(f"{__name__}.jit")
    there = compiled_ahead()
    if word == "ahead" and not there:
        raise ImportError(
            "ROCK_KERNELS is ahead, and no kernels of this version were compiled ahead of time for "
            f"{jit.ahead.level()}; `rock cache --fill` does it"
        )
    return str(jit.AHEAD if there else jit.JUST_IN_TIME)


KEPT = ("jit", "ahead", "places")


def forget() -> None:
    """Have every kernel imported anew, as it is decided at import whether it is compiled."""
    global compiled
    kept = {f"{__name__}.{name}" for name in KEPT}
    for name in [name for name in sys.modules if name.startswith(f"{__name__}.") and name not in kept]:
        parent, _, child = name.rpartition(".")
        if parent in sys.modules:  # or `from parent import child` would find the old one
            vars(sys.modules[parent]).pop(child, None)
        del sys.modules[name]
    compiled = None
