"""A vector of WIDTH doubles as one value: lane code reads like scalar code and runs on whole vector registers.

Compiled, a vector is one of LLVM (`compiled`); as plain Python it is a numpy array of WIDTH numbers, with the
same operators and the same bits.  No operation mixes lanes but `some` and `note`, so that what a lane gets does not
depend on its neighbours.
"""

from __future__ import annotations

import ctypes
import sys
from functools import cache
from typing import Any

import numpy as np

from rockcli.kernels import jit as door
from rockcli.kernels.lanes.vector import WIDTH


def room(n: int) -> Any:
    """Work space of n numbers that begins where a register's worth of memory does: no load straddles two lines."""
    memory = np.zeros(n + 8)
    begin = (-memory.ctypes.data // 8) % 8
    return memory[begin : begin + n]


def load(array: Any, i: int) -> Any:
    """Elements i ... i + WIDTH - 1 of a contiguous array of floats."""
    return array[i : i + WIDTH].copy()


def store(array: Any, i: int, value: Any) -> None:
    """Write a vector to elements i ... i + WIDTH - 1 of a contiguous array."""
    array[i : i + WIDTH] = value


def spread(x: float) -> Any:
    """A number in every lane."""
    return np.full(WIDTH, x)


def select(where: Any, a: Any, b: Any) -> Any:
    """a where it is so, else b; either may be a number."""
    return np.where(where, a, b)


def some(where: Any) -> bool:
    """Whether it is so in any lane."""
    return bool(where.any())


def sqrt(x: Any) -> Any:
    """Square root, rounded correctly."""
    return np.sqrt(x)


def bits_of(x: Any) -> Any:
    """The bits of each number read as an integer, as a float."""
    return x.view(np.int64).astype(np.float64)


def from_bits(x: Any) -> Any:
    """The number whose bits, read as an integer, are x cut to an integer."""
    return x.astype(np.int64).view(np.float64)


def fma(a: Any, b: Any, c: Any) -> Any:
    """a b + c rounded once; each a vector or a number."""
    found = _fused()(a, b, c)
    return found.astype(np.float64) if isinstance(found, np.ndarray) else found


@cache
def _fused() -> Any:
    """The system's function, over arrays."""
    system = ctypes.CDLL("ucrtbase" if sys.platform == "win32" else None).fma
    system.argtypes, system.restype = [ctypes.c_double] * 3, ctypes.c_double
    return np.frompyfunc(system, 3, 1)


def gather(array: Any, index: Any, offset: int) -> Any:
    """The elements of a contiguous array so far behind those that a vector of whole numbers names."""
    return array[index.astype(np.int64) + offset]


def fetch(array: Any, i: int) -> None:
    """Have the memory of element i of a contiguous array brought near before it is used."""


def note(where: Any, first: float, array: Any, n: int) -> int:
    """Append first + lane to array[n], array[n + 1], ... for the lanes where it is so; the new n."""
    lanes = np.flatnonzero(where)
    array[n : n + len(lanes)] = first + lanes
    return n + len(lanes)


if door.compiling():
    from rockcli.kernels.lanes.vector import compiled

    for _name in (
        "load", "store", "spread", "select", "some", "sqrt", "bits_of", "from_bits", "fma", "gather", "fetch", "note",
    ):  # fmt: skip
        globals()[_name] = getattr(compiled, _name)
