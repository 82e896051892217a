"""`rock check`: what studies are about to do; solves nothing."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from rockcli.engine.preview import Preview


def check(
    studies: Annotated[
        list[Path], typer.Argument(metavar="STUDY.yaml|FOLDER...", help="Studies; folders are searched.")
    ],
    settings: Annotated[
        list[str] | None, typer.Option("--set", metavar="PATH=VALUE", help="Change a value, as case.block.R=2.")
    ] = None,
    skip_missing: Annotated[bool, typer.Option("--skip-missing", help="Skip studies whose record is absent.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Errors only.")] = False,
) -> None:
    """Read studies and show what they would do.

    Counts the cases and prints the first: block, accelerations in g and over g tan(alpha), cost.  Solves nothing.
    """
    from rockcli.cli.progress import counted
    from rockcli.cli.sources import open_all
    from rockcli.engine.preview import preview
    from rockcli.engine.run import check_answers

    opened = open_all(studies, settings or (), skip_missing=skip_missing, also=check_answers)
    previews = [preview(study) for study in opened.studies]
    for file, why in opened.skipped:
        typer.echo(f"rock: skipped {file.stem}: {why}", err=True)
    for found in previews:
        if not quiet:
            for warning in found.warnings:
                typer.echo(f"rock: {found.name}: warning: {warning}", err=True)
            typer.echo(_text(found))
    if len(previews) > 1 and not quiet:
        typer.echo(f"{counted(len(previews), 'study')}, {counted(sum(found.cases for found in previews), 'case')}")


def _text(found: Preview) -> str:
    from rockcli.cli.progress import duration

    lines = [f"{found.name}: {found.title}" if found.title else found.name]
    axes = " x ".join(f"{points} {name}" for name, _, points in found.axes)
    lines.append(_row("cases", f"{found.cases}" + (f" = {axes}" if axes else "")))
    first = " (first case)" if found.cases > 1 else ""
    lines.append(f"  block{first}")
    lines += [f"    {name:<24} {value:.6g}" for name, value in found.block.items()]
    lines.append(f"  motion{first}")
    lines += [f"    {name:<24} {v if isinstance(v, str) else f'{v:.6g}'}" for name, v in found.motion.items()]
    lines.append(_row("backend", found.backend))
    size = f", {found.megabytes:.3g} MB of histories at most" if found.megabytes else ""
    lines.append(_row("cost", f"about {duration(found.seconds)}{size}"))
    return "\n".join(lines)


def _row(name: str, words: str) -> str:
    return f"  {name:<9} {words}"
