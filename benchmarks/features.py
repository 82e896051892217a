"""What each feature of a study costs per case, over the same map of a plain block.

    python benchmarks/features.py [WORD...]

Processor time of maps solved in this process with their kernels loaded: a map is made larger until it takes ENOUGH, and
what it takes more than one of a quarter of the cases is that of its cases, the rest what any study costs.  The least of
ROUNDS.  Writes results/features.csv, the table of docs/features.md and, in the time of a machine of reference,
rockcli/engine/costs.csv, from which `rock check` estimates; with WORDs it prints the rows whose names hold one of them
and writes nothing.

A capability adds its row to `FEATURES`, and the reason where it is more than FIVE times as slow as the plain block.
"""

from __future__ import annotations

import csv
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path
from typing import Any

from machine import machine
from pages import write_section
from rolling import outline

import rockcli
from rockcli import kernels
from rockcli.engine.cost import KNOWN
from rockcli.engine.speed import slowness

HERE = Path(__file__).resolve().parent
PAGE = HERE.parent / "docs" / "features.md"
BEGIN, END = "<!-- benchmarks/features.py: begin -->", "<!-- benchmarks/features.py: end -->"
CSV = HERE / "results" / "features.csv"
COST, RATIO = "us a case", "over plain"
HEADINGS = ("feature", "motion", "cases", COST, "cases/s", RATIO, "why", "measured", "machine")

KNOWN_HEADINGS = ("feature", "motion", "cases", "microseconds")

ROUNDS, FIVE = 3, 5.0
ENOUGH, FIRST, MOST = 0.2, 8, 512
"""CPU time of a map [s]; points along its axes at first and at most."""

PULSE, RECORD = "pulse", "record"
FILES = ("synthetic_pulse_m70.AT2", "synthetic_soil_m70.AT2", "synthetic_rock_m65.AT2")
TO_THE_END = (
    "under pulses: two runs of every case, each to its end, where the plain block stops when its outcome is known"
)
MOTIONS: dict[str, dict[str, Any]] = {
    PULSE: {"pulse": {"shape": "ricker", "a_p": 1, "T_p": 1}},
    RECORD: {"record": {"file": FILES[0], "pga": 1}},
}
SUITE = {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha", "n_impacts"]}


def up_to(low: str, high: str, n: int) -> dict[str, Any]:
    """A range of a study."""
    return {"from": low, "to": high, "n": n}


def plain_axes(motion: str, n: int) -> dict[str, Any]:
    """The axes of a map of n x n."""
    if motion == PULSE:
        return {"motion.pulse.a_p": up_to("0.1*g", "2*g", n), "motion.pulse.T_p": up_to("0.1", "3", n)}
    return {"block.R": up_to("0.5", "5", n), "motion.record.pga": up_to("0.1*g", "2*g", n)}


def axis(motion: str, n: int, which: int) -> dict[str, Any]:
    """One of the two."""
    return dict([list(plain_axes(motion, n).items())[which]])


@dataclass(frozen=True)
class Feature:
    """A row: what is laid over the study of the plain block.

    Attributes:
        name: in the table.
        case: what stands in the case instead; of its motion only what is given here.
        motion: beside the pulse or the record.
        save: instead of outcome, peak and impacts.
        top: keys of the study beside its case.
        axes: of n x n cases, instead of the plain ones.
        motions: under which it is measured.
        first: points along its axes at first; many where few cases take most of the time.
        why: it is more than FIVE times as slow, where it is.
    """

    name: str
    case: dict[str, Any] = field(default_factory=dict)
    motion: dict[str, dict[str, Any]] = field(default_factory=dict)
    save: dict[str, Any] = field(default_factory=lambda: SUITE)
    top: dict[str, Any] = field(default_factory=dict)
    axes: Callable[[str, int], dict[str, Any]] = plain_axes
    motions: tuple[str, ...] = (PULSE, RECORD)
    first: int = FIRST
    why: str = ""


def saved(*scalars: str) -> dict[str, Any]:
    """What is saved, no histories among it."""
    return {"histories": False, "scalars": list(scalars)}


def at_uplift(motion: str, n: int) -> dict[str, Any]:
    """Amplitudes of which one is exactly that of uplift."""
    path = "motion.pulse.a_p_over_g_tan_alpha" if motion == PULSE else "motion.record.pga_over_g_tan_alpha"
    return {path: [0.5 * (j + 1) for j in range(n)], **axis(motion, n, motion == PULSE)}


def with_models(motion: str, n: int) -> dict[str, Any]:
    """Several models."""
    (path, values), (other, others) = plain_axes(motion, n).items()
    return {"model": ["rigid", "1", "2", "3", "4"], path: values, other: {**others, "n": max(n // 5, 2)}}


def settings(motion: str, n: int) -> dict[str, Any]:
    """Settings by name."""
    bodies = {f"body {j}": {"R": 0.5 + 4.5 * j / n, "tan_alpha": 0.2} for j in range(n)}
    return {"block": bodies, **axis(motion, n, motion == RECORD)}


def worded(motion: str, n: int) -> dict[str, Any]:
    """Settings by name that say a word beside numbers, as a table of bodies does in a column."""
    models = ("rigid", "linearized")
    bodies = {
        f"body {j}": {"block.R": 0.5 + 4.5 * j / n, "block.tan_alpha": 0.2, "model": models[j % 2]} for j in range(n)
    }
    return {"case": bodies, **axis(motion, n, motion == RECORD)}


def heights(motion: str, n: int) -> dict[str, Any]:
    """Of bodies that are given by h and b."""
    axes = plain_axes(motion, n)
    return {path.replace("block.R", "block.h"): values for path, values in axes.items()}


def suite(motion: str, n: int) -> dict[str, Any]:
    """Records."""
    return {"motion.record.file": list(FILES), "motion.record.pga": up_to("0.1*g", "2*g", max(n * n // 3, 2))}


def directions(motion: str, n: int) -> dict[str, Any]:
    """Angles of two components."""
    return {"motion.record.angle": up_to("0", "pi", n), "block.R": up_to("0.5", "5", n)}


def losses(motion: str, n: int) -> dict[str, Any]:
    """Powers of Housner's loss, for bodies of one outline under a record."""
    axes = plain_axes(motion, n)
    return {"damping.loss" if path == "block.R" else path: values for path, values in axes.items()}


def uncertain(motion: str, n: int) -> dict[str, Any]:
    """None beside the samples."""
    return {}


VERTICAL = {
    PULSE: {"vertical": {"pulse": {"shape": "ricker", "a_p": "0.2*g", "T_p": 0.4}}},
    RECORD: {"vertical": {"record": {"file": FILES[1], "scale": 0.5}}},
}
VERTICAL_PULSE = {RECORD: VERTICAL[PULSE]}
EIGHT = {PULSE: {"duration": 8}, RECORD: {"duration": 8}}
FLOOR = {RECORD: {"through": [{"f": 3, "zeta": 0.05}]}}
PAIR = {RECORD: {"record": {"file": [FILES[0], FILES[0]], "angle": 0, "scale": 1}}}

FEATURES = [
    Feature("plain block: outcome, peak and impacts"),
    Feature("outcome alone", save=saved("outcome")),
    Feature("every scalar and the certainty (default)", save={"histories": False}, why=TO_THE_END),
    Feature("forces", save=saved("outcome", "mu_required", "N_min_over_mg")),
    Feature("time of overturning", save=saved("outcome", "t_overturn")),
    Feature(
        "histories", save={"histories": True, "scalars": ["outcome"]},
        why="some 2000 to 10 000 output times of eight variables a case are interpolated and kept",
    ),
    Feature("vertical motion", motion=VERTICAL, why="under pulses: one body at a time"),
    Feature("vertical pulse", motion=VERTICAL_PULSE, motions=(RECORD,), why="beside a record: one body at a time"),
    Feature("asymmetric body", {"block": {"h": 1.96, "b": [0.3, 0.45]}}, axes=heights),
    Feature(
        "asymmetric body, every scalar (default)", {"block": {"h": 1.96, "b": [0.3, 0.45]}}, axes=heights, save={"histories": False},
        why=TO_THE_END,
    ),
    Feature("body that rolls, ten facets", {"block": {"outline": outline()}}, axes=losses),
    Feature("body that rolls, every scalar (default)", {"block": {"outline": outline()}}, axes=losses, save={"histories": False}, why=TO_THE_END),
    Feature("radius of gyration", {"block": {"R": 2, "tan_alpha": 0.2, "r_g": 1.1}}),
    Feature("friction, mu = 0.6", {"block": {"R": 2, "tan_alpha": 0.2, "mu": 0.6}}),
    Feature("friction, mu = 0.3", {"block": {"R": 2, "tan_alpha": 0.2, "mu": 0.3}}, why="slides and impacts with friction are followed one body at a time"),
    Feature("initial rotation", {"initial": {"theta": "0.3*alpha"}}),
    Feature("duration", motion=EIGHT),
    Feature(
        "base dashpot", {"damping": "dashpot"}, first=96,
        why="it acts all the time, so no energy at the motion's end tells the outcome: one body at a time",
    ),
    Feature("linearized block", {"model": "linearized"}),
    *(Feature(f"model {number}", {"model": number}) for number in "1234"),
    Feature("five models in one study", axes=with_models),
    Feature("bodies by name", axes=settings),
    Feature("bodies by name, of two models", axes=worded),
    Feature("one amplitude exactly at uplift", axes=at_uplift),
    Feature("suite of records", axes=suite, motions=(RECORD,)),
    Feature("two components, directions", motion=PAIR, axes=directions, motions=(RECORD,)),
    Feature("on a floor", motion=FLOOR, motions=(RECORD,), why="what arrives has eight times the samples of its ground"),
    Feature("uncertain inputs", axes=uncertain, top={"uncertain": {"block.R": {"normal": [2, 0.1]}}}),
    Feature(
        "flexible column", {"model": "flexible", "column": {"E": "30*GPa", "rho": 2500, "zeta": 0.02}},
        why="modes of some hundred hertz are followed from sample to sample and from event to event",
    ),
]  # fmt: skip


def study_of(feature: Feature, motion: str, n: int) -> dict[str, Any]:
    """The study of a row, of n x n cases."""
    shaken = {**MOTIONS[motion], **feature.motion.get(motion, {})}
    case = {"block": {"R": 2, "tan_alpha": 0.2}, **feature.case, "motion": shaken}
    study = {"name": "features", "case": case, "save": feature.save, "plots": "none", **feature.top}
    if axes := feature.axes(motion, n):
        study["vary"] = axes
    if "uncertain" in study:
        study["samples"] = n * n
    return study


def seconds(study: dict[str, Any]) -> tuple[float, int]:
    """CPU time of a study [s], and its cases."""
    began = time.process_time()
    dataset = rockcli.run(study)
    took = time.process_time() - began
    return took, int(dataset["outcome"].size)


def per_case(feature: Feature, motion: str) -> tuple[float, int]:
    """CPU time of a case [s], and of how many cases."""
    n = feature.first
    seconds(study_of(feature, motion, n))
    while seconds(study_of(feature, motion, n))[0] < ENOUGH and n < MOST:
        n *= 2
    small, large = (study_of(feature, motion, m) for m in (n // 2, n))
    turns = [(seconds(small), seconds(large)) for _ in range(ROUNDS)]
    less, more = (min(turn[which][0] for turn in turns) for which in range(2))
    few, many = (turns[0][which][1] for which in range(2))
    return max(more - less, 1e-9) / (many - few), many


Rows = list[dict[str, str]]


def read_rows() -> Rows:
    """Those that were measured last."""
    with CSV.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def lines_of(rows: Rows) -> list[str]:
    """The table of docs/features.md: a row for each feature."""
    lines = [
        "| feature | us a case: pulse | record | over the plain block: pulse | record | why more than five times |"
    ]
    lines.append("| --- | --- | --- | --- | --- | --- |")
    for feature in dict.fromkeys(row["feature"] for row in rows):
        by_motion = {row["motion"]: row for row in rows if row["feature"] == feature}
        cells = [by_motion[motion][key] if motion in by_motion else "" for key in (COST, RATIO) for motion in MOTIONS]
        lines.append(
            "| "
            + " | ".join([feature, *cells, next((row["why"] for row in by_motion.values() if row["why"]), "")])
            + " |"
        )
    return [*lines, "", f"Measured {rows[-1]['measured']}: {rows[-1]['machine']}."]


def measured(words: list[str]) -> tuple[Rows, Rows]:
    """The rows whose names hold a word, all without words; the plain block always, first and last, the less of them.

    And the same as `rockcli.engine.cost` reads them.
    """
    found = []
    known: Rows = []
    for number, feature in enumerate(FEATURES):
        if number and words and not any(word in feature.name for word in words):
            continue
        for motion in feature.motions:
            before = slowness()
            cost, cases = per_case(feature, motion)
            found.append((feature, motion, cost, cases))
            reference = 1e6 * cost / (0.5 * (before + slowness()))
            known.append(dict(zip(KNOWN_HEADINGS, (feature.name, motion, str(cases), f"{reference:.3g}"), strict=True)))
            print(feature.name, motion, f"{1e6 * cost:.3g} us, {reference:.3g} on the machine of reference", flush=True)
    plain = {motion: min(cost, per_case(FEATURES[0], motion)[0]) for _, motion, cost, _ in found[: len(MOTIONS)]}
    return rows_of(found, plain), known


def rows_of(found: list[tuple[Feature, str, float, int]], plain: dict[str, float]) -> Rows:
    """Rows of the table from feature, motion, seconds a case and cases."""
    rows: Rows = []
    for feature, motion, cost, cases in found:
        cost = plain[motion] if feature is FEATURES[0] else cost
        ratio = cost / plain[motion]
        why = feature.why if ratio > FIVE else ""
        values = (feature.name, motion, cases, f"{1e6 * cost:.3g}", f"{1.0 / cost:.3g}", f"{ratio:.1f}", why)
        rows.append(dict(zip(HEADINGS, map(str, (*values, date.today().isoformat(), machine())), strict=True)))
    return rows


def main() -> None:
    os.environ.setdefault("ROCK_RECORDS", str(HERE.parent / "records"))
    kernels.load(compile_them=True)
    rows, known = measured(sys.argv[1:])
    if sys.argv[1:]:
        return
    for path, headings, lines in ((CSV, HEADINGS, rows), (KNOWN, KNOWN_HEADINGS, known)):
        with path.open("w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, headings, lineterminator="\n")
            table.writeheader()
            table.writerows(lines)
    write_section(PAGE, BEGIN, END, ["", *lines_of(rows), ""])


if __name__ == "__main__":
    main()
