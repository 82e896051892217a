"""The law of a rocking body (docs/theory.md, T2), written once for floats, vectors of lanes and arrays.

    q'' = -p^2 [ (1 + a_v/g) (r0 + rs sin q + rc cos q) + s (a_g/g) (fc cos q + fs sin q) ]

Linear bodies take q for `sine` and 1 for `cosine`.  Kernels compile these functions (`rigid.law`); others call them as
they are.  The backend `scipy` and the reference of the tests, which are there to disagree, have their own.
"""

from __future__ import annotations

from typing import Any


def restoring(r0: Any, rs: Any, rc: Any, sine: Any, cosine: Any) -> Any:
    """Restoring moment over I_O p^2."""
    return r0 + rs * sine + rc * cosine


def driving(fc: Any, fs: Any, sine: Any, cosine: Any) -> Any:
    """Moment of the ground over I_O p^2 for s a_g = g."""
    return fc * cosine + fs * sine


def pull(weight: Any, restoring_moment: Any, drive: Any, driving_moment: Any) -> Any:
    """-q''/p^2 without a damper: `weight` 1 + a_v/g, `drive` s a_g/g."""
    return weight * restoring_moment + drive * driving_moment


def potential(r0: Any, rc: Any, q: Any, bent: Any, sine: Any) -> Any:
    """Integral of the restoring moment from 0 to q.

    `bent` is rs (1 - cos q), linear rs q^2/2, which each caller knows in its own best way.
    """
    return r0 * q + bent + rc * sine
