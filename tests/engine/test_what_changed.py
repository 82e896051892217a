"""A file that a study names, of whatever kind and however named, is changed: the old answer is never given again."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from rockcli.engine.run import run_study
from rockcli.engine.summary import UP_TO_DATE
from rockcli.errors import StudyError
from rockcli.storage import netcdf
from rockcli.study.open import open_study

PEAK = "theta_peak_over_alpha"


def motion(path: Path, version: int) -> None:
    """Two cycles of a sine in m/s^2, stronger from version to version; enough to rock on."""
    path.write_text(
        "# units: m/s2\n"
        + "".join(f"{0.02 * i:.2f},{(2.4 + 0.2 * version) * math.sin(12.0 * 0.02 * i):.6f}\n" for i in range(60))
    )


def body(path: Path, version: int) -> None:
    """A rectangle 2 m high, wider from version to version."""
    width = 0.40 + 0.02 * version
    path.write_text(f"0,0\n{width},0\n{width},2\n0,2\n")


def stone(path: Path, version: int) -> None:
    """What lies on the foot of a body of two parts, heavier from version to version."""
    height = 1.0 + 0.1 * version
    path.write_text(f"0,0.5\n0.4,0.5\n0.4,{0.5 + height}\n0,{0.5 + height}\n")


BLOCK = {"R": 2.0, "tan_alpha": 0.2}
FOOT = {"outline": [[0, 0], [0.4, 0], [0.4, 0.5], [0, 0.5]]}

Value = Callable[[str], Any]
KINDS: dict[str, tuple[Callable[[Path, int], None], str, Value, dict[str, Any]]] = {
    # what writes it, the path of the axis that names it, what an axis says there, the rest of the case
    "record": (motion, "motion.record.file", lambda name: name, {"block": BLOCK, "motion": {"record": {}}}),
    "component": (
        motion,
        "motion.record.file",
        lambda name: ["h1.csv", name],
        {"block": BLOCK, "motion": {"record": {"angle": 0.6}}},
    ),
    "vertical": (
        motion,
        "motion.vertical.record.file",
        lambda name: name,
        {"block": BLOCK, "motion": {"record": {"file": "h1.csv"}, "vertical": {"record": {}}}},
    ),
    "floor motion": (
        motion,
        "motion.record",
        lambda name: {"file": name, "scale": 1.1},
        {"block": {"height": 1.8, "width": 0.36}, "motion": {}},
    ),
    "outline": (body, "block.outline", lambda name: name, {"block": {}, "motion": {"record": {"file": "h1.csv"}}}),
    "part": (
        stone,
        "block.parts",
        lambda name: [FOOT, {"outline": name}],
        {"block": {}, "motion": {"record": {"file": "h1.csv"}}},
    ),
}
WAYS = ("base", "list", "glob", "named", "settings", "repeated", "symlink")
NO_GLOB = {"component", "floor motion", "outline", "part"}
"""A glob names one file at a point: no pair, no mapping, and records only."""


def base_with(case: dict[str, Any], path: str, value: Any) -> dict[str, Any]:
    head, _, rest = path.partition(".")
    return case | {head: base_with(case.get(head, {}), rest, value) if rest else value}


def study_of(kind: str, way: str, folder: Path) -> tuple[dict[str, Any], Callable[[], None]]:
    """A study, its files in `folder`, and what changes one of them."""
    write, path, value, case = KINDS[kind]
    motion(folder / "h1.csv", 0)
    for name in ("a", "b", "c", "suite"):
        (folder / name).mkdir()
    names = ["one.csv", "two.csv"]
    for version, name in enumerate(names):
        write(folder / name, version)

    def change() -> None:
        write(folder / "two.csv", 5)

    vary: dict[str, Any] = {path: [value(name) for name in names]}
    if way in ("base", "symlink"):
        vary, case = {}, base_with(case, path, value("two.csv"))
        if way == "symlink":
            case = base_with(case, path, value("link.csv"))
            (folder / "link.csv").symlink_to("one.csv")

            def change() -> None:
                (folder / "link.csv").unlink()
                (folder / "link.csv").symlink_to("two.csv")

    elif way == "glob":
        vary = {path: "suite/*.csv"}
        for version, name in enumerate(names):
            write(folder / "suite" / name, version)

        def change() -> None:
            write(folder / "suite" / "two.csv", 5)

    elif way == "named":
        vary = {path: {"first": value("one.csv"), "second": value("two.csv")}}
    elif way == "settings":
        vary = {"case": {"first": {path: value("one.csv")}, "second": {path: value("two.csv")}}}
    elif way == "repeated":  # one base name in three folders: the contents are the same set before and after
        vary = {path: [value(f"{place}/x.csv") for place in ("a", "b", "c")]}
        for place, version in (("a", 0), ("b", 1), ("c", 1)):
            write(folder / place / "x.csv", version)

        def change() -> None:
            write(folder / "c" / "x.csv", 0)

    return {"name": "s", "case": case, "vary": vary}, change


def tables(way: str, folder: Path) -> tuple[dict[str, Any], Callable[[], None]]:
    """A table of sizes, and one that names records."""

    def rows(height: float) -> None:
        (folder / "t.csv").write_text(f"name,height,width\nlow,1.2,0.3\nhigh,{height},0.36\n")

    motion(folder / "h1.csv", 0)
    rows(2.0)
    study = {
        "name": "s",
        "case": {"block": {}, "motion": {"record": {"file": "h1.csv"}}},
        "vary": {"block": "t.csv"},
    }
    if way == "of records":
        for version, name in enumerate(("one.csv", "two.csv")):
            motion(folder / name, version)
        (folder / "t.csv").write_text("name,motion.record.file\nfirst,one.csv\nsecond,two.csv\n")
        study |= {"case": {"block": BLOCK, "motion": {"record": {}}}, "vary": {"case": "t.csv"}}
        return study, lambda: motion(folder / "two.csv", 5)
    if way == "symlink":
        (folder / "t.csv").rename(folder / "u.csv")
        (folder / "t.csv").symlink_to("u.csv")
    return study, lambda: rows(1.7)


CASES = [(kind, way) for kind, way in itertools.product(KINDS, WAYS) if way != "glob" or kind not in NO_GLOB]
CASES += [("table", way) for way in ("of sizes", "of records", "symlink")]


def peaks(folder: Path, out: str) -> Any:
    return netcdf.read(folder / out / "s" / "s.nc").values(PEAK)


@pytest.mark.parametrize(("kind", "way"), CASES, ids=[f"{kind}-{way}" for kind, way in CASES])
def test_the_old_answer_is_never_given_again(
    kind: str, way: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given, change = tables(way, tmp_path) if kind == "table" else study_of(kind, way, tmp_path)
    given |= {"save": {"histories": False, "scalars": ["outcome", PEAK]}}

    def run(out: str, turns: list[float], *, fresh: bool = False) -> Any:
        vary = given["vary"] | {"initial.theta": turns}
        (tmp_path / "s.yaml").write_text(yaml.safe_dump(given | {"vary": vary}, sort_keys=False))
        return run_study(open_study(tmp_path / "s.yaml"), tmp_path / out, plots=False, fresh=fresh)

    run("out", [0.01, 0.02])
    assert run("out", [0.01, 0.02]).status == UP_TO_DATE
    before = peaks(tmp_path, "out")
    report = run("out", [0.01, 0.02, 0.03])  # more points keep what is there, as long as nothing has changed
    assert report.taken_over == before.size
    change()
    for turns in ([0.01, 0.02, 0.03], [0.01, 0.02, 0.03, 0.04]):
        with pytest.raises(StudyError, match="--fresh` replaces it"):
            run("out", turns)
    run("out", [0.01, 0.02, 0.03], fresh=True)
    run("new", [0.01, 0.02, 0.03])
    after = peaks(tmp_path, "new")
    np.testing.assert_array_equal(peaks(tmp_path, "out"), after)
    assert np.isfinite(before).all()
    assert not np.array_equal(before, after[..., :2])


def test_the_records_own_place_counts_as_its_bytes_do(tmp_path: Path) -> None:
    """`H1.csv` and `sub/H1.csv` as the two components of a motion, and their contents exchanged."""
    (tmp_path / "sub").mkdir()
    for version, name in enumerate(("H1.csv", "sub/H1.csv")):
        motion(tmp_path / name, version)
    given = {
        "name": "s",
        "case": {"block": BLOCK, "motion": {"record": {"file": ["H1.csv", "sub/H1.csv"], "angle": 0.3}}},
    }
    (tmp_path / "s.yaml").write_text(yaml.safe_dump(given))
    first = open_study(tmp_path / "s.yaml")
    assert set(first.inputs) == {"H1.csv", "sub/H1.csv"}
    for version, name in enumerate(("sub/H1.csv", "H1.csv")):
        motion(tmp_path / name, version)
    assert open_study(tmp_path / "s.yaml").identity != first.identity


def test_one_file_of_two_names_is_on_the_list_twice(tmp_path: Path) -> None:
    motion(tmp_path / "x.csv", 0)
    (tmp_path / "y.csv").symlink_to("x.csv")
    names = ["x.csv", "./x.csv", "y.csv"]
    case = {"block": BLOCK, "motion": {"record": {}}}
    vary = {"motion.record.file": {f"name {i}": name for i, name in enumerate(names)}}
    (tmp_path / "s.yaml").write_text(yaml.safe_dump({"name": "s", "case": case, "vary": vary}))
    assert set(open_study(tmp_path / "s.yaml").inputs) == set(names)


def test_two_files_of_one_name_are_told_apart_in_words(tmp_path: Path) -> None:
    for place in ("a", "b"):
        (tmp_path / place).mkdir()
        motion(tmp_path / place / "x.csv", 0)
    names = ["a/x.csv", "b/x.csv"]
    case = {"block": BLOCK, "motion": {"record": {}}}
    (tmp_path / "s.yaml").write_text(yaml.safe_dump({"name": "s", "case": case, "vary": {"motion.record.file": names}}))
    study = open_study(tmp_path / "s.yaml")
    assert list(study.inputs) == names
    assert list(study.processing) == ["x.csv", "b/x.csv"]


def test_the_bases_own_record_may_join_the_axis(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What an axis displaces in the base is in no case, and so not in what identifies them."""
    for version, name in enumerate(("one.csv", "two.csv", "own.csv")):
        motion(tmp_path / name, version)

    def run(names: list[str], own: str = "own.csv") -> Any:
        given = {
            "name": "s",
            "case": {"block": BLOCK, "motion": {"record": {"file": own}}},
            "vary": {"motion.record.file": names},
        }
        (tmp_path / "s.yaml").write_text(yaml.safe_dump(given))
        return run_study(open_study(tmp_path / "s.yaml"), tmp_path / "out", plots=False)

    run(["one.csv", "two.csv"])
    assert run(["one.csv", "two.csv", "own.csv"]).taken_over == 2
    assert run(["one.csv", "two.csv", "own.csv"], own="one.csv").taken_over == 3
    motion(tmp_path / "own.csv", 7)
    with pytest.raises(StudyError, match="--fresh` replaces it"):
        run(["one.csv", "two.csv", "own.csv"])


def test_a_key_that_only_some_settings_displace_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    motion(tmp_path / "h1.csv", 0)

    def run(mu: float, settings: dict[str, Any]) -> Any:
        given = {
            "name": "s",
            "case": {"block": BLOCK | {"top": mu}, "motion": {"record": "h1.csv"}},
            "vary": {"case": settings},
        }
        (tmp_path / "s.yaml").write_text(yaml.safe_dump(given))
        return run_study(open_study(tmp_path / "s.yaml"), tmp_path / "out", plots=False)

    two: dict[str, Any] = {"low": {"block.R": 1.9}, "high": {"block.R": 2.1, "block.top": 3.0}}
    run(2.0, two)
    assert run(2.0, two | {"more": {"block.R": 2.2}}).taken_over == 2
    with pytest.raises(StudyError, match="--fresh` replaces it"):
        run(2.5, two | {"more": {"block.R": 2.2}})


def test_a_symbol_of_ones_own_displaces_no_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`scale` and `pga` say the same of a record; as symbols of `let` they are two."""

    def run(pga: float, points: list[float]) -> Any:
        case = {"block": {"R": "scale", "tan_alpha": "pga"}, "initial": {"theta": 0.01}}
        let = {"scale": 1.0, "pga": pga}
        given = {"name": "s", "let": let, "case": case, "vary": {"let.scale": points}, "save": {"histories": False}}
        (tmp_path / "s.yaml").write_text(yaml.safe_dump(given))
        return run_study(open_study(tmp_path / "s.yaml"), tmp_path / "out", plots=False)

    run(0.2, [1.0, 2.0])
    assert run(0.2, [1.0, 2.0, 3.0]).taken_over == 2
    with pytest.raises(StudyError, match="--fresh` replaces it"):
        run(0.3, [1.0, 2.0, 3.0, 4.0])


def test_a_file_that_changes_while_it_is_read_is_not_taken_for_two(tmp_path: Path) -> None:
    from rockcli.study.inputs import Inputs

    body(tmp_path / "b.csv", 0)
    inputs = Inputs()
    first = inputs.read("b.csv", tmp_path / "b.csv")
    body(tmp_path / "b.csv", 1)
    assert inputs.read("b.csv", tmp_path / "b.csv") == first  # read once, whoever asks
    with pytest.raises(StudyError, match=r"b\.csv: was changed while the study was running"):
        inputs.note("b.csv", tmp_path / "b.csv", "0" * 64)


def test_a_study_that_was_opened_is_solved_as_it_was_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    body(tmp_path / "b.csv", 0)
    given = {"name": "s", "case": {"block": {"outline": "b.csv"}, "initial": {"theta": 0.05}}}
    (tmp_path / "s.yaml").write_text(yaml.safe_dump(given))
    study = open_study(tmp_path / "s.yaml")
    run_study(study, tmp_path / "wanted", plots=False)
    body(tmp_path / "b.csv", 4)  # an editor saves between the check and the solution
    run_study(study, tmp_path / "out", plots=False)
    np.testing.assert_array_equal(peaks(tmp_path, "out"), peaks(tmp_path, "wanted"))
