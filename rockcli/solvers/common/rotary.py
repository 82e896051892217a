"""The rotary inertia of a body whose mass is spread along a line."""

from __future__ import annotations

from rockcli.errors import SolverError

ROUNDED = 1e-6
"""Share of I_O by which an `inertia` may be rounded below that of the line."""


def lacking(inertia: float, m: float, R: float, length: float, moved: float = 0.0) -> float:
    """What a line of mass `m` from the base up to `length` lacks of I_O = inertia m R² [kg m²].

    `moved`: what the base's own displacements bring [kg m²].

    Raises:
        SolverError: the line has more than I_O: nodes of negative inertia would make energy.
    """
    whole = inertia * m * R * R
    found = whole - m * length**2 / 3.0 - moved
    if found < -ROUNDED * whole:
        least = (m * length**2 / 3.0 + moved) / (m * R * R)
        raise SolverError(
            f"inertia = {inertia:.6g} is less than the {least:.6g} of a mass spread along the column of model 4; "
            "models 1 to 3 take it"
        )
    return max(found, 0.0)
