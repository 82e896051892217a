"""What a search found, in words."""

import numpy as np
import pytest

from rockcli.scene.thresholds import WHY_NOT, threshold_words

R, records = np.array([1.0, 2.0]), np.array(["one.AT2", "two.AT2"], dtype=object)


@pytest.mark.parametrize(
    ("values", "axes", "words"),
    [
        (2.5, {}, "from 2.5 on"),
        (np.inf, {}, "not at all"),
        ([3.0, 1.5], {"R": R}, "from 1.5 (R=2) to 3 (R=1) on"),
        ([np.nan, 1.5], {"R": R}, f"from 1.5 (R=2) on; not found in 1 of 2 cases: {WHY_NOT}"),
        (np.nan, {}, f"not found: {WHY_NOT}"),
        (
            [[3.0, np.inf], [np.inf, 4.25]],
            {"record": records, "R": R},
            "from 3 (record=one.AT2, R=1) to 4.25 (record=two.AT2, R=2) on; not at all in 2 of 4 cases",
        ),
    ],
)
def test_words(values, axes, words):
    assert threshold_words(np.array(values), axes) == words
