"""How a record is scaled, in words: the last sentence of its processing history."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.ground.amplitudes import FLOOR_SCALINGS, RECORD_SCALINGS
from rockcli.scene.ground.excitation import Samples
from rockcli.study.building.ground_motion import MOTION, sa_name
from rockcli.study.building.numbers import Numbers
from rockcli.study.document.tree import Keys
from rockcli.study.intensity import period_of
from rockcli.study.schema import RecordPart

Array = NDArray[np.float64]
Range = tuple[float, float]

INHERITED = "the horizontal factor"

SAME = 1e-12
"""Relative spread below which factors are the same."""


def scaling_key(numbers: Numbers, keys: Keys) -> str:
    """By which key the record of a component is scaled, `sa` as sa(T); `INHERITED`, or "" where it is not."""
    own = _own_key(numbers, keys)
    return INHERITED if not own and keys != MOTION and _own_key(numbers, MOTION) else own


def _own_key(numbers: Numbers, keys: Keys) -> str:
    record: RecordPart | None = numbers.said((*keys, "record"))
    if record is None:
        return ""
    given = [key for key in RECORD_SCALINGS if getattr(record, key) is not None]
    if keys == MOTION:
        given += [key for key in FLOOR_SCALINGS if getattr(numbers.case.motion, key) is not None]
    key = next(iter(given), "")
    return sa_name(numbers, (*keys, "record")) if key == "sa" else key


@dataclass(frozen=True)
class Scaling:
    """What the cases multiply a record with, and what comes of it, smallest and largest.

    Attributes:
        key: of the study, `INHERITED`, or "" where nothing is scaled.
        factor: signed.  pga, sa [g], pgv [m/s]: of the motion used; over: its PGA over g tan(alpha); sa is 0 where the
            record is not scaled to it.
        before, raw: PGA [g] and PGV [m/s] of the processed record and of the file; they differ between directions.
    """

    key: str
    factor: Range
    pga: Range
    pgv: Range
    over: Range
    sa: Range
    before: tuple[Range, Range]
    raw: tuple[Range, Range]

    @classmethod
    def of(cls, samples: Samples, gs: Array, tan_alpha: Array, key: str) -> Scaling:
        """The scaling of cases of these g and slendernesses, (n,) each."""
        measures, size = samples.measures, np.abs(samples.factor)
        g = float(gs[0])
        ground = "_ground" if "pga_ground" in measures else ""  # what was scaled, before floors
        ground_pga, ground_pgv = measures[f"pga{ground}"], measures[f"pgv{ground}"]
        pga = size * ground_pga / gs
        return cls(
            key=key,
            factor=_range(samples.factor),
            pga=_range(pga),
            pgv=_range(size * ground_pgv),
            over=_range(pga / tan_alpha),
            sa=_range(size * measures[key] / gs) if period_of(key) else (0.0, 0.0),
            before=(_range(ground_pga / g), _range(ground_pgv)),
            raw=(_range(measures["pga_raw"] / g), _range(measures["pgv_raw"])),
        )

    def with_(self, other: Scaling) -> Scaling:
        """The scaling of these cases and of others."""
        of_factor = ("factor", "pga", "pgv", "over", "sa")
        both = {name: _both(getattr(self, name), getattr(other, name)) for name in of_factor}
        before = _both(self.before[0], other.before[0]), _both(self.before[1], other.before[1])
        raw = _both(self.raw[0], other.raw[0]), _both(self.raw[1], other.raw[1])
        return Scaling(key=self.key, before=before, raw=raw, **both)

    @property
    def varies(self) -> bool:
        """Whether the factor differs from case to case."""
        low, high = self.factor
        return high - low > SAME * max(abs(low), abs(high))

    def sentence(self) -> str:
        """`scaled by 0.48 to pga 0.4 g: PGA 0.83 -> 0.4 g, PGV 0.6 -> 0.29 m/s; in the file ...`."""
        (pga, pgv), (raw_pga, raw_pgv) = (tuple(map(_words, ends)) for ends in (self.before, self.raw))
        as_filed = f"PGA {raw_pga} g, PGV {raw_pgv} m/s"
        changed = self.before != self.raw
        in_file = f"; in the file {as_filed}" if changed else ""
        if not self.key and not self.varies:
            turned = ", turned by polarity -1" if self.factor[0] < 0.0 else ""
            return f"not scaled{turned}: PGA {pga} g, PGV {pgv} m/s{in_file}"
        by = f"factors from {_words(self.factor)}, case by case" if self.varies else f"{self.factor[0]:.6g}"
        effect = f"PGA {pga} -> {_words(self.pga)} g, PGV {pgv} -> {_words(self.pgv)} m/s"
        return f"scaled by {by}{self._wanted()}: {effect}{in_file}"

    def _wanted(self) -> str:
        if self.key == "pga":
            return f" to pga {_words(self.pga)} g"
        if self.key == "pgv":
            return f" to pgv {_words(self.pgv)} m/s"
        if self.key == "pga_over_g_tan_alpha":
            return f" to pga_over_g_tan_alpha {_words(self.over)}"
        if self.sa[1] > 0.0:
            return f" to {self.key} {_words(self.sa)} g"
        if self.key in FLOOR_SCALINGS:
            return f" for {self.key}"
        return f", {INHERITED}" if self.key == INHERITED else ""


def _range(values: Array | float) -> Range:
    if isinstance(values, float):
        return float(values), float(values)
    return float(values.min()), float(values.max())


def _both(one: Range, other: Range) -> Range:
    return min(one[0], other[0]), max(one[1], other[1])


def _words(ends: Range) -> str:
    low, high = (f"{end:.4g}" for end in ends)
    return low if low == high else f"{low} to {high}"
