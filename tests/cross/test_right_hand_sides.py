"""`n_rhs` counts what a backend really evaluates: every count is held against one taken from outside."""

from __future__ import annotations

import importlib
import sys
from dataclasses import replace

import numpy as np
import pytest
from plain import plain as plain
from scenes import G, array, block, make_batch, pulse, rock, still

from rockcli import kernels
from rockcli.scene.body.block import make_block
from rockcli.scene.body.column import Column
from rockcli.scene.numerics import Numerics
from rockcli.scene.variables import SCALARS, SCALARS_LARGE
from rockcli.solvers.general import body as general_body
from rockcli.solvers.general.solver import solve as solve_general

FREE = {"theta_0": 0.1, "eta": 1.0}


class Counter:
    """Stands in for a function and counts its calls."""

    def __init__(self, function) -> None:
        self.function, self.calls = function, 0

    def __call__(self, *args):
        self.calls += 1
        return self.function(*args)


def column(*, zeta=0.0, **how):
    """A concrete column under one sine, up to 5 s: it lands once."""
    motion = pulse("sine", 0.5 * G, 2.0 * np.pi / 1.6, duration=5.0)
    batch = make_batch(make_block(h=25.0, b=2.5), motion, model="flexible", scalars=("outcome",), eta=0.985)
    return replace(batch, column=Column(array(30e9), array(2500.0), array(zeta), 2, "lumped"), **how)


def test_a_step_of_the_event_solver_is_one_expansion(plain, monkeypatch):
    march = kernels.load(compile_them=False)
    flow = Counter(march.flow)
    monkeypatch.setattr(march, "flow", flow)
    response = rock(block(2.0, 0.2), still(3.0), **FREE)  # eta 1: it never rests
    assert flow.calls > 5
    assert response.scalars["n_rhs"][0] == response.scalars["n_steps"][0] == flow.calls


@pytest.mark.parametrize("method", ["RK45", "Radau", "LSODA", "ode23s"])
def test_scipy_counts_every_call_also_those_for_jacobians(monkeypatch, method):
    right = general_body.Body.acceleration
    calls = 0

    def counted(self, *args):
        nonlocal calls
        calls += 1
        return right(self, *args)

    batch = make_batch(block(2.0, 0.2), still(1.0), scalars=("outcome",), **FREE)
    batch = replace(batch, numerics=Numerics("scipy", rtol=1e-5, method=method, events=False))
    monkeypatch.setattr(general_body.Body, "acceleration", counted)
    response = solve_general(batch)
    assert calls > response.scalars["n_steps"][0] > 5
    assert response.scalars["n_rhs"][0] == calls


def test_the_error_estimate_of_scipy_is_in_both_counts():
    batch = make_batch(block(2.0, 0.2), still(1.0), scalars=("outcome",), **FREE)
    once = solve_general(batch).scalars
    twice = solve_general(replace(batch, save=replace(batch.save, scalars=frozenset({"error_estimate"})))).scalars
    for name in ("n_steps", "n_rhs"):
        assert twice[name][0] > 2 * once[name][0]


def test_frame_counts_residuals_also_of_steps_that_are_divided(plain, monkeypatch):
    from rockcli.solvers.frame import solver

    kernel = solver.load()
    calls, right = 0, kernel.steps.forces

    def counted(*args):
        nonlocal calls
        calls += sys._getframe(1).f_code.co_name != "settle"  # statics, before the motion
        return right(*args)

    monkeypatch.setattr(kernel.steps, "forces", counted)
    batch = column(numerics=Numerics("frame", dt=1e-2, yield_rotation=1e-10))
    response = solver.solve(batch)
    assert int(response.used["divided_steps"]) > 0
    assert response.scalars["n_rhs"][0] == calls > response.scalars["n_steps"][0]


def test_the_flexible_column_counts_evaluations_of_its_loads(plain, monkeypatch):
    from rockcli.solvers.flexible import solve

    kernels.load(compile_them=False)
    state = importlib.import_module("rockcli.kernels.column.automaton").step.__globals__
    calls = 0
    right = state["loads"]

    def counted(*args):
        nonlocal calls
        calls += sys._getframe(1).f_code.co_name == "step"  # the balance of energy looks at them too
        return right(*args)

    monkeypatch.setitem(state, "loads", counted)
    batch = column(zeta=0.01)
    response = solve(batch)
    assert response.scalars["n_rhs"][0] == calls > response.scalars["n_steps"][0] > 5


def test_large_sweeps_save_it_only_when_asked():
    assert "n_rhs" in SCALARS
    assert "n_rhs" not in SCALARS_LARGE
    assert np.isin(["n_steps", "n_rhs"], SCALARS).all()
