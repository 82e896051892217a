"""Rigid bodies that roll from vertex to vertex of a convex outline, event-driven (docs/rolling.md)."""
