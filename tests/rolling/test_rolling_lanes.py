"""Bodies that roll, many at a time: against an independent march, and the kernel that takes one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rolling_cases import FOUND, PATH, SHAPES, compare_with_march, in_lanes, random_case, random_outline
from scipy.integrate import quad

from rockcli import kernels
from rockcli.errors import StudyError
from rockcli.kernels.rolling.bounces import STEEPER, duration
from rockcli.scene.response import ROCKING, overturned
from rockcli.solvers.common.certainty import CERTAINTY
from rockcli.solvers.event.solver import solve
from rockcli.solvers.rolling import solver as rolling_bodies
from rockcli.study.open import open_study

RECORDS = Path(__file__).resolve().parents[2] / "records"
RECORD = "synthetic_pulse_m70.AT2"


@pytest.fixture(autouse=True, scope="module")
def compiled():
    kernels.load(compile_them=True)


@pytest.fixture
def alone(monkeypatch):
    """Solve a batch one by one."""

    def run(batch):
        with monkeypatch.context() as changed:
            changed.setattr(rolling_bodies, "_way", lambda batch: "")
            return solve(batch).scalars

    return run


def amplitudes(seed, n=120, *, record=""):
    """A random outline under n amplitudes of a pulse, or of a record, or None where it is flat."""
    rng = np.random.default_rng(seed)
    outline, shape, period = random_outline(rng), str(rng.choice(SHAPES)), rng.uniform(0.3, 1.5)
    motion, axis = {"pulse": {"shape": shape, "a_p": "1*g", "T_p": period}}, "motion.pulse.a_p"
    if record:
        motion, axis = {"record": {"file": str(RECORDS / record), "pga": "1*g"}}, "motion.record.pga"
    study = {
        "name": "a",
        "case": {"block": {"outline": outline.tolist(), "stands": "settled"}, "motion": motion},
        "vary": {axis: {"from": "0.2*g*tan_alpha", "to": "6*g*tan_alpha", "n": n}},
        "save": {"histories": False, "scalars": list(FOUND)},
    }
    try:
        ((_, batch),) = open_study(study).batches()
    except StudyError:
        return None
    return batch if batch.block.rolls.all() else None


@pytest.mark.parametrize("path", [False, True])
@pytest.mark.parametrize("seed", [16, 122, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (77, 139))])
def test_lanes_agree_with_an_independent_march(seed, path):
    compare_with_march(seed, path=path)


@pytest.mark.slow
@pytest.mark.parametrize("path", [False, True])
def test_a_hundred_outlines_in_lanes(path):
    for seed in range(1000, 1150):
        if seed % 3 != 2:
            compare_with_march(seed, path=path)


@pytest.mark.parametrize("path", [False, True])
@pytest.mark.parametrize("seed", [35, 110, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (210, 1044))])
def test_lanes_of_records_agree_with_an_independent_march(seed, path):
    compare_with_march(seed, record=True, path=path)


@pytest.mark.slow
def test_a_hundred_and_fifty_outlines_in_lanes_of_records():
    found = []
    for seed in range(2000, 2150):
        ours = in_lanes(random_case(seed, True), (*FOUND, *PATH, *CERTAINTY))
        chaos = 0.0 < ours["overturn_share"][0] < 1.0 or ours["error_estimate"][0] > 1e-7
        found.append("chaos" if chaos else "falls" if overturned(ours["outcome"][0]) else "stands")
        if not chaos:
            compare_with_march(seed, record=True, path=True)
    assert found.count("chaos") < 5
    assert min(found.count(word) for word in ("falls", "stands")) >= 25


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


@pytest.mark.parametrize(("seed", "record"), [(113, True), (374, False), (1330, False), (2845, True), (5666, False)])
def test_no_impact_that_counts_is_left_out(seed, record, alone):
    """A facet whose ends press harder than the barrier is far: bounces that count go on below 1e-6 p sin(alpha)."""
    batch = random_case(seed, record)
    found = [alone(replace(batch, numerics=replace(batch.numerics, accuracy=x))) for x in ("standard", "reference")]
    found += [in_lanes(batch, ("outcome", "n_impacts")), in_lanes(batch, FOUND + PATH)]
    assert len({int(x["n_impacts"][0]) for x in found}) == 1


@pytest.mark.parametrize("record", [RECORD, "synthetic_rock_m65.AT2"])
@pytest.mark.parametrize("seed", [1, 18, 39, 54, 57])
def test_lanes_of_records_answer_as_one_body_alone_does(seed, record, alone):
    batch = amplitudes(seed, 60, record=record)
    save = replace(batch.save, scalars=frozenset((*FOUND, "t_overturn", "t_end", *CERTAINTY)))
    calm = np.zeros(batch.size, dtype=bool)
    for asked in (replace(batch, save=save), batch):
        ours, theirs = in_lanes(asked, asked.save.scalars), alone(asked)
        if "error_estimate" in ours:
            calm = (ours["error_estimate"] < 1e-8) & (ours["overturn_share"] % 1.0 == 0.0)
            assert calm.sum() >= 20
        np.testing.assert_array_equal(ours["outcome"][calm], theirs["outcome"][calm])
        for name in asked.save.scalars - {"outcome", "n_impacts", *CERTAINTY}:
            # of a body that falls the estimate says nothing about its peak to the other side
            known = calm & ~overturned(ours["outcome"]) if name.startswith("theta_peak_") else calm
            atol = 1e-8 if name[:2] != "t_" else 1e-5
            np.testing.assert_allclose(ours[name][known], theirs[name][known], rtol=1e-7, atol=atol, err_msg=name)
        apart = np.abs(ours["n_impacts"] - theirs["n_impacts"])
        assert np.mean(apart[calm] > 1 + 0.01 * theirs["n_impacts"][calm]) <= 0.2  # those near the least that counts


def test_forces_where_a_record_ends_with_a_jump_are_read(tmp_path, alone):
    acceleration = [0.0, -0.56, -1.12, 1.42, 3.96, 5.92, 7.89]
    (tmp_path / "cut.txt").write_text("".join(f"{a}\n" for a in acceleration))
    outline = [[0.0, 0.0], [0.54, 0.0], [0.68, 0.14], [0.61, 2.6], [-0.07, 2.5], [-0.11, 0.2]]
    record = {"file": str(tmp_path / "cut.txt"), "units": "m/s2", "dt": 0.0055}
    study = {
        "name": "cut",
        "case": {"block": {"outline": outline, "density": 1}, "motion": {"record": record}},
        "vary": {"motion.record.scale": [1.0, 1.5, 2.0]},
        "save": {"histories": False, "scalars": ["mu_required", "N_min_over_mg", "theta_dot_peak"]},
    }
    ((_, batch),) = open_study(study).batches()
    together, one_by_one = solve(batch), alone(batch)
    assert "lanes" in together.used["method"]
    for name in study["save"]["scalars"]:
        np.testing.assert_allclose(together.scalars[name], one_by_one[name], rtol=1e-7, err_msg=name)


def test_the_outcome_alone_is_the_same(alone):
    for seed, record in ((18, ""), (39, ""), (54, ""), (18, RECORD), (54, RECORD)):
        batch = amplitudes(seed, record=record)
        whole = in_lanes(batch)
        few = in_lanes(batch, ("outcome", "residual_tilt"))
        for name in few:
            if name in ("outcome", "residual_tilt"):
                np.testing.assert_array_equal(few[name], whole[name])


@pytest.mark.parametrize("record", ["", RECORD])
def test_a_case_does_not_depend_on_the_others(record):
    batch = amplitudes(57, record=record)
    whole = in_lanes(batch)
    for rows in (np.arange(7, 40), np.array([90])):
        some = in_lanes(batch.rows(rows))
        for name in FOUND:
            np.testing.assert_array_equal(some[name], whole[name][rows])


@pytest.mark.parametrize("record", [RECORD, "synthetic_rock_m65.AT2", "synthetic_soil_m70.AT2"])
def test_the_error_estimate_of_lanes_holds_what_parts_them_from_one_body_alone(record, alone):
    """Also where runs part, and more accurate ones are reported: small bounces on a short facet are theirs."""
    for seed in (1, 18, 39, 54, 57):
        batch = amplitudes(seed, 60, record=record)
        asked = replace(batch, save=replace(batch.save, scalars=frozenset((*FOUND, *CERTAINTY))))
        names = (*asked.save.scalars, "theta_peak_over_alpha")
        ours, theirs = in_lanes(asked, names), alone(asked)
        rocks = (ours["outcome"] == ROCKING) & (theirs["outcome"] == ROCKING)
        peaks = (run["theta_peak_over_alpha"][rocks] for run in (ours, theirs))
        errors = (run["error_estimate"][rocks] for run in (ours, theirs))
        assert np.all(np.abs(np.subtract(*peaks)) <= 3.0 * np.add(*errors) + 1e-9)


def test_the_time_of_a_bounce_is_the_integral_of_its_law():
    """From v to w while the centre of mass rises, cos(alpha - q) from c to d: dt = dw/(p^2 sin(alpha - q))."""
    rng, wrong, finely = np.random.default_rng(3), [], []
    for _ in range(300):
        p2, end = rng.uniform(1.0, 20.0), rng.uniform(0.3, 0.98)  # sin of at least a fifth
        start = max(0.0, end - (1.0 - end) * 10.0 ** rng.uniform(-3.0, 0.3))
        w = rng.choice([0.0, rng.uniform(0.0, 5.0)])
        v = np.sqrt(w * w + 2.0 * p2 * (end - start))

        def slowness(rate, p2=p2, start=start, v=v):
            near = start + 0.5 * (v * v - rate * rate) / p2
            return 1.0 / (p2 * np.sqrt(1.0 - near * near))

        exact = quad(slowness, w, v, epsabs=0.0, epsrel=1e-12)[0]
        wrong.append(abs(duration(p2, start, v, w, False) / exact - 1.0))
        if 1.0 - end**2 >= STEEPER**2 * (1.0 - start**2):
            finely.append(abs(duration(p2, start, v, w, True) / exact - 1.0))
    assert max(wrong) < 1e-6
    assert len(finely) > 100
    assert max(finely) < 1e-10
