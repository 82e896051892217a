"""Closed forms drawn over maps of pulses: where they lie, and where they have no business."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.lines import Line2D

import rockcli
from rockcli.plotting import figures
from rockcli.plotting.common.case_settings import case_settings
from rockcli.plotting.kinds import map as outcomes
from rockcli.plotting.page.facts import facts_of
from rockcli.scene.laws.overturning import sine_without_impact
from rockcli.scene.response import NO_UPLIFT, ROCKING

CASE: dict[str, Any] = {
    "block": {"R": 1, "alpha": 0.3},
    "motion": {"pulse": {"shape": "sine", "omega_p_over_p": 2, "a_p_over_g_tan_alpha": 2}},
    "model": "linearized",
    "damping": {"scheme": "restitution", "eta": 0.9},
}
VARY: dict[str, Any] = {
    "motion.pulse.omega_p_over_p": {"from": 0.5, "to": 8, "n": 6},
    "motion.pulse.a_p_over_g_tan_alpha": {"from": 0.5, "to": 12, "n": 7},
}


def mapped(case: dict[str, Any] | None = None, vary: dict[str, Any] | None = None, **more: Any) -> xarray.Dataset:
    study = {"name": "m", "case": CASE | (case or {}), "vary": {**(vary or {}), **VARY}}
    return rockcli.run(study | {"save": {"histories": False, "scalars": ["outcome"]}} | more)


def pulse(**changes: Any) -> dict[str, Any]:
    return {"motion": {"pulse": CASE["motion"]["pulse"] | changes}}


def lines(axes: Axes) -> list[Line2D]:
    """Those of closed forms, without that of uplift."""
    return [line for line in axes.lines if line.get_gid() != outcomes.UPLIFT]


def drawn(axes: Axes) -> tuple[int, int]:
    """Numbers of lines without impact and after one impact."""
    return len(lines(axes)), sum(isinstance(item, ContourSet) for item in axes.collections)


def test_the_lines_are_the_closed_forms_over_g_tan_alpha() -> None:
    axes = figures.figure("map", mapped()).axes[0]
    assert drawn(axes) == (1, 1)
    (line,) = lines(axes)
    x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    np.testing.assert_allclose(y * np.tan(0.3) / 0.3, sine_without_impact(x), rtol=1e-12)
    assert 0.0 < x[0] < 0.01
    assert x[-1] == axes.get_xlim()[1]
    (contour,) = (item for item in axes.collections if isinstance(item, ContourSet))
    points = np.concatenate([path.vertices for path in contour.get_paths()])
    for A in (1.4035653556427826612, 3.4846627333224920275):  # high-precision boundaries at omega_p/p = 3
        there = np.array([3.0, A * 0.3 / np.tan(0.3)])
        beside = points[np.argsort(np.hypot(*(points - there).T))[:2]]
        along = beside[1] - beside[0]
        off = abs(along[0] * (there - beside[0])[1] - along[1] * (there - beside[0])[0]) / np.hypot(*along)
        assert off < 2e-3


@pytest.mark.parametrize(
    ("amplitudes", "signs", "named"),
    [
        ((-12.0, 12.0), [1.0, -1.0], True),
        ((-12.0, -2.0), [-1.0], True),
        ((-0.5, 0.5), [], False),
        ((900, 999), [], False),
    ],
)
def test_pulses_turned_round_have_their_lines_and_legends_name_those_in_the_map(
    amplitudes: tuple[float, float], signs: list[float], *, named: bool
) -> None:
    """Lines were of positive amplitudes alone, and named where none of them is in the map."""
    low, high = amplitudes
    vary = VARY | {"motion.pulse.a_p_over_g_tan_alpha": {"from": low, "to": high, "n": 9}}
    figure = figures.figure("map", rockcli.run({"case": CASE, "vary": vary, "save": {"histories": False}}))
    axes = figure.axes[0]
    assert drawn(axes) == (len(signs), len(signs))
    for line, sign in zip(lines(axes), signs, strict=True):
        x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
        np.testing.assert_allclose(sign * y * np.tan(0.3) / 0.3, sine_without_impact(x), rtol=1e-12)
    lifts = [float(line.get_ydata()[0]) for line in axes.lines if line.get_gid() == outcomes.UPLIFT]
    np.testing.assert_allclose(
        lifts, [s * 0.3 / np.tan(0.3) for s in (1.0, -1.0) if low < s * 0.3 / np.tan(0.3) < high]
    )
    words = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert any("closed form" in word for word in words) == named


def test_maps_of_several_datasets_have_the_lines_of_each() -> None:
    half, floor = pulse(shape="half_sine"), CASE["motion"] | {"through": [{"T": 0.4, "zeta": 0.05}]}
    maps = [mapped(), mapped(half), mapped({"block": {"R": 1, "alpha": 0.6}}), mapped({"motion": floor})]
    panels = rockcli.plot(maps, "map").axes
    for axes, one, expected in zip(panels, maps, [(1, 1), (1, 0), (1, 1), (0, 0)], strict=False):
        (alone, *_) = figures.figure("map", one).axes
        assert drawn(axes) == drawn(alone) == expected
        for line, own in zip(lines(axes), lines(alone), strict=True):
            np.testing.assert_array_equal(line.get_xydata(), own.get_xydata())


def test_the_line_of_uplift_crosses_the_whole_map() -> None:
    axes = figures.figure("map", mapped()).axes[0]
    (line,) = (line for line in axes.lines if line.get_gid() == outcomes.UPLIFT)
    assert (line.get_xdata()[0], line.get_xdata()[-1]) == axes.get_xlim()
    np.testing.assert_allclose(line.get_ydata(), 0.3 / np.tan(0.3))  # linearized, of alpha = .3


@pytest.mark.parametrize("settings", [False, True])
def test_below_floors_no_line_says_where_the_body_lifts(*, settings: bool) -> None:
    """The amplitude is the ground's, what lifts the body arrives through the floor: the case's, or one by name."""
    floor: dict[str, Any] = {"through": [{"T": 0.4, "zeta": 0.05}]}
    vary: dict[str, Any] = {
        "case": {"floor": {"motion": floor}, "stiff": {"motion.through": [{"f": 50, "zeta": 0.05}]}}
    }
    case = {"motion": CASE["motion"] | ({} if settings else floor)}
    figure = figures.figure("map", mapped(case, vary if settings else None))
    assert all(not axes.lines for axes in figure.axes)
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert not [word for word in words if "uplift," in word or "closed form" in word]


def test_a_flexible_column_has_no_line_of_uplift() -> None:
    """It lifts below g tan(alpha) where it is pushed suddenly, and does so here."""
    column = {"block": {"height": 30, "width": 5}, "column": {"E": 3e9, "rho": 1900, "zeta": 0.02}, "model": "flexible"}
    dataset = mapped(column | {"damping": "restitution"}, {"model": ["rigid", "flexible"]})
    low = dataset["outcome"].isel(a_p_over_g_tan_alpha=0)
    assert float(low["a_p_over_g_tan_alpha"]) == 0.5
    assert low.sel(model="flexible").values.max() > 0 == low.sel(model="rigid").values.max()
    rigid, flexible = figures.figure("map", dataset).axes[:2]
    there = [any(line.get_gid() == outcomes.UPLIFT for line in axes.lines) for axes in (rigid, flexible)]
    assert there == [True, False]


def test_they_agree_with_the_outcomes_of_a_map() -> None:
    """Beside the solid line and inside the dashed one the solver says what the figure says."""
    dataset = mapped()
    outcome = dataset["outcome"]
    at = outcome.sel(omega_p_over_p=5.0)
    A = at["a_p_over_g_tan_alpha"].values * np.tan(0.3) / 0.3
    np.testing.assert_array_equal(at.values == 2, sine_without_impact(np.array(5.0)) < A)


def test_every_map_of_a_figure_has_its_own() -> None:
    figure = figures.figure("map", mapped(vary={"model": ["linearized", "rigid", "3"]}))
    assert [drawn(axes) for axes in figure.axes[:3]] == [(1, 1), (1, 1), (0, 0)]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[-3:-1] == ["closed form (linearized): no impact", "closed form (linearized): one impact"]


@pytest.mark.parametrize(
    ("changes", "lines"),
    [
        (pulse(shape="half_sine"), (1, 0)),
        (pulse(shape="rectangular"), (1, 0)),
        (pulse(shape="cosine"), (0, 0)),
        (pulse(cycles=2), (0, 0)),
        (pulse(cycles=1), (1, 1)),
        ({"model": "2"}, (0, 0)),
        ({"damping": "none"}, (1, 1)),
        ({"damping": "dashpot"}, (0, 0)),
        ({"initial": {"theta": 0.01}}, (0, 0)),
        ({"motion": CASE["motion"] | {"duration": 3}}, (0, 0)),
        ({"block": {"h": 2, "b": [0.3, 0.4]}}, (0, 0)),
    ],
)
def test_they_are_drawn_only_where_they_hold(changes: dict[str, Any], lines: tuple[int, int]) -> None:
    dataset = mapped(changes)
    assert drawn(figures.figure("map", dataset).axes[0]) == lines


def test_nothing_is_drawn_over_other_planes_or_without_a_study() -> None:
    plane = {"motion.pulse.T_p": {"from": 1, "to": 4, "n": 6}, "motion.pulse.a_p": {"from": 1, "to": 9, "n": 7}}
    assert drawn(figures.figure("map", _over(plane)).axes[0]) == (0, 0)
    dataset = mapped()
    del dataset.attrs["case"]
    assert drawn(figures.figure("map", dataset).axes[0]) == (0, 0)


def _over(plane: dict[str, Any]) -> xarray.Dataset:
    return rockcli.run({"name": "m", "case": CASE, "vary": plane, "save": {"histories": False, "scalars": ["outcome"]}})


@pytest.mark.parametrize("models", [["linearized"], ["linearized", "rigid"]])
def test_the_legend_stays_on_the_page(models: list[str]) -> None:
    figure = figures.figure("map", mapped(vary={"model": models}))
    figure.draw_without_rendering()
    box = figure.legends[0].get_window_extent()
    assert box.x0 >= figure.bbox.x0
    assert box.x1 <= figure.bbox.x1
    assert not box.overlaps(figure.axes[0].xaxis.label.get_window_extent())


def test_a_body_that_rolls_has_none() -> None:
    """Beyond its two edges it touches others, and overturns elsewhere; on its toes it is the block on two edges."""
    foot = [[-0.2, 0.01], [-0.1, 0.0], [0.1, 0.0], [0.2, 0.01], [0.2, 2.0], [-0.2, 2.0]]
    case = {"block": {"outline": foot}, "model": "rigid", "damping": "restitution"}
    panels = figures.figure("map", mapped(case, {"block.stands": ["outline", "toes"]})).axes[:2]
    assert [drawn(axes) for axes in panels] == [(0, 0), (1, 1)]
    box = {"outline": [[-0.1, 0.0], [0.1, 0.0], [0.1, 2.0], [-0.1, 2.0]]}
    assert drawn(figures.figure("map", mapped(case | {"block": box})).axes[0]) == (1, 1)


def test_a_refined_map_is_not_shaded_by_the_peaks_beside_its_boundaries() -> None:
    save = {"scalars": ["outcome", "theta_peak_over_alpha"]}
    refined, full = (figures.figure("map", mapped(save=save, refine=refine)) for refine in (True, False))
    assert len(full.axes) == len(refined.axes) + 1  # the colour bar
    assert "rocking" in [text.get_text() for text in refined.legends[0].get_texts()]


def test_the_settings_of_the_case_are_read_from_the_dataset() -> None:
    settings = case_settings(mapped())
    assert settings["motion.pulse.shape"] == "sine"
    assert settings["damping.eta"] == "0.9"
    assert settings["model"] == "linearized"
    assert "name" not in settings


def test_bodies_lift_by_the_gravity_of_their_own_case() -> None:
    """Accelerations are in g of 9.81 m/s² where g is varied; the outcomes of the map say where the line is."""
    pulse = {"shape": "sine", "a_p": 1.0, "T_p": 1.0}
    case: dict[str, Any] = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}
    amplitudes = {"motion.pulse.a_p": {"from": 0.1, "to": 2.6, "n": 26}}
    vary = {"g": {"from": 1.65, "to": 9.85, "n": 9}} | amplitudes
    data = rockcli.run({"case": case, "vary": vary, "save": {"histories": False}})
    (line,) = (line for line in rockcli.plot(data, "map").axes[0].lines if line.get_gid() == "uplift")
    level = np.interp(data["g"].values, line.get_xdata(), line.get_ydata()) * 9.81
    still = data["outcome"].transpose("g", "motion_pulse_a_p").values == NO_UPLIFT
    amplitude = data["motion_pulse_a_p"].values
    assert (np.max(np.where(still, amplitude, 0.0), axis=1) <= level).all()
    assert (np.min(np.where(still, np.inf, amplitude), axis=1) > level).all()
    facts = {fact.what: fact.value for fact in facts_of(data)}
    assert facts["lifts from"] == f"{0.2 * 1.65 / 9.81:.3g} to {0.2 * 9.85 / 9.81:.3g} g"
    few = {"g": [1.62, 9.81], "motion.pulse.T_p": [0.5, 1.0, 2.0]}
    suite = {"case": case, "vary": few | amplitudes, "over": "T_p", "save": {"histories": False}}
    for axes, g in zip(rockcli.plot(rockcli.run(suite), "ida").axes, (1.62, 9.81), strict=True):
        levels = [float(line.get_ydata()[0]) for line in axes.lines if np.ptp(line.get_ydata()) == 0.0]
        assert levels == pytest.approx([0.2 * g / 9.81])
    pulse["a_p"] = 0.4
    figure = rockcli.plot(rockcli.run({"case": case, "vary": {"g": [1.62]}}), "histories")
    marks = [text.xy[1] for axes in figure.axes for text in axes.texts if "tan" in text.get_text()]
    assert marks == pytest.approx([0.2 * 1.62 / 9.81])


def test_bodies_of_settings_and_datasets_lift_by_their_own_gravity(tmp_path: Path) -> None:
    """On the moon a block lifts at 0.324 m/s², on the earth at 1.962, however the study says where it is."""
    pulse = {"shape": "sine", "a_p": 1.9, "T_p": 1.0}
    case: dict[str, Any] = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}
    over = {"motion.pulse.a_p": {"from": 0.1, "to": 2.6, "n": 6}, "motion.pulse.T_p": {"from": 0.5, "to": 1.3, "n": 5}}
    settings = {"case": {"earth": {"g": 9.81}, "moon": {"g": 1.62}}}
    symbol = {"let": {"there": 9.81}, "case": case | {"g": "there"}}
    (tmp_path / "table.csv").write_text("name,g\nearth,9.81\nmoon,1.62\n")
    (tmp_path / "study.yaml").write_text(json.dumps({"name": "t", "case": case, "vary": {"case": "table.csv"} | over}))
    several = [
        rockcli.run({"case": case, "vary": settings | over, "save": {"histories": False}}),
        rockcli.run(symbol | {"vary": {"let.there": [9.81, 1.62]} | over, "save": {"histories": False}}),
        rockcli.run(tmp_path / "study.yaml"),
    ]
    for data in several:
        levels = [a.lines[-1].get_ydata()[0] for a in rockcli.plot(data, "map").axes[:2]]
        assert levels == pytest.approx([0.2, 0.2 * 1.62 / 9.81])
        lifts = data["pga"].where(data["outcome"] > 0).min(data["outcome"].dims[1:])
        assert (lifts.values > np.multiply(levels, 9.81)).all()
        assert {fact.what: fact.value for fact in facts_of(data)}["lifts from"] == "0.033 to 0.2 g"
    foot = rockcli.run({"case": case | {"g": "5.315*ft/s**2"}, "vary": over, "save": {"histories": False}})
    assert rockcli.plot(foot, "map").axes[0].lines[-1].get_ydata()[0] == pytest.approx(0.2)
    suite = rockcli.run({"case": case, "vary": settings | over, "over": "T_p", "save": {"histories": False}})
    across = [line for a in rockcli.plot(suite, "ida").axes for line in a.lines if list(line.get_xdata()) == [0, 1]]
    assert [line.get_ydata()[0] for line in across] == pytest.approx([0.2, 0.2 * 1.62 / 9.81])
    maps = [
        rockcli.run({"name": f"g{g:.0f}", "case": case | {"g": g}, "vary": over, "save": {"histories": False}})
        for g in (9.81, 1.62)
    ]
    for several, unit in ((maps, (9.81, 9.81)), (maps[:1], (9.81,)), (maps[1:], (1.62,))):  # one axis, one unit
        for axes, each, g in zip(rockcli.plot(several, "map").axes, several, unit, strict=False):
            (line,) = (line for line in axes.lines if line.get_gid() == "uplift")
            assert line.get_ydata()[0] * g == pytest.approx(0.2 * json.loads(each.attrs["case"])["g"])
            assert axes.get_ylim()[1] * g == pytest.approx(2.6 + 0.25)
    places = [rockcli.run({"name": f"g{g:.0f}", "case": case | {"g": g}}) for g in (9.81, 1.62)]
    for shown, expected in ((places, []), (places[:1], [0.2]), (places[1:], [0.2])):
        drawn = rockcli.plot(shown, "histories")
        assert [t.xy[1] for a in drawn.axes for t in a.texts if "tan" in t.get_text()] == pytest.approx(expected)


@pytest.mark.parametrize(("b", "to_right"), [([0.3, 0.2], 0.3), ([0.2, 0.3], 0.2)])
def test_bodies_with_two_edges_lift_about_the_one_they_are_pushed_over(b: list[float], to_right: float) -> None:
    """Ground that moves to the right alone takes the weight to the left edge, and to the left alone to the other."""
    pulse = {"shape": "half_sine", "a_p": 2.4525, "T_p": 1.0}
    case: dict[str, Any] = {"block": {"h": 1.0, "b": b}, "motion": {"pulse": pulse}}
    over = {"motion.pulse.a_p": {"from": 0.5, "to": 5.0, "n": 19}, "motion.pulse.T_p": {"from": 0.5, "to": 1.5, "n": 5}}
    data = rockcli.run({"case": case, "vary": over, "save": {"histories": False}})
    still = (data["outcome"] == NO_UPLIFT).all("T_p")
    np.testing.assert_array_equal(still, data["motion_pulse_a_p"] < to_right * 9.81)
    both = over | {"motion.pulse.a_p": {"from": -5.0, "to": 5.0, "n": 20}}
    for varied, levels in ((over, [to_right]), (both, [to_right, to_right - 0.5])):
        data = rockcli.run({"case": case, "vary": varied, "save": {"histories": False}})
        lines = [line for line in rockcli.plot(data, "map").axes[0].lines if line.get_gid() == "uplift"]
        assert [line.get_ydata()[0] for line in lines] == pytest.approx(levels)
    suite = rockcli.run({"case": case, "vary": over, "over": "T_p", "save": {"histories": False}})
    figure = rockcli.plot(suite, "ida")
    assert [to_right] in [pytest.approx([line.get_ydata()[0]]) for line in figure.axes[0].lines]
    assert "uplift about either edge" in [text.get_text() for text in figure.legends[0].get_texts()]
    one = rockcli.run({"case": case})
    assert float(one["pga_uplift"]) == pytest.approx(to_right * 9.81)
    (said,) = (fact for fact in facts_of(one) if fact.what == "lifts from")
    assert (said.value, said.sentence) == ("0.2 g", "ground acceleration, g tan(alpha) of the weaker edge")
    marks = {text.get_text(): text.xy[1] for axes in rockcli.plot(one, "histories").axes for text in axes.texts}
    left, right = (rf"g\,\tan\alpha_{{\mathrm{{{side}}}}}$" for side in ("left", "right"))
    assert marks[f"${left}"] == pytest.approx(to_right)
    assert marks[f"$-{right}"] == pytest.approx(to_right - 0.5)


def test_maps_of_several_datasets_have_uplift_of_their_own_edges_and_damping() -> None:
    """Beside a block that lifts at .2 g one whose left edge, and one whose FEMA-356, asks for .3 g."""
    pulse = {"shape": "half_sine", "a_p": 2.0, "T_p": 1.0}
    over = {"motion.pulse.a_p": {"from": 0.5, "to": 5.0, "n": 19}, "motion.pulse.T_p": {"from": 0.5, "to": 1.5, "n": 5}}
    case = {"block": {"h": 1.0, "b": 0.2}, "motion": {"pulse": pulse}}
    two, heavy = {"block": {"h": 1.0, "b": [0.3, 0.2]}}, {"damping": {"scheme": "fema356", "W_over_Mg": 1.5}}
    plain, edges, fema = (
        rockcli.run({"name": f"n{len(more)}{i}", "case": case | more, "vary": over, "save": {"histories": False}})
        for i, more in enumerate(({}, two, heavy))
    )
    for sets, levels in (([plain, edges], [0.2, 0.3]), ([fema, plain], [0.3, 0.2]), ([edges, fema], [0.3, 0.3])):
        lines = [line for axes in rockcli.plot(sets, "map").axes for line in axes.lines if line.get_gid() == "uplift"]
        assert [line.get_ydata()[0] for line in lines] == pytest.approx(levels)


@pytest.mark.parametrize("x", ["T_p", "W_over_Mg"])
def test_fema_356_has_its_own_line_over_g_tan_alpha(x: str) -> None:
    """The procedure leaves at rest what lies below W/Mg, to the next point of the map."""
    pulse = {"shape": "half_sine", "a_p_over_g_tan_alpha": 2.0, "T_p": 1.0}
    five = {"T_p": {"from": 0.5, "to": 1.5, "n": 5}, "W_over_Mg": {"from": 0.8, "to": 2.0, "n": 5}}[x]
    across = f"{'motion.pulse' if x == 'T_p' else 'damping'}.{x}"
    damping = {"scheme": "fema356", "W_over_Mg": 1.5}
    case = {"block": {"h": 1.0, "b": 0.2}, "motion": {"pulse": pulse}, "damping": damping}
    over = {"motion.pulse.a_p_over_g_tan_alpha": {"from": 0.5, "to": 3.0, "n": 26}}
    data = rockcli.run({"case": case, "vary": over | {across: five}, "save": {"histories": False}})
    (line,) = [one for one in rockcli.plot(data, "map").axes[0].lines if one.get_gid() == "uplift"]
    levels = np.asarray(line.get_ydata())[1:-1]
    still = (data["outcome"] == 0).transpose("a_p_over_g_tan_alpha", x).values
    lowest = np.where(still, data["a_p_over_g_tan_alpha"].values[:, None], 0.0).max(axis=0)
    np.testing.assert_allclose(levels, data["W_over_Mg"].values if x == "W_over_Mg" else 1.5)
    assert ((lowest > levels - 0.1) & (lowest < levels + 0.1)).all()


VERTICAL = {"pulse": {"shape": "sine", "a_p": 0.5 * 9.81, "T_p": 0.3}}


@pytest.mark.parametrize(
    ("motion", "vary", "said"),
    [
        ({"vertical": VERTICAL}, {}, "g tan(alpha) without vertical motion"),
        ({}, {"case": {"level": {}, "shaken": {"motion.vertical": VERTICAL}}}, "g tan(alpha) without vertical motion"),
        ({}, {"block.mu": [0.1, 1.0]}, "g tan(alpha) without slip"),
        ({"vertical": VERTICAL}, {"block.mu": [0.1, 1.0]}, "g tan(alpha) without vertical motion and slip"),
        ({}, {"model": ["rigid", "linearized"]}, "g tan(alpha) or g alpha"),
        ({}, {"model": ["rigid"]}, "g tan(alpha)"),
    ],
)
def test_what_changes_where_a_body_lifts_is_told_beside_g_tan_alpha(motion: Any, vary: Any, said: str) -> None:
    """A body of tan(alpha) = 0.2 under 0.15 g lifts where the ground falls at 0.5 g, and with mu = 0.1 not at all."""
    pulse = {"shape": "sine", "a_p": 1.0, "T_p": 1.0}
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse, **motion}}
    plane = {"motion.pulse.T_p": {"from": 0.5, "to": 2, "n": 6}, "motion.pulse.a_p": {"from": 1, "to": 4, "n": 7}}
    data = rockcli.run({"case": case, "vary": vary | plane, "save": {"histories": False}})
    (fact,) = (fact for fact in facts_of(data) if fact.what == "lifts from")
    assert fact.sentence == f"ground acceleration, {said}"
    legend = [text.get_text() for text in rockcli.plot(data, "map").legends[0].get_texts()]
    (words,) = (text for text in legend if text.startswith("uplift"))
    assert ("vertical motion" in words, "slip" in words) == ("vertical motion" in said, "slip" in said)
    assert (r"g\,\tan\alpha" in words, r"g\,\alpha" in words) == ("tan(alpha)" in said, "g alpha" in said)
    if motion:
        assert (data["outcome"].sel(motion_pulse_a_p=1.5) == ROCKING).any()


@pytest.mark.parametrize("key", ["a_p", "a_p_over_g_tan_alpha"])
def test_linearized_blocks_lift_at_g_alpha(key: str) -> None:
    """A block of alpha = 0.8 rocks from .8 g on, and g tan(alpha) is 1.03 g; the outcomes say where the line is."""
    pulse = {"shape": "half_sine", key: 1.0, "T_p": 2.0}
    amplitudes = np.linspace(0.53, 1.43, 19) * (9.81 if key == "a_p" else 1.0 / np.tan(0.8))
    vary = {f"motion.pulse.{key}": amplitudes.tolist(), "motion.pulse.T_p": {"from": 0.5, "to": 2.0, "n": 7}}
    case = {"block": {"R": 2.0, "alpha": 0.8}, "motion": {"pulse": pulse}, "model": "linearized"}
    data = rockcli.run({"case": case, "vary": vary, "save": {"histories": False}})
    figure = rockcli.plot(data, "map")
    (line,) = (line for line in figure.axes[0].lines if line.get_gid() == "uplift")
    still = (data["outcome"] == NO_UPLIFT).all("T_p").values
    shown = 9.81 if key == "a_p" else 1.0
    levels = np.asarray(line.get_ydata())
    assert np.ptp(levels) == 0.0
    assert amplitudes[still].max() / shown <= levels[0] < amplitudes[~still].min() / shown
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert r"uplift, $g\,\alpha$" in words
    (fact,) = (fact for fact in facts_of(data) if fact.what == "lifts from")
    assert (fact.value, fact.sentence) == ("0.8 g", "ground acceleration, g alpha")
