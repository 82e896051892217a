"""Turning points that may be the peak (docs/lanes.md)."""

from __future__ import annotations

from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.records import state as lane
from rockcli.kernels.lanes.records.facets import TILT, rolls, top_of
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.readings import set_peak

LAST = 1e-7
"""A step of Newton this small, relative, is the last: the next would be about its square."""


@jit
def top(st, i, par, both, tol, out):
    """Raise the peak to where the step that lane i has tried turns: its rate is positive first and then not.

    `both`: of either side.  Newton's method kept inside the bracket, from where a parabola turns.
    """
    j = lane.COEFFICIENTS + i
    c1, c2, c3, c4 = st[j], st[j + WIDTH], st[j + 2 * WIDTH], st[j + 3 * WIDTH]
    c5, c6, c7, c8 = st[j + 4 * WIDTH], st[j + 5 * WIDTH], st[j + 6 * WIDTH], st[j + 7 * WIDTH]
    d2, d3, d4, d5, d6, d7, d8 = 2.0 * c2, 3.0 * c3, 4.0 * c4, 5.0 * c5, 6.0 * c6, 7.0 * c7, 8.0 * c8
    low, high = 0.0, 1.0
    x = -c1 / d2 if d2 < -c1 else 0.5
    for _ in range(60):
        f = c1 + x * (d2 + x * (d3 + x * (d4 + x * (d5 + x * (d6 + x * (d7 + x * d8))))))
        df = d2 + x * (2.0 * d3 + x * (3.0 * d4 + x * (4.0 * d5 + x * (5.0 * d6 + x * (6.0 * d7 + x * (7.0 * d8))))))
        if f > 0.0:
            low = x
        else:
            high = x
        new = x - f / df if df != 0.0 else low
        inside = low < new < high
        if not inside:
            new = 0.5 * (low + high)
        near = abs(new - x) <= (LAST if inside else 4e-16) * new
        x = new
        if near:
            break
    height = x * (c1 + x * (c2 + x * (c3 + x * (c4 + x * (c5 + x * (c6 + x * (c7 + x * c8)))))))
    piece = st[lane.PIECE + i]
    t0 = par[at.T_MOTION] if piece > st[lane.LAST + i] else (piece - st[lane.FIRST + i]) * st[lane.DT + i]
    q, t, h = st[lane.Q + i], t0 + st[lane.X + i], st[lane.H + i]
    if h < 0.0:  # the lane is at the step's end
        q -= c1 + (c2 + ((c3 + c4) + ((c5 + c6) + (c7 + c8))))
        t += h
    note_height(st, i, par, q + height, t + x * abs(h), both, tol, out)


@jit
def note_height(st, i, par, q, t, both, tol, out):
    """Raise the peak to a turning point of lane i; `both`: the peaks of either side, not the larger alone."""
    s = st[lane.SIDE + i]
    if st[lane.UNLIKE + i] > 0.0:
        tilt, alpha = abs(par[TILT]) if rolls(par) else 0.0, par[(at.RIGHT if s > 0.0 else at.LEFT) + at.ALPHA]
        set_peak(1.0 if rolls(par) else alpha, s, q + tilt, t, tol, out)
        st[lane.PEAK + i] = top_of(par, s, out)
        return
    set_peak(par[at.RIGHT + at.ALPHA], s, q, t, tol, out)
    st[lane.PEAK + i] = min(out[to.PEAK_LEFT], out[to.PEAK_RIGHT]) if both else out[to.PEAK]
