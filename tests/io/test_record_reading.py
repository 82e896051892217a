"""Any file -> Motion: units and time step stated or refused, never guessed."""

from __future__ import annotations

import bz2
import csv
import gzip
import hashlib
import lzma
import pickle
import re
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from rockcli.errors import RecordError
from rockcli.motion.agencies.formats import format_of
from rockcli.motion.at2 import read_at2
from rockcli.motion.numbers import read_numbers
from rockcli.motion.reading import components_of, read_record
from rockcli.motion.text import two_columns

AT2 = (
    "PEER NGA STRONG MOTION DATABASE RECORD\nEvent, 1/2/2003, Station, 090\nACCELERATION TIME SERIES IN UNITS OF G\n"
    "NPTS=  6, DT=   .0050 SEC\n .1 -.2 .3\n -.4 .5 -.3\n"
)
KNET = """Origin Time       1996/08/11 03:12:00
Lat.              38.920
Long.             140.630
Depth. (km)       7
Mag.              5.9
Station Code      AKT013
Station Lat.      39.6069
Station Long.     140.3213
Station Height(m) 34
Record Time       1996/08/11 03:12:39
Sampling Freq(Hz) 100Hz
Duration Time(s)  0.08
Dir.              E-W
Scale Factor      2000(gal)/1000
Max. Acc. (gal)   10.0
Last Correction   1996/08/11 03:12:15
Memo.
       0       1      -2       3      -4       5       0       0
"""
TWO = "".join(f"{0.02 * i:.3f}\t{value}\n" for i, value in enumerate((0.1, -0.2, 0.3, 0.4)))


def refused(path: Path, words: str, **options: object) -> None:
    with pytest.raises(RecordError) as caught:
        read_record(path, **options)  # type: ignore[arg-type]
    assert words in caught.value.message
    assert caught.value.file == str(path)


def test_at2(write) -> None:
    path = write(AT2)
    motion = read_record(path)
    assert motion.in_g
    assert motion.units == "g"
    assert motion.values.tolist() == [0.1, -0.2, 0.3, -0.4, 0.5, -0.3]
    assert (motion.dt, motion.duration) == (0.005, 5 * 0.005)
    assert (motion.name, motion.format, motion.component) == ("record.AT2", "AT2", "090")
    assert motion.sha256 == hashlib.sha256(AT2.encode()).hexdigest()
    assert motion.processing == ()
    assert motion.warnings == ()
    assert motion.acceleration(9.81)[0] == 0.1 * 9.81


def test_what_is_stated_twice_must_agree(write) -> None:
    path = write(AT2)
    for component in ("090", 90, "90", 0):
        assert read_record(path, component=component, units="g", dt=0.005).component == "090"
    refused(path, "'090' only", component="180")
    refused(path, "'090' only", component=1)
    refused(path, "`units` says gal", units="gal")
    refused(path, "`dt` says 0.01", dt=0.01)
    refused(path, "expected one of g, m/s2", units="furlong")
    refused(path, "above zero", dt=-1.0)


def test_what_no_format_can_be_read_from(write, tmp_path: Path) -> None:
    refused(tmp_path / "none.AT2", "no such file")
    refused(tmp_path, "folder")
    refused(write(b""), "empty")
    refused(write("Corrected acceleration    (Format v01.20)\n 1 2 3\n"), "the format is not known")
    refused(write("some words\n1 2\n"), "format is not known")
    refused(write(bytes(range(256)) * 40), "ObsPy")


@pytest.mark.parametrize(("pack", "words"), [(gzip.compress, "gzip"), (bz2.compress, "bzip2"), (lzma.compress, "xz")])
def test_a_compressed_record_is_told(write, pack: Callable[[bytes], bytes], words: str) -> None:
    refused(write(pack(AT2.encode())), f"compressed by {words}")


@pytest.mark.parametrize("name", ["q.AT2", "q.txt", "q.mseed"])
def test_what_is_too_large_is_refused_by_its_size(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    with path.open("wb") as file:
        file.write(AT2.encode())
        file.truncate(30 * 10**9)  # takes no space: nothing is written there
    began = time.monotonic()
    refused(path, r"has 28,610 MiB, and a record has at most 256 MiB")
    if name == "q.AT2":
        with pytest.raises(RecordError, match="at most 256 MiB"):
            read_at2(str(path))
    assert time.process_time() - began < 1.0


def test_a_pickle_is_not_run(write, tmp_path: Path) -> None:
    class Trap:
        def __reduce__(self) -> tuple[object, tuple[str]]:
            return (Path.touch, (tmp_path / "sprung",))  # type: ignore[return-value]

    refused(write(pickle.dumps(("obspy.core.stream", Trap()))), "format is not known")
    assert not (tmp_path / "sprung").exists()


def test_one_column_needs_units_and_dt(write) -> None:
    path = write("# a comment\n1.0\n-2.0\n\n3.0D0\n", "one.txt")
    refused(path, "`units:`")
    refused(path, "`dt:`", units="g")
    motion = read_record(path, units="gal", dt=0.01)
    np.testing.assert_allclose(motion.values, [0.01, -0.02, 0.03], rtol=1e-15)
    assert not motion.in_g
    assert motion.processing == ("values in gal converted to m/s2",)
    assert read_record(path, units="m/s2", dt=0.01).values.tolist() == [1.0, -2.0, 3.0]
    assert read_record(path, units="cm/s2", dt=0.01).values.tolist() == motion.values.tolist()
    assert read_record(path, units="g", dt=0.01).in_g


@pytest.mark.parametrize("text", [TWO, TWO.replace("\t", ", "), TWO.replace("\n", "\r\n"), "% comment\n" + TWO])
def test_two_columns(write, text: str) -> None:
    path = write(text, "two.txt")
    motion = read_record(path, units="g")
    assert motion.values.tolist() == [0.1, -0.2, 0.3, 0.4]
    assert motion.dt == 0.02
    assert read_record(path, units="g", dt=0.02).dt == 0.02
    refused(path, "time column says dt is 0.02", units="g", dt=0.01)
    refused(path, "`units:`")


@pytest.mark.parametrize(
    "head", ["time [s],acceleration [cm/s2]", '"Time (s)","Acc (gal)"', "t\tacceleration [cm/s^2]"]
)
def test_a_head_names_the_columns_and_their_units(write, head: str) -> None:
    motion = read_record(write(f"# a logger\n{head}\n{TWO}".replace("\t", ","), "headed.csv"))
    assert (motion.values.tolist(), motion.dt, motion.in_g) == ([0.001, -0.002, 0.003, 0.004], 0.02, False)
    assert read_record(write(f"{head}\n{TWO}", "tabs.csv"), units="cm/s2").values.tolist() == motion.values.tolist()
    refused(write(f"{head}\n{TWO}", "other.csv"), "units", units="g")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1"])
@pytest.mark.parametrize("head", ["# Ängelholm, Ångström\n# units: cm/s²\n", "# Å\ntime [s],acceleration [cm/s²]\n"])
def test_comments_and_units_may_hold_any_letters(write, head: str, encoding: str) -> None:
    motion = read_record(write((head + TWO).encode(encoding), "letters.txt"))
    assert (motion.values.tolist(), motion.dt) == ([0.001, -0.002, 0.003, 0.004], 0.02)


def test_a_mark_before_plain_numbers_is_no_part_of_them(write) -> None:
    assert read_record(write(b"\xef\xbb\xbf" + TWO.encode(), "marked.txt"), units="g").values[0] == 0.1


def test_a_value_that_begins_like_a_blank_of_sac_is_a_value(write) -> None:
    path = write("10.5\n-12345.67\n-123450.\n300.25\n", "large.txt")
    assert read_record(path, units="mm/s2", dt=0.01).values[1] == pytest.approx(-12.34567, rel=1e-15)


def test_a_head_that_says_too_little_or_what_is_not_there(write) -> None:
    refused(write(f"time,acceleration\n{TWO}", "bare.csv"), "`units:`")
    assert read_record(write(f"time,acceleration\n{TWO}", "bare.csv"), units="g").in_g
    refused(write(f"time [s],acceleration [furlong]\n{TWO}", "odd.csv"), "is not a unit of acceleration")
    refused(write("time [s],acceleration [g]\n0.1\n0.2\n", "one.csv"), "names two columns", dt=0.01)
    for head in (
        "time [ms],acceleration [g]",
        "time [s],velocity [m/s]",
    ):
        refused(write(f"{head}\n{TWO}", "no.csv"), "format is not known")
    refused(write(f"time [s],acceleration [g]\ntime,acceleration\n{TWO}", "twice.csv"), "named twice")


def test_time_that_starts_at_one_step_is_told(write) -> None:
    text = TWO.split("\n", 1)[1]
    motion = read_record(write(text, "late.txt"), units="g")
    assert motion.values.tolist() == [-0.2, 0.3, 0.4]
    assert "0.02 s in the file" in motion.processing[0]


def test_time_printed_with_few_digits(write) -> None:
    times = [i / 150.0 for i in range(400)]
    path = write("".join(f"{t:.4f} 0.1\n" for t in times), "rounded.txt")
    assert read_record(path, units="g").dt == pytest.approx(1.0 / 150.0, rel=3e-5)
    assert read_record(path, units="g", dt=1.0 / 150.0).dt == 1.0 / 150.0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0.0 .1\n.01 .2\n.05 .3\n", "equal steps"),
        ("0.0 .1\n.02 .2\n.01 .3\n", "equal steps"),
        ("5.0 .1\n5.1 .2\n5.2 .3\n", "equal steps"),
        ("-.3 .1\n.2 .2\n-.2 .3\n", "equal steps"),
        ("0 .1 .2\n.01 .2 .3\n.02 .3 .4\n", "time column and 2 others"),
        ("1 2 3\n4 5\n6 7 8\n", "damaged"),
        ("0,00 0,1\n0,01 0,2\n0,02 0,3\n", "comma"),
        ("1 2 3\n1e 2 3\n", "not a number"),
        ("1\n1e999\n", "too large"),
        ("1\n2\ne\n", "no line of numbers"),
        ("0 .1\n.01 nan\n.02 .3\n", "'.01 nan' is no line of numbers"),
        ("# t, a\n1\n2\n***\n4\n", "'***' is no line of numbers"),
        ("e1\n", "no line of numbers"),
    ],
)
def test_tables_that_are_no_record(write, text: str, words: str) -> None:
    refused(write(text, "table.txt"), words, units="g", dt=0.01)


def test_a_word_in_a_column_is_told_with_its_line(write) -> None:
    with pytest.raises(RecordError, match="no line of numbers") as caught:
        read_record(write("# nan\n" + TWO.replace("0.3", "NaN"), "gap.txt"), units="g")
    assert caught.value.line == 4


def test_rows_of_values_are_read_line_by_line(write) -> None:
    path = write(" .1-.2 .3 .4 .5\n .6 .7\n", "five.acc")
    motion = read_record(path, units="g", dt=0.01)
    assert motion.values.tolist() == [0.1, -0.2, 0.3, 0.4, 0.5, 0.6, 0.7]
    assert "5 on each" in motion.processing[0]


@pytest.mark.parametrize(("head", "line"), [("# a record\n40\n", 2), ("40\n.01\n", 1), (".01\n\n40\n", 3)])
def test_a_number_of_values_is_no_acceleration(write, head: str, line: int) -> None:
    column = "".join(f"{i % 7 - 3.5}\n" for i in range(40))
    path = write(head + column)
    with pytest.raises(RecordError, match="40 is how many values follow") as caught:
        read_record(path, units="gal", dt=0.01)
    assert caught.value.line == line
    for values in (head.replace("40", "40.0") + column, head + column + "1\n"):
        assert read_record(write(values), units="gal", dt=0.01).values.max() == pytest.approx(0.4)


@pytest.mark.parametrize("columns", [3, 6])
def test_motions_side_by_side_are_doubted(write, columns: int) -> None:
    t = 0.01 * np.arange(600)
    motions = np.array([np.sin((3.0 + j) * t + j) for j in range(columns)])
    for values, doubted in ((motions.T, True), (motions[0].reshape(-1, columns), False)):
        text = "\n".join(" ".join(f"{value:.6f}" for value in row) for row in values)
        motion = read_record(write(text), units="g", dt=0.01)
        assert [f"{columns} motions side by side" in one for one in motion.warnings] == [True] * doubted


def test_units_in_a_comment_are_a_statement(tmp_path: Path) -> None:
    path = tmp_path / "own.txt"
    values = np.random.default_rng(0).standard_normal(500)
    path.write_text(two_columns(values, 0.0125, "m/s2", ["title"]), newline="")
    motion = read_record(path)
    assert motion.values.tolist() == values.tolist()
    assert (motion.dt, motion.units) == (0.0125, "m/s2")
    refused(path, "`units` says g", units="g")


@pytest.mark.parametrize("dt", [1.0 / 300.0, 1.0 / 60.0, 0.01])
def test_a_step_of_no_few_digits_is_written_and_read_back(write, dt: float) -> None:
    motion = read_record(write(two_columns(np.ones(6000), dt, "m/s2", [])))
    assert (motion.dt, len(motion.values)) == (dt, 6000)


@pytest.mark.parametrize(
    ("text", "options", "line", "words"),
    [
        ("# dt: 0.02\n1\n2\n", {"dt": 0.01}, 1, "the file says its time step is 0.02 s, `dt` says 0.01 s"),
        ("1\n2\n% dt = .02 sec\n# DT: .01\n", {}, 4, "the file says its time step is 0.02 s, and here 0.01 s"),
        (
            "# dt: 0.02\n0 1\n.01 2\n.02 1\n",
            {"units": "g"},
            None,
            "a comment says dt is 0.02 s, the time column 0.01 s",
        ),
        ("# dt: 20 ms\n1\n2\n", {}, 1, "dt is '20 ms'; expected the time step in seconds"),
        ("# dt: 1,5\n1\n2\n", {}, 1, "dt is '1,5'; expected the time step in seconds"),
        ("# dt: 0\n1\n2\n", {}, 1, "dt is '0'; expected the time step in seconds"),
        ("# units: g\n1\n2\n# units = m/s2\n", {}, 4, "the file says its units are g, and here m/s2"),
        ("1\n2\n# units = m/s2\n", {"units": "g"}, 3, "the file says its units are m/s2, `units` says g"),
    ],
)
def test_what_comments_state_is_not_contradicted(
    write, text: str, options: dict[str, object], line: int | None, words: str
) -> None:
    with pytest.raises(RecordError, match=re.escape(words)) as caught:
        read_record(write(text, "a.txt"), **options)
    assert caught.value.line == line


def test_a_step_in_a_comment_is_a_statement(write) -> None:
    assert read_record(write("# dt: 0.02 s (50 Hz)\n1\n2\n"), units="g").dt == 0.02
    assert read_record(write("# dt: 0.02\n1\n2\n"), units="g", dt=0.02).dt == 0.02
    assert read_record(write("# dt: 0.02\n0 1\n.02 2\n.04 1\n"), units="g").dt == 0.02


def test_suspicious_values_are_remarked(write) -> None:
    assert "are the units right" in read_record(write(AT2.replace(".5", "50.")), dt=0.005).warnings[0]
    assert "offset" in read_record(write(AT2.replace("-", "")), dt=0.005).warnings[0]


def test_knet_counts_become_si_with_the_calibration(write) -> None:
    path = write(KNET, "AKT013.EW")
    motion = read_record(path)
    np.testing.assert_allclose(motion.values, np.array([0, 1, -2, 3, -4, 5, 0, 0]) * 0.02, rtol=1e-12)
    assert (motion.units, motion.format, motion.component, motion.dt) == ("m/s2", "KNET", "EW", 0.01)
    assert "calibration factor 0.02" in motion.processing[0]
    assert read_record(path, units="gal", component="EW").units == "m/s2"
    refused(path, "states its own units", units="g")
    refused(path, "AKT013", component="NS")


@pytest.mark.parametrize(("cut", "left"), [("       5       0       0\n", 5), ("       0\n", 7)])
def test_a_knet_file_that_was_cut_is_refused(write, cut: str, left: int) -> None:
    assert KNET.endswith(cut)
    path = write(KNET.removesuffix(cut) + "\n", "AKT013.EW")
    refused(path, f"the header announces 8 values and {left} follow")


def test_a_header_of_knet_without_its_end(write) -> None:
    refused(write(KNET.replace("Memo.\n", ""), "AKT013.EW"), "does not end with a line 'Memo.'")


def test_seismological_formats_need_units_and_a_component(tmp_path: Path) -> None:
    from obspy import Stream, Trace

    names = ("HNE", "HNN")
    traces = [
        Trace(np.array([1.0, 2.0, -3.0 - i]), {"delta": 0.01, "channel": name, "station": "ABC", "network": "XX"})
        for i, name in enumerate(names)
    ]
    path = tmp_path / "two [1].mseed"
    Stream(traces).write(str(path), format="MSEED")
    refused(path, "0: XX.ABC..HNE, 1: XX.ABC..HNN", units="gal")
    refused(path, "does not state the units", component="HNE")
    refused(path, "`component` is 'HNZ'", component="HNZ", units="gal")
    for asked in ("HNN", "hnn", 1, "XX.ABC..HNN"):
        motion = read_record(path, component=asked, units="gal")
        np.testing.assert_allclose(motion.values, [0.01, 0.02, -0.04], rtol=1e-12)
        assert (motion.format, motion.component) == ("MSEED", "HNN")


@pytest.mark.parametrize("format_name", ["SAC", "SACXY", "AH"])
@pytest.mark.parametrize("dt", [0.01, 1.0 / 128.0, 1.0 / 300.0])
def test_a_step_in_single_precision_keeps_its_digits(tmp_path: Path, dt: float, format_name: str) -> None:
    from obspy import Trace

    path = tmp_path / "step.sac"
    Trace(np.array([1.0, -2.0, 3.0], dtype=np.float32), {"delta": dt}).write(str(path), format=format_name)
    assert read_record(path, units="g").dt == pytest.approx(dt, rel=1e-15 if dt == 0.01 else 2e-7)
    assert read_record(path, units="g", dt=dt).values.tolist() == [1.0, -2.0, 3.0]


def test_miniseed_that_was_cut_is_refused(tmp_path: Path) -> None:
    from obspy import Stream, Trace

    path = tmp_path / "cut.mseed"
    values = np.random.default_rng(5).standard_normal(3000)
    long, short = (Stream([Trace(values, {"channel": name, "delta": 0.01})]) for name in ("HNE", "HNN"))
    long.write(str(path), format="MSEED", reclen=4096)
    whole = path.read_bytes()
    short.write(str(path), format="MSEED", reclen=512)
    mixed = whole + path.read_bytes()
    assert len(mixed) % 4096
    path.write_bytes(mixed)
    assert read_record(path, component="HNE", units="m/s2").values.tolist() == values.tolist()
    path.write_bytes(whole[: int(0.6 * len(whole))])
    refused(path, "the file ends inside a record of 4096 bytes", units="m/s2")


SERIES = "TIMESERIES XX_ABC__HN{}_D, {} samples, 100 sps, 2020-01-02T03:04:05.500000, {}, FLOAT, {}\n"
"""The head of a SLIST or TSPAIR file, as data centres write it: `_D` is a quality."""


def test_time_series_in_text_say_their_units(write) -> None:
    values = [1.5, -2.5, 3.0]
    as_list = SERIES.format("E", 3, "SLIST", "{}") + "1.5 -2.5\n3.0\n"
    as_pairs = SERIES.format("E", 3, "TSPAIR", "{}") + "".join(
        f"2020-01-02T03:04:05.{50 + i}0000 {value}\n" for i, value in enumerate(values)
    )
    for text, name in ((as_list, "a.slist"), (as_pairs, "a.tspair")):
        stated = write(text.format("M/S**2"), name)
        for motion in (read_record(stated), read_record(stated, units="m/s2")):
            assert (motion.values.tolist(), motion.dt, motion.units) == (values, 0.01, "m/s2")
            assert motion.begins == ("UTC", 1577934245.5)
        refused(stated, "the file says its units are m/s2, `units` says g", units="g")
        velocity = write(text.format("M/S"), name)
        refused(velocity, "the values are in 'M/S', not a unit of acceleration", units="m/s2")
        counts = write(text.format("Counts"), name)
        refused(counts, "does not state the units")
        assert read_record(counts, units="g").values.tolist() == values


def test_time_series_in_text_that_were_cut_are_refused(write) -> None:
    both = "".join(SERIES.format(place, 3, "SLIST", "M/S**2") + "1.5 -2.5\n3.0\n" for place in "EN")
    assert read_record(write(both, "two.slist"), component="HNN").values.tolist() == [1.5, -2.5, 3.0]
    cut = write(both.removesuffix("3.0\n"), "two.slist")
    refused(cut, "announces 3 values of XX.ABC..HNN and 2 follow", component="HNE")


@pytest.mark.parametrize("as_text", [False, True])
@pytest.mark.parametrize(
    ("header", "words"),
    [
        ({}, ""),
        ({"idep": "iunkn"}, ""),
        ({"idep": "ivolts"}, ""),
        ({"idep": "iacc"}, ""),
        ({"idep": "ivel"}, "says that this is a velocity"),
        ({"idep": "idisp"}, "says that this is a displacement"),
        ({"iftype": "irlim"}, "no series at equal time steps"),
        ({"iftype": "ixy"}, "no series at equal time steps"),
        ({"leven": False}, "no series at equal time steps"),
    ],
)
def test_sac_of_another_quantity_is_refused(
    tmp_path: Path, header: dict[str, object], words: str, as_text: bool
) -> None:
    from obspy.io.sac import SACTrace

    path = tmp_path / "one.sac"
    values = np.array([1.0, -2.0, 3.0], dtype=np.float32)
    SACTrace(**({"delta": 0.01, "data": values, "nzyear": 2020} | header)).write(str(path), ascii=as_text)
    if words:
        refused(path, words, units="m/s2")
    else:
        assert read_record(path, units="m/s2").values.tolist() == values.tolist()


def test_the_first_time_of_a_sac_file_without_a_date_is_no_time_of_day(tmp_path: Path) -> None:
    from obspy.io.sac import SACTrace

    path = tmp_path / "one.sac"
    values = np.array([1.0, -2.0, 3.0], dtype=np.float32)
    for first, begins in ((0.0, None), (12.5, ("column of times", 12.5)), (-1.5, ("column of times", -1.5))):
        SACTrace(delta=0.01, b=first, data=values).write(str(path))
        assert read_record(path, units="g").begins == begins
    SACTrace(delta=0.01, b=12.5, nzyear=2020, nzjday=3, data=values).write(str(path))
    assert read_record(path, units="g").begins == ("UTC", 1578009612.5)
    whole = path.read_bytes()
    path.write_bytes(whole.replace(np.float32(12.5).tobytes(), np.float32(-4e28).tobytes()))
    assert read_record(path, units="g").begins is None


def test_text_in_miniseed_is_no_record(tmp_path: Path) -> None:
    from obspy import Trace

    path = tmp_path / "log.mseed"
    log = Trace(np.frombuffer(b"gps locked", dtype="S1"), {"channel": "LOG", "station": "ABC", "network": "XX"})
    log.write(str(path), format="MSEED", encoding="ASCII", reclen=512)
    refused(path, "XX.ABC..LOG holds text", units="gal")
    text = path.read_bytes()
    log.stats.channel, log.data = "HNE", np.array([1.0, -2.0, 3.0])
    log.write(str(path), format="MSEED", reclen=512)
    path.write_bytes(text + path.read_bytes())
    assert components_of(path) == ["XX.ABC..HNE"]
    assert read_record(path, component="HNE", units="m/s2").values.tolist() == [1.0, -2.0, 3.0]


def test_a_piece_of_a_record_with_a_gap_is_told(tmp_path: Path) -> None:
    from obspy import Stream, Trace, UTCDateTime

    path = tmp_path / "gap.mseed"
    whole = Trace(np.arange(600.0), {"channel": "HNE", "station": "ABC", "network": "XX", "delta": 0.01})
    Stream([whole.slice(endtime=UTCDateTime(2)), whole.slice(starttime=UTCDateTime(3))]).write(str(path), "MSEED")
    refused(path, "0: XX.ABC..HNE (1), 1: XX.ABC..HNE (2)", component="HNE", units="gal")
    for asked in ("XX.ABC..HNE (2)", 1):
        motion = read_record(path, component=asked, units="m/s2")
        assert motion.values.tolist() == list(range(300, 600))
        assert "in 2 pieces, with gaps" in motion.warnings[0]
    whole.write(str(path), "MSEED")
    assert not any("pieces" in sentence for sentence in read_record(path, units="m/s2").warnings)


def test_a_station_is_its_code_in_every_format(tmp_path: Path) -> None:
    from obspy import Trace

    for format_name in ("AH", "SAC", "MSEED", "SLIST"):
        path = tmp_path / "one.record"
        values = np.array([1.0, -2.0, 3.0], dtype=np.float32)
        Trace(values, {"channel": "HNE", "station": "ABC", "delta": 0.01}).write(str(path), format=format_name)
        header = read_record(path, units="g").header
        assert header["station"] == "ABC"
        assert "AttribDict" not in str(header)


def test_blanks_in_a_first_line_take_no_time(write) -> None:
    """As the empty columns of a spreadsheet, or a file of no known format: a hundred tabs took a second, two hundred 30."""
    begin = time.process_time()
    for blanks in ("\t" * 400, " " * 4000, "\t " * 400):
        refused(write(f"time{blanks}x\n0{blanks}1\n"), "", units="g")
        head = f"time [s]{blanks},{blanks}acc [g]{blanks}\n" if "\t" not in blanks else f"time{blanks}acc [g]{blanks}\n"
        assert read_record(write(f"{head}0,1\n0.1,2\n0.2,3\n")).values.tolist() == [1.0, 2.0, 3.0]
    assert time.process_time() - begin < 2.0


def test_win_that_was_cut_is_refused(tmp_path: Path) -> None:
    """Two seconds of one channel at 4 Hz: a first value of four bytes, three differences of one byte each."""
    seconds = []
    for second, first in ((5, 100), (6, 120)):
        block = bytes([0x20, 0x03, 0x02, 0x01, 0x02, second, 0xA1, 0x00, 0x10, 4])
        block += first.to_bytes(4, "big") + bytes([5, 256 - 2, 10])
        seconds.append((len(block) + 4).to_bytes(4, "big") + block)
    path = tmp_path / "one.win"
    path.write_bytes(b"".join(seconds))
    motion = read_record(path, units="gal")
    np.testing.assert_allclose(motion.values, [1.0, 1.05, 1.03, 1.13, 1.2, 1.25, 1.23, 1.33], rtol=1e-15)
    assert (motion.format, motion.dt) == ("WIN", 0.25)
    path.write_bytes(b"".join(seconds)[:-2])
    refused(path, "ends inside a second", units="gal")


SETTINGS = {
    "RSN729_SUPER.B_B-IVW360_5col_no_header.acc": {"units": "g", "dt": 0.005},
    "BM68elc_5col_no_header.acc": {"units": "g", "dt": 0.01},
    "P695_SortedEQFile_120521_HECTOR_HEC000.txt": {"units": "g"},
    "P695_SortedEQFile_120522_HECTOR_HEC090.txt": {"units": "g"},
    "RSN811_LOMAP_WAH090_SF_0.271.txt": {"units": "g", "dt": 0.005},
    "LomaPrieta_HallsValley090_time_acc.dat": {"units": "m/s2"},
    "elcentro_NS_time_acc_ms2.dat": {"units": "m/s2"},
    "AKT013_1996_EW.knet": {},
    "CHB0031412312349.EW": {},
    "NGNH311106302345.EW2": {},
}


def test_other_real_files_match_their_index(shared_records: Path) -> None:
    with (shared_records / "INDEX.csv").open(newline="") as file:
        rows = {row["file"].removeprefix("other/"): row for row in csv.DictReader(file)}
    for name, settings in SETTINGS.items():
        motion = read_record(shared_records / "other" / name, **settings)  # type: ignore[arg-type]
        values = motion.values if motion.in_g else motion.values / 9.80665
        if motion.format == "KNET":  # raw counts with the instrument's offset; the index lists the peak without it
            assert "offset" in motion.warnings[0]
            values = values - values.mean()
        assert len(values) == int(rows[name]["npts"]), name
        assert float(np.abs(values).max()) == pytest.approx(float(rows[name]["pga_g"]), rel=5e-4, abs=5.1e-6), name
        if rows[name]["dt_s"] and "dt" not in settings:
            assert motion.dt == float(rows[name]["dt_s"]), name


def test_other_real_files_are_read_or_refused_for_what_they_do_not_say(shared_records: Path) -> None:
    """Those of agencies are in test_agencies.py; what is left does not state its units, or its time step."""
    refusals = 0
    for path in sorted((shared_records / "other").iterdir()):
        if format_of(path.read_bytes()) is None and path.suffix not in (".knet", ".EW", ".EW2"):
            with pytest.raises(RecordError, match=r"do not state their units|state neither units nor time step"):
                read_record(path)
            refusals += 1
    assert refusals == 10


@pytest.mark.parametrize("device", ["/dev/null", "/dev/zero"])
def test_a_device_is_no_record(device: str) -> None:
    with pytest.raises(RecordError, match="device"):
        read_record(device)


@pytest.mark.parametrize(
    ("values", "dt", "words"),
    [
        ("0\n1e200\n0\n", 0.01, "too large to be an acceleration"),
        ("0\n1\n0\n", 1e300, "expected seconds between"),
        ("0\n1\n0\n", 1e-300, "expected seconds between"),
    ],
)
def test_numbers_that_no_instrument_gives(tmp_path: Path, values: str, dt: float, words: str) -> None:
    path = tmp_path / "record.txt"
    path.write_text(values)
    with pytest.raises(RecordError, match=words):
        read_record(path, units="g", dt=dt)


@pytest.mark.parametrize("spoiled", [None, "  .1-.2", " 1.5D-03", " 2.5-103", " 100-200", " tail of text"])
def test_numbers_are_those_printed_whether_read_at_once_or_line_by_line(spoiled: str | None) -> None:
    printed = [f"{x:15.7E}" for x in np.random.default_rng(3).normal(size=23)] + ["  .5", " -3e2", "+7."]
    lines = ["".join(printed[i : i + 5]) for i in range(0, len(printed), 5)] + ["", "\t1.25  -0.0\r"]
    wanted = [float(word) for word in printed] + [1.25, -0.0]
    if spoiled is not None:
        lines.append(spoiled)
        of_it = {"  .1-.2": [0.1, -0.2], " 1.5D-03": [1.5e-3], " 2.5-103": [2.5e-103], " 100-200": [100.0, -200.0]}
        wanted += of_it.get(spoiled, [])
    found = read_numbers(lines, 1, "file", expected=len(wanted))
    assert found.values.tolist() == wanted
    assert found.per_line.sum() == len(wanted) == len(found.tokens)
    assert found.text_after == (("tail of text",) if spoiled == " tail of text" else ())


HEADED = "time [s],acceleration [m/s2]\n" + "".join(f"{0.01 * k:.2f},{0.1 * (-1) ** k}\n" for k in range(50))


def columns(tmp_path, text: str | bytes):
    path = tmp_path / "r.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_record(path)


def test_a_spreadsheet_s_mark_before_the_head_is_no_part_of_it(tmp_path):
    plain, marked = (columns(tmp_path, mark + HEADED.encode()) for mark in (b"", b"\xef\xbb\xbf"))
    np.testing.assert_array_equal(plain.values, marked.values)
    assert (marked.dt, marked.units, len(marked.values)) == (0.01, "m/s2", 50)


def test_time_may_begin_anywhere_where_the_head_names_it(tmp_path):
    shifted = HEADED.replace("\n0.", "\n5.")
    found = columns(tmp_path, shifted)
    assert (found.dt, len(found.values)) == (0.01, 50)
    assert "time counted from the first sample, 5 s in the file" in found.processing
    with pytest.raises(RecordError, match=r"grows in equal steps from 5, not from zero: if it is time, say so"):
        columns(tmp_path, shifted.split("\n", 1)[1])


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        ("0.20,0.1\n", "0.20,abc\n", 22, r"'abc' is not a number"),
        ("0.20,0.1\n", "0.20,nan\n", 22, r"nan"),
        ("0.20,0.1\n", "", 22, r"time goes from 0.19 to 0.21 s here, in other steps by 0.01 s"),
        ("0.20,0.1\n", "0.10,0.1\n", 22, r"time goes from 0.19 to 0.1 s"),
        ("0.20,0.1\n", "0.20;0.1\n", 22, r"a semicolon stands here"),
        ("0.20,0.1\n", "0.20,\n", 22, r"numbers on this line: 1, on those before: 2"),
        ("0.20,0.1\n", "0.20,0.1,0.3\n", 22, r"numbers on this line: 3, on those before: 2"),
    ],
)
def test_what_is_wrong_with_a_named_column_is_told_with_its_line(tmp_path, old, new, line, said):
    assert old in HEADED
    with pytest.raises(RecordError, match=said) as error:
        columns(tmp_path, HEADED.replace(old, new))
    assert error.value.line == line


@pytest.mark.parametrize(
    ("dt", "count", "printed", "wanted", "within"),
    [
        (1 / 120, 300, "{!r}", 1 / 120, 1e-15),
        (1 / 3, 101, "{!r}", 1 / 3, 1e-15),
        (1 / 256, 500, "{!r}", 1 / 256, 0.0),
        (1 / 300, 1000, "{:.5f}", 1 / 300, 5e-6),
        (0.01, 1000, "{!r}", 0.01, 0.0),
        (0.01, 1000, "{:.2f}", 0.01, 0.0),
        (0.0125, 1000, "{:.4f}", 0.0125, 0.0),
    ],
)
def test_the_time_step_is_that_of_the_column_of_times(tmp_path, dt, count, printed, wanted, within):
    rows = "".join(f"{printed.format(k * dt)},{k % 7}\n" for k in range(count))
    assert columns(tmp_path, "time [s],acceleration [m/s2]\n" + rows).dt == pytest.approx(wanted, rel=within, abs=0.0)


def test_time_that_runs_backwards_is_told_where_it_begins_to(tmp_path):
    head, *rows = HEADED.splitlines(keepends=True)
    with pytest.raises(RecordError, match=r"time goes from 0.49 to 0.48 s here: write samples in order") as error:
        columns(tmp_path, head + "".join(reversed(rows)))
    assert error.value.line == 3


def test_semicolons_and_decimal_commas_are_told_under_any_head(write):
    rows = "".join(f"0,{i:02d};0,{i % 7}\n" for i in range(40))
    for head in ("Zeit [s];Beschleunigung [m/s2]\n", "time [s];acceleration [m/s2]\n", "\ufeffrecord 1\n\n"):
        with pytest.raises(RecordError, match=r"a semicolon stands here; write .* `time \[s\],acceleration") as caught:
            read_record(write((head + rows).encode()))
        assert caught.value.line == 1 + head.count("\n")
    column = "".join(f"-0,{i % 7}\n" for i in range(40)).encode()
    refused(write(column), "write decimals with a point", units="g", dt=0.01)


@pytest.mark.parametrize("head", ["", "time,acceleration\n"])
def test_commas_before_decimals_and_between_columns_are_told(write, head):
    rows = "".join(f"0,{i:02d},0,{i * i % 97:04d}\n" for i in range(40))
    file = write((head + rows).encode())
    with pytest.raises(RecordError, match=r"0,00,0,0000: write decimals with a point") as caught:
        read_record(file, units="g", dt=0.01)
    assert caught.value.line == 1 + head.count("\n")
    counts = "".join(f"{i * i % 97},{i % 5},{-i},12\n" for i in range(40)).encode()
    assert read_record(write(counts), units="g", dt=0.01).processing[0] == "values read line by line, 4 on each"


def test_a_head_without_numbers(tmp_path):
    with pytest.raises(RecordError, match="no number follows"):
        columns(tmp_path, HEADED.split("\n")[0] + "\n")


def test_steps_that_grow_little_by_little_are_no_equal_steps(tmp_path):
    """None differs from its neighbours by more than digits may, and all together by a tenth."""
    times = np.concatenate([[0.0], np.cumsum(np.linspace(0.0095, 0.0105, 60))])
    text = "time [s],acceleration [m/s2]\n" + "".join(f"{t:.8f},0.1\n" for t in times)
    with pytest.raises(RecordError, match="equal steps of time"):
        columns(tmp_path, text)
