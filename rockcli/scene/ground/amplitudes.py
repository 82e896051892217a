"""Keys of a study that say how strong a motion is, or of which frequency: of each group a motion gives one."""

from __future__ import annotations

PULSE_AMPLITUDES = ("a_p", "a_p_over_g_tan_alpha", "A")
PULSE_FREQUENCIES = ("omega_p", "T_p", "f_p", "omega_p_over_p")
RECORD_SCALINGS = ("scale", "pga", "pgv", "sa", "pga_over_g_tan_alpha")
FLOOR_SCALINGS = ("floor_scale", "floor_pga")
"""Of what arrives above floors and isolators."""

AMPLITUDES = (*RECORD_SCALINGS, "a_p", "a_p_over_g_tan_alpha", *FLOOR_SCALINGS)
"""Last parts of the paths of axes that are an amplitude of the motion: A makes a pulse of its own at every value."""
