"""Solves cases so that one bad case never loses the others: what breaks is halved to find the culprits.

A case that breaks is failed, with a message.  A machine that refuses what a case needs has said nothing about it: that
case is `Unsolved`, and solved again by the next run.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rockcli.engine.auto import settled
from rockcli.engine.backends import choose
from rockcli.errors import RecordError, SolverError, StudyError
from rockcli.scene.auto import AUTO
from rockcli.scene.backends import EVENT
from rockcli.scene.batch import Batch
from rockcli.scene.laws.models import FLEXIBLE
from rockcli.scene.response import Response
from rockcli.solvers.event.record_lanes import asked
from rockcli.study.cases.buildable import ATTEMPTS, Rebuild, build_isolated, reason_of
from rockcli.study.study import Index


def solve_isolated(rebuild: Rebuild, indices: Index, batch: Batch) -> Iterator[tuple[Index, Response | str]]:
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
                pending.extend(build_isolated(rebuild, half))
        else:
            broken = 0
            yield from answers


def _solved(indices: Index, batch: Batch) -> Iterator[tuple[Index, Response]]:
    """The response of a batch; of model auto one for each model its cases are solved with.

    Of a suite one for each motion, but where lanes take them together.
    """
    if batch.excitation.suite is not None and not _together(batch):
        for rows, one in batch.apart():
            yield from _solved(indices[rows], one)
        return
    if batch.model == AUTO:
        yield from ((indices[rows], response) for rows, response in settled(batch))
    else:
        yield indices, choose(batch).load()(batch)


def _together(batch: Batch) -> bool:
    """Whether the solver of a suite takes cases of many records at once."""
    return batch.model not in (AUTO, FLEXIBLE) and choose(batch).name == EVENT and asked(batch)
