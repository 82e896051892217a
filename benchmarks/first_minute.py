"""What the first runs on a machine that never compiled anything cost beside the second: CPU of whole commands.

    python benchmarks/first_minute.py

Every way of running the kernels begins with an empty cache of the user (that of the figures' fonts too) and runs each
study twice.  Needs kernels compiled ahead of time with the program (an installation makes them).
Writes results/first_minute.csv.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

from machine import write_results

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent

MAP = """
case: {block: {R: 1.0, tan_alpha: 0.2}, motion: {pulse: {shape: ricker, omega_p_over_p: 2, a_p_over_g_tan_alpha: 2}}}
vary:
  motion.pulse.omega_p_over_p: {from: 0.1, to: 10, n: %d}
  motion.pulse.a_p_over_g_tan_alpha: {from: 1, to: 10.9, n: %d}
"""
FEW = "save: {scalars: [outcome, theta_peak_over_alpha, n_impacts]}\n"
RECORD = """
case: {block: {R: 1.0, tan_alpha: 0.2}, motion: {record: {file: synthetic_rock_m65.AT2}}}
vary: {block.R: {from: 0.5, to: 5, n: 50}, motion.record.scale: {from: 1, to: 4, n: 50}}
"""
STUDIES = {
    "first_rock, with plots": None,
    "300 x 300 pulses, three scalars": MAP % (300, 300) + FEW,
    "50 x 50 pulses, all scalars, some at uplift": MAP % (50, 50),
    "50 x 50 under a record, three scalars": RECORD + FEW,
}
WAYS = {"ahead of time": "", "just in time": "jit"}


def cpu(command: list[str], environment: dict[str, str]) -> float:
    """Processor time of a command and all it started [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    rock = str(Path(sys.executable).parent / "rock")
    clean = {k: v for k, v in os.environ.items() if k not in ("ROCK_KERNELS", "ROCK_CACHE_DIR", "MPLCONFIGDIR")}
    clean["ROCK_RECORDS"] = str(ROOT / "records")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for way, word in WAYS.items():
            for number, (name, words) in enumerate(STUDIES.items()):
                if word and words is None:
                    continue  # one case alone is never compiled just in time
                place = Path(folder, f"{way.split()[0]}-{number}")
                place.mkdir()
                study = ROOT / "studies" / "examples" / "first_rock.yaml"
                if words is not None:
                    study = place / "map.yaml"
                    study.write_text(f"name: map\n{words}plots: []\n")
                environment = (
                    clean | {"XDG_CACHE_HOME": str(place / "cache")} | ({"ROCK_KERNELS": word} if word else {})
                )
                command = [rock, "run", str(study), "--fresh", "--workers", "1", "--out", str(place / "out")]
                first, second = (cpu(command, environment) for _ in range(2))
                rows.append([name, way, f"{first:.2f}", f"{second:.2f}", f"{first - second:.2f}"])
                print(*rows[-1], sep="  ")
    head = ["command", "kernels", "first [CPU s]", "second [CPU s]", "difference [s]"]
    write_results(HERE / "results" / "first_minute.csv", head, rows)


if __name__ == "__main__":
    main()
