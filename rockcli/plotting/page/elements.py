"""What the pages are made of: `template.html`, sections, tables, figures."""

from __future__ import annotations

import base64
import io
import re
import zlib
from collections.abc import Iterable, Sequence
from html import escape
from importlib.resources import files
from string import Template
from typing import TYPE_CHECKING

import matplotlib as mpl

from rockcli.plotting.common import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_HEAVY = 1_500_000
"""Characters of a drawing above which it is a picture instead: no reader opens a page of many megabytes."""

_DPI = 200
"""Of pictures: sharp on a laptop at twice its nominal resolution."""


def laid_out(name: str, title: str, references: str, parts: Iterable[str]) -> str:
    """A page of parts that are HTML, empty ones left out."""
    template = Template(files(__package__).joinpath("template.html").read_text(encoding="utf-8"))
    sections = "\n".join(part for part in parts if part)
    return template.substitute(name=name, title=title, references=references, sections=sections)


def section(title: str, body: str) -> str:
    """A part of the page under its title; "" where it is empty."""
    return f"<section><h2>{escape(title)}</h2>\n{body}</section>" if body else ""


def folded(title: str, body: str) -> str:
    """A section that opens at a click."""
    return f"<section><details><summary>{escape(title)}</summary>\n{body}</details></section>" if body else ""


def image(drawn: Figure, words: str) -> str:
    """A figure in the page: scalable, or a picture where it would be heavy."""
    width = int(drawn.get_figwidth() * 130)
    code = io.StringIO()
    with mpl.rc_context({**style.RC, "svg.fonttype": "path"}), style.no_word_of_glyphs():
        style.settle(drawn)
        drawn.savefig(code, format="svg", metadata={"Date": None, "Creator": None})
    text = code.getvalue()
    if len(text) <= _HEAVY:
        inside = text[text.index("<svg") :].replace("\n", " ")
        inside = _of_its_own(re.sub(r"<metadata>.*?</metadata>", "", inside))
        role = f'<svg role="img" aria-label="{escape(words)}" style="max-width:{width}px"'
        return re.sub(r"^<svg", role, re.sub(r' (width|height)="[\d.]+pt"', "", inside, count=2))
    return picture(drawn, words)


def _of_its_own(drawing: str) -> str:
    """A drawing whose names are those of no other on the page; nothing refers to those of its groups."""
    own = f"{zlib.crc32(drawing.encode()):08x}"
    named = re.sub(r'(<g) id="[^"]*"', r"\1", drawing)
    return re.sub(r'( id="|href="#|url\(#)', rf"\g<1>d{own}-", named)


def picture(drawn: Figure, words: str) -> str:
    """A figure in the page, as pixels."""
    width = int(drawn.get_figwidth() * 130)
    file = io.BytesIO()
    with mpl.rc_context(style.RC), style.no_word_of_glyphs():
        style.settle(drawn)
        drawn.savefig(file, format="png", dpi=_DPI)
    data = base64.b64encode(file.getvalue()).decode("ascii")
    return f'<img src="data:image/png;base64,{data}" alt="{escape(words)}" style="width:{width}px">'


def table(header: Sequence[str], rows: Sequence[Sequence[str]], note: str = "") -> str:
    """A table with a note below; "" without rows."""
    if not rows:
        return ""
    head = "".join(f"<th>{escape(word).replace('_', '_<wbr>')}</th>" for word in header)
    body = "".join("<tr>" + "".join(f"<td>{escape(word)}</td>" for word in row) + "</tr>" for row in rows)
    below = f'<p class="quiet">{escape(note)}</p>' if note else ""
    return f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>{below}'
