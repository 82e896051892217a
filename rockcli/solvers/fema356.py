"""The rocking procedure of FEMA-356 [3.4-3.7]: an equivalent linear oscillator on a response spectrum.

The rocking block is replaced by an oscillator of the block's period at its amplitude and a damping for its impacts;
the amplitude is where the oscillator's spectral displacement equals the block's own (docs/fema356.md).  The method is
known to be poor: it is offered for comparison.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import SolverError
from rockcli.motion.spectrum import Forcing, displacement_spectrum, forcing, history, peaks
from rockcli.scene.batch import Batch
from rockcli.scene.laws.damping import Fema356
from rockcli.scene.response import NO_UPLIFT, OVERTURNED_AFTER_IMPACT, ROCKING, UNRESOLVED, Response
from rockcli.scene.variables import SCALARS
from rockcli.solvers.common.duration import durations_of

Array = NDArray[np.float64]
Demand = Callable[[Array], Array]
"""Spectral displacement S_d [m] of periods [s], (m,) -> (m,); NaN where the spectrum says nothing."""

ELASTIC_DAMPING = 0.05
"""Damping ratio of the elastic, not rocking body on its fixed base, for the rocking potential."""

UPLIFT_MARGIN = 1e-9
"""The spectrum must exceed the threshold by this much, relatively: a pulse of exactly that amplitude moves nothing."""

_Y = np.concatenate([np.geomspace(3e-3, 0.1, 40), np.arange(0.11, 7.0, 0.0125), np.linspace(7.0, 14.5, 60)])
"""Where solutions are sought, in y = arcosh(1/(1 - theta/alpha)) = p T/4: theta/alpha from 4.5e-6 to 1 - 1e-6."""

_NEAR = 0.05
"""Between two solutions closer than the scan S_d comes this near to delta, relatively: looked at again, closer."""

POOR = "FEMA-356, known to be poor, is for comparison"


def damping_ratio(inertia: float, alpha: float) -> tuple[float, float]:
    """r and the effective damping ratio beta, (3.5) and (3.4), of a body with I_O/(m R^2) = `inertia`.

    r = [1 - (1 - cos 2 alpha)/inertia]^2, beta = 0.4 (1 - sqrt r); sqrt r is Housner's eta (its modulus).
    """
    root = abs(1.0 - 2.0 * np.sin(alpha) ** 2 / inertia)
    return float(root**2), float(0.4 * (1.0 - root))


def rocking_period(phi: Array, p: float) -> Array:
    """T = (4/p) arcosh(1/(1 - phi)) (3.6) [s] of amplitudes phi = theta/alpha in [0, 1)."""
    return np.asarray(8.0 / p * np.arcsinh(np.sqrt(0.5 * phi / (1.0 - phi))))


def amplitudes(demand: Demand, p: float, delta_alpha: float) -> tuple[Array, Array]:
    """All amplitudes phi = theta/alpha in (0, 1) with S_d(T(phi)) = phi delta_alpha, ascending; and the scan.

    Args:
        demand: S_d of periods.
        p: frequency parameter with the weight W, sqrt(W R/I_O) [rad/s].
        delta_alpha: displacement of the centre of mass at theta = alpha (3.7), alpha R cos(alpha) [m].

    Returns:
        (roots,), and S_d/delta - 1 at all points of the scan, in order of phi.
    """

    def excess(y: Array) -> Array:
        return demand(4.0 / p * y) / (delta_alpha * _phi(y)) - 1.0

    y, f = _Y, excess(_Y)
    for _ in range(2):
        around = _close_calls(f)
        if not len(around):
            break
        more = np.unique(np.linspace(y[around - 1], y[around + 1], 33)[1:-1])
        y, first = np.unique(np.concatenate([y, more]), return_index=True)
        f = np.concatenate([f, excess(more)])[first]
    turns = np.flatnonzero(np.isfinite(f[:-1]) & np.isfinite(f[1:]) & ((f[:-1] > 0.0) != (f[1:] > 0.0)))
    low, high, above = y[turns], y[turns + 1], f[turns] > 0.0
    rows = np.arange(len(turns))
    for _ in range(10 if len(turns) else 0):  # cut every bracket into 16, ten times
        inside = np.linspace(low, high, 17)
        values = excess(inside[1:-1].ravel()).reshape(15, -1)
        crossed = np.concatenate([(values > 0.0) != above, np.ones((1, len(turns)), dtype=bool)])
        at = np.argmax(crossed, axis=0)
        low, high = inside[at, rows], inside[at + 1, rows]
    return _phi(0.5 * (low + high)), f


def _close_calls(f: Array) -> NDArray[np.intp]:
    """Points of a scan at which the excess is least within its neighbours, of one sign, and small."""
    size = np.abs(f)
    with np.errstate(invalid="ignore"):
        dip = (size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:]) & (size[1:-1] < _NEAR)
        same = (np.sign(f[1:-1]) == np.sign(f[:-2])) & (np.sign(f[1:-1]) == np.sign(f[2:]))
    return np.flatnonzero(dip & same) + 1


def _phi(y: Array) -> Array:
    """Theta/alpha of y = arcosh(1/(1 - theta/alpha))."""
    return np.asarray(2.0 * np.sinh(0.5 * y) ** 2 / np.cosh(y))


@dataclass(frozen=True, eq=False)
class _Body:
    """One case as the method sees it: one edge, one weight (SI; p with the weight W)."""

    alpha: float
    p: float
    height: float
    top: float
    beta: float
    needed: float


@dataclass(eq=False)
class _Found:
    """What the method says of one case."""

    outcome: int
    sentence: str
    phi: float = np.nan
    T: float = np.nan
    t_peak: float = np.nan
    side: float = 1.0
    roots: Array = field(default_factory=lambda: np.empty(0))
    ordinates: int = 0


def solve(batch: Batch) -> Response:
    """Apply the procedure to every case of the batch; see `Response` for what comes back.

    No solution is overturning, `overturned_after_impact`: the method's oscillation is one impact per half period.

    Raises:
        SolverError: the batch has another damping scheme, or neither a motion nor a spectrum.
    """
    began = time.perf_counter()
    scheme = batch.damping.fema356
    if scheme is None:
        raise SolverError(f"FEMA-356 is asked to solve a case with damping {batch.damping.scheme!r}")
    if scheme.spectrum is None and batch.excitation.horizontal is None:
        raise SolverError("FEMA-356 needs a ground motion or a design spectrum")
    bodies = _bodies(batch, scheme)
    motions = [_motion(batch, i) for i in range(batch.size)]
    with np.errstate(over="ignore", invalid="ignore"):  # extreme numbers end as a spectrum without values
        found = [_case(body, motion, scheme, i) for i, (body, motion) in enumerate(zip(bodies, motions, strict=True))]
    t_end = durations_of(batch).report
    scalars = _scalars(batch, bodies, found, t_end)
    scalars["wall_time"] = np.full(batch.size, (time.perf_counter() - began) / batch.size)
    histories, t = _histories(batch, bodies, motions, found, t_end) if batch.save.histories else ({}, np.empty(0))
    shaken = {"a_g": _live(t, t_end[:, None]).sum(axis=1)}  # also where the procedure has no solution
    used = {
        "backend": "fema356",
        "method": "equivalent linear oscillator on "
        + ("the motion's response spectrum, exact recursion" if scheme.spectrum is None else "a design spectrum"),
        "spectrum": "motion" if scheme.spectrum is None else scheme.spectrum.shape,
    }
    return Response(scalars, [one.sentence for one in found], t, histories, {}, used, shaken)


def _bodies(batch: Batch, scheme: Fema356) -> list[_Body]:
    block, weight = batch.block, scheme.W_over_Mg
    edge = block.of_weak_edge
    alpha, inertia = edge(block.alpha), edge(block.inertia)
    height, top = edge(block.heights), edge(block.tops)
    p = edge(batch.p) * np.sqrt(weight)
    needed = weight * (batch.g * edge(block.tan_alpha))
    return [
        _Body(
            alpha=float(alpha[i]),
            p=float(p[i]),
            height=float(height[i]),
            top=float(top[i]),
            beta=damping_ratio(float(inertia[i]), float(alpha[i]))[1],
            needed=float(needed[i]),
        )
        for i in range(batch.size)
    ]


def _motion(batch: Batch, case: int) -> Forcing:
    channel, duration = batch.excitation.horizontal, float(batch.excitation.duration[case])
    if channel is None:
        return ()
    return forcing(channel, case, np.inf if np.isnan(duration) else duration)


def _case(body: _Body, motion: Forcing, scheme: Fema356, i: int) -> _Found:
    """The procedure: will it rock, how far, or does it overturn."""
    spectrum, fixed = scheme.spectrum, float(scheme.fixed_base_period[i])

    def demand(periods: Array, beta: float = body.beta) -> Array:
        if spectrum is None:
            return displacement_spectrum(motion, periods, beta)
        return spectrum.S_a(periods, beta, i) * (periods / (2.0 * np.pi)) ** 2

    if not np.isnan(fixed):
        period = np.array([fixed])
        S_a = float(demand(period, ELASTIC_DAMPING)[0] * (2.0 * np.pi / fixed) ** 2)
        where = f"S_a({fixed:.4g} s)"
    elif spectrum is None:
        S_a, where = _pga(motion), "PGA"
    else:
        S_a, where = float(spectrum.S_a(np.zeros(1), body.beta, i)[0]), "S_a(0)"
    if not S_a > body.needed * (1.0 + UPLIFT_MARGIN):
        return _Found(NO_UPLIFT, f"FEMA-356: rocking is not indicated, {where} does not exceed (W/Mg) g tan(alpha)")

    roots, scan = amplitudes(demand, body.p, body.height * body.alpha)
    count = len(scan)
    if not len(roots):
        if not (scan > 0.0).any():
            sentence = "FEMA-356: rocking is indicated, but the spectrum lies below every amplitude: taken as none"
            return _Found(NO_UPLIFT, sentence, ordinates=count)
        if np.isnan(scan).any():
            sentence = "FEMA-356: the spectrum has no value at the period of the solution, if there is one"
            return _Found(UNRESOLVED, sentence, ordinates=count)
        sentence = f"FEMA-356 finds no solution: overturning predicted ({POOR}; it knows no impacts and no side)"
        return _Found(OVERTURNED_AFTER_IMPACT, sentence, ordinates=count)
    phi = float(roots[0])
    T = float(rocking_period(roots[:1], body.p)[0])
    sentence = f"{POOR}: one amplitude solves it"
    if len(roots) > 1:
        listed = ", ".join(f"{root:.6g}" for root in roots[:8]) + (", ..." if len(roots) > 8 else "")
        sentence = f"{POOR}: {len(roots)} amplitudes theta/alpha solve it, {listed}; the smallest is reported"
    answer = _Found(ROCKING, sentence, phi, T, roots=roots, ordinates=count)
    if spectrum is None:
        x, t = peaks(motion, np.array([T]), body.beta)
        answer.side, answer.t_peak = float(np.sign(x[0])), float(t[0])
    return answer


def _pga(motion: Forcing) -> float:
    """Peak ground acceleration at the ends of all steps [m/s²]."""
    largest = 0.0
    for part in motion:
        ends = part.c @ part.h ** np.arange(part.c.shape[1])
        largest = max(largest, float(np.abs(part.c[:, 0]).max()), float(np.abs(ends).max()))
    return largest


def _scalars(batch: Batch, bodies: list[_Body], found: list[_Found], t_end: Array) -> dict[str, NDArray[Any]]:
    n = batch.size
    scalars: dict[str, NDArray[Any]] = {name: np.full(n, np.nan) for name in SCALARS if name != "reason"}
    outcome = np.array([one.outcome for one in found], dtype=np.int8)
    still, fell = outcome == NO_UPLIFT, outcome == OVERTURNED_AFTER_IMPACT

    def told(values: Array) -> Array:
        return np.where(still, 0.0, np.where(fell, np.inf, values))

    alpha, height, top, beta = (
        np.array([getattr(body, name) for body in bodies]) for name in ("alpha", "height", "top", "beta")
    )
    phi, T, t_peak, side = (np.array([getattr(one, name) for one in found]) for name in ("phi", "T", "t_peak", "side"))
    delta = phi * alpha * height
    return scalars | {
        "outcome": outcome,
        "theta_peak": told(phi * alpha * side),
        "theta_peak_over_alpha": told(phi),
        "theta_dot_peak": told(np.full(n, np.nan)),
        "u_top_peak": told(delta * top / height),
        "t_peak": t_peak,
        "t_end": np.where(fell, np.nan, t_end),
        "n_impacts": np.where(still, 0, -1).astype(np.int64),
        "n_steps": np.array([one.ordinates for one in found], dtype=np.int64),
        "fema_delta": told(delta),
        "fema_u_top": told(delta * top / height),
        "fema_T": T,
        "fema_beta": beta,
        "fema_n_roots": np.where(outcome < 0, np.nan, [float(len(one.roots)) for one in found]),
    }


def _live(t: Array, t_end: Any) -> NDArray[np.bool_]:
    """Which output times are not after the end."""
    return np.asarray(t <= t_end * (1.0 + 1e-12))


def _histories(
    batch: Batch, bodies: list[_Body], motions: list[Forcing], found: list[_Found], t_end: Array
) -> tuple[dict[str, Array], Array]:
    """The oscillator (T, beta) at the solution, its displacement over R cos(alpha) as theta (Figs 41-42)."""
    t = np.arange(int(np.max(t_end) / batch.save.dt_out + 1e-9) + 1) * np.float64(batch.save.dt_out)
    names = ("theta", "theta_dot", "u_top")
    histories = {name: np.full((batch.size, len(t)), np.nan) for name in names}
    for i, (body, motion, one) in enumerate(zip(bodies, motions, found, strict=True)):
        live = _live(t, t_end[i])
        if one.outcome == NO_UPLIFT:
            x = v = np.zeros(int(live.sum()))
        elif one.outcome == ROCKING and motion:
            x, v = history(motion, one.T, body.beta, t[live])
        else:
            continue
        histories["theta"][i, live] = x / body.height
        histories["theta_dot"][i, live] = v / body.height
        histories["u_top"][i, live] = x * body.top / body.height
    return histories, t
