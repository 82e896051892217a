"""The page of scores: tables and figures of predictions, one page that needs no network and no other file."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from html import escape
from importlib.resources import files
from string import Template

import matplotlib as mpl
from matplotlib.figure import Figure

from rockcli.plotting.common import style

Section = tuple[str, Sequence[str], Sequence[Sequence[str]], str, Figure | None]
"""Title, names of the columns, rows, a sentence, a figure."""


def page(name: str, sections: Sequence[Section]) -> str:
    """The page, from sections of a table and a figure each."""
    template = Template(files(__package__).joinpath("template.html").read_text(encoding="utf-8"))
    parts = "\n".join(_section(section) for section in sections)
    return template.substitute(name=escape(name), title="Predictions and experiments", references="", sections=parts)


def _section(section: Section) -> str:
    title, head, rows, sentence, figure = section
    names = "".join(f"<th>{escape(word)}</th>" for word in head)
    cells = "".join("<tr>" + "".join(f"<td>{escape(word)}</td>" for word in row) + "</tr>" for row in rows)
    body = f'<div class="wide"><table><thead><tr>{names}</tr></thead><tbody>{cells}</tbody></table></div>'
    said = f'<p class="quiet">{escape(sentence)}</p>' if sentence else ""
    return f"<section><h2>{escape(title)}</h2>\n{said}{_image(figure, title)}{body}</section>"


def _image(figure: Figure | None, title: str) -> str:
    if figure is None:
        return ""
    style.settle(figure)
    picture = io.BytesIO()
    with mpl.rc_context(style.RC), style.no_word_of_glyphs():
        figure.savefig(picture, format="png", dpi=200)
    code = base64.b64encode(picture.getvalue()).decode("ascii")
    width = int(figure.get_figwidth() * 130)
    image = f'<img src="data:image/png;base64,{code}" alt="{escape(title)}" style="width:{width}px">'
    return f'<div class="plot">{image}</div>'
