"""What the figures show of a dataset: sides, times, motions, jumps, marks, units and the orientation of maps."""

from __future__ import annotations

import json
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.mathtext import MathTextParser
from scipy.integrate import quad

import rockcli
from rockcli.plotting import figures
from rockcli.plotting.common import ground
from rockcli.plotting.common.case_settings import may_vary
from rockcli.plotting.common.labels import axis_label, coordinate_label
from rockcli.plotting.common.response import edges, response_of, window
from rockcli.plotting.common.selection import overlaid
from rockcli.plotting.kinds import map as outcomes
from rockcli.plotting.page.facts import facts_of
from rockcli.scene.variables import VARIABLES

ASYMMETRIC = {"name": "a", "case": {"block": {"h": 1.05, "b": [0.2, 0.35]}}, "vary": {"initial.theta": [-0.15, 0.1]}}
TIME = np.round(np.arange(0, 150, 0.01), 2)


def test_matplotlib_can_set_the_symbol_of_every_variable():
    for row in VARIABLES.values():
        MathTextParser("path").parse(row.symbol)


def axis(name: str, values: object, path: str = "", unit: str = "1") -> xarray.DataArray:
    array = np.asarray(values)
    numeric = array.dtype.kind == "f"
    attrs = {"long_name": "words", "path": path or name} | ({"units": unit} if numeric else {})
    return xarray.DataArray(array if numeric else array.astype(object), dims=name, attrs=attrs)


def shaken(a_g: list[np.ndarray], theta: list[np.ndarray], **more: object) -> xarray.Dataset:
    """Cases of an axis `case` with a ground motion [m/s^2] and a rotation each."""
    n = len(theta)
    data = {
        "theta": (("case", "time"), np.stack(theta)),
        "theta_dot": (("case", "time"), np.gradient(np.stack(theta), TIME, axis=1)),
        "a_g": (("case", "time"), np.stack(a_g)),
        "outcome": ("case", np.ones(n, dtype=np.int8)),
    } | more
    coords = {"case": axis("case", [f"number {i}" for i in range(n)]), "time": TIME, "alpha": 0.2, "p": 2.0}
    return xarray.Dataset(data, coords, {"title": "Cases", "axes": "case"})


def swing(start: float, end: float, size: float = 0.1) -> np.ndarray:
    return np.where((start < TIME) & (end > TIME), size * np.sin(8.0 * (TIME - start)), 0.0)


def noise(seed: int, size: float = 3.0) -> np.ndarray:
    return size * np.random.default_rng(seed).standard_normal(len(TIME)) * np.exp(-(((TIME - 8.0) / 4.0) ** 2))


def traces(axes: Axes) -> list[np.ndarray]:
    """Drawn curves over all times."""
    return [np.asarray(line.get_ydata(), dtype=float) for line in axes.lines if len(line.get_xdata()) >= len(TIME)]


def labelled(figure: Figure, label: str) -> list[Axes]:
    return [axes for axes in figure.axes if axes.get_ylabel() == label]


@pytest.fixture(scope="module")
def asymmetric() -> xarray.Dataset:
    return rockcli.run(ASYMMETRIC)


def test_edges_of_asymmetric_bodies_are_in_the_dataset(asymmetric: xarray.Dataset) -> None:
    left, right = np.arctan(0.2 / 1.05), np.arctan(0.35 / 1.05)
    assert float(asymmetric["alpha_left"]) == pytest.approx(left, rel=1e-14)
    assert float(asymmetric["alpha_right"]) == pytest.approx(right, rel=1e-14)
    assert float(asymmetric["R_right"]) == pytest.approx(np.hypot(0.35, 1.05), rel=1e-14)
    assert float(asymmetric["p_left"]) == float(asymmetric["p"])
    assert float(asymmetric["eta_left"]) == float(asymmetric["eta"]) != float(asymmetric["eta_right"])
    assert asymmetric["alpha_left"].dims == ()
    assert "alpha_left" in asymmetric.coords
    symmetric = rockcli.run(ASYMMETRIC | {"case": {"block": {"h": 1.05, "b": 0.2}}})
    assert not [name for name in symmetric.coords if str(name).endswith(("_left", "_right"))]
    sizes = rockcli.run(
        {"name": "a", "case": ASYMMETRIC["case"] | {"initial": {"theta": 0.1}}, "vary": {"block.h": [1.05, 2.1]}}
    )
    assert sizes["alpha_right"].dims == ("h",)


def test_rotations_are_over_the_alpha_of_their_side(asymmetric: xarray.Dataset) -> None:
    alpha, p = edges(asymmetric, "alpha", (0,)), edges(asymmetric, "p", (0,))
    assert response_of(asymmetric, (0,)).ratio[0] == pytest.approx(-0.15 / alpha[0], rel=1e-14)
    assert response_of(asymmetric, (1,)).ratio[0] == pytest.approx(0.1 / alpha[1], rel=1e-14)
    peak = float(asymmetric["theta_peak_over_alpha"][0])
    assert np.nanmax(np.abs(response_of(asymmetric, (0,)).ratio)) == pytest.approx(peak, rel=1e-3)
    portrait = figures.figure("phase", asymmetric).axes[0]
    dashed = [line for line in portrait.lines if line.is_dashed()]
    tops = {
        side: max(abs(line.get_ydata()[0]) for line in dashed if np.sign(line.get_xdata()[-1]) == side)
        for side in (-1, 1)
    }
    for side, a in ((-1, alpha[0]), (1, alpha[1])):
        assert tops[side] == pytest.approx(2.0 * np.sin(0.5 * a) / a, rel=1e-12)
    response = response_of(asymmetric, (0,))
    first = np.flatnonzero(np.diff(response.time) == 0.0)[0]  # from the left edge to the right one
    before, after = response.theta_dot[first : first + 2]
    assert response.rate[first] == pytest.approx(before / (p[0] * alpha[0]), rel=1e-14)
    assert response.rate[first + 1] == pytest.approx(after / (p[1] * alpha[1]), rel=1e-14)


def test_the_peak_of_a_body_on_two_edges_is_that_over_alpha() -> None:
    """Its largest rotation is to the right, 1.13 s after the start, the largest |theta|/alpha to the left."""
    case = {
        "block": ASYMMETRIC["case"]["block"],
        "motion": {"pulse": {"shape": "sine", "a_p": 7.2, "f_p": 2, "cycles": 3}},
    }
    dataset = rockcli.run({"name": "a", "case": case})
    assert float(dataset["theta_peak"]) > float(dataset["theta_peak_left"]) > 0.0
    most = float(dataset["theta_peak_over_alpha"])
    assert most == pytest.approx(float(dataset["theta_peak_left"] / dataset["alpha_left"]))
    at = float(dataset["time"].values[np.nanargmin(dataset["theta"].values)])
    figure = figures.figure("histories", dataset)
    assert rf"peak $|\theta|/\alpha$ = {most:.4g} at {at:.3g} s" in figure.get_label()
    rings = [line.get_xydata() for axes in figure.axes for line in axes.lines if line.get_markerfacecolor() == "none"]
    assert np.concatenate(rings) == pytest.approx(np.array([[at, -most]]))


def test_crosses_are_where_the_curves_pass_the_unstable_equilibrium() -> None:
    """That of corotational model 2 is at 1.091 alpha of .4; its cross was at alpha, beside the curve."""
    study = {
        "name": "m",
        "case": {
            "block": {"R": 1.0, "alpha": 0.4},
            "motion": {"pulse": {"shape": "sine", "a_p": 12.0, "f_p": 1.0}},
            "geometry": "corotational",
        },
        "vary": {"model": ["rigid", "2"]},
        "compare_to": {"model": "rigid"},
    }
    dataset = rockcli.run(study)
    time, theta = dataset["time"].values, dataset["theta"].values / 0.4
    expected = [[at, np.interp(at, time, one)] for at, one in zip(dataset["t_overturn"].values, theta, strict=True)]
    assert np.abs(expected) == pytest.approx(np.array([[expected[0][0], 1.0], [expected[1][0], 1.0913]]), abs=3e-3)
    figure = figures.figure("histories", dataset)
    crosses = [line.get_xydata()[0] for axes in figure.axes for line in axes.lines if line.get_marker() == "x"]
    assert np.array(crosses) == pytest.approx(np.array(expected[::-1]), rel=1e-9)


def test_only_the_response_is_shown() -> None:
    late = shaken([noise(0)], [swing(60.0, 75.0)])
    seen = window(late, [(0,)])
    assert 55.0 < seen.start < 60.0
    assert 75.0 < seen.end < 80.0
    figure = figures.figure("histories", late)
    assert figure.axes[0].get_xlim() == (seen.start, seen.end)
    assert "of 150 s" in figure.get_suptitle()
    early = window(shaken([noise(0)], [swing(3.0, 18.0)]), [(0,)])
    assert early.start == 0.0
    assert early.end < 20.0
    comparable = window(shaken([noise(0)], [swing(10.0, 120.0)]), [(0,)])
    assert (comparable.start, comparable.end, comparable.note) == (0.0, 150.0 - 0.01, "")
    still = window(shaken([noise(0)], [0.0 * TIME]), [(0,)])
    assert (still.start, still.end) == (0.0, 150.0 - 0.01)


def test_a_fall_is_not_followed() -> None:
    theta = np.where(TIME < 2.0, 0.0, 0.05 * (TIME - 2.0) ** 2)
    theta = np.where(TIME < 8.0, theta, theta[TIME == 8.0])  # lies on the ground
    fallen = shaken([noise(0)], [theta], outcome=("case", np.array([2], dtype=np.int8)))
    leaves = 2.0 + np.sqrt(1.3 * 0.2 / 0.05)
    seen = window(fallen, [(0,)])
    assert leaves < seen.end < leaves + 0.5
    other = shaken([noise(0)] * 2, [theta, swing(1.0, 100.0)], outcome=("case", np.array([2, 1], dtype=np.int8)))
    assert window(other, [(0,), (1,)]).end > 100.0


def test_swings_before_a_fall_are_whole() -> None:
    """What others need room for cuts the fall, not the swings from which the body came back."""
    small, falls = swing(1.0, 9.0, 0.01), swing(1.0, 3.2, 0.02)
    falls = falls + np.where((TIME > 4.0) & (TIME < 5.0), 0.14 * np.sin(np.pi * (TIME - 4.0)), 0.0)
    falls = falls - np.where(TIME > 5.0, np.minimum(TIME - 5.0, 1.5), 0.0)
    dataset = shaken([noise(1)] * 2, [small, falls], outcome=("case", np.array([1, 3], dtype=np.int8)))
    (panel,) = labelled(figures.figure("histories", dataset), r"$\theta/\alpha$")
    low, high = panel.get_ylim()
    assert high > 0.7
    assert -2.0 < low < -0.7


def test_the_largest_of_those_that_come_back_is_shown() -> None:
    """Of fifteen, nine of which hardly move: spread over their peaks every second one was, and this was not."""
    peaks = np.array([0.0] * 9 + [0.01, 0.02, 0.03, 0.04, 0.5, np.inf])
    swings = [swing(1.0, 9.0, 0.001 * (i + 1)) for i in range(15)]
    fates = np.where(np.isinf(peaks), 3, 1).astype(np.int8)
    more = {"theta_peak_over_alpha": ("case", peaks), "outcome": ("case", fates)}
    (legend,) = figures.figure("histories", shaken([noise(1)] * 15, swings, **more)).legends
    told = [text.get_text() for text in legend.get_texts()]
    assert len(told) == 8
    assert {"number 0", "number 13", "number 14 (overturns)"} <= set(told)


def test_a_motion_is_drawn_once_however_it_is_scaled() -> None:
    record = noise(1)
    cut = np.where(TIME < 9.0, 2.0 * record, np.nan)  # overturned early
    one = {"ground_motion": ("case", np.zeros(3, dtype=np.int32))}
    dataset = shaken([cut, record, 0.5 * record], [swing(5.0, 18.0)] * 3, **one)
    same = ground.motions(dataset, [(0,), (1,), (2,)])
    assert [motion.cases for motion in same] == [[0, 1, 2]]
    assert same[0].scales == pytest.approx([2.0, 1.0, 0.5])
    assert np.isfinite(same[0].horizontal).all()
    figure = figures.figure("histories", dataset)
    trace = labelled(figure, r"$a_g\,/\,\max|a_g|$")[0].lines[0]
    assert trace.get_color() == "#333333"
    assert np.abs(trace.get_ydata()).max() == pytest.approx(1.0)


def test_records_do_not_hide_each_other() -> None:
    thetas = [swing(5.0, 18.0, 0.02 * (i + 1)) for i in range(5)]
    few = figures.figure("histories", shaken([noise(i) for i in range(3)], thetas[:3]))
    assert [axes.get_title(loc="left") for axes in few.axes[:3]] == ["number 0", "number 1", "number 2"]
    assert len({axes.get_ylim() for axes in few.axes[:3]}) == 1
    many = figures.figure("histories", shaken([noise(i) for i in range(5)], thetas))
    drawn = traces(many.axes[0])
    assert len(drawn) == 5
    assert all(one.min() > other.max() for one, other in pairwise(drawn))


def test_impacts_are_jumps() -> None:
    dataset = rockcli.run({"name": "b", "case": {"block": {"R": 1.0, "alpha": 0.25}, "initial": {"theta": 0.15}}})
    response = response_of(dataset, ())
    jumps = np.flatnonzero(np.diff(response.time) == 0.0)
    known = np.isfinite(dataset["t_impact"].values)
    assert len(jumps) >= known.sum()
    np.testing.assert_array_equal(response.ratio[jumps[:5]], 0.0)
    figure = figures.figure("histories", dataset)
    rate = figure.axes[-1].lines[0]
    for i in range(3):
        at = np.flatnonzero(rate.get_xdata() == float(dataset["t_impact"][i]))
        assert set(rate.get_ydata()[at]) >= {
            float(dataset["theta_dot_before"][i]),
            float(dataset["theta_dot_after"][i]),
        }
    portrait = response_of(dataset, (), apart=True)
    assert np.isnan(portrait.rate).sum() == known.sum()


def test_a_body_that_rolls_strikes_where_its_facets_are() -> None:
    """Impacts lie on the curve, at the tilts of the facets; the separatrix is that of a body on two edges."""
    foot = [[-0.25, 0.05], [-0.15, 0.003], [-0.1, 0.0], [0.1, 0.0], [0.15, 0.003], [0.25, 0.05], [0.25, 2], [-0.25, 2]]
    motion = {"pulse": {"shape": "sine", "omega_p_over_p": 5, "a_p_over_g_tan_alpha": 3}, "duration": 4}
    case = {"block": {"outline": foot}, "motion": motion}
    dataset = rockcli.run({"name": "r", "case": case, "vary": {"block.stands": ["outline", "toes"]}})
    (panel,) = labelled(figures.figure("histories", dataset), r"$\theta/\alpha$")
    marked = next(line for line in panel.lines if line.get_marker() == "o")
    tilt = np.arctan(0.003 / 0.05) / float(dataset["alpha"])
    struck = np.abs(np.asarray(marked.get_ydata(), dtype=float))
    assert (struck < 1e-9).any()
    assert (struck > 0.5).any()
    np.testing.assert_allclose(struck[struck > 0.1], tilt, rtol=1e-3)
    rolling, turning = figures.figure("phase", dataset).axes
    dashed = [sum(line.is_dashed() for line in axes.lines) for axes in (rolling, turning)]
    assert dashed == [0, 4]


def test_the_separatrix_is_that_of_the_model() -> None:
    """Energy of model 2, whose base spring keeps its moment and whose weight pulls at h, by quadrature."""
    alpha, turned = 0.6, 0.3
    case = {"block": {"R": 1.0, "alpha": alpha}, "geometry": "corotational", "initial": {"theta": "0.9*alpha"}}
    panels = figures.figure("phase", rockcli.run({"case": case, "vary": {"model": [2, "linearized", "rigid"]}})).axes
    by_default = case | {"model": 2, "geometry": None}  # negative stiffness, the energy of the block
    panels += figures.figure("phase", rockcli.run({"case": by_default})).axes
    top = np.arcsin(np.tan(alpha))
    left = quad(lambda q: np.sin(alpha) - np.cos(alpha) * np.sin(q), turned, top)[0]
    block = 2.0 * np.sin(0.5 * (alpha - turned))
    wanted = [np.sqrt(2.0 * left), alpha - turned, block, block]
    shown = [axes for axes in panels if axes.axison]
    for axes, rate in zip(shown, wanted, strict=True):
        dashed = [line for line in axes.lines if line.is_dashed()]
        assert len(dashed) == 4
        for line in dashed:
            x, y = np.abs(np.asarray(line.get_data(), dtype=float))
            assert np.interp(turned / alpha, x, y) == pytest.approx(rate / alpha, rel=1e-4)


@pytest.mark.parametrize(
    ("case", "vary"),
    [
        ({"model": 3, "geometry": "corotational"}, {"block.alpha": [0.9]}),  # never overturns
        ({"model": "flexible", "column": {"E": "5*GPa", "rho": 2500}}, {"block.alpha": [0.2]}),
        ({}, {"case": {"a block": {}, "model 1": {"model": 1, "geometry": "corotational"}}}),  # labels do not say which
    ],
    ids=["no equilibrium", "column", "settings"],
)
def test_no_separatrix_where_none_is_known(case: dict[str, Any], vary: dict[str, Any]) -> None:
    made = {"block": {"R": 3.0, "alpha": 0.2}, "initial": {"theta_dot": "0.6*p*alpha"}, "motion": {"duration": 1}}
    dataset = rockcli.run({"case": made | case, "vary": vary})
    for drawn in (dataset, overlaid([dataset, dataset], ["one", "other"])):
        figure = figures.figure("phase", drawn)
        assert not any(line.is_dashed() for axes in figure.axes for line in axes.lines)
        assert "separatrix" not in figure.get_suptitle()


def test_a_dataset_tells_what_differs_between_its_cases(tmp_path: Path) -> None:
    (tmp_path / "bodies.csv").write_text("body,g,model\nmoon,1.62,rigid\nearth,9.81,linearized\n")
    case = {"block": {"R": 3.0, "alpha": 0.2}, "motion": {"pulse": {"shape": "sine", "a_p": "0.3*g", "omega_p": 6}}}
    lifted = {"vertical": {"pulse": {"shape": "sine", "a_p": "k*g", "omega_p": 6}}}
    vary = {
        "block.R": [1.0, 2.0],
        "let.k": [0.1, 0.2],
        "case": str(tmp_path / "bodies.csv"),
        "motion": {"alone": {}, "lifted": lifted},
    }
    dataset = rockcli.run({"case": case, "let": {"k": 0.1}, "vary": vary})
    of_pulse = [f"motion.vertical.pulse.{key}" for key in ("a_p", "omega_p", "shape")]
    assert json.loads(dataset.attrs["varied"]) == ["block.R", "g", "let.k", "model", *of_pulse]
    assert may_vary(dataset, "motion.vertical")
    assert may_vary(dataset, "block.alpha", "g")
    assert not may_vary(dataset, "motion.pulse", "motion.vert", "block.R.x")


@pytest.mark.parametrize(
    ("damping", "vary", "words"),
    [
        ("dashpot", None, "separatrix of free rocking without the dashpot"),
        ("restitution", {"damping": ["restitution", "dashpot"]}, "separatrix of free rocking without the dashpot"),
        ("restitution", {"block.R": [3.0, 4.0]}, "separatrix of free rocking"),
    ],
)
def test_the_separatrix_is_said_to_be_without_the_dashpot(damping: str, vary: Any, words: str) -> None:
    made = {"block": {"R": 3.0, "alpha": 0.2}, "initial": {"theta": "0.9*alpha"}, "motion": {"duration": 1}}
    study = {"case": made | {"damping": damping}} | ({} if vary is None else {"vary": vary})
    figure = figures.figure("phase", rockcli.run(study))
    said = figure.get_suptitle() or figure.axes[0].get_title()
    assert f"dashed: {words}" in said.replace("\n", " ")
    assert ("dashpot" in said) == ("dashpot" in words)


@pytest.mark.parametrize(("n", "marked"), [(20, True), (40, False)])
def test_few_impacts_are_marked(n: int, marked: bool) -> None:
    t = np.linspace(5.5, 17.5, n)[None, :]
    rates = {"t_impact": t, "theta_dot_before": np.full((1, n), 0.5), "theta_dot_after": np.full((1, n), 0.4)}
    more = {name: (("case", "impact"), values) for name, values in rates.items()}
    figure = figures.figure("histories", shaken([noise(0)], [swing(5.0, 18.0)], **more))
    dots = [line for line in figure.axes[1].lines if line.get_marker() == "o"]
    assert sum(len(line.get_xdata()) for line in dots) == (n if marked else 0)


def test_the_vertical_component_is_drawn() -> None:
    vertical = {"a_v": (("case", "time"), noise(7)[None, :])}
    panel = figures.figure("histories", shaken([noise(0)], [swing(5.0, 18.0)], **vertical)).axes[0]
    assert len(traces(panel)) == 2
    assert [text.get_text() for text in panel.get_legend().get_texts()] == ["$a_g$", "$a_v$"]
    still = {"a_v": (("case", "time"), 0.0 * TIME[None, :])}
    panel = figures.figure("histories", shaken([noise(0)], [swing(5.0, 18.0)], **still)).axes[0]
    assert len(traces(panel)) == 1
    assert panel.get_legend() is None


def peaks(names: tuple[str, str], paths: tuple[str, str], units: tuple[str, str] = ("1", "1")) -> xarray.Dataset:
    size = (6, 7)
    coords = {
        name: axis(name, np.linspace(9.81, 9.81 * n, n), path, unit)
        for name, path, unit, n in zip(names, paths, units, size, strict=True)
    }
    data = {"outcome": (names, np.ones(size, dtype=np.int8)), "theta_peak_over_alpha": (names, np.full(size, 0.3))}
    return xarray.Dataset(data, coords, {"title": "Peaks", "axes": " ".join(names)})


def test_what_has_no_value_is_in_a_strip_of_its_own() -> None:
    dataset = peaks(("case", "a_p"), ("case", "motion.pulse.a_p"), ("1", "m s-2")).isel(case=slice(0, 2))
    dataset = dataset.assign_coords(case=axis("case", ["one", "other"]))
    flags, values = dataset["outcome"].values, dataset["theta_peak_over_alpha"].values
    for at, flag, value in (((0, 6), 3, np.inf), ((1, 6), 2, np.inf), ((0, 0), -2, np.nan), ((1, 2), -1, np.nan)):
        flags[at], values[at] = flag, value
    strip, curves = figures.figure("map", dataset).axes
    assert [text.get_text() for text in strip.get_yticklabels()] == ["failed", "unresolved", "overturned"]
    marks = [(line.get_marker(), *line.get_xydata()[0].round()) for line in strip.lines if len(line.get_xdata()) == 1]
    assert sorted(marks) == [("o", 1.0, 0.0), ("o", 7.0, 2.0), ("s", 3.0, 1.0), ("s", 7.0, 2.0)]  # in g, by row
    assert [line.get_marker() for line in curves.lines if line.get_label() in ("one", "other")] == ["o", "s"]
    assert curves.get_xlabel() == "$a_p$ [g]"


def test_accelerations_are_in_g() -> None:
    dataset = peaks(("pga", "g"), ("motion.record.pga", "g"), ("m s-2", "m s-2"))
    assert axis_label(dataset, "pga") == "PGA [g]"
    assert coordinate_label(dataset, "pga", 1) == "PGA = 2 g"
    assert coordinate_label(dataset, "g", 0) == "$g$ = 9.81 m/s²"


def test_points_that_lie_close_have_labels_of_their_own() -> None:
    dataset = peaks(("pga", "size"), ("motion.record.pga", "block.R"), ("m s-2", "m")).isel(size=slice(0, 6))
    dataset = dataset.assign_coords(
        pga=axis("pga", np.array([3.57, 3.5701, 3.9, 0.0, -3.57, 9.81]), "motion.record.pga", "m s-2"),
        size=axis("size", np.array([12346.0, 12347.0, 1.0, np.nextafter(1.0, 2.0), 2.0, 1e9]), "block.R", "m"),
    )
    words = [coordinate_label(dataset, "pga", i) for i in range(6)]
    assert words == [f"PGA = {x} g" for x in ("0.36391", "0.36392", "0.3976", "0", "-0.3639", "1")]
    words = [coordinate_label(dataset, "size", i) for i in range(6)]
    assert words[:2] == ["$R$ = 12346 m", "$R$ = 12347 m"]
    assert words[4:] == ["$R$ = 2 m", "$R$ = $10^{9}$ m"]
    assert len({*words}) == 6


@pytest.mark.parametrize(
    ("first", "second", "plane"),
    [
        ("motion.pulse.omega_p", "block.R", (0, 1)),
        ("block.R", "motion.pulse.T_p", (1, 0)),
        ("block.R", "motion.pulse.a_p", (0, 1)),
        ("motion.record.pga", "block.R", (1, 0)),
        ("block.R", "motion.floor_pga", (0, 1)),
        ("motion.pulse.a_p", "motion.pulse.f_p", (1, 0)),
        ("motion.pulse.omega_p_over_p", "motion.pulse.a_p", (0, 1)),
        ("block.R", "block.alpha", (1, 0)),
    ],
)
def test_the_plane_of_a_map(first: str, second: str, plane: tuple[int, int]) -> None:
    names = ("one", "two")
    x, y = outcomes.plane(peaks(names, (first, second))) or ("", "")
    assert (names.index(x), names.index(y)) == plane


@pytest.mark.parametrize("save", [["outcome"], ["outcome", "theta_peak_over_alpha"]])
@pytest.mark.parametrize(
    "amplitudes", [np.linspace(1.0, 9.0, 27), np.linspace(1.0, 9.0, 27) ** 1.2], ids=["even", "uneven"]
)
def test_cells_drawn_as_an_image_are_where_others_are(
    save: list[str], amplitudes: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Down an axis too; a few pixels lie on borders of cells, which the two ways round to the next but one at most."""
    study = {
        "name": "m",
        "case": {
            "block": {"R": 2.0, "tan_alpha": 0.2},
            "motion": {"pulse": {"shape": "ricker", "a_p": 3.0, "f_p": 1.0}},
        },
        "vary": {
            "motion.pulse.f_p": {"from": 3.0, "to": 0.3, "n": 31},
            "motion.pulse.a_p": amplitudes.tolist(),
        },
        "save": {"scalars": save},
    }
    dataset = rockcli.run(study)

    def pixels() -> np.ndarray:
        figure = figures.figure("map", dataset)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        assert bool(figure.axes[0].images) == outcomes._monotonic(np.arange(3.0))
        left, bottom, right, top = figure.axes[0].bbox.extents.astype(int)
        return np.asarray(canvas.buffer_rgba())[::-1][bottom + 3 : top - 2, left + 3 : right - 2]  # within the frame

    image = pixels()
    monkeypatch.setattr(outcomes, "_monotonic", lambda edges: False)
    mesh = pixels()
    assert np.mean((image != mesh).any(axis=-1)) < 0.1
    rows, columns = (range(2, n - 2) for n in mesh.shape[:2])
    neighbours = [mesh[np.ix_(np.add(rows, i), np.add(columns, j))] for i, j in product(range(-2, 3), repeat=2)]
    inside = image[2:-2, 2:-2]
    assert np.logical_or.reduce([(inside == each).all(axis=-1) for each in neighbours]).all()


@pytest.mark.parametrize("kind", ["map", "curve", "polar"])
def test_points_of_an_axis_are_drawn_in_ascending_order(kind: str) -> None:
    """However a study lists them: cells lay over one another, and lines went back and forth."""
    rows, columns = np.array([3, 0, 5, 1, 4, 2]), np.array([6, 2, 0, 5, 1, 3, 4])
    angles = ("direction", "direction2"), ("block.direction", "case"), ("rad", "1")
    dataset = peaks(*angles) if kind == "polar" else peaks(("one", "two"), ("one", "two"))
    first, second = dataset["outcome"].dims
    dataset["theta_peak_over_alpha"][:] = np.linspace(0.0, 0.9, 42).reshape(6, 7)
    dataset["outcome"][2:4, 2:5] = 2
    shuffled = dataset.isel({first: rows, second: columns})
    assert not np.array_equal(shuffled["outcome"].values, dataset["outcome"].values)
    if kind == "curve":  # the axis of the curves alone: the others are in the order of the study
        shuffled = dataset.isel({second: columns})
    elif kind == "polar":
        shuffled = dataset.isel({first: rows})

    def pixels(of: xarray.Dataset) -> np.ndarray:
        canvas = FigureCanvasAgg(figures.figure(kind, of))
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())

    assert np.array_equal(pixels(shuffled), pixels(dataset))


def test_a_size_that_returns_between_two_that_overturn_is_seen_in_a_spectrum() -> None:
    dataset = peaks(("along", "two"), ("block.R", "two")).assign_coords(p=("along", np.linspace(3.0, 1.0, 6)))
    dataset["theta_peak_over_alpha"][[0, 2, 3], 1] = np.inf
    period = 2.0 * np.pi / dataset["p"].values
    axes = figures.figure("spectrum", dataset).axes[0]
    dots = np.concatenate([line.get_xydata() for line in axes.lines if line.get_marker() == "o"])
    assert dots == pytest.approx(np.array([[period[1], 0.3]]))


@pytest.mark.parametrize(("kind", "path"), [("polar", "motion.record.angle"), ("spectrum", "block.R")])
def test_gaps_of_a_curve_are_told(kind: str, path: str) -> None:
    """Cases that failed, or are unresolved, have no peak."""
    dataset = peaks(("along", "two"), (path, "two")).assign_coords(p=("along", np.linspace(1.0, 3.0, 6)))
    assert "without an answer" not in figures.figure(kind, dataset).get_label()
    dataset["theta_peak_over_alpha"][:] = np.inf
    assert "ring" not in figures.figure(kind, dataset).get_label()  # of directions that all overturn none is worst
    dataset["theta_peak_over_alpha"][1:3, 4] = np.nan
    dataset["outcome"][1:3, 4] = -2
    assert "2 of 42 cases without an answer left out" in figures.figure(kind, dataset).get_label()


def test_the_share_of_a_suite_is_drawn_in_ascending_order() -> None:
    study = {
        "name": "s",
        "case": {"block": {"R": 1.0, "alpha": 0.2}, "motion": {"pulse": {"shape": "sine", "a_p": 4.0, "f_p": 1.0}}},
        "over": "motion.pulse.f_p",
        "vary": {"motion.pulse.f_p": [0.7, 1.0, 1.5, 3.0], "block.R": [4.0, 0.5, 2.0, 1.0, 8.0]},
        "save": {"histories": False},
    }
    dataset = rockcli.run(study)
    for axes, name in zip(
        figures.figure("curve", dataset).axes, ("p_overturned", "theta_peak_over_alpha_p50"), strict=True
    ):
        x, y = axes.lines[0].get_data()
        np.testing.assert_array_equal(x, [0.5, 1.0, 2.0, 4.0, 8.0])
        values = dataset[name].sel(R=np.asarray(x)).values
        np.testing.assert_array_equal(y, np.where(np.isfinite(values), values, np.nan))


def test_cases_that_are_one_are_drawn_once() -> None:
    study = {
        "name": "g",
        "case": {"block": {"R": 2.0, "tan_alpha": 0.2}, "initial": {"theta": 0.1}},
        "vary": {"model": ["rigid", "linearized", "3"], "geometry": ["negative_stiffness", "corotational"]},
    }
    titles = [axes.get_title() for axes in figures.figure("phase", rockcli.run(study)).axes]
    assert [title for title in titles if title] == [
        "rigid = model 3, negative stiffness",
        "linearized",
        "model 3, corotational",
    ]
    compared = figures.figure("histories", rockcli.run(study | {"compare_to": {"model": "rigid"}}))
    assert len(labelled(compared, r"$\theta/\alpha$")) == 1
    names = [text.get_text() for text in compared.legends[0].get_texts()]
    assert names == ["linearized", "model 3, negative stiffness", "model 3, corotational", "rigid (reference)"]


def test_a_compared_case_whose_history_was_not_saved_is_left_out() -> None:
    def study(**kept: float | str) -> xarray.Dataset:
        case = {"block": {"alpha": 0.2, "R": 1.0}, "motion": {"pulse": {"shape": "sine", "a_p": 3.0, "T_p": 1.0}}}
        vary = {"model": ["rigid", "linearized"], "block.R": [1.0, 2.0]}
        return rockcli.run({"case": case, "vary": vary, "compare_to": {"model": "rigid"}, "save": {"histories": kept}})

    one = figures.figure("histories", study(R=2.0))
    assert [text.get_text() for text in one.legends[0].get_texts()] == ["linearized", "rigid (reference)"]
    assert [axes.get_title() for axes in one.axes if axes.get_title()] == ["$R$ = 2 m"]
    for model in ("rigid", "linearized"):  # there is nothing to compare
        dataset = study(model=model)
        alone = figures.figure("histories", dataset)
        names = [text.get_text().removesuffix(" (overturns)") for text in alone.legends[0].get_texts()]
        assert names == [f"{model}, $R$ = 1 m", f"{model}, $R$ = 2 m"]
        assert "grey" not in str(figures.figure("phase", dataset).get_suptitle())


def test_legends_look_as_the_curves_do() -> None:
    study = {
        "name": "c",
        "case": {"block": {"R": 2.0, "tan_alpha": 0.2}, "model": "3", "geometry": "corotational"},
        "curves": ["moment_rotation", "displacements"],
    }
    dataset = rockcli.run(study)
    assert figures.default_kinds(dataset) == ("curves",)
    figure = figures.figure("curves", dataset)
    drawn = {(line.get_color(), line.get_linewidth()) for axes in figure.axes for line in axes.lines}
    handles = {line.get_label(): (line.get_color(), line.get_linewidth()) for line in figure.legends[0].get_lines()}
    assert "spring alone" in handles
    assert set(handles.values()) <= drawn
    assert "block" in handles
    corners = [axes for axes in figure.axes if axes.get_legend() is not None]
    assert [axes.get_ylabel() for axes in corners] == [r"$u_{top}\,/\,2b$", r"$v_{top}\,/\,2b$"]


def test_errors_that_are_none_have_an_axis_of_theirs() -> None:
    """What impacts leave is Housner's, whatever the amplitude; an axis of 1e-17 made a line of rounding of it."""
    curves = ["moment_rotation", "pushover", "displacements", "overturning_moment", "energy_per_cycle"]
    study = {"case": {"block": {"R": 5.0, "tan_alpha": 0.3}}, "vary": {"model": [1, 2]}, "curves": curves}
    error = figures.figure("curves", rockcli.run(study)).axes[-1]
    assert all(not np.any(line.get_ydata()) for line in error.lines)
    low, high = error.get_ylim()
    assert low == -high
    assert high > 0.01


@pytest.mark.parametrize(("alpha", "seen"), [(0.02, False), (0.3, True)])
def test_a_portrait_names_impacts_that_can_be_seen(alpha: float, seen: bool) -> None:
    """An impact of a slender block takes 1.5 alpha² of the velocity."""
    case = {"block": {"R": 1.0, "alpha": alpha}, "initial": {"theta": "0.3*alpha"}}
    figure = figures.figure("phase", rockcli.run({"case": case, "vary": {"model": ["rigid", "linearized"]}}))
    figure.draw_without_rendering()
    longest = 0.0
    for axes in figure.axes:
        for path in (path for lines in axes.collections for path in lines.get_paths()):
            longest = max(longest, float(np.ptp(axes.transData.transform(path.vertices)[:, 1])) * 72.0 / figure.dpi)
    assert (longest > 5.0) if seen else (0.0 < longest < 0.5)
    assert ("dotted: impacts" in figure.get_suptitle()) is seen


def test_the_title_of_one_portrait_is_over_it(asymmetric: xarray.Dataset) -> None:
    one = asymmetric.isel(initial_theta=0, drop=True).assign_attrs(axes="")
    figure = figures.figure("phase", one)
    figure.draw_without_rendering()
    title, panel = figure._suptitle.get_window_extent(), figure.axes[0].bbox
    middle = 0.5 * (title.x0 + title.x1)
    assert middle == pytest.approx(0.5 * (panel.x0 + panel.x1), abs=0.005 * figure.bbox.width)
    assert abs(middle - 0.5 * figure.bbox.width) > 0.02 * figure.bbox.width


def test_a_failed_case_does_not_keep_the_others_from_being_drawn() -> None:
    case = {"block": {"height": 50, "width": 5}, "initial": {"theta": 0.02}, "model": "flexible"}
    buckles = {"case": case | {"column": {"E": 1e6, "rho": 2500}, "motion": {"duration": 5}}, "save": {"dt_out": 0.05}}
    alone = rockcli.run({"name": "alone", **buckles})
    assert int(alone["outcome"]) == -2
    assert traces_of(alone) == 0
    both = rockcli.run({"name": "both", **buckles, "vary": {"column.E": [1e6, 3e10]}})
    assert both["outcome"].values.tolist() == [-2, 1]
    assert traces_of(both) == 1


def traces_of(dataset: xarray.Dataset) -> int:
    """Curves of the rotation that have anything in them."""
    (axes,) = labelled(figures.figure("histories", dataset), r"$\theta/\alpha$")
    return sum(np.isfinite(line.get_ydata()).sum() > 50 for line in axes.lines)


def test_cases_whose_histories_are_not_saved_are_not_among_those_drawn() -> None:
    case = {"block": {"R": 5, "tan_alpha": 0.2}, "initial": {"theta": 0.1}, "motion": {"duration": 5}}
    study = {"name": "some", "case": case, "save": {"histories": {"model": "rigid"}, "dt_out": 0.01}}
    dataset = rockcli.run({**study, "vary": {"model": ["rigid", "linearized"]}})
    assert traces_of(dataset) == 1
    for kind in ("histories", "phase"):
        figure = figures.figure(kind, dataset)
        words = " ".join(text.get_text() for text in figure.texts)
        assert "rigid" in words
        assert "linearized" not in words
        assert "without rotation" not in words
        assert not figure.legends


@pytest.mark.parametrize("width", [90, 180])
def test_the_numbers_along_slender_bodies_do_not_touch(width: int) -> None:
    bodies = {name: {"h": 1.15, "width": b} for name, b in (("a", 0.5), ("b", 0.45), ("c", 0.3), ("d", 1.2))}
    data = rockcli.run(
        {"case": {"block": {"h": 1.1, "width": 0.6}, "initial": {"theta": 0.1}}, "vary": {"block": bodies}}
    )
    figure = rockcli.plot(data, "body", width=width)
    figure.draw_without_rendering()
    rows = [max(axes.get_position().height for axes in row) for row in (figure.axes[:2], figure.axes[2:])]
    assert sum(rows) > 0.55  # the figure is hardly higher than its bodies and the words below them
    for axes in figure.axes:
        labels = [label.get_window_extent() for label in axes.get_xticklabels() if label.get_text()]
        seen = [box for box in labels if axes.bbox.x0 <= 0.5 * (box.x0 + box.x1) <= axes.bbox.x1]
        for left, right in pairwise(seen):
            assert right.x0 - left.x1 > 0.25 * right.height


def test_the_page_tells_the_rotation_nearest_to_alpha_beside_its_margin() -> None:
    """Of a body whose largest rotation is to the side of the larger alpha."""
    case = {
        "block": ASYMMETRIC["case"]["block"],
        "motion": {"pulse": {"shape": "sine", "a_p": 7.2, "f_p": 2, "cycles": 3}},
    }
    dataset = rockcli.run({"name": "a", "case": case, "save": {"histories": False}})
    nearest, largest = (np.degrees(float(dataset[f"theta_peak_{side}"])) for side in ("left", "right"))
    told = {fact.what: fact.value for fact in facts_of(dataset)}
    assert largest > nearest
    assert told["rotation nearest to alpha"] == f"{nearest:.3g}°"
    assert told["margin"] == f"{100.0 - 100.0 * np.radians(nearest) / float(dataset['alpha_left']):.3g} %"


def test_the_bodies_of_a_mixed_list_are_all_drawn_and_the_page_has_them_beside_the_barriers():
    """The figure of bodies left out those of sizes, without a word, and a mesh among them took its place."""
    triangle = [[-0.3, 0.0], [0.3, 0.0], [0.0, 1.5]]
    bodies = {"cone": {"outline": triangle}, "stele": {"height": 1.6, "width": 0.3}, "box": {"h": 0.7, "b": 0.2}}
    study = {"case": {"block": {"height": 1.0, "width": 0.2}, "initial": {"theta": 0.01}}, "vary": {"block": bodies}}
    data = rockcli.run({**study, "save": {"histories": False}})
    drawn = rockcli.plot(data, "body")
    assert [axes.get_title() for axes in drawn.axes if axes.get_title()] == list(bodies)
    over = np.full((3, 4), np.nan)
    data["barrier"] = (("block", "azimuth"), over)
    data["barrier"][0] = 0.1
    assert figures.default_kinds(data)[:2] == ("body", "barriers")
    data["barrier"][:] = 0.1
    assert figures.default_kinds(data)[0] == "barriers"


def test_barriers_are_those_of_a_box(tmp_path: Path) -> None:
    """A box tips over an edge when its centre of mass, 0.5 m high, has risen to its distance from the edge."""
    trimesh = pytest.importorskip("trimesh", reason="meshes are read by trimesh: pip install -e '.[meshes]'")
    trimesh.creation.box((0.4, 0.6, 1.0)).export(tmp_path / "box.stl")
    block = {"mesh": str(tmp_path / "box.stl"), "density": 2700, "direction": 0.0}
    dataset = rockcli.run({"name": "box", "case": {"block": block, "initial": {"theta": 0.01}}})
    body, around = figures.figure("barriers", dataset).axes
    corners = [line.get_xydata()[0] for line in body.lines if line.get_marker() == "^"]
    np.testing.assert_allclose(sorted(map(tuple, corners)), [(-0.2, 0.0), (0.2, 0.0)], atol=1e-6)
    curve, mark = around.lines
    along_x, along_y = (1e3 * (np.hypot(half, 0.5) - 0.5) for half in (0.2, 0.3))
    angle, height = (np.asarray(values) for values in curve.get_data())
    assert np.interp([0.0, 0.5 * np.pi], angle[:-1], height[:-1]) == pytest.approx([along_x, along_y], rel=1e-3)
    (angle,), (height,) = mark.get_data()
    assert np.cos(angle) ** 2 == pytest.approx(1.0)
    assert height == pytest.approx(along_x, rel=1e-3)
    (words,) = (text.get_text() for text in around.texts)
    assert words == f"{np.degrees(angle) % 360.0:.4g}\N{DEGREE SIGN}: {along_x:.3g} mm"
