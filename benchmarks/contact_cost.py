"""What friction costs in a sweep of records, over the time of pure rocking, and in a map of mu and amplitude.

    python benchmarks/contact_cost.py [FOLDER_WITH_AT2_RECORDS] [--times 1.5] [--bodies 400]

As many bodies (R from 0.5 to 5 m, tan(alpha) from 0.1 to 0.4) under every AT2 file of the folder (default: records/),
scaled to `times` g tan(alpha), by mu/tan(alpha), with all scalars that lanes can find: seconds without a `mu`, with it, how many slide.
The best of three runs each, kernels compiled before.  Then a map of mu and amplitude of 100 000 pulses.  Writes
results/contact_cost.csv.
"""

from __future__ import annotations

import argparse
import csv
import resource
import time
from pathlib import Path
from typing import Any

from contact import map_study
from machine import machine

import rockcli

HERE = Path(__file__).resolve().parent
TABLE = HERE / "results" / "contact_cost.csv"

RATIOS = (1.05, 1.1, 1.2, 1.5, 2.0)
HEADER = ["what", "mu_over_tan_alpha", "cases", "slide", "seconds", "over_pure_rocking", "memory_MB", "machine"]


def sweep(files: list[Path], times: float, bodies: int, ratio: float | None) -> dict[str, Any]:
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
        "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha", "slide_peak"]},
    }


def measured(study: dict[str, Any], repeats: int = 3) -> tuple[float, Any]:
    best, found = float("inf"), None
    for _ in range(repeats):
        began = time.perf_counter()
        found = rockcli.run(study)
        best = min(best, time.perf_counter() - began)
    return best, found


def memory() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, nargs="?", default=HERE.parent / "records")
    parser.add_argument("--times", type=float, default=1.5)
    parser.add_argument("--bodies", type=int, default=400)
    asked = parser.parse_args()
    files = sorted(asked.folder.glob("*.AT2"))
    for ratio in (None, RATIOS[0]):
        rockcli.run(sweep(files, asked.times, asked.bodies, ratio))  # compile
    pure, free = measured(sweep(files, asked.times, asked.bodies, None))
    rows: list[list[Any]] = [["records", "", free["outcome"].size, "", pure, 1.0, memory(), machine()]]
    for ratio in RATIOS:
        seconds, found = measured(sweep(files, asked.times, asked.bodies, ratio))
        slides = float((found["slide_peak"].values > 0.0).mean())
        rows.append(["records", ratio, found["outcome"].size, slides, seconds, seconds / pure, memory(), machine()])
        print(rows[-1], flush=True)
    seconds, found = measured(map_study(), 1)
    slides = float((found["slide_peak"].values > 0.0).mean())
    rows.append(["map of pulses", "", found["outcome"].size, slides, seconds, "", memory(), machine()])
    print(rows[-1], flush=True)
    with TABLE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(HEADER)
        writer.writerows([f"{x:.3g}" if isinstance(x, float) else x for x in row] for row in rows)


if __name__ == "__main__":
    main()
