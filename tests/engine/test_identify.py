"""`rock identify` on synthetic measurements: an independent integration plus noise, and amplitudes alone."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from reference import flights, symmetric
from scipy.optimize import curve_fit
from typer.testing import CliRunner

from rockcli.cli.main import app
from rockcli.engine import identify
from rockcli.engine.identify import ALPHA, ETA, Measured, identify_amplitudes
from rockcli.errors import StudyError

G, ALPHA_0, R, ETA_0 = 9.81, 0.25, 0.8, 0.91
P_0 = float(np.sqrt(0.75 * G / R))


def free_rocking(theta_0: float, t: np.ndarray) -> np.ndarray:
    """Rotation of a rigid block let go at theta_0, by DOP853 restarted at impacts."""
    out = np.zeros(len(t))
    body = symmetric(ALPHA_0, P_0, ETA_0)
    for sol, _ in flights(body, int(np.sign(theta_0)), (theta_0, 0.0), 0.0, [(t[-1], lambda t: 0.0)], rest=1e-4):
        inside = (t >= sol.t[0]) & (t <= sol.t[-1])
        out[inside] = sol.sol(t[inside])[0]
    return out


def write(path: Path, *columns: np.ndarray, head: str = "") -> Path:
    np.savetxt(path, np.column_stack(columns), header=head)
    return path


def identified(*arguments: str) -> dict:
    result = CliRunner().invoke(app, ["identify", *arguments, "--json"])
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


@pytest.mark.slow
def test_eta_alpha_and_p_from_a_noisy_history(tmp_path: Path) -> None:
    t = np.arange(0.0, 4.0, 0.02)
    noise = 0.01 * ALPHA_0 * np.random.default_rng(7).normal(size=len(t))
    file = write(tmp_path / "free.txt", t, free_rocking(0.6 * ALPHA_0, t) + noise, head="time [s], theta [rad]")
    found = identified(str(file), "--alpha", str(1.05 * ALPHA_0), "--p", str(0.97 * P_0), "--fit", "alpha,p")
    truth = {"eta": ETA_0, "alpha": ALPHA_0, "p": P_0, "theta_0": 0.6 * ALPHA_0}
    for name, true in truth.items():
        row = found["parameters"][name]
        half = row["high"] - row["value"]
        assert abs(row["value"] - true) < 2.0 * half, name  # four standard errors
        assert half < 0.05 * true, name
    assert found["scatter"] == pytest.approx(0.01 * ALPHA_0, rel=0.2)
    assert found["notes"] == []


def test_rows_close_together_ask_for_no_finer_history(tmp_path: Path) -> None:
    t = np.sort(np.append(np.arange(0.0, 2.0, 0.04), 1.0 + 1e-9))
    file = write(tmp_path / "twice.txt", t, free_rocking(0.6 * ALPHA_0, t))
    found = identified(str(file), "--alpha", str(ALPHA_0), "--p", str(P_0))
    assert found["parameters"]["eta"]["value"] == pytest.approx(ETA_0, rel=1e-4)


def test_eta_of_a_driven_body(tmp_path: Path) -> None:
    # a shake table: the motion in the study, the history by the solver under another eta
    import rockcli

    study = {
        "name": "table",
        "case": {
            "block": {"R": R, "alpha": ALPHA_0},
            "motion": {"pulse": {"shape": "sine", "a_p": 4.0, "omega_p": 5.0, "cycles": 2}},
            "damping": {"scheme": "restitution", "eta": ETA_0},
        },
        "save": {"dt_out": 0.01},
    }
    truth = rockcli.run(study)
    kept = np.isfinite(truth["theta"].values)
    t, theta = truth["time"].values[kept][:400], truth["theta"].values[kept][:400]
    noisy = theta + 0.002 * np.random.default_rng(3).normal(size=len(theta))
    data = write(tmp_path / "table.csv", t, np.degrees(noisy))
    file = tmp_path / "table.yaml"
    study["case"]["damping"]["eta"] = 0.95  # type: ignore[index]
    file.write_text(json.dumps(study))
    found = identified(str(data), "--study", str(file), "--degrees")
    assert list(found["parameters"]) == ["eta"]
    row = found["parameters"]["eta"]
    assert row["low"] - 1e-3 < ETA_0 < row["high"] + 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 15, 19])
def test_eta_of_a_body_shaken_for_long_is_found_from_a_wrong_guess(tmp_path: Path, seed: int) -> None:
    """The sum of squares has many minima in eta under a ground motion: 553 times the noise was left at one of them, the whole motion with the last."""
    import rockcli

    a = np.convolve(np.random.default_rng(seed).normal(size=400), np.hanning(11), "same")
    a *= np.sin(np.linspace(0.0, np.pi, len(a)))
    np.savetxt(tmp_path / "motion.csv", 5.0 * a / np.abs(a).max())
    study = {
        "name": "table",
        "case": {
            "block": {"R": R, "alpha": ALPHA_0},
            "motion": {"record": {"file": str(tmp_path / "motion.csv"), "units": "m/s2", "dt": 0.02}},
            "damping": {"scheme": "restitution", "eta": ETA_0},
        },
        "save": {"dt_out": 0.01},
    }
    truth = rockcli.run(study)
    kept = np.isfinite(truth["theta"].values) & (truth["time"].values < 8.0)
    t, theta = truth["time"].values[kept], truth["theta"].values[kept]
    noise = 0.005 * ALPHA_0
    noisy = theta + noise * np.random.default_rng(3).normal(size=len(theta))
    data = write(tmp_path / "table.txt", t, noisy)
    study["case"]["damping"]["eta"] = 0.95  # type: ignore[index]
    (tmp_path / "table.yaml").write_text(json.dumps(study))
    found = identified(str(data), "--study", str(tmp_path / "table.yaml"))
    assert found["parameters"]["eta"]["value"] == pytest.approx(ETA_0, abs=2e-4)
    assert found["scatter"] == pytest.approx(noise, rel=0.1)


@pytest.mark.parametrize(("alpha", "doubted"), [(ALPHA_0, False), (1.15 * ALPHA_0, True)])
def test_residuals_that_are_no_noise_are_told(tmp_path: Path, alpha: float, doubted: bool) -> None:
    t = np.arange(0.0, 1.5, 0.02)
    noise = 0.005 * ALPHA_0 * np.random.default_rng(5).normal(size=len(t))
    file = write(tmp_path / "free.txt", t, free_rocking(0.6 * ALPHA_0, t) + noise)
    found = identified(str(file), "--alpha", str(alpha), "--p", str(P_0))
    assert any("correlate" in note for note in found["notes"]) is doubted


def test_every_stage_is_told() -> None:
    t = np.arange(0.0, 0.6, 0.02)
    source = {"name": "free", "case": {"block": {"R": R, "alpha": ALPHA_0}, "initial": {"theta": 0.6 * ALPHA_0}}}
    told: list[tuple[int, int]] = []
    names = [ETA, identify.THETA, identify.RATE]
    measured = Measured(free_rocking(0.6 * ALPHA_0, t), t)
    identify.identify_history(
        measured, source, identify.guess_of(source), names, lambda done, of: told.append((done, of))
    )
    assert told == [(0, 4), (1, 4), (2, 4), (3, 4)]


def amplitudes(n: int) -> np.ndarray:
    top = np.cos(0.0) - np.cos(ALPHA_0)
    start = np.cos(ALPHA_0 - 0.7 * ALPHA_0) - np.cos(ALPHA_0)
    U = start * ETA_0 ** (2.0 * np.arange(n))
    assert U[0] < top
    return ALPHA_0 - np.arccos(U + np.cos(ALPHA_0))


def test_amplitudes_alone() -> None:
    found = identify_amplitudes(Measured(amplitudes(8), None), ALPHA_0, free=[ETA])
    assert found.fit.values[0] == pytest.approx(ETA_0, abs=1e-9)
    found = identify_amplitudes(Measured(amplitudes(8), None), 1.2 * ALPHA_0, free=[ALPHA])
    assert found.fit.values[[0, 2]] == pytest.approx([ETA_0, ALPHA_0], rel=1e-6)


@pytest.mark.parametrize("size", [1e-4, 1e-6])
def test_the_fit_of_small_amplitudes_is_the_least_sum_of_squares_too(size: float) -> None:
    """Small ones fall by eta² a swing, as U is proportional to theta: the curve that scipy fits to shares of the first."""
    swings = np.arange(12.0)
    shares = np.abs(ETA_0 ** (2.0 * swings) + 0.01 * np.random.default_rng(1).normal(size=12))
    (eta, _), _ = curve_fit(lambda k, eta, first: first * eta ** (2.0 * k), swings, shares, p0=[0.95, 1.0])
    found = identify_amplitudes(Measured(size * ALPHA_0 * shares, None), ALPHA_0, free=[ETA]).fit
    assert found.values[0] == pytest.approx(eta, abs=1e-4)
    assert found.converged


def test_intervals_cover_the_truth_as_often_as_they_say() -> None:
    draw = np.random.default_rng(11)
    covered = []
    for _ in range(200):
        noisy = amplitudes(8) + 0.002 * draw.normal(size=8)
        fit = identify_amplitudes(Measured(noisy, None), ALPHA_0, free=[ETA]).fit
        covered.append(fit.low[0] <= ETA_0 <= fit.high[0])
    assert 0.90 <= np.mean(covered) <= 0.99


def test_the_command_with_amplitudes(tmp_path: Path) -> None:
    file = write(tmp_path / "peaks.txt", amplitudes(6))
    told = CliRunner().invoke(app, ["identify", str(file), "--alpha", str(ALPHA_0)])
    assert told.exit_code == 0, told.output
    assert f"eta          {ETA_0:.6g}" in told.stdout
    told = CliRunner().invoke(app, ["identify", str(file), "--alpha", str(1.1 * ALPHA_0), "--fit", "alpha"])
    (line,) = (line for line in told.stdout.splitlines() if line.strip().startswith("alpha"))
    assert f"{ALPHA_0:.6g}" in line
    assert line.endswith(" rad")


def test_what_the_data_do_not_determine_has_no_interval(tmp_path: Path) -> None:
    t = np.arange(0.0, 0.3, 0.01)  # before the first impact
    file = write(tmp_path / "short.txt", t, free_rocking(0.6 * ALPHA_0, t))
    told = CliRunner().invoke(app, ["identify", str(file), "--alpha", str(ALPHA_0), "--p", str(P_0)])
    assert told.exit_code == 0, told.output
    (eta,) = (line for line in told.stdout.splitlines() if line.strip().startswith("eta"))
    assert eta.endswith("no interval")
    assert "nan" not in told.stdout


@pytest.mark.slow
def test_measured_and_fitted_are_written(tmp_path: Path) -> None:
    """The fitted rotation is that of an independent integration, the residual the noise that was added."""
    t = 5.0 + np.arange(0.0, 3.0, 0.02)
    free, noise = free_rocking(0.6 * ALPHA_0, t - t[0]), 1e-3 * np.random.default_rng(7).normal(size=len(t))
    file = write(tmp_path / "free.txt", t, free + noise)
    body = [str(file), "--alpha", str(ALPHA_0), "--p", str(P_0)]
    identified(*body, "--out", str(tmp_path / "fit.csv"))
    assert (tmp_path / "fit.csv").read_text().startswith("time [s],measured [rad],fitted [rad]\n")
    times, measured, fitted = np.loadtxt(tmp_path / "fit.csv", delimiter=",", skiprows=1).T
    np.testing.assert_allclose(times, t, rtol=1e-12)
    np.testing.assert_allclose(measured, free + noise, rtol=1e-12)
    np.testing.assert_allclose(fitted, free, atol=1e-3)
    peaks = write(tmp_path / "peaks.txt", amplitudes(6))
    for name in ("fit.png", "fit.svg"):
        identified(str(peaks), "--alpha", str(ALPHA_0), "--out", str(tmp_path / name))
        assert (tmp_path / name).stat().st_size > 1000


def test_a_place_that_cannot_be_is_refused_before_anything_is_fitted(tmp_path, monkeypatch):
    monkeypatch.setattr(identify, "identify_amplitudes", None)
    peaks = write(tmp_path / "peaks.txt", amplitudes(6))
    (tmp_path / "folder.csv").mkdir()
    for name, why in (("fit.jpg", "expected a name that ends in .csv, .png"), ("folder.csv", "is a folder")):
        wrong = CliRunner().invoke(app, ["identify", str(peaks), "--alpha", ".25", "--out", str(tmp_path / name)])
        assert isinstance(wrong.exception, StudyError)
        assert why in str(wrong.exception)


def test_the_fit_does_not_replace_what_was_measured(tmp_path, monkeypatch):
    monkeypatch.setattr(identify, "identify_amplitudes", None)
    peaks = write(tmp_path / "peaks.csv", amplitudes(6))
    before = Path(peaks).read_text()
    wrong = CliRunner().invoke(app, ["identify", str(peaks), "--alpha", ".25", "--out", str(peaks)])
    assert isinstance(wrong.exception, StudyError)
    assert "is what was measured" in str(wrong.exception)
    assert Path(peaks).read_text() == before


def test_the_figure_shows_both_and_the_residuals() -> None:
    from rockcli.plotting.fit import figure

    time = np.linspace(0.0, 2.0, 200)
    above, below = figure(time, "time [s]", np.cos(time) + 0.1, np.cos(time), "a test").axes
    one, other, *_ = (np.asarray(line.get_ydata()) for line in above.lines)
    np.testing.assert_array_equal(one - other, np.asarray(below.lines[0].get_ydata()))
    assert below.get_xlabel() == "time [s]"


@pytest.mark.parametrize(
    ("text", "options", "said"),
    [
        ("0,00;0,1\n1,00;0,05\n2,00;0,02\n", ["--alpha", ".2", "--p", "2"], "write decimals with a point"),
        ("0,15\n0,13\n0,11\n", ["--alpha", ".2"], "do not increase; a comma parts columns: write decimals with"),
        ("0 .1\n1 .05\n1 .02\n", ["--alpha", ".2", "--p", "2"], "do not increase"),
        ("0 .1 3\n1 .05 3\n", ["--alpha", ".2", "--p", "2"], "one column"),
        ("t theta\n0 .1\nx y\n", ["--alpha", ".2", "--p", "2"], "expected numbers"),
        ("theta [deg]\n.2\n.17\n.14\n", ["--alpha", ".2"], "says [deg], and rotations are taken in radians"),
        ("# t (s) theta (rad)\n0 .1\n1 .05\n", ["--alpha", ".2", "--degrees"], "says [rad]: leave --degrees out"),
        ("time [ms],theta [rad]\n0,.1\n1,.05\n", ["--alpha", ".2", "--p", "2"], "says [ms]; expected time [s]"),
        ("0 .1\n1 .05\n2 .02\n", ["--alpha", ".2"], "needs --p"),
        (".1\n.05\n.02\n", [], "--alpha"),
        (".3\n.05\n.02\n", ["--alpha", ".2"], "between 0 and alpha"),
        (".1\n.05\n.02\n", ["--alpha", ".2", "--fit", "p"], "say nothing of p"),
        (".1\n.05\n.02\n", ["--alpha", ".2", "--fit", "mass"], "expected eta, alpha or p"),
        (".1\n.05\n.02\n", ["--alpha", "14"], "--alpha 14: expected an angle between 0 and pi/2 in radians"),
        (".1\n.05\n.02\n", ["--alpha", "-.2"], "--alpha -0.2: expected an angle"),
        ("0 .1\n1 .05\n2 .02\n", ["--alpha", ".2", "--p", "0"], "--p 0: expected a number of rad/s"),
        ("0 .1\n1 .05\n2 .02\n", ["--alpha", ".2", "--p", "-3"], "--p -3: expected a number of rad/s"),
        ("0 .1\n1 .05\n2 .02\n", ["--alpha", ".2", "--p", "nan"], "--p nan: expected a number of rad/s"),
    ],
)
def test_wrong_data(tmp_path: Path, text: str, options: list[str], said: str) -> None:
    from rockcli.errors import StudyError

    file = tmp_path / "data.txt"
    file.write_text(text)
    result = CliRunner().invoke(app, ["identify", str(file), *options])
    assert isinstance(result.exception, StudyError)
    assert said in str(result.exception)
