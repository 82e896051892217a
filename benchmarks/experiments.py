"""Predictions of overturned boulders on a shaking table: the program, published simulators, and intensity alone.

    python benchmarks/experiments.py --fit FOLDER --score FOLDER --json

A folder holds runs_unl_granite.csv (a line a test), motions.npz (the table's acceleration) and, if others are to be
compared, published_predictions.csv; the outlines of the scan, outline_unl_granite.csv, lie beside or above it.

FIT and SCORE the same: 5 folds x 5 of whole ground motions.  Else the runs of FIT calibrate, those of SCORE are
predicted.  Nothing is fitted on a ground motion that is scored.  The scores of a specimen are those of one location and
one scatter; `by_day`: the location may wander from one day of tests to the next; `unfitted`: the scan, falling in its
weakest plane.

    --csv FILE writes the scores as a table, --figure FILE.svg the reliability of each specimen
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import sys
import tempfile
import time
from dataclasses import asdict, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import ndtr
from scipy.stats import norm, qmc

from rockcli.analysis.experiments.baselines import forest, has_forest
from rockcli.analysis.experiments.calibration import AMPLITUDES, LAPSE, capacities
from rockcli.analysis.experiments.scores import NAMES, divide_groups, mcnemar, scored
from rockcli.engine.experiments.calibrate import Calibration, predicted
from rockcli.engine.experiments.runs import Runs, read_runs
from rockcli.engine.experiments.score import STUDY, Options, Prediction, Report, intensities, report_of
from rockcli.engine.experiments.score_page import write
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

WEAKEST, AZIMUTH = 334.0, 12.0
"""Direction of the least barrier of the scan, and the standard deviation of how well it is known [degrees]."""

DIRECTIONS = (320, 330, 334, 335, 336, 337, 338, 340, 345, 350)
"""Of the scan as it stands, with Housner's loss: what falls in its weakest plane is a body of these."""

DRAWN, SEED = 60, 1
"""Bodies drawn from what is not known, and the seed of the Latin hypercube."""

TILT, SIZE = 0.7, 0.03
"""Standard deviations: of how the boulder stands against its scan, as two scans of it differ [degrees]; of its size."""

LOSSES = (0.65, 1.0, 1.5)
"""Powers of Housner's loss, equally likely."""

CAPACITY = 0.2
"""Standard deviation of the logarithm of the capacity where nothing is fitted."""

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
    # what is not measured in every run is that of the motions
    measured = {
        name: [row.get(column) or "" for row in rows]
        for name, column in (("pga", "pga_recorded_25Hz_g"), ("pgv", "pgv_recorded_m_s"))
    }
    measured = {name: cells for name, cells in measured.items() if all(map(_is_positive, cells))}
    days = [row.get("date") or "" for row in rows]
    columns = {**measured, **({"session": days} if all(days) else {})}
    found = {}
    for specimen in SPECIMENS:
        names = [name for name in next(iter(others.values()), {}) if _is_of(name, specimen)]
        path = work / f"specimen{specimen}.csv"
        with path.open("w", newline="") as out:
            table = csv.writer(out)
            table.writerow(["record", "outcome", "group", *columns, *names])
            for i, row in enumerate(rows):
                said = others.get(row["run"], {})
                cells = [f"{row['run']}.txt", row[f"outcome_specimen{specimen}"], row["split_group"]]
                table.writerow(cells + [c[i] for c in columns.values()] + [said.get(name, "") for name in names])
        found[specimen] = read_runs(path)
    return found


def _is_positive(cell: str) -> bool:
    try:
        return 0.0 < float(cell) < math.inf
    except ValueError:
        return False


def _is_of(name: str, specimen: str) -> bool:
    return f"_sp{specimen}_" in name or (name.startswith("vsr2") and specimen == "1")


def outlines_of(*folders: Path) -> Path:
    """The file of the outlines, in one of the folders or above it."""
    for folder in folders:
        for at in (folder, *folder.resolve().parents):
            if (at / OUTLINES).exists():
                return at / OUTLINES
    raise FileNotFoundError(f"{OUTLINES} is in none of {', '.join(map(str, folders))}, nor above them")


def outlines(path: Path) -> dict[int, dict[str, Any]]:
    """Direction -> block of the scan seen along it."""
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


def bodies(path: Path) -> dict[float, dict[str, dict[str, Any]]]:
    """Loss -> label -> block: the scan in DIRECTIONS with either sign of the motion, and DRAWN ones."""
    seen = outlines(path)
    known = np.array(sorted(seen))
    found: dict[float, dict[str, dict[str, Any]]] = {1.0: {}}
    for direction in DIRECTIONS:
        for sign in (1, -1):
            found[1.0][f"{direction} {sign:+}"] = _placed(seen[direction], sign, 0.0, 1.0)
    u = qmc.LatinHypercube(5, seed=SEED).random(DRAWN)
    z = norm.ppf(u)
    for row, unit in zip(z, u, strict=True):
        off = (known - (WEAKEST + AZIMUTH * row[0]) + 180.0) % 360.0 - 180.0
        direction = int(known[np.argmin(np.abs(off))])
        tilt, size, sign = TILT * row[1], 1.0 + SIZE * row[3], 1 if unit[4] < 0.5 else -1
        loss = LOSSES[int(len(LOSSES) * unit[2])]
        label = f"{direction} {sign:+}, tilt {tilt:.2f}, size {size:.3f}"
        found.setdefault(loss, {})[label] = _placed(seen[direction], sign, tilt, size)
    return found


def _placed(block: dict[str, Any], sign: int, tilt: float, size: float) -> dict[str, Any]:
    """An outline turned about its centre of mass [degrees], of another size, and seen from behind for the sign -1."""
    c, s = math.cos(math.radians(tilt)), math.sin(math.radians(tilt))
    points = size * np.array(block["outline"]) @ np.array([[c, s], [-s, c]])
    if sign < 0:
        points = (points * [-1, 1])[::-1]
    return {**block, "outline": points.tolist(), "r_g": size * block["r_g"]}


def solved(path: Path, runs: Runs, team: Team) -> Simulated:
    """All bodies under the motions of all runs."""
    parts = []
    for loss, blocks in bodies(path).items():
        study = {
            "name": "outlines",
            "case": {
                "block": next(iter(blocks.values())),
                "motion": {"record": {"units": "g", "dt": 0.005}},
                "damping": {"scheme": "restitution", "loss": loss},
            },
            "vary": {"block": blocks},
        }
        part = simulate(study, runs, AMPLITUDES.tolist(), team=team)
        parts.append(replace(part, inputs=part.inputs | {"loss": np.full(len(blocks), loss)}))
    inputs = {name: np.concatenate([part.inputs[name] for part in parts]) for name in ("block", "loss")}
    return replace(parts[0], share=np.concatenate([part.share for part in parts], axis=1), inputs=inputs)


def some(known: Simulated, runs: np.ndarray) -> Simulated:
    return replace(known, share=known.share[runs])


def unfitted(known: Simulated) -> Prediction:
    """Nothing fitted: shaken along an azimuth about WEAKEST, a boulder falls in the plane that falls first.

    In a plane at an angle d to the azimuth the motion is cos(d) times itself.  The mean over nine azimuths, equally
    likely, and either sign of the motion.
    """
    log_capacity = capacities(known.share, known.amplitudes)
    labels = known.inputs["block"].tolist()
    planes = np.array(DIRECTIONS, dtype=float)
    azimuths = WEAKEST + AZIMUTH * norm.ppf((np.arange(9) + 0.5) / 9.0)
    p = []
    for sign in (1, -1):
        of = log_capacity[:, [labels.index(f"{direction} {sign:+}") for direction in DIRECTIONS]]
        for azimuth in azimuths.tolist():
            least = (of - np.log(np.cos(np.radians(planes - azimuth)))).min(axis=1)
            p.append(LAPSE + (1.0 - 2.0 * LAPSE) * ndtr(-least / CAPACITY))
    return Prediction(STUDY, np.mean(p, axis=0))


def calibrated(fit: Calibration, known: Simulated, runs: Runs, same: bool, options: Options) -> Prediction:
    session = runs.session if fit.session else ()
    return predicted(fit, known, runs.labels, options, leave_out=same, session=session)[0]


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
    return np.array(["placeholder" in (row.get("flag") or "") for row in tests_in(folder)])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fit", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--score", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--csv", type=Path, metavar="FILE")
    parser.add_argument("--figure", type=Path, metavar="FILE")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--count", type=int, default=5, help="folds of whole ground motions")
    parser.add_argument("--quick", action="store_true", help="no baselines and no calibrations on few runs")
    said = parser.parse_args()
    for folder in (said.fit, said.score):
        if not all((folder / name).exists() for name in (RUNS, MOTIONS)):
            print(json.dumps({"skipped": f"{folder} has no {RUNS} and {MOTIONS}"}))
            return
    began = time.perf_counter()
    result, reports = scores(said.fit, said.score, workers=said.workers, count=said.count, quick=said.quick)
    result["seconds"] = round(time.perf_counter() - began, 1)
    if said.figure is not None:
        write(reports, said.figure)
    if said.csv is not None:
        as_csv(result, said.csv)
    if said.json:
        print(json.dumps(result, indent=2))
        return
    for specimen in SPECIMENS:
        print(f"specimen {specimen}")
        found = result[f"specimen{specimen}"]
        for name, told in (("calibrated", found), ("by day", found.get("by_day")), ("unfitted", found["unfitted"])):
            if told is not None:
                words = ", ".join(f"{key} {told[key]}" for key in ("accuracy", "balanced_accuracy", "auc", "brier"))
                print(f"  {name:12} n {told['n']}: {words}")


def scores(fit: Path, score: Path, *, workers: int, count: int, quick: bool) -> tuple[dict[str, Any], list[Report]]:
    same = fit.resolve() == score.resolve()
    path, options = outlines_of(fit, score), Options(count=count)
    result: dict[str, Any] = {"fit": str(fit), "score": str(score), "folds": f"{count} x 5" if same else None}
    reports = []
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        (work / "a").mkdir()
        (work / "b").mkdir()
        learnt = tables(fit, work / "a")
        asked = learnt if same else tables(score, work / "b")
        team = Team(workers)
        # the bodies and motions of both specimens are the same: they are solved once
        first = solved(path, learnt["1"], team)
        known = first if same else solved(path, asked["1"], team)
        for specimen in SPECIMENS:
            told, report = _of_specimen(
                specimen, learnt[specimen], asked[specimen], first, known, same=same, options=options, quick=quick
            )
            real = ~placeholders(score)
            for each in (told, told["unfitted"], told.get("by_day")):
                if each is not None:
                    p = each.pop("p")
                    rows = asked[specimen].rows(real)
                    each["without_placeholders"] = numbers(rows, Prediction(STUDY, p[real])) if rows.size else None
            result[f"specimen{specimen}"] = told
            reports.append(report)
    return result, reports


def _of_specimen(
    specimen: str,
    learnt: Runs,
    runs: Runs,
    first: Simulated,
    known: Simulated,
    *,
    same: bool,
    options: Options,
    quick: bool,
) -> tuple[dict[str, Any], Report]:
    calibration = Calibration(first, learnt.outcome, learnt.labels, "")
    main, free = calibrated(calibration, known, runs, same, options), unfitted(known)
    told = numbers(runs, main) | {"p": main.p, "unfitted": numbers(runs, free) | {"p": free.p}}
    if main.repeats is not None:
        told["accuracy_of_repeats"] = [float(np.mean((p >= 0.5) == runs.outcome)) for p in main.repeats]
    plain = calibration.as_plain()
    told["calibration"] = {
        key: plain[key] for key in ("capacity_factor", "capacity_scatter", "bodies", "bodies_effective", "posterior")
    }
    by_day = None
    if learnt.session and runs.session:
        dated = replace(calibration, session=learnt.session)
        by_day = calibrated(dated, known, runs, same, options)
        plain = dated.as_plain()
        kept = {key: plain[key] for key in ("capacity_factor", "capacity_scatter", "session_walk")}
        told["by_day"] = numbers(runs, by_day) | {"p": by_day.p, "calibration": kept}
    report = report_of(
        runs,
        specimen=f"specimen{specimen}",
        study=("outlines", main),
        source=RECORDS,
        options=replace(options, baselines=not quick),
        fitted_on=None if same else learnt,
    )
    told["others"] = {}
    for name, found in report.scores.items():
        if name == "outlines":
            continue
        values = {key: found.scores[key].value for key in ("accuracy", "balanced_accuracy", "brier")}
        other = report.predictions[name].p
        both = ~np.isnan(other)
        tests = {"mcnemar_p": report.mcnemar[name].p_value}
        if by_day is not None:
            tests["mcnemar_p_by_day"] = mcnemar(runs.outcome[both], by_day.p[both], other[both]).p_value
        told["others"][name] = {"n": found.n} | {k: v if math.isfinite(v) else None for k, v in values.items()} | tests
    told["reliability"] = [asdict(one) for one in report.reliability["outlines"]]
    if same and not quick:
        few = {n: after_few(known, runs, n) for n in FEW}
        told["after_few_runs"] = {n: {"outlines": a, "random forest": b} for n, (a, b) in few.items()}
    told["runs"] = [
        {"run": Path(name).stem, "outcome": int(fell), "p": float(p), "unfitted": float(q)}
        | ({} if by_day is None else {"by_day": float(by_day.p[i])})
        for i, (name, fell, p, q) in enumerate(zip(runs.record, runs.outcome, main.p, free.p, strict=True))
    ]
    return told, report


_COLUMNS = ("n", "accuracy", "accuracy_low", "accuracy_high", "balanced_accuracy", "auc", "brier")


def as_csv(result: dict[str, Any], path: Path) -> None:
    """The scores, a line a prediction."""

    def line(told: dict[str, Any]) -> list[Any]:
        ends = told.get("accuracy_interval") or ("", "")
        values = {**told, "accuracy_low": ends[0], "accuracy_high": ends[1]}
        cells = [values.get(name, "") for name in _COLUMNS]
        return [f"{cell:.4f}" if isinstance(cell, float) else cell for cell in cells]

    with path.open("w", newline="") as out:
        table = csv.writer(out, lineterminator="\n")
        table.writerow(["specimen", "prediction", *_COLUMNS, "mcnemar_p", "mcnemar_p_by_day"])
        for specimen in SPECIMENS:
            found = result[f"specimen{specimen}"]
            for name, told in (("calibrated", found), ("by day", found.get("by_day")), ("unfitted", found["unfitted"])):
                if told is not None:
                    table.writerow([specimen, f"outlines {name}", *line(told), "", ""])
                    rest = told["without_placeholders"]
                    table.writerow([specimen, f"outlines {name} without placeholders", *line(rest or {}), "", ""])
            for name, told in found["others"].items():
                tests = [f"{told[key]:.2g}" if key in told else "" for key in ("mcnemar_p", "mcnemar_p_by_day")]
                table.writerow([specimen, name, *line(told), *tests])
            for count, told in found.get("after_few_runs", {}).items():
                for name, value in told.items():
                    table.writerow([specimen, f"{name} after {count} runs", *line({"accuracy": value}), "", ""])


if __name__ == "__main__":
    sys.exit(main())
