"""The deformable rocking column, event-driven and modal (docs/flexible.md)."""

from __future__ import annotations

from rockcli.solvers.flexible.solver import solve

__all__ = ["solve"]
