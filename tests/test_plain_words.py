"""Documentation and messages are in the words of the field: what they replaced does not come back."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
EVERY = sorted((ROOT / "rockcli").rglob("*.py"))
MODULES = [path for path in EVERY if "kernels" not in path.parts]

DEAD = {
    r"\bthe source(?:'s)?\b(?! of)": "the thesis",
    r"linearis": "linearized",
    r"rate of rotation": "angular velocity",
    r"\blandings?\b": "impact",
    r"\bwaiting room\b": "queue",
    r"\bfilm(?:s|ed)?\b": "animation",
    r"\bwith a sentence\b|\btold so\b|that is said\b": "with a message, a warning",
    r"\bto rounding\b": "to machine precision",
    r"\btold apart\b": "separated, distinguished",
    r"\bforet(?:ell|old)\b": "estimate",
    r"\bsought\b": "searched for",
    r"\bnot to be had\b": "not available",
    r"\bdisplace[sd]\b (?:`|what|its)": "overrides",
    r"\bmakes no dimension\b": "adds no dimension",
    r"\bsafe islands?\b": "stable islands",
    r"\b\d+ % (?:fractile|quantile)": "16th percentile",
    r"\benergy kept\b": "energy retained",
    r"m/s\^2|m/s\*\*2": "m/s²",
    r"\bkinship\b": "sweep_id",
    r"\brungs?\b(?! down)|\bladders?\b": "setting, series of settings, candidate",
    r"(?<!`)\b(?:unsafe|wary)\b(?!`)": "unconservative, false alarm",
}
"""Pattern -> what is written in its place; old names of keys that still work stand in backquotes."""

DEAD_NAMES = {
    r"call_in|turn_away|let_in|let_out|lay_aside|sit_down|foresee": "screen, leave_screened, next_case, finish_case",
    r"rungs?|ladders?|climb": "setting, series, candidate",
    r"folds?|unfold": "reduction, reduced",
    r"unsafe|wary": "unconservative, false_alarms",
    r"films?": "animation",
    r"agenda|diary|naive|reread|bury|deaths|lives|takeover": "chunks, trajectory, stepwise, crashes",
}
"""The same of names of modules, functions, classes and their fields: one of the words between underscores."""


def messages(path: Path) -> list[tuple[int, str]]:
    """Line and text of every string of several words that is no docstring."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    passed = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    found = [
        (node.lineno, node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in passed
    ]
    return [(line, text) for line, text in found if " " in text.strip()]


@cache
def lines() -> list[tuple[Path, int, str]]:
    """Every line of the pages, and every message."""
    read = [(path, i, line) for path in PAGES for i, line in enumerate(path.read_text("utf-8").splitlines(), 1)]
    return read + [(path, i, text) for path in MODULES for i, text in messages(path)]


@pytest.mark.parametrize("pattern", DEAD, ids=lambda pattern: DEAD[pattern])
def test_dead_words_stay_out(pattern: str) -> None:
    found = [
        f"{path.relative_to(ROOT)}:{i}: {line.strip()[:100]}" for path, i, line in lines() if re.search(pattern, line)
    ]
    assert not found, f"write {DEAD[pattern]!r} instead"


@cache
def names(path: Path) -> list[str]:
    """Of a module, and of what it defines."""
    defined = [
        node.name if not isinstance(node, ast.AnnAssign) else ast.unparse(node.target)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef | ast.ClassDef | ast.AnnAssign)
    ]
    return [path.stem, *defined]


@pytest.mark.parametrize("pattern", DEAD_NAMES, ids=lambda pattern: DEAD_NAMES[pattern])
def test_dead_names_stay_out(pattern: str) -> None:
    dead = re.compile(rf"(?:^|_)(?:{pattern})(?:_|$)", re.IGNORECASE)
    found = [f"{path.relative_to(ROOT)}: {name}" for path in EVERY for name in names(path) if dead.search(name)]
    assert not found, f"write {DEAD_NAMES[pattern]!r} instead"


def test_the_first_sentence_of_a_module_is_in_these_words() -> None:
    for path in EVERY:
        first = (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").split("\n\n")[0]
        assert first or path.stem in ("__init__", "__main__"), path
        dead = [pattern for pattern in DEAD if re.search(pattern, first)]
        assert not dead, f"{path}: {first}"


def test_messages_are_found() -> None:
    texts = [text for path, _, text in lines() if path not in PAGES]
    assert len(texts) > 1000
    assert any("needs a column with E and rho" in text for text in texts)
    assert not any("is one error with file" in text for text in texts)
