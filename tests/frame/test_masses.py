"""Masses and stiffnesses of the columns: truths C15 (cantilever) and C18 (inertia of lumped masses)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from frame.frames import PAIRS, column, on_fibres, ricker
from scenes import block, make_batch, pulse
from tables import CANTILEVER

from rockcli.errors import SolverError
from rockcli.scene.body.column import Column
from rockcli.solvers.common.rotary import lacking
from rockcli.solvers.frame.case import case_of
from rockcli.solvers.frame.solver import load
from rockcli.solvers.frame.structure import (
    clamped_frequency,
    consistent_bar,
    full_matrix,
    lumped_bar,
    structure_of,
)


def about_the_base(mass: np.ndarray, heights: np.ndarray, *, rise: float = 0.0) -> float:
    """Inertia of a rigid rotation; the base rises by `rise` per radian."""
    turned = np.zeros(3 * len(heights))
    turned[0::3], turned[1::3], turned[2::3] = heights, rise, 1.0
    return float(turned @ full_matrix(mass) @ turned)


@pytest.mark.parametrize("n", [1, 2, 5, 10, 20])
def test_inertia_of_a_bar(n):
    heights = np.linspace(0.0, 1.0, n + 1)
    assert about_the_base(lumped_bar(n, 1.0), heights) == pytest.approx((1.0 + 0.5 / n**2) / 3.0, rel=1e-12)
    assert about_the_base(consistent_bar(n, 1.0, 1.0 / n), heights) == pytest.approx(1.0 / 3.0, rel=1e-12)


@pytest.mark.parametrize(("n", "inertia"), [(2, 0.375), (5, 0.34), (10, 0.335), (20, 0.33375)])
def test_truths_of_half_end_masses(n, inertia):
    assert about_the_base(lumped_bar(n, 1.0), np.linspace(0.0, 1.0, n + 1)) == pytest.approx(inertia, rel=1e-12)


@pytest.mark.parametrize(("n", "consistent", "lumped"), CANTILEVER)
def test_cantilever(n, consistent, lumped):
    for mass, expected in ((consistent_bar(n, 1.0, 1.0 / n), consistent), (lumped_bar(n, 1.0), lumped)):
        assert clamped_frequency(n, 1.0 / n, 1e6, 1.0, mass) == pytest.approx(expected, rel=1e-9)


def test_first_period_of_the_source():
    batch = column(n=20)
    structure = structure_of(batch, 0, fibres=False)
    h, tan_alpha = 25.0, 0.1
    plain = (
        2.0
        * np.pi
        / clamped_frequency(
            20, structure.length, structure.axial, structure.bending, consistent_bar(20, structure.m, structure.length)
        )
    )
    assert plain == pytest.approx(12.3809 * np.sqrt(2500.0 / 30e9) * h / tan_alpha, rel=2e-5)  # (4.3)
    assert plain == pytest.approx(0.8935, abs=1e-4)
    # the rotary inertia of the nodes lengthens it by 0.8 %
    with_rotary = (
        2.0 * np.pi / clamped_frequency(20, structure.length, structure.axial, structure.bending, structure.mass)
    )
    assert with_rotary / plain == pytest.approx(1.008, abs=0.0015)


@pytest.mark.parametrize(("model", "geometry"), PAIRS)
@pytest.mark.parametrize("tan_alpha", [0.1, 0.5])
def test_every_model_turns_like_the_block(model, geometry, tan_alpha):
    batch = ricker(model, geometry, tan_alpha=tan_alpha)
    structure = structure_of(batch, 0, fibres=False)
    R, alpha = batch.block.R[0, 0], batch.block.alpha[0, 0]
    assert about_the_base(structure.mass, structure.heights) == pytest.approx(4.0 / 3.0 * structure.m * R**2, rel=1e-12)
    # overturning moment m a_g R cos(alpha), restoring moment of the weight
    turned = np.zeros_like(structure.pull)
    turned[0::3], turned[2::3] = structure.heights, 1.0
    assert turned @ structure.pull == pytest.approx(structure.m * R * np.cos(alpha), rel=1e-12)
    arm = R if model in ("1", "4") else R * np.cos(alpha)
    assert structure.heights @ structure.weights[1::3] == pytest.approx(structure.m * arm, rel=1e-12)


def test_lumped_model_4_and_the_flexible_column():
    batch = replace(ricker("4", "corotational"), column=Column(*(np.full(1, np.nan),) * 3, 5, "lumped"))
    structure = structure_of(batch, 0, fibres=False)
    assert about_the_base(structure.mass, structure.heights) == pytest.approx(
        4.0 / 3.0 * structure.m * 4.0 * (1.0 + 0.5 / 25), rel=1e-12
    )
    flexible = structure_of(column(n=7), 0, fibres=False)
    R2 = 25.0**2 + 2.5**2
    assert flexible.m == pytest.approx(2500.0 * 250.0)
    assert about_the_base(flexible.mass, flexible.heights) == pytest.approx(4.0 / 3.0 * flexible.m * R2, rel=1e-12)
    assert flexible.pull[0::3].sum() == pytest.approx(flexible.m)


def test_on_fibres_the_corner_is_the_pivot():
    batch = on_fibres(kw=1e12, fibres=5)
    structure = structure_of(batch, 0, fibres=True)
    b = batch.block.b[0, 0]
    assert structure.heights[-1] == pytest.approx(2.0 * batch.block.h[0])
    assert about_the_base(structure.mass, structure.heights, rise=b) == pytest.approx(
        4.0 / 3.0 * structure.m * 100.0, rel=1e-12
    )


@pytest.mark.parametrize("fibres", [False, True])
def test_an_inertia_below_that_of_its_line_is_refused(fibres):
    """Nodes of negative rotary inertia made energy: a block that hardly moves was told to overturn."""
    body = replace(block(2.0, 0.2), inertia=np.full((1, 2), 1.3))
    batch = replace(make_batch(body, pulse("ricker", 7.0, 9.0), model="4"), geometry="corotational")
    if fibres:
        fibred = on_fibres(kw=1e12, fibres=5)
        batch = replace(fibred, block=replace(fibred.block, inertia=np.full((1, 2), 1.3)))
    with pytest.raises(SolverError, match=r"inertia = 1\.3 is less than the 1\.3[23]"):
        case_of(batch, 0, load())


def test_an_inertia_may_be_rounded_and_be_larger():
    assert lacking(1.3333333, 3.0, 2.0, 4.0) == 0.0
    assert lacking(1.4, 3.0, 2.0, 4.0) == pytest.approx(12.0 * (1.4 - 4.0 / 3.0))
