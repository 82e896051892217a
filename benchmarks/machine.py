"""Tables of results: each figure with the date and the machine it was measured on."""

from __future__ import annotations

import csv
import os
import platform
from collections.abc import Iterable, Sequence
from datetime import date
from pathlib import Path


def machine() -> str:
    """Processor, cores and Python, in a line."""
    name = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        for line in cpuinfo.read_text().splitlines():
            if line.startswith("model name"):
                name = line.split(":", 1)[1].strip()
                break
    return f"{name}, {os.cpu_count()} cores, Python {platform.python_version()}"


def write_results(path: Path, head: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write a csv of what was measured, with `measured` and `machine` as its last columns."""
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow([*head, "measured", "machine"])
        table.writerows([*row, date.today().isoformat(), machine()] for row in rows)
