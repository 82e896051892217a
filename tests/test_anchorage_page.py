"""The numbers of docs/anchorage.md are those of its study."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

import rockcli
from rockcli.cli.main import app

PAGE = (Path(__file__).resolve().parents[1] / "docs" / "anchorage.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def data():
    (text,) = re.findall(r"^```yaml\n(.*?)^```", PAGE, re.DOTALL | re.M)
    return rockcli.run(yaml.safe_load(text))


def ends(values, unit=""):
    low, high = (f"{end:.2f}" for end in (values.min(), values.max()))
    return f"{low} to {high}{unit}"


def test_the_table_is_that_of_the_study(data):
    peak, pga = data["theta_peak_over_alpha"], data["pga"] / 9.81
    for case in ("as it stands", "base of 0.9 m"):
        assert f"| {case} | {ends(peak.sel(case=case).values)} | none |" in PAGE
    assert ends(pga.sel(case="as it stands").values, " g |") in PAGE
    assert ends(pga.sel(case="isolated").values, " g |") in PAGE
    assert f"| {1e3 * float(data['slide_peak'].sel(case='on a pad').max()):.0f} mm |" in PAGE
    words = np.array(data["outcome"].attrs["flag_meanings"].split())
    flags = data["outcome"].attrs["flag_values"]
    said = {
        str(case): {str(words[flags == flag][0]) for flag in data["outcome"].sel(case=case).values}
        for case in data["case"].values
    }
    assert said["on a pad"] == {"sliding"}
    assert said["isolated"] == {"no_uplift"}


def test_the_forces_of_an_anchor_follow_from_the_peak_acceleration(data):
    a, m, h, b, d = float(data["pga"].sel(case="as it stands").max()), 450.0, 1.1, 0.3, 0.6
    assert f"a = {a / 9.81:.2f} g, so {m * a / 1e3:.1f} kN of shear" in PAGE
    assert f"{m * (a * h - 9.81 * b) / d / 1e3:.1f} kN of tension" in PAGE


def test_the_forces_of_a_table_of_bodies_are_those_of_each(tmp_path, monkeypatch):
    (script,) = re.findall(r"^```python\n(.*?)^```", PAGE, re.DOTALL | re.M)
    monkeypatch.chdir(tmp_path)
    bodies = {"tall": (1.1, 0.5, 450.0), "broad": (0.5, 1.2, 900.0)}
    cells = [f"{name},{','.join(str(x) for x in sizes)}" for name, sizes in bodies.items()]
    Path("cabinets.csv").write_text("\n".join(["name,block.h,block.width,block.mass", *cells, ""]))
    study = {
        "name": "my-cabinets",
        "case": {
            "block": {"h": 1.0, "width": 0.6},
            "motion": {"record": {"file": "synthetic_rock_m65.AT2", "scale": 1}},
        },
        "vary": {
            "case": "cabinets.csv",
            "motion.record.scale": [1, 2],
            "motion.record.file": ["synthetic_rock_m65.AT2", "synthetic_soil_m70.AT2"],
        },
        "save": {"histories": False},
    }
    Path("study.yaml").write_text(yaml.safe_dump(study, sort_keys=False))
    data = rockcli.run("study.yaml")
    assert CliRunner().invoke(app, ["run", "study.yaml"]).exit_code == 0
    exec(compile(script, "anchorage.md", "exec"), {})
    found = np.genfromtxt("anchors.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    for name, scale, shear, tension in found.tolist():
        (h, width, mass), a = bodies[name], float(data["pga"].sel(scale=scale).max())
        assert shear == pytest.approx(mass * a, rel=1e-12)
        assert tension == pytest.approx(max(mass * (a * h - 9.81 * width / 2) / width, 0.0), rel=1e-12)
    assert len(found) == 4
    assert (found["tension_on_a_side_N"] == 0.0).any()
