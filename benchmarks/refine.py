"""Refined maps beside the same maps solved in full: processor time, cases solved, pixels told wrongly.

    python benchmarks/refine.py [SIDE]

Outcomes alone, SIDE x SIDE pixels (4000), both ways in turn in one process with kernels loaded, no files written; of
the refined one the least of ROUNDS.  Writes results/refine.csv.
"""

from __future__ import annotations

import csv
import sys
import time
from pathlib import Path

import numpy as np
from machine import machine

from rockcli import kernels
from rockcli.engine.sweep.refine import solve_refined
from rockcli.engine.sweep.sweep import solve_cases
from rockcli.study.open import open_study

HERE = Path(__file__).resolve().parent
RESULTS = HERE / "results" / "refine.csv"
ROUNDS = 3

PULSES = {
    "motion.pulse.omega_p_over_p": {"from": 0.1, "to": 10},
    "motion.pulse.a_p_over_g_tan_alpha": {"from": 1, "to": 10.9},
}
RECORDED = {"block.R": {"from": 0.5, "to": 10}, "motion.record.pga_over_g_tan_alpha": {"from": 1, "to": 4}}
RECORD = {"record": {"file": str(HERE.parent / "records" / "synthetic_pulse_m70.AT2"), "pga_over_g_tan_alpha": 2}}


def pulse(shape):
    return {"pulse": {"shape": shape, "omega_p_over_p": 2, "a_p_over_g_tan_alpha": 2}}


MAPS = {
    "Ricker": (pulse("ricker"), PULSES, 1),
    "one sine": (pulse("sine"), PULSES, 1),
    "record synthetic_pulse_m70": (RECORD, RECORDED, 10),
}
"""Motion, axes, and by what the side is divided: to solve a map under a record takes too long else."""


def study(motion, axes, side, *, refine):
    case = {"block": {"R": 1, "tan_alpha": 0.2}, "motion": motion}
    vary = {name: {**span, "n": side} for name, span in axes.items()}
    save = {"histories": False, "scalars": ["outcome"]}
    return open_study({"name": "a", "case": case, "vary": vary, "save": save, "refine": refine})


def timed(solve, opened):
    """Results of a study, and the processor time they took [s]."""
    begun = time.process_time()
    results = solve(opened)
    return results, time.process_time() - begun


def main():
    kernels.load(compile_them=True)
    whole = int(sys.argv[1]) if sys.argv[1:] else 4000
    head = ["map", "side", "refined_s", "full_s", "ratio_percent", "solved_percent", "wrong", "machine"]
    rows = []
    for name, (motion, axes, over) in MAPS.items():
        side = whole // over
        solve_refined(study(motion, axes, 120, refine=True))  # loads the kernels
        runs = [timed(solve_refined, study(motion, axes, side, refine=True)) for _ in range(ROUNDS)]
        full, full_s = timed(solve_cases, study(motion, axes, side, refine=False))
        refined, refined_s = min(runs, key=lambda run: run[1])
        wrong = float(np.mean(refined.scalars["outcome"] != full.scalars["outcome"]))
        solved = 100.0 * float(np.mean(refined.solved))
        share = 100.0 * refined_s / full_s
        rows.append(
            [
                name,
                side,
                f"{refined_s:.2f}",
                f"{full_s:.1f}",
                f"{share:.2f}",
                f"{solved:.2f}",
                f"{wrong:.1e}",
                machine(),
            ]
        )
        print(*rows[-1], flush=True)
    with RESULTS.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *rows])


if __name__ == "__main__":
    main()
