"""Processing: what each step does, in which order, what it says, and what it refuses."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rockcli.motion.motion import Motion
from rockcli.motion.options import OptionError
from rockcli.motion.processing import process
from rockcli.motion.reading import read_record

DT = 0.01
T = DT * np.arange(2001)


@pytest.fixture
def sines() -> Motion:
    """0.2 g at 1 Hz and 0.05 g at 30 Hz, under a bell, with an offset of 0.01 g."""
    bell = np.exp(-(((T - 10.0) / 3.0) ** 2))
    values = bell * (0.2 * np.sin(2 * np.pi * T) + 0.05 * np.sin(2 * np.pi * 30 * T)) + 0.01
    return Motion(values=values, dt=DT, in_g=True, name="sines")


def amplitude(motion: Motion, frequency: float) -> float:
    """Fourier amplitude at a frequency."""
    t = motion.dt * np.arange(len(motion.values))
    return float(abs(np.sum(motion.values * np.exp(-2j * np.pi * frequency * t))) * motion.dt)


def test_nothing_is_done_unasked(sines: Motion) -> None:
    assert process(sines) is sines


@pytest.mark.parametrize("dt", [1e-9, 3.3e-8, 1e-6, 0.01, 1 / 3, 1e6])
def test_a_window_keeps_the_samples_nearest_to_its_times_whatever_the_step(sines: Motion, dt: float) -> None:
    counted = dataclasses.replace(sines, values=np.arange(1000.0), dt=dt)
    kept = process(counted, window=[(22 - 0.3) * dt, (541 + 0.4) * dt])
    np.testing.assert_array_equal(kept.values, np.arange(22.0, 542.0))


def test_window(sines: Motion) -> None:
    cut = process(sines, window=[5.0, 12.5])
    assert cut.values.tolist() == sines.values[500:1251].tolist()
    assert "751 samples" in cut.processing[0]
    assert process(sines, window=[0, 20.0]).values.tolist() == sines.values.tolist()


@pytest.mark.parametrize("kind", ["constant", "demean"])
def test_detrend_constant(sines: Motion, kind: str) -> None:
    done = process(sines, detrend=kind)
    np.testing.assert_allclose(done.values, sines.values - sines.values.mean(), atol=1e-15)


def test_detrend_lines(sines: Motion) -> None:
    line = Motion(values=0.3 + 0.1 * T, dt=DT, in_g=False)
    np.testing.assert_allclose(process(line, detrend="linear").values, 0.0, atol=1e-12)
    np.testing.assert_allclose(process(line, detrend="simple").values, 0.0, atol=1e-12)


@pytest.mark.parametrize("taper", [0.1, {"fraction": 0.1}, {"fraction": 0.1, "type": "hann"}])
def test_taper(sines: Motion, taper: Any) -> None:
    done = process(sines, taper=taper)
    assert done.values[0] == done.values[-1] == 0.0
    assert done.values[250:-250].tolist() == sines.values[250:-250].tolist()


def test_a_drift_longer_than_the_period_of_a_highpass_is_left_and_told() -> None:
    t = DT * np.arange(2001)
    drifts = Motion(values=np.sin(np.pi * t / t[-1]), dt=DT, in_g=False)
    for wanted in ({"highpass": 0.02 / t[-1]}, {"bandpass": [0.02 / t[-1], 20]}):
        low = process(drifts, **wanted)
        assert np.abs(low.values).max() > 0.5
        (said,) = low.warnings
        assert f"from {0.02 / t[-1]:g} Hz on, a period of {50 * t[-1]:g} s, of a record of {t[-1]:g} s" in said
    high = process(drifts, highpass=2.0 / t[-1])
    assert np.abs(high.values[200:-200]).max() < 0.05
    assert high.warnings == ()


def test_a_taper_of_less_than_a_sample_is_told_as_nothing_done() -> None:
    short = Motion(values=np.array([1.0, 2.0, -1.5, 0.5, 0.25] * 2 + [1.0]), dt=DT, in_g=False)
    done = process(short, taper=0.05)
    assert done.values.tolist() == short.values.tolist()
    assert (
        "taper 0.05 of the length at each end, cosine (11 samples): not one sample, nothing done:" in done.processing[0]
    )
    assert done.warnings == ("`taper` 0.05 of 11 samples is not one: nothing is tapered",)
    whole = process(short, taper=0.1)
    assert whole.values.tolist() == [0.0, *short.values[1:-1], 0.0]
    assert "nothing" not in whole.processing[0]
    assert whole.warnings == ()


def test_filters(sines: Motion) -> None:
    low, high = amplitude(sines, 1.0), amplitude(sines, 30.0)
    lowpassed, highpassed = process(sines, lowpass=10.0), process(sines, highpass=10.0)
    assert amplitude(lowpassed, 1.0) == pytest.approx(low, rel=1e-3)
    assert amplitude(lowpassed, 30.0) < 1e-3 * high
    assert amplitude(highpassed, 1.0) < 1e-3 * low
    assert amplitude(highpassed, 30.0) == pytest.approx(high, rel=1e-2)
    band = process(sines, bandpass=[20, 40])
    assert amplitude(band, 30.0) == pytest.approx(high, rel=3e-2)
    same = process(sines, bandpass={"freqmin": 20.0, "freqmax": 40.0, "corners": 4, "zerophase": True})
    assert same.values.tolist() == band.values.tolist()


def test_filters_have_four_corners_and_zero_phase_unless_said(sines: Motion) -> None:
    default = process(sines, lowpass=10.0)
    said = process(sines, lowpass={"freq": 10.0, "corners": 4, "zerophase": True})
    causal = process(sines, lowpass={"freq": 10.0, "zerophase": False})
    two = process(sines, lowpass={"freq": 10.0, "corners": 2})
    assert default.values.tolist() == said.values.tolist()
    assert default.processing[0].startswith("lowpass 10 Hz, 4 corners, zero phase: PGA ")
    assert causal.processing[0].startswith("lowpass 10 Hz, 4 corners, causal: PGA ")
    assert np.abs(causal.values - default.values).max() > 0.01
    assert np.abs(two.values - default.values).max() > 1e-4
    # the gain at the corner of a zero-phase filter is 1/2
    half = process(sines, lowpass=1.0)
    assert amplitude(half, 1.0) == pytest.approx(0.5 * amplitude(sines, 1.0), rel=0.02)


def test_order_is_the_contract_s_not_the_caller_s(sines: Motion) -> None:
    done = process(
        sines, resample={"dt": 0.02, "method": "lanczos"}, lowpass=20, taper=0.05, detrend="linear", window=[2, 18]
    )
    assert [re.match(r"\w+", sentence)[0] for sentence in done.processing] == [
        "window",
        "detrend",
        "taper",
        "lowpass",
        "resample",
    ]


def test_every_sentence_tells_pga_and_pgv(sines: Motion) -> None:
    done = process(sines, highpass=0.1, lowpass=10.0)
    pattern = r".*: PGA [\d.]+ -> [\d.]+ g, PGV [\d.]+ -> [\d.]+ m/s"
    assert all(re.fullmatch(pattern, sentence) for sentence in done.processing)
    assert "PGA 0.2" in done.processing[0]
    metres = process(Motion(values=sines.values * 9.81, dt=DT, in_g=False), highpass=0.1)
    assert metres.processing[0].split(", PGV")[1] == process(sines, highpass=0.1).processing[0].split(", PGV")[1]
    assert " m/s2, PGV" in metres.processing[0]


def test_the_record_s_own_biography_stays(sines: Motion) -> None:
    before = Motion(
        values=sines.values, dt=DT, in_g=True, processing=("counts made g",), warnings=("odd",), sha256="ab"
    )
    after = process(before, detrend="demean")
    assert after.processing[0] == "counts made g"
    assert (after.warnings, after.sha256) == (("odd",), "ab")
    assert before.processing == ("counts made g",)


@pytest.mark.parametrize("method", ["lanczos", "fourier", "linear", "weighted_average_slopes"])
def test_upsampling_keeps_the_samples(sines: Motion, method: str) -> None:
    calm = process(sines, window=[0.0, 19.99], lowpass=5.0, detrend="demean")
    done = process(calm, resample={"dt": 0.005, "method": method})
    assert done.dt == 0.005
    assert done.warnings == ()
    np.testing.assert_allclose(done.values[: 2 * len(calm.values) : 2], calm.values, atol=2e-5)
    assert f"resample from dt 0.01 to 0.005 s, {method}: PGA" in done.processing[-1]


def test_band_limited_methods_find_the_motion_between_the_samples() -> None:
    def truth(t: np.ndarray) -> np.ndarray:
        return np.exp(-(((t - 10.0) / 2.0) ** 2)) * np.sin(2 * np.pi * 20 * t)

    motion = Motion(values=truth(T[:2000]), dt=DT, in_g=True)
    errors = {}
    for method in ("lanczos", "fourier", "linear"):
        done = process(motion, resample={"dt": 0.004, "method": method})
        errors[method] = np.abs(done.values - truth(0.004 * np.arange(len(done.values)))).max()
    assert errors["fourier"] < 1e-9
    assert errors["lanczos"] < 1e-2
    assert errors["linear"] > 0.1


@pytest.mark.parametrize("every", [2, 3])
def test_fourier_downsampling_keeps_what_is_at_the_new_nyquist_frequency(every: int) -> None:
    """There a motion is its own samples: nothing lies above."""
    motion = Motion(values=np.cos(np.pi / every * np.arange(2100) + 0.4), dt=DT, in_g=True)
    done = process(motion, resample={"dt": every * DT, "method": "fourier"})
    np.testing.assert_allclose(done.values, motion.values[::every], atol=1e-12)


@pytest.mark.parametrize(("old", "new"), [(60, 90), (60, 45), (45, 60), (45, 75), (60, 40), (75, 50), (75, 45)])
def test_fourier_resampling_is_that_of_scipy(old: int, new: int) -> None:
    """Of noise, which has something at every frequency, the highest of the coarser step among them."""
    from scipy.signal import resample

    motion = Motion(values=np.random.default_rng(old).standard_normal(old), dt=DT, in_g=True)
    done = process(motion, resample={"dt": DT * old / new, "method": "fourier"})
    np.testing.assert_allclose(done.values, resample(motion.values, new), atol=1e-12)


@pytest.mark.parametrize("dt", [0.0022, 0.0033, 0.005, 0.0066, 0.0132, 0.0198])
def test_resampling_never_leaves_the_record(dt: float) -> None:
    motion = Motion(values=np.sin(np.arange(2048) * 0.05), dt=0.0066, in_g=True)
    for method in ("lanczos", "linear"):
        done = process(motion, resample={"dt": dt, "method": method})
        assert motion.duration - dt < done.duration <= motion.duration * (1 + 1e-12)
        assert done.dt == dt


def test_downsampling_warns_of_aliasing(sines: Motion) -> None:
    to = {"dt": 0.02, "method": "lanczos"}
    assert "low-pass" in process(sines, resample=to).warnings[0]
    assert "low-pass" in process(sines, resample=to, highpass=0.1, lowpass=30).warnings[0]
    assert process(sines, resample=to, lowpass=20.0).warnings == ()
    assert process(sines, resample=to, bandpass=[0.1, 20.0]).warnings == ()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"window": [5, 5]}, "`window` is [5, 5]"),
        ({"window": [5, 25]}, "t2 <= 20"),
        ({"window": [-1, 5]}, "0 <= t1"),
        ({"window": "all"}, "[t1, t2]"),
        ({"window": [0, "end"]}, "'end'"),
        ({"detrend": "quadratic"}, "constant, demean, linear, simple"),
        ({"taper": 0.6}, "at most 0.5"),
        ({"taper": "hann"}, "'hann'"),
        ({"taper": {"fraction": 0.1, "type": "square"}}, "`taper.type`"),
        ({"taper": {"length": 0.1}}, "does not know 'length'"),
        ({"highpass": 0.0}, "above 0"),
        ({"highpass": 50.0}, "Nyquist frequency, 50"),
        ({"lowpass": float("nan")}, "`lowpass` holds nan"),
        ({"lowpass": "10 Hz"}, "'10 Hz'"),
        ({"lowpass": {"corners": 2}}, "`lowpass` holds None"),
        ({"lowpass": {"freq": 10, "corners": 0}}, "`lowpass.corners`"),
        ({"lowpass": {"freq": 10, "zerophase": "yes"}}, "`lowpass.zerophase`"),
        ({"bandpass": 3.0}, "[freqmin, freqmax]"),
        ({"bandpass": [20, 1]}, "lower frequency first"),
        ({"bandpass": [1, 60]}, "Nyquist"),
        ({"resample": 0.005}, "method: one of fourier, lanczos"),
        ({"resample": {"dt": 0.005}}, "method: one of fourier, lanczos"),
        ({"resample": {"dt": 0.005, "method": "cubic"}}, "'cubic'"),
        ({"resample": {"dt": -1, "method": "linear"}}, "above 0"),
        ({"resample": {"dt": 1e-9, "method": "linear"}}, "`resample.dt` is 1e-09, which would make 2e+10 samples"),
        ({"resample": {"dt": 1e-320, "method": "fourier"}}, "at most 1e+07"),
        ({"resample": {"dt": 0.0066, "method": "fourier"}}, "whole number of new steps"),
    ],
)
def test_refusals_name_the_key(sines: Motion, options: dict[str, Any], words: str) -> None:
    with pytest.raises(OptionError) as caught:
        process(sines, **options)
    assert words in str(caught.value)
    assert caught.value.key.split(".")[0] in options  # by which the line of a study is found


def test_steps_that_leave_no_numbers_are_refused() -> None:
    huge = Motion(values=np.full(50, 1e308), dt=DT, in_g=True)
    with pytest.raises(OptionError, match="not finite") as caught:
        process(huge, detrend="constant")
    assert caught.value.key == "detrend"


def test_el_centro(shared_records: Path) -> None:
    motion = read_record(shared_records / "peer" / "dialects" / "IELC180.AT2")
    done = process(motion, highpass=0.1, lowpass=15)
    first = re.search(r"PGA ([\d.]+) -> ([\d.]+) g", done.processing[0])
    assert first is not None
    assert float(first[1]) == pytest.approx(0.3129)
    assert 0.30 < float(first[2]) < 0.32
