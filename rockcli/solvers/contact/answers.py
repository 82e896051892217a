"""From the raw output of the contact kernel to scalars by name, and a sentence a case."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import DONE, ILL_POSED
from rockcli.kernels.contact import results as to
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.laws.contact import slides_only
from rockcli.scene.response import NO_UPLIFT, SLIDING, UNRESOLVED
from rockcli.solvers.common.certainty import withdraw
from rockcli.solvers.common.found import (
    ON_SEPARATRIX,
    barrier,
    broke_off,
    counts,
    found_of,
    note_unstored,
    residual_tilt,
)
from rockcli.solvers.contact.run import Raw

Array = NDArray[np.float64]

SLIDES = "slides and does not rock: mu is not above tan(alpha)"

SLIDES_ON = "slides on for ever: the ground leaves it with a velocity that no friction stops"

SLIPS_STILL = "slips while it rocks still 60/p after the report, where it is left"

GOES_ON, NO_OUTCOME = "its slide goes on from what is told", "whether it overturns is not known"


def answer(
    batch: Batch, raw: Raw, rocking: dict[str, NDArray[Any]], exact: NDArray[np.bool_]
) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Scalars by name and sentences.

    Args:
        rocking: the scalars of pure rocking, which tell what friction that would need.
        exact: where flight and slide-rock are described, (n,); elsewhere a body only slides.
    """
    out, block = raw.out, batch.block
    found = found_of(out, to, out[:, to.TOP_PEAK])
    scalars = found.scalars(batch)
    scalars |= _by_side(batch, out, found.theta_peak)
    slid, least = _standing(out, found.fell)
    outcome = scalars["outcome"]
    scalars["outcome"] = np.where((outcome == NO_UPLIFT) & (slid > 0.0), SLIDING, outcome).astype(np.int8)
    known = found.unless_failed
    only = slides_only(batch)
    # a body that only slides needs no more than there is; what rocks is told what rocking would have needed
    needed = np.where(only & (out[:, to.N_SLIPS] > 0), block.mu, rocking["mu_required"])
    scalars |= {
        "mu_required": known(needed),
        "mu_impact": known(np.where(only, 0.0, rocking["mu_impact"])),
        "N_min_over_mg": known(least),
        "energy_residual": known(np.where(only, np.nan, out[:, to.BALANCE] / (batch.g * barrier(batch)))),
        "slide_peak": known(slid),
        "slide_residual": known(np.where(found.fell, np.nan, out[:, to.SLIDE_END])),
        "residual_tilt": residual_tilt(batch, found),
        "t_slip": known(out[:, to.T_SLIP]),
        "t_flight": known(out[:, to.T_FLIGHT]),
        "n_slips": known(out[:, to.N_SLIPS]),
        "n_flights": known(out[:, to.N_FLIGHTS]),
        "n_jams": known(out[:, to.N_JAMS]),
        "n_steps": counts(out[:, to.N_STEPS]),
        "n_rhs": counts(out[:, to.N_STEPS]),  # a step is one expansion
        "error_estimate": np.full(batch.size, np.nan),
        "overturn_share": np.full(batch.size, np.nan),
    }
    unknown = ~exact & (scalars["outcome"] >= NO_UPLIFT) & ((out[:, to.N_FLIGHTS] > 0) | found.moved)
    withdraw(scalars, unknown)
    return scalars, _reasons(batch, out, scalars, only, unknown)


def _standing(out: Array, fell: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Largest |slide| [m] and smallest normal force over m g of the report, (n,); of a body that falls until it passes.

    As of pure rocking (`event.unpack.standing_extremes`): on its way to the ground the base slides about a metre.
    """
    passed = fell & (out[:, to.T_OVERTURN] <= out[:, to.T_END])
    never = passed & (out[:, to.T_OVERTURN] == 0.0)
    slid = np.where(passed, out[:, to.SLIDE_STANDING], np.abs(out[:, to.SLIDE_PEAK]))
    least = np.where(passed, out[:, to.N_STANDING], out[:, to.N_MIN])
    return np.asarray(slid), np.where(never, np.nan, least)


def _by_side(batch: Batch, out: Array, peak: Array) -> dict[str, Array]:
    """Largest |theta| to the left and to the right, NaN for symmetric bodies, and the larger |theta|/alpha."""
    symmetric = batch.block.symmetric & ~batch.block.rolls
    alpha, infinite = batch.block.alpha, np.isinf(peak)
    sides = [
        np.where(np.isnan(peak), np.nan, np.where(infinite & (np.sign(peak) == sign), np.inf, out[:, column]))
        for sign, column in ((-1.0, to.PEAK_LEFT), (1.0, to.PEAK_RIGHT))
    ]
    ratio = np.maximum(sides[LEFT] / alpha[:, LEFT], sides[RIGHT] / alpha[:, RIGHT])
    left, right = (np.where(symmetric, np.nan, side) for side in sides)
    return {"theta_peak_left": left, "theta_peak_right": right, "theta_peak_over_alpha": ratio}


def _reasons(
    batch: Batch, out: Array, scalars: dict[str, NDArray[Any]], only: NDArray[np.bool_], unknown: NDArray[np.bool_]
) -> list[str]:
    reasons = [""] * batch.size
    outcome = scalars["outcome"]
    counted = (out[:, to.N_JAMS] > 0) | (out[:, to.TWO_WAYS] > 0) | (out[:, to.NEARLY_FLAT] < ILL_POSED)
    counted |= np.isinf(out[:, to.SLIDE_END]) | (out[:, to.SLIP_LEFT] != 0.0)
    noted = (out[:, to.STATUS] != DONE) | unknown | (outcome == UNRESOLVED) | only | counted
    for i in np.flatnonzero(noted):  # of most there is nothing to say
        row, said = out[i], []
        if row[to.STATUS] != DONE:
            said.append(broke_off(row[to.STATUS], row[to.N_STEPS], row[to.T_END]))
        elif unknown[i]:
            said.append("leaves the ground or tips while it slides: this model has no consistent contact forces")
        elif outcome[i] == UNRESOLVED and row[to.SLIP_LEFT] == 0.0:
            said.append(ON_SEPARATRIX)
        elif only[i] and outcome[i] == SLIDING and row[to.N_FLIGHTS] == 0:
            said.append(SLIDES)
        if row[to.STATUS] == DONE and row[to.SLIP_LEFT] != 0.0:
            said.append(f"{SLIPS_STILL}: {NO_OUTCOME if outcome[i] == UNRESOLVED else GOES_ON}")
        if np.isinf(row[to.SLIDE_END]):
            said.append(SLIDES_ON)
        if row[to.NEARLY_FLAT] < ILL_POSED and row[to.STATUS] == DONE and not unknown[i]:
            said.append(
                "comes down from flight flat within 0.002 alpha: rigid bodies have no limit there, on which edge "
                "it lands decides how it goes on"
            )
        if row[to.N_JAMS] > 0:
            said.append(
                f"jams {row[to.N_JAMS]:.0f} times: mu is so large that no finite force lets it slide on, it is stopped "
                "at once as by a stiff contact"
            )
        if row[to.TWO_WAYS] > 0:
            said.append("mu is so large that slip and flight are both consistent: flight was taken")
        reasons[i] = "; ".join(said)
    note_unstored(batch, scalars["n_impacts"], reasons)
    return reasons
