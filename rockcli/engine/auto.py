"""Solves cases of model auto: tries the cheap models, decides case by case, solves with what each case requires."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.analysis.measures import peaks
from rockcli.engine.backends import choose
from rockcli.scene.auto import (
    COLUMN,
    FREE_OVER_CLAMPED,
    LINEARIZED,
    LINEARIZED_CLASSES,
    NONE,
    NUDGE,
    RIGID,
    RIGID_CLASSES,
    WINKLER,
    Groups,
    bending_at_uplift,
    class_of_linearized,
    class_of_rigid,
    doubt,
    expected_error,
    groups_of,
    on_rung,
    outside,
    rung_of_reference,
    sentence,
)
from rockcli.scene.auto import prospect as words_of_prospect
from rockcli.scene.batch import Batch, Save
from rockcli.scene.excitation import scaled
from rockcli.scene.response import NO_UPLIFT, Response, overturned
from rockcli.scene.variable import PEAK
from rockcli.study.study import Index

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Choice:
    """What was decided of n cases.

    Attributes:
        rung: of each, (n,); error: expected, (n,), NaN where the reference itself is chosen or none is known.
        said: a sentence for each.
    """

    rung: NDArray[np.int8]
    error: Array
    said: list[str]


def settled(batch: Batch) -> Iterator[tuple[Index, Response]]:
    """Yield (rows, response) for all cases of a batch of model auto, a response for each rung chosen."""
    if batch.column is not None:
        kernels.load(compile_them=True)  # the column is never solved in plain Python
    began = perf_counter()
    choice = decide(batch)
    spent = (perf_counter() - began) / batch.size
    for rung in np.unique(choice.rung):
        rows = np.flatnonzero(choice.rung == rung)
        part = on_rung(batch.rows(rows), int(rung))
        response = choose(part).load()(part)
        scalars: dict[str, NDArray[Any]] = {
            **response.scalars,
            "model_used": np.full(len(rows), rung, dtype=np.int8),
            "model_error": np.where(overturned(response.scalars["outcome"]), np.nan, choice.error[rows]),
        }
        if "wall_time" in scalars:
            scalars["wall_time"] = scalars["wall_time"] + spent
        reasons = ["; ".join(filter(None, (choice.said[i], r))) for i, r in zip(rows, response.reasons, strict=True)]
        yield rows, replace(response, scalars=scalars, reasons=reasons)


def groups(batch: Batch) -> Groups:
    """The dimensionless groups of a batch."""
    return groups_of(batch, *peaks(batch.excitation.horizontal, batch.size, batch.excitation.duration))


def decide(batch: Batch) -> Choice:
    """Choose a rung for every case: the cheapest whose expected error is within the case's tolerance."""
    assert batch.tolerance is not None
    reference, found = rung_of_reference(batch), groups(batch)
    why = outside(batch, found)
    choice = Choice(
        np.full(batch.size, reference, dtype=np.int8),
        np.full(batch.size, np.nan),
        [sentence(reference, reference, np.nan, reason) for reason in why],
    )
    rows = np.array([i for i, reason in enumerate(why) if not reason], dtype=np.int64)
    if len(rows):
        inside = batch.rows(rows)
        step = _without_column if reference == RIGID else _with_column
        for i, (rung, error, said) in zip(rows, step(inside, found.rows(rows), reference), strict=True):
            choice.rung[i], choice.error[i], choice.said[i] = rung, error, said
    return choice


Chosen = tuple[int, float, str]


def _without_column(batch: Batch, found: Groups, reference: int) -> list[Chosen]:
    """Nothing moves, or the linearised block where its error is small for what it does, else the rigid one."""
    assert batch.tolerance is not None
    moves, everywhere = found.amplitude > 1.0, np.ones(batch.size, dtype=np.int64)
    overturned = len(LINEARIZED_CLASSES) - 1
    best = np.min([expected_error("linearized", found, j * everywhere) for j in range(overturned)], axis=0)
    class_found = overturned * everywhere  # where nothing it may do while it stands will serve, it is not tried
    tried = np.flatnonzero(moves & (best <= batch.tolerance))
    if len(tried):
        class_found[tried] = class_of_linearized(peak_of(on_rung(batch.rows(tried), LINEARIZED)))
    errors = expected_error("linearized", found, class_found, boundary=_boundary(batch))
    chosen: list[Chosen] = []
    for i, error in enumerate(errors):
        doing = LINEARIZED_CLASSES[class_found[i]]
        if not moves[i]:
            why = "PGA does not exceed g tan(alpha), so that the body cannot move"
            chosen.append((NONE, 0.0, sentence(NONE, reference, 0.0, why)))
        elif best[i] > batch.tolerance[i]:
            why = doubt("linearised", float(best[i]), "at this alpha, whatever it does")
            chosen.append((RIGID, np.nan, sentence(RIGID, reference, np.nan, why)))
        elif error <= batch.tolerance[i]:
            chosen.append((LINEARIZED, float(error), sentence(LINEARIZED, reference, float(error), doing)))
        else:
            chosen.append((RIGID, np.nan, sentence(RIGID, reference, np.nan, doubt("linearised", float(error), doing))))
    return chosen


def _with_column(batch: Batch, found: Groups, reference: int) -> list[Chosen]:
    """The rigid block where neither bending nor partial uplift can matter, else the column."""
    assert batch.tolerance is not None
    peak, tried = try_rigid(batch)
    class_found = class_of_rigid(peak, tried)
    bending = expected_error("rigid", found, class_found, boundary=_boundary(batch))
    opening = np.zeros(batch.size)
    if reference == WINKLER:
        opening = expected_error("flexible", found, class_found, boundary=_boundary(batch))
    chosen: list[Chosen] = []
    for i, tolerance in enumerate(batch.tolerance):
        error, doing = float(bending[i] + opening[i]), RIGID_CLASSES[class_found[i]]
        if error <= tolerance:
            rung = NONE if peak[i] == 0.0 else RIGID
            chosen.append((rung, error, sentence(rung, reference, error, f"the rigid block serves: {doing}")))
        elif reference == WINKLER and opening[i] <= tolerance:
            why = f"{doubt('rigid', error, doing)}, partial uplift matters little"
            chosen.append((COLUMN, float(opening[i]), sentence(COLUMN, reference, float(opening[i]), why)))
        else:
            why = doubt("rigid", error, doing)
            chosen.append((reference, np.nan, sentence(reference, reference, np.nan, why)))
    return chosen


def _boundary(batch: Batch) -> bool:
    return batch.save.scalars == frozenset({"outcome"})


def prospect(batch: Batch) -> list[tuple[str, str, float | str]]:
    """(key, words, value) about the first case before anything is solved: tolerance, groups, what to expect."""
    assert batch.tolerance is not None
    first = batch.rows(np.zeros(1, dtype=np.int64))
    found = groups(first)
    rate, p_T1 = float(found.rate[0]), float(found.p_T1[0])
    said: list[tuple[str, str, float | str]] = [
        ("tolerance", "error of theta/alpha allowed", float(first.tolerance[0])),  # type: ignore[index]
        ("rate", "PGA/(PGV p)", rate),
    ]
    if first.column is not None:
        density = first.column.rho[0] * first.g[0] * first.block.R[0, 0]
        said += [
            ("p_T1", "p T_1, clamped", p_T1),
            ("T1_over_motion", "T_1 over 2 pi PGV/PGA, clamped", p_T1 * rate / (2.0 * np.pi)),
            (
                "T1_rocking_over_motion",
                "T_1 over 2 pi PGV/PGA, rocking",
                p_T1 * rate / (2.0 * np.pi) / FREE_OVER_CLAMPED,
            ),
            ("E_over_rho_g_R", "E/(rho g R)", float(first.column.E[0] / density)),
            ("bending_at_uplift", "bending of the top at uplift over 2h alpha", bending_at_uplift(p_T1)),
        ]
    if first.base is not None:
        said.append(("opening", "rotation at which the base opens over alpha", float(found.opening[0])))
    return [*said, ("takes", "auto takes", words_of_prospect(first, found))]


def try_rigid(batch: Batch) -> tuple[Array, Array]:
    """Peak over alpha of the rigid block, (n,), and of its neighbours (3, n).

    The neighbours have 5 % more and less motion, and the law (2.10) that a column tends to as E grows.
    """
    rigid = on_rung(batch, RIGID)
    more, less = (replace(rigid, excitation=_nudged(rigid, 1.0 + nudge)) for nudge in (NUDGE, -NUDGE))
    stiff = replace(rigid, model="3", geometry="corotational")
    return peak_of(rigid), np.stack([peak_of(other) for other in (more, less, stiff)])


def _nudged(batch: Batch, factor: float) -> Any:
    channel = batch.excitation.horizontal
    assert channel is not None
    return replace(batch.excitation, horizontal=scaled(channel, factor))


def peak_of(batch: Batch) -> Array:
    """Peak of |theta| over alpha, (n,): 0 at rest, inf overturned, NaN unknown; nothing else is asked for."""
    asked = replace(batch, save=Save(False, batch.save.dt_out, frozenset({"outcome", PEAK})), warnings=())
    scalars = choose(asked).load()(asked).scalars
    peak = np.asarray(scalars[PEAK], dtype=np.float64)
    return np.where(scalars["outcome"] == NO_UPLIFT, 0.0, peak)
