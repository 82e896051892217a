"""Cost of a flexible rocking column at equal error: exact modal steps against a compiled Newmark and penalty loop.

    python benchmarks/flexible_cost.py

Fig. 60 of the source (50 x 5 m column, one sine of T_p = 1.6 s, a_p = 5 g tan alpha, zeta = .01, 16 s), 5 and 20 elements,
lumped masses in both.  Error: largest |theta - theta_ref| over alpha in the history, each solver against its own finest run
(event: `reference`; frame: the smallest step), so that only the numerics are compared; the distance between the two finest
runs is printed.  Each solver runs down its ladder (accuracy levels and steps; time steps and, from 5e-4 s up, two yield
rotations); the cheapest run within 1e-2 and 1e-3 counts.  Baselines: the project's own `frame` backend, compiled, and OpenSees where it is installed (its process start is
in the time).  Times are the best of a few runs after a first one.
Writes results/flexible_cost.csv.
"""

from __future__ import annotations

import csv
import importlib.util
import os
import time
from datetime import date
from pathlib import Path
from typing import Any

os.environ["ROCK_KERNELS"] = "compiled"
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np
from machine import machine

from rockcli.engine.choose import choose
from rockcli.study.open import open_study

HERE = Path(__file__).resolve().parent
END, DT_OUT = 16.0, 0.02
STEPS = {
    5: (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 1e-5),
    20: (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 2e-5),
}
OPENSEES_STEPS = {5: (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 5e-5), 20: (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 1e-4)}
YIELD_ROTATIONS = (1e-6, 1e-5)
EVENT: tuple[tuple[str, dict[str, Any]], ...] = (
    ("draft, dt 0.15 s", {"accuracy": "draft", "dt": 0.15}),
    ("draft", {"accuracy": "draft"}),
    ("standard", {"accuracy": "standard"}),
)


def study(elements: int, solver: dict[str, Any]) -> dict[str, Any]:
    return {
        "name": "cost",
        "case": {
            "block": {"height": 50, "width": 5},
            "motion": {"pulse": {"shape": "sine", "T_p": 1.6, "a_p": "5*g*tan_alpha"}, "duration": END},
            "model": "flexible",
            "damping": "none",
            "column": {"E": "30*GPa", "rho": 2500, "zeta": 0.01, "elements": elements, "mass": "lumped"},
            "solver": solver,
        },
        "save": {"histories": True, "dt_out": DT_OUT, "scalars": ["outcome", "theta_peak_over_alpha"]},
    }


def run(elements: int, solver: dict[str, Any]) -> tuple[np.ndarray, float]:
    """(theta over alpha, seconds of the best of a few runs)."""
    ((_, batch),) = open_study(study(elements, solver)).batches()
    solve = choose(batch).load()
    response = solve(batch)
    times: list[float] = []
    while not times or (sum(times) < 0.5 and len(times) < 20):
        began = time.perf_counter()
        response = solve(batch)
        times.append(time.perf_counter() - began)
    return response.histories["theta"][0] / batch.block.alpha[0, 0], min(times)


def per_case(elements: int, solver: dict[str, Any], cases: int = 50) -> float:
    """Seconds per case of the event solver in a sweep of amplitudes within 1 %, where a column is prepared once."""
    swept = study(elements, {"backend": "event", **solver})
    swept["save"] = {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]}
    swept["vary"] = {"motion.pulse.a_p": {"from": 0.495 * 9.81, "to": 0.505 * 9.81, "n": cases}}
    ((_, batch),) = open_study(swept).batches()
    solve = choose(batch).load()
    solve(batch)
    times = []
    for _ in range(40):
        began = time.perf_counter()
        solve(batch)
        times.append(time.perf_counter() - began)
    return min(times) / cases


def largest(theta: np.ndarray, exact: np.ndarray) -> float:
    """Largest difference of two histories; infinite if one is cut short."""
    k = min(len(theta), len(exact))
    error = np.abs(theta[:k] - exact[:k])
    return float(np.max(error)) if k > 100 and np.isfinite(error).all() else np.inf


def ladder(elements: int, backend: str, steps: tuple[float, ...]) -> tuple[list[tuple[str, float, float]], np.ndarray]:
    """(setting, error against the finest, seconds) of a stepping solver, and its finest history."""
    runs = []
    for dt in steps:
        for rotation in YIELD_ROTATIONS if dt >= 5e-4 else YIELD_ROTATIONS[:1]:
            theta, seconds = run(elements, {"backend": backend, "dt": dt, "yield_rotation": rotation})
            runs.append((f"dt {dt:g} s, theta_y {rotation:g}", theta, seconds))
            print(f"{backend}, {elements} elements, {runs[-1][0]}: {seconds:.3f} s", flush=True)
    finest = runs[-1][1]
    return [(setting, largest(theta, finest), seconds) for setting, theta, seconds in runs[:-1]], finest


def main() -> None:
    rows: list[list[str]] = []
    peers = {"frame": STEPS}
    if importlib.util.find_spec("openseespy"):
        peers["opensees"] = OPENSEES_STEPS
    for elements in (5, 20):
        exact, _ = run(elements, {"backend": "event", "accuracy": "reference"})
        event = []
        for level, solver in EVENT:
            theta, seconds = run(elements, {"backend": "event", **solver})
            event.append((f"{level}, one case", largest(theta, exact), seconds))
            event.append((f"{level}, a case in a sweep of 50", event[-1][1], per_case(elements, solver)))
        for peer, steps in peers.items():
            found, finest = ladder(elements, peer, steps[elements])
            print(
                f"{peer}, {elements} elements: its finest history is {largest(finest, exact):.1e} alpha from the event solver's"
            )
            for bound in (1e-2, 1e-3):
                slow = min((r for r in found if r[1] <= bound), key=lambda r: r[2], default=None)
                head = [str(elements), f"{bound:g}", peer]
                if slow is None:
                    rows.append([*head, "bound not reached", "", "", "", "", "", ""])
                    continue
                for way in ("one case", "a case in a sweep of 50"):
                    fast = min((r for r in event if r[1] <= bound and r[0].endswith(way)), key=lambda r: r[2])
                    ours = [fast[0], f"{fast[1]:.1e}", f"{1e3 * fast[2]:.3g}"]
                    rows.append(
                        [*head, slow[0], f"{slow[1]:.1e}", f"{1e3 * slow[2]:.3g}", *ours, f"{slow[2] / fast[2]:.0f}"]
                    )
    with (HERE / "results" / "flexible_cost.csv").open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        heads = ["elements", "error bound", "peer", "its setting", "its error", "its time [ms]"]
        heads += ["event solver", "its error", "its time [ms]", "ratio of times"]
        table.writerow([*heads, "measured", "machine"])
        for row in rows:
            print(*row, sep="  ")
            table.writerow([*row, date.today().isoformat(), machine()])


if __name__ == "__main__":
    main()
