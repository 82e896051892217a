"""Series of settings of `rock trade`: settings of every backend from coarse to fine, and what each is held against."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rockcli.engine.trade.record_sampling import SAMPLINGS, has_samples, resampled
from rockcli.scene.backends import BACKENDS, EVENT, Pair
from rockcli.scene.batch import Batch, Save
from rockcli.scene.ground.excitation import Pulses
from rockcli.scene.laws.damping import Damping
from rockcli.scene.laws.models import CONTINUUM, DEFORMABLE, FLEXIBLE, MODELS
from rockcli.scene.numerics import ACCURACIES, STANDARD, Numerics

NUMERICS, MODEL, DATA = "numerics", "model", "data"
"""Kinds of error: against the same equations solved better, against a better model, against another sampling."""

MODAL_REFERENCE = 0.0625
"""Step of the flexible column over that of accuracy `draft`, as in the series of its backend."""

ELEMENTS = (1, 2, 3, 5, 10)
ELEMENTS_REFERENCE = 20


@dataclass(frozen=True)
class Setting:
    """One setting.

    Attributes:
        part: kind of its error; family: what is drawn as one curve; step: which point of it.
        model, geometry: solved.
        numerics: tolerances; `dt` and `yield_rotation` are set by `factor` where that is given.
        factor: of the time step (see `Backend.settings`).
        elements, across: of the column, None = the study's.
        sampling: of records, "" = as they are.
        rigid_base: whether the base is taken as rigid, whatever the study's.
        against: label of the reference.
    """

    part: str
    family: str
    step: str
    model: str
    geometry: str | None
    numerics: Numerics
    factor: float | None = None
    elements: int | None = None
    across: int | None = None
    sampling: str = ""
    rigid_base: bool = False
    against: str = ""

    @property
    def label(self) -> str:
        """The coordinate of the dataset."""
        return f"{self.part}: {self.model_word}: {self.family}, {self.step}"

    @property
    def model_word(self) -> str:
        """What is solved, in words."""
        return model_word((self.model, self.geometry)) + (" on a rigid base" if self.rigid_base else "")

    def of(self, batch: Batch) -> Batch:
        """The cases of a batch with this setting."""
        column = batch.column if self.model in (*DEFORMABLE, "4") else None
        if column is not None and self.elements is not None:
            column = replace(column, elements=self.elements)
        if column is not None and self.across is not None:
            column = replace(column, across=self.across)
        damping = batch.damping
        if self.model == CONTINUUM and damping.scheme == "restitution":
            damping = Damping("none", np.ones_like(damping.eta))  # an impact costs what the mesh makes of it
        carried = self.model in (batch.model, *DEFORMABLE) and not self.rigid_base
        excitation = resampled(batch.excitation, self.sampling) if self.sampling else batch.excitation
        numerics = self.numerics
        given = replace(
            batch, model=self.model, geometry=self.geometry, column=column, excitation=excitation, damping=damping,
            base=batch.base if carried else None,
            save=Save(False, batch.save.dt_out, frozenset({"outcome", "theta_peak_over_alpha", "n_steps", "n_rhs"})),
        )  # fmt: skip
        if self.factor is not None:
            numerics = _stepping(numerics, given, self.factor)
        return replace(given, numerics=numerics)


def model_word(pair: Pair) -> str:
    """`3 corotational`, `rigid`."""
    return " ".join(filter(None, pair))


def _stepping(numerics: Numerics, batch: Batch, factor: float) -> Numerics:
    """A time step for the batch, `factor` times the finest that any of its cases takes by itself."""
    if numerics.backend == "event":
        steps = 0.03 / float(batch.p.max())
        if isinstance(batch.excitation.horizontal, Pulses):
            steps = min(steps, 2.0 * np.pi / float(batch.excitation.horizontal.omega_p.max()) / 60.0)
        return replace(numerics, dt=factor * steps)
    if numerics.backend == "calculix":
        from rockcli.solvers.calculix.case import largest_step

        plain = replace(batch, numerics=Numerics())
        return replace(numerics, dt=factor * min(largest_step(plain, i) for i in range(batch.size)))
    from rockcli.scene.constants import YIELD_ROTATION
    from rockcli.solvers.frame.case import default_dt

    plain = replace(batch, numerics=Numerics())
    dt = min(default_dt(plain, i) for i in range(batch.size))
    return replace(numerics, dt=factor * dt, yield_rotation=factor * YIELD_ROTATION)


def reference(batch: Batch, pair: Pair, elements: int | None = None) -> Setting | None:
    """The best there is for a model under the batch's damping; None if nothing solves it."""
    model, geometry = pair
    fine = Numerics("event", "reference")
    asked = replace(batch, model=model, geometry=geometry, numerics=fine)
    if BACKENDS["event"].supports(asked):
        if model == FLEXIBLE:
            words = f"dt/{1.0 / MODAL_REFERENCE:g} of draft" + (f", {elements} elements" if elements else "")
            return Setting(NUMERICS, "event", words, model, geometry, fine, MODAL_REFERENCE, elements)
        return Setting(NUMERICS, "event", f"rtol {ACCURACIES['reference'].rtol:g}", model, geometry, fine)
    if BACKENDS["frame"].supports(asked):
        return Setting(NUMERICS, "frame", "dt/4", model, geometry, Numerics("frame"), 0.25)
    return None


def numerical(batch: Batch, pair: Pair, peers: frozenset[str]) -> Iterator[list[Setting]]:
    """A series, coarse to fine, per family that solves a model under the damping; `peers`: backends there are."""
    model, geometry = pair
    best = reference(batch, pair)
    if best is None:
        return
    against = f"{best.family}, {best.step}"

    def series(family: str, settings: Sequence[tuple[str, Numerics, float | None]]) -> list[Setting]:
        return [
            Setting(NUMERICS, family, words, *pair, how, factor, against=against) for words, how, factor in settings
        ]

    for name, backend in BACKENDS.items():
        row = backend.of_model(model)
        if name not in peers or row.slow or not row.solves(model, geometry, batch.damping.scheme):
            continue
        if name == EVENT and row.stepping:
            levels = {0.5 * level.wave_step: f" ({word})" for word, level in ACCURACIES.items()}
            yield series(name, [(f"dt x {f:g}{levels.get(f, '')}", Numerics(name), f) for f in row.settings])
            yield _elements(batch, pair)
        elif name == EVENT:
            yield series(name, [(_rtol(rtol), Numerics(name, _level(rtol), rtol), None) for rtol in row.settings])
        elif row.stepping:
            ends = row.settings if best.family == EVENT else row.settings[:-1]
            yield series(name, [(f"dt x {f:g}", Numerics(name), f) for f in ends])
        elif "method" in row.reads:
            from rockcli.solvers.general.methods import METHODS

            for method in METHODS:
                settings = [(f"rtol {r:g}", Numerics(name, STANDARD, r, method), None) for r in row.settings]
                yield series(f"{name} {method}", settings)
            if (batch.damping.eta == 1.0).all():
                blind = [(f"rtol {r:g}", Numerics(name, STANDARD, r, "RK45", False), None) for r in row.settings]
                yield series(f"{name} RK45, impacts not located", blind)
        elif row.settings:
            yield series(name, [(f"rtol {r:g}", Numerics(name, STANDARD, r), None) for r in row.settings])


def _elements(batch: Batch, pair: Pair) -> list[Setting]:
    best = reference(batch, pair, ELEMENTS_REFERENCE)
    assert best is not None
    how = Numerics("event", "reference")
    against = f"{best.family}, {best.step}"
    words = {n: f"{n} element" + ("s" if n > 1 else "") for n in ELEMENTS}
    return [Setting(NUMERICS, "event, elements", words[n], *pair, how, elements=n, against=against) for n in ELEMENTS]


def _level(rtol: float) -> str:
    return next(word for word, level in ACCURACIES.items() if rtol >= level.rtol)


def _rtol(rtol: float) -> str:
    named = [name for name, level in ACCURACIES.items() if level.rtol == rtol]
    return f"rtol {rtol:g}" + (f" ({named[0]})" if named else "")


def models(batch: Batch, own: Pair) -> Iterator[tuple[Setting, Pair]]:
    """(setting, the better model): simpler models of the same body, at accuracy standard."""
    rigid: Pair = ("rigid", None)
    how = Numerics("event")

    def solved(pair: Pair) -> bool:
        return BACKENDS["event"].supports(replace(batch, model=pair[0], geometry=pair[1], numerics=how))

    if own[0] == FLEXIBLE and batch.base is not None and solved(own):
        yield Setting(MODEL, "event", "standard", *own, how, rigid_base=True, against=model_word(own)), own
    pairs: list[tuple[Pair, Pair]] = [(pair, rigid) for pair in MODELS if pair != rigid]
    if own[0] == FLEXIBLE:
        pairs.insert(0, (rigid, own))
    for pair, better in pairs:
        if solved(pair):
            yield Setting(MODEL, "event", "standard", *pair, how, against=model_word(better)), better


def data(batch: Batch, own: Pair) -> Iterator[Setting]:
    """Other samplings of the records of a batch, at accuracy reference: nothing of the numerics is in the error."""
    how_well = Numerics("event", "reference")
    asked = replace(batch, model=own[0], geometry=own[1], numerics=how_well)
    if has_samples(batch.excitation) and BACKENDS["event"].supports(asked):
        for how in SAMPLINGS:
            yield Setting(DATA, "event", how, *own, how_well, sampling=how, against="the record as it is")
