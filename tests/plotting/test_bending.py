"""The figure of flexible columns beside other models."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from plotting.column_datasets import columns

from rockcli.plotting import figures
from rockcli.plotting.common.style import save


def rows(figure: Figure) -> list[str]:
    return [axes.get_ylabel() for axes in figure.axes]


def curves(figure: Figure, label: str) -> list[np.ndarray]:
    """Curves of the panels with a label, without lines of reference."""
    panel = next(axes for axes in figure.axes if axes.get_ylabel() == label)
    return [np.asarray(line.get_ydata(), dtype=float) for line in panel.lines if len(line.get_ydata()) > 2]


def test_the_kind_is_suggested_beside_histories():
    assert figures.default_kinds(columns())[:2] == ("histories", "bending")


@pytest.mark.parametrize("nothing", [np.nan, 0.0])
def test_nothing_that_bends_is_not_drawn(nothing):
    dataset = columns()
    dataset["u_top_bending"][:] = nothing
    assert "bending" not in figures.default_kinds(dataset)
    assert "bends" in figures.why_not("bending", dataset)
    assert "bends" in figures.why_not("bending", dataset.drop_vars("u_top_bending"))
    assert "histories" in figures.why_not("bending", dataset.drop_vars(["theta", "time"]))


def test_rows_show_what_the_dataset_holds():
    dataset = columns(("rigid", "flexible"))
    figure = figures.figure("bending", dataset)
    assert len(figure.axes) == 4
    _, theta, top, bending = rows(figure)
    np.testing.assert_array_equal(curves(figure, theta), dataset["theta"] / dataset["alpha"])
    np.testing.assert_array_equal(curves(figure, top), dataset["u_top"])
    np.testing.assert_array_equal(curves(figure, bending), dataset["u_top_bending"])
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["rigid", "flexible"]


def test_bodies_that_bend_have_a_panel_each_on_one_scale():
    dataset = columns()  # a rigid one, and two that bend
    figure = figures.figure("bending", dataset)
    *_, one, other = figure.axes
    assert rows(figure)[-2] == rows(figure)[-1]
    assert [axes.get_title(loc="left") for axes in (one, other)] == ["flexible", "fallen"]
    np.testing.assert_array_equal(one.lines[0].get_ydata(), dataset["u_top_bending"][1])
    assert one.lines[0].get_color() != other.lines[0].get_color()
    assert one.get_ylim() == other.get_ylim()


def test_a_ground_at_rest_has_no_panel():
    dataset = columns(("rigid", "flexible"))
    dataset["a_g"][:] = 0.0
    assert len(figures.figure("bending", dataset).axes) == 3


def test_a_fall_is_marked_and_does_not_squeeze_the_others():
    figure = figures.figure("bending", columns())
    assert "crosses: overturning" in figure.get_suptitle()
    theta = next(axes for axes in figure.axes if "theta" in axes.get_ylabel())
    assert theta.get_ylim()[0] > -1.6
    assert any(line.get_marker() == "x" for line in theta.lines)


def test_motions_are_columns_and_more_of_them_are_counted():
    figure = figures.figure("bending", columns(("rigid", "flexible"), pulses=5))
    assert len(figure.axes) == 4 * 3
    assert "3 of 5 columns shown" in figure.get_suptitle()
    assert [axes.get_title() for axes in figure.axes[:3]] == ["pulse 0", "pulse 2", "pulse 4"]


def test_one_model_under_several_motions_is_one_column():
    assert len(figures.figure("bending", columns(("flexible",), pulses=2)).axes) == 3 + 2  # the bending of each


@pytest.mark.parametrize("plot_format", ["png", "pdf", "svg"])
def test_it_is_written(plot_format: str, tmp_path: Path):
    path = tmp_path / f"bending.{plot_format}"
    save(figures.figure("bending", columns()), path)
    assert path.stat().st_size > 5000
