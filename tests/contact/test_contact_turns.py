"""Bodies under records that go by turns through lanes and the kernel of contact, and those that stay with that one."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scenes import G, block, make_batch, record

from rockcli.kernels.contact import results as to
from rockcli.motion.reading import read_record
from rockcli.scene.body.block import make_block
from rockcli.scene.ground.excitation import Excitation, Suite
from rockcli.scene.variables import SCALARS
from rockcli.solvers.contact import solver as contact_solver
from rockcli.solvers.contact import turns
from rockcli.solvers.contact.run import run
from rockcli.solvers.event import record_lanes
from rockcli.solvers.event.solver import solve

NAMES = frozenset(
    {
        "outcome", "theta_peak", "slide_peak", "slide_residual", "t_slip", "n_slips", "n_flights", "t_uplift", "t_peak",
        "t_overturn", "t_end", "n_impacts",
    }
)  # fmt: skip


EXTREMES = frozenset({"theta_dot_peak", "u_top_peak", "N_min_over_mg"})


def asked(batch, names):
    return dataclasses.replace(batch, save=dataclasses.replace(batch.save, scalars=frozenset(names)))


def alone(batch, monkeypatch):
    """The scalars with the kernel of contact alone."""
    with monkeypatch.context() as patch:
        patch.setattr(contact_solver, "solved", run)
        return solve(asked(batch, NAMES | EXTREMES | {"error_estimate", "mu_required", "mu_impact"})).scalars


def scene(name, n=120, kinetic=1.0, eta="housner", theta_0=0.0, strength=1.0):
    rng = np.random.default_rng(11)
    tan_alpha = rng.uniform(0.08, 0.45, n)
    body = block(np.exp(rng.uniform(-1.0, 1.5, n)), tan_alpha, n)
    mu = rng.uniform(1.0, 1.2, n) * tan_alpha
    body = dataclasses.replace(body, mu=mu, mu_kinetic=kinetic * mu)
    motion = read_record(f"records/{name}.AT2")
    values = motion.acceleration(G)
    factor = strength * rng.uniform(1.0, 2.5, n) * tan_alpha * G / np.abs(values).max()
    batch = make_batch(
        body,
        record(values, motion.dt, factor=factor),
        accuracy="standard",
        eta=eta,
        theta_0=theta_0 * np.arctan(tan_alpha),
    )
    return dataclasses.replace(batch, save=dataclasses.replace(batch.save, histories=False, scalars=NAMES))


def assert_a_few_slip_in_lanes_as_alone():
    """Four bodies under a second of strong motion: the results of either way."""
    t = np.arange(60) * 0.02
    values = 6.0 * np.sin(9.0 * t) + 2.0 * np.sin(31.0 * t)
    body = block(np.array([0.5, 1.0, 1.0, 2.0]), np.array([0.3, 0.25, 0.2, 0.3]), 4)
    body = dataclasses.replace(
        body, mu=1.05 * body.tan_alpha[:, 0], mu_kinetic=np.array([0.9, 1.05, 0.8, 1.0]) * body.tan_alpha[:, 0]
    )
    batch = asked(make_batch(body, record(values, 0.02, factor=np.ones(4)), accuracy="standard"), SCALARS)
    level = batch.numerics.tolerances
    one, other = turns.solved(batch, level).out, run(batch, level).out
    assert other[:, to.N_SLIPS].sum() >= 8
    np.testing.assert_array_equal(one[:, to.VERDICT], other[:, to.VERDICT])
    np.testing.assert_array_equal(one[:, to.N_SLIPS], other[:, to.N_SLIPS])
    np.testing.assert_allclose(one[:, to.BALANCE], 0.0, atol=1e-10)
    for column in (to.PEAK, to.SLIDE_PEAK, to.SLIDE_END, to.RATE_PEAK, to.TOP_PEAK, to.N_MIN, to.T_SLIP):
        np.testing.assert_allclose(one[:, column], other[:, column], rtol=1e-7, atol=1e-10)


@pytest.mark.parametrize(
    ("name", "how"),
    [
        ("synthetic_pulse_m70", {}),
        ("synthetic_rock_m65", {"kinetic": 0.7}),
        ("synthetic_soil_m70", {"eta": 0.9}),
        ("synthetic_rock_m65", {"theta_0": 0.4}),
        ("synthetic_soil_m70", {"strength": 3.0}),
        ("synthetic_pulse_m70", {"strength": 2.5, "kinetic": 0.8}),
    ],
)
@pytest.mark.parametrize("every", [False, True])
def test_turns_end_where_the_kernel_of_contact_does_alone(name, how, every, monkeypatch):
    batch = scene(name, **how)
    followed = alone(batch, monkeypatch)
    begun_anew = []
    whole = turns.run

    def counted(some, level):
        begun_anew.append(turns.can_take_turns(some).sum())
        return whole(some, level)

    monkeypatch.setattr(turns, "run", counted)
    by_turns = solve(asked(batch, SCALARS) if every else batch).scalars
    assert sum(begun_anew) < 0.1 * batch.size
    slid = followed["slide_peak"] > 0.0
    assert slid.mean() > 0.2
    # of a thousand small impacts both ways forget the start, as they do without friction
    calm = followed["n_impacts"] < 500
    assert calm.mean() > 0.5
    for exact in ("outcome", "n_slips", "n_flights"):
        np.testing.assert_array_equal(by_turns[exact][calm], followed[exact][calm], err_msg=exact)
    # of bounces that end in rest, lanes count the last ones to the letter
    np.testing.assert_allclose(by_turns["n_impacts"][calm], followed["n_impacts"][calm], rtol=0.02, atol=1.0)
    if every:
        assert np.abs(by_turns["energy_residual"][slid]).max() < 1e-10
        # two runs of a body are told apart as they are by the kernel of contact alone
        ratio = by_turns["error_estimate"][slid & calm] / followed["error_estimate"][slid & calm]
        assert 0.9 < np.nanmedian(ratio) < 1.1
    for close in (NAMES | EXTREMES if every else NAMES) - {"outcome", "n_slips", "n_flights", "n_impacts"}:
        one, other = by_turns[close], followed[close]
        # one that lingers at its equilibrium magnifies what rounding did
        assert np.isclose(one[calm], other[calm], rtol=1e-6, atol=1e-9, equal_nan=True).mean() > 0.97, close
        np.testing.assert_allclose(one[calm], other[calm], rtol=1e-3, atol=1e-9, err_msg=close)
        told = slid & np.isfinite(other)
        assert not told.any() or np.median(np.abs(one[told] - other[told])) < 1e-10, close


def test_a_slip_on_the_way_down_of_a_body_that_would_have_come_back_once_more(monkeypatch):
    """It passes its equilibrium at 6.8 s, slips at 7.6 s and falls; without the slip it would pass it again at 8.6 s."""
    body = block(np.array([0.79519893]), np.array([0.28961631]), 1)
    body = dataclasses.replace(body, mu=np.array([0.40461482]), mu_kinetic=np.array([0.28323038]))
    motion = read_record("records/synthetic_soil_m70.AT2")
    values = record(motion.acceleration(G), motion.dt, factor=np.array([9.32075445]))
    batch = asked(make_batch(body, values, accuracy="standard"), NAMES)
    found, other = solve(batch).scalars, alone(batch, monkeypatch)
    free = solve(dataclasses.replace(batch, block=dataclasses.replace(body, mu=np.full(1, np.nan)))).scalars
    assert free["t_overturn"][0] > other["t_slip"][0] > other["t_overturn"][0]
    for name in ("t_overturn", "t_end", "t_slip", "slide_peak"):
        np.testing.assert_allclose(found[name], other[name], rtol=1e-7, err_msg=name)


def test_a_foot_that_gives_way_after_the_end_of_the_motion(monkeypatch):
    """Large bodies that topple long after a record was cut off, and slip on their way to the ground alone."""
    rng, n = np.random.default_rng(5), 400
    motion = read_record("records/synthetic_pulse_m70.AT2")
    values = motion.acceleration(G)[200:1095]
    body = block(rng.uniform(3.0, 12.0, n), rng.uniform(0.15, 0.3, n), n)
    body = dataclasses.replace(body, mu=rng.uniform(0.5, 1.2, n))
    factor = rng.uniform(5.0, 9.0, n) / np.abs(values).max()
    batch = asked(make_batch(body, record(values, motion.dt, factor=factor), accuracy="standard"), NAMES)
    found, followed = solve(batch).scalars, alone(batch, monkeypatch)
    fell_later = followed["t_overturn"] > (len(values) - 1) * motion.dt
    assert fell_later.sum() > 10
    assert not followed["slide_peak"][fell_later].any()
    for name in ("outcome", "n_slips", "slide_peak", "t_slip", "t_overturn"):
        np.testing.assert_allclose(found[name], followed[name], rtol=1e-6, atol=1e-9, err_msg=name)


def test_who_does_not_slip_has_the_bits_of_a_body_that_cannot():
    batch = scene("synthetic_soil_m70")
    batch = dataclasses.replace(batch, block=dataclasses.replace(batch.block, mu=1.15 * batch.block.mu))
    free = dataclasses.replace(batch, block=dataclasses.replace(batch.block, mu=np.full(batch.size, np.nan)))
    one, other = solve(batch).scalars, solve(free).scalars
    held = one["slide_peak"] == 0.0
    assert 0.1 < held.mean() < 1.0
    for name in ("outcome", "theta_peak", "t_uplift", "t_peak", "t_overturn", "t_end", "n_impacts"):
        np.testing.assert_array_equal(one[name][held], other[name][held], err_msg=name)


def test_the_work_of_every_part_of_a_path_is_in_the_balance():
    batch = asked(scene("synthetic_soil_m70"), SCALARS)
    level = batch.numerics.tolerances
    raw, whole = turns.solved(batch, level), run(batch, level)
    assert (raw.out[:, to.N_SLIPS] > 2).mean() > 0.1
    weight = batch.g * batch.block.h
    np.testing.assert_allclose(raw.out[:, to.BALANCE] / weight, whole.out[:, to.BALANCE] / weight, atol=1e-11)


@pytest.mark.parametrize("names", [NAMES, frozenset(SCALARS)], ids=["few", "every"])
def test_bodies_of_many_records_slide_as_under_each(names, monkeypatch):
    motions = [read_record(f"records/synthetic_{name}.AT2") for name in ("soil_m70", "rock_m65")]
    records = tuple(record(motion.acceleration(G), motion.dt).horizontal for motion in motions)
    one = asked(scene("synthetic_soil_m70", n=40), names)
    which = np.arange(40) % 2
    factor = 1.6 * one.block.tan_alpha[:, 0] * G / np.array([np.abs(r.values).max() for r in records])[which]
    suite = Excitation(None, None, one.excitation.duration, Suite(records, which, factor))
    together = dataclasses.replace(one, excitation=suite)
    found = solve(together).scalars
    for rows, part in together.apart():
        apart = solve(part).scalars
        assert (apart["slide_peak"] > 0.0).mean() > 0.2
        for name in names & apart.keys() - {"wall_time"}:
            np.testing.assert_array_equal(found[name][rows], apart[name], err_msg=name)
    monkeypatch.setattr(record_lanes, "AT_ONCE", 1)  # one motion after the other
    again = solve(together).scalars
    for name in names & again.keys() - {"wall_time"}:
        np.testing.assert_array_equal(again[name], found[name], err_msg=name)


def test_a_body_without_friction_is_judged_as_it_is_where_others_have_some():
    batch = asked(scene("synthetic_soil_m70", n=40), SCALARS)
    free = np.arange(40) % 2 == 0
    fast = np.where(free, -3.0 * np.sqrt(G / batch.block.R[:, 0]), 0.0)  # lifts off at once
    batch = dataclasses.replace(batch, theta_0=np.where(free, 0.5 * batch.block.alpha[:, 0], 0.0), theta_dot_0=fast)

    def solved_with(mu):
        return solve(dataclasses.replace(batch, block=dataclasses.replace(batch.block, mu=mu))).scalars

    nothing = np.full(40, np.nan)
    mixed, without = solved_with(np.where(free, np.nan, batch.block.mu)), solved_with(nothing)
    assert (without["N_min_over_mg"][free] <= 0.0).all()
    assert np.isfinite(without["error_estimate"][free]).any()
    for name in ("outcome", "theta_peak", "error_estimate", "overturn_share"):
        np.testing.assert_array_equal(mixed[name][free], without[name][free], err_msg=name)


@pytest.mark.parametrize("name", ["pulse_m70", "soil_m70", "rock_m65"])
def test_bodies_that_are_done_are_left_alone(name):
    """Lanes whose bodies are done wait where the record begins, here in the middle of the shaking."""
    whole = scene(f"synthetic_{name}", n=60)
    values = whole.excitation.horizontal.values
    peak = int(np.argmax(np.abs(values)))
    motion = dataclasses.replace(whole.excitation.horizontal, values=np.ascontiguousarray(values[peak : peak + 240]))
    batch = asked(
        dataclasses.replace(whole, excitation=dataclasses.replace(whole.excitation, horizontal=motion)), NAMES
    )
    level = batch.numerics.tolerances
    by_turns, followed = turns.solved(batch, level).out, run(batch, level).out
    assert (followed[:, to.N_SLIPS] > 0).mean() > 0.5
    np.testing.assert_array_equal(by_turns[:, to.VERDICT], followed[:, to.VERDICT])
    # lanes do not look for the top of a hop from rest that ends within its sample, here of 1.2e-8 rad
    for column, least in ((to.PEAK, 1e-8), (to.T_END, 1e-9), (to.SLIDE_PEAK, 1e-9)):
        np.testing.assert_allclose(by_turns[:, column], followed[:, column], rtol=1e-6, atol=least)


def slips_near_the_end():
    """Results by turns and by the kernel of contact alone of a squat body that slips three times as it lands."""
    body = dataclasses.replace(make_block(h=0.45, b=0.72), mu=np.array([1.69]))
    batch = make_batch(body, record([0.0, 16.6, 0.0], 0.068), eta=0.82, accuracy="standard")
    level = batch.numerics.tolerances
    return turns.solved(batch, level).out[0], run(batch, level).out[0]


def test_a_foot_that_slips_as_it_lands_presses_as_one_that_slips():
    """N of a foot that held would be .0098 m g at the first of its slips."""
    by_turns, followed = slips_near_the_end()
    assert followed[to.T_SLIP] == pytest.approx(0.08224932549945, rel=1e-9)
    assert followed[to.N_MIN] == pytest.approx(0.1839598674, rel=1e-8)
    assert by_turns[to.N_MIN] == pytest.approx(followed[to.N_MIN], rel=1e-9)


def test_a_slip_that_begins_in_the_last_sample_is_counted_once():
    """Lanes find it, and leave it to the kernel of contact."""
    by_turns, followed = slips_near_the_end()
    assert by_turns[to.N_SLIPS] == followed[to.N_SLIPS] == 3.0
