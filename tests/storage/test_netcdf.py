"""What is written is what is read, with the attributes the contract names."""

from __future__ import annotations

from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray

from rockcli.errors import OutputError, StudyError
from rockcli.storage import netcdf
from rockcli.storage.atomic import replacing, sweep_leftovers
from rockcli.storage.contents import (
    Contents,
    Field,
    axis_field,
    reasons_field,
    root_attributes,
    time_field,
    variable_field,
)
from rockcli.storage.read import open_dataset, to_xarray

ATTRS = root_attributes(
    title="Two models",
    source="rockcli",
    history="2026 solved",
    references="Fig. 1",
    more={"identity": "abc", "study": "name: x\n"},
)


def contents() -> Contents:
    axes = ("tan_alpha", "model")
    fields: dict[str, Field] = {
        "tan_alpha": axis_field("tan_alpha", "block.tan_alpha", (0.1, 0.2, 0.3), numeric=True, unit="1"),
        "model": axis_field("model", "model", ("rigid", "3"), numeric=False, unit="1"),
        "R": variable_field("R", (), np.asarray(5.0)),
        "alpha": variable_field("alpha", ("tan_alpha",), np.arctan([0.1, 0.2, 0.3])),
        "time": time_field(np.arange(4) * 0.5),
        "outcome": variable_field("outcome", axes, np.array([[0, 1], [2, 3], [-2, -1]], dtype=np.int8)),
        "theta_peak_over_alpha": variable_field(
            "theta_peak_over_alpha", axes, np.array([[0, 0.5], [np.inf] * 2, [np.nan] * 2])
        ),
        "n_impacts": variable_field("n_impacts", axes, np.arange(6).reshape(3, 2)),
        "reason": variable_field("reason", axes, np.array([[0, 0], [0, 0], [1, 0]], dtype=np.int32)),
        "reasons": reasons_field(["", "gave up: θ is not a number"]),
        "theta": variable_field(
            "theta", (*axes, "time"), np.where(np.arange(24) % 4 > 2, np.nan, 0.01).reshape(3, 2, 4)
        ),
        "t_impact": variable_field("t_impact", (*axes, "impact"), np.full((3, 2, 1), np.nan)),
    }
    return Contents(axes, fields, ATTRS)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    file = tmp_path / "x.nc"
    netcdf.write(contents(), file)
    return file


def test_memory_equals_file(path: Path) -> None:
    xarray.testing.assert_identical(to_xarray(contents()), open_dataset(path))


def test_plain_arrays_return(path: Path) -> None:
    written, found = contents(), netcdf.read(path)
    assert (found.axes, found.shape, found.attrs) == (written.axes, written.shape, written.attrs)
    assert list(found.fields) == list(written.fields)
    for name, item in written.fields.items():
        other = found.fields[name]
        assert other.dims == item.dims, name
        assert other.coordinate == item.coordinate, name
        assert other.values.dtype == item.values.dtype, name
        np.testing.assert_array_equal(other.values, item.values)


def test_outcome_is_a_flag_without_fill_value(path: Path) -> None:
    with netCDF4.Dataset(path) as file:
        outcome = file["outcome"]
        assert outcome.dtype == np.int8
        assert "_FillValue" not in outcome.ncattrs()
        assert outcome.flag_values.dtype == np.int8
        assert list(outcome.flag_values) == [-2, -1, 0, 1, 2, 3, 4]
        assert outcome.flag_meanings.split() == [
            "failed",
            "unresolved",
            "no_uplift",
            "rocking",
            "overturned_without_impact",
            "overturned_after_impact",
            "sliding",
        ]
    flags = open_dataset(path)["outcome"]
    assert flags.dtype == np.int8


def test_every_number_has_a_unit_and_a_sentence(path: Path) -> None:
    with netCDF4.Dataset(path) as file:
        assert file.Conventions == "CF-1.11"
        assert file.title == "Two models"
        for name, variable in file.variables.items():
            assert variable.long_name, name
            if variable.dtype is not str and name not in ("outcome", "reason"):
                assert variable.units, name
        assert file["time"].units == "s"
        assert "standard_name" not in file["time"].ncattrs()
        assert "_FillValue" not in file["alpha"].ncattrs()
        assert np.isnan(file["theta"]._FillValue)
        assert set(file["theta"].coordinates.split()) == {"R", "alpha"}


def test_times_stay_numbers_and_labels_strings(path: Path) -> None:
    found = open_dataset(path)
    assert found["time"].dtype == np.float64
    assert found["model"].values.tolist() == ["rigid", "3"]
    assert float(found["theta_peak_over_alpha"].sel(tan_alpha=0.1, model="3")) == 0.5
    assert set(found.coords) >= {"R", "alpha", "tan_alpha", "model", "time"}


def test_without_axes_scalars_have_no_dims(tmp_path: Path) -> None:
    one = Contents((), {"theta_peak": variable_field("theta_peak", (), np.asarray(-0.25))}, ATTRS)
    netcdf.write(one, tmp_path / "one.nc")
    found = open_dataset(tmp_path / "one.nc")
    assert found["theta_peak"].dims == ()
    assert float(found["theta_peak"]) == -0.25
    xarray.testing.assert_identical(to_xarray(one), found)


def test_a_failed_write_leaves_what_was_there(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = path.read_bytes()

    def breaks(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(netcdf.Writer, "_write_field", breaks)
    with pytest.raises(KeyboardInterrupt):
        netcdf.write(contents(), path)
    assert path.read_bytes() == before
    assert [file.name for file in path.parent.iterdir()] == [path.name]


def test_what_was_written_ahead_is_no_more_than_that(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Values that lie elsewhere in the end, or an order that is not that of the contents, are written anew."""
    monkeypatch.setattr(netcdf, "_COMPRESSED_FROM", 1)
    monkeypatch.setattr(netcdf, "_PIECE", 2)
    wanted, names = contents(), ("tan_alpha", "model", "theta_peak_over_alpha")
    wanted.fields["theta_peak_over_alpha"].values[:] += 0.25
    for last in (names, names[::-1]):
        with netcdf.Writer(tmp_path / "x.nc") as file:
            file.begin({name: contents().fields[name] for name in last})
            file.write_known(4)
            assert "theta_peak_over_alpha" in file._rests
            file.finish(wanted)
        assert netcdf.is_intact(tmp_path / "x.nc")
        xarray.testing.assert_identical(to_xarray(wanted), open_dataset(tmp_path / "x.nc"))


def test_what_the_library_does_not_tell_may_be_memory(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It has the same words where it gets none, while the disk takes what it is asked to."""

    def refused(*_: object) -> None:
        raise RuntimeError("NetCDF: HDF error")

    contents = netcdf.read(path)
    monkeypatch.setattr(netcdf.Writer, "_write", refused)
    with pytest.raises(OutputError, match=r"no space or memory left, .* \(NetCDF: HDF error\)"):
        netcdf.write(contents, path)


def test_scratch_files_of_killed_runs_are_swept(tmp_path: Path) -> None:
    left = tmp_path / ".x.1234.part.nc"
    left.write_text("half")
    with replacing(tmp_path / "x.nc") as scratch:
        assert scratch.parent == tmp_path
        scratch.write_text("whole")
    sweep_leftovers(tmp_path)
    assert [file.name for file in tmp_path.iterdir()] == ["x.nc"]


def test_identity_of_a_file(path: Path, tmp_path: Path) -> None:
    assert netcdf.identity(path) == "abc"
    (tmp_path / "not.nc").write_text("hello")
    assert netcdf.identity(tmp_path / "not.nc") is None
    assert netcdf.identity(tmp_path / "absent.nc") is None


def test_what_is_not_a_dataset_is_refused(tmp_path: Path) -> None:
    (tmp_path / "not.nc").write_text("hello")
    for file in (tmp_path / "not.nc", tmp_path / "absent.nc"):
        with pytest.raises(StudyError):
            open_dataset(file)
        with pytest.raises(StudyError):
            netcdf.read(file)
    xarray.Dataset({"a": 1.0}).to_netcdf(tmp_path / "other.nc")
    with pytest.raises(StudyError, match="not a dataset written by"):
        netcdf.read(tmp_path / "other.nc")
