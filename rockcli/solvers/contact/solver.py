"""Bodies with a coefficient of friction: what pure rocking cannot tell is solved with all modes of contact.

The fast kernels come first; a body whose friction suffices and that stays on the ground keeps their answer, to the
bit.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.kernels.constants import FALLS, ILL_POSED
from rockcli.kernels.contact import results as to
from rockcli.scene.batch import Batch
from rockcli.scene.laws.contact import slides_only
from rockcli.scene.numerics import Accuracy
from rockcli.scene.repeated import repeated
from rockcli.scene.response import FAILED, NO_UPLIFT, Response, overturned
from rockcli.scene.variables import SCALARS_SLIDING
from rockcli.solvers.common.certainty import (
    CERTAINTY,
    Judgement,
    Traces,
    judge,
    perturbed,
)
from rockcli.solvers.contact.answers import answer
from rockcli.solvers.contact.histories import held_histories, histories_of
from rockcli.solvers.contact.run import Raw, run
from rockcli.solvers.contact.turns import SAME_PASSAGE, only_rocks, solved
from rockcli.solvers.event.perturbations import finer_than, perturbations
from rockcli.solvers.event.record_lanes import FINEST_AGAIN, asked

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]

SHEETS = (0.0, -1.0, 1.0)
"""Runs that a nearly flat landing is judged by: as its tilt has it, on the left edge first, on the right one."""


class Opened(NamedTuple):
    """Cases of which pure rocking does not tell what they do.

    Attributes:
        unknown: nobody looked at its forces: all modes of contact tell whether friction holds, (n,).
        slides: it slides or flies, (n,).
        raw: raw results of those that slide or fly; None if there are none.
    """

    unknown: Mask
    slides: Mask
    raw: Raw | None = None


def with_contact(batch: Batch, response: Response, level: Accuracy, opened: Opened) -> Response:
    """The response of pure rocking with, in its place, that of bodies that slide or leave the ground.

    Adds what only friction decides to all cases with a `mu`; cases without stay as they are, with NaN for it.

    Args:
        opened: what pure rocking does not tell, and what is known of it.
    """
    given = np.isfinite(batch.block.mu)
    scalars: dict[str, Any] = dict(response.scalars)
    if not given.any():
        nothing = repeated(np.full(1, np.nan), batch.size)
        return replace(response, scalars=scalars | dict.fromkeys(SCALARS_SLIDING, nothing))
    unknown = ~given | (np.asarray(scalars["outcome"]) < NO_UPLIFT)
    for name in SCALARS_SLIDING:
        scalars[name] = np.where(unknown | name.startswith("t_"), np.nan, 0.0)
    scalars["slide_residual"] = np.where(overturned(np.asarray(scalars["outcome"])), np.nan, scalars["slide_residual"])
    histories = dict(response.histories)
    if histories:
        histories |= held_histories(batch, histories)
    response = replace(response, scalars=scalars, histories=histories)
    answered = np.asarray(scalars["outcome"]) != FAILED
    leaves = leaves_rocking(batch, np.fmax(scalars["mu_required"], scalars["mu_impact"]), scalars["N_min_over_mg"])
    leaves &= answered | starts_otherwise(batch)
    if opened.raw is not None:
        response = _entered(batch, response, np.flatnonzero(opened.slides), opened.raw, None)
    rows = np.flatnonzero(given & (leaves | opened.unknown) & ~opened.slides)
    return _solved(batch, response, rows, level, opened.unknown[rows] & ~leaves[rows]) if len(rows) else response


def has_contact_forces(batch: Batch) -> Mask:
    """Which cases all modes of contact can be told of, (n,): nonlinear rigid bodies whose loss is that of impacts.

    The linearized block and the spring models have no consistent forces at the edge; a base damper acts on no modelled
    surface; a body whose mass is at one point has none left to turn; and one that rolls has more than two edges.
    """
    exact = batch.model == "rigid" and batch.damping.only_eta
    return np.asarray((batch.block.inertia > 1.0).all(axis=1) & ~batch.block.rolls & exact)


def leaves_rocking(batch: Batch, needs: Array, least: Array) -> Mask:
    """Where pure rocking needs more friction than there is, leaves the ground, or is not what the body begins with.

    Args:
        needs, least: its largest friction and smallest normal force over m g, NaN where not known, (n,).
    """
    with np.errstate(invalid="ignore"):
        slips, lifts = needs > batch.block.mu, least <= 0.0
    return np.asarray(starts_otherwise(batch) | (has_contact_forces(batch) & (slips | lifts)))


def starts_otherwise(batch: Batch) -> Mask:
    """Bodies that only slide, or that are pushed along the ground at first, (n,)."""
    pushed = False if batch.slide_rate_0 is None else batch.slide_rate_0 != 0.0
    return np.asarray(slides_only(batch) | pushed)


def _solved(batch: Batch, response: Response, rows: Index, level: Accuracy, open_: Mask) -> Response:
    """The response with that of all modes of contact for some cases; not of those `open_` that only rock, (rows,)."""
    some = batch.rows(rows)
    raw = _run(some, level, histories=bool(response.histories))
    if open_.any():  # in a map: no histories, no further runs
        kept = ~(open_ & only_rocks(raw.out) & ~_comes_back(response, rows, raw))
        rows, some, raw = rows[kept], some.rows(np.flatnonzero(kept)), raw.rows(kept)
        if not len(rows):
            return response
    return _entered(batch, response, rows, raw, _judged(some, raw, level) if batch.save.scalars & CERTAINTY else None)


def _comes_back(response: Response, rows: Index, raw: Raw) -> Mask:
    """Where a body that slips or flies beyond its equilibrium, and falls, would have come back had it not, (rows,)."""
    leaves = np.isfinite(raw.out[:, to.T_SLIP]) | np.isfinite(raw.out[:, to.T_FLIGHT])
    names = ("outcome", "n_impacts", "t_overturn")
    outcome, n_impacts, passed = (np.asarray(response.scalars[name])[rows] for name in names)
    later = np.abs(passed - raw.out[:, to.T_OVERTURN]) > SAME_PASSAGE  # not where nobody asked
    return np.asarray(leaves & (~overturned(outcome) | (n_impacts != raw.out[:, to.N_IMPACTS]) | later))


def _entered(batch: Batch, response: Response, rows: Index, raw: Raw, judgement: Judgement | None) -> Response:
    """The response with raw results of contact of some cases."""
    if not len(rows):
        return response
    some = batch.rows(rows)
    rocking = {name: np.asarray(values)[rows] for name, values in response.scalars.items()}
    found, said = answer(some, raw, rocking, has_contact_forces(some))
    if judgement is not None:
        judgement.enter(found, said)
    scalars, reasons = dict(response.scalars), list(response.reasons)
    for name in scalars.keys() - {"wall_time"}:  # of what is not answered here nothing is known
        scalars[name] = _with_rows(scalars[name], rows, found.get(name, np.nan))
    for row, reason in zip(rows, said, strict=True):
        reasons[row] = reason
    histories, impacts, time = dict(response.histories), response.impacts, response.time
    if histories:
        ours, hits = histories_of(some, raw)
        n_time = max(len(time), ours["theta"].shape[1])
        histories = {
            name: _with_rows(_padded(values, n_time), rows, _padded(ours[name], n_time))
            for name, values in histories.items()
        }
        last = int(np.flatnonzero(np.isfinite(histories["theta"]).any(axis=0))[-1]) + 1
        histories = {name: values[:, :last] for name, values in histories.items()}
        time = np.arange(last, dtype=np.float64) * np.float64(batch.save.dt_out)
        most = max([0, *(values.shape[1] for values in (*impacts.values(), *hits.values()))])
        impacts = {
            name: _with_rows(_padded(values, most), rows, _padded(hits[name], most)) for name, values in impacts.items()
        }
    return replace(response, scalars=scalars, reasons=reasons, time=time, histories=histories, impacts=impacts)


def _with_rows(values: NDArray[Any], rows: Index, new: Any) -> NDArray[Any]:
    copy = values.copy()
    copy[rows] = new
    return copy


def _padded(values: Array, n: int) -> Array:
    return np.pad(values, ((0, 0), (0, n - values.shape[1])), constant_values=np.nan)


def _run(batch: Batch, level: Accuracy, *, histories: bool) -> Raw:
    """Raw results of contact, by turns where lanes of records can take part."""
    return solved(batch, level) if _goes_by_turns(batch, level) else run(batch, level, histories=histories)


def _goes_by_turns(batch: Batch, level: Accuracy) -> bool:
    """Whether bodies of a batch may go by turns at a tolerance."""
    return asked(batch) and batch.excitation.vertical is None and bool(kernels.compiled) and level.rtol >= FINEST_AGAIN


def _judged(batch: Batch, raw: Raw, level: Accuracy) -> Judgement:
    """What further runs show; where two part, the more accurate one takes the place of the first in `raw`."""
    finer = finer_than(level)
    first, second, reach = perturbations(level, finer)
    turns = _goes_by_turns(batch, level)
    peaks = replace(
        batch, save=replace(batch.save, histories=False, scalars=frozenset({"theta_peak", "error_estimate"}))
    )

    pairs = turns and finer.rtol >= FINEST_AGAIN
    twins: list[Traces] = []  # of the more accurate runs, that of each of those

    def again(rows: Index, factors: Array, fine: bool) -> Traces:
        if fine and twins:
            return twins.pop()
        others = perturbed(peaks, rows, factors)
        how_well = finer if fine else level
        out = solved(others, how_well).out if turns and how_well.rtol >= FINEST_AGAIN else run(others, how_well).out
        return Traces.of_kernel(others, out, to)

    def refine(rows: Index) -> Traces:
        if pairs:  # few: with their perturbed runs they take half of the turns, and fill the lanes better
            both = perturbed(batch, np.tile(rows, 2), np.repeat([1.0, 1.0 - second.size], len(rows)))
            found = solved(both, finer)
            raw.put(rows, found.rows(np.arange(len(rows))))
            twins.append(Traces.of_kernel(both, found.out, to).rows(np.arange(len(rows), both.size)))
        else:
            raw.put(rows, _run(batch.rows(rows), finer, histories=raw.histories.shape[2] > 0))
        return Traces.of_kernel(batch, raw.out, to).rows(rows)

    found = judge(Traces.of_kernel(batch, raw.out, to), again, first, refine, second, reach)
    _judge_flat_landings(batch, raw, level, found)
    return found


def _judge_flat_landings(batch: Batch, raw: Raw, level: Accuracy, found: Judgement) -> None:
    """Runs that land on the one or the other edge first where the body comes down nearly flat."""
    rows = np.flatnonzero((raw.out[:, to.NEARLY_FLAT] < ILL_POSED) & np.isin(found.share, (0.0, 1.0)))
    if not len(rows):
        return
    some = batch.rows(rows)
    outs = [raw.out[rows], *(run(some, level, first=first).out for first in SHEETS[1:])]
    runs = [Traces.of_kernel(some, out, to) for out in outs]
    shares = np.nanmean([traces.share for traces in runs], axis=0)
    peaks = np.array([np.where(traces.verdict == FALLS, np.inf, traces.peak) for traces in runs])
    for i, row in enumerate(rows):
        if 0.0 < shares[i] < 1.0:
            found.share[row], found.error[row] = shares[i], np.inf
            found.said[row] = "whether it overturns hangs on the edge on which it comes down first"
        elif shares[i] == 0.0:
            found.error[row] = max(float(found.error[row]), float(np.nanmax(np.abs(peaks[:, i] - peaks[0, i]))))
