"""Solves all cases of a study in chunks and gathers the results; one bad case never loses the others."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from itertools import chain, islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.engine.backends import choose
from rockcli.engine.cost import seconds_in_plain_python, seconds_of_laying_out, seconds_per_case
from rockcli.engine.sweep.ahead import Ahead, pays
from rockcli.engine.sweep.chunk_result import ChunkResult, blank, spans_of
from rockcli.engine.sweep.chunk_symbols import Reduction
from rockcli.engine.sweep.chunks import CHUNK, Chunks, Pace, Spans, Turned, counted, places_in_turn, without
from rockcli.engine.sweep.executors import answers
from rockcli.engine.sweep.history_size import cases_at_a_time
from rockcli.engine.sweep.isolate_failures import solve_isolated
from rockcli.engine.sweep.memory import keep_freed
from rockcli.engine.sweep.parts import Keeper
from rockcli.engine.sweep.results import Results, Tally
from rockcli.engine.sweep.settings_used import joined
from rockcli.engine.sweep.symbols_of_cases import describe, describe_rest, rows_of, symbols_of
from rockcli.engine.sweep.work import Team
from rockcli.errors import MachineError, SolverError
from rockcli.scene.auto import highest
from rockcli.scene.batch import Batch
from rockcli.scene.laws.models import DEFORMABLE
from rockcli.scene.response import Response
from rockcli.scene.variables import GROUND
from rockcli.storage.netcdf import Writer
from rockcli.storage.on_disk import full, in_blocks, let_go
from rockcli.study.cases.buildable import Unsolved, build_isolated, buildable
from rockcli.study.study import OF_DIRECTIONS, OF_RECORDS, Index, Study

Progress = Callable[[int, int], None]

CHUNK_WITH_HISTORIES = 100

ESTIMATED_BY, BATCHES_BUILT = 64, 8
"""Cases by which the cost of all is estimated, and batches of theirs that are built for it."""

COMPILED_ABOVE = 2.0
"""Time in plain Python above which a study's kernels are compiled [s]."""


@dataclass
class Sweep:
    """How a study is to be solved, beside what it says.

    Attributes:
        team: who works.
        keeper: keeps what is finished where a killed run finds it again; None = nowhere.
        share: (K, N): only the K-th of N shares of the cases.
        known: answers there are already, of the same numbers.
        folder: where results too large for memory lie until the dataset is written; None = in memory.
        file: the dataset that is to be written, for what is large to be written ahead.
        progress: called with (cases done, cases in all) after every chunk.
        resumed: afterwards, how many cases the keeper had.
    """

    team: Team
    keeper: Keeper | None = None
    share: tuple[int, int] | None = None
    known: Iterable[ChunkResult] = ()
    folder: Path | None = None
    file: Writer | None = None
    progress: Progress | None = None
    resumed: int = 0


@dataclass(frozen=True, eq=False)
class Solving:
    """Solves some cases of a study, wherever it is called (`work.Work`).

    Attributes:
        described: whether it also tells their symbols and warnings; `reduction`: how.
    """

    study: Study
    compiled: bool = False
    reduction: Reduction | None = None
    described: bool = True

    def __call__(self, cases: Index) -> ChunkResult:
        """The answer of some cases.

        Raises:
            StudyError: a solver cannot do what the study asks for.
        """
        with np.errstate(all="ignore"):  # what is not finite is found in the results
            return self._solved(cases)

    def lost(self, cases: Index, why: str) -> ChunkResult:
        """The answer of cases that failed with a message, or are unsolved."""
        answer = ChunkResult(cases, blank(self.study.scalars, len(cases)), {why: cases})
        return _left_out(answer) if isinstance(why, Unsolved) else answer

    def _solved(self, cases: Index) -> ChunkResult:
        if self.compiled:
            kernels.load(compile_them=True)
        study = self.study
        answer = ChunkResult(cases, blank(study.scalars, len(cases)))
        responses: list[tuple[Index, Response]] = []
        said: dict[str, list[Index]] = {}
        built: list[tuple[Index, Batch]] = []
        for part, batch in build_isolated(study.suites, cases):
            if isinstance(batch, str):
                said.setdefault(batch, []).append(part)
                continue
            built.append((part, batch))
            for some, response in solve_isolated(study.suites, part, batch):
                if isinstance(response, str):
                    said.setdefault(response, []).append(some)
                else:
                    _gather(answer, some, response, said)
                    if response.histories or response.impacts:
                        responses.append((some, response))
        answer.sentences = {sentence: np.sort(np.concatenate(where)) for sentence, where in said.items()}
        if self.described:
            answer.described = describe(study, built)
        if self.reduction is not None and answer.described is not None:
            answer.described.symbols = self.reduction(answer.described.cases, answer.described.symbols)
        _join(answer, responses)
        return _left_out(answer)


def solve_cases(study: Study, sweep: Sweep | None = None) -> Results:
    """Solve every case of a study.

    Raises:
        StudyError: a solver cannot do what the study asks for.
        OutputError: what is finished cannot be kept.
    """
    sweep = sweep or Sweep(Team())
    with np.errstate(all="ignore"):
        return _solve_cases(study, sweep)


def _solve_cases(study: Study, sweep: Sweep) -> Results:
    keep_freed()
    results = Results.of(study, symbols_of(study, sweep.folder), sweep.folder)
    results.whole = True
    if sweep.file is not None and pays(study):
        results.ahead = Ahead(study, sweep.file).put
    todo = take_known(sweep, results)
    known = results.answered
    chunks = Chunks(study.size, todo if known else None, _by_record(study))
    if not known:
        del todo  # a byte for every case
    _work_off_at_pace(study, sweep, results, chunks)
    if known:
        for at in in_blocks(todo):
            np.logical_not(todo[at], out=todo[at])
        describe_rest(study, results, todo)
    results.finish()
    return results


def solve_share(study: Study, sweep: Sweep) -> int:
    """Solve what is left of a share (`sweep.share`), and hold no more of the study than is at work.

    Returns how many cases of the study are kept by then.

    Raises:
        StudyError, OutputError: as `solve_cases`.
    """
    assert sweep.share is not None
    with np.errstate(all="ignore"):
        keep_freed()
        turned = _by_record(study)
        kept: Spans = []
        for answer in chain(sweep.known, sweep.keeper.kept() if sweep.keeper else ()):
            spans = [(first, stop) for first, stop in spans_of(places_in_turn(answer.cases, turned)).tolist()]
            kept = sorted([*kept, *without(spans, kept)])
        note_damaged(sweep)
        chunks = Chunks(study.size, without(_of_share(study.size, *sweep.share), kept), turned)
        tally = Tally(counted(kept))
        _work_off_at_pace(study, sweep, tally, chunks)
        return tally.answered


def _work_off_at_pace(study: Study, sweep: Sweep, results: Results | Tally, chunks: Chunks) -> None:
    estimate, compiled = outlook(study, study.size) if chunks.left else (1.0, False)
    most = cases_at_a_time(study, CHUNK_WITH_HISTORIES) if study.histories else CHUNK
    pace = Pace(estimate, most, at_once=compiled and kernels.compiled_ahead())
    work_off(study, sweep, results, chunks, pace, compiled=compiled)


def _by_record(study: Study) -> Turned | None:
    """How chunks hold all cases of few records, not some of all: a record is laid out for every chunk that has it."""
    of_records = (axis.path == OF_DIRECTIONS or (axis.path in OF_RECORDS and not axis.numeric) for axis in study.axes)
    first = next((i for i, each in enumerate(of_records) if each), 0)
    return (study.shape, first) if first > 0 else None


def take_known(sweep: Sweep, results: Results) -> NDArray[np.bool_]:
    """Put the answers there are already into results; which cases are left, (n,)."""
    todo = full(results.size, True, np.bool_, sweep.folder)
    for answer in sweep.known:
        todo[answer.cases] = False
        results.put(answer)
    for answer in sweep.keeper.kept() if sweep.keeper else ():
        fresh = answer.among(todo[answer.cases])
        todo[fresh.cases] = False
        results.put(fresh)
        sweep.resumed += len(fresh.cases)
        let_go(todo)
    note_damaged(sweep)
    return todo


def note_damaged(sweep: Sweep) -> None:
    """Say that parts were met that cannot be read."""
    if sweep.keeper and sweep.keeper.damaged:
        sweep.team.note("some results kept by earlier runs were damaged and were solved again")


def work_off(
    study: Study, sweep: Sweep, results: Results | Tally, chunks: Chunks, pace: Pace, *, compiled: bool
) -> None:
    """Solve the cases of chunks into results.

    Raises:
        StudyError: a solver cannot do what the study asks for.
        OutputError: what is finished cannot be kept.
        MachineError: all that could be solved is; the machine refused what the rest needs.
    """
    done = results.answered
    in_all = done + chunks.left
    refused: dict[str, int] = {}
    if sweep.progress is not None and done:
        sweep.progress(done, in_all)
    solving = Solving(study, compiled, results.reduction, described=results.describes)
    for cases, answer in answers(solving, chunks, pace, sweep.team):
        if answer.described is not None:
            results.describe(answer.described)
            answer.described = None
        if sweep.keeper is not None and len(answer.cases):
            sweep.keeper.keep(answer)
        results.put(answer)
        note_unsolved(refused, answer)
        done += len(cases)
        if sweep.progress is not None:
            sweep.progress(done, in_all)
    check_solved(refused, in_all)


def note_unsolved(refused: dict[str, int], answer: ChunkResult) -> None:
    """Add the cases that an answer lacks to those refused, by what the machine said."""
    for sentence, where in answer.unsolved.items():
        refused[sentence] = refused.get(sentence, 0) + len(where)


def check_solved(refused: dict[str, int], cases: int) -> None:
    """`MachineError` if the machine refused cases."""
    if refused:
        most = max(refused, key=lambda sentence: refused[sentence])
        more = f", and {len(refused) - 1} other complaints" if len(refused) > 1 else ""
        message = f"{sum(refused.values())} of {cases} cases are not solved, because the machine refused: {most}{more}"
        if cases == 1:
            message = f"the case is not solved, because the machine refused: {most}"
        raise MachineError(message)


def _of_share(n: int, k: int, shares: int) -> Spans:
    """The places among n that belong to share k of N: blocks in turn, since neighbours cost about the same."""
    block = max(1, n // (64 * shares))
    return [(start, min(start + block, n)) for start in range((k - 1) * block, n, shares * block)]


def outlook(study: Study, size: int) -> tuple[float, bool]:
    """Seconds per case, estimated from some all over the study, and whether kernels are to be compiled for so many."""
    some = np.unique(np.linspace(0, study.size - 1, ESTIMATED_BY).astype(np.int64))
    seconds = in_plain_python = 0.0
    seen = 0
    records = max([axis.size for axis in study.axes if axis.path in OF_RECORDS and not axis.numeric], default=0) / size
    for part, batch in islice(buildable(study.suites, some), BATCHES_BUILT):
        try:
            backend = choose(batch).name
        except SolverError:
            continue
        if backend == "event" and highest(batch).model not in DEFORMABLE:
            in_plain_python += seconds_in_plain_python(batch) * len(part)
        seconds += (seconds_per_case(batch, backend) + records * seconds_of_laying_out(batch)) * len(part)
        seen += len(part)
    return (seconds / seen, in_plain_python / seen * size > COMPILED_ABOVE) if seen else (1e-3, False)


def _gather(answer: ChunkResult, part: Index, response: Response, said: dict[str, list[Index]]) -> None:
    rows = rows_of(answer.cases, part)
    for name, values in answer.scalars.items():
        if name in response.scalars:
            values[rows] = response.scalars[name]
    if any(response.reasons):
        by_sentence: dict[str, list[int]] = {}
        for case, sentence in zip(part.tolist(), response.reasons, strict=True):
            if sentence:
                by_sentence.setdefault(sentence, []).append(case)
        for sentence, where in by_sentence.items():
            said.setdefault(sentence, []).append(np.array(where, dtype=np.int64))
    used = [(part[at], one) for at, one in response.apart] or [(part, response.used)]
    answer.used = joined([*answer.used, *((int(cases.min()), one) for cases, one in used)])


def _left_out(answer: ChunkResult) -> ChunkResult:
    """An answer without the cases that are unsolved."""
    unsolved = {str(said): where for said, where in answer.sentences.items() if isinstance(said, Unsolved)}
    if not unsolved:
        return answer
    rest = answer.among(~np.isin(answer.cases, np.concatenate(list(unsolved.values()))))
    return replace(rest, described=answer.described, unsolved=unsolved)


def _join(answer: ChunkResult, responses: list[tuple[Index, Response]]) -> None:
    """Histories of the batches of a chunk on the longest of their time axes, impacts padded, the ground's counted."""
    answer.time = max((response.time for _, response in responses), key=len, default=answer.time)
    for into, kind in ((answer.histories, "histories"), (answer.impacts, "impacts")):
        found: list[tuple[Index, dict[str, Any]]] = [(part, getattr(response, kind)) for part, response in responses]
        width = max((values.shape[1] for _, named in found for values in named.values()), default=0)
        for part, named in found:
            for name, values in named.items():
                if name not in into:
                    into[name] = np.full((len(answer.cases), width), np.nan)
                into[name][rows_of(answer.cases, part), : values.shape[1]] = values
    for part, response in responses:
        if response.histories:
            shaken = response.shaken
            if shaken is None:
                shaken = dict.fromkeys(GROUND, np.isfinite(response.histories["theta"]).sum(axis=1))
            for name, told in shaken.items():
                counted = answer.shaken.setdefault(name, np.zeros(len(answer.cases), dtype=np.int64))
                counted[rows_of(answer.cases, part)] = told
