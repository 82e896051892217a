"""Every kind of figure is drawn from a dataset alone, and says what it leaves out."""

from __future__ import annotations

import random
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
import xarray
from matplotlib.figure import Figure

import rockcli
from rockcli.plotting import figures
from rockcli.plotting.common.labels import axis_label, coordinate_label, unit_g, unit_in_brackets, variable_label
from rockcli.plotting.common.style import save
from rockcli.plotting.kinds.map import is_log, plane
from rockcli.plotting.page.elements import image
from rockcli.scene.variables import VARIABLES
from rockcli.study.document.paths import UNITS
from rockcli.study.schema import PLOTS

ALPHA, P = np.arctan(0.2), 1.2


def axis(name: str, path: str, values: object, unit: str = "1") -> xarray.DataArray:
    array = np.asarray(values)
    attrs = {"long_name": "words", "path": path} | ({"units": unit} if array.dtype.kind == "f" else {})
    return xarray.DataArray(array if array.dtype.kind == "f" else array.astype(object), dims=name, attrs=attrs)


def histories(n: int, overturns: bool = False, compare_to: str = "null") -> xarray.Dataset:
    """Decaying swings of n sizes."""
    t = np.arange(0, 8, 0.01)
    R = np.linspace(2.0, 9.0, n)
    theta = ALPHA * 0.5 * np.sin(2 * t[None, :] / np.sqrt(R[:, None] / 2)) * np.exp(-0.2 * t)
    if overturns:
        theta[0] = np.where(t < 3, ALPHA * 0.3 * t**2, np.nan)
    crossing = np.arange(1, 4) * np.pi / 2
    pulse = np.where(t < 1, 2.0 * np.sin(2 * np.pi * t), 0.0)
    dims = ("R_m", "time")
    data = {
        "theta": (dims, theta),
        "theta_dot": (dims, np.gradient(theta, t, axis=1)),
        "a_g": (dims, np.tile(pulse, (n, 1))),
        "t_impact": (("R_m", "impact"), np.tile(crossing, (n, 1))),
        "theta_dot_before": (("R_m", "impact"), np.full((n, 3), 0.10)),
        "theta_dot_after": (("R_m", "impact"), np.full((n, 3), 0.09)),
        "outcome": ("R_m", np.where((np.arange(n) == 0) & overturns, 3, 1).astype(np.int8)),
        "theta_peak_over_alpha": ("R_m", np.where((np.arange(n) == 0) & overturns, np.inf, 0.4)),
        "t_overturn": ("R_m", np.where((np.arange(n) == 0) & overturns, 2.0, np.nan)),
        "n_impacts": ("R_m", np.full(n, 3)),
    }
    coords = {"R_m": axis("R_m", "block.R", R, "m"), "time": t, "alpha": ALPHA, "p": P}
    attrs = {"title": "Swings of $5 blocks", "axes": "R_m", "compare_to": compare_to}
    return xarray.Dataset(data, coords, attrs)


def spectrum(with_label: bool = False) -> xarray.Dataset:
    """An outcome map with every outcome in it."""
    a, w = np.linspace(0.5, 6, 12), np.geomspace(0.5, 8, 15)
    peak = a[:, None] / w[None, :]
    flags = np.select([a[:, None] + 0 * w < 1, peak > 2.5, peak > 1.5], [0, 2, 3], 1).astype(np.int8)
    flags[-1, -1], flags[-1, -2] = -2, -1
    peak = np.where(flags > 1, np.inf, np.where(flags < 0, np.nan, peak))
    dims: tuple[str, ...] = ("a_p_over_g_tan_alpha", "omega_p_over_p")
    coords = {
        dims[0]: axis(dims[0], "motion.pulse.a_p_over_g_tan_alpha", a),
        dims[1]: axis(dims[1], "motion.pulse.omega_p_over_p", w),
    }
    if with_label:
        flags, peak = np.stack([flags] * 7), np.stack([peak] * 7)
        coords["model"] = axis("model", "model", ["rigid", "1", "2", "3", "4", "5", "6"])
        dims = ("model", *dims)
    data = {"outcome": (dims, flags), "theta_peak_over_alpha": (dims, peak)}
    return xarray.Dataset(data, coords, {"title": "A spectrum", "axes": " ".join(dims)})


def words(figure: Figure) -> str:
    figure.draw_without_rendering()
    return " | ".join([figure.get_suptitle(), *(ax.get_title() for ax in figure.axes)])


@pytest.mark.parametrize("kind", ["histories", "phase", "map"])
@pytest.mark.parametrize("plot_format", ["png", "pdf", "svg"])
def test_kinds_and_formats(kind: str, plot_format: str, tmp_path: Path) -> None:
    dataset = histories(3, overturns=True)
    file = tmp_path / f"figure.{plot_format}"
    save(figures.figure(kind, dataset), file)
    head = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml"}[plot_format]
    assert file.read_bytes().startswith(head)


def test_the_same_figure_gives_the_same_bytes(tmp_path: Path) -> None:
    """Wherever in memory its parts come to lie: the layout's solver goes by addresses."""
    dataset, elsewhere, rng = histories(2), [], random.Random(1)
    for name in "abcdef":
        save(figures.figure("histories", dataset), tmp_path / f"{name}.svg")
        elsewhere = [bytes(rng.randrange(1, 4000)) for _ in range(rng.randrange(20_000))][::2]
    assert elsewhere
    assert len({(tmp_path / f"{name}.svg").read_bytes() for name in "abcdef"}) == 1


def test_settings_of_the_user_change_no_figure(tmp_path: Path) -> None:
    """As those of a `matplotlibrc`: LaTeX, which may be missing and takes % for the end of a line, grids, margins."""
    settings = {"text.usetex": True, "axes.grid": True, "axes.xmargin": 0.3, "savefig.bbox": "tight"}
    pages = []
    for name, theirs in (("plain", {}), ("theirs", settings)):
        with mpl.rc_context(theirs):
            save(figures.figure("histories", histories(2)), tmp_path / f"{name}.png")
            pages.append(image(figures.figure("phase", histories(2)), "words"))
    assert (tmp_path / "plain.png").read_bytes() == (tmp_path / "theirs.png").read_bytes()
    assert pages[0] == pages[1]


def test_a_study_can_ask_for_every_kind_and_for_no_other() -> None:
    assert sorted(PLOTS) == sorted(figures.KINDS)


def test_what_the_content_suggests() -> None:
    assert figures.default_kinds(histories(1).isel(R_m=0, drop=True).assign_attrs(axes="")) == ("histories", "phase")
    assert figures.default_kinds(histories(5)) == ("histories", "phase", "curve")
    assert figures.default_kinds(spectrum()) == ("map",)
    bare = xarray.Dataset({"outcome": ((), np.int8(1))}, attrs={"axes": ""})
    assert figures.default_kinds(bare) == ()
    assert "no histories" in figures.why_not("phase", bare)
    assert "not drawn by this version" in figures.why_not("portrait", bare)
    assert "measured by `rock trade`" in figures.why_not("work_precision", bare)
    assert figures.why_not("map", spectrum()) == ""


def test_one_case_is_summed_up_in_the_title() -> None:
    one = histories(1).isel(R_m=0, drop=True).assign_attrs(axes="")
    figure = figures.figure("histories", one)
    assert "0.4" in words(figure)
    assert "3 impacts" in words(figure)
    assert r"\$5" in words(figure)
    assert [ax.get_ylabel() for ax in figure.axes] == [r"$a_g$ [g]", r"$\theta/\alpha$", r"$\dot\theta$ [rad/s]"]


def test_a_selection_is_said() -> None:
    assert "8 of 20 cases shown" in words(figures.figure("histories", histories(20)))
    assert "6 of 20 cases shown" in words(figures.figure("phase", histories(20)))
    assert "6 of 7 maps shown" in words(figures.figure("map", spectrum(with_label=True)))


def test_what_overturned_is_said() -> None:
    figure = figures.figure("histories", histories(3, overturns=True))
    assert "overturns" in figure.legends[0].get_texts()[0].get_text()
    low, high = figure.axes[1].get_ylim()
    assert high < 2.0
    assert low < 0.0
    strip = figures.figure("map", histories(4, overturns=True)).axes[0]
    assert [text.get_text() for text in strip.get_yticklabels()] == ["overturned"]


def test_a_comparison_shows_the_difference() -> None:
    dataset = histories(3, compare_to='{"R_m": 2.0}')
    figure = figures.figure("histories", dataset)
    assert figure.axes[-1].get_ylabel() == r"$\Delta\theta/\alpha$"
    assert [text.get_text() for text in figure.legends[0].get_texts()][-1] == "$R$ = 2 m (reference)"
    assert len(figure.legends[0].get_texts()) == 3
    assert "grey: $R$ = 2 m" in words(figures.figure("phase", dataset))


def test_nothing_overlaps() -> None:
    """Titles, labels and legends of the busiest figures keep clear of each other and inside the page."""
    long = histories(8, overturns=True).rename(R_m="record").assign_attrs(axes="record", title="A long title " * 12)
    names = [f"a_record_with_a_long_name_{i}.AT2" for i in range(8)]
    long = long.assign_coords(record=axis("record", "motion.record.file", names))
    several = [(kind, long) for kind in ("histories", "phase")]
    for kind, dataset in (
        *several,
        ("histories", histories(20)),
        ("phase", histories(20)),
        ("map", spectrum(with_label=True)),
    ):
        figure = figures.figure(kind, dataset)
        figure.draw_without_rendering()
        page = figure.bbox
        boxes = [figure._suptitle.get_window_extent(), *(legend.get_window_extent() for legend in figure.legends)]
        for ax in figure.axes:
            if ax.axison:
                boxes += [t.get_window_extent() for t in (ax.title, ax.xaxis.label, ax.yaxis.label) if t.get_text()]
        for number, box in enumerate(boxes):
            assert box.x0 >= page.x0 - 1
            assert box.x1 <= page.x1 + 1
            assert box.y0 >= page.y0 - 1
            assert box.y1 <= page.y1 + 1
            assert not any(box.overlaps(other) for other in boxes[number + 1 :])


def test_the_map_stands_amplitudes_upright_and_knows_spacing() -> None:
    assert plane(spectrum()) == ("omega_p_over_p", "a_p_over_g_tan_alpha")
    assert plane(histories(3)) is None
    assert is_log(np.geomspace(0.1, 10, 30))
    assert not is_log(np.linspace(0.1, 10, 30))
    assert is_log(np.array([3e9, 3e10, 3e11, 3e15]))  # uneven, but nothing to be seen of on a linear axis
    assert not is_log(np.array([0.1, 0.2, 1.0, 2.0]))
    figure = figures.figure("map", spectrum())
    assert figure.axes[0].get_xscale() == "log"
    assert figure.axes[0].get_yscale() == "linear"
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert legend == [
        "no uplift",
        "overturned without impact (mode 2)",
        "overturned after impact (mode 1)",
        "failed",
        "unresolved",
        r"uplift, $g\,\tan\alpha$",
    ]


def test_labels() -> None:
    dataset = histories(3)
    assert axis_label(dataset, "R_m") == "$R$ [m]"
    assert coordinate_label(dataset, "R_m", 0) == "$R$ = 2 m"
    labelled = spectrum(with_label=True)
    assert coordinate_label(labelled, "model", 0) == "rigid"
    assert coordinate_label(labelled, "model", 3) == "model 3"
    for name in VARIABLES:
        assert variable_label(name)


def test_units_are_written_as_people_write_them() -> None:
    pulse = {"shape": "ricker", "a_p": 3.0, "f_p": 1.0}
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}
    dataset = rockcli.run({"name": "u", "case": case, "vary": {"motion.pulse.f_p": [1.0, 2.5]}})
    assert axis_label(dataset, "f_p") == "$f_p$ [Hz]"
    assert coordinate_label(dataset, "f_p", 1) == "$f_p$ = 2.5 Hz"
    written = {unit: unit_in_brackets(unit) for unit in UNITS.values()}
    assert not any("-" in shown for shown in written.values()), written


def test_accelerations_are_in_the_g_of_the_case() -> None:
    dataset = histories(1)
    moon = dataset.assign_attrs(case='{"block": {"R": 2.0}, "g": 1.62}')
    assert unit_g(dataset) == 9.81
    assert unit_g(dataset.assign_attrs(case='{"block": {"g": 1.0}}')) == 9.81
    assert unit_g(moon) == 1.62
    assert unit_g(dataset.assign_attrs(case='{"g": "10"}')) == 10.0
    assert unit_g(dataset.assign_attrs(case='{"g": "2*5"}')) == 9.81
    drawn = figures.figure("histories", dataset.assign_attrs(case='{"g": 2.0}')).axes[0].lines[0].get_ydata()
    assert np.nanmax(drawn) == pytest.approx(1.0, rel=1e-3)
    varied = moon.rename(R_m="g").assign_attrs(axes="g")
    varied["g"].attrs["path"] = "g"
    assert unit_g(varied) == 9.81


def test_letters_the_font_lacks_are_no_warning(tmp_path: Path) -> None:
    """Warnings are errors here."""
    from rockcli.plotting.figures import figure

    study = {"name": "far", "title": "地震", "case": {"block": {"R": 2, "tan_alpha": 0.2}, "initial": {"theta": 0.1}}}
    save(figure("histories", rockcli.run(study)), tmp_path / "h.png")


def test_what_a_search_found_is_a_curve() -> None:
    """The lowest overturning amplitude against the frequency, by half sines of which it is known in closed form."""
    from rockcli.scene.laws.overturning import sine_without_impact

    pulse = {"shape": "half_sine", "omega_p_over_p": 1, "a_p_over_g_tan_alpha": 1}
    case = {"block": {"R": 1, "alpha": 0.1}, "motion": {"pulse": pulse}, "model": "linearized"}
    frequencies = [1.0, 2.0, 3.0, 8.0]
    vary = {
        "motion.pulse.omega_p_over_p": frequencies,
        "motion.pulse.a_p_over_g_tan_alpha": {"from": 1, "to": 4, "n": 40, "find": "overturning"},
    }
    dataset = rockcli.run({"name": "s", "case": case, "vary": vary})
    assert figures.default_kinds(dataset) == ("curve",)
    strip, axes = figures.figure("curve", dataset).axes
    assert axes.get_ylabel() == r"lowest overturning $a_p/(g\,\tan\alpha)$"
    drawn = np.asarray(axes.lines[0].get_ydata(), dtype=float)
    expected = sine_without_impact(np.array(frequencies), 1) * 0.1 / np.tan(0.1)
    assert (expected > 4.0).any()
    np.testing.assert_allclose(drawn, np.where(expected > 4.0, np.nan, expected), rtol=1e-5)
    assert [label.get_text() for label in strip.get_yticklabels()] == ["none in range"]


def test_curves_of_a_refined_map_tell_what_was_not_solved() -> None:
    """What was filled in has an outcome and no peak: it was marked `no answer`, whether it overturns or not."""
    pulse = {"shape": "sine", "omega_p_over_p": 2.0, "a_p_over_g_tan_alpha": 2.0}
    vary = {f"motion.pulse.{key}": {"from": 0.5, "to": 10.0, "n": 160} for key in pulse if key != "shape"}
    case = {"block": {"R": 1, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}
    dataset = rockcli.run({"case": case, "vary": vary, "refine": True})
    strip, _ = figures.figure("curve", dataset.isel(a_p_over_g_tan_alpha=[50])).axes
    assert [label.get_text() for label in strip.get_yticklabels()] == ["not solved", "overturned"]
    marked = [np.sort(line.get_xdata()) for line in strip.lines if line.get_marker() != "None"]
    row = dataset.isel(a_p_over_g_tan_alpha=50)
    x, fell = row["omega_p_over_p"].values, row["outcome"].values >= 2
    np.testing.assert_array_equal(marked[1], x[fell])
    np.testing.assert_array_equal(marked[0], x[~fell & (row["solved"].values == 0)])
    assert len(marked[0]) > 10


@pytest.mark.parametrize(
    ("ends", "words"),
    [((3e8, 3e10), ["$10^{9}$", "$10^{10}$"]), ((2e9, 6e9), [r"$2\times10^{9}$", r"$5\times10^{9}$"]),
     ((0.3, 30.0), ["0.5", "1", "2", "5", "10", "20"])],
)  # fmt: skip
def test_logarithmic_axes_have_powers_of_ten_as_legends_have(ends, words) -> None:
    """They had 5e+08, and in a column of a journal these ran into one another."""
    values = np.geomspace(*ends, 5)
    axis = ("E", values, {"path": "column.E", "units": "Pa", "long_name": "E"})
    dataset = xarray.Dataset({"theta_peak_over_alpha": ("E", np.arange(5.0))}, {"E": axis}, {"axes": "E", "title": "t"})
    (axes,) = figures.figure("curve", dataset).axes
    low, high = axes.get_xlim()
    ticks = zip(axes.get_xticks(), axes.get_xticklabels(), strict=True)
    assert [label.get_text() for at, label in ticks if low <= at <= high] == words


def test_what_overturns_counts_for_the_numbers_along_a_logarithmic_axis() -> None:
    """Of one peak among moduli over two decades the axis had 1, 2 and 5 times each power of ten, or some of them."""
    axis = ("E", np.geomspace(3e8, 3e10, 3), {"path": "column.E", "units": "Pa", "long_name": "E"})
    peaks = ("E", np.array([np.inf, np.inf, 0.7]))
    dataset = xarray.Dataset({"theta_peak_over_alpha": peaks}, {"E": axis}, {"axes": "E", "title": "t"})
    _, axes = figures.figure("curve", dataset).axes
    low, high = axes.get_xlim()
    ticks = zip(axes.get_xticks(), axes.get_xticklabels(), strict=True)
    assert [label.get_text() for at, label in ticks if low <= at <= high] == ["$10^{9}$", "$10^{10}$"]


@pytest.mark.parametrize(("values", "limits"), [([1e-3, 5e-3], (0.0, 5.6e-3)), ([-3.0, 2.0], (-3.36, 2.24))])
def test_the_axis_of_a_curve_is_that_of_its_values(values, limits) -> None:
    """Small values lay on a line at the bottom of an axis to 0.11; negative ones, of a search, were left out."""
    axis = ("b", np.array([1.0, 2.0]), {"path": "block.b", "units": "m", "long_name": "b"})
    name = "motion_pulse_a_p_over_g_tan_alpha_overturning"
    dataset = xarray.Dataset({name: ("b", np.array(values))}, {"b": axis}, {"axes": "b", "title": "t"})
    (axes,) = figures.figure("curve", dataset).axes
    np.testing.assert_allclose(axes.get_ylim(), limits)
    bodies = ("body", np.array(["one", "two"], dtype=object), {"path": "block", "long_name": "body"})
    by_name = xarray.Dataset({name: ("body", np.array(values))}, {"body": bodies}, {"axes": "body", "title": "t"})
    (axes,) = figures.figure("ranking", by_name).axes
    np.testing.assert_allclose(axes.get_xlim(), np.array(limits) * 1.05 / 1.12)


def test_a_search_that_found_nothing_is_drawn_on_a_logarithmic_axis_too() -> None:
    """Warnings are errors here."""
    pulse = {"shape": "half_sine", "omega_p_over_p": 1, "a_p_over_g_tan_alpha": 1}
    case = {"block": {"R": 1, "alpha": 0.1}, "motion": {"pulse": pulse}}
    vary = {
        "motion.pulse.omega_p_over_p": [8.0, 16.0, 32.0],
        "motion.pulse.a_p_over_g_tan_alpha": {"from": 1, "to": 1.2, "n": 3, "find": "overturning"},
    }
    strip, axes = figures.figure("curve", rockcli.run({"name": "s", "case": case, "vary": vary})).axes
    assert axes.get_xscale() == "log"
    assert [label.get_text() for label in strip.get_yticklabels()] == ["none in range"]
