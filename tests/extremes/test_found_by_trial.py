"""Answers that were once wrong: extremes between looks, passages that a long step hides."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import G, block, pulse, rock, still, unit_block

LEVELS = ["draft", "standard", "reference"]


@pytest.mark.parametrize("accuracy", LEVELS)
def test_smallest_normal_force_of_a_fall(accuracy):
    """Let go at 1.01 alpha, alpha = 0.2: N from the energy, N/m g = 1 + 3/4 [sin b (-q''/p2) - ...] over the fall."""
    alpha = 0.2
    body = unit_block(alpha)
    response = rock(body, still(), theta_0=1.01 * alpha, accuracy=accuracy)
    q = np.linspace(1.01 * alpha, 0.5 * np.pi, 2_000_001)
    beta = alpha - q
    # with p = 1: q'' = -sin(beta), q'^2 = 2 (cos(beta_0) - cos(beta)); R = 3 g/4
    rate2 = 2.0 * (np.cos(0.01 * alpha) - np.cos(beta))
    N = 1.0 + 0.75 * (-(np.sin(beta) ** 2) - np.cos(beta) * rate2)
    T = np.abs(0.75 * (-np.cos(beta) * np.sin(beta) + np.sin(beta) * rate2))
    assert response.scalars["N_min_over_mg"][0] == pytest.approx(N.min(), rel=1e-4, abs=1e-9)
    assert response.scalars["mu_required"][0] == pytest.approx((T / N).max(), rel=1e-3)


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


def test_friction_on_the_way_to_the_ground_does_not_flag_a_body():
    body = block(2.0, 0.15)
    given = type(body)(**{**{f: getattr(body, f) for f in body.__dataclass_fields__}, "mu": np.array([0.95])})
    response = rock(given, still(), theta_dot_0=1.0)
    assert response.scalars["outcome"][0] == 2
    assert response.scalars["mu_required"][0] > 0.95  # over the fall, as reported
    assert response.reasons[0] == ""


def test_draft_counts_impacts_down_to_the_same_speed():
    fine, rough = (rock(block(1.0, 0.3), still(), theta_0=0.1, accuracy=a) for a in ("reference", "draft"))
    assert rough.scalars["n_impacts"][0] == fine.scalars["n_impacts"][0]
