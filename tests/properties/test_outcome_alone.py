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


def test_a_body_that_rocks_before_a_bell_comes() -> None:
    # far from its centre a Ricker pulse is nothing, and a step may not leap over it
    study = {
        "name": "before",
        "case": {
            "block": {"R": 1.0, "tan_alpha": 1.1},
            "motion": {"pulse": {"shape": "ricker", "a_p_over_g_tan_alpha": 4.0, "omega_p_over_p": 0.6}},
            "initial": {"theta": "-0.05*alpha", "theta_dot": "0.33*p*alpha"},
        },
        "vary": {
            "initial.theta": ["-0.8*alpha", "-0.05*alpha", "0.3*alpha"],
            "motion.pulse.omega_p_over_p": [0.6, 3.0, 12.0],
            "motion.pulse.a_p_over_g_tan_alpha": [1.5, 4.0, 9.0],
        },
    }

    def solved(scalars: object) -> dict[str, np.ndarray]:
        found = rockcli.run(study | {"save": {"histories": False, "scalars": scalars}})
        return {name: found[name].values for name in ("outcome", "theta_peak_over_alpha")}

    few, whole = solved(["outcome", "theta_peak_over_alpha"]), solved("all")
    assert (few["outcome"] == whole["outcome"]).all()
    assert (whole["outcome"] >= OVERTURNED_WITHOUT_IMPACT).any()
    np.testing.assert_allclose(few["theta_peak_over_alpha"], whole["theta_peak_over_alpha"], rtol=1e-8)
