"""`audit`: solves cases of a finished sweep again, more accurately, and tells where the two answers disagree."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.compare_datasets import FLOOR
from rockcli.analysis.places import place, units_of
from rockcli.engine.backends import choose
from rockcli.engine.sweep.chunk_result import ChunkResult
from rockcli.engine.sweep.chunks import CHUNK, Chunks, Pace
from rockcli.engine.sweep.executors import answers
from rockcli.engine.sweep.sweep import Solving, check_solved, note_unsolved, outlook
from rockcli.engine.sweep.work import Team
from rockcli.errors import SolverError, StudyError
from rockcli.scene.auto import AUTO
from rockcli.scene.batch import Batch, Save
from rockcli.scene.constants import YIELD_ROTATION
from rockcli.scene.counted import counted
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import FAILED, NO_UPLIFT, OUTCOMES
from rockcli.scene.variables import AUDIT
from rockcli.storage.contents import Contents, variable_field
from rockcli.study.cases.buildable import buildable
from rockcli.study.study import CaseSource, Index, Study

Array = NDArray[np.float64]

MOST = 10_000
"""Cases audited by `audit: true`; a share of a larger study is a sample."""

SEED = 20260101
"""Of the sample: the same cases every time."""

FINER, STEPS_FINER = 1e-2, 0.5
"""A given rtol, and a given or penalty time step with its yield rotation, are audited at this many times themselves."""

TIMES_STATED, UNSTATED = 10.0, 1e-6
"""A peak disagrees beyond this many times the error its run stated, or beyond 1e-6 in theta/alpha where none is saved;
never below the floor."""

NAMED = 5
"""Worst points told."""

NOT_AUDITED = -1


@dataclass(frozen=True, eq=False)
class Tighter:
    """The cases of a study, each at a tighter accuracy; only outcome and peak are asked for."""

    cases: CaseSource

    def batches(self, indices: Index) -> Iterator[tuple[Index, Batch]]:
        """As `CaseSource.batches`."""
        for part, batch in self.cases.batches(indices):
            save = Save(False, batch.save.dt_out, frozenset({"outcome", "theta_peak_over_alpha"}))
            yield part, replace(batch, numerics=tighter(batch) or batch.numerics, save=save)


def tighter(batch: Batch) -> Numerics | None:
    """Numerics for an audit of a batch; None where nothing tighter is worth having, or there is."""
    try:
        backend = choose(batch)
    except SolverError:
        return None
    if backend.slow or not backend.settings:
        return None
    given, level = batch.numerics, batch.numerics.level.tighter
    if "yield_rotation" in backend.reads:
        given = replace(given, yield_rotation=STEPS_FINER * (given.yield_rotation or YIELD_ROTATION))
    stepping = backend.stepping and batch.model != AUTO  # whose rigid bodies are not
    if stepping and given.dt is not None:
        return replace(given, dt=STEPS_FINER * given.dt)
    if batch.model == AUTO and level:
        given = replace(given, accuracy=level)  # the columns among its cases take no rtol
    if not stepping and given.rtol is not None:
        least = backend.least_rtol
        return None if given.rtol <= least else replace(given, rtol=max(FINER * given.rtol, least))
    return replace(given, accuracy=level) if level else None


def check_audit(study: Study) -> None:
    """`StudyError` if an audit would have nothing to compare."""
    if not study.audit:
        return
    if study.search is not None:
        raise StudyError("audit: compares cases, and `find` keeps none; audit a study of cases", file=study.file)
    if "outcome" not in study.scalars:
        raise StudyError("audit: compares outcomes, and this study is one of static curves", file=study.file)


def with_audit(
    contents: Contents, study: Study, team: Team | None = None, progress: Callable[[int, int], None] | None = None
) -> Contents:
    """Add what an audit finds to a dataset, or take it away if the study does not ask for one.

    `audit_same_outcome` is 1, 0, or -1 where not audited; `audit_error` is |peak - peak of the tighter run|, NaN where
    not audited or not both finite; `audit_disagreements` counts outcomes that differ and peaks farther apart than
    their stated error allows.  An audit of the same share that the dataset holds already is kept.
    """
    if study.audit and json.loads(contents.attrs.get("audit", "{}")).get("asked") == str(study.audit):
        return contents
    fields = {name: item for name, item in contents.fields.items() if name not in AUDIT}
    attrs = {name: words for name, words in contents.attrs.items() if name != "audit"}
    if not study.audit:
        return Contents(contents.axes, fields, attrs)
    finished = _finished(contents, study)
    chosen, levels, left_out = _chosen(study, finished)
    again = _solved_again(study, chosen, team or Team(), progress)
    found = _Findings.of(contents, chosen, again)
    says = [_first_sentence(len(finished), found, levels, left_out), *found.sentences(contents)]
    shape, axes = study.shape, contents.axes
    comment = {"comment": f"{NOT_AUDITED}: not audited, or no outcome to compare"}
    for name, dims, values, more in (
        ("audit_same_outcome", axes, found.same.reshape(shape), comment),
        ("audit_error", axes, found.error.reshape(shape), {}),
        ("audit_disagreements", (), np.array(found.disagreements), {}),
    ):
        fields[name] = variable_field(name, dims, values, **more)
    attrs["audit"] = json.dumps({"asked": str(study.audit), "says": says}, ensure_ascii=False)
    return Contents(axes, fields, attrs)


def _finished(contents: Contents, study: Study) -> Index:
    """Flat indices of the cases that were solved: what `refine` filled in is no answer of a solver."""
    if "solved" in contents.fields:
        return np.flatnonzero(contents.values("solved").ravel()).astype(np.int64)
    return np.arange(study.size, dtype=np.int64)


def _chosen(study: Study, cases: Index) -> tuple[Index, list[str], int]:
    """Flat indices among `cases` that are audited, the levels in words, and how many there is nothing tighter for."""
    size = len(cases)
    n = min(size, MOST) if study.audit is True else max(1, round(float(study.audit) * size))
    if n < size:
        cases = np.sort(cases[np.random.default_rng(SEED).choice(size, n, replace=False)])
    parts: list[Index] = []
    levels: dict[str, None] = {}
    for part, batch in buildable(study.batches, cases):
        numerics = tighter(batch)
        if numerics is not None:
            parts.append(part)
            levels[_step(batch.numerics, numerics)] = None
    chosen = np.sort(np.concatenate(parts)) if parts else np.empty(0, dtype=np.int64)
    return chosen, list(levels), n - len(chosen)


def _step(before: Numerics, after: Numerics) -> str:
    steps = [(name, getattr(before, name), getattr(after, name)) for name in ("dt", "rtol")]
    words = [f"{name} {old:g} -> {new:g}" for name, old, new in steps if old != new]
    if before.accuracy != after.accuracy:
        words.append(f"{before.accuracy} -> {after.accuracy}")
    return " with ".join(words)


def _solved_again(
    study: Study, chosen: Index, team: Team, progress: Callable[[int, int], None] | None
) -> dict[str, NDArray[Any]]:
    """Outcome and peak of the chosen cases at the tighter level, (m,) each."""
    names = tuple(name for name in ("outcome", "theta_peak_over_alpha") if name in study.scalars)
    again = replace(study, cases=Tighter(study.cases), histories=False, histories_at=None, scalars=names)
    todo = np.zeros(study.size, dtype=bool)
    todo[chosen] = True
    found: dict[str, NDArray[Any]] = {
        "outcome": np.full(len(chosen), FAILED, dtype=np.int8),
        "theta_peak_over_alpha": np.full(len(chosen), np.nan),
    }
    if not len(chosen):
        return found
    seconds, compiled = outlook(again, len(chosen))
    done = 0
    refused: dict[str, int] = {}
    work = Solving(again, compiled, described=False)
    for cases, answer in answers(work, Chunks(study.size, todo), Pace(seconds, CHUNK), team):
        _put(found, chosen, answer)
        note_unsolved(refused, answer)
        done += len(cases)
        if progress is not None:
            progress(done, len(chosen))
    check_solved(refused, len(chosen))
    return found


def _put(found: dict[str, NDArray[Any]], chosen: Index, answer: ChunkResult) -> None:
    rows = np.searchsorted(chosen, answer.cases)
    for name, values in answer.scalars.items():
        found[name][rows] = values


@dataclass(frozen=True, eq=False)
class _Findings:
    """Over all cases of the study: see `with_audit`; `other` and `beyond` are flat indices, the worst first."""

    audited: int
    failed: int
    same: NDArray[np.int8]
    error: Array
    other: Index
    beyond: Index
    now: NDArray[np.int8]
    stated: bool

    @property
    def disagreements(self) -> int:
        return len(self.other) + len(self.beyond)

    @classmethod
    def of(cls, contents: Contents, chosen: Index, again: dict[str, NDArray[Any]]) -> _Findings:
        size = int(np.prod(contents.shape, dtype=np.int64))
        same = np.full(size, NOT_AUDITED, dtype=np.int8)
        error, now = np.full(size, np.nan), np.full(size, FAILED, dtype=np.int8)
        flags = contents.values("outcome").ravel()
        now[chosen] = again["outcome"]
        comparable = np.zeros(size, dtype=bool)
        comparable[chosen] = (flags[chosen] >= NO_UPLIFT) & (again["outcome"] != FAILED)
        same[comparable] = (flags == now)[comparable]
        stated = "error_estimate" in contents.fields
        if "theta_peak_over_alpha" in contents.fields:
            peaks = contents.values("theta_peak_over_alpha").ravel()
            with np.errstate(invalid="ignore"):
                error[chosen] = np.abs(peaks[chosen] - again["theta_peak_over_alpha"])
            error[~(np.isfinite(error) & comparable)] = np.nan
        estimate = contents.values("error_estimate").ravel() if stated else np.full(size, np.nan)
        allowed = np.where(np.isfinite(estimate), np.maximum(TIMES_STATED * estimate, FLOOR), UNSTATED)
        with np.errstate(invalid="ignore"):
            beyond = np.flatnonzero((same == 1) & (error > allowed))
        beyond = beyond[np.argsort(-error[beyond], kind="stable")]
        failed = int(np.sum(again["outcome"] == FAILED))
        return cls(len(chosen), failed, same, error, np.flatnonzero(same == 0), beyond, now, stated)

    def sentences(self, contents: Contents) -> Iterator[str]:
        """How large the differences are, and the worst points."""
        finite = self.error[np.isfinite(self.error)]
        if finite.size:
            middle, high = np.quantile(finite, (0.5, 0.9))
            yield f"peaks differ by {middle:.1e} (median), {high:.1e} (90 %), {finite.max():.1e} (largest)"
        flags = contents.values("outcome").ravel()
        worst = [(case, f"{OUTCOMES[int(flags[case])]} -> {OUTCOMES[int(self.now[case])]}") for case in self.other]
        worst += [(case, f"peak off by {self.error[case]:.2e}") for case in self.beyond]
        for case, words in worst[:NAMED]:
            at = np.unravel_index(int(case), contents.shape) if contents.axes else ()
            where = place(contents, contents.axes, at, units_of(contents))
            yield f"{where}: {words}" if where else words
        if len(worst) > NAMED:
            yield f"and {len(worst) - NAMED} more, in audit_same_outcome and audit_error"


def _first_sentence(size: int, found: _Findings, levels: list[str], left_out: int) -> str:
    whole = found.audited + left_out == size
    what = f"all {found.audited}" if whole and not left_out else f"{found.audited} of {size}"
    how = "" if whole else " (a sample, the same every time)"
    limit = "ten times their stated error" if found.stated else f"{UNSTATED:g}"
    what = "the case" if size == 1 else f"{what} cases"
    words = f"{what} again{how}, {', '.join(levels) or 'nothing tighter'}: "
    words += (
        f"{counted(len(found.other), 'other outcome')}, {counted(len(found.beyond), 'peak')} off by more than {limit}"
    )
    if found.failed:
        words += f"; {found.failed} failed in the tighter run"
    if left_out:
        words += f"; no tighter setting for {left_out}"
    return words
