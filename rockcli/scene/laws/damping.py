"""Damping schemes, a row each: restitution at impacts, base dashpot, numerical (HHT), FEMA-356."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.body.block import Block, housner_eta
from rockcli.scene.ground.spectra import DesignSpectrum
from rockcli.scene.repeated import once, repeated

Array = NDArray[np.float64]

DASHPOT = 0.02
"""The thesis's coefficient of the base damper (3.3)."""

STRONGEST_DAMPER = 1e4
"""Base damper above which a case is refused, c/(I_O p)."""

CLAMPED = "Housner's eta is negative (tan alpha > sqrt 2 for a rectangle): taken as 0, the body stops at the impact"


@dataclass(frozen=True, eq=False)
class Fema356:
    """What the procedure of FEMA-356 [3.4] needs beside the body.

    Attributes:
        W_over_Mg: weight carried at the base over M g of the seismic mass, (n,).
        fixed_base_period: elastic period without rocking, (n,) [s]; NaN where the study gives none.
        spectrum: design spectrum, or None for the response spectrum of the motion itself.
    """

    W_over_Mg: Array
    fixed_base_period: Array
    spectrum: DesignSpectrum | None = None


@dataclass(frozen=True, eq=False)
class Damping:
    """A damping scheme of a batch.

    Attributes:
        scheme: its name; the schemes are in `SCHEMES`.
        eta: ratio of angular velocities just after / just before an impact, (n, 2); column j when the body
            lands on edge j (0 left, 1 right).  Ones where nothing is lost.
        coefficient: of the dashpot c = coefficient (alpha/0.1)^2 m g^0.5 R^1.5 (3.3), (n,); None without one.
        fema356: of that scheme, else None.
        alpha_d: parameter of the HHT integrator in [2/3, 1] of that scheme, (n,); None = the backend's default.
        loss: power of Housner's loss at every vertex of a body that rolls over several, (n,): 1 his, 0 none; None of
            bodies on two edges, for which eta says it.
    """

    scheme: str
    eta: Array
    coefficient: Array | None = None
    fema356: Fema356 | None = None
    alpha_d: Array | None = None
    loss: Array | None = None

    @property
    def only_eta(self) -> bool:
        """Whether nothing is lost but at impacts, by `eta`: all that the lanes and the contact kernel know."""
        others = (field.name for field in fields(self) if field.name not in ("scheme", "eta", "loss"))
        return all(getattr(self, name) is None for name in others)


def dashpot_rate(coefficient: Array, alpha: Array, R: Array, inertia: Array, g: Array) -> Array:
    """c / I_O of the base damper (3.3), of the shape of alpha [1/s]: c = coefficient (alpha/0.1)^2 m g^0.5 R^1.5."""
    return np.asarray(coefficient * (alpha / 0.1) ** 2 * np.sqrt(g / R) / inertia)


Values = Mapping[str, Array | None]
"""What a study gives for the keys of a scheme, (n,) each; None where it gives nothing."""

Check = tuple[Callable[[Array, Block, Array], NDArray[np.bool_]], str]
"""`good(value, block, g)` of a key, and what it must be in words."""

POSITIVE: Check = (lambda value, block, g: value > 0.0, "must be greater than 0")
NOT_NEGATIVE: Check = (lambda value, block, g: value >= 0.0, "must not be negative")
SHARE: Check = (lambda value, block, g: (value >= 0.0) & (value <= 1.0), "must be between 0 and 1")


def _can_be_scaled(value: Array, block: Block, g: Array) -> NDArray[np.bool_]:
    rolls = block.rolls
    if not rolls.any():
        return np.ones(block.size, dtype=bool)
    return np.asarray(~rolls | (value == 1.0) | (housner_eta(block) > 0.0).all(axis=1))


SCALED: Check = (
    _can_be_scaled,
    "cannot be told of the other vertices of the outline, as Housner's eta on its base is not positive",
)


@dataclass(frozen=True)
class Key:
    """A key of a scheme in the study.

    Attributes:
        name, sentence: what it is called, and what it is.
        checks: what its value must be.
        instead_of: keys that say the same thing.
        word: what may stand for the number that follows from the body.
        number: whether it is a number; else `study/building/damping.py` reads it.
    """

    name: str
    sentence: str
    checks: tuple[Check, ...] = ()
    instead_of: tuple[str, ...] = ()
    word: str = ""
    number: bool = True


@dataclass(frozen=True)
class Scheme:
    """A row: `make(values, block, g)` gives the damping of bodies at g (n,).

    `impacts`: whether eta is lost at impacts.  `doubt`: a sentence on the bodies that `doubted(values, block)` tells,
    (n,).
    """

    name: str
    sentence: str
    make: Callable[[Values, Block, Array], Damping]
    keys: tuple[Key, ...] = ()
    impacts: bool = False
    doubt: str = ""
    doubted: Callable[[Values, Block], NDArray[np.bool_]] = lambda values, block: np.zeros(block.size, dtype=bool)


def _lossless(block: Block) -> Array:
    return repeated(np.ones((1, 2)), block.size)


def _or(value: Array | None, default: float, block: Block) -> Array:
    return np.full(len(block.h), default) if value is None else value


def _none(values: Values, block: Block, g: Array) -> Damping:
    return Damping("none", _lossless(block), loss=_loss(block, np.zeros(block.size)))


def _loss(block: Block, loss: Array) -> Array | None:
    return None if block.vertices is None else loss


def _restitution(values: Values, block: Block, g: Array) -> Damping:
    eta, r_energy = values["eta"], values["r_energy"]
    if r_energy is not None:
        eta = np.sqrt(r_energy)
    if eta is not None:
        both = once(lambda eta: np.repeat(eta[:, None], 2, axis=1), eta)
        return Damping("restitution", both, loss=None if block.vertices is None else _power(eta, housner_eta(block)))
    housner = housner_eta(block)
    kept = np.maximum(housner, 0.0) if (housner < 0.0).any() else housner
    if values["loss"] is None:
        return Damping("restitution", kept, loss=_loss(block, np.ones(block.size)))
    # of two unequal edges what is lost is told by the root of the energy: sqrt(I_i/I_j) changes the rate without loss
    both = np.sqrt(kept[:, :1] * kept[:, 1:])
    loss = values["loss"][:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        lossy = np.where(both > 0.0, kept * both ** (loss - 1.0), np.where(loss > 0.0, 0.0, 1.0))
    return Damping("restitution", np.where(loss == 1.0, kept, lossy), loss=_loss(block, values["loss"]))


def _power(eta: Array, housner: Array) -> Array:
    """The power of Housner's loss that a restitution is at an impact between the two edges, (n,)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        power = np.log(eta) / (0.5 * np.log(np.prod(np.maximum(housner, 0.0), axis=1)))
    return np.where(eta == 1.0, 0.0, power)


def _clamped(values: Values, block: Block) -> NDArray[np.bool_]:
    by_housner = values["eta"] is None and values["r_energy"] is None
    return once(lambda eta: (eta < 0.0).any(axis=1) & by_housner, housner_eta(block))


def _dashpot(values: Values, block: Block, g: Array) -> Damping:
    return Damping("dashpot", _lossless(block), coefficient=_or(values["coefficient"], DASHPOT, block))


def _overdamped(coefficient: Array, block: Block, g: Array) -> NDArray[np.bool_]:
    # explicit steps would have to be as short as c/I_O is large
    rate = dashpot_rate(coefficient[:, None], block.alpha, block.R, block.inertia, g[:, None])
    return np.asarray(rate <= STRONGEST_DAMPER * block.p(g))


def _hht(values: Values, block: Block, g: Array) -> Damping:
    return Damping("hht", _lossless(block), alpha_d=values["alpha_d"])


def _fema356(values: Values, block: Block, g: Array) -> Damping:
    weight, period = (_or(values[key], default, block) for key, default in _OF_FEMA356.items())
    return Damping("fema356", np.maximum(housner_eta(block), 0.0), fema356=Fema356(weight, period))


HOUSNER = "housner"
"""What stands for the eta that follows from the body."""

_OF_FEMA356 = {"W_over_Mg": 1.0, "fixed_base_period": np.nan}

_ROWS: tuple[Scheme, ...] = (
    Scheme("none", "nothing is lost", _none),
    Scheme(
        "restitution",
        "event-based damping, [3.2, 3.5]: what Housner's impact leaves, or a coefficient of restitution",
        _restitution,
        (
            Key(
                "eta",
                "angular velocity after / before an impact, in [0, 1]; default housner",
                (SHARE, SCALED),
                (),
                HOUSNER,
            ),
            Key(
                "r_energy",
                "kinetic energy after / before an impact, eta^2, in [0, 1]",
                (SHARE, SCALED),
                instead_of=("eta",),
            ),
            Key(
                "loss",
                "power of Housner's eta [1]: 1 his, 0 nothing is lost",
                (NOT_NEGATIVE,),
                instead_of=("eta", "r_energy"),
            ),
        ),
        impacts=True,
        doubt=CLAMPED,
        doubted=_clamped,
    ),
    Scheme(
        "dashpot",
        "a rotational damper at the base, acting all the time, no loss at impacts, (3.3)",
        _dashpot,
        (
            Key(
                "coefficient",
                f"coefficient [1]; default {DASHPOT}",
                (
                    NOT_NEGATIVE,
                    (
                        _overdamped,
                        f"makes a base damper of c/(I_O p) above {STRONGEST_DAMPER:g}, in which nothing rocks "
                        f"(2 is critical): the usual coefficient is {DASHPOT}",
                    ),
                ),
            ),
        ),
    ),
    Scheme(
        "hht",
        "the dissipation of the time integrator over a no-tension base, [3.3]",
        _hht,
        (
            Key(
                "alpha_d",
                "parameter, in [2/3, 1]",
                (
                    (
                        lambda value, block, g: (value >= 2.0 / 3.0 - 1e-9) & (value <= 1.0),
                        "must be between 2/3 (most dissipation) and 1 (none)",
                    ),
                ),
            ),
        ),
    ),
    Scheme(
        "fema356",
        "an equivalent linear oscillator, [3.4]",
        _fema356,
        (
            Key("W_over_Mg", "weight over M g [1]", (POSITIVE,)),
            Key("fixed_base_period", "elastic period without rocking [s], for the rocking potential", (POSITIVE,)),
            Key("spectrum", "design spectrum, or `motion` (default)", number=False),
        ),
        impacts=True,
    ),
)

SCHEMES: dict[str, Scheme] = {row.name: row for row in _ROWS}

DEFAULT_SCHEME = "restitution"
