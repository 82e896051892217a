"""What a study costs with the scalars it saves by default over what it costs with two of them: whole commands.

    python benchmarks/default_cost.py [FOLDER_WITH_AT2_RECORDS]

Processor and wall time of `rock run` with all scalars, the error estimate among them, and with `outcome` and
`theta_peak_over_alpha` alone, in turn; the least of ROUNDS of each.  Without a folder of records the suite has the
three records that are shipped.  Writes results/default_cost.csv.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
import time
from pathlib import Path

from machine import write_results

HERE = Path(__file__).resolve().parent
SHIPPED = HERE.parent / "records"
ROUNDS, RECORDS = 3, 42

HEADINGS = (
    "study", "cases", "CPU two [s]", "CPU default [s]", "CPU ratio", "wall two [s]", "wall default [s]", "wall ratio",
    "records",
)  # fmt: skip

TWO = "save: {histories: false, scalars: [outcome, theta_peak_over_alpha]}\n"
ALL = "save: {histories: false}\n"

FAMILIES = {
    "suite of records x 100 amplitudes": """\
case: {block: {R: 2, tan_alpha: 0.2}, motion: {record: {file: suite/a.AT2, pga: 1}}}
vary:
  motion.record.file: "suite/*.AT2"
  motion.record.pga: {from: 0.1*g, to: 2*g, n: 100}
""",
    "record map 100 x 100": """\
case: {block: {R: 2, tan_alpha: 0.2}, motion: {record: {file: one.AT2, pga: 1}}}
vary:
  block.R: {from: 0.5, to: 5, n: 100}
  motion.record.pga: {from: 0.1*g, to: 2*g, n: 100}
""",
    "10 000 bodies under one record": """\
case: {block: {R: 2, tan_alpha: 0.2}, motion: {record: {file: one.AT2, pga: 0.6*g}}}
vary:
  block.R: {from: 0.5, to: 5, n: 100}
  block.tan_alpha: {from: 0.05, to: 0.4, n: 100}
""",
    "pulse map 100 x 100": """\
case: {block: {R: 2, tan_alpha: 0.2}, motion: {pulse: {shape: sine, a_p: 1, T_p: 1}}}
vary:
  motion.pulse.a_p: {from: 0.1*g, to: 2*g, n: 100}
  motion.pulse.T_p: {from: 0.1, to: 3, n: 100}
""",
    "pulse map 300 x 300": """case: {block: {R: 2, tan_alpha: 0.2}, motion: {pulse: {shape: sine, a_p: 1, T_p: 1}}}
vary:
  motion.pulse.a_p: {from: 0.1*g, to: 2*g, n: 300}
  motion.pulse.T_p: {from: 0.1, to: 3, n: 300}
""",
}


def measured(rock: str, study: Path) -> tuple[float, float]:
    """Processor and wall time of a run [s]."""
    command = [rock, "run", str(study), "--quiet", "--fresh", "--no-plots", "--out", str(study.parent / "out")]
    began = time.perf_counter()
    child = os.posix_spawn(command[0], command, os.environ)
    _, status, usage = os.wait4(child, 0)
    if status:
        raise SystemExit(f"{' '.join(command)} failed")
    return usage.ru_utime + usage.ru_stime, time.perf_counter() - began


def main() -> None:
    paths = sorted(Path(sys.argv[1]).rglob("*.AT2"))[:RECORDS] if len(sys.argv) > 1 else sorted(SHIPPED.glob("*.AT2"))
    rock = str(Path(sys.executable).parent / "rock")
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "suite").mkdir()
        for number, path in enumerate(paths):
            shutil.copy(path, folder / "suite" / f"{'a' if number == 0 else f'r{number}'}.AT2")
        shutil.copy(SHIPPED / "synthetic_pulse_m70.AT2", folder / "one.AT2")
        for family, text in FAMILIES.items():
            cases = 100 * len(paths) if "suite" in family else 90_000 if "300" in family else 10_000
            studies = {}
            for what, save in (("two", TWO), ("all", ALL)):
                studies[what] = folder / f"{what}.yaml"
                studies[what].write_text(f"name: {what}\n{text}{save}plots: none\n")
                measured(rock, studies[what])  # kernels compiled, files in memory
            times = [[measured(rock, studies[what]) for what in ("two", "all")] for _ in range(ROUNDS)]
            cpu, wall = ([min(turn[which][kind] for turn in times) for which in range(2)] for kind in range(2))
            rows.append([family, cases, *(f"{x:.2f}" for x in (*cpu, cpu[1] / cpu[0], *wall, wall[1] / wall[0]))])
            print(*rows[-1], sep="  ", flush=True)
    write_results(HERE / "results" / "default_cost.csv", HEADINGS, [[*row, len(paths)] for row in rows])


if __name__ == "__main__":
    main()
