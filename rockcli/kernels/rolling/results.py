"""Where a number stands in the vector of results of the kernel of a rolling body, after those of `kernels.rigid`."""

from __future__ import annotations

from rockcli.kernels.rigid.results import N_OUT as OF_RIGID

MU_IMPACT, FACET, N_OUT = range(OF_RIGID, OF_RIGID + 3)
"""Largest ratio of the impulses at a counted impact; index of the facet on which the body comes to rest, or -1; the
length.  What `kernels.rigid.results` names stands where it does there; theta is counted from the stand."""
