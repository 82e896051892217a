"""Record maps: many bodies under sampled motions, in lanes (docs/lanes.md).

The automaton of `march`, cut for speed: LANES bodies in flight, each at its own time, are stepped together
(`step`), and so are landings (`impacts`); a lane that meets another event is looked after by
itself (`events`), with the guards and the closed forms of the single body.  A lane whose body is done takes
the next one, under its own motion.  Nothing a body gets depends on the others.
"""

from __future__ import annotations

from rockcli.kernels.ahead import MATRIX, VECTOR
from rockcli.kernels.constants import MAX_ORDER
from rockcli.kernels.jit import entry, jit_lean
from rockcli.kernels.lanes.records import footholds, slips
from rockcli.kernels.lanes.records import state as lane
from rockcli.kernels.lanes.records.events import arrive, attend
from rockcli.kernels.lanes.records.facets import BODY, stand
from rockcli.kernels.lanes.records.forces import commit, look_into
from rockcli.kernels.lanes.records.impacts import land
from rockcli.kernels.lanes.records.peaks import top
from rockcli.kernels.lanes.records.rest import BLOCK as BLOCK
from rockcli.kernels.lanes.records.rest import FINISHED, STANDING, begin, hand_over, park, rest, turn
from rockcli.kernels.lanes.records.rolling import bounce, roll_over
from rockcli.kernels.lanes.records.state import place
from rockcli.kernels.lanes.records.step import advance, advance_linear
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.fused import bits, lowest_bit, page_the_stack
from rockcli.kernels.lanes.vector.plain import load, note, room
from rockcli.kernels.rigid.march import ALL
from rockcli.kernels.rigid.settings import Settings as Settings

STEPS_PER_SAMPLE, STEPS_AFTER = 16, 20_000
"""Steps a body may take in lanes, a sample on the average and after the motion; one that needs more is handed over."""

ROUNDS = 1024
"""Rounds between two looks at who has taken too many."""


def work_space():
    """Work space of `march_lanes`: state, lanes that land, turn and touch the next facet, series, ground, forces."""
    return (
        room(lane.STATE), *(room(lane.LANES + WIDTH) for _ in range(3)),
        *(room(MAX_ORDER + 1) for _ in range(4)), room(2), room(2), room(6),
    )  # fmt: skip


@entry(
    MATRIX, MATRIX, Settings, VECTOR, VECTOR, VECTOR, VECTOR, MATRIX, MATRIX, bool, bool, MATRIX, (VECTOR,) * 11, MATRIX
)  # fmt: skip
def march_lanes(pars, bodies, how, values, slopes, blocks, tail, velocity, spans, two_sided, hold, starts, work, out):
    """`in_lanes` of bodies that do not slip, or stop where they may."""
    in_lanes(
        pars, bodies, how, values, slopes, blocks, tail, velocity, spans, two_sided, hold, starts, work, out, None,
        None, None, None, None, None,
    )  # fmt: skip


@jit_lean
def in_lanes(
    pars, bodies, how, values, slopes, blocks, tail, velocity, spans, two_sided, hold, starts, work, out, feet,
    slip_work, foot_work, nothing, felt, heave,
):  # fmt: skip
    """`march_all` for bodies on two edges, no damper, under sampled motions; no histories.

    two_sided: the edges of these bodies differ.  bodies: none, or the table of
    `kernels.rolling.parameters` of bodies that roll, whose rows of `pars` are longer (`facets`), and are written to.
    values, slopes: of one motion after the other, each followed by two of zeros or more, so that the next begins with
    a block.  blocks: largest |value| of each block; tail: running bound to the end of a motion.
    spans: of the motion of each body, first and last sample and the time between two.
    velocity: of the ground, as `lost` wants it, or nothing if the path of a fall is asked for, as it is
    where forces are (`how.detail` ALL) or what impacts carry.
    hold: a body stops where friction may not hold its foot: STATUS GIVES_WAY.  starts: rows of `handover`, where it
    begins and, then, has stopped; not read without `hold`.  With forces beside it, PEAK_LEFT and PEAK_RIGHT are those
    of either side.
    feet: None, or of such bodies the rows of `kernels.contact.parameters`: those do not stop but slip on in lanes, with
    those that rock; what else comes of it the kernel of contact follows until their feet hold again.  What all parts of
    their paths have found is added to `felt`, rows of `kernels.contact.results`.  nothing: no histories, (6, 0).
    heave: None, or of the vertical motion beside the one there is then values, slopes, blocks and tail.
    Where `feet` or `heave` is None, what asks for it and nothing else is not compiled.
    A row of `out` whose STATUS is LEFT_TO_MARCH is for `march_all` to solve.
    """
    page_the_stack()
    st, landings, turns, touches, c, guard, sin_q, cos_q, a, a_v, force = work
    path, watch, rolling = len(velocity) == 0, how.detail == ALL, len(bodies) > 0
    n_case = len(pars)
    following = busy = rounds = slipping = waiting = 0
    for number in range(lane.LANES):
        park(st, place(number))
    if feet is not None:
        sl, series, ready = slip_work
        for number in range(slips.STATE // slips.STRIDE * WIDTH):
            slips.clear(sl, slips.place(number))
    while True:
        # fill the free lanes, first with bodies whose foot holds again
        while waiting > 0 or (busy + slipping < lane.LANES and following < n_case):
            k, again = following, waiting > 0
            if feet is not None:  # noqa: SIM102
                if again:
                    waiting -= 1
                    k = int(ready[waiting])
            if not again:
                following += 1
            i = place(busy)
            if rolling:
                stand(pars[k], bodies[int(pars[k][BODY])])
            state = begin(
                st, i, pars[k], spans[k], how, values, slopes, blocks, tail, path, two_sided, hold, starts[k], out[k],
                heave,
            )  # fmt: skip
            if state == STANDING:
                st[lane.CASE + i] = k
                busy += 1
            else:
                if feet is not None:
                    footholds.count_in(feet[k], starts[k], out[k], felt[k])
                park(st, i)
        if busy == 0 and slipping == 0:
            return
        if feet is not None:
            slipping, waiting = slip_on(
                sl, slipping, series, foot_work, feet, how, spans, starts, values, slopes, ready, waiting, nothing, felt
            )
        landing = turning = touching = 0
        emptied = False
        for o in range(0, place(busy - 1) + 1, lane.STRIDE):
            if how.linear:
                calls, moved, near, tops, next_facet = advance_linear(st, o, values, slopes, watch, heave)
            else:
                calls, moved, near, tops, next_facet = advance(st, o, values, slopes, watch, hold, heave)
            if watch:
                doubtful = commit(st, o)
                while doubtful != 0:
                    i = o + lowest_bit(doubtful)
                    doubtful &= doubtful - 1
                    k = int(st[lane.CASE + i])
                    if k >= 0:
                        look_into(st, i, pars[k], st[lane.SIDE + i], 1.0, guard, force, a, a_v, out[k])
            landing = note(near, 1.0 * o, landings, landing)
            turning = note(tops, 1.0 * o, turns, turning)
            if rolling:
                touching = note(next_facet, 1.0 * o, touches, touching)
            while calls != 0:
                bit = lowest_bit(calls)
                calls &= calls - 1
                i = o + bit
                k = int(st[lane.CASE + i])
                if (moved >> bit) & 1:
                    state = arrive(
                        st, i, pars[k], bodies, how, values, slopes, velocity, c, sin_q, cos_q, a, a_v, hold, starts[k],
                        out[k], heave,
                    )  # fmt: skip
                else:
                    state = attend(
                        st, i, pars[k], bodies, how, values, slopes, blocks, tail, velocity,
                        c, guard, sin_q, cos_q, a, a_v, force, hold, starts[k], out[k], heave,
                    )  # fmt: skip
                if state == FINISHED:
                    st[lane.CASE + i], emptied = left_by(k), True
        for j in range(turning):
            i = int(turns[j])
            k = int(st[lane.CASE + i])
            top(st, i, pars[k], hold and watch, how.tol, out[k])
        for j in range(landing, min(landing + WIDTH, len(landings))):
            landings[j] = place(lane.LANES)
        for j in range(0, landing, WIDTH):
            over, slow, doubtful, hit = land(st, landings, j, path, watch, how.linear, False, heave)
            look_into_those(st, landings, j, landing, doubtful, pars, guard, force, a, a_v, out)
            while two_sided and hit != 0:
                bit = lowest_bit(hit)
                hit &= hit - 1
                if j + bit >= landing:
                    break
                i = int(landings[j + bit])
                k = int(st[lane.CASE + i])
                turn(st, i, pars[k], st[lane.SIDE + i], out[k])
                free = rolling and st[lane.PIECE + i] > st[lane.LAST + i]
                if free and bounce(st, i, pars[k], bodies, how.rest_speed, path, watch, out[k]) == FINISHED:
                    st[lane.CASE + i], emptied = left_by(k), True
                    over, slow = over & ~(1 << bit), slow & ~(1 << bit)
            calls = over | slow
            while calls != 0:
                bit = lowest_bit(calls)
                calls &= calls - 1
                if j + bit >= landing:
                    break
                i = int(landings[j + bit])
                k = int(st[lane.CASE + i])
                if (over >> bit) & 1:
                    state = arrive(
                        st, i, pars[k], bodies, how, values, slopes, velocity, c, sin_q, cos_q, a, a_v, hold, starts[k],
                        out[k], heave,
                    )  # fmt: skip
                else:
                    state = rest(st, i, pars[k], how, values, slopes, blocks, tail, hold, starts[k], out[k], heave)
                if state == FINISHED:
                    st[lane.CASE + i], emptied = left_by(k), True
        for j in range(touching, min(touching + WIDTH, len(touches))):
            touches[j] = place(lane.LANES)
        for j in range(0, touching, WIDTH):
            over, slow, doubtful, hit = land(st, touches, j, path, watch, how.linear, True, heave)
            look_into_those(st, touches, j, touching, doubtful, pars, guard, force, a, a_v, out)
            calls = over | hit
            while calls != 0:
                bit = lowest_bit(calls)
                calls &= calls - 1
                if j + bit >= touching:
                    break
                i = int(touches[j + bit])
                k = int(st[lane.CASE + i])
                state = STANDING
                if (hit >> bit) & 1:
                    state = roll_over(st, i, pars[k], bodies, values, slopes, path, watch, out[k])
                if state != FINISHED and (over >> bit) & 1:
                    state = arrive(
                        st, i, pars[k], bodies, how, values, slopes, velocity, c, sin_q, cos_q, a, a_v, hold, starts[k],
                        out[k], heave,
                    )  # fmt: skip
                elif state != FINISHED and (hit >> bit) & 1 and st[lane.V + i] <= st[lane.SLOW + i]:
                    state = rest(st, i, pars[k], how, values, slopes, blocks, tail, hold, starts[k], out[k], heave)
                if state == FINISHED:
                    st[lane.CASE + i], emptied = left_by(k), True
        rounds += 1
        if rounds % ROUNDS == 0:
            for number in range(busy):
                i = place(number)
                samples = st[lane.LAST + i] - st[lane.FIRST + i]
                k = int(st[lane.CASE + i])
                if k >= 0 and st[lane.STEPS + i] > STEPS_PER_SAMPLE * samples + STEPS_AFTER:
                    hand_over(out[k])
                    st[lane.CASE + i], emptied = left_by(k), True
        if not emptied:
            continue
        # close the gaps
        number, held = 0, busy
        while number < busy:
            i = place(number)
            if number % WIDTH == 0 and bits(load(st, lane.CASE + i) < 0.0) == 0:
                number += WIDTH
            elif st[lane.CASE + i] < 0.0:
                k = int(left_by(st[lane.CASE + i]))
                if feet is not None:
                    j = slips.place(slipping)
                    contact_how = footholds.settings(how)
                    becomes = footholds.give_way(
                        st, i, sl, j, k, feet[k], contact_how, starts[k], values, slopes, foot_work, out[k], felt[k]
                    )
                    if becomes == footholds.ELSEWHERE:
                        becomes = footholds.follow(
                            feet[k], contact_how, spans[k], starts[k], values, foot_work, nothing, felt[k]
                        )
                    if becomes == footholds.SLIPPING:
                        slipping += 1
                    elif becomes == footholds.HOLDING:
                        ready[waiting] = k
                        waiting += 1
                busy -= 1
                last = place(busy)
                for field in range(0, lane.STRIDE, WIDTH):
                    st[i + field] = st[last + field]
                    st[i + lane.VECTORS + field] = st[last + lane.VECTORS + field]
            else:
                number += 1
        for number in range(busy, held):
            park(st, place(number))


@jit_lean
def left_by(k):
    """What marks a lane whose body k is done; of that, k again."""
    return -2.0 - k


@jit_lean
def slip_on(sl, count, series, w, feet, how, spans, starts, values, slopes, ready, waiting, nothing, felt):
    """Step the bodies that slip, the first `count` of `sl`; those that hold again are appended to `ready`.

    Returns how many slip and how many are ready.
    """
    contact_how, watch, thinned = footholds.settings(how), how.detail == ALL, False
    for first in range(0, count, WIDTH):
        o = slips.place(first)
        calls, over, halved = slips.slide_on(sl, o, series, values, slopes, watch)
        todo = calls | over | halved
        while todo != 0:
            bit = lowest_bit(todo)
            todo &= todo - 1
            if first + bit >= count:
                break
            j = o + bit
            k = int(sl[slips.CASE + j])
            if (calls >> bit) & 1:
                becomes = footholds.look_after(
                    sl, j, feet[k], contact_how, starts[k], values, slopes, series, w, felt[k]
                )
            else:
                becomes = footholds.give_up(sl, j, feet[k], starts[k], felt[k])
            if becomes == footholds.ELSEWHERE:
                becomes = footholds.follow(feet[k], contact_how, spans[k], starts[k], values, w, nothing, felt[k])
            if becomes != footholds.SLIPPING:
                sl[slips.CASE + j], thinned = -1.0, True
            if becomes == footholds.HOLDING:
                ready[waiting] = k
                waiting += 1
    number = 0
    while thinned and number < count:
        j = slips.place(number)
        if sl[slips.CASE + j] < 0.0:
            count -= 1
            last = slips.place(count)
            for field in range(0, slips.STRIDE, WIDTH):
                sl[j + field] = sl[last + field]
            slips.clear(sl, last)
        else:
            number += 1
    return count, waiting


@jit_lean
def look_into_those(st, queue, j, count, doubtful, pars, guard, force, a, a_v, out):
    """`look_into` what `land` has taken of queue[j: count] and found doubtful."""
    while doubtful != 0:
        bit = lowest_bit(doubtful)
        doubtful &= doubtful - 1
        if j + bit >= count:
            break
        i = int(queue[j + bit])
        k = int(st[lane.CASE + i])
        look_into(st, i, pars[k], st[lane.SIDE_BEFORE + i], st[lane.X_HIT + i], guard, force, a, a_v, out[k])
