"""Cases go to their places, and one bad case never loses the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from handmade import MODEL, SLENDER, answer, make_study, solve_by

from rockcli.analysis.measures import peaks
from rockcli.engine.backends import choose
from rockcli.engine.run import solve
from rockcli.engine.sweep.sweep import solve_cases
from rockcli.errors import SolverError, StudyError
from rockcli.scene.backends import BACKENDS
from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import Samples
from rockcli.scene.ground.pulses import make_pulses
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import FAILED, ROCKING, Response
from rockcli.storage.reduced import reduce


def test_results_stand_where_their_case_stands(monkeypatch: pytest.MonkeyPatch) -> None:
    solve_by(monkeypatch, answer)
    done = []
    found = solve(make_study(SLENDER, MODEL, most=4), progress=lambda *state: done.append(state))
    np.testing.assert_array_equal(found.values("theta_peak_over_alpha"), 0.01 * np.arange(6.0).reshape(3, 2))
    assert done == [(6, 6)]
    assert found.values("theta_peak").shape == (3, 2)
    assert np.isnan(found.values("theta_peak")).all()  # the solver did not say
    assert (found.values("n_steps") == -1).all()


def test_one_bad_case_never_loses_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    def solver(batch: Batch) -> Response:
        if 4.0 in batch.theta_0:
            raise FloatingPointError("overflow")
        return answer(batch)

    solve_by(monkeypatch, solver)
    found = solve(make_study(SLENDER, MODEL))
    assert found.values("outcome").ravel().tolist() == [ROCKING] * 4 + [FAILED, ROCKING]
    assert np.isnan(found.values("theta_peak_over_alpha")[2, 0])
    assert found.values("n_impacts")[2, 0] == -1
    sentence = found.values("reasons")[found.values("reason")[2, 0]]
    assert sentence == "the solver broke: FloatingPointError: overflow"
    assert found.values("reasons")[0] == ""


def test_a_solver_that_always_breaks_is_not_tried_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []

    def solver(batch: Batch) -> Response:
        calls.append(batch.size)
        raise ZeroDivisionError

    solve_by(monkeypatch, solver)
    many = replace(SLENDER, values=tuple(np.linspace(0.1, 0.3, 900)))
    found = solve(make_study(many))
    assert (found.values("outcome") == FAILED).all()
    assert len(calls) < 200


def test_what_no_backend_solves_fails_with_a_sentence() -> None:
    _, batch = next(iter(make_study().batches()))
    other = replace(batch, model="jelly")
    with pytest.raises(SolverError, match="no backend solves model 'jelly' with damping 'none'"):
        choose(other)
    with pytest.raises(SolverError, match="no backend 'slide_rule'; there are event"):
        choose(replace(batch, numerics=Numerics(backend="slide_rule")))
    assert choose(batch) is BACKENDS["event"]


def test_a_study_error_while_building_cases_is_the_users(monkeypatch: pytest.MonkeyPatch) -> None:
    def solver(batch: Batch) -> Response:
        raise StudyError("no such thing")

    solve_by(monkeypatch, solver)
    with pytest.raises(StudyError):
        solve(make_study())


def test_histories_share_the_longest_time_axis(monkeypatch: pytest.MonkeyPatch) -> None:
    def solver(batch: Batch) -> Response:
        k = 3 + int(batch.theta_0[0])
        n = batch.size
        return replace(
            answer(batch),
            time=np.arange(k) * 0.5,
            histories={"theta": np.ones((n, k)) * batch.theta_0[:, None]},
            impacts={"t_impact": np.ones((n, k - 3))},
        )

    solve_by(monkeypatch, solver)
    results = solve_cases(make_study(SLENDER, most=1, histories=True))
    np.testing.assert_array_equal(results.time, np.arange(5) * 0.5)
    np.testing.assert_array_equal(np.isfinite(results.histories["theta"]).sum(axis=1), [3, 4, 5])
    np.testing.assert_array_equal(np.isfinite(results.impacts["t_impact"]).sum(axis=1), [0, 1, 2])


def test_without_any_impact_the_dimension_still_exists(monkeypatch: pytest.MonkeyPatch) -> None:
    def solver(batch: Batch) -> Response:
        return replace(answer(batch), impacts={"t_impact": np.empty((batch.size, 0))})

    solve_by(monkeypatch, solver)
    assert solve(make_study(histories=True)).sizes["impact"] == 1


def test_sentences_are_numbered_by_the_first_case_that_has_them(monkeypatch: pytest.MonkeyPatch) -> None:
    words = {0: "b", 1: "", 2: "a", 3: "b", 4: "c", 5: "a"}

    def solver(batch: Batch) -> Response:
        return replace(answer(batch), reasons=[words[int(i)] for i in batch.theta_0])

    solve_by(monkeypatch, solver)
    study = make_study(SLENDER, MODEL)
    backwards = replace(study, cases=_Backwards(study.cases))
    for one in (study, backwards):
        found = solve(one)
        assert found.values("reasons").tolist() == ["", "b", "a", "c"]
        assert found.values("reason").ravel().tolist() == [1, 0, 2, 1, 3, 2]


class _Backwards:
    def __init__(self, cases: object) -> None:
        self.cases = cases

    def batches(self, indices):  # type: ignore[no-untyped-def]
        for start in reversed(range(0, len(indices), 2)):
            yield from self.cases.batches(indices[start : start + 2])  # type: ignore[attr-defined]


def test_symbols_lose_the_axes_they_do_not_depend_on() -> None:
    rows = np.array([[1.0, 1.0], [2.0, 2.0], [np.nan, np.nan]])
    dims, values = reduce(rows, ("x", "y"))
    assert dims == ("x",)
    np.testing.assert_array_equal(values, [1.0, 2.0, np.nan])
    assert reduce(rows.T, ("y", "x"))[0] == ("x",)
    assert reduce(np.full((3, 2), 7.0), ("x", "y"))[0] == ()
    assert reduce(np.arange(6.0).reshape(3, 2), ("x", "y"))[0] == ("x", "y")


def test_peaks_of_pulses_are_those_of_the_formulas() -> None:
    a_p, omega_p = np.array([2.0, 3.0, 3.0]), np.array([np.pi, np.pi, 2.0 * np.pi])
    pga, pgv = peaks(make_pulses("sine", a_p=a_p, omega_p=omega_p), 3)
    np.testing.assert_allclose(pga, a_p, rtol=1e-12)
    np.testing.assert_allclose(pgv, 2.0 * a_p / omega_p, rtol=1e-6)
    pga, pgv = peaks(make_pulses("rectangular", a_p=a_p, omega_p=omega_p), 3)
    np.testing.assert_allclose(pga, a_p, rtol=1e-12)
    np.testing.assert_allclose(pgv, a_p * np.pi / omega_p, rtol=1e-12)
    pga, _ = peaks(make_pulses("ricker", a_p=a_p, omega_p=omega_p), 3)
    np.testing.assert_allclose(pga, a_p, rtol=1e-12)


def test_peaks_of_records_follow_their_factor() -> None:
    record = Samples(np.zeros(3), 0.01, np.array([1.0, -2.0]), measures={"pga": 3.0, "pgv": 0.5})
    pga, pgv = peaks(record, 2)
    assert pga.tolist() == [3.0, 6.0]
    assert pgv.tolist() == [0.5, 1.0]
    assert np.isnan(peaks(None, 2)).all()
