"""Refined maps beside the same maps solved in full: processor time, cases solved, pixels told wrongly.

    python benchmarks/refine.py [SIDE [FOLDER]]

Outcomes alone, SIDE x SIDE pixels (4000), both ways in turn in one process with kernels loaded, no files written; of
the refined one under a pulse the least of ROUNDS.  Recorded motions are sought in FOLDER.  Writes results/refine.csv.
`beside_percent` is the share of the pixels that have one of another outcome among the eight around them: what any way
of solving both sides of all boundaries costs.  Of `drawn` pixels, drawn at random, `drawn_wrong` were filled in wrongly.
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
OURS = HERE.parent / "records"
RECORDS = ("synthetic_pulse_m70", "synthetic_rock_m65", "P695FF03_NORTHR_LOS000", "RSN1086_NORTHR_SYL360")
"""Two of the repository, and recorded motions: Lost Canyon in Northridge, and one near its fault with a pulse."""


def pulse(shape):
    return {"pulse": {"shape": shape, "omega_p_over_p": 2, "a_p_over_g_tan_alpha": 2}}


def maps(folder):
    """Name, motion and axes of every map, and how often it is refined."""
    for name, shape in (("Ricker", "ricker"), ("one sine", "sine")):
        yield name, pulse(shape), PULSES, ROUNDS
    for name in RECORDS:
        for file in [*OURS.glob(f"{name}.AT2"), *(folder.rglob(f"{name}.AT2") if folder else ())][:1]:
            yield f"record {name}", {"record": {"file": str(file), "pga_over_g_tan_alpha": 2}}, RECORDED, 1


def beside(outcome):
    """Share of the pixels of a map of which one of the eight around has another outcome [%]."""
    found = np.zeros(outcome.shape, dtype=bool)
    for here, there in (
        ((slice(1, None), slice(None)), (slice(None, -1), slice(None))),
        ((slice(None), slice(1, None)), (slice(None), slice(None, -1))),
        ((slice(1, None), slice(1, None)), (slice(None, -1), slice(None, -1))),
        ((slice(1, None), slice(None, -1)), (slice(None, -1), slice(1, None))),
    ):
        differ = outcome[here] != outcome[there]
        found[here] |= differ
        found[there] |= differ
    return 100.0 * float(found.mean())


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
    side = int(sys.argv[1]) if sys.argv[1:] else 4000
    head = ["map", "side", "refined_s", "full_s", "ratio_percent", "solved_percent", "beside_percent"]
    rows = [[*head, "wrong", "drawn", "drawn_wrong", "machine"]]
    print(*rows[0], flush=True)
    for name, motion, axes, rounds in maps(Path(sys.argv[2]) if sys.argv[2:] else None):
        solve_refined(study(motion, axes, 120, refine=True))  # loads the kernels
        runs = [timed(solve_refined, study(motion, axes, side, refine=True)) for _ in range(rounds)]
        full, full_s = timed(solve_cases, study(motion, axes, side, refine=False))
        refined, refined_s = min(runs, key=lambda run: run[1])
        outcome = full.scalars["outcome"]
        told = [f"{refined_s:.2f}", f"{full_s:.1f}", f"{100.0 * refined_s / full_s:.2f}"]
        told += [f"{100.0 * np.mean(refined.solved):.2f}", f"{beside(outcome.reshape(side, side)):.2f}"]
        told += [f"{np.mean(refined.scalars['outcome'] != outcome):.1e}", *map(str, refined.probes)]
        rows.append([name, side, *told, machine()])
        print(*rows[-1], flush=True)
    with RESULTS.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


if __name__ == "__main__":
    main()
