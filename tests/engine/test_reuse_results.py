"""A study whose axes have got more points takes over what was solved before."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from swept import STUDY, assert_same, counting, solved, study

from rockcli.engine.run import check_study, run_study
from rockcli.errors import StudyError
from rockcli.motion.motion import Motion
from rockcli.scene.batch import Batch
from rockcli.scene.response import FAILED, Response
from rockcli.storage import netcdf
from rockcli.study.open import open_study


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    return counting(monkeypatch)


def with_axis(path: str, points: Any) -> Any:
    return study(vary=STUDY["vary"] | {path: points})


THETA = np.linspace(0.001, 0.1, 10).tolist()


@pytest.mark.parametrize(
    ("path", "points", "new"),
    [
        ("model", ["rigid", "3", "linearized"], 30),
        ("block.R", [1.0, 1.5, 2.0, 3.0, 9.0], 40),
        ("initial.theta", [0.0005, *reversed(THETA)], 6),
    ],
)
def test_only_the_new_points_are_solved(
    path: str, points: list[Any], new: int, tmp_path: Path, counted: list[int]
) -> None:
    run_study(study(), tmp_path, plots=False)
    counted.clear()
    longer = with_axis(path, points)
    check_study(longer, tmp_path)
    report = run_study(longer, tmp_path, plots=False)
    assert (report.taken_over, sum(counted), report.cases) == (60, new, 60 + new)
    found, wanted = netcdf.read(tmp_path / "swept" / "swept.nc"), solved(longer)
    found.attrs["solver_settings"] = wanted.attrs["solver_settings"]  # their order is that of the runs
    assert_same(wanted, found)


@pytest.mark.parametrize(
    "added", [{"block.mu": None}, {"block.mu": "2*alpha"}, {"block.mu": 0.7, "damping": "none"}], ids=str
)
def test_a_point_of_words_beside_points_of_numbers(added: dict[str, Any], tmp_path: Path, counted: list[int]) -> None:
    """Rows of numbers are columns until one has a word: they are the same rows."""
    rows = {name: {"block.mu": mu, "block.R": R} for name, mu, R in (("a", 0.5, 1.0), ("b", 0.6, 2.0))}
    run_study(study(vary={"case": rows}), tmp_path, plots=False)
    counted.clear()
    longer = study(vary={"case": {"new": {"block.R": 3.0} | added} | rows})
    report = run_study(longer, tmp_path, plots=False)
    assert (report.taken_over, sum(counted)) == (2, 1)
    found, wanted = netcdf.read(tmp_path / "swept" / "swept.nc"), solved(longer)
    found.attrs["solver_settings"] = wanted.attrs["solver_settings"]
    assert_same(wanted, found)


@pytest.mark.parametrize("before", [["third", "first", "second"], ["first", "second"]])
def test_equal_bodies_of_two_names_keep_their_own_answers(
    before: list[str], tmp_path: Path, counted: list[int]
) -> None:
    bodies = {name: {"model": "rigid", "block.R": R} for name, R in (("first", 2.0), ("second", 2.0), ("third", 1.0))}
    theta = {"initial.theta": THETA}
    run_study(study(vary={"case": {name: bodies[name] for name in before}} | theta), tmp_path, plots=False)
    counted.clear()
    again = study(vary={"case": {name: bodies[name] for name in ("third", "second", "first")}} | theta)
    report = run_study(again, tmp_path, plots=False)
    assert (report.taken_over, sum(counted)) == (10 * len(before), 30 - 10 * len(before))
    found, wanted = netcdf.read(tmp_path / "swept" / "swept.nc"), solved(again)
    found.attrs["solver_settings"] = wanted.attrs["solver_settings"]
    assert_same(wanted, found)


@pytest.mark.parametrize(
    "more",
    [
        {"vary": STUDY["vary"] | {"block.R": [1.0, 2.0, 4.0]}},  # a point is missing
        {"vary": STUDY["vary"] | {"block.R": [1.0, 2.0]}},
        {"vary": dict(reversed(STUDY["vary"].items()))},
        {"vary": STUDY["vary"] | {"let.k": [1.0]}, "let": {"k": 1.0}},
        {"case": {"block": {"R": 2.0, "tan_alpha": 0.21}, "initial": {"theta": 0.01}}},
        {"save": {"histories": False, "scalars": ["outcome"]}},
    ],
    ids=["other", "fewer", "order", "axis", "case", "save"],
)
def test_what_is_not_the_same_is_refused(more: dict[str, Any], tmp_path: Path, counted: list[int]) -> None:
    run_study(study(), tmp_path, plots=False)
    with pytest.raises(StudyError, match="--fresh` replaces it"):
        run_study(study(**more), tmp_path, plots=False)


def test_labels_that_fill_in_names_of_files_count(tmp_path: Path, counted: list[int]) -> None:
    """Two bodies that change records: each had the numbers of the other's record."""
    for name, period in (("one", 1.0), ("two", 1.7)):
        wave = 4.0 * np.sin(2.0 * np.pi / period * np.linspace(0.0, 5.0, 501))
        (tmp_path / f"{name}.txt").write_text("\n".join(f"{a:.9f}" for a in wave))
    record = {"file": f"{tmp_path}/{{case}}.txt", "units": "m/s2", "dt": 0.01}
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"record": record}}
    one, other = (
        study(case=case, vary={"case": {"one": {"block.R": R}, "two": {"block.R": 5.0 - R}}}) for R in (2.0, 3.0)
    )
    run_study(one, tmp_path, plots=False)
    counted.clear()
    with pytest.raises(StudyError, match="holds results of this study before it was changed"):
        run_study(other, tmp_path, plots=False)
    assert not counted


def test_another_version_is_refused(tmp_path: Path, counted: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    run_study(study(), tmp_path, plots=False)
    monkeypatch.setattr("rockcli.version.__version__", "99.0")
    with pytest.raises(StudyError, match="--fresh` replaces it"):
        run_study(with_axis("block.R", [1.0, 2.0, 3.0, 4.0]), tmp_path, plots=False)


def test_shares_take_over_too(tmp_path: Path, counted: list[int]) -> None:
    run_study(study(), tmp_path, plots=False)
    counted.clear()
    longer = with_axis("block.R", [1.0, 2.0, 3.0, 4.0])
    for k in (1, 2):
        run_study(longer, tmp_path, plots=False, share=(k, 2))
    report = run_study(longer, tmp_path, plots=False)
    assert (report.taken_over, report.resumed, sum(counted)) == (60, 20, 20)


def suite(folder: Path, names: list[str], **more: Any) -> Path:
    for name in names:
        path = folder / name
        if not path.exists():
            number = int(path.stem[1:])
            path.write_text("\n".join(f"{0.01 * i} {0.3 * np.sin(0.2 * number * i):.6f}" for i in range(60)))
    given = {
        "name": "suite",
        "case": {"block": {"R": 2.0, "tan_alpha": 0.1}, "motion": {"record": {"file": names[0], "units": "g"}}},
        "vary": {"motion.record.file": names, "motion.record.scale": [0.5, 1.0]},
        "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha", "reason"]},
    }
    path = folder / "suite.yaml"
    path.write_text(yaml.safe_dump(given | more, sort_keys=False))
    return path


def measured(batch: Batch) -> Response:
    """Made up from the record of the batch; the bad one breaks."""
    motion: Any = batch.excitation.horizontal
    if motion.name == "q13.txt":
        raise FloatingPointError("overflow")
    peak = np.abs(motion.values).max() * motion.factor
    outcome = np.ones(batch.size, dtype=np.int8)
    return Response(scalars={"outcome": outcome, "theta_peak_over_alpha": peak}, reasons=[""] * batch.size)


def test_an_added_record_solves_only_its_own_cases(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[str] = []

    def solver(batch: Batch) -> Response:
        seen.append(batch.excitation.horizontal.name)  # type: ignore[union-attr]
        return measured(batch)

    monkeypatch.setattr("rockcli.solvers.event.solver.solve", solver)
    run_study(open_study(suite(tmp_path, ["q3.txt", "q7.txt"])), tmp_path / "out", plots=False)
    seen.clear()
    longer = open_study(suite(tmp_path, ["q3.txt", "q5.txt", "q7.txt"]))
    report = run_study(longer, tmp_path / "out", plots=False)
    assert (seen, report.taken_over, report.cases) == (["q5.txt"], 4, 6)
    (tmp_path / "q7.txt").write_text((tmp_path / "q3.txt").read_text())  # other bytes under an old name
    with pytest.raises(StudyError, match="--fresh` replaces it"):
        run_study(open_study(suite(tmp_path, ["q3.txt", "q5.txt", "q7.txt", "q9.txt"])), tmp_path / "out", plots=False)


@pytest.mark.parametrize("breaks", ["the solver", "the reading", "the numbers"])
def test_one_poisoned_record_of_fifty(breaks: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    names = [f"q{i}.txt" for i in range(1, 51)]
    given = open_study(suite(tmp_path, names))
    monkeypatch.setattr("rockcli.solvers.event.solver.solve", measured)
    records: Any = given.cases.records  # type: ignore[attr-defined]
    bad_key = next(key for key in records.prepared if "q13.txt" in key[0])
    if breaks == "the reading":  # forgotten by the program and gone from the disk
        del records.prepared[bad_key]
        (tmp_path / "q13.txt").unlink()
    elif breaks == "the numbers":
        acceleration = Motion.acceleration

        def poisoned(self: Motion, g: float) -> Any:
            values = acceleration(self, g).copy()
            values[30] = np.nan if self.name == "q13.txt" else values[30]
            return values

        monkeypatch.setattr(Motion, "acceleration", poisoned)
        records.prepared[bad_key].unscaled.clear()  # what was measured when the study was opened
    report = run_study(given, tmp_path / "out", plots=False)
    assert (report.failed, report.exit_code) == (2, 3)
    found = netcdf.read(tmp_path / "out" / "suite" / "suite.nc")
    bad = names.index("q13.txt")
    assert (found.values("outcome")[bad] == FAILED).all()
    assert (np.delete(found.values("outcome"), bad, axis=0) != FAILED).all()
    sentence = found.values("reasons")[found.values("reason")[bad, 0]]
    assert ("overflow" if breaks == "the solver" else "q13.txt") in sentence
