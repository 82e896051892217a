"""`refine` against the full map: made-up outcomes, whose boundaries are known, and Ricker pulses."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats
from swept import assert_same, counting

from rockcli.cli.words import report_text
from rockcli.engine.run import run_study, solve
from rockcli.engine.summary import report_on
from rockcli.engine.sweep.refine import UNDER_PULSES, UNDER_RECORDS, Maps, coarse_pitch
from rockcli.engine.sweep.sweep import Sweep
from rockcli.engine.sweep.work import Team
from rockcli.errors import StudyError
from rockcli.scene.batch import Batch
from rockcli.scene.response import FAILED, OVERTURNED_AFTER_IMPACT, OVERTURNED_WITHOUT_IMPACT, ROCKING, Response
from rockcli.storage import netcdf
from rockcli.storage.contents import Contents
from rockcli.study.open import open_study
from rockcli.study.study import Study

SIDE = 301
MAP: dict[str, Any] = {
    "name": "map",
    "case": {"block": {"R": 2.0, "tan_alpha": 0.2}, "initial": {"theta": 0.01}},
    "vary": {"block.R": {"from": 1, "to": 2, "n": SIDE}, "initial.theta": {"from": 0.05, "to": 0.15, "n": SIDE}},
    "save": {"scalars": ["outcome", "theta_peak_over_alpha", "n_impacts"]},
    "refine": True,
}


def made_up(batch: Batch) -> Response:
    """A wavy boundary, a disc that the coarse grid sees, and a sickle one pixel thick that grows out of the disc."""
    y, x = batch.block.R[:, 0] - 1.0, (batch.theta_0 - 0.05) / 0.1
    if batch.model == "linearized":
        x, y = y, 1.0 - x
    outcome = np.where(y > 0.7 + 0.1 * np.sin(9.0 * x), OVERTURNED_WITHOUT_IMPACT, ROCKING)
    outcome[np.hypot(x - 0.3, y - 0.3) < 0.06] = OVERTURNED_AFTER_IMPACT
    outcome[(np.abs(y - 0.3) < 0.6 / SIDE) & (x > 0.3) & (x < 0.8)] = OVERTURNED_AFTER_IMPACT
    scalars = {
        "outcome": outcome.astype(np.int8),
        "theta_peak_over_alpha": np.sqrt(x + y),
        "n_impacts": np.rint(100 * x).astype(np.int64),
    }
    return Response(scalars=scalars, reasons=[""] * batch.size, used={"backend": "made up"})


def unlucky(batch: Batch) -> Response:
    """As `made_up`, but solutions fail in a square, and are unresolved beside it."""
    found = made_up(batch)
    y, x = batch.block.R[:, 0] - 1.0, (batch.theta_0 - 0.05) / 0.1
    found.scalars["outcome"][(x > 0.5) & (x < 0.7) & (y < 0.2)] = FAILED
    return found


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Sizes of the batches solved by `made_up`."""
    return counting(monkeypatch, made_up)


def study(**more: Any) -> Study:
    return open_study(MAP | more)


def both(given: dict[str, Any]) -> tuple[Contents, Contents]:
    """The refined and the full map."""
    return solve(open_study(given)), solve(open_study(given | {"refine": False}))


def assert_solved_alike(refined: Contents, full: Contents) -> None:
    """Every solved pixel has the bits of the full map; the others say that they have none."""
    solved = refined.values("solved") == 1
    for name in ("outcome", "theta_peak_over_alpha", "n_impacts"):
        assert refined.values(name)[solved].tobytes() == full.values(name)[solved].tobytes(), name
    assert np.isnan(refined.values("theta_peak_over_alpha")[~solved]).all()
    assert (refined.values("n_impacts")[~solved] == -1).all()


def test_a_map_of_what_can_be_seen_is_the_full_map(counted: list[int]) -> None:
    refined, full = both(MAP)
    assert_solved_alike(refined, full)
    np.testing.assert_array_equal(refined.values("outcome"), full.values("outcome"))
    solved = refined.values("solved")
    assert solved.dtype == np.int8
    assert 0.02 < solved.mean() < 0.25
    assert sum(counted) == SIDE**2 + solved.sum()
    assert "solved" not in full.fields
    for name in ("R", "alpha", "p", "eta"):  # known of all cases, solved or not
        assert refined.values(name).tobytes() == full.values(name).tobytes()


def test_other_axes_have_a_map_each(counted: list[int]) -> None:
    vary = {
        "block.R": MAP["vary"]["block.R"],
        "model": ["rigid", "linearized"],
        "initial.theta": {"from": 0.05, "to": 0.15, "n": 250},
        "block.tan_alpha": [0.2, 0.3],
    }
    assert study(vary=vary).refine == ("block_R", "initial_theta")
    refined, full = both(MAP | {"vary": vary})
    assert_solved_alike(refined, full)
    np.testing.assert_array_equal(refined.values("outcome"), full.values("outcome"))
    assert refined.values("solved").mean() < 0.3


def test_what_failed_is_never_filled_in(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rockcli.solvers.event.solver.solve", unlucky)
    refined, full = both(MAP)
    failed = full.values("outcome") == FAILED
    assert failed.sum() > 1000
    assert (refined.values("solved")[failed] == 1).all()
    np.testing.assert_array_equal(refined.values("outcome"), full.values("outcome"))


def test_a_band_thinner_than_a_pixel_is_followed_over_its_gaps(monkeypatch: pytest.MonkeyPatch) -> None:
    def solver(batch: Batch) -> Response:
        found = made_up(batch)
        y, x = batch.block.R[:, 0] - 1.0, (batch.theta_0 - 0.05) / 0.1
        band = np.abs(y - 0.3 - 0.23 * (x - 0.3)) < 0.15 / (SIDE - 1)
        outcome = np.where((np.hypot(x - 0.3, y - 0.3) < 0.06) | (band & (x > 0.3) & (x < 0.9)), 3, 1)
        found.scalars["outcome"][:] = outcome
        return found

    monkeypatch.setattr("rockcli.solvers.event.solver.solve", solver)
    refined, full = both(MAP)
    across = (full.values("outcome") == 3)[:, 120:].any(axis=0)
    assert 0.2 < across[:150].mean() < 0.4  # it meets a pixel in one column of three
    np.testing.assert_array_equal(refined.values("outcome"), full.values("outcome"))
    assert refined.values("solved").mean() < 0.15


def test_an_island_between_the_coarse_pixels_is_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the documentation says is missed is missed, and what it says is found is found."""
    pitch = coarse_pitch(SIDE, UNDER_PULSES.coarsest)

    def solver(batch: Batch) -> Response:
        found = made_up(batch)
        y, x = batch.block.R[:, 0] - 1.0, (batch.theta_0 - 0.05) / 0.1
        row, column = np.rint(y * (SIDE - 1)), np.rint(x * (SIDE - 1))
        outcome = np.where(
            (row % pitch > 0) & (column % pitch > 0) & (row // pitch == 30) & (column // pitch == 40), 3, 1
        )
        outcome[(row > 4) & (row < 5 + pitch) & (column > 6) & (column < 7 + pitch)] = 2
        found.scalars["outcome"][:] = outcome
        return found

    monkeypatch.setattr("rockcli.solvers.event.solver.solve", solver)
    monkeypatch.setattr("rockcli.engine.sweep.refine.PROBES", 0)
    refined, full = both(MAP)
    assert not {"drawn", "drawn_wrong", "wrong_at_most"} & set(refined.fields["solved"].attrs)
    wrong = refined.values("outcome") != full.values("outcome")
    assert wrong.sum() == (pitch - 1) ** 2
    assert (full.values("outcome")[wrong] == 3).all()


def test_the_limit_is_of_the_cases_that_were_drawn_from(monkeypatch: pytest.MonkeyPatch) -> None:
    """With one wrong case more than it says none would be met less often than one time in twenty."""
    monkeypatch.setattr("rockcli.solvers.event.solver.solve", made_up)
    solved = solve(open_study(MAP)).fields["solved"]
    drawn, wrong = solved.attrs["drawn"], solved.attrs["drawn_wrong"]
    most = int(solved.attrs["wrong_at_most"] * solved.values.size) + 1
    before = int((solved.values == 0).sum()) + drawn
    assert (drawn > 100, wrong) == (True, 0)
    assert 0.049 < stats.hypergeom(before, most, drawn).pmf(0) < 0.05


def test_what_is_drawn_at_random_tells_how_much_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    """Islands of a few pixels that no boundary leads to; every one that is hit is put right."""

    def solver(batch: Batch) -> Response:
        found = made_up(batch)
        y, x = np.rint((batch.block.R[:, 0] - 1.0) * (SIDE - 1)), np.rint((batch.theta_0 - 0.05) * 10.0 * (SIDE - 1))
        found.scalars["outcome"][:] = np.where((y % 4 > 0) & (x % 4 > 0) & ((31 * y + 17 * x) % 23 < 2), 3, 1)
        return found

    monkeypatch.setattr("rockcli.solvers.event.solver.solve", solver)
    monkeypatch.setattr("rockcli.engine.sweep.refine.UNDER_PULSES", UNDER_PULSES._replace(ahead=0))
    refined, full = both(MAP)
    wrong = (refined.values("outcome") != full.values("outcome")).mean()
    told = refined.fields["solved"].attrs
    assert 0 < told["drawn_wrong"] < told["drawn"]
    assert 0.02 < wrong < told["wrong_at_most"] < 3.0 * wrong
    assert (refined.values("solved") == 1)[refined.values("outcome") == 3].all()
    report = report_on(study(), refined, status="solved")
    assert (report.drawn, report.drawn_wrong) == (told["drawn"], told["drawn_wrong"])
    assert report.wrong_at_most == told["wrong_at_most"]
    assert f"{told['drawn_wrong']} of {told['drawn']} cases drawn at random were filled in wrongly" in report_text(
        report
    )


def test_every_change_lies_between_pixels_that_were_solved(counted: list[int]) -> None:
    refined, _ = both(MAP)
    outcome, solved = refined.values("outcome"), refined.values("solved") == 1
    down, along = outcome[1:] != outcome[:-1], outcome[:, 1:] != outcome[:, :-1]
    assert (solved[1:] & solved[:-1])[down].all()
    assert (solved[:, 1:] & solved[:, :-1])[along].all()


@pytest.mark.parametrize(
    ("n", "pitch", "under_records"),
    [(2, 1, 1), (99, 1, 1), (100, 2, 2), (200, 4, 4), (399, 4, 4), (400, 8, 8), (1000, 16, 16), (9000, 32, 16)],
)
def test_the_coarse_grid_has_at_least_fifty_cells(n: int, pitch: int, under_records: int) -> None:
    assert coarse_pitch(n, UNDER_PULSES.coarsest) == pitch
    assert coarse_pitch(n, UNDER_RECORDS.coarsest) == under_records


def test_a_broken_off_run_goes_on(tmp_path: Path, counted: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    whole = solve(study(), sweep=Sweep(Team()))
    needed = sum(counted)
    counted.clear()

    def breaks(batch: Batch) -> Response:
        if len(counted) == 4:
            raise KeyboardInterrupt
        counted.append(batch.size)
        return made_up(batch)

    with monkeypatch.context() as once:
        once.setattr("rockcli.solvers.event.solver.solve", breaks)
        with pytest.raises(KeyboardInterrupt):
            run_study(study(), tmp_path, plots=False)
    report = run_study(study(), tmp_path, plots=False)
    assert report.resumed > 1000
    assert sum(counted) == needed == report.refined
    assert_same(whole, netcdf.read(tmp_path / "map" / "map.nc"))
    assert run_study(study(), tmp_path, plots=False).refined == needed
    with pytest.raises(StudyError, match="before it was changed in refine"):
        run_study(study(refine=False), tmp_path, plots=False)


def test_shares_are_refused(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match="--part cannot divide a refined map"):
        run_study(study(), tmp_path, plots=False, share=(1, 2))


PULSES = {
    "name": "ricker",
    "case": {
        "block": {"R": 1, "tan_alpha": 0.2},
        "motion": {"pulse": {"shape": "ricker", "omega_p_over_p": 2, "a_p_over_g_tan_alpha": 2}},
    },
    "save": {"scalars": ["outcome", "theta_peak_over_alpha", "n_impacts"]},
    "refine": True,
}


def ricker(n: int) -> dict[str, Any]:
    vary = {
        "motion.pulse.omega_p_over_p": {"from": 0.1, "to": 10, "n": n},
        "motion.pulse.a_p_over_g_tan_alpha": {"from": 1, "to": 10.9, "n": n},
    }
    return PULSES | {"vary": vary}


def share_and_wrong(n: int) -> tuple[float, float]:
    refined, full = both(ricker(n))
    assert_solved_alike(refined, full)
    wrong = refined.values("outcome") != full.values("outcome")
    report = report_on(open_study(ricker(n)), refined, status="solved")
    assert report.refined == refined.values("solved").sum()
    assert f"refined   {report.refined} cases solved" in report_text(report)
    return float(refined.values("solved").mean()), float(wrong.mean())


def test_ricker_pulses() -> None:
    share, wrong = share_and_wrong(130)
    assert share < 0.4  # the finer the map, the smaller
    assert wrong < 2e-3


@pytest.mark.slow
def test_ricker_pulses_on_a_fine_map() -> None:
    share, wrong = share_and_wrong(1000)
    assert share <= 0.05
    assert wrong <= 2e-4


CURVES = {
    "case": {"block": {"R": 1, "tan_alpha": 0.2}},
    "vary": {"block.R": [1, 2], "block.tan_alpha": [0.1, 0.2]},
    "curves": ["moment_rotation"],
    "save": {},
}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"vary": {"block.R": [1, 2, 3]}}, "needs two numeric axes .* there are 1"),
        ({"vary": {"block.R": [1, 3, 2], "initial.theta": [0.01, 0.02]}}, "block.R is not ascending or descending"),
        ({"over": "block.R"}, "`over` takes statistics"),
        ({"save": {"histories": True}}, "no histories are saved"),
        (CURVES, "needs outcomes, and this study is one of static curves"),
    ],
)
def test_what_cannot_be_refined_is_said(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(StudyError, match=words):
        study(**changes)


def test_a_search_is_not_refined() -> None:
    searched = ricker(20)
    searched["vary"]["motion.pulse.a_p_over_g_tan_alpha"]["find"] = "overturning"
    with pytest.raises(StudyError, match="`find` does not make a map"):
        open_study(searched | {"save": {}})


def test_records_are_warned_of() -> None:
    given = {
        "name": "record",
        "case": {
            "block": {"R": 1, "tan_alpha": 0.2},
            "motion": {"record": {"file": "synthetic_rock_m65.AT2", "pga": 1}},
        },
        "vary": {"block.R": [1, 2], "motion.record.pga": [1, 2]},
        "refine": True,
    }
    assert any("fractal" in sentence for sentence in open_study(given).warnings)
    fine = open_study(given | {"vary": {name: {"from": 1, "to": 2, "n": 1600} for name in given["vary"]}})
    assert Maps.of(fine).pitch == UNDER_RECORDS.coarsest
    assert Maps.of(open_study(ricker(1600))).pitch == UNDER_PULSES.coarsest
    assert not any("fractal" in sentence for sentence in open_study(given | {"refine": False}).warnings)
