"""A part of a path that lanes have followed, of a body whose foot holds: its results, added to those so far."""

from __future__ import annotations

import math

from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import results as to
from rockcli.kernels.contact.readings import note_slide
from rockcli.kernels.jit import jit
from rockcli.kernels.rigid import results as of_lanes


@jit
def add_part(par, slide, part, out):
    """Add what lanes have found since `out`, which is nothing yet or what the kernel left; `slide`: of the base."""
    out[to.N_STEPS] += part[of_lanes.N_STEPS]
    out[to.N_IMPACTS] += part[of_lanes.N_IMPACTS]
    out[to.SWINGS] += part[of_lanes.SWINGS]
    out[to.SWINGS_T] += part[of_lanes.SWINGS_T]
    out[to.STRUCK_LATER] = max(out[to.STRUCK_LATER], part[of_lanes.STRUCK_LATER])
    out[to.BALANCE] += par[at.G] * part[of_lanes.ENERGY]
    if math.isnan(out[to.T_UPLIFT]):
        out[to.T_UPLIFT] = part[of_lanes.T_UPLIFT]
    if not math.isnan(part[of_lanes.T_OVERTURN]):  # of passages of the equilibrium the last counts
        out[to.T_OVERTURN] = part[of_lanes.T_OVERTURN]
        out[to.SLIDE_STANDING] = max(abs(out[to.SLIDE_PEAK]), abs(slide))
        out[to.N_STANDING] = min(out[to.N_MIN], part[of_lanes.N_STANDING])
    out[to.N_MIN] = min(out[to.N_MIN], part[of_lanes.N_MIN])
    out[to.RATE_PEAK] = max(out[to.RATE_PEAK], part[of_lanes.RATE_PEAK])
    left, right = part[of_lanes.PEAK_LEFT], part[of_lanes.PEAK_RIGHT]
    out[to.PEAK_LEFT], out[to.PEAK_RIGHT] = max(out[to.PEAK_LEFT], left), max(out[to.PEAK_RIGHT], right)
    if part[of_lanes.PEAK] > out[to.PEAK] * (1.0 + 1e-12):
        out[to.PEAK], out[to.T_PEAK] = part[of_lanes.PEAK], part[of_lanes.T_PEAK]
        out[to.PEAK_SIDE] = part[of_lanes.PEAK_SIDE]
    for sign, angle in ((1.0, right), (-1.0, left)):
        leant = slide + sign * par[at.TOP] * math.sin(min(angle, 0.5 * math.pi))
        out[to.TOP_PEAK] = max(out[to.TOP_PEAK], abs(leant))
    note_slide(slide, out)
    out[to.STATUS], out[to.VERDICT] = part[of_lanes.STATUS], part[of_lanes.VERDICT]
    out[to.T_END], out[to.SLIDE_END] = part[of_lanes.T_END], slide
