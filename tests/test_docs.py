"""The documentation holds: its studies open, its equations are those the code cites, its pages link to what is there."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml
from typer.testing import CliRunner

import rockcli
from rockcli.cli.main import app
from rockcli.study.open import open_study
from rockcli.study.schema import CasePart, MotionPart, StudyPart

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
TEXT = {page.relative_to(ROOT).as_posix(): page.read_text(encoding="utf-8") for page in PAGES}

BLOCKS = [
    (page, text) for page, whole in TEXT.items() for text in re.findall(r"^```yaml\n(.*?)^```", whole, re.DOTALL | re.M)
]
STUDIES = [(page, text) for page, text in BLOCKS if text.startswith("name:")]
WORKFLOW = "# .github/workflows/"
FRAGMENTS = [(page, text) for page, text in BLOCKS if not text.startswith(("name:", WORKFLOW))]

HOMES = {
    "T": ("docs/theory.md", "docs/suites.md"),
    "F": ("docs/flexible.md",),
    "E": ("docs/frame.md",),
    "R": ("docs/rules.md",),
    "I": ("docs/identify.md",),
    "L": ("docs/lanes.md",),
    "B": ("docs/sweeps.md",),
    "K": ("docs/contact.md",),
    "V": ("docs/rolling.md",),
    "X": ("docs/experiments.md",),
}
"""Pages of the equations (T4), (F3), ...; bare numbers such as (2.2) are the thesis's."""

EQUATION = re.compile(rf"(?<![\w.])([{''.join(HOMES)}])([1-9]\d*)(?:-\1([1-9]\d*))?(?=[,)])")
"""In brackets, alone or in a row: (T4), (F1, F2), (docs/frame.md, B9-B13)."""


def brief(value: str) -> str:
    return value.splitlines()[0][:40]


@pytest.mark.parametrize(("page", "text"), STUDIES, ids=brief)
def test_study_of_the_documentation(page, text, tmp_path, monkeypatch):
    monkeypatch.setenv("ROCK_RECORDS", str(ROOT / "records"))
    if "my_record.AT2" in text:  # the reader's own
        (tmp_path / "my_record.AT2").write_bytes((ROOT / "records" / "synthetic_rock_m65.AT2").read_bytes())
    path = tmp_path / "study.yaml"
    path.write_text(text, encoding="utf-8")
    study = open_study(path)
    assert study.size >= 1
    for _, batch in study.batches():
        assert batch.size >= 1


@pytest.mark.parametrize(("page", "text"), FRAGMENTS, ids=brief)
def test_fragment_has_keys_of_a_study(page, text):
    keys = set(yaml.safe_load(text))
    assert any(keys <= set(part.model_fields) for part in (StudyPart, CasePart, MotionPart)), keys


@pytest.mark.parametrize("text", [text for page, text in STUDIES if page == "docs/study.md"], ids=brief)
def test_study_of_the_guide_runs(text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("study.yaml").write_text(text, encoding="utf-8")
    ran = CliRunner().invoke(app, ["run", "study.yaml", "--workers", "1"])
    assert ran.exit_code == 0, ran.output
    assert "plots " in ran.stdout


def test_the_guide_to_the_study_file_has_its_snippets():
    assert sum(page == "docs/study.md" for page, _ in STUDIES) >= 8


def cited_in(text: str) -> set[str]:
    found = set()
    for bracket in re.findall(r"\([^()]*\)", text):
        for letter, first, last in EQUATION.findall(bracket):
            found |= {f"{letter}{k}" for k in range(int(first), int(last or first) + 1)}
    return found


def numbers_of(letter: str) -> set[str]:
    return {n for page in HOMES[letter] for n in cited_in(TEXT[page]) if n[0] == letter}


@pytest.mark.parametrize("letter", HOMES)
def test_equations_are_numbered_without_gaps(letter):
    numbers = numbers_of(letter)
    assert numbers == {f"{letter}{k}" for k in range(1, len(numbers) + 1)} != set()


def test_every_letter_has_one_home():
    """A displayed equation carries its number at the end of its line, or at the beginning."""
    label = re.compile(r"^ +\((\w\d+)\)  |  \((\w\d+)\)$", re.M)
    for page, whole in TEXT.items():
        for number in (x or y for x, y in label.findall(whole)):
            assert page in HOMES.get(number[0], ()), f"{page}: ({number})"


def test_equations_cited_exist():
    known = set().union(*map(numbers_of, HOMES))
    sources = [*sorted((ROOT / "rockcli").rglob("*.py")), *PAGES]
    cited = [(n, source) for source in sources for n in cited_in(source.read_text(encoding="utf-8"))]
    assert len({n for n, source in cited if source.suffix == ".py"}) >= 20
    assert not [(n, source.relative_to(ROOT).as_posix()) for n, source in cited if n not in known]


def anchors_of(page: Path) -> set[str]:
    """What a link may name on a page: its headings in small letters, blanks as hyphens, without other signs."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    headings = [re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", line) for line in re.findall(r"^#+ +(.+)$", text, re.MULTILINE)]
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize(
    "page",
    [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))],
    ids=lambda page: page.relative_to(ROOT).as_posix(),
)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        if not target.startswith("http"):
            file, _, anchor = target.partition("#")
            there = page.parent / file if file else page
            assert there.exists(), target
            assert not anchor or anchor in anchors_of(there), target


def test_every_page_is_in_the_index():
    listed = set(re.findall(r"\]\(([a-z0-9_]+\.md)\)", TEXT["docs/README.md"]))
    assert listed == {page.name for page in PAGES if page.parent.name == "docs"} - {"README.md"}


def test_the_workflow_runs_commands_there_are():
    ((_, text),) = [(page, text) for page, text in BLOCKS if text.startswith(WORKFLOW)]
    steps = yaml.safe_load(text)["jobs"]["rocking"]["steps"]
    commands = [step["run"].partition(" > ")[0].split() for step in steps if step.get("run", "").startswith("rock ")]
    assert [words[1] for words in commands] == ["check", "run"]


def test_the_summary_and_the_verdicts_are_as_described(tmp_path):
    """On a folder of two studies, one of which does not meet what it expects: docs/ci.md, the tables of keys."""
    good = (ROOT / "studies" / "examples" / "first_rock.yaml").read_text(encoding="utf-8")
    (tmp_path / "good.yaml").write_text(good, encoding="utf-8")
    (tmp_path / "bad.yaml").write_text(good.replace("first-rock", "bad").replace("is: rocking", "is: overturned"))
    (tmp_path / "absent.yaml").write_text("name: absent\ncase: {block: {R: 2, alpha: .2}, motion: {record: no.AT2}}\n")
    where = ["--out", str(tmp_path / "out"), "--no-plots", "--junit", str(tmp_path / "verdicts.xml")]
    ran = CliRunner().invoke(app, ["run", str(tmp_path), "--json", "--skip-missing", *where])
    summary = json.loads(ran.stdout)
    assert ran.exit_code == summary["exit_code"] == 1
    assert [(s["name"], s["status"], s["exit_code"]) for s in summary["studies"]] == [
        ("absent", "skipped", 0),
        ("bad", "solved", 1),
        ("first-rock", "solved", 0),
    ]
    tables, sentence = TEXT["docs/ci.md"].split("Every study has all of these keys")[1].split("A clause:")
    rows = re.findall(r"^\| (`.*?`) \|", tables, re.M)
    described = [name for row in rows for name in re.findall(r"`(\w+)`", row)]
    assert set(described) == set(summary["studies"][0])
    clause = set(re.findall(r"`(\w+)`", sentence.partition("Keys may")[0]))
    assert clause == set(summary["studies"][1]["expect"][0])
    suites = ElementTree.parse(tmp_path / "verdicts.xml").getroot()
    assert [(s.get("tests"), s.get("failures"), s.get("skipped")) for s in suites] == [
        ("1", "0", "1"),
        ("2", "1", "0"),
        ("2", "0", "0"),
    ]


def test_every_attribute_of_a_dataset_is_described():
    dataset = rockcli.run(ROOT / "studies" / "examples" / "first_rock.yaml")
    rows = re.findall(r"^\| (`.*?`) \|", TEXT["docs/python.md"].split("**What `dataset.attrs` says**")[1], re.M)
    described = [name for row in rows for name in re.findall(r"`(\w+)`", row)]
    assert sorted(described) == sorted(dataset.attrs)


def test_a_wrong_study_leaves_no_summary(tmp_path):
    (tmp_path / "wrong.yaml").write_text("name: wrong\ncase: {block: {R: 2}}\n")
    verdicts = tmp_path / "verdicts.xml"
    where = ["--out", str(tmp_path / "out"), "--junit", str(verdicts)]
    ran = CliRunner().invoke(app, ["run", str(tmp_path), "--json", *where])
    assert ran.exit_code != 0
    assert ran.stdout == ""
    assert not verdicts.exists()
    assert not (tmp_path / "out").exists()
