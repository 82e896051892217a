"""What is read off a step: energy, work, extremes, histories."""

from __future__ import annotations

import math

from rockcli.kernels.constants import DUE, FAST, MEANINGFUL, NO_ROOT, SAME
from rockcli.kernels.contact import flows
from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import results as to
from rockcli.kernels.contact import workspace as row
from rockcli.kernels.contact.codes import FLIGHT, REST, ROCK, SLIDE, SLIDE_ROCK
from rockcli.kernels.contact.rest import frequency
from rockcli.kernels.contact.state import edge_under
from rockcli.kernels.jit import jit
from rockcli.kernels.rigid.law import potential
from rockcli.kernels.rigid.roots import last_passage, lowest_point, turning_point
from rockcli.kernels.rigid.series import bend, bound, slope, value

LOOKS = 8
"""Parts of a step in which extremes are looked for."""


@jit
def energy_on_edge(par, foot):
    """Energy of a body on an edge over m: kinetic, that of sliding included, and height [J/kg]."""
    q, v, e = foot.q, foot.v, edge_under(foot.s)
    R, beta = par[e + at.RADIUS], par[e + at.ALPHA] - q
    x_rate, z_rate = foot.u + foot.s * R * math.cos(beta) * v, R * math.sin(beta) * v
    half = math.sin(0.5 * q)
    bent = -2.0 * math.cos(par[e + at.ALPHA]) * half * half
    rise = R * potential(0.0, math.sin(par[e + at.ALPHA]), q, bent, math.sin(q))
    return 0.5 * (x_rate * x_rate + z_rate * z_rate + par[at.RG2] * v * v) + par[at.G] * rise


@jit
def energy_in_flight(par, air):
    """Energy of a body in flight over m [J/kg]."""
    x_rate, z_rate, rate = air.x_rate, air.z_rate, air.turn
    kinetic = 0.5 * (x_rate * x_rate + z_rate * z_rate + par[at.RG2] * rate * rate)
    return kinetic + par[at.G] * (air.z - par[at.H])


@jit
def work_of(force, d, rate, n, x):
    """Integral of the product of two series, of orders d <= n, from 0 to x; to order n, as far as they are known."""
    total, power = 0.0, x
    for k in range(n + 1 if d > 1 else n + d + 1):
        product = 0.0
        for j in range(max(k - n, 0), min(d, k) + 1):
            product += force[j] * rate[k - j]
        total += product * power / (k + 1)
        power *= x
    return total


@jit
def work(par, mode, foot, step, n, d, level, w):
    """Work of the ground motion and of friction on a step over m, of -a_g x' - a_v z' + T v_t [J/kg].

    Of forces times velocities, so that the balance of energy judges the flow.  d, level: of the ground, as in `Ahead`.
    """
    if mode == REST or step.x == 0.0:
        return 0.0
    a, W, slip, x = w[row.A_G], w[row.WEIGHT], w[row.SLIP], step.x
    grip = par[at.MU_K] * foot.sigma
    if mode == FLIGHT:
        height, rise = w[row.HEIGHT], w[row.PATH]
        for k in range(n):
            rise[k] = (k + 1) * height[k + 1]
        lifted = par[at.G] * integral(rise, n - 1, x)
        return lifted - work_of(W, d, rise, n - 1, x) - work_of(a, d, slip, n, x)
    if mode == SLIDE:
        return -work_of(a, d, slip, step.slip_order, x) - grip * work_of(W, d, slip, step.slip_order, x)
    shaken = work_of_line(par, mode, foot, step, w) if level and d == 1 else work_turning(par, foot, step, d, w)
    if mode == ROCK:
        return shaken
    if not (level and d == 1):
        shaken -= work_of(a, d, slip, step.slip_order, x)
    return shaken - grip * work_of(w[row.NORMAL], step.order - 2, slip, step.slip_order, x)


@jit
def work_of_line(par, mode, foot, step, w):
    """Work of a level ground's a_g that is a straight line, as in records: x' is the slip less s R sin(beta)'."""
    a, lean, slip, x = w[row.A_G], w[row.LEAN], w[row.SLIP], step.x
    lever, slides = foot.s * par[edge_under(foot.s) + at.RADIUS], mode == SLIDE_ROCK
    total, power, before = 0.0, x, 0.0
    for k in range(step.order):
        back = lever * lean[k] - slip[k] if slides else lever * lean[k]
        total += (a[0] * back + a[1] * before) * power / (k + 1)
        power *= x
        before = back
    return total + a[1] * before * power / (step.order + 1)


@jit
def work_turning(par, foot, step, d, w):
    """`work` of the turning about the edge: x' is -s R times the rate of sin(beta), z' is R times that of cos(beta)."""
    a, W, sin_b, cos_b, x = w[row.A_G], w[row.WEIGHT], w[row.SIN_B], w[row.COS_B], step.x
    total, power = 0.0, x
    for k in range(1, step.order + d + 1):
        drive = 0.0
        for j in range(max(k - step.order, 0), min(d, k - 1) + 1):
            lift = W[j] - par[at.G] if j == 0 else W[j]
            drive += (k - j) * (foot.s * a[j] * sin_b[k - j] - lift * cos_b[k - j])
        total += drive * power / k
        power *= x
    return total * par[edge_under(foot.s) + at.RADIUS]


@jit
def extremes(c, n, x, parts, found):
    """Largest value of a polynomial on [0, x] and where, then the smallest and where, into found[0:4]."""
    extremes_from(c, n, 0.0, x, parts, found)


@jit
def extremes_from(c, n, start, x, parts, found):
    """The same on [start, x]."""
    lo, v_lo, b_lo = start, slope(c, n, start), bend(c, n, start)
    found[0] = found[2] = value(c, n, start)
    found[1] = found[3] = start
    for j in range(1, parts + 1):
        end = start + (x - start) * j / parts if j < parts else x
        b_hi = bend(c, n, end)
        # where the bend changes its sign the slope has an extreme, which the ends do not show
        middle = lo + (end - lo) * b_lo / (b_lo - b_hi) if b_lo * b_hi < 0.0 else end
        for hi in (middle, end):
            P_hi, v_hi = value(c, n, hi), slope(c, n, hi)
            for inside in range(2):
                y, P = hi, P_hi
                if inside == 0:
                    if v_lo > 0.0 > v_hi:
                        y = turning_point(c, n, lo, hi)
                    elif v_lo < 0.0 < v_hi:
                        y = lowest_point(c, n, lo, hi)
                    else:
                        continue
                    P = value(c, n, y)
                if found[0] < P:
                    found[0], found[1] = P, y
                if found[2] > P:
                    found[2], found[3] = P, y
            lo, v_lo = hi, v_hi
        b_lo = b_hi


@jit
def note_angle(q, side, t, tol, out):
    """Raise the peak of |theta| to q if it is the largest so far, of all or of its side (`rigid/readings.set_peak`)."""
    which = to.PEAK_RIGHT if side > 0.0 else to.PEAK_LEFT
    out[which] = max(out[which], q)
    if q > out[to.PEAK] * (1.0 + 1e-12 + 100.0 * tol):
        out[to.PEAK_SIDE], out[to.T_PEAK] = side, t
    out[to.PEAK] = max(out[to.PEAK], q)


@jit
def note_slide(place, out):
    """Raise the largest slide."""
    if abs(place) > abs(out[to.SLIDE_PEAK]):
        out[to.SLIDE_PEAK] = place


@jit
def note_top(most, least, out):
    """Raise the largest displacement of the top to the extremes found."""
    out[to.TOP_PEAK] = max(out[to.TOP_PEAK], abs(most), abs(least))


@jit
def note_rotation(foot, step, t, looks, tol, w, out):
    """Largest rotation of a step on one edge."""
    if step.reach <= out[to.PEAK_RIGHT if foot.s > 0.0 else to.PEAK_LEFT]:
        return
    found = w[row.FOUND]
    extremes(w[row.Q], step.order, step.x, looks, found)
    note_angle(found[0], foot.s, t + found[1], tol, out)


@jit
def note_rocking(par, mode, foot, step, looks, w, out):
    """Extremes of a step on one edge: rate of the rotation, the normal force, the top; where they may be larger yet."""
    c, N, guard, found, m, x = w[row.Q], w[row.NORMAL], w[row.GUARD], w[row.FOUND], step.order, step.x
    fastest = 0.0
    for k in range(m, 0, -1):
        fastest = fastest * x + k * abs(c[k])
    if fastest > out[to.RATE_PEAK]:
        for k in range(m):
            guard[k] = (k + 1) * c[k + 1]
        extremes(guard, m - 1, x, looks, found)
        out[to.RATE_PEAK] = max(out[to.RATE_PEAK], abs(found[0]), abs(found[2]))
    if N[0] + abs(N[0]) - bound(N, m - 2, x) < out[to.N_MIN] * par[at.G]:
        extremes(N, m - 2, x, looks, found)
        out[to.N_MIN] = min(out[to.N_MIN], found[2] / par[at.G])
    slip = w[row.SLIP]
    slid = bound(slip, step.slip_order, x) * x if mode == SLIDE_ROCK else 0.0
    if abs(foot.place) + slid + par[at.TOP] * min(step.reach, 1.0) <= out[to.TOP_PEAK]:  # sin(q) is less than q
        return
    # the top: slide + top sin(theta)
    alpha, sin_b, cos_b = par[edge_under(foot.s) + at.ALPHA], w[row.SIN_B], w[row.COS_B]
    for k in range(m):
        guard[k] = foot.s * par[at.TOP] * (math.sin(alpha) * cos_b[k] - math.cos(alpha) * sin_b[k])
        if mode == SLIDE_ROCK and k > 0:
            guard[k] += slip[k - 1] / k
    guard[0] += foot.place
    extremes(guard, m - 1, x, looks, found)
    note_top(found[0], found[2], out)


@jit
def note_on_edge(par, how, mode, foot, step, t, counted, looks, w, out):
    """Passage of the equilibrium and extremes of a step on one edge, `counted` if the report has not ended."""
    note_passage(par, how, mode, foot, step, t, looks, w, out)
    if counted:
        note_rotation(foot, step, t, looks, how.tol, w, out)
        if how.extremes:
            note_rocking(par, mode, foot, step, looks, w, out)


@jit
def note_carried(scales, hit, t, out):
    """What an impact carries (`MEANINGFUL`)."""
    carried = (hit / (scales.p_min * scales.alpha_min)) ** 2 - MEANINGFUL**2
    if carried > 0.0:
        out[to.SWINGS] += carried
        out[to.SWINGS_T] += carried * t


@jit
def note_passage(par, how, mode, foot, step, t, looks, w, out):
    """When the body last passes its unstable equilibrium outwards, and its slide and normal force until then."""
    alpha = par[edge_under(foot.s) + at.ALPHA]
    if step.reach * SAME < alpha:  # it stays below
        return
    passed = last_passage(w[row.Q], step.order, alpha, step.x, LOOKS)
    if passed == NO_ROOT:
        return
    out[to.T_OVERTURN] = t + passed
    place = foot.place + (integral(w[row.SLIP], step.slip_order, passed) if mode == SLIDE_ROCK else 0.0)
    out[to.SLIDE_STANDING] = max(abs(out[to.SLIDE_PEAK]), abs(foot.place), abs(place))
    if how.extremes:
        found = w[row.FOUND]
        extremes(w[row.NORMAL], step.order - 2, passed, looks, found)
        out[to.N_STANDING] = min(out[to.N_MIN], found[2] / par[at.G])


@jit
def flown_path(par, air, n, up, lower, w):
    """Series of the displacement in flight of what is `up` above the centre of mass, on the side `lower`, in PATH."""
    path, slip, b = w[row.PATH], w[row.SLIP], lower * par[edge_under(lower) + at.B]
    flows.turning(up, b, air, n, path)
    path[0] += air.x - b
    for k in range(1, n + 1):
        path[k] += slip[k - 1] / k


@jit
def flown_extremes(par, air, n, up, x, w):
    """Largest and smallest displacement on [0, x] in flight of what is `up` above the centre of mass on the lower side.

    That is another side from where theta passes zero.
    """
    path, found, theta = w[row.PATH], w[row.FOUND], air.theta
    passes = -theta / air.turn if air.turn != 0.0 else 0.0
    side = 1.0 if theta > 0.0 or (theta == 0.0 and air.turn >= 0.0) else -1.0
    flown_path(par, air, n, up, side, w)
    if not 0.0 < passes < x:
        extremes(path, n, x, LOOKS, found)
        return found[0], found[2]
    extremes(path, n, passes, LOOKS, found)
    most, least = found[0], found[2]
    flown_path(par, air, n, up, -side, w)
    extremes_from(path, n, passes, x, LOOKS, found)
    return max(most, found[0]), min(least, found[2])


@jit
def note_flying(par, air, n, x, t, counted, w, out):
    """Extremes of a step in flight: rotation, its rate, the slide of the lower edge, the top."""
    theta, turn = air.theta, air.turn
    out[to.N_MIN] = min(out[to.N_MIN], 0.0)
    end = abs(theta + turn * x)
    tilted = 1.0 if theta + turn * x > 0.0 else -1.0
    limit = par[edge_under(tilted) + at.ALPHA]
    if end >= limit and tilted * theta < limit:
        passed = (limit - tilted * theta) / abs(turn)
        out[to.T_OVERTURN], out[to.N_STANDING] = t + passed, out[to.N_MIN]
        most, least = flown_extremes(par, air, n, -par[at.H], passed, w)
        out[to.SLIDE_STANDING] = max(abs(out[to.SLIDE_PEAK]), abs(most), abs(least))
    if not counted:
        return
    note_angle(end, tilted, t + x, 0.0, out)
    out[to.RATE_PEAK] = max(out[to.RATE_PEAK], abs(turn))
    most, least = flown_extremes(par, air, n, -par[at.H], x, w)
    note_slide(most, out)
    note_slide(least, out)
    most, least = flown_extremes(par, air, n, par[at.TOP] - par[at.H], x, w)
    note_top(most, least, out)


@jit
def note_step(par, how, mode, foot, air, step, t, counted, ahead, w, out):
    """What happens on the way: extremes of a step, the passage of the equilibrium.

    On a step of no length nothing does: forces there are of a mode that the ground has just ended.
    """
    if step.x == 0.0:
        return
    looks = 1 if ahead.degree == 1 and t < par[at.T_MOTION] else LOOKS
    if mode in (ROCK, SLIDE_ROCK):
        note_on_edge(par, how, mode, foot, step, t, counted, looks, w, out)
    elif mode == FLIGHT:
        note_flying(par, air, how.order, step.x, t, counted, w, out)
    elif counted and ahead.level:
        out[to.N_MIN] = min(out[to.N_MIN], 1.0)
    elif counted:
        extremes(w[row.WEIGHT], ahead.degree, step.x, looks, w[row.FOUND])
        out[to.N_MIN] = min(out[to.N_MIN], w[row.FOUND][2] / par[at.G])


@jit
def integral(c, n, x):
    """Integral of a polynomial from 0 to x."""
    y = c[n] / (n + 1)
    for k in range(n - 1, -1, -1):
        y = y * x + c[k] / (k + 1)
    return y * x


@jit
def slide_in_flight(par, air_x, theta):
    """Slide of the lower edge of a body in flight whose centre of mass is at `air_x` [m]."""
    lower = 1.0 if theta > 0.0 else -1.0
    b = lower * par[edge_under(lower) + at.B]
    return air_x + b * math.cos(theta) - par[at.H] * math.sin(theta) - b


@jit
def write_step(par, mode, foot, air, step, t, until, n, w, dt_out, i, histories):
    """Write the histories at the output times up to a time, from number i on; returns the number of the next."""
    theta_out, rate_out, slide_out = histories[0], histories[1], histories[2]
    slide_rate_out, mode_out, lift_out = histories[3], histories[4], histories[5]
    c, slip, m, ns = w[row.Q], w[row.SLIP], step.order, step.slip_order
    while i < len(theta_out) and i * dt_out <= until * (1.0 + DUE):
        y = min(i * dt_out, until) - t
        mode_out[i] = mode
        theta_out[i] = rate_out[i] = slide_rate_out[i] = lift_out[i] = 0.0
        slide_out[i] = foot.place
        if mode in (ROCK, SLIDE_ROCK):
            theta_out[i], rate_out[i] = foot.s * max(value(c, m, y), 0.0), foot.s * slope(c, m, y)
        if mode in (SLIDE, SLIDE_ROCK):
            slide_out[i] = foot.place + integral(slip, ns, y)
            slide_rate_out[i] = value(slip, ns, y)
        if mode == FLIGHT:
            angle = air.theta + air.turn * y
            sin_t, cos_t = math.sin(angle), math.cos(angle)
            lower = 1.0 if angle > 0.0 else -1.0
            b = lower * par[edge_under(lower) + at.B]
            theta_out[i], rate_out[i] = angle, air.turn
            slide_out[i] = slide_in_flight(par, air.x + integral(slip, n, y), angle)
            slide_rate_out[i] = value(slip, n, y) - air.turn * (b * sin_t + par[at.H] * cos_t)
            lift_out[i] = max(value(w[row.HEIGHT], n, y) - b * sin_t - par[at.H] * cos_t, 0.0)
        i += 1
    return i


@jit
def write_bounces(foot, t, until, dt_out, i, histories):
    """The same during bounces that end in rest, or in sliding, at `until`: upright, at the present slip velocity."""
    while i < len(histories[0]) and i * dt_out <= until * (1.0 + DUE):
        histories[0][i] = histories[1][i] = histories[5][i] = 0.0
        histories[2][i] = foot.place + foot.u * (min(i * dt_out, until) - t)
        histories[3][i], histories[4][i] = foot.u, (ROCK if foot.u == 0.0 else SLIDE_ROCK)
        i += 1
    return i


@jit
def write_rest(foot, until, dt_out, i, histories):
    """The same of a body that rests until the report ends."""
    while i < len(histories[0]) and i * dt_out <= until * (1.0 + DUE):
        for j in range(6):
            histories[j][i] = 0.0
        histories[2][i] = foot.place
        i += 1
    return i


@jit
def note_event(t, mode, events, out):
    """Write down that a mode was entered, and count it."""
    k = int(out[to.N_EVENTS])
    if k < len(events[0]):
        events[0][k], events[1][k] = t, mode
    out[to.N_EVENTS] += 1


@jit
def counts(par, s, hit):
    """Whether an impact at the rate `hit` is counted of a body that has turned about the edge on side s."""
    e = edge_under(s)
    return hit > FAST * frequency(par, e) * par[e + at.ALPHA]


@jit
def note_impact(t, before, after, impacts, out):
    """Count an impact, and write down the rates before and after it."""
    out[to.N_IMPACTS] += 1
    k = int(out[to.IMPACTS_STORED])
    if k < len(impacts[0]):
        impacts[0][k], impacts[1][k], impacts[2][k] = t, before, after
        out[to.IMPACTS_STORED] += 1


@jit
def note_uplift(t, out):
    """The body begins to tilt."""
    if math.isnan(out[to.T_UPLIFT]):
        out[to.T_UPLIFT] = t


@jit
def note_slip(t, turns, slipped, out):
    """The foot begins to slip, or goes on slipping another way."""
    if not slipped:
        out[to.N_SLIPS] += 1
    if math.isnan(out[to.T_SLIP]):
        out[to.T_SLIP] = t
    if turns and math.isnan(out[to.T_SLIDE_ROCK]):
        out[to.T_SLIDE_ROCK] = t


@jit
def note_flight(t, air, out):
    """The body leaves the ground, tilted or turning, or flat."""
    out[to.N_FLIGHTS] += 1
    if math.isnan(out[to.T_FLIGHT]):
        out[to.T_FLIGHT] = t
    if air.theta != 0.0 or air.turn != 0.0:
        note_uplift(t, out)
