"""Rotates two horizontal components of a recorded motion into one direction."""

from __future__ import annotations

import hashlib
import math
import re
from dataclasses import replace

from rockcli.errors import RecordError
from rockcli.motion.motion import AZIMUTH, Motion

TINY = 1e-12
"""Angles closer than this to a whole number of quarter turns are one [rad]: 90*deg is component two, to the bit."""


_QUADRANT = re.compile(r"([NS])(\d\d?)([EW])", re.I)
_ALONG = re.compile(
    r"(N|S|NS[12]?|SN|N-S|NORTH|SOUTH|[A-Z][HLNG]N)|(?:E|W|EW[12]?|WE|E-W|EAST|WEST|[A-Z][HLNG]E)", re.I
)
"""Names of components along north and along east: `S16W`, `NS`, `HNE`."""

_OF_KIK = re.compile(r"(?:NS|EW)([12])")
"""Horizontal components of KiK-net: 1 in the borehole, 2 at the surface."""

ASKEW = 10
"""Degrees by which two components may miss a right angle: those of Lucerne, 260 and 345, are taken as a pair."""


def cosine_and_sine(angle: float) -> tuple[float, float]:
    """cos and sin of an angle [rad], exactly 0 and +/-1 at whole quarter turns."""
    quarters = round(angle / (0.5 * math.pi))
    if abs(angle - quarters * 0.5 * math.pi) <= TINY:
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[quarters % 4]
    return math.cos(angle), math.sin(angle)


def told_of(motion: Motion, *, horizontal: bool) -> tuple[str, ...]:
    """What is remarkable about a record that is taken as horizontal, or as vertical, one sentence each."""
    if not (motion.is_vertical if horizontal else motion.is_horizontal):
        return motion.warnings
    called, taken = ("vertical", "horizontal") if horizontal else ("horizontal", "vertical")
    return (*motion.warnings, f"its file calls it a {called} component, {motion.component}; it is taken as {taken}")


def in_direction(one: Motion, two: Motion, angle: float) -> Motion:
    """The motion `one cos(angle) + two sin(angle)`, angle [rad] from component one towards component two.

    At 0 and 90 degrees these are the components themselves, bit for bit.

    Raises:
        RecordError: time steps, lengths, units or the times of the first samples of the components differ.
    """
    if one.in_g != two.in_g:
        raise RecordError(f"{one.name} is in {one.units}, {two.name} in {two.units}: both must be in the same units")
    if abs(one.dt - two.dt) > 1e-9 * one.dt:
        raise RecordError(f"{one.name} has the time step {one.dt:g} s, {two.name} {two.dt:g} s: both need the same")
    if len(one.values) != len(two.values):
        shorter = min(one.duration, two.duration)
        raise RecordError(
            f"{one.name} has {len(one.values)} samples, {two.name} {len(two.values)}: both must have as many; "
            f"window: [0, {shorter:.10g}] keeps what they have in common"
        )
    refuse_other_start(one, two)
    c, s = cosine_and_sine(angle)
    if s == 0.0:
        values = c * one.values
    elif c == 0.0:
        values = s * two.values
    else:
        values = c * one.values + s * two.values
    both = f"{one.sha256} {two.sha256} {angle!r}"
    of_one_file = one.name == two.name
    names = [f"{motion.name} {motion.component}".rstrip() if of_one_file else motion.name for motion in (one, two)]
    called = list(zip(names, (one, two), strict=True))
    steps = [f"{name}: {sentence}" for name, motion in called for sentence in motion.processing]
    direction = f"taken in the direction of the angle from {' towards '.join(names)}"
    return replace(
        one,
        values=values,
        name=f"{one.name} + {two.name}",
        sha256=hashlib.sha256(both.encode()).hexdigest(),
        processing=(*steps, direction),
        warnings=(
            *(f"{name}: {sentence}" for name, motion in called for sentence in told_of(motion, horizontal=True)),
            *((f"{one.name} {why}",) if (why := not_a_pair(one, two)) else ()),
        ),
        component="",
        header={
            key: said
            for key, said in one.header.items()
            if key in ("start", "first_time") or two.header.get(key) == said
        },
    )


def of_other_places(one: Motion, two: Motion) -> str:
    """That two components are of two events or stations, as both files say; "" if not."""
    for key in ("event", "station"):
        first, second = (str(motion.header.get(key) or "") for motion in (one, two))
        if first and second and first.casefold() != second.casefold():
            return f"is of {key} {first}, {two.name} of {second}: two components are of one motion"
    return ""


def not_a_pair(one: Motion, two: Motion) -> str:
    """That two components are of two events or stations, or not perpendicular, as both files say; "" if not."""
    if elsewhere := of_other_places(one, two):
        return elsewhere
    first, second = one.component, two.component
    degrees = _azimuth(first), _azimuth(second)
    if degrees[0] is not None and degrees[1] is not None:
        askew = abs(abs(degrees[0] - degrees[1]) - 90) > ASKEW
    else:
        askew = first != "" and first.casefold() == second.casefold()
    if askew and (one.header.get("station") or re.fullmatch(AZIMUTH, first)):
        return f"is component {first}, {two.name} is {second}: two components are perpendicular"
    depths = [match[1] for name in (first, second) if (match := _OF_KIK.fullmatch(name))]
    if len(set(depths)) == 2:
        return f"is component {first}, {two.name} is {second}: one is of the borehole, the other of the surface"
    return ""


def _azimuth(component: str) -> int | None:
    """Degrees from north, below 180, of a component that its file calls by them or by a direction; None of others."""
    if re.fullmatch(AZIMUTH, component):
        return int(component) % 180
    if match := _QUADRANT.fullmatch(component):
        angle = int(match[2])
        return (angle if (match[1].upper() == "N") == (match[3].upper() == "E") else -angle) % 180
    match = _ALONG.fullmatch(component)
    return None if match is None else 0 if match[1] else 90


def refuse_other_start(one: Motion, two: Motion) -> None:
    """Make sure that two components begin together, where both files say when.

    Raises:
        RecordError: they do not.
    """
    if later := two.begins_after(one):
        first, second = (one, two) if later > 0.0 else (two, one)
        said = f"{second.name} begins {abs(later):g} s after {first.name}: components must begin at the same time"
        raise RecordError(f"{said}; cut the files to what they have in common")
