"""Every study of the repository runs and meets what it expects; those whose record is absent are listed as such."""

from __future__ import annotations

from pathlib import Path

import pytest

from rockcli.engine.run import check_study, run_study
from rockcli.study.open import open_study
from rockcli.study.records import MissingRecordError

STUDIES = Path(__file__).resolve().parents[1] / "studies"
FILES = sorted(STUDIES.rglob("*.yaml"))


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(STUDIES)))
def test_study_meets_its_expectations(path, tmp_path):
    try:
        study = open_study(path)
    except MissingRecordError as missing:
        pytest.skip(f"its record is not here: {missing.message.splitlines()[0]}")
    check_study(study, tmp_path)
    report = run_study(study, tmp_path, plots=False)
    assert not report.failed
    missed = [verdict for verdict in report.verdicts if not verdict.passed]
    assert not missed, missed


def test_examples_cover_what_a_newcomer_needs():
    names = {path.stem for path in (STUDIES / "examples").glob("*.yaml")}
    assert {"first_rock", "record", "free_rocking", "sweep"} <= names
