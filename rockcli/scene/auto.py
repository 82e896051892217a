"""Model auto: which model a case requires, by its dimensionless groups and a table of measured errors (docs/auto.md).

Candidates, cheapest first: none (the body does not move), rigid, flexible, winkler (flexible with partial uplift).  The
reference is the highest one that a body's data allow.  The error of a candidate is |its theta_peak/alpha minus the
reference's|, 0 where both overturn, infinite where one does.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.auto_table import CHANCES, EXCEEDED, TABLES, TRIED
from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import Channel, Pulses, Samples
from rockcli.scene.laws.models import FLEXIBLE
from rockcli.scene.variables import SCALARS_AUTO

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

AUTO = "auto"

TOLERANCE = 0.02
"""Error of theta_peak/alpha allowed where the study says nothing."""

NONE, RIGID, COLUMN, WINKLER = 0, 2, 3, 4

CANDIDATES: dict[int, str] = {
    -1: "not_auto",
    NONE: "none",
    1: "linearized",
    RIGID: "rigid",
    COLUMN: "flexible",
    WINKLER: "flexible_winkler",
}
"""Flags of `model_used`.  The linearized block is taken no more: it costs what choosing it would save."""

AT_REST = "auto: none: the rigid block, the highest model of this body, stays at rest"

FREE_OVER_CLAMPED = 4.385
"""First bending frequency of a rocking (pinned) column over that of a clamped one."""

PERTURBATION = 0.05
"""Relative change of the motion by which the rigid block is tried."""

RIGID_CLASSES: tuple[str, ...] = (
    "it stays at rest, also with 5 % more motion",
    "its peak is known to 0.01 alpha",
    "its peak is known to 0.03 alpha",
    "its peak is known to 0.1 alpha",
    "its peak is not known to 0.1 alpha",
    "it is close to overturning",
    "it overturns, also with 5 % less motion",
)
"""What the rigid block does, tried with 5 % more and less motion and with the law that stiff columns tend to."""


GROUP_OF = {"rigid": "p_T1", "flexible": "opening"}
"""Step of the table: the group along its rows."""

PAYS = 0.3
"""Chance of serving from which the rigid block is tried: of one case, four of them take a tenth of a column's time."""

STIFF, GENTLE = 0.05, 0.5
"""p T_1 and PGA/(g tan(alpha)) above which, both, vibrations may lift a column though the rigid block stays at rest.
On a Winkler base, whose springs nothing damps, those of the stiffest may: there the second counts alone.
The table has these cases in bins with weaker motions, and too small a number (docs/auto.md)."""

PERIODS: dict[str, float] = {
    "ricker": np.inf,
    "ricker_antisymmetric": np.inf,
    "sine": 1.0,
    "cosine": 1.0,
    "half_sine": np.inf,
    "mavroeidis_papageorgiou": 2.0,
}
"""Pulse shapes of the calibration: periods T_p that they last there.  In longer trains a column builds up vibrations
and rocks where the table says that it stays at rest."""

DECIDES = "only it decides whether the body overturns"
"""Why the reference is taken of bodies that move where outcomes alone are asked for."""

STILL = 0
"""The class of RIGID_CLASSES known without a trial: a body that 5 % more motion does not lift stays at rest."""


@dataclass(frozen=True, eq=False)
class Groups:
    """Dimensionless groups of n cases; NaN where a case has none.

    Attributes:
        alpha: of the weaker edge [rad].
        eta: restitution.
        amplitude: PGA/(g tan(alpha)).
        rate: PGA/PGV over p.
        p_T1: p times the clamped first period (4.3).
        zeta: damping ratio of the column.
        opening: m g/(2 kw b^2)/alpha, the rotation at which a Winkler base opens over alpha.
        record: whether the motion is a record; the same for all.
    """

    alpha: Array
    eta: Array
    amplitude: Array
    rate: Array
    p_T1: Array
    zeta: Array
    opening: Array
    record: bool

    def rows(self, at: NDArray[np.int64]) -> Groups:
        """Those of some of the cases, by their places (k,)."""
        arrays = {f.name: getattr(self, f.name)[at] for f in fields(self) if f.name != "record"}
        return replace(self, **arrays)


def highest(batch: Batch) -> Batch:
    """A batch of model auto with the highest model its data allow: flexible with a column, on the base it has.

    Any other batch is its own highest.
    """
    if batch.model != AUTO:
        return batch
    return replace(batch, model="rigid" if batch.column is None else FLEXIBLE)


def candidate_of_reference(batch: Batch) -> int:
    """The candidate that `highest` is."""
    if batch.column is None:
        return RIGID
    return COLUMN if batch.base is None else WINKLER


def as_candidate(batch: Batch, candidate: int) -> Batch:
    """The batch with the model of a candidate; `none` is the rigid block, which stays at rest."""
    if candidate == WINKLER:
        return replace(batch, model=FLEXIBLE)
    if candidate == COLUMN:
        return replace(batch, model=FLEXIBLE, base=None)
    # the displacement is that of the same point, whatever the candidate: of the end of the column
    block = batch.block if batch.column is None else replace(batch.block, top=2.0 * batch.block.h)
    return replace(batch, model="rigid", block=block, column=None, base=None)


def groups_of(batch: Batch, pga: Array, pgv: Array) -> Groups:
    """Groups of a batch; `pga` [m/s²] and `pgv` [m/s] of each case, (n,)."""
    block, n = batch.block, batch.size
    alpha, tan_alpha = block.of_weak_edge(block.alpha), block.of_weak_edge(block.tan_alpha)
    p, unknown = block.of_weak_edge(batch.p), np.full(n, np.nan)
    p_T1 = zeta = opening = unknown
    if batch.column is not None:
        T_1 = 12.38 * np.sqrt(batch.column.rho / batch.column.E) * block.h / tan_alpha
        p_T1, zeta = p * T_1, batch.column.zeta
        if batch.base is not None:
            weight = batch.column.rho * 4.0 * block.b[:, 0] * block.h * batch.g
            opening = weight / (2.0 * batch.base.kw * block.b[:, 0] ** 2) / alpha
    return Groups(
        alpha=alpha,
        eta=block.of_weak_edge(batch.damping.eta),
        amplitude=pga / (batch.g * tan_alpha),
        rate=pga / pgv / p,
        p_T1=p_T1,
        zeta=zeta,
        opening=opening,
        record=isinstance(batch.excitation.horizontal, Samples),
    )


def bending_at_uplift(p_T1: float) -> float:
    """Static bending of the top under a_g = g tan(alpha), w/(2h alpha) = 3 rho g h/(E alpha^2) (slender), by p T_1."""
    return 3.0 * p_T1**2 / (0.75 * 12.38**2)


def outside(batch: Batch, groups: Groups) -> list[str]:
    """Why each case is not one the table speaks of, "" where it is."""
    excitation, block = batch.excitation, batch.block
    said = [""] * batch.size
    checks: list[tuple[NDArray[np.bool_] | bool, str]] = [
        (excitation.horizontal is None, "there is no horizontal motion"),
        *_of_motion(excitation.horizontal),
        (excitation.vertical is not None, "there is a vertical motion"),
        ((batch.theta_0 != 0.0) | (batch.theta_dot_0 != 0.0), "the body moves at t = 0"),
        (np.isfinite(excitation.duration), "the response is cut off by `duration`"),
        (~block.symmetric, "the body is asymmetric"),
        (np.isfinite(block.mu), "mu is given"),
    ]
    wanted = ["alpha", "eta", "amplitude", "rate"]
    wanted += ["p_T1", "zeta"] if batch.column is not None else []
    wanted += ["opening"] if batch.base is not None else []
    for name in wanted:
        low, high = TRIED[name]
        values = getattr(groups, name)
        checks.append((~((values >= low) & (values <= high)), f"{_WORDS[name]} is not in {low:g} to {high:g}"))
    for which, why in checks:
        for i in np.flatnonzero(np.broadcast_to(which, batch.size)):
            said[i] = said[i] or why
    return said


def _of_motion(horizontal: Channel | None) -> list[tuple[NDArray[np.bool_] | bool, str]]:
    """Which horizontal motions are of a kind that the table does not speak of, and why."""
    if not isinstance(horizontal, Pulses):
        return [(horizontal is not None and horizontal.ground is not None, "the motion is that of a floor")]
    periods = PERIODS.get(horizontal.shape)
    if periods is None:
        return [(True, f"the calibration has no pulse of shape {horizontal.shape}")]
    lasts = np.ptp(horizontal.table[:, -1, :2], axis=1) * horizontal.omega_p / (2.0 * np.pi)
    return [(lasts > periods * (1.0 + 1e-9), f"the pulse lasts longer than {periods:g} T_p")]


_WORDS = {
    "alpha": "alpha",
    "eta": "eta",
    "amplitude": "PGA/(g tan alpha)",
    "rate": "PGA/(PGV p)",
    "p_T1": "p T_1",
    "zeta": "zeta",
    "opening": "m g/(2 kw b^2 alpha)",
}


def class_of_rigid(peak: Array, tried: Array) -> Ints:
    """Index into RIGID_CLASSES, (n,).

    Args:
        peak: of the rigid block over alpha, (n,), inf overturned, NaN unknown.
        tried: the same of its neighbours, (k, n).
    """
    every = np.vstack([peak, tried])
    fell = np.isinf(every)
    with np.errstate(invalid="ignore"):
        spread = np.max(np.abs(tried - peak), axis=0)
    found = 1 + np.digitize(spread, (0.01, 0.03, 0.1))
    found = np.where((every == 0.0).all(axis=0), 0, found)
    found = np.where(fell.any(axis=0) | np.isnan(every).any(axis=0), 5, found)
    return np.where(fell.all(axis=0), 6, found).astype(np.int64)


def expected_errors(step: str, groups: Groups) -> Array:
    """Error that all but a few of the measured scenes of the same bin kept below, (n, classes); inf outside the bins,
    and of a column at rest that its vibrations may lift.

    Args:
        step: `rigid` (against flexible) or `flexible` (against winkler).
        groups: of n cases.
    """
    edges, values = TABLES[step]
    found = _row_of(getattr(groups, GROUP_OF[step]), edges, values[_kind(groups)])
    stiff = (groups.p_T1 <= STIFF) & (step == "rigid")
    found[~stiff & (groups.amplitude > GENTLE), STILL] = np.inf
    return found


def chance(groups: Groups, serves: NDArray[np.bool_]) -> Array:
    """Share of the measured scenes of a like amplitude/rate = PGV p/(g tan alpha) in which a rigid block served, (n,).

    Args:
        groups: of n cases.
        serves: in which of its classes it would, (n, classes).
    """
    edges, shares = CHANCES
    found = _row_of(groups.amplitude / groups.rate, edges, shares[_kind(groups)])
    return np.asarray(np.sum(np.where(serves & np.isfinite(found), found, 0.0), axis=1))


def _kind(groups: Groups) -> str:
    return "record" if groups.record else "pulse"


def _row_of(x: Array, edges: tuple[float, ...], values: tuple[tuple[float, ...], ...]) -> Array:
    """The row of a table that each x falls into, (n, columns); inf outside the edges."""
    row = np.searchsorted(edges, x, side="right") - 1
    row = np.where(x == edges[-1], len(edges) - 2, row)
    inside = (row >= 0) & (row < len(edges) - 1)
    return np.where(inside[:, None], np.array(values)[np.clip(row, 0, len(edges) - 2)], np.inf)


def sentences(write: Callable[[int], str], *columns: NDArray[np.generic]) -> list[str]:
    """A sentence for each of n cases; `write(i)` is called once for all that are as case i in every column (n,)."""
    key = np.zeros(len(columns[0]), dtype=np.int64)
    for column in columns:
        values, place = np.unique(column, return_inverse=True)
        key = key * len(values) + place
    _, first, place = np.unique(key, return_index=True, return_inverse=True)
    written = [write(int(i)) for i in first]
    return [written[k] for k in place.tolist()]


def outcomes_alone(batch: Batch) -> bool:
    """Whether nothing but outcomes is asked for, as in a search for overturning, and perhaps what model gave them."""
    return batch.save.scalars - {*SCALARS_AUTO, "reason"} == {"outcome"}


def prospect(batch: Batch, groups: Groups, searched: bool = False) -> str:
    """What would be chosen for the first case of a batch, as far as the table says it before anything is solved.

    Args:
        batch, groups: a case.
        searched: whether it is one of a search for overturning.
    """
    assert batch.tolerance is not None
    reference, tolerance = candidate_of_reference(batch), float(batch.tolerance[0])
    top, why = _name(reference), outside(batch, groups)[0]
    if reference == RIGID:
        return f"{top}, the highest model of this body: it has no column"
    if why:
        return f"{top}, the highest model of this body: {why}"
    if (searched or outcomes_alone(batch)) and not still(groups)[0]:
        return f"{top}, the highest model of this body: {DECIDES}"
    words = RIGID_CLASSES[: STILL + 1] if still(groups)[0] else RIGID_CLASSES
    bending, opening = expected_errors("rigid", groups)[:1], np.zeros(1)
    if reference == WINKLER:
        opening = expected_errors("flexible", groups)[:1]
    serve = bending + opening <= tolerance
    said = [words[j] for j in np.flatnonzero(serve[0, : len(words)])]
    if not said or (len(words) > 1 and chance(groups, serve)[0] < PAYS):
        as_column = reference == WINKLER and bool((opening[0, : len(words)] <= tolerance).any())
        return f"{_name(COLUMN)} or {top}" if as_column else top
    return f"rigid if {', or '.join(said)}; else {top}"


def still(groups: Groups) -> NDArray[np.bool_]:
    """Which bodies 5 % more motion does not lift, (n,)."""
    return np.asarray(groups.amplitude * (1.0 + PERTURBATION) <= 1.0)


def _name(candidate: int) -> str:
    return CANDIDATES[candidate].replace("_", " on ")


def doubt(model: str, error: float, doing: str) -> str:
    """Why a cheap model does not serve."""
    off = f"may be off by {error:.2g} alpha" if np.isfinite(error) else "may be far off"
    return f"the {model} block {off} ({doing})"


def sentence(candidate: int, reference: int, error: float, why: str) -> str:
    """What was chosen, why, and the error expected."""
    name, top = _name(candidate), _name(reference)
    if candidate == reference:
        return f"auto: {name}, the highest model of this body: {why}"
    held = f"in {100 - EXCEEDED:g} % of such cases"
    if candidate != NONE and error == 0.0:  # it overturns: there the error is none, or infinite
        return f"auto: {name}: {why}; {top} overturns too {held}"
    return f"auto: {name}: {why}; error against {top} below {error:.2g} alpha {held}"
