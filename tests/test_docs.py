"""The studies of the documentation are well-formed and can be built."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from rockcli.study.open import open_study

ROOT = Path(__file__).resolve().parents[1]
SNIPPETS = [
    (page.name, text)
    for page in sorted((ROOT / "docs").glob("*.md"))
    for text in re.findall(r"```yaml\n(name: .*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)
]


@pytest.mark.parametrize(("page", "text"), SNIPPETS, ids=lambda x: x.splitlines()[0][:40])
def test_study_of_the_documentation(page, text, tmp_path, monkeypatch):
    monkeypatch.setenv("ROCK_RECORDS", str(ROOT / "records"))
    path = tmp_path / "study.yaml"
    path.write_text(text, encoding="utf-8")
    study = open_study(path)
    assert study.size >= 1
    for _, batch in study.batches():
        assert batch.size >= 1


def test_the_guide_to_the_study_file_has_its_snippets():
    assert sum(page == "study.md" for page, _ in SNIPPETS) >= 8
