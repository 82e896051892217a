"""What is refused before anything is solved: histories that would not fit, clauses about what will not be there."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import rockcli
from rockcli.engine.plots_ahead import check_plots
from rockcli.engine.preview import preview
from rockcli.engine.run import check_answers, check_study, solve
from rockcli.engine.sweep import history_size as limits
from rockcli.engine.sweep.sweep import Sweep, solve_cases
from rockcli.engine.sweep.work import Team
from rockcli.errors import StudyError
from rockcli.plotting.figures import KINDS, why_not
from rockcli.study.open import open_study


def study(**more: Any) -> dict[str, Any]:
    pulse = {"shape": "ricker", "a_p": "3.6*g*tan_alpha", "omega_p": "3*pi"} | more.pop("pulse", {})
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse}} | more.pop("case", {})
    return {"name": "x", "case": case} | more


@pytest.fixture
def unsolvable(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object, **__: object) -> None:
        raise AssertionError("it was solved")

    monkeypatch.setattr("rockcli.engine.run.solve_cases", never)


@pytest.mark.usefixtures("unsolvable")
@pytest.mark.parametrize(
    ("more", "times"),
    [
        ({"save": {"dt_out": 1e-9}}, "1.309e"),
        ({"pulse": {"t0": 1e9}}, "3e"),
        ({"pulse": {"shape": "sine", "cycles": 1e9}}, "2e"),
        ({"pulse": {"omega_p": 1e-9}}, "5.027e"),
        ({"pulse": {"omega_p": 1e9}}, "3.319e"),
        ({"vary": {"motion.pulse.omega_p": {"from": 0.1, "to": 3000, "n": 50, "spacing": "log"}}}, "50 cases x 2.5e"),
    ],
)
def test_histories_that_do_not_fit(more: dict[str, Any], times: str, tmp_path: Path) -> None:
    for attempt in (rockcli.run, lambda given: check_study(open_study(given), tmp_path)):
        with pytest.raises(StudyError, match="histories would take") as told:
            attempt(study(**more))
        assert times in str(told.value)
        assert "output times" in str(told.value)
        assert "save.histories: false" in str(told.value)
        assert told.value.exit_code == 2
    with pytest.raises(AssertionError, match="it was solved"):
        rockcli.run(study(**more | {"save": {"histories": False}}))


def test_the_spacing_that_is_proposed_fits() -> None:
    given = study(vary={"motion.pulse.omega_p": {"from": 0.1, "to": 3000, "n": 50, "spacing": "log"}})
    with pytest.raises(StudyError, match=r"save.dt_out to 0.00035 s"):
        limits.check_histories(open_study(given))
    limits.check_histories(open_study(given | {"save": {"dt_out": 0.00035}}))
    with pytest.raises(StudyError):
        limits.check_histories(open_study(given | {"save": {"dt_out": 0.00034}}))


def test_the_size_is_that_of_the_dataset() -> None:
    opened = open_study(study(vary={"block.R": [2.0, 9.0]}, case={"damping": "none"}, pulse={"a_p": "1.2*g*tan_alpha"}))
    size, found = limits.histories_size(opened), solve(opened)
    names = [name for name, item in found.fields.items() if item.dims[-1:] == ("time",) and name != "time"]
    kept = sum(found.values(name).nbytes for name in names)
    assert size.variables == len(names)
    assert kept <= size.bytes <= 1.01 * kept + 1000
    assert limits.histories_size(open_study(study(save={"histories": False}))).bytes == 0.0


def test_long_histories_are_solved_a_few_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    opened = open_study(study(vary={"block.R": [2.0, 3.0, 9.0]}))
    whole = solve_cases(opened)
    monkeypatch.setattr(limits, "CHUNK_AT_MOST", 1)
    seen: list[int] = []
    one_by_one = solve_cases(opened, Sweep(Team(), progress=lambda done, total: seen.append(done)))
    assert seen == [1, 2, 3]
    for name, values in whole.histories.items():
        np.testing.assert_array_equal(one_by_one.histories[name], values)


FREE = {"case": {"motion": None, "initial": {"theta": 0.01}}}


@pytest.mark.usefixtures("unsolvable")
@pytest.mark.parametrize(
    ("quantity", "more"),
    [
        ("error_history", {"save": {"histories": False}}),
        ("error_theta_peak_over_alpha", {"save": {"scalars": ["outcome"]}}),
        ("u_top_bending at 1 s", {}),
        ("a_p", FREE),
        ("pga", FREE),
    ],
)
def test_clauses_about_what_will_not_be_there(quantity: str, more: dict[str, Any]) -> None:
    compared = {"vary": {"model": ["rigid", "linearized"]}, "compare_to": {"model": "rigid"}}
    quantity, _, time = quantity.partition(" at ")
    clause = {"quantity": quantity, "max": 1.0} | ({"time": 1.0} if time else {})
    given = study(expect=[clause], **compared, **more)
    with pytest.raises(StudyError, match=f"{quantity}' will not be in the dataset"):
        rockcli.run(given)


def test_clauses_about_what_will_be_there() -> None:
    compared = {"vary": {"model": ["rigid", "linearized"]}, "compare_to": {"model": "rigid"}}
    names = ("error_history", "error_theta_peak_over_alpha", "same_outcome", "a_p", "omega_p", "pga", "pgv")
    found = rockcli.run(study(expect=[{"quantity": name, "max": 99.0} for name in names], **compared))
    assert set(names) <= set(found.variables)


@pytest.mark.parametrize("source", [[], 3, None, 1.5, b"x", ()])
def test_what_is_no_study(source: Any) -> None:
    with pytest.raises(StudyError, match="a study is a mapping or the path of a file"):
        rockcli.run(source)


@pytest.mark.parametrize("block", [{"tan_alpha": 1e-30}, {"alpha": 1e-99, "tan_alpha": None}, {"R": 1e25}])
def test_extreme_numbers_warn_of_nothing(block: dict[str, Any]) -> None:
    """numpy's warnings are errors here."""
    body = {"R": 2.0, "tan_alpha": 0.2} | block
    body = {key: value for key, value in body.items() if value is not None}
    rockcli.run(study(case={"block": body}, pulse={}, save={"dt_out": 1e10 if "R" in block else 0.01}))


@pytest.mark.usefixtures("unsolvable")
def test_a_backend_that_cannot_solve_the_model(tmp_path: Path) -> None:
    case = {"solver": {"backend": "calculix"}}
    refused = open_study(study(case=case))
    with pytest.raises(StudyError, match="backend 'calculix' does not solve model 'rigid'"):
        check_study(refused, tmp_path)
    axis = {"solver.backend": ["event", "calculix"]}
    check_study(open_study(study(vary=axis)), tmp_path)  # one that can is among them


@pytest.mark.usefixtures("unsolvable")
def test_backends_that_are_not_chosen_by_themselves_are_named() -> None:
    case = {"model": 4, "damping": "hht", "column": {"E": 3e10, "rho": 2500}, "base": {"law": "winkler", "kw": 1e10}}
    said = r"auto takes none .* damping 'hht': write solver: \{backend: frame\}, or opensees \(rock show backends"
    with pytest.raises(StudyError, match=said):
        rockcli.run(study(case=case | {"geometry": "corotational"}))


@pytest.mark.usefixtures("unsolvable")
@pytest.mark.parametrize(
    ("case", "said"),
    [
        ({"solver": {"backend": "scipy", "method": "RK54"}}, "has no method 'RK54'; it has RK23, RK45"),
        ({"solver": {"backend": "scipy", "events": False}}, "restitution needs located impacts"),
        ({"model": 3, "solver": {"backend": "frame", "method": "lineer"}}, "know the methods corotational and linear"),
        ({"model": 3, "geometry": "corotational", "solver": {"backend": "frame", "method": "linear"}}, "no P-Delta"),
        ({"model": 3, "solver": {"backend": "opensees", "method": "RK45"}}, "know the methods"),
    ],
)
def test_settings_that_the_backend_does_not_have_are_refused(case: dict[str, Any], said: str) -> None:
    with pytest.raises(StudyError, match=said):
        rockcli.run(study(case=case))


@pytest.mark.usefixtures("unsolvable")
@pytest.mark.parametrize(
    ("case", "line"),
    [
        ("  model: 3\n  solver:\n    backend: frame\n    method: lineer\n", 6),
        ("  model: 3\n  solver:\n    accuracy: draft\n    backend: calculix\n", 6),
        ("  solver:\n    backend: scipy\n    events: false\n", 5),
        ("  model: 4\n  damping: hht\n", 4),
    ],
)
def test_the_line_of_what_the_backend_does_not_solve(tmp_path: Path, case: str, line: int) -> None:
    file = tmp_path / "a.yaml"
    column = "  column: {E: 3e10, rho: 2500}\n" if "hht" in case else ""
    file.write_text(f"name: a\ncase:\n{case}{column}  block: {{R: 2, tan_alpha: 0.2}}\n  initial: {{theta: 0.1}}\n")
    with pytest.raises(StudyError) as refused:
        check_study(open_study(file), tmp_path)
    assert (refused.value.file, refused.value.line) == (str(file), line)


@pytest.mark.usefixtures("unsolvable")
@pytest.mark.parametrize("rigid", [0, 1])
def test_every_base_of_an_axis_is_judged(tmp_path: Path, rigid: int) -> None:
    file = tmp_path / "a.yaml"
    bases = ["    - {law: winkler, kw: 1e9, fibres: 20}\n"]
    bases.insert(rigid, "    - {law: rigid}\n")
    file.write_text(
        "name: a\ncase:\n  block: {R: 2, tan_alpha: 0.2, mass: 1000}\n  model: 4\n  geometry: corotational\n"
        "  damping: hht\n  initial: {theta: 0.1}\n  solver: {backend: frame}\n"
        f"vary:\n  initial.theta_dot: [0, 0.1]\n  base:\n{''.join(bases)}"
    )
    with pytest.raises(StudyError, match=rf"vary\.base\[{rigid}\]: damping hht needs a yielding base") as refused:
        check_study(open_study(file), tmp_path)
    assert (refused.value.line, refused.value.exit_code) == (12 + rigid, 2)


@pytest.mark.usefixtures("unsolvable")
def test_the_option_that_asks_for_what_the_backend_does_not_solve(tmp_path: Path) -> None:
    told = [("case.solver.backend", "calculix")]
    with pytest.raises(StudyError, match=r"^--set case\.solver\.backend=calculix: case: backend 'cal"):
        check_study(open_study(study(), overrides=told), tmp_path)


@pytest.mark.parametrize(
    ("said", "fault"),
    [
        ({}, "hht needs a yielding base"),
        ({"base": {"law": "winkler", "kw": 1e8}}, "a Winkler base carries the weight: it needs geometry: corotational"),
    ],
)
@pytest.mark.parametrize("backend", ["frame", "opensees"])
def test_a_base_that_does_not_fit_the_damping(tmp_path: Path, backend: str, said: dict[str, Any], fault: str) -> None:
    case = {
        "block": {"R": 2.0, "tan_alpha": 0.2},
        "model": 4,
        "damping": {"scheme": "hht"},
        "solver": {"backend": backend},
        "column": {"E": 3e10, "rho": 2500.0},
        "motion": {"pulse": {"shape": "sine", "a_p": 3.0, "T_p": 1.0}},
    }
    with pytest.raises(StudyError, match=fault):
        check_study(open_study({"name": "a", "case": case | said}), tmp_path)


def test_the_estimated_time_is_that_of_how_the_cases_are_solved() -> None:
    axes = {
        "motion.pulse.a_p": {"from": "g*tan_alpha", "to": "4*g*tan_alpha", "n": 1000},
        "motion.pulse.omega_p": {"from": 1.0, "to": 9.0, "n": 1000},
    }
    outcome = {"vary": axes, "save": {"scalars": ["outcome"]}}
    in_lanes = preview(open_study(study(**outcome))).seconds
    twice = preview(open_study(study(**outcome | {"save": {"scalars": ["outcome", "error_estimate"]}}))).seconds
    alone = study(**outcome)
    alone["case"]["motion"]["vertical"] = {"pulse": {"shape": "sine", "a_p": "0.3*g", "T_p": 0.4}}
    one_by_one = preview(open_study(alone)).seconds
    refined = preview(open_study(study(**outcome, refine=True))).seconds
    assert in_lanes < 0.5 * twice
    assert in_lanes < 0.15 * one_by_one  # docs/features.md: by an order
    assert refined < 0.5 * in_lanes


SUITE = {"motion": {"record": {"file": "synthetic_pulse_m70.AT2", "window": [0, 2]}}}
RECORDS = {"motion.record.file": ["synthetic_pulse_m70.AT2", "synthetic_rock_m65.AT2"]}
SIZES = {"block.R": [1.0, 2.0, 3.0]}
TELLING: dict[str, dict[str, Any]] = {
    "one case": {},
    "no motion": {"case": {"motion": None, "initial": {"theta": 0.1}}},
    "nothing saved": {"vary": SIZES, "save": {"histories": False, "scalars": ["outcome"]}},
    "sizes": {"vary": SIZES},
    "slendernesses": {"vary": {"block": {"a": {"R": 1.0}, "b": {"R": 2.0}}, "block.tan_alpha": [0.1, 0.2, 0.3]}},
    "search": {"vary": SIZES | {"motion.pulse.a_p": {"from": 2, "to": 20, "n": 4, "find": "overturning"}}},
    "suite": {"case": SUITE, "vary": RECORDS | SIZES, "over": "record"},
    "intensities": {"case": SUITE, "vary": RECORDS | {"motion.record.pga": ["0.3*g", "0.5*g"]}, "over": "record"},
    "inputs": {"uncertain": {"block.tan_alpha": {"uniform": [0.15, 0.25]}}, "samples": 8},
    "curves": {"curves": ["pushover"]},
}


@pytest.mark.parametrize("more", TELLING.values(), ids=TELLING.keys())
def test_plots_are_refused_before_solving_as_they_would_be_after_it(more: dict[str, Any]) -> None:
    given = study(**{key: dict(value) if isinstance(value, dict) else value for key, value in more.items()})
    dataset = rockcli.run(given)
    for kind in KINDS:
        try:
            check_plots(open_study(given | {"plots": [kind]}))
            told = ""
        except StudyError as error:
            told = error.message.removeprefix(f"plots: {kind}: ")
        assert told == why_not(kind, dataset), kind


@pytest.mark.usefixtures("unsolvable")
@pytest.mark.parametrize(
    ("plots", "words"),
    [
        ("[phase, fragility]", "plots: fragility: the study takes no statistics over an axis"),
        ("[{kind: phase, select: {block.R: 5}}]", "plots: phase: block_R=5: there are 1, 2"),
        ("[{kind: curve, select: {block.R: [1, 2], mu: 1}}]", "plots: curve: select mu: the axes are block_R"),
    ],
)
def test_a_plot_that_cannot_be_is_told_with_its_line(plots: str, words: str, tmp_path: Path) -> None:
    file = tmp_path / "x.yaml"
    given = study(vary={"block.R": [1.0, 2.0]})
    file.write_text(yaml.safe_dump(given) + f"plots: {plots}\n")
    for check in (check_study, lambda given, _: check_answers(given)):
        with pytest.raises(StudyError, match=re.escape(words)) as told:
            check(open_study(file), tmp_path)
        assert (told.value.file, told.value.line) == (str(file), len(file.read_text().splitlines()))
        assert told.value.exit_code == 2
