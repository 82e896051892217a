"""Numbers of papers with which this program does not agree to the last printed digit: an integration of its own decides.

scipy's DOP853 under a smooth pulse, from the instant of uplift on, restarted at every impact (reference.py).
The studies are in studies/literature, the table in docs/validation.md.
"""

from __future__ import annotations

import numpy as np
import pytest
from reference import flights, symmetric
from scipy.optimize import brentq

G = 9.81


def fate(alpha, p, a_p, omega, eta, *, shape=np.sin, uplift, linear=False, span=1.0):
    """Impacts before it overturns, or None: a block under one cycle of a_p [g] shape(omega t), up to 30/p after it."""
    end, impacts = span * 2.0 * np.pi / omega, 0
    pieces = [(end, lambda t: a_p * shape(omega * t)), (end + 30.0 / p, lambda t: 0.0)]
    how = {"linear": linear, "fallen": 6.0 * alpha, "rest": 1e-4}
    for sol, _ in flights(symmetric(alpha, p, eta), -1, (0.0, 0.0), uplift, pieces, **how):
        if sol.t_events[1].size:
            return impacts
        impacts += sol.t_events[0].size
    return None


def begins(a_p, **scene):
    """Whether a block begins to overturn within 2e-6 of an amplitude [g]: it stands below and overturns above."""
    below, above = (
        fate(a_p=each, uplift=uplift_of(each, scene), **scene) is not None for each in (a_p - 2e-6, a_p + 2e-6)
    )
    return not below and above


def uplift_of(a_p, scene):
    threshold = scene["alpha"] if scene.get("linear") else np.tan(scene["alpha"])
    return 0.0 if scene.get("shape") is np.cos else float(np.arcsin(threshold / a_p) / scene["omega"])


def block(b, h):
    alpha = float(np.arctan(b / h))
    return {"alpha": alpha, "p": float(np.sqrt(0.75 * G / np.hypot(b, h))), "eta": 1.0 - 1.5 * np.sin(alpha) ** 2}


def test_makris_and_roussos_fig_9():
    scene = {"omega": 2.0 * np.pi, "linear": True, **block(0.5, 1.5)}
    assert begins(0.451540, **scene)  # the paper: .4514


def test_makris_and_roussos_fig_11():
    scene = {"omega": 2.0 * np.pi, "shape": np.cos, **block(0.5, 1.5)}
    assert begins(0.625844, **scene)  # the paper: .6255


def test_makris_and_roussos_fig_2():
    """Without an impact the closed form is known: sqrt(A^2 - 1) + A exp(-(pi - asin(1/A))/Omega) = Omega."""
    body = block(0.2, 0.6)
    Omega = 2.0 * np.pi / body["p"]
    A = brentq(lambda A: np.sqrt(A * A - 1.0) + A * np.exp(-(np.pi - np.arcsin(1.0 / A)) / Omega) - Omega, 1.0, 9.0)
    assert A * body["alpha"] == pytest.approx(0.5545859, abs=1e-7)  # the paper: .5545
    assert begins(0.554586, omega=2.0 * np.pi, linear=True, span=0.5, **body)


@pytest.mark.parametrize(
    ("omega", "somewhere"), [(5.35, True), (5.45, False), pytest.param(5.8, False, marks=pytest.mark.slow)]
)
def test_mode_1_of_the_block_of_20_degrees_ends_at_5_4(omega, somewhere):
    """Zhang and Makris (2001): at 5.8.  Amplitudes over g tan(alpha), 1/20 apart, where the band closes."""
    alpha = 0.349
    found = [
        fate(
            alpha=alpha,
            p=1.0,
            a_p=a,
            omega=omega,
            eta=1.0 - 1.5 * np.sin(alpha) ** 2,
            uplift=float(np.arcsin(np.tan(alpha) / a) / omega),
        )
        for a in np.arange(5.3, 6.1, 0.05) * np.tan(alpha)
    ]
    assert any(impacts for impacts in found) is somewhere  # None: stands; 0: overturns without an impact
