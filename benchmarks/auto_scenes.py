"""Random scenes for `model: auto`: its calibration and its trial draw from here, with seeds of their own.

A scene is drawn by its dimensionless groups, over the range that rockcli/scene/auto_table.py calls calibrated.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).resolve().parent.parent
sys.path.append(str(ROOT / "records"))

SHAPES = ("ricker", "ricker_antisymmetric", "sine", "cosine", "half_sine", "mavroeidis_papageorgiou")
RHO, G = 2500.0, 9.81
RECORD_LENGTH = 3000
"""Samples kept of a synthetic record."""


@dataclass(frozen=True)
class Scenes:
    """Scenes that share a motion but for its size and rate: the case they differ from, and a table of what differs."""

    label: str
    case: dict[str, Any]
    table: Path
    size: int

    def study(self, **case: Any) -> dict[str, Any]:
        """The study of these scenes, on the highest model unless `case` says otherwise."""
        save: dict[str, Any] = {"histories": False}
        return {"name": "auto", "case": {**self.case, **case}, "vary": {"case": str(self.table)}, "save": save}


def log_uniform(rng: np.random.Generator, low: float, high: float, n: int) -> Array:
    """Numbers whose logarithm is uniform."""
    return np.asarray(np.exp(rng.uniform(np.log(low), np.log(high), n)))


def draw(seed: int, per_shape: int, records: int, per_record: int, folder: Path) -> Iterator[Scenes]:
    """Scenes under every pulse shape and under synthetic records of seeds of their own."""
    rng = np.random.default_rng(seed)
    for shape in SHAPES:
        pulse = {"shape": shape, "a_p_over_g_tan_alpha": 1.0, "omega_p_over_p": 5.0}
        if shape == "mavroeidis_papageorgiou":
            pulse["gamma"] = 2.0
        columns = bodies(rng, per_shape) | {
            "motion.pulse.a_p_over_g_tan_alpha": log_uniform(rng, 0.15, 10.0, per_shape),
            "motion.pulse.omega_p_over_p": log_uniform(rng, 0.3, 30.0, per_shape),
        }
        yield made(shape, {"motion": {"pulse": pulse}}, columns, folder)
    for number in range(records):
        file = synthetic(1000 * seed + number, folder)
        columns = bodies(rng, per_record) | {
            "motion.record.pga_over_g_tan_alpha": log_uniform(rng, 0.3, 8.0, per_record),
        }
        yield made(
            f"record {number}",
            {"motion": {"record": {"file": str(file), "pga_over_g_tan_alpha": 1.0}}},
            columns,
            folder,
        )


def bodies(rng: np.random.Generator, n: int) -> dict[str, Array]:
    """Bodies from a cabinet to a tower, and what they are made of, by groups: p T_1, theta_1/alpha, zeta, eta."""
    tan_alpha, R = log_uniform(rng, 0.03, 0.5, n), log_uniform(rng, 0.3, 30.0, n)
    h, alpha = R / np.hypot(1.0, tan_alpha), np.arctan(tan_alpha)
    p = np.sqrt(0.75 * G / R)
    p_T1, opening = log_uniform(rng, 1e-3, 1.0, n), log_uniform(rng, 1e-7, 0.05, n)
    eta = np.where(rng.random(n) < 0.6, 1.0 - 1.5 * np.sin(alpha) ** 2, rng.uniform(0.7, 1.0, n))
    return {
        "block.R": R,
        "block.tan_alpha": tan_alpha,
        "column.E": RHO * (12.38 * p * h / (tan_alpha * p_T1)) ** 2,
        "column.zeta": rng.uniform(0.0, 0.1, n),
        "base.kw": 2.0 * RHO * G / (opening * alpha * tan_alpha),
        "damping.eta": eta,
    }


def made(label: str, motion: dict[str, Any], columns: dict[str, Array], folder: Path) -> Scenes:
    """Write the table of what differs."""
    table = folder / f"{label.replace(' ', '_')}.csv"
    n = len(next(iter(columns.values())))
    with table.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["scene", *columns])
        writer.writerows([f"s{i}", *(float(values[i]) for values in columns.values())] for i in range(n))
    case = {
        "model": "auto",
        "block": {"R": 1.0, "tan_alpha": 0.1},
        "column": {"E": 1e9, "rho": RHO, "zeta": 0.0},
        "base": {"law": "winkler", "kw": 1e11},
        "damping": {"scheme": "restitution", "eta": 0.9},
        "solver": {"accuracy": "draft"},
        **motion,
    }
    return Scenes(label, case, table, n)


def synthetic(seed: int, folder: Path) -> Path:
    """A record by the method of records/make_records.py: magnitude, distance and site drawn, some near fault."""
    from make_records import ROCK, SOIL, STANDARD_GRAVITY, Scenario, acceleration

    from rockcli.motion.at2 import at2_text

    rng = np.random.default_rng(seed)
    magnitude = float(rng.uniform(6.0, 7.4))
    scenario = Scenario(
        f"auto_{seed}.AT2",
        "auto",
        magnitude,
        float(rng.uniform(5.0, 40.0)),
        float(rng.uniform(0.03, 0.06)),
        ROCK if rng.random() < 0.5 else SOIL,
        0.01,
        RECORD_LENGTH,
        seed,
    )
    if rng.random() < 0.3:
        period = 10.0 ** (-2.9 + 0.5 * magnitude)
        scenario = replace(scenario, pulse=(period, float(rng.uniform(0.5, 1.5)), 1.6, 0.5 * np.pi, 8.5))
    path = folder / scenario.name
    text = at2_text(acceleration(scenario) / STANDARD_GRAVITY, scenario.dt, ["", ""])
    path.write_text(text, encoding="utf-8", newline="")
    return path
