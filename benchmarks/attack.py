"""How the program stands up to input that is meant to break it: counts of studies, records and killed runs.

    python benchmarks/attack.py studies 50000 [FOLDER_OF_FAULTS] [SEED]
    python benchmarks/attack.py records 5000 [FOLDER_OF_FAULTS] [SEED] [FOLDER_OF_RECORDS]
    python benchmarks/attack.py kills 150 [FOLDER_OF_FAULTS] [SEED]

`studies`: the project's own, mutated as trees (odd values, keys renamed, moved, left out) and as bytes, through `rock
check`, and half of those that pass and are small through `rock run`.  `records`: files of records, mutated as bytes,
through `rock records info` and a study.  `kills`: runs of three studies that are ended by one to three signals at any
moment; the run after that must give the dataset of a run that nobody touched, to the last bit.

A fault is an exit code that docs/ci.md does not know, "this is a bug in rock", a warning of Python, no sentence beside
exit 2, something left behind by exit 2, or no end within 90 s.  Faults are kept in the folder.  Counts by exit code are printed.
"""

from __future__ import annotations

import copy
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
import yaml

ROOT = Path(__file__).resolve().parents[1]
ENDS_WITHIN = 90
"""Seconds after which a command hangs; kernels are compiled before."""

ODD: tuple[Any, ...] = (
    0, -1, 1, 1e-300, 1e300, float("nan"), float("inf"), 10**30, True, None, "", "g", "4*g", "0/0", "2**9999", "a" * 500,
    "\u202e", "x\x00y", "\ud800", [], {}, [1, 2], [[1]], [None], {"a": 1}, "07", "1e5", "1_000", "yes", "2026-01-01", "record",
    "*.AT2", "/", "/dev/null", "..", "auto", {"from": 0, "to": 1, "n": 3}, {"from": 1, "to": 100, "n": 10**8}, [1, 1], 45, -0.0,
)  # fmt: skip
PIECES = (
    b":",
    b"-",
    b"\t",
    b"{",
    b"]",
    b"&a ",
    b"*a ",
    b"!!python/object:os.system ",
    b"\n",
    b"#",
    b"'",
    b"\xff\xfe",
    b"\x00",
)
NUMBERS = (
    b"nan",
    b"inf",
    b"1e999",
    b"-",
    b"NPTS= 99999999999",
    b"DT= 0",
    b"\x00",
    b"\xff",
    b"*****",
    b"1.0E",
    b"9" * 400,
)

Found = tuple[int | str, str, str]
"""Exit code, or what went wrong instead; what was printed; the errors."""


class _TooLongError(BaseException):
    pass


def main() -> None:
    kind, count, *more = sys.argv[1:]
    faults = Path(more[0] if more else tempfile.mkdtemp(prefix="faults"))
    faults.mkdir(parents=True, exist_ok=True)
    rng = random.Random(int(more[1]) if len(more) > 1 else 0)
    folder = Path(more[2]) if len(more) > 2 else ROOT / "records"
    counts: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as work:
        if kind == "studies":
            attack = studies(rng, int(count), Path(work))
        elif kind == "records":
            attack = records(rng, int(count), Path(work), folder)
        else:
            attack = kills(rng, int(count), Path(work))
        for n, (what, found, fault, content) in enumerate(attack):
            counts[f"{what}: {found}"] += 1
            if fault:
                counts["faults"] += 1
                (faults / f"{kind}-{n}").write_bytes(content)
                print(f"{faults / f'{kind}-{n}'}: {fault}", flush=True)
    for line in sorted(counts):
        print(f"{counts[line]:8d}  {line}")


def studies(rng: random.Random, count: int, work: Path) -> Iterator[tuple[str, Any, str, bytes]]:
    """Mutated studies, each beside the one it comes from, so that its records are found."""
    files = sorted((ROOT / "studies").rglob("*.yaml"))
    trees = [yaml.safe_load(file.read_text(encoding="utf-8")) for file in files]
    words = sorted({str(word) for tree in trees for word in _words(tree)})
    for _ in range(count):
        which = rng.randrange(len(files))
        content = _study(rng, trees[which], files[which].read_bytes(), words)
        copied = files[which].with_name(f".attack-{os.getpid()}.yaml")
        copied.write_bytes(content)
        out = work / "out"
        try:
            found = command(["check", "--json", str(copied)])
            yield "check", found[0], fault_of(found, (0, 2)), content
            if found[0] == 0 and _small(found[1]) and rng.random() < 0.5:
                shutil.rmtree(out, ignore_errors=True)
                run = command(["run", str(copied), "--out", str(out), "--no-plots", "--workers", "1", "--json"])
                left = run[0] == 2 and any(item.is_file() for item in out.rglob("*"))
                yield "run", run[0], "left files behind" if left else fault_of(run, (0, 1, 2, 3)), content
        finally:
            with suppress(OSError):
                copied.unlink()


def records(rng: random.Random, count: int, work: Path, folder: Path) -> Iterator[tuple[str, Any, str, bytes]]:
    """Mutated files of records, by themselves and in a study."""
    files = [file for file in folder.rglob("*") if file.is_file() and 0 < file.stat().st_size < 400_000]
    options = ("", ", units: g", ", dt: 0.01, units: g", ", pga: 0.3*g")
    for _ in range(count):
        source = rng.choice(files)
        content = _bytes(rng, source.read_bytes(), NUMBERS)
        record, study = work / f"r{source.suffix}", work / "s.yaml"
        record.write_bytes(content)
        study.write_text(
            f"name: attacked\ncase:\n  block: {{R: 2, alpha: 0.2}}\n"
            f"  motion: {{record: {{file: {record.name}{rng.choice(options)}}}}}\n"
        )
        info = command(["records", "info", str(record)])
        yield "records info", info[0], fault_of(info, (0, 2)), content
        run = command(["run", str(study), "--out", str(work / "out"), "--fresh", "--no-plots", "--workers", "1"])
        yield "run", run[0], fault_of(run, (0, 2, 3)), content


PULSE = (
    "name: {0}\ncase: {{block: {{R: 2, alpha: 0.2}}, motion: {{pulse: {{shape: ricker, a_p: 0.5*g, omega_p: 6}}}}}}\n"
)
KILLED = {
    "map": "vary: {motion.pulse.a_p: {from: 0.2*g, to: 2*g, n: 120}, motion.pulse.omega_p: {from: 3, to: 30, n: 100}}\n"
    "save: {scalars: [outcome, theta_peak_over_alpha]}\n",
    "full": "vary: {motion.pulse.a_p: {from: 0.2*g, to: 2*g, n: 40}, motion.pulse.omega_p: {from: 3, to: 30, n: 30}}\n",
    "find": "vary: {motion.pulse.omega_p: {from: 3, to: 30, n: 60},"
    " motion.pulse.a_p: {from: 0.2*g, to: 8*g, n: 40, find: overturning}}\n",
}


def kills(rng: random.Random, count: int, work: Path) -> Iterator[tuple[str, Any, str, bytes]]:
    """Runs ended at any moment, and what the next run makes of them."""
    lasts, untouched = {}, {}
    for name, vary in KILLED.items():
        (work / f"{name}.yaml").write_text(PULSE.format(name) + vary)
        for _ in range(2):  # the second time kernels are compiled
            began = time.time()
            _process(work, name, "untouched", ["--fresh"]).communicate()
            lasts[name] = time.time() - began
        untouched[name] = work / "untouched" / name / f"{name}.nc"
    for n in range(count):
        name, workers = rng.choice(list(KILLED)), rng.choice(([], ["--workers", "1"], ["--workers", "2"]))
        said = []
        for _ in range(rng.choice((1, 1, 2, 3))):
            process = _process(work, name, f"out{n}", workers)
            end = rng.choice((signal.SIGINT, signal.SIGTERM, signal.SIGKILL))
            time.sleep(rng.random() * lasts[name])
            with suppress(ProcessLookupError):
                (os.killpg if rng.random() < 0.3 else os.kill)(process.pid, end)
            said.append(_ended(process, end))
            yield f"{end.name}", process.returncode, said[-1], name.encode()
        last = _process(work, name, f"out{n}", workers)
        wrong = _ended(last, None) or _differs(untouched[name], work / f"out{n}" / name / f"{name}.nc")
        yield "the run after", last.returncode, wrong, name.encode()
        shutil.rmtree(work / f"out{n}", ignore_errors=True)


def command(args: list[str]) -> Found:
    """`rock` in this process: exit code, output and errors."""
    from rockcli.cli import main as rock

    def ring(*_: object) -> None:
        raise _TooLongError

    signal.signal(signal.SIGALRM, ring)
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as errors:
        kept = os.dup(1), os.dup(2)
        os.dup2(out.fileno(), 1)
        os.dup2(errors.fileno(), 2)
        sys.argv = ["rock", *args]
        code: int | str = 0
        signal.alarm(ENDS_WITHIN)
        try:
            rock.main()
        except SystemExit as left:
            code = left.code or 0
        except _TooLongError:
            code = "no end"
        except BaseException as error:
            code = f"raised {type(error).__name__}"
        finally:
            signal.alarm(0)
            for stream, number, old in ((sys.stdout, 1, kept[0]), (sys.stderr, 2, kept[1])):
                with suppress(Exception):
                    stream.flush()
                os.dup2(old, number)
                os.close(old)
        texts = []
        for stream in (out, errors):
            stream.seek(0)
            texts.append(stream.read().decode(errors="replace"))
    return code, texts[0], texts[1]


def fault_of(found: Found, allowed: tuple[int, ...]) -> str:
    """What is wrong with the end of a command, or nothing."""
    code, _, errors = found
    if code not in allowed or any(word in errors for word in ("bug in rock", "Traceback", ".py:")):
        return f"{code}: {errors[-300:]}"
    return "exit 2 without a sentence" if code == 2 and not errors.strip() else ""


def _process(work: Path, name: str, out: str, more: list[str]) -> subprocess.Popen[str]:
    args = [
        sys.executable,
        "-m",
        "rockcli",
        "run",
        str(work / f"{name}.yaml"),
        "--out",
        str(work / out),
        "--no-plots",
        *more,
    ]
    return subprocess.Popen(args, text=True, start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def _ended(process: subprocess.Popen[str], end: signal.Signals | None) -> str:
    try:
        _, errors = process.communicate(timeout=ENDS_WITHIN)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return "no end"
    allowed = (0,) if end is None else (0, 130, 143, -signal.SIGKILL, -signal.SIGINT, -signal.SIGTERM)
    return fault_of((process.returncode, "", errors), allowed)


def _differs(one: Path, other: Path) -> str:
    """Which variable of two datasets differs in a bit, wall times apart."""
    with xr.open_dataset(one) as a, xr.open_dataset(other) as b:
        for name in set(a.variables) | set(b.variables):
            if name != "wall_time" and (name not in a or name not in b or not _equal(a[name].values, b[name].values)):
                return f"{name} differs"
    return ""


def _equal(a: Any, b: Any) -> bool:
    return bool(np.array_equal(a, b, equal_nan=a.dtype.kind == "f"))


def _small(printed: str) -> bool:
    import json

    (preview,) = json.loads(printed)
    return bool(preview["cases"] <= 30 and preview["seconds"] < 2.0)


def _words(tree: Any) -> Iterator[Any]:
    for path in _paths(tree):
        if path:
            yield path[-1]
        value = _at(tree, path)
        if isinstance(value, str) and len(value) < 40:
            yield value


def _paths(tree: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    yield path
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in items:
        yield from _paths(value, (*path, key))


def _at(tree: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        tree = tree[key]
    return tree


def _study(rng: random.Random, tree: Any, text: bytes, words: list[str]) -> bytes:
    if rng.random() < 0.25:
        return _bytes(rng, text, PIECES)
    tree = copy.deepcopy(tree)
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        path = rng.choice([path for path in _paths(tree) if path] or [()])
        if path:
            _mutate(rng, tree, path, words)
    with suppress(Exception):
        written = yaml.safe_dump(tree, allow_unicode=rng.random() < 0.5, sort_keys=False)
        return bytes(written.encode("utf-8", "surrogatepass"))
    return _bytes(rng, text, PIECES)


def _mutate(rng: random.Random, tree: Any, path: tuple[Any, ...], words: list[str]) -> None:
    parent, key = _at(tree, path[:-1]), path[-1]
    old = parent[key]
    number = isinstance(old, int | float) and not isinstance(old, bool)
    change: Callable[[], None] = rng.choice(
        (
            lambda: parent.__setitem__(key, copy.deepcopy(rng.choice(ODD))),
            lambda: parent.__setitem__(
                key, old * rng.choice((-1, 0, 1e-6, 2, 1e3, 1e9)) if number else rng.choice(words)
            ),
            lambda: parent.__delitem__(key),
            lambda: (
                parent.__setitem__(rng.choice(words), parent.pop(key))
                if isinstance(parent, dict)
                else parent.append(old)
            ),
            lambda: parent.__setitem__(key, copy.deepcopy(_at(tree, rng.choice([p for p in _paths(tree) if p])))),
        )
    )
    change()


def _bytes(rng: random.Random, content: bytes, pieces: tuple[bytes, ...]) -> bytes:
    spoilt = bytearray(content)
    for _ in range(rng.choice((1, 1, 2, 5))):
        at = rng.randrange(max(min(len(spoilt), rng.choice((300, 2000, len(spoilt)))), 1)) if spoilt else 0
        match rng.randrange(6):
            case 0 if spoilt:
                spoilt[at] = rng.randrange(256)
            case 1:
                del spoilt[at : at + rng.choice((1, 3, 80, 5000))]
            case 2:
                spoilt[at:at] = rng.choice(pieces)
            case 3:
                spoilt[at:at] = spoilt[: rng.choice((10, 100))]
            case 4:
                old, new = rng.choice((b".", b" ", b"\n", b"E", b"0")), rng.choice((b",", b"\t", b"\r\n", b"D", b""))
                spoilt = spoilt.replace(old, new, rng.choice((1, 5, -1)))
            case _:
                spoilt = spoilt[: max(at, 1)]
    return bytes(spoilt)


if __name__ == "__main__":
    main()
