"""Where a number stands in the vector of results of the contact kernel."""

from __future__ import annotations

(
    STATUS, VERDICT, PEAK, PEAK_SIDE, PEAK_LEFT, PEAK_RIGHT, T_PEAK, RATE_PEAK, TOP_PEAK, T_UPLIFT, T_OVERTURN, T_REST,
    T_END, N_IMPACTS, SLIDE_PEAK, SLIDE_END, T_SLIP, T_SLIDE_ROCK, T_FLIGHT, N_SLIPS, N_FLIGHTS, N_JAMS, MU, MU_IMPACT,
    N_MIN, BALANCE, GAIN, N_STEPS, N_EVENTS, IMPACTS_STORED, NEARLY_FLAT, TWO_WAYS, SWINGS, SWINGS_T, STRUCK_LATER,
    SLIDE_STANDING, N_STANDING, SLIP_LEFT, N_OUT,
) = range(39)  # fmt: skip
"""STATUS how the run ended; VERDICT what became of the body; PEAK |theta| at its earliest maximum, PEAK_SIDE its sign,
PEAK_LEFT, PEAK_RIGHT by side [rad]; RATE_PEAK; TOP_PEAK largest displacement of the top [m]; times [s], NaN for what
did not happen; SLIDE_PEAK with its sign, SLIDE_END [m]; N_SLIPS, N_FLIGHTS, N_JAMS how often it began to slip, left the
ground, jammed; MU friction needed, MU_IMPACT at landings; N_MIN smallest normal force over m g; BALANCE energy not
accounted for, NaN if not asked for, GAIN the largest an impact gained [J/kg]; NEARLY_FLAT least |theta|/alpha at which
it came down from flight; TWO_WAYS how often slip and flight were both consistent; SWINGS what impacts carry, SWINGS_T
the same times their time; STRUCK_LATER 1 if it comes down on an edge beyond the report;
SLIDE_STANDING largest |slide|, N_STANDING N_MIN up to the last outward passage of the equilibrium; SLIP_LEFT the
slip velocity of a body that slips while it rocks where it is not followed any more [m/s], else 0; the length."""
