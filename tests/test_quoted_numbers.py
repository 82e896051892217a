"""Numbers that pages quote from `benchmarks/results` are those of the newest measurements there."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def rows_of(name: str) -> list[dict[str, str]]:
    """Rows of a table of results, without the line above its head that says when and where it was made."""
    lines = (ROOT / "benchmarks" / "results" / f"{name}.csv").read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def newest(name: str, **wanted: str) -> dict[str, str]:
    """The last row that has these values, `_` in a key for a blank."""
    fits = [r for r in rows_of(name) if all(r[key.replace("_", " ")] == value for key, value in wanted.items())]
    assert fits, wanted
    return fits[-1]


def text_of(page: str) -> str:
    return " ".join((ROOT / page).read_text(encoding="utf-8").split())


def spaced(number: float) -> str:
    return f"{number:_.0f}".replace("_", " ")


@pytest.mark.parametrize("page", ["README.md", "paper/paper.md"])
def test_outcomes_that_are_wrong_or_left_open(page):
    standard = [r for r in rows_of("accuracy_levels") if (r["level"], r["estimate"]) == ("standard", "yes")]
    decided, cases, left_open = (sum(int(r[key]) for r in standard) for key in ("decided", "cases", "unresolved"))
    assert f"wrong in {spaced(decided)} cases" in text_of(page)
    assert f"{left_open} of {spaced(cases)} are reported as" in text_of(page)


PULSES, RECORD = "Ricker pulse, 200 x 200 map", "sampled motion, 3000 x 0.01 s"
RK45 = "solve_ivp RK45 1e-6, events"


def test_time_of_a_script():
    per_case = [
        1.0 / float(newest("throughput", workload=w, solver=RK45)["cases/s and core"]) for w in (PULSES, RECORD)
    ]
    assert f"{1e3 * per_case[0]:.0f} ms of a pulse, {per_case[1]:.2g} s of a record: RK45" in text_of(
        "docs/compared.md"
    )


def test_rates_of_the_lanes():
    found = newest("throughput", workload=PULSES, solver="event, standard, outcome only, in the kernel")
    rate, over = float(found["cases/s and core"]), float(found["over RK45"])
    said = f"{rate:.1e}".replace("e+0", "e")
    assert f"{said} in the kernel, {spaced(round(over, -2))} times RK45" in text_of("docs/lanes.md")
    outcomes = newest("throughput", workload=PULSES, solver="event, standard, outcome only")
    said = f"{spaced(round(float(outcomes['cases/s and core']), -4))} pulse outcomes a second"
    assert said in text_of("docs/accuracy.md")


def test_cost_of_the_default():
    suite, pulses = rows_of("default_cost")[0], rows_of("default_cost")[-1]
    assert f"takes {float(suite['CPU ratio']):.1f} times the processor time of one that" in text_of("docs/suites.md")
    assert f"{float(suite['CPU ratio']):.1f} times the processor time of those with" in text_of("docs/lanes.md")
    assert f"and {float(pulses['CPU ratio']):.2f} for one of 90 000" in text_of("docs/lanes.md")


def test_two_workers():
    page = text_of("docs/sweeps.md")
    record, pulses, three = (float(r["ratio"]) for r in rows_of("scaling"))
    assert f"{record:.2f} times as fast for outcomes under a record, {pulses:.2f} for outcomes under pulses" in page
    assert f"{three:.2f} for three scalars under pulses" in page


def test_the_first_minute():
    page = text_of("docs/sweeps.md")
    for row in rows_of("first_minute"):
        first, second = float(row["first [CPU s]"]), float(row["second [CPU s]"])
        if row["kernels"] == "ahead of time":
            assert f"| {first:.2f} s | {second:.2f} s |" in page, row
        else:
            assert f" {first:.1f} " in page, row


def test_fema_over_the_records():
    rows = [r for r in rows_of("damping_over_records") if r["scheme"] == "FEMA-356"]
    right = " and ".join(r["same outcome"] for r in rows)
    low, high = sorted(round(float(r["median error [%]"])) for r in rows)
    said = f"{right} of {rows[0]['records']} outcomes right, peaks off by {low} to {high} % in the median"
    assert said in text_of("docs/rules.md")


def test_samples_of_uncertain_inputs():
    seconds = {int(r["samples"]): float(r["seconds"]) for r in rows_of("uncertain")}
    said = f"10^5 samples of a pulse took {seconds[100_000]:.0f} s for the whole command"
    assert said in text_of("docs/uncertain.md")
    assert f"{seconds[1000]:.0f} s of it to start" in text_of("docs/uncertain.md")


def test_boulders_without_a_fit():
    rows = [r for r in rows_of("experiments") if r["prediction"] == "outlines unfitted"]
    right = {round(float(r["accuracy"]) * int(r["n"])) / int(r["n"]) for r in rows}
    (rate,) = {f"{share:.3f}".removeprefix("0") for share in right}
    assert f"{rate} without any fit" in text_of("docs/experiments.md")


def test_the_linearized_block_against_the_rigid_one():
    plain = "plain block: outcome, peak and impacts"
    ratios = [
        float(newest("features", feature="linearized block", motion=motion)["us a case"])
        / float(newest("features", feature=plain, motion=motion)["us a case"])
        for motion in ("pulse", "record")
    ]
    assert all(0.85 <= ratio <= 0.95 for ratio in ratios)
    assert "some nine tenths of the time of the rigid one" in text_of("docs/auto.md")
