"""`uncertain`: inputs with a distribution, and the one axis `sample` that their samples make."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import StudyError
from rockcli.scene.uncertain.distributions import FAMILIES, Distribution
from rockcli.scene.uncertain.samples import MOST_INPUTS, SAMPLINGS, unit_points
from rockcli.study.cases.variation import Variation
from rockcli.study.document.dimensions import check_unit
from rockcli.study.document.expressions import CONSTANTS, ExpressionError, constant, parse
from rockcli.study.document.overlay import same_twice
from rockcli.study.document.paths import UNITS, Path, resolve, varies_in_batch
from rockcli.study.document.tree import Map, Places, Source, place
from rockcli.study.schema import DistributionPart, OverPart, StudyPart
from rockcli.study.study import SAMPLE, Axis, Input, Uncertain

Evaluate = Callable[[str], float]


@dataclass(frozen=True)
class _Read:
    """An input as the study names it, its path, and what it may be."""

    text: str
    path: Path
    distribution: Distribution


def read_uncertain(
    source: Source, study: Map, part: StudyPart, axes: Sequence[Variation], evaluate: Evaluate
) -> tuple[Variation, Uncertain] | None:
    """The axis of the samples, and what they are; None where nothing is uncertain.

    Which point an input has does not depend on the order in which the study names its inputs.

    Raises:
        StudyError: no path or one whose numbers cannot differ within a batch, no distribution, a number of samples that
            the design cannot have, or what an axis says already.
    """
    if not part.uncertain:
        for key in ("samples", "seed", "sampling"):
            if key in part.model_fields_set:
                raise source.error(study, (key,), "belongs to `uncertain: {PATH: DISTRIBUTION}`, which is missing")
        return None
    if len(part.uncertain) > MOST_INPUTS:
        raise source.error(study, ("uncertain",), f"has more than {MOST_INPUTS} inputs")
    read = [
        _Read(text, path := _path(source, study, text), _distribution(source, study, text, path, said, evaluate))
        for text, said in part.uncertain.items()
    ]
    _check_apart(source, study, read, axes)
    try:
        points = unit_points(part.sampling, part.samples, len(read), part.seed)
    except ValueError as error:
        raise source.error(study, ("samples",), f"is {part.samples}: {error}") from None
    read.sort(key=lambda each: each.path)
    lasts = [each.path[-1] for each in read]
    names = [each.path[-1] if lasts.count(each.path[-1]) == 1 else "_".join(each.path[1:]) for each in read]
    inputs = tuple(
        Input(
            name=f"sampled_{name}",
            path=".".join(each.path).removeprefix("case."),
            unit=UNITS.get(each.path[-1], "1") if each.path[0] != "let" else "1",
            words=each.distribution.words,
            values=each.distribution.at(u),
        )
        for name, each, u in zip(names, read, points.T, strict=True)
    )
    axis = Axis(SAMPLE, SAMPLE, tuple(range(part.samples)), True)
    columns: dict[Path, NDArray[np.float64]] = {each.path: made.values for each, made in zip(read, inputs, strict=True)}
    where = Places(beyond=place(study, ("uncertain",)))
    return Variation(axis, (SAMPLE,), (), columns, where, sampled=True), Uncertain(inputs, part.sampling, part.seed)


def placed(variations: Sequence[Variation], sample: Variation, over: OverPart | None) -> list[Variation]:
    """The axes with that of the samples: innermost, or behind the last of those that `over` names beside it."""
    named = over.axis if over is not None and isinstance(over.axis, list) else []
    beside = [
        i
        for i, v in enumerate(variations)
        if {v.axis.name, v.axis.path, f"case.{v.axis.path}", v.axis.path.rsplit(".", 1)[-1]} & set(named)
    ]
    at = beside[-1] + 1 if beside and SAMPLE in named else len(variations)
    return [*variations[:at], sample, *variations[at:]]


def sentence(uncertain: Uncertain, n: int) -> str:
    """`10000 Latin hypercube samples, seed 0`."""
    return f"{n} {SAMPLINGS[uncertain.sampling]}, seed {uncertain.seed}"


def _path(source: Source, study: Map, text: str) -> Path:
    where = place(study, ("uncertain", text))
    try:
        path = resolve(text)
    except StudyError as error:
        raise source.placed(where, f"uncertain: {error.message}") from None
    if not varies_in_batch(path):
        what = "a number of the block, motion, initial state, damping, column or base, `g`, or a symbol of `let`"
        can = f"only {what} can: vary it instead"
        if path[1:2] == ("block",) and path[2:3] in (("pixel",), ("outline",), ("contacts",), ("parts",)):
            can = "write a symbol of `let` there, and let.NAME here"
        raise source.placed(where, f"uncertain: {text!r} cannot be uncertain; {can}")
    return path


def _distribution(
    source: Source, study: Map, text: str, path: Path, part: DistributionPart, evaluate: Evaluate
) -> Distribution:
    keys = ("uncertain", text)
    given = [family for family in FAMILIES if getattr(part, family) is not None]
    if len(given) != 1:
        has = f"has {' and '.join(given)}" if given else "has no distribution"
        raise source.error(study, keys, f"{has}; exactly one of {', '.join(FAMILIES)} is needed")
    family = FAMILIES[given[0]]

    def number(value: Any, *more: str | int) -> float:
        try:
            if not isinstance(value, str):
                return float(value)
            expression = parse(value)
            known = expression.names <= CONSTANTS.keys()
            found = float(expression.evaluate(constant)) if known else evaluate(value)
            check_unit(value, path, study.get("let"))
            return found
        except ExpressionError as error:
            raise source.error(study, (*keys, *more), f": {error}") from None

    numbers = tuple(number(value, given[0], i) for i, value in enumerate(getattr(part, given[0])))
    if not np.isfinite(numbers).all() or not family.fits(*numbers):
        shown = ", ".join(f"{value:.6g}" for value in numbers)
        raise source.error(
            study, (*keys, given[0]), f"is [{', '.join(family.names)}] = [{shown}]: needs {family.needs}"
        )
    if part.truncate is None:
        return Distribution(given[0], numbers)
    low, high = (number(value, "truncate", i) for i, value in enumerate(part.truncate))
    if not low < high:
        raise source.error(
            study, (*keys, "truncate"), f"is [{low:.6g}, {high:.6g}]; the first must be below the second"
        )
    cut = Distribution(given[0], numbers, (low, high))
    if not cut.mass > 1e-12:
        raise source.error(study, (*keys, "truncate"), f"leaves nothing of {given[0]}: probability {cut.mass:.3g}")
    return cut


def _check_apart(source: Source, study: Map, read: Sequence[_Read], axes: Sequence[Variation]) -> None:
    """Refuse inputs that say the same thing as another, or as an axis; and an axis that is called `sample`."""
    paths = [each.path for each in read]
    if (twice := same_twice(paths)) is not None:
        first, last = (read[i].text for i in twice)
        raise source.error(study, ("uncertain", last), f"and {first} say the same thing; leave one out")
    for each in read:
        for variation in axes:
            said = [variation.path] if variation.columns is None else [variation.path, *variation.columns]
            if any(same_twice([path, each.path]) for path in said):
                raise source.error(study, ("uncertain", each.text), f"is what the axis {variation.axis.path} varies")
    for variation in axes:
        if variation.axis.name == SAMPLE:
            raise source.error(study, ("vary", variation.axis.path), "is called `sample`, as the axis of `uncertain`")
