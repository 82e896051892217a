"""Kernels compiled ahead of time: which there are for this machine, and how they are called without the compiler.

An object file holds one function that Python calls, with all it needs, as `build` makes it.  LLVM's linker puts it into
memory.  The function takes pointers to its result and to an exception, then its arguments, laid out flat: an array as
two null pointers, its size, that of an element, its address, shape and strides; a tuple as what it holds.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import hashlib
import platform
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple, get_type_hints

from rockcli.kernels import places

PACKAGE = __name__.rpartition(".")[0]

_DIGEST = hashlib.sha256().digest_size
"""Size of the digest behind the code in the file of an object [bytes]."""


class Array(NamedTuple):
    """An array of doubles, or of another kind of number by its name in numpy, last index fastest, as an argument."""

    ndim: int
    of: str = "float64"


VECTOR, MATRIX, CUBE, TABLES = Array(1), Array(2), Array(3), Array(4)
CHARACTERS, ROWS = Array(1, "uint8"), Array(1, "int64")

V2 = ("cx16", "popcnt", "sahf", "sse3", "ssse3", "sse4.1", "sse4.2")
V3 = (*V2, "avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")
V4 = (*V3, "avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl")
LEVELS = {"x86-64-v2": V2, "x86-64-v3": V3, "x86-64-v4": V4}
"""Levels of x86-64 and what a processor has of each."""


@cache
def level() -> str:
    """What objects for this machine are compiled for: the highest level of x86-64 it has, or its processor's name."""
    from llvmlite import binding

    has = binding.get_host_cpu_features()
    if platform.machine().lower() in ("x86_64", "amd64"):
        for name, needs in reversed(LEVELS.items()):
            if all(has.get(x) for x in needs):
                return name
    return str(binding.get_host_cpu_name())


def folder_of(of_level: str) -> str:
    """The folder's name for the objects of these kernels at a level."""
    return f"{platform.system().lower()}-{of_level}"


def objects() -> Path | None:
    """The folder of the objects for this machine: those that came with the program, or those in the user's cache."""
    for base in (places.installed(), places.cache_dir()):
        if base.is_dir() and (base / folder_of(level())).is_dir():
            return base / folder_of(level())
    return None


def name_of(function: Callable[..., Any]) -> str:
    """Name of an entry: its module below this package, and its own."""
    return f"{function.__module__.removeprefix(PACKAGE + '.')}.{function.__name__}"


def symbol_of(name: str) -> str:
    """Name of an entry's function in its object."""
    return f"rockcli_{name.replace('.', '_')}"


SCALARS: dict[Any, Any] = {bool: ctypes.c_uint8, int: ctypes.c_int64, float: ctypes.c_double}


@cache
def members(kind: Any) -> tuple[Any, ...] | None:
    """What a tuple holds, given as a class of named values or as a tuple of kinds; None if it is no tuple."""
    if isinstance(kind, Array):
        return None
    if isinstance(kind, tuple):
        return kind
    return tuple(get_type_hints(kind).values()) if isinstance(kind, type) and issubclass(kind, tuple) else None


def flat_types(kind: Any) -> list[Any]:
    """Types of C that an argument is passed as."""
    if isinstance(kind, Array):
        return [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p] + [
            ctypes.c_int64
        ] * (2 * kind.ndim)
    if (inside := members(kind)) is not None:
        return [x for each in inside for x in flat_types(each)]
    return [SCALARS[kind]]


def flatten(kind: Any, value: Any, into: list[Any]) -> None:
    """Append what an argument is passed as."""
    if isinstance(kind, Array):
        if value.ndim != kind.ndim or value.dtype != kind.of or not value.flags.c_contiguous:
            raise TypeError(f"a kernel takes {kind.of}, {kind.ndim} dimensions in order: {value.dtype} {value.strides}")
        into += (None, None, value.size, value.itemsize, value.ctypes.data, *value.shape, *value.strides)
    elif kind in SCALARS:
        into.append(kind(value))
    else:
        for each, part in zip(members(kind) or (), value, strict=True):
            flatten(each, part, into)


class Entry:
    """A function that Python calls, compiled ahead of time; loaded when it is first called."""

    def __init__(self, function: Callable[..., Any], takes: tuple[Any, ...], gives: Any) -> None:
        self.__doc__, self.__wrapped__ = function.__doc__, function
        self._name, self._takes, self._gives = name_of(function), takes, gives
        self._call: Callable[..., int] | None = None

    def __call__(self, *arguments: Any) -> Any:
        """Call it; a TypeError if an array is not as it takes it."""
        if self._call is None:
            self._call = self._load()
        flat: list[Any] = []
        for kind, value in zip(self._takes, arguments, strict=True):
            flatten(kind, value, flat)
        result = SCALARS.get(self._gives, ctypes.c_void_p)()
        status = self._call(ctypes.byref(result), ctypes.byref(ctypes.c_void_p()), *flat)
        if status not in (0, -2):  # done; done, without a result
            raise RuntimeError(f"the kernel {self._name} ended with status {status}")
        return None if self._gives is None else self._gives(result.value)

    def _load(self) -> Callable[..., int]:
        folder = objects()
        if folder is None:
            raise RuntimeError(f"no object of the kernel {self._name}")
        engine, address = engine_of(folder / f"{self._name}.o", symbol_of(self._name))
        types = [x for kind in self._takes for x in flat_types(kind)]
        # a call of this kind lets other threads run meanwhile, of which each may load the object, and run its own
        call = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, *types)(address)
        call.engine = engine  # type: ignore[attr-defined] # which must not go while the call runs
        return call


def sealed(code: bytes, symbol: str) -> bytes:
    """What a file holds of an object: the code, and behind it a digest, by which one that was damaged is known."""
    return code + hashlib.sha256(symbol.encode() + code).digest()


def _unsealed(path: Path, symbol: str) -> bytes:
    """The code in the file of an object; `OSError` if it is damaged: LLVM's linker would end the process."""
    held = path.read_bytes()
    code = held[:-_DIGEST]
    if held != sealed(code, symbol):
        raise OSError(f"the compiled kernel {path} is damaged: remove its folder, and they are compiled anew")
    return code


def engine_of(path: Path, symbol: str) -> tuple[Any, int]:
    """What holds an object in memory, and the address of a function in it; `OSError` if its file is damaged."""
    from llvmlite import binding

    code = _unsealed(path, symbol)
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    if binding.address_of_symbol("sin") is None:  # mostly the interpreter has brought it
        binding.load_library_permanently(ctypes.util.find_library("m"))
    machine = binding.Target.from_default_triple().create_target_machine()
    engine = binding.create_mcjit_compiler(binding.parse_assembly(""), machine)
    engine.add_object_file(binding.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return engine, engine.get_function_address(symbol)
