"""Compile the kernels ahead of time: `python -m rockcli.kernels.build FOLDER [LEVEL ...]` (docs/building.md).

Numba's part is done once, without optimization; LLVM then optimizes and writes machine code for every level.
"""

from __future__ import annotations

import importlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from rockcli.kernels import ENTRIES, ahead, jit, places

KNOWN = frozenset({
    "acos", "asin", "atan", "atan2", "ceil", "copysign", "cos", "cosh", "exp", "expm1", "floor", "fma", "fmod", "frexp",
    "hypot", "ldexp", "log", "memcpy", "memmove", "memset", "pow", "sin", "sinh", "sqrt", "tan", "tanh",
})  # fmt: skip
"""Functions of the system's libraries that an object may call."""

WRAPPED = {"numba_frexp": "frexp", "numba_ldexp": "ldexp"}
"""Functions of numba that only call those of the system."""


def build(base: Path, levels: list[str]) -> None:
    """Compile every entry for some levels into `base`, a folder a level, each there whole or not at all.

    Raises:
        RuntimeError: it could not be done; with what was said.
    """
    base.mkdir(parents=True, exist_ok=True)
    environment = os.environ | {
        "NUMBA_OPT": "0", "NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "", "NUMBA_DISABLE_JIT": "0",
        "PYTHONPATH": os.pathsep.join([str(places.HERE.parents[1]), os.environ.get("PYTHONPATH", "")]),
    }  # fmt: skip
    waiting = list(dict.fromkeys(name.rpartition(".")[0] for name in ENTRIES))
    with tempfile.TemporaryDirectory(dir=base) as room:
        running: list[tuple[str, subprocess.Popen[bytes]]] = []
        try:
            while waiting or running:
                while waiting and len(running) < (os.cpu_count() or 1):
                    group = waiting.pop(0)
                    command = [sys.executable, "-m", __name__ if __name__ != "__main__" else "rockcli.kernels.build"]
                    with Path(room, f"{group}.txt").open("w") as said:
                        process = subprocess.Popen(
                            [*command, "--only", group, room, *levels], env=environment, stdout=said, stderr=said
                        )
                    running.append((group, process))
                for group, process in list(running):
                    if process.poll() is not None:
                        running.remove((group, process))
                        if process.returncode:
                            words = Path(room, f"{group}.txt").read_text(errors="replace")
                            raise RuntimeError(f"the kernels of {group} could not be compiled: {words[-2000:]}")
                time.sleep(0.1)
        finally:
            for _, process in running:
                process.kill()
                process.wait()
        for level in levels:
            put_in_place(Path(room) / ahead.folder_of(level), base / ahead.folder_of(level))


def put_in_place(made: Path, place: Path) -> None:
    """Move a finished folder to its place; one that somebody else put there meanwhile is as good."""
    made.chmod(0o755)
    try:
        made.rename(place)
    except OSError:
        if not place.is_dir():
            raise


def build_group(group: str, base: Path, levels: list[str]) -> None:
    """Compile the entries of some modules, in a process that has not compiled anything."""
    jit.decide(jit.JUST_IN_TIME, keep=False)
    for name in ENTRIES:
        if name.rpartition(".")[0] == group:
            importlib.import_module(f"{ahead.PACKAGE}.{name}")
    for name, (function, takes, gives) in jit.entries.items():
        if name.startswith(f"{group}."):
            text, symbol = unoptimized(function, takes, gives)
            for level in levels:
                folder = base / ahead.folder_of(level)
                folder.mkdir(exist_ok=True)
                code = object_of(text, symbol, ahead.symbol_of(name), level)
                (folder / f"{name}.o").write_bytes(ahead.sealed(code, ahead.symbol_of(name)))


def numba_type(kind: Any) -> Any:
    """Numba's type of an argument."""
    from numba import types

    if isinstance(kind, ahead.Array):
        return types.Array(getattr(types, kind.of), kind.ndim, "C")
    if (inside := ahead.members(kind)) is not None:
        made = [numba_type(each) for each in inside]
        return types.BaseTuple.from_types(made, None if isinstance(kind, tuple) else kind)
    return {bool: types.boolean, int: types.int64, float: types.float64}[kind]


def unoptimized(function: Any, takes: tuple[Any, ...], gives: Any) -> tuple[str, str]:
    """LLVM's text of an entry with all that it calls, and its symbol there.

    Raises:
        RuntimeError: numba passes arguments or results in another way than `ahead.Entry` does.
    """
    from llvmlite import binding
    from numba import types

    signature = tuple(numba_type(kind) for kind in takes)
    function.compile(signature)
    made = function.overloads[signature]
    wanted = types.none if gives is None else numba_type(gives)
    if made.signature.return_type != wanted:
        raise RuntimeError(f"{function} gives {made.signature.return_type}, not {wanted}")
    text, symbol = str(made.library._final_module), made.fndesc.llvm_func_name
    with binding.parse_assembly(text) as module:
        found = [str(x.type) for x in module.get_function(symbol).arguments]
    names = {"c_void_p": "ptr", "c_long": "i64", "c_longlong": "i64", "c_double": "double", "c_ubyte": "i8"}
    expected = ["ptr", "ptr"] + [names[x.__name__] for kind in takes for x in ahead.flat_types(kind)]
    if found != expected:
        raise RuntimeError(f"{function} takes {found}, not {expected}")
    return text, symbol


def object_of(text: str, symbol: str, name: str, level: str) -> bytes:
    """Machine code for a level, with one function that can be found, under a new name.

    Raises:
        RuntimeError: it calls what is not known to be in every process.
    """
    from llvmlite import binding

    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    target = binding.Target.from_triple(binding.get_process_triple())
    machine = target.create_target_machine(cpu=level, opt=3, reloc="static", codemodel="jitdefault", jit=True)
    with binding.parse_assembly(text) as module:
        for value in module.functions:
            value.name = WRAPPED.get(value.name, value.name)
        for value in [*module.functions, *module.global_variables]:
            if not value.is_declaration and value.name != symbol:
                value.linkage = "internal"
        module.get_function(symbol).name = name
        tuning = binding.create_pipeline_tuning_options(3)
        tuning.loop_vectorization = tuning.slp_vectorization = True
        passes = binding.create_pass_builder(machine, tuning)
        passes.getModulePassManager().run(module, passes)
        calls = {value.name for value in module.functions if value.is_declaration}
        unknown = {x for x in calls if not x.startswith("llvm.")} - KNOWN
        if unknown:
            raise RuntimeError(f"{name} calls {', '.join(sorted(unknown))}")
        return bytes(machine.emit_object(module))


def main() -> None:
    """`FOLDER [LEVEL ...]`: compile for this machine, or for the levels named, below FOLDER."""
    words = sys.argv[1:]
    if words[:1] == ["--only"]:
        build_group(words[1], Path(words[2]), words[3:])
        return
    base, levels = Path(words[0]) / places.digest(), words[1:] or [ahead.level()]
    if missing := [x for x in levels if not (base / ahead.folder_of(x)).is_dir()]:
        build(base, missing)
    for other in Path(words[0]).iterdir():
        if re.fullmatch("[0-9a-f]{16}", other.name) and other != base:
            shutil.rmtree(other)  # of other sources


if __name__ == "__main__":
    main()
