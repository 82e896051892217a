"""What rigid bodies leave open is said: which edge a flat body lands on, and sliding that no finite force allows."""

from __future__ import annotations

import pytest

import rockcli
from rockcli.scene.response import UNRESOLVED, overturned


def told(case: dict) -> tuple[int, float, int, str]:
    """Outcome, share that overturns, jams and reason of a case."""
    ds = rockcli.run({"name": "open", "case": case})
    return int(ds.outcome), float(ds.overturn_share), int(ds.n_jams), str(ds.reasons.values[int(ds.reason)])


def thrown_up(tilt: float) -> dict:
    """A body with two unlike edges, thrown up by the ground with some tilt; it comes down as it went up."""
    return {
        "block": {"h": 0.6, "b": [0.15, 0.2], "mu": 0.3, "e_n": 0.45},
        "initial": {"theta": tilt},
        "motion": {
            "pulse": {"shape": "sine", "a_p": 0.1, "T_p": 0.3},
            "vertical": {"pulse": {"shape": "sine", "a_p": -2.0 * 9.81, "T_p": 0.3}},
        },
    }


def slid(mu: float) -> dict:
    """A cube that stands on an edge and slides fast towards it."""
    return {
        "block": {"height": 1.0, "width": 1.0, "mu": mu},
        "initial": {"theta": 0.1, "theta_dot": -1.0, "slide_rate": 3.0},
        "motion": {"pulse": {"shape": "sine", "a_p": 0.1, "T_p": 0.3}},
    }


def test_a_flat_landing_hangs_on_the_edge_that_strikes_first():
    """However small the tilt, its sign decides: beyond doubt on either side, it overturns on one and stands on the other."""
    outcome, share, _, reason = told(thrown_up(1e-5))
    assert outcome == UNRESOLVED
    assert 0.0 < share < 1.0
    assert "comes down from flight flat" in reason
    assert "whether it overturns hangs on the edge on which it comes down first" in reason
    falls = [bool(overturned(told(thrown_up(tilt))[0])) for tilt in (6e-4, -6e-4)]
    assert falls == [False, True]


@pytest.mark.parametrize("mu", [1.6, 2.5])
def test_friction_above_four_thirds_jams_and_says_so(mu):
    """Painlevé's limit of a rectangle that slides on an edge is 4/3, at tan(beta) = 2."""
    _, _, jams, reason = told(slid(mu))
    assert jams == 1
    assert "jams 1 times: mu is so large that no finite force lets it slide on" in reason


def test_friction_below_four_thirds_never_jams():
    _, _, jams, reason = told(slid(1.33))
    assert (jams, reason) == (0, "")
