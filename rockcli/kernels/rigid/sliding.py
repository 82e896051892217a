"""The sliding body as a hybrid automaton: modes STICK and SLIDE, Coulomb friction, no rotation (docs/theory.md).

Relative to the ground the body moves with `u'' = -a_g - mu (g + a_v) sgn(u')`; it sticks until
`|a_g| > mu (g + a_v)`.  The velocity is the integral of the ground acceleration and of a constant, so its Taylor
series is that of the motion: exact on a straight line between samples, to rounding on a pulse.
"""

from __future__ import annotations

import math

from rockcli.kernels.constants import DONE, MAX_ORDER, NO_ROOT, OUT_OF_STEPS
from rockcli.kernels.jit import jit, zeros_maker
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.edge_forces import watch_rest
from rockcli.kernels.rigid.ground import PULSES, expand, piece_at, piece_end
from rockcli.kernels.rigid.roots import first_root, uplift
from rockcli.kernels.rigid.series import value
from rockcli.kernels.rigid.settings import Channel as Channel
from rockcli.kernels.rigid.settings import Degrees

zeros = zeros_maker()

STICK, SLIDE = 0, 1


@jit
def slide(par, max_steps, horizontal, h_data, vertical, v_data, dt_out, history, out):
    """Solve one case; channels as those of `march`.

    To history (3, k), at i dt_out: displacement and velocity relative to the ground, and the direction of sliding, 0
    while the body sticks.
    """
    u_out, rate_out, way_out = history[0], history[1], history[2]
    n_hist = len(u_out)
    mu, g, t_motion = par[at.FRICTION], par[at.GRAVITY], par[at.MOTION_ENDS]
    for i in range(to.SLIDE_OUT):
        out[i] = 0.0
    out[to.STATUS] = DONE
    out[to.N_MIN], out[to.T_FLIGHT] = math.inf, math.nan
    c, a, a_v, guard = zeros(MAX_ORDER + 2), zeros(MAX_ORDER + 1), zeros(MAX_ORDER + 1), zeros(MAX_ORDER + 1)
    t = u = w = 0.0
    d = 1.0
    mode, launch = STICK, False
    ih = iv = i_hist = stalled = 0

    while t < t_motion or mode == SLIDE:
        if out[to.N_STEPS] >= max_steps:
            out[to.STATUS] = OUT_OF_STEPS
            break
        out[to.N_STEPS] += 1
        t_next = t_motion if t < t_motion else math.inf
        if par[at.LASTS] == 1.0 and t < par[at.REPORT_ENDS]:
            t_next = min(t_next, par[at.REPORT_ENDS])
        deg_a = deg_v = 0
        a[0] = a_v[0] = 0.0
        if t < t_motion:
            ih, iv = piece_at(horizontal, h_data, ih, t), piece_at(vertical, v_data, iv, t)
            if ih < horizontal.pieces:
                t_next = min(t_next, piece_end(horizontal, h_data, ih))
                deg_a = expand(horizontal, h_data, par[at.SCALE_H], ih, t, MAX_ORDER, a)
            if iv < vertical.pieces:
                t_next = min(t_next, piece_end(vertical, v_data, iv))
                deg_v = expand(vertical, v_data, par[at.SCALE_V], iv, t, MAX_ORDER, a_v)
        h = t_next - t
        deg = max(deg_a, deg_v)
        for k in range(deg_a + 1, deg + 1):
            a[k] = 0.0
        for k in range(deg_v + 1, deg + 1):
            a_v[k] = 0.0
        if deg > 1:  # keep to where the series of the motion has converged
            for k in range(deg - 1, deg + 1):
                big = max(abs(a[k]), abs(a_v[k]))
                if big > 0.0:
                    h = min(h, (1e-17 * mu * g / big) ** (1.0 / k))
        elif t_next == math.inf:
            h = 2.0 * w / (mu * g)  # the ground is still: the body stops half-way

        # free flight: the normal force vanishes
        for k in range(deg + 1):
            guard[k] = a_v[k]
        guard[0] += g
        flight = 0.0 if guard[0] <= 0.0 else first_root(guard, deg, h, 0)

        event = NO_ROOT
        if mode == STICK:
            for side in range(2):
                sign = 1.0 if side == 0 else -1.0
                for k in range(deg + 1):
                    guard[k] = mu * a_v[k] + sign * a[k]
                guard[0] += mu * g
                root = uplift(guard, deg, h, mu * g)
                if root != NO_ROOT and (event == NO_ROOT or root < event):
                    event, d = root, sign
            if stalled > 100:  # slips and sticks again and again at one instant
                event, stalled, h = NO_ROOT, 0, min(h, max(1e-12 * h, 4e-16 * t))
        else:
            c[0] = w
            for k in range(deg + 1):
                c[k + 1] = -(mu * a_v[k] + d * a[k]) / (k + 1)
            c[1] -= mu * g
            if launch:
                c[1] = max(c[1], 0.0)  # what has just broken loose is not slowed down by rounding
            skip = 0
            while skip < min(deg + 1, 4) and c[skip] == 0.0:
                skip += 1
            event = 0.0 if c[skip] <= 0.0 else first_root(c, deg + 1, h, skip)
        x = h if event == NO_ROOT else event
        if flight != NO_ROOT and flight <= x:
            x, event = flight, NO_ROOT
            out[to.T_FLIGHT] = t + flight
        watch_rest(a, a_v, Degrees(deg_a, deg_v), g, x, out)

        t_new = t_next if x == t_next - t else t + x
        while i_hist < n_hist and i_hist * dt_out <= t_new:
            y = i_hist * dt_out - t
            u_out[i_hist], rate_out[i_hist], way_out[i_hist] = u, 0.0, 0.0
            if mode == SLIDE:
                u_out[i_hist] = u + d * _distance(c, deg + 1, y)
                rate_out[i_hist], way_out[i_hist] = d * value(c, deg + 1, y), d
            i_hist += 1
        stalled = stalled + 1 if t_new == t else 0
        if mode == SLIDE:
            u += d * _distance(c, deg + 1, x)
            w = max(value(c, deg + 1, x), 0.0)
            if abs(u) > abs(out[to.SLIDE_PEAK]) and (par[at.LASTS] == 0.0 or t_new <= par[at.REPORT_ENDS]):
                out[to.SLIDE_PEAK] = u
        launch = False
        t = t_new
        if not math.isnan(out[to.T_FLIGHT]):
            break
        if event != NO_ROOT:
            launch = mode == STICK
            mode = SLIDE if mode == STICK else STICK
            w = 0.0
        if t >= t_motion and mode == SLIDE and w == 0.0:
            mode = STICK

    out[to.SLIDE_END] = u
    out[to.T_END] = par[at.REPORT_ENDS] if par[at.LASTS] == 1.0 else min(t, par[at.REPORT_ENDS])
    while i_hist < n_hist and i_hist * dt_out <= out[to.T_END] and math.isnan(out[to.T_FLIGHT]):
        u_out[i_hist], rate_out[i_hist], way_out[i_hist] = u, 0.0, 0.0
        i_hist += 1


@jit
def _distance(c, n, x):
    """Integral of the polynomial c[0] + ... + c[n] x^n from 0 to x."""
    y = c[n] / (n + 1)
    for k in range(n - 1, -1, -1):
        y = y * x + c[k] / (k + 1)
    return y * x


@jit
def slide_all(pars, max_steps, horizontal, h_data, vertical, v_data, dt_out, histories, out):
    """`slide` for every row of `pars`; histories, results and tables of pulses row by row too."""
    for i in range(len(pars)):
        ih, iv = (i if horizontal.kind == PULSES else 0), (i if vertical.kind == PULSES else 0)
        slide(pars[i], max_steps, horizontal, h_data[ih], vertical, v_data[iv], dt_out, histories[i], out[i])
