"""The full mesh of the rocking body, solved by CalculiX in a process of its own (docs/calculix.md)."""

from __future__ import annotations

from rockcli.solvers.calculix.solver import solve

__all__ = ["solve"]
