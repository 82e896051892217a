"""The kernel of contact for some cases of a batch: from bodies and motions to raw output."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.kernels import handover as carry
from rockcli.kernels.constants import OUT_OF_STEPS
from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import results as to
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT, housner_eta
from rockcli.scene.ground.excitation import Channel
from rockcli.scene.numerics import Accuracy
from rockcli.scene.response import MAX_IMPACTS_STORED
from rockcli.solvers.common.duration import durations_of, output_times
from rockcli.solvers.common.ground import channel_of, factors_of

Array = NDArray[np.float64]

ORDER = 20
"""Order of the Taylor series."""

MAX_STEPS = {True: 5_000_000, False: 100_000}
"""Steps a case may take, compiled or not."""


EXTREMES = frozenset({"theta_dot_peak", "N_min_over_mg", "u_top_peak"})
"""Scalars that cost a look along every step."""

HISTORIES = ("theta", "theta_dot", "slide", "slide_dot", "contact_mode", "lift")
"""What the kernel writes at output times."""


class Raw:
    """Raw output of n cases: `out` (n, N_OUT), histories (n, 6, k), impacts (n, 3, j)."""

    def __init__(self, n: int, n_time: int, n_impacts: int) -> None:
        self.out = np.zeros((n, to.N_OUT))
        self.histories = np.full((n, len(HISTORIES), n_time), np.nan)
        self.impacts = np.full((n, 3, n_impacts), np.nan)

    def rows(self, kept: NDArray[np.bool_] | NDArray[np.int64]) -> Raw:
        """A copy of some cases."""
        some = Raw(0, 0, 0)
        for name, values in vars(self).items():
            setattr(some, name, values[kept])
        return some

    def put(self, rows: NDArray[np.int64], other: Raw) -> None:
        """Take other runs, as large, in place of those of some cases."""
        for name, values in vars(other).items():
            getattr(self, name)[rows] = values


def run(batch: Batch, level: Accuracy, *, first: float = 0.0, histories: bool = False) -> Raw:
    """Solve every case of a batch; `first` is the edge that strikes first in nearly flat landings, 0: as they are.

    A case that needs more steps than plain Python may take is solved again compiled.
    """
    pars = parameters_of(batch, first)
    n_time = output_times(batch.save.dt_out, pars[:, at.T_STOP].max()) if histories else 0
    raw = Raw(batch.size, n_time, MAX_IMPACTS_STORED if histories else 0)
    march(batch, pars, level, raw)
    if not kernels.compiled and np.any(raw.out[:, to.STATUS] == OUT_OF_STEPS):
        kernels.load("contact.march", compile_them=True)
        raw = Raw(batch.size, n_time, MAX_IMPACTS_STORED if histories else 0)
        march(batch, pars, level, raw)
    return raw


def from_the_beginning(n: int) -> Array:
    """Rows of `kernels.handover` for n cases that begin as their parameters have it."""
    return np.full((n, carry.N_HANDOVER), -1.0)


def march(batch: Batch, pars: Array, level: Accuracy, raw: Raw, starts: Array | None = None) -> None:
    """The kernel for the rows of parameters of all cases of a batch, into `raw`.

    `starts`: rows of `kernels.handover` for bodies of which `raw` goes on from what it holds.
    """
    starts = from_the_beginning(len(pars)) if starts is None else starts
    suite = batch.excitation.suite
    if suite is None:
        _march(batch, batch.excitation.horizontal, pars, level, raw, starts)
        return
    for record, rows in suite.cases():
        part = raw.rows(rows)
        _march(batch, record, pars[rows], level, part, starts[rows])
        raw.put(rows, part)


def _march(
    batch: Batch, horizontal_motion: Channel | None, pars: Array, level: Accuracy, raw: Raw, starts: Array
) -> None:
    """`march` under one motion."""
    kernel = kernels.load("contact.march", compile_them=bool(kernels.compiled))
    channels = (horizontal_motion, batch.excitation.vertical)
    (horizontal, h_data), (vertical, v_data) = (channel_of(kernel, c, batch.size) for c in channels)
    events = np.empty((len(pars), 2, 0))  # for tests
    arrays = [raw.histories, raw.impacts, events, raw.out]
    inputs: list[Any] = [pars, h_data, v_data, starts]
    outputs: list[Any] = list(arrays)
    if not kernels.compiled:  # lists are three times faster than arrays for plain Python
        inputs, outputs = [x.tolist() for x in inputs], [x.tolist() for x in arrays]
    rows, h_data, v_data, begin = inputs
    how = kernel.Settings(
        tol=level.rtol,
        rest_speed=level.rest_speed,
        max_steps=MAX_STEPS[bool(kernels.compiled)],
        order=ORDER,
        balance="energy_residual" in batch.save.scalars,
        extremes=bool(batch.save.scalars & EXTREMES),
        hands_back=False,
    )
    *written, out = outputs
    kernel.march_all(
        rows, how, horizontal, h_data, vertical, v_data, batch.save.dt_out, begin, *written, kernel.work_space(), out
    )
    if not kernels.compiled:
        for array, output in zip(arrays, outputs, strict=True):
            array[...] = output


def parameters_of(batch: Batch, first: float = 0.0) -> Array:
    """One row per case in the layout of `kernels.contact.parameters`."""
    block, lasts = batch.block, durations_of(batch)
    rows = np.zeros((batch.size, at.N_PAR))
    r_g2 = ((block.inertia - 1.0) * block.R**2).mean(axis=1)  # of both edges, the same but for rounding
    rows[:, at.G], rows[:, at.H], rows[:, at.RG2], rows[:, at.TOP] = batch.g, block.h, r_g2, block.top
    rows[:, at.MU_S] = block.mu
    rows[:, at.MU_K] = block.mu_in_motion
    rows[:, at.E_N] = np.nan_to_num(block.e_n)
    for edge, j, i in ((at.LEFT, LEFT, RIGHT), (at.RIGHT, RIGHT, LEFT)):
        rows[:, edge + at.B], rows[:, edge + at.ALPHA], rows[:, edge + at.RADIUS] = (
            block.b[:, j], block.alpha[:, j], block.R[:, j],
        )  # fmt: skip
        eta, inelastic = batch.damping.eta[:, j], housner_eta(block)[:, j]
        place = (r_g2 + block.h**2) * (1.0 - eta) / (block.b[:, i] + eta * block.b[:, j])
        # Housner's impulse acts at the new edge, also where his eta is negative and was taken as 0
        rows[:, edge + at.PLACE] = np.where(eta == np.maximum(inelastic, 0.0), block.b[:, j], place)
    rows[:, at.THETA_0], rows[:, at.THETA_DOT_0] = batch.theta_0, batch.theta_dot_0
    rows[:, at.SLIDE_RATE_0] = 0.0 if batch.slide_rate_0 is None else batch.slide_rate_0
    rows[:, at.T_MOTION], rows[:, at.T_STOP], rows[:, at.HAS_DURATION] = lasts.motion, lasts.report, lasts.given
    motion = batch.excitation
    rows[:, at.FACTOR_H] = factors_of(motion.suite or motion.horizontal, batch.size)
    rows[:, at.FACTOR_V] = factors_of(motion.vertical, batch.size)
    rows[:, at.FIRST] = first
    return rows
