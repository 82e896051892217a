"""Clauses of `expect` on plain arrays: NaN satisfies nothing, infinity equals infinity."""

from __future__ import annotations

import numpy as np
import pytest
from handmade import MODEL, SLENDER, clause, make_study

from rockcli.analysis.expect import check_quantities, describe, expected_failures, judge
from rockcli.errors import StudyError
from rockcli.scene.response import FAILED, OVERTURNED_AFTER_IMPACT, ROCKING, UNRESOLVED
from rockcli.storage.contents import Contents, axis_field, time_field, variable_field

NAN, INF = np.nan, np.inf


def contents(**arrays: object) -> Contents:
    """A dataset over tan_alpha with the variables given; 2-D ones are histories or impacts."""
    fields = {"tan_alpha": axis_field("tan_alpha", "block.tan_alpha", (0.1, 0.2, 0.3), numeric=True, unit="1")}
    for name, values in arrays.items():
        array = np.asarray(values)
        if array.ndim == 2 and name == "theta":
            fields["time"] = time_field(np.arange(array.shape[1]) * 0.5)
        dims = ("tan_alpha", "time" if name == "theta" else "impact")[: array.ndim]
        fields[name] = variable_field(name, dims, array)
    return Contents(("tan_alpha",), fields, {})


def verdict(found: Contents, *args: object, **more: object):  # type: ignore[no-untyped-def]
    return judge(found, (clause(*args, **more),))[0]  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("values", "check", "target", "failing"),
    [
        ([0.5, 0.5, 0.5], "value", 0.5, 0),
        ([0.5, 0.5, 0.5 * (1 + 2e-6)], "value", 0.5, 1),
        ([0.5, NAN, 0.5], "value", 0.5, 1),
        ([INF, INF, INF], "value", INF, 0),
        ([INF, 1.0, -INF], "value", INF, 2),
        ([0.1, 0.2, INF], "min", 0.15, 1),
        ([0.1, 0.2, NAN], "max", 0.15, 2),
        ([0.1, 0.15, INF], "max", 0.15, 1),
        ([NAN, NAN, NAN], "max", 1e9, 3),
        ([NAN, NAN, NAN], "min", -1e9, 3),
        ([1.0, 1.0, 1.0], "max", INF, 0),
    ],
)
def test_numbers(values: list[float], check: str, target: float, failing: int) -> None:
    found = verdict(contents(theta_peak_over_alpha=values), "theta_peak_over_alpha", check, target)
    assert (found.points, found.failing, found.passed) == (3, failing, failing == 0)


def test_tolerances_add() -> None:
    found = contents(theta_peak=[1.0, 1.0, 1.11])
    assert verdict(found, "theta_peak", "value", 1.0, rtol=0.1, atol=0.02).passed
    assert not verdict(found, "theta_peak", "value", 1.0, rtol=0.1).passed


def test_the_worst_is_named_with_its_place() -> None:
    found = verdict(contents(theta_peak=[1.0, 1.2, 0.9]), "theta_peak", "value", 1.0)
    assert (found.worst, found.where, found.failing) == ("1.2", "tan_alpha=0.2", 2)
    lost = verdict(contents(theta_peak=[1.0, 1.2, NAN]), "theta_peak", "value", 1.0)
    assert (lost.worst, lost.where) == ("nan", "tan_alpha=0.3")


def test_at_picks_points() -> None:
    found = verdict(contents(theta_peak=[1.0, 2.0, 3.0]), "theta_peak", "value", 2.0, at={"tan_alpha": 0.2})
    assert (found.points, found.passed, found.where) == (1, True, "")
    assert "tan_alpha=0.2" in found.text


def test_outcomes() -> None:
    flags = np.array([ROCKING, ROCKING, OVERTURNED_AFTER_IMPACT], dtype=np.int8)
    found = contents(outcome=flags)
    assert not verdict(found, "outcome", "is", (0, 1)).passed
    assert verdict(found, "outcome", "is", (1, 2, 3)).passed
    bad = verdict(found, "outcome", "is_not", (2, 3))
    assert (bad.failing, bad.worst, bad.where) == (1, "overturned_after_impact", "tan_alpha=0.3")
    assert verdict(found, "outcome", "is_not", (UNRESOLVED,)).passed


def test_a_count_without_answer_satisfies_nothing() -> None:
    found = contents(n_impacts=np.array([0, 2, -1]))
    assert verdict(found, "n_impacts", "max", 5.0).failing == 1


def test_histories_are_read_at_a_time() -> None:
    found = contents(theta=[[0.0, 1.0, 2.0]] * 3)
    assert verdict(found, "theta", "value", 1.0, time=0.5).passed
    assert verdict(found, "theta", "value", 1.5, time=0.75).passed
    assert verdict(found, "theta", "max", 9.0, time=1.5).failing == 3  # after the end there is no answer


def test_padding_is_not_a_point() -> None:
    found = contents(theta=[[0.0, 1.0, NAN], [0.0, NAN, 1.0], [NAN, NAN, NAN]])
    judged = verdict(found, "theta", "max", 2.0)
    assert (judged.points, judged.failing) == (6, 2)  # the gap of the second, the nothing of the third
    impacts = contents(t_impact=[[1.0, 2.0], [1.0, NAN], [NAN, NAN]])
    assert verdict(impacts, "t_impact", "max", 5.0).points == 3
    nothing = verdict(contents(t_impact=np.full((3, 1), NAN)), "t_impact", "max", 5.0)
    assert not nothing.passed


def test_expected_failures_are_known() -> None:
    found = contents(outcome=np.array([FAILED, FAILED, ROCKING], dtype=np.int8))
    clauses = (clause("outcome", "is", (FAILED,), at={"tan_alpha": 0.2}),)
    for at in (slice(0, 3), slice(0, 1), slice(1, 3), slice(2, 3)):
        assert expected_failures(found, clauses, (at,)).tolist() == [False, True, False][at]
    assert not expected_failures(found, (clause("outcome", "is_not", (FAILED,)),), (slice(0, 3),)).any()


def test_clauses_about_what_is_not_saved_are_refused() -> None:
    check_quantities(make_study(MODEL, SLENDER, expect=(clause("alpha", "max", 1.0),)))
    for quantity in ("theta", "error_history", "thetta"):
        study = make_study(MODEL, expect=(clause(quantity, "max", 1.0, line=7),))
        with pytest.raises(StudyError) as caught:
            check_quantities(study)
        assert caught.value.line == 7
    check_quantities(make_study(MODEL, histories=True, expect=(clause("theta", "max", 1.0),)))
    check_quantities(make_study(MODEL, compare_to={"model": "rigid"}, expect=(clause("same_outcome", "min", 1.0),)))


def test_clauses_in_words() -> None:
    nothing = contents()
    assert (
        describe(nothing, clause("theta", "value", 0.5, time=2.0, atol=1e-3))
        == "theta at t = 2 s = 0.5 (rtol 1e-06, atol 0.001)"
    )
    assert describe(nothing, clause("outcome", "is_not", (2, 3))) == (
        "outcome is not overturned_without_impact or overturned_after_impact"
    )
    assert describe(nothing, clause("t_end", "max", INF, at={"model": "rigid"})) == "t_end at model=rigid <= inf"
