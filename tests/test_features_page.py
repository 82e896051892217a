"""The table of docs/features.md is what the committed csv says, has a row for every feature, and a reason for every dear one."""

from __future__ import annotations

from pathlib import Path

import pytest
from scripts import benchmark

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def script():
    with benchmark("features") as features:
        yield features


def test_the_page_is_made_of_the_csv(script):
    text = (ROOT / "docs" / "features.md").read_text(encoding="utf-8")
    section = text.split(script.BEGIN)[1].split(script.END)[0].strip()
    assert section == "\n".join(script.lines_of(script.read_rows()))


def test_every_feature_is_measured(script):
    measured = {(row["feature"], row["motion"]) for row in script.read_rows()}
    assert measured == {(feature.name, motion) for feature in script.FEATURES for motion in feature.motions}


def test_what_is_dear_says_why(script):
    dear = [row for row in script.read_rows() if float(row[script.RATIO]) > script.FIVE]
    assert dear
    assert all(row["why"] for row in dear)


def test_studies_of_the_table_are_what_they_say(script, monkeypatch):
    from rockcli.study.open import open_study

    monkeypatch.setenv("ROCK_RECORDS", str(ROOT / "records"))
    for feature in script.FEATURES:
        for motion in feature.motions:
            study = open_study(script.study_of(feature, motion, 8))
            assert 32 <= study.size <= 80, feature.name
