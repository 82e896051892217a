"""Judges the `expect` clauses of a study on plain arrays."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.compare_to_reference import NEEDED_BY, locate
from rockcli.analysis.direction import WORST, angle_axis
from rockcli.analysis.places import coordinate, place
from rockcli.errors import StudyError
from rockcli.scene.auto import highest
from rockcli.scene.axis_path import axis_path
from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import Pulses
from rockcli.scene.laws.curves import variables_of
from rockcli.scene.laws.models import FLEXIBLE
from rockcli.scene.response import FAILED, OUTCOMES
from rockcli.scene.rules import RULES
from rockcli.scene.units import SI, Units
from rockcli.scene.variables import AUDIT, COUNTS, HISTORIES, IMPACTS, LARGE, ROTATION, VARIABLES
from rockcli.storage.contents import COORDINATES, DIM_TIME, Contents
from rockcli.storage.on_disk import Block, in_blocks
from rockcli.study.cases.buildable import buildable
from rockcli.study.study import Expect, Index, Study

Mask = NDArray[np.bool_]

_BUILT = 4096
"""Cases built at a time to see what they have."""

_OF_PULSES, _OF_MOTIONS, _OF_FLEXIBLE = {"a_p", "omega_p"}, {"pga", "pgv"}, {"u_top_bending"}
_OF_FRICTION, _OF_MESHES = {"slide", "slide_dot", "lift", "contact_mode"}, {"barrier"}
"""What only studies with such cases have."""


@dataclass(frozen=True)
class Verdict:
    """What came of one clause.

    Attributes:
        clause: the clause; text: the clause in words.
        points: points it speaks of; failing: how many do not satisfy it (no point at all fails too).
        worst: the value farthest from what was expected, in words; where: its place on the axes.
    """

    clause: Expect
    text: str
    points: int
    failing: int
    worst: str
    where: str

    @property
    def passed(self) -> bool:
        """Whether the clause is met."""
        return self.points > 0 and self.failing == 0


def names_ahead(study: Study, asked: set[str]) -> set[str]:
    """Names of what the dataset will have; of what only some bodies or motions give, as far as it is `asked` for."""
    saved = {*study.scalars, *COORDINATES, *variables_of(study.curves), *(RULES[name].variable for name in study.rules)}
    if study.histories:
        saved |= {*HISTORIES, *IMPACTS}
    if study.over is not None:
        from rockcli.analysis.suites.statistics import variables

        saved |= variables(study)
    saved |= {*(AUDIT if study.audit else ())}
    if study.search is not None:
        saved |= {study.search.name, *study.search.results(study.over)}
    if angle_axis(study) is not None:
        saved |= set(WORST)
    if study.compare_to is not None:
        saved |= {error for error, needed in NEEDED_BY.items() if needed in saved}
    asked = asked & (_OF_PULSES | _OF_MOTIONS | _OF_FLEXIBLE | _OF_FRICTION | _OF_MESHES)
    found = _of_cases(study, asked)
    return (saved - (asked - found)) | (found & _OF_MESHES)


def check_quantities(study: Study) -> None:
    """`StudyError` if a clause speaks of something the dataset will not have."""
    saved = names_ahead(study, {clause.quantity for clause in study.expect})
    for clause in study.expect:
        if clause.quantity not in saved:
            if clause.quantity not in VARIABLES:
                known = f"is not a variable of the dataset (`rock show variables` lists them): {clause.quantity!r}"
            else:
                what = "`save`, `compare_to`, `curves` and the motion"
                known = f"{clause.quantity!r} will not be in the dataset (see {what})"
            raise StudyError(f"expect: {known}", file=study.file, line=clause.line)


def _of_cases(study: Study, asked: set[str]) -> set[str]:
    """Those of some quantities that the motion and the model of some case give."""
    found: set[str] = set()
    if asked:
        for _, batch in _batches(study):
            motion = batch.excitation.horizontal
            found |= _OF_PULSES if isinstance(motion, Pulses) else set()
            found |= _OF_MOTIONS if motion is not None and study.size <= LARGE else set()
            found |= _OF_FLEXIBLE if highest(batch).model == FLEXIBLE else set()
            found |= _OF_FRICTION if np.isfinite(batch.block.mu).any() else set()
            found |= _OF_MESHES if batch.block.scan is not None else set()
            if found >= asked:
                break
    return found


def _batches(study: Study) -> Iterator[tuple[Index, Batch]]:
    """All that can be built, some cases at a time."""
    for first in range(0, study.size, _BUILT):
        yield from buildable(study.batches, np.arange(first, min(first + _BUILT, study.size)))


def judge(contents: Contents, clauses: tuple[Expect, ...], units: Units = SI) -> list[Verdict]:
    """Judge every clause, in order; `units` are those of the words."""
    return [_judge(contents, clause, units) for clause in clauses]


def expected_failures(contents: Contents, clauses: tuple[Expect, ...], at: Block) -> Mask:
    """Cases of a block that a clause expects to fail (`quantity: outcome, is: failed`), over the axes."""
    mask = np.zeros([part.stop - part.start for part in at], dtype=bool)
    for clause in clauses:
        if clause.quantity == "outcome" and clause.check == "is" and FAILED in _flags(clause):
            mask[tuple(map(_inside, _selection(contents, clause), at))] = True
    return mask


def _inside(chosen: slice, part: slice) -> slice:
    """What of a slice is in another one, counted from the beginning of that."""
    first, stop, _ = chosen.indices(part.stop)
    return slice(max(first - part.start, 0), max(stop - part.start, 0))


def _judge(contents: Contents, clause: Expect, units: Units) -> Verdict:
    text = describe(contents, clause, units)
    if clause.quantity not in contents.fields:
        return Verdict(clause, text, 0, 0, "not in the dataset", "")
    every = _asked(contents, clause)
    points = bad = 0
    largest, worst, where = -np.inf, np.nan, None
    for part in _parts(contents, clause, every):
        values = _values(contents, clause, every[part])
        speaks = _points(values, clause)
        distance = _distance(values, clause)
        failing = speaks & ~(distance <= 0.0)  # a NaN distance satisfies nothing
        points, bad = points + int(speaks.sum()), bad + int(failing.sum())
        rank = np.where(speaks, np.where(np.isnan(distance), np.inf, distance), -np.inf)
        if not rank.size:
            continue
        at = np.unravel_index(int(np.argmax(rank)), rank.shape)
        if where is None or rank[at] > largest:
            firsts = [s.start for s in part] + [0] * (len(at) - len(part))
            largest, worst = rank[at], values[at]
            where = tuple(first + int(i) for first, i in zip(firsts, at, strict=True))
    if points == 0 or where is None:
        return Verdict(clause, text, 0, 0, "no value", "")
    known = clause.quantity == "outcome" and not np.isnan(worst)  # else masked (`dataset.where`)
    word = OUTCOMES[int(worst)] if known else _word(contents, clause, worst, units)
    return Verdict(clause, text, points, bad, word, _place(contents, clause, where, units))


def _asked(contents: Contents, clause: Expect) -> NDArray[Any]:
    """What is stored of what a clause speaks of: (axes..., [time or impact]), axes named in `at` of length 1."""
    item = contents.fields[clause.quantity]
    chosen = zip(contents.axes, _selection(contents, clause), strict=True)
    return contents.over_axes(clause.quantity)[
        tuple(part if axis in item.dims else slice(0, 1) for axis, part in chosen)
    ]


def _parts(contents: Contents, clause: Expect, every: NDArray[Any]) -> Iterable[Block]:
    """Parts in which it is looked at: what has times or impacts is looked at whole."""
    return in_blocks(every) if set(contents.fields[clause.quantity].dims) <= {*contents.axes} else [()]


def _values(contents: Contents, clause: Expect, values: NDArray[Any]) -> NDArray[Any]:
    """Stored values as the clause means them, at the time or rotation it speaks of; no answer is NaN."""
    beside = tuple(dim for dim in contents.fields[clause.quantity].dims if dim not in contents.axes)
    if clause.quantity != "outcome":
        values = values.astype(float)
        if clause.quantity in COUNTS:
            values = np.where(values < 0, np.nan, values)
    for k, dim in enumerate(beside, start=values.ndim - len(beside)):
        if dim in clause.at:
            values = np.take(values, [locate(contents, dim, clause.at[dim])], axis=k)
    if clause.time is not None and beside == (DIM_TIME,):
        return _read_at(values, contents.values(DIM_TIME), clause.time)
    if clause.rotation is not None and beside == (ROTATION,):
        return _read_at(values, contents.values("theta_over_alpha"), clause.rotation)
    return values


def _selection(contents: Contents, clause: Expect) -> tuple[slice, ...]:
    chosen = []
    for axis in contents.axes:
        if axis in clause.at:
            i = locate(contents, axis, clause.at[axis])
            chosen.append(slice(i, i + 1))
        else:
            chosen.append(slice(None))
    return tuple(chosen)


def _read_at(values: NDArray[Any], time: NDArray[np.float64], t: float) -> NDArray[Any]:
    """Linear between output times (or rotations), exact on them; NaN outside."""
    if len(time) == 0 or not time[0] <= t <= time[-1] * (1.0 + 1e-12):
        return np.full(values.shape[:-1], np.nan)
    nearest = int(np.argmin(np.abs(time - t)))
    if abs(time[nearest] - t) <= 1e-9 * max(abs(t), 1.0):
        return np.asarray(values[..., nearest])
    i = int(np.searchsorted(time, t)) - 1
    u = (t - time[i]) / (time[i + 1] - time[i])
    return np.asarray((1.0 - u) * values[..., i] + u * values[..., i + 1])


def _points(values: NDArray[Any], clause: Expect) -> Mask:
    """Points a clause speaks of: all, but not the padding after a history's end or a case's last impact."""
    ragged = clause.quantity in IMPACTS or (clause.quantity in HISTORIES and clause.time is None)
    if not ragged:
        return np.ones(values.shape, dtype=bool)
    present = ~np.isnan(values)
    inside = np.flip(np.logical_or.accumulate(np.flip(present, axis=-1), axis=-1), axis=-1)
    if clause.quantity in HISTORIES:  # a case without any history fails once
        inside[..., 0] |= ~present.any(axis=-1)
    return np.asarray(inside)


def _distance(values: NDArray[Any], clause: Expect) -> NDArray[np.float64]:
    """How far beyond what is allowed, <= 0 where satisfied, NaN where there is no answer."""
    if clause.check in ("is", "is_not"):
        inside = np.isin(values, _flags(clause))
        return np.where(inside == (clause.check == "is"), 0.0, 1.0)
    target = float(clause.target)  # type: ignore[arg-type]
    with np.errstate(invalid="ignore"):
        if clause.check == "min":
            excess = target - values
        elif clause.check == "max":
            excess = values - target
        else:
            excess = np.abs(values - target) - (clause.atol + clause.rtol * abs(target))
    return np.where(np.isinf(values) & (values == target), 0.0, excess)  # infinity equals infinity


def _flags(clause: Expect) -> tuple[int, ...]:
    return clause.target if isinstance(clause.target, tuple) else (int(clause.target),)


def _word(contents: Contents, clause: Expect, value: Any, units: Units) -> str:
    """A value of the quantity."""
    item = contents.fields.get(clause.quantity)
    attrs = {} if item is None else item.attrs
    return units.word(float(value), str(attrs.get("units", "1")), axis_path(attrs, ""), 9)


def _place(contents: Contents, clause: Expect, at: tuple[Any, ...], units: Units) -> str:
    """The axes' coordinates of a point, in words; the axes `at` fixes are in the clause's own words."""
    parts = []
    for number, axis in enumerate(contents.axes):
        if axis not in clause.at and axis in contents.fields[clause.quantity].dims:
            parts.append(place(contents, [axis], [at[number]], units))
    if len(at) > len(contents.axes):
        beside = contents.fields[clause.quantity].dims[-1]
        if beside not in clause.at:
            last = contents.values(beside)[at[-1]] if beside in contents.fields else at[-1]
            parts.append(f"{beside}={coordinate(contents, beside, last)}")
    return ", ".join(parts)


def describe(contents: Contents, clause: Expect, units: Units = SI) -> str:
    """A clause in words: `theta_peak_over_alpha at model=rigid = 0.5537 (rtol 1e-05)`."""
    where = ", ".join(f"{axis}={coordinate(contents, axis, value, units)}" for axis, value in clause.at.items())
    words = clause.quantity + (f" at {where}" if where else "")
    if clause.time is not None:
        words += f" at t = {clause.time:g} s"
    if clause.rotation is not None:
        words += f" at theta/alpha = {clause.rotation:g}"
    if clause.check in ("is", "is_not"):
        names = " or ".join(OUTCOMES[flag] for flag in _flags(clause))
        return f"{words} {clause.check.replace('_', ' ')} {names}"
    sign = {"min": ">=", "max": "<=", "value": "="}[clause.check]
    allowed = ""
    if clause.check == "value":
        atol = _word(contents, clause, clause.atol, units)
        allowed = f" (rtol {clause.rtol:g}" + (f", atol {atol})" if clause.atol else ")")
    return f"{words} {sign} {_word(contents, clause, clause.target, units)}{allowed}"
