"""A body flat on a level ground under a sampled motion: samples in which nothing becomes of it, in closed form."""

from __future__ import annotations

from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import results as to
from rockcli.kernels.contact.codes import REST
from rockcli.kernels.contact.readings import note_slide
from rockcli.kernels.contact.state import Foot
from rockcli.kernels.contact.steps import FAR
from rockcli.kernels.jit import jit
from rockcli.kernels.rigid.ground import piece_end


@jit
def still_until(par, horizontal, h_data, i):
    """The first piece from i on in which a sampled motion might move a body at rest, or that is not its whole."""
    hold = min(par[at.MU_S], par[at.LEFT + at.B] / par[at.H], par[at.RIGHT + at.B] / par[at.H])
    quiet, end = par[at.G] * hold * (1.0 - FAR), min(par[at.T_MOTION], par[at.T_STOP])
    factor = abs(par[at.FACTOR_H])
    while i < horizontal.pieces and piece_end(horizontal, h_data, i) <= end:
        if max(abs(h_data[i]), abs(h_data[i + 1])) * factor >= quiet:
            return i
        i += 1
    return i


@jit
def slide_on(par, horizontal, h_data, i, t, foot, out):
    """Let a body slide on from t in piece i to the end of the last before the one in which it may stop.

    Its deceleration is linear in each: (the piece it is at the beginning of, or i; the foot; work of the ground and of
    friction over m [J/kg]).
    """
    end, factor = min(par[at.T_MOTION], par[at.T_STOP]), par[at.FACTOR_H]
    sigma, u, place, worked = foot.sigma, foot.u, foot.place, 0.0
    grip = par[at.MU_K] * sigma * par[at.G]
    while i < horizontal.pieces and piece_end(horizontal, h_data, i) <= end:
        h = piece_end(horizontal, h_data, i) - t
        a_end, b = h_data[i + 1] * factor, (h_data[i + 1] - h_data[i]) / horizontal.dt * factor
        a = a_end - b * h
        d, d_end = -(a + grip), -(a_end + grip)
        u_end = u + 0.5 * h * (d + d_end)
        turns = sigma * d < 0.0 < sigma * d_end
        if not sigma * u_end > FAR * abs(u) or turns:
            break
        along = h * (u + h * (2.0 * d + d_end) / 6.0)
        pushed = h * (a * u + h * (0.5 * (a * d + b * u) + h * (b * (d - 0.5 * a) / 3.0 - h * b * b / 8.0)))
        worked -= pushed + grip * along
        place += along
        u, t, i = u_end, piece_end(horizontal, h_data, i), i + 1
    note_slide(place, out)
    out[to.TOP_PEAK], out[to.N_MIN] = max(out[to.TOP_PEAK], abs(place)), min(out[to.N_MIN], 1.0)
    return i, Foot(foot.s, sigma, foot.q, foot.v, u, place), worked


@jit
def skimmed(par, mode, horizontal, h_data, ih, t, foot, out):
    """A body at rest, or that slides on, under samples from piece ih on that change no mode: (piece, foot, work)."""
    worked = 0.0
    if mode == REST:
        after = still_until(par, horizontal, h_data, ih)
        if after > ih:
            out[to.N_MIN] = min(out[to.N_MIN], 1.0)
    else:
        after, foot, worked = slide_on(par, horizontal, h_data, ih, t, foot, out)
    out[to.N_STEPS] += max(after - ih, 0)
    return after, foot, worked
