"""`rock plot`: draw the plots of a dataset, from the file alone."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rockcli.cli.say import say


def plot(
    files: Annotated[list[Path], typer.Argument(metavar="FILE.nc...", help="Datasets written by `rock run`.")],
    kinds: Annotated[
        list[str] | None,
        typer.Option("--kind", metavar="KIND", help="Kind of plot, may be repeated; default: what the data suggest."),
    ] = None,
    plot_format: Annotated[str, typer.Option("--format", metavar="png|pdf|svg", help="Format of plots.")] = "png",
) -> None:
    """Draw the plots of datasets beside them."""
    from rockcli.engine.draw import draw
    from rockcli.errors import StudyError

    for file in files:
        drawn, complaints = draw(file, tuple(kinds) if kinds else None, plot_format)
        if not drawn and not kinds:  # nothing suggests itself: whatever there is
            from rockcli.plotting.figures import KINDS

            drawn, complaints = draw(file, tuple(KINDS), plot_format)
        for path in drawn:
            say(str(path))
        if complaints and kinds:
            raise StudyError("; ".join(complaints), file=file)
        if not drawn:
            raise StudyError(f"nothing in it can be drawn: {'; '.join(complaints)}", file=file)
