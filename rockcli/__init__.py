"""rockcli: seismic response of rocking bodies, from a study file to a dataset."""

from __future__ import annotations

import os
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rockcli.version import __version__

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    import pandas
    import xarray
    from matplotlib.figure import Figure

    from rockcli.errors import RecordError, StudyError
    from rockcli.motion.motion import Motion

__all__ = [
    "RecordError",
    "StudyError",
    "__version__",
    "check",
    "open_dataset",
    "plot",
    "read_record",
    "report",
    "run",
    "table",
]

_turn = threading.RLock()
"""Kernels are loaded by one thread, and a process solves one study at a time: other threads wait."""


def _begin_as_child() -> None:
    """A forked process does not wait for a thread that it has not."""
    global _turn
    _turn = threading.RLock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_begin_as_child)


def run(
    study: dict[str, Any] | str | Path,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> xarray.Dataset:
    """Solve a study and return its dataset; nothing is written.  Threads solve one after another.

    Args:
        study: path of a YAML file, or a mapping of the same form, whose `name` may be left out.  In a mapping a record
            may be an array, `{"values": ARRAY, "dt": 0.005, "units": "g"}`, an ObsPy Trace or what `read_record`
            returns, and an axis of records a list of them.
        workers: processes; None = this one alone.
        progress: called with (cases done, cases in all).

    Returns:
        What `rock run` writes, in SI units and radians; `dataset.rock` shows its outcomes and peak.

    Raises:
        StudyError, RecordError: what is wrong with the study or a record.
    """
    from rockcli.engine.run import solve_study

    with _turn:
        dataset = solve_study(study, workers, progress)
    _register()
    return dataset


def check(study: dict[str, Any] | str | Path) -> dict[str, Any]:
    """Read a study and say what it would do, solving nothing.

    Returns:
        What `rock check --json` prints: cases, axes, the first case with its body, model and motion in SI units and
        radians, backend, estimated seconds, warnings.

    Raises:
        StudyError, RecordError: what is wrong with the study or a record.
    """
    from rockcli.engine.preview import preview
    from rockcli.engine.run import opened

    with _turn:
        return preview(opened(study)).as_dict()


def open_dataset(path: str | Path) -> xarray.Dataset:
    """Read a dataset that `rock run` wrote; `dataset.rock` shows its outcomes and peak.

    Raises:
        StudyError: it is none, or damaged.
    """
    from rockcli.errors import path_given
    from rockcli.storage.read import open_dataset

    dataset = open_dataset(path_given(path))
    _register()
    return dataset


def plot(
    dataset: xarray.Dataset | Sequence[xarray.Dataset],
    kind: str | None = None,
    path: str | Path | None = None,
    *,
    select: Mapping[str, Any] | None = None,
    width: str | float | None = None,
    title: str | None = "",
    labels: Mapping[str, str] | None = None,
    limits: Mapping[str, tuple[float, float]] | None = None,
    letters: bool = False,
) -> Figure:
    """Draw a dataset, as `rock plot` does, or several with the same axes in one figure.

    Args:
        dataset: of `run` or `open_dataset`.
        kind: kind of plot, such as `histories`, `map`, `ida`, `fragility`; None = the first that the study lists, else
            the first its content suggests; of a part of a dataset the first of these that it can show.
        path: also written there, as .png, .pdf or .svg.
        select: {axis: value or list of values} of the cases shown, in SI units, or as "0.4g", "10deg".
        width: "single" (90 mm), "double" (180 mm) or a number of mm; None = as its content needs.
        title: instead of the study's; None = no title.
        labels: words for "x" and "y", or for "y1", "y2", ..., the rows of panels from the top.
        limits: (low, high) of the same, in the units of the labels.
        letters: letter the panels (a), (b), ...

    Returns:
        A matplotlib Figure, which notebooks show and which may be changed.

    Raises:
        StudyError: the dataset cannot be drawn so.
    """
    from rockcli.engine.draw import changes, figure_of
    from rockcli.errors import path_given

    changed = changes(select, width, title, labels, limits, letters)
    return figure_of(dataset, kind, None if path is None else path_given(path), **changed)


def report(dataset: xarray.Dataset | str | Path, path: str | Path) -> Path:
    """Write the report of a dataset, in memory or in a file, as one HTML page; returns where.

    Raises:
        StudyError: it is no dataset of this program, or the name does not end in .html or .htm.
    """
    from rockcli.engine.report_page import write_page, write_page_of
    from rockcli.errors import path_given

    if isinstance(dataset, str | Path):
        return write_page(Path(dataset), path_given(path))
    return write_page_of(dataset, path_given(path))


def table(
    dataset: xarray.Dataset, *, of: str = "cases", columns: Sequence[str] | None = None, degrees: bool = False
) -> pandas.DataFrame:
    """A dataset as a table: one row per case, axes first, outcome as a word, columns `name [unit]` in SI units.

    `of` is `cases`, or of a suite `suite`, `fragility`, `risk`, `deaggregation`, `stripes`, `demand` or `inputs`, or of
    a refined map `boundaries`; `columns` are the variables wanted beside the axes; `degrees` gives angles in degrees.
    Histories are in no table.  Raises `StudyError` for a table or column that is not there.
    """
    from rockcli.storage.table import frame_of

    return frame_of(dataset, of=of, columns=columns, degrees=degrees)


def read_record(
    path: str | Path, *, component: str | int | None = None, units: str | None = None, dt: float | None = None
) -> Motion:
    """Read a ground-motion record of any format that studies read.

    Args:
        path: of the file.
        component: which one, by name or place, if the file holds several.
        units: `g`, `m/s2`, `cm/s2`, `gal` or `mm/s2`, where the file does not tell.
        dt: time step [s], where the file does not tell.

    Returns:
        `values` (k,), in g if `in_g`, else in m/s²; `dt` [s]; `name`, `header`, `warnings`.

    Raises:
        RecordError: naming file, line if any, what is wrong and what to do.
    """
    from rockcli.motion.reading import read_record

    return read_record(path, component=component, units=units, dt=dt)


def _register() -> None:
    """Give datasets their `rock`."""
    from rockcli.engine.accessor import register

    register()


def __getattr__(name: str) -> Any:
    """The errors, imported when they are asked for."""
    if name in ("RecordError", "StudyError"):
        from rockcli import errors

        return getattr(errors, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


if "xarray" in sys.modules:  # who opens datasets by xarray itself has `rock` too; the command needs no xarray to begin
    _register()
