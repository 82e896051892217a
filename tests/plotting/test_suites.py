"""Figures of suites: what they show, what they say, and what they refuse."""

from __future__ import annotations

import re

import numpy as np
import pytest
from half_sines import SUITE
from plotting.test_widths import check_words
from scipy.special import ndtr

import rockcli
from rockcli.errors import StudyError
from rockcli.plotting import figures
from rockcli.plotting.common.style import save
from rockcli.plotting.kinds import fragility
from rockcli.plotting.kinds.ida import fractiles_of
from rockcli.scene.ground.hazard import hazard_words

G = 9.81


def suite(**more):
    return SUITE | {"title": "Half sines"} | more


@pytest.fixture(scope="module")
def stripes():
    return rockcli.run(suite())


@pytest.fixture(scope="module")
def sizes():
    vary = {
        "motion.pulse.omega_p": [2.0, 3.0, 4.0],
        "block.tan_alpha": [0.1, 0.2],
        "block.R": {"from": 1, "to": 30, "n": 12, "spacing": "log"},
    }
    return rockcli.run(
        suite(
            vary=vary,
            case={
                "block": {"R": 2.0, "tan_alpha": 0.2},
                "motion": {"pulse": {"shape": "half_sine", "a_p": 0.5 * G, "omega_p": 3.0}},
            },
        )
    )


def test_default_kinds(stripes, sizes):
    assert figures.default_kinds(stripes) == ("ida", "fragility")
    assert figures.default_kinds(sizes) == ("spectrum",)


def test_ida_shows_every_member_and_the_fractiles(stripes):
    figure = figures.figure("ida", stripes)
    (axes,) = figure.axes
    curves = [line for line in axes.lines if len(line.get_ydata()) == 20]
    assert len(curves) == 5  # of five members no percentile: it would leap from one to another
    assert len({(line.get_color(), line.get_linestyle()) for line in curves}) == 5
    assert [text.get_text() for text in figure.legends[0].get_texts()][:5] == [
        f"$\\omega_p$ = {value} rad/s" for value in range(2, 7)
    ]
    assert [end for end, _, _ in fractiles_of(8)] == ["p16", "p50", "p84"]
    np.testing.assert_allclose(curves[0].get_ydata(), stripes["motion_pulse_a_p"].values / G)
    peak = stripes["theta_peak_over_alpha"].values
    right = axes.get_xlim()[1]
    for line, expected in zip(curves, peak, strict=False):
        x = line.get_xdata()
        np.testing.assert_array_equal(x[np.isfinite(expected)], expected[np.isfinite(expected)])
        assert (x[np.isinf(expected)] > right).all()
    assert np.isinf(peak).any()
    assert "leave to the right" in figure.get_suptitle()


def test_the_band_of_a_curve_is_as_wide_as_the_limits_of_its_median():
    """By Student's t: few members would have too narrow a band by the normal law."""
    data = rockcli.run(suite(over={"axis": "motion.pulse.omega_p", "limits": []}))
    begins, median, high = (
        float(data[f"fragility_{name}"].squeeze()) for name in ("begins_at", "median", "median_ci_high")
    )
    (axes,) = figures.figure("fragility", data).axes
    edge = axes.collections[0].get_paths()[0].vertices
    there, back = edge[1 : len(edge) // 2], edge[len(edge) // 2 + 1 : -1][::-1]
    ends = [np.interp(median / G, *each.T) for each in (there, back)]
    width = np.log((high - begins) / (median - begins)) / float(data["fragility_beta_total"].squeeze())
    assert width > 0.1
    np.testing.assert_allclose(ends, ndtr([-width, width]), atol=1e-3)


def test_alternatives_of_a_body_are_shown_together():
    more = {"block.R": [1.0, 2.0, 3.0], "block.tan_alpha": [0.1, 0.2, 0.3]}
    figure = figures.figure("fragility", rockcli.run(suite(vary=suite()["vary"] | more)))
    titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
    assert len(titles) == 6
    assert [sum(f"= {value}" in title for title in titles) for value in (0.1, 0.2, 0.3)] == [2, 2, 2]


def test_of_many_bodies_those_that_overturn_most_easily_are_shown():
    """As a run tells them; sizes on an axis of numbers are spread evenly."""
    ratios = [0.30, 5.0, 0.28, 0.20, 0.26, 0.24, 0.22, 0.02]
    named = {f"body {value}": {"block": {"R": 2.0, "tan_alpha": value}} for value in ratios}
    curve = {"label": "x", "intensity": ["0.01*g", "0.1*g", "1*g", "4*g"], "rate": [0.1, 1e-2, 1e-4, 1e-6]}
    data = rockcli.run(suite(vary=suite()["vary"] | {"case": named}, hazard=[curve]))
    shown = {"fragility": [0.28, 0.2, 0.26, 0.24, 0.22, 0.02], "risk": [0.2, 0.24, 0.22]}
    for kind, expected in (shown | {"ida": shown["fragility"]}).items():
        figure = rockcli.plot(data, kind)
        titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
        assert titles == [f"body {value:g}" for value in expected]
        assert ("those that overturn most easily" in figure.get_label()) is (kind != "risk")


def test_bodies_without_a_curve_overturn_more_easily_than_those_that_never_do():
    """All fall between two intensities, so that beta cannot be told; of eight, six of which stand, both are shown."""
    stout = {f"stout {k}": {"block": {"R": 2.0, "tan_alpha": 0.8 + 0.1 * k}} for k in range(6)}
    slender = {f"slender {k}": {"block": {"R": 2.0, "tan_alpha": 0.15 + 0.01 * k}} for k in range(2)}
    vary = suite()["vary"] | {"motion.pulse.a_p": [0.1 * G, 0.2 * G, 0.6 * G], "case": stout | slender}
    data = rockcli.run(suite(vary=vary))
    falls = data["p_overturned"].sel(motion_pulse_a_p=0.6 * G).values
    assert (falls[:6] == 0.0).all()
    assert (falls[6:] == 1.0).all()
    assert np.isnan(data["fragility_median"].values[:, -1]).all()
    for kind in ("ida", "fragility"):
        figure = rockcli.plot(data, kind)
        titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
        assert {"slender 0", "slender 1"} <= set(titles)
        assert "those that overturn most easily" in figure.get_label()
    rows = [text.get_text() for text in rockcli.plot(data, "ranking").axes[0].get_yticklabels()]
    assert rows[:2] == ["slender 0", "slender 1"]


def test_members_of_an_ida_are_fainter_the_more_there_are():
    amplitudes = {"motion.pulse.a_p": ["0.2*g", "0.4*g", "0.8*g"]}
    for n, alpha in ((20, 1.0), (300, 0.5)):
        periods = {"motion.pulse.omega_p": {"from": 2, "to": 6, "n": n}}
        (axes,) = figures.figure("ida", rockcli.run(suite(vary=periods | amplitudes))).axes
        assert axes.lines[0].get_alpha() == alpha


def test_an_ida_marks_uplift_but_below_floors(stripes):
    words = lambda data: [text.get_text() for text in figures.figure("ida", data).legends[0].get_texts()]  # noqa: E731
    assert words(stripes)[-1].startswith("uplift")
    case = SUITE["case"] | {"motion": SUITE["case"]["motion"] | {"through": [{"T": 0.4, "zeta": 0.05}]}}
    assert not any(word.startswith("uplift") for word in words(rockcli.run(suite(case=case))))


def test_an_ida_of_bodies_that_only_slide_is_of_the_slide():
    vary = SUITE["vary"] | {"motion.pulse.omega_p": {"from": 2, "to": 10, "n": 9}}
    case = SUITE["case"] | {"block": {"height": 2.0, "width": 1.0, "mu": 0.1}}
    data = rockcli.run(suite(case=case, vary=vary))
    assert (data["theta_peak_over_alpha"] == 0.0).all()
    (axes,) = figures.figure("ida", data).axes
    assert axes.get_xlabel() == r"$|u|_{\mathrm{max}}$ [m]"
    peaks = data["slide_peak"].transpose("motion_pulse_omega_p", "motion_pulse_a_p").values
    drawn = [line.get_xdata() for line in axes.lines if len(line.get_xdata()) == peaks.shape[1]]
    np.testing.assert_array_equal(np.stack(drawn[: len(peaks)]), peaks)
    middle = np.sort(peaks, axis=0)
    assert any(np.allclose(curve, np.median(middle, axis=0)) for curve in drawn[len(peaks) :])
    assert axes.get_xlim()[1] == pytest.approx(1.06 * peaks.max())
    assert "uplift" not in str([text.get_text() for text in axes.figure.legends[0].get_texts()])


def test_an_ida_says_in_the_panel_of_a_body_that_it_only_slides():
    blocks = {"rough": {"height": 2.0, "width": 0.4}, "smooth": {"height": 2.0, "width": 1.0, "mu": 0.1}}
    figure = figures.figure("ida", rockcli.run(suite(vary=SUITE["vary"] | {"block": blocks})))
    assert [[text.get_text() for text in axes.texts] for axes in figure.axes] == [[], ["only slides"]]
    upright = [[line for line in axes.lines if set(line.get_xdata()) == {1.0}] for axes in figure.axes]
    assert [len(lines) for lines in upright] == [1, 0]


def test_a_curve_of_a_suite_is_its_share_and_its_median():
    """Not some bodies under some motions: what the suite comes to, body by body."""
    block = {"wide": {"h": 1.0, "b": "0.3*k"}, "slender": {"h": 1.5, "b": "0.2*k"}}
    vary = {"block": block, "let.k": [0.5, 1.0, 1.5, 2.0], "motion.pulse.omega_p": {"from": 2, "to": 8, "n": 9}}
    case = SUITE["case"] | {"motion": {"pulse": {"shape": "half_sine", "a_p": 0.6 * G, "omega_p": 1.0}}}
    data = rockcli.run(suite(case=case, let={"k": 1}, vary=vary))
    assert figures.default_kinds(data) == ("curve",)
    drawn = figures.figure("curve", data)
    for axes, name in zip(drawn.axes, ("p_overturned", "theta_peak_over_alpha_p50"), strict=True):
        values = data[name].transpose("block", "k").values
        assert (np.isinf(values).any(), len(axes.lines)) == (name != "p_overturned", 2)
        for line, expected in zip(axes.lines, values, strict=True):
            np.testing.assert_array_equal(line.get_ydata(), np.where(np.isinf(expected), np.nan, expected))
            np.testing.assert_array_equal(line.get_xdata(), data["k"].values)
    assert [words.get_text() for words in drawn.legends[0].get_texts()] == ["wide", "slender"]
    assert "9 values of" in drawn.get_suptitle()
    assert "no median where half or more overturn" in drawn.get_suptitle()
    assert 0.0 < float(data["p_overturned"].mean()) < 1.0
    vary = {"let.k": vary.pop("let.k"), **vary}
    several = rockcli.run(suite(case=case, let={"k": 1}, vary=vary, over=["block", "motion.pulse.omega_p"]))
    assert len(figures.figure("curve", several).axes[0].lines) == 1


def test_fragility_draws_shares_and_fits(stripes):
    figure = figures.figure("fragility", stripes)
    (axes,) = figure.axes
    lines = iter(axes.lines)
    assert next(lines).get_xdata()[0] == pytest.approx(0.2)  # g tan(alpha): the sketch begins at uplift
    medians = stripes["fragility_median"].values
    fitted = np.isfinite(medians)
    assert fitted.any()
    seen, styles = [], set()
    for i in range(len(medians)):
        median, beta = float(stripes["fragility_median"][i]) / G, float(stripes["fragility_beta"][i])
        begin = float(stripes["fragility_begins_at"]) / G
        markers = next(lines)
        np.testing.assert_array_equal(markers.get_ydata(), stripes["p_exceeded"].values[:, i])
        if not fitted[i]:
            assert markers.get_label().endswith("no curve")
            continue
        if median in seen:  # no member tells the two states apart: one curve
            continue
        seen.append(median)
        curve = next(lines)
        styles.add(str(curve._dash_pattern))
        x, y = curve.get_data()
        np.testing.assert_allclose(y, ndtr(np.log((np.asarray(x) - begin) / (median - begin)) / beta), atol=1e-12)
        assert f"median {median:.3g} g" in curve.get_label()
        assert ("overturned" in curve.get_label()) == (medians[-1] == medians[i])
    assert len(axes.collections) == len(seen) < fitted.sum()
    assert len(styles) == len(seen)


def test_the_last_shares_are_drawn_whole(stripes):
    (axes,) = figures.figure("fragility", stripes).axes
    last = stripes["motion_pulse_a_p"].values.max() / G
    axes.figure.canvas.draw()
    (place, _), (end, _) = axes.transData.transform([(last, 0), (axes.get_xlim()[1], 0)])
    assert end - place > 1.5 / 72 * axes.figure.dpi  # half a marker


def test_states_of_one_curve_share_its_entry_in_the_legend(stripes):
    (axes,) = figures.figure("fragility", stripes).axes
    assert sum(" and overturned: median" in str(label) for label in axes.get_legend_handles_labels()[1]) == 1


def test_the_legend_of_several_bodies_has_curves_that_the_first_lacks():
    """A stout body that no motion overturns, before one of which every state has a curve."""
    bodies = {"block": {"stout": {"R": 2.0, "tan_alpha": 1.9}, "slender": {"R": 2.0, "tan_alpha": 0.2}}}
    figure = figures.figure("fragility", rockcli.run(suite(vary=suite()["vary"] | bodies)))
    stout, slender = figure.axes
    assert [line for line in stout.lines if len(line.get_xdata()) == 401] == []
    drawn = {line.get_label(): line for line in slender.lines if len(line.get_xdata()) == 401}
    legend = figure.legends[0]
    shown = dict(zip([text.get_text() for text in legend.get_texts()], legend.get_lines(), strict=True))
    assert len(drawn) == 4
    for label, line in drawn.items():
        assert (shown[label].get_color(), shown[label]._dash_pattern) == (line.get_color(), line._dash_pattern)


@pytest.mark.parametrize(
    ("limits", "words", "drawn"),
    [
        ([1.0], "bands: 95 % limits", 1),
        ([0.5, 1.0], "bands: 95 % limits", 2),
        ([0.3, 0.5, 1.0], "bars: 95 % limits", 3),
    ],
)
def test_the_note_names_the_limits_that_are_drawn(limits, words, drawn):
    """Overturning has the curve of 1 alpha here, and no band or bar of its own."""
    figure = figures.figure("fragility", rockcli.run(suite(over={"axis": "motion.pulse.omega_p", "limits": limits})))
    kinds = {type(each).__name__ for each in figure.axes[0].collections}
    assert len(figure.axes[0].collections) == drawn
    assert kinds == {"LineCollection" if "bars" in words else "FillBetweenPolyCollection"}
    assert words in figure.get_label()


def test_a_hazard_curve_is_called_so_once():
    assert [hazard_words(label) for label in ("moderate", "hazard", "Hazard site B")] == [
        "hazard moderate",
        "hazard",
        "Hazard site B",
    ]


def test_without_a_curve_the_legend_says_so():
    low = {"motion.pulse.omega_p": [2.0, 3.0], "motion.pulse.a_p": {"from": "0.1*g", "to": "0.3*g", "n": 5}}
    dataset = rockcli.run(suite(vary=low))
    (axes,) = figures.figure("fragility", dataset).axes
    assert any("overturned: no curve" in str(label) for label in axes.get_legend_handles_labels()[1])


def test_spectrum_of_a_suite_and_of_single_cases(sizes):
    figure = figures.figure("spectrum", sizes)
    assert len(figure.axes) == 3 * 2
    assert [axes.get_title() for axes in figure.axes[:2]] == [r"$\tan\alpha$ = 0.1", r"$\tan\alpha$ = 0.2"]
    first = next(line for line in figure.axes[0].lines if len(line.get_xdata()) == 12)
    np.testing.assert_allclose(first.get_xdata(), 2 * np.pi / np.sqrt(0.75 * G / sizes["block_R"].values))
    vary = {"block.tan_alpha": [0.1, 0.2], "block.R": [1.0, 2.0, 4.0, 8.0]}
    single = rockcli.run(suite(over=None, vary=vary))
    figure = figures.figure("spectrum", single)
    rates = [line.get_ydata() for line in figure.axes[1].lines]
    expected = (single["theta_dot_peak"] / single["p"]).values
    np.testing.assert_allclose(rates[0], np.where(np.isinf(expected[0]), rates[0], expected[0]))
    assert len(figure.legends) == 1


def test_spectrum_of_overturning_amplitudes():
    vary = {
        "motion.pulse.omega_p": [3.0, 4.0],
        "block.R": [0.5, 1.0, 2.0],
        "motion.pulse.a_p": {"from": "0.1*g", "to": "6*g", "n": 30, "find": "overturning"},
    }
    dataset = rockcli.run(suite(vary=vary))
    assert figures.default_kinds(dataset) == ("spectrum",)
    (axes,) = figures.figure("spectrum", dataset).axes
    assert axes.get_ylabel() == "lowest overturning $a_p$ [g]"
    np.testing.assert_allclose(axes.lines[0].get_ydata(), dataset["motion_pulse_a_p_overturning"].values[0] / G)


def test_bars_of_several_curves_of_a_spectrum_are_all_seen():
    """They lay on one another, so that of bodies that overturn the last alone was seen to."""
    pulse = {"shape": "sine", "a_p_over_g_tan_alpha": 3.0, "omega_p_over_p": 6.0}
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}
    vary = {"motion.pulse.omega_p_over_p": [1.0, 2.0, 3.0, 8.0], "block.R": [1.0, 2.0, 4.0, 8.0]}
    dataset = rockcli.run({"case": case, "vary": vary, "save": {"histories": False}})
    fell = np.isposinf(dataset["theta_peak_over_alpha"].values).all(axis=1)
    assert fell.tolist() == [True, True, True, False]
    for axes in figures.figure("spectrum", dataset).axes:
        heights = [np.asarray(line.get_ydata())[0] for line in axes.lines if line.get_marker() == "|"]
        heights = [height for height in heights if np.isfinite(height)]
        assert len(set(np.round(heights, 6))) == 3
        assert max(heights) < axes.get_ylim()[1]
        lines = [line for line in axes.lines if not line.get_label().startswith("_")]
        assert len({str(line._dash_pattern) for line in lines}) == 4
        assert np.nanmax(lines[-1].get_ydata()) < min(heights)


def test_notes_and_legends_of_a_suite_that_stays_at_rest_are_of_what_is_drawn():
    """They spoke of cases that leave to the right, of bars, and of a line of uplift beyond the axis."""
    pulse = {"shape": "sine", "a_p": 1.0, "omega_p": 6.0}
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}
    vary = {"motion.pulse.omega_p": [3.0, 6.0, 9.0], "motion.pulse.a_p": [0.2, 0.5, 1.0]}
    dataset = rockcli.run({"case": case, "vary": vary, "over": {"axis": "omega_p", "limits": [0.5]}})
    assert not dataset["theta_peak_over_alpha"].values.any()
    for kind in ("ida", "fragility"):
        figure = figures.figure(kind, dataset)
        assert not re.search("leave|bars|bands", figure.get_label())
        assert not [text for text in figure.legends[0].get_texts() if "uplift" in text.get_text()]
    fallen = rockcli.run({"case": case, "vary": vary | {"motion.pulse.a_p": [2.5, 5.0, 10.0, 20.0]}, "over": "omega_p"})
    assert figures.figure("ida", fallen).get_label().endswith("overturned cases leave to the right")


@pytest.mark.parametrize(("b", "levels"), [(0.2, [0.2, -0.2]), ([0.2, 0.3], [0.2, -0.3])])
def test_an_ida_over_both_signs_marks_uplift_to_both_sides(b, levels):
    """Half sines to the right lift a body about its left edge, those turned round about its right one."""
    pulse = {"shape": "half_sine", "a_p": 4.0, "T_p": 0.5}
    case = {"block": {"h": 1.0, "b": b}, "motion": {"pulse": pulse}}
    vary = {"motion.pulse.T_p": [0.3, 0.4, 0.5], "motion.pulse.a_p": [-6.0, -4.0, -2.0, 2.0, 4.0, 6.0]}
    (axes,) = figures.figure("ida", rockcli.run({"case": case, "vary": vary, "over": "T_p"})).axes
    dotted = [line.get_ydata()[0] for line in axes.lines if line.get_color() == "black"]
    np.testing.assert_allclose(dotted, levels)


def test_ida_of_bodies_that_slide_on_for_ever():
    """No friction stops them: all slides are infinite, and the figure ended in an error of the program."""
    pulse = {"shape": "half_sine", "a_p": 1.0, "omega_p": 6.0}
    case = {"block": {"R": 2.0, "tan_alpha": 0.2, "mu": 0}, "motion": {"pulse": pulse}}
    vary = {"motion.pulse.omega_p": [3.0, 6.0], "motion.pulse.a_p": [1.0, 2.0, 3.0]}
    dataset = rockcli.run({"case": case, "vary": vary, "over": "omega_p"})
    assert np.isposinf(dataset["slide_peak"].values).all()
    (axes,) = figures.figure("ida", dataset).axes
    assert all(np.min(line.get_xdata()) > axes.get_xlim()[1] for line in axes.lines)
    assert axes.figure.get_label().endswith("what slides on for ever leaves to the right")


@pytest.mark.parametrize("floors", [False, True])
def test_what_a_search_goes_along_has_its_symbol_in_every_figure(floors):
    """The figure of its fragility had the name of a variable, `motion_record_pga`; with floors it is the ground's."""
    values = (np.sin(np.linspace(0.0, 6.0 * np.pi, 200)) * np.linspace(1.0, 0.1, 200)).tolist()
    record = {"values": values, "dt": 0.01, "units": "g"}
    vary = {
        "motion.record": {"one": record, "two": record | {"dt": 0.014}, "three": record | {"dt": 0.02}},
        "motion.record.pga": {"from": "0.1*g", "to": "6*g", "n": 30, "find": "overturning"},
        "block.R": [0.5, 1.0, 2.0],
    }
    through = {"through": [{"T": 0.2, "zeta": 0.05}]} if floors else {}
    case = {"block": {"R": 1.0, "tan_alpha": 0.2}, "motion": {"record": record, **through}}
    dataset = rockcli.run({"case": case, "vary": vary, "over": "record"})
    symbol = "PGA of the ground [g]" if floors else "PGA [g]"
    assert figures.figure("fragility", dataset).axes[-1].get_xlabel().replace("\n", " ") == symbol
    assert figures.figure("spectrum", dataset).axes[0].get_ylabel() == f"lowest overturning {symbol}"


def test_a_bar_at_the_end_of_a_spectrum_is_seen_and_words_are_of_what_is():
    """It lay on the line of the axis, behind the curve of the largest value; words spoke of bars where there is none."""

    def drawn(top):
        vary = {
            "motion.pulse.omega_p": [3.0, 4.0, 6.0],
            "block.R": [0.5, 1.0, 2.0],
            "motion.pulse.a_p": {"from": "0.1*g", "to": f"{top}*g", "n": 30, "find": "overturning"},
        }
        dataset = rockcli.run(suite(vary=vary))
        name = "motion_pulse_a_p_overturning_prescreen_p50"
        return dataset, figures.figure("spectrum", dataset.assign({name: 1000.0 * dataset[name]}))

    dataset, figure = drawn(0.4)
    found = dataset["motion_pulse_a_p_overturning"].values / G
    assert np.argwhere(np.isinf(found)).tolist() == [[2, 2]]  # the largest, under the shortest pulse
    (axes,) = figure.axes
    period = 2 * np.pi / dataset["p"].values
    (bar,) = (line for line in axes.lines if line.get_marker() == "|" and np.isfinite(line.get_ydata()).any())
    assert np.nanmin(bar.get_ydata()) > 1.03 * found[np.isfinite(found)].max()
    assert axes.get_xlim()[0] < period.min()
    assert axes.get_xlim()[1] > period.max()
    assert "bars at the top: nothing in the range overturns" in figure.get_label()
    assert "above the axis: median, closed form, after first uplift" in figure.get_label()
    told = [text.get_text() for text in figure.legends[0].get_texts()]
    assert [word for word in told if "closed form" in word] == ["median, closed form, worst excursion"]
    _, whole = drawn(0.6)
    assert "bars" not in whole.get_label()


def test_what_cannot_be_drawn_is_refused_in_words(sizes, stripes):
    assert "no amplitude" in figures.why_not("ida", sizes)
    assert "p changes along no axis" in figures.why_not("spectrum", stripes)
    assert "over: record" in figures.why_not("fragility", rockcli.run(suite(over=None)))


@pytest.mark.parametrize("plot_format", ["pdf", "svg"])
def test_the_same_figure_gives_the_same_bytes(stripes, tmp_path, plot_format):
    for kind in ("ida", "fragility"):
        one, two = (tmp_path / f"{name}.{plot_format}" for name in ("one", "two"))
        for path in (one, two):
            save(figures.figure(kind, stripes), path)
        assert one.read_bytes() == two.read_bytes()


def test_risk_shows_hazard_shares_and_survival():
    hazard = [
        {"label": "one", "intensity": ["0.05*g", "0.5*g", "3*g"], "rate": [1e-2, 1e-4, 1e-7]},
        {"label": "two", "intensity": ["0.05*g", "3*g"], "rate": [1e-1, 1e-6]},
    ]
    data = rockcli.run(suite(hazard=hazard, age=1000))
    assert figures.default_kinds(data) == ("ida", "fragility", "risk")
    assert not figures.why_not("risk", data)
    drawn = figures.figure("risk", data)
    left, middle, right, beside = drawn.axes
    curve = next(line for line in left.lines if line.get_label() == "hazard one")
    np.testing.assert_allclose(curve.get_xdata(), [0.05, 0.5, 3.0])
    np.testing.assert_allclose(curve.get_ydata(), [1e-2, 1e-4, 1e-7])
    assert left.get_xlabel() == "$a_p$ [g]"
    overturned = data.sel(limit_state="overturned")
    x, p = beside.lines[0].get_data()
    median, begin = (float(overturned[f"fragility_{name}"]) / G for name in ("median", "begins_at"))
    assert np.interp(median, x, p) == pytest.approx(0.5, abs=1e-3)
    assert (p[x <= begin] == 0.0).all()
    shares = [patch.get_data().values for patch in middle.patches]
    np.testing.assert_allclose(np.sum(shares, axis=1), 100.0)
    marks = [line.get_ydata()[0] for line in right.lines if len(line.get_xdata()) == 1]
    np.testing.assert_allclose(marks, overturned["survival"])


def test_risk_needs_a_hazard_curve(stripes):
    assert "no hazard curve" in figures.why_not("risk", stripes)


@pytest.mark.parametrize(("width", "columns"), [(180, 3), (120, 1), (60, 1)])
def test_panels_of_risk_stand_below_one_another_where_the_figure_is_narrow(width, columns):
    curve = {"label": "x", "intensity": ["0.01*g", "0.1*g", "1*g", "4*g"], "rate": [0.1, 1e-2, 1e-4, 1e-6]}
    figure = rockcli.plot(rockcli.run(suite(hazard=[curve])), "risk", width=width)
    panels = [axes for axes in figure.axes if axes.get_ylabel() != "probability of overturning"]
    figure.draw_without_rendering()
    assert len(panels) == 3
    assert len({round(axes.get_position().x0, 2) for axes in panels}) == columns


def test_bodies_beside_one_another_name_their_scales_once():
    curve = {"label": "x", "intensity": ["0.01*g", "0.1*g", "1*g", "4*g"], "rate": [0.1, 1e-2, 1e-4, 1e-6]}
    data = rockcli.run(suite(hazard=[curve], vary=suite()["vary"] | {"block.tan_alpha": [0.1, 0.2]}))
    for width, times in ((90, 1), (180, 2)):
        figure = rockcli.plot(data, "risk", width=width)
        named = [axes.get_ylabel() for axes in figure.axes if axes.get_ylabel()]
        assert sorted(named) == sorted(times * [*dict.fromkeys(named)])
        assert len(set(named)) == 4
        assert figure.get_figheight() < 240.0 / 25.4  # a page of a journal
    first, second = (axes for axes in figure.axes if axes.get_ylabel() == "annual rate of exceedance")
    assert first.get_ylim() == second.get_ylim()


def test_risk_is_shown_of_bodies_that_overturn():
    curve = {"label": "x", "intensity": ["0.01*g", "0.1*g", "1*g", "4*g"], "rate": [0.1, 1e-2, 1e-4, 1e-6]}
    vary = suite()["vary"] | {"block.tan_alpha": [2.0, 3.0, 4.0, 5.0, 6.0, 0.2]}
    data = rockcli.run(suite(hazard=[curve], vary=vary))
    none = np.isnan(data["annual_rate"].sel(limit_state="overturned").squeeze("hazard"))
    np.testing.assert_array_equal(none, [True, True, True, True, True, False])
    texts = [text.get_text() for axes in rockcli.plot(data, "risk").axes for text in axes.texts]
    assert texts.count(" 5 %") == 3
    assert texts.count("no curve of\noverturning") == 4


@pytest.mark.parametrize("width", [90, 180])
@pytest.mark.parametrize("age", [None, 1e4])
def test_panels_without_a_curve_say_so_and_nothing_else(width, age):
    """Years from .02 to 20 were told of no rate, and numbers of PGA ran into one another."""
    curve = {"label": "x", "intensity": ["0.01*g", "0.1*g", "1*g", "4*g"], "rate": [0.1, 1e-2, 1e-4, 1e-6]}
    data = rockcli.run(suite(hazard=[curve], age=age, vary=suite()["vary"] | {"block.tan_alpha": [1.9, 0.2]}))
    figure = rockcli.plot(data, "risk", width=width)
    figure.draw_without_rendering()
    check_words(figure)
    empty = [axes for axes in figure.axes if "no curve of\noverturning" in [text.get_text() for text in axes.texts]]
    assert [axes.get_xlabel() for axes in empty] == ["$a_p$ [g]", "age [years]"]
    assert [bool(len(axes.get_xticks())) for axes in empty] == [False, bool(age)]


@pytest.mark.parametrize("width", [90, 180])
@pytest.mark.parametrize("slopes", [(1.9, 0.2), (0.2, 1.9)])
def test_a_body_without_a_curve_leaves_the_scale_of_others(width, slopes):
    curve = {"label": "x", "intensity": ["0.01*g", "0.1*g", "1*g", "4*g"], "rate": [0.1, 1e-2, 1e-4, 1e-6]}
    data = rockcli.run(suite(hazard=[curve], vary=suite()["vary"] | {"block.tan_alpha": list(slopes)}))
    most = 100.0 * float(data["deaggregation"].sel(limit_state="overturned").max())
    figure = rockcli.plot(data, "risk", width=width)
    panels = [axes for axes in figure.axes if axes.patches]
    assert len(panels) == 2
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["hazard x", "fragility"]
    assert panels[slopes.index(0.2)].get_ylim()[1] > most > 10.0
    assert all(axes.get_ylim()[0] == 0.0 for axes in panels)


def test_alternatives_beside_the_highest_rates_are_called_so():
    curve = {"label": "x", "intensity": ["0.01*g", "0.1*g", "1*g", "4*g"], "rate": [0.1, 1e-2, 1e-4, 1e-6]}
    more = {"block.R": [2.0, 2.1, 2.2], "block.tan_alpha": [0.2, 5.0]}
    data = rockcli.run(suite(hazard=[curve], vary=suite()["vary"] | more))
    none = np.isnan(data["annual_rate"].sel(limit_state="overturned").squeeze("hazard"))
    np.testing.assert_array_equal(none, 3 * [[False, True]])
    label = rockcli.plot(data, "risk").get_label()
    assert "2 of 6 bodies shown, those of the highest rates and their alternatives" in label


@pytest.mark.slow
def test_risk_is_shown_of_the_bodies_that_overturn_most_often():
    curve = {"label": "x", "intensity": ["0.01*g", "0.1*g", "1*g", "4*g"], "rate": [0.1, 1e-2, 1e-4, 1e-6]}
    sizes = [0.3, 0.22, 0.28, 0.26, 0.23, 0.29, 0.27, 0.21]
    data = rockcli.run(suite(hazard=[curve], vary=suite()["vary"] | {"block.tan_alpha": sizes}))
    rates = data["annual_rate"].sel(limit_state="overturned").squeeze("hazard").values
    most = sorted(np.argsort(-np.nan_to_num(rates, nan=-1.0))[:3])
    assert np.isfinite(rates[most]).all()
    assert most not in ([0, 1, 2], [0, 3, 7], [0, 4, 7])  # nor the first, nor some of all
    figure = rockcli.plot(data, "risk")
    titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
    assert [words.rpartition(" ")[2].strip("$") for words in titles] == [f"{sizes[i]:g}" for i in most]
    assert "3 of 8 bodies shown, those of the highest rates" in figure.get_label()
    narrow = rockcli.plot(data, "risk", width=90)
    assert "2 of 8 bodies shown, those of the highest rates" in narrow.get_label()
    assert narrow.get_figheight() < 240.0 / 25.4  # a page of a journal
    for drawn in (figure, narrow):
        drawn.draw_without_rendering()
        below = [axes for axes in drawn.axes if axes.get_xlabel()]
        assert all(sum(bool(label.get_text()) for label in axes.get_xticklabels()) > 1 for axes in below)


def test_a_limit_of_the_slide_is_exceeded_by_what_overturns():
    assert fragility._state("slide_peak > 0.05 m").endswith("> 0.05 m or overturned")
    assert "overturned" not in fragility._state("0.5")


def test_both_edges_of_a_rectangle_have_one_line_of_words(stripes):
    (axes,) = rockcli.plot(stripes, "body").axes
    assert [text.get_text().startswith(r"$\alpha_{") for text in axes.texts] == [False]


def plane(intensity, **more):
    """Three records, each filtered three times, by PGA: fragility over two intensities."""
    records = [f"synthetic_{name}.AT2" for name in ("pulse_m70", "rock_m65", "soil_m70")]
    return rockcli.run(
        {
            "name": "plane",
            "case": {"block": {"R": 1.0, "tan_alpha": 0.2}, "motion": {"record": {"file": records[0], "pga": 1.0}}},
            "vary": {
                **more,
                "motion.record.file": records,
                "motion.record.highpass": [0.1, 0.4, 0.8],
                "motion.record.pga": {"from": 0.1 * G, "to": 2.0 * G, "n": 9, "spacing": "log"},
            },
            "over": {"axis": ["record", "highpass"], "intensity": intensity, "limits": []},
            "save": {"histories": False},
        }
    )


@pytest.mark.parametrize(
    ("intensity", "units"),
    [
        (["pga", "pgv_over_pga"], (G, 1.0)),
        (["pgv", "pga"], (1.0, G)),
        (["motion.record.pga", "pgv_over_pga"], (G, 1.0)),
    ],
)
def test_two_intensities_have_every_case_and_the_lines_of_the_fitted_curve(intensity, units):
    dataset = plane(intensity)
    assert "intensities" in figures.default_kinds(dataset)
    figure = figures.figure("intensities", dataset)
    (axes,) = figure.axes
    lines = {str(line.get_label()): line for line in axes.lines}
    fell = np.isin(dataset["outcome"].values, (2, 3))
    assert len(lines["overturned"].get_xdata()) == fell.sum() > 0
    assert len(lines["remains stable"].get_xdata()) == (~fell).sum() > 0
    x_0, m, y_r, c = (
        float(dataset[f"fragility_{name}"].values.ravel()[-1]) for name in ("begins_at", "median", "second", "exponent")
    )
    beta = float(dataset["fragility_beta_total"].values.ravel()[-1])
    assert {"5 %", "50 %", "95 %"} < lines.keys()
    for label, line in lines.items():
        if label.endswith("%"):
            first, second = line.get_ydata() * units[0], line.get_xdata() * units[1]
            share = ndtr(np.log((first - x_0) / ((m - x_0) * (second / y_r) ** -c)) / beta)
            np.testing.assert_allclose(share, float(label.removesuffix(" %")) / 100.0, rtol=1e-9)


def test_lines_over_two_intensities_are_drawn_where_a_motion_has_no_acceleration():
    """Its PGV/PGA is not a number, with which the lines were one point each."""
    dataset = plane(["pga", "pgv_over_pga"])
    none = dataset["fragility_intensity_second"].where(dataset["motion_record_pga"] > 0.11 * G)
    (axes,) = figures.figure("intensities", dataset.assign(fragility_intensity_second=none)).axes
    lines = [line for line in axes.lines if str(line.get_label()).endswith("%")]
    assert len(lines) == 3
    for line in lines:
        assert np.isfinite(line.get_xydata()).all()
        assert line.get_xdata()[[0, -1]] == pytest.approx([float(none.min()), float(none.max())])


def test_lines_over_two_intensities_are_named_where_the_first_body_has_none():
    dataset = plane(["pga", "pgv_over_pga"], case={"huge": {"block.R": 60.0}, "small": {"block.R": 1.0}})
    assert np.isfinite(dataset["fragility_median"].values[:, -1]).tolist() == [False, True]
    figure = figures.figure("intensities", dataset)
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert words == ["remains stable", "overturned", "uplift", "5 %", "50 %", "95 %"]


@pytest.mark.parametrize(
    ("second", "symbol", "unit"), [("sa(0.5)", "$S_a$(0.5 s, 5 %)", "g"), ("motion.record.pga", "PGA", "g")]
)
def test_figures_name_the_second_of_two_intensities(second, symbol, unit):
    dataset = plane(["pgv", second])
    at = float(dataset["fragility_second"]) / G
    figure = figures.figure("fragility", dataset)
    assert f"; at {symbol} = {at:.3g} {unit}; bands" in figure.get_label()
    (axes,) = figures.figure("intensities", dataset).axes
    assert axes.get_xlabel() == f"{symbol} [{unit}]"


@pytest.mark.parametrize("kind", ["fragility", "ranking"])
def test_figures_of_several_bodies_name_the_second_intensity_too(kind):
    dataset = plane(["pga", "pgv_over_pga"], case={"small": {"block.R": 1.0}, "stout": {"block.tan_alpha": 0.35}})
    for values, words in (([0.07, 0.07], "0.07 s"), ([0.08, 0.07], "0.07 to 0.08 s"), ([0.07, np.nan], "0.07 s")):
        told = dataset.assign(fragility_second=dataset["fragility_second"].copy(data=np.array(values)))
        assert f"highpass; at PGV/PGA = {words}; " in figures.figure(kind, told).get_label()


@pytest.mark.parametrize(
    ("more", "label"),
    [
        ({}, "$S_a$(0.5 s, 5 %) [g]"),
        ({"motion.record.sa_period": [0.3, 1.0]}, "$S_a$ [g]"),
        ({"case": {"low": {"block.R": 0.5}, "soft": {"motion.record.sa_period": 1.0}}}, "$S_a$ [g]"),
    ],
)
def test_an_axis_of_sa_is_of_a_period_where_all_cases_have_it(more, label):
    record = {"file": "synthetic_rock_m65.AT2", "sa": 1.0, "sa_period": 0.5}
    dataset = rockcli.run(
        {
            "name": "periods",
            "case": {"block": {"R": 1.0, "tan_alpha": 0.2}, "motion": {"record": record}},
            "vary": {**more, "motion.record.file": "synthetic_*.AT2", "motion.record.sa": [2.0, 4.0, 8.0, 16.0]},
            "over": {"axis": "record", "limits": []},
            "save": {"histories": False},
        }
    )
    assert figures.figure("ida", dataset).axes[0].get_ylabel() == label


@pytest.mark.parametrize("kind", ["intensities", "samples"])
def test_figures_of_a_suite_are_of_one_dataset(kind):
    """Several in one figure have no statistics in common."""
    if kind == "samples":
        uncertain = {"block.R": {"uniform": [1.0, 3.0]}}
        data = rockcli.run(
            {"case": suite()["case"], "uncertain": uncertain, "samples": 8, "save": {"histories": False}}
        )
    else:
        data = plane(["pga", "pgv_over_pga"])
    assert not figures.why_not(kind, data)
    with pytest.raises(StudyError, match="drawn of one dataset at a time"):
        rockcli.plot([data, data], kind)


def test_one_intensity_has_no_plane(stripes):
    assert "two intensities" in figures.why_not("intensities", stripes)


@pytest.mark.parametrize("kind", ["ida", "fragility", "ranking"])
def test_cases_without_an_answer_are_told(kind):
    """A many-sided body that would slide is not followed: shares and curves are of the other cases."""
    turns = np.pi * (2.0 * np.arange(12) + 1.0) / 12
    ngon = np.column_stack([np.sin(turns), -np.cos(turns)]).tolist()
    bodies = {"stout": {"height": 1, "width": 0.8, "mu": 0.9}, "round": {"outline": ngon, "mu": 0.3}}
    pulse = {"shape": "half_sine", "a_p": 1.0, "omega_p": 3.0}
    case = {"block": {"height": 1, "width": 0.8}, "motion": {"pulse": pulse}}
    dataset = rockcli.run(suite(case=case, vary={"block": bodies, **SUITE["vary"]}))
    missing = int((dataset["outcome"] == -1).sum())
    assert missing
    words = f"{missing} of {dataset['outcome'].size} cases without an answer left out"
    assert words in figures.figure(kind, dataset).get_label()
    whole = dataset.sel(block=["stout", "stout"])
    assert "without an answer" not in figures.figure(kind, whole).get_label()
