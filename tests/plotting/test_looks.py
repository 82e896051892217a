"""Figures as they are wanted: width, title, selection, labels, limits, letters, several datasets in one."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import xarray
import yaml
from half_sines import SUITE
from matplotlib.figure import Figure
from PIL import Image
from typer.testing import CliRunner

import rockcli
from rockcli.cli.main import app
from rockcli.engine.draw import asked_of, draw
from rockcli.errors import StudyError
from rockcli.plotting.common.selection import overlaid, place_on, selected
from rockcli.plotting.common.style import save
from rockcli.plotting.figures import figure
from rockcli.scene.looks import Look, width_of
from rockcli.storage.netcdf import write
from rockcli.storage.read import from_xarray

PULSE = {"shape": "sine", "a_p_over_g_tan_alpha": 2.0, "omega_p_over_p": 5.0}
CASE = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": PULSE}}
STUDY = {"name": "sizes", "title": "Three sizes", "case": CASE, "vary": {"block.R": [1.0, 2.0, 4.0]}}


@pytest.fixture(scope="module")
def sizes() -> xarray.Dataset:
    return rockcli.run(STUDY)


@pytest.fixture(scope="module")
def pga() -> xarray.Dataset:
    vary = {"motion.pulse.a_p": ["0.1*g", "0.4*g", "1.2*g"], "model": ["rigid", "linearized"]}
    case = {"block": CASE["block"], "motion": {"pulse": {"shape": "sine", "a_p": 1.0, "omega_p": 5.0}}}
    return rockcli.run({"name": "pga", "case": case, "vary": vary})


def text(drawn: Figure) -> str:
    drawn.draw_without_rendering()
    return " | ".join([drawn.get_suptitle(), *(t.get_text() for legend in drawn.legends for t in legend.get_texts())])


@pytest.mark.parametrize(
    ("kind", "said", "mm"),
    [("histories", "single", 90.0), ("phase", "double", 180.0), ("map", 120.0, 120.0), ("phase", "75", 75.0)],
)
def test_a_figure_is_as_wide_as_it_is_wanted(
    sizes: xarray.Dataset, kind: str, said: str | float, mm: float, tmp_path: Path
) -> None:
    """Of the file itself: nothing is cut off or added."""
    drawn = rockcli.plot(sizes, kind, tmp_path / "a.png", width=said)
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.width / 300.0 * 25.4 == pytest.approx(mm, abs=0.1)
    page = drawn.bbox
    for axes in drawn.axes:
        box = axes.get_tightbbox()
        assert box is None or (box.x0 >= page.x0 - 1.0 and box.x1 <= page.x1 + 1.0)
    for legend in drawn.legends:
        assert legend.get_window_extent().x0 >= page.x0


def test_widths_that_figures_cannot_have() -> None:
    for said in ("wide", 12.0, "5000", float("nan")):
        with pytest.raises(StudyError, match=r"single or double, or a number from 60 to 500 \[mm\]"):
            width_of(said)
    assert width_of(None) is None
    assert width_of("90mm") == width_of("90 mm") == width_of("90") == 90.0


def test_without_a_title_its_words_are_in_the_file(sizes: xarray.Dataset, tmp_path: Path) -> None:
    drawn = rockcli.plot(sizes, "histories", tmp_path / "a.png", title=None, select={"R": 4})
    assert drawn.get_suptitle() == ""
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.info["Title"] == "Three sizes"
        assert "$R$ = 4 m" in picture.info["Description"]
    other = rockcli.plot(sizes, "histories", title="Mine", select={"R": 4})
    assert other.get_suptitle().startswith("Mine\n$R$ = 4 m; peak")


def test_selected_cases_are_drawn_and_named(sizes: xarray.Dataset, pga: xarray.Dataset) -> None:
    two = rockcli.plot(sizes, "histories", select={"block.R": [4.0, "1"]})
    assert "$R$ = 4 m and $R$ = 1 m" in text(two)
    curves = [line for line in two.axes[1].lines if len(line.get_xdata()) > 100]
    for line, which in zip(curves, (2, 0), strict=True):
        at = int(np.nanargmax(np.abs(line.get_ydata())))
        assert line.get_xdata()[at] == pytest.approx(float(sizes.t_peak[which]), abs=0.005)
    for said in ("0.4g", "0.4*g", "0.4 g", 0.4 * 9.81):
        assert place_on(pga, "a_p" if "a_p" in pga.dims else "motion_pulse_a_p", said) == 1
    part, words = selected(pga, {"a_p": "1.2g", "model": "linearized"})
    assert words == "$a_p$ = 1.2 g, linearized"
    assert dict(part.sizes)["model"] == 1
    assert float(part.theta_peak_over_alpha.squeeze()) == float(pga.theta_peak_over_alpha.values[2, 1])


def test_an_angle_may_be_in_degrees() -> None:
    pulse = {"shape": "sine", "a_p": 2.0, "omega_p": 5.0}
    angles = {"block.alpha": ["10*deg", "15*deg", 0.3], "motion.pulse.a_p": [2.0, 3.0]}
    dataset = rockcli.run({"case": {"block": {"R": 2, "alpha": 0.2}, "motion": {"pulse": pulse}}, "vary": angles})
    for said in ("15deg", "15*deg", " 15 deg", 15 * np.pi / 180):
        assert place_on(dataset, "block_alpha", said) == 1
    assert place_on(dataset, "block_alpha", "0.3") == 2
    for axis, said in (("block_alpha", "15g"), ("motion_pulse_a_p", "15deg"), ("block_alpha", "deg")):
        with pytest.raises(StudyError, match="expected a number"):
            place_on(dataset, axis, said)


@pytest.mark.parametrize(
    ("chosen", "words"),
    [
        ({"radius": 1}, "select radius: the axes are block_R"),
        ({"blokc_R": 1}, "the axes are block_R; did you mean 'block_R'"),
        ({"R": 3}, "block_R=3: there are 1, 2, 4"),
        ({"R": "large"}, "expected a number"),
    ],
)
def test_what_is_not_there_cannot_be_selected(sizes: xarray.Dataset, chosen: dict[str, object], words: str) -> None:
    with pytest.raises(StudyError, match=words):
        selected(sizes, chosen)


@pytest.mark.parametrize(
    ("said", "meant"),
    [
        ("hrem", "'herm'"),
        ("BUST", "'bust-1'"),
        ("bust 2", "'bust-2'"),
        ("FF26", "'P695FF26_LOMAP_G03090.AT2'"),
        ("x", ""),
    ],
)
def test_a_label_that_is_nearly_there_is_named(said: str, meant: str) -> None:
    labels = ["kouros", "herm", "bust-1", "bust-2", "P695FF26_LOMAP_G03090.AT2", *(f"stele {i}" for i in range(30))]
    dataset = xarray.Dataset(
        {"outcome": ("case", np.zeros(len(labels)))},
        {"case": ("case", np.array(labels, dtype=object), {"path": "case"})},
        {"axes": "case"},
    )
    with pytest.raises(StudyError) as caught:
        place_on(dataset, "case", said)
    end = f"; did you mean {meant}?" if meant else ", ..."
    assert str(caught.value).startswith(f"case={said}: there are kouros, herm, bust-1, ")
    assert str(caught.value).endswith(end)


def test_part_of_a_suite_is_no_suite() -> None:
    vary = {"motion.pulse.omega_p": [3.0, 4.0, 5.0], "motion.pulse.a_p": ["0.3*g", "0.6*g", "0.9*g"]}
    case = {"block": CASE["block"], "motion": {"pulse": {"shape": "sine", "a_p": 1.0, "omega_p": 5.0}}}
    study = {"name": "s", "case": case, "vary": vary, "over": "motion.pulse.omega_p", "save": {"histories": False}}
    suite = rockcli.run(study)
    assert asked_of(suite)[0][0] == "ida"
    with pytest.raises(StudyError, match="takes no statistics"):
        rockcli.plot(suite, "ida", select={"omega_p": 4})
    assert asked_of(suite, select={"omega_p": 4})[0][0] == "curve"


@pytest.mark.parametrize(("width", "rows"), [(90, [0, 1]), (180, [0, 0])])
def test_panels_are_counted_as_they_are_read(width: float, rows: list[int]) -> None:
    """The spectrum, beside or below the motion, was panel (a), and below it the first row of labels."""
    pulse = {"shape": "sine", "a_p": 4.0, "T_p": 0.5}
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}
    figure = rockcli.plot(rockcli.run({"case": case}), "motion", width=width, letters=True, labels={"y1": "first"})
    spectrum, ground = figure.axes
    assert [ground.texts[0].get_text(), spectrum.texts[0].get_text()] == ["(a)", "(b)"]
    assert ground.get_ylabel() == "first"
    assert (spectrum.get_ylabel() == "first") == (rows[1] == 0)


def test_labels_limits_and_letters(sizes: xarray.Dataset) -> None:
    drawn = rockcli.plot(
        sizes,
        "histories",
        labels={"x": "time", "y2": "tilt"},
        limits={"x": (0.5, 2.0), "y2": (-0.6, 0.6)},
        letters=True,
    )
    assert [axes.get_ylabel() for axes in drawn.axes] == ["$a_g$ [g]", "tilt", r"$\dot\theta$ [rad/s]"]
    assert [axes.get_xlabel() for axes in drawn.axes] == ["", "", "time"]
    assert drawn.axes[1].get_ylim() == (-0.6, 0.6)
    assert all(axes.get_xlim() == (0.5, 2.0) for axes in drawn.axes)
    assert [axes.texts[-1].get_text() for axes in drawn.axes] == ["(a)", "(b)", "(c)"]
    with pytest.raises(StudyError, match="limits of y4: it has 3 rows of panels"):
        rockcli.plot(sizes, "histories", limits={"y4": (0.0, 1.0)})
    with pytest.raises(StudyError, match=r"limits \(2, 0.5\): expected two finite numbers, low below high"):
        rockcli.plot(sizes, "histories", limits={"x": (2.0, 0.5)})


def test_a_logarithmic_axis_begins_above_zero(pga: xarray.Dataset) -> None:
    vary = {"block.R": {"from": 1, "to": 30, "n": 12, "spacing": "log"}}
    spectrum = rockcli.run({**STUDY, "vary": vary, "save": {"histories": False}})
    with pytest.raises(StudyError, match="the axis is logarithmic"):
        rockcli.plot(spectrum, "map", limits={"x": (0.0, 10.0)})


def test_a_study_says_how_its_plots_are_wanted(tmp_path: Path) -> None:
    """By itself, and when they are drawn again from the file."""
    wanted = {
        "kind": "histories",
        "select": {"block.R": [1, 4]},
        "width": "single",
        "title": False,
        "labels": {"y1": "ground"},
        "limits": {"x": [0, 3]},
        "letters": True,
    }
    data = rockcli.run({**STUDY, "plots": ["phase", wanted, "histories"]})
    asked = asked_of(data)
    assert [kind for kind, _ in asked] == ["phase", "histories", "histories"]
    assert asked[1][1] == Look(
        width=90.0, title=None, select=wanted["select"], labels={"y1": "ground"}, limits={"x": (0.0, 3.0)}, letters=True
    )
    path = tmp_path / "a.nc"
    write(from_xarray(data), path)
    drawn, complaints = draw(path, asked)
    assert [one.path.name for one in drawn] == ["phase.png", "histories.png", "histories_2.png"]
    assert not complaints
    again = CliRunner().invoke(app, ["plot", str(path), "--kind", "histories", "--out", str(tmp_path / "b.png")])
    assert again.exit_code == 0, again.output
    assert (tmp_path / "b.png").read_bytes() == (tmp_path / "histories.png").read_bytes()


@pytest.mark.parametrize(
    ("plots", "words"),
    [
        ("[{kind: histogram}]", "plots[0].kind is 'histogram'"),
        (
            "[{kind: map, width: 2}]",
            "plots[0].width: expected single or double, or a number from 60 to 500 [mm], not 2",
        ),
        (
            "[{kind: map, width: wide}]",
            "plots[0].width: expected single or double, or a number from 60 to 500 [mm], not 'wide'",
        ),
        ("[{kind: map, labels: {z: depth}}]", "plots[0].labels.z: unknown key 'z'; known: x, y, and y1, y2, ..."),
        ("[{kind: map, limits: {z: [0, 1]}}]", "plots[0].limits.z: unknown key 'z'; known: x, y, and y1, y2, ..."),
        ("[{kind: map, limits: {x: [1]}}]", "plots[0].limits.x: two numbers, [low, high], are expected"),
        ("[{kind: map, limits: {x: [1, 2, 3]}}]", "plots[0].limits.x: two numbers, [low, high], are expected"),
        ("[{kind: map, limits: {x: 1}}]", "plots[0].limits.x: two numbers, [low, high], are expected"),
        (
            "[{kind: histories, limits: {x: [8, 0]}}]",
            "a.yaml:4: plots[0].limits.x: two finite numbers, [low, high], low",
        ),
        ("[{kind: histories, limits: {x: [1, 1]}}]", "a.yaml:4: plots[0].limits.x: two finite numbers"),
        ("[{kind: histories, limits: {x: [0, .inf]}}]", "a.yaml:4: plots[0].limits.x: two finite numbers"),
        ("[{width: single}]", "'kind' is missing"),
        ("[{kind: map, letter: true}]", "did you mean 'letters'"),
    ],
)
def test_wrong_plots_are_refused(plots: str, words: str, tmp_path: Path) -> None:
    file = tmp_path / "a.yaml"
    file.write_text(f"name: a\ncase:\n  block: {{R: 2, tan_alpha: 0.2}}\nplots: {plots}\n")
    told = CliRunner().invoke(app, ["check", str(file)])
    assert getattr(told.exception, "exit_code", None) == 2
    assert words in str(told.exception)


def test_suites_of_several_datasets_are_refused_for_what_they_are() -> None:
    one, other = rockcli.run(SUITE), rockcli.run(SUITE | {"name": "other"})
    for kind in ("ida", "fragility"):
        with pytest.raises(StudyError, match=f"plot '{kind}' is drawn of one dataset at a time"):
            rockcli.plot([one, other], kind)
    with pytest.raises(StudyError, match="no hazard curve"):
        rockcli.plot([one, other], "risk")


def test_several_datasets_in_one_figure(sizes: xarray.Dataset, tmp_path: Path) -> None:
    """Each keeps its own line, whatever its time steps."""
    finer = rockcli.run({"name": "finer", "case": CASE, "save": {"dt_out": 0.0031}})
    plain = rockcli.run({"name": "plain", "case": {**CASE, "model": "linearized"}, "save": {"dt_out": 0.005}})
    drawn = rockcli.plot([finer, plain], "histories")
    assert [t.get_text() for t in drawn.legends[0].get_texts()] == ["finer", "plain"]
    both = overlaid([finer, plain], ["finer", "plain"])
    for i, own in enumerate((finer, plain)):
        line = both.theta.values[i]
        again = np.interp(own.time.values, both.time.values, line)
        np.testing.assert_allclose(again, own.theta.values, atol=1e-12)
        between = np.interp(both.time.values, own.time.values, own.theta.values, right=np.nan)
        np.testing.assert_array_equal(line, between)
        known = np.isfinite(own.t_impact.values)
        np.testing.assert_array_equal(both.t_impact.values[i][: known.sum()], own.t_impact.values[known])
    assert figure("phase", both).axes
    with pytest.raises(
        StudyError, match=r"its axes \(block_R\) are not those of the first \(none\); draw it by itself"
    ):
        rockcli.plot([finer, sizes])
    other = rockcli.run({**STUDY, "vary": {"block.R": [1.0, 2.0, 5.0]}})
    with pytest.raises(
        StudyError, match="of block_R are not those of the first; --select block_R=VALUE leaves those of both"
    ):
        rockcli.plot([sizes, other])
    assert rockcli.plot([sizes, other], "histories", select={"R": 2})


def test_the_command_draws_several_files_together_only_where_it_is_told(tmp_path: Path) -> None:
    files = []
    for name in ("one", "two"):
        files.append(tmp_path / name / f"{name}.nc")
        files[-1].parent.mkdir()
        write(from_xarray(rockcli.run({"name": name, "case": CASE})), files[-1])
    names = list(map(str, files))
    assert CliRunner().invoke(app, ["plot", *names]).exit_code == 0
    assert all((file.parent / "histories.png").exists() for file in files)
    both = tmp_path / "both.svg"
    assert CliRunner().invoke(app, ["plot", *names, "--out", str(both), "--no-title"]).exit_code == 0
    assert "one" in both.read_text()
    refused = CliRunner().invoke(app, ["plot", names[0], "--kind", "map", "--kind", "phase", "--out", str(both)])
    assert refused.exit_code != 0
    refused = CliRunner().invoke(app, ["plot", names[0], "--select", "R"])
    assert "expected AXIS=VALUE" in str(refused.exception)


@pytest.mark.slow
def test_what_a_figure_without_a_title_leaves_out_is_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The note that stands below a title says which cases are shown; without one the command line does."""
    monkeypatch.chdir(tmp_path)
    vary = {"block.R": {"from": 1.0, "to": 3.0, "n": 9}, "initial.theta": [0.05, 0.1, 0.15]}
    plots = ["phase", {"kind": "phase", "title": False}]
    study = {"name": "many", "case": CASE, "vary": vary, "plots": plots, "save": {"histories": True, "dt_out": 0.05}}
    Path("many.yaml").write_text(yaml.dump(study), encoding="utf-8")
    left_out = r"phase(_2)?\.png has no title, and does not say: 6 of 27 cases shown"
    run = CliRunner().invoke(app, ["run", "many.yaml"])
    assert run.exit_code == 0
    assert re.findall(r"phase\S* has no title", run.stderr) == ["phase_2.png has no title"]
    assert re.search(left_out, run.stderr)
    plot = ["plot", "results/many/many.nc", "--kind", "phase"]
    assert CliRunner().invoke(app, plot).stderr == ""
    for more in ((), ("--out", "phase.png")):
        untitled = CliRunner().invoke(app, [*plot, "--no-title", *more])
        assert untitled.stdout.count("\n") == 1
        assert re.search(left_out, untitled.stderr)
    selected = CliRunner().invoke(app, [*plot, "--no-title", "--select", "R=1", "--select", "initial.theta=0.1"])
    assert "$" not in selected.stderr
    assert "R = 1 m, theta_0 = 0.1 rad" in selected.stderr


def test_files_are_the_same_whatever_was_drawn_before(sizes: xarray.Dataset, tmp_path: Path) -> None:
    """A wanted width is that of one figure."""
    a, b, c = (tmp_path / f"{name}.png" for name in "abc")
    for path, width in ((a, None), (b, 90.0), (c, None)):
        save(figure("phase", sizes, Look(width=width)), path)
    assert a.read_bytes() == c.read_bytes() != b.read_bytes()


def test_directions_are_a_polar_plot_with_the_worst_marked() -> None:
    """A curve of the peak by direction, in degrees; what overturns is at the edge."""
    angles = np.linspace(0.0, np.pi, 13)
    peak = 0.5 * np.abs(np.cos(angles - angles[4]))
    attrs = {"axes": "scale angle", "title": "Directions"}
    coords = {
        "scale": ("scale", [1.0, 2.0], {"path": "motion.record.scale", "units": "1"}),
        "angle": ("angle", angles, {"path": "motion.record.angle", "units": "rad"}),
    }
    peaks = np.stack([peak, np.where(peak > 0.4, np.inf, 2.0 * peak)])
    data = xarray.Dataset({"theta_peak_over_alpha": (("scale", "angle"), peaks)}, coords, attrs)
    assert asked_of(data)[0][0] == "polar"
    drawn = figure("polar", data)
    axes = drawn.axes[0]
    assert [t.get_text() for t in axes.texts] == ["60\N{DEGREE SIGN}: 0.5"]
    crosses = [line for line in axes.lines if line.get_marker() == "x"]
    assert [len(line.get_xdata()) for line in crosses] == [0, int((peak > 0.4).sum())]
    assert "crosses: overturned" in drawn.get_suptitle()


def test_curves_that_overturn_in_one_direction_have_crosses_side_by_side() -> None:
    """Those of the last hid the others."""
    angles = np.linspace(0.0, 1.75 * np.pi, 8)
    coords = {
        "mu": ("mu", [0.2, 0.4, 0.6], {"path": "block.mu", "units": "1"}),
        "angle": ("angle", angles, {"path": "motion.record.angle", "units": "rad"}),
    }
    peaks = np.full((3, 8), 0.4)
    peaks[:2, 1:5] = np.inf
    data = xarray.Dataset(
        {"theta_peak_over_alpha": (("mu", "angle"), peaks)}, coords, {"axes": "mu angle", "title": "Directions"}
    )
    axes = figure("polar", data).axes[0]
    crosses = [line.get_ydata() for line in axes.lines if line.get_marker() == "x"]
    assert [len(each) for each in crosses] == [4, 4, 0]
    assert axes.get_rmax() > crosses[0][0] > crosses[1][0] + 0.04 > 0.44


def test_datasets_of_which_one_varies_along_more_axes_are_drawn_together():
    """The peak of the ground is of the amplitudes alone, that of a floor of the frequencies too."""
    study = {
        "name": "ground",
        "case": {
            "block": {"R": 2.0, "tan_alpha": 0.2},
            "motion": {"pulse": {"shape": "sine", "a_p": 3.0, "omega_p": 4.0}},
        },
        "vary": {
            "motion.pulse.a_p": {"from": 0.5, "to": 4.0, "n": 5},
            "motion.pulse.omega_p": {"from": 3.0, "to": 9.0, "n": 6},
        },
    }
    floor = {"motion": study["case"]["motion"] | {"through": [{"T": 0.5, "zeta": 0.1}]}}
    one, other = (rockcli.run(each) for each in (study, study | {"name": "floor", "case": study["case"] | floor}))
    assert one["pga"].ndim < other["pga"].ndim
    for first, second in ((one, other), (other, one)):
        both = overlaid([first, second], ["first", "second"])
        for i, each in enumerate((first, second)):
            pga = np.broadcast_to(each["pga"].values.reshape(5, -1), (5, 6))
            np.testing.assert_array_equal(both["pga"].isel(dataset=i).values, pga)
        assert len(rockcli.plot([first, second], "map").axes) >= 2


@pytest.mark.parametrize("kind", ["curve", "map", "ranking"])
def test_datasets_of_equal_results_are_drawn_together(kind):
    """Two names of one study, or amplitudes at which nothing moves in either of two."""
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": {"shape": "sine", "a_p": 3.0, "T_p": 0.5}}}
    a_p, T_p = ({"from": 0.5 * most, "to": most, "n": 5} for most in (1.5, 2.0))
    over = {"motion.pulse.a_p": a_p} | ({} if kind == "curve" else {"motion.pulse.T_p": T_p})
    if kind == "ranking":
        over = {
            "case": {"low": {"block.R": 1.0}, "high": {"block.R": 2.0}, "higher": {"block.R": 3.0}},
            "motion.pulse.a_p": [0.7, 1.5],
        }
    sizes = [
        {"name": name, "case": case | {"block": {"R": R, "tan_alpha": 0.2}}} for name, R in (("a", 1.0), ("b", 2.0))
    ]
    data = [rockcli.run(size | {"vary": over, "save": {"histories": False}}) for size in sizes]
    np.testing.assert_array_equal(*(each["theta_peak_over_alpha"].values for each in data))
    drawn = rockcli.plot(data, kind)
    words = [text.get_text() for legend in drawn.legends for text in legend.get_texts()]
    words += [axes.get_title() for axes in drawn.axes]
    assert all(any(word.startswith(name) for word in words) for name in "ab")


def test_lines_over_datasets_drawn_together_are_those_of_their_own_models():
    """Linearized blocks lift at g alpha, and fall by another separatrix; those of the first were drawn over all."""
    study = {
        "name": "rigid",
        "case": {
            "block": {"R": 2.0, "tan_alpha": 0.6},
            "motion": {"pulse": {"shape": "sine", "a_p": 8.0, "omega_p": 4.0}},
        },
    }
    a_p, omega_p = ({"from": low, "to": high, "n": 5} for low, high in ((1.0, 9.0), (3.0, 9.0)))
    vary = {"vary": {"motion.pulse.a_p": a_p, "motion.pulse.omega_p": omega_p}}
    linear = {"name": "linearized", "case": study["case"] | {"model": "linearized"}}
    for first, second in ((study, study | linear), (study | linear, study)):
        maps = [rockcli.run(each | vary) for each in (first, second)]
        together = rockcli.plot(maps, "map")
        for panel, one in zip(together.axes, maps, strict=False):
            (own,) = (line for line in rockcli.plot(one, "map").axes[0].lines if line.get_gid() == "uplift")
            (line,) = (line for line in panel.lines if line.get_gid() == "uplift")
            assert panel.get_title() == one.attrs["study_name"]
            np.testing.assert_allclose(line.get_ydata(), own.get_ydata(), rtol=1e-12)
        words = [text.get_text() for text in together.legends[0].get_texts()]
        assert r"uplift, $g\,\tan\alpha$ or $g\,\alpha$" in words
        cases = [rockcli.run(each) for each in (first, second)]
        panels = [panel for panel in rockcli.plot(cases, "phase").axes if panel.lines]
        rates = []
        for panel, one in zip(panels, cases, strict=True):
            (alone,) = rockcli.plot(one, "phase").axes
            line, own = ([each for each in p.lines if len(each.get_xdata()) == 201][-1] for p in (panel, alone))
            x = np.linspace(0.0, 0.9, 10)
            rate = np.interp(x, *line.get_data())
            np.testing.assert_allclose(rate, np.interp(x, *own.get_data()), atol=1e-3)
            rates.append(rate)
        assert np.abs(rates[1] - rates[0]).max() > 0.01
