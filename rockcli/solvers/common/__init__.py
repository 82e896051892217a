"""What solvers share: certainty, duration, the ground at output times, scalars of what was found, other programs."""
