"""`plots`: the kinds of plot of a study, and how each is wanted."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from rockcli.scene.looks import Look, width_of
from rockcli.study.document.tree import Map, place
from rockcli.study.schema import PlotPart


def looks_of(plots: Sequence[PlotPart], tree: Map | None = None) -> Iterator[tuple[str, Look]]:
    """Kind and look of each plot, with its line in the study; one that is said twice with nothing else is one."""
    told = set()
    for i, part in enumerate(plots):
        bare = isinstance(said_of(part), str)
        if bare and part.kind in told:
            continue
        told |= {part.kind} if bare else set()
        title = None if part.title is False else part.title or ""
        width = width_of(part.width)
        where = None if tree is None else place(tree, ("plots", i))
        line = where if isinstance(where, int) else None
        yield part.kind, Look(width, title, part.select, part.labels, part.limits, part.letters, line)


def said_of(part: PlotPart) -> Any:
    """A plot as a study says it: its kind alone where nothing else is said."""
    said = part.model_dump(exclude_unset=True)
    said = {key: list(value) if isinstance(value, tuple) else value for key, value in said.items()}
    if "limits" in said:
        said["limits"] = {row: list(ends) for row, ends in said["limits"].items()}
    return part.kind if said.keys() == {"kind"} else said
