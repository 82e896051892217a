"""Symmetric banded matrices: row i holds A[i, i], A[i, i-1], ..., A[i, i-5] (three freedoms per node, two nodes)."""

from __future__ import annotations

from rockcli.kernels.frame import layout as at
from rockcli.kernels.jit import jit


@jit
def clear(x):
    """Set a vector to zero: a loop compiles in a fraction of the time of a slice."""
    for i in range(len(x)):
        x[i] = 0.0


@jit
def clear_band(A):
    """Set a banded matrix to zero."""
    for i in range(len(A)):
        for k in range(at.BAND):
            A[i, k] = 0.0


@jit
def copy(x, y):
    """Write x into y."""
    for i in range(len(x)):
        y[i] = x[i]


@jit
def times(A, x, y):
    """Write y = A x."""
    n = len(x)
    for i in range(n):
        y[i] = A[i, 0] * x[i]
    for i in range(n):
        for k in range(1, min(i, at.BAND - 1) + 1):
            y[i] += A[i, k] * x[i - k]
            y[i - k] += A[i, k] * x[i]


@jit
def solve(A, x):
    """Overwrite A by its factors L D L^T and x by A^-1 x; True unless a pivot is zero or not a number."""
    n = len(x)
    for i in range(n):
        low = max(0, i - at.BAND + 1)
        for j in range(low, i):
            total = A[i, i - j]
            for k in range(max(low, j - at.BAND + 1), j):
                total -= A[i, i - k] * A[j, j - k]
            A[i, i - j] = total  # L[i, j] D[j] so far
        pivot = A[i, 0]
        for j in range(low, i):
            scaled = A[i, i - j] / A[j, 0]
            pivot -= scaled * A[i, i - j]
            A[i, i - j] = scaled
        if not abs(pivot) > 0.0:
            return False
        A[i, 0] = pivot
        for j in range(low, i):
            x[i] -= A[i, i - j] * x[j]
    for i in range(n):
        x[i] /= A[i, 0]
    for i in range(n - 1, -1, -1):
        for j in range(max(0, i - at.BAND + 1), i):
            x[j] -= A[i, i - j] * x[i]
    return True


@jit
def hold(A, x, i):
    """Keep freedom i where it is: its row and column become those of the unit matrix, x[i] zero."""
    for k in range(1, at.BAND):
        if i - k >= 0:
            A[i, k] = 0.0
        if i + k < len(x):
            A[i + k, k] = 0.0
    A[i, 0] = 1.0
    x[i] = 0.0
