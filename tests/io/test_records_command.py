"""`rock records`: what it prints, what it writes, what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import obspy
import pytest
from typer.testing import CliRunner

from rockcli.cli.records import app
from rockcli.errors import RecordError, StudyError
from rockcli.motion.at2 import read_at2
from rockcli.motion.reading import read_record

ROCK = Path(__file__).parents[2] / "records" / "synthetic_rock_m65.AT2"


def run(*arguments: object) -> str:
    result = CliRunner().invoke(app, [str(argument) for argument in arguments], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.stdout


def test_info_prints_the_measures() -> None:
    text = run("info", ROCK, ROCK)
    assert text.count("SYNTHETIC") == 2
    for line in ("values           4000", "time step        0.005 s", "PGA              0.393", "component        H1"):
        assert line in text


def test_info_says_in_words_in_which_units_values_were_read(tmp_path: Path) -> None:
    assert "values read in   g, the acceleration of gravity" in run("info", ROCK)
    (tmp_path / "q.txt").write_text("# units: cm/s2\n0 0\n0.01 100\n0.02 0\n")
    text = run("info", tmp_path / "q.txt")
    assert "values read in   metres per second squared" in text
    assert "cm/s2 converted" in text


def test_info_as_json() -> None:
    (row,) = json.loads(run("info", "--json", ROCK))
    motion = read_record(ROCK)
    assert row["npts"] == 4000
    assert row["pga_g"] == pytest.approx(np.abs(motion.values).max(), rel=1e-12)
    assert row["sha256"] == motion.sha256
    assert {"pgv", "pgd", "arias", "cav", "d5_95", "duration", "format"} <= set(row)


def test_what_is_not_known_is_null_in_json_and_left_out_of_the_table(tmp_path: Path) -> None:
    (tmp_path / "still.txt").write_text("# units: g\n0 0\n0.01 0\n0.02 0\n")
    (row,) = json.loads(run("info", "--json", tmp_path / "still.txt"), parse_constant=pytest.fail)
    assert row["t_mean"] is None
    assert "mean period" not in run("info", tmp_path / "still.txt")


@pytest.mark.parametrize("g", ["0", "-1", "inf", "nan"])
def test_g_is_a_number_above_zero(tmp_path: Path, g: str) -> None:
    for command in (["info", ROCK], ["convert", ROCK, tmp_path / "out.AT2"]):
        with pytest.raises(RecordError, match=f"--g is {g}; expected m/s², above zero"):
            run(*command, "--g", g)
    assert not (tmp_path / "out.AT2").exists()


def test_convert_there_and_back(tmp_path: Path) -> None:
    motion = read_record(ROCK)
    told = run("convert", ROCK, tmp_path / "a.txt")
    assert told == f"{tmp_path / 'a.txt'}: {len(motion.values)} values, dt {motion.dt:g} s\n"
    text = read_record(tmp_path / "a.txt")
    assert text.values.tolist() == motion.values.tolist()
    assert (text.units, text.dt) == ("g", motion.dt)
    run("convert", tmp_path / "a.txt", tmp_path / "b.AT2")
    again = read_record(tmp_path / "b.AT2")
    assert again.values.tolist() == motion.values.tolist()
    run("convert", ROCK, tmp_path / "c.at2")
    assert read_record(tmp_path / "c.at2").component == "H1"


def test_convert_states_no_event_or_station_where_none_is_known(tmp_path: Path) -> None:
    trace = obspy.Trace(np.array([1.0, -2.0, 3.0]), {"delta": 0.01, "station": "A", "channel": "HNE"})
    for name, station in (("a", "A"), ("b", "")):
        trace.stats.station = station
        trace.write(str(tmp_path / name), format="MSEED")
        run("convert", tmp_path / name, tmp_path / f"{name}.AT2", "--units", "g")
        motion = read_record(tmp_path / f"{name}.AT2")
        assert (motion.header["event"], motion.header["station"], motion.component) == ("", station, "HNE")


def test_a_station_with_commas_stays_one_in_at2(tmp_path: Path) -> None:
    path = tmp_path / "one.asc"
    path.write_text(
        "Event Date & Time : 2009-04-06\nStation Code / Name : 2987 / L Aquila, Valle, Italy\nOrientation : NS\n"
        "Time Increment (s) : 0.01\nNumber of Data : 3\ntime series in m/s/s\n1 -2 3\n"
    )
    run("convert", path, tmp_path / "a.AT2")
    motion = read_record(tmp_path / "a.AT2")
    assert (motion.header["station"], motion.component) == ("2987 / L Aquila Valle Italy", "NS")


@pytest.mark.parametrize(
    ("head", "said"),
    [
        ("# start: 2010-02-27T06:34:14.005+00:00\n0 1\n.01 2\n.02 0\n", "start: 2010-02-27T06:34:14.005000Z"),
        ("# start: 2010-02-27T03:34:14-03:00\n0 1\n.01 2\n.02 0\n", "start: 2010-02-27T06:34:14.000000Z"),
        ("time [s],a\n12.3,1\n12.31,2\n12.32,0\n", "start: 12.3 s"),
        ("0 1\n.01 2\n.02 0\n", ""),
        ("# start: 2010-02-27T06:34:14\n0 1\n.01 2\n.02 0\n", ""),  # of no zone
        ("# start: 2010-02-30T06:34:14Z\n0 1\n.01 2\n.02 0\n", ""),
    ],
)
def test_convert_keeps_when_the_first_sample_was_taken(tmp_path: Path, head: str, said: str) -> None:
    source = tmp_path / "one.txt"
    source.write_text(head, encoding="utf-8")
    for target in ("a.AT2", "b.txt", "c.AT2"):
        run("convert", source, tmp_path / target, "--units", "g")
        text = (tmp_path / target).read_text()
        assert said in text
        assert ("start" in text) is bool(said)
        again = read_record(tmp_path / target)
        (row,) = json.loads(run("info", tmp_path / target, "--json"))
        assert row["start"] == said.removeprefix("start: ")
        if said:
            assert f"  first sample at  {row['start']}\n" in run("info", tmp_path / target)
            assert again.begins == read_record(tmp_path / "one.txt", units="g").begins
        source = tmp_path / target
    (trace,) = read_at2(tmp_path / "c.AT2")
    assert str(trace.stats.starttime) == (said[7:] if said.endswith("Z") else "1970-01-01T00:00:00.000000Z")


def test_convert_states_its_g(tmp_path: Path) -> None:
    source = tmp_path / "one.txt"
    source.write_text("981\n-490.5\n", encoding="utf-8")
    run("convert", source, tmp_path / "out.AT2", "--units", "gal", "--dt", "0.01")
    motion = read_record(tmp_path / "out.AT2")
    np.testing.assert_allclose(motion.values, [1.0, -0.5], rtol=1e-7)
    assert "1 g = 9.81 m/s2" in motion.header["title"][0]


def test_refusals(tmp_path: Path) -> None:
    target = tmp_path / "a.AT2"
    run("convert", ROCK, target)
    with pytest.raises(RecordError, match="already there"):
        run("convert", ROCK, target)
    run("convert", ROCK, target, "--force")
    with pytest.raises(RecordError, match=r"expected \.AT2 or \.txt"):
        run("convert", ROCK, tmp_path / "a.csv")
    with pytest.raises(RecordError, match="no such file"):
        run("info", tmp_path / "none.AT2")
    with pytest.raises(RecordError, match="'H1' only"):
        run("info", ROCK, "--component", "090")
    (tmp_path / "folder.AT2").mkdir()
    with pytest.raises(StudyError, match="is a folder"):
        run("convert", ROCK, tmp_path / "folder.AT2")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.AT2", "folder.AT2"]


def test_convert_there_and_back_keeps_the_measures(tmp_path: Path) -> None:
    source = tmp_path / "one.txt"
    source.write_text("0 0\n0.01 2.5\n0.02 -1\n0.03 0\n", encoding="utf-8")
    (before,) = json.loads(run("info", "--json", source, "--units", "m/s2"))
    run("convert", source, tmp_path / "out.AT2", "--units", "m/s2")
    (after,) = json.loads(run("info", "--json", tmp_path / "out.AT2"))
    assert (after["pga"], after["pgv"]) == pytest.approx((before["pga"], before["pgv"]), rel=1e-6)


def test_info_reports_every_file_and_fails_at_the_end(tmp_path: Path) -> None:
    for options in ((), ("--json",)):
        files = [str(tmp_path / "none.AT2"), str(ROCK), str(tmp_path)]
        result = CliRunner().invoke(app, ["info", *options, *files])
        assert "none.AT2: there is no such file" in result.stderr
        assert isinstance(result.exception, RecordError)
        assert "there is no file in this folder; folders in it are not searched" in str(result.exception)
        assert "SYNTHETIC" in result.stdout


def test_a_name_alone_is_searched_for_as_a_study_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "suite").mkdir()
    (tmp_path / "suite" / "one.AT2").write_bytes(ROCK.read_bytes())
    monkeypatch.setenv("ROCK_RECORDS", str(tmp_path / "suite"))
    monkeypatch.chdir(tmp_path)
    for name in (ROCK.name, "one.AT2"):
        (row,) = json.loads(run("info", "--json", name))
        assert Path(row["file"]).name == name
        assert row["npts"] == 4000
    run("convert", "one.AT2", "two.AT2")
    np.testing.assert_array_equal(read_record(tmp_path / "two.AT2").values, read_record(ROCK).values)
    with pytest.raises(RecordError, match=r"one.AT3' was not found\n.*suite\n  Close names: one.AT2"):
        run("info", "one.AT3")
    with pytest.raises(RecordError, match=r"other.one.AT2: there is no such file"):
        run("info", Path("other") / "one.AT2")


def test_what_is_missing_is_asked_for_as_options(tmp_path: Path) -> None:
    source = tmp_path / "one.txt"
    source.write_text("1\n2\n", encoding="utf-8")
    with pytest.raises(RecordError, match=r"with --units, .* the time step with --dt"):
        run("info", source)
    with pytest.raises(RecordError, match=r"--dt"):
        run("convert", source, tmp_path / "a.AT2", "--units", "g")
    source.write_text("NPTS= 2, DT= .01 SEC\n1\n2\n", encoding="utf-8")
    with pytest.raises(RecordError, match=r"give them with --units, one of g, m/s2, cm/s2, gal, mm/s2"):
        run("info", source)


def test_help_is_plain() -> None:
    told = run("info", "--help")
    assert "Time step [s], where" in " ".join(told.split())
    assert "[m/s²]" in told
    assert "completion" not in run("--help")
    assert "─" not in told
