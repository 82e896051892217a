"""Scores as a page of HTML or as a figure of the reliability of the first prediction."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rockcli.analysis.experiments.scores import NAMES, SENTENCES
from rockcli.engine.draw import FORMATS, format_of, write_figure
from rockcli.errors import StudyError
from rockcli.scene.counted import counted
from rockcli.storage.atomic import write_text
from rockcli.storage.places import check_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from rockcli.engine.experiments.score import Report
    from rockcli.plotting.page.scores import Section

PAGES = (".html", ".htm")


def check_target(path: Path) -> None:
    """`StudyError` for a name that ends otherwise, or a place that cannot be written."""
    if path.suffix.lower() not in PAGES and format_of(path) not in FORMATS:
        raise StudyError(f"ends in {path.suffix!r}; expected .html, .{', .'.join(FORMATS)}", file=path)
    check_file(path)


def write(reports: Sequence[Report], path: Path) -> None:
    """Write the page, or the figure, of which there is one a specimen: NAME-SPECIMEN.png of several.

    Raises:
        OutputError: it cannot be written.
    """
    if path.suffix.lower() in PAGES:
        from rockcli.plotting.page.scores import page

        write_text(path, page(path.stem, [section for report in reports for section in _sections(report)]))
        return
    for report in reports:
        target = path if len(reports) == 1 else path.with_stem(f"{path.stem}-{report.specimen}")
        write_figure(_figure(report), target)


def _figure(report: Report) -> Figure:
    from rockcli.plotting.reliability import Point, figure

    points = [Point(one.p, one.share, one.low, one.high, one.n) for one in report.reliability[report.against]]
    found = report.scores[report.against]
    words = f"{counted(found.n, 'run')}, {found.events} overturned; limits of 95 %"
    return figure(points, " ".join(filter(None, (report.specimen, report.against))), words)


def _sections(report: Report) -> list[Section]:
    """(title, head, rows, sentence, figure) of the parts of the page."""
    found = report.scores
    rows = [
        [name, str(each.n), *(_words(each.scores[score]) for score in NAMES), str(each.missed), str(each.false)]
        for name, each in found.items()
    ]
    head = ["prediction", "runs", *(name.replace("_", " ") for name in NAMES), "missed", "false"]
    said = "; ".join(f"{name.replace('_', ' ')}: {SENTENCES[name]}" for name in NAMES)
    what = f"{report.specimen}: " if report.specimen else ""
    sections: list[Section] = [
        (f"{what}Scores", head, rows, f"Intervals of 95 % by a bootstrap of the groups. {said}.", None)
    ]
    tests = [[name, *test.cells()] for name, test in report.mcnemar.items()]
    if tests:
        head = ["other prediction", "runs", f"{report.against} alone right", "other alone right", "p"]
        said = "McNemar's exact test, two-sided; it takes the runs for independent."
        sections.append((f"{what}{report.against} against the others", head, tests, said, None))
    bins = [
        [f"{one.p:.3f}", str(one.n), f"{one.share:.3f}", f"{one.low:.3f} to {one.high:.3f}"]
        for one in report.reliability[report.against]
    ]
    said = f"Runs by the probability that {report.against} gives them, and the share that overturned."
    sections.append((f"{what}Reliability", ["probability", "runs", "overturned", "95 %"], bins, said, _figure(report)))
    if report.notes:
        sections.append((f"{what}Notes", [], [[note] for note in report.notes], "", None))
    return sections


def _words(score: object) -> str:
    value, low, high = (getattr(score, name) for name in ("value", "low", "high"))
    said = "-" if value != value else f"{value:.3f}"
    return said if low != low else f"{said} ({low:.3f} to {high:.3f})"
