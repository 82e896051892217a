"""What friction changes over recorded motions, and what a map of it costs.

    python benchmarks/contact.py FOLDER_WITH_AT2_RECORDS [--times 1.5]

100 blocks (R from 0.5 to 5 m, tan(alpha) from 0.1 to 0.4), every AT2 file of the folder scaled to `times` g tan(alpha), by
mu/tan(alpha): how many slide, how many outcomes are others than those of pure rocking (a friction that never gives way), by how
much the peaks of those that return either way differ, how far they slide.  Then a map of mu and
amplitude of 100 000 pulses is timed.  Writes results/contact.csv and the table of docs/contact.md.
"""

from __future__ import annotations

import argparse
import csv
import time
from pathlib import Path
from typing import Any

import numpy as np
from machine import machine
from pages import write_section

import rockcli

HERE = Path(__file__).resolve().parent
TABLE = HERE / "results" / "contact.csv"
PAGE = HERE.parent / "docs" / "contact.md"
BEGIN, END = "<!-- contact: begin -->", "<!-- contact: end -->"

RATIOS = (0.8, 1.02, 1.05, 1.1, 1.2, 1.5)
HEADER = ["mu_over_tan_alpha", "cases", "slides", "outcome_differs", "unresolved", "peak_median", "peak_p90",
          "slide_median_m", "slide_p90_m"]  # fmt: skip


def solved(files: list[Path], times: float, ratio: float | None) -> Any:
    block: dict[str, Any] = {"R": 1.0, "tan_alpha": 0.2}
    if ratio is not None:
        block["mu"] = f"{ratio}*tan_alpha"
    return rockcli.run(
        {
            "case": {
                "block": block,
                "motion": {"record": {"file": str(files[0]), "pga_over_g_tan_alpha": times}},
            },
            "vary": {
                "motion.record.file": [str(path) for path in files],
                "block.R": {"from": 0.5, "to": 5.0, "n": 10, "spacing": "log"},
                "block.tan_alpha": {"from": 0.1, "to": 0.4, "n": 10},
            },
            "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha", "slide_peak"]},
        }
    )


def rows_of(files: list[Path], times: float) -> list[list[Any]]:
    free = solved(files, times, None)
    truth, pure = free["outcome"].values, free["theta_peak_over_alpha"].values
    rows = []
    for ratio in RATIOS:
        found = solved(files, times, ratio)
        outcome, peak, slide = (found[name].values for name in ("outcome", "theta_peak_over_alpha", "slide_peak"))
        known = (outcome >= 0) & (truth >= 0)
        fell = [np.isin(values, (2, 3)) for values in (outcome, truth)]
        slides = (slide > 0.0) & known
        both = known & ~fell[0] & ~fell[1] & (pure > 0.0)
        both &= peak > 0.0  # of bodies that rock either way
        error = np.abs(peak[both] / pure[both] - 1.0) if both.any() else np.full(1, np.nan)
        far = slide[slides & ~fell[0]]
        rows.append(
            [ratio, outcome.size, slides.sum() / known.sum(), (fell[0] != fell[1])[known].mean(), int((outcome < 0).sum()),
             *np.quantile(error, (0.5, 0.9)), *(np.quantile(far, (0.5, 0.9)) if len(far) else (0.0, 0.0))]
        )  # fmt: skip
        print(rows[-1], flush=True)
    return rows


def map_study() -> dict[str, Any]:
    """A map of mu and amplitude of 100 000 pulses."""
    return {
        "case": {
            "block": {"R": 1.0, "tan_alpha": 0.25, "mu": 0.3},
            "motion": {"pulse": {"shape": "sine", "a_p": "0.5*g", "T_p": 0.6}},
        },
        "vary": {
            "block.mu": {"from": 0.05, "to": 1.0, "n": 400},
            "motion.pulse.a_p": {"from": "0.05*g", "to": "0.8*g", "n": 250},
        },
        "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha", "slide_peak"]},
    }


def map_seconds() -> tuple[int, float]:
    began = time.perf_counter()
    found = rockcli.run(map_study())
    return int(found["outcome"].size), time.perf_counter() - began


def table(rows: list[list[Any]]) -> str:
    lines = [
        "| mu/tan(alpha) | slide | another outcome | peak differs, median / 90 % | slide, median / 90 % |",
        "| --- | --- | --- | --- | --- |",
    ]
    for ratio, _, slides, differs, _, median, p90, slide, far in rows:
        peak = "- (none rocks)" if np.isnan(median) else f"{median:.2g} / {p90:.2g}"
        lines.append(f"| {ratio:g} | {slides:.1%} | {differs:.2%} | {peak} | {1e3 * slide:.2g} / {1e3 * far:.3g} mm |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--times", type=float, default=1.5)
    asked = parser.parse_args()
    files = sorted(asked.folder.glob("*.AT2"))
    rows = rows_of(files, asked.times)
    with TABLE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(HEADER)
        writer.writerows([f"{x:.6g}" if isinstance(x, float) else x for x in row] for row in rows)
    n, seconds = map_seconds()
    said = f"{len(files)} records, PGA {asked.times:g} g tan(alpha), {rows[0][1]} cases a line; {machine()}."
    lines = [table(rows), "", said, f"A map of mu and amplitude of {n} pulses: {seconds:.0f} s."]
    write_section(PAGE, BEGIN, END, lines)
    print(*lines, sep="\n")


if __name__ == "__main__":
    main()
