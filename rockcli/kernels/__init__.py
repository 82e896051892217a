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

compiled: bool | None = None
"""How the kernels in use were loaded; None before the first `load`."""

announce: Callable[[str], None] | None = None
"""Told when kernels are about to be compiled of which nothing is in the cache."""

COMPILING = "compiling the kernels, once: about 15 s"
COMPILING_ALWAYS = "compiling the kernels: about 15 s in every run, as there is no place to keep them (ROCK_CACHE_DIR)"


def load(name: str = "rigid.march", *, compile_them: bool) -> ModuleType:
    """A module of kernels by its name below this package, compiled if asked; once compiled, so for the process's life.

    The environment variable ROCK_KERNELS = compiled | interpreted overrules the caller.
    """
    global compiled
    wish = {"compiled": True, "interpreted": False}.get(os.environ.get("ROCK_KERNELS", ""), compile_them)
    if compiled is None or (wish and not compiled):
        jit = importlib.import_module(f"{__name__}.jit")
        forget()
        compiled = wish
        jit.decide(wish)
        if wish and announce is not None and jit.is_cold():
            announce(COMPILING if jit.cache_takes_files() else COMPILING_ALWAYS)
    return importlib.import_module(f"{__name__}.{name}")


def forget() -> None:
    """Have every kernel imported anew, as it is decided at import whether it is compiled."""
    global compiled
    for name in [name for name in sys.modules if name.startswith(f"{__name__}.") and name != f"{__name__}.jit"]:
        parent, _, child = name.rpartition(".")
        vars(sys.modules.get(parent, sys)).pop(child, None)  # or `from parent import child` would find the old one
        del sys.modules[name]
    compiled = None
