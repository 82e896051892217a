"""Bodies that roll, many at a time under pulses: against an independent march, and the kernel that takes one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_rolling_dop853 import SHAPES, random_case, random_outline, reference

from rockcli import kernels
from rockcli.errors import StudyError
from rockcli.scene.response import overturned
from rockcli.solvers.event.solver import solve
from rockcli.solvers.rolling import solver as rolling_bodies
from rockcli.study.open import open_study

FOUND = (
    "outcome", "theta_peak", "t_peak", "t_uplift", "n_impacts", "residual_tilt", "theta_peak_left", "theta_peak_right",
    "u_top_peak",
)  # fmt: skip


@pytest.fixture(autouse=True, scope="module")
def compiled():
    kernels.load(compile_them=True)


@pytest.fixture
def alone(monkeypatch):
    """Solve a batch one by one."""

    def run(batch):
        with monkeypatch.context() as changed:
            changed.setattr(rolling_bodies, "fit", lambda batch, pars: np.zeros(len(pars), dtype=bool))
            return solve(batch).scalars

    return run


def in_lanes(batch, scalars=FOUND):
    some = replace(batch, save=replace(batch.save, histories=False, scalars=frozenset(scalars)))
    response = solve(some)
    assert "lanes" in response.used["method"]
    return response.scalars


def amplitudes(seed, n=120):
    """A random outline under n amplitudes of a pulse, or None where it is flat."""
    rng = np.random.default_rng(seed)
    outline, shape, period = random_outline(rng), str(rng.choice(SHAPES)), rng.uniform(0.3, 1.5)
    pulse = {"shape": shape, "a_p": "1*g", "T_p": period}
    study = {
        "name": "a",
        "case": {"block": {"outline": outline.tolist(), "stands": "settled"}, "motion": {"pulse": pulse}},
        "vary": {"motion.pulse.a_p": {"from": "0.2*g*tan_alpha", "to": "6*g*tan_alpha", "n": n}},
        "save": {"histories": False, "scalars": list(FOUND)},
    }
    try:
        ((_, batch),) = open_study(study).batches()
    except StudyError:
        return None
    return batch if batch.block.rolls.all() else None


def compare_with_march(seed):
    batch = random_case(seed)
    theirs = reference(batch)
    ours = {name: values[0] for name, values in in_lanes(batch).items()}
    if not theirs.fell and abs(abs(ours["theta_peak"]) - theirs.peak) > 1e-8:
        theirs = reference(batch, finer=50)
    assert bool(overturned(ours["outcome"])) == theirs.fell, seed
    if not theirs.fell:
        assert abs(abs(ours["theta_peak"]) - theirs.peak) < 1e-8, seed
        assert abs(ours["theta_peak_left"] - theirs.peak_left) < 1e-8, seed
        if theirs.rested:
            assert ours["residual_tilt"] == pytest.approx(theirs.theta, abs=1e-9), seed


@pytest.mark.parametrize("seed", [1, 3, 6, 7, 9])
def test_lanes_agree_with_an_independent_march(seed):
    compare_with_march(seed)


@pytest.mark.slow
def test_a_hundred_outlines_in_lanes():
    for seed in range(1000, 1150):
        if seed % 3 != 2:  # a pulse
            compare_with_march(seed)


@pytest.mark.parametrize("seed", [1, 18, 39, 54, 57])
def test_lanes_answer_as_one_body_alone_does(seed, alone):
    batch = amplitudes(seed)
    ours, theirs = in_lanes(batch), alone(batch)
    np.testing.assert_array_equal(ours["outcome"], theirs["outcome"])
    for name in FOUND[1:]:
        if name == "n_impacts":  # those at the limit of what counts
            np.testing.assert_allclose(ours[name], theirs[name], atol=1)
        else:
            np.testing.assert_allclose(ours[name], theirs[name], rtol=1e-8, atol=1e-8 if name != "t_peak" else 1e-6)


def test_the_outcome_alone_is_the_same(alone):
    for seed in (18, 39, 54):
        batch = amplitudes(seed)
        whole = in_lanes(batch)
        few = in_lanes(batch, ("outcome", "residual_tilt"))
        for name in few:
            if name in ("outcome", "residual_tilt"):
                np.testing.assert_array_equal(few[name], whole[name])


def test_a_case_does_not_depend_on_the_others():
    batch = amplitudes(57)
    whole = in_lanes(batch)
    for rows in (np.arange(7, 40), np.array([90])):
        some = in_lanes(batch.rows(rows))
        for name in FOUND:
            np.testing.assert_array_equal(some[name], whole[name][rows])
