"""Tables for the terminal: as wide as it is, long cells on several lines; plain lines where nobody looks on."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from io import StringIO
from typing import Literal

_UNBOUNDED = 100_000
"""Width of what is not read in a terminal: one row is one line there, for programs that read it."""


_FOLDED = 12
"""Letters of a column of words, and of heads above them, that it is not folded below."""

_APART = 2
"""Blanks between columns."""


def table(head: Sequence[str], rows: Iterable[Sequence[str]], *, right: int = 0, indent: int = 0, keys: int = 1) -> str:
    """Rows below a head, columns aligned by blanks.

    A terminal that is too narrow for all columns has the others in further tables below, beside the same first ones.

    Args:
        head: names of the columns; blank ones print no head.
        rows: cells, as many in each as in `head`.
        right: number of columns, the last ones, whose cells are numbers and end at the same place.
        indent: blanks before every line.
        keys: number of columns, the first ones, that say what a row is of.
    """
    from rich.cells import cell_len
    from rich.console import Console

    seen = sys.stdout.isatty()
    if not seen:
        return _laid_out(head, list(rows), range(len(head)), [0] * len(head), right, indent, _UNBOUNDED)
    cells, width = list(rows), Console().width
    whole = [max(map(cell_len, column)) for column in zip(head, *cells, strict=True)]
    words = len(head) - right
    least = [size if i >= words else min(size, _FOLDED) for i, size in enumerate(whole)]
    tables = []
    for columns in _blocks(least, keys, width - indent):
        needed = indent + sum(least[i] + _APART for i in columns) - _APART
        tables.append(_laid_out(head, cells, columns, least, right, indent, max(width, needed)))
    return "\n\n".join(tables)


def _blocks(least: Sequence[int], keys: int, width: int) -> list[list[int]]:
    """Which columns, of some least widths, stand in each of the tables of a terminal, the keys in all of them."""
    first = list(range(min(keys, len(least))))
    blocks = [first]
    for i in range(len(first), len(least)):
        if len(blocks[-1]) > len(first) and sum(least[j] + _APART for j in (*blocks[-1], i)) - _APART > width:
            blocks.append(first)
        blocks[-1] = [*blocks[-1], i]
    return blocks


def _laid_out(
    head: Sequence[str],
    rows: Sequence[Sequence[str]],
    columns: Sequence[int],
    least: Sequence[int],
    right: int,
    indent: int,
    width: int,
) -> str:
    """Some of the columns as one table of at most `width`."""
    from rich.console import Console
    from rich.padding import Padding
    from rich.table import Table

    seen = sys.stdout.isatty()
    text = StringIO()  # standard output is for `say`, which tells where it takes nothing
    console = Console(file=text, force_terminal=seen, width=width, markup=False, highlight=False, emoji=False)
    style = "bold" if seen else "none"
    made = Table(box=None, pad_edge=False, padding=(0, _APART, 0, 0), header_style=style, show_header=any(head))
    for i in columns:
        numeric = i >= len(head) - right
        side: Literal["left", "right"] = "right" if numeric else "left"
        made.add_column(head[i], justify=side, no_wrap=numeric, overflow="fold", min_width=least[i])
    for row in rows:
        made.add_row(*(row[i] for i in columns))
    console.print(Padding(made, (0, 0, 0, indent), expand=False))
    return "\n".join(line.rstrip() for line in text.getvalue().splitlines())


def facts(rows: Iterable[tuple[str, str]], *, indent: int = 2) -> str:
    """What something is called, and what it is: a table without a head."""
    return table(("", ""), rows, indent=indent)
