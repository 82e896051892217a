"""Modes of the column against closed forms and high-precision values."""

from __future__ import annotations

import numpy as np
import pytest
from tables import CANTILEVER

from rockcli.solvers.flexible.beam import unit_beam
from rockcli.solvers.flexible.column import critical_modulus
from rockcli.solvers.flexible.modes import UnstableError, free_modes, held_modes, make_modes

OMEGA_1 = 3.51601526850015118
"""First clamped frequency of the Euler-Bernoulli cantilever, EI = m = L = 1."""


def omega(n: int, mass: str = "consistent", rotary: float = 0.0) -> float:
    return float(np.sqrt(held_modes(unit_beam(n, mass), 1.0, 0.0, rotary)[0][0]))


@pytest.mark.parametrize(("n", "consistent", "lumped"), CANTILEVER)
def test_first_frequency_of_n_elements(n, consistent, lumped):
    assert omega(n) == pytest.approx(consistent, rel=1e-9)
    assert omega(n, "lumped", rotary=1e-10) == pytest.approx(lumped, rel=1e-5)  # massless rotations: a little inertia


@pytest.mark.parametrize(("tan_alpha", "ratio"), [(0.2, 1.03064479183567526), (0.333, 1.08333767592181838)])
def test_rotary_inertia_of_the_source_lengthens_the_period(tan_alpha, ratio):
    assert omega(80) / omega(80, rotary=4.0 / 3.0 * (0.5 * tan_alpha) ** 2) == pytest.approx(ratio, rel=3e-6)


def test_period_of_the_source():
    """(4.3): T_1 = 12.3809 sqrt(rho/E) h/tan(alpha), 0.8935 s; +0.8 % with the rotary inertia."""
    bending = 30e9 * 5.0**3 / 12.0 / (2500.0 * 5.0 * 50.0 * 50.0**3)
    T_1 = 2.0 * np.pi / (omega(20) * np.sqrt(bending))
    assert pytest.approx(12.3809 * np.sqrt(2500.0 / 30e9) * 25.0 / 0.1, rel=1e-4) == T_1
    assert pytest.approx(0.8935, abs=1e-4) == T_1
    assert omega(20) / omega(20, rotary=4.0 / 3.0 * 0.05**2) == pytest.approx(1.008, abs=5e-4)


def test_rocking_column_is_pinned_and_free():
    """The first bending mode while rocking is 4.385 times faster than the clamped one."""
    lam, _ = free_modes(unit_beam(40, "consistent"), 1.0, 0.0, 0.0, 0.0)
    assert lam[0] == pytest.approx(0.0, abs=1e-12)
    assert np.sqrt(lam[1]) / OMEGA_1 == pytest.approx(4.385, abs=1e-3)


@pytest.mark.parametrize("bending", [1e2, 1e6, 1e12])
@pytest.mark.parametrize("mass", ["consistent", "lumped"])
def test_rocking_mode_of_a_nearly_rigid_column(bending, mass):
    """As E grows it becomes the inverted pendulum -(g/L)/2 / (I/(m L^2)), however large E is."""
    beam = unit_beam(5, mass)
    inertia = beam.rigid @ (beam.mass + 0.003 * beam.rotary) @ beam.rigid
    lam, phi = free_modes(beam, bending, 0.2, 0.003, 0.0)
    assert lam[0] == pytest.approx(-0.1 / inertia, rel=0.2 / bending + 1e-12)
    M = beam.mass + 0.003 * beam.rotary
    np.testing.assert_allclose(phi.T @ M @ phi, np.eye(beam.size), atol=1e-9)


def test_weight_and_uniform_load_belong_together():
    """The weight of a rigidly rotated column is the uniform load: no error of the P-Delta in the rigid limit."""
    for mass in ("consistent", "lumped"):
        beam = unit_beam(7, mass)
        np.testing.assert_allclose(beam.weight @ beam.rigid, beam.uniform, atol=1e-14)
        assert beam.uniform @ beam.rigid == pytest.approx(0.5, rel=1e-14)


def test_self_buckling():
    """Greenhill: a clamped column buckles under its weight at w L^3/(E I) = 7.837."""
    beam = unit_beam(20, "consistent")
    how = {"weight": 1.0, "rotary": 0.003, "zeta": 0.0, "length": 1.0, "spring": None}
    make_modes(beam, bending=1.0 / 7.8373 * 1.0001, **how)
    with pytest.raises(UnstableError):
        make_modes(beam, bending=1.0 / 7.8373 * 0.9999, **how)
    assert critical_modulus(2500.0, 9.81, 25.0, 2.5) == pytest.approx(1.8775e8, rel=1e-4)


def test_base_moment_of_a_statically_loaded_column():
    """The guard quantity of the held column: a_g m h, by equilibrium, without P-Delta."""
    beam = unit_beam(5, "consistent")
    modes = make_modes(beam, bending=50.0, weight=1e-12, rotary=0.003, zeta=0.02, length=2.0, spring=None)
    a = 3.0
    z = -modes.bu[0] * a / 2.0 / modes.lam[0]
    moment = modes.row[0] @ z + modes.r_a * a
    assert moment == pytest.approx(0.5 * a / 2.0, rel=1e-10)
