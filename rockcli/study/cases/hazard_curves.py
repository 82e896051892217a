"""`hazard`: curves of annual rates against the intensity of a suite's fragility, from the study or from CSV files.

A file is a table of two columns, intensity and annual rate, or the hazard curves that OpenQuake exports.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import StudyError, is_file
from rockcli.scene.constants import STANDARD_G
from rockcli.scene.ground.hazard import HazardCurve
from rockcli.scene.units import g_of
from rockcli.study.document.dimensions import stated_number
from rockcli.study.document.expressions import constant, says_its_unit
from rockcli.study.document.tree import Keys, Map, Source, value_at
from rockcli.study.document.values import describe, reads_as_number
from rockcli.study.inputs import Inputs, csv_rows
from rockcli.study.intensity import bare, period_of
from rockcli.study.schema import HazardPart, StudyPart
from rockcli.study.study import Axis, Over

Array = NDArray[np.float64]

_NAMES = ("pga", "pgv", "pgv_over_pga", "arias", "cav")
"""Intensities a curve may be told to be of; beside them sa(T)."""

_OPENQUAKE = {"PGV": ("pgv", "cm/s"), "IA": ("arias", "m/s"), "CAV": ("cav", "g*s")}
"""Intensities as OpenQuake names them: the name here, and the unit that they have there; others are in g."""

_SITE = 1e-4
"""Degrees by which a site may differ from the one asked for."""


@dataclass(frozen=True)
class _Read:
    """Points of a curve as they stand: intensity in `unit` ("" = SI), rate, of which intensity ("" = not told).

    `lines`: of the points in their file, where each has its own.
    """

    intensity: Array
    rate: Array
    of: str = ""
    unit: str = ""
    notes: tuple[str, ...] = ()
    lines: tuple[int, ...] = ()


def read_hazard(
    source: Source, study: Map, part: StudyPart, over: Over | None, axes: Sequence[Axis], own_g: float | None = None
) -> Over | None:
    """The statistics of a study with the hazard curves and the age it gives; `own_g`: what an expression for g is.

    Raises:
        StudyError: there is no fragility to convolve with, a curve is none or of another intensity, a file cannot be
            read.
    """
    if part.hazard is None:
        if part.age is not None:
            raise source.error(study, ("age",), "belongs to `hazard`, which the study does not give")
        return over
    if over is None or not over.told_against or over.fit == "none":
        raise source.error(
            study, ("hazard",), "needs fragility curves: `over` an axis, with an intensity that is varied"
        )
    if over.second:
        raise source.error(
            study, ("hazard",), f"is of one intensity, the fragility of two ({over.told_against}, {over.second})"
        )
    g = g_of(study["case"] | ({} if own_g is None else {"g": own_g}), {axis.path for axis in axes})
    against = _against(over, axes)
    curves: list[HazardCurve] = []
    for i, entry in enumerate(part.hazard):
        keys: Keys = ("hazard", i) if isinstance(value_at(study, ("hazard",)), list) else ("hazard",)
        curve = _curve(source, study, keys, entry, against, g, i)
        if curve.label in (known.label for known in curves):
            raise source.error(study, keys, f"is the second curve named {curve.label!r}; give each a label")
        curves.append(curve)
    age = None if part.age is None else _number(source, study, ("age",), part.age)
    if age is not None and not age > 0.0:
        raise source.error(study, ("age",), f"is {describe(part.age)}; expected years, a number greater than 0")
    return replace(over, hazard=tuple(curves), age=age)


def _against(over: Over, axes: Sequence[Axis]) -> str:
    """The intensity of the fragility by its short name, as `pga` of the axis motion_record_pga, or of the ground's."""
    axis = next((axis for axis in axes if axis.name == over.told_against), None)
    return bare(over.told_against) if axis is None else axis.path.rsplit(".", 1)[-1]


def _curve(
    source: Source, study: Map, keys: Keys, entry: HazardPart, against: str, g: float, number: int
) -> HazardCurve:
    numbers = entry.intensity is not None or entry.rate is not None
    if (entry.file is None) == (not numbers) or (numbers and (entry.intensity is None or entry.rate is None)):
        raise source.error(study, keys, ": expected FILE.csv, or {intensity: [...], rate: [...]}")
    file = None if entry.file is None else source.folder / entry.file
    if file is not None and not is_file(file):
        raise source.error(study, keys, f": there is no such file, {str(file)[:300]}")
    if file is None:
        if entry.site is not None:
            raise source.error(study, (*keys, "site"), "chooses among the sites of a file")
        if entry.units and (twice := [v for v in _list(entry.intensity) if says_its_unit(v)]):
            message = f": {twice[0]!r} says its unit, and `units: {entry.units}` too; leave one out"
            raise source.error(study, (*keys, "intensity"), message)
        x = [_number(source, study, (*keys, "intensity", i), v, g) for i, v in enumerate(_list(entry.intensity))]
        rate = [_number(source, study, (*keys, "rate", i), v) for i, v in enumerate(_list(entry.rate))]
        if len(x) != len(rate):
            raise source.error(study, keys, f"has {len(x)} intensities and {len(rate)} rates")
        read, default = _Read(np.array(x), np.array(rate)), f"hazard {number + 1}"
    else:
        read, default = _file(source.inputs, file, _site(source, study, keys, entry)), file.stem

    def refused(message: str, point: int | None = None) -> StudyError:
        if file is None:
            return source.error(study, keys, message)
        return StudyError(message, file=file, line=read.lines[point] if point is not None and read.lines else None)

    of = read.of.lower()
    if of and not _same(of, against):
        raise refused(
            f"is a hazard curve of {read.of}, the fragility is told against {against}; over: {{intensity: ...}}"
        )
    unit = entry.units or read.unit
    factor = _factor(unit, against, g, refused)
    if read.unit and not math.isclose(factor, _factor(read.unit, against, g, refused)):
        raise refused(f"says that its intensities are in {read.unit}, `units` says {entry.units}; leave it out")
    intensity = read.intensity * factor
    if wrong := _why_none(intensity, read.rate):
        raise refused(*wrong)
    keep = read.rate > 0.0
    notes = read.notes
    if not keep.all():
        notes = (*notes, f"{_points(keep)} of rate 0 left out")
    if keep.sum() < 2:
        raise refused("has fewer than two points of a rate above 0")
    return HazardCurve(entry.label or default, intensity[keep], read.rate[keep], notes)


def _points(kept: NDArray[np.bool_]) -> str:
    """How many points are not kept."""
    n = int((~kept).sum())
    return "1 point" if n == 1 else f"{n} points"


def _why_none(x: Array, rate: Array) -> tuple[str, int | None] | None:
    """What is wrong with the points of a curve, and with which of them; None if nothing."""
    if len(x) < 2:
        return "needs at least two points", None
    if (bad := ~(np.isfinite(x) & np.isfinite(rate))).any():
        return "holds a number that is not finite", int(np.argmax(bad))
    if (bad := (x <= 0.0) | (np.diff(x, prepend=0.0) <= 0.0)).any():
        return "needs intensities that are greater than 0 and ascend", int(np.argmax(bad))
    if (bad := (rate < 0.0) | (np.diff(rate, prepend=np.inf) > 0.0)).any():
        said = "needs annual rates of exceedance, which are not negative and never grow with the intensity"
        return said, int(np.argmax(bad))
    return None


def _list(value: object) -> list[object]:
    return list(value) if isinstance(value, list) else [value]


def _number(source: Source, study: Map, keys: Keys, value: Any, g: float = STANDARD_G) -> float:
    """A number or an expression of numbers, units and g."""
    return stated_number(source, study, keys, value, lambda name: g if name == "g" else constant(name))


def _same(of: str, against: str) -> bool:
    known, wanted = (period_of(name) for name in (of, against))
    if known is not None and wanted is not None:
        return math.isclose(known, wanted, rel_tol=1e-9)
    return of == against


def _factor(unit: str, against: str, g: float, refused: Callable[[str], StudyError]) -> float:
    """What intensities are multiplied by to be in SI units."""
    acceleration = against in ("pga", "a_p", "sa", "floor_pga") or period_of(against) is not None
    text = unit.replace("²", "2").replace("^", "").replace("**", "").replace(" ", "")
    known = {"": 1.0, "1": 1.0}
    if acceleration:
        known = {"": 1.0, "g": g, "%g": 0.01 * g, "m/s2": 1.0, "ms-2": 1.0, "cm/s2": 0.01, "gal": 0.01}
    elif against in ("pgv", "arias", "cav"):
        known = {"": 1.0, "m/s": 1.0, "ms-1": 1.0, "cm/s": 0.01}
        known |= {"gs": g, "g-s": g, "g*s": g} if against == "cav" else {}
    elif against == "pgv_over_pga":
        known = {"": 1.0, "s": 1.0}
    factor = known.get(text if text in known else text.lower())
    if factor is None:
        raise refused(f"is in {unit!r}, no unit of {against}; expected {', '.join(filter(None, known))}")
    return factor


def _site(source: Source, study: Map, keys: Keys, entry: HazardPart) -> tuple[float, float] | None:
    if entry.site is None:
        return None
    lon, lat = (_number(source, study, (*keys, "site", i), v) for i, v in enumerate(entry.site))
    return lon, lat


def _file(inputs: Inputs, path: Path, site: tuple[float, float] | None) -> _Read:
    """The curve in a file.

    Raises:
        StudyError: it cannot be read or is no table of a hazard curve.
    """
    rows = csv_rows(inputs.read_beside(path), path)
    head = next((row for _, row in rows if not row[0].startswith("#")), [])
    if any(cell.startswith("poe-") for cell in head):
        return _openquake(path, rows, site)
    rows = [(i, row) for i, row in rows if not row[0].startswith("#")]
    if site is not None:
        raise StudyError("has no sites: they are those of OpenQuake's exported curves", file=path)
    if len(rows) < 3 or any(len(row) != 2 for _, row in rows):
        raise StudyError(
            "a hazard curve is a table of two columns, intensity and annual rate, with a head, as `pga [g],rate`, and "
            "a line per point",
            file=path,
        )
    (line, (first, second)), *points = rows
    if reads_as_number(first):
        raise StudyError("the first line names the columns, as `pga [g],rate`", file=path, line=line)
    said, _, unit = (part.strip() for part in first.rstrip("] ").partition("["))
    name = bare(said)  # a hazard curve is of the ground
    of = name.lower()
    if of not in (*_NAMES, "intensity") and not _is_spectral(of):
        raise StudyError(
            f"the first column is {said!r}; expected intensity, sa(T), {', '.join(_NAMES)}, with the unit in square "
            "brackets, as `pga [g],rate`",
            file=path,
            line=line,
        )
    if not re.fullmatch(r"(annual[_ ])?rate(_of_exceedance)?(\s*\[(1/a|1/yr|1/year)\])?", second.lower()):
        raise StudyError(f"the second column is {second!r}; expected rate, a year's", file=path, line=line)
    values = np.array([[_cell(path, i, cell) for cell in row] for i, row in points])
    told = "" if of == "intensity" else name
    return _Read(values[:, 0], values[:, 1], told, unit, lines=tuple(i for i, _ in points))


def _openquake(path: Path, rows: list[tuple[int, list[str]]], site: tuple[float, float] | None) -> _Read:
    """Probabilities of exceedance at one site, as annual rates -ln(1 - P)/T."""
    comment = " ".join(cell for _, row in rows if row[0].startswith("#") for cell in row)
    time = re.search(r"investigation_time=['\"]?([0-9.eE+]+)", comment)
    imt = re.search(r"imt=['\"]*([A-Za-z0-9_().]+)", comment)
    if time is None or imt is None or not float(time[1]) > 0.0:
        raise StudyError(
            "its first line does not tell investigation_time and imt, as OpenQuake's exports do", file=path
        )
    body = [(i, row) for i, row in rows if not row[0].startswith("#")]
    (line, head), *sites = body
    columns = [k for k, cell in enumerate(head) if cell.startswith("poe-")]
    levels = np.array([_cell(path, line, head[k].removeprefix("poe-")) for k in columns])
    if any(len(row) != len(head) for _, row in sites) or not sites:
        raise StudyError("a line per site is expected, with a probability for every level", file=path)
    if site is None and len(sites) > 1:
        raise StudyError(f"holds {len(sites)} sites: choose one, {{file: ..., site: [lon, lat]}}", file=path)
    if site is not None:
        lon, lat = (head.index(name) if name in head else -1 for name in ("lon", "lat"))
        if min(lon, lat) < 0:
            raise StudyError("has no columns lon and lat", file=path, line=line)
        at = [np.hypot(_cell(path, i, r[lon]) - site[0], _cell(path, i, r[lat]) - site[1]) for i, r in sites]
        nearest = int(np.argmin(at))
        if at[nearest] > _SITE:
            there = f"{sites[nearest][1][lon]}, {sites[nearest][1][lat]}"
            raise StudyError(f"has no site {site[0]:g}, {site[1]:g}; the nearest is {there}", file=path)
        sites = [sites[nearest]]
    number, row = sites[0]
    poe = np.array([_cell(path, number, row[k]) for k in columns])
    if (poe < 0.0).any() or (poe > 1.0).any():
        raise StudyError("holds a probability that is not between 0 and 1", file=path, line=number)
    sure = poe >= 1.0
    rate = -np.log1p(-poe[~sure]) / float(time[1])
    notes = (f"{_points(~sure)} of probability 1, which tells no rate, left out",) if sure.any() else ()
    of, unit = _OPENQUAKE.get(imt[1].upper(), (imt[1], "g"))
    return _Read(levels[~sure], rate, of, unit, notes)


def _is_spectral(name: str) -> bool:
    try:
        return period_of(name) is not None
    except ValueError:
        return False


def _cell(path: Path, line: int, cell: str) -> float:
    if not reads_as_number(cell):
        raise StudyError(f"{cell!r} is no number", file=path, line=line)
    return float(cell)
