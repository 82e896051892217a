"""`Response`, the output of every solver: outcomes and other results by name, over the cases of its batch.

A failure is a result with a message; overturning is a result; neither is an exception.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

FAILED, UNRESOLVED, NO_UPLIFT, ROCKING, OVERTURNED_WITHOUT_IMPACT, OVERTURNED_AFTER_IMPACT, SLIDING = range(-2, 5)

OUTCOMES: dict[int, str] = {
    FAILED: "failed",
    UNRESOLVED: "unresolved",
    NO_UPLIFT: "no_uplift",
    SLIDING: "sliding",
    ROCKING: "rocking",
    OVERTURNED_WITHOUT_IMPACT: "overturned_without_impact",
    OVERTURNED_AFTER_IMPACT: "overturned_after_impact",
}
"""Names of the flags, in the order for people.  SLIDING: moved along the ground and never lifted."""

_MODES = {"overturned_after_impact": " (mode 1)", "overturned_without_impact": " (mode 2)"}
"""The modes of overturning of Zhang and Makris (2001)."""

MAX_IMPACTS_STORED = 1000
"""Impacts kept per case; more are counted, not stored, and a message says so."""


def outcome_words(name: str) -> str:
    """The name of an outcome for people: `overturned after impact (mode 1)`."""
    return name.replace("_", " ") + _MODES.get(name, "")


def overturned(outcome: ArrayLike) -> NDArray[np.bool_]:
    """Where outcomes mean that the body overturned."""
    return np.isin(outcome, (OVERTURNED_WITHOUT_IMPACT, OVERTURNED_AFTER_IMPACT))


@dataclass(frozen=True, eq=False)
class Response:
    """Results of a batch of n cases.

    Attributes:
        scalars: by variable name (scene/variables.py), (n,); `outcome` is int8, counts are int64.
        reasons: one sentence per case, "" where there is nothing to say, length n.
        time: output times (k,) [s], empty without histories.
        histories: by variable name, (n, k); NaN after a case's t_end.  Not the ground's: it follows from the motion.
        impacts: `t_impact`, `theta_dot_before`, `theta_dot_after`, (n, j), NaN-padded, j <= MAX_IMPACTS_STORED.
        used: what was actually used: backend, method, tolerances.
        apart: rows and what was used for them, where some were solved otherwise than others; else empty.
        shaken: of a_g and a_v: at how many of the output times the dataset tells them, (n,); None: as long as theta.
    """

    scalars: dict[str, NDArray[np.generic]]
    reasons: list[str]
    time: Array = field(default_factory=lambda: np.empty(0))
    histories: dict[str, Array] = field(default_factory=dict)
    impacts: dict[str, Array] = field(default_factory=dict)
    used: dict[str, str] = field(default_factory=dict)
    shaken: dict[str, NDArray[np.int64]] | None = None
    apart: tuple[tuple[NDArray[np.int64], dict[str, str]], ...] = ()


def merged(n: int, pieces: Sequence[tuple[NDArray[np.int64], Response]]) -> Response:
    """One response of n cases from those of parts of them, by their places; histories are as long as the longest."""
    time = max((piece.time for _, piece in pieces), key=len)
    first = pieces[0][1]

    def put(values: Sequence[NDArray[Any]]) -> NDArray[Any]:
        width = max((of.shape[1:] for of in values), default=())
        whole = np.full((n, *width), np.nan if values[0].dtype.kind == "f" else 0, dtype=values[0].dtype)
        for (at, _), of in zip(pieces, values, strict=True):
            if width:
                whole[at, : of.shape[1]] = of
            else:
                whole[at] = of
        return whole

    reasons = [""] * n
    for at, piece in pieces:
        for i, said in zip(at.tolist(), piece.reasons, strict=True):
            reasons[i] = said
    return replace(
        first,
        scalars={name: put([piece.scalars[name] for _, piece in pieces]) for name in first.scalars},
        reasons=reasons,
        time=time,
        histories={name: put([piece.histories[name] for _, piece in pieces]) for name in first.histories},
        impacts={name: put([piece.impacts[name] for _, piece in pieces]) for name in first.impacts},
        apart=tuple((at, piece.used) for at, piece in pieces),
    )
