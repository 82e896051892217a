"""Bodies under records that go by turns through lanes and the kernel of contact, and those that stay with that one."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scenes import G, block, make_batch, record

from rockcli.motion.reading import read_record
from rockcli.solvers.contact import turns
from rockcli.solvers.event.solver import solve

NAMES = frozenset(
    {
        "outcome", "theta_peak", "slide_peak", "slide_residual", "t_slip", "n_slips", "n_flights", "t_uplift", "t_peak",
        "t_overturn", "t_end", "n_impacts",
    }
)  # fmt: skip


def scene(name, n=120, kinetic=1.0, eta="housner", theta_0=0.0):
    rng = np.random.default_rng(11)
    tan_alpha = rng.uniform(0.08, 0.45, n)
    body = block(np.exp(rng.uniform(-1.0, 1.5, n)), tan_alpha, n)
    mu = rng.uniform(1.0, 1.2, n) * tan_alpha
    body = dataclasses.replace(body, mu=mu, mu_kinetic=kinetic * mu)
    motion = read_record(f"records/{name}.AT2")
    values = motion.acceleration(G)
    factor = rng.uniform(1.0, 2.5, n) * tan_alpha * G / np.abs(values).max()
    batch = make_batch(
        body,
        record(values, motion.dt, factor=factor),
        accuracy="standard",
        eta=eta,
        theta_0=theta_0 * np.arctan(tan_alpha),
    )
    return dataclasses.replace(batch, save=dataclasses.replace(batch.save, histories=False, scalars=NAMES))


@pytest.mark.parametrize(
    ("name", "how"),
    [
        ("synthetic_pulse_m70", {}),
        ("synthetic_rock_m65", {"kinetic": 0.7}),
        ("synthetic_soil_m70", {"eta": 0.9}),
        ("synthetic_rock_m65", {"theta_0": 0.4}),
    ],
)
def test_turns_end_where_the_kernel_of_contact_does_alone(name, how, monkeypatch):
    batch = scene(name, **how)
    alone = []
    whole = turns.run

    def counted(some, level):
        alone.append(some.size)
        return whole(some, level)

    monkeypatch.setattr(turns, "run", counted)
    by_turns = solve(batch).scalars
    # a displacement of the top has to be followed all the way
    every = dataclasses.replace(batch, save=dataclasses.replace(batch.save, scalars=NAMES | {"u_top_peak"}))
    followed = solve(every).scalars
    assert sum(alone) < 0.1 * batch.size
    slid = followed["slide_peak"] > 0.0
    assert 0.2 < slid.mean() < 1.0
    for exact in ("outcome", "n_slips", "n_flights"):
        np.testing.assert_array_equal(by_turns[exact], followed[exact], err_msg=exact)
    # of a thousand small impacts both ways forget the start, as they do without friction
    calm = followed["n_impacts"] < 500
    assert calm.mean() > 0.7
    for close in NAMES - {"outcome", "n_slips", "n_flights"}:
        one, other = by_turns[close], followed[close]
        np.testing.assert_allclose(one[calm], other[calm], rtol=1e-6, atol=1e-9, err_msg=close)
        told = slid & np.isfinite(other)
        assert not told.any() or np.median(np.abs(one[told] - other[told])) < 1e-10, close


def test_who_does_not_slip_has_the_bits_of_a_body_that_cannot():
    batch = scene("synthetic_soil_m70")
    batch = dataclasses.replace(batch, block=dataclasses.replace(batch.block, mu=1.15 * batch.block.mu))
    free = dataclasses.replace(batch, block=dataclasses.replace(batch.block, mu=np.full(batch.size, np.nan)))
    one, other = solve(batch).scalars, solve(free).scalars
    held = one["slide_peak"] == 0.0
    assert 0.1 < held.mean() < 1.0
    for name in ("outcome", "theta_peak", "t_uplift", "t_peak", "t_overturn", "t_end", "n_impacts"):
        np.testing.assert_array_equal(one[name][held], other[name][held], err_msg=name)
