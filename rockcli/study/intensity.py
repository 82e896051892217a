"""Names of intensities: what a study may say that fragility is told against."""

from __future__ import annotations

import re

SPECTRAL = re.compile(r"sa\(\s*([0-9.eE+-]+)\s*(?:s)?\s*\)", re.IGNORECASE)

KNOWN = ("pga", "pgv", "pgv_over_pga", "sa(T)", "arias", "cav")
"""Offered beside any numeric axis."""


def period_of(name: str) -> float | None:
    """The period T [s] of `sa(T)`; None for any other name.  ValueError if it is no positive number."""
    match = SPECTRAL.fullmatch(name.strip())
    if match is None:
        return None
    period = float(match[1])
    if not 0.0 < period < float("inf"):
        raise ValueError(f"{match[1]} is no period")
    return period
