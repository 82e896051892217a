"""The page of scores: tables and figures of predictions, one page that needs no network and no other file."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from matplotlib.figure import Figure

from rockcli.plotting.page.elements import laid_out, picture, section, table

Section = tuple[str, Sequence[str], Sequence[Sequence[str]], str, Figure | None]
"""Title, names of the columns, rows, a sentence, a figure."""


def page(name: str, sections: Sequence[Section]) -> str:
    """The page, from sections of a table and a figure each."""
    return laid_out(escape(name), "Predictions and experiments", "", map(_section, sections))


def _section(part: Section) -> str:
    title, head, rows, sentence, figure = part
    said = f'<p class="quiet">{escape(sentence)}</p>' if sentence else ""
    drawn = "" if figure is None else f'<div class="plot">{picture(figure, title)}</div>'
    return section(title, f"{said}{drawn}{table(head, rows)}")
