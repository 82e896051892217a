"""Kernels compiled ahead of time: the same bits as just in time, and what happens where there are none."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rockcli import kernels
from rockcli.cli import cache
from rockcli.errors import OutputError, StudyError
from rockcli.kernels import ahead, build, places

ROOT = Path(__file__).resolve().parents[2]

STUDIES = {
    "pulses": """
case: {block: {R: 1.0, tan_alpha: 0.2}, motion: {pulse: {shape: ricker, omega_p_over_p: 2, a_p_over_g_tan_alpha: 2}}}
vary: {motion.pulse.omega_p_over_p: {from: 0.3, to: 8, n: 20}, motion.pulse.a_p_over_g_tan_alpha: {from: 1, to: 9, n: 20}}
save: {scalars: [outcome, theta_peak, n_impacts]}
""",
    "single bodies": """
case: {block: {R: 1.0, tan_alpha: 0.2}, motion: {pulse: {shape: sine, omega_p_over_p: 2, a_p_over_g_tan_alpha: 2}}}
vary: {motion.pulse.omega_p_over_p: {from: 0.3, to: 8, n: 10}, motion.pulse.a_p_over_g_tan_alpha: {from: 1, to: 9, n: 10}}
""",
    "records": """
case: {block: {R: 1.0, tan_alpha: 0.2}, motion: {record: {file: synthetic_rock_m65.AT2}}}
vary: {block.R: {from: 0.5, to: 5, n: 20}, motion.record.scale: {from: 1, to: 4, n: 20}}
save: {scalars: [outcome, theta_peak, n_impacts]}
""",
    "column": """
case:
  block: {R: 5.0, tan_alpha: 0.1}
  column: {E: 2.0e9, rho: 2500, zeta: 0.02}
  model: flexible
  motion: {pulse: {shape: ricker, omega_p_over_p: 4, a_p_over_g_tan_alpha: 3}}
save: {histories: true}
""",
    "frame": """
case:
  block: {R: 2.0, tan_alpha: 0.2}
  model: 3
  motion: {pulse: {shape: sine, omega_p_over_p: 6, a_p_over_g_tan_alpha: 3}}
  solver: {backend: frame, dt: 0.002}
save: {histories: true}
""",
    "sliding": """
case:
  block: {R: 1.0, tan_alpha: 0.4, mu: 0.3}
  motion: {pulse: {shape: sine, omega_p_over_p: 3, a_p_over_g_tan_alpha: 2}}
vary: {block.mu: [0.2, 0.3, 0.42]}
save: {histories: true}
""",
}

SOLVE = """
import sys, warnings
import numpy as np
import yaml
import rockcli
from rockcli import kernels
from rockcli.cli import cache
from rockcli.errors import OutputError
from rockcli.kernels import ahead, jit
if sys.argv[1] != "jit":
    ahead.level = lambda: sys.argv[1]
for path in sys.argv[2:]:
    found = rockcli.run(path)
    kept = {name: np.asarray(v.values) for name, v in found.data_vars.items() if v.dtype.kind in "fiu" and name != "wall_time"}
    np.savez(path + "." + sys.argv[1] + ".npz", **kept)
print(jit._way, "numba" in sys.modules)
"""


def environment(**more: str) -> dict[str, str]:
    return {k: v for k, v in os.environ.items() if k not in ("ROCK_KERNELS", "ROCK_CACHE_DIR")} | more


@pytest.mark.slow
def test_same_bits_both_ways(tmp_path: Path) -> None:
    """Hundreds of pulses and records, single bodies, a column, a frame, sliding bodies; every level this machine has."""
    paths = []
    for name, words in STUDIES.items():
        path = tmp_path / f"{name.replace(' ', '-')}.yaml"
        path.write_text(f"name: {path.stem}\n{words}")
        paths.append(str(path))
    lower = list(ahead.LEVELS)[: list(ahead.LEVELS).index(ahead.level())] if ahead.level() in ahead.LEVELS else []
    levels = [*lower, ahead.level()]
    missing = [x for x in levels if not (places.installed() / ahead.folder_of(x)).is_dir()]
    if missing:
        build.build(tmp_path / f"kernels-{places.digest()}", missing)
    ways = []
    for way in (*levels, "jit"):
        more = {"ROCK_KERNELS": "jit"} if way == "jit" else {"ROCK_KERNELS": "ahead", "ROCK_CACHE_DIR": str(tmp_path)}
        done = subprocess.run(
            [sys.executable, "-c", SOLVE, way, *paths],
            env=environment(ROCK_RECORDS=str(ROOT / "records"), **more),
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        ways.append(done.stdout.strip())
    assert ways == ["compiled ahead of time False"] * len(levels) + ["compiled just in time True"]
    for path in paths:
        wanted = dict(np.load(f"{path}.jit.npz"))
        assert "outcome" in wanted
        for level in levels:
            found = dict(np.load(f"{path}.{level}.npz"))
            assert found.keys() == wanted.keys()
            for name in wanted:
                assert found[name].tobytes() == wanted[name].tobytes(), f"{path}, {level}: {name}"


@pytest.fixture
def nothing_installed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """No kernels with the program and an empty cache; kernels are loaded afresh before and after."""
    monkeypatch.setattr(places, "INSTALLED", tmp_path / "installed")
    monkeypatch.setenv("ROCK_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.delenv("ROCK_KERNELS", raising=False)
    return tmp_path


def put(folder: Path) -> Path:
    """A folder of objects for this machine, without any in it."""
    place = folder / ahead.folder_of(ahead.level())
    place.mkdir(parents=True)
    return place


def test_objects_are_found_by_digest_and_processor(nothing_installed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert ahead.objects() is None
    cached = put(places.cache_dir())
    assert ahead.objects() == cached
    installed = put(places.installed())
    assert ahead.objects() == installed
    monkeypatch.setattr(ahead, "level", lambda: "another-processor")
    assert ahead.objects() is None
    monkeypatch.undo()


def test_objects_of_other_sources_are_not_used(nothing_installed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put(places.installed())
    put(places.cache_dir())
    monkeypatch.setattr(places, "digest", lambda: "0123456789abcdef")
    assert ahead.objects() is None


def test_the_digest_is_that_of_the_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    copy = tmp_path / "kernels"
    shutil.copytree(places.HERE, copy, ignore=shutil.ignore_patterns("__pycache__", "objects"))
    monkeypatch.setattr(places, "HERE", copy)
    assert places.digest.__wrapped__() == places.digest()
    law = copy / "rigid" / "law.py"
    law.write_text(law.read_text() + "\n")
    assert places.digest.__wrapped__() != places.digest()


def test_what_is_demanded_and_absent_is_said(nothing_installed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROCK_KERNELS", "ahead")
    kernels.forget()
    with pytest.raises(ImportError, match=r"no kernels of this version .* `rock cache --fill` does it"):
        kernels.load(compile_them=False)
    monkeypatch.undo()
    kernels.forget()


def test_an_entry_takes_arrays_in_order_only() -> None:
    flat: list[object] = []
    a = np.arange(6.0).reshape(2, 3)
    ahead.flatten(ahead.MATRIX, a, flat)
    assert flat == [None, None, 6, 8, a.ctypes.data, 2, 3, 24, 8]
    for wrong in (a.T, a[0], a.astype(np.float32), a[:, ::2]):
        with pytest.raises(TypeError, match="a kernel takes float64"):
            ahead.flatten(ahead.MATRIX, wrong, [])
    flat.clear()
    text = np.frombuffer(b" 1.5\n", dtype=np.uint8)
    ahead.flatten(ahead.CHARACTERS, text, flat)
    assert flat == [None, None, 5, 1, text.ctypes.data, 5, 1]
    with pytest.raises(TypeError, match="a kernel takes uint8"):
        ahead.flatten(ahead.CHARACTERS, a[0], [])


@pytest.mark.parametrize("what", ["empty", "short", "without its digest", "a bit", "another's"])
def test_a_damaged_object_is_named_before_the_linker_has_it(what: str, tmp_path: Path) -> None:
    """The linker ends the process of what was cut short, and calls what was changed."""
    code = bytes(range(256)) * 8
    held = {
        "empty": b"",
        "short": ahead.sealed(code, "rockcli_x")[:1000],
        "without its digest": code,
        "a bit": ahead.sealed(code, "rockcli_x").replace(b"\x00", b"\x01", 1),
        "another's": ahead.sealed(code, "rockcli_y"),
    }[what]
    (tmp_path / "x.o").write_bytes(held)
    with pytest.raises(OSError, match=r"the compiled kernel .*x\.o is damaged: remove its folder"):
        ahead.engine_of(tmp_path / "x.o", "rockcli_x")


def rock(*words: str, **more: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "rockcli.cli.main", "cache", *words]
    return subprocess.run(command, env=environment(**more), capture_output=True, text=True, check=False)


def test_cache_says_where_and_how_large(tmp_path: Path) -> None:
    folder = tmp_path / f"kernels-{places.digest()}"
    other = tmp_path / "kernels-of-another-version"
    for place, size in ((folder, 3_000_000), (other, 1_500_000)):
        place.mkdir()
        (place / "x.nbc").write_bytes(bytes(size))
    said = rock(ROCK_CACHE_DIR=str(tmp_path))
    assert f"{tmp_path}: 4.5 MB, 3.0 MB of this version" in said.stdout
    found = json.loads(rock("--prune", "--json", ROCK_CACHE_DIR=str(tmp_path)).stdout)
    assert (found["bytes"], found["bytes_of_this_version"], found["writable"]) == (3_000_000, 3_000_000, True)
    assert found["processor"] == ahead.level()
    assert not other.exists()


def test_cache_refuses_what_it_does_not_know(tmp_path: Path) -> None:
    for words in (("--fill", "--level", "x86-64-v9"), ("--level", "x86-64-v3")):
        said = rock(*words, ROCK_CACHE_DIR=str(tmp_path))
        assert said.returncode == 2, said
        assert "--level" in said.stderr
    assert not list(tmp_path.rglob("*.o"))


def test_a_cache_that_cannot_be_written_is_said(nothing_installed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (nothing_installed / "file").write_text("")
    place = str(nothing_installed / "file" / "cache")
    said = rock(ROCK_CACHE_DIR=place)
    assert said.returncode == 0
    assert "cannot be written: kernels compiled just in time are compiled in every run" in said.stdout
    monkeypatch.setenv("ROCK_CACHE_DIR", place)
    with pytest.raises(StudyError, match=r"cannot be written; ROCK_CACHE_DIR names another place"):
        cache.cache(fill=True)


def test_a_build_that_fails_leaves_nothing(nothing_installed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", shutil.which("false"))
    with pytest.raises(OutputError, match=r"the kernels of .* could not be compiled"):
        cache.cache(fill=True)
    assert list(places.cache_dir().iterdir()) == []


def test_what_is_there_is_not_compiled_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As when the program is installed once more with another extra."""
    (tmp_path / places.digest() / ahead.folder_of(ahead.level())).mkdir(parents=True)
    asked: list[list[str]] = []
    monkeypatch.setattr(build, "build", lambda base, levels: asked.append(levels))
    for words in ([], [ahead.level()], [ahead.level(), "another"]):
        monkeypatch.setattr(sys, "argv", ["build", str(tmp_path), *words])
        build.main()
    assert asked == [["another"]]


AT_ONCE = """
import threading
import numpy as np
from rockcli import kernels
from rockcli.kernels import ahead
peak = kernels.load("reading.peaks", compile_them=True).peak_velocity
both, engine_of = threading.Barrier(2), ahead.engine_of

def loaded_by_both(*given):
    found = engine_of(*given)
    both.wait(60)
    return found

ahead.engine_of = loaded_by_both
shaking = np.tile([1.0, -1.0], 10_000_000)
found = []
threads = [threading.Thread(target=lambda: found.append(peak(shaking, 0.01))) for _ in range(2)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
print(*found)
"""


@pytest.mark.skipif(not kernels.compiled_ahead(), reason="no kernels were compiled ahead of time")
def test_threads_that_load_one_kernel_at_once_run_each_its_own() -> None:
    """Velocity rises by half of 1 m/s² times 0.005 s; the code that one ran was gone once the other had its own."""
    done = subprocess.run([sys.executable, "-c", AT_ONCE], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.split()) == (0, ["0.0025", "0.0025"]), done.stderr
