"""Bodies that only calm down over ground at rest: known to come back, and to swing as long as an integral says."""

from __future__ import annotations

import math

from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import results as to
from rockcli.kernels.contact.events import landed
from rockcli.kernels.contact.readings import counts, energy_on_edge, note_carried, note_impact
from rockcli.kernels.contact.rest import frequency, slowest
from rockcli.kernels.contact.state import Foot, edge_under
from rockcli.kernels.jit import jit
from rockcli.kernels.quadrature import LOW, NODES, POINTS, WEIGHTS

SURELY = 1.0 - 1e-9
"""A bound must hold by more than rounding."""


@jit
def only_decays(par, foot, out):
    """Whether a body that rocks over ground at rest only calms down: its foot holds (K15), and it gets no further.

    No impact gives energy, so that it does not get beyond where it was on either side, of which `out` tells.
    """
    if foot.u != 0.0:
        return False
    energy = energy_on_edge(par, foot)
    for s in (-1.0, 1.0):
        e = edge_under(s)
        peak = out[to.PEAK_RIGHT] if s > 0.0 else out[to.PEAK_LEFT]
        if energy > SURELY * energy_on_edge(par, Foot(s, 0.0, min(peak, par[e + at.ALPHA]), 0.0, 0.0, 0.0)):
            return False
        R, place = par[e + at.RADIUS], par[e + at.PLACE]
        inertia = 1.0 + par[at.RG2] / (R * R)
        sin_a, spin = math.sin(par[e + at.ALPHA]), 2.0 * energy / (par[at.G] * R * inertia)
        across = 1.0 - sin_a * sin_a / inertia - spin
        if sin_a * max(1.0 / inertia, spin) > SURELY * par[at.MU_S] * across:
            return False
        if place < 0.0 or par[at.H] * place > SURELY * par[at.MU_S] * (par[at.RG2] + par[at.H] * par[at.H]):
            return False
    return True


@jit
def shows_more(par, foot, out):
    """Whether free swings may yet take the top of such a body farther, or press it less on the ground, than so far.

    With E its energy over m the body turns back at cos(alpha - q) = cos(alpha) + E/(g R) = c_turn.  On the way, with
    c = cos(alpha - q) and v the rate at q = 0, N/m = g - R [p^2 (1 - 3 c^2) + c (v^2 + 2 p^2 cos(alpha))].
    """
    energy = energy_on_edge(par, foot)
    for s in (-1.0, 1.0):
        e = edge_under(s)
        R, cos_a = par[e + at.RADIUS], math.cos(par[e + at.ALPHA])
        turn = par[e + at.ALPHA] - math.acos(min(cos_a + energy / (par[at.G] * R), 1.0))
        if abs(foot.place + s * par[at.TOP] * math.sin(turn)) > out[to.TOP_PEAK]:
            return True
        p2, rate2 = frequency(par, e) ** 2, 2.0 * energy / (par[at.RG2] + R * R)
        c = min(max(cos_a, (rate2 / p2 + 2.0 * cos_a) / 6.0), 1.0)  # where N is least
        if par[at.G] - R * (p2 * (1.0 - 3.0 * c * c) + c * (rate2 + 2.0 * p2 * cos_a)) < out[to.N_MIN] * par[at.G]:
            return True
    return False


@jit
def swung(par, scales, t, foot, rest_speed, impacts, out):
    """A body that only calms down, just after a landing at t, some swings on: (t, foot, energy lost in landings).

    After the landing that may end in rest, or the first one after the report.  The time of a swing is that of
    `lanes.pulses.free_rocking`; one that comes near the equilibrium is left to steps.
    """
    lost, slow = 0.0, rest_speed * slowest(par)
    while t <= par[at.T_STOP] and foot.u == 0.0:
        e, v = edge_under(foot.s), foot.v
        p2 = frequency(par, e) ** 2
        sin_a, cos_a = math.sin(par[e + at.ALPHA]), math.cos(par[e + at.ALPHA])
        if v <= slow or v * v >= LOW * LOW * 2.0 * p2 * (1.0 - cos_a):
            break
        total = 0.0
        for i in range(POINTS):
            u = 0.5 * v * v * (1.0 - NODES[i] * NODES[i])
            total += WEIGHTS[i] / math.sqrt((p2 * sin_a) ** 2 - 2.0 * p2 * cos_a * u - u * u)
        t += 2.0 * v * total
        foot, change = landed(par, Foot(foot.s, foot.sigma, 0.0, -v, 0.0, foot.place), out)
        lost += change
        if t <= par[at.T_STOP]:
            note_carried(scales, v, t, out)
            if counts(par, -foot.s, v):
                note_impact(t, foot.s * v, foot.s * foot.v, impacts, out)
    return t, foot, lost
