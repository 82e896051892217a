"""Ground acceleration: what a solver integrates over, piece by piece.

A channel is one component of the ground motion of all cases of a batch.  It is zero before its
first piece and after its last; inside a piece it is smooth, so that steps land on its breakpoints.

`Samples`: one recorded motion, linear between samples, times a factor per case.
`Pulses`: an analytic pulse per case, as a table of pieces (see `PIECE_WIDTH`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from hashlib import sha256

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LINEAR, WAVES, BELL = 0, 1, 2
"""Kinds of piece.  With c = row[3:], x the time since the beginning of the motion:

LINEAR  c0 + c1 (t - t_a)
WAVES   sum over j = 0, 1, 2 of A_j sin(w_j (t - c0) + phi_j), A_j w_j phi_j = c[1 + 3j : 4 + 3j]
BELL    (d0 + d1 y + d2 y^2 + d3 y^3) exp(-y^2/2), y = c1 (t - c0), d = c[2:6]
"""

PIECE_WIDTH = 14
"""Columns of a row: t_a, t_b, kind, c0 ... c9, and a bound of |a| over this piece and all later ones."""

AMPLITUDE_COLUMNS = {LINEAR: (3, 4), WAVES: (4, 7, 10), BELL: (5, 6, 7, 8)}
"""Columns of a piece of each kind that are proportional to the amplitude of the pulse."""


@dataclass(frozen=True, eq=False)
class Samples:
    """A recorded motion.

    Attributes:
        values: acceleration, (k,) [m/s²], at times i dt, i = 0 ... k-1; linear between, zero after.
        dt: time between samples [s].
        factor: what each case multiplies the values with, (n,).
        name: the record's file name, a coordinate of the dataset.
        processing: what was done to the record, one sentence each, in order.
        measures: of the motion as processed, before `factor`: pga [m/s²], pgv [m/s], and whatever else
            is known of it; `pga_raw`, `pgv_raw` before any processing.
        files: those it was made from, one or two, as the study names them.
        ground: the motion of the ground, where this is what arrives of it through floors; None: it is the ground's.
    """

    values: Array
    dt: float
    factor: Array
    name: str = ""
    processing: tuple[str, ...] = ()
    measures: dict[str, float] = field(default_factory=dict)
    files: tuple[str, ...] = ()
    ground: Samples | Pulses | None = None

    @property
    def end(self) -> float:
        """Time of the last sample [s]."""
        return (len(self.values) - 1) * self.dt


@dataclass(frozen=True, eq=False)
class Pulses:
    """An analytic pulse per case.

    Attributes:
        table: (n, m, PIECE_WIDTH), rows in time order without gaps.
        shape: its name in the study.
        a_p, omega_p: amplitude [m/s²] and circular frequency [rad/s] of each case, (n,).
    """

    table: Array
    shape: str
    a_p: Array
    omega_p: Array

    @property
    def end(self) -> Array:
        """Time of the end of the last piece, (n,) [s]."""
        return self.table[:, -1, 1]


Channel = Samples | Pulses


@dataclass(frozen=True, eq=False)
class Suite:
    """Recorded motions of which each case has one, for who solves cases of many records together.

    Attributes:
        records: the motions, their factors nothing.
        which: place of each case's motion among them, (n,).
        factor: what each case multiplies its motion with, (n,).
    """

    records: tuple[Samples, ...]
    which: NDArray[np.int64]
    factor: Array

    @property
    def end(self) -> Array:
        """Time of the last sample of each case, (n,) [s]."""
        return np.array([record.end for record in self.records])[self.which]

    def measure(self, name: str) -> Array:
        """A measure of each case's motion before its factor, (n,); NaN where it is not known."""
        return np.array([record.measures.get(name, np.nan) for record in self.records])[self.which]

    def cases(self, some: NDArray[np.int64] | None = None) -> Iterator[tuple[Samples, NDArray[np.int64]]]:
        """The motions that cases have, in order, each with the places of those cases; of `some`, among these."""
        which = self.which if some is None else self.which[some]
        order = np.argsort(which, kind="stable")
        for rows in np.split(order, np.flatnonzero(np.diff(which[order])) + 1):
            if len(rows):
                yield self.records[which[rows[0]]], rows


@dataclass(frozen=True, eq=False)
class Excitation:
    """The motion of the ground: horizontal, vertical (positive up), either may be absent.

    `duration` (n,) [s] from t = 0, NaN where the study gives none: the motion ends there at the latest,
    and the response is reported up to there.  `suite`: in place of a horizontal motion of all cases, one of each.
    """

    horizontal: Channel | None
    vertical: Channel | None
    duration: Array
    suite: Suite | None = None


def scaled(channel: Channel, factor: float | Array) -> Channel:
    """The same motion, a factor larger; the factor one number or one a case, (n,)."""
    if isinstance(channel, Samples):
        ground = None if channel.ground is None else scaled(channel.ground, factor)
        return replace(channel, factor=channel.factor * factor, ground=ground)
    table, each = channel.table.copy(), np.broadcast_to(factor, len(channel.table))[:, None]
    table[:, :, PIECE_WIDTH - 1] *= np.abs(each)
    for kind, columns in AMPLITUDE_COLUMNS.items():
        for column in columns:
            table[:, :, column] *= np.where(table[:, :, 2] == kind, each, 1.0)
    return replace(channel, table=table, a_p=channel.a_p * factor)


def codes_of_motions(excitation: Excitation, n: int) -> Array:
    """A code of the motion of each of n cases, (n,), that all motions have in common which differ in scale alone.

    Whole numbers below 2^48, from a hash of what a motion is beside its scale: the same whatever the other cases are.
    """
    horizontal, vertical = excitation.horizontal, excitation.vertical
    beside, above = _beside_scale(horizontal, n), _beside_scale(vertical, n)
    ratio = [""] * n
    if horizontal is not None and vertical is not None:
        with np.errstate(all="ignore"):
            ratio = [f"{share:.6g}" for share in np.broadcast_to(_scale(vertical) / _scale(horizontal), n)]
    known: dict[tuple[bytes, bytes, str], float] = {}
    for key in zip(beside, above, ratio, strict=True):
        if key not in known:
            digest = sha256(b"|".join((key[0], key[1], key[2].encode()))).digest()
            known[key] = float(int.from_bytes(digest[:6], "big"))
    return np.array([known[key] for key in zip(beside, above, ratio, strict=True)])


def _scale(channel: Channel) -> Array:
    return channel.factor if isinstance(channel, Samples) else channel.a_p


def _beside_scale(channel: Channel | None, n: int) -> list[bytes]:
    """Of each of n cases what its motion is beside its scale."""
    if channel is None:
        return [b""] * n
    if isinstance(channel, Samples):
        return [sha256(channel.values.tobytes() + np.float64(channel.dt).tobytes()).digest()] * n
    table = channel.table.astype(np.float32)  # periods said in two ways differ in their last bits
    table[:, :, PIECE_WIDTH - 1] = 0.0
    for kind, columns in AMPLITUDE_COLUMNS.items():
        for column in columns:
            table[:, :, column] *= table[:, :, 2] != kind
    return [channel.shape.encode() + table[i].tobytes() for i in range(n)]


def acceleration(channel: Channel | None, t: Array, case: int = 0) -> Array:
    """Ground acceleration of one case at times t (k,) [s]: (k,) [m/s²]; at a breakpoint, the later piece."""
    if channel is None:
        return np.zeros_like(t)
    if isinstance(channel, Samples):
        return np.asarray(unscaled(channel, t) * channel.factor[case])
    a = np.zeros_like(t)
    for row in channel.table[case]:
        inside = (t >= row[0]) & (t < row[1])
        if inside.any():
            a[inside] = _piece(row, t[inside])
    return a


def unscaled(channel: Samples, t: Array) -> Array:
    """A recorded motion before the factors of the cases, at times t (k,) [s]: (k,) [m/s²]."""
    i = np.clip(np.floor(t / channel.dt).astype(int), 0, len(channel.values) - 2)
    u = np.clip(t / channel.dt - i, 0.0, 1.0)
    a = channel.values[i] * (1.0 - u) + channel.values[i + 1] * u
    return np.where((t >= 0.0) & (t <= channel.end), a, 0.0)


def _piece(row: Array, t: Array) -> Array:
    kind, c = int(row[2]), row[3:13]
    if kind == LINEAR:
        return np.asarray(c[0] + c[1] * (t - row[0]))
    if kind == WAVES:
        x = t - c[0]
        return np.asarray(sum(c[1 + 3 * j] * np.sin(c[2 + 3 * j] * x + c[3 + 3 * j]) for j in range(3)))
    y = c[1] * (t - c[0])
    return np.asarray((c[2] + y * (c[3] + y * (c[4] + y * c[5]))) * np.exp(-0.5 * y * y))
