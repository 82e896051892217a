"""numba's one door."""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])

_compiled = False
_cached = False


def decide(compile_them: bool) -> None:
    """Say, before a kernel module is imported, whether its functions are to be compiled.

    What is compiled is kept in the cache, if there is a place for it.  Without one numba would keep it beside the
    sources, where it does not notice that a callee in another file has changed.
    """
    global _compiled, _cached
    _compiled = compile_them
    if compile_them:
        from numba import config

        _cached = cache_takes_files()
        setattr(config, "CACHE_DIR", str(_cache_dir()))  # noqa: B010 - the checker does not know it


def compiling() -> bool:
    """What was decided."""
    return _compiled


def cache_takes_files() -> bool:
    """Whether compiled kernels can be kept."""
    try:
        _cache_dir().mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=_cache_dir()) as file:
            file.write(bytes(4096))
    except OSError:
        return False
    return True


def is_cold() -> bool:
    """Whether nothing compiled is in the cache."""
    return next(_cache_dir().rglob("*.nbi"), None) is None


def jit(function: F) -> F:
    """Compile a kernel, cached on disk, or leave it as it is.

    No fast-math: the same operations in the same order give the same bits compiled or not.  Other threads may run
    meanwhile, such as the one that hears an interrupt.
    """
    return _compile(function)


def jit_lean(function: F) -> F:
    """`jit` for a kernel that makes no arrays: those it is given are not counted, as that costs more than its work."""
    return _compile(function, _nrt=False)


def _compile(function: F, **options: Any) -> F:
    if not _compiled:
        return function
    from numba import njit

    compiled = njit(cache=_cached, error_model="numpy", nogil=True, **options)(function)
    if _cached:
        _forgive(compiled._cache)
    return cast(F, compiled)


def _forgive(cache: Any) -> None:
    """Let a kernel that cannot be kept, as the disk is full by now, be used all the same."""
    save = cache.save_overload

    def save_if_possible(signature: Any, kernel: Any) -> None:
        with contextlib.suppress(OSError):
            save(signature, kernel)

    cache.save_overload = save_if_possible


def room(n: int) -> Any:
    """Work space of n numbers: an array for compiled code, a list (three times faster) for plain Python."""
    if not _compiled:
        return [0.0] * n
    import numpy as np

    return np.zeros(n)


def _cache_dir() -> Path:
    """A folder named by all kernel sources: numba does not notice an edit in a callee of another file."""
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.rglob("*.py")):
        digest.update(source.read_bytes())
    base = os.environ.get("ROCK_CACHE_DIR") or os.path.join(
        os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache"), "rockcli"
    )
    return Path(base) / f"kernels-{digest.hexdigest()[:16]}"
