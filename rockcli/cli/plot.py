"""`rock plot`: draw the plots of a dataset, from the file alone."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rockcli.cli.options import PlotFormat, Select, chosen
from rockcli.cli.say import say


def _kinds(incomplete: str) -> list[tuple[str, str]]:
    from rockcli.plotting.figures import KINDS

    return [(name, kind.sentence) for name, kind in KINDS.items() if name.startswith(incomplete)]


def plot(
    files: Annotated[list[Path], typer.Argument(metavar="FILE.nc...", help="Datasets written by `rock run`.")],
    kinds: Annotated[
        list[str] | None,
        typer.Option(
            "--kind",
            metavar="KIND",
            help="Kind of plot, may be repeated; default: those that the study lists, else what the data suggest.",
            autocompletion=_kinds,
        ),
    ] = None,
    select: Select = None,
    width: Annotated[
        str | None,
        typer.Option("--width", metavar="single|double|MM", help="Width: 90 mm, 180 mm, or a number of mm."),
    ] = None,
    title: Annotated[str, typer.Option("--title", metavar="TEXT", help="Title instead of the study's.")] = "",
    no_title: Annotated[
        bool,
        typer.Option(
            "--no-title", help="No title or note below it; both are in the file's metadata, and the note is printed."
        ),
    ] = False,
    letters: Annotated[bool, typer.Option("--letters", help="Letter the panels: (a), (b), ...")] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="FILE.png|.pdf|.svg", help="The one figure; several datasets are drawn together in it."
        ),
    ] = None,
    plot_format: PlotFormat = "png",
) -> None:
    """Draw the plots of datasets beside them, or one figure of them all."""
    from rockcli.engine.draw import changes, draw_as_told

    changed = changes(chosen(select), width, None if no_title else title, letters=letters)
    for drawn in draw_as_told(files, out, tuple(kinds or ()), plot_format, **changed):
        say(str(drawn.path))
        if drawn.sentence:
            say(f"rock: {drawn.sentence}", err=True)
