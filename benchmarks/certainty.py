"""How far `overturn_share` and `error_estimate` can be trusted, and what they cost: a table of docs/accuracy.md.

    python benchmarks/certainty.py [FOLDER_WITH_AT2_RECORDS]

Some 10 000 random scenes by family (certainty_scenes.py) at `draft` and `standard`, against the event solver at `reference`,
with certainty too, and at `standard` as many of another seed, on which nothing was set; flexible columns against steps a sixteenth (pulses) and a fifth (records) as long.  An outcome is wrong
if both runs call theirs certain and one overturns while the other does not.  It is withheld if the run calls it
uncertain and the better one does not.  A sample of the certain ones of every rigid family at `standard` is held against solvers that have
nothing in common with it but the equations: under cycles a Taylor series in long doubles (long_double.py), and there those of
the largest error estimates too; else DOP853 at its smallest tolerance, started anew at every sample and impact.

The cost is processor time of the same scenes with `overturn_share` and `error_estimate` over that without, when all other
scalars are asked for.  At last suites: 20 bodies of three ratios of their edges under every record at 12 intensities, each
a stripe, where the largest difference of the share that overturns with certainty and without it is told: of a stripe, and
of what a single body has in it.  The rows go to
results/certainty.csv, from which the table is made.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from datetime import date
from pathlib import Path
from time import process_time

import accuracy_scenes
import certainty_scenes as scenes
import long_double
import numpy as np
from accuracy_levels import dop853
from machine import machine
from pages import write_rows, write_section

from rockcli import kernels
from rockcli.motion.reading import read_record
from rockcli.scene.batch import Batch, Save
from rockcli.scene.body.block import make_block
from rockcli.scene.body.column import Column
from rockcli.scene.ground.excitation import Samples
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import NO_UPLIFT, ROCKING, overturned
from rockcli.scene.variables import SCALARS
from rockcli.solvers import flexible
from rockcli.solvers.common.certainty import CERTAINTY
from rockcli.solvers.event import solver as event

HERE = Path(__file__).resolve().parent
CSV, PAGE = HERE / "results" / "certainty.csv", HERE.parent / "docs" / "accuracy.md"
BEGIN, END = "<!-- certainty: begin -->", "<!-- certainty: end -->"

CASES, SAMPLE, COLUMNS_PER_RECORD = 1670, 20, 6
"""Scenes of a family, those of them solved by others, flexible columns under each record."""

HELD_OUT = 116
"""Seed of the scenes that the factor of the estimate was not set on."""

FIELDS = (
    "scenes", "level", "cases", "wrong", "certain", "uncertain", "withheld", "above", "within_2", "median_estimate",
    "median_error", "others_wrong", "others_cases", "cost",
)  # fmt: skip
"""`certain` by both runs; `above`, `within_2`: share of the errors not above the estimate, and not above twice it."""

PLAIN = frozenset(SCALARS) - CERTAINTY
SUITES = "suites"

Solver = Callable[[Batch], dict[str, np.ndarray]]


def solved(batch: Batch, wanted: frozenset[str] = frozenset(SCALARS)) -> dict[str, np.ndarray]:
    """Scalars of a batch."""
    solver = flexible if batch.model == "flexible" else event
    return solver.solve(replace(batch, save=Save(False, 0.01, wanted))).scalars


def at_reference(batch: Batch) -> dict[str, np.ndarray]:
    """Scalars of a batch at the highest accuracy."""
    return solved(scenes.at(batch, "reference"))


def finer_steps(batch: Batch) -> dict[str, np.ndarray]:
    """Columns with much shorter steps."""
    motion = batch.excitation.horizontal
    if isinstance(motion, Samples):
        dt = motion.dt / 5.0
    else:
        dt = min(2.0 * np.pi / float(motion.omega_p.max()) / 60.0, 0.03 / float(batch.p.max())) / 16.0
    return solved(replace(batch, numerics=Numerics(dt=dt)), frozenset({"outcome", "theta_peak_over_alpha"}))


def held_against_others(batch: Batch, ours: dict[str, np.ndarray], n: int) -> tuple[int, int]:
    """Wrong outcomes among some n certain ones, and how many these are, by solvers that share nothing with ours.

    Under cycles in long doubles, besides n taken evenly the n of the largest error estimates; else DOP853.
    """
    certain = np.flatnonzero(ours["outcome"] >= NO_UPLIFT)
    evenly = certain[:: -(-len(certain) // n)]
    fell = overturned(ours["outcome"])
    if not long_double.takes(batch):
        outcome, _ = dop853(batch.rows(evenly))
        known = outcome >= NO_UPLIFT
        return int((known & (overturned(outcome) != fell[evenly])).sum()), int(known.sum())
    hardest = certain[np.argsort(-ours["error_estimate"][certain])][:n]
    every = np.union1d(evenly, hardest)
    return sum(long_double.solve(batch, i)[0] != fell[i] for i in every), len(every)


def columns(paths: list[Path]) -> list[Batch]:
    """Flexible columns under the pulses of accuracy_scenes.py and under records at 2 to 6 times g tan(alpha)."""
    found, rng = list(accuracy_scenes.columns()), np.random.default_rng(15)
    n = COLUMNS_PER_RECORD
    for motion in map(read_record, paths):
        values = motion.acceleration(scenes.G)
        factor = scenes.G * 0.1 * rng.uniform(2.0, 6.0, n) / np.abs(values).max()
        shaken = scenes.excited(Samples(values, motion.dt, factor), n)
        batch = accuracy_scenes.batch_of(25.125, 0.1, shaken, model="flexible")
        column = Column(E=10.0 ** rng.uniform(9.7, 10.5, n), rho=np.full(n, 2500.0), zeta=rng.choice([0.01, 0.02], n))
        found.append(replace(batch, column=column))
    return found


def measured(name: str, batches: list[Batch], level: str, truth: Solver, sample: int) -> dict[str, str]:
    """A row."""
    parts: dict[str, list[np.ndarray]] = {}
    seconds = np.zeros(2)
    of_sample = [0, 0]
    for number, batch in enumerate(batches):
        batch = scenes.at(batch, level)
        began = process_time()
        solved(batch, PLAIN)
        half = process_time()
        ours = solved(batch)
        seconds += half - began, process_time() - half
        better = truth(batch)
        found = {f"our {name}": ours[name] for name in ("outcome", "theta_peak_over_alpha", "error_estimate")}
        found |= {f"better {name}": better[name] for name in ("outcome", "theta_peak_over_alpha")}
        for key, values in found.items():
            parts.setdefault(key, []).append(values)
        if sample and number % (4 if batch.excitation.vertical is not None else 1) == 0:  # two channels: 30 s a case
            wrong, both = held_against_others(batch, ours, max(sample // len(batches), 1))
            of_sample = [of_sample[0] + wrong, of_sample[1] + both]
    of = {key: np.concatenate(values) for key, values in parts.items()}
    outcome, truths = of["our outcome"], of["better outcome"]
    certain = (outcome >= NO_UPLIFT) & (truths >= NO_UPLIFT)
    stands = (outcome == ROCKING) & (truths == ROCKING)
    error = np.abs(of["our theta_peak_over_alpha"][stands] - of["better theta_peak_over_alpha"][stands])
    estimate = of["our error_estimate"][stands]
    values = (
        name, level, len(outcome), int((certain & (overturned(outcome) != overturned(truths))).sum()), int(certain.sum()),
        int((outcome < NO_UPLIFT).sum()), int(((outcome < NO_UPLIFT) & (truths >= NO_UPLIFT)).sum()),
        f"{np.mean(error <= estimate):.4f}", f"{np.mean(error <= 2.0 * estimate):.4f}",
        f"{np.median(estimate):.1e}", f"{np.median(error):.1e}", *of_sample, f"{seconds[1] / seconds[0]:.2f}",
    )  # fmt: skip
    print(*values, flush=True)
    return dict(zip(FIELDS, map(str, values), strict=True))


def stripes(paths: list[Path]) -> list[dict[str, str]]:
    """Rows of suites.

    `wrong`: certain members of another outcome without certainty; `above`, `within_2`: largest difference of
    p_overturned, of a stripe and of a single body in it.
    """
    motions = [(m.acceleration(scenes.G), m.dt) for m in map(read_record, paths)]
    times = np.linspace(1.05, 8.0, 12)
    rows = []
    for ratio in (1.0, 2.0, 5.0):
        h = np.repeat(np.geomspace(0.3, 5.0, 20), len(times))
        body = make_block(h=h, b=0.12 * h[:, None] * np.array([1.0, ratio]), n=len(h))
        shares, plain = [], []
        for values, dt in motions:
            factor = scenes.uplift(body) * np.tile(times, 20) / np.abs(values).max()
            batch = scenes.batch_of(body, scenes.excited(Samples(values, dt, factor), len(h)))
            shares.append(solved(batch, CERTAINTY | {"outcome"})["overturn_share"])
            plain.append(overturned(solved(batch, frozenset({"outcome", "theta_peak_over_alpha"}))["outcome"]))
        share, fell = (np.array(x).reshape(len(motions), 20, len(times)) for x in (shares, plain))
        certain = (share == 0.0) | (share == 1.0)
        of_body, of_stripe = (np.abs(share.mean(axis=at) - fell.mean(axis=at)).max() for at in (0, (0, 1)))
        row = dict.fromkeys(FIELDS, "") | {
            "scenes": f"{SUITES}, edge ratio {ratio:g}",
            "level": "standard",
            "cases": str(share.size),
            "wrong": str(int((certain & (share != fell)).sum())),
            "certain": str(int(certain.sum())),
            "uncertain": str(int((~certain).sum())),
            "above": f"{of_stripe:.4f}",
            "within_2": f"{of_body:.4f}",
        }
        print(row, flush=True)
        rows.append(row)
    return rows


def lines_of(rows: list[dict[str, str]], stamp: str) -> list[str]:
    """The section of the page, from the rows of the csv."""
    lines = [
        "| scenes | level | cases | wrong | uncertain | of these certain by the better run | error not above the estimate "
        "| nor above twice it | median estimate, error | wrong against others | cost |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for r in (r for r in rows if not r["scenes"].startswith(SUITES)):
        other = f"{r['others_wrong']} of {r['others_cases']}" if r["others_cases"] != "0" else "-"
        cells = (
            r["scenes"], f"`{r['level']}`", r["cases"], f"{r['wrong']} of {r['certain']}", r["uncertain"], r["withheld"],
            *(f"{100.0 * float(r[name]):.2f} %" for name in ("above", "within_2")),
            f"{r['median_estimate']}, {r['median_error']}", other, f"{r['cost']}",
        )  # fmt: skip
        lines.append(f"| {' | '.join(cells)} |")
    lines += ["", "Suites, `standard`, with `overturn_share` and without:", ""]
    lines += [
        "| suites of | cases | certain ones of another outcome without | uncertain | largest difference of p_overturned, "
        "a stripe of 20 bodies | of one body |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for r in (r for r in rows if r["scenes"].startswith(SUITES)):
        cells = (
            r["scenes"].removeprefix(SUITES + ", "),
            *(r[n] for n in ("cases", "wrong", "uncertain", "above", "within_2")),
        )
        lines.append(f"| {' | '.join(cells)} |")
    return [*lines, "", f"Generated by `benchmarks/certainty.py`. {stamp}"]


def main() -> None:
    kernels.load(compile_them=True)
    own = sorted((HERE.parent / "records").glob("*.AT2"))
    paths = accuracy_scenes.found_motions(Path(sys.argv[1])) if len(sys.argv) > 1 else own
    some = scenes.families(60, paths)["records"][0]
    solved(some)  # compile
    rows = []
    for name, batches in scenes.families(CASES, paths).items():
        for level in ("draft", "standard"):
            sample = SAMPLE if level == "standard" else 0
            rows.append(measured(name, batches, level, at_reference, sample))
    for name, batches in scenes.families(CASES, paths, HELD_OUT).items():
        rows.append(measured(name, batches, "standard", at_reference, 0) | {"scenes": f"{name}, held out"})
    flexible_ones = columns(paths)
    solved(flexible_ones[0])  # compile
    rows.append(measured("flexible columns", flexible_ones, "standard", finer_steps, 0))
    rows += stripes(paths)
    stamp = f"Measured {date.today().isoformat()} on {machine()}, one core, compiled, {len(paths)} records."
    write_rows(CSV, stamp, FIELDS, rows)
    write_section(PAGE, BEGIN, END, lines_of(rows, stamp))
    print(f"wrote {CSV} and {PAGE}")


if __name__ == "__main__":
    main()
