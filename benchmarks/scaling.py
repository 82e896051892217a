"""One worker against two (or N) on large maps: wall time of the whole command.

    python benchmarks/scaling.py [--workers N] [--repeats K]

Three maps that take one worker more than 20 s: outcomes under a record, outcomes under pulses, and the three scalars a
large sweep saves by default under pulses.  Medians of repeats in turn, of the ratio too: what the
machine does besides changes a run by a tenth.  Writes results/scaling.csv.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median
from time import perf_counter

from machine import write_results

HERE = Path(__file__).resolve().parent
TABLE = HERE / "results" / "scaling.csv"

BODY = "block: {R: 2, tan_alpha: 0.2}, damping: {scheme: restitution, eta: 0.9}"
PULSES = f"""\
name: map
case: {{{BODY}, motion: {{pulse: {{shape: ricker, omega_p_over_p: 2, a_p_over_g_tan_alpha: 2}}}}}}
vary:
  motion.pulse.omega_p_over_p: {{from: 0.5, to: 8, n: SIDE}}
  motion.pulse.a_p_over_g_tan_alpha: {{from: 0.5, to: 6, n: SIDE}}
"""
MAPS = {
    "outcomes under a record, 2e6 cases": f"""\
name: map
case: {{{BODY}, motion: {{record: {{file: {HERE.parent / "records" / "synthetic_pulse_m70.AT2"}, pga_over_g_tan_alpha: 2}}}}}}
vary:
  block.R: {{from: 0.5, to: 10, n: 1000}}
  motion.record.pga_over_g_tan_alpha: {{from: 1, to: 4, n: 2000}}
save: {{scalars: [outcome]}}
""",
    "outcomes under pulses, 1.9e7 cases": PULSES.replace("SIDE", "4400") + "save: {scalars: [outcome]}\n",
    "outcome, peak and impacts under pulses, 6.8e6 cases": PULSES.replace("SIDE", "2600"),
}


def wall_time(study: str, workers: int) -> float:
    """Of `rock run`, the kernels compiled before [s]."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "map.yaml").write_text(study, encoding="utf-8")
        command = [
            sys.executable,
            "-m",
            "rockcli",
            "run",
            "map.yaml",
            "--workers",
            str(workers),
            "--no-plots",
            "--quiet",
        ]
        began = perf_counter()
        subprocess.run(command, cwd=folder, check=True)
        return perf_counter() - began


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--repeats", type=int, default=3)
    given = parser.parse_args()
    rows = []
    for name, study in MAPS.items():
        spent: dict[int, list[float]] = {1: [], given.workers: []}
        for _ in range(given.repeats):
            for workers, times in spent.items():
                times.append(wall_time(study, workers))
        one, many = (median(times) for times in spent.values())
        ratio = median(a / b for a, b in zip(*spent.values(), strict=True))
        rows.append([name, f"{one:.1f}", given.workers, f"{many:.1f}", f"{ratio:.2f}"])
        print(*rows[-1], sep="; ", flush=True)
    write_results(TABLE, ["map", "one worker [s]", "workers", "they take [s]", "ratio"], rows)


if __name__ == "__main__":
    main()
