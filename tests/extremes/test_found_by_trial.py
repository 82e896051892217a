"""Answers that were once wrong: extremes between looks, passages that a long step hides."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scenes import G, block, pulse, record, rock, still, unit_block

from rockcli.scene.body.block import make_block

LEVELS = ["draft", "standard", "reference"]


def extremes(alpha: float, q: np.ndarray, rate2: np.ndarray) -> tuple[float, float]:
    """Largest |T|/N and smallest N/(m g) of a rectangle of p = 1 (R = 3 g/4), q'' = -sin(alpha - q), with q'^2 given."""
    beta = alpha - q
    N = 1.0 + 0.75 * (-(np.sin(beta) ** 2) - np.cos(beta) * rate2)
    T = np.abs(0.75 * (-np.cos(beta) * np.sin(beta) + np.sin(beta) * rate2))
    return float((T / N).max()), float(N.min())


@pytest.mark.parametrize("accuracy", LEVELS)
@pytest.mark.parametrize("alpha", [0.9, 1.3])
def test_extremes_of_the_forces_inside_a_swing(alpha, accuracy):
    """A stocky body let go at 0.7 alpha, at rest after its impact: forces from the energy, extremes between the ends."""
    response = rock(unit_block(alpha), still(), theta_0=0.7 * alpha, eta=0.0, accuracy=accuracy)
    q = np.linspace(0.0, 0.7 * alpha, 2_000_001)
    mu, N = extremes(alpha, q, 2.0 * (np.cos(0.3 * alpha) - np.cos(alpha - q)))
    assert response.scalars["N_min_over_mg"][0] == pytest.approx(N, rel=1e-4, abs=1e-9)
    assert response.scalars["mu_required"][0] == pytest.approx(mu, rel=1e-3)


@pytest.mark.parametrize("accuracy", LEVELS)
def test_friction_is_largest_within_a_sample_at_the_end_of_which_it_acts_the_other_way(accuracy):
    """As with sixteen samples for one: |T|/N rises, falls to zero and rises again between two of them."""
    values, dt = np.array([0.0, 16.0, 23.7, 20.9, 9.9, -3.8, -14.5, 0.0]), 0.0625
    fine = np.interp(np.arange(16 * 7 + 1) / 16, np.arange(8), values)
    body, how = make_block(h=0.5, b=0.38, r_g=0.46), {"theta_dot_0": -0.94, "eta": 0.8, "accuracy": accuracy}
    needed, often = (
        rock(body, motion, histories=True, **how).scalars["mu_required"][0]
        for motion in (record(values, dt), record(fine, dt / 16))
    )
    assert needed == pytest.approx(often, rel=1e-6)
    assert often == pytest.approx(1.192323, rel=1e-6)


@pytest.mark.parametrize("accuracy", LEVELS)
@pytest.mark.parametrize(
    ("A", "Omega", "passages"),
    [
        (4.919661016949153, 4.153846153846154, 0.685592),
        (6.578305084745763, 6.0769230769230775, 0.847438),
        (6.815254237288135, 6.269230769230769, 0.818223),
    ],
)
def test_last_outward_passage(A, Omega, passages, accuracy):
    """The body passes alpha, comes back inside, and passes it again within one long step."""
    body = block(1.0, 0.2)
    p = float(body.p(np.array([G]))[0, 0])
    motion = pulse("sine", A * G * 0.2, Omega * p, cycles=3.0)
    response = rock(body, motion, accuracy=accuracy)
    assert response.scalars["outcome"][0] >= 2
    assert response.scalars["t_overturn"][0] == pytest.approx(passages, abs=2e-6)


def test_friction_on_the_way_to_the_ground_lets_no_body_slide():
    """Thrown over: what it needs up to alpha from the energy; beyond, N goes to zero."""
    alpha, rate = 0.15, 0.6
    body = unit_block(alpha)
    q = np.linspace(0.0, alpha, 200_001)
    mu, N = extremes(alpha, q, rate**2 - 2.0 * (np.cos(alpha - q) - np.cos(alpha)))
    fall = np.linspace(alpha, 0.5 * np.pi, 200_001)
    assert extremes(alpha, fall, rate**2 - 2.0 * (np.cos(alpha - fall) - np.cos(alpha)))[1] < 0.0
    given = dataclasses.replace(body, mu=np.array([1.01 * mu]))
    response = rock(given, still(), theta_dot_0=rate)
    assert response.scalars["outcome"][0] == 2
    assert response.scalars["mu_required"][0] == pytest.approx(mu, rel=1e-9)
    assert response.scalars["N_min_over_mg"][0] == pytest.approx(N, rel=1e-9)
    assert response.reasons[0] == ""
    short = dataclasses.replace(body, mu=np.array([0.99 * mu]))
    assert rock(short, still(), theta_dot_0=rate).scalars["n_slips"][0] > 0
    assert response.scalars["n_slips"][0] == 0


def test_draft_counts_impacts_down_to_the_same_speed():
    fine, rough = (rock(block(1.0, 0.3), still(), theta_0=0.1, accuracy=a) for a in ("reference", "draft"))
    assert rough.scalars["n_impacts"][0] == fine.scalars["n_impacts"][0]
