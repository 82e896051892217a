"""Draws the plots of dataset files, from the files alone, as their study or a command wants them."""

from __future__ import annotations

import logging
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from rockcli.errors import StudyError
from rockcli.scene.looks import WIDTHS_IN_WORDS, Look, width_of
from rockcli.storage.atomic import replacing
from rockcli.storage.lazy import open_lazily
from rockcli.storage.places import check_file
from rockcli.storage.read import of_a_part, open_dataset, with_axes_left

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

log = logging.getLogger(__name__)

FORMATS = ("png", "pdf", "svg")

_AS = {"select": "{'pga': 3.0}", "labels": "{'x': 'time [s]'}", "limits": "{'x': (0.0, 2.0)}"}

Asked = Sequence[tuple[str, Look]]
"""Kinds of plot, and how each is wanted."""


@dataclass(frozen=True)
class Drawn:
    """A file with a figure.

    Attributes:
        path: of the file.
        untold: what the note below a title says, as which cases are shown, where the figure has no title.
    """

    path: Path
    untold: str

    @property
    def sentence(self) -> str:
        """That the figure does not say it; "" where nothing is left out."""
        return self.untold and f"{self.path.name} has no title, and does not say: {self.untold}"


def changes(
    select: Mapping[str, Any] | None = None,
    width: str | float | None = None,
    title: str | None = "",
    labels: Mapping[str, str] | None = None,
    limits: Mapping[str, tuple[float, float]] | None = None,
    letters: bool = False,
) -> dict[str, Any]:
    """What is said of a figure, as parts of the `Look`; `StudyError` for what no figure can have."""
    for name, told in (("select", select), ("labels", labels), ("limits", limits)):
        if told is not None and not isinstance(told, Mapping):
            raise StudyError(f"{name} is {told!r}; expected a mapping, as {_AS[name]}")
    if not (title is None or isinstance(title, str)):
        raise StudyError(f"title is {title!r}; expected words, or None for no title")
    for row, words in (labels or {}).items():
        if not (isinstance(row, str) and isinstance(words, str)):
            raise StudyError(f"labels of {row!r} are {words!r}; expected words, as {_AS['labels']}")
    if not (width is None or isinstance(width, str | Real)):
        raise StudyError(f"width is {width!r}; expected {WIDTHS_IN_WORDS}")
    for row, ends in (limits or {}).items():
        two = isinstance(ends, tuple | list) and len(ends) == 2 and all(isinstance(end, Real) for end in ends)
        if not (isinstance(row, str) and two):
            raise StudyError(f"limits of {row!r} are {ends!r}; expected two numbers, as {_AS['limits']}")
    said = {"select": select, "labels": labels, "limits": limits, "letters": letters, "width": width_of(width)}
    return {key: value for key, value in said.items() if value} | ({} if title == "" else {"title": title})


def check_format(plot_format: str) -> None:
    """`StudyError` for what no figure is written in."""
    if plot_format not in FORMATS:
        raise StudyError(f"--format {plot_format}: expected {', '.join(FORMATS)}")


def draw(path: Path, asked: Asked | None = None, plot_format: str = "png") -> tuple[tuple[Drawn, ...], tuple[str, ...]]:
    """Draw plots beside a dataset file.

    Args:
        path: the dataset; plots appear as <kind>.<format> in its folder, the second of a kind as <kind>_2.<format>.
        asked: kinds of plot; None = those its content suggests.
        plot_format: png, pdf or svg.

    Returns:
        The files drawn, and a sentence for each kind asked for that the dataset cannot show.

    Raises:
        StudyError: the file cannot be read, the format is unknown, or no plot can be written there.
    """
    check_format(plot_format)
    if asked is not None and not asked:
        return (), ()
    from rockcli.plotting.import_matplotlib import import_lean

    import_lean()
    from rockcli.plotting.figures import default_kinds

    dataset = open_lazily(path)
    if asked is None:
        asked = [(kind, Look()) for kind in default_kinds(dataset)]
    targets = [path.parent / f"{name}.{plot_format}" for name in _names(kind for kind, _ in asked)]
    for target in targets:
        check_file(target)
    drawn, complaints = [], []
    for (kind, look), target in zip(asked, targets, strict=True):
        log.info("drawing %s", target.name)
        try:
            drawn.append(_write(dataset, kind, look, target))
        except StudyError as error:
            complaints.append(error.message)
    return tuple(drawn), tuple(complaints)


def left_over(path: Path, drawn: Sequence[Path], *, every: bool) -> str:
    """A sentence on the figures beside a dataset that earlier runs drew, but for `drawn`; "" where there are none.

    every: all of them, as where none is wanted; else those that are older than the dataset.
    """
    from rockcli.study.schema import PLOTS

    name = re.compile(rf"({'|'.join(PLOTS)})(_[0-9]+)?\.({'|'.join(FORMATS)})")
    written = path.stat().st_mtime
    found = [
        one.name
        for one in sorted(path.parent.iterdir())
        if name.fullmatch(one.name) and one not in drawn and (every or one.stat().st_mtime < written)
    ]
    return f"left by an earlier run, and not drawn by this one: {', '.join(found)}" if found else ""


def _names(kinds: Iterator[str]) -> list[str]:
    seen: Counter[str] = Counter()
    names = []
    for kind in kinds:
        seen[kind] += 1
        names.append(kind if seen[kind] == 1 else f"{kind}_{seen[kind]}")
    return names


def _write(dataset: xarray.Dataset, kind: str, look: Look, target: Path) -> Drawn:
    from rockcli.plotting.common.style import untold
    from rockcli.plotting.figures import figure

    drawn = figure(kind, dataset, look)
    write_figure(drawn, target)
    return Drawn(target, untold(drawn))


def write_figure(drawn: Figure, path: Path) -> None:
    """Write a figure whole or not at all, by the ending of the name in the format of it; OutputError where it fails."""
    from rockcli.plotting.common.style import save

    with replacing(path) as scratch:
        save(drawn, scratch)


def format_of(path: Path) -> str:
    """What the ending of a name says: `png`."""
    return path.suffix.lower().lstrip(".")


def asked_of(dataset: xarray.Dataset, kinds: Sequence[str] = (), **changed: Any) -> Asked:
    """Kinds of plot of a dataset, each as its study wants it but for what is changed.

    Args:
        dataset: of `rock run`.
        kinds: names; () = those that its study lists, else those that its content suggests.
        changed: parts of the `Look`.
    """
    from rockcli.plotting.common.selection import selected
    from rockcli.plotting.figures import default_kinds
    from rockcli.study.reopen import plots_of

    listed = plots_of(str(dataset.attrs.get("study", "")))
    if kinds:
        looks = dict(reversed(listed))
        listed = [(kind, looks.get(kind, Look())) for kind in kinds]
    elif not listed:
        part, _ = selected(dataset, changed.get("select", {}))
        listed = [(kind, Look()) for kind in default_kinds(part)]
    return [(kind, replace(look, **changed)) for kind, look in listed]


def draw_as_told(
    files: Sequence[Path], out: Path | None, kinds: Sequence[str], plot_format: str = "png", **changed: Any
) -> tuple[Drawn, ...]:
    """Draw dataset files as a command tells it: each beside its file, or all of them in one figure, `out`.

    Args:
        files: the datasets.
        out: the figure, .png, .pdf or .svg; None = <kind>.<format> beside each dataset.
        kinds, changed: as `asked_of`.
        plot_format: png, pdf or svg, where `out` is not given.

    Raises:
        StudyError: a file cannot be read, or cannot be drawn so.
    """
    from rockcli.plotting.import_matplotlib import import_lean

    import_lean()
    if out is not None:
        datasets = [open_dataset(file) for file in files]
        names = [str(each.attrs.get("study_name") or file.stem) for each, file in zip(datasets, files, strict=True)]
        if len(kinds) > 1:
            raise StudyError("--out names one figure: give one --kind with it")
        from rockcli.plotting.common.style import untold

        whole = figure_of(datasets, kinds[0] if kinds else None, out, names=names, **changed)
        return (Drawn(out, untold(whole)),)
    from rockcli.plotting.common.selection import selected

    drawn: list[Drawn] = []
    for file in files:
        dataset = open_lazily(file)
        selected(dataset, changed.get("select", {}))
        made, complaints = draw(file, asked_of(dataset, kinds, **changed), plot_format)
        if not made and not kinds:  # nothing suggests itself: whatever there is
            from rockcli.plotting.figures import KINDS

            made, complaints = draw(file, asked_of(dataset, tuple(KINDS), **changed), plot_format)
        drawn += made
        if complaints and (kinds or not made):
            before = "" if kinds else "nothing in it can be drawn: "
            raise StudyError(before + "; ".join(complaints), file=file)
    return tuple(drawn)


def _shows(dataset: xarray.Dataset, kind: str, look: Look) -> bool:
    """Whether a dataset has what a plot of it selects and shows."""
    from rockcli.plotting.common.selection import selected
    from rockcli.plotting.figures import why_not

    try:
        part, _ = selected(dataset, look.select)
    except StudyError:
        return False
    return not why_not(kind, part)


def figure_of(
    dataset: xarray.Dataset | Sequence[xarray.Dataset],
    kind: str | None = None,
    path: Path | None = None,
    *,
    names: Sequence[str] = (),
    **changed: Any,
) -> Figure:
    """One figure of a dataset in memory, or of several laid over one another.

    Args:
        dataset: of rockcli.run or of a file; several with the same axes.
        kind: kind of plot; None = the first that its study lists or its content suggests; of a part of a dataset the
            first of these that it can show.
        path: also written there, as png, pdf or svg by its ending.
        names: of several datasets; () = those of their studies.
        changed: parts of the `Look`, instead of what the study says.

    Raises:
        StudyError: the dataset cannot be drawn so, or no figure can be written to `path`.
    """
    from rockcli.plotting.common.selection import overlaid, selected
    from rockcli.plotting.figures import default_kinds, figure, why_not

    several: list[xarray.Dataset] = (
        [*dataset] if isinstance(dataset, list | tuple) else [cast("xarray.Dataset", dataset)]
    )
    if not several:
        raise StudyError("an empty list: expected one dataset of `rock run` or rockcli.run, or several")
    if not (kind is None or isinstance(kind, str)):
        raise StudyError(f"kind is {kind!r}; expected the name of a kind of plot, as 'histories'")
    if path is not None and format_of(path) not in FORMATS:
        raise StudyError(f"expected a name that ends in {', '.join('.' + one for one in FORMATS)}", file=path)
    if path is not None:
        check_file(path)
    whole, several = several, [with_axes_left(each) for each in several]
    one = several[0]
    if len(several) > 1:
        words = list(names) or [str(each.attrs.get("study_name") or i) for i, each in enumerate(several, 1)]
        one = overlaid([selected(each, changed.get("select", {}))[0] for each in several], words)
        changed = {key: value for key, value in changed.items() if key != "select"}
    asked = asked_of(one, () if kind is None else (kind,), **changed)
    if kind is None and any(of_a_part(each) for each in whole):
        part, _ = selected(one, changed.get("select", {}))
        suggested = ((suggestion, replace(Look(), **changed)) for suggestion in default_kinds(part))
        asked = [(each, look) for each, look in (*asked, *suggested) if _shows(one, each, look)] or asked
    if not asked:
        raise StudyError("nothing in it suggests a figure; name a kind")
    wanted = asked[0][0]
    if len(several) > 1 and why_not(wanted, one) and not why_not(wanted, several[0]):
        raise StudyError(
            f"plot {wanted!r} is drawn of one dataset at a time; alternatives that are settings of an axis of one "
            "study (vary: case) are its panels"
        )
    drawn = figure(wanted, one, asked[0][1])
    if path is not None:
        write_figure(drawn, path)
    return drawn
