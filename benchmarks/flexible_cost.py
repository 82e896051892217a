"""Cost of a flexible rocking column at equal error: exact modal steps against Newmark and a penalty spring.

    python benchmarks/flexible_cost.py

Fig. 60 of the thesis (50 x 5 m column, one sine of T_p = 1.6 s, a_p = 5 g tan alpha, zeta = .01, 16 s), 5 and 20 elements,
lumped masses, no loss at landings.  Peers: the project's own `frame` backend, compiled, and OpenSees where it is installed
(its process start is in the time).

Error of a run: largest |theta - theta_ref| over alpha in its history, against the converged history of the same solver
(event: `reference`; a peer: its smallest step), so that only the numerics are compared.  A peer's error falls unevenly, so
a setting reaches a bound if it and every smaller step of the ladder stay within it.  Its cost and that of the event solver
are CPU times, which other work on the machine disturbs little, the best of a few runs taken in turn.

The converged histories differ, since the solvers do not discretise the same column: `frame` shares the additional rotary
inertia out in equal parts (the event solver and OpenSees: half parts at both ends).  The event solver is run with equal
parts too, and its distance to the peer before and after is in the table.
Writes results/flexible_cost.csv.
"""

from __future__ import annotations

import importlib.util
import os
import resource
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

os.environ["ROCK_KERNELS"] = "compiled"
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np
from machine import write_results

from rockcli.engine.backends import choose
from rockcli.solvers.flexible import column as columns
from rockcli.solvers.flexible.beam import Beam, unit_beam
from rockcli.study.open import open_study

HERE = Path(__file__).resolve().parent
END, DT_OUT = 16.0, 0.02
CASES = 50
STEPS = {
    "frame": (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5),
    "opensees": (5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4),
}
EVENT: tuple[dict[str, Any], ...] = (
    *({"accuracy": "draft", "dt": dt} for dt in (0.4, 0.3, 0.2, 0.15, 0.1)),
    {"accuracy": "draft"},
    {"accuracy": "standard"},
)
ROUNDS, ENOUGH = 5, 15.0
"""Runs of each side at most, and seconds after which no further round begins."""

Run = tuple[str, np.ndarray, dict[str, Any]]
"""Setting in words, theta over alpha, the solver's keys."""


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


def one_case(elements: int, solver: dict[str, Any]) -> Callable[[], Any]:
    """Solves the case with its history; the column is prepared each time."""
    ((_, batch),) = open_study(study(elements, solver)).batches()
    solve = choose(batch).load()
    return lambda: solve(batch)


def sweep(elements: int, solver: dict[str, Any]) -> Callable[[], Any]:
    """Solves `CASES` amplitudes within 1 % without histories, the column being prepared once."""
    swept = study(elements, solver)
    swept["save"] = {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]}
    swept["vary"] = {"motion.pulse.a_p": {"from": 0.495 * 9.81, "to": 0.505 * 9.81, "n": CASES}}
    ((_, batch),) = open_study(swept).batches()
    solve = choose(batch).load()
    return lambda: solve(batch)


def history(elements: int, solver: dict[str, Any]) -> np.ndarray:
    """theta over alpha at the output times."""
    return np.asarray(one_case(elements, solver)().histories["theta"][0] / np.arctan(0.1))


def largest(theta: np.ndarray, exact: np.ndarray) -> float:
    """Largest difference of two histories; infinite if one is cut short."""
    k = min(len(theta), len(exact))
    error = np.abs(theta[:k] - exact[:k])
    return float(np.max(error)) if k > 100 and np.isfinite(error).all() else np.inf


def cheapest(runs: list[Run], finest: np.ndarray, bound: float) -> tuple[Run, float] | None:
    """The first run, from coarse to fine, from which on all stay within the bound, and the largest of their errors."""
    errors = [largest(theta, finest) for _, theta, _ in runs]
    within = [max(errors[i:]) <= bound for i in range(len(runs))]
    return (runs[within.index(True)], errors[within.index(True)]) if any(within) else None


def cpu_seconds() -> float:
    """CPU time of this process and of its children that have ended."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def in_turn(*jobs: Callable[[], Any]) -> list[float]:
    """CPU seconds of each job, the best of runs taken in turn; short jobs are run ten times per round."""
    best, began = [np.inf] * len(jobs), time.perf_counter()
    for round_ in range(ROUNDS):
        if round_ > 0 and time.perf_counter() - began > ENOUGH:
            break
        for i, job in enumerate(jobs):
            for _ in range(10 if best[i] < 0.1 else 1):
                start = cpu_seconds()
                job()
                best[i] = min(best[i], cpu_seconds() - start)
    return best


def event_as(peer: str, elements: int) -> np.ndarray:
    """The converged event solver on the peer's column: its shares of rotary inertia."""

    def shared_equally(n: int, mass: str) -> Beam:
        beam = unit_beam(n, mass)
        rotary = np.zeros_like(beam.rotary)
        turning = [0, *range(2, beam.size, 2)]
        rotary[turning, turning] = 1.0 / (n + 1)
        return replace(beam, rotary=rotary)

    try:
        if peer == "frame":
            columns.unit_beam = shared_equally
        return history(elements, {"backend": "event", "accuracy": "reference"})
    finally:
        columns.unit_beam = unit_beam


def ladder(elements: int, peer: str) -> list[Run]:
    """A peer's runs from coarse to fine."""
    runs: list[Run] = []
    for dt in STEPS[peer]:
        solver = {"backend": peer, "dt": dt, "yield_rotation": 1e-6}
        runs.append((f"dt {dt:g} s", history(elements, solver), solver))
    return runs


def main() -> None:
    rows: list[list[str]] = []
    peers = [peer for peer in STEPS if peer == "frame" or importlib.util.find_spec("openseespy")]
    for elements in (5, 20):
        exact = history(elements, {"backend": "event", "accuracy": "reference"})
        ours: list[Run] = []
        for level in EVENT:
            solver = {"backend": "event", **level}
            ours.append((", dt ".join(map(str, level.values())), history(elements, solver), solver))
        for peer in peers:
            runs = ladder(elements, peer)
            finest = runs.pop()[1]
            apart, same = largest(finest, exact), largest(finest, event_as(peer, elements))
            print(f"{peer}, {elements} elements: {apart:.1e} alpha from the event solver; as one column {same:.1e}")
            for name, theta, _ in runs:
                print(f"  {name}: {largest(theta, finest):.1e} from its own finest", flush=True)
            for bound in (1e-2, 1e-3):
                head = [str(elements), f"{bound:g}", peer]
                slow, fast = cheapest(runs, finest, bound), cheapest(ours, exact, bound)
                if slow is None or fast is None:
                    rows.append([*head, "bound not reached", *[""] * 8, f"{apart:.1e}", f"{same:.1e}"])
                    continue
                ((theirs, _, key), error), ((setting, _, mine), small) = slow, fast
                cost, alone, many = in_turn(one_case(elements, key), one_case(elements, mine), sweep(elements, mine))
                each = many / CASES
                times = [f"{1e3 * alone:.3g}", f"{cost / alone:.0f}", f"{1e3 * each:.3g}", f"{cost / each:.0f}"]
                ends = [*times, f"{apart:.1e}", f"{same:.1e}"]
                rows.append([*head, theirs, f"{error:.1e}", f"{1e3 * cost:.3g}", setting, f"{small:.1e}", *ends])
                print(*rows[-1], sep="  ", flush=True)
    heads = ["elements", "error bound", "peer", "its setting", "its error", "its time [ms]", "event solver"]
    heads += ["its error", "one case [ms]", "ratio", "a case in a sweep of 50 [ms]", "ratio"]
    heads += ["converged histories apart", "as the same column"]
    write_results(HERE / "results" / "flexible_cost.csv", heads, rows)


if __name__ == "__main__":
    main()
