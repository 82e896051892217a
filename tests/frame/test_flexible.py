"""The thesis's flexible column: known values, and the modal solver, which has no penalty spring and no small step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from frame.frames import column, framed
from scenes import G, array, block, make_batch, peak, pulse, still

from rockcli.scene.body.column import Base
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import NO_UPLIFT
from rockcli.solvers.event.solver import solve as event
from rockcli.solvers.flexible import solve as modal
from rockcli.solvers.frame.solver import solve


@pytest.mark.parametrize(
    ("how", "expected"),
    [
        ({"mass": "lumped", "zeta": 0.0}, 0.685),  # Fig. 60, as OpenSees has it with 5 elements
        ({"mass": "lumped", "eta": "housner"}, 0.6256),  # Fig. 63
        ({"mass": "consistent"}, 0.6832),  # converged, zeta .01
        ({"mass": "consistent", "eta": "housner"}, 0.6428),
    ],
)
def test_figures_60_and_63(how, expected):
    assert peak(solve(framed(column(**how), dt=2e-4))) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize(
    "how",
    [
        {"eta": "housner"},
        {"eta": "housner", "mass": "lumped"},
        {"eta": 1.0},
        {"eta": "housner", "base": True},
        pytest.param({"eta": "housner", "n": 10}, marks=pytest.mark.slow),
    ],
)
def test_against_the_modal_solver(how):
    base = Base("winkler", array(1e11)) if how.pop("base", False) else None
    batch = replace(column(**how), base=base)
    frame, exact = solve(framed(batch)), modal(replace(batch, numerics=Numerics()))
    assert peak(frame) == pytest.approx(peak(exact), abs=1e-3)
    assert frame.scalars["n_impacts"][0] == pytest.approx(exact.scalars["n_impacts"][0], abs=1)


def test_a_stiff_column_is_model_3():
    rigid = replace(column(), model="3", geometry="corotational", column=None)
    assert peak(solve(framed(column(E=1e16)))) == pytest.approx(peak(event(rigid)), abs=2e-3)


def test_histories_of_the_top():
    response = solve(framed(column(histories=True, eta="housner"), dt=2e-4))
    theta, top, bending = (response.histories[name][0] for name in ("theta", "u_top", "u_top_bending"))
    live = np.isfinite(theta)
    np.testing.assert_allclose(bending[live], (top - 50.0 * np.sin(theta))[live], atol=2e-4)
    assert 0.05 < np.abs(bending[live]).max() < 0.2
    assert response.scalars["u_top_peak"][0] == pytest.approx(np.abs(top[live]).max(), rel=1e-3)


@pytest.mark.parametrize("mass", [np.nan, 4e6])
def test_moment_of_the_base_is_per_unit_mass_or_of_the_mass_given(mass):
    batch = column(histories=True, dt_out=0.01)
    batch = replace(batch, block=replace(batch.block, mass=array(mass)))
    frame, exact = solve(framed(batch)).histories, modal(batch).histories
    open_ = np.flatnonzero(np.abs(frame["theta"][0]) > 1e-3)
    assert len(open_) > 100
    np.testing.assert_allclose(frame["M_base"][0, open_], exact["M_base"][0, open_], rtol=1e-9)
    assert np.abs(frame["M_base"][0, open_[0]]) == pytest.approx(G * 2.5 * (mass if np.isfinite(mass) else 1.0))


@pytest.mark.slow
def test_one_eta_per_landing():
    # the base re-crosses zero several times after a landing; the count hardly depends on the mesh
    counts = [int(solve(framed(column(n=n, eta="housner"), dt=2e-4)).scalars["n_impacts"][0]) for n in (3, 5, 10)]
    assert max(counts) - min(counts) <= 1


def under_both(zeta: float, eta: float | str):
    """A column under a horizontal and a vertical motion, and the stiffness of its Winkler base."""
    vertical = pulse("sine", -7.0, 3.0, cycles=2.0).horizontal
    motion = replace(pulse("sine", 0.7, 4.0, cycles=2.0), vertical=vertical)
    kw = 2500.0 * 10.0 * G / (2.0 * 0.5**2) / (0.05 * np.arctan(0.1))
    return column(E=4e9, zeta=zeta, n=3, height=10.0, excitation=motion, eta=eta), array(kw)


def test_a_winkler_base_under_vertical_motion_is_as_stiff_as_at_rest():
    # fibres know nothing of the law: the weight opens them sooner, their stiffness stays
    batch, kw = under_both(0.05, "housner")
    on_law, on_fibres = (replace(batch, base=Base("winkler", kw, fibres)) for fibres in (None, 81))
    assert peak(solve(framed(on_law))) == pytest.approx(peak(solve(framed(on_fibres))), rel=0.015)


@pytest.mark.parametrize("fibres", [None, 81])
def test_a_winkler_base_under_vertical_motion_opens_by_what_it_carries_and_keeps_the_energy(fibres):
    batch, kw = under_both(0.0, 1.0)
    found = solve(framed(replace(batch, base=Base("winkler", kw, fibres)), dt=5e-4)).scalars
    column_alone = modal(replace(batch, base=Base("winkler", kw, None))).scalars
    # the vertical motion sets the column on fibres swinging by 21 m/s^3 over omega = 63 1/s, 3 % of the weight at rest
    within = 1e-3 if fibres is None else 0.01
    assert found["t_uplift"][0] == pytest.approx(column_alone["t_uplift"][0], abs=within)
    assert abs(found["energy_residual"][0]) < 1e-6


@pytest.mark.parametrize("fibres", [None, 21])
def test_a_base_in_full_contact_loses_nothing_by_eta(fibres):
    # the edge opens from .15 alpha on; a spring that is pressed all the time takes no energy
    body = column(height=20.0, n=2, zeta=0.0, excitation=pulse("sine", 0.3 * G * 0.1, 2.0 * np.pi / 1.5, duration=8.0))
    kw = 2500.0 * 40.0 * G / (2.0 * 1.0**2) / (0.15 * np.arctan(0.1))
    batch = replace(body, base=Base("winkler", array(kw), fibres), save=replace(body.save, histories=True))
    kept = solve(framed(batch, dt=1e-3))
    struck = solve(framed(replace(batch, damping=replace(batch.damping, eta=0.8 * batch.damping.eta)), dt=1e-3))
    assert np.nanmax(np.abs(kept.histories["theta"])) > 0.05 * np.arctan(0.1)
    assert struck.scalars["outcome"][0] == NO_UPLIFT
    assert struck.scalars["n_impacts"][0] == 0
    np.testing.assert_array_equal(struck.histories["theta"], kept.histories["theta"])


def test_a_base_of_fibres_uplifts_where_it_hops():
    """Closed form: dropped with A = .8 g, it swings about -(g - A)/omega^2 from -g/omega^2 and is off at v = 0."""
    fall, omega, body = 0.8, 20.0, block(2.0, 0.2)
    batch = make_batch(body, still(0.5), eta=1.0, model="4")
    motion = replace(still(0.5), vertical=pulse("rectangular", -fall * G, 2.0 * np.pi).horizontal)
    kw = 2500.0 * 2.0 * body.h[0] * omega**2  # of 2 b kw/m
    hopping = replace(batch, geometry="corotational", excitation=motion, base=Base("winkler", array(kw), 5))
    leaves = np.arccos(-(1.0 - fall) / fall) / omega
    assert solve(framed(hopping)).scalars["t_uplift"][0] == pytest.approx(leaves, abs=2e-4)


@pytest.mark.parametrize("fibres", [None, 21])
def test_a_column_let_go_in_full_contact_does_not_uplift(fibres):
    # from .05 alpha on a base that opens at .3 alpha: the edges stay down, as in the modal solver
    kw = array(2500.0 * 40.0 * G / (2.0 * 1.0**2) / (0.3 * np.arctan(0.1)))
    let_go = column(height=20.0, n=2, theta_0=0.05 * np.arctan(0.1), excitation=still(3.0))
    on_law, batch = (replace(let_go, base=Base("winkler", kw, how)) for how in (None, fibres))
    found = solve(framed(batch, dt=1e-3)).scalars
    assert found["outcome"][0] == modal(on_law).scalars["outcome"][0] == NO_UPLIFT
    assert np.isnan(found["t_uplift"][0])
    assert found["theta_peak_over_alpha"][0] == 0.0
