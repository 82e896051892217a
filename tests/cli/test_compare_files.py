"""`rock compare A.nc B.nc`: exit codes, shared points, the worst points named."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from rockcli.analysis.compare_datasets import difference
from rockcli.cli.main import app
from rockcli.engine.run import solve
from rockcli.errors import StudyError
from rockcli.scene.response import FAILED, NO_UPLIFT, ROCKING
from rockcli.scene.variables import PEAK
from rockcli.storage import netcdf
from rockcli.storage.contents import Contents, Field
from rockcli.study.open import open_study

RECORD = "synthetic_rock_m65.AT2"


def dataset(amplitudes: list[float], **block: float) -> Contents:
    study = {
        "name": "pair",
        "case": {
            "block": {"R": 2.0, "tan_alpha": 0.2} | block,
            "motion": {"pulse": {"shape": "ricker", "a_p_over_g_tan_alpha": 2.0, "omega_p": "3*pi"}},
        },
        "vary": {"motion.pulse.a_p_over_g_tan_alpha": amplitudes, "model": ["rigid", 3]},
        "save": {"histories": False},
    }
    return solve(open_study(study))


@pytest.fixture(scope="module")
def first() -> Contents:
    return dataset([0.5, 2.0, 3.6, 9.0])


def changed(contents: Contents, name: str, at: tuple[Any, ...], value: Any) -> Contents:
    values = contents.values(name).copy()
    values[at] = value
    item = contents.fields[name]
    return Contents(
        contents.axes, contents.fields | {name: Field(item.dims, values, item.attrs, item.coordinate)}, contents.attrs
    )


def test_a_dataset_is_the_same_as_itself(first: Contents) -> None:
    found = difference(first, first, rtol=0.0, atol=0.0)
    assert found.same
    assert (found.points, found.only_a, found.only_b, found.largest) == (8, 0, 0, 0.0)


def test_peaks_within_and_beyond_the_tolerance(first: Contents) -> None:
    peak = first.values("theta_peak_over_alpha")[2, 0]
    other = changed(first, "theta_peak_over_alpha", (2, 0), peak * 1.001)
    assert difference(first, other, rtol=2e-3).same
    found = difference(first, other, rtol=1e-4)
    assert (found.outcomes, found.peaks) == (0, 1)
    assert found.largest == pytest.approx(1e-3 / 1.001)
    assert found.worst[0][0] == "a_p_over_g_tan_alpha=3.6, model=rigid"


def test_another_outcome_comes_first(first: Contents) -> None:
    flag = first.values("outcome")[1, 1]
    other = changed(changed(first, "outcome", (1, 1), -1), "theta_peak_over_alpha", (2, 0), 7.0)
    found = difference(first, other, rtol=1e-6)
    assert (found.outcomes, found.peaks) == (1, 1)
    assert "unresolved" in found.worst[0][1]
    assert flag != -1


def test_slides_of_bodies_that_stand_are_compared() -> None:
    """v²/(2 mu g), pushed at v = 1 m/s; a body that overturns has no slide that could be held against another."""
    cases = [{"block": {"h": 1.0, "b": 0.25, "mu": mu}, "initial": {"slide_rate": 1.0}} for mu in (0.2, 0.1)]
    one, other = (solve(open_study({"name": "pushed", "case": case})) for case in cases)
    assert difference(one, one, rtol=0.0, atol=0.0).same
    found = difference(one, other, rtol=1e-6)
    assert not found.same
    assert (found.outcomes, found.peaks) == (0, 1)
    assert found.largest == pytest.approx(0.5)
    before, after = found.worst[0][1].partition("slide ")[2].removesuffix(" m").split(" -> ")
    assert (float(before), float(after)) == pytest.approx((1.0 / (0.4 * 9.81), 1.0 / (0.2 * 9.81)))
    assert not difference(changed(one, "outcome", (), 3), changed(other, "outcome", (), 3), rtol=1e-6).peaks


def test_an_answer_lost_is_a_difference(first: Contents) -> None:
    other = changed(first, "theta_peak_over_alpha", (2, 0), np.nan)
    assert difference(first, other, rtol=1.0).peaks == 1
    assert difference(other, other, rtol=0.0).same


def test_an_answer_lost_is_no_difference_of_0(first: Contents, tmp_path: Path) -> None:
    """Two peaks apart by a thousandth and by a half, one lost, one in neither: the lost one is the worst."""
    at = [(0, 0), (2, 0), (2, 1), (1, 0)]
    before = after = first
    for place, one, other in zip(at, (0.2, 0.2, 0.2, np.nan), (0.2 * 1.001, 0.4, np.nan, np.nan), strict=True):
        before, after = changed(before, PEAK, place, one), changed(after, PEAK, place, other)
    before, after = (
        changed(before, PEAK, ([0, 1, 3, 3], [1, 1, 0, 1]), np.inf),
        changed(after, PEAK, ([0, 1, 3, 3], [1, 1, 0, 1]), np.inf),
    )
    found = difference(before, after, rtol=1e-6)
    assert found.peaks == 3
    assert found.worst[0][1] == "peak 0.2 -> nan"
    assert found.median == pytest.approx(0.5 * (1e-3 / 1.001 + 0.5))
    lost = changed(first, PEAK, (slice(None), slice(None)), np.nan)
    assert np.isnan(difference(first, lost, rtol=1e-6).largest)
    paths = [str(tmp_path / "a.nc"), str(tmp_path / "b.nc")]
    for path, contents in zip(paths, (first, lost), strict=True):
        netcdf.write(contents, Path(path))
    assert "  peaks     8 beyond rtol 1e-06\n" in CliRunner().invoke(app, ["compare", *paths]).stdout


def test_points_of_one_only_are_counted_and_axes_may_be_in_another_order(first: Contents) -> None:
    second = dataset([2.0, 3.6, 4.0])
    flipped = {
        name: Field(f.dims[::-1], np.asarray(f.values).T, f.attrs, f.coordinate) if f.dims == second.axes else f
        for name, f in second.fields.items()
    }
    found = difference(first, Contents(second.axes[::-1], flipped, second.attrs), rtol=1e-12)
    assert found.same
    assert (found.points, found.only_a, found.only_b) == (4, 4, 2)


@pytest.mark.parametrize("off", [-1e-12, 1e-12])
def test_points_off_by_rounding_are_the_same_points(first: Contents, off: float) -> None:
    axis = first.axes[0]
    found = difference(first, changed(first, axis, (...,), first.values(axis) * (1.0 + off)), rtol=0.0, atol=0.0)
    assert found.same
    assert (found.points, found.only_a, found.only_b) == (8, 0, 0)


BODIES = {"low": (2.0, 0.5), "high": (3.0, 0.5)}


def bodies(vary: dict[str, object]) -> Contents:
    """Two bodies on two models, which axes of labels give."""
    case = {"block": {"height": 1.0, "width": 1.0}, "initial": {"theta": 0.1}}
    return solve(open_study({"name": "bodies", "case": case, "vary": vary, "save": {"histories": False}}))


def test_settings_of_a_table_are_those_by_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An axis of labels is compared with one of another name and the same labels, in any order."""
    monkeypatch.chdir(tmp_path)
    rows = [f"{label},{height},{width}\n" for label, (height, width) in reversed(BODIES.items())]
    Path("bodies.csv").write_text("name,block.height,block.width\n" + "".join(rows))
    named = bodies(
        {"block": {label: {"height": h, "width": w} for label, (h, w) in BODIES.items()}, "model": ["rigid", 3]}
    )
    table = bodies({"model": ["rigid", 3], "case": "bodies.csv"})
    found = difference(named, table, rtol=0.0, atol=0.0)
    assert found.same
    assert (found.points, found.only_a, found.only_b) == (4, 0, 0)
    assert found.paired == {"block": "case"}
    assert np.unique(named.values("theta_peak_over_alpha")).size > 1
    for name, contents in (("named", named), ("table", table)):
        netcdf.write(contents, tmp_path / f"{name}.nc")
    told = CliRunner().invoke(app, ["compare", "named.nc", "table.nc"])
    assert "the axis case of the second is taken for block: its labels are the same" in told.stdout


def test_axes_of_other_labels_are_said_with_what_to_do() -> None:
    one = bodies({"block": {label: {"height": h, "width": w} for label, (h, w) in BODIES.items()}})
    other = bodies({"case": {f"the {label}": {"block.height": h} for label, (h, _) in BODIES.items()}})
    with pytest.raises(
        StudyError, match=r"other axes: block \('low', 'high'\) in the first, case \('the low', .*same labels"
    ):
        difference(one, other, rtol=1e-6)


def test_axes_of_one_name_and_another_key_are_not_compared() -> None:
    """A scale of the horizontal motion is none of the vertical one; a symbol may stand for either."""
    both = {"record": {"file": RECORD}, "vertical": {"file": RECORD, "scale": 0.5}}

    def of(path: str, motion: dict[str, Any] = both) -> Contents:
        case = {"block": {"height": 2.0, "width": 1.0}, "motion": motion}
        study = {"name": "x", "let": {"scale": 1}, "case": case, "vary": {path: [0.5, 1]}, "save": {"histories": False}}
        return solve(open_study(study))

    one, other, same = of("motion.record.scale"), of("motion.vertical.record.scale"), of("motion.vertical.scale")
    for wrong in ((one, other), (one, same)):
        with pytest.raises(
            StudyError, match=r"the axis scale is case\.motion\.record\.scale in the first and case.*vert"
        ):
            difference(*wrong, rtol=1e-6)
    assert difference(other, same, rtol=0.0).same
    symbol = of("let.scale", {"record": {"file": RECORD, "scale": "scale"}, "vertical": both["vertical"]})
    assert difference(one, symbol, rtol=0.0).same


def test_what_cannot_be_compared(first: Contents) -> None:
    words = (
        r"no point in common: a_p_over_g_tan_alpha \(0.5, 2, 3.6, 9\) in the first, a_p_over_g_tan_alpha \(1\) in the"
    )
    with pytest.raises(StudyError, match=words):
        difference(first, dataset([1.0]), rtol=1e-6)
    single = open_study({"name": "one", "case": {"block": {"R": 2, "tan_alpha": 0.2}, "initial": {"theta": 0.1}}})
    with pytest.raises(StudyError, match="other axes"):
        difference(first, solve(single), rtol=1e-6)


def test_the_command(first: Contents, tmp_path: Path) -> None:
    a, b = tmp_path / "a.nc", tmp_path / "b.nc"
    netcdf.write(first, a)
    netcdf.write(dataset([0.5, 2.0, 3.6, 9.0], R=2.0001), b)
    rock = CliRunner()
    assert rock.invoke(app, ["compare", str(a), str(a)]).exit_code == 0
    told = rock.invoke(app, ["compare", str(a), str(b), "--most", "1"])
    assert told.exit_code == 1
    assert "8 points in both" in told.stdout
    assert "a_p_over_g_tan_alpha=3.6" in told.stdout
    assert rock.invoke(app, ["compare", str(a), str(b), "--rtol", "0.01"]).exit_code == 0
    summary = json.loads(rock.invoke(app, ["compare", str(a), str(b), "--json"]).stdout)
    assert summary["same"] is False
    assert summary["points"] == 8
    assert summary["quantity"] == "theta_peak_over_alpha"
    assert sum(summary["changes"].values()) == summary["outcomes"]


def test_a_refined_map_has_the_peaks_of_what_it_solved(tmp_path: Path) -> None:
    """Held against the whole map: outcomes everywhere, peaks where it has them; one of these and one outcome changed."""
    pulse = {"shape": "ricker", "omega_p_over_p": 2, "a_p_over_g_tan_alpha": 2}
    vary = {
        "motion.pulse.omega_p_over_p": {"from": 0.1, "to": 10, "n": 110},
        "motion.pulse.a_p_over_g_tan_alpha": {"from": 1, "to": 10.9, "n": 110},
    }
    case = {"block": {"R": 1, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}
    asked = {"name": "map", "case": case, "vary": vary, "save": {"scalars": ["outcome", PEAK], "histories": False}}
    refined, whole = (solve(open_study(asked | more)) for more in ({"refine": True}, {}))
    solved = refined.values("solved") == 1
    wrong = int((refined.values("outcome") != whole.values("outcome")).sum())
    found = difference(refined, whole, rtol=1e-6)
    assert (found.points, found.filled, found.outcomes, found.peaks) == (12100, int((~solved).sum()), wrong, 0)
    finite = solved & np.isfinite(whole.values(PEAK)) & (whole.values(PEAK) > 0.1)
    (at, *_), (other, *_) = np.argwhere(finite), np.argwhere(~solved)
    changed_there = changed(whole, PEAK, tuple(at), 0.05)
    changed_there = changed(changed_there, "outcome", tuple(other), FAILED)
    found = difference(changed_there, refined, rtol=1e-6)
    assert (found.outcomes, found.peaks) == (wrong + 1, 1)
    paths = [str(tmp_path / "a.nc"), str(tmp_path / "b.nc")]
    for path, contents in zip(paths, (refined, whole), strict=True):
        netcdf.write(contents, Path(path))
    told = CliRunner().invoke(app, ["compare", *paths]).stdout
    assert f"{int((~solved).sum())} of which a refined map filled in" in told


def test_changes_of_the_outcome_are_counted(first: Contents) -> None:
    before = after = first
    for at, one, other in (((1, 0), NO_UPLIFT, ROCKING), ((2, 0), ROCKING, FAILED), ((2, 1), ROCKING, FAILED)):
        before, after = changed(before, "outcome", at, one), changed(after, "outcome", at, other)
    found = difference(before, after, rtol=1e-6)
    assert list(found.changes.items()) == [("rocking -> failed", 2), ("no_uplift -> rocking", 1)]
    assert found.outcomes == 3


def searched(**more: object) -> Contents:
    study = {
        "name": "search",
        "case": {
            "block": {"R": 2.0, "tan_alpha": 0.2},
            "motion": {"pulse": {"shape": "sine", "a_p": 1.0, "omega_p_over_p": 4}},
            **more,
        },
        "vary": {
            "motion.pulse.omega_p_over_p": [2.0, 4.0, 8.0],
            "motion.pulse.a_p": {"from": "0.2*g", "to": "1.2*g", "n": 20, "find": "overturning"},
        },
    }
    return solve(open_study(study))


def test_what_two_searches_found_is_compared(tmp_path: Path) -> None:
    one, other = searched(), searched(damping={"scheme": "restitution", "eta": 0.8})
    same = difference(one, one, rtol=1e-6)
    assert (same.same, same.points, same.quantity) == (True, 3, "motion_pulse_a_p_overturning")
    found = difference(one, other, rtol=1e-3)
    a, b = (x.values("motion_pulse_a_p_overturning") for x in (one, other))
    both = np.isfinite(a) & np.isfinite(b)
    assert (
        found.outcomes
        == (
            one.values("motion_pulse_a_p_overturning_state") != other.values("motion_pulse_a_p_overturning_state")
        ).sum()
    )
    assert found.peaks == (np.abs(b[both] - a[both]) > 1.001e-3 * np.maximum(a, b)[both]).sum() > 0
    near = changed(
        one,
        "motion_pulse_a_p_overturning_high",
        (0,),
        float(one.values("motion_pulse_a_p_overturning_high")[0]) * (1 + 1e-8),
    )
    assert difference(one, near, rtol=0.0).same  # within the bracket
    paths = [tmp_path / "a.nc", tmp_path / "b.nc"]
    for path, contents in zip(paths, (one, other), strict=True):
        netcdf.write(contents, path)
    told = CliRunner().invoke(app, ["compare", *map(str, paths)])
    assert told.exit_code == 1
    assert "motion_pulse_a_p_overturning" in told.stdout
    assert f"{a[0] / 9.81:.9g} -> {b[0] / 9.81:.9g} g" in told.stdout


def test_two_searches_of_other_axes_say_what_each_found() -> None:
    one = searched()
    other = changed(one, "motion_pulse_a_p_overturning", (0,), 1.0)
    fields = {name.replace("motion_pulse_a_p_over", "scale_over"): item for name, item in other.fields.items()}
    with pytest.raises(
        StudyError, match=r"a search found \(motion_pulse_a_p_overturning in the first, scale_overturning in the"
    ):
        difference(one, Contents(other.axes, fields, other.attrs), rtol=1e-6)


def test_what_else_is_apart_is_told(first: Contents, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Peaks that differ since the bodies do are no change of the program: both are said."""
    old = Contents(first.axes, first.fields, first.attrs | {"source": "rockcli 0.1.0"})
    netcdf.write(old, tmp_path / "a.nc")
    netcdf.write(dataset([0.5, 2.0, 3.6, 9.0], R=2.5), tmp_path / "b.nc")
    result = CliRunner().invoke(app, ["compare", str(tmp_path / "a.nc"), str(tmp_path / "b.nc")])
    assert result.exit_code == 1
    assert "study     differs in case.block.R (2.0 -> 2.5)" in result.stdout
    assert f"program   rockcli 0.1.0 -> {first.attrs['source']}" in result.stdout


def test_two_folders_are_compared_by_name(first: Contents, tmp_path: Path) -> None:
    other = changed(first, "theta_peak_over_alpha", (2, 0), 7.0)
    for folder, name, contents in (
        ("old", "one", first),
        ("old", "two", first),
        ("old", "gone", first),
        ("new", "one", first),
        ("new", "two", other),
        ("new", "three", first),
    ):
        (tmp_path / folder / name).mkdir(parents=True)
        netcdf.write(contents, tmp_path / folder / name / f"{name}.nc")
    (tmp_path / "old" / ".one.4711.part.nc").write_text("a run is writing")
    asked = ["compare", str(tmp_path / "old"), str(tmp_path / "new")]
    result = CliRunner().invoke(app, asked)
    assert result.exit_code == 1
    lines = result.stdout.splitlines()
    assert lines[0] == f"{Path('two', 'two.nc')}: 8 points in both"
    assert lines[-1] == "2 datasets in both: 1 the same, 1 differs"
    assert f"only in the first, not compared: {Path('gone', 'gone.nc')}" in lines
    assert f"only in the second, not compared: {Path('three', 'three.nc')}" in lines
    told = json.loads(CliRunner().invoke(app, [*asked, "--json"]).stdout)
    assert [(one["name"], one["same"]) for one in told["datasets"]] == [
        (str(Path("one", "one.nc")), True),
        (str(Path("two", "two.nc")), False),
    ]
    assert not told["same"]
    (tmp_path / "new" / "two" / "two.nc").write_text("damaged")
    assert isinstance(CliRunner().invoke(app, asked).exception, StudyError)
    (tmp_path / "old" / "two" / "two.nc").unlink()
    assert CliRunner().invoke(app, asked).exit_code == 0
    (tmp_path / "empty").mkdir()
    for other_place in ("empty", "old/one/one.nc"):
        asked[2] = str(tmp_path / other_place)
        assert isinstance(CliRunner().invoke(app, asked).exception, StudyError)


def test_folders_say_of_equal_datasets_what_was_not_compared(first: Contents, tmp_path: Path) -> None:
    """A dataset that has one point of the other's is not simply the same."""
    for folder, contents in (("old", first), ("new", dataset([0.5, 2.5]))):
        (tmp_path / folder).mkdir()
        old = {"source": "rockcli 0.1.0"} if folder == "old" else {}
        netcdf.write(Contents(contents.axes, contents.fields, contents.attrs | old), tmp_path / folder / "one.nc")
    result = CliRunner().invoke(app, ["compare", str(tmp_path / "old"), str(tmp_path / "new")])
    assert result.exit_code == 0
    program = f"rockcli 0.1.0 -> {first.attrs['source']}"
    assert result.stdout.splitlines() == [
        "one.nc: the same at 2 points in both; 6 only in the first, 2 only in the second: not compared",
        "  study     differs in vary.motion.pulse.a_p_over_g_tan_alpha ([0.5, 2.0, 3.6, 9.0] -> [0.5, 2.5])",
        f"of those that are the same: program {program}",
        "1 dataset in both: 1 the same, 0 differ",
    ]


def test_what_is_not_there_is_named(tmp_path: Path) -> None:
    (tmp_path / "results").mkdir()
    for there in (tmp_path / "results", tmp_path / "a.nc"):
        told = CliRunner().invoke(app, ["compare", str(there), str(tmp_path / "old")])
        gone = tmp_path / "old" if there.is_dir() else there
        assert isinstance(told.exception, StudyError)
        assert str(told.exception) == f"{gone}: no such file or folder"


def test_static_curves_in_folders_are_told_and_the_others_compared(first: Contents, tmp_path: Path) -> None:
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "model": 3}
    curves = solve(open_study({"name": "curves", "case": case, "curves": ["pushover"]}))
    for folder in ("old", "new"):
        (tmp_path / folder).mkdir()
        netcdf.write(curves, tmp_path / folder / "curves.nc")
    command = ["compare", str(tmp_path / "old"), str(tmp_path / "new")]
    told = CliRunner().invoke(app, command)
    assert isinstance(told.exception, StudyError)
    assert "no dataset of the same name that can be compared" in str(told.exception)
    for folder, contents in (("old", first), ("new", changed(first, "theta_peak_over_alpha", (2, 0), 7.0))):
        netcdf.write(contents, tmp_path / folder / "one.nc")
    told = CliRunner().invoke(app, command)
    assert told.exit_code == 1
    assert "without outcomes, peaks and thresholds, as static curves are, not compared: curves.nc" in told.stdout
    assert told.stdout.endswith("1 dataset in both: 0 the same, 1 differs\n")
    (tmp_path / "new" / "one.nc").unlink()
    netcdf.write(first, tmp_path / "new" / "one.nc")
    told = CliRunner().invoke(app, [*command, "--json"])
    assert told.exit_code == 0
    assert json.loads(told.stdout)["nothing_to_compare"] == ["curves.nc"]
