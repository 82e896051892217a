"""What is finished is never lost, doubled or mixed, wherever a run is ended."""

from __future__ import annotations

import json
import resource
import shutil
import signal
import subprocess
import sys
import time
import weakref
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from swept import CASES, STUDY, assert_same, counting, made_up, solved, stop_after, study, write_study

from rockcli.engine.lock import LOCK_NAME, locked
from rockcli.engine.run import check_study, run_study, solve
from rockcli.engine.summary import SHARE, SOLVED, UP_TO_DATE
from rockcli.engine.sweep import chunks, parts, sweep
from rockcli.engine.sweep.chunk_result import ChunkResult, blank, cases_of, spans_of
from rockcli.engine.sweep.parts import FOLDER, Parts
from rockcli.engine.sweep.settings_used import joined
from rockcli.engine.sweep.work import Team
from rockcli.errors import OutputError, StudyError
from rockcli.storage import netcdf
from rockcli.storage.part import read_part, write_part


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Cases solved, batch by batch; three at a time, every one kept at once."""
    monkeypatch.setattr(sweep, "CHUNK", 3)
    monkeypatch.setattr(parts, "EVERY", -1.0)
    return counting(monkeypatch)


def break_off(folder: Path, monkeypatch: pytest.MonkeyPatch, chunks: int = 5, *, fresh: bool = False) -> None:
    """Interrupt a run after some chunks."""
    with monkeypatch.context() as once:
        stop_after(once, chunks, KeyboardInterrupt)
        with pytest.raises(KeyboardInterrupt):
            run_study(study(), folder, plots=False, fresh=fresh)


def hidden(folder: Path) -> list[Path]:
    return sorted((folder / "swept" / FOLDER).rglob("*.npz"))


def test_a_broken_off_run_goes_on(tmp_path: Path, counted: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    whole = solved(study())
    counted.clear()
    break_off(tmp_path, monkeypatch)
    assert sum(counted) == 15
    assert len(hidden(tmp_path)) == 5
    report = run_study(study(), tmp_path, plots=False)
    assert sum(counted) == CASES
    assert (report.status, report.resumed) == (SOLVED, 15)
    assert_same(whole, netcdf.read(tmp_path / "swept" / "swept.nc"))
    assert [file.name for file in (tmp_path / "swept").iterdir()] == ["swept.nc"]
    assert run_study(study(), tmp_path, plots=False).status == UP_TO_DATE


def test_what_waits_is_written_on_interrupt(
    tmp_path: Path, counted: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parts, "EVERY", 1e9)
    break_off(tmp_path, monkeypatch, 4)
    assert len(hidden(tmp_path)) == 1
    assert run_study(study(), tmp_path, plots=False).resumed == 12


def test_parts_of_another_study_never_mix(tmp_path: Path, counted: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    break_off(tmp_path, monkeypatch)
    other = study(case={"block": {"R": 2.0, "tan_alpha": 0.3}, "initial": {"theta": 0.01}})
    wrong = tmp_path / "swept" / FOLDER / other.identity[:16]
    hidden(tmp_path)[0].parent.rename(wrong)  # the right name, and still not its own
    assert run_study(other, tmp_path, plots=False).resumed == 0


def test_another_study_leaves_parts_alone(tmp_path: Path, counted: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    """A wrong turn, as a mistyped `--set`, costs nothing of what a long run has finished."""
    break_off(tmp_path, monkeypatch)
    other = study(case={"block": {"R": 2.0, "tan_alpha": 0.3}, "initial": {"theta": 0.01}})
    run_study(other, tmp_path, plots=False)
    assert len(hidden(tmp_path)) == 5
    (tmp_path / "swept" / "swept.nc").unlink()
    assert run_study(study(), tmp_path, plots=False).resumed == 15
    assert hidden(tmp_path) == []


def test_a_part_whose_directory_is_damaged_is_none(tmp_path: Path) -> None:
    """Of an archive the directory alone has no checksum: an entry may vanish, or want a password."""
    part = tmp_path / "1.npz"
    write_part(part, {"one": np.arange(3.0), "two": np.arange(2)}, {"said": ["so"]})
    whole, damaged = part.read_bytes(), 0
    for at in range(whole.index(b"PK\x01\x02"), len(whole)):
        for flipped in (1, 8, 255):
            part.write_bytes(whole[:at] + bytes([whole[at] ^ flipped]) + whole[at + 1 :])
            found = read_part(part)
            damaged += found is None
            assert found is None or (found[0].keys() == {"one", "two"} and found[1] == {"said": ["so"]})
    assert damaged > 100


def test_damaged_parts_are_solved_again(tmp_path: Path, counted: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    whole = solved(study())
    break_off(tmp_path, monkeypatch)
    one, two, three, *_ = hidden(tmp_path)
    one.write_bytes(one.read_bytes()[:-200])
    two.write_bytes(b"")
    turned = bytearray(three.read_bytes())
    turned[len(turned) // 2] ^= 255
    three.write_bytes(bytes(turned))
    report = run_study(study(), tmp_path, plots=False)
    assert 6 <= report.resumed <= 9  # the turned bit may stand where nobody reads
    assert any("were damaged and were solved again" in warning for warning in report.warnings)
    assert_same(whole, netcdf.read(tmp_path / "swept" / "swept.nc"))


def test_parts_of_a_run_that_was_killed_after_its_dataset_go(
    tmp_path: Path, counted: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    break_off(tmp_path, monkeypatch)
    left = tmp_path / "swept" / FOLDER
    shutil.copytree(left, tmp_path / "kept")
    run_study(study(), tmp_path, plots=False)
    (tmp_path / "kept").rename(left)
    assert run_study(study(), tmp_path, plots=False).status == UP_TO_DATE
    assert [file.name for file in (tmp_path / "swept").iterdir()] == ["swept.nc"]


def test_fresh_forgets_parts(tmp_path: Path, counted: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    break_off(tmp_path, monkeypatch)
    assert run_study(study(), tmp_path, plots=False, fresh=True).resumed == 0


@pytest.mark.parametrize("there", [{"R": 2.0, "tan_alpha": 0.3}, STUDY["case"]["block"]], ids=["other", "same"])
def test_a_fresh_run_that_was_broken_off_goes_on_without_fresh(
    there: dict[str, float], tmp_path: Path, counted: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    other = study(case={"block": there, "initial": {"theta": 0.01}})
    run_study(other, tmp_path, plots=False)
    break_off(tmp_path, monkeypatch, fresh=True)
    check_study(study(), tmp_path)
    counted.clear()
    report = run_study(study(), tmp_path, plots=False)
    assert (report.status, report.resumed, sum(counted)) == (SOLVED, 15, CASES - 15)
    assert_same(solved(study()), netcdf.read(tmp_path / "swept" / "swept.nc"))
    assert [file.name for file in (tmp_path / "swept").iterdir()] == ["swept.nc"]


def test_a_full_disk_keeps_what_was_finished(
    tmp_path: Path, counted: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "no space")

    keep, seen = Parts.keep, []

    def kept(self: Parts, answer: ChunkResult) -> None:
        if len(seen) == 5:
            monkeypatch.setattr(np, "savez", full)
        keep(self, answer)
        seen.append(answer)

    with monkeypatch.context() as once:
        once.setattr(Parts, "keep", kept)
        with pytest.raises(OutputError, match="no space left on the device; run again once that is fixed"):
            run_study(study(), tmp_path, plots=False)
    monkeypatch.undo()
    assert len(hidden(tmp_path)) == 5
    monkeypatch.setattr("rockcli.solvers.event.solver.solve", made_up)
    assert run_study(study(), tmp_path, plots=False).resumed == 15


@pytest.mark.parametrize("ends", [KeyboardInterrupt, None])
def test_a_folder_that_cannot_be_made_is_told_as_a_part_that_cannot_be_written(
    ends: type[BaseException] | None, tmp_path: Path, counted: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on a disk without room for one; the system's error took the place of the interrupt, and lacked the advice."""
    (tmp_path / "swept").mkdir()
    (tmp_path / "swept" / FOLDER).write_text("")
    if ends is not None:
        monkeypatch.setattr(parts, "EVERY", 60.0)
        stop_after(monkeypatch, 2, ends)
    with pytest.raises(ends or OutputError, match=None if ends else "could not be kept and will be solved again"):
        run_study(study(), tmp_path, plots=False)


def test_a_part_holds_everything(tmp_path: Path) -> None:
    cases = np.array([0, 1, 2, 7, 9, 10], dtype=np.int64)
    answer = ChunkResult(cases, blank(("outcome", "theta_peak", "n_steps", "reason"), 6))
    answer.sentences = {"naïve: a sentence": np.array([2, 9])}
    answer.used = [(7, {"backend": "x"})]
    answer.time = np.arange(4) * 0.1
    answer.histories = {"theta": np.arange(24.0).reshape(6, 4)}
    answer.impacts = {"t_impact": np.full((6, 1), np.nan)}
    answer.shaken = {"a_g": np.array([4, 4, 3, 0, 1, 4])}
    keeper = Parts(tmp_path, study())
    keeper.keep(answer)
    keeper.flush()
    (found,) = Parts(tmp_path, study()).kept()
    np.testing.assert_array_equal(found.cases, cases)
    assert found.used == answer.used
    for kind in ("scalars", "sentences", "histories", "impacts", "shaken"):
        mine, theirs = getattr(answer, kind), getattr(found, kind)
        assert mine.keys() == theirs.keys()
        for name in mine:
            assert mine[name].dtype == theirs[name].dtype
            np.testing.assert_array_equal(mine[name], theirs[name])
    some = found.among(np.isin(cases, [2, 7]))
    assert some.cases.tolist() == [2, 7]
    assert [where.tolist() for where in some.sentences.values()] == [[2]]
    assert some.histories["theta"].tolist() == [[8.0, 9.0, 10.0, 11.0], [12.0, 13.0, 14.0, 15.0]]
    assert some.shaken["a_g"].tolist() == [3, 0]


def test_parts_of_another_format_are_passed_over(
    tmp_path: Path, counted: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = solved(study())
    monkeypatch.setattr(parts, "_FORMAT", 1)
    run_study(study(), tmp_path, plots=False, share=(1, 2))
    assert len(list(Parts(tmp_path / "swept", study()).kept())) > 0
    monkeypatch.undo()
    monkeypatch.setattr("rockcli.solvers.event.solver.solve", made_up)
    assert list(Parts(tmp_path / "swept", study()).kept()) == []
    assert run_study(study(), tmp_path, plots=False).resumed == 0
    assert_same(whole, netcdf.read(tmp_path / "swept" / "swept.nc"))


@pytest.mark.parametrize("cases", [[5], [0, 1, 2], [1, 3, 5], [0, 1, 4, 5, 6, 9]])
def test_spans(cases: list[int]) -> None:
    assert cases_of(spans_of(np.array(cases))).tolist() == cases


@pytest.mark.parametrize("shares", [1, 3, 7])
def test_shares_are_merged_to_the_same_file(tmp_path: Path, counted: list[int], shares: int) -> None:
    whole = solved(study())
    counted.clear()
    for k in reversed(range(1, shares + 1)):
        report = run_study(study(), tmp_path, plots=False, share=(k, shares))
        assert (report.status, report.share, report.exit_code) == (SHARE, (k, shares), 0)
    assert sum(counted) == CASES
    assert not (tmp_path / "swept" / "swept.nc").exists()
    report = run_study(study(), tmp_path, plots=False)
    assert (report.resumed, sum(counted)) == (CASES, CASES)
    assert_same(whole, netcdf.read(tmp_path / "swept" / "swept.nc"))


def test_overlapping_shares_double_nothing(tmp_path: Path, counted: list[int]) -> None:
    whole = solved(study())
    for share in ((1, 2), (2, 3), (3, 3)):
        keeper = Parts(tmp_path / "swept", study())
        done = sweep.Sweep(sweep.Team(), keeper=_Deaf(keeper), share=share)
        sweep.solve_share(study(), done)
        keeper.flush()
    run_study(study(), tmp_path, plots=False)
    found = netcdf.read(tmp_path / "swept" / "swept.nc")
    assert_same(whole, found)


@pytest.mark.parametrize("turned", [None, ((3, 4, 5), 1)])
def test_shares_hold_spans_of_cases_not_the_study(turned: tuple[tuple[int, ...], int] | None) -> None:
    found = []
    for k in range(1, 4):
        spans = sweep._of_share(60, k, 3)
        left = chunks.without(spans, [(7, 9), (20, 33)])
        wanted = {place for first, stop in spans for place in range(first, stop)} - {7, 8, *range(20, 33)}
        assert {place for first, stop in left for place in range(first, stop)} == wanted
        assert chunks.counted(left) == len(wanted)
        handed = chunks.Chunks(60, left, turned)
        while handed.left:
            cases = handed.take(4)
            assert (np.diff(cases) > 0).all()
            assert set(chunks.places_in_turn(cases, turned).tolist()) <= wanted
            found += cases.tolist()
    assert len(set(found)) == len(found) == 60 - 15


@pytest.mark.slow
def test_a_share_of_a_study_that_nobody_could_hold(tmp_path: Path) -> None:
    """10^10 cases, whose outcomes alone are 10 GB: a share of 10^5 of them is solved in the memory of one."""
    axes = {f"motion.pulse.{name}": {"from": 0.1, "to": 1.0, "n": 100_000} for name in ("a_p", "T_p")}
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": {"shape": "sine", "a_p": 1.0, "T_p": 1.0}}}
    (tmp_path / "large.yaml").write_text(
        json.dumps({"name": "large", "case": case, "vary": axes, "save": {"scalars": ["outcome"]}})
    )
    command = [sys.executable, "-m", "rockcli", "run", "large.yaml", "--part", "1/100000", "--quiet", "--workers", "1"]
    subprocess.run(command, cwd=tmp_path, check=True)
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss < 1 << 20


class _Full:
    """Has every case, each in a part of its own, and counts how many of them are held at once."""

    damaged = 0
    most = 0

    def kept(self):  # type: ignore[no-untyped-def]
        held: weakref.WeakSet[ChunkResult] = weakref.WeakSet()
        for case in range(CASES):
            answer = ChunkResult(np.array([case]), {})
            held.add(answer)
            self.most = max(self.most, len(held))
            yield answer
            del answer

    def keep(self, answer: ChunkResult) -> None:
        raise AssertionError


def test_a_share_holds_no_parts_but_the_one_it_looks_at() -> None:
    keeper = _Full()
    assert sweep.solve_share(study(), sweep.Sweep(Team(), keeper, (1, 2))) == CASES
    assert keeper.most <= 2


class _Deaf:
    """Keeps, and does not look at what others have kept."""

    damaged = 0

    def __init__(self, keeper: Parts) -> None:
        self.keeper = keeper

    def kept(self):  # type: ignore[no-untyped-def]
        return iter(())

    def keep(self, answer: ChunkResult) -> None:
        self.keeper.keep(answer)


def test_shares_work_side_by_side_and_keep_others_out(tmp_path: Path, counted: list[int]) -> None:
    folder = tmp_path / "swept"
    with locked(folder, (1, 2)):
        with locked(folder, (2, 2)):
            pass
        with pytest.raises(StudyError, match="share 1/2"), locked(folder, (1, 2)):
            pass
        with pytest.raises(StudyError, match="another process is working in this folder"), locked(folder):
            pass
        assert [path.name for path in folder.iterdir()] == [f"{LOCK_NAME}-1-of-2"]
    with locked(folder), pytest.raises(StudyError, match="another process"), locked(folder, (1, 2)):
        pass
    assert list(folder.iterdir()) == []


def test_a_searched_range_has_no_shares(tmp_path: Path) -> None:
    searched = study(vary={"initial.theta": {"from": 0.01, "to": 0.3, "n": 5, "find": "overturning"}}, save={})
    with pytest.raises(StudyError, match="--part cannot divide a search"):
        run_study(searched, tmp_path, share=(1, 2))


KILLED = """\
import os, sys, time
from swept import made_up
from rockcli.engine.sweep import executors, parts, sweep
from rockcli.solvers.event import solver as event
def solve(batch):
    time.sleep(0.01 * batch.size)
    with open("solved", "a") as log:
        log.writelines(f"{model} {R} {theta}\\n" for model, R, theta in
            zip([batch.model] * batch.size, batch.block.R[:, 0], batch.theta_0))
    return made_up(batch)
event.solve = solve
sweep.CHUNK, parts.EVERY, executors._worth = 2, -1.0, lambda *_: True
from rockcli.cli.main import main
main()
"""


@pytest.mark.parametrize(
    ("workers", "kills"),
    [(2, (3,)), pytest.param(1, (3, 8, 12), marks=pytest.mark.slow), pytest.param(2, (2, 9), marks=pytest.mark.slow)],
)
def test_a_killed_run_goes_on(
    workers: int, kills: tuple[int, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_study(tmp_path)
    command = [sys.executable, "-c", KILLED, "run", path.name, "--no-plots", "--workers", str(workers)]
    environment = {"PYTHONPATH": str(Path(__file__).parent), "PATH": "/usr/bin:/bin"}
    for enough in kills:
        process = subprocess.Popen(command, cwd=tmp_path, env=environment, stdout=subprocess.DEVNULL)
        limit = time.monotonic() + 60.0
        while len(list((tmp_path / "results").rglob("*.npz"))) < enough and time.monotonic() < limit:
            time.sleep(0.002)
        process.send_signal(signal.SIGKILL)
        process.wait()
    assert not (tmp_path / "results" / "swept" / "swept.nc").exists()
    time.sleep(1.0)  # workers notice within half a second
    subprocess.run(command, cwd=tmp_path, env=environment, check=False, stdout=subprocess.DEVNULL)
    monkeypatch.setattr("rockcli.solvers.event.solver.solve", made_up)
    assert_same(solved(study()), netcdf.read(tmp_path / "results" / "swept" / "swept.nc"))
    assert [file.name for file in (tmp_path / "results" / "swept").iterdir()] == ["swept.nc"]
    said = (tmp_path / "solved").read_text().splitlines()
    assert len(set(said)) == CASES
    # solved twice: at most what was at work, on its way or unwritten when it was killed
    assert len(said) <= CASES + 6 * workers * len(kills)


def test_the_disk_that_is_full_for_the_dataset(tmp_path: Path, counted: list[int]) -> None:
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (8192, before[1]))  # room for parts, not for the dataset
        with pytest.raises(OutputError):
            run_study(study(), tmp_path, plots=False)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    counted.clear()
    assert run_study(study(), tmp_path, plots=False).resumed == CASES
    assert not counted


def test_two_runs_into_one_folder(tmp_path: Path, counted: list[int]) -> None:
    with locked(tmp_path / "swept"), pytest.raises(StudyError, match="another process"):
        run_study(study(), tmp_path, plots=False)
    assert not counted


def test_resolved_anew_after_a_longer_study(tmp_path: Path, counted: list[int]) -> None:
    """Parts go once the dataset is there, so that nothing of an older study can come back."""
    run_study(study(), tmp_path, plots=False)
    again = run_study(replace(study(), identity="0" * 64), tmp_path, plots=False, fresh=True)
    assert again.resumed == 0
    assert hidden(tmp_path) == []


class TestSettings:
    """Those of the solvers are the same whoever solved which cases together."""

    STUDY = {  # noqa: RUF012
        "case": {
            "block": {"R": 2.0, "tan_alpha": 0.2},
            "motion": {"pulse": {"shape": "sine", "a_p_over_g_tan_alpha": 1.5, "omega_p_over_p": 12}, "duration": 0.4},
            "model": 3,
        },
        "vary": {
            "case": {
                "event": {"solver": {"backend": "event"}},
                "scipy": {"solver": {"backend": "scipy", "rtol": 1e-6}},
                "frame": {
                    "model": 4,
                    "geometry": "corotational",
                    "damping": {"scheme": "hht", "alpha_d": 0.7},
                    "base": {"law": "winkler", "kw": 1e8},
                    "solver": {"backend": "frame", "accuracy": "draft"},
                },
            },
            "block.R": [1.0, 2.0, 3.0],
        },
        "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]},
    }

    @staticmethod
    def settings(folder: Path) -> list[dict[str, str]]:
        return json.loads(netcdf.read(folder / "swept" / "swept.nc").attrs["solver_settings"])

    def test_of_shares(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        asked = study(**self.STUDY)
        run_study(asked, tmp_path / "whole", plots=False)
        monkeypatch.setattr(sweep, "CHUNK", 2)
        for k in (3, 1, 2):
            run_study(asked, tmp_path / "shares", plots=False, share=(k, 3))
        run_study(asked, tmp_path / "shares", plots=False)
        whole = self.settings(tmp_path / "whole")
        assert self.settings(tmp_path / "shares") == whole
        assert [one["backend"] for one in whole] == ["event", "scipy", "frame"]
        assert " ... " in whole[2]["dt"]  # of three sizes

    @pytest.mark.parametrize(
        ("case", "vary", "said"),
        [
            (
                {
                    "model": 4,
                    "geometry": "corotational",
                    "damping": {"scheme": "hht", "alpha_d": 0.7},
                    "base": {"law": "winkler", "kw": 1e8},
                    "solver": {"backend": "frame", "accuracy": "draft"},
                },
                {"damping.alpha_d": [0.7, 0.8, 0.9]},
                [("alpha_d", "0.7 ... 0.9")],
            ),
            (
                {
                    "model": "flexible",
                    "column": {"E": 1e9, "rho": 2500},
                    "solver": {"backend": "frame", "accuracy": "draft"},
                },
                {"column.zeta": [0.0, 0.01, 0.02]},
                [("stiffness_damping", "0 ... ")],
            ),
            (
                {
                    "block": {"mesh": "frustum.obj", "density": 2500},
                    "model": "rigid",
                    "motion": {
                        "pulse": {"shape": "half_sine", "a_p": 3, "T_p": 1},
                        "vertical": "synthetic_rock_m65.AT2",
                    },
                },
                {
                    "block.direction": [0.0, 1.0, "90*deg"]
                },  # along x it rolls from vertex to vertex, along y it does not
                [("method", "vertex to vertex"), ("method", "events located")],
            ),
        ],
    )
    def test_of_chunks(
        self, case: dict, vary: dict, said: list, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        sections = [(0.3, 0.0), (0.45, 0.1), (0.45, 2.0)]
        corners = [(x, y, z) for a, z in sections for x, y in ((-a, -0.4), (a, -0.4), (a, 0.4), (-a, 0.4))]
        sides = [(k + i, k + (i + 1) % 4, k + 4 + (i + 1) % 4, k + 4 + i) for k in (0, 4) for i in range(4)]
        faces = [" ".join(str(i + 1) for i in face) for face in [(0, 3, 2, 1), (8, 9, 10, 11), *sides]]
        lines = [*(f"v {x} {y} {z}" for x, y, z in corners), *(f"f {face}" for face in faces)]
        (tmp_path / "frustum.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
        monkeypatch.chdir(tmp_path)
        asked = study(**{**self.STUDY, "case": {**self.STUDY["case"], **case}, "vary": vary})
        found = []
        for most in (1, 2, 100):
            monkeypatch.setattr(sweep, "CHUNK", most)
            found.append(json.loads(solve(asked).attrs["solver_settings"]))
        assert found[0] == found[1] == found[2]
        assert [words in one[key] for (key, words), one in zip(said, found[0], strict=True)] == [True] * len(said)

    def test_one_after_the_other(self) -> None:
        entries = [
            (0, {"backend": "frame", "dt": "0.001", "divided_steps": "2"}),
            (1, {"backend": "frame", "dt": "0.002 ... 0.004", "divided_steps": "0"}),
            (2, {"backend": "frame", "dt": "0.0005", "divided_steps": "2"}),
            (3, {"backend": "event", "dt": "T_p/50, 0.1/p", "rtol": "1e-08"}),
            (4, {"backend": "event", "dt": "T_p/50, 0.1/p", "rtol": "1e-10"}),
            (5, {"backend": "frame", "dt": "-", "divided_steps": "0"}),
        ]
        wanted = [(0, {"backend": "frame", "dt": "0.0005 ... 0.004", "divided_steps": "4"}), *entries[3:5]]
        for order in ([0, 1, 2, 3, 4, 5], [5, 4, 2, 0, 3, 1]):
            assert joined(entries[i] for i in order) == wanted
        assert joined(joined(entries[:2]) + joined(entries[2:])) == wanted


def test_locks_that_killed_shares_left_go_with_the_merge(tmp_path: Path, counted: list[int]) -> None:
    folder = tmp_path / "swept"
    run_study(study(), tmp_path, plots=False, share=(1, 2))
    for name in (LOCK_NAME, f"{LOCK_NAME}-2-of-2"):
        (folder / name).touch()
    run_study(study(), tmp_path, plots=False)
    assert [file.name for file in folder.iterdir()] == ["swept.nc"]
