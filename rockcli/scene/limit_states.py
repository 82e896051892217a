"""Names of the limit states of a suite, and what they say in full."""

from __future__ import annotations

from rockcli.scene.variables import PEAK

OVERTURNED = "overturned"
"""The last limit state of every suite."""


def limit_label(quantity: str, value: float) -> str:
    """The name of a limit state on its axis: `0.5` of theta_peak/alpha, `slide_peak > 0.05 m` of a slide [m]."""
    return f"{value:g}" if quantity == PEAK else f"{quantity} > {value:g} m"


def exceeded_when(label: str) -> str:
    """When a limit state is exceeded: that of a slide also by what overturns, whose rotation exceeds any by itself."""
    return f"{label} or {OVERTURNED}" if ">" in label else label


def in_full(label: str) -> str:
    """A limit state for readers: the bare number of a rotation says what it is of."""
    return label if label == OVERTURNED or ">" in label else f"theta/alpha > {label}"
