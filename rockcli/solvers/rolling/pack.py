"""From a batch of rolling bodies to the tables of the kernel (`kernels.rolling.parameters`)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.rolling import parameters as at
from rockcli.scene.batch import Batch
from rockcli.scene.body.lower_outline import Facets, facets_of
from rockcli.scene.repeated import is_repeated
from rockcli.solvers.common.duration import durations_of
from rockcli.solvers.common.ground import factors_of

Array = NDArray[np.float64]


def facets_in(batch: Batch) -> Facets:
    """The facets of every body, or of one for all where they are the same."""
    vertices = batch.block.vertices
    assert vertices is not None
    return facets_of(vertices[:1] if is_repeated(vertices) else vertices)


def parameters_of(batch: Batch, facets: Facets) -> tuple[Array, Array]:
    """One row per case, and the table of bodies its BODY points into, of a row where all are the same."""
    lasts = durations_of(batch)
    r_g2, loss = batch.block.r_g2, batch.damping.loss
    assert loss is not None
    same = len(facets.count) == 1 and bool((r_g2 == r_g2[0]).all() and (loss == loss[0]).all())
    bodies = bodies_of(facets, r_g2[:1] if same else r_g2, loss[:1] if same else loss)
    columns = (
        batch.g, 0.0 if same else np.arange(batch.size), batch.theta_0, batch.theta_dot_0, lasts.motion, lasts.report,
        lasts.given, factors_of(batch.excitation.suite or batch.excitation.horizontal, batch.size),
        factors_of(batch.excitation.vertical, batch.size),
    )  # fmt: skip
    rows = np.empty((batch.size, len(columns)))
    for column, values in enumerate(columns):
        rows[:, column] = values
    return rows, bodies


def bodies_of(facets: Facets, r_g2: Array, loss: Array) -> Array:
    """The table of bodies; r_g2 (n,) squared radius of gyration [m^2], loss (n,) power of Housner's loss."""
    n, f = len(r_g2), facets.tilt.shape[1]
    table = np.zeros((n, at.FIRST + f * at.FACET))
    table[:, at.COUNT], table[:, at.STANDING] = facets.count, facets.standing
    table[:, at.FALL_LEFT], table[:, at.FALL_RIGHT] = facets.fall[:, 0], facets.fall[:, 1]
    table[:, at.SCALE] = np.abs(facets.fall).min(axis=1)
    table[:, at.LOSSLESS] = loss == 0.0
    each = table[:, at.FIRST :].reshape(n, f, at.FACET)
    each[:, :, at.TILT], each[:, :, at.HEIGHT] = facets.tilt, facets.height
    inertia = r_g2[:, None, None] + facets.R**2  # about each end, over m
    kept = (r_g2[:, None] + facets.height**2 - facets.b.prod(axis=2)) / np.sqrt(inertia.prod(axis=2))
    with np.errstate(invalid="ignore"):
        kept = np.where(loss[:, None] == 0.0, 1.0, np.maximum(kept, 0.0) ** loss[:, None])
    _barriers(table, facets, inertia, kept)
    for side, place in ((0, at.LEFT), (1, at.RIGHT)):
        end = each[:, :, place : place + at.END]
        R, alpha, extent = facets.R[:, :, side], facets.alpha[:, :, side], facets.extent[:, :, side]
        end[:, :, at.P2] = R / inertia[:, :, side]  # over g
        end[:, :, at.ALPHA], end[:, :, at.SIN], end[:, :, at.COS] = alpha, np.sin(alpha), np.cos(alpha)
        end[:, :, at.RADIUS], end[:, :, at.EXTENT] = R, extent
        end[:, :, at.RISE] = 2.0 * np.sin(0.5 * extent) * np.sin(alpha - 0.5 * extent)
        end[:, :, at.ETA] = kept * np.sqrt(inertia[:, :, 1 - side] / inertia[:, :, side])
        end[:, :, at.B] = facets.b[:, :, side]
    return np.nan_to_num(table)


def _barriers(table: Array, facets: Facets, inertia: Array, kept: Array) -> None:
    """What tells early whether a body falls; inertia (n, f, 2) about each end over m, kept (n, f) by (V4), (V5)."""
    left, right = facets.fall[:, :1], facets.fall[:, 1:]
    with np.errstate(invalid="ignore"):
        between = (facets.tilt > left) & (facets.tilt < right)
        carries = (facets.b >= 0.0).all(axis=2)
        beyond = facets.tilt <= left, facets.tilt >= right
    wells = carries & between
    table[:, at.VALLEY] = np.where(wells.sum(axis=1) == 1, wells.argmax(axis=1), -1)
    table[:, at.LOWEST] = np.where(between, facets.height, np.inf).min(axis=1)
    own = np.take_along_axis(facets.height, facets.standing[:, None], axis=1)[:, 0]
    table[:, at.TOP] = own + facets.barrier.min(axis=1)
    table[:, at.SWAY] = np.nanmax(facets.R / np.sqrt(inertia), axis=(1, 2))
    for place, there in zip((at.KEEP_LEFT, at.KEEP_RIGHT), beyond, strict=True):
        table[:, place] = np.where((carries & there).any(axis=1), 0.0, np.where(there, kept, 1.0).prod(axis=1))
