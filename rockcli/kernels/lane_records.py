"""Record maps: many bodies under one sampled motion, in lanes (docs/sweeps.md).

The automaton of `march`, cut for speed: LANES bodies in flight, each at its own time, are stepped together
(`lane_records_step`); a lane that meets an event is looked after by itself (`lane_records_event`), with the guards and
the closed forms of the single body.  A lane whose body is done takes the next one.  Nothing a body gets depends on
the others.
"""

from __future__ import annotations

import numpy as np

from rockcli.kernels.jit import jit
from rockcli.kernels.lane_fused import lowest_bit
from rockcli.kernels.lane_records_event import HANDED_OVER as HANDED_OVER
from rockcli.kernels.lane_records_event import arrive, attend
from rockcli.kernels.lane_records_impact import land
from rockcli.kernels.lane_records_rest import BLOCK as BLOCK
from rockcli.kernels.lane_records_rest import FINISHED, STANDING, begin, rest
from rockcli.kernels.lane_records_step import LANES, PIECE, STATE, STRIDE, advance, advance_linear
from rockcli.kernels.lane_vector import WIDTH

ROWS = STATE // STRIDE


@jit
def march_lanes(pars, linear, tol, rest_speed, margin, detail, order, values, slopes, blocks, tail, dt, out):
    """`march_all` for bodies with two equal edges, no damper, under one sampled motion; no forces, no histories.

    values, slopes: of the motion, then two of zeros.  blocks: largest |value| of each block; tail: running bound.
    A row of `out` whose STATUS is HANDED_OVER is for `march_all` to solve.
    """
    st = np.zeros(STATE)
    case = np.zeros(LANES, np.int64)
    queue = np.zeros(LANES + WIDTH)
    c, guard, sin_q, cos_q = np.zeros(31), np.zeros(31), np.zeros(31), np.zeros(31)
    a, a_v = np.zeros(2), np.zeros(2)
    n_case = len(pars)
    following = busy = 0
    while True:
        # fill the free lanes
        while busy < LANES and following < n_case:
            k = following
            following += 1
            state = begin(
                st, busy, pars[k], tol, values, slopes, blocks, tail, dt, out[k],
            )  # fmt: skip
            if state == STANDING:
                case[busy] = k
                busy += 1
        if busy == 0:
            return
        landing = 0
        for i in range(0, busy, WIDTH):
            if linear:
                calls, moved, near = advance_linear(st, i, values, slopes)
            else:
                calls, moved, near = advance(st, i, values, slopes)
            while calls != 0:
                place = lowest_bit(calls)
                calls &= calls - 1
                lane = i + place
                if lane >= busy:
                    break
                k = case[lane]
                if (near >> place) & 1:
                    queue[landing] = lane
                    landing += 1
                    continue
                if (moved >> place) & 1:
                    state = arrive(
                        st, lane, pars[k], linear, tol, margin, detail, order, len(values), dt,
                        c, sin_q, cos_q, a, a_v, out[k],
                    )  # fmt: skip
                else:
                    state = attend(
                        st, lane, pars[k], linear, tol, rest_speed, margin, detail, order, values, slopes, blocks,
                        tail, dt, c, guard, sin_q, cos_q, a, a_v, out[k],
                    )  # fmt: skip
                if state == FINISHED:
                    case[lane] = -1
        for j in range(landing, min(landing + WIDTH, len(queue))):
            queue[j] = LANES
        for j in range(0, landing, WIDTH):
            over, slow = land(st, queue, j)
            calls = over | slow
            while calls != 0:
                place = lowest_bit(calls)
                calls &= calls - 1
                if j + place >= landing:
                    break
                lane = int(queue[j + place])
                k = case[lane]
                if (over >> place) & 1:
                    state = arrive(
                        st, lane, pars[k], linear, tol, margin, detail, order, len(values), dt,
                        c, sin_q, cos_q, a, a_v, out[k],
                    )  # fmt: skip
                else:
                    state = rest(st, lane, pars[k], rest_speed, values, slopes, blocks, tail, dt, out[k])
                if state == FINISHED:
                    case[lane] = -1
        # close the gaps
        lane = 0
        while lane < busy:
            if case[lane] < 0:
                busy -= 1
                case[lane] = case[busy]
                for row in range(ROWS):
                    st[row * STRIDE + lane] = st[row * STRIDE + busy]
            else:
                lane += 1
        for lane in range(busy, LANES):  # what is left there goes on unheeded, and must not leave the motion
            st[PIECE + lane] = 0.0
