"""Record maps: many bodies under sampled motions, in lanes (docs/lanes.md).

The automaton of `march`, cut for speed: LANES bodies in flight, each at its own time, are stepped together
(`step`), and so are landings (`impacts`); a lane that meets another event is looked after by
itself (`events`), with the guards and the closed forms of the single body.  A lane whose body is done takes
the next one, under its own motion.  Nothing a body gets depends on the others.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from rockcli.kernels.ahead import MATRIX, VECTOR
from rockcli.kernels.constants import MAX_ORDER
from rockcli.kernels.jit import entry, jit, jit_part
from rockcli.kernels.lanes.records import slips, stick_slip
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


class Cases(NamedTuple):
    """Of all bodies, row by row; see `in_lanes`."""

    pars: Any
    bodies: Any
    spans: Any
    starts: Any
    out: Any


class Motions(NamedTuple):
    """All motions, one after the other; see `in_lanes`."""

    values: Any
    slopes: Any
    blocks: Any
    tail: Any
    velocity: Any


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


@jit
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
    cases, motions = Cases(pars, bodies, spans, starts, out), Motions(values, slopes, blocks, tail, velocity)
    st, turns = work[0], work[2]
    following = busy = rounds = slipping = waiting = 0
    for number in range(lane.LANES):
        park(st, place(number))
    if feet is not None:
        sl = slip_work[0]
        for number in range(slips.STATE // slips.STRIDE * WIDTH):
            slips.clear(sl, slips.place(number))
    while True:
        busy, following, waiting = fill(
            st, busy, following, slipping, waiting, cases, motions, how, two_sided, hold, feet, slip_work, felt, heave
        )
        if busy == 0 and slipping == 0:
            return
        if feet is not None:
            slipping, waiting = slip_on(
                slipping, waiting, slip_work, foot_work, cases, motions, how, feet, nothing, felt
            )
        landing, turning, touching, emptied = step_all(st, busy, cases, motions, how, hold, work, heave)
        for j in range(turning):
            i = int(turns[j])
            k = int(st[lane.CASE + i])
            top(st, i, pars[k], hold and how.detail == ALL, how.tol, out[k])
        if land_all(st, landing, cases, motions, how, two_sided, hold, work, heave):
            emptied = True
        if touching > 0 and touch_all(st, touching, cases, motions, how, hold, work, heave):
            emptied = True
        rounds += 1
        if rounds % ROUNDS == 0 and give_up_the_slow(st, busy, out):
            emptied = True
        if emptied:
            held = busy
            busy, slipping, waiting = close_gaps(
                st, busy, slipping, waiting, cases, motions, how, feet, slip_work, foot_work, nothing, felt
            )
            for number in range(busy, held):
                park(st, place(number))


@jit_part
def fill(st, busy, following, slipping, waiting, cases, motions, how, two_sided, hold, feet, slip_work, felt, heave):
    """Fill the free lanes, first with bodies whose foot holds again: (how many are busy, have begun, wait)."""
    pars, bodies, spans, starts, out = cases
    values, slopes, blocks, tail, velocity = motions
    while waiting > 0 or (busy + slipping < lane.LANES and following < len(pars)):
        k, again = following, waiting > 0
        if feet is not None:  # noqa: SIM102
            if again:
                waiting -= 1
                k = int(slip_work[2][waiting])
        if not again:
            following += 1
        i = place(busy)
        if len(bodies) > 0:
            stand(pars[k], bodies[int(pars[k][BODY])])
        state = begin(
            st, i, pars[k], spans[k], how, values, slopes, blocks, tail, len(velocity) == 0, two_sided, hold, starts[k],
            out[k], heave,
        )  # fmt: skip
        if state == STANDING:
            st[lane.CASE + i] = k
            busy += 1
        else:
            if feet is not None:
                stick_slip.count_in(feet[k], starts[k], out[k], felt[k])
            park(st, i)
    return busy, following, waiting


@jit_part
def step_all(st, busy, cases, motions, how, hold, work, heave):
    """Step all lanes, and look after those with an event of their own.

    Lanes that land, turn and touch the next facet go to their lists in `work`: how many there are, and whether a body
    has left its lane.
    """
    values, slopes, blocks, tail, velocity = motions
    _, landings, turns, touches, c, guard, sin_q, cos_q, a, a_v, force = work
    watch, landing, turning, touching, emptied = how.detail == ALL, 0, 0, 0, False
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
                    look_into(
                        st, i, cases.pars[k], st[lane.SIDE + i], 1.0, guard, force, a, a_v, cases.out[k]
                    )  # fmt: skip
        landing = note(near, 1.0 * o, landings, landing)
        turning = note(tops, 1.0 * o, turns, turning)
        if len(cases.bodies) > 0:
            touching = note(next_facet, 1.0 * o, touches, touching)
        while calls != 0:
            bit = lowest_bit(calls)
            calls &= calls - 1
            i = o + bit
            k = int(st[lane.CASE + i])
            if (moved >> bit) & 1:
                state = arrive_at(st, i, k, cases, motions, how, hold, work, heave)
            else:
                state = attend(
                    st, i, cases.pars[k], cases.bodies, how, values, slopes, blocks, tail, velocity,
                    c, guard, sin_q, cos_q, a, a_v, force, hold, cases.starts[k], cases.out[k], heave,
                )  # fmt: skip
            if state == FINISHED:
                st[lane.CASE + i], emptied = left_by(k), True
    return landing, turning, touching, emptied


@jit_part
def fill_up(queue, count):
    """End a list of lanes with one that nobody is in, as far as a vector reaches."""
    for j in range(count, min(count + WIDTH, len(queue))):
        queue[j] = place(lane.LANES)


@jit_part
def land_all(st, landing, cases, motions, how, two_sided, hold, work, heave):
    """Land the first `landing` of the list of those that do; whether a body has left its lane."""
    pars, bodies, _, _, out = cases
    landings, guard, a, a_v, force = work[1], work[5], work[8], work[9], work[10]
    path, watch, emptied = len(motions.velocity) == 0, how.detail == ALL, False
    fill_up(landings, landing)
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
            free = len(bodies) > 0 and st[lane.PIECE + i] > st[lane.LAST + i]
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
                state = arrive_at(st, i, k, cases, motions, how, hold, work, heave)
            else:
                state = come_to_rest(st, i, k, cases, motions, how, hold, heave)
            if state == FINISHED:
                st[lane.CASE + i], emptied = left_by(k), True
    return emptied


@jit_part
def touch_all(st, touching, cases, motions, how, hold, work, heave):
    """Roll the first `touching` of the list of those that touch the next facet over to it; as `land_all`."""
    pars, bodies, _, _, out = cases
    touches, guard, a, a_v, force = work[3], work[5], work[8], work[9], work[10]
    path, watch, emptied = len(motions.velocity) == 0, how.detail == ALL, False
    fill_up(touches, touching)
    for j in range(0, touching, WIDTH):
        over, _, doubtful, hit = land(st, touches, j, path, watch, how.linear, True, heave)
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
                state = roll_over(st, i, pars[k], bodies, motions.values, motions.slopes, path, watch, out[k])
            if state != FINISHED and (over >> bit) & 1:
                state = arrive_at(st, i, k, cases, motions, how, hold, work, heave)
            elif state != FINISHED and (hit >> bit) & 1 and st[lane.V + i] <= st[lane.SLOW + i]:
                state = come_to_rest(st, i, k, cases, motions, how, hold, heave)
            if state == FINISHED:
                st[lane.CASE + i], emptied = left_by(k), True
    return emptied


@jit_part
def arrive_at(st, i, k, cases, motions, how, hold, work, heave):
    """`arrive` of body k in lane i."""
    _, _, _, _, c, _, sin_q, cos_q, a, a_v, _ = work
    return arrive(
        st, i, cases.pars[k], cases.bodies, how, motions.values, motions.slopes, motions.velocity, c, sin_q, cos_q, a,
        a_v, hold, cases.starts[k], cases.out[k], heave,
    )  # fmt: skip


@jit_part
def come_to_rest(st, i, k, cases, motions, how, hold, heave):
    """`rest` of body k in lane i."""
    return rest(
        st, i, cases.pars[k], how, motions.values, motions.slopes, motions.blocks, motions.tail, hold, cases.starts[k],
        cases.out[k], heave,
    )  # fmt: skip


@jit_part
def give_up_the_slow(st, busy, out):
    """Hand over bodies that have taken too many steps; whether there were any."""
    emptied = False
    for number in range(busy):
        i = place(number)
        samples = st[lane.LAST + i] - st[lane.FIRST + i]
        k = int(st[lane.CASE + i])
        if k >= 0 and st[lane.STEPS + i] > STEPS_PER_SAMPLE * samples + STEPS_AFTER:
            hand_over(out[k])
            st[lane.CASE + i], emptied = left_by(k), True
    return emptied


@jit_part
def close_gaps(st, busy, slipping, waiting, cases, motions, how, feet, slip_work, foot_work, nothing, felt):
    """Move the last bodies into the lanes of those that left: (how many are busy, slip, wait).

    A body with a foot that has given way begins to slip, unless it holds by then or is done.
    """
    number = 0
    while number < busy:
        i = place(number)
        if number % WIDTH == 0 and bits(load(st, lane.CASE + i) < 0.0) == 0:
            number += WIDTH
        elif st[lane.CASE + i] < 0.0:
            k = int(left_by(st[lane.CASE + i]))
            if feet is not None:
                j = slips.place(slipping)
                contact_how, start = stick_slip.settings(how), cases.starts[k]
                becomes = stick_slip.give_way(
                    st, i, slip_work[0], j, k, feet[k], contact_how, start, motions.values, motions.slopes,
                    foot_work, cases.out[k], felt[k],
                )  # fmt: skip
                if becomes == stick_slip.ELSEWHERE:
                    becomes = stick_slip.follow(
                        feet[k], contact_how, cases.spans[k], start, motions.values, foot_work, nothing, felt[k]
                    )
                if becomes == stick_slip.SLIPPING:
                    slipping += 1
                elif becomes == stick_slip.HOLDING:
                    slip_work[2][waiting] = k
                    waiting += 1
            busy -= 1
            last = place(busy)
            for field in range(0, lane.STRIDE, WIDTH):
                st[i + field] = st[last + field]
                st[i + lane.VECTORS + field] = st[last + lane.VECTORS + field]
        else:
            number += 1
    return busy, slipping, waiting


@jit
def left_by(k):
    """What marks a lane whose body k is done; of that, k again."""
    return -2.0 - k


@jit_part
def slip_on(count, waiting, slip_work, w, cases, motions, how, feet, nothing, felt):
    """Step the bodies that slip, `count` of them; those that hold again wait for a lane: (how many slip, wait)."""
    sl, series, ready = slip_work
    _, _, spans, starts, _ = cases
    values, slopes, _, _, _ = motions
    contact_how, watch, thinned = stick_slip.settings(how), how.detail == ALL, False
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
                becomes = stick_slip.look_after(
                    sl, j, feet[k], contact_how, starts[k], values, slopes, series, w, felt[k]
                )
            else:
                becomes = stick_slip.give_up(sl, j, feet[k], starts[k], felt[k])
            if becomes == stick_slip.ELSEWHERE:
                becomes = stick_slip.follow(feet[k], contact_how, spans[k], starts[k], values, w, nothing, felt[k])
            if becomes != stick_slip.SLIPPING:
                sl[slips.CASE + j], thinned = -1.0, True
            if becomes == stick_slip.HOLDING:
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


@jit
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
