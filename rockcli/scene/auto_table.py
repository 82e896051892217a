"""Errors by which model auto chooses, and the range they were measured over (docs/auto.md).

Written by benchmarks/calibrate_auto.py from 1975 random scenes under pulses and
3995 under synthetic records (seed 1); its counts are in benchmarks/results/calibrate_auto.csv.
"""

from __future__ import annotations

from math import inf

EXCEEDED = 2.5
"""Chance that a further scene of a bin has a larger error than TABLES says [%]."""

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
    "rigid": (
        (0.001, 0.01, 0.03, 0.1, 0.3, 1),
        {
            "pulse": (
                (0.0001, 0.0034, inf, inf, inf, inf, 0),
                (0.0001, 0.0034, inf, inf, inf, inf, 0),
                (0.0001, 0.0079, inf, inf, inf, inf, 0),
                (0.0035, 0.0241, inf, inf, inf, inf, 0),
                (0.0342, 0.0962, inf, inf, inf, inf, inf),
            ),
            "record": (
                (0, 0.0219, 0.104, 0.0946, inf, inf, 0),
                (0, 0.0219, 0.104, 0.1026, inf, inf, inf),
                (0.0002, 0.0529, 0.104, 0.1382, inf, inf, inf),
                (0.0069, 0.0644, 0.2379, inf, inf, inf, inf),
                (0.032, 0.8322, 0.2745, inf, inf, inf, inf),
            ),
        },
    ),
    "flexible": (
        (1e-07, 1e-05, 0.0001, 0.001, 0.05),
        {
            "pulse": (
                (0.0006, 0.0167, inf, inf, inf, inf, 0),
                (0.0054, inf, inf, inf, inf, inf, 0),
                (inf, inf, inf, inf, inf, inf, inf),
                (inf, inf, inf, inf, inf, inf, inf),
            ),
            "record": (
                (0.0017, 0.1363, inf, 0.3743, inf, inf, 0.0013),
                (0.0155, 0.1837, inf, inf, inf, inf, inf),
                (0.0815, 0.532, inf, inf, inf, inf, inf),
                (inf, inf, inf, inf, inf, inf, inf),
            ),
        },
    ),
}
"""Step (rigid against flexible, flexible against winkler): edges of the rows (p T_1, m g/(2 kw b^2 alpha)) and, for
either kind of motion, the error of theta_peak/alpha by row and class of what the rigid block does (scene/auto.py)."""

CHANCES: tuple[tuple[float, ...], dict[str, tuple[tuple[float, ...], ...]]] = (
    (0, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.2, 2, 4, inf),
    {
        "pulse": (
            (0, 1, 0, 0, 0, 0, 0),
            (0, 0.98, 0.02, 0, 0, 0, 0),
            (0, 0.92, 0.08, 0, 0, 0, 0),
            (0, 0.68, 0.21, 0.12, 0, 0, 0),
            (0, 0.52, 0.3, 0.16, 0.02, 0, 0),
            (0, 0.38, 0.33, 0.11, 0.03, 0.08, 0.07),
            (0, 0.19, 0.12, 0.19, 0.05, 0.12, 0.33),
            (0, 0.03, 0.09, 0.08, 0.04, 0.13, 0.62),
            (0, 0, 0, 0.02, 0.02, 0.05, 0.91),
            (0, 0, 0, 0, 0, 0, 1),
        ),
        "record": (
            (0, 0.86, 0.1, 0.04, 0, 0, 0),
            (0, 0.63, 0.21, 0.13, 0.03, 0, 0),
            (0, 0.43, 0.26, 0.21, 0.1, 0, 0),
            (0, 0.28, 0.3, 0.23, 0.19, 0.01, 0),
            (0, 0.2, 0.19, 0.26, 0.24, 0.09, 0.03),
            (0, 0.1, 0.12, 0.17, 0.2, 0.28, 0.14),
            (0, 0.03, 0.05, 0.08, 0.09, 0.26, 0.49),
            (0, 0.01, 0, 0.05, 0.02, 0.1, 0.82),
            (0, 0, 0, 0, 0, 0.02, 0.97),
            (0, 0, 0, 0, 0, 0, 1),
        ),
    },
)
"""Edges of the rows of amplitude/rate = PGV p/(g tan alpha), and, for either kind of motion, the share of the scenes
that move in which the rigid block does what each class says, by row and class."""
