"""`rock show`, the package itself, and what help says."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable

import pytest
from typer.testing import CliRunner

import rockcli
from rockcli.cli.main import app

Rock = Callable[..., int]


def shown(*arguments: str) -> str:
    result = CliRunner().invoke(app, list(arguments))
    assert result.exit_code == 0, result.output
    return result.stdout


def test_outcomes_are_listed() -> None:
    assert "outcome: -2 failed, -1 unresolved, 0 no_uplift, 1 rocking" in shown("show", "variables")


def test_symbols_units_and_functions_are_listed() -> None:
    from rockcli.study.document.expressions import FUNCTIONS, SYMBOLS, UNITS

    listed = {line.split("  ")[0] for line in shown("show", "symbols").splitlines()}
    assert listed >= {"g", "pi", *SYMBOLS, *UNITS, *(f"{name}(x)" for name in FUNCTIONS)}


def test_every_model_is_listed() -> None:
    names = {line.split()[0] for line in shown("show", "models").splitlines()}
    assert names >= {"rigid", "linearized", "1", "2", "3", "4", "flexible", "continuum"}


def test_what_is_said_of_the_block_is_what_it_does() -> None:
    case = {
        "block": {"height": 2.0, "width": 1.2, "mu": 0.3},
        "motion": {"pulse": {"shape": "sine", "a_p": 6, "T_p": 1}},
    }
    slid = float(rockcli.run({"name": "s", "case": case})["slide_peak"]) > 0.0
    (row,) = (line for line in shown("show", "models").splitlines() if line.startswith("rigid "))
    assert slid == ("with block.mu it slides" in row)


def test_a_row_of_a_table_is_one_line_where_nobody_looks_on(monkeypatch: pytest.MonkeyPatch) -> None:
    from rockcli.cli.tables import table

    rows = [("a [b]", "word " * 40, "1.5"), ("c", "d", "-")]
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "60")
    plain = table(("name", "sentence", "number"), rows, right=1).splitlines()
    assert plain[0].split() == ["name", "sentence", "number"]
    assert plain[1].split() == [*["a", "[b]"], *["word"] * 40, "1.5"]
    assert plain[1].endswith("  1.5")
    assert plain[2].endswith("    -")
    assert len(plain) == 3
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    assert len(table(("name", "sentence", "number"), rows, right=1).splitlines()) > 4


def test_what_is_told_by_name_stays_beside_the_name(monkeypatch: pytest.MonkeyPatch) -> None:
    from rockcli.cli.tables import facts

    rows = [("title", "word " * 40), ("  time step [s]", "0.01")]
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "60")
    plain = facts(rows).splitlines()
    assert [line.split()[0] for line in plain] == ["title", "time"]
    column = plain[1].index("0.01")
    assert plain[0].index("word") == column
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    seen = facts(rows).splitlines()
    assert len(seen) > 4
    assert all(line.index("word") == column and len(line) <= 60 for line in seen[:-1])


@pytest.mark.parametrize("command", ["run", "check", "export"])
def test_set_may_be_repeated(command: str) -> None:
    assert "may be repeated" in " ".join(shown(command, "--help").split())


def test_errors_are_in_the_package() -> None:
    from rockcli import errors

    assert rockcli.StudyError is errors.StudyError
    assert rockcli.RecordError is errors.RecordError
    with pytest.raises(rockcli.StudyError):
        rockcli.run({"case": {}})
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = rockcli.nothing


def test_a_mapping_needs_no_name() -> None:
    study = {"case": {"block": {"R": 2, "tan_alpha": 0.2}, "initial": {"theta": 0.1}}}
    assert rockcli.run(study).attrs["study_name"] == "study"
    assert "name" not in study
    assert rockcli.run({"name": "own", **study}).attrs["study_name"] == "own"


def test_importing_the_package_imports_nothing_else() -> None:
    code = "import sys, rockcli; sys.exit(bool({m for m in sys.modules if m.startswith('rockcli.') or m == 'numpy'} - {'rockcli.version'}))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_python_m() -> None:
    told = subprocess.run([sys.executable, "-m", "rockcli", "--version"], check=True, capture_output=True, text=True)
    assert told.stdout == f"rock {rockcli.__version__}\n"
