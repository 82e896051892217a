"""The report of a dataset file as one HTML page, from the file alone."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from rockcli.analysis.expect import Verdict, judge
from rockcli.analysis.fragility.curves import FITTED, STATUS, WHY_NOT
from rockcli.analysis.places import units_of
from rockcli.analysis.rules import misled
from rockcli.analysis.suites.words import why_no_curve
from rockcli.errors import StudyError
from rockcli.scene.axis_path import axis_path
from rockcli.scene.limit_states import OVERTURNED
from rockcli.scene.units import written
from rockcli.scene.variables import HAZARD, INPUT, LIMIT, MEASURE, PEAK
from rockcli.storage import netcdf
from rockcli.storage.atomic import write_text
from rockcli.storage.contents import Contents
from rockcli.storage.lazy import lazily
from rockcli.storage.places import check_file
from rockcli.storage.read import from_xarray, of_a_part, with_axes_left
from rockcli.storage.table import CURVE, items_of, table_of
from rockcli.study.reopen import clauses_of

if TYPE_CHECKING:
    import xarray

    from rockcli.plotting.page.page import Table


def write_page(path: Path, out: Path | None = None) -> Path:
    """Write the report of a dataset; default: <dataset>.html beside it.

    Raises:
        StudyError: the file is not a dataset of this program, or a page cannot be where `out` says.
        OutputError: the page cannot be written.
    """
    target = path.with_suffix(".html") if out is None else out
    _check(target)
    contents = netcdf.read(path)
    dataset = lazily(contents)
    _write(dataset, contents, target, whole=not of_a_part(dataset))
    return target


def write_page_of(dataset: xarray.Dataset, out: Path) -> Path:
    """Write the report of a dataset in memory; of a part of one nothing is judged.  Raises as `write_page`."""
    _check(out)
    contents = from_xarray(dataset)
    _write(with_axes_left(dataset), contents, out, whole=not of_a_part(dataset))
    return out


def _check(target: Path) -> None:
    if target.suffix.lower() not in (".html", ".htm"):
        raise StudyError("a report is an HTML page: expected a name that ends in .html or .htm", file=target)
    check_file(target)


def _write(dataset: xarray.Dataset, contents: Contents, target: Path, *, whole: bool) -> None:
    from rockcli.plotting.import_matplotlib import import_lean

    import_lean()
    from rockcli.plotting.page.page import page

    judged = [(verdict.passed, _words(verdict)) for verdict in verdicts(contents)] if whole else []
    write_text(target, page(dataset, judged, tables=[*_suite_tables(dataset, contents), *_rules_table(contents)]))


_LIMITS = (
    "fragility_second",
    "fragility_median",
    "fragility_median_ci_low",
    "fragility_median_ci_high",
    "fragility_beta_total",
)
_RATES = ("annual_rate", "annual_rate_ci_low", "annual_rate_ci_high")
_SLIDES = ("slide_peak_p50", "slide_peak_p84")

_WANTED: dict[str, tuple[str, tuple[str, ...]]] = {
    "fragility": ("Fragility", (*_LIMITS, "fragility_percentile_5", "fragility_begins_at", CURVE)),
    "risk": ("Risk", (*_RATES, "probability_in_age", "survival", CURVE)),
    "suite": ("The suite", ("n_answered", "p_overturned", *(f"{PEAK}_{p}" for p in ("p16", "p50", "p84")), *_SLIDES)),
}
"""Tables of a page: title, and which columns."""

_ROWS_SHOWN = 1000
"""Rows of a table of the suite."""


def _suite_tables(dataset: xarray.Dataset, contents: Contents) -> list[Table]:
    """What the suite comes to, as `rock table --of` has it, accelerations in g."""
    from rockcli.plotting.page.facts import name_of

    found: list[Table] = []
    words = units_of(contents)
    for of, (title, wanted) in _WANTED.items():
        try:
            every = table_of(items_of(dataset), dataset.attrs, of=of)
        except StudyError:
            continue
        (block,) = every.blocks(max(every.size, 1))
        bare = {column.head.partition(" [")[0]: column for column in block}
        axes = str(dataset.attrs["axes"]).split()
        about = [name for name in bare if name in (*axes, LIMIT, HAZARD)]
        said = {*bare[CURVE].values} if CURVE in bare else set()
        none = [status for status in WHY_NOT if STATUS[status] in said]
        heads, columns = [], []
        for name in (*about, *(name for name in wanted if name in bare and (none or name != CURVE))):
            divisor, unit = words.of(bare[name].head.partition(" [")[2].rstrip("]"))
            values = bare[name].values[:_ROWS_SHOWN].tolist()
            called = name_of(dataset, name) if name in axes else _said(name)
            heads.append(called + (f" [{written(unit)}]" if unit else ""))
            columns.append([_cell(v, divisor, name) for v in values])
        notes = [f"{_curve(STATUS[status])}: {why_no_curve(contents, status)}" for status in none]
        if every.size > _ROWS_SHOWN:
            notes.append(f"the first {_ROWS_SHOWN} of {every.size} rows; all: rock table --of {of}")
        found.append((title, heads, [*map(list, zip(*columns, strict=True))], "; ".join(notes)))
    return found


def _cell(value: float | str, divisor: float, name: str) -> str:
    """A value of a table; a dash where there is none."""
    if name == CURVE:
        return _curve(str(value))
    if isinstance(value, str):
        return f"peak theta/alpha > {value}" if name == LIMIT and ">" not in value and value != OVERTURNED else value
    if isinstance(value, int) and divisor == 1.0:  # counts, whole
        return str(value)
    return f"{value / divisor:.4g}" if value == value else "–"


def _curve(status: str) -> str:
    """Whether there is a curve, as a cell says it."""
    return status if status == STATUS[FITTED] else f"none ({status.replace('_', ' ')})"


_SAID = {
    "fragility_status": "curve",
    "fragility_second": "at a second intensity of",
    "fragility_": "",
    "_ci_low": ", lower 95 %",
    "_ci_high": ", upper 95 %",
    "theta_peak_over_alpha": "peak theta/alpha",
    "_p16": ", 16th percentile",
    "_p50": ", median",
    "_p84": ", 84th percentile",
    "percentile_5": "exceeded with 5 %",
    "n_answered": "members with an answer",
    "p_overturned": "probability of overturning",
    "beta_total": "beta",
}
"""What heads of tables are called on a page."""


def _said(name: str) -> str:
    for one, other in _SAID.items():
        name = name.replace(one, other)
    return name.replace("_", " ").strip()


def _rules_table(contents: Contents) -> list[Table]:
    """How the rules of thumb compare with the histories."""
    head = ["rule", "edition", "cases", "unconservative", "false alarms"]
    rows = [
        [r.name, r.edition, str(r.cases), f"{r.unconservative:.4g}", f"{r.false_alarms:.4g}"]
        for r in misled(contents)
        if r.cases
    ]
    note = "unconservative: stable by the rule, overturned by the history, or slides farther; false alarm: the opposite"
    return [("Rules of thumb and code checks", head, rows, note)] if rows else []


def verdicts(contents: Contents) -> list[Verdict]:
    """The clauses of `expect` in the study that a dataset holds, judged again on what it holds.

    There are none of a trade, whose points are settings and not those of its study.
    """
    if "trade_references" in contents.attrs:
        return []
    named = (*contents.axes, *(name for name in (LIMIT, MEASURE, INPUT, HAZARD) if name in contents.fields))
    axes = [(name, axis_path(contents.fields[name].attrs, name), contents.values(name)) for name in named]
    clauses = clauses_of(contents.attrs.get("study", ""), axes, tuple(contents.fields))
    return judge(contents, clauses, units_of(contents))


def _words(verdict: Verdict) -> str:
    many = f"{verdict.failing} of {verdict.points} points fail: " if verdict.failing and verdict.points > 1 else ""
    where = f" at {verdict.where}" if verdict.where else ""
    return f"{verdict.text}: {many}{verdict.worst}{where}"
