"""Scalar physics: floats in, floats out; one source that runs compiled by numba or as plain Python.

Compiling costs half a second from a warm cache, so one case is faster uncompiled and a sweep compiled.
`load` is the only way in: it decides before the kernels are first imported.
"""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Callable
from types import ModuleType

_KERNELS = (
    "motion", "series", "roots", "decide", "rest", "watch", "contact", "march", "slide",
    "lane_math", "lane_vector", "lane_bounces", "lane_state", "lane_ground", "lane_series", "lane_roots", "lane_events",
    "lane_wakes", "lane_decide", "lane_pulses",
)  # fmt: skip

compiled: bool | None = None
"""How the kernels in use were loaded; None before the first `load`."""

announce: Callable[[str], None] | None = None
"""Told when kernels are about to be compiled of which nothing is in the cache."""

COMPILING = "compiling the kernels, once: about 15 s"
COMPILING_ALWAYS = "compiling the kernels: about 15 s in every run, as there is no place to keep them (ROCK_CACHE_DIR)"


def load(name: str = "march", *, compile_them: bool) -> ModuleType:
    """A module of kernels, compiled if asked.  Kernels once compiled stay so for the life of the process.

    The environment variable ROCK_KERNELS = compiled | interpreted overrules the caller.
    """
    global compiled
    wish = {"compiled": True, "interpreted": False}.get(os.environ.get("ROCK_KERNELS", ""), compile_them)
    if compiled is None or (wish and not compiled):
        for kernel in _KERNELS:
            sys.modules.pop(f"{__name__}.{kernel}", None)
        compiled = wish
        jit = importlib.import_module(f"{__name__}.jit")
        jit.decide(wish)
        if wish and announce is not None and jit.is_cold():
            announce(COMPILING if jit.cache_takes_files() else COMPILING_ALWAYS)
    return importlib.import_module(f"{__name__}.{name}")
