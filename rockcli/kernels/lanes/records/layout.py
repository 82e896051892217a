"""What the lanes of records read of a motion, sample by sample, beside its values: found once for all its bodies."""

from __future__ import annotations

from rockcli.kernels.ahead import MATRIX, VECTOR
from rockcli.kernels.jit import entry, jit

SLACK = 1e-9
"""What bounds of the velocity are widened by, over its range: far more than rounding."""


@entry(VECTOR, MATRIX, VECTOR, VECTOR, VECTOR, MATRIX)
def lay_out(values, spans, slopes, blocks, tail, velocity):
    """Fill what `march_lanes` reads of motions one after the other, first, last sample and time step `spans`.

    velocity: of one row at most, it is not told.
    """
    size = len(values) // len(blocks)
    for j in range(len(blocks)):
        most = 0.0
        for i in range(j * size, (j + 1) * size):
            most = max(most, abs(values[i]))
        blocks[j] = most
    for k in range(len(spans)):
        first, last, dt = int(spans[k, 0]), int(spans[k, 1]), spans[k, 2]
        for i in range(first, last):
            slopes[i] = (values[i + 1] - values[i]) / dt
        most = 0.0
        for i in range(last, first - 1, -1):
            most = max(most, abs(values[i]))
            tail[i] = most
        if len(velocity) > 1:
            bound(values, slopes, first, last, dt, velocity)


@jit
def bound(values, slopes, first, last, dt, velocity):
    """The ground's velocity at each sample of a motion, and its largest and least from that sample on, rows of three.

    a_g is linear between samples, so that a velocity may be extreme inside one, where a_g passes zero.
    """
    now = least = most = 0.0
    for i in range(first, last + 1):
        velocity[i, 0] = between = now
        if i < last:
            if values[i] * values[i + 1] < 0.0:
                between = now - 0.5 * (values[i] * values[i]) / slopes[i]
            now += 0.5 * dt * (values[i] + values[i + 1])
        velocity[i, 1] = between
        if i == first:
            least = most = between
        least, most = min(least, between), max(most, between)
    slack = SLACK * (most - least)
    least = most = velocity[last, 0]
    for i in range(last, first - 1, -1):
        now, between = velocity[i, 0], velocity[i, 1]
        least, most = min(least, now, between), max(most, now, between)
        velocity[i, 1], velocity[i, 2] = most + slack, least - slack


@entry(VECTOR, VECTOR, float, VECTOR)
def graze(values, guards, within, found):
    """Whether one of these accelerations is as large as each guard but for `within`, relative to it: 1, else 0."""
    for j in range(len(guards)):
        guard, slack = guards[j], within * guards[j]
        n = 0
        if guard - guard == 0.0:  # finite
            for i in range(len(values)):
                n += 1 if abs(abs(values[i]) - guard) <= slack else 0
        found[j] = 1.0 if n > 0 else 0.0
