"""Where results go: what is in the way is told before anything is solved, a full disk leaves nothing half-written."""

from __future__ import annotations

import os
import re
import resource
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from rockcli.storage.atomic import replacing, sweep_leftovers
from rockcli.storage.places import check_file, check_folder, passing, remove_passing

Rock = Callable[..., int]

STUDY = """\
name: x
case:
  block: {R: 2.0, tan_alpha: 0.2}
  motion: {pulse: {shape: ricker, a_p: 3.6*g*tan_alpha, omega_p: 3*pi}}
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "x.yaml"
    path.write_text(STUDY)
    return path


def obstruct(folder: Path, what: str) -> list[str]:
    """Put something in the way; the options that lead there."""
    place = folder / "way"
    if what == "file as --out":
        place.write_text("")
    elif what == "file above --out":
        place.write_text("")
        place = place / "deep" / "er"
    elif what == "file as folder of the study":
        place.mkdir()
        (place / "x").write_text("")
    elif what == "links in a circle":
        place.symlink_to(place)
    elif what == "broken symbolic link":
        place.symlink_to(folder / "nothing")
    elif what == "device":
        place = Path("/dev/full")
    elif what == "folder as dataset":
        (place / "x" / "x.nc").mkdir(parents=True)
        return ["--out", str(place), "--fresh"]
    elif what == "folder as junit":
        return ["--junit", "."]
    else:
        place.write_text("")
        return ["--junit", str(place / "v.xml")]
    return ["--out", str(place)]


@pytest.mark.parametrize(
    ("what", "told"),
    [
        ("file as --out", "way: is not a folder"),
        ("file above --out", "way: is not a folder"),
        ("file as folder of the study", "x: is not a folder"),
        ("links in a circle", "way: cannot be used: a loop of symbolic links"),
        ("broken symbolic link", "way: is a broken symbolic link"),
        ("device", "/dev/full: is not a folder"),
        ("folder as dataset", "x.nc: is a folder"),
        ("folder as junit", "is a folder"),
        ("file as folder of junit", "way: is not a folder"),
    ],
)
def test_obstacles(
    what: str,
    told: str,
    rock: Rock,
    file: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr("rockcli.engine.run.run_study", None)  # nothing is to be solved
    assert rock("run", file, *obstruct(tmp_path, what)) == 2
    said = capsys.readouterr().err
    assert told in said
    assert "bug" not in said


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such names")
def test_a_name_that_is_no_text_is_told_before_anything_is_solved(
    rock: Rock, file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    odd = os.fsdecode(b"r\xf6ck")
    monkeypatch.setattr("rockcli.engine.run.run_study", None)
    assert rock("run", file, "--out", odd) == 2
    (tmp_path / odd).mkdir()
    (tmp_path / odd / "x.nc").write_bytes(b"CDF")
    for command in ("table", "plot"):
        assert rock(command, f"{odd}/x.nc") == 2
    said = capsys.readouterr().err
    assert said.count("the name is not in UTF-8, which netCDF needs: choose another\n") == 3
    assert said.count("\n") == 3


@pytest.mark.skipif(sys.platform == "win32", reason="there it is a slash")
def test_a_backslash_in_a_name_is_told_before_anything_is_solved(
    rock: Rock, file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("rockcli.engine.run.run_study", None)
    assert rock("run", file, "--out", "a\\b") == 2
    (tmp_path / "a\\b").mkdir()
    (tmp_path / "a\\b" / "x.nc").write_bytes(b"CDF")
    for command in ("table", "plot"):
        assert rock(command, "a\\b/x.nc") == 2
    said = capsys.readouterr().err
    assert said.count("x.nc: the name has a backslash, which netCDF takes for a slash: choose another\n") == 3
    assert said.count("\n") == 3


@pytest.mark.parametrize(
    ("what", "told"),
    [("folder", "is a folder; give the dataset in it"), ("empty.nc", "is empty"), ("none.nc", "no such file")],
)
@pytest.mark.parametrize("command", ["table", "plot", "report", "animate"])
def test_what_is_there_instead_of_a_dataset(
    command: str, what: str, told: str, rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "empty.nc").write_bytes(b"")
    assert rock(command, what) == 2
    assert f"rock: {what}: {told}" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [
        "run LONG.yaml",
        "check LONG",
        "export LONG.nc",
        "trade LONG.yaml",
        "table LONG.nc",
        "plot LONG.nc",
        "verify LONG.nc",
        "animate LONG.nc --out x.gif",
        "compare LONG.nc LONG.nc",
        "records info ../LONG.AT2",
        'check x.yaml --set case.block={"outline":LONG.csv}',
        'check x.yaml --set case.block={"mesh":LONG.stl,"density":2000}',
        'check x.yaml --set vary={"base":LONG.csv}',
        'check x.yaml --set hazard=[LONG.csv] --set vary={"motion.pulse.a_p":[1,2],"block.R":[1,2]} --set over=block.R',
    ],
)
def test_a_name_that_no_file_can_have_is_wrong_input(
    words: str, rock: Rock, file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What the system refuses of a name that is given is told as of a file that cannot be read, and so is its code."""
    assert rock(*words.replace("LONG", "long" * 100).split()) == 2
    said = capsys.readouterr().err
    assert re.fullmatch(r"rock: .*(long){100}(\.\w+)?: cannot be read: File name too long\n", said)


def test_scripts_need_a_folder_too(rock: Rock, file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert rock("export", file, "--out", file) == 2
    assert "x.yaml: is not a folder" in capsys.readouterr().err


WRITERS = [
    ("table results/x/x.nc --out", "t.csv"),
    ("plot results/x/x.nc --kind phase --out", "p.png"),
    ("report results/x/x.nc --out", "r.html"),
    ("animate results/x/x.nc --fps 2 --speed 20 --out", "a.gif"),
    ("new block --out", "b.yaml"),
    ("new examples --out", "e"),
    ("identify swings.txt --alpha 0.2 --out", "f.csv"),
    ("identify swings.txt --alpha 0.2 --out", "f.png"),
    ("records convert swings.txt --units g --dt 0.1", "r.AT2"),
    ("records info swings.txt --units g --dt 0.1 --spectrum", "s.png"),
    ("export x.yaml --set case.model=3 --set case.damping=dashpot --out", "scripts"),
    ("run x.yaml --no-plots --junit", "v.xml"),
]


@pytest.fixture
def solved(rock: Rock, file: Path, tmp_path: Path) -> Rock:
    assert rock("run", file, "--no-plots", "--quiet") == 0
    (tmp_path / "swings.txt").write_text("0.1\n-0.07\n0.05\n-0.035\n0.025\n")
    return rock


@pytest.mark.parametrize(("command", "name"), WRITERS)
def test_whatever_is_written_makes_its_folder(command: str, name: str, solved: Rock, tmp_path: Path) -> None:
    assert solved(*command.split(), f"new/folder/{name}") == 0
    assert (tmp_path / "new" / "folder" / name).exists()


@pytest.mark.parametrize(("command", "name"), WRITERS)
def test_a_file_where_a_folder_is_needed_is_told_as_such(
    command: str, name: str, solved: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "way").write_text("mine")
    assert solved(*command.split(), f"way/{name}") == 2
    assert "way: is not a folder" in capsys.readouterr().err
    assert (tmp_path / "way").read_text() == "mine"


@pytest.mark.parametrize(
    ("command", "name"),
    [
        *[(command, name) for command, name in WRITERS if not command.startswith(("new", "export"))],
        ("plot results/x/x.nc --kind phase", "results/x/phase.png"),
        ("run x.yaml", "results/x/histories.png"),
        ("export x.yaml --set case.model=3 --set case.damping=dashpot --out .", "x/opensees/case_1.py"),
    ],
)
def test_a_folder_where_a_file_is_to_be_written_is_told_as_such(
    command: str, name: str, solved: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / name).mkdir(parents=True)
    capsys.readouterr()
    assert solved(*command.split(), *([] if "/" in name else [name])) == 2
    assert capsys.readouterr().err == f"rock: {name}: is a folder where a file is to be written\n"


def test_plots_beside_a_dataset_in_a_folder_that_takes_none(
    solved: Rock, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(os, "access", lambda _, mode: not mode & os.W_OK)
    assert solved("plot", "results/x/x.nc", "--kind", "phase") == 2
    assert "rock: results/x: is a folder in which this user may not write\n" in capsys.readouterr().err


def test_a_place_that_is_not_there_yet_is_none(tmp_path: Path) -> None:
    check_folder(tmp_path / "a" / "b")
    check_file(tmp_path / "a" / "b" / "c.nc")
    check_file(tmp_path / "c.nc")
    check_folder(Path("a/b"))
    check_folder(Path())
    assert list(tmp_path.iterdir()) == []


def limited(folder: Path, most: int, *args: object) -> subprocess.CompletedProcess[str]:
    """`rock ARGS...` in a process that may write no file of more than `most` bytes."""
    return subprocess.run(
        [sys.executable, "-m", "rockcli.cli.main", *map(str, args)],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)),
    )


@pytest.mark.parametrize("most", [2000, 20_000])
def test_no_space(most: int, file: Path, tmp_path: Path) -> None:
    found = limited(tmp_path, most, "run", file, "--no-plots")
    assert found.returncode == 4
    assert found.stderr.count("\n") == 1
    assert "results/x/x.nc: cannot be written: no space" in found.stderr
    assert "bug" not in found.stderr
    assert list((tmp_path / "results" / "x").iterdir()) == []


def test_no_space_for_a_plot(rock: Rock, file: Path, tmp_path: Path) -> None:
    assert rock("run", file, "--no-plots", "--quiet") == 0
    found = limited(tmp_path, 5000, "plot", "results/x/x.nc", "--kind", "phase")
    assert found.returncode == 4
    assert "phase.png: cannot be written: no space" in found.stderr
    assert [path.name for path in (tmp_path / "results" / "x").iterdir()] == ["x.nc"]


@pytest.mark.parametrize("ending", ["csv", "xlsx", "parquet"])
def test_no_space_for_a_table(rock: Rock, file: Path, tmp_path: Path, ending: str) -> None:
    """Of a workbook also for the temporary file that openpyxl writes."""
    file.write_text(STUDY + "vary: {block.R: {from: 1, to: 2, n: 40}}\nsave: {histories: false}\n")
    assert rock("run", file, "--no-plots", "--quiet") == 0
    found = limited(tmp_path, 300, "table", "results/x/x.nc", "--out", f"t.{ending}")
    assert found.returncode == 4
    assert found.stderr.startswith(f"rock: t.{ending}: cannot be written: no space: files may not be as large as this")
    assert found.stderr.count("\n") == 1
    assert not list(tmp_path.glob(f"*.{ending}"))


def test_a_stream_that_takes_nothing(file: Path, tmp_path: Path) -> None:
    with Path("/dev/full").open("w") as full:
        found = subprocess.run(
            [sys.executable, "-m", "rockcli.cli.main", "check", str(file)],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert found.returncode == 4
    assert found.stderr == "rock: standard output: no space left on the device\n"


def test_verdicts_that_cannot_be_written(rock: Rock, file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert rock("run", file, "--no-plots", "--junit", "/dev/full") == 4
    assert capsys.readouterr().err == "rock: /dev/full: cannot be written: no space left on the device\n"
    assert rock("run", file, "--no-plots", "--json", "--junit", "/dev/full") == 4
    assert not capsys.readouterr().out  # a summary would have said that the exit code is 0


def test_no_space_for_a_sheet_or_for_examples(
    rock: Rock, file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert rock("run", file, "--no-plots", "--quiet") == 0
    found = limited(tmp_path, 3000, "table", "results/x/x.nc", "--out", "t.xlsx")
    assert (found.returncode, found.stdout) == (4, "")
    assert re.fullmatch("rock: t.xlsx: cannot be written: no space.*\n", found.stderr)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(shutil, "copy2", full)
    assert rock("new", "examples") == 4
    assert capsys.readouterr().err == "rock: examples: cannot be written: no space left on the device\n"
    assert not [path for path in tmp_path.iterdir() if path.name.startswith((".rock", "examples", "t.xlsx"))]


def test_what_must_not_outlive_its_use(tmp_path: Path) -> None:
    path = tmp_path / "scratch"
    with passing(path):
        path.write_text("")
    assert not path.exists()
    with passing(path):
        path.write_text("")
        remove_passing()
        assert not path.exists()
    path.write_text("")
    remove_passing()
    assert path.exists()


FULL = """\
mount -t tmpfs -o size=2m tmpfs {folder} && cp x.yaml {folder} && cd {folder} || exit 77
{rock} run x.yaml --no-plots -q || exit 78
dd if=/dev/zero of=fill bs=1k count=4000 2>/dev/null
{rock} run x.yaml --no-plots -q --set title=another
code=$?
ls -A results/x >&2
exit $code
"""


def test_a_disk_that_is_full_on_renewal_is_not_permission_denied(file: Path, tmp_path: Path) -> None:
    if shutil.which("unshare") is None:
        pytest.skip("no unshare here, to mount a small disk with")
    (tmp_path / "disk").mkdir()
    script = FULL.format(folder="disk", rock=f"{sys.executable} -m rockcli.cli.main")
    command = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", script]
    found = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    if found.returncode in (1, 77) and "rock:" not in found.stderr:
        pytest.skip("no file system may be mounted here")
    assert found.returncode == 4
    assert found.stderr == "rock: results/x/x.nc: cannot be written: no space left on the device\nx.nc\n"


def test_a_place_where_nothing_can_be_made_is(rock: Rock, file: Path, tmp_path: Path, monkeypatch, capsys) -> None:
    """The library's word stands where the disk takes a file all the same."""
    import netCDF4

    def denied(*args: object, **options: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(netCDF4, "Dataset", denied)
    assert rock("run", file, "--no-plots") == 4
    assert "x.nc: cannot be written: permission denied" in capsys.readouterr().err
    assert [path.name for path in (tmp_path / "results" / "x").iterdir()] == [".parts"]


MINE = [
    ".x.part.y",
    ".x.part.nc",
    ".notes.12.part.txt",
    ".12.part.nc",
    "x.12.part.nc",
    ".lock-mine",
    ".lock.txt",
]


def test_a_users_own_files_stay_and_those_of_killed_runs_go(rock: Rock, file: Path, tmp_path: Path) -> None:
    folder = tmp_path / "results" / "x"
    folder.mkdir(parents=True)
    left_behind = [".x.4711.part.nc", ".histories.4711.part.png", ".lock-1-of-3", ".lock-12-of-30", ".lock"]
    for name in (*MINE, *left_behind):
        (folder / name).write_text("mine")
    assert rock("run", file, "--no-plots", "--quiet") == 0
    assert sorted(path.name for path in folder.iterdir()) == sorted([*MINE, "x.nc"])
    assert (folder / ".x.part.y").read_text() == "mine"


def test_what_is_left_behind_is_called_so(tmp_path: Path) -> None:
    """The name that a killed writer leaves is one that goes."""
    with replacing(tmp_path / "a.b.nc") as scratch:
        scratch.write_text("half")
        left = scratch.with_name(scratch.name)
        copy = tmp_path / "elsewhere" / left.name
        copy.parent.mkdir()
        copy.write_text("half")
    sweep_leftovers(copy.parent)
    assert list(copy.parent.iterdir()) == []
    assert (tmp_path / "a.b.nc").read_text() == "half"


@pytest.mark.skipif(sys.platform == "win32", reason="a process cannot be asked for without ending it")
def test_what_a_killed_writer_of_the_same_file_left_goes(rock: Rock, tmp_path: Path) -> None:
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    stay = [f".b.{os.getppid()}.part.yaml", f".c.{gone.pid}.part.yaml", f".b.{gone.pid}.part.nc", ".b.x.part.yaml"]
    for name in (*stay, f".b.{gone.pid}.part.yaml"):
        (tmp_path / name).write_text("half")
    assert rock("new", "block", "--out", "b.yaml") == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*stay, "b.yaml"])


def test_figures_of_an_earlier_run_are_named(rock, tmp_path, capsys):
    text = (
        "name: few\ncase:\n  block: {R: 2.0, tan_alpha: 0.2}\n  initial: {theta: 0.1}\n"
        "vary: {block.R: [1.0, 2.0]}\nsave: {dt_out: 0.1}\n"
    )
    study, folder = tmp_path / "few.yaml", tmp_path / "results" / "few"
    study.write_text(f"{text}plots: [phase, curve]\n")
    assert rock("run", "few.yaml") == 0
    assert "earlier run" not in capsys.readouterr().err
    (folder / "notes.png").write_bytes(b"")
    study.write_text(f"{text}plots: [phase]\n")
    assert rock("run", "few.yaml") == 0
    assert "left by an earlier run, and not drawn by this one: curve.png" in capsys.readouterr().err  # dataset renewed
    study.write_text(f"{text}plots: []\n")
    assert rock("run", "few.yaml") == 0
    assert "not drawn by this one: curve.png, phase.png" in capsys.readouterr().err
    assert rock("run", "few.yaml", "--no-plots") == 0
    assert "earlier run" not in capsys.readouterr().err
    for name in ("curve.png", "phase.png"):
        (folder / name).unlink()
    assert rock("run", "few.yaml") == 0
    assert "earlier run" not in capsys.readouterr().err
