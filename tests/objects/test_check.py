"""`rock check` of a body from outlines: the quantities of the equations, edge by edge."""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from rockcli.cli.main import app

STUDY = """name: plate
case:
  block:
    parts:
      - {outline: [[-0.2, 0], [0.3, 0], [0.3, 0.1], [-0.2, 0.1]], density: 8000, depth: 0.5}
      - {outline: [[-0.1, 0.1], [0.1, 0.1], [0.1, 1.3], [-0.1, 1.3]], density: 2500, depth: 0.2}
    mu: MU
  motion: {pulse: {shape: sine, a_p: 2, T_p: 1}}
"""


def checked(tmp_path, mu, *options):
    file = tmp_path / "s.yaml"
    file.write_text(STUDY.replace("MU", str(mu)))
    told = CliRunner().invoke(app, ["check", str(file), *options])
    assert told.exit_code == 0, told.output
    return told.stdout


def test_the_quantities_of_the_equations(tmp_path):
    body = json.loads(checked(tmp_path, 0.7, "--json"))[0]["first_case"]["body"]
    m = np.array([8000 * 0.5 * 0.5 * 0.1, 2500 * 0.2 * 0.2 * 1.2])
    x, z = np.array([0.05, 0.0]), np.array([0.05, 0.7])
    own = np.array([0.5**2 + 0.1**2, 0.2**2 + 1.2**2]) / 12
    x_c, h = (m * x).sum() / m.sum(), (m * z).sum() / m.sum()
    I_cm = (m * (own + (x - x_c) ** 2 + (z - h) ** 2)).sum()
    expected = {
        "mass": m.sum(),
        "h": h,
        "top": 1.3,
        "width": 0.5,
        "outline_width": 0.5,
        "outline_height": 1.3,
        "r_g": np.sqrt(I_cm / m.sum()),
    }
    for side, b in (("left", x_c + 0.2), ("right", 0.3 - x_c)):
        R = np.hypot(b, h)
        I_O = I_cm + m.sum() * R**2
        expected |= {
            f"b_{side}": b,
            f"R_{side}": R,
            f"alpha_{side}": np.arctan(b / h),
            f"alpha_deg_{side}": np.arctan(b / h) * 180 / np.pi,
            f"I_O_{side}": I_O,
        }
        expected |= {f"p_{side}": np.sqrt(m.sum() * 9.81 * R / I_O), f"g_tan_alpha_{side}": 9.81 * b / h}
        expected |= {f"inertia_{side}": I_O / (m.sum() * R**2)}
    for name, value in expected.items():
        assert body[name] == pytest.approx(value, rel=1e-12), name


@pytest.mark.parametrize(("mu", "words"), [(0.2, "slide (mu <= tan"), (0.85, "by direction"), (0.95, "rock (mu > tan")])
def test_how_it_begins_to_move(tmp_path, mu, words):
    assert words in checked(tmp_path, mu)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("", "uplift at [g]"),
        (", vertical: {pulse: {shape: sine, a_p: 2, T_p: 0.3}}", "uplift without vertical motion at [g]"),
        ("}, model: flexible, column: {E: 30e9, rho: 2500", "uplift of a rigid body at [g]"),
    ],
)
def test_the_table_of_bodies_says_what_its_uplift_is(tmp_path, more, words):
    """As for the first case; programs have it under one name."""
    file = tmp_path / "s.yaml"
    motion = "motion: {pulse: {shape: sine, a_p: 2, T_p: 1}"
    file.write_text(f"name: s\ncase: {{block: {{h: 1, b: 0.2}}, {motion}{more}}}}}\nvary: {{block.h: [1, 2]}}\n")
    told = CliRunner().invoke(app, ["check", str(file)])
    assert told.exit_code == 0, told.output
    heads = told.stdout[told.stdout.index("  body  ") :].splitlines()[0]
    assert words in heads
    assert f"  {words} " in told.stdout
    (found,) = json.loads(CliRunner().invoke(app, ["check", str(file), "--json"]).stdout)
    assert [row["uplift at [g]"] for row in found["bodies"]] == pytest.approx([0.2, 0.1])
