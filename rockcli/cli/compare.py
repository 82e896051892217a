"""`rock compare`: whether two datasets say the same."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rockcli.cli.say import say

if TYPE_CHECKING:
    from rockcli.analysis.compare_datasets import Difference

_NAMED = 10
"""Datasets that are not compared and named nevertheless."""


def compare(
    a: Annotated[Path, typer.Argument(metavar="A", help="A dataset written by `rock run`, or a folder of them.")],
    b: Annotated[Path, typer.Argument(metavar="B", help="Another one over the same axes, or another folder.")],
    rtol: Annotated[float, typer.Option("--rtol", help="Allowed relative difference of the peaks.")] = 1e-6,
    most: Annotated[int, typer.Option("--most", metavar="N", help="How many of the worst points are named.")] = 10,
    as_json: Annotated[bool, typer.Option("--json", help="Print the comparison as JSON.")] = False,
) -> None:
    """Compare the outcomes and peaks of two datasets at the points both have, of searches the thresholds found.

    Peaks are of the rotation and, of bodies that stand, of the slide.  Of two folders every dataset with that of the
    same name; static curves are named and not compared.  Exit 1 on another outcome or a peak beyond --rtol; the worst
    points are named.
    """
    from rockcli.errors import StudyError, is_file

    if not 0.0 <= rtol < float("inf"):
        raise StudyError(f"--rtol {rtol}: expected a number >= 0")
    if most < 0:
        raise StudyError(f"--most {most}: expected a number >= 0")
    if os.path.isdir(a) and os.path.isdir(b):
        same = _folders(a, b, rtol, most, as_json=as_json)
    elif gone := next((path for path in (a, b) if not (os.path.exists(path) or is_file(path))), None):
        raise StudyError("no such file or folder", file=gone)
    elif os.path.isdir(a) or os.path.isdir(b):
        raise StudyError(f"{a} and {b}: a folder and a file; expected two datasets, or two folders of them")
    else:
        found, apart = _files(a, b, rtol, most, si=as_json)
        say(_json(_plain(found, apart)) if as_json else _in_words(found, apart, rtol))
        same = found.same
    raise typer.Exit(0 if same else 1)


def _files(a: Path, b: Path, rtol: float, most: int, *, si: bool) -> tuple[Difference, dict[str, str]]:
    """How two datasets differ, and what else is apart: {`study`: the keys that differ, `program`: both versions}."""
    import json

    from rockcli.analysis.compare_datasets import difference
    from rockcli.storage import netcdf
    from rockcli.study.differences import differences
    from rockcli.study.document.loader import load_value

    one, other = netcdf.read(a), netcdf.read(b)
    found = difference(one, other, rtol=rtol, most=most, si=si)
    inputs = (json.loads(contents.attrs.get("inputs", "{}")) for contents in (one, other))
    new = load_value(other.attrs.get("study", "{}"), f"the study in {b}")
    keys = differences(one.attrs.get("study", ""), new, *inputs)
    apart = {"study": f"differs in {keys}" if keys else ""}
    programs = [str(contents.attrs.get("source", "")) for contents in (one, other)]
    apart["program"] = "" if programs[0] == programs[1] else " -> ".join(programs)
    return found, {what: words for what, words in apart.items() if words}


def _folders(a: Path, b: Path, rtol: float, most: int, *, as_json: bool) -> bool:
    """Compare the datasets that two folders both have; whether all are the same."""
    from rockcli.analysis.compare_datasets import NothingToCompareError
    from rockcli.errors import StudyError
    from rockcli.scene.counted import counted
    from rockcli.storage.atomic import datasets_below

    names = [{str(file.relative_to(folder)) for file in datasets_below(folder)} for folder in (a, b)]
    both, only_a, only_b = sorted(names[0] & names[1]), sorted(names[0] - names[1]), sorted(names[1] - names[0])
    if not both:
        raise StudyError(f"{a} and {b} have no dataset of the same name")
    found, refused, curves = {}, {}, []
    for name in both:
        try:
            found[name] = _files(a / name, b / name, rtol, most, si=as_json)
        except NothingToCompareError:
            curves.append(name)
        except StudyError as error:
            refused[name] = error.message
    differ = [name for name, (difference, _) in found.items() if not difference.same]
    if as_json:
        datasets = [{"name": name, **_plain(*one)} for name, one in found.items()]
        same = not differ and not refused
        others = {"only_a": only_a, "only_b": only_b, "nothing_to_compare": curves, "refused": refused}
        say(_json({"same": same, "datasets": datasets, **others}))
    else:
        programs: set[str] = set()
        for name, (difference, apart) in found.items():
            if not difference.same:
                say(f"{name}: {_in_words(difference, apart, rtol)}")
                continue
            program = apart.pop("program", "")
            programs |= {program} if program else set()
            if apart or difference.only_a or difference.only_b:
                say("\n".join([f"{name}: the same at {_points(difference)}", *_beside(difference, apart)]))
        for program in sorted(programs):
            say(f"of those that are the same: program {program}")
        for words, some in (
            ("only in the first", only_a),
            ("only in the second", only_b),
            ("without outcomes, peaks and thresholds, as static curves are", curves),
        ):
            if some:
                more = f", and {len(some) - _NAMED} more" if len(some) > _NAMED else ""
                say(f"{words}, not compared: {', '.join(some[:_NAMED])}{more}")
        counts = f"{len(found) - len(differ)} the same, {len(differ)} differ{'s' if len(differ) == 1 else ''}"
        say(f"{counted(len(found), 'dataset')} in both: {counts}")
    if not found and not refused:
        raise StudyError(f"{a} and {b} have no dataset of the same name that can be compared")
    if refused:
        raise StudyError("\n".join(f"{name}: {message}" for name, message in refused.items()))
    return not differ


def _in_words(found: Difference, apart: dict[str, str], rtol: float) -> str:
    from rockcli.scene.thresholds import FOUND

    lines = [_points(found), *_beside(found, apart)]
    search = found.quantity.endswith(FOUND)
    flags, values = ("states", found.quantity) if search else ("outcomes", "peaks")
    lines.append(f"  {flags:<9} {found.outcomes} differ")
    lines += [f"            {n} {_spaced(words)}" for words, n in found.changes.items()]
    known = found.largest == found.largest
    if known or found.peaks:
        spread = f"; relative difference: median {found.median:.2g}, largest {found.largest:.2g}" if known else ""
        lines.append(f"  {values:<9} {found.peaks} beyond rtol {rtol:g}{spread}")
    lines += [f"    {place + ': ' if place else ''}{words}" for place, words in found.worst]
    hidden = found.outcomes + found.peaks - len(found.worst)
    if hidden:
        lines.append(f"    and {hidden} more")
    return "\n".join(lines)


def _points(found: Difference) -> str:
    """How many points were compared, and how many could not be."""
    from rockcli.scene.counted import counted

    words = f"{counted(found.points, 'point')} in both"
    if found.filled:
        words += f", {found.filled} of which a refined map filled in: their outcomes alone are compared"
    if found.only_a or found.only_b:
        words += f"; {found.only_a} only in the first, {found.only_b} only in the second: not compared"
    return words


def _beside(found: Difference, apart: dict[str, str]) -> list[str]:
    """Lines: which axes were taken for one another, where the studies and the programs differ."""
    pairs = [f"  the axis {b} of the second is taken for {a}: its labels are the same" for a, b in found.paired.items()]
    return [*pairs, *(f"  {what:<9} {words}" for what, words in apart.items())]


def _spaced(words: str) -> str:
    return words.replace("_", " ")


def _plain(found: Difference, apart: dict[str, str]) -> dict[str, Any]:
    from dataclasses import asdict

    plain = asdict(found) | {"same": found.same, "worst": [{"at": at, "what": what} for at, what in found.worst]}
    for name in ("largest", "median"):
        plain[name] = plain[name] if plain[name] == plain[name] else None
    return plain | {"apart": apart}


def _json(plain: dict[str, Any]) -> str:
    import json

    return json.dumps(plain, indent=2)
