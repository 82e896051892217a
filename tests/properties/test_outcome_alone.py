"""The outcome does not depend on what else is asked for."""

from __future__ import annotations

import numpy as np
import pytest

import rockcli
from rockcli.scene.response import OVERTURNED_AFTER_IMPACT, OVERTURNED_WITHOUT_IMPACT


@pytest.mark.parametrize("accuracy", ["standard", "reference"])
@pytest.mark.parametrize("model", ["rigid", "linearized"])
def test_the_kind_of_overturning_is_that_of_the_whole_answer(model: str, accuracy: str) -> None:
    # a sine after whose end many blocks swing back, land and overturn on the other side
    def outcomes(scalars: object) -> np.ndarray:
        study = {
            "name": "kinds",
            "case": {
                "block": {"R": 1.0, "alpha": 0.2},
                "motion": {"pulse": {"shape": "sine", "a_p_over_g_tan_alpha": 2.0, "omega_p_over_p": 2.0}},
                "model": model,
                "solver": {"accuracy": accuracy},
            },
            "vary": {
                "motion.pulse.omega_p_over_p": {"from": 1, "to": 8, "n": 12},
                "motion.pulse.a_p_over_g_tan_alpha": {"from": 1.1, "to": 12, "n": 12},
            },
            "save": {"histories": False, "scalars": scalars},
        }
        return rockcli.run(study)["outcome"].values

    alone, whole = outcomes(["outcome"]), outcomes("all")
    assert set(np.unique(whole)) >= {OVERTURNED_WITHOUT_IMPACT, OVERTURNED_AFTER_IMPACT}
    assert (alone == whole).all()
