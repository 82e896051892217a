"""Sines, cosines and exponentials written out as polynomials: additions and multiplications only.

They take a float (a loop of them over lanes is vectorised by numba) or a vector of `kernels.lanes.vector.plain`, alike.
Nothing branches, so that what a lane gets does not depend on its neighbours.
"""

from __future__ import annotations

from math import factorial, pi

from rockcli.kernels.jit import jit_lean

S3, S5, S7, S9, S11, S13, S15, S17, S19, S21 = ((-1.0) ** (k // 2) / factorial(k) for k in range(3, 22, 2))
C2, C4, C6, C8, C10, C12, C14, C16, C18, C20, C22 = ((-1.0) ** (k // 2) / factorial(k) for k in range(2, 23, 2))
E2, E3, E4, E5, E6, E7, E8, E9 = (1.0 / factorial(k) for k in range(2, 10))

ROUND = 6755399441055744.0
"""1.5 * 2^52: adding and subtracting it rounds a number below 2^51 to the nearest integer."""

ONE_OVER_PI = 1.0 / pi
PI_HIGH = 3.1415926218032837
"""pi to 27 bits: its product with an integer below 2^26 is exact."""
PI_LOW = pi - PI_HIGH
PI_REST = 1.2246467991473532e-16
"""What a double leaves of pi."""


@jit_lean
def sin_cos(x):
    """(sin x, cos x) for |x| <= pi/2, to 2e-16: their series to x^21 and x^22."""
    z = x * x
    s = S13 + z * (S15 + z * (S17 + z * (S19 + z * S21)))
    s = x + x * (z * (S3 + z * (S5 + z * (S7 + z * (S9 + z * (S11 + z * s))))))
    c = C14 + z * (C16 + z * (C18 + z * (C20 + z * C22)))
    c = 1.0 + z * (C2 + z * (C4 + z * (C6 + z * (C8 + z * (C10 + z * (C12 + z * c))))))
    return s, c


@jit_lean
def sin_cos_of_any(x):
    """(sin x, cos x) for |x| < 1e8, to 2e-16 beside the rounding of x: reduced to |x| <= pi/2 first."""
    n = (x * ONE_OVER_PI + ROUND) - ROUND
    odd = n * 0.5 - ((n * 0.5 + ROUND) - ROUND)
    sign = 1.0 - 8.0 * odd * odd  # odd is 0 or +-1/2
    s, c = sin_cos(((x - n * PI_HIGH) - n * PI_LOW) - n * PI_REST)
    return sign * s, sign * c


@jit_lean
def exp_of_negative(x):
    """exp(x) for -50 <= x <= 0, to 4e-16 absolute.

    exp(x/128) - 1 by its series to x^9, then seven times doubled as m (2 + m), which keeps the precision of m.
    """
    y = x * 0.0078125
    m = y + y * y * (E2 + y * (E3 + y * (E4 + y * (E5 + y * (E6 + y * (E7 + y * (E8 + y * E9)))))))
    for _ in range(7):
        m = m * (2.0 + m)
    return 1.0 + m
