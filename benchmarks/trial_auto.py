"""Holds `model: auto` against the highest model on scenes that its calibration has not seen.

    nice -n 19 python benchmarks/trial_auto.py

Kept: both stand or both overturn, and theta_peak/alpha is within the tolerance (which is absolute: 0.02 is 2 % of alpha).
Random scenes (auto_scenes.py, seed 2) of bodies without a column, with a column on a rigid base, and with a column on a
Winkler base: 120 under pulses at three tolerances and 2000 under records at the default one, of which every fifth on the
Winkler base.  Then searches for the overturning amplitude, whose tolerance is relative to that amplitude.  Writes
results/trial_auto.csv.  Some six minutes on a core; what auto costs is measured by cost_auto.py.
"""

from __future__ import annotations

import csv
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from auto_scenes import Array, Scenes, draw
from machine import write_results

import rockcli
from rockcli import kernels
from rockcli.scene.auto import CANDIDATES, COLUMN, RIGID, WINKLER

HERE = Path(__file__).resolve().parent
RESULTS = HERE / "results" / "trial_auto.csv"

SEED, PER_SHAPE, RECORDS, PER_RECORD = 2, 20, 80, 25
TOLERANCES = {"pulse": (0.01, 0.02, 0.05), "record": (0.02,)}
WINKLER_EVERY = 5
"""The Winkler base costs most: under records only every fifth scene is solved on it."""

SEARCHES = 10

WITHOUT_COLUMN = ("column.E", "column.zeta", "base.kw")
BODIES: dict[str, tuple[tuple[str, ...], str]] = {
    "column on winkler": ((), "flexible"),
    "column": (("base.kw",), "flexible"),
    "no column": (WITHOUT_COLUMN, "rigid"),
}
"""Body: what is left out of its scenes, and its highest model."""

HIGHEST = dict(zip(BODIES, (WINKLER, COLUMN, RIGID), strict=True))
"""Body: its highest candidate."""


def solved(scenes: Scenes, without: tuple[str, ...], every: int, model: Any) -> dict[str, Array]:
    """Outcomes and peaks (and candidates) of every so many of some scenes, some of whose columns are left out."""
    study = scenes.study(model=model)
    study["save"]["scalars"] = ["outcome", "theta_peak_over_alpha"]
    if isinstance(model, dict):
        study["save"]["scalars"] += ["model_used", "model_error"]
    head, *rows = csv.reader(scenes.table.read_text().splitlines())
    keep = [i for i, name in enumerate(head) if name not in without]
    table = scenes.table.with_name(f"{scenes.table.stem}_some.csv")
    with table.open("w", newline="") as file:
        csv.writer(file).writerows([[row[i] for i in keep] for row in [head, *rows[::every]]])
    study["vary"] = {"case": str(table)}
    for part in {name.split(".")[0] for name in without if name != "column.zeta"}:
        del study["case"][part]
    found = rockcli.run(study)
    return {name: found[name].values for name in study["save"]["scalars"]}


def kept(auto: dict[str, Array], reference: dict[str, Array], tolerance: float) -> Array:
    """Where auto kept its promise, (n,); the reference has an answer everywhere it is asked."""
    a, b = auto["theta_peak_over_alpha"], reference["theta_peak_over_alpha"]
    with np.errstate(invalid="ignore"):
        near = (np.isinf(a) & np.isinf(b)) | (np.abs(a - b) <= tolerance * (1.0 + 1e-9))
    return np.asarray(near | (np.isnan(a) & np.isnan(b)))


def trial(
    seed: int, per_shape: int, records: int, per_record: int, tolerances: dict[str, tuple[float, ...]], every: int
) -> list[dict[str, Any]]:
    """A row per body, kind of motion and tolerance: scenes, promises kept, scenes on each candidate."""
    found: dict[tuple[str, str, float], list[tuple[dict[str, Array], dict[str, Array]]]] = {}
    with TemporaryDirectory() as folder:
        for scenes in draw(seed, per_shape, records, per_record, Path(folder)):
            motion = "record" if scenes.label.startswith("record") else "pulse"
            for body, (without, highest) in BODIES.items():
                some = every if motion == "record" and body == "column on winkler" else 1
                reference = solved(scenes, without, some, highest)
                for tolerance in tolerances[motion]:
                    auto = solved(scenes, without, some, {"name": "auto", "tolerance": tolerance})
                    found.setdefault((body, motion, tolerance), []).append((auto, reference))
    rows = []
    for (body, motion, tolerance), pairs in found.items():
        autos, references = ({k: np.concatenate([p[w][k] for p in pairs]) for k in pairs[0][w]} for w in (0, 1))
        good, cheap = kept(autos, references, tolerance), autos["model_used"] < HIGHEST[body]
        candidates = {name: int((autos["model_used"] == flag).sum()) for flag, name in CANDIDATES.items() if flag >= 0}
        rows.append(
            {
                "body": body,
                "motion": motion,
                "tolerance": tolerance,
                "scenes": len(good),
                "kept": int(good.sum()),
                "on a cheaper model": int(cheap.sum()),
                "of these kept": int((good & cheap).sum()),
                **candidates,
            }
        )
    return rows


def searches(seed: int, n: int, tolerance: float) -> list[dict[str, Any]]:
    """Overturning amplitudes of columns by auto and by the flexible model, over a range of pulses."""
    rng = np.random.default_rng(seed)
    ratios = []
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
        for model in ({"name": "auto", "tolerance": tolerance}, "flexible"):
            found = rockcli.run({**study, "case": {**case, "model": model}})
            both.append(float(found["a_p_over_g_tan_alpha_overturning"]))
        ratios.append(1.0 if both[0] == both[1] else both[0] / both[1])
    error = np.abs(np.array(ratios) - 1.0)
    kept_ = int((error <= tolerance).sum())
    return [
        {"body": "column, find: overturning", "motion": "pulse", "tolerance": tolerance, "scenes": n, "kept": kept_}
    ]


def main() -> None:
    """Run the trial and write what came of it."""
    kernels.load(compile_them=True)
    rows = trial(SEED, PER_SHAPE, RECORDS, PER_RECORD, TOLERANCES, WINKLER_EVERY) + searches(SEED, SEARCHES, 0.02)
    shown = [{k: f"{v:.3g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows]
    print(*shown, sep="\n")
    write_results(RESULTS, list(rows[0]), [[row.get(name, "") for name in rows[0]] for row in shown])


if __name__ == "__main__":
    main()
