"""Runs studies: in memory, or into a folder where results appear whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from rockcli.engine.assemble import assemble
from rockcli.engine.compare import with_comparison
from rockcli.engine.curves import with_curves
from rockcli.engine.expect import check_quantities
from rockcli.engine.limits import check_histories
from rockcli.engine.lock import locked
from rockcli.engine.provenance import refreshed
from rockcli.engine.report import SOLVED, UP_TO_DATE, RunReport, report_on
from rockcli.engine.search import find_overturning
from rockcli.engine.sweep import Progress, describe_cases, solve_cases
from rockcli.errors import StudyError
from rockcli.storage import netcdf
from rockcli.storage.atomic import sweep_leftovers
from rockcli.storage.contents import Contents
from rockcli.storage.places import check_file
from rockcli.study.study import Study

if TYPE_CHECKING:
    import xarray


def solve_study(source: dict[str, Any] | str | Path) -> xarray.Dataset:
    """Solve a study given as a mapping or a file and return its dataset; nothing is written.

    Raises `StudyError` or `RecordError` for what is wrong with it.
    """
    from rockcli.storage.read import to_xarray
    from rockcli.study.open import open_study

    if not isinstance(source, dict | str | os.PathLike):
        raise StudyError(f"a study is a mapping or the path of a file, not {type(source).__name__}")
    study = open_study(source if isinstance(source, dict) else Path(source))
    check_answers(study)
    return to_xarray(solve(study))


def solve(study: Study, progress: Progress | None = None) -> Contents:
    """Solve a checked study in memory."""
    if study.search is not None:
        thresholds = find_overturning(study, progress)
        return with_curves(assemble(study, describe_cases(study), thresholds), study)
    with np.errstate(all="ignore"):  # what is not finite is a result
        return with_curves(assemble(study, solve_cases(study, progress)), study)


def dataset_path(study: Study, out_dir: Path) -> Path:
    """Where a study's dataset belongs: DIR/<name>/<name>.nc."""
    return out_dir / study.name / f"{study.name}.nc"


def check_answers(study: Study) -> None:
    """What can be said against solving a study, wherever its results go.

    Raises:
        StudyError: a clause of `expect` speaks of what will not be saved, or the histories would not fit.
    """
    check_quantities(study)
    check_histories(study)


def check_study(study: Study, out_dir: Path, *, fresh: bool = False) -> None:
    """Everything that can be said against running a study before it is solved.

    Raises:
        StudyError: as `check_answers`; other results stand in the folder, or something stands in its place.
    """
    path = dataset_path(study, out_dir)
    check_file(path)
    if fresh or not path.exists():
        check_answers(study)
        return
    check_quantities(study)
    found = netcdf.identity(path)
    if found != study.identity:
        what = "a file that is not a dataset of this program" if found is None else "the results of another study"
        raise StudyError(f"{path} holds {what} (or of another version of it); --fresh replaces it", file=study.file)


def run_study(
    study: Study,
    out_dir: Path,
    *,
    fresh: bool = False,
    plots: bool = True,
    plot_format: str = "png",
    progress: Progress | None = None,
) -> RunReport:
    """Solve a study into DIR/<name>/<name>.nc, judge it and draw its plots.

    A finished study of the same identity is not solved again: its words, errors, verdicts and plots are renewed.

    Args:
        study: a checked study.
        out_dir: DIR.
        fresh: replace whatever stands there.
        plots: draw; plot_format: png, pdf or svg.
        progress: called with (cases done, cases in all).

    Raises:
        StudyError: as `check_study`, or another process works in the folder.
        OutputError: the results cannot be written.
    """
    started = perf_counter()
    path = dataset_path(study, out_dir)
    with locked(path.parent):
        sweep_leftovers(path.parent)
        check_study(study, out_dir, fresh=fresh)
        if path.exists() and not fresh:
            contents, status = _renewed(study, path), UP_TO_DATE
        else:
            contents, status = solve(study, progress), SOLVED
            netcdf.write(contents, path)
        drawn, complaints = _draw(study, path, plot_format) if plots else ((), ())
    return report_on(
        study,
        contents,
        status=status,
        file=path,
        plots=drawn,
        warnings=(*_warnings(contents), *complaints),
        seconds=perf_counter() - started,
    )


def _renewed(study: Study, path: Path) -> Contents:
    """The finished dataset, with the study's present words, comparison and curves; rewritten only if they changed."""
    contents = netcdf.read(path)
    if contents.attrs.get("study") == study.resolved_yaml:
        return contents
    described = Contents(contents.axes, contents.fields, refreshed(contents.attrs, study))
    with np.errstate(all="ignore"):
        contents = with_curves(with_comparison(described, study.compare_to), study)
    netcdf.write(contents, path)
    return contents


def _draw(study: Study, path: Path, plot_format: str) -> tuple[tuple[Path, ...], tuple[str, ...]]:
    from rockcli.engine.draw import draw

    return draw(path, study.plots, plot_format)


def _warnings(contents: Contents) -> tuple[str, ...]:
    import json

    return tuple(json.loads(contents.attrs.get("warnings", "[]")))
