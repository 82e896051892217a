"""Walks all cases of a study in chunks and gathers the results; one bad case never loses the others."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.choose import choose
from rockcli.engine.limits import cases_at_a_time
from rockcli.engine.measures import peaks
from rockcli.errors import RecordError, SolverError, StudyError
from rockcli.scene.batch import Batch
from rockcli.scene.excitation import Pulses
from rockcli.scene.response import FAILED, MAX_IMPACTS_STORED, Response
from rockcli.scene.variables import LARGE
from rockcli.study.study import Index, Study

Array = NDArray[np.float64]
Progress = Callable[[int, int], None]

CHUNK = 65536
"""Cases solved at a time."""

CHUNK_WITH_HISTORIES = 100

_ATTEMPTS = 64
"""Batches that may break before what is left of a chunk is no longer taken apart to find the culprits."""

_DTYPES = {"outcome": np.int8, "n_impacts": np.int64, "n_steps": np.int64}


@dataclass(eq=False)
class Results:
    """Everything the solvers said, over the flat cases of a study.

    Attributes:
        scalars: (n,) by name; floats NaN and counts -1 where there is no answer.
        symbols: R alpha p eta a_p omega_p pga pgv, (n,), NaN where a case has none.
        time: output times (k,) [s].
        histories: (n, k) by name, NaN after a case's t_end; impacts: (n, j), NaN-padded.
        sentences: (n,) code of the sentence of each case; codes: sentence -> code, "" is 0.
        used: distinct settings of the solvers, in the order met.
        warnings: sentence -> number of cases.
        has_mass: whether every case has a mass (M_base is then in N m).
    """

    scalars: dict[str, NDArray[Any]]
    symbols: dict[str, Array]
    sentences: NDArray[np.int32]
    codes: dict[str, int] = field(default_factory=lambda: {"": 0})
    time: Array = field(default_factory=lambda: np.empty(0))
    histories: dict[str, Array] = field(default_factory=dict)
    impacts: dict[str, Array] = field(default_factory=dict)
    used: list[dict[str, str]] = field(default_factory=list)
    warnings: dict[str, int] = field(default_factory=dict)
    has_mass: bool = True

    def say(self, indices: Index, sentences: list[str]) -> None:
        """Note one sentence per case."""
        for index, sentence in zip(indices, sentences, strict=True):
            if sentence:
                self.sentences[index] = self.codes.setdefault(sentence, len(self.codes))

    def order_reasons(self) -> None:
        """Number the sentences by the first case that has them, whatever order the batches came in."""
        known = list(self.codes)
        used, first = np.unique(self.sentences, return_index=True)
        order = [0, *(int(code) for code in used[np.argsort(first)] if code)]
        place = np.zeros(len(known), dtype=np.int32)
        place[order] = np.arange(len(order))
        self.sentences = place[self.sentences]
        self.codes = {known[code]: i for i, code in enumerate(order)}


def solve_cases(study: Study, progress: Progress | None = None) -> Results:
    """Solve every case of a study.

    Args:
        study: a checked study.
        progress: called with (cases done, cases in all) after every batch.

    Raises:
        StudyError, RecordError: a case cannot be built.
    """
    with np.errstate(all="ignore"):  # what is not finite is found in the results
        return _solve_cases(study, progress)


def _solve_cases(study: Study, progress: Progress | None) -> Results:
    results = _empty(study)
    histories: list[tuple[Index, Response]] = []
    done = 0
    for chunk in _chunks(study):
        for indices, batch in study.batches(chunk):
            _describe(results, indices, batch, measure=study.size <= LARGE)
            for part, response in solve_apart(study.batches, indices, batch):
                _gather(results, part, response)
                if study.histories and not isinstance(response, str):
                    histories.append((part, response))
            done += len(indices)
            if progress is not None:
                progress(done, study.size)
    _join_histories(results, histories, study.size)
    results.order_reasons()
    return results


def describe_cases(study: Study) -> Results:
    """What is known of the cases without solving them: their symbols and warnings."""
    results = _empty(study)
    with np.errstate(all="ignore"):
        for chunk in _chunks(study):
            for indices, batch in study.batches(chunk):
                _describe(results, indices, batch, measure=False)
    return results


def _chunks(study: Study) -> Iterator[Index]:
    step = cases_at_a_time(study, CHUNK_WITH_HISTORIES) if study.histories else CHUNK
    for start in range(0, study.size, step):
        yield np.arange(start, min(start + step, study.size))


def _empty(study: Study) -> Results:
    n = study.size
    scalars: dict[str, NDArray[Any]] = {}
    for name in study.scalars:
        if name == "outcome":
            scalars[name] = np.full(n, FAILED, dtype=np.int8)
        elif name in _DTYPES:
            scalars[name] = np.full(n, -1, dtype=_DTYPES[name])
        elif name != "reason":
            scalars[name] = np.full(n, np.nan)
    return Results(scalars, {}, np.zeros(n, dtype=np.int32))


def _describe(results: Results, indices: Index, batch: Batch, *, measure: bool) -> None:
    """Note the symbols and warnings of a batch."""
    block, motion = batch.block, batch.excitation.horizontal
    symbols = {
        "R": block.of_weak_edge(block.R),
        "alpha": block.of_weak_edge(block.alpha),
        "p": block.of_weak_edge(batch.p),
        "eta": block.of_weak_edge(batch.damping.eta),
    }
    if isinstance(motion, Pulses):
        symbols |= {"a_p": motion.a_p, "omega_p": motion.omega_p}
    if measure:
        symbols["pga"], symbols["pgv"] = peaks(motion, batch.size, batch.excitation.duration)
    for name, values in symbols.items():
        results.symbols.setdefault(name, np.full(len(results.sentences), np.nan))[indices] = values
    results.has_mass &= bool(np.isfinite(block.mass).all())
    for sentence in batch.warnings:
        results.warnings[sentence] = results.warnings.get(sentence, 0) + batch.size


Rebuild = Callable[[Index], Iterator[tuple[Index, Batch]]]


def solve_apart(rebuild: Rebuild, indices: Index, batch: Batch) -> Iterator[tuple[Index, Response | str]]:
    """Yield responses, or the sentence of why there is none; a batch that breaks is halved to find the bad cases.

    `rebuild(indices)` gives the batches of some of the cases again.
    """
    pending: list[tuple[Index, Batch]] = [(indices, batch)]
    broken = 0
    while pending:
        part, cases = pending.pop()
        try:
            solver = choose(cases).load()
        except SolverError as error:
            yield part, str(error)
            continue
        try:
            response = solver(cases)
        except (StudyError, RecordError):
            raise
        except SolverError as error:
            yield part, str(error)
        except Exception as error:  # a solver that breaks is a failed case, not a lost study
            broken += 1
            if len(part) == 1 or broken > _ATTEMPTS:
                yield part, f"the solver broke: {type(error).__name__}: {error}"
                continue
            for half in np.array_split(part, 2):
                pending.extend(rebuild(half))
        else:
            yield part, response


def _gather(results: Results, indices: Index, response: Response | str) -> None:
    if isinstance(response, str):
        results.say(indices, [response] * len(indices))
        return
    for name, values in results.scalars.items():
        if name in response.scalars:
            values[indices] = response.scalars[name]
    results.say(indices, response.reasons)
    if response.used not in results.used:
        results.used.append(response.used)


def _join_histories(results: Results, parts: list[tuple[Index, Response]], n: int) -> None:
    """Lay the histories of all batches on the longest of their time axes, and pad the impacts."""
    results.time = max((response.time for _, response in parts), key=len, default=np.empty(0))
    longest = max((a.shape[1] for _, r in parts for a in r.impacts.values()), default=0)
    for indices, response in parts:
        for name, values in response.histories.items():
            if name not in results.histories:
                results.histories[name] = np.full((n, len(results.time)), np.nan)
            results.histories[name][indices, : values.shape[1]] = values
        for name, values in response.impacts.items():
            if name not in results.impacts:
                results.impacts[name] = np.full((n, min(max(longest, 1), MAX_IMPACTS_STORED)), np.nan)
            results.impacts[name][indices, : values.shape[1]] = values
