"""Figures at the widths of journals: nothing leaves the page or lies on other words, and no colour is needed to read them."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from itertools import combinations

import numpy as np
import pytest
import xarray
from half_sines import SUITE
from matplotlib import rc_context
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text
from plotting.column_datasets import columns
from plotting.test_gallery import gallery
from plotting.test_work_precision import traded

import rockcli
from rockcli.plotting import record_spectra
from rockcli.plotting.common import style
from rockcli.plotting.common.style import wrapped

MADE = {
    "bending": lambda: columns(),
    "work_precision": lambda: traded(["event", "scipy RK45", "frame"]).assign_attrs(axes=""),
}
"""Datasets made by hand, where the study of the gallery takes long."""

KINDS = [kind for kind in gallery.PICTURES if kind not in ("histories", "motion")]
WIDTHS = (90, 120, 180)
COLUMN_FIRST = (90, *(pytest.param(width, marks=pytest.mark.slow) for width in WIDTHS[1:]))
"""A column of a journal has least room; wider figures are seen to where there is time."""


@pytest.fixture(scope="module")
def datasets() -> dict[str, xarray.Dataset]:
    """By study, each run once."""
    return {}


@pytest.fixture(scope="module")
def figures() -> dict[tuple[str, float], Figure]:
    """By kind and width, each drawn once."""
    return {}


@pytest.fixture
def drawn(datasets: dict[str, xarray.Dataset], figures: dict[tuple[str, float], Figure]) -> Callable[..., Figure]:
    def figure(kind: str, width: float) -> Figure:
        if kind == "barriers":
            pytest.importorskip("trimesh", reason="meshes are read by trimesh: pip install -e '.[meshes]'")
        study, _, options = gallery.PICTURES[kind]
        key = kind if kind in MADE else study
        if key not in datasets:
            datasets[key] = MADE[kind]() if kind in MADE else gallery.dataset(kind)
        if (kind, width) not in figures:
            figures[kind, width] = rockcli.plot(datasets[key], kind, width=width, **options)
            figures[kind, width].draw_without_rendering()
        return figures[kind, width]

    return figure


def words(figure: Figure) -> list[Text]:
    """Words that are seen."""
    found = [figure._suptitle, *(text for legend in figure.legends for text in legend.get_texts())]
    for axes in figure.axes:
        found += [axes.title, axes._left_title, *axes.texts]
        found += axes.get_legend().get_texts() if axes.get_legend() else []
        for axis in (axes.xaxis, axes.yaxis) if axes.axison else ():
            low, high = sorted(axis.get_view_interval())
            room = 1e-9 * (high - low)
            ticks = [*axis.get_major_ticks(), *axis.get_minor_ticks()]
            found += [axis.label, *(tick.label1 for tick in ticks if low - room <= tick.get_loc() <= high + room)]
            found += [tick.label2 for tick in ticks if low - room <= tick.get_loc() <= high + room]
    return [text for text in found if text is not None and text.get_visible() and text.get_text().strip()]


@pytest.mark.parametrize("width", COLUMN_FIRST[:2])  # what has room there has it at 180 mm
@pytest.mark.parametrize("kind", KINDS)
def test_words_stay_on_the_page_and_off_one_another(drawn, kind, width):
    check_words(drawn(kind, width))


def check_words(figure: Figure) -> None:
    boxes = [(text.get_text(), text.get_window_extent()) for text in words(figure)]
    page = figure.bbox
    for said, box in boxes:
        assert box.x0 >= page.x0 + 1.0, said
        assert box.x1 <= page.x1 - 1.0, said
        assert box.y0 >= page.y0 + 1.0, said
        assert box.y1 <= page.y1 - 1.0, said
    for (one, a), (other, b) in combinations(boxes, 2):
        across = min(a.x1, b.x1) - max(a.x0, b.x0)
        down = min(a.y1, b.y1) - max(a.y0, b.y0)
        assert across < 2.0 or down < 2.0, (one, other)


@pytest.mark.parametrize("width", COLUMN_FIRST)
@pytest.mark.parametrize("n", [2, 3, 6])
def test_words_of_several_bodies_stay_off_one_another(n, width):
    """Stout and slender ones, some with two different edges and so two lines of alpha and R."""
    outlines = {f"body {k}": [[0, 0], [0.3, 0], [0.3 + 0.1 * k, 1], [0, 1 + 0.1 * k]] for k in range(n)}
    vary = {"block": {name: {"outline": points} for name, points in outlines.items()}}
    case = {"block": {"h": 1.0, "b": 0.2}, "initial": {"theta": 0.01}}
    data = rockcli.run({"name": "several", "case": case, "vary": vary, "save": {"histories": False}})
    figure = rockcli.plot(data, "body", width=width)
    for _ in range(3):  # layouts of equal axes settle in a few turns
        figure.draw_without_rendering()
    check_words(figure)


@pytest.mark.parametrize(("width", "b"), [(90, [0.2, 0.26]), (90, [0.6, 0.72]), (120, 0.6)])
def test_words_of_bodies_with_long_names_stay_on_the_page_of_a_file(width, b, tmp_path):
    """Files are laid out without a drawing before them."""
    said = "shelf of the archive with the files of 1950 to 1990"
    names = {f"{k}, {said[: 20 + 13 * k]}": {"h": 1.0 + 0.1 * k, "b": b} for k in range(2)}
    case = {"block": {"h": 1.0, "b": 0.2}, "initial": {"theta": 0.01}}
    data = rockcli.run({"name": "long", "case": case, "vary": {"block": names}, "save": {"histories": False}})
    figure = rockcli.plot(data, "body", tmp_path / "body.png", width=width)
    figure.draw_without_rendering()
    check_words(figure)


@pytest.mark.parametrize("width", [None, 90, 120])
@pytest.mark.parametrize("b", [[0.32, 0.4], 0.32, 0.28, 0.225, 0.15])
def test_words_of_a_body_as_wide_as_its_panel_stay_on_the_page(b, width, tmp_path):
    """Whether the width or the height of the page bounds it, in files, which are laid out without a drawing before."""
    data = rockcli.run({"name": "one", "case": {"block": {"h": 0.45, "b": b}, "initial": {"theta": 0.01}}})
    figure = rockcli.plot(data, "body", tmp_path / "body.png", width=width)
    figure.draw_without_rendering()
    check_words(figure)


@pytest.mark.parametrize(
    "bodies",
    [
        [{"h": 9.571, "b": 4.3177}, {"h": 0.104, "b": 0.0688}],
        [{"h": 1.347, "b": 1.1446}, {"h": 0.846, "b": [0.0802, 0.4896]}],
    ],
)
def test_numbers_of_two_bodies_in_a_column_leave_their_axis_its_name(bodies, tmp_path):
    """The layout of panels with one scale may end between two sets of numbers, of which the wider ones are drawn."""
    names = {f"object number {i}": body for i, body in enumerate(bodies)}
    case = {"block": {"h": 1.0, "b": 0.2}, "initial": {"theta": 0.001}}
    study = {"name": "two", "title": "A title of a study with bodies", "case": case, "vary": {"block": names}}
    data = rockcli.run(study | {"save": {"histories": False}})
    figure = rockcli.plot(data, "body", tmp_path / "body.png", width=90)
    figure.draw_without_rendering()
    check_words(figure)


@pytest.mark.parametrize("width", [90, 180])
def test_long_names_in_a_legend_stay_on_the_page(width):
    said = "shelf of the archive with the files of 1950 to 1990, unloaded and not tied to the wall of the basement"
    names = {f"{said}, {word}": {"width": b} for word, b in (("as it stands", 0.5), ("on a plate", 0.6))}
    case = {"block": {"height": 2.0, "width": 0.5}, "initial": {"theta": 0.1}}
    data = rockcli.run({"name": "long", "case": case, "vary": {"block": names}, "save": {"histories": True}})
    figure = rockcli.plot(data, "histories", width=width)
    figure.draw_without_rendering()
    check_words(figure)
    shown = [text.get_text().replace("\n", " ") for text in figure.legends[0].get_texts()]
    assert shown == list(names)


@pytest.mark.parametrize(("width", "columns"), [(90, 2), (120, 2), (180, 3)])
def test_static_curves_stand_beside_one_another_where_there_is_room(width, columns):
    """Which corner a line is of is written in its panel, and does not leave it."""
    curves = ["moment_rotation", "pushover", "displacements", "overturning_moment", "energy_per_cycle"]
    data = rockcli.run({"name": "c", "case": {"block": {"R": 5.0, "tan_alpha": 0.3}, "model": 2}, "curves": curves})
    figure = rockcli.plot(data, "curves", width=width)
    figure.draw_without_rendering()
    check_words(figure)
    shown = [axes for axes in figure.axes if axes.axison]
    assert len(shown) == 12
    assert len({round(axes.get_position().x0, 2) for axes in shown}) == columns
    written = [axes for axes in shown if axes.get_legend()]
    assert len(written) == 2
    for axes in written:
        words, panel = axes.get_legend().get_window_extent(), axes.get_window_extent()
        assert panel.x0 - 1.0 <= words.x0 < words.x1 <= panel.x1 + 1.0


def test_names_of_files_in_spectra_are_shown_as_they_are(tmp_path, monkeypatch):
    """Long ones stay on the page; a dollar is no mathematics, and an underscore in front leaves nothing out."""
    names = ["RSN811_LOMAP_a_name_as_long_as_those_of_a_database_of_records_1.AT2 H1", "1$ and 2$.txt", "_kept.AT2"]
    drawn: list[Figure] = []
    monkeypatch.setattr(record_spectra, "save", lambda figure, *_: drawn.append(figure))
    periods = np.geomspace(0.1, 1.0, 5)
    record_spectra.draw(tmp_path / "x.png", periods, [(name, periods) for name in names], "Spectra")
    (figure,) = drawn
    figure.draw_without_rendering()
    check_words(figure)
    shown = [text.get_text() for text in figure.legends[0].get_texts()]
    assert [words.strip().replace("\n", "").replace("\\$", "$") for words in shown] == names
    assert shown[1].count("\\$") == 2


@pytest.mark.parametrize("kind", ["curve", "histories"])
def test_a_high_legend_leaves_the_panels_as_they_are(kind):
    """Eight names of two or three lines are higher than the panels, which nothing was left of."""
    said = "shelf of the archive with the files of 1950 to 1990, unloaded and not tied to the wall of the basement"
    names = {f"{said}, number {k}": {"width": 0.3 + 0.05 * k} for k in range(8)}
    pulse = {"shape": "sine", "a_p": 4.0, "T_p": 0.6}
    case = {"block": {"height": 2.0, "width": 0.5}, "motion": {"pulse": pulse}}
    over = {"motion.pulse.a_p": [2.0, 4.0, 6.0]} if kind == "curve" else {}
    study = {"case": case, "vary": {"block": names} | over, "save": {"histories": kind == "histories"}}
    figure = rockcli.plot(rockcli.run(study), kind, width=90)
    figure.draw_without_rendering()
    check_words(figure)
    assert figure.axes[-1].get_window_extent().height / figure.dpi > 1.5


@pytest.mark.parametrize("width", [None, 60, 90, 120, 150])
def test_words_beside_a_slender_body_stay_on_the_page(width):
    outline = [[0, 0], [0.41, 0.012], [0.53, 0.74], [0.4, 1.75], [0, 1.8], [-0.24, 0.8]]
    block = {"outline": outline, "contacts": [[0, 0], [0.41, 0.012]]}
    data = rockcli.run({"name": "one", "case": {"block": block, "initial": {"theta": 0.01}}})
    figure = rockcli.plot(data, "body", width=width)
    figure.draw_without_rendering()
    check_words(figure)


@pytest.mark.parametrize("width", COLUMN_FIRST)
@pytest.mark.parametrize("kind", ["fragility", "risk"])
def test_a_long_name_of_the_intensity_stays_below_its_panel(kind, width):
    """Of two panels side by side at 90 mm the names lay on one another, and the unit of the second left the page."""
    study = SUITE | {
        "case": SUITE["case"] | {"block": {"height": 2.0, "width": 0.5}},
        "vary": {"block": {"one": {"height": 2.0, "width": 0.5}, "two": {"height": 3.0, "width": 0.7}}} | SUITE["vary"],
        "over": {"axis": "omega_p", "along": "a_p", "intensity": "ground_sa(0.5)"},
        "hazard": {"intensity": ["0.05*g", "0.5*g", "3*g"], "rate": [1e-2, 1e-4, 1e-7]},
    }
    study["case"]["motion"] = SUITE["case"]["motion"] | {"through": [{"f": 5, "zeta": 0.05}]}
    figure = rockcli.plot(rockcli.run(study), kind, width=width)
    figure.draw_without_rendering()
    assert "of the ground" in " ".join(figure.axes[-1 if kind == "fragility" else 0].get_xlabel().split())
    check_words(figure)


def test_barriers_name_the_body_where_the_study_has_others(tmp_path):
    pytest.importorskip("trimesh", reason="meshes are read by trimesh: pip install -e '.[meshes]'")
    mesh = gallery.ROOT / "studies" / "tutorials" / "boulder.obj"
    bodies = {"plinth": {"height": 1.0, "width": 0.8}, "boulder": {"mesh": str(mesh), "density": 2700}}
    case = {"block": {"height": 1.0, "width": 0.8}, "initial": {"theta": 0.01}}
    data = rockcli.run({"name": "two", "case": case, "vary": {"block": bodies}, "save": {"histories": False}})
    for width in WIDTHS:
        figure = rockcli.plot(data, "barriers", width=width)
        figure.draw_without_rendering()
        assert "boulder" in figure.axes[0].get_title()


def looks(handle: object) -> tuple[tuple[object, ...], float]:
    """What tells an entry of a legend from another without colours, and its lightness."""
    if isinstance(handle, Line2D):
        marker = handle.get_marker() if handle.get_markersize() > 1.0 else ""
        return (str(handle._dash_pattern), marker, handle.get_linewidth()), lightness(handle.get_color())
    assert isinstance(handle, Patch)
    return (handle.get_hatch(),), lightness(handle.get_facecolor())


def lightness(colour: object) -> float:
    """L* of CIE 1976."""
    c = np.array(to_rgb(colour))
    y = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4) @ [0.2126, 0.7152, 0.0722]
    return float(116.0 * np.cbrt(y) - 16.0 if y > 0.008856 else 903.3 * y)


def check_colours(figure: Figure) -> None:
    for legend in figure.legends:
        for one, other in combinations(legend.legend_handles, 2):
            (a, light), (b, dark) = looks(one), looks(other)
            assert a != b or abs(light - dark) > 9.0, (one.get_label(), other.get_label())


@pytest.mark.parametrize("kind", KINDS)
def test_a_legend_needs_no_colours(drawn, kind):
    check_colours(drawn(kind, 120))


def test_no_word_of_a_title_is_left_alone():
    said = "Which direction of a polarised motion rocks a block most"
    assert wrapped(said, 50) == ["Which direction of a polarised", "motion rocks a block most"]
    assert wrapped(said, 80) == [said]
    assert wrapped("", 20) == []
    for room in range(12, 60):
        lines = wrapped(said, room)
        assert " ".join(lines) == said
        assert max(map(len, lines)) <= room
        assert len(lines) == len(textwrap.wrap(said, room))


def test_a_number_keeps_its_unit():
    said = "as it stands, PGA = 0.3 g, synthetic pulse m70"
    assert wrapped(said, 30) == ["as it stands, PGA = 0.3 g,", "synthetic pulse m70"]
    assert wrapped(said, 20) == ["as it stands,", "PGA = 0.3 g,", "synthetic pulse m70"]


@pytest.mark.parametrize("kind", ["ida", "fragility"])
def test_titles_and_legends_take_nothing_from_the_panels(drawn, kind):
    """However many lines they have, panels are as high as they are wide, nearly, and never flat."""
    for width in WIDTHS:
        figure = drawn(kind, width)
        box = figure.axes[0].get_window_extent()
        assert box.height / figure.dpi >= 1.55
        assert 0.6 < box.height / box.width < 1.3


@pytest.mark.parametrize("width", [60, 90, 120])
def test_maps_beside_one_another_are_not_flat_in_a_column(width):
    """A legend of four lines left maps of two bodies half an inch, in which numbers touched."""
    case = {"block": {"R": 2.0, "tan_alpha": 0.3}, "motion": {"pulse": {"shape": "sine", "a_p": 4.0, "T_p": 0.5}}}
    a_p = {"from": 0.4, "to": 40.0, "n": 9, "spacing": "log"}
    vary = {"block.R": [1.0, 4.0], "motion.pulse.a_p": a_p, "motion.pulse.T_p": {"from": 0.3, "to": 2.3, "n": 9}}
    figure = rockcli.plot(rockcli.run({"case": case, "vary": vary, "save": {"histories": False}}), "map", width=width)
    figure.draw_without_rendering()
    check_words(figure)
    assert figure.axes[0].get_window_extent().height / figure.dpi > 1.59


def test_names_of_functions_take_room_in_titles_of_panels():
    """tan(alpha) is four letters and a blank; they were none, and titles reached the edge of the page."""
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "initial": {"theta": "0.4*alpha"}}
    vary = {"block.tan_alpha": [0.35, 0.25], "model": ["linearized", "1", "2"]}
    figure = rockcli.plot(rockcli.run({"name": "t", "case": case, "vary": vary}), "phase", width=90)
    figure.draw_without_rendering()
    check_words(figure)
    assert figure.axes[1].get_title() == "$\\tan\\alpha$ = 0.35,\nmodel 1 = model 2"


def test_half_a_circle_leaves_no_half_empty(drawn):
    for width in WIDTHS:
        figure = drawn("polar", width)
        (axes,) = figure.axes
        half = axes.patch.get_window_extent()
        title = axes.title.get_window_extent()
        above = title.y0 - half.y1
        below = half.y0 - figure.bbox.y0
        assert 0.0 < above < 0.35 * figure.dpi
        assert 0.0 < below < 0.4 * figure.dpi
        assert half.width > 0.75 * figure.bbox.width


def test_panels_with_little_in_common_stand_below_one_another_in_a_column(drawn):
    for width, abreast in ((90, False), (180, True)):
        body, barrier = drawn("barriers", width).axes
        assert (body.get_position().x1 < barrier.get_position().x0) == abreast
        assert (body.get_position().y0 > barrier.get_position().y1) != abreast


@pytest.mark.parametrize("width", [60, 90])
def test_short_names_in_a_legend_stay_on_the_page(width):
    """Names of up to twelve letters were set in as many columns as asked for, whether there was room or not."""
    figure = style.new_figure(width / 25.4, 2.0)
    handles = [Line2D([], [], label=f"record number {k}"[:12]) for k in range(4)]
    with rc_context(style.RC):
        style.legend_below(figure, handles)
    figure.draw_without_rendering()
    check_words(figure)


def test_every_line_of_a_title_of_a_panel_is_as_long_as_the_panel():
    """What mathematics is written with, in one line, made room for more letters in another that has none."""
    pulse = {"shape": "sine", "a_p_over_g_tan_alpha": 20, "omega_p_over_p": 0.2}
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}
    vary = {f"motion.pulse.{key}": [1.0 * value, 1.5 * value] for key, value in pulse.items() if key != "shape"}
    figure = rockcli.plot(rockcli.run({"name": "t", "case": case, "vary": vary}), "phase", width=90)
    figure.draw_without_rendering()
    check_words(figure)
    title = "$a_p/(g\\,\\tan\\alpha)$ = 20,\n$\\omega_p/p$ = 0.2, overturned\nwithout impact"
    assert figure.axes[0].get_title() == title


@pytest.mark.parametrize("width", [90, 180])
@pytest.mark.parametrize("kind", ["histories", "motion", "bending"])
def test_names_of_traces_stay_above_their_panels(kind, width):
    """Long names of one line each reached over the panel beside them and off the page."""
    said = "shelf of the archive with the files of 1950 to 1990, unloaded and not tied to the wall"
    names = [f"{said}, {word}" for word in ("as it stands", "on a plate", "on rollers")]
    steps = np.sin(np.arange(200) * 0.1)
    records = {name: {"values": (steps**n).tolist(), "dt": 0.02, "units": "g"} for n, name in enumerate(names, 1)}
    case = {"block": {"height": 2.0, "width": 0.5}, "motion": {"record": records[names[0]]}}
    vary = {"motion.record": records}
    if kind == "bending":
        case |= {"model": "flexible", "column": {"E": 3e9, "rho": 2400.0, "zeta": 0.02}}
        vary = {"case": {name: {"column.E": E} for name, E in zip(names, (3e8, 3e9, 3e10), strict=True)}}
    data = rockcli.run({"name": "long", "case": case, "vary": vary})
    figure = rockcli.plot(data, kind, width=width)
    figure.draw_without_rendering()
    check_words(figure)


@pytest.mark.parametrize(("R", "tan_alpha"), [(2.0, 0.01), (0.03, 0.1), (0.03, 0.05), (20.0, 0.05)])
@pytest.mark.parametrize("width", [None, 180])
def test_numbers_below_a_slender_body_stay_off_one_another(R, tan_alpha, width, tmp_path):
    case = {"block": {"R": R, "tan_alpha": tan_alpha}, "initial": {"theta": "0.1*alpha"}}
    data = rockcli.run({"name": "one", "case": case, "save": {"histories": False}})
    figure = rockcli.plot(data, "body", tmp_path / "body.png", width=width)
    figure.draw_without_rendering()
    check_words(figure)


@pytest.mark.parametrize("width", [60, 90, 180])
def test_static_curves_of_several_bodies_name_corners_below_the_panels(width):
    """Words in each of three panels beside one another lay over numbers along the axis, and over the curves."""
    case = {"block": {"R": 5.0, "tan_alpha": 0.3}, "model": 2}
    study = {"case": case, "vary": {"block.tan_alpha": [0.1, 0.2, 0.4]}, "curves": ["pushover", "displacements"]}
    figure = rockcli.plot(rockcli.run(study), "curves", width=width)
    figure.draw_without_rendering()
    check_words(figure)
    assert not [axes for axes in figure.axes if axes.get_legend()]
    assert "block, pivot-side corner" in [text.get_text() for text in figure.legends[0].get_texts()]


def test_many_curves_of_samples_and_spectra_need_no_colours(tmp_path, monkeypatch):
    """They differed in colour alone; along the axes of spectra stood 10^-1 and 10^0, two numbers in a figure."""
    drawn: list[Figure] = []
    monkeypatch.setattr(record_spectra, "save", lambda figure, *_: drawn.append(figure))
    periods = np.geomspace(0.02, 10.0, 50)
    record_spectra.draw(tmp_path / "x.png", periods, [(f"{i}", (1.0 + i) / (1.0 + periods)) for i in range(8)], "t")
    case = {"block": {"R": 2.0, "alpha": 0.2}, "initial": {"theta_dot": 0.5}}
    study = {"case": case, "uncertain": {"block.R": {"lognormal": [2.0, 0.3]}}, "samples": 16}
    data = rockcli.run(study | {"vary": {"initial.theta_dot": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]}})
    drawn.append(rockcli.plot(data, "samples"))
    for figure in drawn:
        figure.draw_without_rendering()
        check_words(figure)
        check_colours(figure)
    for axis in (drawn[0].axes[0].xaxis, drawn[0].axes[0].yaxis):
        low, high = axis.get_view_interval()
        ticks = [tick.label1.get_text() for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
        assert "1" in ticks
        assert len(ticks) > 2


def test_a_dollar_in_a_name_takes_the_room_of_a_letter():
    figure = style.new_figure(90 / 25.4, 2.0)
    names = [r"100 % of \$5", r"a \$ b \$ c \$ d", "{brace}"]
    with rc_context(style.RC):
        style.legend_below(figure, [Line2D([], [], label=name) for name in names])
    assert [text.get_text() for text in figure.legends[0].get_texts()] == names
