"""What `mkdocs build` does beside: equations become MathML, notebooks pages, and links out of docs/ bring their files.

The pages are read on their own too, in an editor or beside the code, so they link to studies, tables and README where
these lie.  The site has them under `project/`.
"""

from __future__ import annotations

import importlib.util
import json
import posixpath
import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
LINK = re.compile(r"(?<=\]\()([^)\s#]+)((?:#[^)\s]*)?)(?=\))")
EQUATIONS = re.compile(r"^```equation\n(.*?)^```$", re.DOTALL | re.MULTILINE)
PAGE = "project"
"""Folder of the site for what lies outside docs/."""


def _module(name: str) -> Any:
    """A neighbour of this file; mkdocs loads hooks from wherever it was started."""
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    if spec is None or spec.loader is None:
        raise ImportError(name)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


rendered = _module("equations").rendered


def place(page: str, target: str) -> str | None:
    """Path in the repository that a link of a page (path in the repository) leads to; None of links into the web."""
    if re.match(r"[a-z]+:", target):
        return None
    return posixpath.normpath(posixpath.join(posixpath.dirname(page), target))


def in_site(path: str) -> str:
    """Where a file of the repository stands in the site."""
    if path.endswith(".ipynb"):
        path = path.removesuffix(".ipynb") + ".md"
    return path.removeprefix("docs/") if path.startswith("docs/") else f"{PAGE}/{path.lstrip('.')}"


def in_repository(uri: str) -> str:
    """The reverse of `in_site`."""
    return uri.removeprefix(f"{PAGE}/") if uri.startswith(f"{PAGE}/") else f"docs/{uri}"


def relinked(page: str, text: str) -> str:
    """The text of a page with its links as they lead in the site."""

    def moved(found: re.Match[str]) -> str:
        path = place(page, found[1])
        if path is None or not (ROOT / path).is_file():
            return found[0]
        return posixpath.relpath(in_site(path), posixpath.dirname(in_site(page)) or ".") + found[2]

    return LINK.sub(moved, text)


def outside(pages: list[str]) -> list[str]:
    """Files outside docs/ that these pages link to, and that those among them which are pages link to."""
    found: list[str] = []
    waiting = list(pages)
    while waiting:
        page = waiting.pop()
        for target, _ in LINK.findall((ROOT / page).read_text(encoding="utf-8")):
            path = place(page, target)
            if path is None or path.startswith(("docs/", "../")) or path in found or not (ROOT / path).is_file():
                continue
            found.append(path)
            if path.endswith(".md"):
                waiting.append(path)
    return sorted(found)


def notebook_page(path: Path) -> str:
    """A notebook as a page, with what its cells gave when it was last executed: texts, tables, pictures."""
    parts = []
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            parts.append(source)
            continue
        parts.append(f"```python\n{source}\n```")
        parts += [part for output in cell["outputs"] if (part := _output(output))]
    head, _, rest = "\n\n".join(parts).partition("\n")
    return f"{head}\n\nThe [notebook]({path.name}) itself, to run and change.\n{rest}\n"


def _output(output: dict[str, Any]) -> str:
    """One output of a cell; what needs a script of its own (plotly) is only in the notebook."""
    data = output.get("data", {})
    if "image/png" in data:
        return f'<img alt="what the cell draws" src="data:image/png;base64,{"".join(data["image/png"].split())}">'
    if "application/vnd.plotly.v1+json" in data:
        return "*An interactive figure: open the notebook.*"
    if "text/html" in data:
        return f'<div class="output">{"".join(data["text/html"])}</div>'
    text = "".join(output.get("text", data.get("text/plain", "")))
    return f"```text\n{text.rstrip()}\n```" if text.strip() else ""


def on_files(files: Any, config: Any) -> Any:
    """Hook of mkdocs: what lies outside docs/."""
    from mkdocs.structure.files import File

    pages = [in_repository(file.src_uri) for file in files.documentation_pages() if file.src_uri.endswith(".md")]
    for path in outside(pages):
        files.append(File.generated(config, in_site(path), abs_src_path=str(ROOT / path)))
    for notebook in sorted((ROOT / "docs").rglob("*.ipynb")):
        uri = in_site(notebook.relative_to(ROOT).as_posix())
        files.append(File.generated(config, uri, content=notebook_page(notebook)))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Hook of mkdocs: links and equations."""
    if page.file.src_uri.startswith("notebooks/"):
        return markdown
    return EQUATIONS.sub(lambda found: rendered(found[1]), relinked(in_repository(page.file.src_uri), markdown))
