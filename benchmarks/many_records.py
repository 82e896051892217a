"""Many recorded motions in one axis: whole commands, cases a second.

    python benchmarks/many_records.py [--workers N] [--rounds K] [--before FOLDER]

Records of 4000 to 8000 samples at .005 s, made here, in AT2 files; 490 of them under 22 amplitudes, the axes in either
order, and 3000 under one and in a table with a scale each, with outcome and peak and with the scalars saved by default.
`reading` is the processor time of reading the files alone, the floor of what a run that reads them can take.  The least of the rounds counts.
Writes results/many_records.csv.  With the FOLDER of another build, which holds its package `rockcli` with objects of its
kernels, the two builds run the studies in turn with outcome and peak: results/many_records_paired.csv.  Python has
compiled the modules of either before, as it has on a user's machine; where PYTHONDONTWRITEBYTECODE is set it would compile
all of them in every command, half a second.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path
from time import perf_counter, process_time

import numpy as np
from machine import write_results

from rockcli.motion.at2 import at2_text
from rockcli.motion.reading import read_record, ready_for

HERE = Path(__file__).resolve().parent
HEADINGS = (
    "study", "saved", "cases", "wall [s]", "CPU [s]", "cases/s", "reading [CPU s]", "workers", "load before",
)  # fmt: skip

PAIRED = (
    "study", "saved", "before [CPU s]", "after [CPU s]", "ratio", "before, wall [s]", "after, wall [s]", "ratio, wall",
    "cases/s", "workers", "rounds", "load before",
)  # fmt: skip

RECORDS, FEWER = 3000, 490

AMPLITUDES = "motion.record.pga: {from: 0.1*g, to: 2*g, n: 22}"
STUDIES = {
    "490 records x 22 amplitudes": ('motion.record.file: "some/*.AT2"', AMPLITUDES),
    "22 amplitudes x 490 records": (AMPLITUDES, 'motion.record.file: "some/*.AT2"'),
    "3000 records": ('motion.record.file: "all/*.AT2"',),
    "3000 records and scales in a table": ("case: rows.csv",),
}
SAVED = {
    "outcome, peak": "save: {histories: false, scalars: [outcome, theta_peak_over_alpha]}",
    "default": "save: {histories: false}",
}


def make(folder: Path, count: int) -> None:
    """Records of filtered noise with a rise and a decay, PGA .05 to .8 g."""
    rng = np.random.default_rng(1)
    for k in range(count):
        n, dt = int(rng.integers(4000, 8001)), 0.005
        t, f = np.arange(n) * dt, np.fft.rfftfreq(n, dt)
        low = 1.0 / (1.0 + (f / rng.uniform(0.5, 5.0)) ** 2) * np.exp(-f / 20.0)
        a = np.fft.irfft(np.fft.rfft(rng.standard_normal(n)) * low * (f / 0.2) ** 2 / (1.0 + (f / 0.2) ** 2), n)
        rise = rng.uniform(2.0, 5.0)
        a *= np.minimum(t / rise, 1.0) ** 2 * np.exp(-0.3 * np.maximum(t - rise - rng.uniform(3.0, 12.0), 0.0))
        a *= rng.uniform(0.05, 0.8) / np.abs(a).max()
        (folder / f"r{k:04d}.AT2").write_text(at2_text(a, dt, ["synthetic", "benchmark"]))


def measured(study: Path, workers: int, build: Path | None = None) -> tuple[float, float]:
    """Wall and processor time of a run [s], of this build or of that in a folder, its modules compiled by Python before."""
    rock = str(Path(sys.executable).parent / "rock")
    command = [rock, "run", str(study), "--quiet", "--fresh", "--no-plots", "--out", str(study.parent / "out")]
    began = perf_counter()
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment |= {"PYTHONPATH": str(build)} if build is not None else {}
    child = os.posix_spawn(rock, [*command, "--workers", str(workers)], environment)
    _, status, usage = os.wait4(child, 0)
    if status:
        raise SystemExit(f"{' '.join(command)} failed")
    return perf_counter() - began, usage.ru_utime + usage.ru_stime


def reading(files: list[Path]) -> float:
    """Processor time of reading files, as a study of so many reads them [s]."""
    ready_for(len(files))
    began = process_time()
    for path in files:
        read_record(path)
    return process_time() - began


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--before", type=Path)
    options = parser.parse_args()
    load = f"{os.getloadavg()[0]:.1f}"
    rows, pairs = [], []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for place in ("all", "some"):
            (folder / place).mkdir()
        make(folder / "all", RECORDS)
        for path in sorted((folder / "all").iterdir())[:FEWER]:
            (folder / "some" / path.name).symlink_to(path)
        lines = [f"{k},all/r{k:04d}.AT2,{0.5 + k / RECORDS:.3f}" for k in range(RECORDS)]
        (folder / "rows.csv").write_text("\n".join(["name,motion.record.file,motion.record.scale", *lines]) + "\n")
        for title, axes in STUDIES.items():
            files = sorted((folder / ("some" if "490" in title else "all")).iterdir())
            floor = min(reading(files) for _ in range(options.rounds))
            cases = len(files) * (22 if "22" in title else 1)
            for saved, save in SAVED.items():
                study = folder / "study.yaml"
                study.write_text(
                    "name: many\ncase: {block: {R: 2, tan_alpha: 0.2}, motion: {record: {pga: 0.5*g}}}\nvary:\n"
                    + "".join(f"  {axis}\n" for axis in axes)
                    + f"{save}\nplots: none\n"
                )
                if options.before is not None:
                    if saved == next(iter(SAVED)):
                        builds = (options.before, HERE.parent)
                        turns = [[measured(study, options.workers, b) for b in builds] for _ in range(options.rounds)]
                        row = [title, saved]
                        for kind in (1, 0):
                            old, new = (min(turn[which][kind] for turn in turns) for which in range(2))
                            row += [f"{old:.2f}", f"{new:.2f}", f"{new / old:.2f}"]
                        pairs.append([*row, f"{cases / new:.0f}", options.workers])
                        print(*pairs[-1], sep="  ", flush=True)
                    continue
                runs = [measured(study, options.workers) for _ in range(options.rounds)]
                wall, cpu = (min(run[kind] for run in runs) for kind in range(2))
                rows.append([title, saved, cases, f"{wall:.2f}", f"{cpu:.2f}", f"{cases / wall:.0f}", f"{floor:.2f}"])
                print(*rows[-1], sep="  ", flush=True)
    if options.before is not None:
        path = HERE / "results" / "many_records_paired.csv"
        write_results(path, PAIRED, [[*row, options.rounds, load] for row in pairs])
        return
    write_results(HERE / "results" / "many_records.csv", HEADINGS, [[*row, options.workers, load] for row in rows])


if __name__ == "__main__":
    main()
