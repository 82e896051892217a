"""The outcome of the lanes as early as it is known (docs/lanes.md)."""

from __future__ import annotations

from rockcli.kernels.constants import FALLS, RETURNS
from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.pulses import state as lane
from rockcli.kernels.lanes.pulses.ground import to_come
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.elementary import sin_cos
from rockcli.kernels.lanes.vector.plain import load, select, some, spread, sqrt, store
from rockcli.kernels.rigid.law import potential
from rockcli.kernels.rigid.march import OUTCOME


@jit
def judge(state, o, how, two_sided):
    """One vector: its energy against that of the equilibrium, with what the rest of the motion can still change."""
    event, mode = load(state, o + lane.EVENT * WIDTH), load(state, o + lane.MODE * WIDTH)
    going = (mode >= lane.REST) & (event < lane.DONE)
    if not some(going):
        return
    t, q, v = load(state, o + lane.T * WIDTH), load(state, o + lane.Q * WIDTH), load(state, o + lane.V * WIDTH)
    margin = how.margin
    sine, bend = now(state, o, q, how.linear)
    plus, minus = to_come(state, o, t)
    full, right = load(state, o + lane.L_PULL * WIDTH), load(state, o + lane.S * WIDTH) > 0.0
    pull, inward = full, full * select(right, plus, minus)
    r0, rs, rc = (
        load(state, o + lane.L_R0 * WIDTH), load(state, o + lane.L_RS * WIDTH), load(state, o + lane.L_RC * WIDTH),
    )  # fmt: skip
    stored = 2.0 * potential(r0, rc, q, rs * bend, sine)
    energy, top = v * v + stored, 2.0 * load(state, o + lane.L_TOP * WIDTH)
    crest, speed = load(state, o + lane.L_CREST * WIDTH), sqrt(select(energy > 0.0, energy, 0.0))
    least, lower = top, crest  # of both edges: the rate goes on over an impact, less by eta
    if two_sided:
        there = o + lane.TO_OTHER
        least, lower = 2.0 * load(state, there + lane.L_TOP * WIDTH), load(state, there + lane.L_CREST * WIDTH)
        other = load(state, there + lane.L_PULL * WIDTH)
        least, lower = select(least < top, least, top), select(lower < crest, lower, crest)
        pull = select(other > pull, other, pull)
    both = pull * (plus + minus)
    inside, doubt = q < load(state, o + lane.L_STAR * WIDTH), 100.0 * margin * crest
    returns = inside & (speed + both < lower - doubt)
    falls = (v > 0.0) & (speed - inward > crest + doubt)
    falls = (inside & falls) | (~inside & (v > inward + doubt))

    over = t >= load(state, o + lane.L_END * WIDTH)  # nothing more to come: the sign of the excess decides
    excess = energy - top
    returns = returns | (over & inside & (energy < least))
    falls = falls | (over & ((inside & (excess > 0.0) & (v > 0.0)) | (~inside & (excess < 0.0))))
    p = load(state, o + lane.L_P * WIDTH)
    near = over
    if some(over):
        close = 10.0 * margin * load(state, o + lane.L_ALPHA * WIDTH) * p * (abs(v) + sqrt(abs(top - stored)))
        close = close + 1e-13 * p * p
        near = over & ((abs(excess) <= close) | (abs(energy - least) <= close))

    verdict = load(state, o + lane.VERDICT * WIDTH)
    asked = going & (mode == lane.ROCK) & (verdict < 0.0)
    verdict = select(asked & returns, 1.0 * RETURNS, verdict)
    verdict = select(asked & falls, 1.0 * FALLS, verdict)
    still = going & (mode == lane.REST) & over
    verdict = select(still, 1.0 * RETURNS, verdict)
    known = verdict >= 0.0
    ends = (t >= load(state, o + lane.L_STOP * WIDTH)) & (load(state, o + lane.L_GIVEN * WIDTH) > 0.0)
    if how.detail > OUTCOME:
        stop = load(state, o + lane.L_STOP * WIDTH)
        known = still | (verdict == 1.0 * FALLS) | (known & (t >= stop) & ((v <= 0.0) | ends))
    next_event = select(known, lane.DONE, lane.NONE)
    doubtful = (asked & near) | (going & ends & ~known) | (load(state, o + lane.N_STEPS * WIDTH) >= how.max_steps)
    next_event = select(doubtful, lane.FOR_MARCH, next_event)
    store(state, o + lane.VERDICT * WIDTH, verdict)
    store(state, o + lane.EVENT * WIDTH, select(going, next_event, event))


@jit
def now(state, o, q, linear):
    """sin q and 1 - cos q of a vector; sets SINE and COSINE."""
    if linear:
        sine, cosine, bend = q, spread(1.0), 0.5 * q * q
    else:
        sine, cosine = sin_cos(q)
        bend = 1.0 - cosine
    store(state, o + lane.SINE * WIDTH, sine)
    store(state, o + lane.COSINE * WIDTH, cosine)
    return sine, bend
