"""rockcli: seismic response of rocking bodies, from a study file to a dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rockcli.version import __version__

if TYPE_CHECKING:
    from pathlib import Path

    import xarray

    from rockcli.errors import RecordError, StudyError

__all__ = ["RecordError", "StudyError", "__version__", "run"]


def run(study: dict[str, Any] | str | Path) -> xarray.Dataset:
    """Solve a study and return its dataset; nothing is written.

    `study` is the path of a YAML file or a mapping of the same form, whose `name` may be left out.  Raises
    `StudyError` or `RecordError` for what is wrong with it.
    """
    from rockcli.engine.run import solve_study

    return solve_study({"name": "study", **study} if isinstance(study, dict) else study)


def __getattr__(name: str) -> Any:
    """The errors, imported when they are asked for."""
    if name in ("RecordError", "StudyError"):
        from rockcli import errors

        return getattr(errors, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
