"""What `rock table` of ten million cases takes: wall time and peak memory of whole processes.

    python benchmarks/tables.py [CASES]

Of a map of pulses, two axes and three scalars.  The same commands on 100 cases tell what the libraries take by
themselves, and pandas what it takes to hold the table.
Writes results/tables.csv.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from machine import write_results

HERE = Path(__file__).resolve().parent
CASES = 10_000_000
FEW = 100
COLUMNS = "outcome,theta_peak_over_alpha,n_impacts"
"""Five columns with the axes."""

STUDY = """\
name: map{cases}
case: {{block: {{R: 2, tan_alpha: 0.2}}, motion: {{pulse: {{shape: sine, a_p: 1, T_p: 1}}}}, solver: {{accuracy: draft}}}}
vary:
  motion.pulse.a_p: {{from: 0.5, to: 20, n: {n}}}
  motion.pulse.T_p: {{from: 0.1, to: 3, n: {m}}}
save: {{histories: false, scalars: [outcome, theta_peak_over_alpha, n_impacts]}}
plots: none
"""

HELD = """\
import sys, xarray
frame = xarray.open_dataset(sys.argv[1]).to_dataframe()
print(len(frame))
"""


def dataset(rock: str, folder: Path, cases: int) -> Path:
    """A map of about so many pulses, solved by `rock run`: two axes and three scalars."""
    n = max(10, round(cases**0.5))
    study = folder / f"map{cases}.yaml"
    study.write_text(STUDY.format(cases=cases, n=n, m=max(10, cases // n)))
    subprocess.run([rock, "run", str(study), "--quiet", "--out", str(folder)], check=True)
    return folder / f"map{cases}" / f"map{cases}.nc"


def measured(command: list[str]) -> tuple[float, float]:
    """Wall time [s] and peak resident memory [MB] of a process."""
    began = time.perf_counter()
    quiet = [(os.POSIX_SPAWN_OPEN, stream, os.devnull, os.O_WRONLY, 0) for stream in (1, 2)]
    child = os.posix_spawn(command[0], command, os.environ, file_actions=quiet)
    _, status, usage = os.wait4(child, 0)
    if status:
        raise SystemExit(f"{' '.join(command)} failed")
    return time.perf_counter() - began, usage.ru_maxrss / 1024.0


def main() -> None:
    cases = int(float(sys.argv[1])) if len(sys.argv) > 1 else CASES
    rock = str(Path(sys.executable).parent / "rock")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "t"
        many, few = (dataset(rock, Path(folder), n) for n in (cases, FEW))
        for name, command in {
            "terminal": [rock, "table", "FILE"],
            "CSV": [rock, "table", "FILE", "--columns", COLUMNS, "--out", f"{out}.csv"],
            "Parquet": [rock, "table", "FILE", "--columns", COLUMNS, "--out", f"{out}.parquet"],
            "pandas, all held (xarray's to_dataframe)": [sys.executable, "-c", HELD, "FILE"],
        }.items():
            (_, idle), (seconds, peak) = (
                measured([str(file) if word == "FILE" else word for word in command]) for file in (few, many)
            )
            size = next((f"{p.stat().st_size / 1e6:.0f}" for p in Path(folder).glob("t.*")), "")
            rows.append([name, cases, f"{seconds:.1f}", f"{peak:.0f}", f"{peak - idle:.0f}", size])
            for p in Path(folder).glob("t.*"):
                p.unlink()
            print(*rows[-1], sep="  ", flush=True)
    head = ["table", "cases", "wall [s]", "peak memory [MB]", "beyond 100 cases [MB]", "file [MB]"]
    write_results(HERE / "results" / "tables.csv", head, rows)


if __name__ == "__main__":
    main()
