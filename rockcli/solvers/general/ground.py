"""The motion of the ground as scalar functions of time, cut where it is not smooth."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import LINEAR, WAVES, Channel, Pulses, Samples
from rockcli.solvers.common.duration import durations_of

Array = NDArray[np.float64]
Law = Callable[[float], float]


AFTERWARDS = 1000.0
"""How long a swing under way at the end of the report is followed, times 1/p."""


@dataclass(frozen=True)
class Piece:
    """A stretch of time [t_a, t_b] s over which both accelerations a_g(t), a_v(t) [m/s²] are smooth."""

    t_a: float
    t_b: float
    a_g: Law
    a_v: Law


@dataclass(frozen=True)
class Ground:
    """The motion of one case.

    Attributes:
        t_motion, t_stop: end of the motion and of the report [s].
        has_duration: whether the study gives the end of the report.
        dt: spacing of the samples of a record, infinite for pulses [s].
        detail: steps must not be longer during the motion, lest they miss it: dt, or a quarter of a pulse's period [s].
    """

    horizontal: Channel | None
    vertical: Channel | None
    case: int
    t_motion: float
    t_stop: float
    has_duration: bool
    dt: float
    detail: float

    def pieces(self) -> Iterator[Piece]:
        """Up to t_stop, cut at every sample and at the ends of the parts of a pulse."""
        cuts = np.concatenate(
            [[0.0], *(_cuts(c, self.case) for c in (self.horizontal, self.vertical)), [self.t_motion]]
        )
        cuts = np.unique(cuts[(cuts >= 0.0) & (cuts <= self.t_motion)])
        if len(cuts) > 1:  # cuts of both components that rounding keeps apart are one
            cuts = cuts[np.append(np.diff(cuts) > 1e-12 * self.t_motion, True)]
        for t_a, t_b in pairwise(cuts.tolist()):
            middle = 0.5 * (t_a + t_b)
            yield Piece(t_a, t_b, _law(self.horizontal, self.case, middle), _law(self.vertical, self.case, middle))
        if self.t_stop > self.t_motion:
            yield Piece(self.t_motion, self.t_stop, _silence, _silence)

    def whole(self) -> Piece:
        """The whole report as one piece, kinks and jumps inside: what a script hands to a solver."""
        laws = []
        for channel in (self.horizontal, self.vertical):
            laws.append(_until(self.t_motion, _anywhere(channel, self.case)))
        return Piece(0.0, self.t_stop, *laws)

    def bounds(self, t: float) -> tuple[float, float]:
        """Bounds of |a_g| and |a_v| from t on [m/s²]."""
        if t >= self.t_motion:
            return 0.0, 0.0
        return _bound(self.horizontal, self.case, t), _bound(self.vertical, self.case, t)


def ground_of(batch: Batch, case: int) -> Ground:
    """The motion of one case of a batch."""
    motion = batch.excitation
    channels = (motion.horizontal, motion.vertical)
    end, stop, given = durations_of(batch).of(case)
    dt = min((c.dt for c in channels if isinstance(c, Samples)), default=math.inf)
    periods = (2.0 * math.pi / float(c.omega_p[case]) for c in channels if isinstance(c, Pulses))
    detail = min(dt, 0.25 * min(periods, default=math.inf))
    return Ground(*channels, case, end, stop, given, dt, detail)


def _silence(t: float) -> float:
    return 0.0


def _end(channel: Channel, case: int) -> float:
    return channel.end if isinstance(channel, Samples) else float(channel.end[case])


def _cuts(channel: Channel | None, case: int) -> Array:
    if channel is None:
        return np.empty(0)
    if isinstance(channel, Samples):
        return np.asarray(np.arange(len(channel.values)) * channel.dt, dtype=np.float64)
    return np.unique(channel.table[case, :, :2].ravel())


def _law(channel: Channel | None, case: int, t: float) -> Law:
    """The acceleration around t, continued smoothly beyond its part of the motion."""
    if channel is None or not 0.0 <= t < _end(channel, case):
        return _silence
    if isinstance(channel, Samples):
        i = min(int(t / channel.dt), len(channel.values) - 2)
        factor = float(channel.factor[case])
        a, slope = float(channel.values[i]) * factor, float(channel.values[i + 1] - channel.values[i]) / channel.dt
        slope, begin = slope * factor, i * channel.dt
        return lambda x: a + slope * (x - begin)
    return _pulse(channel, case, t)


def _pulse(channel: Pulses, case: int, t: float) -> Law:
    for row in channel.table[case].tolist():
        if row[0] <= t < row[1]:
            return _part(row)
    return _silence


def _part(row: list[float]) -> Law:
    begin, kind, c = row[0], int(row[2]), row[3:13]
    if kind == LINEAR:
        return lambda x: c[0] + c[1] * (x - begin)
    if kind == WAVES:
        waves = [(A, w, phase) for A, w, phase in (c[1:4], c[4:7], c[7:10]) if A != 0.0]
        return lambda x: sum(A * math.sin(w * (x - c[0]) + phase) for A, w, phase in waves)

    def bell(x: float) -> float:
        y = c[1] * (x - c[0])
        return (c[2] + y * (c[3] + y * (c[4] + y * c[5]))) * math.exp(-0.5 * y * y)

    return bell


def _anywhere(channel: Channel | None, case: int) -> Law:
    """The acceleration at any time, zero outside the motion."""
    if channel is None:
        return _silence
    if isinstance(channel, Samples):
        values, dt, last = (channel.values * channel.factor[case]).tolist(), channel.dt, len(channel.values) - 1

        def sampled(x: float) -> float:
            i = int(x / dt)
            if x < 0.0 or i >= last:
                return float(values[last]) if x == last * dt else 0.0
            return float(values[i] + (values[i + 1] - values[i]) * (x / dt - i))

        return sampled
    parts = [(row[0], row[1], _part(row)) for row in channel.table[case].tolist()]
    return lambda x: next((law(x) for t_a, t_b, law in parts if t_a <= x < t_b), 0.0)


def _until(end: float, law: Law) -> Law:
    return law if law is _silence else lambda x: law(x) if x <= end else 0.0


def _bound(channel: Channel | None, case: int, t: float) -> float:
    if channel is None or t >= _end(channel, case):
        return 0.0
    if isinstance(channel, Samples):
        rest = channel.values[int(t / channel.dt) :]
        return float(np.abs(rest).max() * abs(channel.factor[case]))
    return next((float(row[13]) for row in channel.table[case] if t < row[1]), 0.0)
