"""Bodies whose two edges differ in the lanes of records: against the single-body solver, DOP853, and themselves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cross.test_lanes_records import (
    LAWS,
    SCALARS,
    _lanes_only,
    assert_as_integrated,
    assert_known_early,
    assert_same,
    differences,
    mirrored,
    own,
    same_bits_apart,
)
from scenes import G, make_batch

from rockcli.scene.body.block import housner_eta, make_block
from rockcli.scene.ground.excitation import Excitation, Samples
from rockcli.scene.response import OVERTURNED_WITHOUT_IMPACT
from rockcli.solvers.event import solver as event
from rockcli.solvers.event.solver import solve

assert _lanes_only  # a fixture of every test here too


def skew(values, dt, scale, h, ratio, *, eta=None, model="rigid", geometry=None, scalars=SCALARS, **theta):
    """Every combination of scale [g tan(alpha) of the lower edge], h [m] and left over right edge, .2 h to the right."""
    scale, h, ratio = (x.ravel() for x in np.meshgrid(scale, h, ratio, indexing="ij"))
    n = len(scale)
    body = make_block(h=h, b=np.column_stack([0.2 * h * ratio, 0.2 * h]), n=n)
    least = np.minimum(0.2 * ratio, 0.2)
    kept = np.clip(housner_eta(body), 0.0, 1.0) if eta is None else np.full((n, 2), eta)
    motion = Samples(values, dt, scale * G * least / np.abs(values).max())
    batch = make_batch(
        body,
        Excitation(motion, None, np.full(n, np.nan)),
        eta=kept,
        model=model,
        accuracy="standard",
        scalars=scalars,
        dt_out=0.01,
        **theta,
    )
    return replace(batch, geometry=geometry)


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_every_law(law):
    values, dt = own()
    batch = skew(values, dt, np.linspace(0.9, 6.0, 9), [0.6, 3.0], [0.6, 1.5], model=law[0], geometry=law[1])
    found = assert_same(batch, most=1e-7, other_impacts=0.02)  # where it is hit some 300 times
    assert {0, 1} <= set(found["outcome"].tolist())
    assert (found["outcome"] >= OVERTURNED_WITHOUT_IMPACT).any()


@pytest.mark.parametrize("eta", [0.0, 0.5, (0.9, 0.6)])
def test_every_restitution(eta):
    values, dt = own("synthetic_rock_m65.AT2")
    wrong, error, found, exact = differences(skew(values, dt, [1.05, 2.0, 3.0, 4.5], [1.0, 3.0], [0.7, 1.2], eta=eta))
    assert not wrong.any()
    assert np.median(error) <= 1e-10
    for name in ("theta_peak_left", "theta_peak_right"):
        np.testing.assert_array_equal(np.isfinite(found[name]), np.isfinite(exact[name]))
        apart = np.abs(found[name] - exact[name])
        assert np.nanmedian(np.where(np.isfinite(apart), apart, np.nan)) <= 1e-10


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_a_fall_is_known_before_it_ends(law):
    values, dt = own()
    batch = skew(values, dt, np.linspace(1.5, 8.0, 19), [0.5, 3.0], [0.6, 1.5], model=law[0], geometry=law[1])
    asked = ("outcome", "theta_peak", "theta_peak_left", "theta_peak_right", "t_uplift", "n_impacts")
    assert_known_early(batch, asked, share=1.0)


def test_from_a_tilt_to_either_side():
    values, dt = own()
    for theta in (-0.05, 0.08):
        batch = skew(values, dt, [0.5, 2.0], [1.0, 2.0], [0.7, 1.3], theta_0=theta, theta_dot_0=0.1)
        wrong, error, _, _ = differences(batch)
        assert not wrong.any()
        assert np.median(error) <= 1e-10


def test_a_mirrored_body_under_a_mirrored_motion():
    values, dt = own()
    batch = skew(values, dt, [1.5, 2.5, 3.5], [0.8, 2.0], [0.7])
    body = make_block(h=batch.block.h, b=batch.block.b[:, ::-1].copy(), n=batch.size)
    eta = replace(batch.damping, eta=batch.damping.eta[:, ::-1].copy())
    back = replace(batch, block=body, damping=eta, excitation=mirrored(batch.excitation))
    here, there = solve(batch).scalars, solve(back).scalars
    np.testing.assert_array_equal(here["theta_peak"], -there["theta_peak"])
    np.testing.assert_array_equal(here["n_impacts"], there["n_impacts"])


def test_neighbours_order_and_other_bodies_do_not_matter():
    """Among bodies whose edges are alike too."""
    values, dt = own()
    batch = skew(values, dt, np.linspace(0.9, 6.0, 40), np.geomspace(0.4, 6.0, 5), [0.6, 1.0, 1.4])
    same_bits_apart(batch, (*SCALARS, "n_steps", "theta_peak_left", "mu_impact"))


def test_hardly_any_is_left_to_the_single_body(monkeypatch):
    alone = []
    monkeypatch.setattr(event, "_march_rows", lambda kernel, batch, rows, *rest, **more: alone.append(len(rows)))
    values, dt = own()
    solve(skew(values, dt, np.linspace(0.9, 6.0, 20), np.geomspace(0.4, 6.0, 5), [0.6, 1.4]))
    assert sum(alone) == 0


@pytest.mark.slow
def test_against_an_independent_integrator():
    values, dt = own()
    assert_as_integrated(skew(values, dt, [1.4, 2.4], [1.0], [0.7, 1.3]), values, dt, 2e-8)


def test_certainty():
    """The second run of the estimate goes in lanes too, and it bounds the error."""
    values, dt = own()
    batch = skew(
        values,
        dt,
        np.linspace(1.0, 4.0, 25),
        [0.7, 2.0],
        [0.6, 1.3],
        scalars=(*SCALARS, "error_estimate", "overturn_share"),
    )
    response = solve(batch)
    assert "lanes" in response.used["method"]
    _, _, _, exact = differences(skew(values, dt, np.linspace(1.0, 4.0, 25), [0.7, 2.0], [0.6, 1.3]))
    found = response.scalars
    sure = np.isfinite(found["theta_peak_over_alpha"]) & (found["outcome"] >= 0)
    assert sure.sum() >= 20
    error = np.abs(found["theta_peak_over_alpha"][sure] - exact["theta_peak_over_alpha"][sure])
    assert (error <= np.maximum(found["error_estimate"][sure], 1e-12)).mean() > 0.98
    np.testing.assert_array_equal(found["outcome"][sure], exact["outcome"][sure])
