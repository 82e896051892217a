"""Tables of datasets: every number of the file in its row, whatever the block, the format or the order of dimensions."""

from __future__ import annotations

import csv
import math
import sys
from pathlib import Path

import numpy as np
import pandas
import pytest

import rockcli
from rockcli.errors import StudyError
from rockcli.storage import netcdf
from rockcli.storage.contents import Contents, Field, axis_field, text, variable_field
from rockcli.storage.read import to_xarray
from rockcli.storage.table import frame, opened, table_of, units_of
from rockcli.storage.table_files import write

AXES = ("label", "size", "model")


@pytest.fixture
def made(tmp_path) -> tuple[Contents, Path]:
    """Three axes, variables over all, some and none of them, a history; made by hand."""
    rng = np.random.default_rng(1)
    shape = (3, 5, 2)
    peak = rng.random(shape)
    peak[0, 1, 0], peak[2, 4, 1] = np.inf, np.nan
    outcome = rng.integers(-1, 4, shape).astype(np.int8)
    reason = np.full(shape, -1)
    reason[2, 4, 1] = 1
    fields = {
        "label": axis_field("label", "case", ["a, b", 'c "d"', "é"], numeric=False, unit="1"),
        "size": axis_field("size", "block.R", [1.0, 2.0, 3.0, 4.0, 0.1 + 0.2], numeric=True, unit="m"),
        "model": axis_field("model", "model", ["rigid", "3"], numeric=False, unit="1"),
        "alpha": variable_field("alpha", ("label",), np.array([0.1, 0.2, 0.3])),
        "R": variable_field("R", (), np.array(2.5)),
        "outcome": variable_field("outcome", AXES, outcome),
        "theta_peak_over_alpha": variable_field("theta_peak_over_alpha", AXES, peak),
        "reason": variable_field("reason", AXES, reason),
        "reasons": Field(("reasons",), text(["first", "second, third"]), {}, True),
        "theta": Field((*AXES, "time"), np.zeros((*shape, 7)), {"units": "rad"}),
        "turned": Field(("model", "label"), rng.random((2, 3)), {"units": "m s-2", "long_name": "turned"}),
    }
    contents = Contents(AXES, fields, {"identity": "x", "case": '{"g": 10.0}'})
    path = tmp_path / "made.nc"
    netcdf.write(contents, path)
    return contents, path


def rows_of(contents: Contents):
    """Every row by plain loops: the independent way."""
    meanings = dict(
        zip(
            contents.fields["outcome"].attrs["flag_values"].tolist(),
            contents.fields["outcome"].attrs["flag_meanings"].split(),
            strict=True,
        )
    )
    for i in range(3):
        for j in range(5):
            for k in range(2):
                yield {
                    "label": contents.values("label")[i],
                    "size [m]": contents.values("size")[j],
                    "model": contents.values("model")[k],
                    "R [m]": 2.5,
                    "alpha [rad]": contents.values("alpha")[i],
                    "outcome": meanings[int(contents.values("outcome")[i, j, k])],
                    "theta_peak_over_alpha": contents.values("theta_peak_over_alpha")[i, j, k],
                    "reason": "second, third" if contents.values("reason")[i, j, k] == 1 else "",
                    "turned [m s-2]": contents.values("turned")[k, i],
                }


def same(one, other, rtol: float = 0.0) -> bool:
    if isinstance(other, str):
        return ("" if one is None or one != one else one) == other
    return (math.isnan(float(one)) and math.isnan(other)) or math.isclose(float(one), other, rel_tol=rtol)


def check(rows, contents, rtol: float = 0.0):
    wanted = list(rows_of(contents))
    assert len(rows) == len(wanted) == 30
    for row, want in zip(rows, wanted, strict=True):
        assert list(row)[:3] == ["label", "size [m]", "model"]
        assert set(row) == set(want)
        assert all(same(row[name], want[name], rtol) for name in want), (row, want)


@pytest.mark.parametrize("rows", [1, 2, 3, 7, 10, 11, 29, 30, 1000])
def test_blocks_of_any_size_are_the_same_rows(made, rows):
    contents, path = made
    with opened(path) as (items, attrs):
        blocks = list(table_of(items, attrs).blocks(rows))
    assert all(len(block[0].values) <= rows for block in blocks)
    check([r for b in blocks for r in frame(b).astype(object).to_dict("records")], contents)


@pytest.mark.parametrize("rows", [1, 4, 30, 1000])
@pytest.mark.parametrize("descending", [False, True])
@pytest.mark.parametrize(
    ("name", "head"),
    [("theta_peak_over_alpha", "theta_peak_over_alpha"), ("turned", "turned [m s-2]"), ("size", "size [m]")]
    + [(name, name) for name in ("outcome", "reason", "label")],
)
def test_a_sorted_table_is_its_rows_by_a_column(made, name, head, descending, rows):
    """Equal rows keep their order; NaN and empty words are last whichever way it goes."""
    contents, path = made
    every = list(rows_of(contents))
    known = [row for row in every if row[head] == row[head] and row[head] != ""]
    wanted = sorted(known, key=lambda row: row[head], reverse=descending)
    wanted += [row for row in every if row not in known]
    with opened(path) as (items, attrs):
        found = table_of(items, attrs, sort=("-" if descending else "") + name)
        told = [r for block in found.blocks(rows) for r in frame(block).astype(object).to_dict("records")]
    assert len(told) == len(wanted) == 30
    for row, want in zip(told, wanted, strict=True):
        assert all(same(row[column], want[column]) for column in want), (row, want)


def test_cases_that_are_masked_have_no_words(made):
    contents, _ = made
    dataset = to_xarray(contents)
    masked = {name: dataset[name].where(dataset["size"] > 1.5) for name in ("outcome", "reason")}
    table = rockcli.table(dataset.assign(masked))
    out = table["size [m]"] < 1.5
    assert out.sum() == 2 * 3 * 2
    assert (table.loc[out, ["outcome", "reason"]] == "").all(axis=None)
    assert (table.loc[~out, "outcome"] != "").all()


@pytest.mark.parametrize("ending", ["csv", "xlsx", "parquet"])
def test_every_format_is_sorted_by_a_column_that_it_need_not_have(made, tmp_path, ending):
    contents, path = made
    target = tmp_path / f"t.{ending}"
    with opened(path) as (items, attrs):
        try:
            write(table_of(items, attrs, columns=["reason"], sort="-theta_peak_over_alpha"), target)
        except StudyError as error:
            pytest.skip(str(error))
    read = {"csv": pandas.read_csv, "xlsx": pandas.read_excel, "parquet": pandas.read_parquet}[ending]
    told = read(target, **({} if ending == "parquet" else {"dtype": {"model": str}}))
    assert list(told) == ["label", "size [m]", "model", "reason"]
    peak = contents.values("theta_peak_over_alpha")
    at = [contents.values("label").tolist().index(label) for label in told["label"]]
    j = [int(np.argmin(abs(contents.values("size") - size))) for size in told["size [m]"]]
    k = [["rigid", "3"].index(model) for model in told["model"]]
    peaks = peak[at, j, k]
    assert np.isinf(peaks[0])
    assert np.isnan(peaks[-1])
    assert (np.diff(peaks[1:-1]) < 0.0).all()


def test_csv_holds_every_digit(made, tmp_path):
    contents, path = made
    with opened(path) as (items, attrs):
        write(table_of(items, attrs), tmp_path / "t.csv")
    with (tmp_path / "t.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        row["theta_peak_over_alpha"] = row["theta_peak_over_alpha"] or "nan"
    check(rows, contents)


def test_parquet_holds_every_digit(made, tmp_path):
    pytest.importorskip("pyarrow")
    contents, path = made
    with opened(path) as (items, attrs):
        write(table_of(items, attrs), tmp_path / "t.parquet")
    check(pandas.read_parquet(tmp_path / "t.parquet").astype(object).to_dict("records"), contents)


def test_a_workbook_holds_numbers_and_words(made, tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    contents, path = made
    with opened(path) as (items, attrs):
        write(table_of(items, attrs), tmp_path / "t.xlsx")
    head, *cells = openpyxl.load_workbook(tmp_path / "t.xlsx").active.iter_rows(values_only=True)
    rows = [dict(zip(head, row, strict=True)) for row in cells]
    assert rows[2]["theta_peak_over_alpha"] == "inf"
    assert rows[29]["theta_peak_over_alpha"] is None
    assert isinstance(rows[0]["size [m]"], int | float)
    for row in rows:
        row["theta_peak_over_alpha"] = "nan" if row["theta_peak_over_alpha"] is None else row["theta_peak_over_alpha"]
    check(rows, contents, 1e-15)  # openpyxl writes 16 digits


@pytest.mark.parametrize("word", ["=1+2", "=as built", "#N/A", "+x", "-1", "007", "TRUE"])
def test_a_label_is_text_in_a_workbook_too(made, tmp_path, word):
    openpyxl = pytest.importorskip("openpyxl")
    contents, path = made
    contents.fields["label"] = axis_field("label", "case", [word, "b", "c"], numeric=False, unit="1")
    netcdf.write(contents, path)
    with opened(path) as (items, attrs):
        write(table_of(items, attrs), tmp_path / "t.xlsx")
    cell = openpyxl.load_workbook(tmp_path / "t.xlsx").active["A2"]
    assert (cell.value, cell.data_type) == (word, "s")


def test_the_dataframe_is_the_same_table(made):
    contents, _ = made
    found = rockcli.table(to_xarray(contents))
    check(found.astype(object).to_dict("records"), contents)


def test_degrees_and_g_are_told_in_the_head(made):
    contents, path = made
    found = rockcli.table(to_xarray(contents), columns=["alpha"], degrees=True)
    assert list(found) == ["label", "size [m]", "model", "alpha [deg]"]
    np.testing.assert_allclose(found["alpha [deg]"], 180.0 / math.pi * np.repeat([0.1, 0.2, 0.3], 10), rtol=1e-15)
    with opened(path) as (items, attrs):
        shown = frame(table_of(items, attrs, units=units_of(items, attrs)).first(1))
    assert shown["turned [g]"][0] == contents.values("turned")[0, 0] / 10.0


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({"columns": ["alhpa"]}, "did you mean 'alpha'"),
        ({"columns": ["theta"]}, "is not in this table: it is over label, size, model, time"),
        ({"of": "fragility"}, "has no table 'fragility'; it has cases"),
        ({"of": "case"}, "is no table"),
    ],
)
def test_what_is_not_there_is_refused(made, asked, words):
    with pytest.raises(StudyError, match=words):
        rockcli.table(to_xarray(made[0]), **asked)


@pytest.mark.parametrize(("ending", "library"), [("xlsx", "openpyxl"), ("parquet", "pyarrow")])
def test_without_the_library_nothing_is_written(made, tmp_path, monkeypatch, ending, library):
    monkeypatch.setitem(sys.modules, library, None)
    words = rf"/t\.{ending}: needs {library}.*rockcli\[tables\]"
    with opened(made[1]) as (items, attrs), pytest.raises(StudyError, match=words):
        write(table_of(items, attrs), tmp_path / f"t.{ending}")
    assert [path.name for path in tmp_path.iterdir()] == ["made.nc"]


def test_a_sheet_too_long_is_refused_before_writing(tmp_path):
    pytest.importorskip("openpyxl", reason="sheets are written by openpyxl: pip install -e '.[tables]'")
    n = 1_048_576
    fields = {
        "size": axis_field("size", "block.R", np.arange(n), numeric=True, unit="m"),
        "outcome": variable_field("outcome", ("size",), np.ones(n, dtype=np.int8)),
    }
    netcdf.write(Contents(("size",), fields, {"identity": "x"}), tmp_path / "long.nc")
    with opened(tmp_path / "long.nc") as (items, attrs), pytest.raises(StudyError, match="1048576 rows"):
        write(table_of(items, attrs), tmp_path / "t.xlsx")
    assert not (tmp_path / "t.xlsx").exists()
