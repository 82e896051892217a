"""What several solvers need: certainty of outcomes, time steps, other programs."""
