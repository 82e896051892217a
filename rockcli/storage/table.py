"""Datasets as tables, in blocks of rows: the cases, or what a suite comes to, one row for each.

Histories are never in a table.  A block is read when it is asked for, so a file of any size passes through in pieces;
one that is sorted is read whole.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import StudyError
from rockcli.scene.axis_path import axis_path
from rockcli.scene.limit_states import exceeded_when
from rockcli.scene.units import SI, Units, g_of
from rockcli.scene.variables import BOUNDARY_POINT, HAZARD, INPUT, INTENSITY_BIN, LIMIT, MEASURE, PERCENTILE
from rockcli.storage.checksum import note_opened
from rockcli.storage.contents import COORDINATES, OF_TABLES
from rockcli.storage.netcdf import open_file
from rockcli.storage.read import with_axes_left

if TYPE_CHECKING:
    import pandas
    import xarray

CASES, BOUNDARIES = "cases", "boundaries"

TABLES: dict[str, str] = {
    CASES: "one row per case: what was varied, what became of it, every scalar",
    "suite": "what the suite does at every point of the other axes: shares, fractiles",
    "fragility": "one row per body and limit state: median, beta, their limits, percentiles",
    "risk": "one row per body, limit state and hazard curve: annual rate, its limits, survival",
    "deaggregation": "one row per body, limit state, hazard curve and bin of intensity: its share of the rate",
    "stripes": "one row per intensity and limit state: the share that exceeds it",
    "demand": "one row per measure of the motion: its correlation with the peak",
    "inputs": "one row per uncertain input: how much it matters",
    BOUNDARIES: "of a refined map, one row per point of the curves between outcomes",
}
"""Tables by name, and what they hold."""

BLOCK = 65_536
"""Rows read at a time."""

_REASON, _REASONS = "reason", "reasons"

CURVE = "fragility_status"
"""Whether a body has a fragility curve."""

_Points = dict[str, Any]
"""Dimension -> the points of a block on it: a slice, or of a sorted table an index of every row."""


@dataclass(frozen=True, eq=False)
class Column:
    """One column of numbers or words.

    Attributes:
        name: of the variable.
        head: `name [unit]`; `name` where there is no dimension.
        values: one for each row of the block.
    """

    name: str
    head: str
    values: NDArray[Any]


@dataclass(frozen=True, eq=False)
class Item:
    """A variable, read in pieces by indexing `values`."""

    dims: tuple[str, ...]
    values: Any
    attrs: Mapping[str, Any]

    def read(self) -> Item:
        """The same, all of it in memory."""
        return replace(self, values=np.asarray(self.values[...]))


@dataclass(frozen=True, eq=False)
class Table:
    """A table that is read in blocks.

    Attributes:
        dims: dimensions of which it has a row for every point, the last one running fastest unless it is sorted.
        names: variables that are its columns, in order, the coordinates of `dims` first.
        size: number of rows.
    """

    dims: tuple[str, ...]
    names: tuple[str, ...]
    size: int
    _items: Mapping[str, Item]
    _sizes: Mapping[str, int]
    _units: Units
    _degrees: bool
    _order: NDArray[np.int64] | None = None
    """The rows in their order, as numbers of the points; None: that of the points."""

    def blocks(self, rows: int = BLOCK) -> Iterator[list[Column]]:
        """Yield its columns in blocks of about `rows` rows, in order."""
        for at in self._ordered(rows):
            yield [column for name in self.names for column in self._columns(name, at)]

    def _ordered(self, rows: int) -> Iterator[_Points]:
        """The points of blocks of about `rows` rows."""
        sizes = [self._sizes[dim] for dim in self.dims]
        if self._order is None:
            for place in _places(sizes, rows):
                yield dict(zip(self.dims, place, strict=True))
            return
        for start in range(0, self.size, rows):
            points = np.unravel_index(self._order[start : start + rows], sizes)
            yield dict(zip(self.dims, points, strict=True))

    def sorted_by(self, name: str, *, descending: bool) -> Table:
        """The same rows by the numbers or words of a column; equal ones as they were, those without a value last."""
        if self.size < 2:
            return self
        (column,) = self._columns(name, {dim: slice(0, self._sizes[dim]) for dim in self.dims})
        values = column.values
        _, rank = np.unique(values, return_inverse=True)
        without = values == "" if values.dtype == object else values != values
        order = np.lexsort((-rank if descending else rank, without))
        wholes = [each if each in self._items else _percentile_of(each, self._items)[0] for each in self.names]
        read = {each: self._items[each].read() for each in {*wholes, _REASONS, PERCENTILE} & self._items.keys()}
        return replace(self, _items=read, _order=order)

    def first(self, rows: int) -> list[Column]:
        """The columns of its first rows, all of them where there are no more."""
        blocks = self.blocks(rows)
        found, n = [], 0
        while n < min(rows, self.size):
            found.append(next(blocks))
            n += len(found[-1][0].values)
        whole = zip(*found, strict=True)
        return [Column(c[0].name, c[0].head, np.concatenate([part.values for part in c])[:rows]) for c in whole]

    def _columns(self, name: str, at: _Points) -> Iterator[Column]:
        """One column, or one for each percentile, of which `fragility_percentile_5` is one."""
        whole, asked = (name, "") if name in self._items else _percentile_of(name, self._items)
        item = self._items[whole]
        if PERCENTILE not in item.dims:
            yield self._column(name, item, self._values(item, at))
            return
        for i, percent in enumerate(_percents(self._items)):
            if asked in ("", percent):
                one = self._values(item, at | {PERCENTILE: slice(i, i + 1)})
                yield self._column(name, item, one, "" if asked else f"_{percent}")

    def _values(self, item: Item, at: _Points) -> NDArray[Any]:
        """One value for each row of a block, whatever the variable depends on."""
        values = np.asarray(item.values[tuple(at.get(dim, slice(None)) for dim in item.dims)])
        if self._order is not None:
            return np.broadcast_to(values.ravel(), len(at[self.dims[0]]))
        shape = tuple(at[dim].stop - at[dim].start for dim in self.dims)
        order = (*self.dims, *(dim for dim in item.dims if dim not in self.dims))
        values = values.transpose([item.dims.index(dim) for dim in order if dim in item.dims])
        values = values.reshape(values.shape[: sum(dim in item.dims for dim in self.dims)])
        index = tuple(slice(None) if dim in item.dims else None for dim in self.dims)
        return np.broadcast_to(values[index], shape).ravel()

    def _column(self, name: str, item: Item, values: NDArray[Any], end: str = "") -> Column:
        if "flag_meanings" in item.attrs:
            return Column(name, name, _words(values, item.attrs))
        if name == _REASON:
            return Column(name, name, _sentences(values, self._items.get(_REASONS)))
        if values.dtype.kind in "OUTS":
            words = values.astype(object)
            if name == LIMIT:
                words[:] = [exceeded_when(label) for label in words]
            return Column(name, name, words)
        unit = str(item.attrs.get("units", "1"))
        if self._degrees and unit == "rad":
            values, unit = np.degrees(values), "deg"
        divisor, unit = self._units.of(unit, axis_path(item.attrs, ""))
        head = name + end + ("" if unit == "1" else f" [{unit}]")
        return Column(name, head, values if divisor == 1.0 else values / divisor)


def _percents(items: Mapping[str, Item]) -> list[str]:
    """The percentiles of a dataset as names of columns end in them."""
    return [f"{p:g}" for p in np.asarray(items[PERCENTILE].values[:]).tolist()] if PERCENTILE in items else []


def _percentile_of(name: str, items: Mapping[str, Item]) -> tuple[str, str]:
    """`fragility_percentile_5` -> the variable and the percentile; two empty strings for what is none."""
    whole, _, percent = name.rpartition("_")
    there = whole in items and PERCENTILE in items[whole].dims and percent in _percents(items)
    return (whole, percent) if there else ("", "")


def _places(sizes: Sequence[int], rows: int) -> Iterator[tuple[slice, ...]]:
    """Boxes that cover a product of sizes in C order, of about `rows` points each."""
    cut, inner = len(sizes), 1
    while cut and inner * sizes[cut - 1] <= rows:
        cut -= 1
        inner *= sizes[cut]
    whole = tuple(slice(0, size) for size in sizes[cut:])
    if not cut:
        yield whole
        return
    step = max(1, rows // inner)
    for outer in np.ndindex(*sizes[: cut - 1]):
        fixed = tuple(slice(i, i + 1) for i in outer)
        for start in range(0, sizes[cut - 1], step):
            yield (*fixed, slice(start, min(start + step, sizes[cut - 1])), *whole)


def _words(values: NDArray[Any], attrs: Mapping[str, Any]) -> NDArray[Any]:
    """Flags as their meanings."""
    meanings = dict(zip(np.atleast_1d(attrs["flag_values"]).tolist(), str(attrs["flag_meanings"]).split(), strict=True))
    found, inverse = np.unique(values, return_inverse=True)
    words = np.array([meanings.get(value, "") for value in found.tolist()], dtype=object)
    return np.asarray(words[inverse.ravel()])


def _sentences(values: NDArray[Any], reasons: Item | None) -> NDArray[Any]:
    """The sentences that indices point to, "" where they point to none."""
    known = [] if reasons is None else [str(one) for one in np.asarray(reasons.values[:])]
    words = np.array([*known, ""], dtype=object)
    number = np.nan_to_num(np.asarray(values, dtype=float), nan=-1.0).astype(int)
    return np.asarray(words[np.where((number >= 0) & (number < len(known)), number, -1)])


def table_of(
    items: Mapping[str, Item],
    attrs: Mapping[str, Any],
    *,
    of: str = CASES,
    columns: Sequence[str] | None = None,
    degrees: bool = False,
    units: Units = SI,
    sort: str | None = None,
) -> Table:
    """The table of a name, with all of its columns or those asked for.

    Args:
        items, attrs: of a dataset.
        of: name of the table.
        columns: variables beside its dimensions; None = all.
        degrees: angles in degrees.
        units: of the other numbers.
        sort: a column of it, asked for or not, by which its rows stand; with `-` before it the largest first; None =
            as its points run.

    Raises:
        StudyError: there is no such table, or no such column in it.
    """
    if of not in TABLES:
        close = get_close_matches(of, TABLES, n=1)
        hint = f"; did you mean {close[0]!r}?" if close else ""
        raise StudyError(f"{of!r} is no table; expected one of {', '.join(TABLES)}{hint}")
    ensemble = json.loads(attrs.get("ensemble", "null"))
    axes = tuple(str(attrs["axes"]).split())
    dims = _dims(of, axes, ensemble)
    belong = [name for name, item in items.items() if _belongs(of, name, item, dims, ensemble)]
    if dims is None or (of != CASES and not belong):
        raise StudyError(f"has no table {of!r}; it has {', '.join(_there(items, axes, ensemble))}")

    def elsewhere(name: str) -> list[str]:
        """Tables of this dataset that have a variable."""
        others = {other: _dims(other, axes, ensemble) for other in TABLES if other != of}
        return [other for other, over in others.items() if _belongs(other, name, items[name], over, ensemble)]

    first = [dim for dim in dims if dim in items]
    rest = [name for name in belong if name not in first]
    if of not in (CASES, BOUNDARIES):  # what was said of the bodies, beside what becomes of them
        rest = [*(name for name, item in items.items() if _said(name, item, dims)), *rest]
    if of == "risk":  # why a body has no rate: one that never overturns and one that always does have none alike
        rest.append(CURVE)
    if "outcome" in rest:  # after the coordinates, before what was computed
        rest.remove("outcome")
        known = [name for name in rest if name in COORDINATES or name.startswith(OF_TABLES)]
        rest = [*known, "outcome", *(name for name in rest if name not in known)]
    chosen = rest if columns is None else [_known(name, items, [*first, *rest], elsewhere) for name in columns]
    names = (*first, *dict.fromkeys(name for name in chosen if name not in first))
    sizes = {dim: size for item in items.values() for dim, size in zip(item.dims, item.values.shape, strict=True)}
    size = int(np.prod([sizes[dim] for dim in dims], dtype=np.int64))
    table = Table(dims, names, size, items, sizes, units, degrees)
    if sort is None:
        return table
    by = _known(sort.removeprefix("-"), items, [*first, *rest], elsewhere)
    if by in items and PERCENTILE in items[by].dims:
        raise StudyError(f"column {by!r} is several: sort by one of {', '.join(f'{by}_{p}' for p in _percents(items))}")
    return table.sorted_by(by, descending=sort.startswith("-"))


def _dims(of: str, axes: tuple[str, ...], ensemble: Mapping[str, Any] | None) -> tuple[str, ...] | None:
    """Dimensions of which a table has a row each; None if this dataset has no such table."""
    if of in (CASES, BOUNDARIES):
        return axes if of == CASES else (BOUNDARY_POINT,)
    if ensemble is None:
        return None
    over = ensemble["axis"] if isinstance(ensemble["axis"], list) else [ensemble["axis"]]
    rest = tuple(axis for axis in axes if axis not in over)
    bodies = tuple(axis for axis in rest if axis != ensemble["along"])
    return {
        "suite": rest,
        "fragility": (*bodies, LIMIT),
        "risk": (*bodies, LIMIT, HAZARD),
        "deaggregation": (*bodies, LIMIT, HAZARD, INTENSITY_BIN),
        "stripes": (*rest, LIMIT),
        "demand": (*rest, MEASURE),
        "inputs": (*rest, INPUT),
    }[of]


def _belongs(
    of: str,
    name: str,
    item: Item,
    dims: tuple[str, ...] | None,
    ensemble: Mapping[str, Any] | None,
) -> bool:
    if dims is None or not set(item.dims) - {PERCENTILE} <= set(dims) or name == PERCENTILE:
        return False
    if of == BOUNDARIES:
        return item.dims == dims
    derived = ensemble is not None and name in ensemble["fields"]
    over = () if ensemble is None else np.atleast_1d(ensemble["axis"]).tolist()
    if PERCENTILE in item.dims and of != "fragility":
        return False
    if of == CASES:
        return not derived or bool(set(item.dims) & set(over)) or not item.dims
    of_curves = derived and name.startswith("fragility_") and name != "fragility_intensity"
    if of in ("suite", "fragility"):
        return derived and of_curves == (of == "fragility") and (LIMIT not in item.dims or of_curves)
    marks = {
        "risk": {LIMIT, HAZARD},
        "deaggregation": {INTENSITY_BIN},
        "stripes": {LIMIT, str((ensemble or {}).get("along"))},
        "demand": {MEASURE},
        "inputs": {INPUT},
    }[of]
    return derived and marks <= set(item.dims)


def _said(name: str, item: Item, dims: tuple[str, ...]) -> bool:
    """Whether a variable is a column of the table that an axis was read from, and has one value in a row."""
    return name.startswith(OF_TABLES) and bool(item.dims) and set(item.dims) <= set(dims)


def _there(items: Mapping[str, Item], axes: tuple[str, ...], ensemble: Mapping[str, Any] | None) -> list[str]:
    return [
        of
        for of in TABLES
        if (dims := _dims(of, axes, ensemble)) is not None
        and (of == CASES or any(_belongs(of, name, item, dims, ensemble) for name, item in items.items()))
    ]


def _known(name: str, items: Mapping[str, Item], columns: list[str], elsewhere: Callable[[str], list[str]]) -> str:
    """A column asked for; `StudyError` with what is near, or where it is."""
    whole = name if name in items else _percentile_of(name, items)[0]
    if whole in columns:
        return name
    if whole:
        dims = ", ".join(items[whole].dims) or "no dimension"
        there = "".join(f"; it is in another: --of {table}" for table in elsewhere(whole)[:1])
        raise StudyError(f"column {name!r} is not in this table: it is over {dims}{there}")
    percents = {f"{one}_{p}" for one in columns if PERCENTILE in items[one].dims for p in _percents(items)}
    if (whole := name.rpartition("_")[0]) in columns and PERCENTILE in items[whole].dims:
        raise StudyError(f"no column {name!r}: percentiles are {', '.join(_percents(items))}")
    close = get_close_matches(name, [*columns, *percents], n=1)
    hint = f"did you mean {close[0]!r}?" if close else f"expected some of {', '.join(columns)}"
    raise StudyError(f"no column {name!r}; {hint}")


def units_of(items: Mapping[str, Item], attrs: Mapping[str, Any]) -> Units:
    """How the numbers of a dataset are shown to people: accelerations in g of its case."""
    paths = {axis_path(items[axis].attrs, axis) for axis in str(attrs["axes"]).split()}
    return Units(g_of(json.loads(attrs.get("case", "{}")), paths))


@contextmanager
def opened(path: Path) -> Iterator[tuple[Mapping[str, Item], Mapping[str, Any]]]:
    """Variables and root attributes of a dataset file, read in pieces while it is open.

    Raises:
        StudyError: it is no dataset of this program, or damaged.
    """
    note_opened(path)
    with open_file(path) as file:
        file.set_auto_mask(False)
        attrs = {name: file.getncattr(name) for name in file.ncattrs()}
        items = {
            name: Item(tuple(item.dimensions), item, {key: item.getncattr(key) for key in item.ncattrs()})
            for name, item in file.variables.items()
        }
        yield items, attrs


def frame(block: Sequence[Column]) -> pandas.DataFrame:
    """Columns as a pandas DataFrame, headed by name and unit; words are categories."""
    import pandas

    def one(column: Column) -> Any:
        return pandas.Categorical(column.values) if column.values.dtype == object else column.values

    return pandas.DataFrame({column.head: one(column) for column in block})


def items_of(dataset: xarray.Dataset) -> dict[str, Item]:
    """Variables of a dataset in memory."""
    return {
        str(name): Item(tuple(map(str, item.dims)), item.values, item.attrs) for name, item in dataset.variables.items()
    }


def frame_of(
    dataset: xarray.Dataset, *, of: str = CASES, columns: Sequence[str] | None = None, degrees: bool = False
) -> pandas.DataFrame:
    """A table of a dataset in memory; see `rockcli.table`."""
    dataset = with_axes_left(dataset)
    if not isinstance(of, str):
        raise StudyError(f"of is {of!r}; expected the name of a table, as 'cases'")
    listed = columns is None or (isinstance(columns, Iterable) and not isinstance(columns, str))
    if not listed or not all(isinstance(name, str) for name in columns or ()):
        raise StudyError(f"columns is {columns!r}; expected a list of names, as ['outcome']")
    found = table_of(items_of(dataset), dataset.attrs, of=of, columns=columns, degrees=degrees)
    (block,) = found.blocks(max(found.size, 1))
    return frame(block)
