"""Errors against a reference, on numbers made by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from handmade import MODEL, SLENDER, answer, make_study, solve_by

from rockcli.analysis.compare_to_reference import locate
from rockcli.engine.run import solve
from rockcli.scene.batch import Batch
from rockcli.scene.response import FAILED, OVERTURNED_AFTER_IMPACT, ROCKING, Response
from rockcli.storage.contents import Contents

ALPHA = np.arctan(0.2)
INF, NAN = np.inf, np.nan


def compared(monkeypatch: pytest.MonkeyPatch, theta: list[list[float]], **scalars: list[float]) -> Contents:
    """Two models (the first is the reference) for one slenderness; theta over alpha at 0, 0.5, 1 ... s."""

    def solver(batch: Batch) -> Response:
        own = batch.theta_0.astype(int)
        values = {name: np.asarray(v)[own] for name, v in scalars.items()}
        rows = np.asarray(theta)[own] * ALPHA
        return replace(answer(batch, **values), time=np.arange(rows.shape[1]) * 0.5, histories={"theta": rows})

    solve_by(monkeypatch, solver)
    return solve(make_study(MODEL, histories=True, compare_to={"model": "rigid"}))


def test_peaks_differ_by_case_minus_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    found = compared(
        monkeypatch, [[0, 0.3, 0.1], [0, 0.2, 0.4]], theta_peak_over_alpha=[0.3, 0.45], outcome=[ROCKING, ROCKING]
    )
    np.testing.assert_allclose(found.values("error_theta_peak_over_alpha"), [0.0, 0.15], atol=1e-15)
    np.testing.assert_allclose(found.values("error_history"), [0.0, 0.3], atol=1e-15)
    assert found.values("same_outcome").tolist() == [1, 1]
    assert found.values("same_outcome").dtype == np.int8


def test_histories_are_compared_until_either_overturns(monkeypatch: pytest.MonkeyPatch) -> None:
    found = compared(
        monkeypatch,
        [[0, 0.1, 0.2, 0.3], [0, 0.15, 0.9, 7.0]],
        theta_peak_over_alpha=[0.3, INF],
        t_overturn=[NAN, 0.9],
        outcome=[ROCKING, OVERTURNED_AFTER_IMPACT],
    )
    assert found.values("error_history")[1] == pytest.approx(0.05)
    assert found.values("error_theta_peak_over_alpha")[1] == INF
    assert found.values("same_outcome").tolist() == [1, 0]


def test_histories_are_compared_where_both_are(monkeypatch: pytest.MonkeyPatch) -> None:
    found = compared(monkeypatch, [[0, 0.1, NAN, NAN], [0, 0.2, 0.9, NAN]])
    assert found.values("error_history")[1] == pytest.approx(0.1)


def test_two_overturned_have_no_difference_but_the_same_outcome(monkeypatch: pytest.MonkeyPatch) -> None:
    flags = [OVERTURNED_AFTER_IMPACT] * 2
    found = compared(monkeypatch, [[0, 1], [0, 1]], theta_peak_over_alpha=[INF, INF], outcome=flags)
    assert np.isnan(found.values("error_theta_peak_over_alpha")).all()
    assert found.values("same_outcome").tolist() == [1, 1]


def test_two_failures_do_not_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    found = compared(monkeypatch, [[NAN, NAN], [NAN, NAN]], outcome=[FAILED, FAILED])
    assert found.values("same_outcome").tolist() == [0, 0]
    assert np.isnan(found.values("error_history")).all()


def test_an_axis_not_named_is_matched(monkeypatch: pytest.MonkeyPatch) -> None:
    solve_by(monkeypatch, answer)
    found = solve(make_study(SLENDER, MODEL, compare_to={"model": "linearized"}))
    np.testing.assert_allclose(found.values("error_theta_peak_over_alpha"), [[-0.01, 0.0]] * 3, atol=1e-15)


def test_places_are_found_to_nine_digits(monkeypatch: pytest.MonkeyPatch) -> None:
    solve_by(monkeypatch, answer)
    found = solve(make_study(SLENDER, MODEL))
    assert locate(found, "tan_alpha", 0.2 * (1 + 1e-10)) == 1
    assert locate(found, "model", "linearized") == 1
    with pytest.raises(KeyError):
        locate(found, "tan_alpha", 0.2001)
