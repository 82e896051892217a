"""Calibration: Bayes' rule written out again, truth recovered from runs that a known error has made, commands."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.stats import norm

from rockcli.analysis.experiments.calibration import (
    AMPLITUDES,
    LAPSE,
    LOCATIONS,
    SCATTERS,
    SPREAD,
    WALKS,
    capacities,
    errors,
    evidence,
    predict,
)
from rockcli.cli.calibrate import _cells
from rockcli.engine.experiments.calibrate import Calibration, predicted
from rockcli.engine.experiments.score import Options
from rockcli.engine.experiments.simulated import Simulated


def steps(capacity: np.ndarray) -> np.ndarray:
    """Shares of models that overturn at amplitudes above their capacity: (n, c) -> (n, c, a)."""
    return (capacity[..., None] < AMPLITUDES).astype(float)


def test_the_weights_of_bodies_are_bayes_rule():
    rng = np.random.default_rng(1)
    share = steps(np.exp(rng.normal(0.0, 0.4, (6, 3))))
    share[2, 1, 4] = np.nan
    share[3, 0, 7] = 0.25
    outcome, group = rng.random(6) < 0.5, np.array([0, 0, 1, 2, 2, 2])
    found = evidence(share, outcome, group, AMPLITUDES).weights(np.array([True, False, True]))
    edges = np.log(AMPLITUDES[:-1] * AMPLITUDES[1:]) / 2.0
    weights = []
    for body in range(3):
        total = 0.0
        for mu in LOCATIONS:
            for beta in SCATTERS[::4]:
                inside = np.diff(np.concatenate([[0.0], norm.cdf(edges, mu, beta), [1.0]]))
                likelihood = norm.pdf(mu, 0.0, SPREAD)
                for i in (0, 1, 3, 4, 5):
                    p = LAPSE + (1.0 - 2.0 * LAPSE) * np.where(np.isnan(share[i, body]), 0.5, share[i, body]) @ inside
                    likelihood *= p if outcome[i] else 1.0 - p
                total += likelihood
        weights.append(total ** (2.0 / 5.0))  # five runs of two groups
    assert found == pytest.approx(np.array(weights) / sum(weights), rel=1e-9)


def test_mu_beta_and_their_walk_are_bayes_rule():
    """Every path of mu over three sessions, the second without runs, weighed by its probability."""
    log_capacity, outcome = np.array([0.1, -0.2, 0.3, 0.05]), np.array([True, True, False, False])
    session = np.array([0, 0, 2, 2])
    p = LAPSE + (1.0 - 2.0 * LAPSE) * norm.cdf((LOCATIONS[:, None] - log_capacity[:, None, None]) / SCATTERS)
    own = np.ones((3, *p.shape[1:]))
    for i in range(4):
        own[session[i]] *= p[i] if outcome[i] else 1.0 - p[i]
    prior = norm.pdf(LOCATIONS, 0.0, SPREAD)
    last, total, walks = np.zeros(p.shape[1:]), 0.0, []
    for walk in WALKS:
        step = norm.pdf(LOCATIONS[:, None], LOCATIONS, walk)
        step /= step.sum(axis=1, keepdims=True)
        joint = np.einsum("i,ib,ij,jb,jk,kb->ijkb", prior / prior.sum(), own[0], step, own[1], step, own[2])
        last += joint.sum(axis=(0, 1))
        walks.append(joint.sum())
    total = sum(walks)
    found = errors(log_capacity, outcome, session, 3)
    assert found.weight[2] == pytest.approx(last / total, rel=1e-8, abs=1e-14)
    assert found.walk == pytest.approx(np.array(walks) / total, rel=1e-9)
    new = norm.cdf((LOCATIONS[:, None] - 0.12) / SCATTERS)
    place = (LAPSE + (1.0 - 2.0 * LAPSE) * new).ravel()
    said, low, high = predict(np.array([0.12]), found, np.array([2]))[:, 0]
    right = (last / total).ravel()
    assert said == pytest.approx(right @ place, rel=1e-9)
    order = np.argsort(place)
    mass = np.cumsum(right[order])
    for end, q in ((low, 0.025), (high, 0.975)):
        assert end == pytest.approx(place[order][np.searchsorted(mass, q)], abs=1e-9)


def test_the_capacity_is_where_as_much_falls_below_as_stands_above():
    step = np.log(AMPLITUDES[1] / AMPLITUDES[0])
    share = steps(np.array([[0.01, 1.0, 100.0]]))
    ends = np.log(AMPLITUDES[0]) - step / 2.0, np.log(AMPLITUDES[-1]) + step / 2.0
    assert capacities(share, AMPLITUDES)[0] == pytest.approx([ends[0], 0.0, ends[1]], abs=1e-12)
    share[0, 1, 9], share[0, 1, 4] = 0.0, 1.0  # a pocket on either side
    assert capacities(share, AMPLITUDES)[0, 1] == pytest.approx(0.0, abs=1e-12)
    share[0, 1, 10] = np.nan
    assert capacities(share, AMPLITUDES)[0, 1] == pytest.approx(step / 2.0, abs=1e-12)


def synthetic(seed: int, n: int, mu: float, beta: float) -> tuple[np.ndarray, np.ndarray]:
    """Logarithms of a model's capacity in n runs, and outcomes where motions act stronger by exp(normal(mu, beta))."""
    rng = np.random.default_rng(seed)
    log_capacity = rng.uniform(-0.6, 0.6, n)
    return log_capacity, rng.normal(mu, beta, n) > log_capacity


def once(n: int) -> np.ndarray:
    """One session of n runs."""
    return np.zeros(n, dtype=np.int64)


def test_a_known_error_lies_in_its_interval_as_often_as_it_says():
    inside = []
    for seed in range(40):
        log_capacity, outcome = synthetic(seed, 60, -0.15, 0.15)
        factor, scatter = errors(log_capacity, outcome, once(60), 1).summaries()
        inside.append(factor.p2_5 <= np.exp(0.15) <= factor.p97_5 and scatter.p2_5 <= 0.15 <= scatter.p97_5)
    assert sum(inside) >= 32  # of two intervals of 95 % at once: 36 expected, fewer than 32 once in 60 times


def test_predicted_probabilities_are_the_shares_that_overturn():
    known = errors(*synthetic(0, 400, 0.1, 0.15), once(400), 1)
    log_capacity, outcome = synthetic(1, 6000, 0.1, 0.15)
    p = predict(log_capacity, known, once(6000))[0]
    place = np.minimum((p * 12.0).astype(int), 11)
    for number in range(12):
        some = place == number
        assert some.sum() >= 100
        assert outcome[some].mean() == pytest.approx(p[some].mean(), abs=0.12)
    assert np.mean((p - outcome) ** 2) < 0.1


def test_many_bodies_that_err_by_chance_are_surer_together():
    """Each of thirty models errs by 0.3 in every run; the mean of them errs less, and is taken for what it is."""
    rng = np.random.default_rng(4)
    truth, outcome = synthetic(2, 400, 0.0, 0.1)
    several = np.exp(truth[:, None] + rng.normal(0.0, 0.3, (400, 30)))
    scatters = []
    for bodies in (several[:, :1], several):
        known = calibration(outcome, bodies, tuple(f"g{i // 20}" for i in range(400)))
        scatters.append(known.as_plain()["capacity_scatter"])
    assert scatters[0]["p2_5"] > scatters[1]["p97_5"]
    assert scatters[1]["mean"] == pytest.approx(np.hypot(0.1, 0.3 / np.sqrt(30.0)), rel=0.4)


def test_an_error_that_wanders_from_session_to_session_is_followed():
    rng = np.random.default_rng(6)
    session = np.repeat(np.arange(12), 20)
    mu = np.cumsum(np.concatenate([[-0.3], np.full(11, 0.06)]))[session]
    log_capacity = rng.uniform(-0.8, 0.8, 240)
    outcome = rng.normal(mu, 0.1) > log_capacity
    even = np.arange(240) % 2 == 0
    brier = []
    for where, count in ((session, 12), (np.zeros(240, dtype=np.int64), 1)):
        known = errors(log_capacity[even], outcome[even], where[even], count)
        brier.append(np.mean((predict(log_capacity[~even], known, where[~even])[0] - outcome[~even]) ** 2))
    assert brier[0] < 0.8 * brier[1]


def test_runs_tell_the_right_body():
    rng = np.random.default_rng(5)
    capacity = np.exp(rng.normal(0.0, 0.5, (80, 4)))
    outcome = np.exp(rng.normal(0.1, 0.1, 80)) > capacity[:, 2]
    assert evidence(steps(capacity), outcome, np.arange(80), AMPLITUDES).weights(np.ones(80, bool))[2] > 0.99


def calibration(outcome: np.ndarray, capacity: np.ndarray, labels: tuple[str, ...]) -> Calibration:
    inputs = {"block.b": np.arange(float(capacity.shape[1]))}
    return Calibration(Simulated(steps(capacity), AMPLITUDES, inputs, {}, "s", ""), outcome, labels, "runs.csv")


def test_no_run_is_predicted_by_outcomes_of_its_group():
    """What happened in a group changes all predictions but its own."""
    rng = np.random.default_rng(3)
    capacity, labels = np.exp(rng.normal(0.0, 0.4, (40, 5))), tuple(f"g{i % 8}" for i in range(40))
    outcome = capacity[:, 1] < 1.0
    own = np.array([label == "g3" for label in labels])
    for leave_out in (True, False):
        p = []
        for flipped in (outcome, np.where(own, ~outcome, outcome)):
            known = calibration(flipped, capacity, labels)
            options = Options(count=0, repeats=1)
            p.append(predicted(known, known.simulated, labels, options, leave_out=leave_out)[0].p)
        assert (p[0][own] == p[1][own]).all() == leave_out
        assert (p[0][~own] != p[1][~own]).all()


DT = 0.01
TRUE = 0.06


@pytest.fixture(scope="module")
def experiments(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Thirty sines on a body of b = TRUE, half of them in a.csv and half in b.csv, and a study that does not know b."""
    import rockcli

    folder = tmp_path_factory.mktemp("experiments")
    rng = np.random.default_rng(2)
    lines: dict[str, list[str]] = {"a": [], "b": []}
    for number in range(30):
        period, name = rng.uniform(0.3, 1.2), f"sine_{number:02}.txt"
        t = DT * np.arange(int(1.5 * period / DT) + 2)
        np.savetxt(folder / name, np.sin(2.0 * np.pi * t / period) * (t <= period))
        scale = float(np.exp(rng.uniform(0.0, np.log(20.0))))
        record = {"file": str(folder / name), "units": "m/s2", "dt": DT, "scale": scale}
        case = {"block": {"h": 0.3, "b": TRUE}, "damping": {"eta": 0.9}, "motion": {"record": record}}
        fell = int(rockcli.run({"case": case, "save": {"histories": False}})["outcome"]) >= 2
        lines["ab"[number % 2]].append(f"{name},{scale!r},{int(fell)},g{number // 3}")
    for table, rows in lines.items():
        (folder / f"{table}.csv").write_text("\n".join(["record,scale,outcome,group", *rows]) + "\n")
    study = {
        "name": "unknown-width",
        "case": {
            "block": {"h": 0.3, "b": 0.1},
            "damping": {"eta": 0.9},
            "motion": {"record": {"units": "m/s2", "dt": DT}},
        },
        "uncertain": {"block.b": {"uniform": [0.03, 0.12]}},
        "samples": 24,
    }
    (folder / "study.yaml").write_text(yaml.safe_dump(study))
    other = study | {"uncertain": {"block.b": {"uniform": [0.03, 0.13]}}}
    (folder / "other.yaml").write_text(yaml.safe_dump(other))
    return folder


def test_calibrate_on_some_runs_and_predict_others(rock, experiments, monkeypatch, capsys):
    monkeypatch.chdir(experiments)
    assert rock("calibrate", experiments / "study.yaml", experiments / "a.csv", "--out", "a.json", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    before, after = (found["posterior"]["block.b"][key] for key in ("prior", "posterior"))
    assert before["mean"] == pytest.approx(0.075, abs=0.002)
    assert after["p2_5"] <= TRUE <= after["p97_5"]
    assert after["sd"] < 0.95 * before["sd"]  # a wider body and a stronger model are almost the same
    assert found["capacity_factor"]["p2_5"] <= 1.0 <= found["capacity_factor"]["p97_5"]
    first = Path("a.json").read_bytes()
    assert rock("calibrate", experiments / "study.yaml", experiments / "a.csv", "--out", "a.json") == 0
    told = capsys.readouterr().out
    assert "capacity, body over model" in told
    assert told.rstrip().endswith("were equally likely")
    assert Path("a.json").read_bytes() == first

    paths = experiments / "study.yaml", experiments / "b.csv"
    assert rock("score", *paths, "--calibration", "a.json", "--json", "--no-baselines") == 0
    (scores,) = json.loads(capsys.readouterr().out)["specimens"]
    assert any("this is a fit" in note for note in scores["notes"])  # the groups are in both tables
    assert rock("score", *paths, "--calibration", "a.json", "--folds", "group", "--json", "--no-baselines") == 0
    (scores,) = json.loads(capsys.readouterr().out)["specimens"]
    assert scores["notes"] == []
    assert scores["predictions"]["unknown-width"]["accuracy"] >= 0.8
    assert all(0.0 <= row["low"] <= row["p"] <= row["high"] <= 1.0 for row in scores["probabilities"])
    assert rock("score", *paths, "--json", "--no-baselines") == 0
    (unfitted,) = json.loads(capsys.readouterr().out)["specimens"]
    brier = [each["predictions"]["unknown-width"]["brier"] for each in (scores, unfitted)]
    assert brier[0] < brier[1]


def test_a_mean_that_rounding_keeps_from_zero_is_zero():
    told = {"mean": -4.2e-17, "sd": 1.0, "p2_5": -1.0, "p50": -1.0, "p97_5": 1.0}
    assert _cells(told) == ["0", "1", "-1", "-1", "1"]
    small = {"mean": 3e-9, "sd": 1e-9, "p2_5": 1e-9, "p50": 3e-9, "p97_5": 5e-9}
    assert _cells(small) == ["3e-09", "1e-09", "1e-09", "3e-09", "5e-09"]


def test_runs_of_a_session_are_predicted_by_its_error(rock, experiments, capsys):
    """Sessions are kept in the calibration, and wanted of the runs that it predicts."""
    lines = (experiments / "a.csv").read_text().split()
    dated = [f"{line},{'2021-06-01' if i < 8 else '2021-08-01'}" for i, line in enumerate(lines[1:])]
    Path("dated.csv").write_text("\n".join([f"{lines[0]},session", *dated]) + "\n")
    study = experiments / "study.yaml"
    for name in {line.split(",")[0] for line in lines[1:]}:
        Path(name).write_bytes((experiments / name).read_bytes())
    assert rock("calibrate", study, "dated.csv", "--out", "dated.json", "--json") == 0
    assert 0.05 <= json.loads(capsys.readouterr().out)["session_walk"] <= 0.4
    assert json.loads(Path("dated.json").read_text())["session"][-1] == "2021-08-01"
    assert rock("calibrate", study, "dated.csv", "--out", "dated.json") == 0
    walk = json.loads(Path("dated.json").read_text())["session_walk"]
    assert capsys.readouterr().out.endswith(f"\n  ln(capacity) changes by {walk:.2g} from a session to the next\n")
    said = "--calibration", "dated.json", "--folds", "group", "--no-baselines", "--json"
    assert rock("score", study, "dated.csv", *said) == 0
    capsys.readouterr()
    assert rock("score", study, experiments / "a.csv", *said) == 2
    assert "has no column `session`" in capsys.readouterr().err


@pytest.mark.parametrize("groups", [1, 2])
def test_a_fold_that_leaves_no_runs_to_calibrate_on_is_told(groups):
    labels = tuple(f"g{i % groups}" for i in range(16))
    known = calibration(np.arange(16) % 3 == 0, np.ones((16, 1)), labels)
    found, notes = predicted(known, known.simulated, labels, Options(count=0, repeats=1), leave_out=True)
    assert bool(notes) == (groups == 1)
    if notes:
        assert notes[0].startswith("nothing is fitted")
        np.testing.assert_allclose(found.p, 0.5, atol=1e-12)  # of capacity 1, as much above as below


def test_groups_of_another_column_are_not_left_out_and_this_is_said(rock, experiments, capsys):
    """Each run has the same group under another name in a column `event`, which the calibration does not know."""
    head, *lines = (experiments / "a.csv").read_text().split()
    for name in {line.split(",")[0] for line in lines}:
        Path(name).write_bytes((experiments / name).read_bytes())
    Path("events.csv").write_text("\n".join([f"{head},event", *(f"{line},of {line[-2:]}" for line in lines)]) + "\n")
    study = experiments / "study.yaml"
    assert rock("calibrate", study, "events.csv", "--out", "a.json") == 0
    said = "--no-baselines", "--json"
    assert rock("score", study, "events.csv", "--calibration", "a.json", "--folds", "event", *said) == 2
    assert "a.json: groups its runs by `group` and not by `event`" in capsys.readouterr().err
    assert rock("calibrate", study, "events.csv", "--out", "b.json", "--folds", "event") == 0
    capsys.readouterr()
    briers = []
    for file, folds in (("a.json", "group"), ("b.json", "event")):
        assert rock("score", study, "events.csv", "--calibration", file, "--folds", folds, *said) == 0
        (scores,) = json.loads(capsys.readouterr().out)["specimens"]
        briers.append(scores["predictions"]["unknown-width"]["brier"])
    assert briers[0] == briers[1]
    assert rock("score", study, "events.csv", "--calibration", "b.json", *said) == 0
    (scores,) = json.loads(capsys.readouterr().out)["specimens"]
    assert any(note.startswith("b.json groups its runs by `event` and not by `group`") for note in scores["notes"])


def test_what_is_no_calibration_of_these_bodies_is_refused(rock, experiments, capsys):
    study, table = experiments / "study.yaml", experiments / "a.csv"
    assert rock("calibrate", study, table, "--out", "a.json") == 0
    Path("few.csv").write_text("\n".join(table.read_text().split("\n")[:10]) + "\n")
    head, *lines = table.read_text().split()
    both = [f"{head},specimen", *(f"{line},{'left' if i % 2 else 'right'}" for i, line in enumerate(lines))]
    Path("both.csv").write_text("\n".join(both) + "\n")
    Path("none.json").write_text("{}")
    Path("cut.json").write_text(Path("a.json").read_text()[:500])
    Path("odd.json").write_text(Path("a.json").read_text().replace('"bodies": 24', '"bodies": 23'))
    capsys.readouterr()
    for arguments, words in (
        (("calibrate", study, "few.csv", "--out", "b.json"), "at least 10"),
        (("calibrate", study, "both.csv", "--out", "b.json"), "2 specimens (left, right): choose one with --specimen"),
        (("calibrate", study, table, "--out", "b.txt"), "expected .json"),
        (("score", study, table, "--calibration", "lost.json"), "no such file"),
        (("score", study, table, "--calibration", "none.json"), "no calibration"),
        (("score", study, table, "--calibration", "cut.json"), "is no JSON"),
        (("score", study, table, "--calibration", "odd.json"), "damaged calibration"),
        (("score", experiments / "other.yaml", table, "--calibration", "a.json"), "other bodies"),
        (("score", table, "--calibration", "a.json"), "STUDY.yaml"),
    ):
        assert rock(*arguments) == 2
        said = capsys.readouterr()
        assert words in said.err
        assert said.out == ""
    assert not Path("b.json").exists()


@pytest.mark.parametrize("n", [30, 100, 400])
def test_beta_is_that_of_a_far_finer_grid(n):
    """Of 400 runs nine beta, each a third larger than the one before, left 95 % between .169 and .225."""
    rng = np.random.default_rng(n)
    log_capacity = rng.uniform(-0.6, 0.6, n)
    outcome = log_capacity < 0.1 + 0.19 * rng.standard_normal(n)
    _, beta = errors(log_capacity, outcome, np.zeros(n, dtype=int), 1).summaries()
    mu, fine = np.linspace(-1.0, 1.0, 161)[:, None], np.geomspace(0.04, 0.4, 241)
    log_weight = -0.5 * (mu / SPREAD) ** 2
    for each, fell in zip(log_capacity, outcome, strict=True):
        p = LAPSE + (1.0 - 2.0 * LAPSE) * norm.cdf((mu - each) / fine)
        log_weight = log_weight + np.log(p if fell else 1.0 - p)
    weight = np.exp(log_weight - log_weight.max()).sum(axis=0)
    mass = np.cumsum(weight / weight.sum())
    ends = np.interp([0.025, 0.5, 0.975], mass, fine)
    assert beta.mean == pytest.approx(fine @ weight / weight.sum(), rel=0.025)
    assert [beta.p2_5, beta.p50, beta.p97_5] == pytest.approx(ends, rel=0.035)
