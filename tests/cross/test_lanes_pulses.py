"""Pulse maps in lanes against the single-body kernels at reference accuracy, and against an independent DOP853."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from reference import falls, flights, symmetric
from scenes import G, make_batch, pulse

from rockcli import kernels
from rockcli.kernels.rigid import results as to
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import make_block
from rockcli.scene.ground.pulses import SHAPES
from rockcli.scene.laws.models import MODELS
from rockcli.solvers.event import pulse_lanes as lane_pulses
from rockcli.solvers.event.pack import parameters_of, settings_of
from rockcli.solvers.event.solver import solve
from rockcli.solvers.general import solver as general

ALPHA = 0.2
PEAKS = ("outcome", "theta_peak_over_alpha", "theta_peak", "n_impacts", "t_peak", "t_uplift")
OPTIONS = {"mavroeidis_papageorgiou": {"gamma": 3.0}, "sine": {"cycles": 2.0}}


def map_of(
    shape: str, side: int, *, model="rigid", geometry=None, eta=0.9, accuracy="standard", scalars=PEAKS
) -> Batch:
    """A side x side overturning map of a block of p = 1."""
    A, W = (x.ravel() for x in np.meshgrid(np.linspace(0.8, 6.0, side), np.linspace(0.5, 8.0, side)))
    options = {name: np.full(A.shape, value) for name, value in OPTIONS.get(shape, {}).items()}
    motion = pulse(shape, A * G * np.tan(ALPHA), W, **options)
    R = 0.75 * G
    body = make_block(h=R * np.cos(ALPHA), b=np.full((A.size, 2), R * np.sin(ALPHA)), R=R, alpha=ALPHA, n=A.size)
    batch = make_batch(body, motion, eta=np.full((A.size, 2), eta), model=model, accuracy=accuracy, scalars=scalars)
    return replace(batch, geometry=geometry)


def assert_same(batch: Batch, tolerance: float) -> None:
    assert lane_pulses.asked(batch)
    found = solve(batch)
    assert found.used["method"] == lane_pulses.METHOD
    exact = solve(replace(batch, numerics=replace(batch.numerics, accuracy="reference"))).scalars
    np.testing.assert_array_equal(found.scalars["outcome"], exact["outcome"])
    np.testing.assert_array_equal(found.scalars["t_uplift"] > 0.0, exact["t_uplift"] > 0.0)
    stands = np.isfinite(exact["theta_peak_over_alpha"])
    for name in ("theta_peak_over_alpha", "theta_peak"):
        one, other = found.scalars[name][stands], exact[name][stands]
        if (batch.damping.eta == 1.0).all():  # it swings as far to either side, for ever
            one, other = np.abs(one), np.abs(other)
        error = np.abs(one - other)
        assert np.median(error) < tolerance
        assert np.quantile(error, 0.99) < 1e3 * tolerance
    # an impact at the very end of the report may fall on either side of it
    assert np.mean(found.scalars["n_impacts"] != exact["n_impacts"]) < 5e-3


@pytest.mark.parametrize("shape", SHAPES)
def test_shapes(shape):
    assert_same(map_of(shape, 4), 1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("shape", SHAPES)
def test_shapes_in_detail(shape):
    assert_same(map_of(shape, 60), 1e-10)


@pytest.mark.parametrize(("model", "geometry"), [pair for pair in MODELS if pair != ("rigid", None)])
def test_models(model, geometry):
    assert_same(map_of("ricker", 4, model=model, geometry=geometry), 1e-10)


@pytest.mark.parametrize("eta", [0.0, 0.5, 1.0])
def test_restitution(eta):
    assert_same(map_of("sine", 4, eta=eta), 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("eta", [0.0, 0.3, 0.8, 0.99, 1.0])
def test_restitution_in_detail(eta):
    assert_same(map_of("ricker", 60, eta=eta), 1e-9)


def turned(batch: Batch) -> Batch:
    """It begins on its left edge, going back."""
    return replace(batch, theta_0=np.full(batch.size, -0.4 * ALPHA), theta_dot_0=np.full(batch.size, 0.03))


def pushed(batch: Batch) -> Batch:
    return replace(batch, theta_dot_0=np.full(batch.size, -0.1))


def cut(batch: Batch) -> Batch:
    """The report ends in the middle of some motions and soon after others."""
    return replace(batch, excitation=replace(batch.excitation, duration=np.linspace(2.0, 9.0, batch.size)))


def uneven(batch: Batch, left: float = 0.7, right: float = 1.1) -> Batch:
    h, b = 0.75 * G * np.cos(ALPHA), 0.75 * G * np.sin(ALPHA)
    return replace(batch, block=make_block(h=h, b=np.tile([left * b, right * b], (batch.size, 1)), n=batch.size))


FEATURES = [
    (turned,),
    (pushed,),
    (cut,),
    (uneven,),
    (uneven, cut),
    (uneven, turned),
    (turned, cut),
    (uneven, pushed, cut),
]
SIDES = ("theta_peak_left", "theta_peak_right")


def with_features(features, side: int, **how) -> Batch:
    batch = map_of("ricker", side, scalars=(*PEAKS, *SIDES), **how)
    for feature in features:
        batch = feature(batch)
    return batch


def assert_features(features, side: int, **how) -> None:
    batch = with_features(features, side, **how)
    assert_same(batch, 1e-10)
    found = solve(batch).scalars
    alone = solve(replace(batch, save=replace(batch.save, scalars=batch.save.scalars | {"t_end"})))
    assert alone.used["method"] != lane_pulses.METHOD
    assert np.mean(found["n_impacts"] != alone.scalars["n_impacts"]) < 5e-3
    exact = solve(replace(batch, numerics=replace(batch.numerics, accuracy="reference"))).scalars
    for name in (*SIDES, "t_peak", "t_uplift"):
        np.testing.assert_array_equal(np.isnan(found[name]), np.isnan(exact[name]))
        known = np.isfinite(exact[name])
        assert np.all(np.abs(found[name][known] - exact[name][known]) < 1e-6), name


def names(features) -> str:
    return "-".join(feature.__name__ for feature in features)


@pytest.mark.parametrize("features", FEATURES, ids=names)
def test_features(features):
    assert_features(features, 5)


@pytest.mark.slow
@pytest.mark.parametrize("model", ["rigid", "linearized", "3"])
@pytest.mark.parametrize("features", FEATURES, ids=names)
def test_features_in_detail(features, model):
    assert_features(features, 40, model=model, geometry="negative_stiffness" if model == "3" else None)


@pytest.mark.parametrize("features", [(turned,), (cut,), (uneven,), (uneven, turned, cut)], ids=names)
def test_features_against_general_solvers(features):
    """Solvers that share no formula with the lanes."""
    batch = with_features(features, 3)
    found = solve(batch).scalars
    other = general.solve(replace(batch, numerics=replace(batch.numerics, backend="scipy"))).scalars
    assert len(set(found["outcome"])) >= 2
    np.testing.assert_array_equal(found["outcome"], other["outcome"])
    for name in ("theta_peak", "t_peak", "t_uplift"):
        np.testing.assert_allclose(found[name], other[name], rtol=0.0, atol=2e-6)


def test_the_lanes_take_features():
    """None of them is left to the single-body kernels, but for a few that they hand over."""
    lanes = kernels.load("lanes.pulses.march", compile_them=bool(kernels.compiled))
    for features in FEATURES:
        batch = with_features(features, 5)
        how = settings_of(lanes, batch, batch.numerics.tolerances, lanes.OUTCOME + 1)
        raw = lane_pulses.run(lanes, batch, parameters_of(batch), how, slice(None), path=False)
        assert np.isnan(raw[:, to.STATUS]).mean() <= 0.2, names(features)


@pytest.mark.slow
@pytest.mark.parametrize("shape", SHAPES)
def test_no_wrong_outcome_among_forty_thousand(shape):
    batch = map_of(shape, 200, scalars=("outcome",))
    found = solve(batch).scalars["outcome"]
    exact = solve(replace(batch, numerics=replace(batch.numerics, accuracy="reference"))).scalars["outcome"]
    np.testing.assert_array_equal(found >= 2, exact >= 2)


def ricker_in_g(A: float, W: float):
    """A Ricker pulse of A g tan(alpha) as a function of time, in g, its end, and when it first lifts the block."""
    t0, end = 4.0 * np.pi / W, 8.0 * np.pi / W

    def a(t):
        x = 0.5 * (W * (t - t0)) ** 2
        return A * np.tan(ALPHA) * (1.0 - x) * np.exp(-0.5 * x)

    grid = np.linspace(0.0, end, 200_001)
    first = int(np.argmax(np.abs(a(grid)) > np.tan(ALPHA)))
    lo, hi = grid[first - 1], grid[first]
    for _ in range(60):
        lo, hi = (lo, 0.5 * (lo + hi)) if abs(a(0.5 * (lo + hi))) > np.tan(ALPHA) else (0.5 * (lo + hi), hi)
    return a, end, hi


def overturns_by_dop853(A: float, W: float, eta: float) -> bool:
    """A block of p = 1 under a Ricker pulse, in g, from its uplift on; the energy decides at the end."""
    a, end, hi = ricker_in_g(A, W)
    body = symmetric(ALPHA, 1.0, eta)
    *_, (sol, s) = flights(body, -int(np.sign(a(hi))), (0.0, 0.0), hi, [(end, a)])
    return bool(sol.t_events[1].size) or falls(body, s, sol.y[:, -1])


def test_against_dop853():
    A, W = (x.ravel() for x in np.meshgrid(np.linspace(1.5, 6.0, 6), np.linspace(1.0, 5.0, 5)))
    R = 0.75 * G
    body = make_block(h=R * np.cos(ALPHA), b=np.full((A.size, 2), R * np.sin(ALPHA)), R=R, alpha=ALPHA, n=A.size)
    motion = pulse("ricker", A * G * np.tan(ALPHA), W)
    batch = make_batch(body, motion, eta=np.full((A.size, 2), 0.9), accuracy="standard", scalars=("outcome",))
    found = solve(batch).scalars["outcome"] >= 2
    assert 3 <= found.sum() <= A.size - 3
    np.testing.assert_array_equal(found, [overturns_by_dop853(*case, 0.9) for case in zip(A, W, strict=True)])
