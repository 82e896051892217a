"""The full mesh in `rock trade`: its families of steps and of elements, and the models it judges."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from rockcli.engine.trade.settings import ELEMENTS_REFERENCE, MODEL, NUMERICS, Setting, model_word
from rockcli.scene.backends import BACKENDS, Pair
from rockcli.scene.batch import Batch
from rockcli.scene.laws.models import CONTINUUM, FLEXIBLE
from rockcli.scene.numerics import Numerics

MESH: Pair = (CONTINUUM, None)

STEPS = BACKENDS["calculix"].settings
"""Largest time steps over the backend's own at accuracy `standard`."""

ACROSS = (1, 2, 4, 6, 8)
"""Elements across, beside those of the study."""

DRAFT = 2.0
"""Step at which meshes are compared: that of accuracy `draft`."""

HOW = Numerics("calculix")


def refusal(batch: Batch) -> str:
    """Why the bodies of a batch are no mesh; "" if they are."""
    from rockcli.solvers.calculix.case import Refused, prepare

    try:
        prepare(Setting(NUMERICS, "calculix", "", *MESH, HOW).of(batch), 0)
    except Refused as refused:
        return str(refused)
    return ""


def families(batch: Batch, along: int) -> tuple[list[Setting], list[Setting]]:
    """Families of elements and of steps; `along`: elements along the height that the study asks for, 0 = square ones.

    What they are held against is known when they have been climbed.
    """
    assert batch.column is not None
    own = batch.column.across

    def setting(family: str, words: str, across: int, factor: float) -> Setting:
        elements = round(along * across / own) or int(along > 0)
        return Setting(NUMERICS, family, words, *MESH, HOW, factor, elements, across)

    def mesh(across: int) -> str:
        return f"{across} x {round(along * across / own) or 1}" if along else f"{across} across"

    elements = [setting("calculix, elements", mesh(n), n, DRAFT) for n in sorted({*ACROSS, own})]
    return elements, [setting("calculix", f"dt x {factor:g}", own, factor) for factor in STEPS]


def judged(batch: Batch, own: Pair) -> Iterator[Setting]:
    """Models whose error is told against the mesh: the flexible column, and of a study of the mesh the block too.

    At accuracy `standard`, under the study's damping.
    """
    for pair in ((FLEXIBLE, None), ("rigid", None)) if own == MESH else ((FLEXIBLE, None),):
        elements = ELEMENTS_REFERENCE if pair[0] == FLEXIBLE and own == MESH else None
        asked = replace(batch, model=pair[0], geometry=pair[1], numerics=Numerics("event"))
        if BACKENDS["event"].supports(asked):
            words = f"against {model_word(MESH)}"
            yield Setting(MODEL, "event", words, *pair, Numerics("event"), elements=elements, against=model_word(MESH))
