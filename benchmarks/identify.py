"""How often `rock identify` finds a shaken body from a wrong first guess, and whether it says so where it does not.

    python benchmarks/identify.py

Blocks under the records of this project, scaled to rock and stand, measured with white noise of 1 % of the peak: eta
alone from up to 0.08 off, and with alpha and p from up to 3 % off.  The truth is `accuracy: reference`.  Writes
results/identify.csv.
"""

from __future__ import annotations

import csv
import time
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
from machine import machine

import rockcli
from rockcli.engine.identify import ALPHA, ETA, Measured, P, guess_of, identify_history

HERE = Path(__file__).resolve().parent
RECORDS = sorted((HERE.parent / "records").glob("*.AT2"))
BODIES, BODIES_WITH_SHAPE = 40, 16
ABOVE = 1.1
"""Scatter over that of the noise up to which a body is found."""


def body(draw: np.random.Generator) -> tuple[dict[str, Any], dict[str, float]] | None:
    """A study and the truth, or None if that body falls or hardly rocks."""
    alpha, R, eta = draw.uniform(0.1, 0.35), draw.uniform(0.4, 3.0), draw.uniform(0.8, 0.96)
    study: dict[str, Any] = {
        "name": "shaken",
        "case": {
            "block": {"R": R, "alpha": alpha},
            "motion": {
                "record": {
                    "file": str(RECORDS[draw.integers(len(RECORDS))]),
                    "pga_over_g_tan_alpha": float(draw.uniform(1.2, 3.5)),
                }
            },
            "damping": {"scheme": "restitution", "eta": eta},
            "solver": {"accuracy": "reference"},
        },
        "save": {"dt_out": 0.01},
    }
    data = rockcli.run(study)
    if int(data["outcome"]) != 1 or float(abs(data["theta_peak_over_alpha"])) < 0.1:
        return None
    return study, {ETA: eta, ALPHA: alpha, P: float(data["p"])}


def trial(seed: int, free: tuple[str, ...]) -> tuple[bool, bool, float] | None:
    """(found, something is said, seconds of processor time) of one body, or None."""
    draw = np.random.default_rng(seed)
    made = body(draw)
    if made is None:
        return None
    study, truth = made
    data = rockcli.run(study)
    theta = data["theta"].values
    theta = theta[np.isfinite(theta)]
    t = data["time"].values[: len(theta)]
    noisy = theta + 0.01 * np.abs(theta).max() * draw.normal(size=len(theta))
    study["case"]["solver"] = {"accuracy": "standard"}
    guess = guess_of(study)
    guess[ETA] = float(np.clip(truth[ETA] + draw.uniform(-0.08, 0.08), 0.5, 0.99))
    for name in set(free) - {ETA}:
        guess[name] = truth[name] * (1.0 + draw.uniform(-0.03, 0.03))
    began = time.process_time()
    found = identify_history(Measured(noisy, t), study, guess, free)
    spent = time.process_time() - began
    near = found.fit.scatter < ABOVE * 0.01 * np.abs(theta).max()
    return bool(near), bool(found.notes), spent


def main() -> None:
    rows = []
    for free, wanted in (((ETA,), BODIES), ((ETA, ALPHA, P), BODIES_WITH_SHAPE)):
        trials: list[tuple[bool, bool, float]] = []
        seed = 0
        while len(trials) < wanted:
            one = trial(seed, free)
            seed += 1
            if one is not None:
                trials.append(one)
                print(seed, free, *one, flush=True)
        found = [right for right, _, _ in trials]
        unsaid = sum(not right and not said for right, said, _ in trials)
        needless = sum(right and said for right, said, _ in trials)
        spent = np.median([seconds for _, _, seconds in trials])
        rows.append([" ".join(free), wanted, sum(found), unsaid, needless, f"{spent:.1f}"])
    here = machine()
    with (HERE / "results" / "identify.csv").open("w", newline="") as file:
        head = [
            "fitted",
            "bodies",
            "found",
            "astray unsaid",
            "found but doubted",
            "median CPU [s]",
            "measured",
            "machine",
        ]
        csv.writer(file, lineterminator="\n").writerows(
            [head, *([*row, date.today().isoformat(), here] for row in rows)]
        )
    for row in rows:
        print(*row, sep="  ")


if __name__ == "__main__":
    main()
