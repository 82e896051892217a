"""From the numbers of a batch of cases to the batch that a solver takes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch, Save
from rockcli.scene.block import Block, housner_eta
from rockcli.scene.damping import DASHPOT, Damping
from rockcli.scene.numerics import Numerics
from rockcli.study.features import BACKENDS, DAMPING, available, model_and_geometry
from rockcli.study.motion import build_excitation
from rockcli.study.numbers import Numbers
from rockcli.study.records import Records
from rockcli.study.tree import Keys

Array = NDArray[np.float64]

SCHEME_KEYS: dict[str, tuple[str, ...]] = {"restitution": ("eta", "r_energy"), "dashpot": ("coefficient",)}
"""Keys of a damping scheme beside its name."""

CLAMPED = "Housner's eta is negative (tan alpha > sqrt 2 for a rectangle): taken as 0, the body stops at the impact"


def build_batch(numbers: Numbers, records: Records, save: Save) -> Batch:
    """The batch of these numbers.

    Raises:
        StudyError, RecordError: a case cannot be built, or asks for what this version cannot solve.
    """
    # overflow and its kin are found as values that are not finite
    with np.errstate(all="ignore"):
        return _built(numbers, records, save)


def _built(numbers: Numbers, records: Records, save: Save) -> Batch:
    warnings: list[str] = []
    model, geometry = model_and_geometry(numbers.source, numbers.tree)
    numerics = _numerics(numbers)
    g = numbers.array(numbers.g)
    block = numbers.block
    p = block.p(g)
    numbers.require(("case", "g"), (p > 0.0) & (p < np.inf), "g and the block give no finite p")
    damping = _damping(numbers, warnings)
    excitation = build_excitation(numbers, records, warnings)
    theta_0, theta_dot_0 = _initial(numbers)
    warnings += leaving_its_ground(model, geometry, block)
    return Batch(
        g=g,
        block=block,
        excitation=excitation,
        theta_0=theta_0,
        theta_dot_0=theta_dot_0,
        model=model,
        geometry=geometry,
        damping=damping,
        numerics=numerics,
        save=save,
        warnings=tuple(dict.fromkeys(warnings)),
    )


def leaving_its_ground(model: str, geometry: str | None, block: Block) -> list[str]:
    """Sentences where a model is asked for what it does not describe (2.10), [1.8]."""
    said = []
    if geometry == "corotational" and model in ("2", "3"):
        if (block.tan_alpha > 1.0).any():
            said.append(f"model {model} (corotational) never overturns for tan alpha > 1, as the block does (2.10)")
        if (block.tan_alpha <= 1.0).any():
            said.append(f"model {model} (corotational) overturns at asin(tan alpha), not at alpha as the block (2.10)")
    with np.errstate(invalid="ignore"):
        if (block.tan_alpha > block.mu[:, None]).any():
            said.append("tan alpha > mu: the body slides before it rocks, and sliding is not simulated [1.8]")
    return said


def _initial(numbers: Numbers) -> tuple[Array, Array]:
    keys: Keys = ("case", "initial")
    theta, theta_dot = numbers.value((*keys, "theta")), numbers.value((*keys, "theta_dot"))
    if theta is not None:
        numbers.require((*keys, "theta"), np.abs(theta) < 0.5 * np.pi, "must be between -pi/2 and pi/2 (radians)")
    return numbers.array(0.0 if theta is None else theta), numbers.array(0.0 if theta_dot is None else theta_dot)


def _damping(numbers: Numbers, warnings: list[str]) -> Damping:
    keys: Keys = ("case", "damping")
    given = {key: value for key, value in (numbers.tree["case"].get("damping") or {}).items() if value is not None}
    scheme = available(numbers.source, numbers.tree, keys, given.get("scheme", "restitution"), DAMPING, "damping")
    for key in given:
        if key != "scheme" and key not in SCHEME_KEYS.get(scheme, ()):
            numbers.fail((*keys, key), f"is no key of the damping scheme {scheme}")
    if scheme == "none":
        return Damping(scheme, np.ones((numbers.n, 2)))
    if scheme == "dashpot":
        coefficient = numbers.value((*keys, "coefficient"))
        if coefficient is None:
            coefficient = DASHPOT
        numbers.require((*keys, "coefficient"), np.greater_equal(coefficient, 0.0), "must not be negative")
        return Damping(scheme, np.ones((numbers.n, 2)), coefficient=numbers.array(coefficient))
    if "eta" in given and "r_energy" in given:
        numbers.fail((*keys, "r_energy"), "eta and r_energy say the same thing; leave one out")
    if given.get("eta", "housner") == "housner" and "r_energy" not in given:
        eta = housner_eta(numbers.block)
        if (eta < 0.0).any():
            warnings.append(CLAMPED)
            eta = np.maximum(eta, 0.0)
        return Damping(scheme, eta)
    key = "eta" if "eta" in given else "r_energy"
    value = numbers.value((*keys, key))
    assert value is not None
    numbers.require((*keys, key), np.greater_equal(value, 0.0) & np.less_equal(value, 1.0), "must be between 0 and 1")
    column = numbers.array(value if key == "eta" else np.sqrt(value))
    return Damping(scheme, np.repeat(column[:, None], 2, axis=1))


def _numerics(numbers: Numbers) -> Numerics:
    keys: Keys = ("case", "solver")
    solver = numbers.tree["case"].get("solver") or {}
    asked = solver.get("backend") or "auto"
    backend = available(numbers.source, numbers.tree, (*keys, "backend"), asked, BACKENDS, "backend")
    rtol, dt, yield_rotation = (numbers.constant((*keys, key)) for key in ("rtol", "dt", "yield_rotation"))
    for key, value in (("rtol", rtol), ("dt", dt), ("yield_rotation", yield_rotation)):
        numbers.require((*keys, key), value is None or value > 0.0, "must be greater than 0")
    numbers.require((*keys, "rtol"), rtol is None or rtol < 1.0, "must be below 1")
    return Numerics(
        backend=backend,
        accuracy=solver.get("accuracy") or "standard",
        rtol=rtol,
        method=solver.get("method"),
        events=solver.get("events"),
        dt=dt,
        yield_rotation=yield_rotation,
    )
