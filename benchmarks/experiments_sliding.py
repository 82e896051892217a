"""Does sliding explain boulders that stood above 0.6 g and were called fallen?  A body on two edges, with friction and without.

    python benchmarks/experiments_sliding.py FOLDER

FOLDER as that of `experiments.py`.  Friction is solved for bodies on two edges alone, so they stand for the scan: of its
height and radius of gyration, as wide as makes their barrier (`barrier`), or the tilt at which they fall (`tilt`), that
of the scan in the same direction.  Both sides are alike, so the unknown sign of the motion is of no account.  Every
coefficient of friction has the same bodies, weights and folds; writes benchmarks/results/experiments_sliding.csv.
"""

from __future__ import annotations

import argparse
import csv
import math
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from experiments import AZIMUTH, SPECIMENS, WEAKEST, calibrated, outlines, outlines_of, tables
from machine import machine
from scipy.stats import norm

from rockcli.analysis.experiments.scores import mcnemar
from rockcli.engine.experiments.calibrate import Calibration
from rockcli.engine.experiments.runs import Runs
from rockcli.engine.experiments.score import STUDY, Options, Prediction
from rockcli.engine.experiments.simulated import Simulated, simulate
from rockcli.engine.sweep.work import Team
from rockcli.scene.body.lower_outline import facets_of
from rockcli.study.open import open_study

RESULTS = Path(__file__).resolve().parent / "results" / "experiments_sliding.csv"

DIRECTIONS = (334, 338, 345, 350)
"""Of the scan [degrees]."""

FRICTION = (None, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0)
"""Coefficients; without one a body cannot slide."""

SHAPES = ("barrier", "tilt")

AMPLITUDES = np.geomspace(0.5, 2.0, 13)

STRONG = 0.6
"""PGA above which boulders may have slid [g]."""


def bodies(folder: Path) -> dict[str, Any]:
    """Label "direction shape mu" -> block."""
    found = {}
    blocks = outlines(outlines_of(folder))
    for direction in DIRECTIONS:
        scan = blocks[direction]
        case = {"block": scan, "motion": {"pulse": {"shape": "sine", "a_p": "0.1*g", "T_p": 1.0}}}
        ((_, batch),) = open_study({"name": "scan", "case": case}).batches()
        facets = facets_of(batch.block.vertices)
        h = float(facets.height[0, facets.standing[0]])
        widths = {
            "barrier": math.sqrt((h + float(facets.barrier[0].min())) ** 2 - h**2),
            "tilt": h * math.tan(float(np.abs(facets.fall[0]).min())),
        }
        for shape, b in widths.items():
            body = {"outline": [[-b, 0], [b, 0], [b, 2 * h], [-b, 2 * h]], "centre": [0, h], "r_g": scan["r_g"]}
            for mu in FRICTION:
                found[f"{direction} {shape} {mu}"] = body if mu is None else {**body, "mu": mu}
    return found


def study(folder: Path) -> dict[str, Any]:
    blocks = bodies(folder)
    return {
        "name": "two_edges",
        "case": {"block": next(iter(blocks.values())), "motion": {"record": {"units": "g", "dt": 0.005}}},
        "vary": {"block": blocks},
    }


def part(known: Simulated, shape: str, mu: float | None) -> Simulated:
    """The bodies of one shape and coefficient of friction; labels are their directions."""
    labels = [label.split() for label in known.inputs["block"].tolist()]
    chosen = np.array([its == [shape, str(mu)] for _, *its in labels])
    directions = np.array([direction for direction, *_ in labels])[chosen]
    return replace(known, share=known.share[:, chosen], inputs={"block": directions})


def unfitted(known: Simulated) -> Prediction:
    """The share that overturns at the motion's own amplitude, directions by a normal law."""
    direction = np.array([float(label) for label in known.inputs["block"]])
    off = (direction - WEAKEST + 180.0) % 360.0 - 180.0
    distinct = np.unique(off)
    edges = np.concatenate([[-np.inf], 0.5 * (distinct[1:] + distinct[:-1]), [np.inf]])
    mass = dict(zip(distinct.tolist(), np.diff(norm.cdf(edges, 0.0, AZIMUTH)).tolist(), strict=True))
    weight = np.array([mass[value] for value in off.tolist()])
    at = int(np.argmin(np.abs(np.log(known.amplitudes))))
    share = np.where(np.isnan(known.share[:, :, at]), 0.5, known.share[:, :, at])
    return Prediction(STUDY, share @ (weight / weight.sum()))


def row(runs: Runs, p: np.ndarray, strong: np.ndarray, without: np.ndarray) -> list[Any]:
    """Scores on all runs and on the strong ones, and McNemar's test against the same without friction."""
    called, fell = p >= 0.5, runs.outcome.astype(bool)
    right, before = called == fell, (without >= 0.5) == fell
    balanced = 0.5 * (right[fell].mean() + right[~fell].mean())
    told = [len(p), right.mean(), balanced, np.mean((p - fell) ** 2)]
    told += [strong.sum(), right[strong].mean(), (called & ~fell & strong).sum(), (~called & fell & strong).sum()]
    told += [(right & ~before & strong).sum(), (~right & before & strong).sum()]
    told.append(mcnemar(fell, called, without >= 0.5).p_value)
    return [round(float(value), 4) if isinstance(value, float) else int(value) for value in told]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("--workers", type=int, default=2)
    said = parser.parse_args()
    if not (said.folder / "motions.npz").exists():
        parser.error(f"{said.folder} has no motions.npz")
    head = [
        "specimen",
        "shape",
        "prediction",
        "mu",
        "n",
        "accuracy",
        "balanced_accuracy",
        "brier",
        "n_strong",
        "accuracy_strong",
        "false_strong",
        "missed_strong",
        "mended_strong",
        "spoilt_strong",
        "mcnemar_p",
        "no_answer",
        "machine",
    ]
    rows = []
    with tempfile.TemporaryDirectory() as work:
        asked = tables(said.folder, Path(work))
        known = simulate(study(said.folder), asked["1"], AMPLITUDES.tolist(), team=Team(said.workers))
    for specimen in SPECIMENS:
        runs = asked[specimen]
        strong = np.asarray(runs.measures["pga"]) > STRONG
        for shape in SHAPES:
            without: dict[str, np.ndarray] = {}
            for mu in FRICTION:
                its = part(known, shape, mu)
                fit = Calibration(its, runs.outcome, runs.labels, "")
                for name, found in (
                    ("unfitted", unfitted(its)),
                    ("calibrated", calibrated(fit, its, runs, True, Options())),
                ):
                    p = found.p
                    told = row(runs, p, strong, without.setdefault(name, p))
                    unknown = round(float(np.isnan(its.share).mean()), 4)
                    rows.append([specimen, shape, name, mu or "", *told, unknown, machine()])
                    print(*rows[-1], flush=True)
    with RESULTS.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *rows])


if __name__ == "__main__":
    main()
