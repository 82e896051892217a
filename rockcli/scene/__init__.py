"""What is solved: frozen values in SI units and radians, and the formulas that belong to them.

Nothing here knows YAML, files, plots or a solution method.  Numbers come as arrays over the
`n` cases of a batch (structure of arrays); one case is a batch of one.
"""
