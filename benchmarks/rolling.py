"""Processor time of a body that rolls over eleven vertices (ten facets) beside the same base on two edges.

    python benchmarks/rolling.py

One process, kernels compiled and warm; the bodies take turns, 21 rounds.  `toes` is the base of the same outline, whose
two edges differ, `block` the plain block of that size.  Writes benchmarks/results/rolling.csv.
"""

from __future__ import annotations

import csv
import json
import tempfile
import time
from pathlib import Path

import many_records
import numpy as np
from machine import machine

import rockcli
from rockcli import kernels
from rockcli.solvers.event.solver import solve
from rockcli.study.open import open_study

HERE = Path(__file__).resolve().parent
RESULTS = HERE / "results" / "rolling.csv"
CASES = (200, 4000)
ROUNDS = 21

ASKED = {
    "outcome": ["outcome"],
    "outcome, peak, impacts": ["outcome", "theta_peak_over_alpha", "n_impacts"],
    "default": "all",
}

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


def block(kind):
    """The body of a row: rolling, on the same base alone, or the plain block of that size, alike on both sides."""
    if kind != "block":
        return {"outline": outline(), "stands": kind}
    case = {"block": block("toes"), "motion": MOTIONS["pulses"][0]}
    ((_, batch),) = open_study({"name": "a", "case": case}).batches()
    return {"R": float(batch.block.R.mean()), "alpha": float(batch.block.alpha.mean())}


def opened(kind, motion, axis, n, scalars):
    study = {
        "name": "a",
        "case": {"block": block(kind), "motion": motion},
        "vary": {axis: {"from": "0.1*g", "to": "1.5*g", "n": n}},
        "save": {"histories": False, "scalars": scalars},
    }
    ((_, batch),) = open_study(study).batches()
    return batch


def costs(motion, axis, n, scalars):
    """By body: facets, least time a case [us], its median over that of the toes beside it, part that fell, impacts."""
    batches = {kind: opened(kind, motion, axis, n, scalars) for kind in ("outline", "toes", "block")}
    responses = {kind: solve(batch) for kind, batch in batches.items()}  # compiles
    rounds = np.array([[seconds(batch) for batch in batches.values()] for _ in range(ROUNDS)])
    least, over = 1e6 * rounds.min(axis=0) / n, np.median(rounds / rounds[:, 1:2], axis=0)
    found = {}
    for j, (kind, batch) in enumerate(batches.items()):
        facets = 1 if batch.block.vertices is None else batch.block.vertices.shape[1] - 1
        told = responses[kind].scalars
        found[kind] = facets, least[j], over[j], (told["outcome"] >= 2).mean(), int(told["n_impacts"].mean())
    return found


def seconds(batch):
    begun = time.process_time()
    solve(batch)
    return time.process_time() - begun


def of_many_records():
    """Rows of 490 records of 4000 to 8000 samples under 22 amplitudes: processor time of whole commands with two workers,
    and wall time of the same in a running Python, one process, files read anew.
    """
    cases, found = 22 * many_records.FEWER, []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "some").mkdir()
        many_records.make(folder / "some", many_records.FEWER)
        study = folder / "study.yaml"
        axes, saved = many_records.AMPLITUDES, many_records.SAVED["outcome, peak"]
        for kind, facets in (("outline", 10), ("toes", 1), ("block", 1)):
            study.write_text(
                f"name: many\ncase:\n  block: {json.dumps(block(kind))}\n"
                "  motion: {record: {file: some/r0000.AT2, pga: 1*g}}\n"
                f'vary:\n  motion.record.file: "some/*.AT2"\n  {axes}\n{saved}\n'
            )
            seconds = min(many_records.measured(study, workers=2)[1] for _ in range(3))
            found.append(("490 records, whole command", kind, facets, 1e6 * seconds / cases))
            seconds = min(in_a_running_python(study) for _ in range(5))  # the first loads the kernels
            found.append(("490 records, in a running Python", kind, facets, 1e6 * seconds / cases))
    toes = {what: us for what, kind, _, us in found if kind == "toes"}
    return [
        [what, "outcome, peak", cases, kind, facets, round(us, 1), round(us / toes[what], 2), "", "", machine()]
        for what, kind, facets, us in found
    ]


def in_a_running_python(study):
    """Wall time of a study file from reading it to its dataset [s]."""
    begun = time.perf_counter()
    rockcli.run(study)
    return time.perf_counter() - begun


def main():
    kernels.load(compile_them=True)
    head = [
        "motion",
        "asked",
        "cases",
        "body",
        "facets",
        "us_per_case",
        "over_toes",
        "overturned",
        "mean_impacts",
        "machine",
    ]
    rows = []
    for name, (motion, axis) in MOTIONS.items():
        for asked, scalars in ASKED.items():
            for n in CASES:
                for kind, (facets, us, over, fell, impacts) in costs(motion, axis, n, scalars).items():
                    told = round(us, 1), round(over, 2), round(float(fell), 3), impacts
                    rows.append([name, asked, n, kind, facets, *told, machine()])
                    print(*rows[-1], flush=True)
    for row in of_many_records():
        rows.append(row)
        print(*row, flush=True)
    with RESULTS.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *rows])


if __name__ == "__main__":
    main()
