"""The AT2 reader: every dialect met, every refusal with file, line and remedy."""

from __future__ import annotations

import csv
import importlib.metadata
import io
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rockcli.errors import RecordError
from rockcli.motion.at2 import at2_text, is_at2, parse_at2, read_at2

TITLE = "PEER NGA STRONG MOTION DATABASE RECORD\nLoma Prieta, 10/18/1989, WAHO, 090\n"
IN_G = "ACCELERATION TIME SERIES IN UNITS OF G\n"
VALUES = "  -.1000000E-02   .2500000E+00  -.3000000E+00   .4000000E-03   .5000000E-03\n   .6000000E-03   .7000000E-03\n"
EXPECTED = [-0.001, 0.25, -0.3, 0.0004, 0.0005, 0.0006, 0.0007]
GOOD = TITLE + IN_G + "NPTS=      7, DT=   .0050 SEC,\n" + VALUES

COUNT_LINES = [
    "NPTS=      7, DT=   .0050 SEC,",
    "NPTS=      7  DT=   .0050 SEC,   ",
    "NPTS=      7, DT=   .0050 SEC,   0 POLE @    30.00000 HZ,  -5 POLE @      .05000 HZ, ACAUSAL",
    "NPTS=      7, DT=   .0050 SEC,   0 POLE @    30.00000",
    "NPTS=  7, DT= .00500 SEC",
    "NPTS=   7, dt=  .0050",
    "npts = 7, dt = 5.0E-3",
    "NPTS= 7,\tDT=\t0.0050\tSEC",
    "NPTS=  7, DT=  0.00500 SEC",
    "NPTS=  7, DT= 5.0D-3 SEC",
    "NPTS=  7, DT= .0050 .0050 SEC",
    "NPTS=  7, DT= .0050 SEC, UNITS: G, NPTS= 7",
    "7    0.0050    NPTS, DT",
    "7 0.0050 NPTS, DT ",
]


def parse(text: str) -> np.ndarray:
    return parse_at2(text.encode(), "record.AT2").values


@pytest.mark.parametrize("line", COUNT_LINES)
def test_every_form_of_the_count_line(line: str) -> None:
    record = parse_at2((TITLE + IN_G + line + "\n" + VALUES).encode(), "record.AT2")
    assert record.dt == 0.005
    assert record.values.tolist() == EXPECTED
    assert record.units == "g"
    assert record.warnings == ()


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r\r\n", "\r"])
def test_every_line_end(end: str) -> None:
    assert parse(GOOD.replace("\n", end)).tolist() == EXPECTED
    assert parse(GOOD.rstrip("\n").replace("\n", end) + "   ").tolist() == EXPECTED


def test_a_mark_of_an_editor_is_no_part_of_the_first_line(write) -> None:
    marked = parse_at2(b"\xef\xbb\xbf" + GOOD.encode(), "record.AT2")
    assert marked.titles == parse_at2(GOOD.encode(), "record.AT2").titles
    (trace,) = read_at2(write("\ufeff7 0.0050 NPTS, DT, UNITS: G\n" + VALUES))
    assert trace.data.tolist() == EXPECTED
    assert is_at2(write("\ufeff7 0.0050 NPTS, DT, UNITS: G\n" + VALUES))


@pytest.mark.parametrize("per_line", [1, 2, 5, 6, 7, 8])
def test_any_number_of_values_per_line(per_line: int) -> None:
    words = VALUES.split()
    rows = [" ".join(words[i : i + per_line]) for i in range(0, len(words), per_line)]
    assert parse(GOOD.replace(VALUES, "\n".join(rows) + "   \n\n")).tolist() == EXPECTED


def test_fortran_numbers() -> None:
    values = " 1.0D-3-2.5D-01 3.0d+00\n-.4000000E-03-.5000000E-03 0.6-103\n 7.\n"
    expected = [1e-3, -0.25, 3.0, -4e-4, -5e-4, 0.6e-103, 7.0]
    assert parse(GOOD.replace(VALUES, values)).tolist() == expected


def test_header_of_seven_lines_and_units_in_words() -> None:
    rotated = "Orig PEER filename = X.acc, Scale factor = 2.4\n H1\n H2\n rotation angle -37.0\n FN component\n"
    assert parse(rotated + "  Acceleration in g\n7 0.0050 NPTS, DT \n" + VALUES).tolist() == EXPECTED
    assert parse("El Centro\n7 points\nThe units are (g)\nNPTS=  7, DT= .02000 SEC\n" + VALUES).tolist() == EXPECTED


def test_text_and_zeros_behind_the_values_are_told() -> None:
    footer = parse_at2((GOOD + "\n*** End of 7 Data ***\n").encode(), "record.AT2")
    assert footer.values.tolist() == EXPECTED
    assert "End of 7 Data" in footer.warnings[0]
    padded = parse_at2((GOOD.rstrip() + "  .0  0.0\n").encode(), "record.AT2")
    assert padded.values.tolist() == EXPECTED
    assert "2 zero(s)" in padded.warnings[0]


@pytest.mark.parametrize(
    ("line", "identity"),
    [
        (
            "Loma Prieta, 10/18/1989, Gilroy - Gavilan Coll., 67",
            ("Loma Prieta", "10/18/1989", "Gilroy - Gavilan Coll.", "67"),
        ),
        (
            "IMPERIAL VALLEY 5/19/40 0439, EL CENTRO ARRAY #9, 180 (USGS STATION 117)",
            ("IMPERIAL VALLEY", "5/19/40", "EL CENTRO ARRAY #9", "180"),
        ),
        ("FRIULI, ITALY 05/06/76 2000, TOLMEZZO, 000", ("FRIULI, ITALY", "05/06/76", "TOLMEZZO", "000")),
        ("RSN1044, Clockwise rot. 68.7962 deg.", ("", "", "", "")),
    ],
)
def test_identity(line: str, identity: tuple[str, ...]) -> None:
    text = GOOD.replace("Loma Prieta, 10/18/1989, WAHO, 090", line)
    record = parse_at2(text.encode(), "record.AT2")
    assert (record.event, record.date, record.station, record.component) == identity


REFUSED = {
    "fewer values": (GOOD.replace(".7000000E-03", ""), 7, "only 6 follow"),
    "cut inside a number": (GOOD[:-30], 6, "only"),
    "cut inside the last number": (GOOD.rstrip()[:-1], 6, "cut"),
    "cut at the last exponent": (GOOD.rstrip()[:-4], 6, "cut"),
    "no values": (GOOD.replace(VALUES, "\n\n"), None, "none follows"),
    "more values": (GOOD + ".1\n", None, "8 follow"),
    "a second record": (GOOD + "next\n.1 .2\n", 7, "continue on line 8"),
    "a word": (GOOD.replace(".2500000E+00", ".25x"), 5, "'.25x' is not a number"),
    "not a number": (GOOD.replace(".2500000E+00", "NaN"), 5, "'NaN' is not a number"),
    "overflowed field": (GOOD.replace(".2500000E+00", "*******"), 5, "not a number"),
    "underscore": (GOOD.replace(".2500000E+00", "1_0"), 5, "not a number"),
    "infinite": (GOOD.replace(".2500000E+00", "1E999"), 5, "too large"),
    "displacement": (GOOD.replace(IN_G, "DISPLACEMENT TIME SERIES IN UNITS OF CM\n"), 3, "displacement record"),
    "velocity": (GOOD.replace(IN_G, "VELOCITY TIME HISTORY IN UNITS OF CM/S. FILTER\n"), 3, "velocity record"),
    "no units": (GOOD.replace(IN_G, "\n"), 4, "`units:`"),
    "unknown units": (GOOD.replace("OF G", "OF COUNTS"), 3, "'COUNTS'"),
    "no count": (GOOD.replace("NPTS=      7, DT=   .0050 SEC,", ""), None, "NPTS="),
    "no dt": (GOOD.replace(".0050 SEC,", ""), 4, "DT is"),
    "negative dt": (GOOD.replace(" .0050", "-.0050"), 4, "above zero"),
    "zero dt": (GOOD.replace(".0050", ".0000"), 4, "above zero"),
    "a fraction": (GOOD.replace(".0050 SEC", "1/200 SEC"), 4, "DT is '1/200'"),
    "no letter of the exponent": (GOOD.replace(".0050 SEC", "5.0-003 SEC"), 4, "DT is '5.0-003'"),
    "two points": (GOOD.replace(".0050 SEC", "0.005.0 SEC"), 4, "DT is '0.005.0'"),
    "a rate": (GOOD.replace(".0050 SEC", "200 HZ"), 4, "DT is a rate, in Hz"),
    "milliseconds": (GOOD.replace(".0050 SEC", "5.0 MSEC"), 4, "milliseconds"),
    "negative count": (GOOD.replace("      7", "     -7"), 4, "NPTS is '-7'"),
    "one value": (GOOD.replace("      7", "      1"), 4, "two or more"),
    "a second dt": (GOOD.replace("SEC,", "SEC, DT= .01 SEC"), 4, "DT is 0.005, and .01 on the same line"),
    "a second dt without a name": (GOOD.replace(".0050", ".0050 .0100"), 4, "DT is 0.005, and .0100"),
    "a second count": (GOOD.replace("SEC,", "SEC, NPTS= 5"), 4, "NPTS is 7, and 5 on the same line"),
    "a second count without a name": (GOOD.replace(" 7, DT", " 7, 5, DT"), 4, "NPTS is 7, and 5 on the same line"),
    "a second unit": (GOOD.replace("SEC,", "SEC, UNITS: CM/S2"), 4, "in g, and in cm/s2 here"),
    "a second unit without a name": (GOOD.replace("SEC,", "SEC, cm/s/s"), 4, "in g, and in cm/s2 here"),
    "a second unit above": (GOOD.replace(IN_G, "Units: gal\n" + IN_G), 4, "in gal, and in g here"),
    "pairs": (GOOD.replace("      7", "      8").replace(VALUES, "0 .1\n.005 -.2\n.01 .3\n.015 .2\n"), 5, "is a time"),
    "empty": ("", None, "empty"),
    "blank": (" \n\n", None, "empty"),
    "binary": ("\0\1" + GOOD, None, "binary"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refusals_name_line_and_reason(case: str) -> None:
    text, line, words = REFUSED[case]
    with pytest.raises(RecordError) as caught:
        parse(text)
    assert words in caught.value.message
    assert caught.value.file == "record.AT2"
    assert caught.value.line == line


def test_units_from_outside() -> None:
    unstated = GOOD.replace(IN_G, "\n").encode()
    assert parse_at2(unstated, "record.AT2", "cm/s2").units == "cm/s2"
    with pytest.raises(RecordError, match="leave it out"):
        parse_at2(GOOD.encode(), "record.AT2", "cm/s2")
    stated = GOOD.replace("OF G", "OF CM/SEC**2").encode()
    assert parse_at2(stated, "record.AT2").units == "cm/s2"
    assert parse_at2(stated, "record.AT2", "gal").units == "cm/s2"


def test_is_at2_claims_its_own_only(write) -> None:
    assert is_at2(write(GOOD))
    assert is_at2(str(write(GOOD)))
    assert is_at2(io.BytesIO(GOOD.encode()))
    assert is_at2(write(REFUSED["displacement"][0]))
    assert is_at2(write(REFUSED["no count"][0]))
    for other in (
        b"",
        b"\0\0\0NPTS= 3, DT= .1",
        b"Origin Time       1996/08/11",
        b"TIMESERIES BW_, 3 samples\n1\n2\n3\n",
    ):
        assert not is_at2(write(other))
    assert not is_at2("/no/such/file")
    assert not is_at2("/")
    assert not is_at2(None)
    assert not is_at2(io.StringIO("NPTS= 3, DT= .1"))


def test_stream(write) -> None:
    stream = read_at2(write(GOOD))
    trace = stream[0]
    assert len(stream) == 1
    assert trace.data.dtype == np.float64
    assert trace.data.tolist() == EXPECTED
    assert trace.stats.delta == 0.005
    assert (trace.stats.station, trace.stats.channel) == ("WAHO", "090")
    assert trace.stats.at2.units == "g"
    assert trace.stats.at2.title[0].startswith("PEER")
    assert read_at2(write(GOOD), headonly=True)[0].stats.npts == 7
    assert read_at2(io.BytesIO(GOOD.encode()))[0].data.tolist() == EXPECTED
    with pytest.raises(RecordError, match="not in g"):
        read_at2(write(GOOD.replace("OF G", "OF CM/S/S")))
    with pytest.raises(RecordError, match="this is a folder"):
        read_at2("/")


def installed() -> bool:
    return bool(importlib.metadata.entry_points(group="obspy.plugin.waveform", name="AT2"))


@pytest.mark.skipif(not installed(), reason="the package is not installed, so ObsPy cannot find its plug-in")
def test_obspy_reads_at2_and_passes_the_refusal_on(write) -> None:
    import obspy

    trace = obspy.read(str(write(GOOD)))[0]
    assert trace.stats._format == "AT2"
    assert trace.data.tolist() == EXPECTED
    with pytest.raises(RecordError, match="displacement record"):
        obspy.read(str(write(REFUSED["displacement"][0])))


def test_import_is_light() -> None:
    modules = "rockcli.motion.at2, rockcli.motion.reading, rockcli.motion.processing, rockcli.motion.measures"
    code = f"import sys, {modules}; print([name for name in ('obspy', 'scipy') if name in sys.modules])"
    root = str(Path(__file__).parents[2])
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=root)
    assert done.stdout.strip() == "[]"


def test_what_is_written_is_read_back() -> None:
    values = np.random.default_rng(1).standard_normal(1003) * 0.1
    text = at2_text(values, 1.0 / 150.0, ["Title", "Event, 1/1/2001, Station, 090"])
    record = parse_at2(text.encode(), "written.AT2")
    assert record.dt == 1.0 / 150.0
    assert record.component == "090"
    np.testing.assert_allclose(record.values, values, rtol=5.1e-8, atol=0.0)


@pytest.mark.parametrize("title", ["NPTS= 3, DT= .1", "ACCELERATION IN UNITS OF CM", "two\nlines"])
def test_titles_that_would_be_misread_are_refused(title: str) -> None:
    with pytest.raises(RecordError, match="title"):
        at2_text([0.1, 0.2], 0.01, [title])
    with pytest.raises(RecordError, match="finite"):
        at2_text([0.1, np.nan], 0.01, ["Title"])


def index(folder: Path) -> list[dict[str, str]]:
    with (folder / "INDEX.csv").open(newline="") as file:
        return [row for row in csv.DictReader(file) if row["file"].startswith(("peer/", "derived/"))]


def test_all_real_records_match_their_index(shared_records: Path) -> None:
    rows = index(shared_records)
    assert len(rows) > 150
    for row in rows:
        record = parse_at2((shared_records / row["file"]).read_bytes(), row["file"])
        pga = np.abs(record.values).max()
        assert len(record.values) == int(row["npts"]), row["file"]
        assert record.dt == float(row["dt_s"]), row["file"]
        digits = f"{pga:.3e}" if "e" in row["pga_g"] else f"{pga:.5f}"
        assert float(digits) == float(row["pga_g"]), row["file"]
        assert record.warnings == (), row["file"]
        assert is_at2(shared_records / row["file"]), row["file"]
        if record.component.isdigit() and row["component"].isdigit():
            assert int(record.component) == int(row["component"]), row["file"]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("HECTOR_HEC000_cut_inside_number.AT2", "4531 values and only 1621"),
        ("HECTOR_HEC090_cut_short.AT2", "4531 values and only 275"),
        ("LA3536PPhor.AT2", "units"),
        ("arti_1_1g_no_data.AT2", "none follows"),
        ("IELC180_no_header.acc", "no header line"),
        ("DIAM_quoted_header.ACC", "no header line"),
        ("IELC180_displacement.DT2", "displacement record"),
        ("RSN1063_NORTHR_RRS228_displacement.DT2", "displacement record"),
    ],
)
def test_malformed_real_files_are_refused(shared_records: Path, name: str, words: str) -> None:
    with pytest.raises(RecordError) as caught:
        parse_at2((shared_records / "malformed" / name).read_bytes(), name)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("name", "npts", "words"),
    [
        ("RSN960_NORTHR_LOS270_one_value_too_many.AT2", 1999, "zero"),
        ("elCentro_peknold_footer.at2", 1559, "End Data"),
    ],
)
def test_tolerated_real_files_are_flagged(shared_records: Path, name: str, npts: int, words: str) -> None:
    record = parse_at2((shared_records / "malformed" / name).read_bytes(), name)
    assert len(record.values) == npts
    assert words in record.warnings[0]
