"""The table of published numbers in docs/validation.md is what the studies give; their histories hold what no clause can ask."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from scenes import SHARED
from scripts import benchmark

from rockcli.engine.run import run_study, solve
from rockcli.study.building.records import MissingRecordError
from rockcli.study.open import open_study

ROOT = Path(__file__).resolve().parents[2]
STUDIES = ROOT / "studies" / "literature"


@pytest.fixture(autouse=True)
def _records_beside_the_checkout(monkeypatch):
    if "ROCK_RECORDS" not in os.environ and (SHARED / "records" / "peer").is_dir():
        monkeypatch.setenv("ROCK_RECORDS", str(SHARED / "records" / "peer"))


@pytest.fixture(scope="module")
def literature():
    with benchmark("literature") as script:
        yield script


@pytest.mark.slow
def test_the_table_is_made_of_the_studies(literature, tmp_path):
    for path in [*sorted(STUDIES.glob("*.yaml")), ROOT / "studies" / "objects" / "rocking_frame.yaml"]:
        try:
            run_study(open_study(path), tmp_path, plots=False)
        except MissingRecordError:
            assert "pacoima" in path.name
    table = literature.PAGE.read_text(encoding="utf-8").split(literature.BEGIN)[1].split(literature.END)[0].strip()
    assert "not run" not in table
    assert literature.lines_of(tmp_path, table) == table.splitlines()
    assert "| not run |" in "\n".join(literature.lines_of(tmp_path / "nothing", ""))


@pytest.mark.parametrize(("degrees", "period", "published"), [(15, 7.0, (2.11, 1.82)), (20, 4.0, (1.39, 0.98))])
def test_longest_cycles_under_pacoima_dam(degrees, period, published):
    """Makris and Konstantinidis (2003), Fig. 7, read off a plot: .02 s.  A cycle: from an impact to the next but one."""
    try:
        study = open_study(STUDIES / "makris_konstantinidis_pacoima.yaml")
    except MissingRecordError as missing:
        pytest.skip(f"its record is not here: {missing.message.splitlines()[0]}")
    fields = solve(study).fields
    i = int(np.argmin(abs(fields["block_alpha"].values - np.radians(degrees))))
    j = list(fields["period"].values).index(period)
    times = np.r_[fields["t_uplift"].values[i, j], fields["t_impact"].values[i, j]]
    lengths = times[2:] - times[:-2]
    first = int(np.nanargmax(lengths))
    assert (lengths[first], lengths[first + 2]) == pytest.approx(published, abs=0.02)
