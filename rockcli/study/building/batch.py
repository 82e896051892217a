"""From the numbers of a batch of cases to the batch that a solver takes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.auto import AUTO, TOLERANCE
from rockcli.scene.backends import AUTOMATIC, BACKENDS, EVENT, automatic
from rockcli.scene.batch import Batch, Save
from rockcli.scene.body.block import RECTANGLE_INERTIA, Block
from rockcli.scene.body.column import ACROSS, Base, Column
from rockcli.scene.constants import ELEMENTS
from rockcli.scene.laws.contact import slides_first
from rockcli.scene.laws.damping import Damping
from rockcli.scene.laws.models import CONTINUUM, DEFAULT_GEOMETRY, DEFORMABLE, FLEXIBLE, MODELS
from rockcli.scene.numerics import Numerics
from rockcli.study.building.damping import build_damping, fema356_warnings
from rockcli.study.building.ground_motion import build_excitation
from rockcli.study.building.numbers import Numbers
from rockcli.study.building.records import Records
from rockcli.study.document.tree import Keys
from rockcli.study.schema import ColumnPart
from rockcli.study.unused import unused_solver_keys

Array = NDArray[np.float64]


def build_batch(numbers: Numbers, records: Records, save: Save) -> Batch:
    """The batch of these numbers.

    Raises:
        StudyError, RecordError: a case cannot be built, or asks for what this version cannot solve.
    """
    # overflow and its kin are found as values that are not finite
    with np.errstate(all="ignore"):
        return _built(numbers, records, save)


def build_pieces(numbers: Numbers, records: Records) -> tuple[Callable[[], object], ...]:
    """What a batch is built from, piece by piece: each raises what is wrong with it, whatever the others are."""
    return (
        lambda: numbers.block,
        lambda: build_damping(numbers),
        lambda: build_excitation(numbers, records, []),
        lambda: _initial(numbers),
        lambda: _numerics(numbers),
    )


def _built(numbers: Numbers, records: Records, save: Save) -> Batch:
    warnings: list[str] = []
    model, geometry = _model_and_geometry(numbers)
    numerics = _numerics(numbers)
    g = numbers.array(numbers.g)
    block = numbers.block
    numbers.require(("case", "g"), (numbers.p > 0.0) & (numbers.p < np.inf), "g and the block give no finite p")
    damping = build_damping(numbers)
    excitation = build_excitation(numbers, records, warnings)
    theta_0, theta_dot_0 = _initial(numbers)
    if damping.fema356 is not None:
        warnings += fema356_warnings(
            numbers, damping.fema356, excitation, moving=bool(theta_0.any() or theta_dot_0.any())
        )
    bends = _bends(numbers, model)
    warnings += [*numbers.remarks, *leaving_its_ground(model, geometry, block, bends=bends)]
    by = _taken(model, geometry, damping.scheme, numerics.backend)
    _check_rolling(numbers, model, damping)
    slide_rate_0 = _slide_rate(numbers, block)
    # auto takes the column of every body that has one and a mu
    warnings += friction_said(block, slide_rate_0, FLEXIBLE if bends and model == AUTO else model, by)
    warnings += unused_solver_keys(numbers.case.solver, model, geometry, damping.scheme)
    column, base = _column(numbers, model), _base(numbers, model)
    warnings += _unread_of_column(numbers, model)
    if base is not None and base.fibres is not None and not BACKENDS[by].fibres:
        able = " and ".join(row.name for row in BACKENDS.values() if row.fibres)
        warnings.append(f"base.fibres is ignored by backend {by}: {able} have fibres")
    if model == CONTINUUM and damping.scheme not in ("none", "hht"):
        numbers.fail(("case", "damping"), "model continuum loses energy by itself: damping must be none or hht")
    if model == CONTINUUM:
        numbers.require(("case", "initial", "theta_dot"), theta_dot_0 == 0.0, "model continuum starts from rest")
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
        column=column,
        base=base,
        tolerance=_tolerance(numbers, numerics, damping) if model == AUTO else None,
        slide_rate_0=slide_rate_0,
    )


def _model_and_geometry(numbers: Numbers) -> tuple[str, str | None]:
    """The model of a case and its geometry, both of which this version solves."""
    case = numbers.case
    model, geometry = case.model.name, case.geometry
    if model == AUTO:
        return model, None  # a geometry given beside it is that of the models it is compared with
    if case.model.tolerance is not None:
        numbers.fail(("case", "model", "tolerance"), "belongs to model auto")
    if model in DEFORMABLE:
        return model, None  # corotational, whatever the models it is compared with are
    geometries = [pair[1] for pair in MODELS if pair[0] == model]
    if geometries == [None]:
        return model, None  # a geometry given beside it is that of the models it is compared with
    chosen = DEFAULT_GEOMETRY if geometry is None else geometry
    if chosen not in geometries:
        known = ", ".join(map(str, geometries))
        numbers.fail(("case", "geometry"), f"model {model} is available as {known}")
    return model, chosen


def _check_rolling(numbers: Numbers, model: str, damping: Damping) -> None:
    """Refuse for bodies that roll over several vertices what knows but two edges."""
    if not numbers.block.rolls.any():
        return
    backend = numbers.case.solver.backend
    pushed = numbers.value(("case", "initial", "slide_rate")) is not None
    others = (
        (
            ("case", "initial", "slide_rate"),
            pushed,
            "a velocity of a body that rolls, and so cannot slide",
        ),
        (("case", "model"), model != "rigid", f"{model}, which knows but two edges, instead of model rigid"),
        (("case", "damping"), damping.loss is None, f"{damping.scheme}, instead of restitution or none"),
        (("case", "solver", "backend"), backend not in (AUTOMATIC, EVENT), f"{backend}, instead of {EVENT}"),
    )
    for keys, wrong, asked in others:
        if wrong:
            said = (
                "the outline has vertices beside its base, over which the body rolls: case.block.stands: toes leaves it"
            )
            numbers.fail(keys, f"is {asked}; {said} its two edges")


def _tolerance(numbers: Numbers, numerics: Numerics, damping: Damping) -> Array:
    """The error of theta_peak/alpha that model auto may make, (n,).

    Raises:
        StudyError: not between 0 and 1, or auto is asked for what none of its models does.
    """
    keys: Keys = ("case", "model", "tolerance")
    tolerance = numbers.positive(keys)
    numbers.require(keys, tolerance is None or np.less_equal(tolerance, 1.0), "must be at most 1 (of theta/alpha)")
    if damping.scheme not in ("none", "restitution"):
        numbers.fail(("case", "damping"), "model auto chooses among models with damping restitution or none")
    if numerics.backend not in (AUTOMATIC, EVENT):
        numbers.fail(("case", "solver", "backend"), "model auto is solved by backend event")
    return numbers.array(TOLERANCE if tolerance is None else tolerance)


def _column(numbers: Numbers, model: str) -> Column | None:
    """The column of the flexible model, or the mesh of model 4 in finite-element backends; others have none."""
    keys: Keys = ("case", "column")
    given = _column_said(numbers)
    if model == "4" and given is not None:
        unknown = numbers.array(np.nan)
        return Column(unknown, unknown, unknown, _elements(given, model), given.mass)
    if model not in DEFORMABLE and not (model == AUTO and given is not None):
        return None
    if given is None or given.E is None or given.rho is None:
        needs = f"model {model} needs a column with E and rho: {{E: 30*GPa, rho: 2500}}"
        numbers.fail(("case",) if given is None else keys, needs)
    E, rho, zeta = numbers.positive((*keys, "E")), numbers.positive((*keys, "rho")), numbers.value((*keys, "zeta"))
    assert E is not None
    assert rho is not None
    if zeta is not None:
        numbers.require((*keys, "zeta"), np.greater_equal(zeta, 0.0), "must not be negative")
    numbers.require(("case", "block", "b"), numbers.block.symmetric, "the flexible column is symmetric; give one b")
    rectangle = np.abs(numbers.block.inertia - RECTANGLE_INERTIA) < 1e-12
    numbers.require(("case", "block"), rectangle, "the flexible column is a rectangle; inertia and r_g do not apply")
    return Column(
        E=numbers.array(E),
        rho=numbers.array(rho),
        zeta=numbers.array(0.0 if zeta is None else zeta),
        elements=_elements(given, model),
        mass=given.mass,
        across=ACROSS if given.across is None else given.across,
    )


def _column_said(numbers: Numbers) -> ColumnPart | None:
    """The column of a case; one of which nothing is said is none."""
    column = numbers.case.column
    return column if column is not None and column.model_fields_set else None


COLUMN_KEYS = {"4": ("elements", "mass"), CONTINUUM: ("E", "rho", "zeta", "elements", "across")}
"""Keys of a column that models read; others all but `across`."""


def _unread_of_column(numbers: Numbers, model: str) -> list[str]:
    """A sentence for each key of a column that the model does not read; of models without one another warning tells."""
    given = _column_said(numbers)
    if given is None or model not in (*DEFORMABLE, "4"):
        return []
    read = COLUMN_KEYS.get(model, ("E", "rho", "zeta", "elements", "mass"))
    said = [key for key in type(given).model_fields if key in given.model_fields_set and key not in read]
    return [f"column.{key} is ignored by model {model}, which reads {', '.join(read)}" for key in said]


def _elements(column: ColumnPart, model: str) -> int:
    """Elements along the height: those of a full mesh are square by themselves."""
    if column.elements is not None:
        return column.elements
    return 0 if model == CONTINUUM else ELEMENTS


def _base(numbers: Numbers, model: str) -> Base | None:
    """What the body stands on; None is the rigid base."""
    keys: Keys = ("case", "base")
    given, scheme = numbers.case.base, numbers.said(("case", "damping", "scheme"))
    if given is None or given.law == "rigid":
        if given is not None and given.kw is not None:
            numbers.fail((*keys, "kw"), "belongs to base law winkler")
        return None
    if model == AUTO and _column_said(numbers) is None:
        numbers.fail(keys, "a winkler base needs a column beside it: {E: 30*GPa, rho: 2500}")
    if model not in (*DEFORMABLE, AUTO) and not (model == "4" and scheme == "hht"):
        models = ", ".join(DEFORMABLE)
        numbers.fail((*keys, "law"), f"winkler is a base of models {models}, or of model 4 with damping hht")
    kw = numbers.positive((*keys, "kw"))
    if kw is None:
        numbers.fail(keys, "base law winkler needs kw [N/m³]")
    return Base("winkler", numbers.array(kw), given.fibres)


def _bends(numbers: Numbers, model: str) -> bool:
    """Whether the displacement reported is that of a column's end."""
    return model in DEFORMABLE or (model == AUTO and _column_said(numbers) is not None)


def leaving_its_ground(model: str, geometry: str | None, block: Block, *, bends: bool) -> list[str]:
    """Sentences where a model is asked for what it does not describe (2.10), [1.8].

    `bends`: whether what moves is the end of a column (`_bends`).
    """
    said = []
    if geometry == "corotational" and model in ("2", "3"):
        if (block.tan_alpha > 1.0).any():
            said.append(f"model {model} (corotational) never overturns for tan alpha > 1, as the block does (2.10)")
        if (block.tan_alpha <= 1.0).any():
            said.append(f"model {model} (corotational) overturns at asin(tan alpha), not at alpha as the block (2.10)")
    if bends and (np.abs(block.top - 2.0 * block.h) > 1e-9 * block.h).any():
        said.append(f"block.top has no use in model {model}: the displacement is that of the column's end, at 2h")
    if (block.rolls & np.isfinite(block.mu)).any():
        said.append(
            "a body that rolls over several vertices is not followed where it would slide: cases whose mu does not "
            "hold have no answer (block.stands: toes leaves it its two edges, and it slides)"
        )
    return said


def _taken(model: str, geometry: str | None, scheme: str, backend: str) -> str:
    """The backend that solves the cases; where there is none, or several by turns (model auto), `event`."""
    if backend != AUTOMATIC:
        return backend
    found = automatic(model, geometry, scheme)
    return EVENT if found is None else found.name


SLIDES_FIRST = "a body of mu <= tan alpha slides before it rocks (`rock check` says which do)"
"""A warning, which tells also why a suite of such bodies has no fragility curve."""


def friction_said(block: Block, slide_rate_0: Array | None, model: str, backend: str) -> list[str]:
    """A sentence where friction decides that a body slides first, or where nothing looks at it."""
    if not np.isfinite(block.mu).any():
        return []
    if model in DEFORMABLE or backend != EVENT:
        who = f"model {model}" if backend == EVENT else f"backend {backend}"
        pushed = slide_rate_0 is not None and slide_rate_0.any()
        what = "block.mu and initial.slide_rate are" if pushed else "block.mu is"
        return [f"{what} ignored by {who}, which solves no sliding"]
    if slides_first(block.mu[:, None], block.tan_alpha).any():
        return [SLIDES_FIRST]
    return []


def _initial(numbers: Numbers) -> tuple[Array, Array]:
    keys: Keys = ("case", "initial")
    theta, theta_dot = numbers.value((*keys, "theta")), numbers.value((*keys, "theta_dot"))
    assert theta is not None
    assert theta_dot is not None
    numbers.require((*keys, "theta"), np.abs(theta) < 0.5 * np.pi, "must be between -pi/2 and pi/2 (radians)")
    return numbers.array(theta), numbers.array(theta_dot)


def _numerics(numbers: Numbers) -> Numerics:
    keys: Keys = ("case", "solver")
    solver = numbers.case.solver
    rtol, dt, yield_rotation = (numbers.constant((*keys, key)) for key in ("rtol", "dt", "yield_rotation"))
    for key, value in (("rtol", rtol), ("dt", dt), ("yield_rotation", yield_rotation)):
        numbers.require((*keys, key), value is None or value > 0.0, "must be greater than 0")
    numbers.require((*keys, "rtol"), rtol is None or rtol < 1.0, "must be below 1")
    least = BACKENDS[EVENT if solver.backend == AUTOMATIC else solver.backend].least_rtol
    numbers.require(
        (*keys, "rtol"), rtol is None or rtol >= least, f"must be at least {least:g}: double precision holds no more"
    )
    return Numerics(
        backend=solver.backend,
        accuracy=solver.accuracy,
        rtol=rtol,
        method=solver.method,
        events=solver.events,
        dt=dt,
        yield_rotation=yield_rotation,
    )


def _slide_rate(numbers: Numbers, block: Block) -> Array | None:
    """Initial velocity along the ground, (n,) [m/s]; None where the study gives none."""
    keys: Keys = ("case", "initial", "slide_rate")
    rate = numbers.value(keys)
    if rate is None:
        return None
    numbers.require(keys, np.isfinite(block.mu), "needs a mu of the block: without one the body cannot slide")
    return numbers.array(rate)
