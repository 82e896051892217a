"""Accelerations are in g wherever people read them, and in m/s^2 in datasets and JSON: the same number everywhere."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rockcli.cli.main import app
from rockcli.engine.report_page import write_page
from rockcli.plotting.figures import figure
from rockcli.scene.units import SI, Units
from rockcli.storage.read import open_dataset

G = 9.0
"""Of the case, so that no 9.81 can pass for it."""

SEARCHED = f"""
name: searched
case:
  g: {G}
  block: {{R: 2.0, alpha: 0.2}}
  motion: {{pulse: {{shape: sine, a_p: 0.3*g, T_p: 1}}}}
vary:
  block.R: {{from: 1, to: 8, n: 3, spacing: log}}
  motion.pulse.a_p: {{from: 0.2*g, to: 2*g, n: 19, find: overturning}}
plots: [spectrum]
expect:
  - {{quantity: motion_pulse_a_p_overturning, value: 0.35*{G}, atol: 0.9*{G}}}
"""

SUITE = f"""
name: suite
case:
  g: {G}
  block: {{R: 1.0, tan_alpha: 0.2}}
  motion: {{record: {{file: synthetic_rock_m65.AT2, pga: 1}}}}
over: {{axis: record, limits: [0.1, 0.5]}}
vary:
  motion.record.file: "synthetic_*.AT2"
  motion.record.pga: [0.25*g, 0.35*g, 0.5*g, 0.7*g, 0.9*g]
save: {{histories: false}}
expect:
  - {{quantity: theta_peak_over_alpha_p84, at: {{motion.record.pga: 0.35*g}}, min: 0}}
"""


def run(*args: object) -> str:
    told = CliRunner().invoke(app, [str(arg) for arg in args])
    assert told.exit_code == 0, told.output
    return told.stdout


@pytest.fixture
def solve(tmp_path: Path):
    def solved(text: str) -> tuple[Path, Path, str]:
        file = tmp_path / "study.yaml"
        file.write_text(text, encoding="utf-8")
        told = run("run", file, "--no-plots", "--out", tmp_path / "results")
        (dataset,) = (tmp_path / "results").rglob("*.nc")
        return file, dataset, told

    return solved


def figure_words(kind: str, dataset: Path) -> str:
    words = []
    for axes in figure(kind, open_dataset(dataset)).axes:
        words += [text.get_text() for text in (axes.xaxis.label, axes.yaxis.label, *axes.texts)]
        words += map(str, axes.get_legend_handles_labels()[1])
    return " ".join(words)


def test_a_threshold(solve, tmp_path: Path) -> None:
    file, path, told = solve(SEARCHED)
    values = open_dataset(path)["motion_pulse_a_p_overturning"]
    assert values.attrs["units"] == "m s-2"
    low, high = float(values.min()), float(values.max())
    page = write_page(path).read_text(encoding="utf-8")
    assert f"{low / G:.6g} g" in told
    assert "(rtol 1e-06, atol 0.9 g): " in told
    assert "= 0.35 g" in told
    assert f"{low / G:.6g} g" in page
    assert "motion_pulse_a_p_<wbr>overturning [g]".replace("<wbr>", "") in page.replace("<wbr>", "")
    assert "[g]" in figure_words("spectrum", path)
    drawn = figure("spectrum", open_dataset(path)).axes[0].lines[0].get_ydata()
    assert (min(drawn), max(drawn)) == pytest.approx((low / G, high / G), rel=1e-12)
    for shown in (told, page.split("<h2>Study")[0]):
        assert not re.search(r"m/s2|m/s²|m s-2", shown)
    read = json.loads(run("run", file, "--no-plots", "--json", "--out", tmp_path / "results"))
    assert read["units"] == "SI"
    assert f"{low:.6g} m/s²" in read["studies"][0]["overturns"]["motion_pulse_a_p"]
    assert f" = {0.35 * G:.9g} " in read["studies"][0]["expect"][0]["clause"]


def test_a_suite_and_a_point_on_an_axis(solve, tmp_path: Path) -> None:
    file, path, told = solve(SUITE)
    data = open_dataset(path)
    median = float(data["fragility_median"].sel(limit_state="0.5"))
    page = write_page(path).read_text(encoding="utf-8")
    assert f"median motion_record_pga {median / G:.3g} g" in told
    assert f"median PGA {median / G:.3g} g" in page
    assert "fewer than 8 records" in page
    assert f"median {median / G:.3g} g" in figure_words("fragility", path)
    assert "theta_peak_over_alpha_p84 at motion_record_pga=0.35 g" in told
    assert "theta_peak_over_alpha_p84 at motion_record_pga=0.35 g" in page
    assert "PGA [g]" in page.replace("<wbr>", "")
    for shown in (told, page.split("<h2>Study")[0]):
        assert not re.search(r"m/s2|m/s²|m s-2", shown)
    read = json.loads(run("run", file, "--no-plots", "--json", "--out", tmp_path / "results"))
    assert f"median motion_record_pga {median:.3g} m/s²" in " ".join(read["studies"][0]["suite"])


def test_check_and_compare(solve, tmp_path: Path) -> None:
    file, path, _ = solve(SUITE)
    told = run("check", file)
    assert "PGA [g]" in told
    assert "m/s2" not in told
    (rows,) = json.loads(run("check", "--json", file))
    motion = rows["first_case"]["motion"]
    assert motion["pga"] == pytest.approx(G * motion["pga_g"])
    assert "motion_record_pga=" not in run("compare", path, path)


def test_g_itself_is_no_multiple_of_g() -> None:
    assert Units(9.0).of("m s-2", "motion.record.pga") == (9.0, "g")
    assert Units(9.0).of("m s-2", "g") == (1.0, "m s-2")
    assert Units(9.0).of("m s-1", "motion.record.pgv") == (1.0, "m s-1")
    assert SI.of("m s-2", "motion.record.pga") == (1.0, "m s-2")
    assert Units(9.0).word(1.8, "m s-2") == "0.2 g"


def test_coordinates_of_every_dimension_have_units(solve, tmp_path: Path) -> None:
    """On the page and in the terminal; programs have numbers alone."""
    pulse = "pulse: {shape: sine, a_p: 2.9, T_p: 0.5}"
    vary = "vary: {motion.pulse.T_p: [0.4, 0.8], block.R: [2.0], block.tan_alpha: [0.2], motion.pulse.a_p: [2.7]}"
    expect = "expect: [{quantity: theta_peak_over_alpha, min: 0}]"
    file, path, told = solve(
        f"name: x\ncase: {{g: {G}, block: {{R: 1, alpha: 0.2}}, motion: {{{pulse}}}}}\n{vary}\n{expect}"
    )
    at = "T_p=0.8 s, block_R=2 m, tan_alpha=0.2, motion_pulse_a_p=0.3 g"
    assert f"at {at}" in told
    page = write_page(path).read_text(encoding="utf-8")
    assert "at T p 0.8 s" in page
    (read,) = json.loads(run("run", file, "--no-plots", "--json", "--out", tmp_path / "results"))["studies"]
    assert read["peak_at"] == "T_p=0.8, block_R=2, tan_alpha=0.2, motion_pulse_a_p=2.7"


@pytest.mark.parametrize("g", ["k*2", "18*0.5*m/s**2"])
def test_an_expression_for_g_is_its_number_where_accelerations_are_shown(solve, g: str) -> None:
    """A median in multiples of 9.81 m/s² would be 8 % less, and of a hazard curve at 0.1*g the rate another."""
    hazard = "hazard: {intensity: [0.05*g, 0.3*g, 2*g], rate: [0.1, 0.002, 1.0e-6]}\n"
    _, path, told = solve(SUITE + hazard)
    plain, words = open_dataset(path), figure_words("fragility", path)
    shutil.rmtree(path.parent)
    _, path, again = solve(SUITE.replace(f"g: {G}", f"g: {g}") + hazard + "let: {k: 4.5}\n")
    assert "median motion_record_pga" in told
    lines = [[one for one in text.splitlines() if " g" in one or "annual" in one] for text in (told, again)]
    assert lines[0] == lines[1]
    assert figure_words("fragility", path) == words
    assert open_dataset(path)["annual_rate"].values.tolist() == plain["annual_rate"].values.tolist()
