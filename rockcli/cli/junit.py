"""The `expect` checks of a run as JUnit XML, for a CI service."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

from rockcli.cli.words import verdict_text
from rockcli.errors import OutputError, StudyError
from rockcli.scene.counted import counted
from rockcli.storage.atomic import replacing
from rockcli.storage.places import check_file, reason

if TYPE_CHECKING:
    from rockcli.engine.summary import RunReport


_ROOT = re.compile(rb"<testsuites?\b")

COUNTS = ("tests", "failures", "errors", "skipped")
"""Attributes of a test suite that add up over the run."""


def check_junit(path: Path, datasets: Sequence[Path]) -> None:
    """Refuse a place for the verdicts before anything is solved.

    Raises:
        StudyError: it cannot be written, holds what is no JUnit file, or is where a dataset goes.
    """
    if os.path.exists(path) and not (os.path.isfile(path) or os.path.isdir(path)):  # a pipe or a device
        return
    check_file(path)
    if os.path.realpath(path) in {os.path.realpath(dataset) for dataset in datasets}:
        raise StudyError("is the place of a dataset: --junit needs a file of its own", file=path)
    if path.exists() and not _is_ours(path):
        raise StudyError("exists and is not a JUnit file: --junit does not replace it", file=path)


def _is_ours(path: Path) -> bool:
    """Whether a file is JUnit XML, or empty."""
    with path.open("rb") as file:
        head = file.read(4096)
    return not head or _ROOT.search(head) is not None


def write_junit(reports: Sequence[RunReport], path: Path) -> None:
    """One test suite per study: a test for its cases being solved, and one per clause of `expect`.

    Raises:
        OutputError: another file is there, or it cannot be written.
    """
    suites = [_suite(report) for report in reports]
    root = ET.Element("testsuites", name="rock run")
    for count in COUNTS:
        root.set(count, str(sum(int(suite.get(count, 0)) for suite in suites)))
    root.set("time", f"{sum(report.seconds for report in reports):.3f}")
    root.extend(suites)
    ET.indent(root)
    tree = ET.ElementTree(root)
    if path.exists() and not path.is_file():  # a pipe or a device
        try:
            tree.write(path, encoding="utf-8", xml_declaration=True)
        except OSError as error:
            raise OutputError(f"cannot be written: {reason(error)}", file=path) from error
        return
    if path.exists() and not _is_ours(path):  # made since it was checked, as a plot
        raise OutputError("exists and is not a JUnit file: --junit does not replace it", file=path)
    with replacing(path) as scratch:
        tree.write(scratch, encoding="utf-8", xml_declaration=True)


def _suite(report: RunReport) -> ET.Element:
    skipped = "; ".join(report.warnings) if report.status == "skipped" else ""
    if report.share is not None:
        skipped = f"share {report.share[0]}/{report.share[1]}: the run that merges the shares judges their cases"
    failures = report.unmet + bool(report.failed)
    suite = ET.Element(
        "testsuite",
        name=report.name,
        tests=str(1 + len(report.verdicts)),
        failures=str(failures),
        errors="0",
        skipped=str(int(bool(skipped))),
        time=f"{report.seconds:.3f}",
    )
    solved = ET.SubElement(suite, "testcase", classname=report.name, name="all cases solved")
    if skipped:
        ET.SubElement(solved, "skipped", message=skipped)
    if report.failed:
        ET.SubElement(solved, "failure", message=f"{counted(report.failed, 'case')} failed")
    for verdict in report.verdicts:
        case = ET.SubElement(suite, "testcase", classname=report.name, name=verdict.text)
        if not verdict.passed:
            ET.SubElement(case, "failure", message=verdict_text(verdict))
    return suite
