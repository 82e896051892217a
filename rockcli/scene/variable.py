"""What is said of a variable of the dataset."""

from __future__ import annotations

from dataclasses import dataclass

CASE, TIME, IMPACT, ROTATION = "case", "time", "impact", "rotation"
SUITE, LIMIT, MEASURE = "suite", "limit_state", "measure"
SETTING = "setting"


PEAK = "theta_peak_over_alpha"
"""The peak that figures, suites and comparisons speak of."""

COUNTS = ("n_impacts", "n_steps", "n_rhs")
"""Scalars that are whole numbers."""


@dataclass(frozen=True)
class Variable:
    """A row: `over` is CASE (the axes), TIME (axes, time), IMPACT (axes, impact),
    ROTATION (axes, rotation: static curves), SUITE (the axes but that of `over`), LIMIT (the same, limit_state),
    MEASURE (the same, measure) or SETTING (setting: `rock trade`); unit "1" = dimensionless.
    """

    name: str
    symbol: str
    over: str
    unit: str
    sentence: str
