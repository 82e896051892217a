"""Pulses and records of a study: amplitude, frequency, scaling, where records are sought."""

import hashlib
import math
import os
from pathlib import Path

import numpy as np
import pytest

from rockcli.errors import RecordError, StudyError
from rockcli.study.building.records import MissingRecordError
from rockcli.study.open import open_study

BLOCK = {"R": 5.0, "tan_alpha": 0.2}
DT = 0.01


def batches_of(motion, vary=None, file=None, **case):
    study = {"name": "a", "case": {"block": BLOCK, "motion": motion, **case}, "vary": vary or {}}
    if file is not None:
        import yaml

        file.write_text(yaml.safe_dump(study, sort_keys=False))
        return open_study(file)
    return open_study(study)


def batch_of(motion, **more):
    ((_, batch),) = batches_of(motion, **more).batches()
    return batch


@pytest.fixture
def folder(tmp_path):
    """A folder with a study's place and one two-peaked record in g."""
    (tmp_path / "records").mkdir()
    t = np.arange(400) * DT
    write(tmp_path / "records" / "quake.txt", 0.3 * np.sin(2 * np.pi * t) * np.exp(-t))
    return tmp_path


def write(path: Path, values):
    path.write_text("".join(f"{i * DT:.2f} {a:.10e}\n" for i, a in enumerate(values)))


RECORD = {"file": "quake.txt", "units": "g"}


class TestPulses:
    @pytest.mark.parametrize(
        ("keys", "omega_p"),
        [
            ({"omega_p": "2*pi"}, 2 * math.pi),
            ({"T_p": 0.5}, 4 * math.pi),
            ({"f_p": "3*Hz"}, 6 * math.pi),
            ({"omega_p_over_p": 4}, 4 * math.sqrt(3 * 9.81 / 20)),
        ],
    )
    def test_frequency(self, keys, omega_p):
        pulse = batch_of({"pulse": {"shape": "sine", "a_p": 1, **keys}}).excitation.horizontal
        assert pulse.omega_p[0] == pytest.approx(omega_p, rel=1e-15)

    def test_options_reach_the_pulse(self):
        pulse = batch_of({"pulse": {"shape": "sine", "a_p": 2, "T_p": 1, "cycles": 3, "t0": 0.5}}).excitation.horizontal
        assert pulse.end[0] == pytest.approx(3.5)
        assert pulse.a_p[0] == 2.0

    def test_the_wavelet_takes_a_velocity_or_an_acceleration(self):
        shape = {"shape": "mavroeidis_papageorgiou", "T_p": 1.3, "gamma": 1.8, "nu": 0.7}
        by_A = batch_of({"pulse": {**shape, "A": 0.6}}).excitation.horizontal
        by_a = batch_of({"pulse": {**shape, "a_p": float(by_A.a_p[0])}}).excitation.horizontal
        np.testing.assert_allclose(by_a.table, by_A.table, rtol=1e-12)
        t = np.linspace(0, float(by_A.end[0]), 20001)
        from rockcli.scene.ground.excitation import acceleration

        assert np.abs(acceleration(by_A, t)).max() == pytest.approx(by_A.a_p[0], rel=1e-6)

    def test_a_cut_ricker_is_warned_of(self):
        ricker = {"shape": "ricker", "a_p": 1, "T_p": 1}
        assert batch_of({"pulse": ricker}).warnings == ()
        assert batch_of({"pulse": {**ricker, "t0": 2.0}}).warnings == ()
        assert "t0 < 2 T_p" in batch_of({"pulse": {**ricker, "t0": 1.9}}).warnings[0]
        sine = {"shape": "sine", "a_p": 1, "T_p": 1, "t0": -0.5}
        assert batch_of({"pulse": sine}).warnings[0].startswith("sine pulses with t0 < 0 are zero for t < 0")

    @pytest.mark.parametrize(
        ("key", "value"),
        [
            ("omega_p", 1e300),
            ("omega_p", 1e-300),
            ("T_p", 1e200),
            ("a_p", -1e300),
            ("t0", 1e300),
            ("cycles", 1e300),
        ],
    )
    def test_what_would_overflow_is_out_of_range(self, key, value):
        pulse = {"shape": "sine", "a_p": 1, "T_p": 1, key: value}
        if key == "omega_p":
            del pulse["T_p"]
        with pytest.raises(StudyError, match=rf"case\.motion\.pulse\.{key} = .*: is out of range"):
            batch_of({"pulse": pulse})

    def test_a_wavelet_of_too_many_half_cycles(self):
        wavelet = {"shape": "mavroeidis_papageorgiou", "T_p": 1, "A": 1, "gamma": 1e10}
        with pytest.raises(StudyError, match=r"pulse\.gamma = 1e\+10: must be greater than 1 and at most 1000"):
            batch_of({"pulse": wavelet})

    def test_the_slenderest_bodies_raise_no_warning(self):
        ((_, batch),) = open_study({"name": "a", "case": {"block": {"R": 2, "alpha": 1e-100}}}).batches()
        assert batch.block.alpha[0, 0] == 1e-100

    @pytest.mark.parametrize("alpha", [1e-101, 1e-300, 1e-320])
    def test_bodies_whose_energies_are_no_numbers_are_refused(self, alpha):
        with pytest.raises(StudyError, match=r"case\.block\.alpha = .*: alpha must be at least 1e-100"):
            open_study({"name": "a", "case": {"block": {"R": 2, "alpha": alpha}}}).batches()

    def test_no_motion_is_free_rocking(self):
        for motion in ({}, "none", None):
            batch = batch_of(motion, initial={"theta": "0.5*alpha", "theta_dot": "0.1*p"})
            assert batch.excitation.horizontal is None
            assert batch.theta_0[0] == 0.5 * batch.block.alpha[0, 0]
            assert batch.theta_dot_0[0] == 0.1 * batch.p[0, 0]

    def test_duration(self):
        pulse = {"shape": "sine", "a_p": 1, "T_p": 1}
        assert math.isnan(batch_of({"pulse": pulse}).excitation.duration[0])
        batch = batch_of({"pulse": pulse, "duration": 0.5})
        assert batch.excitation.duration[0] == 0.5
        assert "cut off" in batch.warnings[0]
        assert batch_of({"pulse": pulse, "duration": 1.0}).warnings == ()


class TestRecords:
    def test_values_in_g_take_the_g_of_the_case(self, folder):
        study = batches_of({"record": RECORD}, file=folder / "s.yaml", g=9.5)
        ((_, batch),) = study.batches()
        samples = batch.excitation.horizontal
        assert samples.name == "quake.txt"
        assert samples.factor.tolist() == [1.0]
        assert samples.measures["pga"] == np.abs(samples.values).max() == samples.measures["pga_raw"]
        assert study.inputs == {
            "quake.txt": hashlib.sha256((folder / "records" / "quake.txt").read_bytes()).hexdigest()
        }
        assert study.dt_out == 0.005

    def test_g_may_be_an_axis(self, folder):
        study = batches_of({"record": {**RECORD, "pga": 3}}, {"g": [1.62, 9.81]}, file=folder / "s.yaml")
        ((_, batch),) = study.batches()
        samples = batch.excitation.horizontal
        np.testing.assert_allclose(samples.factor * samples.measures["pga"], 3.0, rtol=1e-14)
        plain = batches_of({"record": RECORD}, {"g": [1.62, 9.81]}, file=folder / "s.yaml")
        ((_, batch),) = plain.batches()
        samples = batch.excitation.horizontal
        g_values = samples.values[37] * samples.factor / np.array([1.62, 9.81])
        assert g_values[0] == pytest.approx(g_values[1], rel=1e-14)

    @pytest.mark.parametrize("key", ["scale", "pga", "pgv", "pga_over_g_tan_alpha"])
    def test_scaling(self, folder, key):
        samples = batch_of({"record": {**RECORD, key: 2, "polarity": -1}}, file=folder / "s.yaml").excitation.horizontal
        got = {
            "scale": 1.0,
            "pga": samples.measures["pga"],
            "pgv": samples.measures["pgv"],
            "pga_over_g_tan_alpha": samples.measures["pga"] / (9.81 * 0.2),
        }[key]
        assert samples.factor[0] * got == pytest.approx(-2.0, rel=1e-14)

    def test_vertical_takes_the_horizontal_factor_without_its_sign(self, folder):
        horizontal = {**RECORD, "pga": 3, "polarity": -1}
        for vertical in (RECORD, {"record": RECORD}):
            motion = batch_of({"record": horizontal, "vertical": vertical}, file=folder / "s.yaml").excitation
            assert motion.vertical.factor[0] == -motion.horizontal.factor[0] > 0.0
        own = batch_of({"record": horizontal, "vertical": {**RECORD, "scale": 0.5}}, file=folder / "s.yaml").excitation
        assert own.vertical.factor[0] == 0.5
        pulse = {"pulse": {"shape": "sine", "a_p": 1, "T_p": 1}}
        assert batch_of({**pulse, "vertical": RECORD}, file=folder / "s.yaml").excitation.vertical.factor[0] == 1.0

    def test_processing_is_done_once_and_told(self, folder, monkeypatch):
        import rockcli.motion.reading as reading

        calls, read = [], reading.read_record
        monkeypatch.setattr(reading, "read_record", lambda *a, **k: calls.append(a) or read(*a, **k))
        record = {**RECORD, "window": [0, "1*s"], "lowpass": "10*Hz", "detrend": "constant"}
        study = batches_of({"record": record}, {"motion.record.pga": [1, 2], "model": ["rigid", "linearized"]},
                           file=folder / "s.yaml")  # fmt: skip
        list(study.batches())
        assert len(calls) == 1
        (sentences,) = study.processing.values()
        assert [s.split()[0] for s in sentences] == ["window", "detrend", "lowpass", "scaled"]
        assert "PGA" in sentences[-1]

    def test_processing_may_be_an_axis(self, folder):
        study = batches_of({"record": RECORD}, {"motion.record.lowpass": [5, 10]}, file=folder / "s.yaml")
        assert study.axes[0].numeric
        assert study.axes[0].unit == "s-1"
        assert len(list(study.batches())) == 2
        assert len(study.processing) == 2

    def test_places_where_records_are_sought(self, folder, monkeypatch, tmp_path_factory):
        inner = folder / "studies" / "deep"
        inner.mkdir(parents=True)
        batch_of({"record": RECORD}, file=inner / "s.yaml")  # records/ of a parent
        other = tmp_path_factory.mktemp("other")
        write(other / "far.txt", [0.0, 0.1, 0.0])
        far = {"record": {"file": "far.txt", "units": "g"}}
        with pytest.raises(MissingRecordError):
            batch_of(far, file=inner / "s.yaml")
        monkeypatch.setenv("ROCK_RECORDS", os.pathsep.join([str(folder / "none"), str(other)]))
        batch_of(far, file=inner / "s.yaml")
        monkeypatch.delenv("ROCK_RECORDS")
        (other / "records").mkdir()
        (other / "far.txt").rename(other / "records" / "far.txt")
        monkeypatch.chdir(other)
        batch_of(far, file=inner / "s.yaml")
        batch_of({"record": {"file": str(other / "records" / "far.txt"), "units": "g"}}, file=inner / "s.yaml")

    def test_a_missing_record_says_where_it_was_sought(self, folder):
        with pytest.raises(MissingRecordError) as caught:
            batch_of({"record": {"file": "quak.txt"}}, file=folder / "s.yaml")
        message = str(caught.value)
        assert str(folder / "records") in message
        assert "Close names: quake.txt" in message
        assert caught.value.file == str(folder / "s.yaml")
        assert caught.value.line is not None

    @pytest.mark.parametrize("name", ["synthetic_rock_m6.AT2", "synthetic_rock_m65", "syntetic_rock_m65.AT2"])
    def test_a_record_of_the_program_is_among_the_close_names(self, tmp_path, name):
        with pytest.raises(MissingRecordError, match=r"Close names: synthetic_rock_m65\.AT2"):
            batch_of({"record": name}, file=tmp_path / "s.yaml")

    def test_a_record_of_the_catalogue_says_how_to_get_it(self, folder):
        with pytest.raises(MissingRecordError, match=r"(?s)It is Loma Prieta, WAHO.*\n  How to get it: PEER"):
            batch_of({"record": "RSN811_LOMAP_WAH090.AT2"}, file=folder / "s.yaml")

    def test_a_pattern_is_not_taken_for_one_record_of_the_catalogue(self, folder):
        with pytest.raises(MissingRecordError) as caught:
            batch_of({"record": "none/*.AT2"}, file=folder / "s.yaml")
        assert "It is" not in str(caught.value)

    @pytest.mark.parametrize(
        ("record", "words"),
        [
            ({"pga": 1, "scale": 2}, "say the same thing"),
            ({"pga": -1}, "polarity"),
            ({"polarity": 0.5}, "1 or -1"),
            ({"file": "a", "angle": 0.3}, r"record\.angle: needs two horizontal components: file: \[H1, H2\]"),
            ({"file": ["a", "b"]}, "two horizontal components need an angle"),
            ({"file": ["a", "b", "c"], "angle": 0.3}, "has 3 names; two horizontal components"),
            ({"window": [1]}, r"two numbers, \[from, to\], are expected, not \[1\]"),
            ({"detrend": "cubic"}, "constant, demean"),
            ({"resample": 0.01}, "must be a mapping"),
            ({"unit": "g"}, "did you mean 'units'"),
            ({"file": None}, r"record\.file: a file name is expected, not nothing"),
            ({"file": 3}, r"record\.file: a file name is expected, not 3"),
            ({"lowpass": {"freq": 5, "corners": 11}}, "corners is 11; expected at most 10"),
            ({"lowpass": {"freq": 5, "corners": 2.5}}, "corners is 2.5; expected a whole number"),
            ({"scale": 1e308}, r"case\.motion\.record\.scale = 1e\+308: is out of range"),
            ({"pgv": 1e300}, r"case\.motion\.record\.pgv = 1e\+300: is out of range"),
        ],
    )
    def test_wrong_settings(self, folder, record, words):
        with pytest.raises(StudyError, match=words):
            batch_of({"record": {**RECORD, **record}}, file=folder / "s.yaml")

    def test_a_pulse_and_a_record_are_too_much(self, folder):
        with pytest.raises(StudyError, match="not both"):
            batch_of({"record": RECORD, "pulse": {"shape": "sine", "a_p": 1, "T_p": 1}}, file=folder / "s.yaml")

    def test_a_scaling_beside_the_vertical_record_is_misplaced(self, folder):
        with pytest.raises(StudyError, match=r"case\.motion\.vertical\.scale: unknown key"):
            batch_of({"record": RECORD, "vertical": {"record": RECORD, "scale": 2}}, file=folder / "s.yaml")

    def test_the_vertical_scaling_may_be_an_axis(self, folder):
        motion = {"record": RECORD, "vertical": RECORD}
        for path in ("motion.vertical.scale", "motion.vertical.record.scale"):
            batch = batch_of(motion, vary={path: [0.5, 1.5]}, file=folder / "s.yaml")
            assert batch.excitation.vertical.factor.tolist() == [0.5, 1.5]
            assert batch.excitation.horizontal.factor.tolist() == [1.0, 1.0]

    def test_a_silent_record_cannot_be_scaled(self, folder):
        write(folder / "records" / "silent.txt", [0.0, 0.0, 0.0])
        with pytest.raises(StudyError, match="zero throughout"):
            batch_of({"record": {"file": "silent.txt", "units": "g", "pga": 1}}, file=folder / "s.yaml")

    @pytest.mark.parametrize(
        ("record", "key", "words"),
        [
            ({"window": [10, 5]}, "window", ["quake.txt", "`window` is [10, 5]"]),
            ({"resample": {"dt": 1e-9, "method": "linear"}}, "resample.dt", ["quake.txt", "3.99e+09 samples"]),
            ({"lowpass": 500}, "lowpass", ["quake.txt", "Nyquist"]),
            ({"taper": {"fraction": 0.1, "type": "x"}}, "taper.type", ["quake.txt", "cosine, hann"]),
            ({"units": "inch"}, "units", ["quake.txt", "g, m/s2"]),
            ({"component": 3}, "component", ["quake.txt", "leave `component` out"]),
            ({"dt": 1}, "dt", ["quake.txt", "time column"]),
            ({"file": "bad.AT2"}, "file", ["bad.AT2", "not known"]),
        ],
    )
    def test_a_record_that_cannot_be_used_is_an_error_at_its_key(self, folder, record, key, words):
        (folder / "records" / "bad.AT2").write_text("nonsense\n")
        file = folder / "s.yaml"
        with pytest.raises(RecordError) as caught:
            batch_of({"record": {**RECORD, **record}}, file=file)
        error = caught.value
        assert error.file == str(file)
        assert key.split(".")[-1] in file.read_text().splitlines()[error.line - 1]
        assert error.message.startswith(f"case.motion.record.{key}: ")
        for word in words:
            assert word in error.message

    def test_the_window_of_an_axis_is_named_at_its_line(self, folder):
        file = folder / "s.yaml"
        with pytest.raises(RecordError, match=r"case\.motion\.record\.window: quake\.txt") as caught:
            batches_of({"record": RECORD}, {"motion.record.window": [[0, 1], [2, 1]]}, file=file)
        assert caught.value.line > file.read_text().splitlines().index("vary:")
