"""What a case costs, and the memory of the process, from 10^4 to 10^8 cases: whole commands, one process, no plots.

    python benchmarks/scale.py [--most CASES] [--least CASES] [--repeats K] [--folder DIR]

A map of Ricker pulses on one block, outcome and peak saved.  The cost of a case is that of those more than in the row
above; the least of the repeats counts (one from 10^7 on).  10^8 cases take some 7 minutes of processor time and 2 GB in
the folder meanwhile.  Writes the rows measured into results/scale.csv.  Up to 10^5 cases a dataset also has the peak
acceleration and velocity of every pulse.
"""

from __future__ import annotations

import argparse
import csv
import os
import sys
import tempfile
from datetime import date
from itertools import pairwise
from pathlib import Path
from time import perf_counter

from machine import machine

TABLE = Path(__file__).resolve().parent / "results" / "scale.csv"

STUDY = """\
name: map
case:
  block: {{R: 2, tan_alpha: 0.2}}
  damping: {{scheme: restitution, eta: 0.9}}
  motion: {{pulse: {{shape: ricker, omega_p_over_p: 2, a_p_over_g_tan_alpha: 2}}}}
vary:
  motion.pulse.omega_p_over_p: {{from: 0.5, to: 8, n: {rows}}}
  motion.pulse.a_p_over_g_tan_alpha: {{from: 0.5, to: 6, n: {columns}}}
save: {{scalars: [outcome, theta_peak_over_alpha]}}
"""
SIDES = {10**k: (10 ** (k // 2), 10 ** (k - k // 2)) for k in range(4, 10)}

HEAD = (
    "cases", "processor time [s]", "wall time [s]", "a case more [us]", "largest memory [MB]",
    "dataset [MB]", "load before", "measured", "machine",
)  # fmt: skip


def run(cases: int, where: Path | None) -> tuple[float, float, float, float]:
    """Processor and wall time [s], largest memory and size of the dataset [MB] of `rock run`."""
    with tempfile.TemporaryDirectory(dir=where) as folder:
        rows, columns = SIDES[cases]
        study = Path(folder) / "map.yaml"
        study.write_text(STUDY.format(rows=rows, columns=columns), encoding="utf-8")
        command = [sys.executable, "-m", "rockcli", "run", str(study), "--out", folder]
        began = perf_counter()
        process = os.spawnv(os.P_NOWAIT, command[0], [*command, "--workers", "1", "--no-plots", "--quiet"])
        _, status, used = os.wait4(process, 0)
        assert status == 0, status
        dataset = (Path(folder) / "map" / "map.nc").stat().st_size
        return used.ru_utime + used.ru_stime, perf_counter() - began, used.ru_maxrss * 1024 / 1e6, dataset / 1e6


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--most", type=float, default=1e7)
    parser.add_argument("--least", type=float, default=1e4)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--folder", type=Path)
    given = parser.parse_args()
    rows: dict[int, list[str]] = {}
    if TABLE.exists():
        with TABLE.open(encoding="utf-8", newline="") as file:
            rows = {int(row[0]): row for row in list(csv.reader(file))[1:]}
    for cases in SIDES:
        if given.least <= cases <= given.most:
            load = os.getloadavg()[0]
            repeats = given.repeats if cases < 10**7 else 1
            seconds, wall, memory, dataset = min(run(cases, given.folder) for _ in range(repeats))
            numbers = (f"{seconds:.2f}", f"{wall:.1f}", "", f"{memory:.0f}", f"{dataset:.1f}", f"{load:.1f}")
            rows[cases] = [str(cases), *numbers, date.today().isoformat(), machine()]
            print(*rows[cases], sep="; ", flush=True)
    write(rows)


def write(rows: dict[int, list[str]]) -> None:
    """The table, with what a case costs from row to row."""
    known = sorted(rows)
    for fewer, more in pairwise(known):
        rows[more][3] = f"{1e6 * (float(rows[more][1]) - float(rows[fewer][1])) / (more - fewer):.2f}"
    rows[known[0]][3] = ""
    with TABLE.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(HEAD)
        table.writerows(rows[cases] for cases in known)


if __name__ == "__main__":
    main()
