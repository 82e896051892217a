"""Record maps per second and core: the lanes against solve_ivp RK45 with impact events, in one run.

    python benchmarks/throughput_records.py [FOLDER of AT2 files [NAME of one or more of them ...]]

A map (scale x size x slenderness) under each of several recorded motions, or the project's own where the folder is
absent; RK45 at rtol 1e-6 with max_step = dt solves a random sample of the same cases.  Processor time of this thread in
both; the lanes with all that goes round the kernel, and the kernel alone.  Errors against the reference accuracy.  Puts its rows into
results/throughput.csv, beside those of throughput.py.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

os.environ["ROCK_KERNELS"] = "compiled"

import numpy as np
import throughput

from rockcli.motion.at2 import parse_at2
from rockcli.scene.batch import Batch, Save
from rockcli.scene.body.block import make_block
from rockcli.scene.ground.excitation import Excitation, Samples
from rockcli.scene.laws.damping import Damping
from rockcli.scene.numerics import Numerics
from rockcli.solvers.event.solver import solve

HERE = Path(__file__).resolve().parent
G, ETA = throughput.G, throughput.ETA
NAMES = ("RSN1106_KOBE_KJM000", "P695FF27_SUPERST_B-ICC000", "RSN1063_NORTHR_RRS228", "P695FF41_MANJIL_ABBAR--T")
SAMPLE, REPEATS = 20, 5
"""Cases RK45 solves; runs of the lanes, the fastest of which counts."""
SCALES, EVERY = 160, 20
"""Scales of a map (16 000 cases); every so many are solved at the reference accuracy, and RK45 takes its sample there."""


def record_map(values: np.ndarray, dt: float, scales: np.ndarray) -> tuple[Batch, np.ndarray]:
    """A map of 100 cases a scale, scale outermost, and p of each."""
    axes = np.meshgrid(scales, np.linspace(1, 4, 10), np.linspace(0.1, 0.3, 10), indexing="ij")
    scale, p, alpha = (x.ravel() for x in axes)
    R = 0.75 * G / p**2
    body = make_block(h=R * np.cos(alpha), b=np.repeat((R * np.sin(alpha))[:, None], 2, 1), R=R, alpha=alpha, n=len(p))
    zero = np.zeros(len(p))
    factor = scale * G * np.tan(alpha) / np.abs(values).max()
    batch = Batch(
        g=np.full(len(p), G),
        block=body,
        excitation=Excitation(Samples(values, dt, factor), None, np.full(len(p), np.nan)),
        theta_0=zero,
        theta_dot_0=zero,
        model="rigid",
        geometry=None,
        damping=Damping("restitution", np.full((len(p), 2), ETA)),
        numerics=Numerics(),
        save=Save(False, 0.01, frozenset({"outcome", "theta_peak_over_alpha", "n_impacts"})),
    )
    return batch, p


def measure(name: str, values: np.ndarray, dt: float, scales: tuple[float, float]) -> list:
    steps = np.linspace(*scales, SCALES)
    batch, p = record_map(values, dt, steps)
    found = solve(batch).scalars
    spent, within = [], []
    for _ in range(REPEATS):
        with throughput.in_the_kernel() as clock:
            began = time.thread_time()
            solve(batch)
            spent.append(time.thread_time() - began)
        within.append(clock.spent)
    few, p = record_map(values, dt, steps[::EVERY])
    exact = solve(replace(few, numerics=Numerics(accuracy="reference"))).scalars
    kept = (np.arange(batch.size) // 100) % EVERY == 0
    found = {name: x[kept] for name, x in found.items()}
    rng = np.random.default_rng(1)
    theirs, errors = [], []
    began = time.thread_time()
    sample = rng.choice(few.size, SAMPLE, replace=False)
    for i in sample:
        throughput.ALPHA = float(few.block.alpha[i, 0])
        theirs.append(throughput.rk45(few.excitation, int(i), float(p[i]), dt * len(values), dt))
    each = (time.thread_time() - began) / SAMPLE
    for (fell, peak), i in zip(theirs, sample, strict=True):
        if not fell and np.isfinite(exact["theta_peak_over_alpha"][i]):
            errors.append(abs(peak - exact["theta_peak_over_alpha"][i]))
    missed = np.mean([x[0] != (exact["outcome"][i] >= 2) for x, i in zip(theirs, sample, strict=True)])
    wrong = np.mean((found["outcome"] >= 2) != (exact["outcome"] >= 2))
    with np.errstate(invalid="ignore"):
        error = np.abs(found["theta_peak_over_alpha"] - exact["theta_peak_over_alpha"])
    label = f"record map, {name}, {len(values)} x {dt:g} s, {scales[0]:g} to {scales[1]:g} g tan(alpha)"
    return [
        [
            label,
            "solve_ivp RK45 1e-6, events, max_step dt",
            f"{1 / each:.4g}",
            "1",
            f"{np.median(errors):.1e}",
            f"{missed:.4f}",
        ],
        *(
            [
                label,
                f"lanes, standard, peaks and impacts{words} ({batch.size} cases)",
                f"{batch.size / min(seconds):.4g}",
                f"{batch.size / min(seconds) * each:.0f}",
                f"{np.median(error[np.isfinite(error)]):.1e}",
                f"{wrong:.5f}",
            ]
            for words, seconds in (("", spent), (", in the kernel", within))
        ),
    ]


def motions(folder: Path, names: Sequence[str] = NAMES) -> list[tuple[str, np.ndarray, float]]:
    paths = [p for name in names for p in sorted(folder.rglob(f"{name}.AT2"))] if folder.is_dir() else []
    found = []
    for path in paths or sorted((HERE.parent / "records").glob("*.AT2")):
        trace = parse_at2(path.read_bytes(), path.name)
        found.append((path.stem, np.asarray(trace.values) * G, trace.dt))
    return found


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE.parent / "records"
    if len(sys.argv) > 2:  # records of one's own choice are shown, not kept
        for name, values, dt in motions(folder, sys.argv[2:]):
            print(*measure(name, values, dt, (1.0, 4.0)), sep="\n", flush=True)
        return
    for name, values, dt in motions(folder):
        rows = measure(name, values, dt, (1.0, 4.0))
        print(*rows, sep="\n", flush=True)
        throughput.write(rows)
    # always rocking: a noise that never falls below the threshold for long, at an amplitude few survive
    rng = np.random.default_rng(7)
    noise = np.convolve(rng.normal(size=3000), np.hanning(9), "same")
    rows = measure("active: filtered noise without a pause", noise, 0.01, (2.0, 6.0))
    print(*rows, sep="\n", flush=True)
    throughput.write(rows)


if __name__ == "__main__":
    main()
