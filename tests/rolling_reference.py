"""An independent solver of bodies that roll over the vertices of a convex outline: scipy's DOP853, restarted.

It knows points in the plane alone: the vertex in contact is the lowest point, moments come from arms, an impact from the
cross products of the angular momentum, barriers and rests from the height of the centre of mass over a grid of angles.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

QUARTER = 0.5 * np.pi


@dataclass
class Rolled:
    fell: bool = False
    peak: float = 0.0
    peak_right: float = 0.0
    peak_left: float = 0.0
    n_impacts: int = 0
    lost: float = 0.0
    theta: float = 0.0
    moved: bool = False
    rested: bool = False
    rate: float = 0.0
    friction: float = 0.0
    normal: float = np.inf
    push: float = 0.0
    t_impact: list = field(default_factory=list)
    w_after: list = field(default_factory=list)


class Rock:
    """Points (k, 2) from the centre of mass, radius of gyration, g; `power` of the loss at impacts."""

    def __init__(self, points, r_g, g=9.81, power=1.0):
        self.points, self.r_g, self.g, self.power = np.asarray(points, float), r_g, g, power
        grid = np.linspace(-QUARTER, QUARTER, 200001)
        height = self._height(grid)
        tops = np.flatnonzero((height[1:-1] > height[:-2]) & (height[1:-1] >= height[2:])) + 1
        left, right = tops[grid[tops] < 0], tops[grid[tops] > 0]
        self.last_left = grid[left[0]] if len(left) and height[left[0]] >= height[0] else -QUARTER
        self.last_right = grid[right[-1]] if len(right) and height[right[-1]] >= height[-1] else QUARTER
        self.scale = min(-self.last_left, self.last_right)

    def _height(self, theta):
        best = np.full(len(theta), -np.inf)
        for x, z in self.points:
            best = np.maximum(best, x * np.sin(theta) - z * np.cos(theta))
        return best

    def turned(self, theta):
        """The points as they lie when the body is turned clockwise by theta, from the centre of mass."""
        c, s = np.cos(theta), np.sin(theta)
        return self.points @ np.array([[c, -s], [s, c]])

    def acceleration(self, theta, i, a_g, a_v):
        x, z = -self.turned(theta)[i]  # of the centre of mass from the vertex
        return (x * (self.g + a_v) - z * a_g) / (self.r_g**2 + x * x + z * z)

    def after(self, theta, rate, old, new):
        r_old, r_new = -self.turned(theta)[[old, new]]
        kept = (self.r_g**2 + r_old @ r_new) / (self.r_g**2 + r_new @ r_new)
        inertia = [self.r_g**2 + r @ r for r in (r_old, r_new)]
        without = np.sqrt(inertia[0] / inertia[1])
        return rate * without * max(kept / without, 0.0) ** self.power

    def forces(self, theta, rate, i, a_g, a_v):
        """Along the ground and up per unit mass: what moves the centre of mass as it does, turning about vertex i."""
        x, z = -self.turned(theta)[i]
        turning = self.acceleration(theta, i, a_g, a_v)
        return z * turning - x * rate**2 + a_g, -x * turning - z * rate**2 + self.g + a_v

    def ratio(self, theta, before, after, old, new):
        """Of the impulses along the ground and up that change the velocity of the centre of mass so."""
        (x_old, z_old), (x_new, z_new) = -self.turned(theta)[[old, new]]
        return abs(z_new * after - z_old * before) / (x_old * before - x_new * after)

    def neighbours(self, i):
        """The vertices that touch next when the body turns right and left from vertex i, and at which theta."""
        found = {}
        for sign in (1, -1):
            best, at = None, sign * QUARTER
            for j, (x, z) in enumerate(self.points):
                dx, dz = x - self.points[i, 0], z - self.points[i, 1]
                if j == i or sign * dx <= 0:
                    continue
                theta = np.arctan2(sign * dz, sign * dx)
                if sign * theta < sign * at:
                    best, at = j, theta
            found[sign] = (best, at)
        return found


def largest(values):
    """Of a smooth function at equal distances, by the parabola through the largest and those beside it."""
    k = int(np.argmax(values))
    if not 0 < k < len(values) - 1 or not np.all(np.isfinite(values[k - 1 : k + 2])):
        return values[k]
    low, top, high = values[k - 1 : k + 2]
    bend = low - 2.0 * top + high
    return top - 0.125 * (low - high) ** 2 / bend if bend < 0.0 else top


def roll(rock, motion, breaks, t_end, theta_0=0.0, *, free=80.0, rtol=1e-12, linear=False, finer=1, report=np.inf):
    """The body under motion(t) -> (a_g, a_v), smooth between `breaks`, until t_end, then free until it rests or falls.

    linear: the motion is so between breaks.  finer: of the steps, within which two impacts are not seen.
    report: when forces, rates and impulses are no longer looked at.
    """
    out = Rolled()
    t, theta, rate, pivot = 0.0, theta_0, 0.0, None
    p = np.sqrt(rock.g / (2.0 * np.abs(rock.points).max()))
    ends = [b for b in breaks if b < t_end] + [t_end, t_end + free / p]
    z = rock.turned(theta)[:, 1]
    touching = np.flatnonzero(z - z.min() < 1e-12 * np.abs(rock.points).max())
    resting = len(touching) > 1
    pair = sorted(touching, key=lambda j: rock.points[j, 0])[:: max(len(touching) - 1, 1)]
    if not resting:
        pivot = int(touching[0])

    def note(value):
        out.peak_right, out.peak_left = max(out.peak_right, value), max(out.peak_left, -value)
        out.peak = max(out.peak_right, out.peak_left)

    def press(along, up):
        out.normal = min(out.normal, -largest(-up / rock.g))
        with np.errstate(divide="ignore"):
            out.friction = max(out.friction, largest(np.where(up > 0.0, np.abs(along) / np.maximum(up, 0.0), np.inf)))

    note(theta)
    for stop in ends:
        while t < stop:
            middle = 0.5 * (t + stop)
            if resting:

                def tips(time):
                    # positive while the foot stays between the two vertices
                    a_g, a_v = motion(time, middle)
                    left, right = (rock.acceleration(theta, j, a_g, a_v) for j in pair)
                    return min(left, -right)

                when = np.linspace(t, stop, 2 if linear else 400)
                values = [tips(w) for w in when]
                k = next((k for k, value in enumerate(values) if value < 0.0), None)
                until = stop if k is None else t if k == 0 else brentq(tips, when[k - 1], when[k], xtol=1e-15)
                if min(until, report) > t:
                    along, up = np.transpose([motion(w, middle) for w in np.linspace(t, min(until, report), 400)])
                    press(along, up + rock.g)
                t = until
                if k is None:
                    break
                if k > 0:
                    while tips(t) >= 0.0:
                        t += 1e-15 * max(t, 1.0)
                a_g, a_v = motion(t, middle)
                right = -rock.acceleration(theta, pair[1], a_g, a_v) < rock.acceleration(theta, pair[0], a_g, a_v)
                pivot, resting, rate, out.moved = int(pair[1 if right else 0]), False, 0.0, True
            around = rock.neighbours(pivot)
            (right_j, right_at), (left_j, left_at) = around[1], around[-1]

            def rhs(time, y):
                a_g, a_v = motion(time, middle)
                return [y[1], rock.acceleration(y[0], pivot, a_g, a_v)]

            def to_right(time, y):
                return right_at - y[0]

            def to_left(time, y):
                return y[0] - left_at

            def turns(time, y):
                return y[1]

            to_right.terminal = to_left.terminal = True
            to_right.direction = to_left.direction = -1
            turns.terminal = False
            back = rock.acceleration(theta, pivot, *motion(t, middle))
            low = abs(rate / back) if rate * back < 0.0 else np.inf  # a step inside a low flight, to see its end
            first = min(0.1 / p / finer, low, stop - t)
            run = solve_ivp(rhs, (t, stop), [theta, rate], method="DOP853", rtol=rtol, atol=1e-15, first_step=first,
                            dense_output=True, events=(to_right, to_left, turns), max_step=0.1 / p / finer)  # fmt: skip
            for state in run.y_events[2]:
                note(state[0])
            for begin, end in zip(run.t, run.t[1:], strict=False):
                if begin >= report:
                    break
                when = np.linspace(begin, min(end, report), 33)
                at, speed = run.sol(when)
                ground = [motion(w, middle) for w in when]
                along_up = [rock.forces(a, w, pivot, *b) for a, w, b in zip(at, speed, ground, strict=True)]
                press(*np.transpose(along_up))
                out.rate = max(out.rate, largest(np.abs(speed)))
            t, (theta, rate) = run.t[-1], run.y[:, -1]
            note(theta)
            if run.status == 1:
                new, at = (right_j, right_at) if len(run.t_events[0]) else (left_j, left_at)
                theta = at
                if new is None:
                    out.fell, out.theta = True, theta
                    return out
                went = rate
                rate = rock.after(theta, rate, pivot, new)
                if abs(went) > 1e-6 * p * rock.scale:
                    out.n_impacts += 1
                    if t < report:
                        out.push = max(out.push, rock.ratio(theta, went, rate, pivot, new))
                    out.t_impact.append(t)
                    out.w_after.append(rate)
                pair = sorted((pivot, new), key=lambda j: rock.points[j, 0])
                pivot = new
                a_g, a_v = motion(t, middle)
                left, right = (rock.acceleration(theta, j, a_g, a_v) for j in pair)
                if abs(rate) < 2e-7 * p * rock.scale and left > 0.0 > right:
                    resting, rate = True, 0.0
            if t > t_end and not (rock.last_left <= theta <= rock.last_right) and rate * theta > 0.0:
                out.fell, out.theta = True, theta
                return out
    out.theta, out.rested = theta, resting
    out.fell = not rock.last_left <= theta <= rock.last_right
    return out
