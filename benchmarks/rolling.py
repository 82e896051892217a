"""Processor time of a body that rolls over eleven vertices (ten facets) beside the same base on two edges.

    python benchmarks/rolling.py

One process, kernels compiled and warm; outcome, peak and impacts of every case; writes benchmarks/results/rolling.csv.
"""

from __future__ import annotations

import csv
import time
from pathlib import Path

import numpy as np
from machine import machine

from rockcli import kernels
from rockcli.solvers.event.solver import solve
from rockcli.study.open import open_study

HERE = Path(__file__).resolve().parent
RESULTS = HERE / "results" / "rolling.csv"
N = 200

MOTIONS = {
    "pulses": ({"pulse": {"shape": "ricker", "a_p": "1*g", "T_p": 0.8}}, "motion.pulse.a_p"),
    "record": ({"record": {"file": str(HERE.parent / "records" / "synthetic_rock_m65.AT2"), "pga": "1*g"}}, "motion.record.pga"),
}  # fmt: skip


def outline():
    """A base of 0.3 m and facets that rise on an arc beside it, a top of 1 m."""
    tilts = np.deg2rad([0, 8, 16, 24, 32, 40])
    lengths = np.array([0.15, 0.06, 0.06, 0.06, 0.06, 0.03])
    x, z = np.cumsum(lengths * np.cos(tilts)), np.cumsum(lengths * np.sin(tilts))
    right = list(zip(x.tolist(), z.tolist(), strict=True))
    left = [(-a, b) for a, b in reversed(right[:-1])]
    top = float(x[-2]) - 0.05
    return [list(point) for point in ((-top, 1.0), *left, *right, (top, 1.0))]


def cost(stands, motion, axis):
    study = {
        "name": "a",
        "case": {"block": {"outline": outline(), "stands": stands}, "motion": motion},
        "vary": {axis: {"from": "0.1*g", "to": "1.5*g", "n": N}},
        "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha", "n_impacts"]},
    }
    ((_, batch),) = open_study(study).batches()
    facets = 1 if batch.block.vertices is None else batch.block.vertices.shape[1] - 1
    times = []
    for _ in range(4):  # the first compiles
        begun = time.process_time()
        response = solve(batch)
        times.append(time.process_time() - begun)
    fell = float((response.scalars["outcome"] >= 2).mean())
    return [facets, round(1e6 * min(times[1:]) / N, 1), round(fell, 3), int(response.scalars["n_impacts"].mean())]


def main():
    kernels.load(compile_them=True)
    head = ["motion", "stands", "facets", "us_per_case", "overturned", "mean_impacts", "machine"]
    rows = []
    for name, (motion, axis) in MOTIONS.items():
        for stands in ("outline", "toes"):
            rows.append([name, stands, *cost(stands, motion, axis), machine()])
            print(*rows[-1], flush=True)
    with RESULTS.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *rows])


if __name__ == "__main__":
    main()
