"""Bodies under a record by turns: in lanes while friction holds their foot, one by one while it slips or flies.

A body that slides while it rocks does so for a small part of a record; the rest of its path is that of pure rocking,
for which lanes take a fortieth of the time.  Lanes stop a body before the step in which its foot may give way, the
kernel of contact takes it from there, and hands it back when the foot has held for a while.
"""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.kernels import handover as carry
from rockcli.kernels.constants import DONE, FALLS, GIVES_WAY, HOLDS, RETURNS
from rockcli.kernels.contact import results as to
from rockcli.kernels.rigid import results as in_lanes
from rockcli.scene.batch import Batch
from rockcli.scene.block import LEFT
from rockcli.scene.numerics import Accuracy
from rockcli.solvers.common.certainty import CERTAINTY
from rockcli.solvers.contact.run import EXTREMES, Raw, from_the_beginning, march, parameters_of, run
from rockcli.solvers.contact.screen import ROUNDING
from rockcli.solvers.event import record_lanes
from rockcli.solvers.event.pack import parameters_of as pack
from rockcli.solvers.event.pack import settings_of
from rockcli.solvers.event.record_lanes import Laid
from rockcli.solvers.event.unpack import FORCES

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

BESIDE = EXTREMES | FORCES | CERTAINTY | {"mu_impact"}
"""Scalars that are asked of pure rocking too: of that all bodies are solved first."""

OF_ALL_STEPS = EXTREMES | {"energy_residual"}
"""Scalars that lanes have to look for in every step."""

MOST_TURNS = 100
"""Turns after which a body stays with the kernel of contact."""


def can_take_turns(batch: Batch) -> Mask:
    """Bodies whose foot does not slip while they stand and where they land, (n,), and that nothing pushes."""
    block, eta = batch.block, batch.damping.eta
    landing = block.h[:, None] * (1.0 - eta) / (block.b[:, ::-1] + eta * block.b)
    pushed = False if batch.slide_rate_0 is None else batch.slide_rate_0 != 0.0
    with np.errstate(invalid="ignore"):
        holds = np.maximum(landing, block.tan_alpha).max(axis=1) < block.mu * ROUNDING
    return np.asarray(holds & np.logical_not(pushed))


def by_turns(batch: Batch, rows: Array, level: Accuracy) -> tuple[Array, Mask, Raw]:
    """Solve bodies that take turns, and tell who only rocks.

    Args:
        rows: their parameters for lanes, (n, N_PAR).

    Returns:
        raw results of pure rocking (n, N_OUT), those of lanes without friction, to the bit, where it holds; who slides
        or flies, (n,); and the raw results of contact of those.
    """
    lanes, how = _lanes_of(batch, level)
    starts = _held(batch)
    found = record_lanes.run(lanes, batch, rows, how, starts)
    stopped = np.flatnonzero(found[:, in_lanes.STATUS] == GIVES_WAY)
    slides = np.zeros(batch.size, dtype=bool)
    if not len(stopped):
        return found, slides, Raw(0, 0, 0)
    # lanes that are not asked for the path have not noted when those beyond the equilibrium passed it
    late = stopped[starts[stopped, carry.Q] >= batch.block.alpha[stopped, LEFT]]
    if len(late):
        begun = _held(batch)[late]
        found[late] = record_lanes.run(lanes, batch, rows[late], how, begun, cases=late, path=True)
        starts[late] = begun
    slipping = batch.rows(stopped)
    laid = Laid.of(lanes, slipping)
    raw = _followed(slipping, rows[stopped], level, found[stopped], np.arange(len(stopped)), starts[stopped], laid)
    slips = ~only_rocks(raw.out)
    slides[stopped[slips]] = True
    found[stopped[slips], in_lanes.STATUS] = DONE  # as far as it goes
    rocks = stopped[~slips]
    if len(rocks):
        found[rocks] = record_lanes.run(lanes, batch, rows[rocks], how, cases=rocks)
    return found, slides, raw.rows(slips)


def solved(batch: Batch, level: Accuracy) -> Raw:
    """Raw results of contact of all cases of a batch that lanes of records could take; by turns those that can."""
    rows = np.ascontiguousarray(pack(batch))
    turns = record_lanes.fit(batch, rows) & can_take_turns(batch)
    if not turns.any():
        return run(batch, level)
    lanes, how = _lanes_of(batch, level)
    some, taking = (batch, rows) if turns.all() else (batch.rows(np.flatnonzero(turns)), rows[turns])
    starts = _held(some)
    laid = Laid.of(lanes, some)
    on, starts = _in_order(np.arange(some.size), starts, laid)
    found = record_lanes.run(lanes, some, taking[on], how, starts, cases=on, path=True, laid=laid)
    raw = _followed(some, taking, level, found, on, starts, laid)
    if turns.all():
        return raw
    both, others = Raw(batch.size, 0, 0), np.flatnonzero(~turns)
    both.put(np.flatnonzero(turns), raw)
    both.put(others, run(batch.rows(others), level))
    return both


def only_rocks(out: Array) -> Mask:
    """Where no foot slips and none leaves the ground, (n,), or but on the way to the ground, beyond the equilibrium."""
    first = np.fmin(out[:, to.T_SLIP], out[:, to.T_FLIGHT])
    falling = (out[:, to.VERDICT] == FALLS) & (out[:, to.T_OVERTURN] <= first)
    return np.asarray((out[:, to.STATUS] == DONE) & (np.isnan(first) | falling))


def _held(batch: Batch) -> Array:
    """Rows of `kernels.handover` for bodies that begin, with the friction that holds them."""
    starts = from_the_beginning(batch.size)
    starts[:, carry.MU], starts[:, carry.SLIDE] = batch.block.mu * ROUNDING, 0.0
    return starts


def _lanes_of(batch: Batch, level: Accuracy) -> tuple[ModuleType, Any]:
    lanes: Any = kernels.load("lanes.records.march", compile_them=True)
    peaks: Any = kernels.load("rigid.march", compile_them=True)
    detail = lanes.ALL if batch.save.scalars & OF_ALL_STEPS else peaks.PEAKS
    return lanes, settings_of(lanes, batch, level, int(detail))


def _in_order(on: NDArray[np.int64], starts: Array, laid: Laid | None) -> tuple[NDArray[np.int64], Array]:
    """Cases and where they start, as lanes had better take them."""
    if laid is None:
        return on, starts
    order = laid.order(on, starts)
    return on[order], starts[order]


def _followed(
    batch: Batch, rows: Array, level: Accuracy, then: Array, on: NDArray[np.int64], begun: Array, laid: Laid | None
) -> Raw:
    """Raw results of contact of bodies that lanes have taken as far as `then` says, those that stopped to `begun`.

    `on`: the cases of these rows, in whatever order.  A body of which lanes do not know the end begins anew, with the
    kernel of contact alone.
    """
    lanes, how = _lanes_of(batch, level)
    raw, pars = Raw(batch.size, 0, 0), parameters_of(batch)
    raw.out[:] = _NOTHING_YET
    whole = np.zeros(batch.size, dtype=bool)
    turn = 0
    while len(on):
        verdict, stopped = then[:, in_lanes.VERDICT], then[:, in_lanes.STATUS] == GIVES_WAY
        known = stopped | (then[:, in_lanes.STATUS] == DONE) & ((verdict == RETURNS) | (verdict == FALLS))
        if not known.all():
            whole[on[~known]] = True
            on, begun, then = on[known], begun[known], then[known]
        some = raw.rows(on)
        march(batch, pars[on], level, some, begun, cases=on, hands_back=turn < MOST_TURNS, parts=then, laid=laid)
        raw.put(on, some)
        holds = some.out[:, to.STATUS] == HOLDS
        on, begun = _in_order(on[holds], begun[holds], laid)
        turn += 1
        then = record_lanes.run(lanes, batch, rows[on], how, begun, cases=on, path=True, laid=laid)
    left = np.flatnonzero(whole)
    if len(left):
        raw.put(left, run(batch.rows(left), level))
    return raw


def _nothing_yet() -> Array:
    """Results of contact before anything has happened, (N_OUT,)."""
    out = np.zeros(to.N_OUT)
    for name in ("T_PEAK", "T_UPLIFT", "T_OVERTURN", "T_REST", "T_SLIP", "T_SLIDE_ROCK", "T_FLIGHT"):
        out[getattr(to, name)] = np.nan
    out[[to.N_MIN, to.NEARLY_FLAT]] = np.inf
    return out


_NOTHING_YET = _nothing_yet()
