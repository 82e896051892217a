"""rockcli: seismic response of rocking bodies, from a study file to a dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rockcli.version import __version__

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    import pandas
    import xarray

    from rockcli.errors import RecordError, StudyError

__all__ = ["RecordError", "StudyError", "__version__", "run", "table"]


def run(study: dict[str, Any] | str | Path) -> xarray.Dataset:
    """Solve a study and return its dataset; nothing is written.

    `study` is the path of a YAML file or a mapping of the same form, whose `name` may be left out.  Raises
    `StudyError` or `RecordError` for what is wrong with it.
    """
    from rockcli.engine.run import solve_study

    return solve_study({"name": "study", **study} if isinstance(study, dict) else study)


def table(
    dataset: xarray.Dataset, *, of: str = "cases", columns: Sequence[str] | None = None, degrees: bool = False
) -> pandas.DataFrame:
    """A dataset as a table: one row per case, axes first, outcome as a word, columns `name [unit]` in SI units.

    `of` is `cases`, or of a suite `suite`, `fragility`, `risk`, `deaggregation`, `stripes` or `demand`; `columns` are
    the variables wanted beside the axes; `degrees` gives angles in degrees.  Histories are in no table.  Raises
    `StudyError` for a table or column that is not there.
    """
    from rockcli.storage.table import frame_of

    return frame_of(dataset, of=of, columns=columns, degrees=degrees)


def __getattr__(name: str) -> Any:
    """The errors, imported when they are asked for."""
    if name in ("RecordError", "StudyError"):
        from rockcli import errors

        return getattr(errors, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
