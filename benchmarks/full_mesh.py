"""The thesis's claim about flexible bodies, measured: a column of 5 elements against a full mesh, in one run.

    python benchmarks/full_mesh.py [--duration 10]

Fig. 60 (50 m x 5 m of concrete, one sine of 1.6 s and 5 g tan(alpha)): peak and history of the base rotation of
the event-driven column against a 4 x 40 mesh in CalculiX, and the processor time of both studies, from mapping to
dataset, kernels compiled before.  Needs `ccx`; takes some minutes.  Writes results/full_mesh.csv.
"""

from __future__ import annotations

import argparse
import resource
import time
from pathlib import Path
from typing import Any

import numpy as np
from machine import write_results

import rockcli

HERE = Path(__file__).resolve().parent
REPEATS = 5
COLUMN = {"E": "30*GPa", "rho": 2500}
MODELS: dict[str, dict[str, Any]] = {
    "flexible, n = 5": {"model": "flexible", "column": {"elements": 5}},
    "flexible, n = 40": {"model": "flexible", "column": {"elements": 40}},
    "flexible, n = 5, winkler 1e12": {
        "model": "flexible",
        "column": {"elements": 5},
        "base": {"law": "winkler", "kw": 1e12},
    },
    "rigid block": {"model": "rigid"},
}


def study(how: dict[str, Any], zeta: float, duration: float, accuracy: str = "standard") -> dict[str, Any]:
    """Fig. 60 with one of the models; `how` is laid over the case."""
    case = {
        "block": {"height": 50, "tan_alpha": 0.1},
        "motion": {"pulse": {"shape": "sine", "a_p_over_g_tan_alpha": 5, "T_p": 1.6}, "duration": duration},
        "damping": "none",
        "solver": {"accuracy": accuracy},
        **how,
    }
    if how["model"] != "rigid":
        case["column"] = {**COLUMN, "zeta": zeta, **how.get("column", {})}
    return {"name": "full-mesh", "case": case, "save": {"histories": True, "dt_out": 0.005}}


def cpu(who: int) -> float:
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


def solved(problem: dict[str, Any]) -> tuple[Any, float]:
    """The dataset and the processor time it took, of this process and its children [s]."""
    before = cpu(resource.RUSAGE_SELF) + cpu(resource.RUSAGE_CHILDREN)
    dataset = rockcli.run(problem)
    if int(dataset.outcome) < 0:
        raise SystemExit(f"{problem['case']['model']} failed: {dataset.reasons.values}")
    return dataset, cpu(resource.RUSAGE_SELF) + cpu(resource.RUSAGE_CHILDREN) - before


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--duration", type=float, default=10.0, help="length of the histories [s]")
    options.add_argument("--accuracy", default="standard", help="of the mesh")
    asked = options.parse_args()
    head = [
        "zeta", "model", "theta_peak/alpha", "peak error [%]", "history error [theta/alpha]",
        "bending history error [m]", "CPU of the study [s]", "mesh CPU / CPU",
    ]  # fmt: skip
    rows: list[list[str]] = []
    for zeta in (0.0, 0.01):
        began = time.perf_counter()
        mesh, cost = solved(study({"model": "continuum"}, zeta, asked.duration, asked.accuracy))
        alpha, peak = float(mesh.alpha), float(mesh.theta_peak_over_alpha)
        print(f"mesh, zeta {zeta:g}: {peak:.4f}, {cost:.1f} s of CPU, {time.perf_counter() - began:.1f} s", flush=True)
        rows.append([f"{zeta:g}", "mesh 4 x 40", f"{peak:.4f}", "0", "0", "0", f"{cost:.2f}", "1"])
        for name, how in MODELS.items():
            problem = study(how, zeta, asked.duration)
            solved(problem)  # compiles
            runs = [solved(problem) for _ in range(REPEATS)]
            reduced = runs[0][0]
            whole = min(seconds for _, seconds in runs)
            error = 100.0 * (float(reduced.theta_peak_over_alpha) / peak - 1.0)
            history = float(np.nanmax(np.abs(reduced.theta.values - mesh.theta.values))) / alpha
            bends = "" if how["model"] == "rigid" else f"{bending_error(reduced, mesh):.3f}"
            rows.append(
                [f"{zeta:g}", name, f"{float(reduced.theta_peak_over_alpha):.4f}", f"{error:+.2f}", f"{history:.4f}",
                 bends, f"{whole:.4f}", f"{cost / whole:.0f}"]
            )  # fmt: skip
            print(*rows[-1], sep="  ", flush=True)
    write_results(HERE / "results" / "full_mesh.csv", head, rows)


def bending_error(reduced: Any, mesh: Any) -> float:
    """Largest difference of the displacement of the top due to bending [m]."""
    return float(np.nanmax(np.abs(reduced.u_top_bending.values - mesh.u_top_bending.values)))


if __name__ == "__main__":
    main()
