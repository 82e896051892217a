"""Records scaled to one Sa(T): the factor, the intensity of the suite, and what does not go together."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lsim

import rockcli
from rockcli.errors import StudyError
from rockcli.motion.reading import read_record

G = 9.81
SHIPPED = Path(__file__).resolve().parents[2] / "records"
RECORDS = ["synthetic_rock_m65.AT2", "synthetic_soil_m70.AT2", "synthetic_pulse_m70.AT2"]
T = 0.7
LEVELS = [0.15, 0.25, 0.35, 0.45, 0.6, 0.8]
"""Sa(T) over g."""


def sa_of(name):
    """Sa(T) [m/s²] of a record, linear between its samples, by scipy on a grid sixteen times as fine."""
    motion = read_record(SHIPPED / name)
    a = motion.acceleration(G)
    t = np.arange(len(a)) * motion.dt
    fine = np.arange(16 * len(a) + int(32.0 * T / motion.dt)) * motion.dt / 16.0
    omega = 2.0 * np.pi / T
    _, x, _ = lsim(([-1.0], [1.0, 0.1 * omega, omega**2]), np.interp(fine, t, a, right=0.0), fine)
    return float(np.abs(x).max() * omega**2)


def study(record=None, vary=None, motion=None, **more):
    of_record = {"file": RECORDS[0], **({"sa": 0.3 * G, "sa_period": T} if record is None else record)}
    case = {"block": {"height": 2.0, "width": 0.4}, "motion": {"record": of_record, **(motion or {})}}
    return {"name": "scaled", "case": case, "vary": vary or {}, "save": {"histories": False}, **more}


def suite(by, **more):
    """Stripes of all records at LEVELS: by `sa`, or by a table of factors."""
    if by == "sa":
        vary = {"motion.record.file": RECORDS, "motion.record.sa": [level * G for level in LEVELS]}
        return study(vary=vary, over={"axis": "record", **more.pop("over", {})}, **more)
    factors = {name: {"motion.record": {"file": name, "scale": f"target*{G / sa_of(name)!r}"}} for name in RECORDS}
    over = {"axis": "case", "along": "target", "intensity": f"sa({T})", **more.pop("over", {})}
    vary = {"case": factors, "let.target": LEVELS}
    return study({"scale": 1.0}, vary, over=over, let={"target": 1.0}, **more)


@pytest.mark.parametrize("name", RECORDS)
def test_the_record_has_the_sa_that_is_wanted(name):
    dataset = rockcli.run(study({"file": name, "sa": "0.3*g", "sa_period": T}))
    as_filed = rockcli.run(study({"file": name}))
    assert float(dataset.pga / as_filed.pga) == pytest.approx(0.3 * G / sa_of(name), rel=2e-4)
    ((*_, said),) = json.loads(dataset.attrs["processing"]).values()
    assert f"to sa({T}) 0.3 g" in said


def test_a_suite_is_that_of_a_table_of_factors():
    hazard = {"intensity": [0.1 * G, 0.5 * G, 2.0 * G], "rate": [1e-2, 1e-3, 1e-4]}
    by_sa, by_table = (rockcli.run(suite(by, hazard=hazard)) for by in ("sa", "table"))
    assert by_sa["pga"].values == pytest.approx(by_table["pga"].values, rel=2e-4)
    assert (by_sa["outcome"].values == by_table["outcome"].values).all()
    assert {*by_sa["fragility_status"].values.ravel()} == {0}  # fitted
    assert by_sa["fragility_intensity"].values == pytest.approx(np.tile(np.array(LEVELS) * G, (3, 1)), rel=1e-12)
    for name in ("fragility_median", "fragility_beta", "fragility_begins_at", "annual_rate"):
        assert by_sa[name].values.ravel() == pytest.approx(by_table[name].values.ravel(), rel=1e-3)


def test_a_threshold_is_the_factor_times_the_sa_of_the_record():
    by_sa = rockcli.run(
        study(vary={"motion.record.sa": {"from": 0.1 * G, "to": 3 * G, "n": 60, "find": "overturning"}})
    )
    top = 3.0 * G / sa_of(RECORDS[0])
    scale = {"from": top / 30.0, "to": top, "n": 60, "find": "overturning"}
    by_scale = rockcli.run(study({"scale": 1.0}, {"motion.record.scale": scale}))
    ours = float(by_sa["sa_overturning"])
    assert np.isfinite(ours)
    assert ours == pytest.approx(float(by_scale["scale_overturning"]) * sa_of(RECORDS[0]), rel=1e-3)


def test_below_floors_it_is_that_of_the_ground():
    floors = {"through": [{"f": 2.0, "zeta": 0.05}]}
    vary = {"motion.record.file": RECORDS, "motion.record.sa": [level * G for level in LEVELS]}
    dataset = rockcli.run(study(vary=vary, motion=floors, over="record"))
    assert dataset["fragility_intensity"].values == pytest.approx(np.tile(np.array(LEVELS) * G, (3, 1)), rel=1e-12)
    assert dataset["fragility_intensity"].attrs["long_name"] == f"ground_sa({T})"


def test_another_way_to_say_it_takes_its_place():
    settings = {"sa": {"polarity": 1}, "pga": {"pga": 0.25 * G}}
    dataset = rockcli.run(study(vary={"motion.record": settings}))
    assert float(dataset.pga.sel(record="pga")) == pytest.approx(0.25 * G)
    assert float(dataset.pga.sel(record="sa")) == pytest.approx(
        float(rockcli.run(study({})).pga) * 0.3 * G / sa_of(RECORDS[0]), rel=2e-4
    )


@pytest.mark.parametrize(
    ("record", "words"),
    [
        ({"sa": 1.0}, "needs `sa_period`"),
        ({"sa_period": 0.5}, "which the record does not give"),
        ({"sa": 1.0, "sa_period": 0.0}, "greater than 0"),
        ({"sa": 1.0, "sa_period": 0.5, "pga": 1.0}, "say the same thing"),
        ({"sa": -1.0, "sa_period": 0.5}, "must not be negative"),
    ],
)
def test_what_does_not_go_together_is_refused(record, words):
    with pytest.raises(StudyError, match=words):
        rockcli.run(study(record))
