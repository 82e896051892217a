"""`over`: the axis ensemble statistics are taken over, and what is an intensity beside it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from rockcli.scene.ground.amplitudes import AMPLITUDES
from rockcli.scene.limit_states import in_full
from rockcli.scene.variables import PEAK
from rockcli.study.document.dimensions import stated_number
from rockcli.study.document.expressions import UNITS, ExpressionError, number_of, parse
from rockcli.study.document.tree import Map, Source, nearest, value_at
from rockcli.study.document.values import describe
from rockcli.study.intensity import GROUND, KNOWN, OF_GROUND, bare, period_of
from rockcli.study.schema import OverPart, SlideLimitPart
from rockcli.study.study import Axis, Limit, Over, Searched

QUANTITIES = (PEAK, "slide_peak", "slide_residual")
"""Scalars that limit states may be told of."""

LONG_SLIDE, LARGE_TILT = 2.0, 2.0
"""Limits of the slide [m] and of theta/alpha above which their units are doubted."""

NEEDED = ("outcome", PEAK)
"""Scalars of which the statistics need one."""


def read_over(
    source: Source, study: Map, said: OverPart | None, axes: Sequence[Axis], scalars: Sequence[str], *, searches: bool
) -> Over | None:
    """The ensemble statistics of a study whose form has been checked.

    Raises:
        StudyError: no such axis, no or several axes that may be the intensity where one is needed, a limit that is no
            positive number or is said twice, or nothing saved that statistics could be made of.
    """
    if said is None:
        return None
    where = ("over", "axis") if isinstance(value_at(study, ("over",)), dict) else ("over",)
    chosen = _side_by_side(source, study, where, said.axis, axes)
    if not searches and not set(NEEDED) & set(scalars):
        raise source.error(study, ("over",), f"needs {' or '.join(NEEDED)} among the saved scalars (`save`)")
    along = None
    if said.along is not None:
        along = _axis(source, study, ("over", "along"), said.along, axes)
        if not along.numeric or along in chosen:
            raise source.error(study, ("over", "along"), "must be another axis, of numbers")
    else:
        known = [a for a in axes if a not in chosen and a.numeric and a.path.rsplit(".", 1)[-1] in AMPLITUDES]
        if len(known) > 1:
            names = " or ".join(a.path for a in known)
            raise source.error(study, ("over",), f": the intensity may be {names}; say {{axis: ..., along: ...}}")
        along = known[0] if known else None
    limits = [_limit(source, study, i, value) for i, value in enumerate(said.limits)]
    for i, limit in enumerate(limits):
        if limit.quantity not in (PEAK, *scalars):
            message = f"needs {limit.quantity}, which bodies with a mu have, among the saved scalars (`save`)"
            raise source.error(study, ("over", "limits", i), message)
        if limit.label in (before.label for before in limits[:i]):
            raise source.error(study, ("over", "limits", i), f"is the limit state {in_full(limit.label)} twice")
    first, second = _intensities(source, study, said.intensity, axes)
    if not first and along is not None:
        first = _of_sa(study, along.path, axes)
    return Over(
        tuple(axis.name for axis in chosen),
        along.name if along else None,
        tuple(sorted(limits, key=lambda limit: (QUANTITIES.index(limit.quantity), limit.value))),
        said.mean,
        first,
        said.fit,
        str(said.begins_at),
        _beta_added(source, study, said.beta_added),
        second=second,
    )


def doubted_limits(said: OverPart | None, over: Over | None, unheld: str | None) -> Iterator[str]:
    """What a careful reader would doubt about the limits of a suite; `unheld`: the first body without a mu."""
    limits = [] if said is None else said.limits
    if said is not None and "limits" in said.model_fields_set and over is not None and limits:
        if not over.limits:
            yield "over.limits is not told of a search, which looks for overturning alone"
        elif not over.told_against:
            yield (
                "over.limits is not told where no intensity is varied; with an axis of one, as motion.record.pga: "
                "[0.4*g], `rock table FILE.nc --of stripes` has the share that exceeds each"
            )
    slides = [value for one in limits if isinstance(one, SlideLimitPart) for _, value in one if value is not None]
    if slides and unheld is not None:
        yield (
            "limits of the slide tell of overturning alone where a body has no mu: it cannot slide"
            + (f" (first: {unheld})" if unheld else "")
        )
    far = [value for value in slides if isinstance(value, int | float) and value > LONG_SLIDE]
    if far:
        yield f"over.limits: a slide of {far[0]:g} m: limits of the slide are in metres"
    beyond = [value for value in limits if isinstance(value, int | float) and value > LARGE_TILT]
    if beyond:
        yield (
            f"over.limits: theta/alpha > {beyond[0]:g} is exceeded by hardly a body that does not overturn: limits of "
            "the rotation are shares of alpha, not angles"
        )
    for value in limits:
        if isinstance(value, str) and (units := sorted(parse(value).names & UNITS.keys())):
            yield (
                f"over.limits: {value} is taken as theta/alpha > {number_of(value):g}, {units[0]} being a unit: limits "
                "of the rotation are shares of alpha; of the slide they are {slide_peak: 0.05} [m]"
            )


def of_search(source: Source, study: Map, over: Over, search: Searched, axes: Sequence[Axis]) -> Over:
    """The statistics of a searched amplitude: of its lowest overturning values there is a curve of overturning.

    Raises:
        StudyError: the intensity does not grow in proportion to what is searched.
    """
    amplitude = search.axis.path.rsplit(".", 1)[-1] in AMPLITUDES
    if over.intensity and not amplitude:
        raise source.error(
            study, ("over", "intensity"), f": {search.axis.path} is searched, no amplitude of the motion"
        )
    if not amplitude or over.fit == "none":
        return replace(over, limits=(), intensity="")
    if not over.intensity:
        over = replace(over, intensity=_of_sa(study, search.axis.path, axes))
    grows = not over.intensity or bare(over.intensity) in ("pga", "pgv", "cav") or period_of(over.intensity) is not None
    if over.second or not grows:
        known = ", ".join(("pga", "pgv", "cav", "sa(T)", *OF_GROUND))
        raise source.error(study, ("over", "intensity"), f"of a search is one of {known}")
    return replace(over, limits=(), intensity=over.intensity or search.axis.name)


def _side_by_side(
    source: Source, study: Map, keys: tuple[str, ...], said: str | list[str], axes: Sequence[Axis]
) -> list[Axis]:
    """The axes of the ensemble, in the order of the dataset."""
    names = [said] if isinstance(said, str) else said
    found = [_axis(source, study, keys, name, axes) for name in names]
    at = sorted(axes.index(axis) for axis in found)
    if at != list(range(at[0], at[0] + len(at))):
        listed = ", ".join(axis.path for axis in axes)
        why = "takes axes that stand side by side, each once"
        raise source.error(study, keys, f"{why}; the study has, outermost first, {listed}: put them so in `vary`")
    return [axes[i] for i in at]


def _of_sa(study: Map, path: str, axes: Sequence[Axis]) -> str:
    """`sa(0.5)`, or `ground_sa(0.5)` below floors, if a path is the `sa` of records and has one period; else ""."""
    record = path.removeprefix("case.")
    if record != "motion.record.sa" or any(axis.path.endswith(".sa_period") for axis in axes):
        return ""
    period = value_at(study, ("case", "motion", "record", "sa_period"))
    try:
        T = number_of(period)
    except (ExpressionError, TypeError):
        return ""
    return f"{GROUND if _has_floors(study['case']) or _has_floors(study.get('vary')) else ''}sa({T:.12g})"


def _has_floors(part: Any) -> bool:
    """Whether a part of a study, or a setting in it, has something stand between the ground and the body."""
    return isinstance(part, dict) and any("through" in str(k).split(".") or _has_floors(v) for k, v in part.items())


def _intensities(source: Source, study: Map, said: Any, axes: Sequence[Axis]) -> tuple[str, str]:
    """The intensity that fragility is told against, and a second one, as `_intensity` names them."""
    names = said if isinstance(said, list) else [said]
    found = [_intensity(source, study, name, axes) for name in names]
    if len(found) == 1:
        return found[0], ""
    if found[0] == found[1]:
        raise source.error(study, ("over", "intensity"), f"is {names[0]!r} twice; expected two intensities")
    return found[0], found[1]


def _intensity(source: Source, study: Map, name: Any, axes: Sequence[Axis]) -> str:
    """An intensity by its name in the dataset; "" = the axis of the intensity."""
    if name is None:
        return ""
    keys = ("over", "intensity")
    try:
        known = period_of(name) is not None or name in (*KNOWN, *OF_GROUND)
    except ValueError as error:
        raise source.error(study, keys, f"is {name!r}: {error}; expected sa(0.5)") from None
    if known and bare(name) != "sa(T)":
        return str(name)
    if not any(name in (a.name, a.path, a.path.rsplit(".", 1)[-1]) for a in axes):
        offered = ", ".join((*KNOWN, *OF_GROUND))
        raise source.error(study, keys, f"is {name!r}; expected {offered} with T in seconds, or a numeric axis")
    found = _axis(source, study, keys, name, axes)
    if not found.numeric:
        raise source.error(study, keys, f"is {name!r}, an axis of words; expected numbers")
    return found.name


def _beta_added(source: Source, study: Map, value: Any) -> float:
    number = stated_number(source, study, ("over", "beta_added"), value)
    if not 0.0 <= number < 10.0:
        raise source.error(study, ("over", "beta_added"), f"is {describe(value)}; expected a number >= 0, as 0.2")
    return number


def _axis(source: Source, study: Map, keys: tuple[str, ...], text: str, axes: Sequence[Axis]) -> Axis:
    found = [a for a in axes if text in (a.name, a.path, f"case.{a.path}")]
    found = found or [a for a in axes if text == a.path.rsplit(".", 1)[-1]]
    if len(found) != 1:
        names = [name for a in axes for name in dict.fromkeys((a.path, a.name))]
        hint = nearest(text, names) if names else "the study has no axes (`vary`)"
        what = "which may be several axes" if found else "which is no axis of the dataset"
        raise source.error(study, keys, f"is {text!r}, {what}; {hint}")
    return found[0]


def _limit(source: Source, study: Map, i: int, value: Any) -> Limit:
    quantity, keys = PEAK, ("over", "limits", i)
    if isinstance(value, SlideLimitPart):
        said = {name: number for name, number in value if number is not None}
        if len(said) != 1:
            raise source.error(study, keys, "expected {slide_peak: m} or {slide_residual: m}")
        ((quantity, value),) = said.items()
    number = stated_number(source, study, keys if quantity == PEAK else (*keys, quantity), value)
    if not number > 0.0:
        raise source.error(study, keys, f"is {describe(value)}; expected a number greater than 0")
    return Limit(number, quantity)
