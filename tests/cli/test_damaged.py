"""A damaged dataset is called so, whatever is done with it; one that is whole is not."""

from __future__ import annotations

import json
import random
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from rockcli.storage import netcdf

STUDY = """\
name: d
title: first
case:
  block: {R: 2.0, tan_alpha: 0.2}
  motion: {pulse: {shape: ricker, a_p: 3*g*tan_alpha, omega_p: 3*pi}}
vary: {motion.pulse.omega_p: [8, 9, 10], model: [rigid, linearized]}
compare_to: {model: rigid}
save: {dt_out: 0.1}
expect:
  - {quantity: outcome, is_not: failed}
"""

READERS: list[tuple[str, ...]] = [
    ("run", "d.yaml", "--no-plots"),
    ("run", "d.yaml", "--no-plots", "--set", "title=second"),
    ("run", "d.yaml", "--no-plots", "--set", "vary.motion.pulse.omega_p=[8, 9, 10, 11]"),
    ("report", "results/d/d.nc"),
    ("compare", "results/d/d.nc", "whole.nc"),
    ("table", "results/d/d.nc"),
    ("plot", "results/d/d.nc", "--kind", "curve"),
]


@pytest.fixture
def made(rock, tmp_path, capsys):
    (tmp_path / "d.yaml").write_text(STUDY)
    assert rock("run", "d.yaml", "--no-plots", "--quiet") == 0
    (tmp_path / "whole.nc").write_bytes((tmp_path / "results/d/d.nc").read_bytes())
    capsys.readouterr()
    return tmp_path / "results" / "d" / "d.nc"


def rewritten(path: Path, *, without: str = "", **attrs: object) -> None:
    """The dataset as another program might write it: without a variable, or with other root attributes."""
    with netCDF4.Dataset(path.parent / "copy.nc", "w") as new, netCDF4.Dataset(path) as old:
        old.set_auto_mask(False)
        for name, dimension in old.dimensions.items():
            new.createDimension(name, len(dimension))
        for name, variable in old.variables.items():
            if name != without:
                copy = new.createVariable(name, variable.dtype, variable.dimensions)
                copy.setncatts({key: variable.getncattr(key) for key in variable.ncattrs() if key != "_FillValue"})
                copy[...] = variable[...]
        for name in old.ncattrs():
            if attrs.get(name, "") is not None:
                new.setncattr_string(name, attrs.get(name, old.getncattr(name)))
    (path.parent / "copy.nc").replace(path)


def test_a_whole_one_is(made, rock, capsys):
    assert netcdf.is_intact(made) is True
    for command in READERS:
        assert rock(*command) == 0, command
        assert "damaged" not in capsys.readouterr().err
    assert netcdf.is_intact(made) is True


@pytest.mark.parametrize(
    "damage",
    [
        {"without": "outcome"},
        pytest.param({"without": "omega_p"}, marks=pytest.mark.slow),
        pytest.param({"warnings": "["}, marks=pytest.mark.slow),
        pytest.param({"axes": "omega_p nothing"}, marks=pytest.mark.slow),
        {"solver_settings": "7"},
    ],
)
def test_one_that_lacks_something(damage, made, rock, capsys):
    rewritten(made, **damage)
    assert netcdf.is_intact(made) is False
    for command in READERS:
        code, said = rock(*command), capsys.readouterr().err
        assert "this is a bug" not in said, (command, said)
        assert code in (0, 1, 2), command  # what does not need what is missing does without it
        if command[0] == "run":
            assert code == 2
            assert "d.nc is damaged, or was changed by another program; --fresh" in said


def test_one_value_that_has_changed(made, rock, capsys):
    with netCDF4.Dataset(made, "a") as file:
        file["theta_peak_over_alpha"][0, 0] = np.nextafter(file["theta_peak_over_alpha"][0, 0], 1.0)
    assert rock("run", "d.yaml") == 2
    assert "is damaged, or was changed" in capsys.readouterr().err
    assert rock("run", "d.yaml", "--no-plots", "--fresh") == 0
    assert netcdf.is_intact(made) is True


def test_one_value_that_has_changed_is_told_by_whoever_reads(made, rock, capsys, monkeypatch):
    with netCDF4.Dataset(made, "a") as file:
        file["theta_peak_over_alpha"][0, 0] = np.nextafter(file["theta_peak_over_alpha"][0, 0], 1.0)
    commands = [("table", made), ("table", made, "--out", "t.csv"), ("compare", made, "whole.nc", "--rtol", "0.1")]
    for command in (*commands, ("report", made), ("plot", made, "--kind", "curve")):
        assert rock(*command) == 0
        said = capsys.readouterr()
        assert said.err.count("d.nc: warning: is damaged, or was changed by another program") == 1, command
        assert "damaged" not in said.out
    monkeypatch.setattr(netcdf, "_SOON", 10)  # as of a dataset that takes long to sum
    assert rock("table", made) == 0
    assert "damaged" not in capsys.readouterr().err


def test_bytes_that_are_cut_off_or_turned(made, rock, capsys):
    whole, chance = made.read_bytes(), random.Random(5)
    for trial in range(12):
        data = bytearray(whole[: chance.randrange(len(whole))] if trial % 4 == 0 else whole)
        if trial % 4:
            for _ in range(30):
                data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
        made.write_bytes(data)
        for command in (READERS[0], READERS[4]):
            code, said = rock(*command), capsys.readouterr().err
            assert "this is a bug" not in said, (trial, command, said)
            assert code in (0, 1, 2), (trial, command, said)
            assert command[0] != "run" or code == 2 or netcdf.is_intact(made), (trial, said)


def test_what_is_read_first_is_not_blamed_for_a_bug(made, rock, capsys, monkeypatch):
    def stumble(*args, **options):
        raise KeyError("outcome")

    monkeypatch.setattr("rockcli.analysis.compare_datasets.difference", stumble)
    assert rock("compare", made, "whole.nc") == 4
    assert "this is a bug in rock: KeyError" in capsys.readouterr().err


def test_one_of_an_earlier_build_has_no_checksum(made, rock):
    rewritten(made, checksum=None)
    assert netcdf.is_intact(made) is None
    assert rock("run", "d.yaml", "--no-plots") == 0


def test_datasets_of_a_folder_are_verified(rock, made, capsys):
    """One that is whole, one of which a number was changed, one cut off, one without a checksum."""
    folder = made.parent.parent
    (made.parent / ".d.4711.part.nc").write_text("a run is writing")
    assert rock("verify", folder) == 0
    assert capsys.readouterr().out == "1 dataset, 1 intact\n"
    for name in ("changed", "cut", "old"):
        (folder / f"{name}.nc").write_bytes(made.read_bytes())
    with netCDF4.Dataset(folder / "changed.nc", "a") as file:
        file["theta_peak_over_alpha"][0] += 1e-9
    (folder / "cut.nc").write_bytes(made.read_bytes()[:5000])
    with netCDF4.Dataset(folder / "old.nc", "a") as file:
        file.delncattr("checksum")
    assert rock("verify", made, folder / "old.nc") == 0
    capsys.readouterr()
    assert rock("verify", folder, "--json") == 1
    told = {Path(one["file"]).stem: one["intact"] for one in json.loads(capsys.readouterr().out)}
    assert told == {"changed": False, "cut": False, "old": None, "d": True}
    assert rock("verify", folder) == 1
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith(f"{folder / 'changed.nc'}: damaged, or changed")
    assert said[1].startswith(f"{folder / 'cut.nc'}: damaged")
    assert said[2:] == [f"{folder / 'old.nc'}: without a checksum", "4 datasets, 1 intact"]
    assert rock("verify", folder / "gone.nc") == 2
