"""Cost of a flexible rocking column at equal error: exact modal steps against a compiled Newmark and penalty loop.

    python benchmarks/flexible_cost.py

Fig. 60 of the source (50 x 5 m column, one sine of T_p = 1.6 s, a_p = 5 g tan alpha, zeta = .01, 16 s), 5 and 20 elements,
lumped masses in both.  Error: largest |theta - theta_ref| over alpha in the history, each solver against its own finest run
(event: `reference`; frame: the smallest step), so that only the numerics are compared; the distance between the two finest
runs is printed.  Each solver runs down its ladder (accuracy levels; time steps); the cheapest run within 1e-2 and 1e-3
counts.  The baseline is the project's own `frame` backend, compiled.  Times are of the second run.
Writes results/flexible_cost.csv.
"""

from __future__ import annotations

import csv
import os
import time
from datetime import date
from pathlib import Path
from typing import Any

os.environ["ROCK_KERNELS"] = "compiled"

import numpy as np
from machine import machine

from rockcli.engine.choose import choose
from rockcli.study.open import open_study

HERE = Path(__file__).resolve().parent
END, DT_OUT = 16.0, 0.02
STEPS = {5: (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 1e-5), 20: (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 2e-5)}
YIELD_ROTATION = 1e-6


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
    """(theta over alpha, seconds of the second run)."""
    ((_, batch),) = open_study(study(elements, solver)).batches()
    solve = choose(batch).load()
    solve(batch)
    began = time.perf_counter()
    response = solve(batch)
    seconds = time.perf_counter() - began
    return response.histories["theta"][0] / batch.block.alpha[0, 0], seconds


def main() -> None:
    rows: list[list[str]] = []
    for elements in (5, 20):
        exact, _ = run(elements, {"backend": "event", "accuracy": "reference"})

        def error_of(theta: np.ndarray, exact: np.ndarray = exact) -> float:
            k = min(len(theta), len(exact))
            error = np.abs(theta[:k] - exact[:k])
            return float(np.max(error)) if k > 100 and np.isfinite(error).all() else np.inf

        event = [
            (level, *(lambda out: (error_of(out[0]), out[1]))(run(elements, {"backend": "event", "accuracy": level})))
            for level in ("draft", "standard")
        ]
        runs = []
        for dt in STEPS[elements]:
            runs.append((dt, *run(elements, {"backend": "frame", "dt": dt, "yield_rotation": YIELD_ROTATION})))
            print(f"{elements} elements, dt {dt:g} s: {runs[-1][2]:.3f} s", flush=True)
        finest = runs[-1][1]
        print(f"{elements} elements: the two finest histories differ by {error_of(finest):.1e} alpha")
        frame = [(f"dt {dt:g} s", error_of(theta, finest), seconds) for dt, theta, seconds in runs[:-1]]
        for bound in (1e-2, 1e-3):
            fast = min((r for r in event if r[1] <= bound), key=lambda r: r[2])
            slow = min((r for r in frame if r[1] <= bound), key=lambda r: r[2], default=None)
            rows.append([str(elements), f"{bound:g}", "event", fast[0], f"{fast[1]:.1e}", f"{1e3 * fast[2]:.3g}", "1"])
            if slow is None:
                best = min(frame, key=lambda r: r[1])
                ratio = f"> {best[2] / fast[2]:.0f} (bound not reached)"
                rows.append([str(elements), f"{bound:g}", "frame", best[0], f"{best[1]:.1e}", f"{1e3 * best[2]:.3g}", ratio])
            else:
                ratio = f"{slow[2] / fast[2]:.0f}"
                rows.append([str(elements), f"{bound:g}", "frame", slow[0], f"{slow[1]:.1e}", f"{1e3 * slow[2]:.3g}", ratio])
    with (HERE / "results" / "flexible_cost.csv").open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        heads = ["elements", "error bound", "solver", "setting", "error", "time [ms]", "times the event solver"]
        table.writerow([*heads, "measured", "machine"])
        for row in rows:
            print(*row, sep="  ")
            table.writerow([*row, date.today().isoformat(), machine()])


if __name__ == "__main__":
    main()
