"""Formats of agencies: tiny files made by hand, and the real ones where they are; PGA as the header states it."""

from __future__ import annotations

import csv
import tomllib
from collections.abc import Callable
from datetime import UTC, datetime
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from rockcli.errors import RecordError
from rockcli.motion.agencies import plugins
from rockcli.motion.agencies.csmip import CSMIP
from rockcli.motion.agencies.formats import FORMATS, channels_of, format_of
from rockcli.motion.agencies.geonet import GEONET
from rockcli.motion.agencies.smc import SMC
from rockcli.motion.direction import in_direction
from rockcli.motion.reading import components_of, read_record
from rockcli.motion.units import FACTORS

ROOT = Path(__file__).parents[2]
VALUES = [0.0, 1.5, -12.25, 3.0, -123.5, 20.0, 4.0, -5.0, 60.5, 0.5, -0.25, 2.0]
"""cm/s2; the largest is the fifth."""


def rows(values: list[float], width: int, per_line: int, digits: int = 3) -> str:
    """Fixed columns without blanks between, as the programs of agencies print them."""
    words = [f"{value:{width}.{digits}f}" for value in values]
    return "".join("".join(words[i : i + per_line]) + "\n" for i in range(0, len(words), per_line))


def cosmos(
    values: list[float] = VALUES, dt: float = 0.01, kind: str = "acceleration", units: str = "cm/sec2(04)"
) -> str:
    reals = [-999.0] * 100
    reals[33], reals[61], reals[63] = (
        0.5 * dt,
        1000.0 * dt,
        min(values, key=lambda x: -abs(x)),
    )  # 33 is the raw record's
    text = ["Corrected acceleration    (Format v01.20 with 13 text lines)", "Record of a test", "", "",
            "Statn No: 01-00001  Code:CE-T1", "", "", "", "Sta Chan  1: 340 deg (Rcrdr Chan  1) Location: roof",
            "", "", "", "Values used when parameter or data value is unknown/unspecified:   -999, -999.0"]  # fmt: skip
    integers = " 100 Integer-header values follow on  10 lines, Format= (10I8)\n" + ("    -999" * 10 + "\n") * 10
    header = " 100 Real-header values follow on  20 lines, Format= (5F15.6)\n" + rows(reals, 15, 5, 6)
    comments = '  1 Comment line(s) follow, each starting with a "|":\n| none\n'
    said = f"{len(values):8d} {kind} pts, approx  0.1 secs, units={units},Format=(8F10.3)\n"
    end = "End-of-data for Chan  1 acceleration\n"
    return "\n".join(text) + "\n" + integers + header + comments + said + rows(values, 10, 8) + end


def csmip_v2(values: list[float] = VALUES) -> str:
    one = ""
    for number, place in ((1, "90 DEG"), (2, "UP")):
        said = "".join(
            f"{len(values):5d} POINTS OF {what} DATA EQUALLY SPACED AT  .010 SEC.  (UNITS: {unit})\n{rows(values, 10, 8)}"
            for what, unit in (("ACCEL", "CM/SEC/SEC"), ("VELOC", "CM/SEC"), ("DISPL", "CM"))
        )
        one += (
            f"CORRECTED ACCELEROGRAM   00001-T1       CHAN  {number}: {place}\n"
            "UNCORRECTED ACCELEROGRAM DATA              PROCESSED:\nTEST EARTHQUAKE\n1 JAN 2000\n00001\n"
            f"STATION NO. 00001   35.9N, 120.4W\nA PLACE\nCHAN  {number}: {place}\n"
            f"PEAK ACCELERATION =  -123.500    CM/SEC/SEC  AT     .040   SEC.\n{rows([0.0] * 16, 10, 8)}{said}"
            f"/&  ----------  END OF DATA FOR CHANNEL  {number}  ----------\n"
        )
    return one


def csmip_v2_newer() -> str:
    text = csmip_v2().replace("STATION NO. 00001", "Station Id. T1").replace(" POINTS OF ACCEL", " points of accel")
    return text.replace("SEC.  (UNITS: CM/SEC/SEC)", "sec, in cm/sec2. (8f10.3)").replace(
        "(UNITS: CM/SEC)", "in cm/sec."
    )


def csmip_v1(values: list[float] = VALUES) -> str:
    in_g = [value / 1000.0 for value in values]
    return (
        "Uncorrected Accelerogram Data             Processed: 01/01/00, CGS\nRecord of a test\n\n\n"
        "Station No. 00001   40.9N\nA place\nChan  1: 360 Deg\n"
        "Units of uncor data are sec and g .        Max  =  -.1235 g , at   .020 sec.\n"
        f" {len(values)} Accelerogram points at 200 pts/sec in units of g .      Format: (8f9.6)\n"
        f"{rows(in_g, 9, 8, 6)}/&  ----------  End of Data for Channel  1  ----------\n"
    )


UNKNOWN = -32768


def smc(
    values: list[float] = VALUES, kind: str = "2 CORRECTED ACCELEROGRAM", start: tuple[int, ...] = (UNKNOWN,) * 6
) -> str:
    integers, reals = [UNKNOWN] * 48, [1.7e38] * 50
    integers[1:7] = start
    integers[15], integers[16] = 1, len(values)
    reals[1], reals[28], reals[29], reals[30], reals[31] = 200.0, 0.04, 60.5, 0.02, -123.5
    text = [kind, "*", "T1", "     2000  01  01    0000 A test", "*", "station = A place   component=    360",
            "*", "*", "*", "*", "*"]  # fmt: skip
    numbers = "".join("".join(f"{i:10d}" for i in integers[k : k + 8]) + "\n" for k in range(0, 48, 8))
    numbers += "".join("".join(f"{x:15.7E}" for x in reals[k : k + 5]) + "\n" for k in range(0, 50, 5))
    # one digit in the exponent, and no blank before a sign
    printed = [f"{x:.4E}".replace("E+0", "E+").replace("E-0", "E-").rjust(10) for x in values]
    body = "".join("".join(printed[k : k + 8]) + "\n" for k in range(0, len(printed), 8))
    return "\n".join(text) + "\n" + numbers + "| made by hand\n" + body


def geonet(values: list[float] = VALUES, corrected: bool = True, start: str = "", prepended: int = 0) -> str:
    integers = [1] * 40
    integers[31] = prepended
    for place, said in zip((8, 9, 18, 19, 38, 39), (start or "0 0 0 0 0 0").split(), strict=True):
        integers[place] = int(said)
    header = rows([float(one) for one in integers], 8, 10, 0) + rows([1.0] * 60, 8, 10, 1)
    one = ""
    for place in ("S16W", "Up"):
        text = [
            f"{'Corrected' if corrected else 'Uncorrected'} accelerogram 20000101_000000_TEST_20 GNS Science",
            "Site TEST      39 56 38S  176 35 04E", "A place", "Instrument", "Resolution", "Accelerogram", "6 km south",
            "2000 January 01", "Epicentre", f"Number of points  {len(values)}    Duration 0.22 sec",
            "Instrument corrected data at 0.020 sec intervals" if corrected
            else "Raw readings in units of 2.00 mm/s/s  at intervals of 0.005 s",
            "Band-pass filter", f"Component {place}  Longitudinal",
            f"Acceleration:  peak   {-1235.0 if corrected else -2470.0:.1f} mm/s/s at  0.08 sec", "Velocity:", "Displacement:",
        ]  # fmt: skip
        series = [10.0 * value for value in values]
        body = "".join(rows(series, 8, 10, 1) for _ in range(3 if corrected else 1))
        one += "\n".join(text) + "\n" + header + body
    return one


def esm(values: list[float] = VALUES, kind: str = "ACCELERATION", count: int | None = None) -> str:
    pairs = {"EVENT_NAME": "A TEST", "EVENT_ID": "1", "MAGNITUDE_W": "6.1", "STATION_CODE": "T1", "STATION_NAME": "",
             "VS30_M/S": "294", "SAMPLING_INTERVAL_S": "0.005000", "NDATA": str(count or len(values)), "STREAM": "HNE",
             "UNITS": "cm/s^2", "PGA_CM/S^2": "-123.5", "DATA_TYPE": kind, "USER5": ""}  # fmt: skip
    return "".join(f"{key}: {value}\n" for key, value in pairs.items()) + "".join(f"{value:.6f}\n" for value in values)


def resorce(values: list[float] = VALUES) -> str:
    body = "".join(f"{0.01 * value:14.7E}" + ("\n" if i % 5 == 4 else "") for i, value in enumerate(values))
    return (
        "Event Date & Time             : 2000-01-01 01:32:39\nStation Code / Name           : T1 / A place\n"
        "Orientation                   : NS\nTime Increment (s)            : 0.005\n"
        f"Number of Data                : {len(values)}\nPGA (m/s/s)                   : 1.2350000E+00\n"
        f"Accelaration time series in m/s/s\n{body}\n"
    )


def csmnc(values: list[float] = VALUES) -> str:
    return (
        "000T1000101000000\n0000\nA TEST\nEPICENTER\nMAGNITUDE\nSTATION: T1 28.9N\nSITE\nINSTRUMENT\nOBSERVING\n"
        "COMP. EW\nUNCORRECTED ACCELERATION          UNIT: CM/SEC/SEC\n"
        f"NO. OF POINTS:  {len(values)}  EQUALLY SPACED INTERVALS OF:  0.005  SEC\n"
        f"PEAK VALUE:    -123.5   AT   0.02 SEC    DURATION:  0.06 SEC\nPRE-EVENT TIME:  0  SEC\nCSMNC\n\n{rows(values, 12, 8)}"
    )


def cwb(values: list[float] = VALUES) -> str:
    body = "".join(f"{0.02 * i:10.3f}{value:10.3f}{-value:10.3f}\n" for i, value in enumerate(values))
    return (
        "#Earthquake Information\n\n#StationCode: T1\n#SampleRate(Hz): 50\n#AmplitudeUnit:  gal. DCoffset(corr)\n"
        "#AmplitudeMAX. U:    60.5~   -123.5\n#AmplitudeMAX. N:   123.5~   -60.5\n"
        f"#DataSequence: Time U(+); N(+)\n#Data: 3F10.3\n{body}"
    )


MADE = {
    "COSMOS": (cosmos(), None, 0.01, "m/s2", "340"),
    "CSMIP": (csmip_v2(), "90", 0.01, "m/s2", "90"),
    "CSMIP newer": (csmip_v2_newer(), "90", 0.01, "m/s2", "90"),
    "CSMIP volume 1": (csmip_v1(), None, 0.005, "g", "360"),
    "SMC": (smc(), None, 0.005, "m/s2", "360"),
    "GEONET": (geonet(), "S16W", 0.02, "m/s2", "S16W"),
    "GEONET as recorded": (geonet(corrected=False), 1, 0.005, "m/s2", "Up"),
    "ESM": (esm(), None, 0.005, "m/s2", "HNE"),
    "RESORCE": (resorce(), "NS", 0.005, "m/s2", "NS"),
    "CSMNC": (csmnc(), None, 0.005, "m/s2", "EW"),
    "CWB": (cwb(), "U", 0.02, "m/s2", "U"),
}


@pytest.mark.parametrize("name", MADE)
@pytest.mark.parametrize(("line_end", "mark"), [("\n", ""), ("\r\n", "\ufeff")])
def test_a_file_made_by_hand_is_read(tmp_path: Path, name: str, line_end: str, mark: str) -> None:
    text, component, dt, units, found = MADE[name]
    path = tmp_path / "record.txt"
    path.write_bytes((mark + text.replace("\n", line_end)).encode())
    motion = read_record(path, component=component)
    factor = {"g": 1e-3, "m/s2": 1e-2}[units] * (2.0 if "recorded" in name else 1.0)
    np.testing.assert_allclose(motion.values, np.array(VALUES) * factor, rtol=1e-4, atol=1e-9)
    assert (motion.dt, motion.units, motion.component) == (dt, units, found)
    assert motion.format == name.split()[0]
    assert not any("header says" in said for said in motion.warnings)
    one = format_of(path.read_bytes())
    assert one is not None
    for channel in channels_of(path.read_bytes(), one, "record"):
        assert channel.peak == pytest.approx(np.abs(channel.values).max(), rel=1e-2)


STARTS = [
    (esm, "UNITS:", "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS: 20180206_155029.{}\nUNITS:"),
    (esm, "UNITS:", "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS: 06/02/2018 15:50:29.{}00\nUNITS:"),
    (cwb, "#SampleRate", "#StartTime(GMT+08): 2018/02/06-23:50:29.{}\n#SampleRate"),
    (cosmos, "CE-T1\n\n", "CE-T1\nRcrd start time: 2018/02/06 15:50:29.{} UTC (Q=5)\n"),
    (cosmos, "CE-T1\n\n", "CE-T1\nRcrd start time:02/06/2018, 15:50:29.{} UTC (Q=2)\n"),
    (csmip_v1, "test\n\n\n", "test\n\n00001-T1              Start time:  2/06/18, 15:50:29.{} UTC (GPS)\n"),
]


@pytest.mark.parametrize(("make", "place", "line"), STARTS)
def test_a_start_that_the_file_states_is_read_and_compared(
    make: Callable[[], str], place: str, line: str, tmp_path: Path
) -> None:
    motions = []
    for name, said in (("first", line.format("250")), ("second", line.format("750")), ("unsaid", place)):
        path = tmp_path / f"{name}.txt"
        path.write_text(make().replace(place, said))
        motions.append(read_record(path, component="U" if make is cwb else None))
    first, second, unsaid = motions
    assert first.begins == ("UTC", datetime(2018, 2, 6, 15, 50, 29, 250_000, tzinfo=UTC).timestamp())
    assert second.begins_after(first) == 0.5
    assert unsaid.begins is None
    with pytest.raises(RecordError, match=r"second.txt begins 0.5 s after first.txt"):
        in_direction(first, second, 0.5)


@pytest.mark.parametrize(
    ("start", "prepended", "said"),
    [
        ("2018 2 6 15 50 29050", 0, "2018-02-06T15:50:29.050000+00:00"),
        ("2018 2 6 15 50 29050", 250, "2018-02-06T15:50:24.050000+00:00"),  # 5 s before the recorded ones
        ("2018 2 6 15 50 0", 250, None),
        ("2018 2 0 15 50 29050", 0, None),
        ("2018 2 6 15 50 99999", 0, None),
        ("", 250, None),
    ],
)
def test_a_start_of_geonet_is_that_of_the_first_value(start: str, prepended: int, said: str | None) -> None:
    channels = channels_of(geonet(start=start, prepended=prepended).encode(), GEONET, "record")
    assert [channel.header.get("start") for channel in channels] == [said, said]


@pytest.mark.parametrize(
    ("start", "said"),
    [
        ((2018, 37, 15, 50, 29, 50), "2018-02-06T15:50:29.050000+00:00"),
        ((2018, 37, 15, 50, 56, 0), "2018-02-06T15:50:56+00:00"),
        ((2018, 37, 15, 50, 0, 0), None),
        ((2018, 37, 15, 50, 0, UNKNOWN), None),
        ((2018, 37, 15, 50, 29, UNKNOWN), None),
        ((0, 37, 15, 50, 29, 50), None),
    ],
)
def test_a_start_of_smc_is_one_to_the_millisecond(start: tuple[int, ...], said: str | None) -> None:
    (channel,) = channels_of(smc(start=start).encode(), SMC, "record")
    assert channel.header.get("start") == said


@pytest.mark.parametrize(
    ("said", "start"),
    [
        ("Start time:  8/29/18, 02:33:  .0 UTC (GPS)", "2018-08-29T02:33:00+00:00"),
        ("Start time:  8/29/18, 02:33: 6.5 UTC (GPS)", "2018-08-29T02:33:06.500000+00:00"),
        ("Start time:  8/29/18, 02:33 UTC", None),
        ("Start time:  8/28/18, 19:33:06.5 PDT", None),
        ("TRIGGER TIME: 06/28/92, 15:05:37.4 UTC", None),
    ],
)
def test_a_start_of_csmip_is_one_of_the_first_sample_to_the_second(said: str, start: str | None) -> None:
    (channel,) = channels_of(csmip_v1().replace("test\n\n", f"test\n\n{said}").encode(), CSMIP, "record")
    assert channel.header.get("start") == start


@pytest.mark.parametrize(
    ("said", "component", "is_vertical"),
    [
        ("Sta Chan  2:  Up     (Rcrdr", "Up", True),
        ("Sta Chan:    2 :  270 deg (Rcrdr", "270", False),
        ("Sta Chan   ?:Other   (Rcrdr", "1", False),  # by the line behind the values
    ],
)
def test_a_component_of_cosmos(tmp_path: Path, said: str, component: str, is_vertical: bool) -> None:
    path = tmp_path / "record.v2"
    path.write_text(cosmos().replace("Sta Chan  1: 340 deg (Rcrdr", said))
    motion = read_record(path)
    assert (motion.component, motion.is_vertical) == (component, is_vertical)


def test_every_format_is_made_by_hand_and_declared() -> None:
    """ObsPy finds the readers by the entry points of the installed package."""
    assert {one.name for one in FORMATS} == {name.split()[0] for name in MADE}
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"]
    for one in FORMATS:
        entry = declared[f"obspy.plugin.waveform.{one.name}"]
        assert declared["obspy.plugin.waveform"][one.name] == plugins.__name__
        for name, function in entry.items():
            module, attribute = function.split(":")
            assert getattr(import_module(module), attribute) is getattr(plugins, attribute)
            assert attribute == f"{'is' if name == 'isFormat' else 'read'}_{one.name.lower()}"


@pytest.mark.parametrize("name", MADE)
def test_obspy_reads_it_by_the_plug_in(tmp_path: Path, name: str) -> None:
    path = tmp_path / "record.txt"
    path.write_text(MADE[name][0])
    own = name.split()[0].lower()
    says = [one.name.lower() for one in FORMATS if getattr(plugins, f"is_{one.name.lower()}")(str(path))]
    assert says == [own]
    assert not getattr(plugins, f"is_{own}")(str(tmp_path / "none"))
    read = getattr(plugins, f"read_{own}")
    stream = read(str(path))
    assert stream[0].stats.npts == len(VALUES)
    assert stream[0].stats[own].units in ("cm/s2", "mm/s2", "m/s2", "gal", "g")
    with path.open("rb") as file:
        assert read(file, headonly=True)[0].stats.delta == stream[0].stats.delta


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (cosmos(kind="velocity", units="cm/sec(06)"), "velocity record"),
        (cosmos(units="counts(50)"), "'counts', not a unit of acceleration"),
        (cosmos().rsplit("\n", 4)[0], "announces 12 values and"),
        (smc(kind="3 VELOCITY"), "file of velocity"),
        (smc().rsplit("\n", 2)[0], "announces 12 values and 8 follow"),
        (esm(kind="VELOCITY"), "velocity record"),
        (esm(count=13), "announces 13 values and 12 follow"),
        (csmip_v2().replace("ACCEL DATA", "SOME DATA"), "no acceleration at equal time steps"),
        (geonet().replace("Number of points  12", "Number of points  11"), "announces 33 values and 36 follow"),
        (geonet().replace("at 0.020 sec", "at 0.0.20 sec"), "the interval is '0.0.20'; expected a number"),
        (geonet(corrected=False).replace("2.00 mm", "2..00 mm"), "the unit is '2..00'"),
        (csmip_v1().replace("at 200 pts", "at 0 pts"), "the time step is 0 s"),
        (csmip_v1().replace("at 200 pts", "at 2.0.0 pts"), "the rate is '2.0.0'"),
        (esm().replace("_S: 0.005000", "_S: 0.0 05"), "SAMPLING_INTERVAL_S is '0.0 05'; expected a number"),
        (resorce().replace(": 0.005", ": 1/200"), "the time increment is '1/200'"),
        (csmnc().replace("0.005  SEC", "5-003  SEC"), "the interval is '5-003'"),
        (cwb().replace("(Hz): 50", "(Hz): 50,0"), r"SampleRate\(Hz\) is '50,0'"),
        (cosmos().replace("10.000000", "10,000000", 1), r"the time step \[ms\] is '10,000000'"),
        (smc().replace("2.0000000E+02", "2.000-000E+02", 1), "the rate is '2.000-000E"),
        (resorce().replace("m/s/s", "cubits"), "'cubits'"),
        (cwb().replace("     0.040", "     0.070"), "does not grow"),
        (cwb().replace("Rate(Hz): 50", "Rate(Hz): 51"), "does not grow"),
        (cwb().replace("#SampleRate", "#RecordLength(sec): 3\n#SampleRate"), "announces 3 s and 0.24 s follow"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "record.txt"
    path.write_text(text)
    with pytest.raises(RecordError, match=words) as caught:
        read_record(path, component=0)
    assert caught.value.line is not None


def test_an_exponent_of_fortran_in_a_step(tmp_path: Path) -> None:
    path = tmp_path / "record.txt"
    path.write_text(resorce().replace(": 0.005", ": 5.0D-03"))
    assert read_record(path).dt == 0.005


def test_what_only_describes_a_record_may_be_damaged(tmp_path: Path) -> None:
    path = tmp_path / "record.txt"
    for text in (geonet().replace("-1235.0 mm", "-.1235.0 mm"), resorce().replace("& Time  ", "& Times ")):
        path.write_text(text)
        assert len(read_record(path, component=0).values) == len(VALUES)


@pytest.mark.parametrize("make", [smc, esm, resorce, csmnc])
def test_a_second_record_in_a_file_of_one_is_refused(tmp_path: Path, make: Callable[[], str]) -> None:
    path = tmp_path / "record.txt"
    path.write_text(make() + "a footer\n")
    assert len(read_record(path).values) == len(VALUES)
    path.write_text(make() + make())
    with pytest.raises(RecordError, match="numbers follow behind the only component") as caught:
        read_record(path)
    assert caught.value.line is not None
    assert caught.value.line > make().count("\n")


def test_a_header_that_states_another_peak_is_mentioned(tmp_path: Path) -> None:
    path = tmp_path / "record.asc"
    path.write_text(esm().replace("-123.5", "-150.0", 1))
    assert "the header says the peak is 150 cm/s2, that of the values is 123.5" in read_record(path).warnings
    with pytest.raises(RecordError, match="the file says its units are cm/s2"):
        read_record(path, units="g")


@pytest.mark.parametrize("end", ["/&  ----------  END OF DATA", "----------  END OF DATA", ""])
def test_several_components_have_to_be_chosen_from(tmp_path: Path, end: str) -> None:
    path = tmp_path / "record.V2"
    path.write_text(csmip_v2().replace("/&  ----------  END OF DATA", end))
    with pytest.raises(RecordError, match="choose one with `component`; the file holds 0: 90, 1: UP"):
        read_record(path)
    assert read_record(path, component="up").component == "UP"


def test_components_of_one_name_are_told_apart(tmp_path: Path) -> None:
    def one(degrees: str, peak: float) -> str:
        return cosmos([0.0, peak, 1.0]).replace("340 deg", f"{degrees:>3} deg")

    def peaks(path: Path) -> list[float]:
        return [float(read_record(path, component=each).values.max()) for each in components_of(path)]

    path = tmp_path / "building.v2"
    path.write_text("".join(one(degrees, 10.0 + i) for i, degrees in enumerate(("90", "0", "360", "90"))))
    assert components_of(path) == ["90 (1)", "0", "360", "90 (2)"]
    assert peaks(path) == pytest.approx([0.10, 0.11, 0.12, 0.13])
    with pytest.raises(RecordError, match=r"the file holds 0: 90 \(1\), 1: 0, 2: 360, 3: 90 \(2\)"):
        read_record(path, component=90)
    path.write_text("".join(one(degrees, 10.0 + i) for i, degrees in enumerate(("0", "90", "0"))))
    assert peaks(path) == pytest.approx([0.10, 0.11, 0.12])


def test_real_files_have_the_peak_their_header_states(shared_records: Path) -> None:
    with (shared_records / "INDEX.csv").open(newline="") as file:
        index = {row["file"]: row for row in csv.DictReader(file)}
    read = 0
    for path in sorted((shared_records / "other").iterdir()):
        data = path.read_bytes()
        if (one := format_of(data)) is None:
            continue
        channels = channels_of(data, one, path.name)
        for channel in channels:
            assert np.abs(channel.values).max() == pytest.approx(channel.peak, rel=0.01), path.name
        # the index was made by another reader, of the first component but in files where it says otherwise
        row = index[f"other/{path.name}"]
        peaks = [np.abs(c.values).max() * (FACTORS[c.units] / 9.80665 if c.units != "g" else 1.0) for c in channels]
        assert min(abs(peak - float(row["pga_g"])) for peak in peaks) < 5e-4 * float(row["pga_g"]) + 5.1e-6, path.name
        assert channels[0].dt == pytest.approx(float(row["dt_s"]), rel=1e-9)
        assert len(channels[0].values) == int(row["npts"])
        read += 1
    assert read == 16
