"""Trajectories per second and core: the event solver against solve_ivp RK45 with impact events, in one run.

    python benchmarks/throughput.py

A 200 x 200 overturning map (Ricker pulse, alpha = 0.2, eta = 0.9) and a sampled motion; RK45 at rtol 1e-6 solves
a random sample of the same cases.  Errors against the reference accuracy.  Writes results/throughput.csv, beside the
rows of throughput_records.py and of other machines.
"""

from __future__ import annotations

import csv
import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import date
from pathlib import Path

os.environ["ROCK_KERNELS"] = "compiled"

import numpy as np
from machine import machine
from scipy.integrate import solve_ivp

from rockcli import kernels
from rockcli.motion.at2 import parse_at2
from rockcli.scene.batch import Batch, Save
from rockcli.scene.body.block import Block, make_block
from rockcli.scene.ground.excitation import Excitation, Samples, acceleration
from rockcli.scene.ground.pulses import make_pulses
from rockcli.scene.laws.damping import Damping
from rockcli.scene.numerics import Numerics
from rockcli.solvers.event.solver import solve

HERE = Path(__file__).resolve().parent
G, ALPHA, ETA = 9.81, 0.2, 0.9
SAMPLE = 40


def blocks(n: int, p: float) -> Block:
    R = 0.75 * G / p**2
    return make_block(h=R * np.cos(ALPHA), b=np.full((n, 2), R * np.sin(ALPHA)), R=R, alpha=ALPHA, n=n)


def batch(excitation: Excitation, n: int, p: float, accuracy: str, scalars: tuple[str, ...]) -> Batch:
    zero = np.zeros(n)
    return Batch(
        g=np.full(n, G),
        block=blocks(n, p),
        excitation=excitation,
        theta_0=zero,
        theta_dot_0=zero,
        model="rigid",
        geometry=None,
        damping=Damping("restitution", np.full((n, 2), ETA)),
        numerics=Numerics(accuracy=accuracy),
        save=Save(False, 0.01, frozenset(scalars)),
    )


def rk45(excitation: Excitation, case: int, p: float, end: float, max_step: float) -> tuple[bool, float]:
    """(overturned, peak theta/alpha) by solve_ivp RK45, rtol 1e-6, restarted after each impact, 20/p of free rocking."""
    assert excitation.horizontal is not None
    channel = excitation.horizontal
    t = np.arange(0.0, end, min(max_step, 0.002))
    a = acceleration(channel, t, case)
    strong = np.flatnonzero(np.abs(a) > G * np.tan(ALPHA))
    if not len(strong):
        return False, 0.0
    now, s = t[strong[0]], -np.sign(a[strong[0]])
    y = [s * 1e-12, 0.0]
    peak, stop = 0.0, end + 20.0 / p
    while now < stop:

        def rhs(x: float, u: np.ndarray, s: float = s) -> list[float]:
            a_g = np.interp(x, t, a, right=0.0)
            return [u[1], -(p**2) * (np.sin(ALPHA * s - u[0]) + a_g / G * np.cos(ALPHA * s - u[0]))]

        def impact(x: float, u: np.ndarray, s: float = s) -> float:
            return s * u[0]

        def ground(x: float, u: np.ndarray) -> float:
            return abs(u[0]) - 0.5 * np.pi

        impact.terminal, impact.direction, ground.terminal = True, -1, True  # type: ignore[attr-defined]
        sol = solve_ivp(rhs, (now, stop), y, rtol=1e-6, atol=1e-9, events=(impact, ground), max_step=max_step)
        peak = max(peak, float(np.abs(sol.y[0]).max()) / ALPHA)
        if len(sol.t_events[1]):
            return True, np.inf
        if not len(sol.t_events[0]):
            break
        now, rate = sol.t_events[0][0], ETA * sol.y_events[0][0][1]
        s = -s
        y = [s * 1e-12, rate]
        if abs(rate) < 1e-4 * p * ALPHA:  # at rest until the ground lifts it again
            later = strong[t[strong] > now]
            if not len(later):
                break
            now, s = t[later[0]], -np.sign(a[later[0]])
            y = [s * 1e-12, 0.0]
    q, rate = sol.y[0, -1], sol.y[1, -1]
    fell = abs(q) > ALPHA and q * rate > 0.0
    return bool(fell), np.inf if fell else peak


class Clock:
    """Time spent in the lane kernels."""

    spent = 0.0


@contextmanager
def in_the_kernel() -> Iterator[Clock]:
    """Measure what the lanes of a map take, without what is packed for them and unpacked after them."""
    clock, kept = Clock(), []
    for name, function in (("lanes.pulses.march", "sweep"), ("lanes.records.march", "march_lanes")):
        lanes = kernels.load(name, compile_them=True)
        work = getattr(lanes, function)

        def timed(*arguments: object, work: Callable[..., object] = work) -> object:
            began = time.process_time()
            found = work(*arguments)
            clock.spent += time.process_time() - began
            return found

        kept.append((lanes, function, work))
        setattr(lanes, function, timed)
    try:
        yield clock
    finally:
        for lanes, function, work in kept:
            setattr(lanes, function, work)


def measure(name: str, excitation: Excitation, n: int, p: float, end: float, max_step: float) -> list[list[str]]:
    rng = np.random.default_rng(1)
    sample = rng.choice(n, SAMPLE, replace=False)
    exact = solve(batch(excitation, n, p, "reference", ("outcome", "theta_peak_over_alpha"))).scalars
    began = time.process_time()  # of this process alone, whatever else the machine does
    theirs = [rk45(excitation, int(i), p, end, max_step) for i in sample]
    per_rk45 = (time.process_time() - began) / SAMPLE
    wrong = np.mean([fell != (exact["outcome"][i] >= 2) for i, (fell, _) in zip(sample, theirs, strict=True)])
    finite = [(x, exact["theta_peak_over_alpha"][i]) for i, (_, x) in zip(sample, theirs, strict=True)]
    errors = [abs(x - y) for x, y in finite if np.isfinite(x) and np.isfinite(y)]
    rows = [
        [name, "solve_ivp RK45 1e-6, events", f"{1.0 / per_rk45:.4g}", "1", f"{np.median(errors):.1e}", f"{wrong:.4f}"]
    ]
    for accuracy in ("draft", "standard", "reference"):
        for label, scalars in (
            ("outcome only", ("outcome",)),
            ("peaks and impacts", ("outcome", "theta_peak_over_alpha", "n_impacts")),
        ):
            work = batch(excitation, n, p, accuracy, scalars)
            scalars_found = solve(work).scalars
            spent, within = [], []
            for _ in range(5):
                with in_the_kernel() as clock:
                    began = time.process_time()
                    solve(work)
                    spent.append(time.process_time() - began)
                within.append(clock.spent)
            rate = n / min(spent)
            wrong = np.mean((scalars_found["outcome"] >= 2) != (exact["outcome"] >= 2))
            both = np.isfinite(scalars_found["theta_peak_over_alpha"]) & np.isfinite(exact["theta_peak_over_alpha"])
            error = np.abs(scalars_found["theta_peak_over_alpha"][both] - exact["theta_peak_over_alpha"][both])
            stated = f"{np.median(error):.1e}" if label != "outcome only" else ""
            rows.append(
                [name, f"event, {accuracy}, {label}", f"{rate:.4g}", f"{rate * per_rk45:.0f}", stated, f"{wrong:.5f}"]
            )
            if min(within) > 0.0:
                alone = n / min(within)
                words = f"event, {accuracy}, {label}, in the kernel"
                rows.append([name, words, f"{alone:.4g}", f"{alone * per_rk45:.0f}", stated, f"{wrong:.5f}"])
    return rows


def write(rows: list[list[str]]) -> None:
    """Put the rows in place of those of the same workloads on this machine."""
    path, here = HERE / "results" / "throughput.csv", machine()
    mine = {row[0] for row in rows}
    with path.open(newline="") as file:
        heads, *others = csv.reader(file)
    others = [row for row in others if row[0] not in mine or row[-1] != here]
    made = [[*row, date.today().isoformat(), here] for row in rows]
    with path.open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([heads, *others, *made])


def main() -> None:
    n = 200
    A, Omega = (x.ravel() for x in np.meshgrid(np.linspace(0.5, 6.0, n), np.linspace(0.5, 8.0, n)))
    pulses = make_pulses("ricker", a_p=A * G * np.tan(ALPHA), omega_p=Omega)
    still = np.full(n * n, np.nan)
    rows = measure(
        "Ricker pulse, 200 x 200 map", Excitation(pulses, None, still), n * n, 1.0, 4.0 * 2.0 * np.pi / 0.5, np.inf
    )
    trace = parse_at2((HERE.parent / "records" / "synthetic_pulse_m70.AT2").read_bytes(), "synthetic_pulse_m70.AT2")
    values = np.asarray(trace.values) * G
    factor = np.linspace(1.0, 4.0, 2000) * G * np.tan(ALPHA) / np.abs(values).max()
    motion = Excitation(Samples(values, trace.dt, factor), None, np.full(len(factor), np.nan))
    rows += measure(
        f"sampled motion, {len(values)} x {trace.dt} s", motion, len(factor), 2.0, trace.dt * len(values), trace.dt
    )
    for row in rows:
        print(*row, sep="  ")
    write(rows)


if __name__ == "__main__":
    main()
