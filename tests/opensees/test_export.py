"""`rock export`: the script is the backend, and stands alone."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scenes import array
from thesis_cases import flexible, needs_opensees, rigid
from typer.testing import CliRunner

from rockcli.cli.main import app
from rockcli.errors import SolverError, StudyError
from rockcli.scene.body.column import Base
from rockcli.scene.laws.damping import Damping
from rockcli.scene.numerics import Numerics
from rockcli.solvers.opensees.script import script_of

STUDY = """\
name: carry-on
case:
  block: {R: 2.0, tan_alpha: 0.2}
  motion: {pulse: {shape: sine, a_p: 3.6*g*tan_alpha, omega_p: 4.44*pi}, duration: 1.5}
  model: 3
  geometry: corotational
  solver: {backend: opensees}
vary:
  model: [rigid, 3]
save: {scalars: [outcome, theta_peak_over_alpha, n_impacts, n_steps, n_rhs]}
"""


@pytest.fixture
def study(tmp_path):
    file = tmp_path / "study.yaml"
    file.write_text(STUDY)
    return file


def invoke(*words):
    return CliRunner().invoke(app, [str(word) for word in words])


@needs_opensees
def test_running_the_exported_script_gives_the_backends_answer(study, tmp_path):
    import rockcli

    result = invoke("export", study, "--to", "opensees", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    script = tmp_path / "out" / "carry-on" / "opensees" / "case_2.py"
    assert str(script) in result.stdout.splitlines()
    assert "case 1 (model = rigid)" in result.output
    subprocess.run([sys.executable, "-I", str(script)], check=True, capture_output=True, cwd="/")
    found = json.loads(script.with_name("case_2_summary.json").read_text())
    answer = rockcli.run(study).sel(model="3")
    alpha = np.arctan(0.2)
    assert abs(found["theta_peak"]) / alpha == float(answer.theta_peak_over_alpha)
    assert found["steps"] == int(answer.n_steps)
    assert found["iterations"] == int(answer.n_rhs) > found["steps"]
    assert len(found["impacts"]) == int(answer.n_impacts) > 0
    table = np.loadtxt(script.with_name("case_2_results.txt"))
    theta = np.interp(answer.time.values, table[:, 0], table[:, 1])
    np.testing.assert_allclose(answer.theta.values, theta, atol=1e-5)


def test_one_case_by_its_number(study, tmp_path):
    result = invoke("export", study, "--out", tmp_path, "--case", 2, "--set", "case.block.R=5")
    assert result.exit_code == 0
    folder = tmp_path / "carry-on" / "opensees"
    assert sorted(file.name for file in folder.iterdir()) == ["case_2.py", "case_2_a_g.txt"]
    text = (folder / "case_2.py").read_text()
    assert "R = 5.0" in text
    assert "Study carry-on, case 2 (model = 3)." in text
    assert "rockcli" not in text.split('"""')[2]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--case", 3), "cases 1 to 2"),
        (("--case", 1), "no case of it can be written"),
        (("--to", "abaqus"), "expected opensees"),
    ],
)
def test_what_cannot_be_exported_is_said(study, tmp_path, words, sentence):
    result = invoke("export", study, "--out", tmp_path / "out", *words)
    assert isinstance(result.exception, StudyError)
    assert sentence in str(result.exception)
    assert not (tmp_path / "out").exists()


def test_cases_that_are_refused_alike_are_told_once(study, tmp_path):
    settings = ("--set", "vary={block.R: [0.3, 0.1, 0.2]}", "--set", "case.model=rigid")
    result = invoke("export", study, "--out", tmp_path / "out", *settings)
    (line,) = [line for line in result.output.splitlines() if "does not solve" in line]
    assert line.startswith("rock: carry-on: 3 cases, the first case 1 (block_R = 0.3): backend 'opensees'")


def test_every_script_is_python_whose_names_are_known():
    """Each combination of pieces compiles, and pyflakes' rules of the linter find nothing undefined."""
    hht = Damping("hht", np.ones((1, 2)), alpha_d=array(0.7))
    winkler, fibres = Base("winkler", array(1e11)), Base("winkler", array(1e11), 11)
    soft = flexible(eta="housner", zeta=0.01)
    how = [{"model": m, "geometry": g} for m in "1234" for g in ("corotational", "negative_stiffness")]
    batches = [rigid(**one) for one in how] + [rigid(scheme="dashpot", theta_0=0.1), soft, replace(soft, base=winkler)]
    batches += [rigid(geometry="negative_stiffness", theta_0=0.1, numerics=Numerics(method="linear"))]
    batches += [replace(soft, base=fibres, damping=hht, theta_0=array(0.01))]
    shaken = replace(soft.excitation, vertical=soft.excitation.horizontal)
    batches += [replace(soft, base=fibres, excitation=shaken)]
    for batch in batches:
        script = script_of(batch, 0, title='A "quoted" title\nof two lines \\ and a slash')
        text = script.files["case.py"]
        compile(text, "case.py", "exec")
        checked = subprocess.run(
            [sys.executable, "-m", "ruff", "check", "--isolated", "--select", "F", "--stdin-filename", "case.py", "-"],
            input=text, capture_output=True, text=True,
        )  # fmt: skip
        assert checked.returncode == 0, checked.stdout


@pytest.mark.parametrize(
    ("block", "initial", "said"),
    [
        ("", "", ""),
        (", mu: 0.1", "", "warning: block.mu is ignored by backend opensees"),
        (
            ", mu: 0.3",
            "  initial: {slide_rate: 0.2}\n",
            "block.mu and initial.slide_rate are ignored by backend opensees",
        ),
    ],
)
def test_friction_is_not_in_the_scripts_and_this_is_said(study, tmp_path, block, initial, said):
    body = "tan_alpha: 0.2"
    study.write_text(STUDY.replace(f"{body}}}\n", f"{body}{block}}}\n{initial}"))
    result = invoke("export", study, "--set", "vary=null", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    assert said in result.stderr if said else result.stderr == ""


def test_the_amplitude_of_a_search_is_said(study, tmp_path):
    study.write_text(
        STUDY[: STUDY.index("vary")] + "vary: {motion.pulse.a_p: {from: 3, to: 9, n: 5, find: overturning}}\n"
    )
    result = invoke("export", study, "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    assert "warning: the scripts have motion.pulse.a_p = 3, where its search begins" in result.stderr
    result = invoke("export", study, "--set", "vary.motion.pulse.a_p=[5]", "--out", tmp_path / "out")
    assert result.stderr == ""
    assert "a_p = 5 m/s2" in (tmp_path / "out" / "carry-on" / "opensees" / "case_1.py").read_text()


def test_an_inertia_below_that_of_its_line_is_refused():
    batch = rigid(model="4")
    below = replace(batch, block=replace(batch.block, inertia=np.full((1, 2), 1.3)))
    with pytest.raises(SolverError, match=r"inertia = 1\.3 is less than the 1\.33333"):
        script_of(below, 0)
    in_one_point = script_of(replace(below, model="3"), 0).case
    assert in_one_point.number("I_O") == pytest.approx(1.3 * in_one_point.number("m") * 4.0)
