"""`rock check`: what studies are about to do; solves nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from rockcli.cli.options import Settings, SkipMissing, Studies
from rockcli.cli.say import say, warn
from rockcli.cli.tables import facts, table

if TYPE_CHECKING:
    from rockcli.engine.preview import Preview


def check(
    studies: Studies,
    settings: Settings = None,
    skip_missing: SkipMissing = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Errors only.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON list instead of tables.")] = False,
) -> None:
    """Read studies and show what they would do.

    Counts the cases and prints the first: body, model, motion in g and over g tan(alpha), cost.  Solves nothing.
    """
    from rockcli.cli.sources import open_all
    from rockcli.engine.preview import preview
    from rockcli.engine.run import check_answers
    from rockcli.scene.counted import counted

    opened = open_all(studies, settings or (), skip_missing=skip_missing, also=check_answers)
    previews = [preview(study) for study in opened.studies]
    for file, why in opened.skipped:
        say(f"rock: skipped {file.stem}: {why}", err=True)
    for found in previews:
        if not quiet:
            for warning in found.warnings:
                warn(found.name, warning)
        if not quiet and not as_json:
            say(_text(found))
    if as_json:
        import json

        say(json.dumps([found.as_dict() for found in previews], indent=2))
    elif len(previews) > 1 and not quiet:
        say(f"{counted(len(previews), 'study')}, {counted(sum(found.cases for found in previews), 'case')}")


MOST_BODIES = 60
"""Bodies that are printed."""

MOST_RECORDS = 4
"""Records of which what was done to them is printed."""

IN_SI = "[m/s2]"
"""End of the rows that are for programs: accelerations are printed in g."""


def _text(found: Preview) -> str:
    from rockcli.cli.progress import duration

    axes = " x ".join(f"{points} {name}" for name, _, points in found.axes)
    rows = [("cases", f"{found.cases}" + (f" = {axes}" if axes else ""))]
    first = " (first case)" if found.cases > 1 else ""
    for name, section in (("body", found.body), ("model", found.model), ("motion", found.motion)):
        rows.append((f"{name}{first}", ""))
        rows += [(f"  {row.words}", _shown(row.value)) for row in section if not row.words.endswith(IN_SI)]
    if len(found.bodies) > 1:
        rows.append(("bodies", f"{len(found.bodies)}, below"))
    for name, steps in list(found.processing.items())[:MOST_RECORDS]:
        rows.append(("record", name))
        rows += [("", step) for step in steps]
    if (more := len(found.processing) - MOST_RECORDS) > 0:
        rows.append(("", f"and {more} more: --json has all"))
    size = f", {found.megabytes:.3g} MB of histories at most" if found.megabytes else ""
    held = f"{round(found.memory, -1):.0f} MB of memory{size}"
    cost = f"about {duration(found.seconds)} of processor time, {held}, without plots"
    rows += [("backend", found.backend), ("cost", cost)]
    title = f"{found.name}: {found.title}" if found.title else found.name
    return f"{title}\n{facts(rows)}" + (f"\n{_bodies(found)}" if len(found.bodies) > 1 else "")


def _bodies(found: Preview) -> str:
    """Every distinct body in a row."""
    from rockcli.engine.bodies import UPLIFT
    from rockcli.scene.counted import counted

    columns = [name for name in found.bodies[0] if any(row[name] == row[name] for row in found.bodies)]
    shown = found.bodies[:MOST_BODIES]
    cells = [[_shown(row[name]) if row[name] == row[name] else "" for name in columns] for row in shown]
    printed = table([found.uplift if name == UPLIFT else name for name in columns], cells, indent=2)
    more = len(found.bodies) - len(shown)
    return printed + (f"\n  and {counted(more, 'more body')}: --json has all" if more else "")


def _shown(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.6g}"
