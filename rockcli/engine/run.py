"""Runs studies: in memory, or into a folder where results appear whole or not at all."""

from __future__ import annotations

import contextlib
import json
import os
import traceback
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from rockcli.analysis.derive import derive
from rockcli.analysis.expect import check_quantities
from rockcli.analysis.rules import check_rules
from rockcli.engine.audit import check_audit, with_audit
from rockcli.engine.backends import check_backend, check_kernels
from rockcli.engine.lock import locked
from rockcli.engine.plots_ahead import check_plots
from rockcli.engine.provenance import refreshed
from rockcli.engine.search.search import find_overturning
from rockcli.engine.summary import SHARE, SOLVED, UP_TO_DATE, RunReport, report_on
from rockcli.engine.sweep.assemble import assemble
from rockcli.engine.sweep.history_size import check_histories
from rockcli.engine.sweep.parts import Parts
from rockcli.engine.sweep.refine import solve_refined
from rockcli.engine.sweep.reuse_results import reuse_results
from rockcli.engine.sweep.sweep import Progress, Sweep, solve_cases, solve_share
from rockcli.engine.sweep.symbols_of_cases import describe_cases
from rockcli.engine.sweep.work import Team
from rockcli.errors import MachineError, OutputError, RockError, StudyError
from rockcli.storage import netcdf
from rockcli.storage.atomic import sweep_leftovers
from rockcli.storage.contents import Contents
from rockcli.storage.places import check_file
from rockcli.study.differences import differences
from rockcli.study.study import Study

if TYPE_CHECKING:
    import xarray

DRAWN = 25_000_000
"""Cases up to which a run draws its plots: 130 bytes of each are in memory then."""


def opened(source: dict[str, Any] | str | Path, readers: int = 1) -> Study:
    """A checked study from a mapping, whose `name` may be left out, or a file; `readers`: processes that read records.

    Raises `StudyError` or `RecordError` for what is wrong with it.
    """
    from rockcli.study.open import open_study

    if not isinstance(source, dict | str | os.PathLike):
        raise StudyError(f"a study is a mapping or the path of a file, not {type(source).__name__}")
    study = open_study({"name": "study", **source} if isinstance(source, dict) else Path(source), readers=readers)
    check_answers(study)
    return study


def solve_study(
    source: dict[str, Any] | str | Path, workers: int | None = None, progress: Progress | None = None
) -> xarray.Dataset:
    """Solve a study given as a mapping or a file and return its dataset; nothing is written.

    `workers` processes, None = this one; `progress(done, total)` is called as cases are solved.  Raises `StudyError` or
    `RecordError` for what is wrong with it.
    """
    from rockcli.storage.read import to_xarray

    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, int | np.integer) or workers < 1):
        raise StudyError(f"workers is {workers!r}; expected a whole number of processes greater than 0, or None")
    if not (progress is None or callable(progress)):
        raise StudyError(f"progress is {progress!r}; expected a function of (cases done, cases in all), or None")
    processes = int(workers or 1)
    study = opened(source, processes)
    return to_xarray(solve(study, sweep=Sweep(Team(processes), progress=progress)))


def solve(study: Study, progress: Progress | None = None, sweep: Sweep | None = None) -> Contents:
    """Solve a checked study in memory, by itself or as `sweep` says."""
    sweep = sweep or Sweep(Team(), progress=progress)
    with np.errstate(all="ignore"):  # what is not finite is a result
        if study.search is not None:
            found = _searched(study, sweep)
        else:
            found = assemble(study, (solve_refined if study.refine else solve_cases)(study, sweep))
    return _with_derived(found, study, sweep)


def _with_derived(contents: Contents, study: Study, sweep: Sweep) -> Contents:
    """Solved cases with all that follows from them, whether they were solved now or are those of a finished dataset."""
    return with_audit(derive(contents, study), study, sweep.team, sweep.progress)


def _searched(study: Study, sweep: Sweep) -> Contents:
    """What a search found, and what is known of its cases without solving them."""
    thresholds, failed = find_overturning(study, sweep)
    results = describe_cases(study)
    for sentence, cases in failed.items():
        results.explain(sentence, cases)
    results.finish()
    return assemble(study, results, thresholds)


def dataset_path(study: Study, out_dir: Path) -> Path:
    """Where a study's dataset belongs: DIR/<name>/<name>.nc."""
    return out_dir / study.name / f"{study.name}.nc"


def check_answers(study: Study) -> None:
    """What can be said against solving a study, wherever its results go.

    Raises:
        StudyError: a clause of `expect` speaks of what will not be saved, a plot shows what will not be there, no
            backend solves the model, or the histories would not fit.
    """
    check_kernels()
    check_quantities(study)
    check_plots(study)
    check_backend(study)
    check_histories(study)
    check_rules(study)
    check_audit(study)


def check_study(study: Study, out_dir: Path, *, fresh: bool = False) -> None:
    """Everything that can be said against running a study before it is solved.

    `fresh`: it replaces what stands there, as one does that was broken off while it did.

    Raises:
        StudyError: as `check_answers`; other results stand in the folder, or something stands in its place.
    """
    path = dataset_path(study, out_dir)
    check_file(path)
    if fresh or not path.exists() or Parts(path.parent, study).anew:
        check_answers(study)
        return
    check_quantities(study)
    check_plots(study)
    found = netcdf.identity(path)
    if found is not None and netcdf.is_intact(path) is False:  # not to be judged, renewed or added to
        raise StudyError(f"{path} is damaged, or was changed by another program; --fresh solves it again", study.file)
    if found == study.identity:
        return
    if found is None:
        what = "a file that is not a dataset of this program, or a damaged one"
    elif reuse_results(study, old := netcdf.read(path)) is not None:
        check_answers(study)
        return
    else:
        inputs = json.loads(old.attrs.get("inputs", "{}"))
        changed = differences(old.attrs.get("study", ""), study.resolved, inputs, study.inputs)
        why = f"changed in {changed}" if changed else "another study, or of another version of it or of rock"
        what = f"results of this study before it was {why}" if changed else f"the results of {why}"
    type_this = f"`rock run {study.file or 'STUDY.yaml'} --fresh`"
    raise StudyError(
        f"{path} holds {what}; {type_this} replaces it, `--out DIR` or another `name` keeps both", file=study.file
    )


def run_study(
    study: Study,
    out_dir: Path,
    *,
    fresh: bool = False,
    plots: bool = True,
    plot_format: str = "png",
    si: bool = False,
    progress: Progress | None = None,
    team: Team | None = None,
    share: tuple[int, int] | None = None,
) -> RunReport:
    """Solve a study into DIR/<name>/<name>.nc, judge it and draw its plots.

    A finished study of the same identity is not solved again: its words, errors, verdicts and plots are renewed.  What
    a killed run or other shares have finished is not solved again, nor what the dataset of fewer points has.

    Args:
        study: a checked study.
        out_dir: DIR.
        fresh: replace whatever stands there; broken off, it is finished by a run that is not fresh.
        plots: draw; plot_format: png, pdf or svg.
        si: the words of the report are in SI units; else accelerations are in g.
        progress: called with (cases done, cases in all).
        team: who works; None = this process.
        share: (K, N): solve only the K-th of N shares and leave it for a run without a share, which merges them.

    Raises:
        StudyError: as `check_study`, or another process works in the folder.
        OutputError: the results cannot be written.
        MachineError: the machine refused to solve some cases; the others are kept for the next run.
    """
    started = perf_counter()
    path = dataset_path(study, out_dir)
    team = team or Team()
    parts = Parts(path.parent, study)
    sweep = Sweep(team, parts, share, folder=path.parent, progress=progress)
    with locked(path.parent, share):
        check_study(study, out_dir, fresh=fresh)
        if share is None:
            sweep_leftovers(path.parent)
            parts.sweep()
        known = 0
        if path.exists() and not fresh and not parts.anew:
            if netcdf.identity(path) == study.identity:
                if share is None:
                    parts.remove()  # of a run that was killed when the dataset was there, or of a `fresh` one
                contents, status = _renewed(study, path, sweep), UP_TO_DATE
                return _reported(study, contents, status, path, started, plot_format if plots else None, si=si)
            old = netcdf.read(path)
            found = reuse_results(study, old)
            assert found is not None
            known, sweep.known = int(np.prod(old.shape, dtype=np.int64)), found
        if fresh:
            parts.begin_anew()
        try:
            if share is not None:
                return _of_share(study, sweep, started)
            with netcdf.Writer(path) as sweep.file:
                contents = solve(study, sweep=sweep)
                sweep.file.finish(contents)
        except BaseException as error:
            traceback.clear_frames(error.__traceback__)  # gives back what is held where memory may have run out
            kept = False
            with contextlib.suppress(OutputError, MemoryError):  # whatever ends a run, what is finished is kept
                parts.flush()
                kept = True
            if (advised := _advised(error, path, kept=kept, fresh=fresh)) is not None:
                raise advised from error
            raise
        parts.remove()
        report = _reported(study, contents, SOLVED, path, started, plot_format if plots else None, si=si)
    return replace(report, taken_over=known, resumed=sweep.resumed, warnings=(*report.warnings, *team.notes))


def _advised(error: BaseException, path: Path, *, kept: bool, fresh: bool) -> RockError | None:
    """An error of the machine that ends a run, with what to do then; None for others.

    kept: whether what was finished last could be written.  fresh: whether the run forgets what others kept.
    """
    what = "finished cases are kept" if kept else "cases finished last could not be kept and will be solved again"
    advice = f"run again{' without --fresh' if fresh else ''} once that is fixed: {what}"
    if isinstance(error, MemoryError):
        return MachineError("; ".join(filter(None, ("out of memory", str(error), advice))), path)
    if isinstance(error, OutputError | MachineError):
        return type(error)(f"{error.message}; {advice}", error.file or path)
    return None


def _of_share(study: Study, sweep: Sweep, started: float) -> RunReport:
    """Solve one share into parts."""
    assert isinstance(sweep.keeper, Parts)
    assert sweep.share is not None
    if study.search is not None:
        raise StudyError("--part cannot divide a search (`find`); --workers and --dask can", file=study.file)
    if study.refine:
        raise StudyError("--part cannot divide a refined map (`refine`); --workers and --dask can", file=study.file)
    cases = solve_share(study, sweep)
    sweep.keeper.flush()
    return RunReport(
        name=study.name,
        status=SHARE,
        cases=study.size,
        resumed=cases,
        share=sweep.share,
        warnings=tuple(sweep.team.notes),
        seconds=perf_counter() - started,
    )


def _reported(
    study: Study, contents: Contents, status: str, path: Path, started: float, plot_format: str | None, *, si: bool
) -> RunReport:
    seconds = perf_counter() - started  # of solving and writing, not of drawing
    drawn, remarks = _draw(study, path, plot_format) if plot_format is not None else ((), ())
    return report_on(
        study,
        contents,
        si=si,
        status=status,
        file=path,
        plots=drawn,
        warnings=(*_warnings(contents), *remarks),
        seconds=seconds,
    )


def _renewed(study: Study, path: Path, sweep: Sweep) -> Contents:
    """The finished dataset, with the study's present words, comparison and curves; rewritten only if they changed."""
    contents = netcdf.read(path)
    if contents.attrs.get("study") == study.resolved_yaml:
        return contents
    described = Contents(contents.axes, contents.fields, refreshed(contents.attrs, study))
    contents = _with_derived(described, study, sweep)
    netcdf.write(contents, path)
    return contents


def _draw(study: Study, path: Path, plot_format: str) -> tuple[tuple[Path, ...], tuple[str, ...]]:
    """The files drawn, and what is to be said of them: what could not be drawn, and what they leave out unsaid."""
    from rockcli.engine.draw import draw, left_over

    if study.size > DRAWN and study.plots != ():
        return (), (f"not drawn: of {study.size} cases, as a figure holds all it shows in memory (at most {DRAWN})",)
    drawn, complaints = draw(path, study.plots, plot_format)
    files = tuple(one.path for one in drawn)
    untold = [one.sentence for one in drawn] + [left_over(path, files, every=study.plots == ())]
    return files, (*complaints, *filter(None, untold))


def _warnings(contents: Contents) -> tuple[str, ...]:
    return tuple(json.loads(contents.attrs.get("warnings", "[]")))
