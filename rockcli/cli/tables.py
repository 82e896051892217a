"""Tables for the terminal: as wide as it is, long cells on several lines; plain lines where nobody looks on."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from io import StringIO

_UNBOUNDED = 100_000
"""Width of what is not read in a terminal: one row is one line there, for programs that read it."""


def table(head: Sequence[str], rows: Iterable[Sequence[str]], *, right: int = 0, indent: int = 0) -> str:
    """Rows below a head, columns aligned by blanks.

    Args:
        head: names of the columns; blank ones print no head.
        rows: cells, as many in each as in `head`.
        right: number of columns, the last ones, whose cells are numbers and end at the same place.
        indent: blanks before every line.
    """
    from rich.console import Console
    from rich.padding import Padding
    from rich.table import Table

    seen = sys.stdout.isatty()
    text = StringIO()  # standard output is for `say`, which tells where it takes nothing
    width = None if seen else _UNBOUNDED
    console = Console(file=text, force_terminal=seen, width=width, markup=False, highlight=False, emoji=False)
    style = "bold" if seen else "none"
    made = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style=style, show_header=any(head))
    for number, name in enumerate(head):
        numeric = number >= len(head) - right
        made.add_column(name, justify="right" if numeric else "left", no_wrap=numeric, overflow="fold")
    for row in rows:
        made.add_row(*row)
    console.print(Padding(made, (0, 0, 0, indent), expand=False))
    return "\n".join(line.rstrip() for line in text.getvalue().splitlines())


def facts(rows: Iterable[tuple[str, str]], *, indent: int = 2) -> str:
    """What something is called, and what it is: a table without a head."""
    return table(("", ""), rows, indent=indent)
