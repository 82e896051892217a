"""Large results are written into the dataset's file while other cases are solved, so that nobody waits for it."""

from __future__ import annotations

from heapq import heappop, heappush

import numpy as np

from rockcli.engine.sweep.assemble import first_fields
from rockcli.engine.sweep.chunk_result import DTYPES, spans_of
from rockcli.engine.sweep.results import Results
from rockcli.storage.netcdf import Writer
from rockcli.study.study import Index, Study

WORTH = 1 << 24
"""Size of all scalars from which they are written ahead, some 0.1 s of work [bytes]."""


def pays(study: Study) -> bool:
    """Whether a study has results that are large."""
    return study.size * sum(np.dtype(DTYPES.get(name, np.float64)).itemsize for name in study.scalars) >= WORTH


class Ahead:
    """Follows how many of the first cases of a study are answered, and has as many written."""

    def __init__(self, study: Study, file: Writer) -> None:
        self._study, self._file = study, file
        self._first = 0
        self._begun = False
        self._later: list[tuple[int, int]] = []
        """Spans of answered cases beyond the first ones, a heap."""

    def put(self, cases: Index, results: Results) -> None:
        """Take note of cases that are answered in results."""
        if not self._begun:
            self._begun = True
            self._file.begin(first_fields(self._study, results))
        for first, stop in spans_of(cases).tolist():
            heappush(self._later, (first, stop))
        while self._later and self._later[0][0] <= self._first:
            self._first = max(self._first, heappop(self._later)[1])
        self._file.write_known(self._first)
