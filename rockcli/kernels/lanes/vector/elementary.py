"""Sines, cosines and exponentials written out as polynomials: fused multiply-adds only.

They take a float (a loop of them over lanes is vectorised by numba) or a vector of `kernels.lanes.vector.plain`, alike.
Nothing branches, so that what a lane gets does not depend on its neighbours.
"""

from __future__ import annotations

from math import factorial, pi

from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.vector.plain import fma

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


@jit
def sin_cos(x):
    """(sin x, cos x) for |x| <= pi/2, to 2e-16: their series to x^21 and x^22."""
    z = x * x
    y = z * z
    # even and odd powers of z apart: half the latency
    s = fma(
        z, fma(y, fma(y, fma(y, fma(y, S21, S17), S13), S9), S5), fma(y, fma(y, fma(y, fma(y, S19, S15), S11), S7), S3)
    )
    c = fma(y, fma(y, fma(y, fma(y, fma(y, C22, C18), C14), C10), C6), C2)
    c = fma(z, fma(y, fma(y, fma(y, fma(y, C20, C16), C12), C8), C4), c)
    return fma(x * z, s, x), fma(z, c, 1.0)


@jit
def sin_cos_of_any(x):
    """(sin x, cos x) for |x| < 1e8, to 2e-16 beside the rounding of x: reduced to |x| <= pi/2 first."""
    n = (x * ONE_OVER_PI + ROUND) - ROUND
    odd = n * 0.5 - ((n * 0.5 + ROUND) - ROUND)
    sign = 1.0 - 8.0 * odd * odd  # odd is 0 or +-1/2
    s, c = sin_cos(((x - n * PI_HIGH) - n * PI_LOW) - n * PI_REST)
    return sign * s, sign * c


@jit
def exp_of_negative(x):
    """exp(x) for -50 <= x <= 0, to 4e-16 absolute.

    exp(x/128) - 1 by its series to x^9, then seven times doubled as m (2 + m), which keeps the precision of m.
    """
    y = x * 0.0078125
    m = fma(y, fma(y, fma(y, fma(y, fma(y, fma(y, fma(y, E9, E8), E7), E6), E5), E4), E3), E2)
    m = fma(y * y, m, y)
    for _ in range(7):
        m = fma(m, m, m + m)
    return 1.0 + m
