"""Forces at the edge, rates and the energy balance of rocking lanes (docs/theory.md T9, docs/lanes.md).

Extremes are looked for at the start of every step and at landings, many lanes at a time; a step inside which something
may be larger than so far is looked at by itself with the means of a single body.

With G = R/p^2 [FORCING_C sin q + FORCING_S (1 - cos q)], which is zero where a body turns over or rests, the work of
the ground is the change of a G less the integral of G da; `WORK` is that with the other sign.  The work of a vertical
motion is the same with H = R/p^2 [FREE_0 q + FREE_S (1 - cos q) + FREE_C sin q] and its acceleration over g.
"""

from __future__ import annotations

import math

from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.records import state as lane
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.elementary import sin_cos
from rockcli.kernels.lanes.vector.fused import bits, gather, scatter
from rockcli.kernels.lanes.vector.plain import fma, load, select, some, store
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.edge_forces import watch_rocking
from rockcli.kernels.rigid.law import driving, edge_of, energy, pressed, pull, restoring
from rockcli.kernels.rigid.settings import Degrees

FARTHEST = 2.0
"""How far beyond the value at a step's start a quantity may go inside it, in derivatives times the step."""

CLEAR = 1e-2
"""Forces in small bounces are nearly those of a body that turns at rest: its own inertia changes them by less than this
share of what that does."""


@jit
def begin_watch(st, i, par, linear, q, v, a):
    """The constants of a body in lane i, and what it begins with: q, its rate v, and the ground a."""
    side = st[lane.SIDE + i] if q != 0.0 or v != 0.0 else 1.0
    watch_edge(st, i, par, side)
    st[lane.RATE_MAX + i], st[lane.N_LEAST + i], st[lane.MU_MOST + i] = abs(v), math.inf, 0.0
    st[lane.WORK + i] = st[lane.LOST + i] = 0.0
    if q != 0.0 or v != 0.0:
        edge = edge_of(par, at.RIGHT if side > 0.0 else at.LEFT)
        st[lane.LOST + i], st[lane.WORK + i] = -energy(edge, q, v, linear), a * drive(st, i, q, linear)


@jit
def watch_edge(st, i, par, s):
    """The constants of a body in lane i that turns about its edge on side s."""
    right, left = edge_of(par, at.RIGHT), edge_of(par, at.LEFT)
    edge, other = (right, left) if s > 0.0 else (left, right)
    st[lane.SIN_ALPHA + i], st[lane.COS_ALPHA + i] = math.sin(edge.alpha), math.cos(edge.alpha)
    st[lane.SHAKE + i], st[lane.WEIGHT + i] = par[at.FACTOR_H] / edge.radius, edge.g / edge.radius
    inertia = edge.radius / edge.p2
    st[lane.INERTIA + i] = inertia
    st[lane.LOSS + i] = 0.5 * (inertia - other.radius / other.p2 * other.eta * other.eta)


@jit
def drive(st, i, q, linear):
    """G of lane i at q."""
    inertia = st[lane.INERTIA + i]
    if linear:
        return inertia * st[lane.FORCING_C + i] * q
    half = math.sin(0.5 * q)
    return inertia * (st[lane.FORCING_C + i] * math.sin(q) + st[lane.FORCING_S + i] * 2.0 * half * half)


@jit
def drive_up(st, i, q, linear):
    """H of lane i at q, times the scale of the vertical motion over g."""
    free_0, free_s, free_c = st[lane.FREE_0 + i], st[lane.FREE_S + i], st[lane.FREE_C + i]
    if linear:
        free = (free_0 + free_c) * q + 0.5 * free_s * q * q
    else:
        half = math.sin(0.5 * q)
        free = free_0 * q + free_c * math.sin(q) + free_s * 2.0 * half * half
    return st[lane.INERTIA + i] * st[lane.HEAVE + i] * free


@jit
def forces_of(sin_b, cos_b, v, acc, jerk, shake, a, da, weight, change):
    """s T, N and their derivatives by (T9), over m R, of quantities of one unit of time: b = alpha - q.

    weight: of gravity and the vertical motion; change: None, or its derivative.
    """
    vv = v * v
    T = fma(shake, a, fma(cos_b, acc, sin_b * vv))
    N = fma(sin_b, acc, weight - cos_b * vv)
    dT = fma(shake, da, fma(cos_b, jerk, v * fma(3.0 * sin_b, acc, -(cos_b * vv))))
    dN = fma(sin_b, jerk, -(v * fma(3.0 * cos_b, acc, sin_b * vv)))
    if change is not None:
        dN = dN + change
    return T, N, dT, dN


@jit
def may_peak(v, acc, T, N, dT, dN, v_1, acc_1, T_1, N_1, dT_1, dN_1, rate, least, most):
    """Where rate, normal force or friction have an extreme inside a step that may be the largest so far."""
    size = abs(T)
    fast = (v * acc > 0.0) & (v_1 * acc_1 < 0.0) & (abs(v) + FARTHEST * abs(acc) > rate)
    low = N - FARTHEST * abs(dN)
    light = (dN < 0.0) & (dN_1 > 0.0) & (low < least)
    slope, slope_1 = dT * N - T * dN, dT_1 * N_1 - T_1 * dN_1  # of T/N, which may change its sign inside
    bends = (slope * slope_1 < 0.0) & ((T * slope > 0.0) | (T_1 * slope_1 < 0.0))
    rough = bends & (size + FARTHEST * abs(dT) > most * low)
    return fast | light | rough


@jit
def at_end(d1, d2, d3, d4, d5, d6, d7, d8):
    """Rate, acceleration and its derivative at the end of a step, in units of it, from d_k = k c_k."""
    v = d1 + (d2 + ((d3 + d4) + ((d5 + d6) + (d7 + d8))))
    acc = fma(3.0, d4, fma(2.0, d3, d2)) + (fma(5.0, d6, 4.0 * d5) + fma(7.0, d8, 6.0 * d7))
    jerk = fma(6.0, d4, 2.0 * d3) + (fma(20.0, d6, 12.0 * d5) + fma(42.0, d8, 30.0 * d7))
    return v, acc, jerk


@jit
def gives_way(st, i, s0, k0, s1, k1, a, a1, h, d1, d2, d3, d4, d5, d6, d7, d8):
    """Which of WIDTH lanes may need more friction than they have, or leave the ground, in the steps they try.

    Arguments as those of `weigh`.
    """
    sin_a, cos_a, h2 = load(st, lane.SIN_ALPHA + i), load(st, lane.COS_ALPHA + i), h * h
    shake, weight = load(st, lane.SIDE + i) * load(st, lane.SHAKE + i) * h2, load(st, lane.WEIGHT + i) * h2
    T, N, dT, dN = forces_of(
        fma(sin_a, k0, -(cos_a * s0)), fma(cos_a, k0, sin_a * s0), d1, d2, 2.0 * d3, shake, a, a1, weight, None
    )
    v_1, acc_1, jerk_1 = at_end(d1, d2, d3, d4, d5, d6, d7, d8)
    T_1, N_1, dT_1, dN_1 = forces_of(
        fma(sin_a, k1, -(cos_a * s1)), fma(cos_a, k1, sin_a * s1), v_1, acc_1, jerk_1, shake, a + a1, a1, weight, None
    )
    return may_give_way(st, i, d1, d2, T, N, dT, dN, v_1, acc_1, T_1, N_1, dT_1, dN_1)


@jit
def may_give_way(st, i, v, acc, T, N, dT, dN, v_1, acc_1, T_1, N_1, dT_1, dN_1):
    """`gives_way` from rates, accelerations, forces and their derivatives at both ends of the steps."""
    most = load(st, lane.MU_HELD + i)
    at_ends = (abs(T) <= most * N) & (abs(T_1) <= most * N_1)
    # in between a rate is of no account: infinite, none is larger
    between = may_peak(v, acc, T, N, dT, dN, v_1, acc_1, T_1, N_1, dT_1, dN_1, math.inf, 0.0 * N, most)
    doubt = ~at_ends | between
    store(st, lane.WEAK + i, select(doubt, 1.0, 0.0 * T))
    return doubt


@jit
def weigh(st, i, q, v, s0, k0, s1, k1, area, a, a1, pitch, h, d1, d2, d3, d4, d5, d6, d7, d8, lifted, hold):
    """What WIDTH lanes have at the start of the steps they try, and what these may hide.

    s0, k0, s1, k1: sin q and cos q at the start and the end; area: integral of G over the fraction of the step; a, a1:
    the ground and its change over the step; pitch: the same a second.  lifted: None, or the vertical motion and its
    slope, gravity over g and its change over the step, and the integral of H.  hold: where a foot slips from the start
    on its normal force is another.  Returns what `may_give_way` needs.
    """
    sin_a, cos_a, h2 = load(st, lane.SIN_ALPHA + i), load(st, lane.COS_ALPHA + i), h * h
    shake, weight = load(st, lane.SIDE + i) * load(st, lane.SHAKE + i) * h2, load(st, lane.WEIGHT + i) * h2
    least, most, rate = load(st, lane.N_LEAST + i), load(st, lane.MU_MOST + i), load(st, lane.RATE_MAX + i)
    work = load(st, lane.INERTIA + i) * (a1 * area)
    if lifted is None:
        heavy, heavy_1, change = weight, weight, None
    else:
        up, slope_up, w, w1, area_up = lifted
        heavy, heavy_1, change = weight * w, weight * (w + w1), weight * w1
        work = fma(load(st, lane.INERTIA + i), w1 * area_up, work)
        store(st, lane.UP_0 + i, up)
        store(st, lane.UP_1 + i, slope_up)
    T, N, dT, dN = forces_of(
        fma(sin_a, k0, -(cos_a * s0)), fma(cos_a, k0, sin_a * s0), d1, d2, 2.0 * d3, shake, a, a1, heavy, change
    )
    v_1, acc_1, jerk_1 = at_end(d1, d2, d3, d4, d5, d6, d7, d8)
    T_1, N_1, dT_1, dN_1 = forces_of(
        fma(sin_a, k1, -(cos_a * s1)), fma(cos_a, k1, sin_a * s1), v_1, acc_1, jerk_1, shake, a + a1, a1, heavy_1,
        change,
    )  # fmt: skip
    doubt = may_peak(d1, d2, T, N, dT, dN, v_1, acc_1, T_1, N_1, dT_1, dN_1, rate * h, least * weight, most)
    store(st, lane.RATE_MAX + i, select(abs(v) > rate, abs(v), rate))
    size = abs(T)
    more, less = ~(size <= most * N), least * weight > N
    if hold:
        less = less & (size <= load(st, lane.MU_HELD + i) * N)
    if some(more | less):  # seldom: a division costs as much as all the rest
        store(st, lane.MU_MOST + i, select(more, select(N > 0.0, size / N, math.inf), most))
        store(st, lane.N_LEAST + i, select(less, N / weight, least))
    store(st, lane.DOUBT + i, select(doubt, 1.0, 0.0 * q))
    store(st, lane.STEP_WORK + i, work)
    store(st, lane.Q_BEFORE + i, q)
    store(st, lane.A_0 + i, a)
    store(st, lane.A_1 + i, pitch)
    return d1, d2, T, N, dT, dN, v_1, acc_1, T_1, N_1, dT_1, dN_1


@jit
def commit(st, i):
    """Count the work of the steps that WIDTH lanes have taken; which of them to look into."""
    taken = load(st, lane.H + i) < 0.0
    store(st, lane.WORK + i, load(st, lane.WORK + i) + select(taken, load(st, lane.STEP_WORK + i), 0.0))
    return bits(taken & (load(st, lane.DOUBT + i) > 0.0))


@jit
def weigh_landing(st, lanes, q, h, c1, c2, c3, c4, c5, c6, c7, c8, x, loss, end, rate, linear, heave):
    """`weigh` and `commit` for lanes that go as far as x, the fraction of a step, and to q = end: which to look into.

    loss: of those that turn over onto their other edge, energy lost over m g and its rate squared; else 0.
    """
    sin_a, cos_a, h2 = gather(st, lanes + lane.SIN_ALPHA), gather(st, lanes + lane.COS_ALPHA), h * h
    side = gather(st, lanes + lane.SIDE)
    shake, weight = side * gather(st, lanes + lane.SHAKE) * h2, gather(st, lanes + lane.WEIGHT) * h2
    least, most = gather(st, lanes + lane.N_LEAST), gather(st, lanes + lane.MU_MOST)
    fastest = gather(st, lanes + lane.RATE_MAX)
    a, a1 = gather(st, lanes + lane.A_0), gather(st, lanes + lane.A_1) * h
    s0, k0 = sin_cos(q)
    s1, k1 = sin_cos(end)
    v, acc, jerk = c1, 2.0 * c2, 6.0 * c3
    if heave is None:
        heavy, heavy_1, change = weight, weight, None
    else:
        share = gather(st, lanes + lane.HEAVE)
        w, w1 = fma(share, gather(st, lanes + lane.UP_0), 1.0), share * (gather(st, lanes + lane.UP_1) * h)
        heavy, heavy_1, change = weight * w, weight * fma(x, w1, w), weight * w1
    T, N, dT, dN = forces_of(
        fma(sin_a, k0, -(cos_a * s0)), fma(cos_a, k0, sin_a * s0), v, acc, jerk, shake, a, a1, heavy, change
    )
    v_1 = rate * h
    acc_1 = fma(x, fma(x, fma(x, fma(x, 56.0 * c8, 42.0 * c7), 30.0 * c6), 20.0 * c5), 12.0 * c4)
    acc_1 = fma(x, fma(x, acc_1, 6.0 * c3), acc)
    jerk_1 = fma(x, fma(x, fma(x, fma(x, fma(x, 336.0 * c8, 210.0 * c7), 120.0 * c6), 60.0 * c5), 24.0 * c4), jerk)
    T_1, N_1, dT_1, dN_1 = forces_of(
        fma(sin_a, k1, -(cos_a * s1)), fma(cos_a, k1, sin_a * s1), v_1, acc_1, jerk_1, shake, fma(x, a1, a), a1,
        heavy_1, change,
    )  # fmt: skip
    doubt = may_peak(v, acc, T, N, dT, dN, v_1, acc_1, T_1, N_1, dT_1, dN_1, fastest * h, least * weight, most)
    speed, size, light = abs(rate), abs(T_1), N_1 / weight
    friction = select(N_1 > 0.0, size / N_1, math.inf)
    scatter(st, lanes + lane.RATE_MAX, select(speed > fastest, speed, fastest))
    scatter(st, lanes + lane.MU_MOST, select(friction > most, friction, most))
    scatter(st, lanes + lane.N_LEAST, select(light < least, light, least))
    scatter(st, lanes + lane.LOST, gather(st, lanes + lane.LOST) + loss * rate * rate)
    scatter(st, lanes + lane.X_HIT, x)
    scatter(st, lanes + lane.SIDE_BEFORE, side)

    # integrals of sin q and 1 - cos q from their series (T3), d_k = k c_k
    if linear:
        sines = x * fma(x, fma(x, fma(x, c3 / 4.0, c2 / 3.0), c1 / 2.0), q)
        y = x * x * x * x * x
        sines = sines + y * fma(x, fma(x, fma(x, fma(x, c8 / 9.0, c7 / 8.0), c6 / 7.0), c5 / 6.0), c4 / 5.0)
        area = gather(st, lanes + lane.FORCING_C) * sines
    else:
        d2, d3, d4, d5, d6 = 2.0 * c2, 3.0 * c3, 4.0 * c4, 5.0 * c5, 6.0 * c6
        s1, k1 = c1 * k0, -(c1 * s0)
        s2, k2 = 0.5 * fma(d2, k0, c1 * k1), -0.5 * fma(d2, s0, c1 * s1)
        s3 = fma(d3, k0, fma(d2, k1, c1 * k2)) / 3.0
        k3 = -fma(d3, s0, fma(d2, s1, c1 * s2)) / 3.0
        s4 = fma(d4, k0, fma(d3, k1, fma(d2, k2, c1 * k3))) / 4.0
        k4 = -fma(d4, s0, fma(d3, s1, fma(d2, s2, c1 * s3))) / 4.0
        s5 = fma(d5, k0, fma(d4, k1, fma(d3, k2, fma(d2, k3, c1 * k4)))) / 5.0
        k5 = -fma(d5, s0, fma(d4, s1, fma(d3, s2, fma(d2, s3, c1 * s4)))) / 5.0
        s6 = fma(d6, k0, fma(d5, k1, fma(d4, k2, fma(d3, k3, fma(d2, k4, c1 * k5))))) / 6.0
        k6 = -fma(d6, s0, fma(d5, s1, fma(d4, s2, fma(d3, s3, fma(d2, s4, c1 * s5))))) / 6.0
        sines = fma(x, fma(x, fma(x, fma(x, s6 / 7.0, s5 / 6.0), s4 / 5.0), s3 / 4.0), s2 / 3.0)
        sines = x * fma(x, fma(x, sines, s1 / 2.0), s0)
        cosines = fma(x, fma(x, fma(x, fma(x, k6 / 7.0, k5 / 6.0), k4 / 5.0), k3 / 4.0), k2 / 3.0)
        cosines = x * fma(x, fma(x, cosines, k1 / 2.0), k0)
        area = gather(st, lanes + lane.FORCING_C) * sines + gather(st, lanes + lane.FORCING_S) * (x - cosines)
        if heave is not None:
            arc = fma(x, fma(x, fma(x, fma(x, c8 / 9.0, c7 / 8.0), c6 / 7.0), c5 / 6.0), c4 / 5.0)
            arc = x * fma(x, fma(x, fma(x, fma(x, arc, c3 / 4.0), c2 / 3.0), c1 / 2.0), q)
            free_s, free_c = gather(st, lanes + lane.FREE_S), gather(st, lanes + lane.FREE_C)
            area_up = fma(gather(st, lanes + lane.FREE_0), arc, fma(free_c, sines, free_s * (x - cosines)))
            work = gather(st, lanes + lane.INERTIA) * (w1 * area_up)
            scatter(st, lanes + lane.WORK, gather(st, lanes + lane.WORK) + work)
    scatter(st, lanes + lane.WORK, gather(st, lanes + lane.WORK) + gather(st, lanes + lane.INERTIA) * (a1 * area))
    return bits(doubt)


@jit
def work_until(st, i, x, c, sin_q, cos_q, linear):
    """Count the work of the step lane i has tried up to the fraction x of it; c: its coefficients."""
    total = total_up = 0.0
    power = x
    for k in range(lane.ORDER):
        if linear:
            sin_q[k], cos_q[k] = c[k], 0.0 if k > 0 else 1.0
        elif k == 0:
            sin_q[0], cos_q[0] = math.sin(c[0]), math.cos(c[0])
        else:
            up = down = 0.0
            for j in range(1, k + 1):
                up += j * c[j] * cos_q[k - j]
                down += j * c[j] * sin_q[k - j]
            sin_q[k], cos_q[k] = up / k, -down / k
        versine = (1.0 if k == 0 else 0.0) - cos_q[k]
        total += (st[lane.FORCING_C + i] * sin_q[k] + st[lane.FORCING_S + i] * versine) * power / (k + 1)
        free = st[lane.FREE_0 + i] * c[k] + st[lane.FREE_C + i] * sin_q[k] + st[lane.FREE_S + i] * versine
        total_up += free * power / (k + 1)
        power *= x
    st[lane.WORK + i] += st[lane.INERTIA + i] * st[lane.A_1 + i] * abs(st[lane.H + i]) * total
    if st[lane.HEAVE + i] != 0.0:
        change = st[lane.HEAVE + i] * st[lane.UP_1 + i] * abs(st[lane.H + i])
        st[lane.WORK + i] += st[lane.INERTIA + i] * change * total_up


@jit
def look_into(st, i, par, s, x, space, force, a, a_v, out):
    """Extremes inside the step lane i has tried on side s, up to the fraction x of it."""
    h, scale = abs(st[lane.H + i]), 1.0
    space[0] = st[lane.Q_BEFORE + i]
    for k in range(lane.ORDER):
        scale /= h
        space[k + 1] = st[lane.COEFFICIENTS + k * WIDTH + i] * scale
    a[0], a[1], a_v[0] = st[lane.A_0 + i] * par[at.FACTOR_H], st[lane.A_1 + i] * par[at.FACTOR_H], 0.0
    degree_up = 0
    if st[lane.HEAVE + i] != 0.0:
        a_v[0], a_v[1], degree_up = st[lane.UP_0 + i] * par[at.FACTOR_V], st[lane.UP_1 + i] * par[at.FACTOR_V], 1
    out[to.RATE_PEAK], out[to.N_MIN], out[to.MU] = st[lane.RATE_MAX + i], st[lane.N_LEAST + i], st[lane.MU_MOST + i]
    edge = edge_of(par, at.RIGHT if s > 0.0 else at.LEFT)
    watch_rocking(edge, s, space, lane.ORDER, x * h, a, a_v, Degrees(1, degree_up), 1, force, out)
    st[lane.RATE_MAX + i], st[lane.N_LEAST + i], st[lane.MU_MOST + i] = out[to.RATE_PEAK], out[to.N_MIN], out[to.MU]


@jit
def weigh_end(st, i, edge, s, q, v, shaken, lifted, linear):
    """What lane i has where its motion or its report ends, the ground's accelerations `shaken` and `lifted`.

    No step begins there.
    """
    sine, cosine = (q, 1.0) if linear else (math.sin(q), math.cos(q))
    back, force = restoring(edge.r0, edge.rs, edge.rc, sine, cosine), driving(edge.fc, edge.fs, sine, cosine)
    acc = -edge.p2 * pull(1.0 + lifted / edge.g, back, s * shaken / edge.g, force)
    sin_b, cos_b, vv = math.sin(edge.alpha - q), math.cos(edge.alpha - q), v * v
    T = shaken + s * edge.radius * (cos_b * acc + sin_b * vv)
    N = edge.g + lifted + edge.radius * (sin_b * acc - cos_b * vv)
    st[lane.RATE_MAX + i] = max(st[lane.RATE_MAX + i], abs(v))
    st[lane.N_LEAST + i] = min(st[lane.N_LEAST + i], N / edge.g)
    st[lane.MU_MOST + i] = max(st[lane.MU_MOST + i], abs(T) / N if N > 0.0 else math.inf)


@jit
def bounces_matter(st, i, par, s, a, da, w, dw, least, most):
    """Whether N/(m g) may be below `least`, or |T|/N above `most`, in small bounces.

    The ground goes from a to a + da, gravity over g from w to w + dw.
    """
    for side in (s, -s):
        edge = edge_of(par, at.RIGHT if side > 0.0 else at.LEFT)
        sin_a, cos_a, weight = st[lane.SIN_ALPHA + i], st[lane.COS_ALPHA + i], st[lane.WEIGHT + i]
        if st[lane.UNLIKE + i] > 0.0:
            sin_a, cos_a, weight = math.sin(edge.alpha), math.cos(edge.alpha), edge.g / edge.radius
        unshaken = CLEAR * max(w, w + dw) * pressed(edge, side, 0.0, 0.0) / weight
        for ground, heavy in ((a, w), (a + da, w + dw)):
            shaken = ground * par[at.FACTOR_H]
            acc = -pressed(edge, side, shaken, (heavy - 1.0) * edge.g)
            N = heavy + sin_a * acc / weight
            T = abs(shaken / edge.g + side * cos_a * acc / weight)
            low, size = N - unshaken * sin_a, T + unshaken * cos_a
            if low < least or size > low * most:
                return True
    return False


@jit
def stood(st, i, par, most):
    """Lane i has been at rest while |a| was `most` at most."""
    st[lane.N_LEAST + i] = min(st[lane.N_LEAST + i], 1.0)
    st[lane.MU_MOST + i] = max(st[lane.MU_MOST + i], most * abs(par[at.FACTOR_H]) / par[at.G])


@jit
def account(st, i, left, out):
    """Results of lane i, whose body has the energy `left` over m g."""
    out[to.RATE_PEAK], out[to.N_MIN], out[to.MU] = st[lane.RATE_MAX + i], st[lane.N_LEAST + i], st[lane.MU_MOST + i]
    out[to.ENERGY] = -st[lane.WORK + i] - st[lane.LOST + i] - left
