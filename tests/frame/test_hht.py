"""Numerical damping on no-tension fibres: what restitution comes out, and what it depends on (docs/frame.md)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from frame.frames import framed, on_fibres, restitution

from rockcli.errors import SolverError
from rockcli.solvers.frame.solver import solve

ALPHA = np.arctan(0.2)
HOUSNER = 1.0 - 1.5 * np.sin(ALPHA) ** 2


def kept(**how) -> np.ndarray:
    dt = how.pop("dt", 1e-4)
    response = solve(framed(on_fibres(**how), dt=dt))
    assert response.scalars["outcome"][0] == 1, response.reasons
    return restitution(response, ALPHA)


def test_two_fibres_at_the_corners_are_housners_impact():
    assert kept(kw=1e11, fibres=2)[0] == pytest.approx(HOUSNER, abs=2e-3)


def test_a_stiff_base_loses_the_same_at_every_impact():
    eta = kept(kw=1e15, fibres=21)[:4]
    np.testing.assert_allclose(eta, 0.952, atol=0.005)


@pytest.mark.parametrize("alpha_d", [2.0 / 3.0, 0.8])
def test_there_alpha_d_hardly_matters(alpha_d):
    assert kept(kw=1e15, fibres=21, alpha_d=alpha_d)[:4].mean() == pytest.approx(0.952, abs=0.006)


def test_with_hardly_any_damping_only_the_first_impact_does_not_hang_on_rounding():
    first = [kept(kw=kw, fibres=21, alpha_d=0.9)[0] for kw in (1e15, 1e15 * (1.0 + 1e-9))]
    np.testing.assert_allclose(first, 0.957, atol=0.002)


def test_more_fibres_lose_less_at_the_first_impact():
    eta = [kept(kw=1e11, fibres=n)[0] for n in (2, 5, 21)]
    assert eta[0] < eta[1] < eta[2] < 1.0
    assert eta[2] > 0.985  # the thesis: "not sensitive to the number of fibres"


def test_a_soft_base_gives_everything_back():
    assert kept(kw=1e9, fibres=21)[0] > 0.99


def test_it_needs_a_base_that_gives_way():
    with pytest.raises(SolverError, match="winkler"):
        solve(framed(replace(on_fibres(kw=1e11, fibres=2), base=None)))
