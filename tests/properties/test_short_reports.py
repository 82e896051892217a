"""A report that ends early (`duration`): what becomes of the body is told as by a long one, its peak is that of the report."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rockcli

PILLAR = [[-0.4, 0], [0.4, 0], [0.5, 0.1], [0.5, 3.6], [-0.5, 3.6], [-0.5, 0.1]]
BODIES: dict[str, dict[str, Any]] = {
    "block": {"R": 2.0, "tan_alpha": 0.2},
    "two edges": {"h": 1.9, "b": [0.35, 0.5]},
    "friction": {"R": 2.0, "tan_alpha": 0.2, "mu": 0.45},
    "rolls": {"outline": PILLAR, "density": 2500},
}
EVERY, PEAK, OUTCOME = "all", ["outcome", "theta_peak"], ["outcome"]
FALLS_AFTER_IMPACT = 3


def cases(rng, body, scheme, n, duration, **case):
    """Bodies that are let go with random rates, in one sweep."""
    start = {"theta": float(rng.uniform(-0.19, 0.19)), "theta_dot": 0.0}
    rates = sorted(rng.uniform(-1.3, 1.3, n).tolist())
    made = {"block": BODIES[body], "damping": scheme, "initial": start, "motion": {"duration": duration}} | case
    return {"name": "short", "case": made, "vary": {"initial.theta_dot": rates}}


def solved(study, scalars):
    return rockcli.run(study | {"save": {"histories": False, "scalars": scalars}})


SCHEMES = ("none", "dashpot", {"scheme": "restitution", "eta": 0.9})
DAMPED = [(body, how) for body in BODIES for how in SCHEMES if how != "dashpot" or body not in ("rolls", "friction")]
"""Bodies that roll or slide take no dashpot."""


@pytest.mark.parametrize(("body", "scheme"), DAMPED)
def test_the_same_fall_as_by_a_long_report(body, scheme):
    rng, later = np.random.default_rng(3), 0
    for _ in range(6):
        short = cases(rng, body, scheme, 12, float(rng.uniform(0.02, 0.4)))
        motion = {"motion": {"duration": 60.0}}
        told = solved(short, EVERY)
        truth = solved(short | {"case": short["case"] | motion}, EVERY)
        for scalars in (OUTCOME, PEAK):
            assert (solved(short, scalars).outcome == truth.outcome).all()
        assert (told.outcome == truth.outcome).all()
        fell = (truth.outcome >= 2).values
        assert (np.sign(told.theta_peak) == np.sign(truth.theta_peak)).values[fell].all()
        np.testing.assert_allclose(told.t_overturn.values[fell], truth.t_overturn.values[fell], rtol=1e-9)
        later += int(((told.outcome == FALLS_AFTER_IMPACT) & (told.n_impacts == 0)).sum())
    assert later > 0


@pytest.mark.parametrize("body", ["block", "two edges"])
def test_the_backend_scipy_tells_the_same(body):
    rng = np.random.default_rng(4)
    short = cases(rng, body, "none", 12, 0.1)
    told = solved(short, PEAK)
    other = solved(short | {"case": short["case"] | {"solver": {"backend": "scipy"}}}, PEAK)
    assert (told.outcome == other.outcome).all()
    assert (np.sign(told.theta_peak) == np.sign(other.theta_peak)).all()
    assert (told.outcome == FALLS_AFTER_IMPACT).any()


@pytest.mark.parametrize("scheme", ["none", "dashpot", "restitution"])
@pytest.mark.parametrize("body", ["block", "two edges"])
def test_the_peak_is_that_of_the_report(body, scheme):
    rng = np.random.default_rng(5)
    for _ in range(8):
        made = cases(rng, body, scheme, 1, 0.1)["case"]
        made["initial"]["theta_dot"] = float(rng.uniform(-0.5, 0.5))
        found = rockcli.run({"name": "short", "case": made, "save": {"histories": True, "dt_out": 1e-4}})
        if int(found.outcome) < 2:
            assert abs(float(found.theta_peak)) == pytest.approx(float(abs(found.theta).max()), rel=1e-5)


TILTED = {"block": {"R": 2.0, "tan_alpha": 0.2}, "initial": {"theta": 0.08}}
TOLD_BY = {
    "rigid": {},
    "scipy": {"solver": {"backend": "scipy"}},
    "friction": {"block": BODIES["friction"]},
    "slips": {"block": BODIES["friction"] | {"mu": 0.15}},
    "rolls": {"block": BODIES["rolls"]},
    "rests": {"initial": {"theta": 1e-4}, "damping": {"scheme": "restitution", "eta": 0.2}},
}


@pytest.mark.parametrize("case", TOLD_BY.values(), ids=TOLD_BY)
def test_histories_reach_the_end_where_the_output_times_pass_it_by_rounding(case):
    dt_out, duration = 0.005, 4.35
    assert 870 * dt_out > duration
    motion = {"duration": duration, "pulse": {"shape": "sine", "a_p": 0.5, "omega_p": 1, "cycles": 2}}
    save = {"histories": True, "dt_out": dt_out}
    told = rockcli.run({"name": "end", "case": TILTED | {"motion": motion} | case, "save": save})
    longer = rockcli.run({"name": "end", "case": TILTED | {"motion": motion | {"duration": 6.0}} | case, "save": save})
    assert told.sizes["time"] == 871
    for name in ("theta", "theta_dot", "a_g", "M_base"):
        np.testing.assert_allclose(told[name][-1], longer[name][870], rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("duration", [0.3, 0.6, 1.0])
def test_histories_of_the_backend_frame_reach_the_end_between_its_steps(duration):
    motion = {"duration": duration, "pulse": {"shape": "sine", "a_p": 1, "T_p": 0.5}}
    case = TILTED | {"initial": {"theta": 0.05}, "motion": motion, "model": 3, "solver": {"backend": "frame"}}
    told = rockcli.run({"name": "end", "case": case, "save": {"histories": True, "dt_out": 0.05}})
    assert told.time[-1] == pytest.approx(duration, rel=1e-12)
    assert np.isfinite(told.theta).all()


FOLLOWED_ON = {
    "slides": {"block": BODIES["friction"] | {"mu": 0.1}, "initial": {"slide_rate": 1.0}},
    "damped": {"damping": {"scheme": "dashpot", "coefficient": 0.05}, "initial": {"theta": 0.19, "theta_dot": -0.3}},
}


@pytest.mark.parametrize("case", FOLLOWED_ON.values(), ids=FOLLOWED_ON)
def test_histories_end_with_the_report_though_the_outcome_is_sought_beyond(case):
    study = {"name": "late", "case": TILTED | {"motion": {"duration": 1.0}} | case, "save": {"histories": True}}
    told = rockcli.run(study | {"vary": {"motion.duration": [0.02, 0.3, 4.0]}})
    ends = told.time.where(np.isfinite(told.theta)).max("time")
    assert ends[:2].values == pytest.approx([0.02, 0.3], rel=1e-12)
