"""Planar contact by time stepping (Moreau 1988, Jean 1999), written apart from the program: no events, no modes, no series.

A step of length h takes the velocity to where impulses at the edges that touch, complementary to their velocities and
inside Coulomb's cone, put it; which edges push, stick or slip is found by trying all sixteen ways.  First order.
"""

from __future__ import annotations

import numpy as np
from numba import njit

OPEN, STICK, SLIP_RIGHT, SLIP_LEFT = range(4)


@njit(cache=True)
def solve(A, b, n):
    """Gauss elimination with pivoting; False where the matrix is singular."""
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(A[i, k]) > abs(A[pivot, k]):
                pivot = i
        if abs(A[pivot, k]) < 1e-12:
            return False
        for j in range(n):
            A[k, j], A[pivot, j] = A[pivot, j], A[k, j]
        b[k], b[pivot] = b[pivot], b[k]
        for i in range(k + 1, n):
            f = A[i, k] / A[k, k]
            for j in range(k, n):
                A[i, j] -= f * A[k, j]
            b[i] -= f * b[k]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            b[k] -= A[k, j] * b[j]
        b[k] /= A[k, k]
    return True


@njit(cache=True)
def steps(b_left, b_right, h, r_g2, mu, places, theta, a_g, W, dt, t_end, found):
    """March to t_end or until the body lies on its side; `a_g`, `W` at the middles of the steps, still beyond them.

    `places`: where the impulse of a landing on the left and on the right edge acts (b: at the edge).  found: largest
    |theta|, largest |slide|, last slide, 1 if it overturned.
    """
    b = np.array([-b_left, b_right])
    c, d = np.zeros(2), np.zeros(2)
    v, q, free, new, best = np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3)
    normal, force, along = np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 3))
    inverse = np.array([1.0, 1.0, 1.0 / r_g2])
    q[2] = theta
    side = 1 if theta > 0.0 else 0
    q[1] = b[side] * np.sin(theta) + h * np.cos(theta)
    q[0] = b[side] * (1.0 - np.cos(theta)) + h * np.sin(theta)
    touched = np.zeros(2, dtype=np.bool_)
    if theta != 0.0:
        touched[side] = True
    else:
        touched[:] = True
    A, rhs = np.zeros((4, 4)), np.zeros(4)
    n = int(t_end / dt)
    for step in range(n):
        ground, weight = (a_g[step], W[step]) if step < len(a_g) else (0.0, W[-1])
        for k in range(3):
            q[k] += 0.5 * dt * v[k]
        free[0], free[1], free[2] = v[0] - dt * ground, v[1] - dt * weight, v[2]
        sin_t, cos_t = np.sin(q[2]), np.cos(q[2])
        active = np.zeros(2, dtype=np.bool_)
        for i in range(2):
            c[i], d[i] = b[i] * cos_t - h * sin_t, -b[i] * sin_t - h * cos_t
            active[i] = q[1] + d[i] <= 0.0
        for i in range(2):
            normal[i] = np.array([0.0, 1.0, -c[i]])
            along[i] = np.array([1.0, 0.0, d[i]])
            force[i] = normal[i]
            if active[i] and not touched[i] and touched[1 - i]:  # a landing: the resultant acts inside the base
                force[i, 2] = places[i] if i == 0 else -places[i]
        least, known = np.inf, False
        for one in range(4):
            for two in range(4):
                if (one != OPEN and not active[0]) or (two != OPEN and not active[1]):
                    continue
                ways = (one, two)
                m = 0
                cols = np.zeros((4, 3))  # generalised impulses of the unknowns
                rows = np.zeros((4, 3))  # velocities that vanish
                for i in range(2):
                    if ways[i] == OPEN:
                        continue
                    rows[m] = normal[i]
                    if ways[i] == STICK:
                        cols[m] = force[i]
                        cols[m + 1], rows[m + 1] = along[i], along[i]
                        m += 2
                    else:
                        sign = 1.0 if ways[i] == SLIP_RIGHT else -1.0
                        cols[m] = force[i] - sign * mu * along[i]
                        m += 1
                for i in range(m):
                    rhs[i] = 0.0
                    for k in range(3):
                        rhs[i] -= rows[i, k] * free[k]
                    for j in range(m):
                        A[i, j] = 0.0
                        for k in range(3):
                            A[i, j] += rows[i, k] * inverse[k] * cols[j, k]
                if m == 4:  # both feet stick: four conditions on three velocities
                    for i in range(m):
                        A[i, i] += 1e-10
                if m > 0 and not solve(A, rhs, m):
                    continue
                for k in range(3):
                    new[k] = free[k]
                    for j in range(m):
                        new[k] += inverse[k] * cols[j, k] * rhs[j]
                wrong, m = 0.0, 0
                for i in range(2):
                    v_n, v_t = 0.0, 0.0
                    for k in range(3):
                        v_n += normal[i, k] * new[k]
                        v_t += along[i, k] * new[k]
                    if ways[i] == OPEN:
                        wrong += max(-v_n, 0.0) if active[i] else 0.0
                    elif ways[i] == STICK:
                        wrong += max(-rhs[m], 0.0) + max(abs(rhs[m + 1]) - mu * rhs[m], 0.0)
                        m += 2
                    else:
                        wrong += max(-rhs[m], 0.0)
                        wrong += max(-v_t, 0.0) if ways[i] == SLIP_RIGHT else max(v_t, 0.0)
                        m += 1
                if wrong < least * 0.999 - 1e-15 or not known:
                    least, known = wrong, True
                    best[:] = new
        v[:] = best
        touched[:] = active
        for k in range(3):
            q[k] += 0.5 * dt * v[k]
        side = 1 if q[2] > 0.0 else 0
        slide = q[0] + b[side] * (np.cos(q[2]) - 1.0) - h * np.sin(q[2])
        found[0] = max(found[0], abs(q[2]))
        found[1] = max(found[1], abs(slide))
        found[2] = slide
        if abs(q[2]) >= 0.5 * np.pi:
            found[3] = 1.0
            return
