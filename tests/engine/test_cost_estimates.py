"""What `rock check` estimates follows from what features were measured to cost, feature by feature, and solves nothing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rockcli.engine import cost, preview
from rockcli.engine.cost import known, memory, seconds_per_case
from rockcli.engine.speed import slowness
from rockcli.engine.sweep.sweep import outlook
from rockcli.motion.at2 import at2_text
from rockcli.scene.batch import Batch
from rockcli.study.open import open_study
from rockcli.study.study import Study

BLOCK = {"R": 2.0, "tan_alpha": 0.2}
SINE = {"pulse": {"shape": "sine", "a_p": 5.0, "T_p": 1.0}}
SUITE = ["outcome", "theta_peak_over_alpha", "n_impacts"]


def study(motion: dict[str, Any] = SINE, save: Any = None, top: dict[str, Any] | None = None, **case: Any) -> Study:
    saved = {"histories": False, "scalars": SUITE} if save is None else save
    whole = {"block": BLOCK, "motion": motion, **case}
    return open_study({"name": "estimated", "case": whole, "save": saved, **(top or {})})


def batch(**said: Any) -> Batch:
    return next(iter(study(**said).batches()))[1]


def microseconds(feature: str, motion: str = "pulse") -> float:
    return known()[feature, motion][0]


@pytest.mark.parametrize(
    ("feature", "said"),
    [
        (cost.PLAIN, {}),
        ("vertical motion", {"motion": {**SINE, "vertical": SINE}}),
        ("asymmetric body", {"block": {"h": 1.96, "b": [0.3, 0.45]}}),
        ("friction, mu = 0.6", {"block": {**BLOCK, "mu": 0.6}}),
        ("friction, mu = 0.3", {"block": {**BLOCK, "mu": 0.3}}),
        ("initial rotation", {"initial": {"theta": "0.3*alpha"}}),
        ("duration", {"motion": {**SINE, "duration": 8}}),
        ("base dashpot", {"damping": "dashpot"}),
        ("model 3", {"model": 3}),
        ("flexible column", {"model": "flexible", "column": {"E": "30*GPa", "rho": 2500, "zeta": 0.02}}),
        ("every scalar and the certainty (default)", {"save": {"histories": False}}),
        ("forces", {"save": {"histories": False, "scalars": ["outcome", "mu_required"]}}),
    ],
)
def test_a_case_with_one_feature_costs_what_the_feature_was_measured_to(feature: str, said: dict[str, Any]) -> None:
    found = seconds_per_case(batch(**said), "event")
    assert found == pytest.approx(microseconds(feature))


def test_a_sweep_reckons_with_cases_all_over() -> None:
    """A weak motion lifts no body, and its cases are a tenth as dear as those of the strongest."""
    axis = {"vary": {"motion.record.pga": {"from": "0.02*g", "to": "2*g", "n": 150}}}
    whole = study({"record": {"file": "synthetic_rock_m65.AT2", "pga": "0.5*g"}}, top=axis)
    ((_, first),), ((_, every),) = whole.batches(np.zeros(1, dtype=np.int64)), whole.batches(np.arange(150))
    estimate, _ = outlook(whole, whole.size)
    assert estimate == pytest.approx(seconds_per_case(every, "event"), rel=0.05)
    assert estimate > 3.0 * seconds_per_case(first, "event")


def test_features_together_cost_more_than_each(tmp_path: Any) -> None:
    both = seconds_per_case(batch(motion={**SINE, "vertical": SINE}, save={"histories": False}), "event")
    assert both > microseconds("vertical motion")
    assert both < microseconds("vertical motion") * microseconds(cost.EVERY) / microseconds(cost.PLAIN)


def test_records_cost_by_their_samples_and_by_what_they_lift(tmp_path: Any) -> None:
    def seconds(n: int, pga: float) -> float:
        file = tmp_path / f"{n}.txt"
        file.write_text("\n".join(f"{x:.6e}" for x in np.sin(np.arange(n) * 0.05)))
        record = {"file": str(file), "dt": 0.01, "units": "m/s2", "pga": pga}
        return seconds_per_case(batch(motion={"record": record}), "event")

    still = microseconds(cost.STILL, "record")
    assert seconds(3000, 0.5) == pytest.approx(still)
    assert seconds(3000, 5.0) == pytest.approx(microseconds(cost.PLAIN, "record"))
    assert seconds(6000, 5.0) - still == pytest.approx(2.0 * (seconds(3000, 5.0) - still))


def test_what_arrives_through_a_floor_takes_time_once_a_record(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(preview, "slowness", lambda: 1.0)
    motion = {"record": {"file": "synthetic_rock_m65.AT2", "pga": "0.01*g"}}
    axis = {"vary": {"motion.record.pga": {"from": "0.01*g", "to": "0.02*g", "n": 20}}}
    floor = study(motion | {"through": [{"f": 3, "zeta": 0.05}]}, top=axis)
    ((_, below),) = floor.batches()
    samples = len(below.excitation.horizontal.values)
    more = preview.preview(floor).seconds - preview.preview(study(motion, top=axis)).seconds
    assert more == pytest.approx(cost.ARRIVING * samples, rel=0.1)


def test_an_estimate_is_in_the_time_of_this_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    axes = {"vary": {"motion.pulse.a_p": {"from": 1, "to": 9, "n": 5000}}}
    what = study(top=axes)
    monkeypatch.setattr(preview, "slowness", lambda: 1.0)
    one = preview.preview(what)
    monkeypatch.setattr(preview, "slowness", lambda: 3.0)
    assert preview.preview(what).seconds == pytest.approx(3.0 * one.seconds)
    assert 0.1 < slowness() < 100.0


def test_bodies_that_are_built_apart_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 600 outlines under nine pulses the estimate was 0.5 s; they took 4.5, as those that differ in numbers did not."""
    monkeypatch.setattr(preview, "slowness", lambda: 1.0)
    widths = [0.3 + 0.001 * k for k in range(60)]
    outlines = {
        f"body {b:.3f}": {"outline": [[0, 0], [b, 0], [b, 2], [0, 2]], "stands": "toes", "top": 2.0} for b in widths
    }
    numbers = {name: {"height": 2.0, "width": b} for (name, _), b in zip(outlines.items(), widths, strict=True)}
    amplitudes = {"motion.pulse.a_p": [3.0, 4.0, 5.0]}
    apart, together = (
        preview.preview(study(block={"height": 2.0, "width": 0.5}, top={"vary": {"block": blocks, **amplitudes}}))
        for blocks in (outlines, numbers)
    )
    assert apart.cases == together.cases == 180
    assert apart.seconds - together.seconds == pytest.approx(59 * cost.BATCH, rel=0.05)


def test_the_cells_of_a_table_are_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """50 000 rows of five columns took 4.3 s and 247 MB, of which .65 s and 150 MB were told."""
    monkeypatch.setattr(preview, "slowness", lambda: 1.0)
    rows = "".join(f"b{i},{1 + i},{5 + i}\n" for i in range(1000))
    (tmp_path / "t.csv").write_text("body,block.R,motion.pulse.omega_p\n" + rows)
    table, numbers = (
        preview.preview(study(top={"vary": vary}))
        for vary in ({"case": str(tmp_path / "t.csv")}, {"block.R": list(range(1, 1001))})
    )
    assert (table.memory - numbers.memory) * 1e6 == pytest.approx(cost.OF_CELL * 2000)
    assert table.seconds - numbers.seconds == pytest.approx(cost.CELL * 2000, rel=0.05)


def test_nothing_is_solved_for_an_estimate(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: Any) -> Any:
        raise AssertionError

    monkeypatch.setattr("rockcli.solvers.event.solver.solve", never)
    monkeypatch.setattr("rockcli.kernels.load", never)
    assert preview.preview(study(top={"vary": {"block.R": {"from": 1, "to": 9, "n": 300}}})).seconds > 0.0


def test_memory_grows_with_what_is_kept() -> None:
    def of(n: int, scalars: list[str]) -> float:
        axes = {"vary": {"motion.pulse.a_p": {"from": 1, "to": 9, "n": n}}}
        return memory(study(top=axes, save={"histories": False, "scalars": scalars}), 0.0)

    many, more = of(200_000, ["outcome"]), of(200_000, SUITE)
    assert more - many == pytest.approx(2 * 3.2e6)  # as results, and waiting to be written
    assert of(400_000, SUITE) - more == pytest.approx(2 * 3.4e6 + 1.6e6)  # with their numbers


def test_records_that_are_laid_out_for_one_case_each_are_part_of_the_outlook(tmp_path: Path) -> None:
    values = np.sin(np.arange(2000) * 0.05)
    for k in range(40):
        (tmp_path / f"r{k:02d}.AT2").write_text(at2_text(0.3 * values, 0.01, ["a", "b"]))
    files = {"motion.record.file": str(tmp_path / "*.AT2")}
    amplitudes = {"motion.record.pga": {"from": "0.5*g", "to": "0.6*g", "n": 20}}
    alone, _ = outlook(study({"record": {"pga": "0.5*g"}}, top={"vary": files}), 40)
    many, _ = outlook(study({"record": {}}, top={"vary": files | amplitudes}), 800)
    assert alone - many == pytest.approx(cost.LAYING_OUT * 2000 * (1.0 - 1.0 / 20.0), rel=1e-6)
