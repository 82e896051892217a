"""The first root of a guard against the zeros that numpy finds of the same polynomial."""

import numpy as np
import pytest

from rockcli.kernels.constants import NO_ROOT
from rockcli.kernels.rigid import roots

POLYNOMIALS = 800


def plain(function):
    return getattr(function, "py_func", function)


def polynomials(seed):
    """(coefficients, degree, end): positive at 0, sizes over fourteen decades, as just after an event."""
    rng = np.random.default_rng(seed)
    for _ in range(POLYNOMIALS):
        n = int(rng.integers(3, 9))
        c = np.zeros(n + 2)
        c[: n + 1] = rng.normal(size=n + 1) * 10.0 ** rng.uniform(-12.0, 2.0, size=n + 1)
        c[0] = abs(c[0])
        yield c, n, 10.0 ** rng.uniform(-3.0, 0.5)


@pytest.mark.parametrize("find", ["first_root", "uplift"])
def test_a_root_is_where_the_polynomial_ends_to_be_positive(find):
    """A search that hardly moves, as the curvature at the far end is large, took the place it had come to for one."""
    for c, n, h in polynomials(7):
        x = plain(roots.first_root)(c, n, h, 0) if find == "first_root" else plain(roots.uplift)(c, n, h, 1.0)
        P, noise = np.polynomial.Polynomial(c[: n + 1]), 1e-14 if find == "uplift" else 0.0
        zeros = P.roots()
        real = np.sort(zeros[(abs(zeros.imag) < 1e-9 * abs(zeros)) & (zeros.real > 0.0)].real)
        if x == NO_ROOT:
            size = np.abs(c[: n + 1] * h ** np.arange(n + 1)).max()
            first = real[real < h * (1.0 - 1e-6)][:1]
            assert all(P(z * (1.0 + 1e-6)) >= -1e-12 * size - noise for z in first)
        else:
            size = np.abs(c[: n + 1] * x ** np.arange(n + 1)).max()
            assert 0.0 <= x <= h
            assert P(x) <= 1e-7 * size + noise


def test_the_gap_of_a_body_that_leaves_slowly_has_no_root():
    """As of an edge that the ground leaves as it is weightless: its gap grows with the third power of time."""
    c = np.array([1.11e-16, 1.352e-10, 4.136e-4, 22.34, -179.3, -489.9, 0.0])
    assert plain(roots.first_root)(c, 5, 0.02529, 0) == NO_ROOT
    c[:3] = 1e-16, 1e-12, 4e-6
    c[4:] = -1e4, 0.0, 0.0
    assert plain(roots.first_root)(c, 5, 0.02529, 0) == pytest.approx(22.34e-4, rel=1e-4)
