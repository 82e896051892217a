"""What a search found, in words."""

import numpy as np
import pytest

from rockcli.scene.thresholds import BELOW, BRACKETED, IN_RANGE, NONE, Thresholds, threshold_words

R, RECORDS = np.array([1.0, 2.0]), np.array(["one.AT2", "two.AT2"], dtype=object)


def found(state, low, high, islands=0, island_low=np.nan, island_high=np.nan, rocks=0) -> Thresholds:
    columns = np.broadcast_arrays(*map(np.asarray, (state, low, high, islands, island_low, island_high, rocks)))
    types = (np.int8, float, float, np.int64, float, float, np.int8)
    return Thresholds(*(column.astype(kind) for column, kind in zip(columns, types, strict=True)))


@pytest.mark.parametrize(
    ("thresholds", "axes", "words"),
    [
        (found(IN_RANGE, 2.4, 2.5), {}, "2.5 m/s²"),
        (found(NONE, 9.0, np.inf), {}, "none up to 9 m/s²"),
        (found(BELOW, -np.inf, 4.0), {}, "below the range, whose lowest point 4 m/s² overturns already"),
        (found(BRACKETED, 1.0, 4.0), {}, "above 1 m/s² and at most 4 m/s², as a point on the way has no answer"),
        (found(BRACKETED, -np.inf, np.inf), {}, "not known, as a point on the way has no answer"),
        (found(IN_RANGE, 2.4, 2.5, 1, 6.0, 7.0), {}, "2.5 m/s²; stable islands above it at 6 m/s² to 7 m/s²"),
        (found(IN_RANGE, 2.4, 2.5, 1, 6.0, 6.0), {}, "2.5 m/s²; stable islands above it at 6 m/s²"),
        (
            found(IN_RANGE, 2.4, 2.5, rocks=1),
            {},
            "2.5 m/s²; rocks at the lowest point of the range already, and may overturn below it",
        ),
        (
            found([0, 1], [2.4, 9.0], [2.5, np.inf], rocks=[0, 1]),
            {"R": R},
            "2.5 m/s² (R=1); none up to 9 m/s² (R=2) in 1 of 2 cases; "
            "rocks at the lowest point of the range already in 1 of 2 cases, and may overturn below it",
        ),
        (found([0, 0], [2.9, 1.4], [3.0, 1.5]), {"R": R}, "1.5 m/s² (R=2) to 3 m/s² (R=1)"),
        (
            found([[0, 1], [2, 3]], [[2.9, 9], [-np.inf, 5]], [[3, np.inf], [1, np.inf]], [[2, 0], [0, 0]], 6.0, 7.0),
            {"record": RECORDS, "R": R},
            "3 m/s² (record=one.AT2, R=1); none up to 9 m/s² (record=one.AT2, R=2) in 1 of 4 cases; "
            "below the range, whose lowest point 1 m/s² overturns already (record=two.AT2, R=1) in 1 of 4 cases; "
            "above 5 m/s², as a point on the way has no answer (record=two.AT2, R=2) in 1 of 4 cases; "
            "stable islands above it at 6 m/s² to 7 m/s² (record=one.AT2, R=1) in 1 of 4 cases",
        ),
    ],
)
def test_words(thresholds, axes, words):
    assert threshold_words(thresholds, axes, "m s-2") == words


@pytest.mark.parametrize(
    ("state", "low", "high", "words"),
    [
        (IN_RANGE, 2.5, 2.5, "2.5"),
        (NONE, 5.0, np.inf, "censored: above 5"),
        (BELOW, -np.inf, 4.0, "censored: at most 4"),
        (BRACKETED, 1.0, 4.0, "censored: above 1 and at most 4"),
        (BRACKETED, -np.inf, np.inf, "censored: not known"),
    ],
)
def test_words_of_a_statistic(state, low, high, words):
    assert (
        threshold_words(Thresholds(np.int8(state) + np.zeros((), np.int8), np.array(low), np.array(high)), {}) == words
    )


def test_a_dataset_without_states_is_read_as_far_as_it_goes():
    """Of a file written before there were states: a number is found, inf is none, NaN says nothing."""
    values = {"x_overturning": np.array([2.0, np.inf, np.nan])}
    read = Thresholds.read("x_overturning", values.get)
    assert read.state.tolist() == [IN_RANGE, NONE, BRACKETED]
    np.testing.assert_array_equal(read.value, values["x_overturning"])
