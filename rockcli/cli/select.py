"""`--select AXIS=VALUE`: some of the cases of a dataset."""

from __future__ import annotations

from typing import Annotated

import typer

Select = Annotated[
    list[str] | None,
    typer.Option(
        "--select",
        metavar="AXIS=VALUE[,VALUE...]",
        help="Only these cases, may be repeated; a number in SI units, or as 0.4g, 10deg.",
    ),
]
"""The option of a command."""


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
