"""Studies whose results are too large for memory: the same dataset, and memory that does not grow with the cases."""

from __future__ import annotations

import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from swept import assert_same, counting, solved, study, write_study
from typer.testing import CliRunner

from rockcli.cli.main import app
from rockcli.engine import run
from rockcli.engine.cost import memory
from rockcli.engine.run import run_study
from rockcli.engine.summary import SOLVED, UP_TO_DATE
from rockcli.engine.sweep import ahead, executors, parts, results, sweep
from rockcli.engine.sweep.work import Team
from rockcli.scene.batch import Batch
from rockcli.scene.response import Response
from rockcli.storage import netcdf, on_disk
from rockcli.study.study import Study

EXPECT = [
    {"quantity": "theta_peak_over_alpha", "max": 0.5},
    {"quantity": "outcome", "is": "failed", "at": {"initial.theta": 0.1}},
    {"quantity": "n_impacts", "min": 3, "at": {"block.R": 2.0}},
    {"quantity": "R", "value": 2.0},
    {"quantity": "R", "min": 1.0},
]


@pytest.fixture
def cramped(monkeypatch: pytest.MonkeyPatch) -> None:
    """Next to nothing may be in memory."""
    monkeypatch.setattr(on_disk, "IN_MEMORY", 16)
    monkeypatch.setattr(on_disk, "BLOCK", 7)
    monkeypatch.setattr(results, "LET_GO", 5)
    monkeypatch.setattr(sweep, "CHUNK", 4)


def told(given: Study, folder: Path) -> dict[str, Any]:
    """The report of a run, but for its place and time."""
    found = run_study(given, folder, plots=False).as_dict()
    return {key: value for key, value in found.items() if key not in ("file", "seconds", "status", "resumed")}


def test_the_dataset_and_the_report_are_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    counting(monkeypatch)
    given = study(expect=EXPECT)
    wanted = told(given, tmp_path / "memory")
    assert {verdict["passed"] for verdict in wanted["expect"]} == {True, False}
    assert wanted["failed"]
    with monkeypatch.context() as less:
        cramped.__wrapped__(less)  # type: ignore[attr-defined]
        assert told(given, tmp_path / "disk") == wanted
        assert told(given, tmp_path / "disk") == wanted  # of the finished dataset
        assert netcdf.is_intact(tmp_path / "disk" / "swept" / "swept.nc")
    paths = [tmp_path / where / "swept" / "swept.nc" for where in ("memory", "disk")]
    assert_same(*map(netcdf.read, paths))
    assert [file.name for file in (tmp_path / "disk" / "swept").iterdir()] == ["swept.nc"]


def test_more_points_and_a_broken_off_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cramped: None) -> None:
    counted = counting(monkeypatch)
    fewer = {"vary": {"model": ["rigid"], "block.R": [3.0, 1.0], "initial.theta": [0.1, 0.001, 0.012]}}
    run_study(study(**fewer), tmp_path, plots=False)
    monkeypatch.setattr(parts, "EVERY", -1.0)
    keep = parts.Parts.keep

    def killed(self: parts.Parts, answer: Any) -> None:
        keep(self, answer)
        raise KeyboardInterrupt

    with monkeypatch.context() as once:
        once.setattr(parts.Parts, "keep", killed)
        with pytest.raises(KeyboardInterrupt):
            run_study(study(), tmp_path, plots=False)
    report = run_study(study(), tmp_path, plots=False)
    assert (report.taken_over, report.resumed) == (6, 4)
    assert sum(counted) == 60
    assert_same(solved(study()), netcdf.read(tmp_path / "swept" / "swept.nc"))


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("refused", [False, True], ids=["written ahead", "refused meanwhile"])
def test_results_are_written_while_others_are_solved(
    workers: int, refused: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    counting(monkeypatch)
    run_study(study(), tmp_path / "at once", plots=False)
    for where, name, value in (
        (ahead, "WORTH", 0), (netcdf, "_COMPRESSED_FROM", 1), (netcdf, "_PIECE", 4), (sweep, "CHUNK", 4),
        (executors, "_worth", lambda *_: True),
    ):  # fmt: skip
        monkeypatch.setattr(where, name, value)
    left: list[int] = []
    written: list[int] = []
    ends: list[int] = []
    finish, write = netcdf.Writer.finish, netcdf._Rest.write_next

    def watched(self: netcdf.Writer, contents: Any) -> None:
        left.extend(len(rest.blocks) for rest in self._rests.values())
        ends.append(len(written))
        finish(self, contents)

    def counted(self: netcdf._Rest) -> None:
        written.append(len(self.blocks))
        if refused and not ends and len(written) == 9:
            raise RuntimeError("NetCDF: HDF error")
        write(self)

    monkeypatch.setattr(netcdf.Writer, "finish", watched)
    monkeypatch.setattr(netcdf._Rest, "write_next", counted)
    run_study(study(), tmp_path / "ahead", plots=False, team=Team(workers))
    if workers == 1:  # of two one may answer the first cases last
        assert (left, ends) == ([], [9]) if refused else sum(left) < 0.5 * len(written) < ends[0]
    paths = [tmp_path / where / "swept" / "swept.nc" for where in ("at once", "ahead")]
    one, other = map(netcdf.read, paths)
    assert_same(one, other)
    assert list(one.fields) == list(other.fields)
    assert netcdf.is_intact(paths[1])
    assert [file.name for file in paths[1].parent.iterdir()] == ["swept.nc"]


def rows(n: int) -> Study:
    axes = {"block.R": {"from": 1.0, "to": 3.0, "n": n}, "initial.theta": {"from": 1e-3, "to": 0.1, "n": 2000}}
    return study(
        vary=axes, save={"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]}, expect=EXPECT[:1]
    )


def plain(batch: Batch) -> Response:
    scalars = {"outcome": np.ones(batch.size, dtype=np.int8), "theta_peak_over_alpha": batch.theta_0}
    return Response(scalars=scalars, reasons=[""] * batch.size, used={"backend": "made up"})


def most(given: Study, folder: Path, status: str) -> int:
    """Memory that Python and numpy ask for at most while a study is run [bytes]."""
    tracemalloc.start()
    try:
        assert run_study(given, folder, plots=False).status == status
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_memory_does_not_grow_with_the_cases(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor when the finished dataset is checked and judged again; in memory it grows by the nine bytes of a case."""
    counting(monkeypatch, plain)
    monkeypatch.setattr(sweep, "CHUNK", 2000)
    monkeypatch.setattr(parts, "MOST", 2000)
    monkeypatch.setattr(on_disk, "BLOCK", 4000)
    monkeypatch.setattr(netcdf, "_pitch", lambda variable: ())  # what is compressed together is some 4 MB
    few, many = rows(10), rows(80)
    more = many.size - few.size

    def growth(where: str, status: str, expected: float) -> float:
        """Of a second run where the first takes more: what is loaded once, or by another thread, is not of the study."""
        once, again = (tmp_path / where / name for name in ("once", "again" if status == SOLVED else "once"))
        base = most(few, once / "few", status)
        found = (most(many, once / "many", status) - base) / more
        return found if found <= expected else min(found, (most(many, again / "many", status) - base) / more)

    most(few, tmp_path / "first", SOLVED)  # imports
    assert growth("memory", SOLVED, 9.5) > 8.5  # nine, but for what the smaller study asks for besides
    monkeypatch.setattr(on_disk, "IN_MEMORY", 10_000)
    assert growth("disk", SOLVED, 1.0) < 1.0
    assert growth("disk", UP_TO_DATE, 1.0) < 1.0


def test_the_estimate_stops_growing() -> None:
    assert memory(rows(100_000), 0.0) == memory(rows(50_000), 0.0) < 4e8


def test_a_figure_of_too_many_cases_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    counting(monkeypatch)
    monkeypatch.setattr(run, "DRAWN", 59)
    path = write_study(tmp_path)
    found = CliRunner().invoke(app, ["run", str(path), "--out", str(tmp_path)])
    assert "not drawn: of 60 cases" in found.output
    assert not list((tmp_path / "swept").glob("*.png"))
