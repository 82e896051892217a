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
from rockcli.solvers.event.pack import settings_of
from rockcli.solvers.event.unpack import FORCES

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

BESIDE = EXTREMES | FORCES | CERTAINTY | {"mu_impact"}
"""Scalars that are asked of pure rocking too, or of every step of a body that slides."""

MOST_TURNS = 100
"""Turns after which a body stays with the kernel of contact."""

ADDED = ("N_STEPS", "N_IMPACTS", "N_SLIPS", "N_FLIGHTS", "N_JAMS", "TWO_WAYS", "SWINGS", "SWINGS_T")
EARLIEST = ("T_UPLIFT", "T_SLIP", "T_SLIDE_ROCK", "T_FLIGHT", "NEARLY_FLAT")
LARGEST = ("PEAK_LEFT", "PEAK_RIGHT", "GAIN")
AT_PEAK = ("PEAK", "PEAK_SIDE", "T_PEAK")
LAST = ("STATUS", "VERDICT", "T_END", "SLIDE_END")
"""How results of two parts of a path, one after the other, become those of both; of passages of the equilibrium the
last counts, of slides the largest either way."""


def can_take_turns(batch: Batch) -> Mask:
    """Bodies whose foot does not slip while they stand and where they land, (n,), and that nothing pushes."""
    block, eta = batch.block, batch.damping.eta
    landing = block.h[:, None] * (1.0 - eta) / (block.b[:, ::-1] + eta * block.b)
    pushed = False if batch.slide_rate_0 is None else batch.slide_rate_0 != 0.0
    with np.errstate(invalid="ignore"):
        holds = np.maximum(landing, block.tan_alpha).max(axis=1) < block.mu * ROUNDING
    return np.asarray(holds & np.logical_not(pushed))


def by_turns(batch: Batch, rows: Array, level: Accuracy) -> tuple[Array, Mask, Raw]:
    """Solve bodies that take turns.

    Args:
        rows: their parameters for lanes, (n, N_PAR).

    Returns:
        raw results of pure rocking (n, N_OUT), those of lanes without friction, to the bit, where it holds; who slides
        or flies, (n,); and the raw results of contact of those.
    """
    lanes, how = _lanes_of(batch, level)
    starts = from_the_beginning(batch.size)
    starts[:, carry.MU] = batch.block.mu * ROUNDING
    found = record_lanes.run(lanes, batch, rows, how, starts)
    stopped = np.flatnonzero(found[:, in_lanes.STATUS] == GIVES_WAY)
    slides = np.zeros(batch.size, dtype=bool)
    if not len(stopped):
        return found, slides, Raw(0, 0, 0)
    raw = _from_there(batch.rows(stopped), rows[stopped], level, found[stopped], starts[stopped])
    slips = ~only_rocks(raw.out)
    slides[stopped[slips]] = True
    found[stopped[slips], in_lanes.STATUS] = DONE  # as far as it goes
    rocks = stopped[~slips]
    if len(rocks):
        found[rocks] = record_lanes.run(lanes, batch, rows[rocks], how)
    return found, slides, raw.rows(slips)


def only_rocks(out: Array) -> Mask:
    """Where no foot slips and none leaves the ground, (n,), or but on the way to the ground, beyond the equilibrium."""
    first = np.fmin(out[:, to.T_SLIP], out[:, to.T_FLIGHT])
    falling = (out[:, to.VERDICT] == FALLS) & (out[:, to.T_OVERTURN] <= first)
    return np.asarray((out[:, to.STATUS] == DONE) & (np.isnan(first) | falling))


def _lanes_of(batch: Batch, level: Accuracy) -> tuple[ModuleType, Any]:
    lanes: Any = kernels.load("lanes.records.march", compile_them=True)
    peaks: Any = kernels.load("rigid.march", compile_them=True)
    return lanes, settings_of(lanes, batch, level, int(peaks.PEAKS))


def _from_there(batch: Batch, rows: Array, level: Accuracy, found: Array, starts: Array) -> Raw:
    """Raw results of contact of bodies that lanes have `found` up to where they stopped, `starts`."""
    lanes, how = _lanes_of(batch, level)
    raw, pars = Raw(batch.size, 0, 0), parameters_of(batch)
    starts[:, carry.SLIDE] = 0.0
    whole = starts[:, carry.Q] >= batch.block.alpha[:, LEFT]  # lanes have not noted when it passed the equilibrium
    on, turn = np.flatnonzero(~whole), 0
    while len(on):
        begun, part = starts[on], Raw(len(on), 0, 0)
        march(batch, pars[on], level, part, begun, hands_back=turn < MOST_TURNS)
        if turn == 0:
            raw.out[on] = _joined(part.out, found[on], in_lanes, later=False)
        else:
            raw.out[on] = _joined(raw.out[on], part.out, to)
        holds = part.out[:, to.STATUS] == HOLDS
        on, begun, turn = on[holds], begun[holds], turn + 1
        if not len(on):
            break
        then = record_lanes.run(lanes, batch, rows[on], how, begun, path=True)
        starts[on] = begun
        stopped = then[:, in_lanes.STATUS] == GIVES_WAY
        ended = (then[:, in_lanes.STATUS] == DONE) & np.isin(then[:, in_lanes.VERDICT], (RETURNS, FALLS))
        known = stopped | ended
        raw.out[on[known]] = _joined(raw.out[on[known]], then[known], in_lanes)
        whole[on[~known]] = True
        on = on[stopped]
    left = np.flatnonzero(whole)
    if len(left):
        raw.put(left, run(batch.rows(left), level))
    return raw


def _joined(total: Array, part: Array, columns: ModuleType, *, later: bool = True) -> Array:
    """Results of contact with those of another part of the path, whose columns are those of a module."""

    def of(name: str) -> Array:
        return np.asarray(part[:, getattr(columns, name)])

    both = total.copy()
    known = [name for name in (*ADDED, *EARLIEST, *LARGEST, *LAST) if hasattr(columns, name)]
    for name in known:
        column = both[:, getattr(to, name)]
        if name in ADDED:
            column += of(name)
        elif name in EARLIEST:
            column[:] = np.fmin(column, of(name))
        elif name in LARGEST:
            column[:] = np.maximum(column, of(name))
        elif later:
            column[:] = of(name)
    higher = of("PEAK") > both[:, to.PEAK] * (1.0 + 1e-12)
    for name in AT_PEAK:
        both[higher, getattr(to, name)] = of(name)[higher]
    if later:
        passed = np.isfinite(of("T_OVERTURN"))
        both[passed, to.T_OVERTURN] = of("T_OVERTURN")[passed]
    if columns is to:
        farther = np.abs(of("SLIDE_PEAK")) > np.abs(both[:, to.SLIDE_PEAK])
        both[farther, to.SLIDE_PEAK] = of("SLIDE_PEAK")[farther]
    return both
