"""Bodies under a record by turns: in lanes while they rock or slip on one edge, one by one in what else there is.

A body that slides while it rocks does so for a small part of a record; the rest of its path is that of pure rocking,
for which lanes take a fortieth of the time of the kernel of contact.  Lanes stop a body before the step in which its
foot may give way; those that do then go on in lanes of those that rock and of those that slip, and with the kernel of
contact where they bounce to rest, slide on their base or fly.
"""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.kernels import handover as carry
from rockcli.kernels.constants import DONE, FALLS, GIVES_WAY, LEFT_TO_MARCH
from rockcli.kernels.contact import results as to
from rockcli.kernels.rigid import parameters as of_lanes
from rockcli.kernels.rigid import results as in_lanes
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, impulse_ratio
from rockcli.scene.numerics import Accuracy
from rockcli.solvers.common.certainty import CERTAINTY
from rockcli.solvers.contact.run import EXTREMES, Raw, from_the_beginning, march, parameters_of, run
from rockcli.solvers.contact.screen import ROUNDING
from rockcli.solvers.event import record_lanes
from rockcli.solvers.event.pack import parameters_of as pack
from rockcli.solvers.event.pack import settings_of
from rockcli.solvers.event.unpack import FORCES

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

BESIDE = EXTREMES | FORCES | CERTAINTY | {"mu_impact"}
"""Scalars that are asked of pure rocking too: of that all bodies are solved first."""

OF_ALL_STEPS = EXTREMES | {"energy_residual"}
"""Scalars that lanes have to look for in every step."""


SAME_PASSAGE = 1e-3
"""Times of a passage of the equilibrium that differ less are of the same one, with slip or without [s]."""


def can_take_turns(batch: Batch) -> Mask:
    """Bodies whose foot does not slip while they stand and where they land, (n,), and that nothing pushes."""
    block, landing = batch.block, impulse_ratio(batch.block, batch.damping.eta)
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
    pars, raw = parameters_of(slipping), _nothing_found(len(stopped))
    kernels.load("contact.march", compile_them=True).add_parts(pars, starts[stopped], found[stopped], raw.out)
    _follow(slipping, rows[stopped], pars, level, raw, starts[stopped])
    slips = ~only_rocks(raw.out)
    slides[stopped[slips]] = True
    found[stopped[slips], in_lanes.STATUS] = DONE  # as far as it goes
    rocks = stopped[~slips]
    if len(rocks):
        found[rocks] = record_lanes.run(lanes, batch, rows[rocks], how, cases=rocks)
        # one that slips beyond its equilibrium and falls may have come back once more had it not
        apart = np.abs(found[rocks, in_lanes.T_OVERTURN] - raw.out[~slips, to.T_OVERTURN]) > SAME_PASSAGE
        slides[rocks[apart]] = True
        slips[~slips] = apart
    return found, slides, raw.rows(slips)


def solved(batch: Batch, level: Accuracy) -> Raw:
    """Raw results of contact of all cases of a batch that lanes of records could take; by turns those that can."""
    rows = np.ascontiguousarray(pack(batch))
    turns = record_lanes.fit(batch, rows) & can_take_turns(batch)
    if not turns.any():
        return run(batch, level)
    some, taking = (batch, rows) if turns.all() else (batch.rows(np.flatnonzero(turns)), rows[turns])
    raw = _nothing_found(some.size)
    _follow(some, taking, parameters_of(some), level, raw, _held(some))
    if turns.all():
        return raw
    both, others = Raw(batch.size, 0, 0), np.flatnonzero(~turns)
    both.put(np.flatnonzero(turns), raw)
    both.put(others, run(batch.rows(others), level))
    return both


def only_rocks(out: Array) -> Mask:
    """Where no foot slips and none leaves the ground, (n,), or but on the way to the ground, beyond the equilibrium.

    A foot that jams would slip, but no slip of it lasts.
    """
    first = np.fmin(out[:, to.T_SLIP], out[:, to.T_FLIGHT])
    falling = (out[:, to.VERDICT] == FALLS) & (out[:, to.T_OVERTURN] <= first)
    stays = (out[:, to.N_JAMS] == 0.0) & (np.isnan(first) | falling)
    return np.asarray((out[:, to.STATUS] == DONE) & stays)


def _held(batch: Batch) -> Array:
    """Rows of `kernels.handover` for bodies that begin, with the friction that holds them."""
    starts = from_the_beginning(batch.size)
    starts[:, carry.MU], starts[:, carry.SLIDE], starts[:, carry.U] = batch.block.mu * ROUNDING, 0.0, 0.0
    return starts


def _lanes_of(batch: Batch, level: Accuracy) -> tuple[ModuleType, Any]:
    lanes: Any = kernels.load("lanes.records.march", compile_them=True)
    peaks: Any = kernels.load("rigid.march", compile_them=True)
    detail = lanes.ALL if batch.save.scalars & OF_ALL_STEPS else peaks.PEAKS
    return lanes, settings_of(lanes, batch, level, int(detail))


def _nothing_found(n: int) -> Raw:
    """Raw results of n bodies before anything has happened."""
    raw = Raw(n, 0, 0)
    raw.out[:] = _NOTHING_YET
    return raw


def _follow(batch: Batch, rows: Array, pars: Array, level: Accuracy, raw: Raw, starts: Array) -> None:
    """Follow bodies from where they are to their end; `raw` goes on from what it holds of them.

    Those that are past the end of the motion, of which lanes have no samples there, go on with the kernel of contact.
    A body of which lanes do not know the end begins anew, with that kernel alone.
    """
    lanes, how = _lanes_of(batch, level)
    past = starts[:, carry.T] >= rows[:, of_lanes.T_MOTION]
    during, after = np.flatnonzero(~past), np.flatnonzero(past)
    felt = raw.out[during]
    record_lanes.run(
        lanes, batch, rows[during], how, starts[during], cases=during, path=True, feet=pars[during], felt=felt
    )
    raw.out[during] = felt
    if len(after):
        some = raw.rows(after)
        march(batch.rows(after), pars[after], level, some, starts[after])
        raw.put(after, some)
    left = np.flatnonzero(raw.out[:, to.STATUS] == LEFT_TO_MARCH)
    if len(left):
        raw.put(left, run(batch.rows(left), level))


def _nothing_yet() -> Array:
    """Results of contact before anything has happened, (N_OUT,)."""
    out = np.zeros(to.N_OUT)
    for name in ("T_PEAK", "T_UPLIFT", "T_OVERTURN", "T_REST", "T_SLIP", "T_SLIDE_ROCK", "T_FLIGHT"):
        out[getattr(to, name)] = np.nan
    out[[to.N_MIN, to.N_STANDING, to.NEARLY_FLAT]] = np.inf
    return out


_NOTHING_YET = _nothing_yet()
