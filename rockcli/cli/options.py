"""Options and arguments that several commands have, with their help."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Studies = Annotated[list[Path], typer.Argument(metavar="STUDY.yaml|FOLDER...", help="Studies; folders are searched.")]

Results = Annotated[Path, typer.Option("--out", metavar="DIR", help="Where results go.")]

Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="PATH=VALUE", help="Change a value, as case.block.R=2; may be repeated."),
]

Workers = Annotated[
    int | None, typer.Option("--workers", metavar="N", min=1, help="Processes; default: one per usable core.")
]

SkipMissing = Annotated[bool, typer.Option("--skip-missing", help="Skip studies whose record is absent.")]

PlotFormat = Annotated[str, typer.Option("--format", metavar="png|pdf|svg", help="Format of plots.")]

Specimen = Annotated[str | None, typer.Option("--specimen", metavar="NAME", help="Only the runs of this one.")]

Select = Annotated[
    list[str] | None,
    typer.Option(
        "--select",
        metavar="AXIS=VALUE[,VALUE...]",
        help="Only these cases, may be repeated; a number in SI units, or as 0.4g, 10deg.",
    ),
]


def chosen(select: list[str] | None) -> dict[str, list[str]]:
    """Axis -> what was typed, of `AXIS=VALUE,VALUE`; `StudyError` for what is not written so."""
    from rockcli.errors import StudyError

    found: dict[str, list[str]] = {}
    for words in select or []:
        axis, equals, values = words.partition("=")
        if not equals or not axis.strip() or not values.strip():
            raise StudyError(f"--select {words}: expected AXIS=VALUE")
        found.setdefault(axis.strip(), []).append(values)
    return found
