"""Names of files that axes fill in, and globs in named settings."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import numpy as np
import pytest

import rockcli
from rockcli.errors import StudyError
from rockcli.study.building.records import MissingRecordError
from rockcli.study.open import open_study

RECORDS = Path(__file__).resolve().parents[2] / "records"
FILES = {"ground": "synthetic_rock_m65.AT2", "roof": "synthetic_soil_m70.AT2"}


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Two places with the records 01 and 02 each; the second of a place is the first."""
    for place, file in FILES.items():
        for name in ("01", "02"):
            shutil.copy(RECORDS / file, tmp_path / f"{place}_{name}.AT2")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def study(file, vary, **more):
    motion = {"record": {"file": file, "pga": "0.4*g"}}
    return {
        "name": "places",
        "case": {"block": {"h": 0.9, "b": 0.2}, "motion": motion},
        "vary": vary,
        "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]},
    } | more


@pytest.mark.parametrize("records", [["01", "02"], "ground_*.AT2"])
def test_places_by_records_are_one_study(here, records):
    found = rockcli.run(study("{where}_{record}.AT2", {"where": ["ground", "roof"], "record": records}, over="record"))
    assert found.theta_peak_over_alpha.dims == ("where", "record")
    assert found.record.values.tolist() == ["01", "02"]
    for i, name in enumerate(FILES):
        alone = rockcli.run(study(f"{name}_01.AT2", {}))
        assert (found.theta_peak_over_alpha[i] == float(alone.theta_peak_over_alpha)).all()
    assert found.p_overturned.dims == ("where",)


def test_a_labelled_axis_fills_in_too_and_the_resolved_study_says_the_same(here):
    vary = {"motion.record": {"ground": {"pga": "0.2*g"}, "roof": {"pga": "0.4*g"}}, "name": ["01", "02"]}
    opened = open_study(study("{record}_{name}.AT2", vary))
    assert sorted(opened.inputs) == [f"{place}_{name}.AT2" for place in FILES for name in ("01", "02")]
    assert open_study(opened.resolved).identity == opened.identity


@pytest.mark.parametrize("base", ["ground_01.AT2", "ground_{record}.AT2"])
def test_the_cells_of_a_table_alone_may_have_names_that_an_axis_fills_in(here, base):
    """Each body on its own floor, and a base case with any record."""
    cells = [f"{body},{h},{place}_{{record}}.AT2" for body, h, place in (("low", 0.9, "ground"), ("high", 1.1, "roof"))]
    (here / "bodies.csv").write_text("\n".join(["name,block.h,motion.record.file", *cells, ""]))
    for vary in ({"case": "bodies.csv", "record": "ground_*.AT2"}, {"record": ["01", "02"], "case": "bodies.csv"}):
        found = rockcli.run(study(base, vary)).transpose("case", "record")
        for i, (name, h) in enumerate(zip(FILES, (0.9, 1.1), strict=True)):
            alone = study(f"{name}_01.AT2", {})
            alone["case"]["block"]["h"] = h
            assert (found.theta_peak_over_alpha[i] == float(rockcli.run(alone).theta_peak_over_alpha)).all()
    with pytest.raises(StudyError, match=r"'records' is not a path .*; did you mean 'record'\?$"):
        open_study(study(base, {"case": "bodies.csv", "records": ["01", "02"]}))


def test_a_glob_in_a_named_setting_is_a_point_for_every_file(here):
    found = rockcli.run(study("ground_01.AT2", {"motion.record.file": {"up": "roof_*.AT2", "down": "ground_01.AT2"}}))
    assert found.record.values.tolist() == ["up roof_01.AT2", "up roof_02.AT2", "down"]
    peaks = found.theta_peak_over_alpha.values
    assert peaks[0] == peaks[1] != peaks[2]
    assert np.isfinite(peaks).all()


@pytest.mark.parametrize(
    ("path", "below"),
    [
        ("motion.record", lambda file: {"file": file, "pga": "0.3*g"}),
        ("motion", lambda file: {"record": {"file": file, "pga": "0.3*g"}}),
        ("case", lambda file: {"motion.record.file": file, "motion.record.pga": "0.3*g"}),
        ("case", lambda file: {"motion": {"record": {"file": file, "pga": "0.3*g"}}, "block.b": 0.2}),
    ],
)
def test_a_glob_inside_a_setting_keeps_what_else_the_setting_says(here, path, below):
    """Against the same points written out by hand."""
    down = {"down": below("ground_01.AT2")}
    globbed = {"up": below("roof_*.AT2")} | down
    by_hand = {f"up {name}": below(name) for name in ("roof_01.AT2", "roof_02.AT2")} | down
    found, written = (rockcli.run(study("ground_01.AT2", {path: points})) for points in (globbed, by_hand))
    axis = found.theta_peak_over_alpha.dims[0]
    assert found[axis].values.tolist() == [*by_hand]
    np.testing.assert_array_equal(found.theta_peak_over_alpha.values, written.theta_peak_over_alpha.values)
    assert float(found.pga) == pytest.approx(0.3 * 9.81)


def test_a_glob_where_no_axis_stands_says_where_it_may(here):
    with pytest.raises(MissingRecordError, match=r"points of its named settings"):
        open_study(study("ground_*.AT2", {}))


@pytest.mark.parametrize(
    ("file", "vary", "words"),
    [
        ("{wher}_01.AT2", {"where": ["ground"]}, "'where' is not a path"),
        (
            "{wher}_{where}.AT2",
            {"where": ["ground"]},
            r"file name with \{wher\}, which is no axis; did you mean 'where'",
        ),
        ("{where}_01.AT2", {"where": {"from": 1, "to": 2, "n": 2}}, "expected a list of names"),
        ("{where}_01.AT2", {"where": ["ground", "ground"]}, "repeats 'ground'"),
    ],
)
def test_what_is_wrong_is_said(here, file, vary, words):
    with pytest.raises(StudyError, match=words):
        open_study(study(file, vary))


@pytest.mark.parametrize("file", ["locked/ground.AT2", "locked/*.AT2"])
def test_a_folder_that_may_not_be_looked_into_is_told(here, file):
    (here / "locked").mkdir(mode=0)
    if os.access(here / "locked", os.X_OK):
        pytest.skip("this user may look into any folder")
    vary = {"motion.record.file": file} if "*" in file else {}
    with pytest.raises(MissingRecordError, match=r"Searched: .*locked \(permission denied\)"):
        open_study(study(file, vary))


def test_a_file_that_is_missing_is_named(here):
    with pytest.raises(MissingRecordError, match=r"cellar_01\.AT2"):
        open_study(study("{where}_01.AT2", {"where": ["ground", "cellar"]}))
