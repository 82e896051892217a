"""What is derived from solved cases, in one order: comparison, worst direction, bodies, curves, rules, suites."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rockcli.analysis.barriers import with_barriers
from rockcli.analysis.boundaries import with_boundaries
from rockcli.analysis.compare_to_reference import with_comparison
from rockcli.analysis.curves import with_curves
from rockcli.analysis.direction import with_worst_direction
from rockcli.analysis.outlines import with_outlines
from rockcli.analysis.prescreen import with_prescreen
from rockcli.analysis.rules import with_rules
from rockcli.storage.contents import Contents
from rockcli.study.study import Study


def _with_ensembles(contents: Contents, study: Study) -> Contents:
    """The statistics of suites, a third of the modules of `analysis`: loaded where there are any or were."""
    if study.over is None and "ensemble" not in contents.attrs:
        return contents
    from rockcli.analysis.suites.statistics import with_ensembles

    return with_ensembles(contents, study)


DERIVED: tuple[Callable[[Contents, Study], Contents], ...] = (
    with_comparison,
    with_worst_direction,
    with_outlines,
    with_boundaries,
    with_barriers,
    with_curves,
    with_rules,
    with_prescreen,
    _with_ensembles,
)
"""Each adds what the study asks for and takes away what it no longer asks for; later ones may read earlier ones."""


def derive(contents: Contents, study: Study) -> Contents:
    """The contents with all that the study derives from its solved cases.

    Raises:
        StudyError, RecordError: a case cannot be built again.
    """
    with np.errstate(all="ignore"):  # what is not finite is a result
        for add in DERIVED:
            contents = add(contents, study)
    return contents
