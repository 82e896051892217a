"""Random convex outlines under pulses and records against an independent march (`tests/rolling_reference.py`)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rolling_cases import compare, random_case

from rockcli.solvers.event.solver import solve


@pytest.mark.parametrize("seed", [2, 6, 16, 139])
def test_a_few_outlines(seed):
    compare(seed)


@pytest.mark.parametrize("seed", [2, 5, 8])
def test_what_is_asked_changes_no_answer(seed):
    """Records without forces and histories go from sample to sample in a way of their own."""
    batch = random_case(seed)
    few = replace(
        batch, save=replace(batch.save, histories=False, scalars=frozenset({"outcome", "theta_peak", "t_overturn"}))
    )
    whole, lean = solve(batch).scalars, solve(few).scalars
    assert whole["outcome"] == lean["outcome"]
    for name in ("theta_peak", "t_overturn"):
        np.testing.assert_allclose(lean[name], whole[name], rtol=1e-9)


@pytest.mark.slow
def test_a_hundred_and_fifty_outlines():
    found = [compare(seed) for seed in range(1000, 1150)]
    assert found.count("chaos") < 5
    assert found.count("rocks on") < 15
    assert found.count("elsewhere") >= 3
    assert min(found.count(word) for word in ("falls", "stands")) >= 25
