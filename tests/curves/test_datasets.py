"""`curves` in a study: the dataset, its file, its figure; compared histories."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

import rockcli
from rockcli.analysis.compare_to_reference import with_comparison
from rockcli.engine.run import run_study, solve
from rockcli.errors import StudyError
from rockcli.plotting import figures
from rockcli.plotting.kinds.static_curves import words_of
from rockcli.storage import netcdf
from rockcli.storage.contents import Contents
from rockcli.storage.read import open_dataset
from rockcli.study.open import open_study

ALL = ["moment_rotation", "pushover", "displacements", "overturning_moment"]
STILL = {
    "name": "still",
    "case": {"block": {"R": 5.0, "tan_alpha": 0.2}},
    "vary": {
        "block.tan_alpha": [0.1, 0.2, 0.333],
        "model": ["rigid", 1, 3],
        "geometry": ["negative_stiffness", "corotational"],
    },
    "curves": ALL,
}
PULSE = {"pulse": {"shape": "sine", "a_p": "3*g*tan_alpha", "omega_p": "2*pi"}}


def test_a_study_in_which_nothing_moves_holds_its_curves_only():
    dataset = rockcli.run(STILL)
    assert dataset.sizes == {"tan_alpha": 3, "model": 3, "geometry": 2, "rotation": 201}
    assert "outcome" not in dataset
    assert "time" not in dataset.variables
    assert dataset["theta_over_alpha"].dims == ("rotation",)
    assert {"theta_over_alpha", "alpha", "R"} <= set(dataset.coords)
    force = dataset["pushover_force"].sel(tan_alpha=0.333, model="3", geometry="corotational")
    theta = dataset["theta_over_alpha"] * np.arctan(0.333)
    np.testing.assert_allclose(force, 0.333 / np.cos(theta) - np.tan(theta), atol=1e-15)
    error = dataset["curve_error_pushover"].sel(model="1", geometry="negative_stiffness")
    np.testing.assert_allclose(error, (0.0024875776, 0.0098048641, 0.0262840936), rtol=1e-8)
    width = 2.0 * 5.0 * np.sin(np.arctan(0.1))
    assert float(dataset["u_free_corner"].isel(tan_alpha=0, model=0, geometry=0, rotation=-1)) == pytest.approx(width)


def test_uncertain_bodies_have_static_curves_and_no_statistics():
    """asin(tan alpha)/alpha is where the moment of model 3, corotational, vanishes; `over` is still answered."""
    still = {"case": {"block": {"R": 5.0, "tan_alpha": 0.2}, "model": 3, "geometry": "corotational"}}
    still |= {"curves": ["moment_rotation"], "uncertain": {"block.tan_alpha": {"normal": [0.2, 0.01]}}, "samples": 4}
    dataset = rockcli.run(still)
    assert dataset.sizes == {"sample": 4, "rotation": 201}
    tan_alpha = dataset["sampled_tan_alpha"]
    expected = np.arcsin(tan_alpha) / np.arctan(tan_alpha)
    np.testing.assert_allclose(dataset["theta_critical_over_alpha"], expected, rtol=1e-12)
    with pytest.raises(StudyError, match="over needs outcome"):
        rockcli.check(still | {"over": "sample"})


def test_the_resolved_study_runs_again_and_gives_the_same():
    first = rockcli.run(STILL)
    again = rockcli.run(yaml.safe_load(first.attrs["study"]))
    assert again.attrs["identity"] == first.attrs["identity"]
    assert list(again.variables) == list(first.variables)


def test_beside_a_motion_nothing_else_changes():
    study = {"name": "both", "case": {**STILL["case"], "motion": PULSE}}
    plain, curved = rockcli.run(study), rockcli.run(study | {"curves": ["pushover"]})
    assert curved.attrs["identity"] == plain.attrs["identity"]
    assert float(curved["theta_peak_over_alpha"]) == float(plain["theta_peak_over_alpha"])
    assert set(curved.variables) - set(plain.variables) == {
        "theta_over_alpha", "pushover_force", "pushover_force_block", "curve_error_pushover"
    }  # fmt: skip
    asked = rockcli.run(STILL | {"save": {"scalars": ["outcome"]}})
    assert "outcome" in asked


def test_curves_come_and_go_without_solving(tmp_path: Path):
    study = {"name": "both", "case": {**STILL["case"], "motion": PULSE}}
    run_study(open_study(study), tmp_path, plots=False)
    for curves, there in ((["pushover"], True), ([], False), (["displacements"], True)):
        report = run_study(open_study(study | {"curves": curves}), tmp_path, plots=False)
        assert report.status == "up to date"
        fields = netcdf.read(tmp_path / "both" / "both.nc").fields
        assert ("theta_over_alpha" in fields) is there
        assert ("u_model" in fields) is (curves == ["displacements"])
        assert ("pushover_force" in fields) is (curves == ["pushover"])


def test_expect_judges_curves():
    clauses = [
        {"quantity": "curve_error_pushover", "at": {"tan_alpha": 0.1, "model": 3}, "max": 0.005},
        {"quantity": "v_model", "max": 0},
        {"quantity": "pushover_force", "min": 0.1},
    ]
    study = open_study(STILL | {"expect": clauses})
    from rockcli.analysis.expect import check_quantities, judge

    check_quantities(study)
    assert [v.passed for v in judge(solve(study), study.expect)] == [True, True, False]
    with pytest.raises(StudyError, match="curves"):
        check_quantities(open_study(STILL | {"curves": ["pushover"], "expect": clauses}))
    with pytest.raises(StudyError, match="did you mean"):
        open_study(STILL | {"curves": ["pushove"]})


def test_axes_may_not_be_called_rotation():
    study = {**STILL, "let": {"rotation": 1}, "vary": {"let.rotation": [1, 2]}}
    assert "let_rotation" in rockcli.run(study).sizes


ONE = {"block": {"R": 1, "tan_alpha": 0.3}, "model": 3}


@pytest.mark.parametrize(
    ("case", "curves"),
    [
        pytest.param({}, ALL, marks=pytest.mark.slow, id="axes, all"),
        pytest.param({}, ["pushover"], id="axes"),
        pytest.param(ONE, ALL, id="one, all"),
        pytest.param(ONE, ["pushover"], id="one"),
    ],
)
def test_figures(case: dict, curves: list[str], tmp_path: Path):
    study = STILL | {"curves": curves, "plots": ["curves"]}
    if case:
        study = {"name": "still", "case": case, "curves": curves, "plots": ["curves"]}
    report = run_study(open_study(study), tmp_path)
    assert [path.name for path in report.plots] == ["curves.png"]
    dataset = open_dataset(tmp_path / "still" / "still.nc")
    assert figures.default_kinds(dataset) == ("curves",)
    figure = figures.figure("curves", dataset)
    figure.draw_without_rendering()
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert words[0].startswith("block")
    assert any("model" in word for word in words)
    assert "error [%]" in [axes.get_ylabel() for axes in figure.axes]
    if not case:
        assert figure.axes[2].get_title() == r"$\tan\alpha$ = 0.333"
        assert sum("models 1, 3" in word for word in words) == 1  # they coincide with a negative stiffness
    plain = dataset.drop_vars([name for name in dataset.data_vars if name != "alpha"])
    assert "no static curves" in figures.why_not("curves", plain)


def test_bodies_by_name_are_held_against_their_own_blocks():
    """A column each, as bodies by number have; the frequency of a pulse changes no curve and has none."""
    study = {
        "case": {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": {"shape": "sine", "a_p": 1, "T_p": 1}}},
        "vary": {
            "block": {"slim": {"tan_alpha": 0.1}, "stout": {"tan_alpha": 0.5}},
            "motion.pulse.T_p": [0.5, 1.0, 2.0],
            "model": ["rigid", "1"],
        },
        "curves": ["pushover"],
    }
    dataset = rockcli.run(study)
    figure = figures.figure("curves", dataset)
    curves, errors = figure.axes[:2], figure.axes[2:]
    assert [axes.get_title() for axes in curves] == ["slim", "stout"]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["block", "model 1"]
    stored = dataset["curve_error_pushover"].isel(T_p=0).sel(model="1").values
    for axes, error, tan_alpha, expected in zip(curves, errors, (0.1, 0.5), stored, strict=True):
        theta = np.linspace(0.0, np.arctan(tan_alpha), 201)
        block, model = np.tan(theta[-1] - theta), tan_alpha - np.tan(theta)
        block_line, model_line = (line for line in axes.lines if len(line.get_xdata()) == 201)
        np.testing.assert_allclose(block_line.get_ydata(), block / tan_alpha, atol=1e-12)
        np.testing.assert_allclose(model_line.get_ydata(), model / tan_alpha, atol=1e-12)
        np.testing.assert_allclose(error.lines[0].get_ydata(), 100.0 * (model - block) / tan_alpha, atol=1e-8)
        assert np.abs(error.lines[0].get_ydata()).max() == pytest.approx(100.0 * expected)


def test_models_whose_curves_coincide_are_named():
    study = {"case": {"block": {"R": 1.0, "tan_alpha": 0.2}}, "vary": {"model": [1, 2, 3, 4]}, "curves": ["pushover"]}
    figure = figures.figure("curves", rockcli.run(study))
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["block", "models 1, 2, 3, 4"]


def test_labels_of_curves_that_coincide():
    assert words_of([("model 1", "negative_stiffness"), ("model 3", "negative_stiffness")]) == (
        "models 1, 3; negative stiffness"
    )
    assert words_of([("model 1", "a"), ("model 3", "b")]) == "model 1, a = model 3, b"
    assert words_of([("model 3",)]) == "model 3"
    assert words_of([()]) == ""


COMPARED = {
    "name": "compared",
    "case": {"block": {"R": 5.0, "tan_alpha": 0.2}, "motion": {"pulse": {**PULSE["pulse"], "a_p": "A*g*tan_alpha"}}},
    "let": {"A": 3},
    "vary": {"let.A": [3, 30], "model": ["rigid", 3]},
    "compare_to": {"model": "rigid"},
}


def test_nothing_is_compared_after_overturning():
    dataset = rockcli.run(COMPARED)
    np.testing.assert_array_equal(dataset["outcome"].values[1] >= 2, True)
    np.testing.assert_array_equal(dataset["same_outcome"], 1)
    theta, alpha, time = dataset["theta"], float(dataset["alpha"]), dataset["time"]
    gap = np.abs(theta - theta.sel(model="rigid")).sel(model="3") / alpha
    first = dataset["t_overturn"].min("model")
    expected = gap.where(~(time >= first)).max("time")
    np.testing.assert_allclose(dataset["error_history"].sel(model="3"), expected, rtol=1e-14)
    assert float(gap.isel(A=1).max()) > float(expected.isel(A=1)) > 0.0
    np.testing.assert_array_equal(dataset["error_history"].sel(model="rigid"), 0.0)


def test_overturning_is_seen_in_the_history_if_its_time_was_not_saved():
    study = open_study(COMPARED)
    contents = solve(study)
    fields = {name: item for name, item in contents.fields.items() if name != "t_overturn"}
    without = with_comparison(Contents(contents.axes, fields, contents.attrs), study)
    np.testing.assert_allclose(without.values("error_history"), contents.values("error_history"), rtol=0.05)


def test_compared_histories_share_a_legend_and_show_the_difference():
    figure = figures.figure("histories", rockcli.run(COMPARED))
    figure.draw_without_rendering()
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["model 3", "rigid (reference)"]
    names = [axes.get_ylabel() for axes in figure.axes if axes.get_ylabel()]
    assert names == [r"$a_g$ [g]", r"$\theta/\alpha$", r"$\dot\theta/(p\,\alpha)$", r"$\Delta\theta/\alpha$"]
    assert [axes.get_title() for axes in figure.axes[:2]] == ["A = 3", "A = 30"]
    assert "crosses: overturning" in figure.get_suptitle()


@pytest.mark.parametrize("n", [4, 7])
def test_many_columns_go_below_one_another(n: int):
    study = COMPARED | {"vary": {"let.A": [3.0 + 0.1 * i for i in range(n)], "model": ["rigid", 1, 3]}}
    figure = figures.figure("histories", rockcli.run(study))
    figure.draw_without_rendering()
    assert len([axes for axes in figure.axes if axes.get_title()]) == min(n, 6)
    assert ("6 of 7 columns shown" in figure.get_suptitle()) is (n == 7)
