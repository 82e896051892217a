"""`rock check`: what it says of the body, the model and the motion."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import rockcli
from rockcli.engine.preview import preview
from rockcli.plotting.common.case_law import model_of
from rockcli.study.open import open_study

Rock = Callable[..., int]


@pytest.fixture
def checked(rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., Any]:
    def check(case: str, *options: str) -> Any:
        file = tmp_path / "s.yaml"
        file.write_text(f"name: x\ncase: {{{case}}}\n")
        capsys.readouterr()
        assert rock("check", file, *options) == 0
        told = capsys.readouterr().out
        return json.loads(told)[0] if "--json" in options else told

    return check


SINE = "pulse: {shape: sine, a_p: 6, T_p: 1}"
BLOCK = "block: {R: 2.0, tan_alpha: 0.2}"


def test_both_edges_of_an_asymmetric_body(checked: Callable[..., Any]) -> None:
    body = checked(f"block: {{h: 1, b: [0.2, 0.4], mu: 0.5, mass: 100}}, motion: {{{SINE}}}", "--json")["first_case"]
    assert (body["body"]["tan_alpha_left"], body["body"]["tan_alpha_right"]) == (0.2, 0.4)
    assert (body["body"]["mu"], body["body"]["mass"]) == (0.5, 100)
    assert body["model"]["eta_left"] > body["model"]["eta_right"]
    assert body["motion"]["uplift_g"] == 0.2


def test_model_and_damping(checked: Callable[..., Any]) -> None:
    found = checked(f"{BLOCK}, model: 3, damping: {{scheme: dashpot, coefficient: 0.03}}, motion: {{{SINE}}}", "--json")
    model = found["first_case"]["model"]
    assert (model["model"], model["geometry"]) == ("3", "negative_stiffness")
    assert (model["damping"], model["coefficient"]) == ("dashpot", 0.03)
    assert "eta" not in model
    assert found["backend"] == "event"


def test_the_linearized_block_uplifts_at_alpha(checked: Callable[..., Any]) -> None:
    case = f"{BLOCK}, model: linearized, initial: {{theta: 0.01}}, motion: {{{SINE}}}"
    first = checked(case, "--json")["first_case"]
    assert first["motion"]["uplift_g"] == pytest.approx(0.197396, rel=1e-5)
    assert first["model"]["theta_0"] == 0.01
    assert "PGA over g alpha" in checked(case)


def test_uplift_of_a_flexible_column_is_told_as_that_of_a_rigid_body(checked: Callable[..., Any]) -> None:
    column = "block: {height: 30, width: 5}, model: flexible, column: {E: 3e9, rho: 1900, zeta: 0.02}"
    assert "uplift of a rigid body at [g]" in checked(f"{column}, motion: {{{SINE}}}")
    assert "uplift of a rigid body at [g]" in checked(f"{column.replace('flexible', 'auto')}, motion: {{{SINE}}}")
    assert "of a rigid body" not in checked(f"{BLOCK}, model: auto, motion: {{{SINE}}}")
    assert "of a rigid body" not in checked(f"{BLOCK}, motion: {{{SINE}}}")


def test_raw_measures_factor_and_processing_of_a_record(checked: Callable[..., Any], tmp_path: Path) -> None:
    (tmp_path / "q.txt").write_text("# units: m/s2\n0 0\n0.01 2\n0.02 0\n0.03 -1\n")
    case = f"{BLOCK}, motion: {{record: {{file: q.txt, pga: 4}}}}"
    found = checked(case, "--json")
    motion = found["first_case"]["motion"]
    assert (motion["factor"], motion["pga"]) == (2.0, 4.0)
    assert motion["pga_raw_g"] == pytest.approx(2 / 9.81)
    assert found["processing"]["q.txt"][-1].startswith("scaled by 2 to pga")
    told = checked(case)
    assert re.search(r"\n  record +q.txt\n +scaled by 2", told)


def test_columns_are_aligned(checked: Callable[..., Any]) -> None:
    told = checked(f"{BLOCK}, motion: {{{SINE}, vertical: {{pulse: {{shape: sine, a_p: 1, T_p: 0.3}}}}}}")
    rows = [line for line in told.splitlines() if line.startswith("    ")]
    starts = {len(row) - len(row[4:].split("  ", 1)[1].lstrip()) for row in rows}
    assert len(starts) == 1
    assert "vertical PGA over" not in told


@pytest.mark.parametrize(
    ("more", "low", "high"),
    [
        ("", 0.1, 2.0),
        ("solver: {backend: frame}, model: 3", 0.5, 30.0),
        ("solver: {backend: scipy}", 0.3, 2.0),
        ("model: continuum, column: {E: 30*GPa, rho: 2500}, damping: none", 600.0, 2400.0),
    ],
)
def test_the_cost_knows_the_backend(
    checked: Callable[..., Any], monkeypatch: pytest.MonkeyPatch, more: str, low: float, high: float
) -> None:
    monkeypatch.setattr("rockcli.engine.preview.slowness", lambda: 1.0)  # as on the machine of reference
    assert low < checked(f"{BLOCK}, motion: {{{SINE}}}{', ' * bool(more)}{more}", "--json")["seconds"] < high


def test_a_floor_s_peak_and_the_ground_s_are_told_apart(checked: Callable[..., Any]) -> None:
    record = "record: {file: synthetic_rock_m65.AT2, pga: 0.3*g}"
    case = f"{BLOCK}, motion: {{{record}, through: [{{f: 3, zeta: 0.05}}]}}"
    motion = checked(case, "--json")["first_case"]["motion"]
    assert motion["pga_ground_g"] == pytest.approx(0.3)
    assert motion["pga_g"] > 0.35
    told = checked(case)
    assert re.search(r"PGA of the ground \[g\] +0\.3\n", told)
    assert re.search(rf"PGA of what arrives at the body \[g\] +{motion['pga_g']:.6g}\n", told)
    assert "of the ground" not in checked(f"{BLOCK}, motion: {{{record}}}")


def test_what_was_done_to_records_is_told_of_the_first_of_many(
    rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for i in range(7):
        (tmp_path / f"q{i}.txt").write_text(f"# units: m/s2\n0 0\n0.01 {i + 1}\n0.02 0\n")
    study = f"name: x\ncase: {{{BLOCK}, motion: {{record: {{file: q0.txt, pga: 4}}}}}}\n"
    (tmp_path / "s.yaml").write_text(study + 'vary: {motion.record.file: "q*.txt"}\n')
    assert rock("check", tmp_path / "s.yaml") == 0
    told = capsys.readouterr().out
    assert re.findall(r"\n  record +(q\d)", told) == ["q0", "q1", "q2", "q3"]
    assert "and 3 more: --json has all" in told
    assert rock("check", tmp_path / "s.yaml", "--json") == 0
    assert len(json.loads(capsys.readouterr().out)[0]["processing"]) == 7


@pytest.mark.parametrize(
    ("column", "takes"),
    [
        ("", "rigid, the highest model of this body: it has no column"),
        ("column: {E: 3e9, rho: 2500}, ", "flexible"),
        ("column: {E: 1e14, rho: 2500}, ", "rigid if "),
        ("column: {E: 3e8, rho: 2500}, ", "flexible, the highest model of this body: p T_1 is not in 0.001 to 1"),
    ],
)
def test_what_model_auto_will_take_is_what_it_takes(
    rock: Rock, tmp_path: Path, checked: Callable[..., Any], column: str, takes: str
) -> None:
    case = f"block: {{height: 10, width: 1}}, {column}motion: {{{SINE}}}, model: {{name: auto, tolerance: 0.05}}"
    said = checked(case, "--json")["first_case"]["model"]["takes"]
    assert said.startswith(takes)
    assert rock("run", tmp_path / "s.yaml", "-q", "--no-plots", "--out", tmp_path) == 0
    with rockcli.open_dataset(tmp_path / "x" / "x.nc") as found:
        flags = found.model_used.attrs
        names = dict(zip(flags["flag_values"].tolist(), flags["flag_meanings"].split(), strict=True))
        used = names[int(found.model_used)]
        assert said.startswith(used)
        law = model_of(found)  # whose separatrix the figure `phase` draws
        assert (law is None) if used == "flexible" else (law.name == used)


@pytest.mark.parametrize("looked_at", [20_000, 40])
@pytest.mark.parametrize(
    ("let", "path", "pga", "R", "cases"),
    [
        ({}, "motion.record.pga", 1.0, 1.0, [50, 50]),
        ({"k": 1}, "let.k", "k*0.3*g", 1.0, [50, 50]),
        ({"k": 1, "q": "2*k"}, "let.k", "k*0.3*g", "q", [2]),
        ({"k": 1, "q": "2*k"}, "let.k", "q*0.3*g", 1.0, [50, 50]),
        ({"n": 1}, "let.n", "n*0.3*g", 1.0, [50, 50]),
        ({"n": 1, "q": "w*n", "w": 1}, "let.n", "0.3*g", "q", [2]),
    ],
)
def test_bodies_are_counted_by_cases_whatever_varies_their_motion(
    looked_at: int, let: Any, path: str, pga: Any, R: Any, cases: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a study too large to be looked at whole too, a symbol that only the motion speaks of makes no bodies."""
    monkeypatch.setattr("rockcli.engine.preview.LOOKED_AT", looked_at)
    record = {"file": "synthetic_rock_m65.AT2", "pga": pga}
    case = {"block": {"R": R, "tan_alpha": 0.2}, "motion": {"record": record}}
    vary = {path: {"from": 0.5, "to": 3, "n": 50}, "block.tan_alpha" if R == 1.0 else "block.top": [0.1, 0.2]}
    found = preview(open_study({"name": "x", "let": let, "case": case, "vary": vary})).bodies
    assert [row["cases"] for row in found][: len(cases)] == cases
    assert len(found) == (2 if R == 1.0 else min(50, looked_at // 2))
    assert all(("k=" in row["body"] or "n=" in row["body"]) is (R == "q") for row in found)
