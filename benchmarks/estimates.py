"""What `rock check` estimates beside what runs take: every row of docs/features.md, whole commands.

    python benchmarks/estimates.py [WORD...]

Maps of as many cases as are to take some seconds, solved by one process without plots: processor time and largest
memory of `rock run` beside the estimate made just before.  With WORDs only the rows whose names hold one of them, and
nothing is written; else writes results/estimates.csv.
"""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import yaml
from features import COST, CSV, FEATURES, HERE, study_of
from machine import write_results

ROCK = str(Path(sys.executable).parent / "rock")
HEADINGS = (
    "feature", "motion", "cases", "estimated [CPU s]", "taken [CPU s]", "ratio", "estimated [MB]", "taken [MB]",
    "ratio of memory",
)  # fmt: skip

TAKES, LEAST, MOST = 1.0, 4, 600
"""CPU time that a map is to take [s], points along its axes at least and at most."""


def taken(study: Path, out: str) -> tuple[float, float]:
    """Processor time [s] and largest memory [MB] of a run."""
    command = [ROCK, "run", str(study), "--fresh", "--quiet", "--no-plots", "--workers", "1", "--out", out]
    child = os.posix_spawn(ROCK, command, os.environ)
    _, status, usage = os.wait4(child, 0)
    if status:
        raise SystemExit(f"{' '.join(command)} failed")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main() -> None:
    os.environ.setdefault("ROCK_RECORDS", str(HERE.parent / "records"))
    words = sys.argv[1:]
    with CSV.open(encoding="utf-8") as file:
        costs = {(row["feature"], row["motion"]): 1e-6 * float(row[COST]) for row in csv.DictReader(file)}
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder) / "study.yaml"
        for feature in FEATURES:
            if words and not any(word in feature.name for word in words):
                continue
            for motion in feature.motions:
                n = int(min(max((TAKES / costs[feature.name, motion]) ** 0.5, LEAST), MOST))
                study.write_text(yaml.safe_dump(study_of(feature, motion, n)), encoding="utf-8")
                told = subprocess.run([ROCK, "check", str(study), "--json"], check=True, capture_output=True)
                found = json.loads(told.stdout)[0]
                seconds, megabytes = taken(study, folder)
                pairs = ((found["seconds"], seconds), (found["memory"], megabytes))
                numbers = [f"{x:.3g}" for guess, fact in pairs for x in (guess, fact, guess / fact)]
                rows.append([feature.name, motion, found["cases"], *numbers])
                print(*rows[-1], sep="  ", flush=True)
    if words:
        return
    write_results(HERE / "results" / "estimates.csv", HEADINGS, rows)


if __name__ == "__main__":
    main()
