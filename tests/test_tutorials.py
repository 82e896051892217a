"""The tutorials do what they say: their commands run from a new folder, print what is shown, and leave table and figure."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

import rockcli
from rockcli.cli.main import app

ROOT = Path(__file__).resolve().parents[1]
PAGES = sorted(path for path in (ROOT / "docs" / "tutorials").glob("*.md") if path.name != "README.md")
LONG = ("balanced_rocks", "columns")
"""What takes as long as the others together."""

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(\.\d+)?(e[-+]?\d+)?(?![\w.]*[a-z_]\w)")


def blocks(page: Path, kind: str) -> list[str]:
    text = page.read_text(encoding="utf-8")
    return [
        line for block in re.findall(rf"^```{kind}\n(.*?)^```", text, re.DOTALL | re.M) for line in block.splitlines()
    ]


def without_numbers(text: str) -> str:
    """Digits change from machine to machine; words do not."""
    return NUMBER.sub("#", re.sub(r"\s+", " ", text))


def commands(page: Path) -> list[list[str]]:
    return [shlex.split(line)[1:] for line in blocks(page, "sh")]


@pytest.mark.parametrize(
    "page",
    [pytest.param(page, id=page.stem, marks=pytest.mark.slow if page.stem in LONG else ()) for page in PAGES],
)
def test_a_tutorial_runs_and_ends_in_its_table_and_figure(page, tmp_path, monkeypatch):
    if page.stem == "scan":
        pytest.importorskip("trimesh", reason="meshes are read by trimesh: pip install -e '.[meshes]'")
    for folder in ("studies/tutorials", "records"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    monkeypatch.chdir(tmp_path)
    said = ""
    for command in commands(page):
        assert command[0] in ("check", "run", "table", "plot")
        found = CliRunner().invoke(app, command)
        assert found.exit_code == 0, (command, found.output)
        said += found.output
    for line in blocks(page, "text"):
        assert without_numbers(line.strip()) in without_numbers(said), line
    figures = re.findall(r"`(results/\S+\.png)`", page.read_text(encoding="utf-8"))
    assert figures
    for name in figures:
        assert (tmp_path / name).stat().st_size > 10_000, name
    tables = [command for command in commands(page) if command[0] == "table"]
    assert tables
    for command in tables:
        if "--out" in command:
            assert len(Path(command[command.index("--out") + 1]).read_text(encoding="utf-8").splitlines()) > 2


def test_every_study_of_the_tutorials_is_in_one_and_links_lead_somewhere():
    text = {page.name: page.read_text(encoding="utf-8") for page in [*PAGES, ROOT / "docs" / "tutorials" / "README.md"]}
    whole = "".join(text.values())
    for study in (ROOT / "studies" / "tutorials").glob("*.yaml"):
        assert study.name in whole
    for page in PAGES:
        assert f"({page.name})" in text["README.md"]
    for target in re.findall(r"\]\(([^)#]+)[^)]*\)", whole):
        assert (ROOT / "docs" / "tutorials" / target).exists(), target


@pytest.mark.parametrize(
    ("page", "text"),
    [
        (page, text)
        for page in PAGES
        for text in re.findall(r"^```yaml\n(name: .*?)^```", page.read_text("utf-8"), re.S | re.M)
    ],
    ids=lambda value: value.stem if isinstance(value, Path) else value.splitlines()[0],
)
def test_a_study_shown_in_a_tutorial_runs_to_table_and_page(page, text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("study.yaml").write_text(text, encoding="utf-8")
    name = text.split()[1]
    file = f"results/{name}/{name}.nc"
    for command in (["run", "study.yaml", "--no-plots"], ["report", file], ["table", file, "--of", "fragility"]):
        found = CliRunner().invoke(app, command)
        assert found.exit_code == 0, (command, found.output)
    assert "overturned" in found.output


def test_a_list_of_equipment_becomes_a_table_of_bodies_on_their_floors(tmp_path, monkeypatch):
    page = (ROOT / "docs" / "tutorials" / "cabinets.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    radius, floor, axis = (
        re.search(rf"`({words})`", page)[1] for words in (r"sqrt\(.*?/12\)", r"floors/floor2_.*?", r"record: .*?")
    )
    (tmp_path / "floors").mkdir()
    for number in (1, 2):
        for record, a in (("a", 4.0), ("b", 6.0)):
            lines = [f"{0.01 * i:.2f},{number * a if 10 < i < 40 else 0.0}" for i in range(100)]
            (tmp_path / "floors" / f"floor{number}_{record}.csv").write_text(
                "\n".join(["time [s],acceleration [m/s2]", *lines, ""])
            )
    heads = "name,block.h,block.width,block.top,block.r_g,motion.record.file"
    cells = [f"{name},1.0,0.6,2.2,{radius},{floor.replace('2', str(n))}" for name, n in (("low", 1), ("high", 2))]
    (tmp_path / "list.csv").write_text("\n".join([heads, *cells, ""]))
    (tmp_path / "study.yaml").write_text(
        f"name: equipment\ncase:\n  block: {{h: 1, width: 1}}\n  motion: {{record: {{file: synthetic_rock_m65.AT2}}}}\n"
        f"vary:\n  case: list.csv\n  {axis}\n"
    )
    data = rockcli.run("study.yaml")
    assert data["record"].values.tolist() == ["a", "b"]
    assert data["pga"].transpose("case", "record").values.tolist() == [[4.0, 6.0], [8.0, 12.0]]
    p = (9.81 * 1.09**0.5 / ((2.2**2 + 0.6**2) / 12 + 1.09)) ** 0.5
    assert data["p"].values == pytest.approx(p, rel=1e-12)
