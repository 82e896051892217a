"""`rock records info` of many records: the files meant, one row each, spectra, two components in every direction."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rockcli.cli.tables import table

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from rockcli.motion.motion import Motion

    Array = NDArray[np.float64]

SHORTEST, LONGEST, POINTS = 0.02, 10.0, 120
"""Periods [s] of a drawn spectrum, and how many."""

HEADS = (
    ("file", "record", ""), ("component", "component", ""), ("format", "format", ""), ("npts", "values", ""),
    ("dt", "dt", "s"), ("duration", "duration", "s"), ("pga_g", "PGA", "g"), ("pgv", "PGV", "m/s"),
    ("arias", "Arias", "m/s"), ("d5_95", "D5-95", "s"), ("magnitude", "M", ""), ("r_rup", "R_rup", "km"),
    ("vs30", "Vs30", "m/s"), ("pulse_period", "T_pulse", "s"),
)  # fmt: skip
"""Columns of the table: key, head, unit."""

WORDS = ("record", "component", "format")


def listed(paths: Iterable[Path]) -> list[tuple[Path, bool]]:
    """Files, and whether they come out of a folder, where others may stand beside them.

    A folder stands for its files in order of their names, but hidden ones and `_...`; without any for itself.
    """
    files: list[tuple[Path, bool]] = []
    for path in paths:
        there = path.iterdir() if os.path.isdir(path) else ()
        inside = sorted(one for one in there if one.is_file() and one.name[0] not in "._")
        files += [(one, True) for one in inside] or [(path, False)]
    return files


def spectral(motion: Motion, g: float, periods: Sequence[float]) -> dict[str, float]:
    """Pseudo-acceleration at 5 % damping [m/s²] by the name the dataset has it by, as `sa(0.5)`."""
    import numpy as np

    if not periods:
        return {}
    values = spectrum_of(motion, g, np.array(periods, dtype=float))
    return {f"sa({period:g})": float(value) for period, value in zip(periods, values, strict=True)}


def spectrum_of(motion: Motion, g: float, periods: Array) -> Array:
    """Pseudo-acceleration at 5 % damping, (m,) [m/s²]."""
    import numpy as np

    from rockcli.motion.spectrum import Stretch, pseudo_acceleration

    a = motion.acceleration(g)
    forcing = (Stretch(0.0, motion.dt, np.column_stack([a[:-1], np.diff(a) / motion.dt])),)
    return pseudo_acceleration(forcing, periods)


def pair_spectra(one: Motion, two: Motion, g: float, periods: Array) -> tuple[Array, Array]:
    """RotD50 and RotD100 of the pseudo-acceleration of two components at 5 % damping, (m,) each [m/s²]."""
    from rockcli.motion.rotated import rotated_spectrum
    from rockcli.motion.spectrum import DAMPING

    return rotated_spectrum(one.acceleration(g), two.acceleration(g), one.dt, periods, DAMPING)


def pair_facts(one: Motion, two: Motion, g: float, periods: Sequence[float]) -> dict[str, float]:
    """RotD50 and RotD100 of PGA, PGV and Sa(T) of two components.

    Raises:
        RecordError: one is vertical; their places, time steps, lengths or the times of their first samples differ.
    """
    import numpy as np

    from rockcli.errors import RecordError
    from rockcli.motion.direction import not_a_pair, refuse_other_start
    from rockcli.motion.rotated import rotated_measures

    for motion in (one, two):  # as pairs of a folder of three components, or where one is missing, would be
        if motion.is_vertical:
            raise RecordError(f"is a vertical component, {motion.component}: --rotd takes horizontal ones", motion.name)
    if why := not_a_pair(one, two):
        raise RecordError(why, one.name)
    alike, least = abs(one.dt - two.dt) <= 1e-9 * one.dt, min(len(one.values), len(two.values))
    if not alike or len(one.values) != len(two.values):
        said = f"{len(one.values)} values of {one.dt:g} s, {two.name} has {len(two.values)} of {two.dt:g} s"
        cut = f": cut both files to their first {least} values" if alike else ""
        raise RecordError(f"has {said}: two components in one direction need the same times{cut}", one.name)
    refuse_other_start(one, two)
    a, b = one.acceleration(g), two.acceleration(g)
    found = rotated_measures(a, b, one.dt)
    if periods:
        spectra = pair_spectra(one, two, g, np.array(periods, dtype=float))
        for i, period in enumerate(periods):
            found[f"sa({period:g})"] = (float(spectra[0][i]), float(spectra[1][i]))
    ends = ("rotd50", "rotd100")
    return {f"{name}_{end}": pair[k] for name, pair in found.items() for k, end in enumerate(ends)}


def rows_table(rows: Sequence[dict[str, Any]], g: float) -> str:
    """One row per record; columns nobody has a value in are left out, accelerations are in g."""
    extra = [(key, f"{key.split('_')[0].replace('sa', 'Sa').replace('pga', 'PGA').replace('pgv', 'PGV')}"
              f"{' ' + key.split('_')[1].replace('rotd', 'RotD') if '_' in key else ''}",
              "m/s" if key.startswith("pgv_") else "g") for key in dict.fromkeys(k for row in rows for k in row)
             if key.startswith("sa(") or "_rotd" in key]  # fmt: skip
    columns = [one for one in (*HEADS, *extra) if any(row.get(one[0]) not in (None, "") for row in rows)]
    heads = [f"{head} [{unit}]" if unit else head for _, head, unit in columns]
    shared = len({Path(str(row["file"])).parent for row in rows}) == 1
    words = sum(head in WORDS for head in heads)
    if shared and "," not in str(rows[0]["file"]):
        rows = [row | {"file": Path(str(row["file"])).name} for row in rows]
    lines = ([_cell(row.get(key), g if _in_g(key) else 1.0) for key, _, _ in columns] for row in rows)
    return table(heads, lines, right=len(columns) - words)


def _in_g(key: str) -> bool:
    return key.startswith(("sa(", "pga_rotd"))


def _cell(value: Any, divisor: float) -> str:
    if value is None:
        return ""
    return f"{value / divisor:.4g}" if isinstance(value, float) else str(value)
