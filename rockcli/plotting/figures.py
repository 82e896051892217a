"""Which figures there are, which a dataset suggests, and which it cannot show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rockcli.errors import StudyError
from rockcli.plotting.common import style
from rockcli.plotting.common.apply_look import apply_look
from rockcli.plotting.common.cases import axes_of, is_numeric
from rockcli.plotting.common.selection import hint, selected
from rockcli.plotting.common.suite import end_to_end, suite_of
from rockcli.plotting.kinds import (
    barriers,
    bending,
    body,
    boundaries,
    curve,
    fragility,
    histories,
    ida,
    intensities,
    motion,
    overlay,
    phase,
    polar,
    ranking,
    risk,
    samples,
    spectrum,
    suite_curve,
    work_precision,
)
from rockcli.plotting.kinds import map as outcomes
from rockcli.plotting.kinds import static_curves as curves
from rockcli.scene.looks import Look
from rockcli.scene.thresholds import FOUND

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Kind:
    """A row: name, what it shows, why a dataset cannot be drawn so ("" if it can), and how it is drawn."""

    name: str
    sentence: str
    why_not: Callable[[xarray.Dataset], str]
    draw: Callable[[xarray.Dataset], Figure]


def _without_histories(dataset: xarray.Dataset) -> str:
    missing = [name for name in ("theta", "theta_dot", "alpha") if name not in dataset.variables]
    return "the dataset holds no histories (save: {histories: true})" if missing else ""


def _without_map(dataset: xarray.Dataset) -> str:
    if outcomes.plane(dataset) is not None and "outcome" in dataset.variables:
        return ""
    return _without_curve(dataset)


def _without_curve(dataset: xarray.Dataset) -> str:
    if curve.along(dataset) is None:
        return "the dataset has no numeric axis"
    return "" if curve.quantity(dataset) else "theta_peak_over_alpha was not saved"


def _draw_map(dataset: xarray.Dataset) -> Figure:
    """Two numeric axes make a map; one makes curves."""
    mapped = outcomes.plane(dataset) is not None and "outcome" in dataset.variables
    return outcomes.draw(dataset) if mapped else _draw_curve(dataset)


def _draw_curve(dataset: xarray.Dataset) -> Figure:
    """Of a suite what it comes to, not some of its members."""
    return curve.draw(dataset) if suite_curve.along(dataset) is None else suite_curve.draw(dataset)


def _draw_histories(dataset: xarray.Dataset) -> Figure:
    """Compared cases are laid over their reference."""
    return overlay.draw(dataset) if overlay.compares(dataset) else histories.draw(dataset)


_ROWS: tuple[Kind, ...] = (
    Kind(
        "histories",
        "rotation, angular velocity, ground acceleration against time",
        _without_histories,
        _draw_histories,
    ),
    Kind("motion", "ground acceleration and its response spectrum", motion.without_motion, motion.draw),
    Kind("bending", "rotation and top of flexible columns and other models", bending.without_bending, bending.draw),
    Kind("phase", "angular velocity against rotation, with the separatrix", _without_histories, phase.draw),
    Kind("map", "outcomes over two numeric axes; over one as `curve`", _without_map, _draw_map),
    Kind(
        "curve",
        "peaks, or lowest overturning values, over one numeric axis; of a suite the share that overturns",
        _without_curve,
        _draw_curve,
    ),
    Kind(
        "ranking",
        "peaks, lowest overturning values or a suite's medians or shares of bodies by name, worst first",
        ranking.without_ranking,
        ranking.draw,
    ),
    Kind("polar", "peaks by direction of the motion or the body", polar.without_directions, polar.draw),
    Kind(
        "boundaries",
        "lines between the outcomes of a refined map",
        boundaries.without_boundaries,
        boundaries.draw,
    ),
    Kind(
        "ida", "peaks of a suite against intensity, with fractiles", ida.without_ida, lambda d: ida.draw(end_to_end(d))
    ),
    Kind(
        "fragility",
        "share of a suite that exceeds limit states",
        fragility.without_fragility,
        lambda d: fragility.draw(end_to_end(d)),
    ),
    Kind(
        "intensities",
        "overturning over two intensities, with lines of equal probability",
        intensities.without_intensities,
        lambda d: intensities.draw(end_to_end(d)),
    ),
    Kind(
        "risk",
        "hazard curves, fragility, deaggregation, survival",
        risk.without_risk,
        lambda d: risk.draw(end_to_end(d)),
    ),
    Kind("samples", "peaks of uncertain bodies, and which input matters", samples.without_samples, samples.draw),
    Kind(
        "spectrum",
        "peaks against size, 2 pi/p",
        lambda d: spectrum.without_spectrum(end_to_end(d)),
        lambda d: spectrum.draw(end_to_end(d)),
    ),
    Kind("work_precision", "error against cost (`rock trade`)", work_precision.without_trade, work_precision.draw),
    Kind("body", "outline, centre of mass, edges and alpha of bodies", body.without_body, body.draw),
    Kind("barriers", "body of a mesh, and its barrier by direction", barriers.without_barriers, barriers.draw),
    Kind("curves", "static curves of the block and its models, with their errors", curves.without_curves, curves.draw),
)

KINDS: dict[str, Kind] = {row.name: row for row in _ROWS}


def default_kinds(dataset: xarray.Dataset) -> tuple[str, ...]:
    """Kinds of figure the content suggests: a map for numeric sweeps, histories and portraits where there are any."""
    chosen = [] if body.without_outline(dataset) else ["body"]
    if not barriers.without_barriers(dataset):
        chosen = ["barriers"] if np.isfinite(dataset["barrier"].values).all() else ["body", "barriers"]
    numeric = [a for a in axes_of(dataset) if is_numeric(dataset, a) and dataset.sizes[a] >= 3]
    if not _without_histories(dataset):
        moves = _moves(dataset, "theta")
        if moves or _moves(dataset, "a_g") or _moves(dataset, "a_v"):
            chosen.append("histories")
        if not bending.without_bending(dataset):
            chosen.append("bending")
        if moves:
            chosen.append("phase")
    if suite_of(dataset) is not None:
        rows = {"ida": ida.without_ida, "fragility": fragility.without_fragility, "risk": risk.without_risk}
        rows["intensities"] = intensities.without_intensities
        if any(str(name).endswith(FOUND) for name in dataset.data_vars):  # what is searched has its spectrum
            del rows["fragility"]
        rows["samples"] = samples.without_samples
        chosen += [name for name, why in rows.items() if not why(dataset)]
        if not {*rows} & set(chosen):
            if not why_not("spectrum", dataset):
                chosen.append("spectrum")
            elif suite_curve.along(dataset) is not None and not why_not("curve", dataset):
                chosen.append("curve")
        if ranking.telling(dataset, beside=bool({*rows, "curve", "spectrum"} & set(chosen))):
            chosen.append("ranking")
    elif numeric and not _without_map(dataset):
        mapped = outcomes.plane(dataset) is not None and "outcome" in dataset.variables
        if mapped or not polar.without_directions(dataset):
            chosen.append("map" if mapped else "polar")
        elif curve.telling(dataset):
            chosen.append("curve")
        elif ranking.telling(dataset):  # many bodies at few strengths
            chosen.append("ranking")
    elif not numeric and ranking.telling(dataset):
        chosen.append("ranking")
    if not work_precision.without_trade(dataset):
        chosen = ["work_precision"]
    if not curves.without_curves(dataset):
        chosen.append("curves")
    return tuple(chosen)


def _moves(dataset: xarray.Dataset, name: str) -> bool:
    """Whether a history is there and anywhere else than at rest."""
    return name in dataset.variables and bool(np.nan_to_num(dataset[name].values).any())


def why_not(kind: str, dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be drawn as `kind`; "" if it can."""
    if kind not in KINDS:
        return f"not drawn by this version, which draws {', '.join(KINDS)}{hint(kind, list(KINDS))}"
    return KINDS[kind].why_not(dataset)


def figure(kind: str, dataset: xarray.Dataset, look: Look | None = None) -> Figure:
    """Draw a kind the dataset can show, as it is wanted.

    Raises:
        StudyError: the selection, or a row of labels or limits, is not there.
    """
    look = look or Look()
    part, words = selected(dataset, look.select)
    if complaint := why_not(kind, part):
        raise StudyError(f"plot {kind!r}: {complaint}")
    with style.wanted(look, words):
        drawn = KINDS[kind].draw(part)
        apply_look(drawn, look, kind)
        return drawn
