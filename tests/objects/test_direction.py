"""Two horizontal components in one direction: the components themselves at 0 and 90 degrees, the worst angle between."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import obspy
import pytest
from reference import body_of, integrate
from scenes import SHARED
from typer.testing import CliRunner

import rockcli
from rockcli.analysis.direction import with_worst_direction
from rockcli.cli.main import app
from rockcli.errors import RecordError, StudyError
from rockcli.motion.at2 import at2_text
from rockcli.motion.direction import cosine_and_sine, in_direction
from rockcli.motion.motion import Motion
from rockcli.scene.body.block import housner_eta
from rockcli.storage.contents import Contents, axis_field, variable_field
from rockcli.study.open import open_study

BLOCK = {"height": 1.9, "width": 0.5}
STUDIES = Path(__file__).resolve().parents[2] / "studies" / "objects"
DT = 0.01


def column(values):
    return "# units: m/s2\n" + "".join(f"{i * DT:.2f},{v:.17g}\n" for i, v in enumerate(values))


@pytest.fixture
def folder(tmp_path):
    rng = np.random.default_rng(7)
    t = np.arange(400) * DT
    for name in ("h1", "h2"):
        waves = sum(rng.normal() * np.sin(rng.uniform(3, 12) * t + rng.uniform(0, 6)) for _ in range(5))
        (tmp_path / f"{name}.csv").write_text(column(waves))
    (tmp_path / "long.csv").write_text(column(np.sin(np.arange(420) * DT)))
    (tmp_path / "coarse.csv").write_text("# units: m/s2\n" + "".join(f"{i * 0.02:.2f},1\n" for i in range(400)))
    (tmp_path / "in_g.csv").write_text(column(np.sin(t)).replace("m/s2", "g"))
    return tmp_path


def opened(folder, record, **more):
    import yaml

    file = folder / "s.yaml"
    case = {"block": BLOCK, "motion": {"record": record}}
    file.write_text(yaml.safe_dump({"name": "s", "case": case, **more}, sort_keys=False))
    return open_study(file)


def samples(folder, record):
    ((_, batch),) = opened(folder, record).batches()
    return batch.excitation.horizontal


BOTH = ["h1.csv", "h2.csv"]
STEPS = {"window": [0.2, 3.5], "detrend": "linear", "highpass": 0.3}


def trace(name, start):
    header = {"delta": DT, "station": name, "starttime": obspy.UTCDateTime(start)}
    return obspy.Trace(np.random.default_rng(len(name)).normal(size=400), header)


@pytest.mark.parametrize("late", [0.0, 0.004, 2.5])
def test_components_begin_together(late):
    """As far as they say when, and to half a step of time."""
    first, second = trace("A", 1e9), trace("BB", 1e9 + late)
    study = {"case": {"block": BLOCK, "motion": {"record": {"file": [first, second], "units": "m/s2", "angle": 0.5}}}}
    if late < 0.5 * DT:
        pga = np.abs(np.cos(0.5) * first.data + np.sin(0.5) * second.data).max()
        assert float(rockcli.run(study)["pga"]) == pytest.approx(pga, rel=1e-12)
        return
    with pytest.raises(
        RecordError, match=r"\.BB\.\. begins 2.5 s after \.A\.\.: components must begin at the same time"
    ):
        rockcli.run(study)


@pytest.mark.parametrize("steps", [{}, {"window": [0.5, 3.0]}])
def test_columns_of_times_tell_when_components_begin(folder, steps):
    rows = "".join(f"{10.0 + i * DT:.2f},1\n" for i in range(400))
    (folder / "late.csv").write_text("time [s],acceleration [m/s2]\n" + rows)
    with pytest.raises(RecordError, match=r"late.csv begins 10 s after h1.csv"):
        samples(folder, {"file": ["h1.csv", "late.csv"], "angle": 0.5, **steps})


def test_a_vertical_motion_that_begins_at_another_time_is_told():
    early = {"file": trace("A", 1e9), "units": "m/s2"}
    late = {"file": trace("BB", 1e9 - 1.5), "units": "m/s2"}
    for window, said in ((None, ["1.5 s before"]), ([1.5, 3.0], [])):
        motion = {"record": early, "vertical": {"record": late | ({"window": window} if window else {})}}
        told = rockcli.check({"case": {"block": BLOCK, "motion": motion}})["warnings"]
        assert [one for one in told if "begins" in one] == [f".BB.. begins {x} .A.., as the files say; both are taken "
                                                            "from their first samples on" for x in said]  # fmt: skip


def test_components_of_two_stations_are_told(tmp_path):
    for name, station, component in (("a", "Izmit", "090"), ("b", "Duzce", "180"), ("c", "Izmit", "180")):
        titles = ["RECORD", f"Kocaeli, 8/17/1999, {station}, {component}"]
        (tmp_path / f"{name}.AT2").write_text(at2_text(np.ones(9), 0.01, titles, tmp_path))
    for other, said in (("b", True), ("c", False)):
        files = [str(tmp_path / f"{name}.AT2") for name in ("a", other)]
        motion = {"record": {"file": files, "angle": 0.5}}
        told = rockcli.check({"case": {"block": BLOCK, "motion": motion}})["warnings"]
        assert any("a.AT2 is of station Izmit, b.AT2 of Duzce" in one for one in told) is said


def test_what_both_components_state_is_in_the_dataset():
    one, two = (
        Motion(np.ones(9), 0.01, in_g=True, name=name, component=name, header={"magnitude": 6.1, "vs30": vs30})
        for name, vs30 in (("E", 294.0), ("N", 300.0))
    )
    data = rockcli.run({"case": {"block": BLOCK, "motion": {"record": {"file": [one, two], "angle": 0.5}}}})
    assert float(data["magnitude"]) == 6.1
    assert "vs30" not in data.variables


@pytest.mark.parametrize("two", [False, True])
@pytest.mark.parametrize(("event", "station", "said"), [
    ("Kocaeli", "Izmit", None), ("Kocaeli", "Duzce", "station Duzce"), ("Duzce", "Izmit", "event Duzce"),
])  # fmt: skip
def test_a_vertical_motion_of_another_place_is_told(tmp_path, two, event, station, said):
    parts = (("Kocaeli", "Izmit", "090"), ("Kocaeli", "Izmit", "180"), (event, station, "UP"))
    for one, where, component in parts:
        titles = ["RECORD", f"{one}, 8/17/1999, {where}, {component}"]
        (tmp_path / f"{component}.AT2").write_text(at2_text(np.ones(9), 0.01, titles, tmp_path))
    one, other, up = (str(tmp_path / f"{part[2]}.AT2") for part in parts)
    across = {"file": [one, other], "angle": 0.5} if two else one
    told = rockcli.check({"case": {"block": BLOCK, "motion": {"record": across, "vertical": up}}})["warnings"]
    elsewhere = [each for each in told if "two components are of one motion" in each]
    assert [f"the vertical UP.AT2 is of {said}, 090.AT2" in each for each in elsewhere] == [True] * (said is not None)


@pytest.mark.parametrize(
    ("one", "two", "said"),
    [
        ("090", "180", False), ("009", "279", False), ("0", "270", False), ("260", "345", False), ("N", "W", False),
        ("EW", "NS", False), ("12", "13", False),  # numbers of channels
        ("S16W", "S74E", False), ("N05E", "W", False), ("HNE", "HNN", False), ("NS2", "EW2", False), ("L", "T", False),
        ("S16W", "N16E", True), ("N16W", "S74E", True), ("E", "W", True), ("HNE", "HLE", True), ("EW1", "EW2", True),
        ("090", "090", True), ("090", "140", True), ("N", "n", True), ("360", "0", True), ("000", "180", True),
    ],
)  # fmt: skip
def test_components_that_are_not_perpendicular_are_told(tmp_path, one, two, said):
    files = []
    for place, component in enumerate((one, two)):
        files.append(tmp_path / f"{place}.AT2")
        titles = ["RECORD", f"Kocaeli, 8/17/1999, Izmit, {component}"]
        files[-1].write_text(at2_text(np.ones(9), 0.01, titles, tmp_path))
    motion = {"record": {"file": [str(file) for file in files], "angle": 0.5}}
    told = rockcli.check({"case": {"block": BLOCK, "motion": motion}})["warnings"]
    assert [one for one in told if "perpendicular" in one] == [
        f"0.AT2 is component {one}, 1.AT2 is {two}: two components are perpendicular"
    ] * said
    paired = CliRunner().invoke(app, ["records", "info", *map(str, files), "--rotd"])
    assert isinstance(paired.exception, RecordError) is said


def test_components_of_a_borehole_and_the_surface_are_no_pair(tmp_path):
    files = []
    for component in ("NS1", "EW2"):
        files.append(str(tmp_path / f"{component}.AT2"))
        titles = ["RECORD", f"Kocaeli, 8/17/1999, Izmit, {component}"]
        Path(files[-1]).write_text(at2_text(np.ones(9), 0.01, titles, tmp_path))
    motion = {"record": {"file": files, "angle": 0.5}}
    told = rockcli.check({"case": {"block": BLOCK, "motion": motion}})["warnings"]
    assert "NS1.AT2 is component NS1, EW2.AT2 is EW2: one is of the borehole, the other of the surface" in told


def test_a_vertical_component_that_is_taken_as_horizontal_is_told(tmp_path):
    for component in ("UP", "090"):
        titles = ["RECORD", f"Kocaeli, 8/17/1999, Izmit, {component}"]
        (tmp_path / f"{component}.AT2").write_text(at2_text(np.ones(9), 0.01, titles, tmp_path))
    up, across = str(tmp_path / "UP.AT2"), str(tmp_path / "090.AT2")
    motions = {
        "one": ({"record": up}, 1),
        "two": ({"record": {"file": [across, up], "angle": 0.5}}, 1),
        "where it belongs": ({"record": across, "vertical": up}, 0),
    }
    told = rockcli.check({"case": {"block": BLOCK, "motion": {"record": up, "vertical": across}}})["warnings"]
    assert "090.AT2: its file calls it a horizontal component, 090; it is taken as vertical" in told
    for motion, said in motions.values():
        told = rockcli.check({"case": {"block": BLOCK, "motion": motion}})["warnings"]
        assert [one.split(":")[0] for one in told if "calls it a vertical component, UP" in one] == ["UP.AT2"] * said
    suite = {"case": {"block": BLOCK, "motion": {"record": up}}, "vary": {"motion.record.file": [across, up]}}
    assert any("UP.AT2: its file calls it" in one for one in rockcli.check(suite)["warnings"])


@pytest.mark.parametrize(
    ("component", "is_vertical"),
    [
        *((name, True) for name in ["UP", "u", "UD", "UD1", "UD2", "V", "Vert", "vertical", "DN", "DWN", "Z", "HNZ"]),
        *((name, False) for name in ["", "N", "UX", "HNE", "HN1", "EW2", "090", "S16W", "V1", "FN", "NZ"]),
    ],
)
def test_names_of_vertical_components(component, is_vertical):
    assert Motion(np.ones(2), 0.01, in_g=True, component=component).is_vertical is is_vertical


@pytest.mark.parametrize(
    ("component", "is_horizontal"),
    [
        *((name, True) for name in ["N", "e", "EW", "NS2", "090", "0", "45", "S16W", "HNE", "HN1", "East", "H2", "FN"]),
        *((name, False) for name in ["", "12", "UP", "V", "DWN", "HNZ", "3", "BH100", "Channel 1"]),
    ],
)
def test_names_of_horizontal_components(component, is_horizontal):
    assert Motion(np.ones(2), 0.01, in_g=True, component=component).is_horizontal is is_horizontal


@pytest.mark.parametrize(("window", "apart"), [(None, 1), ([1.0, 2.5], 0), ([0.5, 2.5], 1)])
def test_a_window_of_one_of_two_motions_without_a_clock_is_told(window, apart):
    """AT2 files do not say when they begin: samples of one time meet only under one window."""
    along = {"file": "synthetic_soil_m70.AT2", "window": [1.0, 3.0]}
    up = {"file": "synthetic_rock_m65.AT2"} | ({"window": window} if window else {})
    told = rockcli.check({"case": {"block": BLOCK, "motion": {"record": along, "vertical": {"record": up}}}})[
        "warnings"
    ]
    assert len([one for one in told if "need the same window" in one]) == apart


@pytest.mark.parametrize("steps", [{}, STEPS], ids=["as filed", "processed"])
@pytest.mark.parametrize(
    ("angle", "name", "sign"), [(0, 0, 1), ("90*deg", 1, 1), ("180*deg", 0, -1), ("3*pi/2", 1, -1)]
)
def test_quarter_turns_are_the_components_bit_for_bit(folder, angle, name, sign, steps):
    ours = samples(folder, {"file": BOTH, "angle": angle, **steps})
    alone = samples(folder, {"file": BOTH[name], **steps})
    np.testing.assert_array_equal(ours.values, sign * alone.values)
    assert ours.measures["pga"] == alone.measures["pga"]
    assert ours.measures["pga_raw"] == alone.measures["pga_raw"]
    assert ours.end == alone.end


def test_the_answer_at_0_and_90_degrees_is_that_of_the_component(folder):
    answers = []
    for record in ({"file": BOTH, "angle": 0}, {"file": BOTH, "angle": "90*deg"}, *({"file": n} for n in BOTH)):
        file = opened(folder, {**record, "window": [0, 1.2], "pga_over_g_tan_alpha": 1.4}, save={"dt_out": 0.05}).file
        answers.append(rockcli.run(file))
    for both, alone in zip(answers[:2], answers[2:], strict=True):
        assert float(alone.theta_peak_over_alpha) > 0.0
        np.testing.assert_array_equal(both.theta.values, alone.theta.values)


def test_between_them_it_is_the_sum(folder):
    one, two = (samples(folder, {"file": name}).values for name in BOTH)
    ours = samples(folder, {"file": BOTH, "angle": 0.7})
    np.testing.assert_allclose(ours.values, np.cos(0.7) * one + np.sin(0.7) * two, rtol=0, atol=1e-15)
    assert ours.processing[-1] == "taken in the direction of the angle from h1.csv towards h2.csv"


def test_components_of_one_file_are_named():
    one = Motion(np.ones(3), DT, False, name="both.v2", component="N", processing=("detrended",))
    ours = in_direction(one, replace(one, component="E", processing=()), 0.7)
    assert ours.processing == (
        "both.v2 N: detrended",
        "taken in the direction of the angle from both.v2 N towards both.v2 E",
    )


def test_exact_quarter_turns():
    assert cosine_and_sine(np.pi / 2) == (0.0, 1.0)
    assert cosine_and_sine(-np.pi / 2) == (0.0, -1.0)
    assert cosine_and_sine(1e-9) != (1.0, 0.0)


def test_the_bytes_of_both_files_identify_the_results(folder):
    record = {"file": BOTH, "angle": 0.7}
    first = opened(folder, record)
    assert set(first.inputs) == set(BOTH)
    text = (folder / "h2.csv").read_text()
    (folder / "h2.csv").write_text(text.replace("0.01,", "0.010,"))
    assert opened(folder, record).identity != first.identity
    assert opened(folder, {**record, "angle": 0.8}).identity != opened(folder, record).identity


def test_what_was_done_is_said_once_for_all_directions(folder):
    study = opened(
        folder, {"file": BOTH, "angle": 0, "scale": 2}, vary={"motion.record.angle": [0, "45*deg", "90*deg"]}
    )
    ((name, steps),) = study.processing.items()
    assert name == "h1.csv + h2.csv"
    pga = [np.abs(samples(folder, {"file": BOTH, "angle": a}).values).max() / 9.81 for a in (0, "45*deg", "90*deg")]
    assert f"PGA {min(pga):.4g} to {max(pga):.4g} -> {2 * min(pga):.4g} to {2 * max(pga):.4g} g" in steps[-1]


def test_a_suite_of_pairs_is_named_by_its_files(folder):
    vary = {"motion.record.file": [BOTH, BOTH[::-1]], "motion.record.angle": [0, "45*deg"]}
    study = opened(folder, {"file": BOTH, "angle": 0}, vary=vary)
    assert study.axes[0].values == ("h1.csv + h2.csv", "h2.csv + h1.csv")
    assert (study.axes[1].name, study.axes[1].unit) == ("angle", "rad")


def test_directions_by_name_are_those_of_a_list(folder):
    """With numbers alone they share lanes, with expressions they have one each."""
    record, said = {"file": BOTH, "angle": 0, "scale": 2}, ([0.5, "30*deg"], {"one": 0.5, "two": "30*deg"})
    found = [
        rockcli.run(opened(folder, record, vary={"motion.record.angle": each}, save={"histories": False}).file)
        for each in (*said, {"one": 0.5, "two": np.pi / 6})
    ]
    for other in found[1:]:
        assert other.angle.values.tolist() == ["one", "two"]
        np.testing.assert_array_equal(other.theta_peak, found[0].theta_peak)


def test_a_direction_that_is_none_is_refused(folder):
    with pytest.raises(StudyError, match="two horizontal components need an angle"):
        opened(folder, {"file": BOTH, "angle": 0}, vary={"motion.record.angle": [None, 0.5]})


@pytest.mark.parametrize(
    ("record", "words"),
    [
        ({"file": ["h1.csv", "long.csv"], "angle": 1}, r"400 samples, long.csv 420.*window: \[0, 3.99\]"),
        ({"file": ["h1.csv", "coarse.csv"], "angle": 1}, "time step 0.01 s, coarse.csv 0.02 s"),
        ({"file": ["h1.csv", "in_g.csv"], "angle": 1}, "h1.csv is in m/s2, in_g.csv in g"),
        ({"file": ["h1.csv", "none.csv"], "angle": 1}, "'none.csv' was not found"),
    ],
)
def test_components_that_do_not_fit_are_refused(folder, record, words):
    with pytest.raises(RecordError, match=words) as caught:
        opened(folder, record)
    assert caught.value.file == str(folder / "s.yaml")


def test_a_window_gives_components_of_different_length_what_they_have_in_common(folder):
    ours = samples(folder, {"file": ["h1.csv", "long.csv"], "angle": 0, "window": [0, 3.99]})
    np.testing.assert_array_equal(ours.values, samples(folder, {"file": "h1.csv"}).values)


def test_the_vertical_motion_is_one_component(folder):
    file = opened(folder, {"file": "h1.csv"}).file
    text = file.read_text().replace("motion:\n", "motion:\n    vertical: {file: [h1.csv, h2.csv], angle: 1}\n")
    file.write_text(text)
    with pytest.raises(Exception, match="one component"):
        open_study(file)


def test_the_peak_that_the_study_expects_in_the_worst_direction():
    """Its components are one motion at 60 degrees, here undivided and integrated with scipy."""
    values = np.loadtxt(STUDIES / "polarised_h2.csv", delimiter=",")[:, 1] / np.sin(np.pi / 3)
    ((_, batch),) = open_study({"name": "a", "case": {"block": BLOCK, "initial": {"theta": 0.1}}}).batches()
    theirs = integrate(body_of(batch.block, housner_eta(batch.block)[0]), 0.8 * values, DT)
    clause = open_study(STUDIES / "direction.yaml").expect[1]
    assert clause.quantity == "theta_peak_over_alpha_worst"
    assert clause.target == pytest.approx(theirs.peak_over_alpha, rel=clause.rtol)


def test_the_worst_angle_where_some_overturn_or_have_no_answer(folder):
    """Rows: peaks only; two angles overturn; one has no answer; no answer beside one that overturns; no uplift."""
    vary = {"motion.record.scale": [1, 2, 3, 4, 5], "motion.record.angle": [0, 1, 2]}
    study = opened(folder, {"file": BOTH, "angle": 0}, vary=vary)
    peaks = np.array([[0.1, 0.4, 0.3], [0.2, np.inf, np.inf], [0.1, np.nan, 0.3], [np.nan, 0.1, np.inf], [0, 0, 0]])
    fields = {
        "scale": axis_field("scale", "motion.record.scale", [1, 2, 3, 4, 5], numeric=True, unit="1"),
        "angle": axis_field("angle", "motion.record.angle", [0, 1, 2], numeric=True, unit="rad"),
        "theta_peak_over_alpha": variable_field("theta_peak_over_alpha", ("scale", "angle"), peaks),
    }
    found = with_worst_direction(Contents(("scale", "angle"), fields, {}), study)
    np.testing.assert_array_equal(found.values("angle_worst"), [1, 1, np.nan, 2, np.nan])
    np.testing.assert_array_equal(found.values("theta_peak_over_alpha_worst"), [0.4, np.inf, np.nan, np.inf, 0])


@pytest.mark.slow
@pytest.mark.parametrize(("angle", "peak"), [(0.0, 0.846867), (10.0, np.inf), (90.0, 0.812522)])
def test_a_recorded_pair_overturns_between_its_components(angle, peak):
    """Northridge, Beverly Hills - Mulholland: an independent integration of the sum."""
    folder = SHARED / "records" / "peer" / "p695_far_field"
    names = [folder / f"P695FF0{i}_NORTHR_MUL{c}.AT2" for i, c in ((1, "009"), (2, "279"))]
    if not all(name.is_file() for name in names):
        pytest.skip("the records are not here")
    record = {"file": [str(name) for name in names], "angle": f"{angle}*deg"}
    case = {"block": {"height": 2.4, "width": 0.6}, "motion": {"record": record}}
    found = rockcli.run({"name": "a", "case": case, "save": {"histories": False}})
    one, two = (
        next(open_study({"name": "a", "case": {**case, "motion": {"record": {"file": str(name)}}}}).batches())[1]
        for name in names
    )
    a = np.radians(angle)
    values = np.cos(a) * one.excitation.horizontal.values + np.sin(a) * two.excitation.horizontal.values
    theirs = integrate(body_of(one.block, housner_eta(one.block)[0]), values, one.excitation.horizontal.dt)
    assert theirs.overturned == np.isinf(peak)
    assert float(found.theta_peak_over_alpha) == pytest.approx(peak, rel=1e-5)
    if not theirs.overturned:
        assert theirs.peak_over_alpha == pytest.approx(peak, rel=1e-5)
