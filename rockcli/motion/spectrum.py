"""The linear oscillator under a ground motion, and the response spectrum: exact from step to step.

    x'' + 2 zeta omega x' + omega^2 x = -a_g(t),   x = x' = 0 at t = 0

With lam = -zeta omega + i omega_d, omega_d = omega sqrt(1 - zeta^2), the complex state z = x' - conj(lam) x obeys
z' = lam z - a_g, and x = Im(z)/omega_d, x' = Re(z) - zeta omega x.  Where a_g = sum c_j s^j over a step of length h,

    z(h) = exp(lam h) z(0) - sum_j c_j j! h^(j+1) phi_{j+1}(lam h),   phi_k(q) = sum_i q^i/(i + k)!

For an acceleration linear between samples (j = 0, 1) this is the recursion of Nigam and Jennings (1969, Bull.
Seism. Soc. Am. 59: 909-922), in one complex number instead of a 2 x 2 matrix.  All periods march together.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import comb, factorial

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.ground.excitation import BELL, LINEAR, Channel, Samples, acceleration

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

SMOOTH_STEP = 0.0125
"""Step over which a sine or bell is taken as a cubic, times its highest circular frequency: 2e-10 of its amplitude."""

LINEAR_STEPS = 256
"""Steps of a straight piece of a pulse: exact whatever their number, they only make room for peaks between them."""

POINTS_PER_PERIOD = 16
"""Points of the oscillator's history at least kept per period, between which its peaks are located."""

MOST_PARTS = 32
"""Parts a step is cut into at most to have them."""

DAMPING = 0.05
"""Damping ratio of Sa(T)."""

_ENTRIES = 1_000_000
"""Complex states held at a time."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """Steps of equal length, over each of which the ground acceleration is a polynomial.

    Attributes:
        start: time of the beginning of the first step [s]; h: length of a step [s].
        c: coefficients of s^0, s^1, ... with s the time since the beginning of the step, (k, d) [m/s², m/s^3, ...].
    """

    start: float
    h: float
    c: Array

    @property
    def end(self) -> float:
        """Time of the end of the last step [s]."""
        return self.start + len(self.c) * self.h


Forcing = tuple[Stretch, ...]
"""A ground motion from t = 0 on, stretch after stretch without gaps; zero afterwards."""


def forcing(channel: Channel, case: int = 0, until: float = np.inf) -> Forcing:
    """One case's ground acceleration as polynomials over steps, cut off at `until` [s].

    A record is exact (linear between samples), so are straight pieces of a pulse; sines and bells are cubics
    through four points per step of SMOOTH_STEP over their frequency.
    """
    parts = _of_record(channel, case, until) if isinstance(channel, Samples) else _of_pulse(channel, case, until)
    return tuple(part for part in parts if len(part.c) and part.h > 0.0)


def _of_record(record: Samples, case: int, until: float) -> Iterator[Stretch]:
    a = record.values * record.factor[case]
    c = np.column_stack([a[:-1], np.diff(a) / record.dt])
    whole = len(c) if until >= record.end else int(until / record.dt)
    yield Stretch(0.0, record.dt, c[:whole])
    if whole < len(c):
        yield Stretch(whole * record.dt, until - whole * record.dt, c[whole : whole + 1])


def _of_pulse(pulses: Channel, case: int, until: float) -> Iterator[Stretch]:
    assert not isinstance(pulses, Samples)
    # nodes strictly inside a step, so that no jump at its ends is seen
    nodes = 0.5 - 0.5 * np.cos((2.0 * np.arange(4) + 1.0) * np.pi / 8.0)
    fit = np.linalg.inv(np.vander(nodes, 4, increasing=True))
    for row in pulses.table[case]:
        t_a, t_b = float(row[0]), min(float(row[1]), until)
        if not t_b > t_a:
            continue
        if int(row[2]) == LINEAR:
            n = LINEAR_STEPS
        else:
            rate = abs(row[4]) if int(row[2]) == BELL else float(np.max(np.abs(row[[5, 8, 11]])))
            n = int(np.ceil((t_b - t_a) * rate / SMOOTH_STEP)) + 1
        h = (t_b - t_a) / n
        t = t_a + h * (np.arange(n)[:, None] + nodes)
        a = acceleration(pulses, t.ravel(), case).reshape(n, 4)
        degree = 2 if int(row[2]) == LINEAR else 4
        yield Stretch(t_a, h, (a @ fit.T / h ** np.arange(4))[:, :degree])


def displacement_spectrum(motion: Forcing, periods: Array, zeta: float) -> Array:
    """Largest |relative displacement| of oscillators of these periods (m,) [s] and damping ratio zeta: (m,) [m]."""
    return np.abs(peaks(motion, periods, zeta)[0])


def pseudo_acceleration(motion: Forcing, periods: Array, zeta: float = DAMPING) -> Array:
    """Sa = omega^2 S_d of oscillators of these periods (m,) [s] and damping ratio zeta: (m,) [m/s²]."""
    return np.asarray((2.0 * np.pi / periods) ** 2 * displacement_spectrum(motion, periods, zeta))


def peaks(motion: Forcing, periods: Array, zeta: float) -> tuple[Array, Array]:
    """The relative displacement of largest modulus, with its sign, (m,) [m], and its time, (m,) [s].

    Peaks between points are located on the exact solution, those after the motion's end in closed form.  Below
    half a step of the motion a period has fewer than POINTS_PER_PERIOD points, no peaks are sought between them,
    and the answer is up to 1 % low; as the period goes to 0, S_d omega^2 goes to the peak ground acceleration.

    Args:
        motion: from `forcing`.
        periods: undamped natural periods, (m,) [s], > 0.
        zeta: damping ratio, 0 <= zeta < 1.
    """
    lam = _pole(periods, zeta)
    z = np.zeros(len(lam), dtype=np.complex128)
    best, when = np.zeros(len(lam)), np.zeros(len(lam))
    for stretch in motion:
        for parts, chosen in _groups(stretch, periods):
            z[chosen], x, t = _march(_cut(stretch, parts), lam[chosen], z[chosen], np.abs(best[chosen]))
            larger = np.abs(x) > np.abs(best[chosen])
            best[chosen[larger]], when[chosen[larger]] = x[larger], t[larger]
    if motion:
        x, t = _first_free_peak(lam, z)
        larger = np.abs(x) > np.abs(best)
        best, when = np.where(larger, x, best), np.where(larger, motion[-1].end + t, when)
    return best, when


def history(motion: Forcing, period: float, zeta: float, t: Array) -> tuple[Array, Array]:
    """Relative displacement [m] and velocity [m/s] of one oscillator at times t, (k,) [s] >= 0, both (k,)."""
    lam = _pole(np.array([period]), zeta)
    z = np.zeros(1, dtype=np.complex128)
    out = np.zeros(len(t), dtype=np.complex128)
    for stretch in motion:
        states = _states(stretch.c, stretch.h, lam, z)[:, 0]
        inside = np.flatnonzero((t >= stretch.start) & (t < stretch.end))
        i = np.clip(((t[inside] - stretch.start) / stretch.h).astype(int), 0, len(stretch.c) - 1)
        s = t[inside] - stretch.start - i * stretch.h
        out[inside] = _within(lam, states[i], stretch.c[i], s)
        z = states[-1:]
    after = t >= (motion[-1].end if motion else 0.0)
    out[after] = z[0] * np.exp(lam[0] * (t[after] - (motion[-1].end if motion else 0.0)))
    x = out.imag / lam[0].imag
    return x, out.real + lam[0].real * x


def _pole(periods: Array, zeta: float) -> Complex:
    if not 0.0 <= zeta < 1.0:
        raise ValueError(f"the damping ratio must be in [0, 1), not {zeta}")
    omega = 2.0 * np.pi / np.asarray(periods, dtype=np.float64)
    return np.asarray(omega * complex(-zeta, np.sqrt((1.0 - zeta) * (1.0 + zeta))), dtype=np.complex128)


def _groups(stretch: Stretch, periods: Array) -> Iterator[tuple[int, NDArray[np.intp]]]:
    """(parts a step is cut into, indices of the periods that need as many), few enough to be held at a time."""
    with np.errstate(over="ignore"):
        wanted = np.clip(POINTS_PER_PERIOD * stretch.h / periods, 1.0, float(MOST_PARTS))
    parts = 2 ** np.ceil(np.log2(wanted)).astype(int)
    for number in np.unique(parts):
        chosen = np.flatnonzero(parts == number)
        at_a_time = max(1, _ENTRIES // (len(stretch.c) * int(number)))
        for i in range(0, len(chosen), at_a_time):
            yield int(number), chosen[i : i + at_a_time]


def _cut(stretch: Stretch, parts: int) -> Stretch:
    """The same acceleration in steps `parts` times as short."""
    if parts == 1:
        return stretch
    h, d = stretch.h / parts, stretch.c.shape[1]
    offset = h * np.arange(parts)
    c = np.zeros((len(stretch.c), parts, d))
    for j in range(d):
        for power in range(j, d):
            c[:, :, j] += comb(power, j) * stretch.c[:, power, None] * offset ** (power - j)
    return Stretch(stretch.start, h, c.reshape(-1, d))


def _march(stretch: Stretch, lam: Complex, z: Complex, beaten: Array) -> tuple[Complex, Array, Array]:
    """States at the end of a stretch, and the extreme displacements on it with their times."""
    states = _states(stretch.c, stretch.h, lam, z)
    x = states.imag / lam.imag
    top = np.argmax(np.abs(x), axis=0)
    column = np.arange(len(lam))
    extreme, when = x[top, column], np.asarray(stretch.start + stretch.h * top, dtype=float)
    v = states.real + lam.real * x
    resolved = np.abs(lam) * stretch.h <= 2.0 * np.pi / POINTS_PER_PERIOD * (1.0 + 1e-9)
    # where the rate changes sign and the larger end could rise above what is known
    least = np.where(resolved, np.maximum(np.abs(extreme), beaten), np.inf)
    reach = np.maximum(
        np.abs(x[:-1]) + 0.5 * stretch.h * np.abs(v[:-1]), np.abs(x[1:]) + 0.5 * stretch.h * np.abs(v[1:])
    )
    i, j = np.nonzero((v[:-1] * v[1:] < 0.0) & (reach >= least))
    if len(i):
        s, peak = _between(lam[j], states[i, j], stretch.c[i], stretch.h, v[i, j], v[i + 1, j])
        order = np.argsort(np.abs(peak), kind="stable")
        i, j, s, peak = i[order], j[order], s[order], peak[order]
        found, at = extreme.copy(), when.copy()
        found[j], at[j] = peak, stretch.start + stretch.h * i + s  # the last of equal j, the largest, stays
        larger = np.abs(found) > np.abs(extreme)
        extreme, when = np.where(larger, found, extreme), np.where(larger, at, when)
    return states[-1], extreme, when


def _states(c: Array, h: float, lam: Complex, z: Complex) -> Complex:
    """States at the beginning of a stretch of k steps and after each of them, (k + 1, m).

    z_{i+1} = mu z_i + w_i is summed in blocks: within all blocks at once, then from block to block.
    """
    k, m = len(c), len(lam)
    gain = np.stack([factorial(j) * h ** (j + 1) * _phi(j + 1, lam * h) for j in range(c.shape[1])])
    mu = np.exp(lam * h)
    length = max(1, int(np.sqrt(k)))
    blocks = -(-k // length)
    flat = np.zeros((blocks * length, m), dtype=np.complex128)
    flat[:k].real, flat[:k].imag = -(c @ gain.real), -(c @ gain.imag)
    w = flat.reshape(blocks, length, m)
    for i in range(1, length):
        w[:, i] += mu * w[:, i - 1]
    powers = np.exp(lam * h * np.arange(1, length + 1)[:, None])
    start = z
    for block in w:
        block += powers * start
        start = block[-1]
    return np.concatenate([z[None], flat[:k]])


def _within(lam: Complex, z: Complex, c: Array, s: Array) -> Complex:
    """State a time s after the beginning of a step, one step each: all (n,), c (n, d)."""
    q = np.asarray(lam * s)
    moved = z * np.exp(q)
    for j in range(c.shape[1]):
        moved -= c[:, j] * factorial(j) * s ** (j + 1) * _phi(j + 1, q)
    return moved


def _between(lam: Complex, z: Complex, c: Array, h: float, v_0: Array, v_1: Array) -> tuple[Array, Array]:
    """Times in a step at which the rate vanishes, and the displacement there, (n,): safeguarded Newton."""
    low, high = np.zeros(len(z)), np.full(len(z), h)
    s = h * v_0 / (v_0 - v_1)
    x = s
    omega_2 = np.abs(lam) ** 2
    for _ in range(6):
        state = _within(lam, z, c, s)
        x = state.imag / lam.imag
        v = state.real + lam.real * x
        a = sum(c[:, j] * s**j for j in range(c.shape[1]))
        before = v * v_0 > 0.0
        low, high = np.where(before, s, low), np.where(before, high, s)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = s - v / (2.0 * lam.real * v - omega_2 * x - a)
        s = np.where((newton >= low) & (newton <= high), newton, 0.5 * (low + high))
    return s, _within(lam, z, c, s).imag / lam.imag


def _first_free_peak(lam: Complex, z: Complex) -> tuple[Array, Array]:
    """Displacement and time of the first extreme in free vibration from z; none later is larger."""
    crest = np.arctan2(lam.imag, -lam.real)  # x ~ exp(-zeta omega t) sin(angle) is extreme where tan(angle) = this
    t = np.mod(crest - np.angle(z), np.pi) / lam.imag
    return (z * np.exp(lam * t)).imag / lam.imag, t


def _phi(k: int, q: Complex) -> Complex:
    """phi_k(q) = sum_i q^i/(i + k)!, phi_k = (phi_{k-1} - 1/(k-1)!)/q, phi_0 = exp."""
    near = np.abs(q) < 1.0
    small = np.where(near, q, 0.0)
    series = np.full(q.shape, 1.0 / factorial(k + 18), dtype=np.complex128)
    for i in range(17, -1, -1):
        series = series * small + 1.0 / factorial(i + k)
    if near.all():
        return series
    far = np.where(near, 1.0, q)
    value = np.exp(far)
    for i in range(k):
        value = (value - 1.0 / factorial(i)) / far
    return np.where(near, series, value)
