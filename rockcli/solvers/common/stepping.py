"""Time steps that a stepping backend refuses."""

from __future__ import annotations

import numpy as np

from rockcli.errors import SolverError
from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import Pulses, Samples

STEPS_PER_PULSE = 40
"""Steps a period of a pulse takes at least."""

STEPS_PER_SWING = 20
"""Steps 1/p takes at least."""

MOST_STEPS = 1e8


def check_step(batch: Batch, case: int, dt: float, stop: float) -> None:
    """Refuse a step too coarse to see the motion or the swing, or so fine that the run has no end.

    Args:
        batch, case: the case.
        dt: time step [s].
        stop: end of the report [s].

    Raises:
        SolverError: naming the coarsest step that would do.
    """
    limits = [(1.0 / float(batch.p[case].max()) / STEPS_PER_SWING, f"1/{STEPS_PER_SWING} of 1/p")]
    for channel in (batch.excitation.horizontal, batch.excitation.vertical):
        if isinstance(channel, Pulses):
            T_p = 2.0 * np.pi / float(channel.omega_p[case])
            limits.append((T_p / STEPS_PER_PULSE, f"1/{STEPS_PER_PULSE} of the pulse's period"))
        elif isinstance(channel, Samples):
            limits.append((channel.dt, "the time between samples"))
    coarsest, what = min(limits)
    if dt > coarsest * (1.0 + 1e-9):
        raise SolverError(f"dt = {dt:.6g} s is too coarse: at most {coarsest:.4g} s ({what}) is allowed")
    if stop / dt > MOST_STEPS:
        raise SolverError(f"dt = {dt:.6g} s makes {stop / dt:.3g} steps; at most {MOST_STEPS:g} are allowed")
