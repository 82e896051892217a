"""Where compiled kernels are kept: with the program, or in the user's cache."""

from __future__ import annotations

import hashlib
import os
import tempfile
from functools import cache
from pathlib import Path

HERE = Path(__file__).parent

INSTALLED = HERE / "objects"
"""Kernels compiled ahead of time that came with the program, in a folder named by the digest of their sources."""


def installed() -> Path:
    """The folder of these kernels that came with the program."""
    return INSTALLED / digest()


def cache_base() -> Path:
    """The user's cache: ROCK_CACHE_DIR, or the usual place."""
    return Path(
        os.environ.get("ROCK_CACHE_DIR")
        or os.path.join(os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache"), "rockcli")
    )


def cache_dir() -> Path:
    """The folder of these kernels in the user's cache."""
    return cache_base() / f"kernels-{digest()}"


def cache_takes_files() -> bool:
    """Whether compiled kernels can be kept."""
    try:
        cache_dir().mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=cache_dir()) as file:
            file.write(bytes(4096))
    except OSError:
        return False
    return True


@cache
def digest() -> str:
    """Of all kernel sources: what was compiled from others is not used, a callee in another file may have changed."""
    found = hashlib.sha256()
    for source in sorted(HERE.rglob("*.py")):
        found.update(source.read_bytes())
    return found.hexdigest()[:16]
