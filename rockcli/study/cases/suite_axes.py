"""`over`: the axis ensemble statistics are taken over, and what is an intensity beside it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rockcli.study.document.expressions import ExpressionError, constant, parse
from rockcli.study.document.tree import Map, Source, nearest, value_at
from rockcli.study.document.values import describe
from rockcli.study.schema import OverPart
from rockcli.study.study import Axis, Over

AMPLITUDES = ("scale", "pga", "pgv", "pga_over_g_tan_alpha", "a_p", "a_p_over_g_tan_alpha")
"""Last parts of paths that are an intensity unless the study names another."""

NEEDED = ("outcome", "theta_peak_over_alpha")
"""Scalars of which the statistics need one."""


def read_over(
    source: Source, study: Map, said: OverPart | None, axes: Sequence[Axis], scalars: Sequence[str], *, searches: bool
) -> Over | None:
    """The ensemble statistics of a study whose form has been checked.

    Raises:
        StudyError: no such axis, no or several axes that may be the intensity where one is needed, a limit that is no
            positive number, or nothing saved that statistics could be made of.
    """
    if said is None:
        return None
    where = ("over",) if isinstance(value_at(study, ("over",)), str) else ("over", "axis")
    axis = _axis(source, study, where, said.axis, axes)
    if not searches and not set(NEEDED) & set(scalars):
        raise source.error(study, ("over",), f"needs {' or '.join(NEEDED)} among the saved scalars (`save`)")
    along = None
    if said.along is not None:
        along = _axis(source, study, ("over", "along"), said.along, axes)
        if not along.numeric or along is axis:
            raise source.error(study, ("over", "along"), "must be another axis, of numbers")
    else:
        known = [a for a in axes if a is not axis and a.numeric and a.path.rsplit(".", 1)[-1] in AMPLITUDES]
        if len(known) > 1:
            names = " or ".join(a.path for a in known)
            raise source.error(study, ("over",), f": the intensity may be {names}; say {{axis: ..., along: ...}}")
        along = known[0] if known else None
    limits = [_limit(source, study, i, value) for i, value in enumerate(said.limits)]
    return Over(axis.name, along.name if along else None, tuple(sorted(set(limits))), said.mean)


def _axis(source: Source, study: Map, keys: tuple[str, ...], text: str, axes: Sequence[Axis]) -> Axis:
    found = [a for a in axes if text in (a.name, a.path, f"case.{a.path}")]
    found = found or [a for a in axes if text == a.path.rsplit(".", 1)[-1]]
    if len(found) != 1:
        names = [name for a in axes for name in dict.fromkeys((a.path, a.name))]
        hint = nearest(text, names) if names else "the study has no axes (`vary`)"
        what = "which may be several axes" if found else "which is no axis of the dataset"
        raise source.error(study, keys, f"is {text!r}, {what}; {hint}")
    return found[0]


def _limit(source: Source, study: Map, i: int, value: Any) -> float:
    try:
        number = float(parse(value).evaluate(constant)) if isinstance(value, str) else float(value)
    except ExpressionError as error:
        raise source.error(study, ("over", "limits", i), f": {error}") from None
    if not number > 0.0:
        raise source.error(study, ("over", "limits", i), f"is {describe(value)}; expected a number greater than 0")
    return number
