"""The block of a study: from a sufficient pair of keys to bodies."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.body.block import Block, make_block
from rockcli.study.building.body_mesh import build_from_mesh
from rockcli.study.building.body_outline import BLOCK, build_solid, check_no_mesh, has_outline
from rockcli.study.building.numbers import LARGEST, Numbers
from rockcli.study.document.tree import Keys
from rockcli.study.schema import OUTLINES, BlockPart, FrictionPart

HEIGHT, WIDTH, ANGLE = ("h", "height"), ("b", "width"), ("alpha", "tan_alpha", "slenderness")
GROUPS: tuple[tuple[str, ...], ...] = (("R",), HEIGHT, WIDTH, ANGLE)
"""Ways to say the same thing; a body needs two of the four, once each."""

SMALLEST_ALPHA = 1e-100
"""Slenderness below which a body is refused [rad]."""

UNEVEN = (
    "h is half the height of a rectangle; a centre of mass elsewhere is h: its height above the base, beside width, "
    "r_g (radius of gyration) and top, and without height"
)

SUFFICIENT = "two of R, h (or height), b (or width) and alpha (or tan_alpha, slenderness)"


def sufficient_pair(numbers: Numbers) -> Block:
    """Bodies of the given shape, as rectangles, or of the given outline; what the user gave is kept to the last bit.

    Raises:
        StudyError: an outline of no body, over- or under-determined, not positive, not finite, alpha not below pi/2.
    """
    block = numbers.case.block
    if has_outline(block):
        return _outlined(numbers)
    if block.density is not None:
        numbers.fail((*BLOCK, "density"), "belongs to an outline or a mesh; a block given by its sizes has a mass")
    if block.stands != "outline":
        numbers.fail((*BLOCK, "stands"), "belongs to an outline; a block given by its sizes stands on its two edges")
    if block.centre is not None:
        numbers.fail((*BLOCK, "centre"), "belongs to an outline; a block given by its sizes has h and b")
    for key in ("pixel", "z_down", "contacts"):
        if getattr(block, key) not in (None, False):
            numbers.fail((*BLOCK, key), "belongs to an outline, which the block does not have")
    check_no_mesh(numbers, block)
    _check_planes(numbers, block)
    given = [[key for key in group if getattr(block, key) is not None] for group in GROUPS]
    for keys in given:
        if len(keys) > 1:
            why = f"{' and '.join(keys)} say the same thing; leave one out"
            numbers.fail((*BLOCK, keys[-1]), f"{why}: {UNEVEN}" if keys == [*HEIGHT] else why)
    names = [key for keys in given for key in keys]
    if len(names) > 2:
        said = f"the block is over-determined by {', '.join(names)}; {SUFFICIENT} suffice"
        numbers.fail_body((*BLOCK, names[-1]), said)
    if len(names) < 2:
        has = f"has only {names[0]}" if names else "has no size"
        numbers.fail_body(BLOCK, f"the block is under-determined: it {has}; {SUFFICIENT} are needed")
    edges = _edges(numbers, block)
    if edges is not None and given[1] == []:
        numbers.fail((*BLOCK, "b"), "an asymmetric body, b: [left, right], needs h or height beside it")
    # overflow and underflow are found below, as results that are not positive and finite
    with np.errstate(all="ignore"):
        if edges is not None:
            return _finite(numbers, make_block(h=_h(numbers, block), b=edges, n=numbers.n), names)
        return _finite(numbers, _symmetric(numbers, block), names).repeated(numbers.n)


def _check_planes(numbers: Numbers, block: BlockPart) -> None:
    """Refuse a depth or a plane of what is no rectangle of height, width and depth."""
    if block.plane is None:
        if block.depth is not None:
            said = (
                "belongs to an outline, or to a rectangle with a plane: width or depth, the side along which it rocks"
            )
            numbers.fail((*BLOCK, "depth"), said)
        return
    given = [key for group in GROUPS for key in group if getattr(block, key) is not None]
    if given == [*HEIGHT, "width"]:
        numbers.fail((*BLOCK, "plane"), f"belongs to a rectangle of height, width and depth; {UNEVEN}")
    if len(given) != 2 or given[0] not in HEIGHT or given[1] != "width" or block.depth is None:
        numbers.fail((*BLOCK, "plane"), "chooses between width and depth; height (or h), width and depth are needed")
    for key in ("inertia", "r_g"):
        if getattr(block, key) is not None:
            numbers.fail((*BLOCK, key), "is not the same in both planes; give each plane as a setting of its own")
    for key in ("width", "depth"):
        numbers.positive((*BLOCK, key))


def make_body(numbers: Numbers, pair: Block) -> Block:
    """The bodies with inertia, top, mass and friction.

    Raises:
        StudyError: inertia of an asymmetric body, inertia beside r_g, or a value that cannot be.
    """
    block = numbers.case.block
    if has_outline(block):
        given = {key: numbers.positive((*BLOCK, key)) for key in ("top", "mass")}
        known: dict[str, Any] = {key: numbers.array(value) for key, value in given.items() if value is not None}
        return replace(pair, **known, **_contact(numbers, block))
    contact = _contact(numbers, block)
    extras = [key for key in ("inertia", "r_g", "top", "mass") if getattr(block, key) is not None]
    if not extras:
        return replace(pair, **contact)
    if "inertia" in extras and "r_g" in extras:
        numbers.fail((*BLOCK, "r_g"), "inertia and r_g say the same thing; leave one out")
    values: dict[str, Any] = {key: numbers.positive((*BLOCK, key)) for key in extras}
    if "inertia" in values:
        keys = (*BLOCK, "inertia")
        numbers.require(keys, pair.symmetric, "an asymmetric body has one inertia per edge; give r_g instead")
        numbers.require(keys, np.greater_equal(values["inertia"], 1.0), "I_O/(m R^2) is at least 1 for any body")
    with np.errstate(all="ignore"):
        body = make_block(
            h=pair.h,
            b=pair.b,
            R=pair.R[:, 0],
            alpha=pair.alpha[:, 0],
            tan_alpha=pair.tan_alpha[:, 0],
            n=numbers.n,
            **values,
            **contact,
        )
    return _finite(numbers, body, extras)


def _contact(numbers: Numbers, block: BlockPart) -> dict[str, Any]:
    """Friction of the base and restitution of its corners, those that are given."""
    found: dict[str, Any] = {}
    keys: Keys = (*BLOCK, "mu")
    if isinstance(block.mu, FrictionPart):
        static, kinetic = (numbers.not_negative((*keys, name)) for name in ("static", "kinetic"))
        assert static is not None
        found["mu"] = numbers.array(static)
        if kinetic is not None:
            numbers.require((*keys, "kinetic"), np.less_equal(kinetic, static), "must not be above static")
            found["mu_kinetic"] = numbers.array(kinetic)
    elif block.mu is not None:
        mu = numbers.not_negative(keys)
        assert mu is not None
        found["mu"] = numbers.array(mu)
    e_n = numbers.value((*BLOCK, "e_n"))
    if e_n is not None:
        inside = np.greater_equal(e_n, 0.0) & np.less_equal(e_n, 1.0)
        numbers.require((*BLOCK, "e_n"), inside, "must be between 0 and 1")
        if "mu" not in found:
            numbers.fail((*BLOCK, "e_n"), "a body leaves the ground, and comes back, only where mu is given")
        found["e_n"] = numbers.array(e_n)
    return found


def _outlined(numbers: Numbers) -> Block:
    """Bodies of the given outline; the top is their highest point, the mass NaN where no density is given."""
    scan = direction = None
    key = next(key for key in OUTLINES if getattr(numbers.case.block, key) is not None)
    if key == "mesh":
        body, has_mass, scan, direction = build_from_mesh(numbers)
    else:
        body, has_mass = build_solid(numbers)
    mass = body.mass if has_mass else None
    block = make_block(h=body.h, b=body.b, r_g=body.r_g, top=body.height, mass=mass, rise=body.rise, n=numbers.n)
    if numbers.case.block.mu is not None:
        level = "contacts at different heights are a tilted support, on which friction is not solved; leave mu out"
        numbers.require((*BLOCK, "mesh" if key == "mesh" else "contacts"), body.rise == 0.0, level)
    same = np.array_equal(body.outline, np.broadcast_to(body.outline[:1], body.outline.shape), equal_nan=True)
    outline = np.broadcast_to(body.outline[:1], body.outline.shape) if same else body.outline
    block = replace(block, outline=outline, vertices=body.vertices, scan=scan, direction=direction)
    return _finite(numbers, block, [key])


def _symmetric(numbers: Numbers, block: BlockPart) -> Block:
    """Rectangles of equal edges: one where no size differs from case to case."""
    R = numbers.positive((*BLOCK, "R"))
    h, b = _h(numbers, block), _b(numbers, block)
    tan_alpha, alpha = _angle(numbers)
    if R is not None and tan_alpha is not None:
        h = R / np.hypot(1.0, tan_alpha)
        b = h * tan_alpha
    elif R is not None and h is not None:
        numbers.require((*BLOCK, _key(block, HEIGHT)), np.less(h, R), "half the height must be smaller than R")
        b = np.sqrt((R - h) * (R + h))
    elif R is not None:
        numbers.require((*BLOCK, _key(block, WIDTH)), np.less(b, R), "half the width must be smaller than R")
        h = np.sqrt((R - b) * (R + b))
    elif tan_alpha is not None and b is None:
        b = h * tan_alpha
    elif tan_alpha is not None:
        h = b / tan_alpha
    n = numbers.n if np.ndim(h) or np.ndim(b) else 1
    column = np.broadcast_to(np.asarray(b, dtype=np.float64), (n,))[:, None]
    return make_block(h=h, b=np.repeat(column, 2, axis=1), R=R, alpha=alpha, tan_alpha=tan_alpha, n=n)


def _edges(numbers: Numbers, block: BlockPart) -> NDArray[np.float64] | None:
    """[left, right] of an asymmetric body, (n, 2); None for one number or two equal ones."""
    if not isinstance(block.b, list):
        return None
    left, right = (numbers.positive((*BLOCK, "b", side)) for side in (0, 1))
    assert left is not None
    assert right is not None
    if np.all(np.equal(left, right)):
        return None
    return np.stack([numbers.array(left), numbers.array(right)], axis=1)


def _key(block: BlockPart, group: tuple[str, ...]) -> str:
    return next(key for key in group if getattr(block, key) is not None)


def _h(numbers: Numbers, block: BlockPart) -> Any:
    if block.h is not None:
        return numbers.positive((*BLOCK, "h"))
    height = numbers.positive((*BLOCK, "height"))
    return None if height is None else 0.5 * height


def _b(numbers: Numbers, block: BlockPart) -> Any:
    if isinstance(block.b, list):
        return numbers.positive((*BLOCK, "b", 0))
    if block.b is not None:
        return numbers.positive((*BLOCK, "b"))
    width = numbers.positive((*BLOCK, "depth" if block.plane == "depth" else "width"))
    return None if width is None else 0.5 * width


def _angle(numbers: Numbers) -> tuple[Any, Any]:
    """tan(alpha), and alpha where it is what the user gave."""
    alpha = numbers.positive((*BLOCK, "alpha"))
    if alpha is not None:
        numbers.require(
            (*BLOCK, "alpha"), np.less(alpha, 0.5 * np.pi), "must be below pi/2 (radians; 10*deg for degrees)"
        )
        return np.tan(alpha), alpha
    slenderness = numbers.positive((*BLOCK, "slenderness"))
    if slenderness is not None:
        return np.divide(1.0, slenderness), None
    return numbers.positive((*BLOCK, "tan_alpha")), None


def _finite(numbers: Numbers, block: Block, names: list[str]) -> Block:
    for values in (block.h, block.b, block.tan_alpha, block.alpha, block.R, block.inertia):
        good = (values > 0.0) & (values < LARGEST)
        numbers.require((*BLOCK, names[-1]), good, f"{' and '.join(names)} give no body of finite size")
    numbers.require((*BLOCK, names[-1]), block.alpha < 0.5 * np.pi, "alpha must be below pi/2")
    too_slender = (
        f"alpha must be at least {SMALLEST_ALPHA:g}: energies, of the order of alpha**2, would be rounded to 0"
    )
    numbers.require((*BLOCK, names[-1]), block.alpha >= SMALLEST_ALPHA, too_slender)
    return block
