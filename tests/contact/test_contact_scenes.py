"""Whole motions with contact against an independent integration, and what must hold in each (scenes.csv)."""

from __future__ import annotations

import math
import os
import subprocess
import sys

import pytest
from contact_cases import body, motion, run, scenes
from scenes import SHARED

SCENES = {row["scene"]: row for row in scenes()}
NUMBERS = {
    "theta_peak": lambda r: r["PEAK"] * r["PEAK_SIDE"],
    "t_peak": lambda r: r["T_PEAK"],
    "slide_peak": lambda r: r["SLIDE_PEAK"],
    "slide_end": lambda r: r["SLIDE_END"],
    "slide_at_overturn": lambda r: r["SLIDE_END"],
    "t_slip": lambda r: r["T_SLIP"],
    "t_slide_rock": lambda r: r["T_SLIDE_ROCK"],
    "t_flight": lambda r: r["T_FLIGHT"],
    "t_overturn": lambda r: r["T_END"],  # there: when it lies on its side
}


def solved(row):
    given = {name: float(row[name]) for name in ("mu_k", "eta", "e_n") if row[name]}
    if row["theta_0"]:
        given["theta_0"] = float(row["theta_0"])
    par = body(*(float(row[name]) for name in ("b", "h", "mu")), t_motion=float(row["t_motion"]), **given)
    return run(par, motion(row["horizontal"]), motion(row["vertical"]))


@pytest.mark.parametrize("name", SCENES)
def test_scene(name):
    """Angles, slides and times to the larger of 1e-8 and ten times what the scene supports; modes in their order.

    Scene 299 flies and lands flat; rounding of the integration it was found with tilts it by 1e-17 rad, which is not asked.
    """
    row = SCENES[name]
    if ".AT2" in row["horizontal"] and not (SHARED / "records" / row["horizontal"].split()[0]).exists():
        pytest.skip("needs the real records")
    found, near = solved(row), max(1e-8, 10 * float(row["tolerance"]))
    for quantity, of in NUMBERS.items():
        if row[quantity]:
            assert of(found) == pytest.approx(float(row[quantity]), abs=near), quantity
    if row["t_rest"]:
        assert max(found["T_REST"], float(row["t_motion"])) == pytest.approx(float(row["t_rest"]), abs=near)
    fell, lifted = found["VERDICT"] == 1.0, found["PEAK"] > 0.0
    assert row["outcome"] == ("overturned" if fell else "rocks_back" if lifted else "no_uplift")
    events = [event.split() for event in row["events"].split("; ")]
    assert found.modes[: len(events)] == [mode for _, mode in events]
    assert found.t[: len(events)] == pytest.approx([float(t) for t, _ in events], abs=near)
    assert abs(found["BALANCE"]) < 1e-9  # J/kg
    assert found["GAIN"] < 1e-12
    assert found["N_JAMS"] == 0


def test_same_bits_compiled_and_plain():
    """Six scenes with all five modes between them."""
    script = """
import sys
from contact_cases import scenes
from rockcli import kernels
kernels.load("contact.march", compile_them=True)
sys.path.insert(0, "tests/contact")
from test_contact_scenes import SCENES, solved
for name in ("019", "049", "134", "300", "331", "377"):
    print([float(x).hex() for x in solved(SCENES[name]).out])
"""
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    said = []
    for how in ("compiled", "interpreted"):
        env = os.environ | {"ROCK_KERNELS": how, "PYTHONPATH": os.path.join(root, "tests")}
        done = subprocess.run([sys.executable, "-c", script], cwd=root, env=env, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        said.append(done.stdout)
    assert said[0] == said[1]
    assert len(said[0].splitlines()) == 6


def test_mirrored_scenes_are_mirrored_to_the_bit():
    for name in ("019", "300"):
        row = dict(SCENES[name])
        one = solved(row)
        kind, a_p, *rest = row["horizontal"].split()
        row["horizontal"] = " ".join([kind, str(-float(a_p)), *rest])
        if row["theta_0"]:
            row["theta_0"] = str(-float(row["theta_0"]))
        other = solved(row)
        assert other.modes == one.modes
        assert other.t == one.t
        assert other["SLIDE_PEAK"] == -one["SLIDE_PEAK"] != 0.0
        assert (other["PEAK"], other["PEAK_SIDE"]) == (one["PEAK"], -one["PEAK_SIDE"])


def test_histories_are_those_of_the_flow():
    """Slide, rate of slide and angle at output times agree with each other and with the peaks, lift only in flight."""
    row = SCENES["019"]
    par = body(float(row["b"]), float(row["h"]), float(row["mu"]), t_motion=float(row["t_motion"]))
    dt, n = 1e-4, 12001
    found = run(par, motion(row["horizontal"]), motion(row["vertical"]), dt=dt, n=n)
    h = found.histories
    theta, slide, modes, lift = (list(h[k]) for k in ("theta", "slide", "contact_mode", "lift"))
    assert max(abs(x) for x in theta) == pytest.approx(found["PEAK"], abs=1e-6)
    assert min(slide) == pytest.approx(found["SLIDE_PEAK"], abs=1e-6)
    assert {int(m) for m in modes} == {0, 2, 3, 4}
    for i in range(1, n - 1):
        if all(abs(i * dt - t) > 1.01 * dt for t in found.t):  # an event is a jump of the rate
            assert (slide[i + 1] - slide[i - 1]) / (2 * dt) == pytest.approx(h["slide_dot"][i], abs=2e-4)
        assert (lift[i] > 0.0) <= (modes[i] == 4)
    assert not math.isnan(theta[-1])
