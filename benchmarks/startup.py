"""What a command costs before and beside solving, as whole processes: medians of several runs, in turn.

    python benchmarks/startup.py

`rock --help` against a bare typer program with one command; one pulse case, and a map of 1e6 outcomes, without plots
and with their figures.  Writes results/startup.csv.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from machine import write_results

HERE = Path(__file__).resolve().parent
STUDY = HERE.parent / "studies" / "examples" / "first_rock.yaml"
RUNS = 15

BARE = """\
import typer
app = typer.Typer()
@app.command()
def hello(name: str = "you"):
    "Say hello."
    print(name)
@app.command()
def bye(name: str = "you"):
    "Say good bye."
    print(name)
app()
"""

MAP = """\
name: map
case: {block: {R: 2, tan_alpha: 0.2}, motion: {pulse: {shape: ricker, omega_p_over_p: 2, a_p_over_g_tan_alpha: 2}}}
vary:
  motion.pulse.a_p_over_g_tan_alpha: {from: 0.5, to: 6, n: 1000}
  motion.pulse.omega_p_over_p: {from: 0.5, to: 8, n: 1000}
save: {scalars: [outcome]}
plots: [map]
"""


def seconds(command: list[str]) -> float:
    began = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return time.perf_counter() - began


def main() -> None:
    rock = str(Path(sys.executable).parent / "rock")
    with tempfile.TemporaryDirectory() as folder:
        bare = Path(folder) / "bare.py"
        bare.write_text(BARE)
        outcomes = Path(folder) / "map.yaml"
        outcomes.write_text(MAP)
        case, sweep = ([rock, "run", str(study), "--fresh", "--quiet", "--out", folder] for study in (STUDY, outcomes))
        commands = {
            "bare typer program --help": [sys.executable, str(bare), "--help"],
            "rock --help": [rock, "--help"],
            "one pulse case, --no-plots": [*case, "--no-plots"],
            "one pulse case, two figures": case,
            "1e6 outcomes, --no-plots": [*sweep, "--no-plots"],
            "1e6 outcomes, their map": sweep,
        }
        times: dict[str, list[float]] = {name: [] for name in commands}
        for _ in range(RUNS + 1):
            for name, command in commands.items():
                times[name].append(seconds(command))
    base = statistics.median(times["bare typer program --help"][1:])
    rows = []
    for name, all_runs in times.items():
        runs = all_runs[1:]  # the first warms the disk
        median = statistics.median(runs)
        rows.append([name, *(f"{x:.3f}" for x in (median, min(runs), max(runs))), f"{median / base:.2f}"])
        print(*rows[-1], sep="  ")
    head = ["command", "median [s]", "min [s]", "max [s]", "over bare typer"]
    write_results(HERE / "results" / "startup.csv", head, rows)


if __name__ == "__main__":
    main()
