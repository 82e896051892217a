"""The verdicts of a run as JUnit XML, for a CI service."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

from rockcli.cli.progress import counted
from rockcli.cli.words import verdict_text
from rockcli.errors import OutputError
from rockcli.storage.atomic import replacing
from rockcli.storage.places import reason

if TYPE_CHECKING:
    from rockcli.engine.report import RunReport


def write_junit(reports: Sequence[RunReport], path: Path) -> None:
    """One test suite per study: a test for its cases being solved, and one per clause of `expect`."""
    root = ET.Element("testsuites", name="rock run")
    for report in reports:
        root.append(_suite(report))
    ET.indent(root)
    tree = ET.ElementTree(root)
    if path.exists() and not path.is_file():  # a pipe or a device
        try:
            tree.write(path, encoding="utf-8", xml_declaration=True)
        except OSError as error:
            raise OutputError(f"cannot be written: {reason(error)}", file=path) from error
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as scratch:
        tree.write(scratch, encoding="utf-8", xml_declaration=True)


def _suite(report: RunReport) -> ET.Element:
    skipped = report.status == "skipped"
    failures = report.unmet + bool(report.failed)
    suite = ET.Element(
        "testsuite",
        name=report.name,
        tests=str(1 + len(report.verdicts)),
        failures=str(failures),
        skipped=str(int(skipped)),
        time=f"{report.seconds:.3f}",
    )
    solved = ET.SubElement(suite, "testcase", classname=report.name, name="all cases solved")
    if skipped:
        ET.SubElement(solved, "skipped", message="; ".join(report.warnings))
    if report.failed:
        ET.SubElement(solved, "failure", message=f"{counted(report.failed, 'case')} failed")
    for verdict in report.verdicts:
        case = ET.SubElement(suite, "testcase", classname=report.name, name=verdict.text)
        if not verdict.passed:
            ET.SubElement(case, "failure", message=verdict_text(verdict))
    return suite
