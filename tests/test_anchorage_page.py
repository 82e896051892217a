"""The numbers of docs/anchorage.md are those of its study."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import yaml

import rockcli

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
