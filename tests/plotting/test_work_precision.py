"""The picture of `rock trade`: names that belong to their points, looks that belong to their families."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import xarray

import rockcli
from rockcli.plotting.figures import figure
from rockcli.plotting.kinds import work_precision
from rockcli.solvers.general.methods import METHODS

MODELS = {
    "linearized": 2.8e-2,
    "1 negative_stiffness": 3.3e-3,
    "2 negative_stiffness": 3.3e-3,
    "1 corotational": 6.1e-3,
    "2 corotational": 1.0e-3,
    "4 corotational": 6.1e-3,
}


def traded(families):
    """Two settings of each family, and models with errors close together that cost nearly the same."""
    n, m = 2 * len(families), len(MODELS)
    columns = {
        "part": ["numerics"] * n + ["model"] * m,
        "model": ["rigid"] * n + list(MODELS),
        "family": [family for family in families for _ in range(2)] + ["event"] * m,
        "step": ["coarse", "fine"] * len(families) + ["standard"] * m,
        "against": ["event, rtol 1e-16"] * n + ["rigid"] * m,
        "cost": [*np.linspace(1e-3, 1.0, n), *np.linspace(2.6e-4, 2.9e-4, m)],
        "error_median": [*np.geomspace(1e-12, 1e-3, n), *MODELS.values()],
        "on_front": [1] * n + [0] * m,
    }
    return xarray.Dataset({name: ("setting", values) for name, values in columns.items()})


def test_a_thin_line_leads_from_every_model_to_its_name():
    axes = figure("work_precision", traded(["event"])).axes[1]
    names = {text.xy[1]: text.get_text() for text in axes.texts}
    dots, *lines = axes.get_lines()
    assert set(names.values()) == {
        "linearized", "1, 2 negative stiffness", "1, 4 corotational", "2 corotational",
    }  # fmt: skip
    led = [(line.get_xydata()[0], names[line.get_ydata()[1]]) for line in lines]
    assert len(led) == len(MODELS)
    for (name, error), point in zip(MODELS.items(), dots.get_xydata(), strict=True):
        (words,) = [words for start, words in led if (start == point).all()]
        number, _, geometry = name.partition(" ")
        assert point[1] == error
        assert number in words.split(" " + geometry[:3])[0].split(", ")
        assert words.endswith(geometry.replace("_", " "))
    by_height = [names[height] for height in sorted(names)]
    assert by_height == ["2 corotational", "1, 2 negative stiffness", "1, 4 corotational", "linearized"]


def test_samplings_of_several_models_say_whose_they_are():
    dataset = traded(["event"])
    words = {}
    for models in (["rigid"] * len(MODELS), ["rigid", "1 corotational"] * (len(MODELS) // 2)):
        dataset["part"][2:], dataset["step"][2:], dataset["model"][2:] = "data", "half", models
        words[len(set(models))] = {text.get_text() for text in figure("work_precision", dataset).axes[1].texts}
    assert words == {1: {"half"}, 2: {"half, rigid", "half, 1 corotational"}}


def with_evaluations(dataset):
    n = dataset.sizes["setting"]
    return dataset.assign(n_rhs=(("setting", "case"), np.geomspace(10.0, 1e4, n)[:, None])).assign_attrs(axes="")


@pytest.mark.parametrize(("width", "across"), [(90, 1), (120, 2), (180, 3)])
def test_panels_stand_beside_one_another_where_there_is_room(width, across):
    whole = rockcli.plot(with_evaluations(traded(["event", "frame"])), "work_precision", width=width)
    whole.draw_without_rendering()
    assert [axes.get_title() for axes in whole.axes] == ["numerics", "numerics", "models, at accuracy standard"]
    high = [round(axes.get_position().y0, 2) for axes in whole.axes]
    assert high.count(high[0]) == across
    time, evaluations, models = whole.axes
    assert time.get_ylim() == evaluations.get_ylim()
    low, high = models.get_ylim()  # its own scale: the points take more than half of it
    assert np.log(max(MODELS.values()) / min(MODELS.values())) > 0.5 * np.log(high / low)


@pytest.mark.parametrize("width", [90, 120, 180])
@pytest.mark.parametrize("parts", [("model",), ("model", "data")])
def test_names_do_not_lie_on_one_another(width, parts):
    dataset = traded(["event"])
    again = dataset.isel(setting=slice(2, None)).copy(deep=True)
    again["part"][:] = "data"
    again["step"] = ("setting", [f"every {i}" for i in range(again.sizes["setting"])])
    dataset = xarray.concat([dataset, again], "setting") if "data" in parts else dataset
    whole = rockcli.plot(with_evaluations(dataset), "work_precision", width=width)
    whole.draw_without_rendering()
    for axes in whole.axes[2:]:
        boxes = sorted((text.get_window_extent() for text in axes.texts), key=lambda box: box.y0)
        assert len(boxes) > 3
        assert all(low.y1 <= high.y0 + 1.0 for low, high in pairwise(boxes))
        assert all(box.x1 <= whole.bbox.x1 for box in boxes)


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        ([0.0, 0.0, 0.0], [0.0, 1.0, 2.0]),
        ([0.0, 0.5, 4.0], [0.0, 1.0, 4.0]),
        ([-3.0, 0.0, 3.0], [-3.0, 0.0, 3.0]),
        ([4.4, 4.4], [3.5, 4.5]),
        ([-5.0, -5.0], [-4.5, -3.5]),
    ],
)
def test_places_are_apart_and_inside(wanted, found):
    np.testing.assert_allclose(work_precision._apart(np.array(wanted), 1.0, -5.0, 5.0), found, atol=1e-12)


def test_a_family_looks_the_same_beside_any_other():
    def look(families, of):
        lines = figure("work_precision", traded(families)).axes[0].get_lines()
        (line,) = (line for line in lines if line.get_label() == of)
        return line.get_color(), line.get_linestyle(), line.get_marker()

    for of in ("scipy RK23", "frame"):
        assert look(["event", of], of) == look(["event", "opensees", "scipy RK45", of], of)


def test_every_family_has_a_look_of_its_own():
    assert {f"scipy {name}" for name in METHODS} <= set(work_precision.LOOKS)
    seen = list(work_precision.LOOKS.values())
    assert len({(colour, line) for colour, line, _ in seen}) == len(seen)
