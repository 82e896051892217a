"""The damping schemes of the thesis over recorded motions, against the block with its restitution.

    python benchmarks/damping_over_records.py FOLDER_WITH_AT2_RECORDS [--times 2]

Two blocks (R = 5 m, h/b = 10; R = 2 m, h/b = 6), every AT2 file of the folder scaled to `times` g tan(alpha).  The
thesis tries event-based damping, a base dashpot, numerical (HHT) dissipation on no-tension fibres, and FEMA-356 on a
record or two each; this does it on all of them.  Error: |peak - peak of the block| over the peak of the block, where
both remain stable.  An `unresolved` case (HHT: two steps that disagree on the outcome) counts as a wrong outcome.  HHT is
stepped in 1e-4 s, compiled: some seconds of CPU a record.  Writes results/damping_over_records.csv and the table of
docs/validation.md.
"""

from __future__ import annotations

import argparse
import csv
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
from machine import machine
from pages import write_section

import rockcli

HERE = Path(__file__).resolve().parent
TABLE = HERE / "results" / "damping_over_records.csv"
PAGE = HERE.parent / "docs" / "validation.md"
BEGIN, END = "<!-- damping: begin -->", "<!-- damping: end -->"

BLOCKS = ((5.0, 10), (2.0, 6))
"""R [m], h/b."""

KW_OVER_R = 4e13
"""Stiffness of the fibres over R [N/m^4]: that of Fig. 36, where HHT does best; the base's frequency goes as sqrt(kw/R)."""

REFERENCE, HHT = "block", "HHT, model 4 on fibres"


def schemes(R: float) -> dict[str, dict[str, Any]]:
    fibres = {"base": {"law": "winkler", "kw": KW_OVER_R * R, "fibres": 21}, "solver": {"backend": "frame", "dt": 1e-4}}
    return {
        REFERENCE: {"model": "rigid", "damping": "restitution"},
        "event-based, model 3, negative stiffness": {"model": "3", "damping": "restitution"},
        "event-based, model 3, corotational": {"model": "3", "geometry": "corotational", "damping": "restitution"},
        "dashpot, model 3, negative stiffness": {"model": "3", "damping": "dashpot"},
        "none, model 3, negative stiffness": {"model": "3", "damping": "none"},
        "FEMA-356": {"model": "rigid", "damping": "fema356"},
        HHT: {"model": "4", "geometry": "corotational", "damping": {"scheme": "hht", "alpha_d": 0.7}, **fibres},
    }


def peaks(R: float, slenderness: float, files: list[Path], times: float, names: set[str]) -> dict[str, Any]:
    """Per scheme theta_peak/alpha (inf overturned, NaN unresolved) over the records, and the time of its batch."""
    found = rockcli.run(
        {
            "case": {
                "block": {"R": R, "slenderness": slenderness},
                "motion": {"record": {"file": str(files[0]), "pga_over_g_tan_alpha": times}},
            },
            "vary": {
                "motion.record.file": [str(path) for path in files],
                "case": {name: case for name, case in schemes(R).items() if name in names},
            },
            "save": {"histories": False},
        }
    )
    order = [str(name) for name in found["case"].values]
    peak = dict(zip(order, found["theta_peak_over_alpha"].transpose("case", "record").values, strict=True))
    cost = dict(zip(order, found["wall_time"].transpose("case", "record").values, strict=True))
    return {name: (peak[name], float(np.median(cost[name]))) for name in order}


def summary(values: np.ndarray, truth: np.ndarray) -> list[str]:
    """Median, 90th percentile and signed median of the error [%], and counts of outcomes."""
    stand = np.isfinite(values) & np.isfinite(truth) & (truth > 0.0)
    error = 100.0 * (values[stand] / truth[stand] - 1.0)
    same = (np.isinf(values) == np.isinf(truth)) & ~np.isnan(values)
    quantiles = np.quantile(np.abs(error), (0.5, 0.9)) if len(error) else (np.nan, np.nan)
    return [
        f"{quantiles[0]:.2f}",
        f"{quantiles[1]:.2f}",
        f"{np.median(error) if len(error) else np.nan:+.2f}",
        str(len(error)),
        str(int(same.sum())),
        str(int((np.isinf(values) & np.isfinite(truth)).sum())),
        str(int((np.isfinite(values) & np.isinf(truth)).sum())),
        str(int(np.isnan(values).sum())),
    ]


def write_page(rows: list[list[Any]]) -> None:
    """The table of the page, between its markers."""
    lines = [
        "| block | scheme | median error | 90th percentile | median with sign | both stable | same outcome | wrongly overturned / wrongly stable, unresolved |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for block, scheme, n, median, high, signed, stand, same, falls, stands, unresolved, _ in rows:
        words = f"{stand} | {same} of {n} | {falls} / {stands}, {unresolved} |"
        lines.append(f"| {block} | {scheme} | {median} % | {high} % | {signed} % | {words}")
    write_section(PAGE, BEGIN, END, [*lines, "", f"Measured {date.today().isoformat()}."])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--times", type=float, default=2.0, help="PGA over g tan(alpha)")
    parser.add_argument("--hht", type=int, help="HHT on that many records only (all)")
    given = parser.parse_args()
    files = sorted(given.folder.absolute().glob("*.AT2"))
    rows = []
    for R, slenderness in BLOCKS:
        found = peaks(R, slenderness, files, given.times, set(schemes(R)) - {HHT})
        truth, _ = found.pop(REFERENCE)
        if given.hht != 0:
            found |= peaks(R, slenderness, files[: given.hht], given.times, {HHT})
        for name, (values, cost) in found.items():
            counted = summary(values, truth[: len(values)])
            rows.append([f"R = {R:g} m, h/b = {slenderness}", name, len(values), *counted, f"{cost:.3g}"])
            print(*rows[-1], sep="; ", flush=True)
    head = ["block", "scheme", "records", "median error [%]", "90th percentile [%]", "signed median [%]", "both stand"]
    head += ["same outcome", "overturns wrongly", "stands wrongly", "unresolved", "wall time of its batch [s]"]
    with TABLE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([*head, "PGA over g tan(alpha)", "measured", "machine"])
        writer.writerows([*row, f"{given.times:g}", date.today().isoformat(), machine()] for row in rows)
    write_page(rows)
    print(f"wrote {TABLE} and the table of {PAGE}")


if __name__ == "__main__":
    main()
