"""Several processes give the results of one, whatever happens to them."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from swept import CASES, assert_same, made_up, solved, study, write_study

from rockcli.engine.sweep import executors, sweep
from rockcli.engine.sweep import workers as pool
from rockcli.engine.sweep.chunks import Chunks, Pace
from rockcli.engine.sweep.work import Team
from rockcli.errors import StudyError
from rockcli.scene.batch import Batch
from rockcli.scene.response import FAILED, Response

NEVER, ALWAYS = (lambda *_: False), (lambda *_: True)


@pytest.fixture
def by(monkeypatch: pytest.MonkeyPatch):
    """Have all cases solved by a function, in processes from the beginning, a few at a time."""

    def use(solver=made_up, chunk: int = 7, worth=ALWAYS) -> None:
        monkeypatch.setattr("rockcli.solvers.event.solver.solve", solver)
        monkeypatch.setattr(sweep, "CHUNK", chunk)
        monkeypatch.setattr(executors, "_worth", worth)

    return use


def test_the_same_bits_by_any_number_of_workers_and_any_chunks(by) -> None:
    by(chunk=CASES, worth=NEVER)
    whole = solved(study())
    assert 1 < len(set(whole.values("reason").ravel())) == len(whole.values("reasons"))
    for workers, chunk in ((1, 7), (1, 1), (2, 7), (3, 1), (2, CASES)):
        by(chunk=chunk, worth=ALWAYS)
        assert_same(whole, solved(study(), workers))


def test_a_process_that_may_start_no_other_solves_all_itself(by, monkeypatch: pytest.MonkeyPatch) -> None:
    """As that of a `multiprocessing.Pool`, which is daemonic."""
    by()
    whole = solved(study())
    monkeypatch.setitem(multiprocessing.current_process()._config, "daemon", True)  # type: ignore[attr-defined]
    assert_same(whole, solved(study(), 2))


def test_the_same_bits_in_any_order(by, monkeypatch: pytest.MonkeyPatch) -> None:
    by(worth=NEVER)
    whole = solved(study())
    take = Chunks.take

    def from_behind(self: Chunks, most: int):  # type: ignore[no-untyped-def]
        if not hasattr(self, "kept"):
            self.kept = list(np.array_split(take(self, self.left), 9))  # type: ignore[attr-defined]
            self.left = CASES
        cases = self.kept.pop()  # type: ignore[attr-defined]
        self.left -= len(cases)
        return cases

    monkeypatch.setattr(Chunks, "take", from_behind)
    assert_same(whole, solved(study()))


def test_the_same_bits_of_the_real_solver_with_histories(by, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROCK_KERNELS", "interpreted")
    given = study(save={"histories": True, "dt_out": 0.01}, vary={"model": ["rigid", "3"], "block.R": [1.0, 2.0, 3.0]})
    whole = solved(given)
    assert {"theta", "t_impact", "time"} <= whole.fields.keys()
    monkeypatch.setattr(executors, "_worth", ALWAYS)
    monkeypatch.setattr(sweep, "CHUNK_WITH_HISTORIES", 1)
    assert_same(whole, solved(given, 2))


def test_two_workers_are_at_work_at_once(by, tmp_path: Path) -> None:
    def both(batch: Batch) -> Response:
        (tmp_path / str(os.getpid())).touch()
        limit = time.monotonic() + 20.0
        while len(list(tmp_path.iterdir())) < 2:
            assert time.monotonic() < limit, "nobody else is at work"
            time.sleep(0.01)
        return made_up(batch)

    by(both)
    assert (solved(study(), 2).values("n_impacts") >= 0).all()
    assert str(os.getpid()) not in {file.name for file in tmp_path.iterdir()}


def test_folders_of_workers_that_are_killed_do_not_stay(by, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As those of OpenSees, when a run is interrupted."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))

    def beside(batch: Batch) -> Response:
        with tempfile.TemporaryDirectory(prefix="peer-"):
            time.sleep(60.0)
        return made_up(batch)

    def interrupt(number: int, _: object) -> None:
        if len(list(tmp_path.rglob("peer-*"))) == 2:
            raise KeyboardInterrupt
        signal.setitimer(signal.ITIMER_REAL, 0.05)

    by(beside)
    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        with pytest.raises(KeyboardInterrupt):
            solved(study(), 2)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert not list(tmp_path.iterdir())


def test_a_small_study_is_solved_here(by, monkeypatch: pytest.MonkeyPatch) -> None:
    by(worth=executors._worth)
    monkeypatch.setattr("rockcli.engine.sweep.workers.on_workers", None)
    solved(study(), 8)


def test_a_small_rest_goes_with_the_last_chunk() -> None:
    pace = Pace(1e-3, most=220)  # 200 cases in the first chunk
    assert [pace.step(left) for left in (150, 200, 201, 220, 221, 249)] == [200, 200, 201, 220, 200, 200]
    assert [Pace(1e-3).step(left) for left in (250, 251)] == [250, 200]
    assert Pace(1e-3, at_once=True).step(5000) == 1000  # nothing to be learned from a smaller first one
    assert pace.step(220, workers=2) < 200  # where others would wait for it


def test_processes_start_when_what_is_left_is_worth_it() -> None:
    pace = Pace(1e-6)
    assert not executors._worth(Chunks(10**9), pace)  # nothing measured yet
    pace.learn(1000, 0.5)
    pace.learn(1000, 0.001)
    assert executors._worth(Chunks(10**6), pace)
    assert not executors._worth(Chunks(10**5), pace)
    assert executors._worth(Chunks(2), Pace(90.0))  # minutes per case: not even the first here


@pytest.mark.skipif(not executors.FORKS, reason="other processes take longer to start than most studies")
def test_processes_start_at_once_where_nothing_is_to_be_compiled() -> None:
    assert executors._worth(Chunks(10**6), Pace(1e-6, at_once=True))
    assert not executors._worth(Chunks(10**5), Pace(1e-6, at_once=True))


@pytest.mark.skipif(not executors.FORKS, reason="no case is solved before other processes start")
def test_results_are_laid_out_when_processes_are_at_work(by, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first answer takes as long as the memory of all: 0.3 s for 7 million cases."""
    by()
    chunks = Chunks(CASES)
    at_work: list[int] = []
    start = pool._start
    monkeypatch.setattr(pool, "_start", lambda *given: at_work.append(chunks.left) or start(*given))
    told = executors.answers(sweep.Solving(study()), chunks, Pace(1e-3, 7, at_once=True), Team(2))
    first, _ = next(told)
    assert len(at_work) == 2
    assert at_work[0] == CASES - executors.TASTE
    assert len(first) + sum(len(cases) for cases, _ in told) == CASES


def test_no_chunk_is_too_small_to_be_worth_sending() -> None:
    pace = Pace(1.0)
    assert pace.step(60, 2) == 1  # nothing is known yet
    pace.learn(1000, 0.1)
    sizes, left = [], 100_000
    while left:
        sizes.append(min(pace.step(left, 2), left))
        left -= sizes[-1]
    assert max(sizes) == 10_000
    assert min(sizes[:-1]) >= 75  # 7.5 ms
    assert max(sizes[-2:]) < 300


def test_a_worker_that_dies_costs_nothing(by, tmp_path: Path) -> None:
    by(worth=NEVER)
    whole = solved(study())
    shot = tmp_path / "shot"

    def mortal(batch: Batch) -> Response:
        if batch.theta_0[0] > 0.05 and not shot.exists():
            shot.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return made_up(batch)

    by(mortal)
    team = Team(2)
    assert_same(whole, sweep_by(team))
    assert shot.exists()
    assert team.notes == ["a worker process died; its cases were solved again"]


def sweep_by(team: Team):  # type: ignore[no-untyped-def]
    from rockcli.engine.run import solve

    return solve(study(), sweep=sweep.Sweep(team))


def test_a_case_that_kills_every_worker_is_lost_alone(by) -> None:
    def deadly(batch: Batch) -> Response:
        if ((batch.theta_0 == 0.1) & (batch.block.R[:, 0] == 2.0) & (batch.model == "rigid")).any():
            os.kill(os.getpid(), signal.SIGSYS)
        return made_up(batch)

    by(worth=NEVER)
    whole = solved(study())
    by(deadly)
    found = solved(study(), 2)
    rest = np.ones(found.shape, dtype=bool)
    rest[0, 1, 9] = False
    assert found.values("outcome")[0, 1, 9] == FAILED
    assert found.values("reasons")[found.values("reason")[0, 1, 9]] == "the solver's process died of signal SIGSYS"
    for name in ("outcome", "n_impacts", "theta_peak_over_alpha"):
        np.testing.assert_array_equal(found.values(name)[rest], whole.values(name)[rest])


def test_what_is_the_users_fault_is_told_by_a_worker_too(by) -> None:
    def wrong(batch: Batch) -> Response:
        raise StudyError("no such method", line=3, file="x.yaml")

    by(wrong)
    with pytest.raises(StudyError, match=r"x.yaml:3: no such method"):
        solved(study(), 2)


@pytest.mark.parametrize("chunk", [7, 1])  # 1: a chunk in which nothing can be built
def test_what_breaks_while_it_is_built_is_a_failed_case(by, chunk: int) -> None:
    given = study()
    by(worth=NEVER)
    whole = solved(given)
    by(chunk=chunk)

    class Fading:
        def batches(self, indices):  # type: ignore[no-untyped-def]
            if 17 in indices:
                raise ValueError("no number at all")
            yield from given.cases.batches(indices)

    found = solved(replace(given, cases=Fading()), 2)
    flat = found.values("outcome").ravel()
    assert flat[17] == FAILED
    assert "no number at all" in found.values("reasons")[found.values("reason").ravel()[17]]
    np.testing.assert_array_equal(np.delete(flat, 17), np.delete(whole.values("outcome").ravel(), 17))
    assert found.fields["R"].dims == ("block_R",)  # the bad case does not blow up what is known of the others


SLOW = """\
import os, sys, time
from swept import made_up
from rockcli.engine.sweep import executors, sweep
from rockcli.engine.sweep import workers as pool
from rockcli.solvers.event import solver as event
def solve(batch):
    open(f"at-work-{os.getpid()}", "w").close()
    time.sleep(float(os.environ["SECONDS"]))
    return made_up(batch)
event.solve = solve
sweep.CHUNK, executors._worth = 1, lambda *_: True
from rockcli.cli.main import main
main()
"""


def running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize(("sign", "seconds"), [(signal.SIGKILL, 60.0), (signal.SIGKILL, 0.1), (signal.SIGINT, 60.0)])
def test_workers_end_with_their_parent(sign: signal.Signals, seconds: float, tmp_path: Path) -> None:
    """Also those that are done, or wait, before they look whether it is still there."""
    write_study(tmp_path)
    (tmp_path / "temporary").mkdir()
    process = subprocess.Popen(
        [sys.executable, "-c", SLOW, "run", "swept.yaml", "--no-plots", "--workers", "2"],
        cwd=tmp_path,
        env=os.environ
        | {
            "TMPDIR": str(tmp_path / "temporary"),
            "SECONDS": str(seconds),
            "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")]),
        },
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    limit = time.monotonic() + 60.0
    while len(workers := list(tmp_path.glob("at-work-*"))) < 2 and time.monotonic() < limit:
        time.sleep(0.02)
    pids = [int(file.name.rpartition("-")[2]) for file in workers]
    assert len(pids) == 2
    assert process.pid not in pids
    process.send_signal(sign)
    _, told = process.communicate(timeout=20.0)
    assert process.returncode == (130 if sign == signal.SIGINT else -9)
    assert told.startswith("rock: interrupted; run again to continue") == (sign == signal.SIGINT)
    limit = time.monotonic() + 20.0
    while any(running(pid) for pid in pids) and time.monotonic() < limit:
        time.sleep(0.05)
    assert not any(running(pid) for pid in pids)
    assert not list((tmp_path / "temporary").iterdir())


class Big:
    """Answers too big for a pipe that nobody reads; `tell` says which cases it has been given."""

    def __call__(self, cases):  # type: ignore[no-untyped-def]
        return np.repeat(cases, 8)

    def lost(self, cases, why):  # type: ignore[no-untyped-def]
        raise AssertionError(why)


@pytest.mark.parametrize("todo", [None, np.arange(400_000) % 2 == 0], ids=["runs", "every other"])
def test_neither_end_of_a_pipe_waits_for_the_other(todo) -> None:  # type: ignore[no-untyped-def]
    from rockcli.engine.sweep.workers import on_workers

    chunks, pace = Chunks(400_000, todo), Pace(1e-7, most=65536)
    wanted = np.arange(400_000) if todo is None else np.flatnonzero(todo)
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(60)  # a deadlock ends the tests rather than stopping them
    try:
        found = [cases for cases, answer in on_workers(Big(), chunks, pace, Team(2)) if len(answer) == 8 * len(cases)]
    finally:
        signal.alarm(0)
    np.testing.assert_array_equal(np.sort(np.concatenate(found)), wanted)
