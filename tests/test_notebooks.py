"""The notebooks of docs/notebooks are executed, and executing them again prints the same."""

from __future__ import annotations

import ast
import contextlib
import io
import json
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "notebooks"
BOOKS = sorted(FOLDER.glob("*.ipynb"))


def cells(book: Path) -> list[dict]:
    return [cell for cell in json.loads(book.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]


def joined(text) -> str:
    return text if isinstance(text, str) else "".join(text)


def printed(cell: dict) -> str:
    return "".join(joined(out["text"]) for out in cell["outputs"] if out.get("name") == "stdout")


def test_there_are_three():
    assert [book.stem for book in BOOKS] == ["first_block", "own_plots", "suite"]


@pytest.mark.parametrize("book", BOOKS, ids=lambda book: book.stem)
def test_a_notebook_is_executed_from_top_to_bottom(book):
    counts = [cell["execution_count"] for cell in cells(book)]
    assert counts == list(range(1, len(counts) + 1))
    outputs = [out for cell in cells(book) for out in cell["outputs"]]
    assert not [out for out in outputs if out["output_type"] == "error" or out.get("name") == "stderr"]
    kinds = {kind for out in outputs for kind in out.get("data", {})}
    assert kinds & {"image/png", "application/vnd.plotly.v1+json"}
    assert book.stat().st_size < 600_000
    text = book.read_text(encoding="utf-8")
    assert "/home/" not in text
    assert "/root/" not in text


@pytest.mark.parametrize("book", BOOKS, ids=lambda book: book.stem)
def test_a_notebook_prints_again_what_it_shows(book, monkeypatch):
    """Cells are executed as plain Python, the last expression of each is shown as a notebook would."""
    if book.stem == "own_plots":
        pytest.importorskip("plotly")
    monkeypatch.chdir(FOLDER)
    monkeypatch.setenv("MPLBACKEND", "agg")
    space: dict = {}
    for cell in cells(book):
        said = io.StringIO()
        *body, last = ast.parse(joined(cell["source"])).body
        with contextlib.redirect_stdout(said):
            if isinstance(last, ast.Expr) and not (
                isinstance(last.value, ast.Call) and "print" in ast.dump(last.value.func)
            ):
                exec(compile(ast.Module(body, []), str(book), "exec"), space)
                shown = eval(compile(ast.Expression(last.value), str(book), "eval"), space)
                page = getattr(shown, "_repr_html_", None)
                kept = [out["data"] for out in cell["outputs"] if out["output_type"] == "execute_result"]
                if page is not None and kept and "text/html" in kept[0]:
                    assert page() == joined(kept[0]["text/html"])
            else:
                exec(compile(ast.Module([*body, last], []), str(book), "exec"), space)
        assert said.getvalue() == printed(cell)
