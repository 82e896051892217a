"""The records in the repository are what their script makes, and are plausible motions."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import yaml

from rockcli.motion.measures import displacement, measures, velocity
from rockcli.motion.reading import read_record

RECORDS = Path(__file__).parents[2] / "records"


@pytest.fixture(scope="module")
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_records", RECORDS / "make_records.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_the_script_makes_the_files(script: ModuleType, tmp_path: Path) -> None:
    names = {path.name for path in RECORDS.glob("*.AT2")}
    assert names == {scenario.name for scenario in script.SCENARIOS}
    for scenario in script.SCENARIOS:
        script.write(scenario, tmp_path)
        made, kept = read_record(tmp_path / scenario.name), read_record(RECORDS / scenario.name)
        assert made.header == kept.header
        assert made.dt == kept.dt
        np.testing.assert_allclose(made.values, kept.values, rtol=1.1e-7, atol=1e-12)


@pytest.mark.parametrize("path", sorted(RECORDS.glob("*.AT2")), ids=lambda path: path.stem)
def test_the_files_are_motions(path: Path) -> None:
    motion = read_record(path)
    assert motion.header["title"][0].startswith("SYNTHETIC")
    assert motion.warnings == ()
    assert path.stat().st_size < 62_000
    a = motion.acceleration(9.81)
    found = measures(a, motion.dt)
    assert 0.25 < found["pga"] / 9.81 < 0.7
    assert 0.1 < found["pgv"] < 1.5
    assert 3.0 < found["d5_95"] < 20.0
    assert abs(velocity(a, motion.dt)[-1]) < 1e-5
    assert abs(displacement(a, motion.dt)[-1]) < 1e-4


def test_the_pulse_is_in_its_record(script: ModuleType) -> None:
    motion = read_record(RECORDS / "synthetic_pulse_m70.AT2")
    t = motion.dt * np.arange(len(motion.values))
    scenario = next(scenario for scenario in script.SCENARIOS if scenario.pulse is not None)
    pulse = script.pulse_velocity(t, scenario.pulse)
    v = velocity(motion.acceleration(9.80665), motion.dt)
    assert scenario.pulse[0] == pytest.approx(10**0.6)
    assert np.corrcoef(pulse, v)[0, 1] > 0.9


def test_the_source_spectrum_has_its_corner(script: ModuleType) -> None:
    """Below the corner frequency the source's displacement is flat, far above it falls with the square."""
    assert script.seismic_moment(7.0) == pytest.approx(10**26.55)
    corner = script.corner_frequency(6.5)
    assert corner == pytest.approx(4.9e6 * 3.7 * (140.0 / 10**25.8) ** (1 / 3))
    f = np.array([corner])
    scenario = next(scenario for scenario in script.SCENARIOS if scenario.magnitude == 6.5)
    constant = 0.55 * 0.707 * 2.0 / (4.0 * np.pi * 2.8 * 3.7**3) * 1e-20 / 15.0 * 10**25.8 / 2.0 / 100.0
    ratio = script.target_spectrum(f, scenario) / ((2.0 * np.pi * f) ** 2 * constant)
    assert 0.9 < float(ratio[0]) < 1.3  # what is left is path, site and high-pass


def test_catalog() -> None:
    catalog = yaml.safe_load((RECORDS / "catalog.yaml").read_text(encoding="utf-8"))
    keys = ["id", "event", "date", "station", "component", "pga_g", "nga", "file_names", "how_to_obtain", "note"]
    assert len(catalog) == 11
    assert len({entry["id"] for entry in catalog}) == 11
    names = [name for entry in catalog for name in entry["file_names"]]
    assert len(names) == len(set(names))
    for entry in catalog:
        assert list(entry) == keys
        assert isinstance(entry["component"], str)
        assert isinstance(entry["date"], str)
        assert 0.1 < entry["pga_g"] < 1.3
        assert all(name.endswith(f"{entry['component']}.AT2") for name in entry["file_names"])
