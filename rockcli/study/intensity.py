"""Names of intensities: what a study may say that fragility is told against."""

from __future__ import annotations

import re

SPECTRAL = re.compile(r"sa\(\s*([0-9.eE+-]+)\s*(?:s)?\s*\)", re.IGNORECASE)

KNOWN = ("pga", "pgv", "pgv_over_pga", "sa(T)", "arias", "cav")
"""Offered beside any numeric axis; of the motion that the body stands on."""

GROUND = "ground_"
"""Begins the names of those of the ground, below floors and isolators."""

OF_GROUND = tuple(f"{GROUND}{name}" for name in ("pga", "pgv", "sa(T)"))


def bare(name: str) -> str:
    """The name of an intensity without what says that it is the ground's."""
    return name.strip().removeprefix(GROUND)


def period_of(name: str) -> float | None:
    """The period T [s] of `sa(T)` or `ground_sa(T)`, None for other names; ValueError if it is no positive number."""
    match = SPECTRAL.fullmatch(bare(name))
    if match is None:
        return None
    period = float(match[1])
    if not 0.0 < period < float("inf"):
        raise ValueError(f"{match[1]} is no period")
    return period
