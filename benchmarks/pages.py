"""Sections of pages that benchmarks make: what stands between two marks, and tables with a line that says where from."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path


def section(page: Path, begin: str, end: str) -> str:
    """What stands on a page between two marks."""
    return page.read_text(encoding="utf-8").split(begin)[1].split(end)[0].strip()


def write_section(page: Path, begin: str, end: str, lines: Iterable[str]) -> None:
    """Put lines between two marks of a page, in place of what is there."""
    before, rest = page.read_text(encoding="utf-8").split(begin)
    page.write_text("\n".join([before + begin, *lines, end]) + rest.split(end)[1], encoding="utf-8")


def read_rows(path: Path) -> tuple[list[dict[str, str]], str]:
    """Rows of a csv, and the stamp in its first line."""
    with path.open(encoding="utf-8", newline="") as file:
        stamp = file.readline().removeprefix("# ").strip()
        return list(csv.DictReader(file)), stamp


def write_rows(path: Path, stamp: str, names: Sequence[str], rows: Iterable[Mapping[str, object]]) -> None:
    """Write rows below a stamp, which says when and where they were measured."""
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(f"# {stamp}\n")
        writer = csv.DictWriter(file, names, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
