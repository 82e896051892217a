"""What `accuracy: draft | standard | reference` give, on a fixed set of scenes: writes the table of docs/accuracy.md.

    python benchmarks/accuracy_levels.py [FOLDER_WITH_AT2_RECORDS]

Every scene at every level, against the best there is: for the block and the spring models the event solver at
`reference`, which itself is held against DOP853 at its smallest tolerance, started anew at every sample and impact; for
the flexible column the same solver with a quarter of the steps of `reference`.  Cases that either side calls
`unresolved` count as neither right nor wrong; they are listed.  The rows go to results/accuracy_levels.csv, from which
the table is made.  Without a folder of records the row on recorded motions is kept as it stands.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import date
from pathlib import Path
from time import perf_counter

import numpy as np
from machine import machine

from rockcli import kernels
from rockcli.motion.reading import read_record
from rockcli.scene.batch import Batch, Save
from rockcli.scene.block import housner_eta, make_block
from rockcli.scene.column import Column
from rockcli.scene.damping import Damping
from rockcli.scene.excitation import Excitation, Samples
from rockcli.scene.numerics import Numerics
from rockcli.scene.pulses import make_pulses
from rockcli.scene.response import NO_UPLIFT, OVERTURNED_WITHOUT_IMPACT
from rockcli.solvers import event, flexible
from rockcli.solvers.general import solver as general

HERE = Path(__file__).resolve().parent
CSV, PAGE = HERE / "results" / "accuracy_levels.csv", HERE.parent / "docs" / "accuracy.md"
BEGIN, END = "<!-- accuracy levels: begin -->", "<!-- accuracy levels: end -->"

G, LEVELS = 9.81, ("draft", "standard", "reference")
PULSES = {2.0: (3.0, 4.44), 5.0: (2.0, 2.66), 10.0: (1.4, 1.905)}
"""R [m]: omega_p over pi of the Ricker and of the sine pulse (the source's Figs 7-16)."""

COLUMNS = ("scenes", "level", "against", "cases", "median", "p90", "wrong", "decided", "unresolved", "us_per_case")
RECORDED, MAP = "recorded motions", "200 x 200 Ricker map"
SAVE = Save(False, 0.01, frozenset({"outcome", "theta_peak_over_alpha"}))


def batch_of(R, tan_alpha, motion: Excitation, *, eta=None, theta_0=0.0, model="rigid", geometry=None) -> Batch:
    """Blocks (n,) under a motion; Housner's restitution unless eta is given."""
    n = len(motion.duration)
    R, tan_alpha = np.broadcast_to(R, n).astype(float), np.broadcast_to(tan_alpha, n).astype(float)
    alpha = np.arctan(tan_alpha)
    body = make_block(h=R * np.cos(alpha), b=R * np.sin(alpha), R=R, alpha=alpha, tan_alpha=tan_alpha, n=n)
    ratio = np.maximum(housner_eta(body), 0.0) if eta is None else np.full((n, 2), eta)
    return Batch(
        g=np.full(n, G),
        block=body,
        excitation=motion,
        theta_0=np.broadcast_to(theta_0, n) * alpha,
        theta_dot_0=np.zeros(n),
        model=model,
        geometry=geometry,
        damping=Damping("restitution", ratio),
        numerics=Numerics(),
        save=SAVE,
    )


def pulse(shape: str, a_p, omega_p, cycles: float | None = None) -> Excitation:
    a_p, omega_p = np.broadcast_arrays(np.atleast_1d(a_p).astype(float), np.atleast_1d(omega_p).astype(float))
    more = {} if cycles is None else {"cycles": np.full(len(a_p), cycles)}
    return Excitation(
        make_pulses(shape, a_p=a_p.copy(), omega_p=omega_p.copy(), **more), None, np.full(len(a_p), np.nan)
    )


def pulses() -> Iterator[Batch]:
    """The source's pulses at five amplitudes, as the block and as models 1 and 3."""
    for R, both in PULSES.items():
        for shape, over_pi in zip(("ricker", "sine"), both, strict=True):
            tan_alpha = np.repeat([0.1, 0.2, 0.333], 5)
            a_p = G * tan_alpha * np.tile([1.3, 1.9, 2.5, 3.1, 3.6], 3)
            for model, geometry in (("rigid", None), ("1", "negative_stiffness"), ("3", "corotational")):
                yield batch_of(R, tan_alpha, pulse(shape, a_p, over_pi * np.pi), model=model, geometry=geometry)


def pulse_map() -> Iterator[Batch]:
    """200 x 200 over amplitude and frequency of a Ricker pulse: mostly plain, with every boundary in it."""
    p, tan_alpha = np.sqrt(3.0 * G / 8.0), 0.2
    a_p, omega_p = np.meshgrid(np.linspace(1.0, 12.0, 200) * G * tan_alpha, np.linspace(0.5, 8.0, 200) * p)
    yield batch_of(2.0, tan_alpha, pulse("ricker", a_p.ravel(), omega_p.ravel()))


def records(paths: list[Path], scales) -> Iterator[Batch]:
    """Two blocks under each motion, at PGA of some times g tan(alpha)."""
    for path in paths:
        motion = read_record(path)
        values = motion.acceleration(G)
        for R, tan_alpha in ((2.0, 0.2), (5.0, 0.1)):
            factor = np.asarray(scales) * G * tan_alpha / np.abs(values).max()
            yield batch_of(
                R, tan_alpha, Excitation(Samples(values, motion.dt, factor), None, np.full(len(factor), np.nan))
            )


def near_boundary() -> Iterator[Batch]:
    """Amplitudes 1e-3 ... 1e-9 beside the first that overturns, found by bisection at `reference`."""
    for R, (ricker, _) in PULSES.items():
        for tan_alpha in (0.1, 0.2, 0.333):

            def at(times, R=R, tan_alpha=tan_alpha, ricker=ricker) -> Batch:
                a_p = np.atleast_1d(times) * G * tan_alpha
                return batch_of(R, tan_alpha, pulse("ricker", a_p, ricker * np.pi))

            grid = np.linspace(1.0, 12.0, 400)
            fell = solved(at(grid), "reference")[0] >= OVERTURNED_WITHOUT_IMPACT
            first = int(np.argmax(fell))
            low, high = grid[first - 1], grid[first]
            for _ in range(45):
                middle = 0.5 * (low + high)
                over = solved(at(middle), "reference")[0][0] >= OVERTURNED_WITHOUT_IMPACT
                low, high = (low, middle) if over else (middle, high)
            beside = np.concatenate([[-d, d] for d in 10.0 ** -np.arange(3.0, 10.0)])
            yield at(high * (1.0 + beside))


def chatter() -> Iterator[Batch]:
    """Long trains of impacts: barely uplifted, and strongly damped, under ten cycles."""
    a_p = G * 0.2 * np.repeat([1.01, 1.05, 1.2, 1.5, 2.0], 4)
    omega_p = np.sqrt(3.0 * G / 8.0) * np.tile([2.0, 4.0, 8.0, 16.0], 5)
    for eta in (0.3, 0.6, 0.9):
        for shape in ("cosine", "sine"):
            yield batch_of(2.0, 0.2, pulse(shape, a_p, omega_p, 10.0), eta=eta)


def columns() -> Iterator[Batch]:
    """Flexible columns of 50 x 5 m, two stiffnesses with and without damping."""
    for E, zeta in ((5e9, 0.0), (5e9, 0.02), (30e9, 0.02)):
        for shape in ("ricker", "sine"):
            a_p = G * 0.1 * np.array([2.0, 3.0, 4.0, 5.0])
            batch = batch_of(25.125, 0.1, pulse(shape, a_p, 2.0 * np.pi / 1.6), model="flexible")
            four = np.ones(4)
            yield replace(batch, column=Column(E=E * four, rho=2500.0 * four, zeta=zeta * four))


def solved(batch: Batch, level: str):
    """Outcome and peak (n,), and the time it took [s]."""
    batch = replace(batch, numerics=replace(batch.numerics, accuracy=level))
    solve = flexible.solve if batch.model == "flexible" else event.solve
    began = perf_counter()
    found = solve(batch).scalars
    return found["outcome"], found["theta_peak_over_alpha"], perf_counter() - began


def dop853(batch: Batch):
    """As `solved`, by a general method at the smallest tolerance it takes."""
    how = Numerics(backend="scipy", accuracy="reference", rtol=2.5e-14, method="DOP853")
    found = general.solve(replace(batch, numerics=how)).scalars
    return found["outcome"], found["theta_peak_over_alpha"], np.nan


def finer(batch: Batch):
    """As `solved`, with a quarter of the steps of `reference`."""
    assert batch.excitation.horizontal is not None
    omega_p = float(batch.excitation.horizontal.omega_p.max())
    dt = 0.25 * 0.25 * min(2.0 * np.pi / omega_p / 60.0, 0.03 / float(batch.p.max()))
    found = flexible.solve(replace(batch, numerics=Numerics(dt=dt))).scalars
    return found["outcome"], found["theta_peak_over_alpha"], np.nan


@dataclass
class Tally:
    """Errors and outcomes of a level over some scenes."""

    errors: list[np.ndarray]
    wrong: int = 0
    decided: int = 0
    unresolved: int = 0
    cases: int = 0
    seconds: float = 0.0

    def add(self, found, truth, seconds: float) -> None:
        """Take the answers to a batch."""
        both = (found[0] >= NO_UPLIFT) & (truth[0] >= NO_UPLIFT)
        with np.errstate(invalid="ignore"):
            error = np.abs(found[1] - truth[1])
        self.errors.append(error[np.isfinite(error)])
        self.wrong += int(np.sum(found[0][both] != truth[0][both]))
        self.decided += int(both.sum())
        self.unresolved += int((~both).sum())
        self.cases += len(both)
        self.seconds += seconds

    def row(self, scenes: str, level: str, against: str) -> dict[str, str]:
        """As it is written."""
        errors = np.concatenate(self.errors)
        median, p90 = np.quantile(errors, (0.5, 0.9)) if errors.size else (np.nan, np.nan)
        values = (
            scenes, level, against, self.cases, f"{median:.1e}", f"{p90:.1e}", self.wrong, self.decided, self.unresolved,
            f"{1e6 * self.seconds / self.cases:.3g}",
        )  # fmt: skip
        return dict(zip(COLUMNS, map(str, values), strict=True))


def measured(scenes: str, batches: list[Batch], independent: int) -> list[dict[str, str]]:
    """A row per level; `reference` on the first `independent` batches against DOP853, or a column with finer steps."""
    column = batches[0].model == "flexible"
    tallies = {level: Tally([]) for level in LEVELS}
    for number, batch in enumerate(batches):
        solved(batch, "draft")  # loads what has to be loaded
        answers = {level: solved(batch, level) for level in LEVELS}
        best = finer(batch) if column else answers["reference"]
        for level in LEVELS[:2] if not column else LEVELS:
            tallies[level].add(answers[level], best, answers[level][2])
        if not column and number < independent:
            tallies["reference"].add(answers["reference"], dop853(batch), answers["reference"][2])
    against = dict.fromkeys(LEVELS, "a quarter of its steps" if column else "reference")
    if not column:
        against["reference"] = "DOP853"
    return [t.row(scenes, level, against[level]) for level, t in tallies.items() if t.cases]


def lines_of(rows: list[dict[str, str]], stamp: str) -> list[str]:
    """The section of the page, from the rows of the csv."""
    lines = [
        "| scenes | level | against | cases | median error | 90 % | wrong outcomes | unresolved | per case |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for r in rows:
        wrong = f"{r['wrong']} of {r['decided']}"
        cells = (
            r["scenes"],
            f"`{r['level']}`",
            r["against"],
            r["cases"],
            r["median"],
            r["p90"],
            wrong,
            r["unresolved"],
        )
        lines.append(f"| {' | '.join(cells)} | {r['us_per_case']} us |")
    for level in LEVELS[:2]:
        of_map, others = (
            [r for r in rows if r["level"] == level and (r["scenes"] == MAP) == is_map] for is_map in (1, 0)
        )
        counts = [[sum(int(r[name]) for r in some) for name in ("wrong", "decided")] for some in (of_map, others)]
        (wrong_map, in_map), (wrong, decided) = counts
        words = f"{wrong_map} of {in_map} outcomes wrong on the map, {wrong} of {decided} on all other scenes"
        lines += [
            "",
            f"`{level}`: {words} ({wrong / decided:.1e}); the two are not to be pooled, since the map is far larger.",
        ]
    return [*lines, "", f"Generated by `benchmarks/accuracy_levels.py`. {stamp}"]


def read_rows() -> tuple[list[dict[str, str]], str]:
    """Rows and the stamp of the csv."""
    with CSV.open(encoding="utf-8", newline="") as file:
        stamp = file.readline().removeprefix("# ").strip()
        return list(csv.DictReader(file)), stamp


def main() -> None:
    kernels.load(compile_them=True)
    own = sorted((HERE.parent / "records").glob("*.AT2"))
    scenes: dict[str, tuple[list[Batch], int]] = {
        "pulses of the source": (list(pulses()), 6),
        MAP: (list(pulse_map()), 0),
        "synthetic records": (list(records(own, np.linspace(1.1, 3.0, 20))), 0),
        "beside a boundary": (list(near_boundary()), 9),
        "chatter": (list(chatter()), 6),
        "flexible columns": (list(columns()), 0),
    }
    rows: list[dict[str, str]] = []
    kept = read_rows()[0] if CSV.exists() else []
    for name, (batches, independent) in scenes.items():
        rows += measured(name, batches, independent)
        print(name, flush=True)
    if len(sys.argv) > 1:
        found = sorted(Path(sys.argv[1]).rglob("*.AT2"))
        rows += measured(RECORDED, list(records(found[:: max(len(found) // 17, 1)][:17], (1.2, 1.6, 2.0, 2.6))), 0)
    else:
        rows += [row for row in kept if row["scenes"] == RECORDED]
    stamp = f"Measured {date.today().isoformat()} on {machine()}, one core, compiled."
    with CSV.open("w", encoding="utf-8", newline="") as file:
        file.write(f"# {stamp}\n")
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    text = PAGE.read_text(encoding="utf-8")
    before, rest = text.split(BEGIN)
    after = rest.split(END)[1]
    PAGE.write_text("\n".join([before + BEGIN, *lines_of(rows, stamp), END]) + after, encoding="utf-8")
    print(f"wrote {CSV} and {PAGE}")


if __name__ == "__main__":
    main()
