"""`ground_motion` says which cases share a motion: held against the accelerations themselves."""

import numpy as np
import pytest

import rockcli
from rockcli.plotting.common.ground import motions

BLOCK = {"R": 2.0, "tan_alpha": 0.2}
PULSE = {"shape": "sine", "a_p_over_g_tan_alpha": 1.5, "omega_p": 8}
RECORD = {"file": "synthetic_pulse_m70.AT2", "pga_over_g_tan_alpha": 1.5}
FILES = ["synthetic_pulse_m70.AT2", "synthetic_rock_m65.AT2"]


def run(monkeypatch, motion, vary):
    monkeypatch.setenv("ROCK_RECORDS", "records")
    case = {"block": BLOCK, "motion": {**motion, "duration": 6}}
    return rockcli.run({"name": "x", "case": case, "vary": vary, "save": {"histories": True, "dt_out": 0.01}})


def same_up_to_scale(a, b):
    """Whether b is a multiple of a, as far as both last, by least squares over all times."""
    known = np.isfinite(a).all(axis=0) & np.isfinite(b).all(axis=0)
    a, b = a[:, known].ravel(), b[:, known].ravel()
    return np.abs(b - (a @ b) / (a @ a) * a).max() < 1e-6 * np.abs(b).max()


@pytest.mark.parametrize(
    ("motion", "vary", "dims", "different"),
    [
        ({"pulse": PULSE}, {"motion.pulse.a_p_over_g_tan_alpha": [1.2, 2, 3], "block.R": [1, 2]}, (), 1),
        ({"pulse": PULSE}, {"motion.pulse.omega_p": [6, 8], "block.R": [1, 2]}, ("motion_pulse_omega_p",), 2),
        ({"pulse": PULSE}, {"motion.pulse.shape": ["sine", "ricker"], "g": [9.81, 3.7]}, ("shape",), 2),
        (
            {"record": RECORD},
            {"motion.record.file": FILES, "motion.record.pga_over_g_tan_alpha": [1.2, 2]},
            ("record",),
            2,
        ),
        ({"record": RECORD}, {"motion.record.polarity": [1, -1], "block.R": [1, 2]}, (), 1),
        (
            {"record": RECORD},
            {"motion.record.highpass": {"none": None, "some": 0.5}, "block.R": [1, 2]},
            ("highpass",),
            2,
        ),
        ({"record": RECORD, "vertical": FILES[1]}, {"motion.record.pga_over_g_tan_alpha": [1.2, 2]}, (), 1),
        (
            {"record": RECORD, "vertical": {"record": {"file": FILES[1], "scale": 1}}},
            {"motion.vertical.record.scale": [0.5, 1]},
            ("scale",),
            2,
        ),
    ],
)
def test_cases_share_a_number_where_they_share_a_motion(monkeypatch, motion, vary, dims, different):
    dataset = run(monkeypatch, motion, vary)
    number = dataset["ground_motion"]
    assert number.dims == dims
    assert np.unique(number).tolist() == list(range(different))
    shape = tuple(dataset.sizes[axis] for axis in dataset.attrs["axes"].split())
    where = list(np.ndindex(shape))
    a_g = dataset["a_g"]
    every = number.broadcast_like(a_g.isel(time=0)).transpose(*a_g.dims[:-1]).values
    for i in where:
        for j in where:
            one, other = (np.stack([dataset[name].values[k] for name in ("a_g", "a_v")]) for k in (i, j))
            assert same_up_to_scale(one, other) == (every[i] == every[j]), (i, j)
    found = motions(dataset, where)
    assert sorted(len(motion.cases) for motion in found) == sorted(np.unique(every, return_counts=True)[1].tolist())


def test_a_turned_or_scaled_motion_has_its_scale(monkeypatch):
    dataset = run(monkeypatch, {"record": RECORD}, {"motion.record.scale": [0.5, 1, 2]})
    (one,) = motions(dataset, [(0,), (1,), (2,)])
    assert np.array(one.scales) / one.scales[0] == pytest.approx([1, 2, 4], rel=1e-12)
    turned = run(monkeypatch, {"record": RECORD}, {"motion.record.polarity": [1, -1]})
    (one,) = motions(turned, [(0,), (1,)])
    assert one.scales[1] / one.scales[0] == -1.0


def test_without_histories_there_is_no_motion_to_share(monkeypatch):
    monkeypatch.setenv("ROCK_RECORDS", "records")
    case = {"block": BLOCK, "motion": {"record": RECORD}}
    assert "ground_motion" not in rockcli.run({"name": "x", "case": case, "save": {"histories": False}})


def test_a_dataset_of_an_earlier_build_has_a_motion_a_case(monkeypatch):
    dataset = run(monkeypatch, {"record": RECORD}, {"motion.record.scale": [0.5, 1]}).drop_vars("ground_motion")
    assert [motion.cases for motion in motions(dataset, [(0,), (1,)])] == [[0], [1]]
