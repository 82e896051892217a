"""Closed forms of overturning by a sine or a rectangular pulse: against high-precision roots, and the solver's flips."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rockcli
from rockcli.scene.laws.overturning import rectangular_without_impact, sine_one_impact, sine_without_impact
from rockcli.scene.response import OVERTURNED_AFTER_IMPACT, OVERTURNED_WITHOUT_IMPACT, ROCKING

ONE_SINE = {
    0.5: 1.1180499517878435618,
    1.0: 1.4183153355788508339,
    3.0: 3.6311498724447945014,
    10.0: 21.599989284727501635,
}
HALF_SINE = {
    0.1: 1.0049875565496803914,
    5.0: 3.2891467775230030447,
    10.0: 5.7865216516964278046,
    20.0: 10.785709408695769191,
}
RECTANGULAR = {0.1: 10.508331944775049624, 0.5: 2.5414940825367982841, 2.0: 1.1565176427496656518}
ONE_IMPACT = [  # Omega, eta, lower and upper A; roots confirmed by runs at 1 -/+ 1e-12 of them
    (1.0, 0.9, 1.1320471105976836498, 1.4163842969598588276),
    (3.0, 0.9, 1.4035653556427826612, 3.4846627333224920275),
    (5.0, 0.9, 3.0185998608717963664, 6.3180705298274460929),
    (5.0, 0.95, 2.5159022977279718541, 6.8187765188441610697),
    (8.0, 0.95, 8.6320506942755501135, 13.110672087236935747),
    (2.0, 0.7, 1.2559069757631148546, 2.1808288313688574435),
    (3.0, 1.0, 1.3670516293103888317, None),
]


def test_closed_forms_against_high_precision_roots() -> None:
    for table, half_cycles in ((ONE_SINE, 2), (HALF_SINE, 1)):
        found = sine_without_impact(np.array(list(table)), half_cycles)
        np.testing.assert_allclose(found, list(table.values()), rtol=1e-14)
    durations = np.array(list(RECTANGULAR))  # p t_1 = pi/Omega
    np.testing.assert_allclose(rectangular_without_impact(np.pi / durations), list(RECTANGULAR.values()), rtol=1e-14)


def test_limits() -> None:
    slow, fast = np.array([0.01]), np.array([1e4])
    np.testing.assert_allclose(sine_without_impact(slow), np.sqrt(1.0 + slow**2), rtol=1e-14)
    np.testing.assert_allclose(sine_without_impact(fast), fast**2 / (2.0 * np.pi) + 0.5 * fast, rtol=1e-6)
    np.testing.assert_allclose(sine_without_impact(fast, 1), 0.5 * fast + 0.25 * np.pi, rtol=1e-6)
    with pytest.raises(ValueError, match="one or two half cycles"):
        sine_without_impact(slow, 3)


@pytest.mark.parametrize(("Omega", "eta", "lower", "upper"), ONE_IMPACT)
def test_one_impact_changes_sign_at_high_precision_roots(
    Omega: float, eta: float, lower: float, upper: float | None
) -> None:
    for root, up in ((lower, 1.0), (upper, -1.0)):
        if root is not None:
            below, above = sine_one_impact(root * np.array([1.0 - 1e-11, 1.0 + 1e-11]), np.array(Omega), eta)
            assert up * below < 0.0 < up * above


def test_one_impact_where_there_is_none() -> None:
    Omega = np.array(3.0)
    at = np.array([0.5, 1.0, ONE_SINE[3.0] * (1 + 1e-9), 20.0])
    assert np.isnan(sine_one_impact(at, Omega, 0.9)).all()
    assert np.nanmax(sine_one_impact(np.linspace(1.001, 9.4, 200), np.array(6.0), 0.8)) < 0.0  # no band at all
    below = sine_one_impact(np.array([ONE_SINE[3.0] * (1 - 1e-12)]), Omega, 0.9)  # comes back long after the pulse
    np.testing.assert_allclose(below, 0.9 - 1.0, atol=1e-6)
    slowly = sine_one_impact(np.linspace(1.00001, 1.000049, 5), np.array(0.01), 0.9)  # p t up to 628 within the pulse
    assert np.isfinite(slowly).all()


def outcomes(pulse: dict[str, Any], eta: float, A: list[float]) -> list[int]:
    """What becomes of linearized blocks at A = a_p/(g alpha)."""
    alpha = float(np.arctan(0.2))
    study = {
        "name": "flip",
        "let": {"A": 1},
        "case": {
            "block": {"R": 3.0, "tan_alpha": 0.2},
            "motion": {"pulse": pulse | {"a_p": f"A*g*{alpha!r}"}},
            "model": "linearized",
            "damping": {"scheme": "restitution", "eta": eta},
        },
        "vary": {"let.A": A},
        "save": {"histories": False, "scalars": ["outcome"]},
    }
    return [int(flag) for flag in rockcli.run(study)["outcome"].values]


def around(root: float) -> list[float]:
    return [root * (1.0 - 1e-6), root * (1.0 + 1e-6)]


@pytest.mark.parametrize("Omega", [0.7, 2.3, 6.1])
def test_the_solver_overturns_without_impact_where_the_closed_forms_say(Omega: float) -> None:
    for shape, root in (
        ("sine", sine_without_impact(np.array(Omega))),
        ("half_sine", sine_without_impact(np.array(Omega), 1)),
        ("rectangular", rectangular_without_impact(np.array(Omega))),
    ):
        below, above = outcomes({"shape": shape, "omega_p_over_p": Omega}, 0.6, around(float(root)))
        assert below in (ROCKING, OVERTURNED_AFTER_IMPACT), shape
        assert above == OVERTURNED_WITHOUT_IMPACT, shape


@pytest.mark.parametrize(
    ("Omega", "eta", "near"), [(2.5, 0.85, 1.31), (2.5, 0.85, 2.8), (4.4, 0.93, 1.9), (4.4, 0.93, 5.5)]
)
def test_the_solver_overturns_after_one_impact_where_the_closed_form_says(
    Omega: float, eta: float, near: float
) -> None:
    low, high = near * 0.9, near * 1.1  # own bisection of the excess, of which one sign change lies here
    rises = float(sine_one_impact(np.array(high), np.array(Omega), eta)) > 0.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        beyond = (float(sine_one_impact(np.array(middle), np.array(Omega), eta)) > 0.0) == rises
        low, high = (low, middle) if beyond else (middle, high)
    flags = outcomes({"shape": "sine", "omega_p_over_p": Omega}, eta, around(high))
    assert [flag == OVERTURNED_AFTER_IMPACT for flag in flags] == [not rises, rises]
