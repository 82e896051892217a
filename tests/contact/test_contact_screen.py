"""Bodies of a map that are told to hold by how far they rock: never one that needs more friction than it has."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scenes import G, block, make_batch, pulse, record

from rockcli.motion.reading import read_record
from rockcli.scene.variables import SCALARS, SCALARS_LARGE, SCALARS_SLIDING
from rockcli.solvers.contact.screen import surely_holds
from rockcli.solvers.event.solver import solve


def scene(kind, n=150, tan_alpha=0.25):
    rng = np.random.default_rng(4)
    body = dataclasses.replace(block(1.0, tan_alpha, n), mu=rng.uniform(0.2, 0.9, n))
    if kind == "record":
        motion = read_record("records/synthetic_rock_m65.AT2")
        values = motion.acceleration(G)[400:1200]
        factor = rng.uniform(0.9, 2.5, n) * tan_alpha * G / np.abs(values).max()
        return make_batch(body, record(values, motion.dt, factor=factor), accuracy="standard")
    a_p, omega = rng.uniform(0.9, 3.0, n) * tan_alpha * G, rng.uniform(6.0, 30.0, n)
    return make_batch(body, pulse(kind, a_p, omega), accuracy="standard")


@pytest.mark.parametrize("kind", ["ricker", "sine", "record"])
def test_none_that_slides_is_let_through(kind):
    batch = scene(kind)
    free = dataclasses.replace(batch, block=dataclasses.replace(batch.block, mu=np.full(batch.size, np.nan)))
    rocked = solve(free).scalars
    held = surely_holds(batch, np.abs(rocked["theta_peak"]), rocked["outcome"] < 2)
    needs = np.fmax(rocked["mu_required"], rocked["mu_impact"])
    assert (needs[held] <= batch.block.mu[held]).all()
    assert (rocked["N_min_over_mg"][held] > 0.0).all()
    assert 0.15 < held.mean() < 0.95


def test_a_map_with_friction_has_the_bits_of_one_without_where_it_holds():
    batch = scene("ricker", 60)
    asked = frozenset({*SCALARS_LARGE, "theta_peak"})
    batch = dataclasses.replace(batch, save=dataclasses.replace(batch.save, scalars=asked))
    free = dataclasses.replace(batch, block=dataclasses.replace(batch.block, mu=np.full(batch.size, np.nan)))
    one, other = solve(batch).scalars, solve(free).scalars
    held = surely_holds(batch, np.abs(other["theta_peak"]), other["outcome"] < 2)
    assert held.any()
    for name in SCALARS_LARGE:
        np.testing.assert_array_equal(one[name][held], other[name][held])
    assert (one["slide_peak"][held] == 0.0).all()
    assert (one["slide_peak"] > 0.0).any()


@pytest.mark.parametrize(
    ("kind", "names"),
    [("ricker", SCALARS_LARGE), ("record", SCALARS_LARGE), ("record", tuple(SCALARS))],
    ids=["pulses", "record", "record, all scalars"],
)
def test_bodies_that_only_rock_have_the_bits_of_a_map_without_friction(kind, names):
    """Also those of which the bound does not tell: their forces, or all modes of contact, say whether they slide."""
    batch = scene(kind, 60)
    free = dataclasses.replace(batch, block=dataclasses.replace(batch.block, mu=np.full(batch.size, np.nan)))
    one_by_one = dataclasses.replace(free, save=dataclasses.replace(free.save, histories=True))
    rocked = solve(one_by_one).scalars
    needs = np.fmax(rocked["mu_required"], rocked["mu_impact"])
    rocks = (needs < batch.block.mu) & (rocked["N_min_over_mg"] > 0.0) & (rocked["outcome"] < 2)
    held = surely_holds(batch, np.abs(rocked["theta_peak"]), rocked["outcome"] < 2)
    assert (rocks & ~held).sum() > 3
    save = dataclasses.replace(batch.save, histories=False, scalars=frozenset(names))
    one, other = (solve(dataclasses.replace(x, save=save)) for x in (batch, free))
    assert ("lanes" in one.used["method"]) == ("lanes" in other.used["method"])
    assert one.scalars.keys() == other.scalars.keys()
    for name in (one.scalars.keys() & set(names)) - {"wall_time", *SCALARS_SLIDING}:
        np.testing.assert_array_equal(one.scalars[name][rocks], other.scalars[name][rocks], err_msg=name)
    decided = one.scalars["outcome"] < 2
    np.testing.assert_array_equal(one.scalars["slide_peak"][decided] > 0.0, ~rocks[decided])


@pytest.mark.parametrize("scalars", [("outcome", "t_overturn"), ("outcome", "overturn_share"), ("n_impacts", "t_end")])
@pytest.mark.parametrize("kind", ["ricker", "ricker_antisymmetric"])
def test_one_that_a_bell_does_not_lift_presses_on_the_ground(kind, scalars):
    """Also where nobody looks at its forces, and the model has no other contact."""
    body = dataclasses.replace(block(1.0, 0.25, 3), mu=np.full(3, 2.0))
    motion = pulse(kind, np.array([0.3, 0.6, 0.9]) * 0.25 * G, np.full(3, 8.0))
    batch = make_batch(body, motion, model="3", accuracy="standard", scalars=scalars)
    found = solve(dataclasses.replace(batch, geometry="negative_stiffness"))
    np.testing.assert_array_equal(found.scalars["outcome"], 0)
    assert found.reasons == [""] * 3


SLIPS_BEYOND = [(3.0, 9.25, 2.0), (3.0, 10.75, 2.25), (3.0, 11.0, 2.25), (1.5, 4.0, 1.0), (1.5, 6.0, 1.5)]
"""mu and a_p over (g) tan(alpha) and omega_p/p: a foot slips beyond the equilibrium, from where held it would come back."""


@pytest.mark.parametrize("scalars", [("outcome",), SCALARS_LARGE, ("outcome", "t_overturn")])
def test_one_that_slips_beyond_its_equilibrium_and_falls_does_not_come_back(scalars):
    """As an independent time-stepping scheme (moreau.py) has it, too."""
    mu, A, W = np.array(SLIPS_BEYOND).T
    n = len(mu)
    body = dataclasses.replace(block(2.0, 0.1, n), mu=0.1 * mu)
    motion = pulse("ricker", 0.1 * G * A, W * body.p(np.full(n, G))[:, 0])
    few, all_ = (
        solve(make_batch(body, motion, accuracy="standard", scalars=names)).scalars for names in (scalars, SCALARS)
    )
    np.testing.assert_array_equal(few["outcome"], 2)
    np.testing.assert_array_equal(all_["outcome"], 2)
    if "t_overturn" in scalars:
        np.testing.assert_allclose(few["t_overturn"], all_["t_overturn"], rtol=1e-9)


@pytest.mark.parametrize("scalars", [SCALARS_LARGE, ("outcome", "t_peak", "t_overturn")])
def test_one_that_jams_does_not_only_rock(scalars):
    """No slip of it lasts, but its impacts take more friction than there is."""
    body = dataclasses.replace(block(1.0, 0.25, 4), mu=np.full(4, 3.0))
    motion = pulse("sine", np.array([1.5, 2.0, 2.5, 3.0]) * 0.25 * G, np.full(4, 12.0))
    few, all_ = (
        solve(make_batch(body, motion, eta=0.0, accuracy="standard", scalars=names)).scalars
        for names in (scalars, SCALARS)
    )
    assert (all_["n_jams"] > 0).all()
    assert (all_["n_slips"] == 0).all()
    for name in set(scalars) - {"wall_time", "reason"}:
        np.testing.assert_array_equal(few[name], all_[name], err_msg=name)
