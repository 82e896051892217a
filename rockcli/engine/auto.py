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
    AT_REST,
    COLUMN,
    DECIDES,
    FREE_OVER_CLAMPED,
    NONE,
    PAYS,
    PERTURBATION,
    RIGID,
    RIGID_CLASSES,
    STILL,
    WINKLER,
    Groups,
    as_candidate,
    bending_at_uplift,
    candidate_of_reference,
    chance,
    class_of_rigid,
    doubt,
    expected_errors,
    groups_of,
    outcomes_alone,
    outside,
    sentence,
    sentences,
    still,
)
from rockcli.scene.auto import prospect as words_of_prospect
from rockcli.scene.batch import Batch, Save
from rockcli.scene.ground.excitation import scaled
from rockcli.scene.response import NO_UPLIFT, Response, overturned
from rockcli.scene.variables import PEAK, SCALARS_AUTO
from rockcli.study.study import Index

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Choice:
    """What was decided of n cases.

    Attributes:
        candidate: of each, (n,); error: expected, (n,), NaN where the reference itself is chosen or none is known.
        said: a sentence for each.
    """

    candidate: NDArray[np.int8]
    error: Array
    said: list[str]


def settled(batch: Batch) -> Iterator[tuple[Index, Response]]:
    """Yield (rows, response) for all cases of a batch of model auto, a response for each model they are solved with."""
    if batch.column is not None:
        kernels.load(compile_them=True)  # the column is never solved in plain Python
    began = perf_counter()
    choice = decide(batch)
    spent = (perf_counter() - began) / batch.size
    asked = replace(batch, save=replace(batch.save, scalars=batch.save.scalars - frozenset(SCALARS_AUTO)))
    solved_as = np.where(
        choice.candidate == NONE, RIGID, choice.candidate
    )  # what stays at rest is a rigid block as well
    for candidate in np.unique(solved_as):
        rows = np.flatnonzero(solved_as == candidate)
        part = as_candidate(asked if len(rows) == batch.size else asked.rows(rows), int(candidate))
        response = choose(part).load()(part)
        at_rest = (choice.candidate[rows] == NONE) | ((candidate == RIGID) & (response.scalars["outcome"] == NO_UPLIFT))
        unknown = at_rest & np.isnan(choice.error[rows])  # before it was solved
        error = np.where(unknown, 0.0, choice.error[rows])
        scalars: dict[str, NDArray[Any]] = {
            **response.scalars,
            "model_used": np.where(at_rest, NONE, candidate).astype(np.int8),
            "model_error": np.where(overturned(response.scalars["outcome"]), np.nan, error),
        }
        if "wall_time" in scalars:
            scalars["wall_time"] = scalars["wall_time"] + spent
        said = [AT_REST if new else choice.said[i] for i, new in zip(rows.tolist(), unknown.tolist(), strict=True)]
        reasons = [f"{why}; {reason}" if reason else why for why, reason in zip(said, response.reasons, strict=True)]
        yield rows, replace(response, scalars=scalars, reasons=reasons)


def groups(batch: Batch) -> Groups:
    """The dimensionless groups of a batch."""
    return groups_of(batch, *peaks(batch.excitation.horizontal, batch.size, batch.excitation.duration))


def decide(batch: Batch) -> Choice:
    """Choose a candidate for every case: the cheapest whose expected error is within the case's tolerance."""
    assert batch.tolerance is not None
    reference, n = candidate_of_reference(batch), batch.size
    candidate, error = np.full(n, reference, dtype=np.int8), np.full(n, np.nan)
    if reference == RIGID:
        return Choice(candidate, error, [sentence(RIGID, RIGID, np.nan, "it has no column")] * n)
    found = groups(batch)
    why = outside(batch, found)
    rows = np.array([i for i, reason in enumerate(why) if not reason], dtype=np.int64)
    if len(rows) == n:
        return _with_column(batch, found, reference)
    said = sentences(lambda i: sentence(reference, reference, np.nan, why[i]), np.array(why))
    if len(rows):
        inside = _with_column(batch.rows(rows), found.rows(rows), reference)
        candidate[rows], error[rows] = inside.candidate, inside.error
        for i, words in zip(rows.tolist(), inside.said, strict=True):
            said[i] = words
    return Choice(candidate, error, said)


def _with_column(batch: Batch, found: Groups, reference: int) -> Choice:
    """The rigid block where neither bending nor partial uplift can matter, else the column."""
    assert batch.tolerance is not None
    tolerance = batch.tolerance[:, None]
    bending = expected_errors("rigid", found)
    opening = np.zeros_like(bending)
    if reference == WINKLER:
        opening = expected_errors("flexible", found)
    serves = (bending + opening <= tolerance) | ((opening <= tolerance) if reference == WINKLER else False)
    at_rest = still(found)
    # a search stays near the boundary of overturning, where cheap models cannot be trusted
    near_boundary = outcomes_alone(batch)
    tried = ~at_rest & (chance(found, serves) >= PAYS) & (not near_boundary)
    class_found, moves = np.full(batch.size, STILL), ~at_rest
    if tried.any():
        peak, neighbours = try_rigid(_some(batch, tried))
        class_found[tried], moves[tried] = class_of_rigid(peak, neighbours), peak != 0.0
    seen = at_rest | tried
    of_bending, of_opening = (np.where(seen, _at(errors, class_found), np.inf) for errors in (bending, opening))
    of_both = of_bending + of_opening
    as_rigid, as_column = of_both <= batch.tolerance, of_opening <= batch.tolerance
    as_column &= reference == WINKLER
    candidate = np.select([as_rigid & ~moves, as_rigid, as_column], [NONE, RIGID, COLUMN], reference).astype(np.int8)
    error = np.select([as_rigid, as_column], [of_both, of_opening], np.nan)

    def write(i: int) -> str:
        doing = RIGID_CLASSES[class_found[i]]
        if not seen[i]:
            seldom = "the rigid block is seldom accurate enough in such cases"
            why = DECIDES if near_boundary else seldom
        elif as_rigid[i]:
            why = f"the rigid block is accurate enough: {doing}"
        else:
            why = doubt("rigid", float(of_both[i]), doing)
            why += ", partial uplift matters little" if as_column[i] else ""
        return sentence(int(candidate[i]), reference, float(error[i]), why)

    return Choice(candidate, error, sentences(write, candidate, seen, class_found, of_both, error))


def _some(batch: Batch, which: NDArray[np.bool_]) -> Batch:
    return batch if which.all() else batch.rows(np.flatnonzero(which))


def _at(errors: Array, class_found: NDArray[np.int64]) -> Array:
    """The error of each case's class, (n,)."""
    return np.asarray(np.take_along_axis(errors, class_found[:, None], axis=1)[:, 0])


def prospect(batch: Batch, searched: bool) -> list[tuple[str, str, float | str]]:
    """(key, words, value) about the first case before anything is solved: tolerance, groups, what to expect.

    `searched`: whether overturning is searched for.
    """
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
    return [*said, ("takes", "auto takes", words_of_prospect(first, found, searched))]


def try_rigid(batch: Batch) -> tuple[Array, Array]:
    """Peak over alpha of the rigid block, (n,), and of its neighbours (3, n).

    The neighbours have 5 % more and less motion, and the law (2.10) that a column tends to as E grows.
    """
    rigid, n = as_candidate(batch, RIGID), batch.size
    thrice = rigid.rows(np.tile(np.arange(n), 3))
    channel = thrice.excitation.horizontal
    assert channel is not None
    perturbed = scaled(channel, np.repeat([1.0, 1.0 + PERTURBATION, 1.0 - PERTURBATION], n))
    peaks = peak_of(replace(thrice, excitation=replace(thrice.excitation, horizontal=perturbed)))
    peak, more, less = peaks.reshape(3, n)
    stiff = replace(rigid, model="3", geometry="corotational")
    return peak, np.stack([more, less, peak_of(stiff)])


def peak_of(batch: Batch) -> Array:
    """Peak of |theta| over alpha, (n,): 0 at rest, inf overturned, NaN unknown; nothing else is asked for."""
    asked = replace(batch, save=Save(False, batch.save.dt_out, frozenset({"outcome", PEAK})), warnings=())
    scalars = choose(asked).load()(asked).scalars
    peak = np.asarray(scalars[PEAK], dtype=np.float64)
    return np.where(scalars["outcome"] == NO_UPLIFT, 0.0, peak)
