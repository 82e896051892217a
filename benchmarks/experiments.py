"""Predictions of overturned boulders on a shaking table: the program, published simulators, and intensity alone.

    python benchmarks/experiments.py --fit FOLDER --score FOLDER --json

A folder holds runs_unl_granite.csv (a line a test), motions.npz (the table's acceleration) and, if others are to be
compared, published_predictions.csv; the outlines of the scan, outline_unl_granite.csv, lie beside or above it.

FIT and SCORE the same: 5 folds x 5 of whole ground motions.  Else the runs of FIT calibrate, those of SCORE are
predicted.  Nothing is fitted on a ground motion that is scored.  `unfitted`: the scan in the direction of its weakest
barrier, 12 degrees of standard deviation, either sign of the motion equally likely.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import sys
import tempfile
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import norm

from rockcli.analysis.experiments.baselines import forest, has_forest
from rockcli.analysis.experiments.scores import NAMES, divide_groups, scored
from rockcli.engine.experiments.calibrate import Calibration, predicted
from rockcli.engine.experiments.runs import Runs, read_runs
from rockcli.engine.experiments.score import STUDY, Options, Prediction, intensities, report_of
from rockcli.engine.experiments.simulated import Simulated, simulate
from rockcli.engine.sweep.work import Team

RUNS, MOTIONS, OTHERS, OUTLINES = (
    "runs_unl_granite.csv",
    "motions.npz",
    "published_predictions.csv",
    "outline_unl_granite.csv",
)

SPECIMENS = ("1", "2")

FALLEN = 45.0
"""Tilt from which on a boulder counts as overturned, whatever it would come to rest on [degrees]."""

DIRECTIONS = (334, 335, 336, 337, 338, 340, 345, 350)
"""Of the scan, degrees: the valley of its least barriers to one side; every one with either sign of the motion."""

LOSSES = (1.0,)
"""Powers of Housner's loss."""

WEAKEST, AZIMUTH = 334.0, 12.0
"""Direction of the least barrier of the scan, and the standard deviation of how well it is met [degrees]."""

AMPLITUDES = np.geomspace(0.5, 2.0, 13)

FEW = (10, 20)
"""Runs of calibration after which the others are scored too, drawn REPEATS times."""

REPEATS = 10


def tests_in(folder: Path) -> list[dict[str, str]]:
    with (folder / RUNS).open(newline="") as lines:
        return [row for row in csv.DictReader(lines) if row["motion"] == "recorded"]


def published(folder: Path) -> dict[str, dict[str, str]]:
    path = folder / OTHERS
    if not path.exists():
        return {}
    with path.open(newline="") as lines:
        return {row.pop("run"): row for row in csv.DictReader(lines)}


def tables(folder: Path, work: Path) -> dict[str, Runs]:
    """The runs of each specimen; motions as files below `work`."""
    motions, others = np.load(folder / MOTIONS), published(folder)
    rows = tests_in(folder)
    for row in rows:
        path = work / f"{row['run']}.txt"
        if not path.exists():
            values = motions[row["run"]] * float(row["scale_g_per_count"])
            path.write_text("\n".join(map(repr, values.tolist())) + "\n")
    found = {}
    for specimen in SPECIMENS:
        names = [name for name in next(iter(others.values()), {}) if _is_of(name, specimen)]
        path = work / f"{folder.resolve().name}_{specimen}.csv"
        with path.open("w", newline="") as out:
            table = csv.writer(out)
            table.writerow(["record", "outcome", "group", "pga", "pgv", *names])
            for row in rows:
                said = others.get(row["run"], {})
                measured = [row["pga_recorded_25Hz_g"], row["pgv_recorded_m_s"]]
                cells = [f"{row['run']}.txt", row[f"outcome_specimen{specimen}"], row["split_group"], *measured]
                table.writerow(cells + [said.get(name, "") for name in names])
        found[specimen] = read_runs(path)
    return found


def _is_of(name: str, specimen: str) -> bool:
    return f"_sp{specimen}_" in name or (name.startswith("vsr2") and specimen == "1")


def outlines(folder: Path) -> dict[int, dict[str, Any]]:
    """Direction -> block of the scan seen along it."""
    path = next((at / OUTLINES for at in (folder, *folder.resolve().parents) if (at / OUTLINES).exists()), None)
    if path is None:
        raise FileNotFoundError(f"{OUTLINES} is neither in {folder} nor above it")
    points: dict[int, list[tuple[float, float]]] = {}
    k2: dict[int, float] = {}
    with path.open(newline="") as lines:
        for row in csv.DictReader(lines):
            direction = int(row["direction_deg"])
            points.setdefault(direction, []).append((float(row["x_m"]), float(row["z_m"])))
            k2[direction] = float(row["k2_m2"])
    top = max(z for rim in points.values() for _, z in rim) + 0.1  # above all that touches the ground
    blocks = {}
    for direction, rim in points.items():
        low = _reached(rim)
        whole = [[*point] for point in low] + [[low[-1][0], top], [low[0][0], top]]
        blocks[direction] = {"outline": whole, "centre": [0, 0], "r_g": math.sqrt(k2[direction]), "stands": "settled"}
    return blocks


def _reached(rim: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """The vertices on facets of at most FALLEN: a boulder that has turned further lies on its side, which is a fall."""
    low: set[int] = set()
    for i, ((x, z), (x_next, z_next)) in enumerate(pairwise(rim)):
        if abs(math.degrees(math.atan2(z_next - z, x_next - x))) <= FALLEN:
            low |= {i, i + 1}
    return [rim[i] for i in sorted(low)]


def study(folder: Path) -> dict[str, Any]:
    """The scan in several directions, with losses, under either sign of the motion."""
    blocks = outlines(folder)
    axis = {f"{direction}": blocks[direction] for direction in DIRECTIONS}
    return {
        "name": "outlines",
        "case": {
            "block": axis[f"{DIRECTIONS[0]}"],
            "motion": {"record": {"units": "g", "dt": 0.005}},
            "damping": {"scheme": "restitution", "loss": LOSSES[0]},
        },
        "vary": {"block": axis, "damping.loss": list(LOSSES), "motion.record.polarity": [1, -1]},
    }


def some(known: Simulated, runs: np.ndarray) -> Simulated:
    return replace(known, share=known.share[runs])


def unfitted(known: Simulated) -> Prediction:
    """The share that overturns at the motion's own amplitude: directions by a normal law, the signs alike, loss 1."""
    direction = np.array([float(label) for label in known.inputs["block"]])
    off = (direction - WEAKEST + 180.0) % 360.0 - 180.0
    distinct = np.unique(off)
    edges = np.concatenate([[-np.inf], 0.5 * (distinct[1:] + distinct[:-1]), [np.inf]])
    mass = dict(zip(distinct.tolist(), np.diff(norm.cdf(edges, 0.0, AZIMUTH)).tolist(), strict=True))
    weight = np.array([mass[value] for value in off.tolist()]) * (known.inputs["damping.loss"] == 1.0)
    at = int(np.argmin(np.abs(np.log(known.amplitudes))))
    share = np.where(np.isnan(known.share[:, :, at]), 0.5, known.share[:, :, at])
    return Prediction(STUDY, share @ (weight / weight.sum()))


def calibrated(fit: Calibration, known: Simulated, runs: Runs, same: bool, options: Options) -> Prediction:
    return predicted(fit, known, runs.labels, options, leave_out=same)[0]


def after_few(known: Simulated, runs: Runs, count: int) -> tuple[float, float]:
    """Mean accuracy after `count` runs of other groups, by the calibration and by a random forest."""
    measured = np.log(np.maximum(np.column_stack(list(intensities(runs, RECORDS).values())), 1e-12))
    groups, right, other = runs.groups, [], []
    for repeat in range(REPEATS):
        rng = np.random.default_rng(repeat)
        held = divide_groups(groups, 2, repeat) == 0  # half of the groups are predicted, from runs of the other half
        chosen = rng.choice(np.flatnonzero(~held), count, replace=False)
        labels = tuple(runs.labels[i] for i in chosen)
        fit = Calibration(some(known, chosen), runs.outcome[chosen], labels, "")
        others = tuple(label for label, out in zip(runs.labels, held, strict=True) if out)
        p, _ = predicted(fit, some(known, np.flatnonzero(held)), others, Options(), leave_out=False)
        right.append(np.mean((p.p >= 0.5) == runs.outcome[held]))
        if has_forest():
            said = forest(measured[chosen], runs.outcome[chosen])(measured[held])
            other.append(np.mean((said >= 0.5) == runs.outcome[held]))
    return float(np.mean(right)), float(np.mean(other)) if other else math.nan


RECORDS: dict[str, Any] = {
    "name": "records",
    "case": {"block": {"R": 1.0, "alpha": 0.2}, "motion": {"record": {"units": "g", "dt": 0.005}}},
}


def numbers(runs: Runs, prediction: Prediction, seed: int = 0) -> dict[str, Any]:
    found = scored(runs.outcome, prediction.p, runs.groups, seed)
    told: dict[str, Any] = {"n": found.n, "overturned": found.events, "missed": found.missed, "false": found.false}
    for name in NAMES:
        score = found.scores[name]
        told[name] = score.value if math.isfinite(score.value) else None
        told[f"{name}_interval"] = [score.low, score.high] if math.isfinite(score.high) else None
    return told


def placeholders(folder: Path) -> np.ndarray:
    return np.array(["placeholder" in row["flag"] for row in tests_in(folder)])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fit", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--score", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--count", type=int, default=5, help="folds of whole ground motions")
    parser.add_argument("--quick", action="store_true", help="no baselines and no calibrations on few runs")
    said = parser.parse_args()
    for folder in (said.fit, said.score):
        if not all((folder / name).exists() for name in (RUNS, MOTIONS)):
            print(json.dumps({"skipped": f"{folder} has no {RUNS} and {MOTIONS}"}))
            return
    began = time.perf_counter()
    result = scores(said.fit, said.score, workers=said.workers, count=said.count, quick=said.quick)
    result["seconds"] = round(time.perf_counter() - began, 1)
    if said.json:
        print(json.dumps(result, indent=2))
        return
    for specimen in SPECIMENS:
        print(f"specimen {specimen}")
        for name in ("calibrated", "unfitted"):
            told = result[f"specimen{specimen}"] if name == "calibrated" else result[f"specimen{specimen}"]["unfitted"]
            words = ", ".join(f"{key} {told[key]:.3f}" for key in ("accuracy", "balanced_accuracy", "auc", "brier"))
            print(f"  {name:12} n {told['n']}: {words}")


def scores(fit: Path, score: Path, *, workers: int, count: int, quick: bool) -> dict[str, Any]:
    same = fit.resolve() == score.resolve()
    bodies, options = study(fit), Options(count=count)
    result: dict[str, Any] = {"fit": str(fit), "score": str(score), "folds": f"{count} x 5" if same else None}
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        (work / "a").mkdir()
        (work / "b").mkdir()
        learnt = tables(fit, work / "a")
        asked = learnt if same else tables(score, work / "b")
        team = Team(workers)
        # the bodies and motions of both specimens are the same: they are solved once
        first = simulate(bodies, learnt["1"], AMPLITUDES.tolist(), team=team)
        known = first if same else simulate(bodies, asked["1"], AMPLITUDES.tolist(), team=team)
        real = ~placeholders(score)
        for specimen in SPECIMENS:
            runs = asked[specimen]
            calibration = Calibration(first, learnt[specimen].outcome, learnt[specimen].labels, "")
            main = calibrated(calibration, known, runs, same, options)
            free = unfitted(known)
            told = numbers(runs, main)
            told["unfitted"] = numbers(runs, free)
            told["without_placeholders"] = numbers(runs.rows(real), replace(main, p=main.p[real], repeats=None))
            told["unfitted"]["without_placeholders"] = numbers(runs.rows(real), replace(free, p=free.p[real]))
            if main.repeats is not None:
                told["accuracy_of_repeats"] = [float(np.mean((p >= 0.5) == runs.outcome)) for p in main.repeats]
            posterior = calibration.as_plain()
            told["calibration"] = {key: posterior[key] for key in ("capacity_factor", "capacity_scatter", "posterior")}
            told["runs"] = [
                {"run": Path(name).stem, "outcome": int(fell), "p": float(p), "unfitted": float(q)}
                for name, fell, p, q in zip(runs.record, runs.outcome, main.p, free.p, strict=True)
            ]
            if not quick:
                report = report_of(
                    runs, study=("outlines", main), source=RECORDS, options=replace(options, baselines=same)
                )
                told["others"] = {
                    name: {"accuracy": found.scores["accuracy"].value, "brier": found.scores["brier"].value}
                    | {"balanced_accuracy": found.scores["balanced_accuracy"].value}
                    | ({"mcnemar_p": report.mcnemar[name].p_value} if name in report.mcnemar else {})
                    for name, found in report.scores.items()
                    if name != "outlines"
                }
                told["reliability"] = [vars(one) for one in report.reliability["outlines"]]
                few = {n: after_few(known, runs, n) for n in FEW} if same else {}
                told["after_few_runs"] = {n: {"outlines": a, "random forest": b} for n, (a, b) in few.items()}
            result[f"specimen{specimen}"] = told
    return result


if __name__ == "__main__":
    sys.exit(main())
