"""`rock report`: a dataset as one HTML page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rockcli.cli.say import say


def report(
    files: Annotated[list[Path], typer.Argument(metavar="FILE.nc...", help="Datasets written by `rock run`.")],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE.html", help="The page; default: FILE.html beside FILE.nc.")
    ] = None,
) -> None:
    """Write a report of each dataset: result, plots, cases, study and provenance on one page that needs no network."""
    from rockcli.engine.report_page import write_page
    from rockcli.errors import StudyError

    if out is not None and len(files) > 1:
        raise StudyError("--out names one page: give one dataset with it")
    for file in files:
        say(str(write_page(file, out)))
