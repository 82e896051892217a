"""How fast this machine is beside the one on which costs were measured: a few milliseconds of fixed work."""

from __future__ import annotations

from statistics import mean
from time import process_time

import numpy as np

REFERENCE = 1.0e-3
"""Processor time of the fixed work that costs are told for [s]."""

TURNS = 30


def slowness() -> float:
    """Processor time that work takes here, over that on a machine with REFERENCE; the mean of some turns."""
    values = np.linspace(0.0, 1.0, 4096)
    _work(values)
    return mean(_work(values) for _ in range(TURNS)) / REFERENCE


def _work(values: np.ndarray) -> float:
    """Processor time of arithmetic number by number and by arrays [s]."""
    began = process_time()
    x = 0.5
    for _ in range(8000):
        x = 3.7 * x * (1.0 - x)
    for _ in range(8):
        values = np.sqrt(values * values + 1.0) - 0.5 * np.sin(values)
    return process_time() - began
