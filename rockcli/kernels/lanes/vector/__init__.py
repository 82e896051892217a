"""Arithmetic of lanes: vectors compiled or plain, elementary functions, roots of polynomials."""
