"""The figure of samples: what it draws is what the dataset has."""

from __future__ import annotations

import numpy as np
import pytest

import rockcli
from rockcli.plotting.figures import default_kinds, figure, why_not
from rockcli.scene.looks import Look


def study(**more):
    return {
        "name": "free",
        "case": {"block": {"R": 2.0, "alpha": 0.2}, "initial": {"theta_dot": 0.5}, "damping": "none"},
        "uncertain": {"block.R": {"lognormal": [2.0, 0.3]}, "initial.theta_dot": {"normal": [0.5, 0.1]}},
        "samples": 64,
        "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]},
    } | more


def test_exceedance_ends_at_the_probability_and_bars_are_correlations():
    data = rockcli.run(study())
    assert default_kinds(data) == ("samples",)
    left, right = figure("samples", data).axes
    x, y = left.lines[0].get_data()
    peaks = data.theta_peak_over_alpha.values
    assert y[0] == 1.0
    assert y[-1] == pytest.approx(float(data.p_overturned))
    assert y[np.searchsorted(x, 0.8, side="right") - 1] == pytest.approx(np.mean(peaks > 0.8))
    assert sorted(bar.get_width() for bar in right.patches) == pytest.approx(sorted(data.input_spearman.values))
    assert right.get_xlabel() == "rank correlation with the peak (Spearman)"
    assert figure("samples", data, Look(width=90.0)).axes[1].get_xlabel().count("\n") == 2
    assert max(left.get_xticks()) <= x[-1] < left.get_xlim()[1]  # where the points are the axis has no numbers


@pytest.mark.parametrize(("rate", "bottom"), [(1.0, False), (3.0, True)])
def test_where_most_overturn_the_axis_begins_below_that(rate, bottom):
    data = rockcli.run(study())
    data["p_overturned_ci_low"][...] = 0.3 * rate
    low, high = figure("samples", data).axes[0].get_ylim()
    assert (low > 0.5) == bottom
    assert low < 0.3 * rate < high


def test_sobol_indices_are_drawn_where_the_design_has_them():
    data = rockcli.run(study(sampling="saltelli"))
    _, right = figure("samples", data).axes
    outer = [bar.get_width() for bar in right.patches][:2]
    assert outer == pytest.approx(data.sobol_total.values)
    assert "Sobol" in right.get_xlabel()


def test_inputs_of_the_vertical_motion_are_called_so():
    record = {"record": {"file": "synthetic_rock_m65.AT2", "pga": 3.0}}
    case = {"block": {"R": 2.0, "alpha": 0.2}, "motion": {**record, "vertical": record}}
    uncertain = {f"motion.{of}record.pga": {"uniform": [1.0, 4.0]} for of in ("", "vertical.")}
    _, right = figure("samples", rockcli.run(study(case=case, uncertain=uncertain, samples=8))).axes
    assert [tick.get_text() for tick in right.get_yticklabels()] == ["PGA", "vertical PGA"]


def test_several_axes_of_an_ensemble_are_one_in_every_figure_of_suites():
    vary = {"block.mass": [1.0, 2.0, 3.0], "initial.theta": [0.0, 0.01]}
    data = rockcli.run(study(vary=vary, over=["mass", "initial.theta", "sample"]))
    left, _ = figure("samples", data).axes
    assert left.lines[0].get_ydata()[-1] == pytest.approx(float(data.p_overturned))


def test_without_samples_it_says_why():
    data = rockcli.run({k: v for k, v in study().items() if k not in ("uncertain", "samples")})
    assert "uncertain" in why_not("samples", data)
