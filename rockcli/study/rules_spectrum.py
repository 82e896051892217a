"""`rules_spectrum`: a floor response spectrum that code rules are read on."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.counted import counted
from rockcli.scene.ground.spectra import FloorSpectrum
from rockcli.scene.rules import RULES
from rockcli.study.document.dimensions import stated_number
from rockcli.study.document.expressions import says_its_unit
from rockcli.study.document.tree import Map, Source
from rockcli.study.schema import StudyPart

KEY = "rules_spectrum"


def read_rules_spectrum(source: Source, study: Map, part: StudyPart) -> FloorSpectrum | None:
    """The table a study gives; None where it gives none.

    Raises:
        StudyError: lists of different lengths, periods that do not ascend, values that are no accelerations, or no rule
            that takes it.
    """
    said = part.rules_spectrum
    if said is None:
        return None
    if not any(RULES[name].takes_given for name in part.rules):
        takers = ", ".join(name for name, rule in RULES.items() if rule.takes_given)
        raise source.error(
            study, (KEY,), f"is read by none of the rules asked for; expected one of {takers} in `rules`"
        )
    periods, S_a = (_numbers(source, study, key, getattr(said, key)) for key in ("periods", "S_a"))
    if len(periods) != len(S_a):
        raise source.error(
            study, (KEY, "S_a"), f"has {counted(len(S_a), 'value')} for {counted(len(periods), 'period')}"
        )
    if said.units == "g" and (twice := [value for value in said.S_a if says_its_unit(value)]):
        message = f"{twice[0]!r} says its unit, and `units: g` too; leave one out"
        raise source.error(study, (KEY, "S_a"), f": {message}")
    if periods[0] < 0.0 or not (np.diff(periods) > 0.0).all():
        raise source.error(study, (KEY, "periods"), "must ascend, from zero or above")
    if not (S_a > 0.0).all():
        raise source.error(study, (KEY, "S_a"), "must be above zero")
    return FloorSpectrum(periods, S_a, said.units == "g")


def _numbers(source: Source, study: Map, key: str, values: list[Any]) -> NDArray[np.float64]:
    return np.array([stated_number(source, study, (KEY, key, i), value) for i, value in enumerate(values)])
