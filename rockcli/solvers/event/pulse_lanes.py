"""Pulse maps in lanes: which bodies `kernels.lanes.pulses.march` takes, and what it is given (docs/lanes.md)."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import LEFT_TO_MARCH
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rolling import results as results_of_rolling
from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import PIECE_WIDTH, Pulses
from rockcli.scene.laws.models import MODELS
from rockcli.scene.variables import (
    SCALARS_ASYMMETRIC,
    SCALARS_AUTO,
    SCALARS_FEMA,
    SCALARS_FLEXIBLE,
    SCALARS_ROLLING,
    SCALARS_SLIDING,
)
from rockcli.solvers.common.certainty import CERTAINTY
from rockcli.solvers.event.unpack import FORCES

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

METHOD = "Taylor series, many bodies in lanes, events located on the polynomial, outcomes decided early"
METHOD_ON_PATH = "Taylor series, many bodies in lanes, events located on the polynomial"

FINEST = 1e-13
"""Smallest tolerance of the lanes: the reference stays with the single-body kernels, as
polynomials of the lanes' order would need many steps per sample."""

WITHIN = frozenset(
    {
        "outcome", "theta_peak", "theta_peak_over_alpha", "u_top_peak", "t_peak", "t_uplift", "n_impacts",
        "wall_time", "reason", *SCALARS_ASYMMETRIC, *SCALARS_ROLLING,
    }
)  # fmt: skip
"""Scalars that the lanes find where they stop as soon as the outcome is known."""

ON_PATH = frozenset(
    {
        "t_overturn", "t_end", "mu_impact", "n_steps", "n_rhs", *FORCES, *CERTAINTY, *SCALARS_FLEXIBLE, *SCALARS_FEMA,
        *SCALARS_SLIDING, *SCALARS_AUTO,
    }
)  # fmt: skip
"""What else they find where they follow the path of a body to its end, or what these bodies have not."""

TO_THE_GROUND = frozenset({"t_end", "n_steps", "n_rhs", *FORCES})
"""Those for which a body that falls is followed until it lies on its side."""

SECONDS = 0.01
"""A case in lanes of plain Python [s]."""

MAX_STEPS = 10_000
"""Steps of a case after which it is left to the single-body kernels."""


def asked(batch: Batch) -> bool:
    """Whether what is asked can be found in lanes that stop early, whatever the number of cases."""
    return is_for_lanes(batch) and batch.save.scalars <= WITHIN


def path_asked(batch: Batch) -> bool:
    """Whether more is asked than that, and lanes can follow the path, for which kernels are compiled."""
    more = batch.save.scalars - WITHIN
    return bool(more) and more <= ON_PATH and not MODELS[batch.model, batch.geometry].linear and is_for_lanes(batch)


def is_for_lanes(batch: Batch) -> bool:
    """Whether motions, damping and accuracy are for lanes, whatever is asked but histories."""
    motion = batch.excitation
    return (
        isinstance(motion.horizontal, Pulses)
        and motion.vertical is None
        and batch.damping.only_eta
        and not batch.save.histories
        and batch.numerics.tolerances.rtol >= FINEST
    )


def fit(batch: Batch, rows: Array) -> Mask:
    """Which rows (n, N_PAR) of a batch the lanes take, (n,).

    Bodies whose report ends at a given time only without friction, and only as far as their peaks.
    """
    ends = rows[:, at.HAS_DURATION] == 0.0
    return np.asarray(ends if path_asked(batch) else ends | np.isnan(batch.block.mu))


def even(rows: Array) -> Mask:
    """Which rows (n, N_PAR) are of bodies with two equal edges, (n,)."""
    left, right = (rows[:, side : side + at.EDGE] for side in (at.LEFT, at.RIGHT))
    return np.asarray(np.all(left == right, axis=1))


def run(lanes: ModuleType, batch: Batch, rows: Array, how: Any, cases: Any, *, path: bool) -> Array:
    """Raw results (n, N_OUT) for the rows (n, N_PAR) of some cases of a batch.

    `how`: `Settings` of the single-body kernels; `path`: bodies are followed to the end of their paths.  NaN in STATUS
    for a body that is left to the single-body kernels.
    """
    return in_lanes(lanes, batch, rows, how, cases, np.empty((0, 0)), path=path)


def in_lanes(
    lanes: ModuleType, batch: Batch, rows: Array, how: Any, cases: Any, bodies: Array, *, path: bool = False
) -> Array:
    """`run` of bodies on two edges, or of the `bodies` that roll: `kernels.rolling.parameters`."""
    channel = batch.excitation.horizontal
    assert isinstance(channel, Pulses)
    tables, until_fall = channel.table[cases], not batch.save.scalars & TO_THE_GROUND
    width = results_of_rolling.N_OUT if len(bodies) else to.N_OUT
    found = np.zeros((len(rows), width))
    how = how._replace(max_steps=MAX_STEPS)
    with np.errstate(all="ignore"):  # idle lanes divide by zero too
        for two_sided, kind in _kinds(rows, bodies):  # apart, so that no body depends on others
            for table, some in _begun(tables, kind):
                part, pieces = found[some], table.shape[1]
                pulses, work = table.reshape(len(table), pieces * PIECE_WIDTH), lanes.work_space()
                order = in_turn(_strength(rows[some], table))
                lanes.sweep(order, rows[some], bodies, how, pulses, pieces, two_sided, path, until_fall, work, part)
                if not isinstance(some, slice):  # of a slice `part` is a view
                    found[some] = part
    found[found[:, to.STATUS] == LEFT_TO_MARCH, to.STATUS] = np.nan
    if not path:
        found[:, to.T_OVERTURN] = found[:, to.T_END] = np.nan  # the lanes stop where the answer is known
    if not path or how.detail < lanes.ALL:
        found[:, to.N_MIN] = found[:, to.N_STANDING] = np.inf  # nobody looked, at those that never lift either
    return found


def _kinds(rows: Array, bodies: Array) -> list[tuple[bool, Any]]:
    """Bodies whose edges are alike, and those whose edges differ: (whether they do, rows), as far as there are any."""
    whole = slice(0, len(rows))
    if len(bodies):
        return [(True, whole)]
    differs = rows[:, at.LEFT : at.LEFT + at.EDGE] != rows[:, at.RIGHT : at.RIGHT + at.EDGE]
    if not differs.any():
        return [(False, whole)]
    uneven = differs.any(axis=1)  # row by row is slow
    if uneven.all():
        return [(True, whole)]
    return [(False, np.flatnonzero(~uneven)), (True, np.flatnonzero(uneven))]


def _strength(rows: Array, tables: Array) -> Array:
    """The largest |a_g| of some rows' pulses over that which lifts the body, (n,)."""
    if not tables.shape[1]:
        return np.zeros(len(rows))
    return np.asarray(tables[:, 0, 13] / (rows[:, at.G] * rows[:, at.LEFT + at.THRESHOLD]))


def in_turn(strength: Array) -> NDArray[np.int64]:
    """The order in which rows of a strength (n,), without unit, take a lane: their numbers, (n,).

    In a map the strength rises or falls over every line, and again over the next: WIDTH lines are gone through side by
    side, as their points of one strength have most in common.  Other rows are taken as they come.
    """
    n = len(strength)
    change = np.diff(strength)
    begins = np.flatnonzero(change < 0.0) + 1
    if 2 * len(begins) > n:
        begins = np.flatnonzero(change > 0.0) + 1
    if len(begins) < 2:
        return np.arange(n)
    length = int(begins[1] - begins[0])
    if begins[0] > length or not (np.diff(begins) == length).all() or n - begins[-1] > length:
        return np.arange(n)
    missing = length - int(begins[0])  # of the first line
    lines = np.arange(len(begins) + 1)
    places = [
        (some[None, :] * length + np.arange(length)[:, None]).ravel() - missing
        for some in np.array_split(lines, range(WIDTH, len(lines), WIDTH))
    ]
    order = np.concatenate(places)
    return np.asarray(order[(order >= 0) & (order < n)])


def _begun(tables: Array, some: Any) -> list[tuple[Array, Any]]:
    """Pieces of some rows' pulses (n, pieces, `ground.WIDTH`), and these rows, as far as there are any.

    Apart those whose pulse begins at once, without the silence that others of the batch have before theirs.
    """
    at_once = tables[some, 0, 1] <= 0.0
    if tables.shape[1] == 1 or not at_once.any():
        return [(tables[some], some)]
    rows = np.arange(len(tables))[some]
    parts = [(tables[rows[at_once], 1:], rows[at_once]), (tables[rows[~at_once]], rows[~at_once])]
    return [part for part in parts if len(part[1])]
