"""Builds and solves cases so that one bad case never loses the others: what breaks is halved to find the culprits.

A case that breaks is failed, with a sentence.  A machine that refuses what a case needs has said nothing about it: that
case is `Unsolved`, and solved again by the next run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from rockcli.engine.auto import settled
from rockcli.engine.choose import choose
from rockcli.errors import MACHINE, MachineError, RecordError, RockError, SolverError, StudyError
from rockcli.scene.auto import AUTO
from rockcli.scene.batch import Batch
from rockcli.scene.response import Response
from rockcli.study.study import Index

Rebuild = Callable[[Index], Iterator[tuple[Index, Batch]]]

ATTEMPTS = 64
"""Batches that may break in a row, none that works between them, before what breaks is not taken apart any more."""


class Unsolved(str):
    """Why there is no answer: what the machine refused."""

    __slots__ = ()


def reason_of(error: BaseException, what: str) -> str:
    """The sentence of an error: `Unsolved` for what is the machine's; `what` happened, for what nobody foresaw."""
    if isinstance(error, MACHINE):
        return Unsolved(str(error) if isinstance(error, RockError) else f"{type(error).__name__}: {error}")
    return str(error) if isinstance(error, RockError) else f"{what}: {type(error).__name__}: {error}"


def build_apart(build: Rebuild, cases: Index) -> Iterator[tuple[Index, Batch | str]]:
    """Yield the batches of cases, or the sentence of why there is none; what cannot be built is halved to find it."""
    pending = [cases]
    broken = 0
    while pending:
        some = pending.pop()
        done: list[Index] = []
        try:
            for part, batch in build(some):
                yield part, batch
                done.append(part)
                broken = 0
        except Exception as error:  # a record that is gone, a number that cannot be: the case's, not the study's
            broken += 1
            rest = np.setdiff1d(some, np.concatenate(done)) if done else some
            if len(rest) == 1 or broken > ATTEMPTS:
                yield rest, reason_of(error, "the case cannot be built")
            else:
                pending.extend(np.array_split(rest, 2))


def buildable(build: Rebuild, cases: Index) -> Iterator[tuple[Index, Batch]]:
    """Yield the batches of those cases that can be built.

    Raises:
        MachineError: the machine refused what a case needs.
    """
    for part, batch in build_apart(build, cases):
        if isinstance(batch, Unsolved):
            raise MachineError(batch)
        if not isinstance(batch, str):
            yield part, batch


def solve_apart(rebuild: Rebuild, indices: Index, batch: Batch) -> Iterator[tuple[Index, Response | str]]:
    """Yield responses, or the sentence of why there is none; a batch that breaks is halved to find the bad cases.

    `rebuild(indices)` gives the batches of some of the cases again.
    """
    pending: list[tuple[Index, Batch | str]] = [(indices, batch)]
    broken = 0
    while pending:
        part, cases = pending.pop()
        if isinstance(cases, str):
            yield part, cases
            continue
        try:
            answers = list(_solved(part, cases))
        except StudyError:
            raise
        except (SolverError, RecordError) as error:
            yield part, str(error)
        except Exception as error:  # a solver that breaks is a failed case, not a lost study
            broken += 1
            if len(part) == 1 or broken > ATTEMPTS:
                yield part, reason_of(error, "the solver broke")
                continue
            for half in np.array_split(part, 2):
                pending.extend(build_apart(rebuild, half))
        else:
            broken = 0
            yield from answers


def _solved(indices: Index, batch: Batch) -> Iterator[tuple[Index, Response]]:
    """The response of a batch; of model auto one for each model its cases are solved with."""
    if batch.model == AUTO:
        yield from ((indices[rows], response) for rows, response in settled(batch))
    else:
        yield indices, choose(batch).load()(batch)
