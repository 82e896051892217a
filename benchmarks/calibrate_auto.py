"""Measures the errors by which `model: auto` chooses, and writes rockcli/scene/auto_table.py.

    nice -n 19 python benchmarks/calibrate_auto.py [--raw FILE.npz]

Random scenes (auto_scenes.py, seed 1) are solved by every candidate.  They are sorted into bins by a group (p T_1, the
rotation at which a Winkler base opens) and by what the cheap model does in the scene; the table holds the error that
a further scene of a bin exceeds with a chance of 2.5 %, made to grow with the group, and how often the cheap model does
what, by amplitude/rate.  --raw keeps the measured scenes, or reads them if the file is there.  Writes
results/calibrate_auto.csv.  About twelve minutes on a core.
"""

from __future__ import annotations

import argparse
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from auto_scenes import Array, Scenes, draw
from machine import write_results

from rockcli import kernels
from rockcli.engine.auto import groups, peak_of, try_rigid
from rockcli.scene import auto
from rockcli.scene.auto_table import TRIED
from rockcli.study.open import open_study

HERE = Path(__file__).resolve().parent
RESULTS = HERE / "results" / "calibrate_auto.csv"
TABLE = HERE.parent / "rockcli" / "scene" / "auto_table.py"

SEED, PER_SHAPE, RECORDS, PER_RECORD = 1, 400, 160, 25
WINKLER_EVERY = 2
"""The Winkler base costs most: only every second scene is solved on it."""

EXCEEDED = 2.5
"""Chance that a further scene of a bin has a larger error than the table says [%]."""

EDGES = {
    "rigid": ("p_T1", (0.001, 0.01, 0.03, 0.1, 0.3, 1.0)),
    "flexible": ("opening", (1e-7, 1e-5, 1e-4, 1e-3, 0.05)),
}
"""Step: its group and the edges of the bins."""

SPEEDS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.2, 2.0, 4.0, np.inf)
"""Edges of the bins of amplitude/rate, by which it is foreseen what a cheap model will do."""


def measured(scenes: Scenes) -> dict[str, Array]:
    """Groups, and peaks over alpha by every candidate, of some scenes."""
    ((_, batch),) = open_study(scenes.study()).batches()
    found = groups(batch)
    rigid, tried = try_rigid(batch)
    flexible = peak_of(auto.as_candidate(batch, auto.COLUMN))
    winkler = np.full(batch.size, np.nan)
    some = np.arange(0, batch.size, WINKLER_EVERY)
    winkler[some] = peak_of(auto.as_candidate(batch.rows(some), auto.WINKLER))
    inside = np.array([not reason for reason in auto.outside(batch, found)])
    return {
        **{name: np.asarray(getattr(found, name)) for name in TRIED},
        "record": np.full(batch.size, float(found.record)),
        "inside": inside.astype(float),
        "is rigid": auto.class_of_rigid(rigid, tried).astype(float),
        **{"peak rigid": rigid, "peak flexible": flexible, "peak winkler": winkler},
    }


def error(peak: Array, reference: Array) -> Array:
    """|difference| of peaks over alpha: 0 where both overturn, inf where one does, NaN where one has no answer."""
    with np.errstate(invalid="ignore"):
        gap = np.where(np.isinf(peak) & np.isinf(reference), 0.0, np.abs(peak - reference))
    return np.where(np.isnan(peak) | np.isnan(reference), np.nan, gap)


def exceeded_by_few(errors: Array) -> float:
    """The error that a further scene like these n exceeds with a chance of EXCEEDED %; inf where n is too few to say.

    Of n + 1 scenes in random order the last is above the k-th smallest of the others with a chance of at most
    1 - k/(n + 1).
    """
    rank = int(np.ceil((len(errors) + 1) * (1.0 - EXCEEDED / 100.0)))
    return float(np.sort(errors)[rank - 1]) if rank <= len(errors) else float("inf")


def chances(raw: dict[str, Array]) -> dict[str, Any]:
    """Shares of what the rigid block does where it is tried, by kind of motion and by amplitude/rate."""
    kinds = {}
    speed, tried = (
        raw["amplitude"] / raw["rate"],
        (raw["inside"] > 0.0) & (raw["amplitude"] * (1.0 + auto.PERTURBATION) > 1.0),
    )
    for kind, flag in (("pulse", 0.0), ("record", 1.0)):
        values = []
        for low, high in pairwise(SPEEDS):
            doing = raw["is rigid"][tried & (raw["record"] == flag) & (speed >= low) & (speed < high)].astype(int)
            values.append(np.bincount(doing, minlength=len(auto.RIGID_CLASSES)) / max(1, len(doing)))
        kinds[kind] = np.round(values, 2)
    return kinds


def fitted(raw: dict[str, Array]) -> tuple[dict[str, Any], list[list[Any]]]:
    """The tables, and what they were made from, a row per bin."""
    tables: dict[str, Any] = {}
    rows: list[list[Any]] = []
    good = raw["inside"] > 0.0
    for step, (group, edges) in EDGES.items():
        reference = {"rigid": "flexible", "flexible": "winkler"}[step]
        errors = error(raw[f"peak {step}"], raw[f"peak {reference}"])
        doing = raw["is rigid"]
        usable = good & ~np.isnan(errors)
        kinds = {}
        for kind, flag in (("pulse", 0.0), ("record", 1.0)):
            of_kind = usable & (raw["record"] == flag)
            values = np.empty((len(edges) - 1, len(auto.RIGID_CLASSES)))
            for i, (low, high) in enumerate(pairwise(edges)):
                for j, words in enumerate(auto.RIGID_CLASSES):
                    bin_ = errors[of_kind & (raw[group] >= low) & (raw[group] < high) & (doing == j)]
                    values[i, j] = exceeded_by_few(bin_)
                    median = float(np.median(bin_)) if len(bin_) else np.nan
                    rows.append([step, reference, kind, group, low, high, words, len(bin_), median, values[i, j]])
            # a bin is no better than the one before it
            kinds[kind] = np.maximum.accumulate(np.ceil(values * 1e4) / 1e4, axis=0)
        tables[step] = (edges, kinds)
    return tables, rows


def write_table(tables: dict[str, Any], raw: dict[str, Array]) -> None:
    """Write the module of numbers."""
    good = raw["inside"] > 0.0
    counts = {kind: int((good & (raw["record"] == flag)).sum()) for kind, flag in (("pulses", 0.0), ("records", 1.0))}
    kinds = "tuple[tuple[float, ...], dict[str, tuple[tuple[float, ...], ...]]]"
    lines = [
        '"""Errors by which model auto chooses, and the range they were measured over (docs/auto.md).',
        "",
        f"Written by benchmarks/calibrate_auto.py from {counts['pulses']} random scenes under pulses and",
        f"{counts['records']} under synthetic records (seed {SEED}); its counts are in benchmarks/results/calibrate_auto.csv.",
        '"""',
        "",
        "from __future__ import annotations",
        "",
        "from math import inf",
        "",
        f"EXCEEDED = {EXCEEDED}",
        '"""Chance that a further scene of a bin has a larger error than TABLES says [%]."""',
        "",
        "TRIED: dict[str, tuple[float, float]] = {",
        *(f'    "{name}": {TRIED[name]},' for name in TRIED),
        "}",
        '"""Groups: the range of the scenes."""',
        "",
        f"TABLES: dict[str, {kinds}] = {{",
        *(line for step, table in tables.items() for line in written(*table, f'    "{step}": (', "    ),")),
        "}",
        '"""Step (rigid against flexible, flexible against winkler): edges of the rows (p T_1, m g/(2 kw b^2 alpha)) and, for',
        'either kind of motion, the error of theta_peak/alpha by row and class of what the rigid block does (scene/auto.py)."""',
        "",
        *written(SPEEDS, chances(raw), f"CHANCES: {kinds} = (", ")"),
        '"""Edges of the rows of amplitude/rate = PGV p/(g tan alpha), and, for either kind of motion, the share of the scenes',
        'that move in which the rigid block does what each class says, by row and class."""',
        "",
    ]
    TABLE.write_text("\n".join(lines))


def written(edges: tuple[float, ...], kinds: dict[str, Array], opening: str, closing: str) -> list[str]:
    """Lines of a table: its edges, and its rows by kind of motion."""
    before = " " * (len(closing) + 2)
    lines = [opening, f"{before}({', '.join(f'{float(v):g}' for v in edges)}),", f"{before}{{"]
    for kind, values in kinds.items():
        rows = [f"{before}        ({', '.join(f'{float(v):g}' for v in row)})," for row in values]
        lines += [f'{before}    "{kind}": (', *rows, f"{before}    ),"]
    return [*lines, f"{before}}},", closing]


def main() -> None:
    """Measure, fit, write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--raw", type=Path)
    raw_file = parser.parse_args().raw
    if raw_file is not None and raw_file.exists():
        raw = dict(np.load(raw_file))
    else:
        kernels.load(compile_them=True)
        parts = []
        with TemporaryDirectory() as folder, np.errstate(all="ignore"):
            for scenes in draw(SEED, PER_SHAPE, RECORDS, PER_RECORD, Path(folder)):
                parts.append(measured(scenes))
                print(scenes.label, flush=True)
        raw = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        if raw_file is not None:
            np.savez(raw_file, **raw)
    tables, rows = fitted(raw)
    write_table(tables, raw)
    head = "candidate", "against", "motion", "group", "from", "to", "cheap model", "scenes", "median error", "error"
    write_results(RESULTS, head, [[f"{v:.4g}" if isinstance(v, float) else v for v in row] for row in rows])


if __name__ == "__main__":
    main()
