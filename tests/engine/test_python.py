"""The functions of the package: studies, records in memory, figures, reports, and what a dataset shows of itself."""

from __future__ import annotations

import os
import threading
import time
import warnings
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import obspy
import pytest
from matplotlib import pyplot
from matplotlib.text import Text

import rockcli
from rockcli.engine import run
from rockcli.engine.run import run_study
from rockcli.study.open import open_study

BLOCK = {"height": 3.0, "width": 0.6}
DT = 0.005
VALUES = 0.35 * np.sin(2.0 * np.pi * np.arange(0.0, 3.0, DT) / 0.9)


def of(record, **more):
    return {"case": {"block": BLOCK, "motion": {"record": record}}, "save": {"histories": False}} | more


@pytest.fixture(scope="module")
def from_file(tmp_path_factory):
    """The reference: the same samples by way of a text file."""
    path = tmp_path_factory.mktemp("records") / "sine.txt"
    np.savetxt(path, VALUES, fmt="%.17g")
    return rockcli.run(of({"file": str(path), "dt": DT, "units": "g"}))


def trace(values=VALUES, station="ABC"):
    made = obspy.Trace(np.asarray(values, dtype=float))
    made.stats.delta, made.stats.station, made.stats.channel = DT, station, "HNE"
    return made


@pytest.mark.parametrize(
    "record",
    [
        {"values": VALUES, "dt": DT, "units": "g"},
        {"values": VALUES.tolist(), "dt": DT, "units": "g"},
        {"values": VALUES * 9.81, "dt": DT, "units": "m/s2"},
        {"values": trace(), "units": "g"},
        {"file": trace(), "units": "g"},
    ],
    ids=["array", "list", "SI", "trace", "trace as a file"],
)
def test_a_record_in_memory_is_that_of_a_file(record, from_file):
    dataset = rockcli.run(of(record))
    for name in ("outcome", "theta_peak", "t_peak", "n_impacts", "pga", "pgv"):
        np.testing.assert_allclose(dataset[name].values, from_file[name].values, rtol=1e-12)


@pytest.mark.parametrize("short", [True, False])
def test_a_vertical_motion_in_memory_is_that_of_a_file(tmp_path, short):
    np.savetxt(tmp_path / "up.txt", VALUES, fmt="%.17g")
    told = {"dt": DT, "units": "g", "scale": 0.5}
    level = {"record": {"values": -VALUES, "dt": DT, "units": "g"}}
    peaks = []
    for up in ({"file": str(tmp_path / "up.txt"), **told}, {"values": VALUES, **told}):
        motion = level | {"vertical": up if short else {"record": up}}
        peaks.append(float(rockcli.run({"case": {"block": BLOCK, "motion": motion}})["N_min_over_mg"]))
    assert peaks[0] == peaks[1] < 0.9


def test_what_read_record_returns_is_a_record(tmp_path, from_file):
    np.savetxt(tmp_path / "sine.txt", VALUES, fmt="%.17g")
    motion = rockcli.read_record(tmp_path / "sine.txt", units="g", dt=DT)
    dataset = rockcli.run(of(motion))
    assert float(dataset["theta_peak"]) == float(from_file["theta_peak"])


def test_traces_make_an_axis_and_processing_applies():
    weak = trace(0.5 * VALUES, "XYZ")
    study = of(
        {"values": trace(), "units": "g", "pga": 3.0}, vary={"motion.record.file": [trace(), weak]}, over="record"
    )
    dataset = rockcli.run(study)
    assert dataset["record"].values.tolist() == [".ABC..HNE", ".XYZ..HNE"]
    np.testing.assert_allclose(dataset["pga"].values, 3.0)
    np.testing.assert_allclose(*dataset["theta_peak"].values, rtol=1e-9)  # scaled to the same


def test_a_trace_without_a_station_has_a_name():
    bare = [obspy.Trace(scale * VALUES, {"delta": DT}) for scale in (1.0, 0.5)]
    dataset = rockcli.run(of({"values": bare[0], "units": "g"}, vary={"motion.record.file": bare}))
    assert dataset["record"].values.tolist() == ["trace", "trace (2)"]


def test_settings_may_hold_arrays():
    settings = {
        "up": {"values": VALUES, "dt": DT, "units": "g", "name": "first"},
        "down": {"values": -VALUES, "dt": DT, "units": "g"},
    }
    dataset = rockcli.run(of(settings["up"], vary={"motion.record": settings}))
    up, down = dataset["theta_peak"].values
    assert up == pytest.approx(-down, rel=1e-9)


def test_motions_of_equal_numbers_in_other_units_are_two(from_file, tmp_path):
    np.savetxt(tmp_path / "sine.txt", VALUES, fmt="%.17g")
    in_g = rockcli.read_record(tmp_path / "sine.txt", units="g", dt=DT)
    in_si = rockcli.read_record(tmp_path / "sine.txt", units="m/s2", dt=DT)
    dataset = rockcli.run(of(in_g, vary={"motion.record": {"g": in_g, "SI": in_si}}))
    np.testing.assert_allclose(dataset["pga"].values, np.abs(VALUES).max() * np.array([9.81, 1.0]), rtol=1e-12)


@pytest.mark.parametrize(
    ("told", "times"), [({"units": "m/s2", "dt": DT}, 1.0 / 9.81), ({"units": "g", "dt": 2.0 * DT}, 2.0)]
)
def test_one_array_may_be_read_in_several_ways(told, times):
    settings = {"one": {"values": VALUES, "units": "g", "dt": DT}, "other": {"values": VALUES, **told}}
    pgv = rockcli.run(of(settings["one"], vary={"motion.record": settings}))["pgv"].values
    np.testing.assert_allclose(pgv[1], times * pgv[0], rtol=1e-12)


def test_other_values_are_another_study():
    first, second = (rockcli.run(of({"values": v, "dt": DT, "units": "g"})) for v in (VALUES, 1.0001 * VALUES))
    assert first.attrs["identity"] != second.attrs["identity"]


@pytest.mark.parametrize("change", [{"values": 1.0001 * VALUES}, {"dt": 2.0 * DT}, {"in_g": False}])
def test_a_motion_that_was_changed_is_another_study(tmp_path, change):
    np.savetxt(tmp_path / "sine.txt", VALUES, fmt="%.17g")
    motion = rockcli.read_record(tmp_path / "sine.txt", units="g", dt=DT)
    first, again, second = (rockcli.run(of(one)) for one in (motion, replace(motion), replace(motion, **change)))
    assert first.attrs["identity"] == again.attrs["identity"] != second.attrs["identity"]


@pytest.mark.parametrize(
    ("record", "words"),
    [
        ({"values": VALUES, "dt": DT}, "units"),
        ({"values": VALUES, "units": "g"}, "time step"),
        ({"values": [1.0], "dt": DT, "units": "g"}, "two or more"),
        ({"values": [VALUES, VALUES], "dt": DT, "units": "g"}, "shape"),
        ({"values": "fast", "dt": DT, "units": "g"}, "not numbers"),
        ({"values": [[1.0, 2.0], [3.0]], "dt": DT, "units": "g"}, "not numbers"),
        ({"values": VALUES > 0.0, "dt": DT, "units": "g"}, "not numbers"),
        ({"values": np.arange(600).astype("M8[s]"), "dt": DT, "units": "g"}, "not numbers"),
        ({"values": np.ones(600, dtype=[("a", float)]), "dt": DT, "units": "g"}, "not numbers"),
        ({"values": VALUES, "file": "a.AT2", "dt": DT, "units": "g"}, "not both"),
        ({"values": trace(), "units": "g", "dt": 0.1}, "leave `dt` out"),
        ({"values": [1.0, float("nan")], "dt": DT, "units": "g"}, "finite"),
        ({"values": np.fft.ifft(np.fft.fft(VALUES)), "dt": DT, "units": "g"}, "are complex"),
        ({"values": np.ma.masked_greater(VALUES, 0.3), "dt": DT, "units": "g"}, "finite"),
        (np.asarray(VALUES, dtype=float), "an array without a time step and units: write {.values.: ARRAY"),
    ],
)
def test_what_is_wrong_with_a_record_is_said(record, words):
    with pytest.raises((rockcli.StudyError, rockcli.RecordError), match=words):
        rockcli.run(of(record))


@pytest.mark.parametrize(
    ("beside", "words"),
    [
        ({"units": "m/s2"}, "the motion is in g, `units` says m/s2"),
        ({"dt": 2.0 * DT}, "the time step told with the values is 0.005 s"),
        ({"component": "EW"}, "does not name its component"),
    ],
)
def test_what_is_told_beside_a_motion_must_agree_with_it(tmp_path, beside, words):
    np.savetxt(tmp_path / "sine.txt", VALUES, fmt="%.17g")
    motion = rockcli.read_record(tmp_path / "sine.txt", units="g", dt=DT)
    assert float(rockcli.run(of({"file": motion, "units": "g", "dt": DT}))["pga"]) > 0.0
    with pytest.raises(rockcli.RecordError, match=words):
        rockcli.run(of({"file": motion, **beside}))


PULSES = {
    "title": "Two sizes under sines",
    "case": {"block": {"R": 1.0, "tan_alpha": 0.2}, "motion": {"pulse": {"shape": "sine", "a_p": "0.3*g", "T_p": 0.8}}},
    "vary": {"block.R": [1.0, 2.0], "motion.pulse.a_p": {"from": "0.1*g", "to": "1.5*g", "n": 6}},
    "save": {"histories": False},
}


def test_workers_change_no_number_and_progress_reaches_the_end():
    seen = []
    alone = rockcli.run(PULSES, progress=lambda done, total: seen.append((done, total)))
    both = rockcli.run(PULSES, workers=2)
    assert seen[-1] == (12, 12)
    np.testing.assert_array_equal(alone["theta_peak"].values, both["theta_peak"].values)
    for wrong in (0, 1.5, True):
        with pytest.raises(rockcli.StudyError, match="workers"):
            rockcli.run(PULSES, workers=wrong)


@pytest.fixture(scope="module")
def pulses():
    return rockcli.run(PULSES)


def test_threads_solve_one_after_another(monkeypatch):
    """Kernels change from plain Python to compiled under a thread that is at work, and its results were not a number."""
    at_work, most = [], []

    def solve(study, sweep):
        at_work.append(study)
        most.append(len(at_work))
        time.sleep(0.05)
        found = solved(study, sweep=sweep)
        at_work.remove(study)
        return found

    solved = run.solve
    monkeypatch.setattr(run, "solve", solve)
    study = {"case": {"block": BLOCK, "initial": {"theta": 0.05}}, "save": {"histories": False}}
    with ThreadPoolExecutor(4) as pool:
        peaks = {float(found.theta_peak) for found in pool.map(rockcli.run, [study] * 8)}
    assert (most, peaks) == ([1] * 8, {0.05})


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
def test_a_process_forked_while_a_thread_solves_need_not_wait_for_it():
    """The child has the lock as it was held, and no thread that would let it go."""
    held, done = threading.Event(), threading.Event()

    def hold():
        with rockcli._turn:
            held.set()
            done.wait()

    thread = threading.Thread(target=hold)
    thread.start()
    held.wait()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of a fork beside threads
        child = os.fork()
    if not child:
        os._exit(0 if rockcli._turn.acquire(blocking=False) else 1)
    done.set()
    thread.join()
    assert os.waitpid(child, 0)[1] == 0


def test_a_dataset_shows_its_outcomes_and_peak(pulses):
    shown, page = repr(pulses.rock), pulses.rock._repr_html_()
    n = int((pulses["outcome"] == 0).sum())
    for words in (shown, page):
        assert "Two sizes under sines" in words
        assert f"{n} no uplift" in words
        assert f"{pulses.rock.peak:.6g}" in words
    finite = pulses["theta_peak_over_alpha"].values
    assert pulses.rock.peak == finite[np.isfinite(finite)].max()
    assert sum(pulses.rock.outcomes.values()) == 12


def test_a_part_of_a_dataset_shows_its_own(pulses):
    part = pulses.isel(block_R=0) if "block_R" in pulses.dims else pulses.isel({pulses.attrs["axes"].split()[0]: 0})
    assert sum(part.rock.outcomes.values()) == 6
    assert "cases     6" in repr(part.rock)


@pytest.mark.parametrize("over", [None, {"axis": "block.R", "along": "a_p"}])
@pytest.mark.parametrize("gone", [0, 1])
def test_a_part_of_a_dataset_is_a_table_a_figure_and_a_report(over, gone, tmp_path):
    """An axis at one of its points is none any more; what a suite comes to over it goes with it."""
    more = {"save": {"histories": True, "dt_out": 0.05}, "compare_to": {"block.R": PULSES["vary"]["block.R"][0]}}
    dataset = rockcli.run(PULSES | more | ({"over": over} if over else {}))
    axis, left = (dataset.attrs["axes"].split()[i] for i in (gone, 1 - gone))
    part = dataset.isel({axis: 0})
    table = part.rock.table()
    assert len(table) == part.sizes[left]
    assert table.columns[0].startswith(left)
    assert not [head for head in table.columns if head.startswith("p_overturned")]
    assert part.rock.plot().axes
    assert part.rock.report(tmp_path / "part.html").is_file()
    assert dataset.attrs["axes"].split() == [*((axis, left) if gone == 0 else (left, axis))]


def test_of_listed_plots_a_part_shows_the_first_it_can():
    select = {"kind": "curve", "select": {"block.R": PULSES["vary"]["block.R"][0]}}
    suite = PULSES | {"over": {"axis": "block.R", "along": "a_p"}}
    dataset = rockcli.run(suite | {"plots": ["fragility", select, "map"]})
    part = dataset.isel(block_R=0)
    drawn = part.rock.plot().axes[0].get_ylabel()
    assert drawn == rockcli.plot(part, "map").axes[0].get_ylabel() != dataset.rock.plot().axes[0].get_ylabel()
    part = rockcli.run(suite | {"plots": ["fragility"]}).isel(block_R=0)  # what its content suggests
    assert rockcli.plot(part).axes[0].get_ylabel() == drawn
    with pytest.raises(rockcli.StudyError, match="takes no statistics over an axis"):
        rockcli.plot(part, "fragility")


def test_what_a_suite_comes_to_is_not_told_of_a_part(tmp_path):
    expect = [{"quantity": "outcome", "at": {"a_p": "1.5*g"}, "is_not": "failed"}]
    over = {"axis": "block.R", "along": "a_p"}
    dataset = rockcli.run(PULSES | {"over": over, "expect": expect})
    assert dataset.attrs["points"] == "2 6"
    assert "suite" in repr(dataset.rock)
    for part in (dataset.isel(block_R=[1]), dataset.isel(motion_pulse_a_p=slice(3))):
        shown = repr(part.rock)
        assert "suite" not in shown
        assert "warning" not in shown
        assert f"cases     {part['outcome'].size}" in shown
    assert "is not failed" not in part.rock.report(tmp_path / "part.html").read_text(encoding="utf-8")
    own = rockcli.table(dataset).columns
    assert list(rockcli.table(dataset.isel(block_R=[1])).columns) == [head for head in own if "fragility" not in head]
    with pytest.raises(rockcli.StudyError, match="has no table 'suite'"):
        rockcli.table(dataset.isel(block_R=[1]), of="suite")
    dataset.to_netcdf(tmp_path / "again.nc")
    assert "suite" in repr(rockcli.open_dataset(tmp_path / "again.nc").rock)


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ({"select": "a_p=3"}, "select is 'a_p=3'; expected a mapping"),
        ({"limits": (0, 1)}, "limits is .* expected a mapping"),
        ({"limits": {"x": 1}}, "limits of 'x' are 1; expected two numbers"),
        ({"limits": {"x": (0, None)}}, "limits of 'x' are .* expected two numbers"),
        ({"limits": {"z": (0, 1)}}, "limits of 'z': expected x or y"),
        ({"labels": {"ylabel": "words"}}, "labels of 'ylabel': expected x or y"),
        ({"title": 3}, "title is 3; expected words"),
        ({"labels": {"x": 3}}, "labels of 'x' are 3; expected words"),
        ({"limits": {3: (0, 1)}}, "limits of 3 are .* expected two numbers"),
        ({"width": [90]}, r"width is \[90\]; expected single"),
        ({"path": 3}, "path is 3; expected the path of a file"),
    ],
)
def test_what_is_wrong_with_a_figure_is_said(how, words, pulses):
    with pytest.raises(rockcli.StudyError, match=words):
        rockcli.plot(pulses, "map", **how)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda one: rockcli.read_record("a.csv", dt="0.01"), "a.csv: `dt` is '0.01'; expected the time step"),
        (lambda one: rockcli.read_record("a.csv", dt=True), "`dt` is True; expected the time step"),
        (lambda one: rockcli.read_record(None), "path is None; expected the path of a file"),
        (lambda one: rockcli.read_record(["a", "b"]), "path is of type list; expected the path"),
        (lambda one: rockcli.read_record("a\0b"), "cannot be read: embedded null byte"),
        (lambda one: rockcli.open_dataset(3), "path is 3; expected the path of a file"),
        (lambda one: rockcli.open_dataset(one), "path is of type Dataset; expected the path"),
        (lambda one: rockcli.report(one, None), "path is None; expected the path of a file"),
        (lambda one: one.rock.report(3), "path is 3; expected the path of a file"),
        (lambda one: rockcli.plot(one, 3), "kind is 3; expected the name of a kind of plot"),
        (lambda one: one.rock.plot("map", 3), "path is 3; expected the path of a file"),
        (lambda one: rockcli.table(one, of=None), "of is None; expected the name of a table"),
        (lambda one: rockcli.run(PULSES, progress=True), "progress is True; expected a function"),
    ],
)
def test_an_argument_of_another_kind_is_named(call, words, pulses):
    with pytest.raises((rockcli.StudyError, rockcli.RecordError)) as caught:
        call(pulses)
    assert words in str(caught.value)


@pytest.mark.parametrize("columns", ["outcome", [1], 3])
def test_columns_are_a_list_of_names(columns, pulses):
    with pytest.raises(rockcli.StudyError, match="expected a list of names"):
        rockcli.table(pulses, columns=columns)


def test_numbers_of_numpy_are_numbers(pulses):
    assert rockcli.run(PULSES, workers=np.int64(2)).attrs["checksum"] == pulses.attrs["checksum"]
    axis = pulses["motion_pulse_a_p"]
    for values in (axis.values[1:3], axis[1:3]):
        shown = rockcli.plot(pulses, "map", select={"a_p": values, "block.R": [1.0, 2.0]})
        listed = rockcli.plot(pulses, "map", select={"a_p": np.asarray(values).tolist(), "block.R": [1.0, 2.0]})
        assert [axes.get_xlim() for axes in shown.axes] == [axes.get_xlim() for axes in listed.axes]
    one = rockcli.plot(pulses, "curve", select={"a_p": axis[1:], "block.R": pulses["block_R"][1]})
    assert one.axes


def masked(dataset):
    return dataset.where(dataset["R"] > 1.0)


@pytest.mark.parametrize(
    ("change", "same"),
    [
        (lambda d: d.transpose(), True),
        pytest.param(lambda d: d.squeeze(), True, marks=pytest.mark.slow),
        pytest.param(masked, False, marks=pytest.mark.slow),
    ],
    ids=["transposed", "squeezed", "masked"],
)
def test_what_xarray_makes_of_a_dataset_is_shown_too(change, same, tmp_path):
    clause = {"quantity": "outcome", "is": "rocking"}
    more = {
        "save": {"histories": True, "dt_out": 0.05},
        "expect": [clause],
        "case": PULSES["case"] | {"model": "rigid"},
    }
    dataset = rockcli.run(PULSES | more)
    changed = change(dataset)
    assert changed.rock.report(tmp_path / "changed.html").is_file()
    assert changed.rock.plot("histories").axes
    assert changed.rock.plot("map").axes
    cases, table = dataset.rock.table(), changed.rock.table()
    if same:
        assert table[cases.columns].equals(cases)  # squeezed, the one impact of a case stands beside
        assert repr(changed.rock) == repr(dataset.rock)
    else:
        kept = cases[cases["R [m]"] > 1.0]["outcome"].tolist()
        assert [word for word in table["outcome"] if word] == kept
        assert sum(changed.rock.outcomes.values()) == len(kept) == 6


@pytest.mark.parametrize(
    "change",
    [
        lambda d: d.rename(block_R="size"),
        lambda d: d.expand_dims(again=[1, 2]),
        lambda d: d.stack(size=("block_R", "motion_pulse_a_p")),
        lambda d: d.assign_coords(size=("block_R", [1, 2])).swap_dims(block_R="size"),
    ],
    ids=["renamed", "added", "stacked", "swapped"],
)
def test_dimensions_that_are_no_axes_are_told(change, pulses, tmp_path):
    changed = change(pulses)
    for ask in (
        lambda: changed.rock,
        lambda: rockcli.table(changed),
        lambda: rockcli.plot(changed),
        lambda: rockcli.report(changed, tmp_path / "changed.html"),
    ):
        with pytest.raises(rockcli.StudyError, match=r"is over (size|again), which is no axis of the study"):
            ask()


def test_an_axis_without_values_is_told(pulses, tmp_path):
    bare = pulses.drop_vars("block_R")
    for shown in (lambda: bare.rock, lambda: rockcli.report(bare, tmp_path / "bare.html")):
        with pytest.raises(rockcli.StudyError, match="has no values of its axis 'block_R'"):
            shown()


@pytest.mark.parametrize("given", [None, "pulses.nc", [], 3, {"case": {}}])
def test_what_is_no_dataset_is_told(given, tmp_path):
    asked = [lambda: rockcli.table(given), lambda: rockcli.plot(given)]
    if not isinstance(given, str):  # a report is of a file too
        asked.append(lambda: rockcli.report(given, tmp_path / "none.html"))
    for ask in asked:
        with pytest.raises(rockcli.StudyError, match=r"expected (a dataset of|one dataset)"):
            ask()


def test_the_scalars_are_one_row_per_case(pulses):
    study = PULSES | {"over": {"axis": "block.R", "along": "a_p"}, "save": {"histories": True, "dt_out": 0.05}}
    dataset = rockcli.run(study)
    assert "time" in dataset.dims
    frame = dataset.rock.cases.to_dataframe()
    assert len(frame) == 12
    assert {"outcome", "theta_peak", "pga"} <= set(frame.columns)
    assert len(pulses[["outcome", "theta_peak"]].to_dataframe()) == 12


def test_a_figure_a_report_and_a_table_of_a_dataset_in_memory(pulses, tmp_path):
    figure = rockcli.plot(pulses, "map", tmp_path / "map.pdf")
    assert figure.axes
    assert (tmp_path / "map.pdf").read_bytes().startswith(b"%PDF")
    assert rockcli.plot(pulses).axes
    page = rockcli.report(pulses, tmp_path / "pulses.html")
    assert "Two sizes under sines" in page.read_text(encoding="utf-8")
    assert pulses.rock.report(tmp_path / "again.html").read_bytes() == page.read_bytes()
    assert len(pulses.rock.table()) == len(rockcli.table(pulses)) == 12
    with pytest.raises(rockcli.StudyError, match="histories"):
        rockcli.plot(pulses, "phase")
    with pytest.raises(rockcli.StudyError, match="ends in"):
        rockcli.plot(pulses, "map", tmp_path / "map.bmp")
    assert rockcli.report(pulses, tmp_path / "pulses.htm").read_bytes() == page.read_bytes()
    assert ".html or .htm" in str(rockcli.report.__doc__)
    with pytest.raises(rockcli.StudyError, match=r"ends in \.html or \.htm"):
        rockcli.report(pulses, tmp_path / "pulses.pdf")


def test_a_file_is_opened_with_what_it_shows(tmp_path):
    study = {"name": "one", "case": {"block": BLOCK, "motion": {"pulse": {"shape": "sine", "a_p": 3, "T_p": 1}}}}
    path = run_study(open_study(study), tmp_path, plots=False).file
    dataset = rockcli.open_dataset(path)
    assert "outcomes" in repr(dataset.rock)
    assert rockcli.report(path, tmp_path / "one.html").is_file()
    with pytest.raises(rockcli.StudyError):
        rockcli.open_dataset(tmp_path / "none.nc")


def test_check_says_what_rock_check_says():
    found = rockcli.check(PULSES)
    assert found["cases"] == 12
    assert found["first_case"]["body"]["R"] == pytest.approx(1.0)
    with pytest.raises(rockcli.StudyError):
        rockcli.check({"case": {"block": {"R": -1}}})


def label_of(axis):
    """A label as it is read: xarray breaks the lines of long ones."""
    return " ".join(axis.get_label_text().split())


@pytest.mark.parametrize("name", ["outcome", "theta_peak_over_alpha"])
def test_xarray_labels_axes_with_words_and_units(pulses, name):
    pyplot.switch_backend("Agg")
    drawn = pulses[name].plot()
    axes = drawn.axes
    assert {label_of(axes.xaxis), label_of(axes.yaxis)} == {
        "peak acceleration of the pulse [m s-2]",
        "distance from the edge to the centre of mass [m]",
    }
    assert " ".join(drawn.colorbar.ax.get_ylabel().split()).startswith(pulses[name].attrs["long_name"])
    pyplot.close(drawn.figure)


def test_an_axis_has_words_and_its_path(pulses):
    attrs = pulses.motion_pulse_a_p.attrs
    assert attrs == {"long_name": "peak acceleration of the pulse", "path": "motion.pulse.a_p", "units": "m s-2"}


def test_a_frame_of_scalars_has_one_row_per_case(pulses):
    frame = pulses[["outcome", "theta_peak_over_alpha"]].to_dataframe()
    assert len(frame) == pulses.outcome.size == 12
    assert (frame["outcome"].to_numpy() == pulses.outcome.values.ravel()).all()


def test_a_dataset_without_paths_is_shown_as_one_with_them(pulses):
    """As earlier builds wrote them: the path was the long name."""
    old = pulses.copy()
    for name in (*old.dims, *old.coords):
        path = old[name].attrs.pop("path", None)
        if path is not None:
            old[name].attrs["long_name"] = path
    assert old.motion_pulse_a_p.attrs["long_name"] == "motion.pulse.a_p"
    assert rockcli.table(old).equals(rockcli.table(pulses))
    assert repr(old.rock) == repr(pulses.rock)
    texts = [[t.get_text() for t in rockcli.plot(each, "map").findobj(match=Text)] for each in (old, pulses)]
    assert texts[0] == texts[1]


def test_versions_are_those_of_the_installed_packages() -> None:
    from importlib.metadata import version

    from rockcli.engine.provenance import versions

    found = versions()
    assert found["numpy"] == version("numpy")
    assert found["netCDF4"] == version("netCDF4")
