"""Cases of many records in one batch: the numbers of each record alone, each file read once, errors where they belong."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rockcli import kernels
from rockcli.engine.sweep.chunks import Chunks
from rockcli.engine.sweep.sweep import Sweep, solve_cases
from rockcli.engine.sweep.work import Team
from rockcli.errors import RecordError, StudyError
from rockcli.motion import reading
from rockcli.motion.at2 import at2_text
from rockcli.study.open import open_study
from rockcli.study.study import Study

BLOCK = {"R": 2, "tan_alpha": 0.2}
RECORDS = {"a": (900, 0.005), "b": (1201, 0.01), "c": (320, 0.02), "d": (64, 0.1), "e": (62, 0.1), "weak": (400, 0.01)}
"""Samples and time step of every record: lengths of a block of bounds, and two and one short of one, among them."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of records unlike one another."""
    place, rng = tmp_path_factory.mktemp("suite"), np.random.default_rng(7)
    for name, (n, dt) in RECORDS.items():
        t = np.arange(n) * dt
        a = sum(rng.normal() * np.sin(2.0 * np.pi * f * t + rng.uniform(0.0, 6.0)) for f in rng.uniform(0.3, 2.5, 6))
        a *= (0.01 if name == "weak" else 0.4) * np.sin(np.pi * t / t[-1]) / np.abs(a).max()
        (place / f"{name}.AT2").write_text(at2_text(a, dt, ["x", name]))
    return place


def study(
    folder: Path, *, block: dict[str, Any] = BLOCK, save: dict[str, Any] | None = None, **more: Any
) -> dict[str, Any]:
    """Every record at some scales."""
    vary = {"motion.record.scale": [0.5, 1.0, 2.5, 6.0], "motion.record.file": f"{folder}/*.AT2"}
    case = {"block": block, "motion": {"record": {"scale": 1.0}}, **more}
    return {"name": "s", "case": case, "vary": vary, "save": {"histories": False, **(save or {})}}


def solved(what: Study, *, together: bool) -> dict[str, Any]:
    """Scalars of a study, its records together or one by one."""
    if not together:
        what.cases.suites = what.cases.batches  # type: ignore[attr-defined]
    found = solve_cases(what, sweep=Sweep(Team()))
    pga = found.symbols.over("pga", tuple(axis.name for axis in what.axes))
    assert pga is not None
    return {name: values for name, values in found.scalars.items() if name != "wall_time"} | {"pga": pga[1]}


@pytest.mark.parametrize(
    "more",
    [
        {},
        {"save": {"scalars": ["outcome", "theta_peak_over_alpha"]}},
        {"initial": {"theta": 0.02, "theta_dot": -0.1}},
        {"block": {**BLOCK, "mu": 0.25}},
        {"block": {"h": 2, "b": [0.3, 0.5]}},
        {"model": "linearized"},
        {"damping": {"scheme": "dashpot", "coefficient": 50.0}},
        {"model": "flexible", "column": {"E": 1e9, "rho": 2500, "zeta": 0.02, "elements": 2}},
    ],
    ids=["default", "two", "moving", "friction", "asymmetric", "linearized", "dashpot", "flexible"],
)
def test_every_case_is_as_with_its_record_alone(folder: Path, more: dict[str, Any]) -> None:
    kernels.load(compile_them=True)
    one, other = (solved(open_study(study(folder, **more)), together=together) for together in (False, True))
    assert one.keys() == other.keys()
    for name in one:
        np.testing.assert_array_equal(one[name], other[name], err_msg=name)
    assert len(set(one["outcome"].tolist())) > 1


@pytest.mark.parametrize("key", ["motion.record", "motion.record.file"])
def test_many_records_are_one_batch(folder: Path, key: str) -> None:
    plan = study(folder)
    plan["vary"][key] = plan["vary"].pop("motion.record.file")
    what = open_study(plan)
    batches = list(what.suites(np.arange(what.size)))
    assert [batch.size for _, batch in batches] == [what.size]
    assert len(list(what.batches())) == len(RECORDS)


@pytest.mark.parametrize("order", [1, -1])
def test_each_file_is_read_once(folder: Path, monkeypatch: pytest.MonkeyPatch, order: int) -> None:
    read: Counter[str] = Counter()
    bytes_of = reading.record_bytes

    def counted(path: Path) -> bytes:
        read[path.name] += 1
        return bytes_of(path)

    monkeypatch.setattr(reading, "record_bytes", counted)
    plan = study(folder)
    plan["vary"] = dict(list(plan["vary"].items())[::order])
    solve_cases(open_study(plan))
    assert dict(read) == {f"{name}.AT2": 1 for name in RECORDS}


def test_what_is_wrong_with_one_record_is_told_of_it(folder: Path, tmp_path: Path) -> None:
    names = [str(folder / "a.AT2"), str(tmp_path / "bad.AT2"), str(folder / "b.AT2")]
    plan = study(folder)
    plan["vary"]["motion.record.file"] = names
    with pytest.raises(RecordError, match=r"bad\.AT2' was not found"):
        open_study(plan)
    Path(names[1]).write_text((folder / "c.AT2").read_text().replace("NPTS=    320", "NPTS=    321"))
    with pytest.raises(RecordError, match=r"bad\.AT2.*announces 321 values and only 320 follow"):
        open_study(plan)
    Path(names[1]).write_text(at2_text(np.zeros(50), 0.01, ["x", "y"]))
    del plan["vary"]["motion.record.scale"]
    plan["case"]["motion"]["record"] = {"pga": 1.0}
    with pytest.raises(StudyError, match="the record is zero throughout"):
        open_study(plan)


def test_too_weak_records_are_named_and_no_others(folder: Path) -> None:
    said = open_study(study(folder)).warnings
    assert [sentence for sentence in said if "too weak" in sentence and sentence.startswith("weak.AT2")]
    assert not [sentence for sentence in said if "too weak" in sentence and not sentence.startswith("weak.AT2")]


@pytest.mark.parametrize("most", [1, 7, 40, 1000])
@pytest.mark.parametrize("some", [False, True])
def test_chunks_hold_all_cases_of_few_records(most: int, some: bool) -> None:
    shape, axis = (4, 3, 10, 2), 2
    todo = np.random.default_rng(0).random(240) < 0.6 if some else None
    chunks, told = Chunks(240, todo, (shape, axis)), []
    while chunks.left:
        told.append(chunks.take(most))
        assert (np.diff(told[-1]) > 0).all()
        records = np.unique(np.unravel_index(told[-1], shape)[axis])
        assert len(records) <= 2 + most // (24 if todo is None else 8)
    wanted = np.arange(240) if todo is None else np.flatnonzero(todo)
    np.testing.assert_array_equal(np.sort(np.concatenate(told)), wanted)


def directions(folder: Path, **more: Any) -> dict[str, Any]:
    """Two components of one length, in some directions, for some bodies."""
    n, dt = RECORDS["a"]
    rng = np.random.default_rng(3)
    for name in ("one", "two"):
        wave = np.sin(np.linspace(0.0, 40.0, n) + rng.uniform(0.0, 6.0)) * np.hanning(n) * rng.uniform(0.2, 0.5)
        (folder / f"{name}.at2").write_text(at2_text(wave, dt, ["x", name]))
    record = {"file": [str(folder / "one.at2"), str(folder / "two.at2")], "angle": 0, "scale": 1.0}
    vary = {"block.R": [0.5, 1, 3], "motion.record.angle": {"from": 0, "to": "pi", "n": 9}}
    case = {"block": BLOCK, "motion": {"record": record}}
    return {"name": "s", "case": case, "vary": vary, "save": {"histories": False}, **more}


@pytest.mark.parametrize("more", [{}, {"save": {"histories": False, "scalars": ["outcome", "n_impacts"]}}])
def test_every_direction_is_as_alone_and_all_are_one_batch(folder: Path, more: dict[str, Any]) -> None:
    kernels.load(compile_them=True)
    one, other = (solved(open_study(directions(folder, **more)), together=together) for together in (False, True))
    for name in one:
        np.testing.assert_array_equal(one[name], other[name], err_msg=name)
    assert len(set(one["outcome"].tolist())) > 1
    what = open_study(directions(folder, **more))
    assert [batch.size for _, batch in what.suites(np.arange(what.size))] == [27]
    assert len(list(what.batches())) == 9


def test_a_later_axis_of_the_same_length_decides_on_the_motion(folder: Path) -> None:
    """What another axis says of the file or the angle was lost where the records of an axis were solved together."""
    kernels.load(compile_them=True)
    names = [str(folder / f"{name}.AT2") for name in "abc"]
    of_files, of_angles = study(folder), directions(folder)
    of_files["vary"] = {
        "motion.record.file": names[:2],
        "case": {"third": {"motion.record.file": names[2]}, "wide": {"block.R": 3}},
    }
    of_angles["vary"] = {
        "motion.record.angle": [0.0, 1.0],
        "case": {"turned": {"motion.record.angle": 2.0}, "wide": {"block.R": 3}},
    }
    for plan, key, value in ((of_files, "file", names[2]), (of_angles, "angle", 2.0)):
        alone = {**plan, "vary": {f"motion.record.{key}": [value]}}
        (wanted,) = solved(open_study(alone), together=True)["theta_peak"]
        found = solved(open_study(plan), together=True)["theta_peak"]
        assert (found[::2] == wanted).all()
        assert len(set(found.tolist())) == 3


def test_directions_with_something_beside_stay_apart(folder: Path) -> None:
    plan = directions(folder)
    plan["case"]["motion"]["duration"] = 3.0
    what = open_study(plan)
    assert len(list(what.suites(np.arange(what.size)))) == 9


def test_degrees_for_radians_are_told_once(folder: Path) -> None:
    plan = directions(folder)
    plan["vary"]["motion.record.angle"] = [0, 45, 90]
    said = [sentence for sentence in open_study(plan).warnings if "deg" in sentence]
    assert said == ["motion.record.angle is 90 rad: if degrees are meant, write 90*deg"]


ROWS = [
    (name, scale, R, model) for R, model in ((1, "rigid"), (3, "linearized")) for scale in (2, 4) for name in "abcd"
]


def of_rows(folder: Path, rows: list[tuple[str, float, float, str]] = ROWS, **more: Any) -> dict[str, Any]:
    """A table with a record, its scale, a body and a model in each row."""
    cells = [f"row {i},{folder}/{name}.AT2,{scale},{R},{model}" for i, (name, scale, R, model) in enumerate(rows)]
    heads = "name,motion.record.file,motion.record.scale,block.R,model"
    (folder / "rows.csv").write_text("\n".join([heads, *cells]) + "\n")
    case = {"block": BLOCK, "motion": {"record": {"file": str(folder / "a.AT2")}}}
    vary = {"block.tan_alpha": [0.15, 0.25], "case": str(folder / "rows.csv"), **more}
    return {"name": "s", "case": case, "vary": vary, "save": {"histories": False}}


def test_rows_with_a_record_and_numbers_each_are_one_batch_for_each_model(folder: Path) -> None:
    """Each row was a batch: a thousand rows with a record and its scale took 8.2 s, for 2.6."""
    kernels.load(compile_them=True)
    one, other = (solved(open_study(of_rows(folder)), together=together) for together in (False, True))
    for name in one:
        np.testing.assert_array_equal(one[name], other[name], err_msg=name)
    what = open_study(of_rows(folder))
    assert len(list(what.batches())) == 8
    found = list(what.suites(np.arange(what.size)))
    assert [batch.size for _, batch in found] == [16, 16]
    for indices, batch in found:
        rows = [ROWS[i % len(ROWS)] for i in indices]
        assert {batch.model} == {model for *_, model in rows}
        assert batch.block.R[:, 0].tolist() == [R for _, _, R, _ in rows]
        suite = batch.excitation.suite
        assert suite is not None
        assert suite.factor.tolist() == [scale for _, scale, _, _ in rows]
        assert [Path(suite.records[i].files[0]).stem for i in suite.which] == [name for name, *_ in rows]
        assert len(suite.records) == 4


def test_a_row_whose_record_is_missing_is_told_by_its_line(folder: Path) -> None:
    rows = [*ROWS[:5], ("none", 1.0, 1.0, "rigid"), *ROWS[5:]]
    with pytest.raises(RecordError, match=r"rows.csv:7: the record '.*none.AT2' was not found"):
        open_study(of_rows(folder, rows))


def test_rows_of_two_components_or_with_vertical_motion_stay_apart(folder: Path) -> None:
    plan = of_rows(folder)
    plan["case"]["motion"]["vertical"] = {"file": str(folder / "a.AT2"), "scale": 0.1}
    what = open_study(plan)
    assert len(list(what.suites(np.arange(what.size)))) == 8


def test_a_later_table_decides_on_the_record_where_rows_repeat_records(folder: Path) -> None:
    """The first and the last row said what the later table said, and the one between them kept its own record."""
    kernels.load(compile_them=True)
    (folder / "first.csv").write_text(
        "name,file,polarity\n" + "".join(f"{i},{folder}/{n}.AT2,1\n" for i, n in enumerate("aba"))
    )
    later = {"same": {"motion.record.file": str(folder / "a.AT2"), "block.R": 1.5}, "own": {"block.top": "2.5*h"}}
    plan = study(folder)
    plan["case"]["motion"]["record"]["scale"] = 4.0
    plan["vary"] = {"motion.record": str(folder / "first.csv"), "case": later}
    one, other = (solved(open_study(plan), together=together) for together in (False, True))
    np.testing.assert_array_equal(one["theta_peak"], other["theta_peak"])
    assert len(set(one["theta_peak"][::2].tolist())) == 1
    assert len(set(one["theta_peak"][1::2].tolist())) == 2


def test_rows_without_a_record_stand_beside_rows_with_one(folder: Path) -> None:
    rows = {
        f"r{i}": {"motion.record.file": str(folder / f"{name}.AT2"), "block.R": 1 + i} for i, name in enumerate("abc")
    }
    still = {f"s{i}": {"motion": None, "initial.theta": 0.05, "block.R": 1 + i} for i in range(2)}
    plan = study(folder)
    plan["vary"] = {"case": rows | still}
    what = open_study(plan)
    assert sorted(batch.size for _, batch in what.suites(np.arange(what.size))) == [2, 3]
    base = {f"s{i}": {"block.R": 1 + i} for i in range(2)}  # the record of the base case
    plan["case"]["motion"]["record"]["file"] = str(folder / "d.AT2")
    plan["vary"] = {"case": rows | base}
    assert sorted(batch.size for _, batch in open_study(plan).suites(np.arange(5))) == [2, 3]
