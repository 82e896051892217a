"""Holds `model: auto` against the highest model on scenes that its calibration has not seen.

    nice -n 19 python benchmarks/trial_auto.py

Kept: both stand or both overturn, and theta_peak/alpha is within the tolerance (which is absolute: 0.02 is 2 % of alpha).
200 random scenes (auto_scenes.py, seed 2) of bodies with a column on a Winkler base, with a column on a rigid base,
and without a column, then searches for the overturning amplitude, whose tolerance is relative to that amplitude.
The cost is the time of the solvers, the probing of the cheap models included.  Writes results/trial_auto.csv.
"""

from __future__ import annotations

import csv
from collections.abc import Callable
from datetime import date
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np
from auto_scenes import Array, Scenes, draw
from machine import machine

import rockcli
from rockcli import kernels
from rockcli.scene.auto import COLUMN, RIGID, RUNGS, WINKLER

HERE = Path(__file__).resolve().parent
RESULTS = HERE / "results" / "trial_auto.csv"

SEED, PER_SHAPE, RECORDS, PER_RECORD = 2, 20, 16, 5
TOLERANCES = (0.01, 0.02, 0.05)
SEARCHES = 10

WITHOUT_COLUMN = ("column.E", "column.zeta", "base.kw")
BODIES: dict[str, tuple[tuple[str, ...], dict[str, Any]]] = {
    "column on winkler": ((), {"model": "flexible"}),
    "column": (("base.kw",), {"model": "flexible"}),
    "no column": (WITHOUT_COLUMN, {"model": "rigid"}),
}
"""Body: what is left out of its scenes, and its highest model."""

HIGHEST = dict(zip(BODIES, (WINKLER, COLUMN, RIGID), strict=True))
"""Body: its highest rung."""


def solved(scenes: Scenes, without: tuple[str, ...], **case: Any) -> dict[str, Array]:
    """Outcomes, peaks, times (and rungs) of some scenes, some of whose columns are left out."""
    study = scenes.study(**case)
    rows = list(csv.reader(scenes.table.read_text().splitlines()))
    keep = [i for i, name in enumerate(rows[0]) if name not in without]
    table = scenes.table.with_name(f"{scenes.table.stem}_some.csv")
    with table.open("w", newline="") as file:
        csv.writer(file).writerows([[row[i] for i in keep] for row in rows])
    study["vary"] = {"case": str(table)}
    for part in {name.split(".")[0] for name in without if name != "column.zeta"}:
        del study["case"][part]
    found = rockcli.run(study)
    names = ("outcome", "theta_peak_over_alpha", "wall_time", "model_used", "model_error")
    return {name: found[name].values for name in names if name in found}


def kept(auto: dict[str, Array], reference: dict[str, Array], tolerance: float) -> Array:
    """Where auto kept its promise, (n,); the reference has an answer everywhere it is asked."""
    a, b = auto["theta_peak_over_alpha"], reference["theta_peak_over_alpha"]
    with np.errstate(invalid="ignore"):
        near = (np.isinf(a) & np.isinf(b)) | (np.abs(a - b) <= tolerance * (1.0 + 1e-9))
    return np.asarray(near | (np.isnan(a) & np.isnan(b)))


def trial(
    seed: int, per_shape: int, records: int, per_record: int, tolerances: tuple[float, ...]
) -> list[dict[str, Any]]:
    """A row per body and tolerance: scenes, promises kept, times, scenes on each rung."""
    found: dict[tuple[str, float], list[tuple[dict[str, Array], dict[str, Array]]]] = {}
    with TemporaryDirectory() as folder:
        for scenes in draw(seed, per_shape, records, per_record, Path(folder)):
            for body, (without, highest) in BODIES.items():
                reference = solved(scenes, without, **highest)
                for tolerance in tolerances:
                    auto = solved_auto(scenes, without, tolerance)
                    found.setdefault((body, tolerance), []).append((auto, reference))
    rows = []
    for (body, tolerance), pairs in found.items():
        autos, references = ({k: np.concatenate([p[w][k] for p in pairs]) for k in pairs[0][w]} for w in (0, 1))
        good, cheap = kept(autos, references, tolerance), autos["model_used"] < HIGHEST[body]
        rungs = {name: int((autos["model_used"] == flag).sum()) for flag, name in RUNGS.items() if flag >= 0}
        rows.append(
            {
                "body": body,
                "tolerance": tolerance,
                "scenes": len(good),
                "kept": int(good.sum()),
                "on a cheaper model": int(cheap.sum()),
                "of these kept": int((good & cheap).sum()),
                **rungs,
                "time, highest [s]": float(references["wall_time"].sum()),
                "time, auto [s]": float(autos["wall_time"].sum()),
            }
        )
    return rows


def solved_auto(scenes: Scenes, without: tuple[str, ...], tolerance: float) -> dict[str, Array]:
    """Some scenes by model auto."""
    study: Callable[..., dict[str, Any]] = scenes.study
    case = {**study()["case"], "model": {"name": "auto", "tolerance": tolerance}}
    alike = Scenes(scenes.label, case, scenes.table, scenes.size)
    return solved(alike, without)


def searches(seed: int, n: int, tolerance: float) -> list[dict[str, Any]]:
    """Overturning amplitudes of columns by auto and by the flexible model, over a range of pulses."""
    rng = np.random.default_rng(seed)
    ratios, spent = [], [0.0, 0.0]
    for _ in range(n):
        tan_alpha, R, p_T1 = rng.uniform(0.05, 0.3), np.exp(rng.uniform(0.0, 3.0)), np.exp(rng.uniform(-5.0, -0.5))
        p, h = np.sqrt(0.75 * 9.81 / R), R / np.hypot(1.0, tan_alpha)
        shape = ("ricker", "sine", "half_sine")[int(rng.integers(3))]
        pulse = {"shape": shape, "a_p_over_g_tan_alpha": 1, "omega_p_over_p": float(rng.uniform(2.0, 6.0))}
        case = {
            "block": {"R": float(R), "tan_alpha": float(tan_alpha)},
            "motion": {"pulse": pulse},
            "column": {"E": float(2500.0 * (12.38 * p * h / (tan_alpha * p_T1)) ** 2), "rho": 2500, "zeta": 0.02},
        }
        amplitude = "motion.pulse.a_p_over_g_tan_alpha"
        study = {
            "name": "search",
            "case": case,
            "vary": {amplitude: {"from": 1, "to": 9.8, "n": 45, "find": "overturning"}},
        }
        both = []
        for i, model in enumerate(({"name": "auto", "tolerance": tolerance}, "flexible")):
            began = perf_counter()
            found = rockcli.run({**study, "case": {**case, "model": model}})
            spent[i] += perf_counter() - began
            both.append(float(found["a_p_over_g_tan_alpha_overturning"]))
        ratios.append(1.0 if both[0] == both[1] else both[0] / both[1])
    error = np.abs(np.array(ratios) - 1.0)
    kept_ = int((error <= tolerance).sum())
    row = {"body": "column, find: overturning", "tolerance": tolerance, "scenes": n, "kept": kept_}
    return [{**row, "time, highest [s]": spent[1], "time, auto [s]": spent[0]}]


def main() -> None:
    """Run the trial and write what came of it."""
    kernels.load(compile_them=True)
    rows = trial(SEED, PER_SHAPE, RECORDS, PER_RECORD, TOLERANCES) + searches(SEED, SEARCHES, 0.02)
    head = [*rows[0], "measured", "machine"]
    with RESULTS.open("w", newline="") as file:
        writer = csv.DictWriter(file, head, restval="", lineterminator="\n")
        writer.writeheader()
        for row in rows:
            shown = {k: f"{v:.3g}" if isinstance(v, float) else v for k, v in row.items()}
            print(shown)
            writer.writerow({**shown, "measured": date.today().isoformat(), "machine": machine()})


if __name__ == "__main__":
    main()
