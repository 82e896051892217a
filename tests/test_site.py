"""The site: pages made from the program agree with it, equations are readable, the site builds without a warning."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"


def tool(name: str):
    spec = importlib.util.spec_from_file_location(f"docs_{name}", DOCS / "tools" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


equations, reference, site, sketch = (tool(name) for name in ("equations", "reference", "site", "sketch"))

MADE = [*reference.PAGES]
PAGES = sorted(path for path in DOCS.rglob("*.md"))
BLOCKS = [(path, block) for path in PAGES for block in site.EQUATIONS.findall(path.read_text(encoding="utf-8"))]


@pytest.mark.parametrize("name", MADE)
def test_the_reference_agrees_with_the_program(name):
    shown = (DOCS / "reference" / name).read_text(encoding="utf-8")
    assert shown == reference.page(name), "run python docs/tools/reference.py"
    words = re.sub(r"```.*?```|`[^`]*`", "", shown, flags=re.S)
    assert not re.search(r"<\w", words)  # a placeholder, DIR/<name>, would be a tag, of which a page shows nothing


def test_every_environment_variable_is_listed():
    from rockcli.cli.environment import ENVIRONMENT

    sources = [*(ROOT / "rockcli").rglob("*.py"), ROOT / "hatch_build.py"]
    read = {name for path in sources for name in re.findall(r"\bROCK_[A-Z_]+\b", path.read_text(encoding="utf-8"))}
    assert read == set(ENVIRONMENT)


def test_the_sketch_is_what_its_script_draws():
    text = (DOCS / "figures" / "block.svg").read_text(encoding="utf-8")
    assert text == sketch.drawn()
    assert {"R", "α", "h", "b", "θ"} <= {element.text for element in ElementTree.fromstring(text).iter()}


@pytest.mark.parametrize(("path", "block"), BLOCKS, ids=lambda value: value.name if isinstance(value, Path) else "")
def test_equations_become_well_formed_mathml(path, block):
    rendered = ElementTree.fromstring(equations.rendered(block))
    rows = [line for line in block.splitlines() if line.strip()]
    assert len(rendered) == len(rows)
    numbers = re.findall(r"\(([A-Z]\d+)\)$|^\(([A-Z]\d+)\)", block, re.M)
    assert [span.text for span in rendered.iter("span") if span.text[1].isalpha() and len(span.text) > 3] == [
        f"({at_end or at_start})" for at_end, at_start in numbers
    ]
    letters = "".join(rendered.itertext())
    for code in re.findall("`([^`]+)`", block):
        letters = letters.replace(code, "")
    assert not re.search(r"[_^`]|sqrt|\balpha\b|\btheta\b", letters), letters


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("p² x_g", "<msup><mi>p</mi><mrow><mn>2</mn></mrow></msup> <msub><mi>x</mi><mrow><mi>g</mi></mrow></msub>"),
        ("sqrt(a + b)", "<msqrt><mrow><mi>a</mi> <mo>+</mo> <mi>b</mi></mrow></msqrt>"),
        ("f'_(k-1)", "<msubsup><mi>f</mi><mrow><mi>k</mi><mo>−</mo><mn>1</mn></mrow><mrow><mo>′</mo></mrow></msubsup>"),
        ("q* - 2 theta", "<msup><mi>q</mi><mrow><mo>*</mo></mrow></msup> <mo>−</mo> <mn>2</mn> <mi>θ</mi>"),
    ],
)
def test_symbols(text, expected):
    plain = re.sub(r"<mspace[^>]*>", " ", equations.mathml(text)).replace(' stretchy="false"', "")
    assert plain == expected


def test_navigation_has_every_page_and_no_other():
    listed = []

    def walk(entry):
        for value in entry if isinstance(entry, list) else entry.values() if isinstance(entry, dict) else [entry]:
            walk(value) if not isinstance(value, str) else listed.append(value)

    walk(yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))["nav"])
    assert len(listed) == len(set(listed))
    made = {site.in_site(path.relative_to(ROOT).as_posix()) for path in [*PAGES, *DOCS.rglob("*.ipynb")]}
    outside = {site.in_site(path) for path in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")}
    assert set(listed) == made | outside


def test_links_out_of_the_pages_lead_to_their_copies():
    assert site.relinked("docs/study.md", "[a](../README.md#x) [b](ci.md) [c](https://a.b)") == (
        "[a](project/README.md#x) [b](ci.md) [c](https://a.b)"
    )
    assert site.relinked("README.md", "[a](docs/study.md)") == "[a](../study.md)"
    assert site.relinked("docs/tutorials/README.md", "[a](../notebooks/suite.ipynb)") == "[a](../notebooks/suite.md)"


def test_the_site_builds_without_a_warning(tmp_path):
    pytest.importorskip("mkdocs", reason="the site needs mkdocs: pip install -e '.[docs]'")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(tmp_path / "site")]
    built = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": ""})
    assert (built.returncode, built.stdout, built.stderr) == (0, "", "")
    for page in (tmp_path / "site").rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert not re.findall(r'<(?:script|img)[^>]*src="https?:|<link[^>]*stylesheet[^>]*href="https?:', text), (
            page.name
        )
