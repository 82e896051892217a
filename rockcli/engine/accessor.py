"""`dataset.rock`: a dataset in the words of its summary, for those who look at one in a notebook or a session."""

from __future__ import annotations

import json
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rockcli.analysis.places import units_of
from rockcli.engine.summary import infinite, largest, outcomes_of
from rockcli.errors import path_given
from rockcli.scene.response import outcome_words
from rockcli.scene.variables import PEAK
from rockcli.storage.read import as_accessor, from_xarray, of_a_part

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure


class Rock:
    """What a dataset says; also of a part of one, as `dataset.isel(record=0).rock`.

    Shown by itself it tells cases, outcomes, the largest peak, what a suite comes to, and warnings.
    """

    def __init__(self, dataset: xarray.Dataset) -> None:
        self._dataset = dataset
        self._contents = from_xarray(dataset)

    @property
    def outcomes(self) -> dict[str, int]:
        """Number of cases by outcome, without those that have none."""
        return outcomes_of(self._contents)

    @property
    def peak(self) -> float | None:
        """Largest theta_peak_over_alpha of the cases that remain stable; None where none is saved."""
        return largest(self._contents, PEAK, units_of(self._contents))[0]

    @property
    def cases(self) -> xarray.Dataset:
        """The scalars of the cases alone: `dataset.rock.cases.to_dataframe()` has one row per case."""
        axes = set(self._contents.axes)
        beside = [name for name, item in self._dataset.variables.items() if not set(item.dims) <= axes]
        derived = json.loads(self._dataset.attrs.get("ensemble", "{}")).get("fields", [])
        others = [name for name in derived if set(self._dataset[name].dims) < axes] if axes else []
        return self._dataset.drop_vars(sorted({*map(str, beside), *map(str, others)}))

    def table(
        self, *, of: str = "cases", columns: Sequence[str] | None = None, degrees: bool = False
    ) -> pandas.DataFrame:
        """As `rockcli.table`."""
        from rockcli.storage.table import frame_of

        return frame_of(self._dataset, of=of, columns=columns, degrees=degrees)

    def plot(self, kind: str | None = None, path: str | Path | None = None, **how: Any) -> Figure:
        """As `rockcli.plot`."""
        from rockcli.engine.draw import changes, figure_of

        return figure_of(self._dataset, kind, None if path is None else path_given(path), **changes(**how))

    def report(self, path: str | Path) -> Path:
        """As `rockcli.report`."""
        from rockcli.engine.report_page import write_page_of

        return write_page_of(self._dataset, path_given(path))

    def _lines(self) -> list[tuple[str, str]]:
        contents = self._contents
        units = units_of(contents)
        axes = " x ".join(f"{len(contents.values(axis))} {axis}" for axis in contents.axes)
        n = 1
        for size in contents.shape:
            n *= size
        lines = [("cases", f"{n}" + (f" = {axes}" if axes else ""))]
        if self.outcomes:
            lines.append(("outcomes", ", ".join(f"{n} {outcome_words(name)}" for name, n in self.outcomes.items())))
        for name, words, unit in ((PEAK, "peak", "|theta|/alpha = {:.6g}"), ("slide_peak", "slide", "{:.6g} m")):
            value, where = largest(contents, name, units)
            if value is not None and (value > 0.0 or name == PEAK):
                lines.append((words, unit.format(value) + (f" at {where}" if where and value > 0.0 else "")))
        if endless := infinite(contents, "slide_peak"):
            lines.append(("slides on", f"{endless} for ever, as no friction stops it"))
        if not of_a_part(self._dataset):  # what a suite comes to is not that of a part of it
            lines += [("suite", words) for words in json.loads(contents.attrs.get("ensemble", "{}")).get("shown", ())]
            lines += [("warning", words) for words in json.loads(contents.attrs.get("warnings", "[]"))]
        return lines

    def __repr__(self) -> str:
        return "\n".join([self._title(), *(f"  {name:<9} {words}" for name, words in self._lines())])

    def _repr_html_(self) -> str:
        rows = "".join(
            f'<tr><th style="text-align:left">{escape(name)}</th><td style="text-align:left">{escape(words)}</td></tr>'
            for name, words in self._lines()
        )
        return f"<p><b>{escape(self._title())}</b></p><table>{rows}</table>"

    def _title(self) -> str:
        return str(self._dataset.attrs.get("title") or "a dataset of rock")


def register() -> None:
    """Give every xarray.Dataset its `rock`."""
    as_accessor("rock", Rock)
