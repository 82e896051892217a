"""The studies of the thesis's static figures and of its first damped histories meet what they expect."""

from __future__ import annotations

from pathlib import Path

import pytest

from rockcli.analysis.expect import check_quantities, judge
from rockcli.engine.run import solve
from rockcli.study.open import open_study

SEED = Path(__file__).resolve().parents[2] / "studies" / "seed"
FIGURES = ("05", *(str(n) for n in range(21, 30)), "43", "44")


@pytest.mark.parametrize("figure", FIGURES)
def test_seed_study(figure: str):
    study = open_study(SEED / f"fig{figure}.yaml")
    check_quantities(study)
    assert study.expect
    assert f"Fig. {int(figure)}" in study.references
    for verdict in judge(solve(study), study.expect):
        assert verdict.passed, verdict
