"""Arithmetic of lanes: vectors compiled or plain, elementary functions, roots of polynomials."""

WIDTH = 16
"""Lanes of a vector: two registers of AVX-512 or four of AVX2, whose latencies overlap."""
