"""Seconds of the whole command `rock run` for samples of uncertain inputs under a pulse.

    python benchmarks/uncertain.py

Four inputs, Latin hypercube, defaults otherwise; a first run of few samples has the kernels compiled.  Writes
results/uncertain.csv.
"""

from __future__ import annotations

import csv
import subprocess
import sys
import tempfile
import time
from datetime import date
from pathlib import Path

from machine import machine

HERE = Path(__file__).resolve().parent

STUDY = """
name: uncertain-pulse
case:
  block: {h: 1.5, b: 0.3}
  motion: {pulse: {shape: ricker, a_p: 0.5*g, T_p: 0.8}}
uncertain:
  block.b: {normal: [0.3, 0.01]}
  damping.eta: {uniform: [0.88, 0.94]}
  motion.pulse.a_p: {lognormal: [0.5*g, 0.3]}
  motion.pulse.T_p: {lognormal: [0.8, 0.2]}
samples: %d
save: {histories: false, scalars: [outcome, theta_peak_over_alpha, n_impacts]}
"""


def seconds(folder: Path, samples: int) -> float:
    study = folder / "study.yaml"
    study.write_text(STUDY % samples, encoding="utf-8")
    command = [sys.executable, "-m", "rockcli", "run", str(study), "--out", str(folder / "results"), "--fresh"]
    began = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return time.perf_counter() - began


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        seconds(Path(name), 1000)
        rows = [(samples, seconds(Path(name), samples)) for samples in (1000, 10_000, 100_000)]
    with (HERE / "results" / "uncertain.csv").open("w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow(["samples", "seconds", "date", "machine"])
        for samples, took in rows:
            out.writerow([samples, f"{took:.1f}", date.today().isoformat(), machine()])
            print(f"{samples:>8} samples  {took:.1f} s")


if __name__ == "__main__":
    main()
