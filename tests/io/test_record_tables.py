"""Tables of records, spectra, two components in every direction, and what the PEER database says of its records."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import obspy
import pytest
from scipy.signal import cont2discrete, lfilter
from typer.testing import CliRunner

import rockcli
from rockcli.cli.records import app
from rockcli.errors import RecordError
from rockcli.motion.at2 import at2_text
from rockcli.motion.flatfile import NAME, metadata_beside
from rockcli.motion.measures import velocity
from rockcli.motion.reading import read_record
from rockcli.motion.rotated import rotated, rotated_measures, rotated_spectrum

RECORDS = Path(__file__).parents[2] / "records"
ONE, TWO = (RECORDS / f"synthetic_{name}.AT2" for name in ("rock_m65", "soil_m70"))
G = 9.80665
CHANNELS = {"HNE": [1.0, -2.0, 3.0], "HNN": [4.0, -5.0, 6.0], "HNZ": [7.0, -8.0, 9.0]}


def run(*arguments: object) -> tuple[str, str]:
    result = CliRunner().invoke(app, [str(argument) for argument in arguments], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.stdout, result.stderr


def pair(n: int = 3000) -> tuple[np.ndarray, np.ndarray, float]:
    """Two motions alike in what they hold and shifted, from rest to rest."""
    motion = read_record(ONE)
    a, fades = motion.acceleration(G), np.sin(np.pi * np.arange(n) / (n - 1))
    return a[:n] * fades, 0.8 * a[700 : 700 + n] * fades, motion.dt


def spectral(a: np.ndarray, dt: float, period: float, zeta: float = 0.05) -> np.ndarray:
    """Sa of many motions (m, k), linear between samples, by scipy's exact discretisation of the oscillator's filter."""
    parts = max(int(np.ceil(200 * dt / period)), 1)
    t = np.arange((a.shape[1] - 1) * parts + 1 + int(np.ceil(period / dt)) * parts) / parts
    fine = np.array([np.interp(t, np.arange(len(row)), row, right=0.0) for row in a])
    omega = 2.0 * np.pi / period
    b, c, _ = cont2discrete(([1.0], [1.0, 2.0 * zeta * omega, omega**2]), dt / parts, method="foh")
    return omega**2 * np.abs(lfilter(np.ravel(b), c, -fine)).max(axis=1)


@pytest.mark.parametrize("period", [0.05, 0.3, 1.0, 4.0])
def test_rotd_of_a_spectrum_against_rotating_first(period: float) -> None:
    """The ground motion turned into each of 180 directions, then an oscillator in it."""
    one, two, dt = pair(1500)
    angles = np.radians(np.arange(180))[:, None]
    peaks = spectral(np.cos(angles) * one + np.sin(angles) * two, dt, period)
    rotd50, rotd100 = rotated_spectrum(one, two, dt, np.array([period]))
    assert rotd50[0] == pytest.approx(np.median(peaks), rel=1e-3)
    assert rotd100[0] == pytest.approx(peaks.max(), rel=1e-3)


def test_rotd_of_long_periods_under_a_coarse_motion() -> None:
    """Of a quick motion it is the ground, and not the oscillator, that bends the history between two samples."""
    dt, parts, periods = 0.02, 40, np.array([0.3, 1.0, 5.0, 10.0])
    a = np.sin(2.0 * np.pi / 8.0 * (np.arange(41) + 0.5))  # displacements are largest halfway between samples
    fine = np.interp(np.arange(40 * parts + 1) / parts, np.arange(41), a)
    found, close = rotated_spectrum(a, 0.5 * a, dt, periods), rotated_spectrum(fine, 0.5 * fine, dt / parts, periods)
    np.testing.assert_allclose(found, close, rtol=5e-4)


def test_rotd_of_pga_and_pgv_and_closed_forms() -> None:
    one, two, dt = pair()
    angles = np.radians(np.arange(180))[:, None]
    found = rotated_measures(one, two, dt)
    turned = np.cos(angles) * one + np.sin(angles) * two
    assert found["pga"] == pytest.approx((np.median(np.abs(turned).max(axis=1)), np.abs(turned).max()), rel=1e-12)
    speeds = [np.abs(velocity(row, dt)).max() for row in turned]
    assert found["pgv"] == pytest.approx((np.median(speeds), max(speeds)), rel=1e-9)
    t = np.linspace(0.0, 2.0 * np.pi, 100_001)
    assert rotated(np.cos(t), np.sin(t)) == pytest.approx((1.0, 1.0), rel=1e-8)  # a circle
    assert rotated(np.cos(t), 0.0 * t) == pytest.approx((np.sqrt(0.5), 1.0), rel=1e-2)  # a line: |cos(45 deg)|


def test_one_row_for_each_record_of_a_folder(tmp_path: Path) -> None:
    for path in (ONE, TWO):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    (tmp_path / "notes.txt").write_text("not a record\n")
    (tmp_path / "_SearchResults.csv").write_text("")
    said, left_out = run("info", tmp_path, "--sa", "0.5", "--sa", "2")
    head, *rows = said.splitlines()
    assert head.split("  ")[0] == "record"
    assert head.rstrip().endswith("Sa(2) [g]")
    assert [row.split()[0] for row in rows] == sorted([ONE.name, TWO.name])
    for row, path in zip(rows, sorted([ONE, TWO]), strict=True):
        motion = read_record(path)
        expected = [spectral(motion.values[None, :], motion.dt, T)[0] for T in (0.5, 2.0)]
        np.testing.assert_allclose([float(word) for word in row.split()[-2:]], expected, rtol=1e-3)
    assert "left out" in left_out
    assert "notes.txt" in left_out
    parsed = json.loads(run("info", tmp_path, "--sa", "0.5", "--json")[0])
    assert [row["sa(0.5)"] > 0.0 for row in parsed] == [True, True]


def test_pairs_in_every_direction(tmp_path: Path) -> None:
    one, two, dt = pair()
    paths = []
    for name, values in (("a", one), ("b", two)):
        paths.append(tmp_path / f"{name}.txt")
        paths[-1].write_text("# units: m/s2\n" + "".join(f"{x:.12e}\n" for x in values))
    said, _ = run("info", *paths, "--rotd", "--dt", dt, "--sa", "1")
    head, row = said.splitlines()
    assert "PGA RotD50 [g]" in head
    assert "Sa(1) RotD100 [g]" in head
    sa = rotated_spectrum(one, two, dt, np.array([1.0]))
    measures = rotated_measures(one, two, dt)
    expected = [*(np.array(measures["pga"]) / G), *measures["pgv"], sa[0][0] / G, sa[1][0] / G]
    np.testing.assert_allclose([float(word) for word in row.split()[-6:]], expected, rtol=1e-3)
    with pytest.raises(RecordError, match="needs pairs of components, not 1 file"):
        run("info", paths[0], "--rotd", "--dt", dt)
    paths[1].write_text("# units: m/s2\n1\n2\n3\n")
    with pytest.raises(RecordError, match="need the same times: cut both files to their first 3 values"):
        run("info", *paths, "--rotd", "--dt", dt)


@pytest.mark.parametrize(
    ("files", "words"),
    [
        ([("Izmit", "090"), ("Izmit", "UP")], "is a vertical component, UP"),
        ([("Izmit", "090"), ("Duzce", "180")], "is of station Izmit, b.AT2 of Duzce"),
        ([("Izmit", "090"), ("Izmit", "180")], ""),
    ],
)
def test_a_pair_is_of_one_place_and_horizontal(tmp_path: Path, files: list[tuple[str, str]], words: str) -> None:
    for name, (station, component) in zip("ab", files, strict=True):
        titles = ["RECORD", f"Kocaeli, 8/17/1999, {station}, {component}"]
        (tmp_path / f"{name}.AT2").write_text(at2_text(np.ones(9), 0.01, titles, tmp_path))
    if not words:
        run("info", tmp_path, "--rotd")
        return
    with pytest.raises(RecordError, match=words):
        run("info", tmp_path, "--rotd")


def test_a_pair_is_of_one_component_of_each_file(tmp_path: Path) -> None:
    paths = []
    for name, size in (("a", 1.0), ("b", 2.0)):
        paths.append(tmp_path / f"{name}.mseed")
        traces = [obspy.Trace(size * np.array(values), {"channel": place}) for place, values in CHANNELS.items()]
        obspy.Stream(traces).write(str(paths[-1]), format="MSEED")
    with pytest.raises(RecordError, match="choose one with --component; the file holds 0: "):
        run("info", *paths, "--rotd", "--units", "m/s2")
    (row,) = json.loads(run("info", *paths, "--rotd", "--units", "m/s2", "--component", "HNN", "--json")[0])
    assert row["pga_rotd100"] == pytest.approx(np.hypot(6.0, 12.0), rel=1e-4)


@pytest.mark.parametrize("suffix", ["png", "svg"])
def test_spectra_are_drawn(tmp_path: Path, suffix: str) -> None:
    out = tmp_path / "new" / f"spectra.{suffix}"
    run("info", ONE, TWO, "--spectrum", out)
    first = out.read_bytes()
    run("info", ONE, TWO, "--spectrum", out)
    assert first == out.read_bytes()
    with pytest.raises(RecordError, match=r"expected one of \.png, \.pdf, \.svg"):
        run("info", ONE, "--spectrum", tmp_path / "spectra.txt")
    with pytest.raises(RecordError, match="expected a period"):
        run("info", ONE, "--sa", "0")


def test_spectra_of_pairs_are_drawn_in_every_direction(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    one, two, dt = pair(400)
    paths = []
    for name, values in (("a", one), ("b", two)):
        paths.append(tmp_path / f"{name}.txt")
        paths[-1].write_text("# units: m/s2\n" + "".join(f"{x:.12e}\n" for x in values))
    out, drawn = tmp_path / "s.svg", []
    monkeypatch.setattr("rockcli.cli.record_tables.POINTS", 9)
    run("info", *paths, "--rotd", "--dt", dt, "--spectrum", out)
    for words in ("a.txt, b.txt: RotD50", "a.txt, b.txt: RotD100", "in every direction"):
        assert words in out.read_text()
    monkeypatch.setattr("rockcli.plotting.record_spectra.draw", lambda path, *said: drawn.append((path.touch(), *said)))
    run("info", *paths, "--rotd", "--dt", dt, "--g", G, "--spectrum", out)
    ((_, periods, spectra, _),) = drawn
    angles = np.radians(np.arange(180))[:, None]
    turned = np.cos(angles) * one + np.sin(angles) * two
    for i in (3, 6):
        peaks = spectral(turned, dt, periods[i]) / G
        assert [values[i] for _, values in spectra] == pytest.approx([np.median(peaks), peaks.max()], rel=1e-3)
    run("info", *paths * 6, "--rotd", "--dt", dt, "--spectrum", out)
    assert [name for name, _ in drawn[1][2]] == 6 * ["a.txt, b.txt: RotD50"]


def test_a_record_of_zeros_has_a_spectrum_too(tmp_path: Path) -> None:
    silent = tmp_path / "silent.txt"
    silent.write_text("# units: g\n# dt: 0.01\n" + 5 * "0\n")
    run("info", *[ONE] * 12, silent, "--sa", "1", "--spectrum", tmp_path / "s.svg")
    assert "median of 13" in (tmp_path / "s.svg").read_text()
    run("info", silent, "--spectrum", tmp_path / "alone.svg")  # a logarithmic axis has no place for it
    assert "silent.txt" in (tmp_path / "alone.svg").read_text()


SEARCH = """\
PEER Ground Motion Database - test,,,
 -- Summary of Metadata of Selected Records --
 Result ID, Spectral Ordinate, Record Sequence Number, Tp-Pulse (sec), Earthquake Name, Year, Station Name, Magnitude, Mechanism, \
Rjb (km), Rrup (km), Vs30 (m/sec), Lowest Useable Frequency (Hz), Horizontal-1 Acc. Filename, Horizontal-2 Acc. Filename, Vertical Acc. Filename
1, SRSS, 900, 7.504, "Landers, a test",1992,"Yermo",7.28, strike slip,23.62,23.62,353.63,0.07,RSN900_A_YER270.AT2,RSN900_A_YER360.AT2,-----
2, SRSS, 901, -999, "Another",1999,"Place",6.9, reverse,1.0,-999,-999,0.1,RSN901_B_X.AT2,RSN901_B_Y.AT2,RSN901_B_UP.AT2

-- Scaled Spectra used in Search & Scaling --
"""


def test_records_of_one_name_in_two_folders_are_both_drawn(tmp_path: Path) -> None:
    for folder, record in (("a", ONE), ("b", TWO)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "x.AT2").write_bytes(record.read_bytes())
    run("info", tmp_path / "a", tmp_path / "b", "--spectrum", tmp_path / "s.svg")
    drawn = (tmp_path / "s.svg").read_text()
    assert "a/x.AT2" in drawn
    assert "b/x.AT2" in drawn


def test_remarks_are_told_beside_a_table(tmp_path: Path) -> None:
    for name, component in (("a", "090"), ("b", "180")):
        titles = ["RECORD", f"Event, 1/2/2003, Station, {component}"]
        (tmp_path / f"{name}.AT2").write_text(at2_text(np.ones(99), 0.01, titles))
    pair = [tmp_path / "a.AT2", tmp_path / "b.AT2"]
    for arguments in ([tmp_path], [*pair, "--sa", 1], [*pair, "--rotd"], [*pair, "--rotd", "--json"]):
        told = run("info", *arguments)[1].splitlines()
        expected = [f"rock: {pair[0]} 090:", f"rock: {pair[1]} 180:"]
        assert [line.split(" the mean value is 1 g")[0] for line in told] == expected
    assert run("info", tmp_path, "--json")[1] == ""


def test_what_the_database_says_of_a_record(tmp_path: Path) -> None:
    (tmp_path / NAME).write_text(SEARCH)
    known = {"magnitude": 7.28, "r_jb": 23.62, "r_rup": 23.62, "vs30": 353.63, "pulse_period": 7.504}
    assert metadata_beside(tmp_path / "RSN900_A_YER270.AT2") == known
    assert metadata_beside(tmp_path / "rsn900_a_yer360.at2") == known
    assert metadata_beside(tmp_path / "RSN900_renamed.AT2") == known
    assert metadata_beside(tmp_path / "RSN901_B_Y.AT2") == {"magnitude": 6.9, "r_jb": 1.0}
    assert metadata_beside(tmp_path / "other.AT2") == {}
    assert metadata_beside(tmp_path / "elsewhere" / "RSN900_A_YER270.AT2") == {}
    (tmp_path / "RSN900_A_YER270.AT2").write_bytes(ONE.read_bytes())
    said, _ = run("info", tmp_path)
    head, row = said.splitlines()
    assert [one.strip() for one in head.split("  ")[-4:]] == ["M", "R_rup [km]", "Vs30 [m/s]", "T_pulse [s]"]
    assert row.split()[-4:] == ["7.28", "23.62", "353.6", "7.504"]


def test_a_table_of_the_database_that_is_exchanged_for_one_as_old_is_read_again(tmp_path: Path) -> None:
    """As copies with `cp -p` and `rsync -t` are, in one process that goes on."""
    for magnitude in (7.28, 7.31):
        (tmp_path / "new").write_text(SEARCH.replace("7.28", f"{magnitude}"))
        os.utime(tmp_path / "new", (1e9, 1e9))
        (tmp_path / "new").replace(tmp_path / NAME)
        assert metadata_beside(tmp_path / "RSN900_A_YER270.AT2")["magnitude"] == magnitude


def test_a_damaged_table_of_the_database_is_told(tmp_path: Path) -> None:
    open_quote = SEARCH.replace('"Another"', '"Another').replace('"Place"', "Place")
    (tmp_path / NAME).write_text(open_quote + "x" * 140_000)
    with pytest.raises(RecordError, match="cannot be read as the table of the PEER database: field larger"):
        metadata_beside(tmp_path / "RSN900_A_YER270.AT2")


@pytest.mark.parametrize(
    "changed", [SEARCH.replace(",", ";"), SEARCH.replace("Record Sequence Number", "RSN"), "what is this\n"]
)
def test_a_table_without_the_titles_of_the_database_is_refused(tmp_path: Path, changed: str) -> None:
    (tmp_path / NAME).write_text(changed)
    with pytest.raises(RecordError, match="no line has the titles `Record Sequence Number`"):
        metadata_beside(tmp_path / "RSN811_LOMAP_WAH000.AT2")
    (tmp_path / NAME).write_text("")
    assert metadata_beside(tmp_path / "RSN811_LOMAP_WAH000.AT2") == {}


def test_a_record_that_stands_twice_in_the_table_of_the_database(tmp_path: Path) -> None:
    row = next(line for line in SEARCH.splitlines() if " 900," in line)
    (tmp_path / NAME).write_text(SEARCH.replace(row, f"{row}\n{row}"))
    assert metadata_beside(tmp_path / "RSN900_A_YER270.AT2")["magnitude"] == 7.28
    (tmp_path / NAME).write_text(again := SEARCH.replace(row, f"{row}\n{row.replace('7.28', '7.3')}"))
    with pytest.raises(RecordError, match="record 900 stands here again, with other values") as caught:
        metadata_beside(tmp_path / "RSN901_B_X.AT2")
    assert "7.3," in again.splitlines()[caught.value.line - 1]


@pytest.mark.parametrize("unknown", ["-999", "-9999.0", ""])
def test_what_a_header_does_not_know_is_no_number(tmp_path: Path, unknown: str) -> None:
    text = "".join(f"{key}: {value}\n" for key, value in {
        "EVENT_NAME": "A TEST", "EVENT_ID": "1", "MAGNITUDE_W": "6.1", "STATION_CODE": "T1", "VS30_M/S": unknown,
        "SAMPLING_INTERVAL_S": "0.005", "NDATA": "3", "STREAM": "HNE", "UNITS": "cm/s^2", "PGA_CM/S^2": "3",
        "DATA_TYPE": "ACCELERATION", "USER5": "",
    }.items())  # fmt: skip
    (tmp_path / "one.asc").write_text(text + "1\n-3\n2\n")
    (row,) = json.loads(run("info", tmp_path / "one.asc", "--json")[0])
    assert row["magnitude"] == 6.1
    assert "vs30" not in row


def test_what_is_known_of_records_is_in_the_dataset(tmp_path: Path) -> None:
    """Coordinates over the axis of the records, NaN where nothing is known of one; absent where nobody knows."""
    (tmp_path / NAME).write_text(SEARCH)
    for name in ("RSN900_A_YER270.AT2", "RSN901_B_X.AT2", "another.AT2"):
        (tmp_path / name).write_bytes(ONE.read_bytes())
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"record": {"file": "x", "pga": "0.3*g"}}}
    study = {
        "name": "known",
        "case": case,
        "vary": {"motion.record.file": str(tmp_path / "*.AT2"), "block.R": [1.0, 2.0]},
        "save": {"histories": False},
    }
    data = rockcli.run(study)
    records = [str(name) for name in data["record"].values]
    assert data["magnitude"].dims == data["pulse_period"].dims == ("record",)
    known = dict(zip(records, data["magnitude"].values, strict=True))
    assert known["RSN900_A_YER270.AT2"] == 7.28
    assert known["RSN901_B_X.AT2"] == 6.9
    assert np.isnan(known["another.AT2"])
    assert float(data["pulse_period"].max()) == 7.504
    assert data["vs30"].attrs["units"] == "m s-1"
    assert data["r_rup"].attrs["units"] == "km"
    assert {"magnitude", "r_jb"} <= set(data.coords)
    case["motion"]["record"]["file"] = str(ONE)
    assert not {"magnitude", "vs30"} & set(rockcli.run({"name": "unknown", "case": case}).variables)
