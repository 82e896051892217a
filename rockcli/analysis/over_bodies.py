"""What the bodies of a study have, over the axes that change it and no others."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.body.block import Block
from rockcli.storage.reduced import reduce
from rockcli.study.cases.buildable import buildable
from rockcli.study.study import Study

Array = NDArray[np.float64]

MOST_BODIES = 20_000
"""Points, on the axes that may change the body, up to which anything is kept of each."""

MOST_NUMBERS = 2_000_000
"""Numbers of all bodies together up to which they are kept."""

NOT_OF_THE_BODY = frozenset({"motion", "initial", "model", "geometry", "column", "base", "damping", "solver"})
"""Parts of a case that its body does not depend on."""


def over_bodies(
    study: Study, keys: frozenset[str], of: Callable[[Block], Sequence[Array] | Array | None]
) -> tuple[tuple[str, ...], Array] | None:
    """Names of the axes that change what bodies have, and that over them, (*axes, k, ...), NaN after the last.

    None where no body has it, or there would be too much (`MOST_BODIES`, `MOST_NUMBERS`).

    Args:
        keys: of a block, one of which says that it has it.
        of: an array (k, ...) of each of the bodies of a block; None where they have none.

    Raises:
        StudyError, RecordError: a case cannot be built.
    """
    paths = [axis.path.removeprefix("case.").split(".")[0] for axis in study.axes]
    block = study.resolved.get("case", {}).get("block") or {}
    if block.keys().isdisjoint(keys) and not {"block", "case"} & set(paths):
        return None
    may = [i for i, path in enumerate(paths) if path not in NOT_OF_THE_BODY]
    shape = tuple(study.shape[i] for i in may)
    if (size := int(np.prod(shape, dtype=np.int64))) > MOST_BODIES:
        return None
    at = np.zeros((len(paths), size), dtype=np.int64)
    at[may] = np.array(np.unravel_index(np.arange(size), shape)) if may else 0
    cases = np.atleast_1d(np.ravel_multi_index(tuple(at), study.shape)) if paths else np.zeros(1, dtype=np.int64)
    distinct: dict[bytes, tuple[int, Array]] = {}
    which = np.full(size, -1.0)
    for part, batch in buildable(study.suites, np.asarray(cases, dtype=np.int64)):
        found = of(batch.block)
        if found is None:
            continue
        for case, values in zip(np.searchsorted(cases, part).tolist(), found, strict=True):
            which[case] = distinct.setdefault(values.tobytes(), (len(distinct), values))[0]
        if sum(values.size for _, values in distinct.values()) > MOST_NUMBERS:
            return None
    if not distinct:
        return None
    dims, codes = reduce(which.reshape(shape), tuple(study.axes[i].name for i in may))
    rows = [values for _, values in distinct.values()]
    table = np.full((len(rows) + 1, max(len(row) for row in rows), *rows[0].shape[1:]), np.nan)
    for row, values in distinct.values():  # the last row of the table, -1, stands for bodies that have none
        table[row, : len(values)] = values
    chosen = table[codes.astype(np.int64)]
    return None if chosen.size > MOST_NUMBERS else (dims, chosen)
