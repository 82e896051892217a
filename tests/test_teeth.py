"""The truth tests must fail on a wrong kernel: a wrong eta, a wrong sign, a missing reset."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from scenes import G, block, pulse, rock
from tables import SOURCE_PULSES

from rockcli import kernels
from rockcli.kernels.rigid import parameters as at


@pytest.fixture
def plain(monkeypatch):
    """The kernels as plain Python, so that they can be spoilt; loaded afresh afterwards."""
    monkeypatch.setenv("ROCK_KERNELS", "interpreted")
    kernels.compiled = None  # not by monkeypatch, which would put back what no longer is so
    march = kernels.load(compile_them=False)
    yield march
    for name in [name for name in sys.modules if name.startswith("rockcli.kernels.") and name[16:] != "layout"]:
        sys.modules.pop(name)
    kernels.compiled = None


def agrees_with_the_truth() -> bool:
    """What the literature tests ask, on two rows."""
    for row in (SOURCE_PULSES[0], SOURCE_PULSES[3]):
        motion = pulse(row["shape"], 3.6 * G * row["tan_alpha"], row["omega_p_over_pi"] * np.pi)
        response = rock(block(row["R"], row["tan_alpha"]), motion, eta=row["eta"], histories=True)
        n = len(row["t_impact"])
        times = response.impacts["t_impact"][0, :n]
        if len(times) < n or not np.allclose(times, row["t_impact"], atol=1e-8, rtol=0.0):
            return False
        if not np.allclose(response.impacts["theta_dot_before"][0, :n], row["w_before"], atol=1e-8, rtol=0.0):
            return False
        if not abs(response.scalars["theta_peak_over_alpha"][0] - row["peak"]) < 1e-8:
            return False
    return True


def test_the_right_kernel_agrees(plain):
    assert agrees_with_the_truth()


def spoil_parameters(monkeypatch, change):
    from rockcli.solvers.event import solver as event

    right = event.parameters_of

    def wrong(batch):
        parameters = right(batch)
        change(parameters)
        return parameters

    monkeypatch.setattr(event, "parameters_of", wrong)


def test_wrong_eta_is_noticed(plain, monkeypatch):
    def change(parameters):
        for edge in (at.LEFT, at.RIGHT):
            parameters[:, edge + at.ETA] *= 1.01

    spoil_parameters(monkeypatch, change)
    assert not agrees_with_the_truth()


def test_wrong_sign_of_the_ground_motion_is_noticed(plain, monkeypatch):
    right = plain.expand

    def wrong(*args):
        deg = right(*args)
        out = args[-1]
        for i in range(deg + 1):
            out[i] = -out[i]
        return deg

    monkeypatch.setattr(plain, "expand", wrong)
    assert not agrees_with_the_truth()


def test_missing_reset_is_noticed(plain, monkeypatch):
    def change(parameters):
        for edge in (at.LEFT, at.RIGHT):
            parameters[:, edge + at.ETA] = 1.0

    spoil_parameters(monkeypatch, change)
    assert not agrees_with_the_truth()


@pytest.mark.parametrize("coefficient", ["P2", "RS", "RC", "FC", "FS"])
def test_wrong_coefficient_of_the_law_is_noticed(plain, monkeypatch, coefficient):
    def change(parameters):
        for edge in (at.LEFT, at.RIGHT):
            parameters[:, edge + getattr(at, coefficient)] *= 1.0 + 1e-5

    spoil_parameters(monkeypatch, change)
    assert not agrees_with_the_truth()


def test_lost_event_is_noticed(plain, monkeypatch):
    right = plain.first_root
    monkeypatch.setattr(plain, "first_root", lambda *args: min(right(*args) * 1.001, args[2]))
    assert not agrees_with_the_truth()
