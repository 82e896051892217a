"""The ranking of bodies by name: the order of its rows, what it marks at the side, and when it is drawn unasked."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from plotting.test_widths import check_words

import rockcli
from rockcli.plotting import figures
from rockcli.plotting.kinds import ranking
from rockcli.scene.looks import Look

G = 9.81
SIZES = {"low": (1.0, 0.5), "tall": (2.4, 0.4), "slim": (1.6, 0.24), "middle": (1.6, 0.4)}
UPLIFT = {name: width / height for name, (height, width) in SIZES.items()}
"""tan(alpha), the peak acceleration over g that lifts each."""


def study(**more):
    blocks = {name: {"height": h, "width": w} for name, (h, w) in SIZES.items()}
    pulse = {"shape": "sine", "T_p": 0.5, "a_p": 0.3 * G}
    return {
        "name": "bodies",
        "case": {"block": {"height": 1.0, "width": 0.5}, "motion": {"pulse": pulse}},
        "vary": {"block": blocks},
        "save": {"histories": False},
        **more,
    }


def rows(figure):
    return [label.get_text() for label in figure.axes[0].get_yticklabels()]


def dots(axes):
    """(x, row) of every dot."""
    lines = [line for line in axes.lines if line.get_linestyle() == "None"]
    return [(float(x), int(y)) for line in lines for x, y in line.get_xydata() if np.isfinite(x)]


def test_peaks_are_in_order_and_what_overturns_stands_first_and_at_the_side():
    dataset = rockcli.run(study())
    peaks = dict(zip(dataset["block"].values, dataset["theta_peak_over_alpha"].values, strict=True))
    assert np.isinf(peaks["slim"])
    assert peaks["low"] == 0.0  # .3 g is below .5 g
    figure = figures.figure("ranking", dataset)
    assert rows(figure) == sorted(SIZES, key=lambda name: -peaks[name])
    panel, strip = figure.axes
    assert {rows(figure)[row]: x for x, row in dots(panel)} == {n: p for n, p in peaks.items() if np.isfinite(p)}
    assert [tick.get_text() for tick in strip.get_xticklabels()] == ["overturned"]
    assert [rows(figure)[row] for _, row in dots(strip)] == ["slim"]


def test_of_a_search_the_lowest_threshold_stands_first():
    path = "motion.pulse.a_p"
    vary = study()["vary"] | {path: {"from": 0.1 * G, "to": 0.8 * G, "n": 15, "find": "overturning"}}
    dataset = rockcli.run(study(vary=vary))
    found = dict(zip(dataset["block"].values, dataset["motion_pulse_a_p_overturning"].values, strict=True))
    figure = figures.figure("ranking", dataset)
    assert rows(figure) == sorted(SIZES, key=found.get)
    assert {rows(figure)[row]: x for x, row in dots(figure.axes[0])} == pytest.approx(
        {name: a_p / G for name, a_p in found.items() if np.isfinite(a_p)}
    )
    none = [tick.get_text() for tick in figure.axes[1].get_xticklabels()]
    assert none == ["none in range"]
    assert figures.default_kinds(dataset) == ("ranking", *(k for k in figures.default_kinds(dataset) if k != "ranking"))


def of_a_suite(**more):
    T_p = {"spacing": "linear", "from": 0.3, "to": 1.0, "n": 9}
    over = {"axis": "T_p"} | more.pop("over", {})
    return rockcli.run(study(vary=study()["vary"] | {"motion.pulse.T_p": T_p} | more, over=over))


def test_of_a_suite_the_shares_without_intensities():
    dataset = of_a_suite()
    share = dict(zip(dataset["block"].values, dataset["p_overturned"].values, strict=True))
    figure = figures.figure("ranking", dataset)
    assert [share[name] for name in rows(figure)] == sorted(share.values(), reverse=True)
    assert {rows(figure)[row]: x for x, row in dots(figure.axes[0])} == share
    assert "ranking" in figures.default_kinds(dataset)


def test_of_a_suite_the_medians_and_at_one_intensity_the_shares():
    a_p = {"motion.pulse.a_p": [k * 0.1 * G for k in range(1, 9)]}
    dataset = of_a_suite(**a_p, over={"along": "a_p"})
    medians = dict(zip(dataset["block"].values, dataset["fragility_median"].values[:, -1] / G, strict=True))
    figure = figures.figure("ranking", dataset)
    known = {name: x for name, x in medians.items() if np.isfinite(x)}
    assert rows(figure)[: len(known)] == sorted(known, key=known.get)
    assert {rows(figure)[row]: x for x, row in dots(figure.axes[0])} == pytest.approx(known)
    assert "95 % limits" in figure.get_label()
    assert "ranking" not in figures.default_kinds(dataset)  # `fragility` has a panel for each of four
    at_one = figures.figure("ranking", dataset, Look(select={"a_p": 0.4 * G}))
    assert at_one.axes[0].get_xlabel() == "share that overturns"


def test_medians_beyond_the_suite_are_told_as_extrapolated():
    dataset = of_a_suite(**{"motion.pulse.a_p": [0.1 * G, 0.2 * G, 0.25 * G]}, over={"along": "a_p"})
    assert (dataset["fragility_median"][:, -1] > 0.25 * G).sum() == 1
    assert (
        "1 median beyond the intensities of the suite, extrapolated" in figures.figure("ranking", dataset).get_label()
    )
    whole = of_a_suite(**{"motion.pulse.a_p": [k * 0.1 * G for k in range(1, 7)]}, over={"along": "a_p"})
    assert "extrapolated" not in figures.figure("ranking", whole).get_label()


def test_a_limit_far_beyond_the_suite_leaves_medians_their_room():
    """Of five objects one had a limit of 287 g, and all medians stood in a hundredth of the axis."""
    dataset = of_a_suite(**{"motion.pulse.a_p": [k * 0.1 * G for k in range(1, 7)]}, over={"along": "a_p"})
    axes = figures.figure("ranking", dataset).axes[0]
    assert (axes.get_xscale(), axes.get_xlim()[0]) == ("linear", 0.0)
    dataset["fragility_median_ci_high"][0] = 287.0 * G
    axes = figures.figure("ranking", dataset).axes[0]
    marks = np.concatenate([line.get_xdata() for line in axes.lines if line.get_linestyle() == "None"])
    places = axes.transAxes.inverted().transform(axes.transData.transform(np.column_stack([marks, marks])))[:, 0]
    known = places[np.isfinite(marks)]
    assert axes.get_xlim()[1] > 287.0
    assert known.min() > 0.01
    assert np.ptp(known) > 0.05


def test_bodies_and_alternatives_beyond_the_panels_are_ranked():
    """Four bodies in two ways are eight: of more than six a figure of panels leaves some out."""
    two = {"motion.pulse.shape": ["sine", "ricker"], "motion.pulse.a_p": [k * 0.1 * G for k in range(1, 7)]}
    assert "ranking" in figures.default_kinds(of_a_suite(**two, over={"along": "a_p"}))


def test_alternatives_that_are_alike_are_all_seen():
    """Twice, or three times, the same motion: no mark lies on another, and all are nearer to their row than to the next."""
    vary = study()["vary"]
    for names in (("a", "b"), ("a", "b", "c")):
        dataset = rockcli.run(study(vary={"motion.pulse.T_p": dict.fromkeys(names, 0.5)} | vary))
        axes = figures.figure("ranking", dataset).axes[0]
        marks = [line.get_xydata() for line in axes.lines if line.get_linestyle() == "None"]
        assert len(marks) == len(names)
        heights = np.array([mark[:, 1] for mark in marks])
        assert (np.diff(heights, axis=0) >= 0.1).all()
        assert (np.abs(heights - np.arange(len(SIZES))) < 0.4).all()


def test_alternatives_with_limits_are_in_the_rows_of_their_bodies():
    """Those behind the first stood half a row lower, or in the row of the next body."""
    dataset = of_a_suite(
        over={"along": "a_p"},
        **{
            "motion.pulse.shape": ["sine", "ricker", "half_sine"],
            "motion.pulse.a_p": {"from": 1.0, "to": 20.0, "n": 9, "spacing": "log"},
        },
    )
    figure = figures.figure("ranking", dataset)
    panel = figure.axes[0]
    medians = dataset["fragility_median"].isel(limit_state=-1) / G
    assert int(np.isfinite(medians).sum()) > 2 * len(SIZES)
    for line in panel.lines:
        shape = line.get_label().replace(" ", "_")
        for x, y in line.get_xydata():
            expected = float(medians.sel(block=rows(figure)[round(y)], shape=shape))
            np.testing.assert_allclose(x, expected, rtol=1e-12)
            assert abs(y - round(y)) < 0.35
    bars = np.concatenate([np.array(each.get_segments())[:, 0, 1] for each in panel.collections])
    assert len(bars) == int(np.isfinite(medians).sum())
    assert (abs(bars - bars.round()) < 0.35).all()


def test_more_than_a_page_are_the_worst_and_the_note_says_so():
    widths = {f"w{k}": {"height": 2.0, "width": 0.2 + 0.01 * k} for k in range(70)}
    dataset = rockcli.run(study(vary={"block": widths}))
    figure = figures.figure("ranking", dataset)
    assert len(rows(figure)) == 60
    assert "60 of 70 rows shown, those that overturn most easily" in figure.get_label()
    peaks = dict(zip(dataset["block"].values, dataset["theta_peak_over_alpha"].values, strict=True))
    assert min(peaks[name] for name in rows(figure)) >= max(p for n, p in peaks.items() if n not in rows(figure))
    assert "ranking" in figures.default_kinds(dataset)


@pytest.mark.parametrize(("n", "kind"), [(2, "ranking"), (3, "ranking"), (12, "curve")])
def test_many_bodies_at_few_strengths_are_ranked(n, kind):
    """More curves than a figure has room for are drawn where they have many points."""
    widths = {f"w{k}": {"height": 2.0, "width": 0.2 + 0.02 * k} for k in range(9)}
    a_p = {"from": 0.1 * G, "to": 0.3 * G, "n": n}
    dataset = rockcli.run(study(vary={"block": widths, "motion.pulse.a_p": a_p}))
    assert figures.default_kinds(dataset) == (kind,)


def test_axis_and_note_are_of_the_rows_shown(monkeypatch):
    """Of bodies that are left out the limits took most of the width, and medians beyond the suite were counted."""
    monkeypatch.setattr(ranking, "_MOST_ROWS", 1)
    dataset = of_a_suite(**{"motion.pulse.a_p": [0.1 * G, 0.2 * G, 0.25 * G]}, over={"along": "a_p"})
    figure = figures.figure("ranking", dataset)
    assert rows(figure) == ["slim"]
    assert "beyond" not in figure.get_label()  # that of `tall` is
    high = float(dataset["fragility_median_ci_high"].isel(limit_state=-1).sel(block="slim")) / G
    assert figure.axes[0].get_xlim()[1] == pytest.approx(1.05 * high)


def test_numbers_alone_have_no_ranking():
    dataset = rockcli.run(study(vary={"block.height": [1.0, 2.0, 3.0]}))
    assert "by name" in figures.why_not("ranking", dataset)


def test_long_names_leave_room_for_the_marks_in_a_column_of_a_journal():
    names = {f"a long name of a cabinet in the second storey, room {k}, at the wall": 0.3 + 0.1 * k for k in range(4)}
    bodies = {name: {"height": 2.0, "width": width} for name, width in names.items()}
    figure = rockcli.plot(rockcli.run(study(vary={"block": bodies})), "ranking", width="single")
    figure.draw_without_rendering()
    panel = figure.axes[0]
    assert panel.get_position().width > 0.4
    shown = [label.get_window_extent() for label in panel.get_yticklabels()]
    assert all(box.x0 >= 0.0 for box in shown)
    ends = sorted((box.y0, box.y1) for box in shown)
    assert all(top <= bottom for (_, top), (bottom, _) in pairwise(ends))


@pytest.mark.parametrize("width", [60, 90, 180])
def test_few_bodies_with_many_alternatives_have_room_for_both(width):
    """A figure as high as two rows was lower than its legend, and nothing in it was laid out."""
    bodies = {"a low block": {"R": 1.0, "tan_alpha": 0.3}, "a high block": {"R": 2.0, "tan_alpha": 0.2}}
    case = {"block": {"R": 1.0, "tan_alpha": 0.3}, "motion": {"pulse": {"shape": "sine", "a_p": 4.0, "T_p": 0.5}}}
    vary = {"block": bodies, "motion.pulse.a_p": [3.0, 6.0], "motion.pulse.T_p": [0.4, 0.6, 0.8, 1.0]}
    figure = rockcli.plot(
        rockcli.run({"case": case, "vary": vary, "save": {"histories": False}}), "ranking", width=width
    )
    figure.draw_without_rendering()
    check_words(figure)
    row = figure.axes[0].get_window_extent().height / figure.dpi / 2.4
    assert 0.15 < row < 0.16


@pytest.mark.parametrize("width", [90, 130])
def test_marks_of_alternatives_at_the_side_are_all_seen(width):
    """Eight in a column of .17 in lay on one another."""
    pulses = [3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0]
    figure = rockcli.plot(
        rockcli.run(study(vary=study()["vary"] | {"motion.pulse.a_p": pulses})), "ranking", width=width
    )
    figure.draw_without_rendering()
    strip = figure.axes[1]
    assert [tick.get_text() for tick in strip.get_xticklabels()] == ["overturned"]
    at = sorted({strip.transData.transform((x, 0.0))[0] / figure.dpi for x, _ in dots(strip)})
    assert len(at) == 8
    assert min(right - left for left, right in pairwise(at)) > 0.6 * 2.8 / 72.0  # of a mark of 2.8 points


def test_labels_of_two_panels_stay_off_one_another():
    bodies = {f"{name} as it stands": {"height": h, "width": w} for name, (h, w) in SIZES.items()}
    dataset = rockcli.run(study(vary={"block": bodies, "motion.pulse.T_p": [0.3, 0.5, 0.7]}, over="T_p"))
    figure = rockcli.plot(dataset, "ranking", width=60)
    figure.draw_without_rendering()
    check_words(figure)


def test_slides_without_end_are_told():
    """No mark stands for them: the panel of slides was empty, as if nothing slid."""
    bodies = {name: {"height": h, "width": w, "mu": 0} for name, (h, w) in SIZES.items()}
    pulse = {"shape": "half_sine", "T_p": 0.5, "a_p": 0.3 * G}  # leaves the ground with a velocity
    case = {"block": bodies["low"], "motion": {"pulse": pulse}}
    dataset = rockcli.run(study(case=case, vary={"block": bodies}))
    assert np.isposinf(dataset["slide_peak"].values).all()
    assert "4 of 4 slide on for ever" in figures.figure("ranking", dataset).get_label()
