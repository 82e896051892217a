"""The report of a dataset file as one HTML page, from the file alone."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from rockcli.analysis.expect import Verdict, judge
from rockcli.analysis.places import units_of
from rockcli.errors import StudyError
from rockcli.scene.variables import HAZARD, INPUT, LIMIT, MEASURE
from rockcli.storage import netcdf
from rockcli.storage.atomic import write_text
from rockcli.storage.contents import Contents
from rockcli.storage.read import from_xarray, open_dataset
from rockcli.study.reopen import clauses_of

if TYPE_CHECKING:
    import xarray


def write_page(path: Path, out: Path | None = None) -> Path:
    """Write the report of a dataset; default: <dataset>.html beside it.

    Raises:
        StudyError: the file is not a dataset of this program, or `out` would replace it.
        OutputError: the page cannot be written.
    """
    target = path.with_suffix(".html") if out is None else out
    _check(target)
    _write(open_dataset(path), netcdf.read(path), target)
    return target


def write_page_of(dataset: xarray.Dataset, out: Path) -> Path:
    """Write the report of a dataset in memory; raises as `write_page`."""
    _check(out)
    _write(dataset, from_xarray(dataset), out)
    return out


def _check(target: Path) -> None:
    if target.suffix.lower() not in (".html", ".htm"):
        raise StudyError("a report is an HTML page: expected a name that ends in .html", file=target)


def _write(dataset: xarray.Dataset, contents: Contents, target: Path) -> None:
    from rockcli.plotting.page.page import page

    write_text(target, page(dataset, [(verdict.passed, _words(verdict)) for verdict in verdicts(contents)]))


def verdicts(contents: Contents) -> list[Verdict]:
    """The clauses of `expect` in the study that a dataset holds, judged again on what it holds.

    There are none of a trade, whose points are settings and not those of its study.
    """
    if "trade_references" in contents.attrs:
        return []
    named = (*contents.axes, *(name for name in (LIMIT, MEASURE, INPUT, HAZARD) if name in contents.fields))
    axes = [(name, str(contents.fields[name].attrs.get("long_name", name)), contents.values(name)) for name in named]
    clauses = clauses_of(contents.attrs.get("study", ""), axes, tuple(contents.fields))
    return judge(contents, clauses, units_of(contents))


def _words(verdict: Verdict) -> str:
    many = f"{verdict.failing} of {verdict.points} points fail: " if verdict.failing and verdict.points > 1 else ""
    where = f" at {verdict.where}" if verdict.where else ""
    return f"{verdict.text}: {many}{verdict.worst}{where}"
