"""A body beyond its unstable equilibrium never returns, however little energy it has."""

from __future__ import annotations

import numpy as np
import pytest

from rockcli.engine.run import solve
from rockcli.storage.contents import Contents
from rockcli.study.open import open_study

COLUMN = {"model": "flexible", "column": {"E": 2e10, "rho": 2500.0, "zeta": 0.02, "elements": 2}}


def solved(case: dict[str, object], theta: list[str]) -> Contents:
    block = {"R": 3.0, "tan_alpha": 0.2}
    study = {
        "name": "beyond",
        "case": {"block": block, "initial": {"theta": 0.1}} | case,
        "vary": {"initial.theta": theta},
        "save": {"histories": False},
    }
    return solve(open_study(study))


def outcomes(case: dict[str, object], theta: list[str]) -> list[int]:
    return list(np.asarray(solved(case, theta).values("outcome"), dtype=int))


@pytest.mark.parametrize("base", [{"law": "rigid"}, {"law": "winkler", "kw": 1e9}])
def test_a_column_beyond_its_equilibrium_when_the_report_ends_falls(base: dict[str, object]) -> None:
    case = COLUMN | {"base": base, "motion": {"duration": 0.3}}
    assert outcomes(case, ["0.8*alpha", "1.1*alpha", "2.2*alpha"]) == [1, 2, 2]


@pytest.mark.parametrize("solver", [{"backend": "event"}, {"backend": "frame", "accuracy": "draft"}])
def test_a_soft_column_falls_from_below_alpha(solver: dict[str, object]) -> None:
    """At three times the modulus at which it buckles the equilibrium is at .73 alpha."""
    soft = COLUMN | {"column": {"E": 1.65e7, "rho": 2500.0, "zeta": 0.02, "elements": 2}, "solver": solver}
    times = []
    for motion in (None, {"duration": 0.2}):
        found = solved(soft | {"motion": motion}, ["0.6*alpha", "0.85*alpha", "0.95*alpha"])
        assert list(np.asarray(found.values("outcome"), dtype=int)) == [1, 2, 2]
        times.append(found.values("t_overturn"))
    np.testing.assert_array_equal(times[0], times[1])
    assert times[0][1] == 0.0


def test_a_body_on_soft_fibres_falls_from_below_alpha() -> None:
    """On fibres of 3e7 N/m³ the equilibrium of a body of R = 10 m is at about .86 alpha."""
    case = {
        "block": {"R": 10.0, "tan_alpha": 0.2},
        "model": 4,
        "geometry": "corotational",
        "damping": {"scheme": "hht"},
        "base": {"law": "winkler", "kw": 3e7, "fibres": 21},
        "solver": {"backend": "frame", "dt": 2e-3},
    }
    for motion in (None, {"duration": 0.2}):
        assert outcomes(case | {"motion": motion}, ["0.8*alpha", "0.95*alpha"]) == [1, 2]


@pytest.mark.parametrize("damping", ["restitution", "dashpot"])
@pytest.mark.parametrize("geometry", ["negative_stiffness", "corotational"])
def test_a_frame_beyond_its_equilibrium_falls(damping: str, geometry: str) -> None:
    case = {"model": 3, "geometry": geometry, "damping": damping}
    for solver in ({"backend": "event"}, {"backend": "frame", "accuracy": "draft"}):
        assert outcomes(case | {"solver": solver}, ["0.8*alpha", "1.1*alpha", "2.2*alpha"]) == [1, 2, 2]


def test_a_body_let_go_beyond_its_equilibrium_overturns_from_the_start() -> None:
    rigid = {"model": 3, "geometry": "corotational"}
    for case in (
        rigid | {"solver": {"backend": "event"}},
        rigid | {"solver": {"backend": "scipy"}},
        rigid | {"solver": {"backend": "frame", "accuracy": "draft"}},
        COLUMN,
        COLUMN | {"motion": {"duration": 0.3}},
    ):
        times = np.asarray(solved(case, ["0.8*alpha", "1.1*alpha", "2.2*alpha"]).values("t_overturn"))
        np.testing.assert_array_equal(times, [np.nan, 0.0, 0.0], err_msg=str(case))


@pytest.mark.parametrize("toward", ["left", "right"])
def test_a_column_that_falls_after_the_report_is_told_as_model_3_in_its_limit(toward: str) -> None:
    s = 1.0 if toward == "right" else -1.0
    stiff = {"model": "flexible", "column": {"E": 1e16, "rho": 2500.0, "zeta": 0.0, "elements": 1}}
    case = {"initial": {"theta_dot": -1.2 * s}, "motion": {"duration": 0.05}, "damping": "none"}
    theta = [f"{0.3 * s}*alpha", f"{0.5 * s}*alpha"]
    column = solved(stiff | case, theta)
    limit = solved({"model": 3, "geometry": "corotational"} | case, theta)
    for name in ("outcome", "theta_peak", "n_impacts"):
        np.testing.assert_array_equal(column.values(name), limit.values(name), err_msg=name)
    assert (column.values("outcome") == 3).all()
    np.testing.assert_allclose(column.values("t_overturn"), limit.values("t_overturn"), rtol=1e-5)


def test_a_fall_ends_as_the_column_reaches_the_ground_not_with_the_step_it_does_in() -> None:
    stiff = {"model": "flexible", "column": {"E": 1e16, "rho": 2500.0, "zeta": 0.0, "elements": 1}}
    case = {"initial": {"theta_dot": 1.2}, "damping": "none"}
    theta = ["0.3*alpha", "0.5*alpha", "1.1*alpha"]
    column = solved(stiff | case | {"solver": {"accuracy": "draft"}}, theta)
    limit = solved({"model": 3, "geometry": "corotational"} | case, theta)
    np.testing.assert_allclose(column.values("t_end"), limit.values("t_end"), rtol=1e-5)
