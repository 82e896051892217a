"""Draws the plots of a dataset file, from the file alone."""

from __future__ import annotations

from pathlib import Path

from rockcli.errors import StudyError
from rockcli.storage.atomic import replacing
from rockcli.storage.read import open_dataset

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
