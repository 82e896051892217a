"""Errors by which model auto chooses, and the range they were measured over (docs/auto.md).

Written by benchmarks/calibrate_auto.py from 3942 random scenes under pulses and
1499 under synthetic records (seed 1); its counts are in benchmarks/results/calibrate_auto.csv.
"""

from __future__ import annotations

from math import inf

EXCEEDED = 3.0
"""Share of the measured scenes of a bin whose error was larger [%]."""

TRIED: dict[str, tuple[float, float]] = {
    "alpha": (0.03, 0.4636476),
    "eta": (0.7, 1.0),
    "amplitude": (0.15, 10.0),
    "rate": (0.5, 30.0),
    "p_T1": (0.001, 1.0),
    "zeta": (0.0, 0.1),
    "opening": (1e-07, 0.05),
}
"""Groups: the range of the scenes."""

TABLES: dict[str, tuple[tuple[float, ...], dict[str, tuple[tuple[float, ...], ...]]]] = {
    "linearized": (
        (0.03, 0.05, 0.08, 0.12, 0.18, 0.26, 0.4636476),
        {
            "pulse": (
                (0.0027, 0.0014, 0.0055, 0),
                (0.0027, 0.0106, inf, 0),
                (0.0027, 0.0106, inf, 0),
                (0.0044, 0.0224, inf, 0),
                (0.0175, 0.1992, inf, 0),
                (0.0443, 0.1992, inf, inf),
            ),
            "record": (
                (0.05, 0.2256, inf, 0),
                (0.0698, 0.2256, inf, inf),
                (0.0698, 0.2256, inf, inf),
                (0.0698, 0.2256, inf, inf),
                (0.169, inf, inf, inf),
                (0.169, inf, inf, inf),
            ),
        },
    ),
    "rigid": (
        (0.001, 0.01, 0.03, 0.06, 0.12, 0.25, 0.5, 1.0),
        {
            "pulse": (
                (0.0001, 0.0033, 0.0031, 0.009, 0.0475, inf, 0),
                (0.0001, 0.0033, 0.0099, 0.0494, inf, inf, 0),
                (0.0001, 0.0033, 0.0157, inf, inf, inf, 0),
                (0.0002, 0.0046, 0.0278, inf, inf, inf, 0),
                (0.0012, 0.0146, 0.0464, inf, inf, inf, 0),
                (0.0111, 0.0345, 0.0464, inf, inf, inf, 0),
                (0.0213, 0.1018, 0.148, inf, inf, inf, 0),
            ),
            "record": (
                (0, 0.0159, 0.0353, 0.1007, 0.3754, inf, 0),
                (0, 0.0366, 0.0353, 0.1007, inf, inf, 0),
                (0.0001, 0.0384, 0.0353, inf, inf, inf, 0),
                (0.0002, 0.0602, 0.2074, inf, inf, inf, 0),
                (0.0027, 0.0602, 0.4525, inf, inf, inf, 0),
                (0.0073, 0.0795, inf, inf, inf, inf, inf),
                (0.0688, 0.4011, inf, inf, inf, inf, inf),
            ),
        },
    ),
    "flexible": (
        (1e-07, 1e-06, 1e-05, 0.0001, 0.001, 0.01, 0.05),
        {
            "pulse": (
                (0.0003, 0.0058, inf, inf, inf, inf, 0),
                (0.001, 0.0058, inf, inf, inf, inf, inf),
                (0.0048, 0.0165, inf, inf, inf, inf, inf),
                (0.0141, 0.0408, inf, inf, inf, inf, inf),
                (0.2374, 0.9308, inf, inf, inf, inf, inf),
                (inf, inf, inf, inf, inf, inf, inf),
            ),
            "record": (
                (0.0008, 0.0134, inf, inf, inf, inf, 0),
                (0.0024, inf, inf, inf, inf, inf, inf),
                (0.029, inf, inf, inf, inf, inf, inf),
                (0.0482, inf, inf, inf, inf, inf, inf),
                (inf, inf, inf, inf, inf, inf, inf),
                (inf, inf, inf, inf, inf, inf, inf),
            ),
        },
    ),
}
"""Step (linearized against rigid, rigid against flexible, flexible against winkler): edges of the rows (alpha, p T_1,
m g/(2 kw b^2 alpha)) and, for either kind of motion, the error of theta_peak/alpha by row and by class of what the
cheap model does (scene/auto.py)."""
