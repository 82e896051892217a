"""A case's response in the measures of its own edges, with its impacts, and the part of it worth showing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rockcli.plotting.common.cases import Array, has_overturned, number_at, values_at
from rockcli.scene.body.block import LEFT, RIGHT

if TYPE_CHECKING:
    import xarray

SHOWN_UP_TO = 1.3
"""|theta|/alpha beyond which an overturning body is no longer followed."""

_SEEN = 0.005
"""Fraction of the largest rotation below which nothing is seen."""

_COMPARABLE = 0.5
"""Quiet time before or after the response, over its length, up to which it is shown."""

_SHORTEST, _AT_LEAST = 1.0, 0.05
"""Shortest part that is shown: that long [s] or this part of the whole, for a body that hardly moves."""

_BEFORE, _AFTER = 0.12, 0.06
"""Time left before and after a response that is cut out, over its length."""

Position = tuple[int, ...]


@dataclass(frozen=True)
class Response:
    """A case over time: theta/alpha and theta_dot/(p alpha) by the edge it turns about, theta_dot [rad/s].

    An impact is two points at the same time, just before and just after.
    """

    time: Array
    ratio: Array
    rate: Array
    theta_dot: Array


@dataclass(frozen=True)
class Window:
    """The part [start, end] of [0, whole] that is worth showing [s]."""

    start: float
    end: float
    whole: float

    @property
    def note(self) -> str:
        """Says that there is more than is shown."""
        cut = self.start > 0.0 or self.end < self.whole * (1.0 - 1e-9)
        return f"t = {self.start:.3g} \N{HORIZONTAL ELLIPSIS} {self.end:.3g} of {self.whole:.3g} s" if cut else ""


def edges(dataset: xarray.Dataset, name: str, position: Position) -> Array:
    """`alpha`, `p`, ... of the left and right edge: the same for a symmetric body."""
    if f"{name}_left" in dataset.variables:
        return np.array([number_at(dataset, f"{name}_{side}", position) for side in ("left", "right")])
    return np.full(2, number_at(dataset, name, position))


def symmetric(dataset: xarray.Dataset, position: Position) -> bool:
    """Whether both edges are alike."""
    alpha, p = edges(dataset, "alpha", position), edges(dataset, "p", position)
    return bool(alpha[LEFT] == alpha[RIGHT] and p[LEFT] == p[RIGHT])


def over_alpha(dataset: xarray.Dataset, position: Position, theta: Array) -> Array:
    """Rotations over the alpha of their side of a case."""
    alpha = edges(dataset, "alpha", position)
    return np.asarray(theta / np.where(theta < 0.0, alpha[LEFT], alpha[RIGHT]))


def response_of(dataset: xarray.Dataset, position: Position, *, apart: bool = False) -> Response:
    """The response of a case; `apart` leaves a gap (NaN) between the two points of an impact."""
    time = np.asarray(dataset["time"].values, dtype=float)
    theta, theta_dot = (values_at(dataset, name, position) for name in ("theta", "theta_dot"))
    turned = np.where(theta == 0.0, theta_dot, theta)  # about to turn to that side
    t, before, after = impacts_of(dataset, position)
    if len(t):
        count = 3 if apart else 2
        at_rest = _rotation_at(t, time, theta)
        gap = np.full_like(t, np.nan)
        rows = [before, gap, after] if apart else [before, after]
        sides = [-before, gap, after] if apart else [-before, after]
        order = np.lexsort((
            np.repeat(np.arange(count + 1), [len(time), *[len(t)] * count]),
            np.concatenate([time, *[t] * count]),
        ))  # fmt: skip
        time = np.concatenate([time, *[t] * count])[order]
        theta = np.concatenate([theta, *[at_rest] * count])[order]
        theta_dot = np.concatenate([theta_dot, *rows])[order]
        turned = np.concatenate([turned, *sides])[order]
    alpha, p = edges(dataset, "alpha", position), edges(dataset, "p", position)
    left = turned < 0.0
    rate = theta_dot / np.where(left, p[LEFT] * alpha[LEFT], p[RIGHT] * alpha[RIGHT])
    return Response(time, theta / np.where(left, alpha[LEFT], alpha[RIGHT]), rate, theta_dot)


def impacts_of(dataset: xarray.Dataset, position: Position) -> tuple[Array, Array, Array]:
    """Times of the impacts of a case and the rates before and after, empty where they were not saved."""
    names = ("t_impact", "theta_dot_before", "theta_dot_after")
    if any(name not in dataset.variables for name in names):
        return np.empty(0), np.empty(0), np.empty(0)
    t, before, after = (values_at(dataset, name, position) for name in names)
    known = np.isfinite(t) & np.isfinite(before) & np.isfinite(after)
    return t[known], before[known], after[known]


def _rotation_at(t: Array, time: Array, theta: Array) -> Array:
    """Rotation at impacts: 0 where it changes sign, for a body that turns a little before it lands what it has then."""
    known = np.isfinite(theta)
    if not known.any():
        return np.zeros_like(t)
    time, theta = time[known], theta[known]
    after = np.clip(np.searchsorted(time, t), 1, len(time) - 1) if len(time) > 1 else np.zeros(len(t), dtype=int)
    passes = theta[after - 1] * theta[after] <= 0.0
    return np.where(passes, 0.0, np.interp(t, time, theta))


def sliding_speed(dataset: xarray.Dataset, position: Position) -> Array:
    """|Rate of sliding| of a case along the ground (time,) [m/s], 0 where it is not known."""
    if "slide_dot" not in dataset.variables:
        return np.zeros(dataset.sizes["time"])
    return np.asarray(np.abs(np.nan_to_num(values_at(dataset, "slide_dot", position))))


def window(dataset: xarray.Dataset, positions: list[Position]) -> Window:
    """From a little before the first of the cases moves to a little after the last of them has moved or fallen.

    Quiet time that is short beside the response is shown, except after a fall.
    """
    time = np.asarray(dataset["time"].values, dtype=float)
    ratios = [np.abs(over_alpha(dataset, position, values_at(dataset, "theta", position))) for position in positions]
    fell = [has_overturned(dataset, position) for position in positions]
    speeds = [sliding_speed(dataset, position) for position in positions]
    alive = np.any([np.isfinite(ratio) for ratio in ratios], axis=0)
    whole = float(time[alive][-1]) if alive.any() else float(time[-1])
    seen = _SEEN * max(float(np.nanmax(np.minimum(ratio, SHOWN_UP_TO), initial=0.0)) for ratio in ratios)
    first, last, falls = np.inf, 0.0, True
    for ratio, speed, lost in zip(ratios, speeds, fell, strict=True):
        moving = np.flatnonzero((ratio > seen) | (speed > _SEEN * speed.max()))  # NaN compares false
        if not len(moving):
            falls = False
            continue
        final = moving[-1]
        if lost:
            inside = np.flatnonzero(ratio <= SHOWN_UP_TO)
            final = min(final, inside[-1] + 1 if len(inside) else 0)
        falls &= lost
        first = min(first, float(time[max(moving[0] - 1, 0)]))
        last = max(last, float(time[min(final + 1, len(time) - 1)]))
    if not np.isfinite(first) or last <= first:
        return Window(0.0, whole or 1.0, whole or 1.0)
    uplift = [number_at(dataset, "t_uplift", position) for position in positions]
    early = float(np.nanmin(np.maximum(uplift, 0.0), initial=first))
    first = early if first - early <= last - first else first  # else it would be the beginning of nothing to see
    short = 0.5 * (min(_SHORTEST, _AT_LEAST * whole) - (last - first))
    if short > 0.0:
        first, last = max(first - short, 0.0), min(last + short, whole)
    length = last - first
    start = 0.0 if first <= _COMPARABLE * length else first - _BEFORE * length
    comparable = not falls and whole - last <= _COMPARABLE * length
    return Window(start, whole if comparable else min(whole, last + _AFTER * length), whole)
