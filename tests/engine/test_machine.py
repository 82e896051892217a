"""What the machine refuses is no answer of a case: smaller chunks, or exit code 4 and everything finished kept."""

from __future__ import annotations

import errno
import os
import resource
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from swept import CASES, assert_same, made_up, solved, study

from rockcli.engine.run import run_study
from rockcli.engine.summary import SOLVED, UP_TO_DATE
from rockcli.engine.sweep import executors, sweep
from rockcli.engine.sweep.work import Team
from rockcli.errors import MachineError, OutputError, RockError
from rockcli.scene.batch import Batch
from rockcli.scene.response import FAILED, Response
from rockcli.storage import netcdf

Solver = Callable[[Batch], Response]

TROUBLE = [
    MemoryError("Unable to allocate 3.00 GiB"),
    OSError(errno.ENOSPC, "No space left on device"),
    OSError(errno.EMFILE, "Too many open files"),
    ImportError("libx.so: failed to map segment from shared object"),
    MachineError("the program was killed by the system"),
]


@pytest.fixture
def by(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    def use(solver: Solver = made_up, chunk: int = 7, *, at_once: bool = False) -> None:
        monkeypatch.setattr("rockcli.solvers.event.solver.solve", solver)
        monkeypatch.setattr(sweep, "CHUNK", chunk)
        monkeypatch.setattr(executors, "_worth", lambda *_: at_once)

    return use


def unlucky(batch: Batch) -> Any:
    """The three cases that the machine has not enough for."""
    return (batch.theta_0 > 0.09) & (batch.model == "rigid")


def refusing(trouble: BaseException) -> Solver:
    def solver(batch: Batch) -> Response:
        if unlucky(batch).any():
            raise trouble
        return made_up(batch)

    return solver


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("trouble", TROUBLE, ids=lambda error: type(error).__name__)
def test_what_the_machine_refuses_is_solved_by_the_next_run(
    trouble: Exception, workers: int, by: Callable[..., None], tmp_path: Path
) -> None:
    by()
    whole = solved(study())
    by(refusing(trouble), at_once=workers > 1)
    for kept in (0, CASES - 3):
        with pytest.raises(MachineError, match=r"3 of 60 cases are not solved, because the machine refused") as caught:
            run_study(study(), tmp_path, plots=False, team=Team(workers))
        assert caught.value.exit_code == 4
        assert "run again once that is fixed: finished cases are kept" in str(caught.value)
        assert not (tmp_path / "swept" / "swept.nc").exists()
        assert list((tmp_path / "swept" / ".parts").rglob("*.npz")) or not kept
    by()
    report = run_study(study(), tmp_path, plots=False)
    assert (report.status, report.resumed) == (SOLVED, CASES - 3)
    assert_same(whole, netcdf.read(tmp_path / "swept" / "swept.nc"))
    assert run_study(study(), tmp_path, plots=False).status == UP_TO_DATE


def test_what_could_not_be_kept_is_not_called_kept(
    by: Callable[..., None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: Any) -> None:
        raise OutputError("no space left on device")

    monkeypatch.setattr("rockcli.engine.sweep.parts.write_part", full)
    by(refusing(MemoryError("no more")))
    with pytest.raises(RockError, match="could not be kept and will be solved again") as caught:
        run_study(study(), tmp_path, plots=False)
    assert "are kept" not in str(caught.value)


def test_one_share_of_several_keeps_what_it_has(by: Callable[..., None], tmp_path: Path) -> None:
    by(refusing(MemoryError("no more")))
    with pytest.raises(MachineError, match="run again"):
        run_study(study(), tmp_path, plots=False, share=(1, 1))
    by()
    assert run_study(study(), tmp_path, plots=False).resumed == CASES - 3


@pytest.mark.parametrize("workers", [1, 2])
def test_what_does_not_fit_at_once_is_solved_in_smaller_chunks(workers: int, by: Callable[..., None]) -> None:
    by()
    whole = solved(study())
    seen: list[int] = []

    def narrow(batch: Batch) -> Response:
        if batch.size > 3:
            raise MemoryError
        return made_up(batch)

    by(narrow, chunk=CASES, at_once=workers > 1)
    assert_same(whole, solved(study(), workers))

    class Narrow:
        """Has no room for the results of a chunk, wherever it notices that."""

        def __call__(self, cases: Any) -> Any:
            if len(cases) > 5:
                raise MemoryError
            seen.append(len(cases))
            return cases

        def lost(self, cases: Any, why: str) -> Any:
            raise AssertionError(why)

    found = list(executors.answers(Narrow(), sweep.Chunks(40), sweep.Pace(1e-9), Team(workers)))
    np.testing.assert_array_equal(np.sort(np.concatenate([cases for cases, _ in found])), np.arange(40))
    assert len(found) < 40 / 2


def test_a_machine_that_refuses_everything_is_not_asked_for_ever() -> None:
    asked: list[int] = []

    class Refused:
        def __call__(self, cases: Any) -> Any:
            asked.append(len(cases))
            raise ImportError("cannot map the library")

        def lost(self, cases: Any, why: str) -> str:
            return why

    found = list(executors.answers(Refused(), sweep.Chunks(20_000), sweep.Pace(1e-9), Team(1)))
    assert sum(len(cases) for cases, _ in found) == 20_000
    assert {why for _, why in found} == {"ImportError: cannot map the library"}
    assert len(asked) < 200


def test_a_process_that_the_system_kills_has_not_answered(by: Callable[..., None], tmp_path: Path) -> None:
    """SIGKILL comes from outside, mostly for want of memory; SIGSEGV is the solver's own (test_workers)."""
    by()
    whole = solved(study())

    def greedy(batch: Batch) -> Response:
        if unlucky(batch).any():
            os.kill(os.getpid(), signal.SIGKILL)
        return made_up(batch)

    by(greedy, at_once=True)
    with pytest.raises(MachineError, match=r"3 of 60 cases .* the solver's process died of signal SIGKILL"):
        run_study(study(), tmp_path, plots=False, team=Team(2))
    by()
    assert run_study(study(), tmp_path, plots=False).resumed == CASES - 3
    assert_same(whole, netcdf.read(tmp_path / "swept" / "swept.nc"))


@pytest.mark.parametrize("allowed", [0, 1])
def test_fewer_processes_than_wanted(allowed: int, by: Callable[..., None], monkeypatch: pytest.MonkeyPatch) -> None:
    from rockcli.engine.sweep import workers

    by()
    whole = solved(study())
    start, started = workers._start, []

    def refused(*how: Any) -> Any:
        if len(started) == allowed:
            raise BlockingIOError(errno.EAGAIN, "Resource temporarily unavailable")
        started.append(start(*how))
        return started[-1]

    monkeypatch.setattr(workers, "_start", refused)
    by(at_once=True)
    team = Team(3)
    from rockcli.engine.run import solve

    assert_same(whole, solve(study(), sweep=sweep.Sweep(team)))
    (note,) = team.notes
    assert note.startswith(f"{allowed} processes at work, as no more can be started")


def test_one_bad_case_in_every_chunk_loses_no_other(by: Callable[..., None]) -> None:
    """More cases break than are taken apart at a stretch, one here and one there."""
    many = study(vary={"initial.theta": {"from": 0.001, "to": 0.1, "n": 3000}})

    def bad(batch: Batch) -> Any:
        return np.rint(batch.theta_0 * 1e6).astype(int) % 40 == 0

    def solver(batch: Batch) -> Response:
        if bad(batch).any():
            raise FloatingPointError("overflow")
        return made_up(batch)

    by(chunk=3000)
    ((_, batch),) = many.batches()
    by(solver, chunk=3000)
    found = solved(many)
    wrong = bad(batch)
    assert 60 < wrong.sum() < 100
    np.testing.assert_array_equal(found.values("n_impacts") == -1, wrong)
    assert (found.values("outcome")[wrong] == FAILED).all()


def test_whatever_ends_a_run_what_is_finished_is_kept(
    by: Callable[..., None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from rockcli.engine.sweep.results import Results

    by()
    finish = Results.finish

    def broken(self: Results) -> None:
        raise MemoryError("Unable to allocate 1 TiB")

    monkeypatch.setattr(Results, "finish", broken)
    with pytest.raises(MachineError, match="out of memory; Unable to allocate 1 TiB; run again"):
        run_study(study(), tmp_path, plots=False)
    monkeypatch.setattr(Results, "finish", finish)
    assert run_study(study(), tmp_path, plots=False).resumed == CASES


KERNEL = """\
from rockcli.kernels import jit, places
jit.decide(jit.JUST_IN_TIME)
import kernel
print(kernel.twice(21.0), len(list(places.cache_dir().rglob("*.nbc"))) if places.cache_takes_files() else "nowhere")
"""


def compiled(folder: Path, cache: Path, **more: Any) -> str:
    """What a kernel compiled in a process of its own gives, and how many files are in the cache then."""
    (folder / "kernel.py").write_text(
        "from rockcli.kernels.jit import jit\n\n@jit\ndef twice(x):\n    return 2.0 * x\n"
    )
    return subprocess.run(
        [sys.executable, "-c", KERNEL],
        cwd=folder,
        env=os.environ
        | {"ROCK_CACHE_DIR": str(cache), "PYTHONPATH": os.pathsep.join([str(folder), str(Path(__file__).parents[2])])},
        capture_output=True,
        text=True,
        check=True,
        **more,
    ).stdout.strip()


def test_kernels_are_kept_where_there_is_a_place(tmp_path: Path) -> None:
    assert compiled(tmp_path, tmp_path / "cache") == "42.0 1"


def test_without_a_place_kernels_are_used_all_the_same(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert compiled(tmp_path, tmp_path / "file" / "cache") == "42.0 nowhere"
    assert not list((tmp_path / "__pycache__").glob("*.nb*")), "beside the sources changes of callees go unseen"


def test_a_disk_that_is_full_when_kernels_are_to_be_kept(tmp_path: Path) -> None:
    def little_room() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))  # enough to try, not enough for a kernel

    assert compiled(tmp_path, tmp_path / "cache", preexec_fn=little_room) == "42.0 0"


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a kernel, and the cache in which it is kept."""
    folder = tmp_path_factory.mktemp("kept")
    compiled(folder, folder / "cache")
    return folder


@pytest.mark.parametrize("left", [0, 40])
@pytest.mark.parametrize("what", ["*.nbi", "*.nbc"])
def test_kernels_in_the_cache_that_are_damaged_are_compiled_anew(
    what: str, left: int, kept: Path, tmp_path: Path
) -> None:
    """As files that a power failure cut short; all cases were failed, with the words of numba's reader."""
    shutil.copytree(kept / "cache", tmp_path / "cache")
    (damaged,) = (tmp_path / "cache").rglob(what)
    size = damaged.stat().st_size
    os.truncate(damaged, left)
    assert compiled(kept, tmp_path / "cache") == "42.0 1"
    assert damaged.stat().st_size == size


@pytest.fixture
def mounted(tmp_path: Path) -> Iterator[Callable[[str], Path]]:
    """Mount a file system of a few kilobytes, or one that cannot be written; root alone may."""
    if os.geteuid() != 0:
        pytest.skip("mounting a file system needs root")
    places: list[Path] = []

    def mount(options: str) -> Path:
        place = tmp_path / f"mounted{len(places)}"
        place.mkdir()
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(place)], check=False)
        if done.returncode:
            pytest.skip("this place does not let root mount a file system")
        places.append(place)
        return place

    yield mount
    for place in places:
        subprocess.run(["umount", str(place)], check=True)


RUN = "name: x\ncase: {block: {R: 2.0, tan_alpha: 0.2}, initial: {theta: 0.1}}\n"


def rock_in(folder: Path, *words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    (folder / "x.yaml").write_text(RUN)
    return subprocess.run(
        [sys.executable, "-m", "rockcli.cli.main", *words],
        cwd=folder,
        env={key: value for key, value in os.environ.items() if key != "ROCK_CACHE_DIR"} | environment,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.slow
@pytest.mark.parametrize("options", ["ro,size=1m", "size=200k"], ids=["read-only home", "full cache disk"])
def test_a_home_that_takes_nothing(mounted: Callable[[str], Path], options: str, tmp_path: Path) -> None:
    home = mounted(options)
    more = {"HOME": str(home), "XDG_CACHE_HOME": "", "MPLCONFIGDIR": str(tmp_path / "mpl")}
    wanted = rock_in(tmp_path, "run", "x.yaml", "--no-plots", "--out", "wanted", ROCK_KERNELS="compiled")
    found = rock_in(tmp_path, "run", "x.yaml", "--no-plots", "--out", "found", ROCK_KERNELS="compiled", **more)
    assert (wanted.returncode, found.returncode) == (0, 0), found.stderr
    one, other = (netcdf.read(tmp_path / out / "x" / "x.nc") for out in ("wanted", "found"))
    assert_same(one, other)


def test_a_full_disk_for_results(mounted: Callable[[str], Path], tmp_path: Path) -> None:
    place = mounted("size=24k")
    found = rock_in(tmp_path, "run", "x.yaml", "--no-plots", "--out", str(place))
    assert found.returncode == 4
    assert "no space left on the device; run again once that is fixed" in found.stderr
    subprocess.run(["mount", "-o", "remount,size=4m", str(place)], check=True)
    again = rock_in(tmp_path, "run", "x.yaml", "--no-plots", "--out", str(place))
    assert again.returncode == 0
    assert "1 rocking" in again.stdout
