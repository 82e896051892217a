"""What friction costs in a sweep of records, over the time of pure rocking, and in a map of mu and amplitude.

    python benchmarks/contact_cost.py [FOLDER_WITH_AT2_RECORDS] [--times 1.5 3] [--bodies 400] [--amplitudes 1000]

As many bodies (R from 0.5 to 5 m, tan(alpha) from 0.1 to 0.4) under every AT2 file of the folder (default: records/),
scaled to `times` g tan(alpha), each in turn, by mu/tan(alpha), with outcome, peak and slide, and with the default scalars: processor
time of the whole study without a `mu`, with it, how many slide.  Medians of 15 rounds, in each of which every mu is solved beside pure rocking, so that
what else the machine does meets all alike; kernels compiled before.  The same of one body (R = 2 m, tan(alpha) = 0.2)
under every file at amplitudes from 0.5 to 10 g tan(alpha), five rounds.  Then a map of mu and amplitude of 100 000 pulses.  Writes results/contact_cost.csv.
"""

from __future__ import annotations

import argparse
import csv
import resource
import time
from pathlib import Path
from typing import Any

import numpy as np
from contact import map_study
from machine import machine

import rockcli

HERE = Path(__file__).resolve().parent
TABLE = HERE / "results" / "contact_cost.csv"

RATIOS = (0.8, 1.02, 1.05, 1.1, 1.2, 1.5, 2.0)
ROUNDS, ROUNDS_OF_SUITE = 15, 5
SAVED = {"few": ["outcome", "theta_peak_over_alpha", "slide_peak"], "default": "all"}
HEADER = [
    "what",
    "pga_over_g_tan_alpha",
    "scalars",
    "mu_over_tan_alpha",
    "cases",
    "slide",
    "cpu_seconds",
    "over_pure_rocking",
    "memory_MB",
    "machine",
]


def sweep(files: list[Path], times: float, bodies: int, ratio: float | None, saved: str) -> dict[str, Any]:
    block: dict[str, Any] = {"R": 1.0, "tan_alpha": 0.2}
    if ratio is not None:
        block["mu"] = f"{ratio}*tan_alpha"
    n = round(bodies**0.5)
    return {
        "case": {"block": block, "motion": {"record": {"file": str(files[0]), "pga_over_g_tan_alpha": times}}},
        "vary": {
            "motion.record.file": [str(path) for path in files],
            "block.R": {"from": 0.5, "to": 5.0, "n": n, "spacing": "log"},
            "block.tan_alpha": {"from": 0.1, "to": 0.4, "n": n},
        },
        "save": {"histories": False, "scalars": SAVED[saved]},
    }


def suite(files: list[Path], amplitudes: int, ratio: float | None, saved: str) -> dict[str, Any]:
    study = sweep(files, 1.0, 1, ratio, saved)
    study["case"]["block"] |= {"R": 2.0}
    levels = {"motion.record.pga_over_g_tan_alpha": {"from": 0.5, "to": 10.0, "n": amplitudes}}
    return study | {"vary": {"motion.record.file": study["vary"]["motion.record.file"]} | levels}


def measured(study: dict[str, Any]) -> tuple[float, Any]:
    began = time.process_time()
    found = rockcli.run(study)
    return time.process_time() - began, found


def memory() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def over_records(
    studies: dict[float | None, dict[str, Any]], intensity: float | str, saved: str, turns: int = ROUNDS
) -> list[list[Any]]:
    """Rows of the studies by mu/tan(alpha), that of pure rocking first."""
    found = {ratio: rockcli.run(study) for ratio, study in studies.items()}  # compiled by now
    rounds = np.array([[measured(study)[0] for study in studies.values()] for _ in range(turns)])
    seconds, over = np.median(rounds, axis=0), np.median(rounds / rounds[:, :1], axis=0)
    rows: list[list[Any]] = []
    for ratio, cost, times in zip(studies, seconds.tolist(), over.tolist(), strict=True):
        slides = "" if ratio is None else float((found[ratio]["slide_peak"].values > 0.0).mean())
        named = "" if ratio is None else ratio
        rows.append(
            ["records", intensity, saved, named, found[ratio]["outcome"].size, slides, cost, times, memory(), machine()]
        )
        print(rows[-1], flush=True)
    whole = rounds[:, 1:].mean(axis=1)
    mean, times = float(np.median(whole)), float(np.median(whole / rounds[:, 0]))
    rows.append(["records, all mu", intensity, saved, "", "", "", mean, times, "", machine()])
    print(rows[-1], flush=True)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, nargs="?", default=HERE.parent / "records")
    parser.add_argument("--times", type=float, nargs="+", default=[1.5, 3.0])
    parser.add_argument("--bodies", type=int, default=400)
    parser.add_argument("--amplitudes", type=int, default=1000)
    asked = parser.parse_args()
    files = sorted(asked.folder.glob("*.AT2"))
    rows: list[list[Any]] = []
    for intensity in asked.times:
        for saved in SAVED:
            studies = {ratio: sweep(files, intensity, asked.bodies, ratio, saved) for ratio in (None, *RATIOS)}
            rows += over_records(studies, intensity, saved)
    for saved in SAVED:
        studies = {ratio: suite(files, asked.amplitudes, ratio, saved) for ratio in (None, *RATIOS)}
        rows += over_records(studies, "0.5 to 10", saved, ROUNDS_OF_SUITE)
    cost, pulses = measured(map_study())
    slides = float((pulses["slide_peak"].values > 0.0).mean())
    rows.append(["map of pulses", "", "few", "", pulses["outcome"].size, slides, cost, "", memory(), machine()])
    print(rows[-1], flush=True)
    with TABLE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(HEADER)
        writer.writerows([f"{x:.3g}" if isinstance(x, float) else x for x in row] for row in rows)


if __name__ == "__main__":
    main()
