"""Sine and cosine of lanes."""

from __future__ import annotations

from rockcli.kernels.jit import jit_lean
from rockcli.kernels.lanes.vector.elementary import (
    C2,
    C4,
    C6,
    C8,
    C10,
    C12,
    C14,
    C16,
    C18,
    C20,
    C22,
    S3,
    S5,
    S7,
    S9,
    S11,
    S13,
    S15,
    S17,
    S19,
    S21,
)
from rockcli.kernels.lanes.vector.fused import fma


@jit_lean
def sin_cos(x):
    """`elementary.sin_cos` with fused multiply-adds."""
    z = x * x
    y = z * z
    # even and odd powers of z apart: half the latency
    s = fma(
        z, fma(y, fma(y, fma(y, fma(y, S21, S17), S13), S9), S5), fma(y, fma(y, fma(y, fma(y, S19, S15), S11), S7), S3)
    )
    c = fma(y, fma(y, fma(y, fma(y, fma(y, C22, C18), C14), C10), C6), C2)
    c = fma(z, fma(y, fma(y, fma(y, fma(y, C20, C16), C12), C8), C4), c)
    return fma(x * z, s, x), fma(z, c, 1.0)
