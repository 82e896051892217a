"""What `accuracy: draft | standard | reference` give, on a fixed set of scenes: writes the tables of docs/accuracy.md.

    python benchmarks/accuracy_levels.py [FOLDER_WITH_AT2_RECORDS]

Every scene (accuracy_scenes.py) at every level, as a study solves it by default: with the error estimate, which makes a
case `unresolved` if two accuracies leave its outcome unknown.  A second table is of runs that ask for outcome and peak
alone, as sweeps above 1e5 cases do.  The truth is the event solver at `reference`, which itself is held against DOP853 at
its smallest tolerance, started anew at every sample and impact; for the flexible column the same solver with a quarter
of the steps of `reference`.  Where the truth itself is unresolved nothing is right or wrong; those cases are counted.

Costs are processor time, the least of five, of a small sample of each set, all scalars saved.  The rows go to
results/accuracy_levels.csv, from which the tables are made.  Without a folder of records the rows on recorded motions are
kept as they stand.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from datetime import date
from pathlib import Path
from time import process_time

import accuracy_scenes as scenes
import numpy as np
from machine import machine
from pages import read_rows, write_rows, write_section

from rockcli import kernels
from rockcli.scene.batch import Batch, Save
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import NO_UPLIFT, OVERTURNED_WITHOUT_IMPACT
from rockcli.scene.variables import SCALARS
from rockcli.solvers import flexible
from rockcli.solvers.event import solver as event
from rockcli.solvers.general import solver as general

HERE = Path(__file__).resolve().parent
CSV, PAGE = HERE / "results" / "accuracy_levels.csv", HERE.parent / "docs" / "accuracy.md"
BEGIN, END = "<!-- accuracy levels: begin -->", "<!-- accuracy levels: end -->"

LEVELS = ("draft", "standard", "reference")
COLUMNS = (
    "scenes", "level", "estimate", "against", "cases", "median", "p90", "wrong", "decided", "unresolved", "unsettled",
    "us_per_case",
)  # fmt: skip
"""`decided` by the level and by the truth; `unresolved` by the level; `unsettled` by the truth."""

RECORDED = "recorded motions"
PLAIN = ("outcome", "theta_peak_over_alpha")
ESTIMATED = (*PLAIN, "error_estimate")
SAMPLE, REPEATS = 60, 5
"""Cases of a set whose cost is measured (a hundredth of the map), and how often."""


def solved(batch: Batch, level: str, wanted: tuple[str, ...] = ESTIMATED):
    """Outcome and peak (n,)."""
    save = Save(False, 0.01, frozenset(wanted))
    batch = replace(batch, numerics=replace(batch.numerics, accuracy=level), save=save)
    found = (flexible if batch.model == "flexible" else event).solve(batch).scalars
    return found["outcome"], found["theta_peak_over_alpha"]


def overturns(batch: Batch) -> np.ndarray:
    """Which cases overturn, at `reference` (n,)."""
    return np.asarray(solved(batch, "reference", PLAIN)[0] >= OVERTURNED_WITHOUT_IMPACT)


def dop853(batch: Batch):
    """As `solved`, by a general method at the smallest tolerance it takes."""
    how = Numerics(backend="scipy", accuracy="reference", rtol=2.5e-14, method="DOP853")
    found = general.solve(replace(batch, numerics=how, save=Save(False, 0.01, frozenset(ESTIMATED)))).scalars
    return found["outcome"], found["theta_peak_over_alpha"]


def finer(batch: Batch):
    """As `solved`, with a quarter of the steps of `reference`."""
    assert batch.excitation.horizontal is not None
    omega_p = float(batch.excitation.horizontal.omega_p.max())
    dt = 0.25 * 0.25 * min(2.0 * np.pi / omega_p / 60.0, 0.03 / float(batch.p.max()))
    found = flexible.solve(
        replace(batch, numerics=Numerics(dt=dt), save=Save(False, 0.01, frozenset(ESTIMATED)))
    ).scalars
    return found["outcome"], found["theta_peak_over_alpha"]


def thinned(batches: list[Batch], most: int) -> list[Batch]:
    """At most four batches of a set, some `most` cases together."""
    some = batches[:: -(-len(batches) // 4)]
    return [b.rows(np.arange(0, b.size, -(-b.size * len(some) // most))) for b in some]


def cost(batches: list[Batch], level: str, wanted: tuple[str, ...]) -> float:
    """Processor time of a case [us]."""
    seconds = []
    for _ in range(REPEATS):
        began = process_time()
        for batch in batches:
            solved(batch, level, wanted)
        seconds.append(process_time() - began)
    return 1e6 * min(seconds) / sum(batch.size for batch in batches)


@dataclass
class Tally:
    """Errors and outcomes of a level over some scenes."""

    errors: list[np.ndarray]
    wrong: int = 0
    decided: int = 0
    unresolved: int = 0
    unsettled: int = 0
    cases: int = 0

    def add(self, found, truth) -> None:
        """Take the answers to a batch."""
        answered, settled = (outcome >= NO_UPLIFT for outcome in (found[0], truth[0]))
        both = answered & settled
        with np.errstate(invalid="ignore"):
            error = np.abs(found[1] - truth[1])
        self.errors.append(error[np.isfinite(error)])
        self.wrong += int(np.sum(found[0][both] != truth[0][both]))
        self.decided += int(both.sum())
        self.unresolved += int((~answered).sum())
        self.unsettled += int((~settled).sum())
        self.cases += len(both)

    def row(self, set_name: str, level: str, estimate: bool, against: str, us: float) -> dict[str, str]:
        """As it is written."""
        errors = np.concatenate(self.errors)
        median, p90 = np.quantile(errors, (0.5, 0.9)) if errors.size else (np.nan, np.nan)
        values = (
            set_name, level, "yes" if estimate else "no", against, self.cases, f"{median:.1e}", f"{p90:.1e}", self.wrong,
            self.decided, self.unresolved, self.unsettled, f"{us:.3g}",
        )  # fmt: skip
        return dict(zip(COLUMNS, map(str, values), strict=True))


def measured(name: str, batches: list[Batch], independent: int) -> list[dict[str, str]]:
    """A row per level, with and without estimate; `reference` against DOP853 on so many of the cases."""
    column = batches[0].model == "flexible"
    against = "a quarter of its steps" if column else "reference"
    sample = thinned(batches, max(SAMPLE, sum(b.size for b in batches) // 100))
    best = [finer(b) if column else solved(b, "reference") for b in batches]
    rows = []
    for wanted in (ESTIMATED, PLAIN):
        estimate = wanted == ESTIMATED
        for level in LEVELS if column and estimate else LEVELS[:2]:
            tally = Tally([])
            for batch, truth in zip(batches, best, strict=True):
                tally.add(solved(batch, level, wanted), truth)
            rows.append(tally.row(name, level, estimate, against, cost(sample, level, SCALARS if estimate else PLAIN)))
    if independent:
        tally = Tally([])
        for batch in thinned(batches, independent):
            tally.add(solved(batch, "reference"), dop853(batch))
        rows.append(tally.row(name, "reference", True, "DOP853", cost(sample, "reference", SCALARS)))
    print(name, flush=True)
    return rows


def lines_of(rows: list[dict[str, str]], stamp: str) -> list[str]:
    """The section of the page, from the rows of the csv."""
    lines = [
        "| scenes | level | against | cases | median error | 90 % | wrong outcomes | unresolved | unresolved truth | per case |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for r in (r for r in rows if r["estimate"] == "yes"):
        cells = (
            r["scenes"], f"`{r['level']}`", r["against"], r["cases"], r["median"], r["p90"],
            f"{r['wrong']} of {r['decided']}", r["unresolved"], r["unsettled"], f"{r['us_per_case']} us",
        )  # fmt: skip
        lines.append(f"| {' | '.join(cells)} |")
    lines += ["", *(verdict(rows, level, "yes") for level in LEVELS[:2])]
    lines += [
        "",
        "Without an error estimate, as in sweeps above 1e5 cases (lanes where the motion and what is asked allow them):",
        "",
        "| scenes | level | median error | wrong outcomes | unresolved | per case |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for r in (r for r in rows if r["estimate"] == "no"):
        cells = (
            r["scenes"], f"`{r['level']}`", r["median"], f"{r['wrong']} of {r['decided']}", r["unresolved"],
            f"{r['us_per_case']} us",
        )  # fmt: skip
        lines.append(f"| {' | '.join(cells)} |")
    lines += ["", *(verdict(rows, level, "no") for level in LEVELS[:2])]
    return [*lines, "", f"Generated by `benchmarks/accuracy_levels.py`. {stamp}"]


def verdict(rows: list[dict[str, str]], level: str, estimate: str) -> str:
    """A sentence: how many outcomes of a level are wrong, and in which set most."""
    ours = [r for r in rows if (r["level"], r["estimate"]) == (level, estimate)]
    wrong, decided, cases, unresolved = (
        sum(int(r[n]) for r in ours) for n in ("wrong", "decided", "cases", "unresolved")
    )
    worst = max(ours, key=lambda r: int(r["wrong"]) / int(r["decided"]))
    share = int(worst["wrong"]) / int(worst["decided"])
    most = f", most in {worst['scenes']} ({share:.1e})" if wrong else ""
    return f"- `{level}`: {wrong} of {decided} outcomes wrong{most}; {unresolved} of {cases} unresolved."


def main() -> None:
    kernels.load(compile_them=True)
    own = sorted((HERE.parent / "records").glob("*.AT2"))
    sets: dict[str, tuple[list[Batch], int]] = {
        "pulses of the thesis": (list(scenes.pulses()), 90),
        "200 x 200 Ricker map": (list(scenes.pulse_map()), 0),
        "synthetic records": (list(scenes.records(own, np.linspace(1.1, 3.0, 200))), 0),
        "beside a boundary": (list(scenes.near_boundary(overturns)), 90),
        "chatter": (list(scenes.chatter()), 60),
        "chaotic trains": (list(scenes.chaotic_trains()), 0),
        "flexible columns": (list(scenes.columns()), 0),
    }
    kept = read_rows(CSV)[0] if CSV.exists() else []
    rows = [row for name, (batches, independent) in sets.items() for row in measured(name, batches, independent)]
    if len(sys.argv) > 1:
        scales = np.concatenate([np.linspace(1.05, 4.0, 96), [1.2, 1.6, 2.0, 2.6]])
        rows += measured(RECORDED, list(scenes.records(scenes.found_motions(Path(sys.argv[1])), scales)), 0)
    else:
        rows += [row for row in kept if row["scenes"] == RECORDED]
    stamp = f"Measured {date.today().isoformat()} on {machine()}, one core, compiled."
    write_rows(CSV, stamp, COLUMNS, rows)
    write_section(PAGE, BEGIN, END, lines_of(rows, stamp))
    print(f"wrote {CSV} and {PAGE}")


if __name__ == "__main__":
    main()
