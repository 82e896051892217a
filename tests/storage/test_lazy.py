"""Datasets read without xarray: figures are the same to the byte, and what is not answered at once is xarray's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray

from rockcli.engine.report_page import write_page, write_page_of
from rockcli.engine.run import run_study
from rockcli.errors import StudyError
from rockcli.plotting.common.style import save
from rockcli.plotting.figures import figure
from rockcli.storage.lazy import open_lazily
from rockcli.storage.read import open_dataset
from rockcli.study.open import open_study

SINE = {"pulse": {"shape": "sine", "a_p": 4.0, "T_p": 0.6}}
CASE = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": SINE}
SUITE = {"motion.record.file": ["synthetic_rock_m65.AT2", "synthetic_soil_m70.AT2", "synthetic_pulse_m70.AT2"]}
PGA = {"motion.record.pga": {"from": 1.0, "to": 8.0, "n": 6}}
STUDIES = {
    "histories": {"case": CASE, "vary": {"motion.pulse.a_p": [3.0, 4.0]}},
    "slides": {
        "case": CASE | {"block": {"R": 1.0, "tan_alpha": 0.4}},
        "vary": {"block.mu": [0.1, 0.41, 0.5, 2.0], "motion.pulse.a_p": [3.0, 5.0, 7.0]},
        "save": {"histories": False},
    },
    "planets": {
        "case": CASE,
        "vary": {"g": [3.71, 9.81, 24.8], "model": ["rigid", "linearized"], "motion.pulse.a_p": [1.0, 2.0, 4.0]},
        "save": {"histories": False},
    },
    "suite": {
        "case": {"block": CASE["block"], "motion": {"record": {"pga": 3.0}}},
        "vary": SUITE | PGA,
        "over": {"axis": "record", "limits": [0.5]},
        "save": {"histories": False},
    },
    "plane": {
        "case": {"block": CASE["block"], "motion": {"record": {"scale": 1.0}}},
        "vary": SUITE | {"motion.record.scale": {"from": 0.3, "to": 6, "n": 9, "spacing": "log"}},
        "over": {"axis": "record", "intensity": ["pga", "pgv_over_pga"], "limits": []},
        "save": {"histories": False},
    },
}
DRAWN = [
    ("histories", "histories"), ("histories", "phase"), ("histories", "motion"), ("histories", "body"),
    ("histories", "curve"), ("slides", "map"), ("slides", "curve"), ("planets", "map"), ("planets", "curve"),
    ("suite", "ida"), ("suite", "fragility"), ("suite", "spectrum"), ("suite", "ranking"),
    ("plane", "intensities"),
]  # fmt: skip


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("lazy")
    found = {}
    for name, study in STUDIES.items():
        report = run_study(open_study({"name": name, **study}), folder, plots=False)
        assert report.file is not None
        found[name] = report.file
    return found


@pytest.mark.parametrize(("study", "kind"), DRAWN)
def test_figures_are_the_same_to_the_byte(files: dict[str, Path], tmp_path: Path, study: str, kind: str) -> None:
    drawn = []
    for opened in (open_lazily, open_dataset):
        try:
            save(figure(kind, opened(files[study])), tmp_path / "drawn.svg")
        except StudyError as error:
            drawn.append(error.message.encode())
        else:
            drawn.append((tmp_path / "drawn.svg").read_bytes())
    assert drawn[0] == drawn[1]


@pytest.mark.parametrize("study", STUDIES)
def test_pages_are_the_same_to_the_byte(files: dict[str, Path], tmp_path: Path, study: str) -> None:
    file = write_page(files[study], tmp_path / "file.html")
    memory = write_page_of(open_dataset(files[study]), tmp_path / "memory.html")
    assert file.read_bytes() == memory.read_bytes()


@pytest.mark.parametrize("study", STUDIES)
def test_all_of_a_file_is_there(files: dict[str, Path], study: str) -> None:
    lazy, whole = open_lazily(files[study]), open_dataset(files[study])
    assert {*lazy.coords} == {*whole.coords}
    assert {*lazy.data_vars} == {*whole.data_vars} == {*lazy}
    assert lazy.sizes == dict(whole.sizes)
    assert {"axes"} <= lazy.attrs.keys() <= whole.attrs.keys()
    for name, item in whole.variables.items():
        assert name in lazy
        assert lazy[name].dims == item.dims
        assert lazy[name].dtype == item.dtype or {lazy[name].dtype.kind, item.dtype.kind} <= {*"OU"}  # text
        np.testing.assert_array_equal(lazy[name].values, item.values)


def test_parts_are_those_of_xarray(files: dict[str, Path]) -> None:
    lazy, whole = open_lazily(files["slides"]), open_dataset(files["slides"])
    several = np.array([2, 0])
    for at in ({"mu": 1}, {"mu": [0, 2]}, {"mu": 1, "motion_pulse_a_p": several}, {"mu": -1}, {"mu": slice(1, 3)}):
        part, expected = lazy.isel(at), whole.isel(at)
        assert part.sizes == dict(expected.sizes)
        np.testing.assert_array_equal(part["slide_peak"].values, expected["slide_peak"].values)
        one = lazy["slide_peak"].isel(at)
        assert one.dims == expected["slide_peak"].dims
        np.testing.assert_array_equal(one.values, expected["slide_peak"].values)
    for dims in (("motion_pulse_a_p", "mu"), ("motion_pulse_a_p", ...), (..., "mu"), ()):
        turned, expected = lazy["slide_peak"].transpose(*dims), whole["slide_peak"].transpose(*dims)
        assert turned.dims == expected.dims
        np.testing.assert_array_equal(turned.values, expected.values)


def test_what_is_not_answered_is_asked_of_xarray(files: dict[str, Path]) -> None:
    lazy, whole = open_lazily(files["slides"]), open_dataset(files["slides"])
    assert isinstance(lazy.where(lazy["outcome"] > 0), xarray.Dataset)
    slides, mu = lazy["slide_peak"], lazy["mu"]
    expected = (whole["slide_peak"] * whole["mu"]).values
    np.testing.assert_array_equal((slides * mu).values, expected)
    np.testing.assert_array_equal((mu * slides).transpose("mu", ...).values, expected)
    assert float(slides.max()) == float(whole["slide_peak"].max())
    one = slides.isel(mu=0, motion_pulse_a_p=0)
    assert (bool(one), int(one), float(one)) == (True, 0, float(whole["slide_peak"][0, 0]))
    assert not one.copy(data=np.array(0.0))
    assert (len(slides), len(lazy)) == (len(whole["slide_peak"]), len(whole))
    assert [float(each.sum()) for each in slides] == [float(each.sum()) for each in whole["slide_peak"]]
    with pytest.raises(AttributeError, match="nothing_of_the_kind"):
        _ = lazy.nothing_of_the_kind


def test_what_is_no_dataset_is_refused(tmp_path: Path) -> None:
    (tmp_path / "torn.nc").write_bytes(b"CDF")
    for path in (tmp_path / "torn.nc", tmp_path / "none.nc"):
        with pytest.raises(StudyError):
            open_lazily(path)
