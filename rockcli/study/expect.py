"""`expect` and `compare_to`: what a study says of its results, matched to its axes before anything is solved."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from rockcli.scene.response import OUTCOMES, OVERTURNED_AFTER_IMPACT, OVERTURNED_WITHOUT_IMPACT
from rockcli.scene.variables import (
    CASE,
    HAZARD,
    IMPACT,
    INPUT,
    LIMIT,
    MEASURE,
    MEASURES,
    PERCENTILE,
    PERCENTILES,
    ROTATION,
    SUITE,
    TIME,
    VARIABLES,
)
from rockcli.study.document.complaints import Complaints
from rockcli.study.document.dimensions import check_of_unit, stated_number
from rockcli.study.document.expressions import ExpressionError, number_of, parse
from rockcli.study.document.tree import Keys, Map, Source, meant, nearest, place
from rockcli.study.document.values import describe
from rockcli.study.study import MATCH, Axis, Expect, Over

CHECKS = ("value", "min", "max", "is", "is_not")

MEANINGS: dict[str, tuple[int, ...]] = {
    **{name: (flag,) for flag, name in OUTCOMES.items()},
    "overturned": (OVERTURNED_WITHOUT_IMPACT, OVERTURNED_AFTER_IMPACT),
}


Evaluate = Callable[[str], float]
"""Value of an expression that is the same in all cases; raises ExpressionError for others."""


def read_expect(
    source: Source,
    study: Map,
    axes: Sequence[Axis],
    evaluate: Evaluate = number_of,
    found: tuple[str, ...] = (),
    suite: Over | None = None,
) -> tuple[Expect, ...]:
    """The clauses of a study whose form has been checked; `evaluate` is for the coordinates in `at` and for
    the numbers that are expected.

    `found`: names of results that a search gives beside the variables of the dataset; `suite`: the ensemble
    statistics of the study.

    Raises:
        StudyError: an unknown quantity, a point that is on no axis, none or several of `value`, `min`, ...
    """
    complaints, clauses = Complaints(), []
    for i in range(len(study.get("expect") or ())):
        with complaints.gathered():
            clauses.append(_clause(source, study, axes, i, evaluate, found, suite))
    complaints.tell()
    return tuple(clauses)


def _axes_of(quantity: str, axes: Sequence[Axis], suite: Over | None) -> Sequence[Axis]:
    """What a clause about a quantity may name in `at`."""
    over = CASE
    if quantity in VARIABLES:
        over = VARIABLES[quantity].over
    elif suite is not None and quantity.rsplit("_", 1)[-1] in suite.ends:
        over = SUITE
    if suite is None or over not in (SUITE, LIMIT, MEASURE, PERCENTILE, INPUT, HAZARD):
        return axes
    left = [axis for axis in axes if axis.name not in suite.axes]
    if over == HAZARD or (over != CASE and quantity.startswith("fragility_")):
        left = [axis for axis in left if axis.name != suite.along]
    if over == HAZARD:
        left.append(Axis(HAZARD, HAZARD, tuple(curve.label for curve in suite.hazard), False))
    if over in (LIMIT, PERCENTILE, HAZARD):
        left.append(Axis(LIMIT, LIMIT, suite.limit_states, False))
    if over == PERCENTILE:
        left.append(Axis(PERCENTILE, PERCENTILE, PERCENTILES, True))
    if over == MEASURE:
        left.append(Axis(MEASURE, MEASURE, MEASURES, False))
    if over == INPUT:
        left.append(Axis(INPUT, INPUT, suite.inputs, False))
    return left


def check_histories(
    source: Source,
    study: Map,
    clauses: Sequence[Expect],
    axes: Sequence[Axis],
    at: dict[str, Any] | None,
    *,
    saved: bool,
) -> None:
    """Refuse clauses that read a history where none is saved (`at`: the only points where they are; None = all).

    Raises:
        StudyError: naming the clause and what is saved.
    """
    for i, clause in enumerate(clauses):
        if clause.quantity not in VARIABLES or VARIABLES[clause.quantity].over != TIME:
            continue
        keys = ("expect", i)
        if not saved:
            message = f"needs the history of {clause.quantity}, and no histories are saved; save: {{histories: true}}"
            raise source.error(study, keys, message)
        for axis in axes:
            if at is None or axis.name not in at:
                continue
            wanted = [clause.at[axis.name]] if axis.name in clause.at else axis.values
            for value in wanted:
                if value != at[axis.name]:
                    kept, missed = (f"{axis.path} = {_shown(v)}" for v in (at[axis.name], value))
                    message = f"needs the history of {clause.quantity} at {missed}; save.histories keeps {kept} only"
                    raise source.error(study, keys, message)


def _shown(value: Any) -> str:
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def match(
    source: Source,
    study: Map,
    keys: Keys,
    at: dict[str, Any],
    axes: Sequence[Axis],
    evaluate: Evaluate = number_of,
) -> dict[str, Any]:
    """{axis name: coordinate} of the points that a mapping of axes (by name, path or the end of it) to values means.

    Values on numeric axes may be expressions.

    Raises:
        StudyError: no such axis, or no such value on it.
    """
    found: dict[str, Any] = {}
    for said, value in at.items():
        axis = next((a for a in axes if said in (a.name, a.path, f"case.{a.path}")), None)
        ends = [a for a in axes if a.path.endswith(f".{said}")]
        if axis is None and len(ends) == 1:
            axis = ends[0]
        if axis is None:
            names = [name for a in axes for name in dict.fromkeys((a.path, a.name))]
            hint = nearest(said, names) if names else "the study has no axes"
            raise source.error(study, (*keys, said), f"is on no axis; {hint}")
        why = ""
        try:
            coordinate = _coordinate(axis, value, evaluate)
        except ExpressionError as error:
            coordinate, why = None, f" ({error})"
        if coordinate is None:
            shown = ", ".join(f"{v:.10g}" if axis.numeric else v for v in axis.values[:12])
            more = ", ..." if axis.size > 12 else ""
            close = meant(str(value), map(str, axis.values)) if not axis.numeric else None
            hint = f"; did you mean {close!r}?" if close is not None else ""
            message = f"is {describe(value)}, which is no point of that axis{why}; it has {shown}{more}{hint}"
            raise source.error(study, (*keys, said), message)
        found[axis.name] = coordinate
    return found


def _coordinate(axis: Axis, value: Any, evaluate: Evaluate) -> Any:
    if axis.numeric:
        number = evaluate(value) if isinstance(value, str) and _is_expression(value) else _number(value)
        if number is None or number in axis.values:
            return number
        near = min(axis.values, key=lambda v: abs(v - number))
        return near if _same(near, number) else None
    text = {True: "true", False: "false"}.get(value, str(value)) if isinstance(value, bool) else str(value)
    if text in axis.values:
        return text
    return axis.values[axis.files.index(text)] if text in axis.files else None


def _is_expression(text: str) -> bool:
    try:
        return bool(parse(text).names)
    except ExpressionError:
        return False


def _same(a: float, b: float) -> bool:
    return a == b or abs(a - b) <= MATCH * max(abs(a), abs(b))


def _number(value: Any) -> float | None:
    """A number or a constant expression as a float; None for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        return number_of(value)
    except (ExpressionError, OverflowError):
        return None


def _clause(
    source: Source,
    study: Map,
    axes: Sequence[Axis],
    i: int,
    evaluate: Evaluate,
    found: tuple[str, ...],
    suite: Over | None,
) -> Expect:
    clause: Map = study["expect"][i]
    keys: Keys = ("expect", i)
    quantity = clause["quantity"]
    if quantity not in VARIABLES and quantity not in found:
        raise source.error(study, (*keys, "quantity"), f"is {quantity!r}; {nearest(quantity, [*VARIABLES, *found])}")
    over = CASE if quantity in found else VARIABLES[quantity].over
    if over == IMPACT:
        raise source.error(study, (*keys, "quantity"), "has a value per impact; only scalars and histories are judged")
    checks = [key for key in CHECKS if clause.get(key) is not None]
    if len(checks) != 1:
        has = f"has {' and '.join(checks)}" if checks else "says nothing"
        raise source.error(study, keys, f"{has}; exactly one of {', '.join(CHECKS)} is needed")
    time = None if clause.get("time") is None else _positive(source, study, (*keys, "time"), clause["time"])
    if over == TIME and time is None:
        raise source.error(study, keys, f"needs `time`: {quantity} is a history")
    if over != TIME and time is not None:
        raise source.error(study, (*keys, "time"), f"is for histories; {quantity} has no time")
    rotation = (
        None if clause.get("rotation") is None else _positive(source, study, (*keys, "rotation"), clause["rotation"])
    )
    if over != ROTATION and rotation is not None:
        raise source.error(study, (*keys, "rotation"), f"is for static curves; {quantity} is none")
    check = checks[0]
    target: float | tuple[int, ...]
    if check in ("is", "is_not"):
        target = _meanings(source, study, (*keys, check), quantity, clause[check])
    else:
        target = _target(source, study, (*keys, check), quantity, clause[check], evaluate)
    return Expect(
        quantity=quantity,
        at=match(source, study, (*keys, "at"), clause.get("at") or {}, _axes_of(quantity, axes, suite), evaluate),
        check=check,
        target=target,
        rtol=_positive(source, study, (*keys, "rtol"), clause.get("rtol", 1e-6)),
        atol=_positive(source, study, (*keys, "atol"), clause.get("atol", 0.0)),
        time=time,
        rotation=rotation,
        references=clause.get("references") or "",
        line=line if isinstance(line := place(study, keys), int) else None,
    )


def _target(source: Source, study: Map, keys: Keys, quantity: str, value: Any, evaluate: Evaluate) -> float:
    why, of = "", VARIABLES.get(quantity)
    try:
        number = evaluate(value) if isinstance(value, str) and _is_expression(value) else _number(value)
        if isinstance(value, str) and number is not None and of is not None:
            check_of_unit(value, of.unit, study.get("let"))
    except ExpressionError as error:
        number, why = None, f" ({error})"
    if number is None or math.isnan(number):
        hint = "; a meaning is judged by `is`" if quantity == "outcome" else ""
        raise source.error(study, keys, f"is {describe(value)}; expected a number{why}{hint}")
    return number


def _meanings(source: Source, study: Map, keys: Keys, quantity: str, value: Any) -> tuple[int, ...]:
    if quantity != "outcome":
        raise source.error(study, keys, f"judges meanings of outcome; {quantity} is a number: value, min or max")
    names = value if isinstance(value, list) else [value]
    flags: list[int] = []
    for name in names:
        if not isinstance(name, str) or name not in MEANINGS:
            raise source.error(study, keys, f"is {describe(name)}; {nearest(str(name), MEANINGS)}")
        flags += MEANINGS[name]
    if not flags:
        raise source.error(study, keys, f"is empty; expected some of {', '.join(MEANINGS)}")
    return tuple(dict.fromkeys(flags))


def _positive(source: Source, study: Map, keys: Keys, value: Any) -> float:
    number = _number(value)
    if isinstance(value, str) and number is not None:
        number = stated_number(source, study, keys, value)
    if number is None or not 0.0 <= number < math.inf:
        raise source.error(study, keys, f"is {describe(value)}; expected a number that is not negative")
    return number
