"""Reports of a given duration in the lanes of records: against the single-body solver, DOP853, and themselves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cross.test_lanes_records import LAWS, SCALARS, _lanes_only, assert_same, own, reference, same_bits_apart, suite
from cross.test_lanes_records_forces import assert_forces, everything, uneven
from reference import body_of, integrate

from rockcli.scene.batch import Batch, Save
from rockcli.scene.response import OVERTURNED_WITHOUT_IMPACT
from rockcli.solvers.event import solver as event
from rockcli.solvers.event.solver import solve

assert _lanes_only  # a fixture of every test here too


def lasting(batch: Batch, shares) -> Batch:
    """The same cases whose reports end after such shares of the motion, one after the other."""
    horizontal = batch.excitation.horizontal
    duration = np.resize(np.asarray(shares), batch.size) * horizontal.end
    return replace(batch, excitation=replace(batch.excitation, duration=duration))


ANYWHERE = (0.0003, 0.17, 0.2204, 0.25, 0.3121, 0.5, 0.77, 1.0, 1.13)
"""Ends inside a sample, the first one too, at one, at the end of the motion and after it."""


def assert_ends(batch: Batch) -> dict:
    """As `assert_same`, each body to the end of its report; what the lanes found."""
    found = assert_same(batch, most=1e-6, other_impacts=0.02)  # where it is hit some 300 times
    np.testing.assert_array_equal(found["t_end"], batch.excitation.duration)
    return found


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_every_law(law):
    values, dt = own()
    batch = suite(values, dt, np.linspace(0.9, 5.0, 10), [0.6, 3.0], [0.1, 0.25], model=law[0], geometry=law[1])
    assert {0, 1} <= set(assert_ends(lasting(batch, ANYWHERE))["outcome"].tolist())


@pytest.mark.parametrize("ratio", [1.0, 0.7])
def test_every_scalar(ratio):
    values, dt = own("synthetic_rock_m65.AT2")
    n = 10 * 2
    start = {"theta_0": np.linspace(-0.03, 0.05, n), "theta_dot_0": np.linspace(0.1, -0.2, n)}
    for state in ({}, start):
        batch = suite(values, dt, np.linspace(0.8, 5.0, 10), [0.6, 3.0], [0.15], **state)
        found, exact, changes = everything(lasting(uneven(batch, ratio), ANYWHERE))
        assert_forces(found, exact, changes)
        np.testing.assert_array_equal(found["t_end"], exact["t_end"])


def test_the_outcome_alone_and_without_the_fall():
    values, dt = own()
    batch = lasting(suite(values, dt, np.linspace(1.5, 6.0, 19), [0.5, 3.0], [0.1, 0.25]), ANYWHERE)
    exact = reference(batch)
    for asked in (("outcome",), ("outcome", "theta_peak", "t_uplift", "n_impacts"), SCALARS):
        found = solve(replace(batch, save=Save(False, 0.01, frozenset(asked)))).scalars
        np.testing.assert_array_equal(found["outcome"], exact["outcome"])


def test_what_comes_after_the_report_is_free_rocking():
    """A motion that goes on has no say: as under its first samples alone, to where the report ends."""
    values, dt = own()
    batch = suite(values, dt, np.linspace(1.0, 6.0, 30), [0.6, 2.0], [0.2])
    for samples in (700, 800, 1100):
        shorter = replace(batch.excitation.horizontal, values=values[:samples])
        cut = replace(batch, excitation=replace(batch.excitation, horizontal=shorter))
        whole = replace(batch, excitation=replace(batch.excitation, duration=np.full(batch.size, (samples - 1) * dt)))
        one, two = solve(cut).scalars, solve(whole).scalars
        np.testing.assert_array_equal(one["outcome"], two["outcome"])
        fell = one["outcome"] >= OVERTURNED_WITHOUT_IMPACT
        assert (one["theta_peak_over_alpha"][~fell] >= two["theta_peak_over_alpha"][~fell] * (1.0 - 1e-12)).all()
        np.testing.assert_array_equal(one["t_uplift"], two["t_uplift"])


def test_neighbours_order_and_chunks_do_not_matter():
    values, dt = own()
    batch = suite(values, dt, np.linspace(0.9, 5.0, 40), np.geomspace(0.4, 6.0, 5), [0.1, 0.2, 0.3])
    some = np.where(np.arange(batch.size) % 3 == 0, np.nan, 1.0)
    batch = lasting(batch, some * np.resize(ANYWHERE, batch.size))
    same_bits_apart(batch, (*SCALARS, "n_steps", "mu_impact"))


def test_hardly_any_is_left_to_the_single_body(monkeypatch):
    alone = []
    monkeypatch.setattr(event, "_march_rows", lambda kernel, batch, rows, *rest, **more: alone.append(len(rows)))
    values, dt = own()
    solve(lasting(suite(values, dt, np.linspace(0.9, 6.0, 20), np.geomspace(0.4, 6.0, 5), [0.2]), ANYWHERE))
    assert sum(alone) == 0


@pytest.mark.slow
def test_against_an_independent_integrator():
    """The outcome of the cut motion, and the peak up to the cut."""
    values, dt = own()
    samples = 731
    batch = suite(values, dt, [1.5, 2.0, 2.6], [0.7, 1.5], [0.2])
    batch = replace(batch, excitation=replace(batch.excitation, duration=np.full(batch.size, (samples - 1) * dt)))
    found = solve(batch).scalars
    for i in range(batch.size):
        shaken = values[:samples] * batch.excitation.horizontal.factor[i]
        theirs = integrate(body_of(batch.block, batch.damping.eta[i], case=i), shaken, dt)
        assert theirs.overturned == (found["outcome"][i] >= OVERTURNED_WITHOUT_IMPACT)
        if not theirs.overturned:
            assert theirs.peak_over_alpha >= found["theta_peak_over_alpha"][i] - 1e-9
