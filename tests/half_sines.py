"""A block under half sines of five frequencies at twenty amplitudes: a small suite for figures and pages."""

SUITE = {
    "name": "suite",
    "case": {
        "block": {"R": 2.0, "tan_alpha": 0.2},
        "motion": {"pulse": {"shape": "half_sine", "a_p": 1.0, "omega_p": 1.0}},
    },
    "over": "motion.pulse.omega_p",
    "vary": {
        "motion.pulse.omega_p": [2.0, 3.0, 4.0, 5.0, 6.0],
        "motion.pulse.a_p": {"from": "0.1*g", "to": "2*g", "n": 20},
    },
    "save": {"histories": False},
}
