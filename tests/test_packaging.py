"""What it is handed out as: the conda recipe, the image and the extras agree with pyproject.toml and .ci/run."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import jsonschema
import pytest
import yaml

import rockcli

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
RECIPE = yaml.safe_load((ROOT / "recipe" / "recipe.yaml").read_text(encoding="utf-8"))
IMAGE = (ROOT / "Dockerfile").read_text(encoding="utf-8")
CI = (ROOT / ".ci" / "run").read_text(encoding="utf-8")

CONDA_NAMES = {"netCDF4": "netcdf4", "matplotlib": "matplotlib-base"}

WORDS = {"type": "array", "minItems": 1, "items": {"type": "string", "pattern": r"^[a-z0-9_.-]+( [<>=!0-9.,*]+)?$"}}
TEXTS = {"type": "array", "minItems": 1, "items": {"type": "string"}}
SCHEMA = {
    "type": "object",
    "required": ["package", "source", "build", "requirements", "tests", "about"],
    "additionalProperties": False,
    "properties": {
        "context": {"type": "object", "additionalProperties": {"type": ["string", "number", "boolean"]}},
        "package": {"type": "object", "required": ["name", "version"], "additionalProperties": False,
                    "properties": {"name": {"const": "rockcli"}, "version": {"type": "string"}}},
        "source": {"type": "object", "required": ["path"], "additionalProperties": False,
                   "properties": {"path": {"type": "string"}}},
        "build": {"type": "object", "required": ["number", "script"], "additionalProperties": False,
                  "properties": {"number": {"type": "integer", "minimum": 0}, "script": TEXTS}},
        "requirements": {"type": "object", "required": ["host", "run"], "additionalProperties": False,
                         "properties": {"host": WORDS, "run": WORDS}},
        "tests": {"type": "array", "minItems": 1, "items": {"oneOf": [
            {"type": "object", "required": ["python"], "additionalProperties": False, "properties": {"python": {
                "type": "object", "required": ["imports"], "additionalProperties": False,
                "properties": {"imports": TEXTS, "pip_check": {"type": "boolean"}}}}},
            {"type": "object", "required": ["script"], "additionalProperties": False, "properties": {"script": TEXTS}},
        ]}},
        "about": {"type": "object", "required": ["summary", "license", "license_file"],
                  "properties": {"summary": {"type": "string", "maxLength": 200}}},
    },
}  # fmt: skip
"""The part of the format of conda recipes (version 1) that this one uses."""


def test_the_recipe_is_one():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    jsonschema.validate(RECIPE, SCHEMA)
    expressions = re.findall(r"\$\{\{ *(\w+) *\}\}", str(RECIPE))
    assert set(expressions) == {"version", "PYTHON"}


def test_the_recipe_has_the_version_the_dependencies_and_the_licence_of_the_project():
    assert RECIPE["context"]["version"] == rockcli.__version__
    asked = {}
    for requirement in PROJECT["dependencies"]:
        name, bound = requirement.split(">=")
        asked[CONDA_NAMES.get(name, name)] = f">={bound}"
    asked["python"] = PROJECT["requires-python"]
    assert dict(word.split() for word in RECIPE["requirements"]["run"]) == asked
    assert RECIPE["about"]["license"] == PROJECT["license"]
    assert RECIPE["about"]["summary"].startswith(PROJECT["description"].split(":")[0])
    assert (ROOT / RECIPE["about"]["license_file"]).is_file()


def test_the_image_installs_what_continuous_integration_does():
    def of_the_system(script: str) -> set[str]:
        found = re.findall(r"apt-get install -y (?:--no-install-recommends )?([\w -]+)", script)
        return {name for names in found for name in names.split()}

    assert of_the_system(IMAGE) == of_the_system(CI) - {"python3-venv"}  # the image's Python has venv, and needs none
    (base,) = set(re.findall(r"^FROM python:(3\.\d+)-", IMAGE, re.M))
    assert f"Programming Language :: Python :: {base}" in PROJECT["classifiers"]
    words = {line.split()[0] for line in IMAGE.replace("\\\n", " ").splitlines() if line and line[0] != "#"}
    assert words <= {"FROM", "WORKDIR", "COPY", "RUN", "ENV", "USER", "ENTRYPOINT", "CMD"}
    assert re.search(r"^USER (?!root)", IMAGE, re.M)


def test_the_wheel_has_every_file_that_the_program_reads():
    """Against the list that the build backend makes: what .gitignore names, or lies beside the package, is not in it."""
    builder = pytest.importorskip("hatchling.builders.wheel").WheelBuilder(str(ROOT))
    there = {Path(file.distribution_path).as_posix() for file in builder.recurse_included_files()}

    def below(folder: str, pattern: str) -> set[str]:
        found = {path.relative_to(ROOT).as_posix() for path in (ROOT / folder).rglob(pattern)}
        assert found, folder
        return found

    assert below("rockcli", "*.py") <= there
    assert below("rockcli/cli/templates", "*.yaml") <= there
    shipped = set().union(*(below(folder, "*.*") for folder in ("records", "studies/examples", "studies/tutorials")))
    made = ("/results/", "/__pycache__/")
    assert {f"rockcli/shipped/{name}" for name in shipped if not any(folder in name for folder in made)} <= there
    single = ("engine/costs.csv", "plotting/page/template.html", "study/catalog.yaml", "py.typed")
    assert {f"rockcli/{name}" for name in single} <= there
    assert {name.partition("/")[0] for name in there} == {"rockcli"}


def test_what_all_brings_is_for_users_and_no_address_is_invented():
    def names(extra: str) -> set[str]:
        found = set()
        for requirement in PROJECT["optional-dependencies"][extra]:
            if own := re.fullmatch(r"rockcli\[(.*)\]", requirement):
                found |= set().union(*(names(other) for other in own[1].split(",")))
            else:
                found.add(re.split(r"[<>=]", requirement)[0])
        return found

    developers = {"pytest", "pytest-xdist", "hypothesis", "ruff", "mypy", "pre-commit", "types-PyYAML", "mkdocs"}
    assert not names("all") & developers
    assert {"openseespy", "dask", "openpyxl", "trimesh"} <= names("all")
    assert "urls" not in PROJECT


def test_the_paper_cites_what_its_bibliography_has_and_shows_what_studies_draw():
    text = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")
    head, body = text.split("---\n")[1:3]
    assert {"title", "tags", "authors", "affiliations", "date", "bibliography"} == set(yaml.safe_load(head))
    for section in ("Summary", "Statement of need", "State of the field", "References"):
        assert f"# {section}\n" in body
    keys = re.findall(r"^@\w+\{(\w+),", (ROOT / "paper" / "paper.bib").read_text(encoding="utf-8"), re.M)
    assert set(re.findall(r"@(\w+)", body)) == set(keys)
    assert len(keys) == len(set(keys))
    script = (ROOT / "paper" / "figures.py").read_text(encoding="utf-8")
    figures = re.findall(r"!\[.*\(`(studies/\S+)`\)\.\]\((\w+\.png)\)", body)
    assert len(figures) == 2
    for study, figure in figures:
        assert (ROOT / "paper" / figure).is_file()
        assert f'"{figure}": ("{study}"' in script
        assert (ROOT / study).is_file()


def test_the_version_has_its_date_in_the_changelog_and_the_citation():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    dated = re.findall(
        r"^## \[(\d+\.\d+\.\d+)\] - (\d{4}-\d\d-\d\d)$", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.M
    )
    assert dated[0] == (rockcli.__version__, str(citation["date-released"]))
    assert citation["version"] == rockcli.__version__
    assert (citation["license"], citation["title"].split(":")[0]) == (PROJECT["license"], PROJECT["name"])
