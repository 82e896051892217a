"""The motion of the ground: what solvers integrate over, pulses, design spectra, hazard."""
