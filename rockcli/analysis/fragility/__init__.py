"""Fragility curves: fitted to what became of members of suites, judged, and convolved with hazard."""
