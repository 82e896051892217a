"""Draws the plots of a dataset file, from the file alone."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from rockcli.errors import StudyError
from rockcli.storage.atomic import replacing
from rockcli.storage.read import open_dataset

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

FORMATS = ("png", "pdf", "svg")


def draw(
    path: Path, kinds: tuple[str, ...] | None = None, plot_format: str = "png"
) -> tuple[tuple[Path, ...], tuple[str, ...]]:
    """Draw plots beside a dataset file.

    Args:
        path: the dataset; plots appear as <kind>.<format> in its folder.
        kinds: kinds of plot; None = those its content suggests.
        plot_format: png, pdf or svg.

    Returns:
        The files drawn, and a sentence for each kind asked for that the dataset cannot show.

    Raises:
        StudyError: the file cannot be read, or the format or a kind is unknown.
    """
    if plot_format not in FORMATS:
        raise StudyError(f"unknown format {plot_format!r}; there are {', '.join(FORMATS)}")
    if kinds == ():
        return (), ()
    from rockcli.plotting.figures import default_kinds, figure, save, why_not

    dataset = open_dataset(path)
    drawn, complaints = [], []
    for kind in default_kinds(dataset) if kinds is None else kinds:
        complaint = why_not(kind, dataset)
        if complaint:
            complaints.append(f"plot {kind!r}: {complaint}")
            continue
        target = path.parent / f"{kind}.{plot_format}"
        with replacing(target) as scratch:
            save(figure(kind, dataset), scratch, plot_format)
        drawn.append(target)
    return tuple(drawn), tuple(complaints)


def figure_of(dataset: xarray.Dataset, kind: str | None = None, path: Path | None = None) -> Figure:
    """One figure of a dataset in memory.

    Args:
        dataset: of rockcli.run or of a file.
        kind: kind of plot; None = the first that its content suggests.
        path: also written there, as png, pdf or svg by its ending.

    Raises:
        StudyError: the dataset cannot be drawn so, or the ending is none of a figure.
    """
    from rockcli.plotting.figures import default_kinds, figure, save, why_not

    if "axes" not in dataset.attrs:
        raise StudyError("is not a dataset of `rock run` or rockcli.run: it does not name its axes")
    suggested = default_kinds(dataset) if kind is None else (kind,)
    if not suggested:
        raise StudyError("nothing in it suggests a figure; name a kind")
    if complaint := why_not(suggested[0], dataset):
        raise StudyError(f"plot {suggested[0]!r}: {complaint}")
    if path is not None and path.suffix.lower().lstrip(".") not in FORMATS:
        raise StudyError(f"expected a name that ends in {', '.join('.' + one for one in FORMATS)}", file=path)
    drawn = figure(suggested[0], dataset)
    if path is not None:
        with replacing(path) as scratch:
            save(drawn, scratch, path.suffix.lower().lstrip("."))
    return drawn
