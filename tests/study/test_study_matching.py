"""Patterns mean what they mean to everybody else, and looking for their files comes to an end."""

from __future__ import annotations

import glob
import time
from pathlib import Path

import pytest

from rockcli.errors import RecordError
from rockcli.study.building import matching
from rockcli.study.open import open_study

FILES = (
    "a.AT2", "b.AT2", "c.txt", ".hidden.AT2", "[x].AT2", "one/a.AT2", "one/one/a.AT2", "one/two/c.AT2", "two/b1.AT2",
    "two/b2.AT2", ".dark/a.AT2", "one/.dark/a.AT2", "sp ace/ü.AT2",
)  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in FILES:
        path = tmp_path / "suite" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("0 0\n0.01 1\n0.02 0\n")
    (tmp_path / "suite" / "link").symlink_to("two")
    (tmp_path / "suite" / "linked.AT2").symlink_to("two/b1.AT2")
    return tmp_path / "suite"


@pytest.mark.parametrize(
    "pattern",
    [
        "*.AT2", "?.AT2", "[ab].AT2", "[!a].AT2", "[[]x].AT2", "*", "*.nothing", "one/*.AT2", "one//*.AT2", "*/a.AT2",
        "*/*.AT2", "*/*/*.AT2", "**/*.AT2", "**/**/*.AT2", "one/**/*.AT2", "one/one/*", "**/one/*.AT2", "**/two/**/*", "on**/**/*.AT2",
        "two/**", ".*.AT2", ".dark/*.AT2", "*/.dark/*.AT2", "../suite/*.AT2", "./*.AT2", "a.AT2", "no.AT2", "no/*.AT2",
        "link/*.AT2", "sp*/*",
    ],
)  # fmt: skip
def test_a_pattern_means_what_the_standard_library_says(folder: Path, pattern: str) -> None:
    wanted = [name for name in glob.glob(pattern, root_dir=folder, recursive=True) if (folder / name).is_file()]
    found = matching.matched(pattern, folder)
    assert found == sorted({name.replace("//", "/") for name in wanted})


def test_a_link_that_leads_back_ends(folder: Path) -> None:
    (folder / "one" / "round").symlink_to(folder)
    assert matching.matched("**/b1.AT2", folder) == ["link/b1.AT2", "two/b1.AT2"]


def test_an_absolute_pattern(folder: Path) -> None:
    assert matching.matched(f"{folder}/two/*.AT2", Path("elsewhere")) == [
        f"{folder}/two/b1.AT2",
        f"{folder}/two/b2.AT2",
    ]


def pattern_study(pattern: str) -> None:
    case = {"block": {"R": 2, "tan_alpha": 0.2}, "motion": {"record": {"units": "g"}}}
    open_study({"name": "a", "case": case, "vary": {"motion.record.file": pattern}})


def test_a_whole_disk_is_not_looked_through(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(matching, "MOST", 10)
    with pytest.raises(RecordError, match=r"looks through more than \d+ files; begin with the folder") as caught:
        pattern_study(f"{folder}/**/*.AT2")
    assert caught.value.exit_code == 2
    assert len(matching.matched(f"{folder}/two/*.AT2", Path())) == 2


@pytest.mark.slow
@pytest.mark.skipif(
    len(list(Path("/").iterdir())) < 5 or not Path("/proc").is_dir(), reason="no disk with a root to look through"
)
def test_from_the_root_it_ends_within_seconds() -> None:
    began = time.monotonic()
    with pytest.raises(RecordError):
        pattern_study("/**/*.no-such-record")
    assert time.monotonic() - began < 30.0  # minutes on a large disk, for ever on a slow one
