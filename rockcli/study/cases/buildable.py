"""Isolates cases that cannot be built, by bisection, so that one bad case never loses the others.

A case that cannot be built is failed, with a message.  A machine that refuses what a case needs has said nothing about
it: that case is `Unsolved`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from rockcli.errors import MACHINE, MachineError, RockError
from rockcli.scene.batch import Batch
from rockcli.study.study import Index

Rebuild = Callable[[Index], Iterator[tuple[Index, Batch]]]

ATTEMPTS = 64
"""Batches that may break in a row, none that works between them, before what breaks is not taken apart any more.

Those that cannot be built are still, if their first or their last case can be: past a row of bad cases begin good ones.
"""


class Unsolved(str):
    """Why there is no answer: what the machine refused."""

    __slots__ = ()


def reason_of(error: BaseException, what: str) -> str:
    """The sentence of an error: `Unsolved` for what is the machine's; `what` happened, for what nobody foresaw."""
    if isinstance(error, MACHINE):
        return Unsolved(str(error) if isinstance(error, RockError) else f"{type(error).__name__}: {error}")
    return str(error) if isinstance(error, RockError) else f"{what}: {type(error).__name__}: {error}"


def build_isolated(build: Rebuild, cases: Index) -> Iterator[tuple[Index, Batch | str]]:
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
            if len(rest) == 1 or (broken > ATTEMPTS and not any(_builds(build, end) for end in (rest[:1], rest[-1:]))):
                yield rest, reason_of(error, "the case cannot be built")
            else:
                pending.extend(np.array_split(rest, 2))


def _builds(build: Rebuild, cases: Index) -> bool:
    """Whether cases can be built."""
    try:
        return bool(list(build(cases)))
    except Exception:  # what is wrong is told of the cases that it is looked for
        return False


def buildable(build: Rebuild, cases: Index) -> Iterator[tuple[Index, Batch]]:
    """Yield the batches of those cases that can be built.

    Raises:
        MachineError: the machine refused what a case needs.
    """
    for part, batch in build_isolated(build, cases):
        if isinstance(batch, Unsolved):
            raise MachineError(batch)
        if not isinstance(batch, str):
            yield part, batch


def by_motion(build: Rebuild, cases: Index) -> Iterator[tuple[Index, Batch]]:
    """`buildable`, where batches of many records, built once for all of them, are taken apart by their motions."""
    for part, batch in buildable(build, cases):
        if batch.excitation.suite is None:
            yield part, batch
        else:
            yield from ((part[rows], one) for rows, one in batch.apart())
