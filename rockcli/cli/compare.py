"""`rock compare`: whether two datasets say the same."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rockcli.cli.say import say

if TYPE_CHECKING:
    from rockcli.analysis.compare_datasets import Difference


def compare(
    a: Annotated[Path, typer.Argument(metavar="A.nc", help="A dataset written by `rock run`.")],
    b: Annotated[Path, typer.Argument(metavar="B.nc", help="Another one over the same axes.")],
    rtol: Annotated[float, typer.Option("--rtol", help="Allowed relative difference of the peaks.")] = 1e-6,
    most: Annotated[int, typer.Option("--most", metavar="N", help="How many of the worst points are named.")] = 10,
    as_json: Annotated[bool, typer.Option("--json", help="Print the comparison as JSON.")] = False,
) -> None:
    """Compare the outcomes and peaks of two datasets at the points both have, of searches the thresholds found.

    Exit 1 on another outcome or a peak beyond --rtol; the worst points are named.
    """
    from rockcli.analysis.compare_datasets import difference
    from rockcli.errors import StudyError
    from rockcli.storage import netcdf

    if not 0.0 <= rtol < float("inf"):
        raise StudyError(f"--rtol {rtol}: expected a number >= 0")
    if most < 0:
        raise StudyError(f"--most {most}: expected a number >= 0")
    found = difference(netcdf.read(a), netcdf.read(b), rtol=rtol, most=most, si=as_json)
    if as_json:
        say(_as_json(found))
    else:
        say(_in_words(found, rtol))
    raise typer.Exit(0 if found.same else 1)


def _in_words(found: Difference, rtol: float) -> str:
    from rockcli.cli.progress import counted
    from rockcli.scene.thresholds import FOUND

    lines = [f"{counted(found.points, 'point')} in both"]
    if found.only_a or found.only_b:
        lines[0] += f"; {found.only_a} only in the first, {found.only_b} only in the second: not compared"
    lines += [
        f"  the axis {b} of the second is taken for {a}: its labels are the same" for a, b in found.paired.items()
    ]
    search = found.quantity.endswith(FOUND)
    flags, values = ("states", found.quantity) if search else ("outcomes", "peaks")
    lines.append(f"  {flags:<9} {found.outcomes} differ")
    lines += [f"            {n} {_spaced(words)}" for words, n in found.changes.items()]
    if found.largest == found.largest:
        spread = f"relative difference: median {found.median:.2g}, largest {found.largest:.2g}"
        lines.append(f"  {values:<9} {found.peaks} beyond rtol {rtol:g}; {spread}")
    lines += [f"    {place + ': ' if place else ''}{words}" for place, words in found.worst]
    hidden = found.outcomes + found.peaks - len(found.worst)
    if hidden:
        lines.append(f"    and {hidden} more")
    return "\n".join(lines)


def _spaced(words: str) -> str:
    return words.replace("_", " ")


def _as_json(found: Difference) -> str:
    import json
    from dataclasses import asdict

    plain = asdict(found) | {"same": found.same, "worst": [{"at": at, "what": what} for at, what in found.worst]}
    for name in ("largest", "median"):
        plain[name] = plain[name] if plain[name] == plain[name] else None
    return json.dumps(plain, indent=2)
