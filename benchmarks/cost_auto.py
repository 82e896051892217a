"""What `model: auto` costs, over what the model costs that it replaces, by family of scenes.

    nice -n 10 python benchmarks/cost_auto.py

Every family is a small study, solved in turn by auto and by the highest model its bodies have; the cost is the CPU time
of the whole run (the choice, the trials and the dataset included), the median of turns; the ratio is the median of
those of each turn, which other work on the machine disturbs least.  Kernels are compiled before.
Writes results/cost_auto.csv.  Some seven minutes on a core.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from auto_scenes import RHO, ROOT
from machine import write_results

import rockcli
from rockcli import kernels
from rockcli.scene.auto import CANDIDATES

RESULTS = Path(__file__).resolve().parent / "results" / "cost_auto.csv"

FEWEST, MOST, ENOUGH = 7, 31, 3.0
"""Turns of a family: as many as take some seconds of CPU by either model, within bounds."""

PULSE = {"pulse": {"shape": "ricker", "a_p_over_g_tan_alpha": 1.0, "omega_p_over_p": 5.0}}
RECORD = {"record": {"file": str(ROOT / "records" / "synthetic_soil_m70.AT2"), "pga_over_g_tan_alpha": 1.0}}
AMPLITUDE = {"pulse": "motion.pulse.a_p_over_g_tan_alpha", "record": "motion.record.pga_over_g_tan_alpha"}
PEAKS = ["outcome", "theta_peak_over_alpha"]


def grid(motion: str, block: dict[str, Any], amplitudes: int, others: int) -> dict[str, Any]:
    """Amplitudes from below uplift, and frequencies of a pulse or sizes of a body under a record."""
    size = "block.R" if "R" in block else "block.h"
    other = ("motion.pulse.omega_p_over_p", 1.5, 20, others) if motion == "pulse" else (size, 1, 20, others)
    axes = ((AMPLITUDE[motion], 0.6, 8, amplitudes), other)
    return {path: {"from": low, "to": high, "n": n} for path, low, high, n in axes}


def families() -> Iterator[tuple[str, dict[str, Any], str]]:
    """Name, study without its model, and the model that auto stands in for."""
    bodies = {
        "slender": {"R": 2.0, "tan_alpha": 0.04},
        "of 0.15": {"R": 2.0, "tan_alpha": 0.15},
        "stocky": {"R": 2.0, "tan_alpha": 0.4},
        "asymmetric": {"h": 2.0, "b": [0.2, 0.4]},
    }
    for motion, ground in (("pulse", PULSE), ("record", RECORD)):
        asked = {
            "peaks": ((120, 120) if motion == "pulse" else (60, 40), {"histories": False, "scalars": PEAKS}),
            "scalars": ((20, 15), {"histories": False}),
            "histories": ((6, 6), {"histories": True}),
        }
        for body, block in bodies.items():
            for what, (sizes, save) in asked.items():
                study = {"case": {"block": block, "motion": ground}, "vary": grid(motion, block, *sizes), "save": save}
                yield f"{motion}, {body}, {what}", study, "rigid"
        for body in ("slender", "stocky"):
            block = bodies[body]
            column = {"E": 1.0, "rho": RHO, "zeta": 0.02}
            moduli = [modulus(block, p_T1) for p_T1 in (0.005, 0.03, 0.15, 0.6)]
            amplitudes = {"from": 0.6, "to": 7, "n": 9}
            case = {"block": block, "motion": ground, "column": column}
            vary = {AMPLITUDE[motion]: amplitudes, "column.E": moduli}
            save = {"histories": False}
            yield f"{motion}, {body} column", {"case": case, "vary": vary, "save": save}, "flexible"
            base = {"law": "winkler", "kw": 1e10}
            vary = {AMPLITUDE[motion]: {**amplitudes, "n": 5}, "column.E": moduli[1::2]}
            study = {"case": {**case, "base": base}, "vary": vary, "save": save}
            yield f"{motion}, {body} column on winkler", study, "flexible"
            one = {"case": {**case, "column": {**column, "E": moduli[2]}, "motion": at(ground, 2.5)}, "save": save}
            yield f"{motion}, {body} column, one case", one, "flexible"
            outcomes = {"histories": False, "scalars": ["outcome"]}
            search = {AMPLITUDE[motion]: {"from": 1, "to": 9, "n": 33, "find": "overturning"}, "column.E": moduli[1:3]}
            yield f"{motion}, {body} column, search", {"case": case, "vary": search, "save": outcomes}, "flexible"


def at(ground: dict[str, Any], amplitude: float) -> dict[str, Any]:
    """A motion of another amplitude."""
    ((kind, motion),) = ground.items()
    return {kind: {**motion, AMPLITUDE[kind].split(".")[-1]: amplitude}}


def modulus(block: dict[str, Any], p_T1: float) -> float:
    """E [N/m^2] of a column of a given p T_1."""
    h = block["R"] / np.hypot(1.0, block["tan_alpha"])
    return float(RHO * (12.38 * np.sqrt(0.75 * 9.81 / block["R"]) * h / (block["tan_alpha"] * p_T1)) ** 2)


def spent(study: dict[str, Any]) -> float:
    """CPU time of a run [s]."""
    began = process_time()
    rockcli.run(study)
    return process_time() - began


def measured(study: dict[str, Any], highest: str) -> dict[str, Any]:
    """CPU times of auto and of the highest model, and the share of the cases on each candidate."""
    by = {"auto": "auto", "highest": highest}
    studies = {name: {**study, "case": {**study["case"], "model": model}} for name, model in by.items()}
    warm = {name: spent(one) for name, one in studies.items()}
    taken: dict[str, list[float]] = {name: [] for name in studies}
    for turn in range(int(np.clip(ENOUGH / warm["highest"], FEWEST, MOST))):
        for name, one in list(studies.items())[:: 1 - 2 * (turn % 2)]:  # neither is always first
            taken[name].append(spent(one))
    row = {**{f"{name} [s]": float(np.median(seconds)) for name, seconds in taken.items()}}
    row["ratio"] = float(np.median(np.divide(taken["auto"], taken["highest"])))
    found = rockcli.run(studies["auto"])
    if "outcome" in found:
        row["cases"] = found["outcome"].size
    if "model_used" in found:
        used = found["model_used"].values.astype(int)
        row |= {name: int((used == flag).sum()) for flag, name in CANDIDATES.items() if flag >= 0}
    return row


def main() -> None:
    """Measure every family and write what came of it."""
    kernels.load(compile_them=True)
    rows = []
    for family, study, highest in families():
        rows.append({"family": family, "highest": highest, **measured(study, highest)})
        print({k: f"{v:.3g}" if isinstance(v, float) else v for k, v in rows[-1].items()}, flush=True)
    head = list(dict.fromkeys(name for row in rows for name in row))
    cells = [[row.get(name, "") for name in head] for row in rows]
    write_results(RESULTS, head, [[f"{v:.3g}" if isinstance(v, float) else v for v in row] for row in cells])


if __name__ == "__main__":
    main()
