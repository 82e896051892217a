"""Bodies that slide and never rock, and the mode of contact at every output time (docs/objects.md)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.kernels.constants import DONE
from rockcli.kernels.formulas import driving, pull, restoring
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.scene.batch import Batch
from rockcli.scene.block import LEFT, RIGHT
from rockcli.scene.contact import FREE_FLIGHT, REST, ROCK, SLIDE, SLIDE_ROCK, mode_from_rest, slides_only
from rockcli.scene.models import MODELS
from rockcli.scene.response import FAILED, NO_UPLIFT, SLIDING, UNRESOLVED, Response
from rockcli.scene.variables import SCALARS_ASYMMETRIC
from rockcli.solvers.common.duration import output_times
from rockcli.solvers.common.found import counts
from rockcli.solvers.common.ground import channel_of, ground_history
from rockcli.solvers.event.pack import parameters_of

Array = NDArray[np.float64]

SLIDES = "slides and does not rock: mu is not above tan(alpha)"

ABSENT = ("t_peak", "t_uplift", "t_overturn", "energy_residual")
NOTHING = ("theta_peak", "theta_peak_over_alpha", "theta_dot_peak", "mu_impact", "error_estimate", "overturn_share")
"""Scalars that a body which slides and never rocks has not, and those that are 0."""


@dataclass(frozen=True, eq=False)
class Slid:
    """What the kernel found for the cases `rows`: `out` (n, SLIDE_OUT); `histories` (n, 3, k) at output times.

    These are u [m], its rate [m/s] and the direction of sliding, 0 where the body sticks; k = 0 without histories.
    """

    rows: NDArray[np.intp]
    out: Array
    histories: Array


def with_sliding(batch: Batch, response: Response, max_steps: int) -> Response:
    """The response of bodies that cannot slide, in its place that of those that slide and never rock.

    Adds the displacement along the ground and the mode of contact of all cases with a `mu`; cases without stay as
    they are, with NaN for what only friction decides.
    """
    given = np.isfinite(batch.block.mu)
    scalars, histories, time = dict(response.scalars), dict(response.histories), response.time
    unknown = ~given | (np.asarray(scalars["outcome"]) < NO_UPLIFT)
    scalars |= {name: np.where(unknown, np.nan, 0.0) for name in ("slide_peak", "slide_residual")}
    if not given.any():
        return replace(response, scalars=scalars)
    if histories:
        rocks = np.isfinite(histories["theta"]) & given[:, None]
        still = np.where(rocks, 0.0, np.nan)
        modes = np.where(rocks, _modes(batch, histories), np.nan)
        histories |= {"slide": still, "slide_dot": still, "contact_mode": modes}
    rows = np.flatnonzero(slides_only(batch))
    if not len(rows):
        return replace(response, scalars=scalars, histories=histories)
    slid = _solved(batch, rows, max_steps, histories=bool(histories))
    reasons, impacts = list(response.reasons), response.impacts
    for name, values in _scalars(batch, slid).items():
        if name in scalars:
            scalars[name] = _with_rows(scalars[name], rows, values)
    for row, reason in zip(rows, _reasons(slid), strict=True):
        reasons[row] = reason
    if histories:
        ours = _histories(batch, slid)
        n_time = max(len(time), slid.histories.shape[2])
        histories = {name: _with_rows(_padded(values, n_time), rows, _padded(ours[name], n_time))
                     for name, values in histories.items()}  # fmt: skip
        last = int(np.flatnonzero(np.isfinite(histories["theta"]).any(axis=0))[-1]) + 1
        histories = {name: values[:, :last] for name, values in histories.items()}
        time = np.arange(last, dtype=np.float64) * np.float64(batch.save.dt_out)
        impacts = {name: _with_rows(values, rows, np.nan) for name, values in impacts.items()}
    return replace(response, scalars=scalars, reasons=reasons, time=time, histories=histories, impacts=impacts)


def _with_rows(values: NDArray[Any], rows: NDArray[np.intp], new: Any) -> NDArray[Any]:
    copy = values.copy()
    copy[rows] = new
    return copy


def _padded(values: Array, n_time: int) -> Array:
    return np.pad(values, ((0, 0), (0, n_time - values.shape[1])), constant_values=np.nan)


def _solved(batch: Batch, rows: NDArray[np.intp], max_steps: int, *, histories: bool) -> Slid:
    """Run the kernel, compiled or not as those of rocking were."""
    kernel = kernels.load("rigid.sliding", compile_them=bool(kernels.compiled))
    every = parameters_of(batch)
    columns = [at.T_MOTION, at.T_STOP, at.HAS_DURATION, at.FACTOR_H, at.FACTOR_V]
    pars: Any = np.column_stack([batch.block.mu, batch.g, every[:, columns]])[rows]
    n_time = output_times(batch.save.dt_out, every[rows, at.T_STOP].max()) if histories else 0
    found = Slid(rows, np.zeros((len(rows), to.SLIDE_OUT)), np.full((len(rows), 3, n_time), np.nan))
    arrays = [found.histories, found.out]
    channels = (batch.excitation.horizontal, batch.excitation.vertical)
    (horizontal, h_data), (vertical, v_data) = (channel_of(kernel, c, batch.size, rows) for c in channels)
    inputs, outputs = [pars, h_data, v_data], list(arrays)
    if not kernels.compiled:
        inputs, outputs = [x.tolist() for x in inputs], [x.tolist() for x in arrays]
    pars, h_data, v_data = inputs
    kernel.slide_all(pars, max_steps, horizontal, h_data, vertical, v_data, batch.save.dt_out, *outputs)
    if not kernels.compiled:
        for array, output in zip(arrays, outputs, strict=True):
            array[...] = output
    return found


def _scalars(batch: Batch, slid: Slid) -> dict[str, Any]:
    """Scalars by name of the cases that slide."""
    out = slid.out
    failed, flew = out[:, to.STATUS] != DONE, np.isfinite(out[:, to.T_FLIGHT])
    missing = failed | flew

    def known(values: Any) -> Array:
        return np.where(missing, np.nan, values)

    peak = known(np.abs(out[:, to.SLIDE_PEAK]))
    outcome = np.where(peak > 0.0, SLIDING, np.where(flew, UNRESOLVED, NO_UPLIFT))
    needed = np.minimum(out[:, to.MU], batch.block.mu[slid.rows])  # a slide never needs more than there is
    return {
        **dict.fromkeys(ABSENT, np.nan),
        **{name: known(0.0) for name in NOTHING},
        **dict.fromkeys(SCALARS_ASYMMETRIC, np.where(batch.block.symmetric[slid.rows], np.nan, known(0.0))),
        "n_impacts": 0,
        "outcome": np.where(failed, FAILED, outcome).astype(np.int8),
        "u_top_peak": peak,
        "slide_peak": peak,
        "slide_residual": known(out[:, to.SLIDE_END]),
        "t_end": np.where(failed, np.nan, out[:, to.T_END]),
        "mu_required": np.where(failed, np.nan, np.where(flew, np.inf, needed)),
        "N_min_over_mg": np.where(failed, np.nan, np.where(flew, np.minimum(out[:, to.N_MIN], 0.0), out[:, to.N_MIN])),
        "n_steps": counts(out[:, to.N_STEPS]),
        "n_rhs": counts(out[:, to.N_STEPS]),  # a step is one expansion
    }


def _reasons(slid: Slid) -> list[str]:
    said = []
    for out in slid.out:
        if out[to.STATUS] != DONE:
            said.append(f"gave up after {out[to.N_STEPS]:.0f} steps at t = {out[to.T_END]:.6g} s")
        elif np.isfinite(out[to.T_FLIGHT]):
            said.append(f"the normal force vanishes at t = {out[to.T_FLIGHT]:.6g} s: free flight is not simulated")
        else:
            said.append(SLIDES if out[to.SLIDE_PEAK] != 0.0 else "")
    return said


def _histories(batch: Batch, slid: Slid) -> dict[str, Array]:
    """Histories by name of the cases that slide, (n, k)."""
    rows, (u, rate, way) = slid.rows, slid.histories.transpose(1, 0, 2)
    t = np.arange(u.shape[1], dtype=np.float64) * np.float64(batch.save.dt_out)
    live = np.isfinite(u)
    a_g, a_v = ground_history(batch, t, live, rows)
    mu, g, h = batch.block.mu[rows, None], batch.g[rows, None], batch.block.h[rows, None]
    mass = np.where(np.isfinite(batch.block.mass), batch.block.mass, 1.0)[rows, None]
    friction = np.where(way == 0.0, a_g, -way * mu * (g + a_v))  # on the body, per unit mass
    modes = np.where(way != 0.0, SLIDE, REST)
    found = {
        **dict.fromkeys(("theta", "theta_dot", "v_top"), np.zeros_like(u)),
        "a_g": a_g,
        "a_v": a_v,
        "u_top": u,
        "M_base": -friction * h * mass,
        "slide": u,
        "slide_dot": rate,
        "contact_mode": np.where(g + a_v <= 0.0, FREE_FLIGHT, modes),
    }
    return {name: np.where(live, values, np.nan) for name, values in found.items()}


def _modes(batch: Batch, histories: dict[str, Array]) -> Array:
    """Mode of contact of bodies that do not slide: where they would, or would fly, that mode, (n, k)."""
    model, block, g = MODELS[batch.model, batch.geometry], batch.block, batch.g[:, None]
    theta, rate, a_g, a_v = (histories[name] for name in ("theta", "theta_dot", "a_g", "a_v"))
    law = model.law(block.alpha, block.tan_alpha)
    still = (theta == 0.0) & (rate == 0.0)
    s = np.where(theta != 0.0, np.sign(theta), np.where(rate != 0.0, np.sign(rate), -np.sign(a_g)))

    def of_side(both: Array) -> Array:
        return np.where(s > 0.0, both[:, RIGHT, None], both[:, LEFT, None])

    alpha, R, inertia, r0, rs, rc, fc, fs, rise = (
        of_side(both)
        for both in (block.alpha, block.R, block.inertia, law.r0, law.rs, law.rc, law.fc, law.fs, law.threshold)
    )
    q, v = np.abs(theta), s * rate
    sin_q, cos_q = (q, 1.0) if model.linear else (np.sin(q), np.cos(q))
    moments = restoring(r0, rs, rc, sin_q, cos_q), driving(fc, fs, sin_q, cos_q)
    acc = -(of_side(batch.p) ** 2) * pull(1.0 + a_v / g, moments[0], s * a_g / g, moments[1])
    sin_b, cos_b = np.sin(alpha - q), np.cos(alpha - q)
    T = a_g + s * R * (cos_b * acc + sin_b * v * v)
    N = g + a_v + R * (sin_b * acc - cos_b * v * v)
    mu = block.mu[:, None]
    rocking = np.where(N <= 0.0, FREE_FLIGHT, np.where(np.abs(T) > mu * N, SLIDE_ROCK, ROCK))
    return np.where(still, mode_from_rest(rise, inertia, mu, a_g / g, a_v / g), rocking)
