"""Every study of the repository runs, meets what it expects and has a page; those whose record is absent are listed as such.

By default only those that take less than a second or two, and few pages; the rest with `-m slow`.  Records are sought in ROCK_RECORDS,
or in a folder of real records beside the checkout.
"""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

import pytest
import yaml
from scenes import SHARED

from rockcli.engine.report_page import verdicts, write_page
from rockcli.engine.run import check_study, run_study
from rockcli.storage import netcdf
from rockcli.study.building.records import MissingRecordError
from rockcli.study.open import open_study

STUDIES = Path(__file__).resolve().parents[1] / "studies"
FILES = sorted(STUDIES.rglob("*.yaml"))

SLOW = (
    "extremes/(flexible|frame|hundred_thousand_periods).yaml",
    "(flexible/thresholds|objects/sliding|suites/fragility).yaml",
    "contact/regimes.yaml",  # three thousand pulses
    "frame/",
    "seed/fig03.yaml",
    "seed/fig18.yaml",  # finite elements, compiled
    "seed/fig3[6-9].yaml",
    "seed/fig4[56].yaml",  # ten thousand pulses each, compiled
    "seed/fig4[1278].yaml",  # records
    "seed/fig49.yaml",
    "seed/fig5.*.yaml",
    "seed/fig6[12].yaml",
    "spectra/",  # eighty thousand pulses each, compiled
    "tutorials/",  # run as their pages say, by test_tutorials.py
    "seed/mesh/",  # CalculiX: minutes each
)
"""Patterns of the studies that take longer."""

PAGES = (
    "examples/(first_rock|sweep).yaml",
    "literature/makris_roussos_2000.yaml",  # searched
    "objects/(direction|statue).yaml",
    "seed/fig2[16].yaml",  # static curves
    "suites/(rocking_spectrum|rules).yaml",
)
"""Patterns of the studies whose page is made by default."""

WITHOUT_RESULT = {1, 2, 6, 9, 13, 17, 35, 40, 59}
"""Figures of the thesis that show a photograph, a sketch of a model or of a procedure."""


def _name(path: Path) -> str:
    return path.relative_to(STUDIES).as_posix()


def _is_one_of(patterns: tuple[str, ...], path: Path) -> bool:
    return any(re.match(pattern, _name(path)) for pattern in patterns)


def _marked(path: Path, *, slow: bool):
    return pytest.param(path, id=_name(path), marks=[pytest.mark.slow] if slow else [])


@pytest.fixture(autouse=True)
def _records_beside_the_checkout(monkeypatch):
    folders = [SHARED / "records" / name for name in ("peer", "derived")]
    if "ROCK_RECORDS" not in os.environ and all(folder.is_dir() for folder in folders):
        monkeypatch.setenv("ROCK_RECORDS", os.pathsep.join(map(str, folders)))


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """A folder in which what one test has solved is up to date for another."""
    return tmp_path_factory.mktemp("results")


def _run(path: Path, results: Path):
    if _name(path).startswith("seed/mesh/") and shutil.which("ccx") is None:
        pytest.skip("CalculiX (ccx) is not installed")
    if "mesh: " in path.read_text(encoding="utf-8"):
        pytest.importorskip("trimesh", reason="meshes are read by trimesh: pip install -e '.[meshes]'")
    try:
        study = open_study(path)
    except MissingRecordError as missing:
        pytest.skip(f"its record is not here: {missing.message.splitlines()[0]}")
    check_study(study, results)
    return run_study(study, results, plots=False)


@pytest.mark.parametrize("path", [_marked(path, slow=_is_one_of(SLOW, path)) for path in FILES])
def test_study_meets_its_expectations(path, results):
    report = _run(path, results)
    assert not report.failed
    missed = [verdict for verdict in report.verdicts if not verdict.passed]
    assert not missed, missed
    # the dataset alone says the same
    read_again = verdicts(netcdf.read(report.file))
    assert [(v.text, v.points, v.worst, v.where) for v in read_again] == [
        (v.text, v.points, v.worst, v.where) for v in report.verdicts
    ]


@pytest.mark.parametrize("path", [_marked(path, slow=not _is_one_of(PAGES, path)) for path in FILES])
def test_study_has_a_page(path, results):
    report = _run(path, results)
    page = write_page(report.file).read_text(encoding="utf-8")
    assert page.endswith("</html>\n")
    assert f"Expected: {len(report.verdicts)} of {len(report.verdicts)} met" in page or not report.verdicts
    assert "<h2>Cases</h2>" in page or "<svg " in page
    assert str(path.parents[2]) not in page


def test_examples_cover_what_a_newcomer_needs():
    names = {path.stem for path in (STUDIES / "examples").glob("*.yaml")}
    assert {"first_rock", "record", "free_rocking", "sweep"} <= names


def test_every_figure_with_a_result_has_a_study():
    found = {path.stem for path in (STUDIES / "seed").glob("*.yaml")}
    assert found == {f"fig{number:02d}" for number in set(range(1, 67)) - WITHOUT_RESULT}


@pytest.mark.parametrize("path", sorted((STUDIES / "seed").glob("*.yaml")), ids=lambda path: path.stem)
def test_a_figures_study_says_what_it_reproduces_and_what_it_expects(path):
    text = path.read_text(encoding="utf-8")
    assert re.search(rf"^name: {path.stem}$", text, re.M)
    assert re.search(rf"^references: .*dissertation, Fig\. {int(path.stem[3:])}\b", text, re.M)
    for clause in yaml.safe_load(text)["expect"]:
        assert "references" in clause or clause["quantity"] in ("outcome", "same_outcome"), clause


@pytest.mark.parametrize("path", sorted((STUDIES / "literature").glob("*.yaml")), ids=lambda path: path.stem)
def test_a_study_of_a_paper_names_it_and_says_where_each_number_is_from(path):
    study = yaml.safe_load(path.read_text(encoding="utf-8"))
    assert re.search(r"\((19|20)\d\d\)", study["references"])
    assert study["expect"]
    assert all(clause.get("references") for clause in study["expect"])
