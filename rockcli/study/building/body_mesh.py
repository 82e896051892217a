"""The mesh of a body: a file beside the study, measured by trimesh, to a solid in the direction of the motion."""

from __future__ import annotations

from functools import lru_cache
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import is_file
from rockcli.scene.body.lower_outline import LEVEL, lower_hull
from rockcli.scene.body.outline import OutlineError, Solid
from rockcli.scene.body.scan import QUARTER, Profile, Scan
from rockcli.scene.body.slivers import without_slivers
from rockcli.scene.counted import counted
from rockcli.study.building.body_outline import BLOCK, SAID_BY_OUTLINE
from rockcli.study.building.numbers import Numbers
from rockcli.study.document.expressions import UNITS
from rockcli.study.document.tree import Keys, place
from rockcli.study.document.values import LENGTHS, WEAKEST
from rockcli.study.schema import BlockPart

Array = NDArray[np.float64]

MESH: Keys = (*BLOCK, "mesh")

FORMATS = (".obj", ".ply", ".stl")

MOST_BYTES = 200_000_000
"""Largest mesh."""

USUAL, POSSIBLE = (0.05, 20.0), (0.01, 200.0)
"""Largest side of a body whose file's unit is not said, and of one whose unit is [m]."""

DENSITIES = 5.0, 25_000.0
"""Of what a body is made, from foam to heavy metals [kg/m³]."""

LEANS = np.radians(5.0)
"""Turn from the position of the file to rest above which it is doubted that z is up [rad]."""


class MeshError(ValueError):
    """A mesh that is no body; says what is wrong and what to do."""


def build_from_mesh(numbers: Numbers) -> tuple[Solid, bool, Scan, Array]:
    """The bodies that a mesh describes, whether their mass is known, the mesh, and the directions (n,) [rad].

    Raises:
        StudyError: keys that the mesh contradicts, a file that cannot be read or is no closed surface of a likely size.
    """
    block = numbers.case.block
    _check_keys(numbers, block)
    scan = _scan(numbers, block)
    density = numbers.positive((*BLOCK, "density"))
    _check_mass(numbers, scan)
    try:
        direction = _directions(numbers, scan)
        weight = numbers.array(1.0 if density is None else density)
        solid, tilts = _solid(scan, direction, weight, rolls=block.stands != "toes")
    except OutlineError as error:
        numbers.fail(MESH, str(error))
    if np.abs(tilts).max() > LEANS:
        numbers.remarks.append(
            f"case.block.mesh: as it stands in its file the body turns by {np.degrees(np.abs(tilts).max()):.3g} deg "
            "until it rests; is z of the file up?"
        )
    return solid, density is not None, scan, direction


def _check_keys(numbers: Numbers, block: BlockPart) -> None:
    for key in (*SAID_BY_OUTLINE, "r_g", "centre", "outline", "parts", "depth", "pixel", "contacts"):
        if getattr(block, key) is not None:
            numbers.fail((*BLOCK, key), "follows from the mesh, or belongs to an outline; leave one of the two out")
    if block.z_down:
        numbers.fail((*BLOCK, "z_down"), "belongs to an outline; z of a mesh is up")
    if block.stands == "settled":
        numbers.fail((*BLOCK, "stands"), "belongs to an outline; a mesh stands where it comes to rest")
    if block.density is not None and block.mass is not None:
        numbers.fail((*BLOCK, "mass"), "and density say the same thing; leave one out")


def _check_mass(numbers: Numbers, scan: Scan) -> None:
    """Refuse a mass that nothing of this volume has: one of the two is in other units."""
    mass = numbers.positive((*BLOCK, "mass"))
    if mass is not None:
        low, high = (scan.volume * density for density in DENSITIES)
        said = f"in the {scan.volume:.4g} m³ of the mesh is no body: check block.units and the mass [kg]"
        numbers.require((*BLOCK, "mass"), np.greater_equal(mass, low) & np.less_equal(mass, high), said)


def _directions(numbers: Numbers, scan: Scan) -> Array:
    keys: Keys = (*BLOCK, "direction")
    weakest = (
        scan.weakest
    )  # looks in every direction: a body that finds no rest in one is refused whichever is asked for
    if numbers.said(keys) in (None, WEAKEST):
        return np.full(numbers.n, weakest)
    value = numbers.value(keys)
    assert value is not None
    numbers.require(keys, np.isfinite(value), "needs a finite number")
    return numbers.array(value)


def _solid(scan: Scan, directions: Array, density: Array, *, rolls: bool) -> tuple[Solid, Array]:
    """Bodies of a scan in given directions, and by how much they turn until they rest, (n,) [rad].

    They roll over all vertices of their lower outline, or turn about the two corners they balance over.
    """
    distinct, which = np.unique(directions, return_inverse=True)
    profiles = [scan.profile(each) for each in distinct.tolist()]
    rows = [_base(profile) if rolls else _two_toes(profile) for profile in profiles]
    h, left, right, rise = (np.array(column)[which] for column in zip(*rows, strict=True))
    top = np.array([profile.outline[:, 1].max() for profile in profiles])[which] + h
    outline = _table([profile.outline for profile in profiles], which)
    outline = outline + np.stack([np.zeros_like(h), h], axis=1)[:, None, :]
    vertices = _table([lower_hull(profile.outline) for profile in profiles], which) if rolls else None
    vertices = None if vertices is None or vertices.shape[1] < 3 else vertices
    r_g = np.array([profile.r_g for profile in profiles])[which]
    tilts = np.array([profile.tilt for profile in profiles])[which]
    return Solid(density * scan.volume, h, np.stack([left, right], axis=1), r_g, top, rise, outline, vertices), tilts


def _table(rows: list[Array], which: NDArray[np.intp]) -> Array:
    """Points of every case, (n, points, 2), NaN after the last; one row stands for all where they are the same."""
    table = np.full((len(rows), max(len(points) for points in rows), 2), np.nan)
    for row, points in zip(table, rows, strict=True):
        row[: len(points)] = points
    return table[which] if len(rows) > 1 else np.broadcast_to(table, (len(which), *table.shape[1:]))


def _two_toes(profile: Profile) -> tuple[float, float, float, float]:
    """Height of the centre of mass above the middle of both toes, distances to them, rise of the right one [m]."""
    if profile.tilts.max() >= QUARTER:
        raise OutlineError("balances over no corner before a quarter turn; it rolls: leave `stands: toes` out")
    (x_left, z_left), (x_right, z_right) = profile.toes.tolist()
    rise = z_right - z_left
    level = abs(rise) <= LEVEL * np.ptp(profile.outline)
    return (-0.5 * (z_left + z_right), *_even(profile, -x_left, x_right), 0.0 if level else rise)


def _base(profile: Profile) -> tuple[float, float, float, float]:
    """The same of the side on which the body rests."""
    lies = profile.outline[:, 1] <= LEVEL * np.ptp(profile.outline) - profile.h
    x = profile.outline[lies, 0]
    return (profile.h, *_even(profile, float(-x.min()), float(x.max())), 0.0)


def _even(profile: Profile, left: float, right: float) -> tuple[float, float]:
    """Distances that differ by rounding alone are the same."""
    middle = 0.5 * (left + right)
    return (middle, middle) if abs(left - right) <= LEVEL * np.ptp(profile.outline) else (left, right)


def _scan(numbers: Numbers, block: BlockPart) -> Scan:
    name = str(block.mesh)
    path = numbers.source.folder / name
    where = place(numbers.tree, MESH)
    if path.suffix.lower() not in FORMATS:
        numbers.fail(MESH, f"is {name[:200]!r}; expected a file that ends in {', '.join(FORMATS)}")
    if not is_file(path):
        raise numbers.source.placed(where, f"case.block.mesh: the mesh {str(path)[:300]} does not exist")
    data = numbers.source.inputs.read(name, path, MOST_BYTES)
    try:
        return measured(data, path.suffix.lower()[1:], block.units)
    except MeshError as error:
        numbers.fail(MESH, f"{path.name}: {error}")


@lru_cache(maxsize=8)
def measured(data: bytes, kind: str, units: str | None) -> Scan:
    """The body of a mesh: the bytes of a file of a kind (obj, ply, stl), in these units; None = metres, and not said.

    Raises:
        MeshError: no mesh, a surface that is not closed, or of several pieces, or of an unlikely size; no trimesh.
    """
    mesh = _loaded(data, kind)
    _check_closed(mesh)
    mesh.apply_scale(1.0 if units is None else UNITS[units])
    _check_size(float(mesh.extents.max()), units)
    middle = mesh.bounds.mean(axis=0)
    mesh.apply_translation(-middle)  # scans may lie far from the origin, which would cost digits
    if mesh.volume < 0.0:  # triangles turned inwards, all of them: the body is the same
        mesh.invert()
    hull = mesh.convex_hull
    centre = np.asarray(mesh.center_mass, dtype=np.float64)
    poses, heights = _poses(
        np.asarray(hull.triangles, dtype=np.float64) - centre, np.asarray(hull.face_normals, dtype=np.float64)
    )
    return Scan(
        volume=float(mesh.volume),
        centre=middle + centre,
        r2=np.asarray(mesh.moment_inertia / mesh.mass, dtype=np.float64),
        hull=np.asarray(hull.vertices, dtype=np.float64) - centre,
        poses=poses,
        heights=heights,
        triangles=len(mesh.faces),
    )


def _loaded(data: bytes, kind: str) -> Any:
    """A mesh of trimesh; corners at one place are one corner, whatever their texture, and triangles of no area none.

    A polygon with a corner on a straight side comes as triangles some of which have no area, without which it leaks.
    """
    try:
        import trimesh
    except ImportError:
        raise MeshError("meshes are read by trimesh, which is not installed: pip install 'rockcli[meshes]'") from None
    try:
        mesh = trimesh.load_mesh(BytesIO(data), file_type=kind)
        corners, triangles = np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces)
    except Exception as error:  # whatever a damaged file makes of the reader
        raise MeshError(f"cannot be read as {kind.upper()} ({type(error).__name__}: {str(error)[:200]})") from None
    if triangles.ndim != 2 or len(triangles) < 4 or not np.isfinite(corners).all():
        raise MeshError(f"holds no body: {counted(len(triangles), 'triangle')}")
    read = trimesh.Trimesh(corners, triangles, process=True)
    mesh = _cleaned(read.copy())
    if not mesh.is_watertight:
        corners = np.asarray(read.vertices)
        other = _cleaned(trimesh.Trimesh(corners, without_slivers(corners, np.asarray(read.faces)), process=False))
        mesh = other if other.is_watertight else mesh
    return mesh


def _cleaned(mesh: Any) -> Any:
    mesh.update_faces(mesh.nondegenerate_faces() & mesh.unique_faces())
    mesh.remove_unreferenced_vertices()
    return mesh


def _check_closed(mesh: Any) -> None:
    """Refuse a surface that encloses nothing, or of which nobody knows what it encloses."""
    if not mesh.is_watertight:
        _, times = np.unique(np.sort(mesh.edges, axis=1), axis=0, return_counts=True)
        raise MeshError(
            f"the surface leaks: {int((times == 1).sum())} of its edges belong to one triangle alone, "
            f"{int((times > 2).sum())} to more than two; close its holes in MeshLab or Blender, as it has to be a body"
        )
    if not mesh.is_winding_consistent:
        raise MeshError("its triangles are not all turned outwards; turn them in MeshLab or Blender")
    if mesh.body_count > 1:
        raise MeshError(
            f"is {mesh.body_count} surfaces; a body is one closed surface: join them, or leave out what is none of it"
        )
    if not abs(mesh.volume) > 1e-9 * float(np.prod(mesh.extents)):
        raise MeshError("encloses no volume")


def _check_size(size: float, units: str | None) -> None:
    """Refuse what no body that rocks measures."""
    low, high = USUAL if units is None else POSSIBLE
    if not low <= size <= high:
        said = "metres, as no units are said" if units is None else units
        raise MeshError(
            f"its largest side measures {size:.4g} m, read in {said}: "
            f"expected {low:g} to {high:g} m; say block.units: {', '.join(LENGTHS)}"
        )


def _poses(triangles: Array, normals: Array) -> tuple[Array, Array]:
    """Normals (j, 3) of the facets of a convex hull on which it can rest, and heights (j,) of the origin above them.

    The origin, seen along the normal, has to lie on the facet.  trimesh's stable poses are the same, with the chance
    of each, and take seconds for some thousand triangles.
    """
    heights = (triangles[:, 0] * normals).sum(axis=1)
    foot = heights[:, None] * normals
    rests = np.ones(len(triangles), dtype=bool)
    for i in range(3):
        side, to_foot = triangles[:, (i + 1) % 3] - triangles[:, i], foot - triangles[:, i]
        turn = (np.cross(side, to_foot) * normals).sum(axis=1)
        rests &= turn >= -LEVEL * (side * side).sum(axis=1)
    order = np.flatnonzero(rests)[np.argsort(heights[rests], kind="stable")]
    _, first = np.unique(np.round(normals[order], 6) + 0.0, axis=0, return_index=True)
    order = order[np.sort(first)]  # triangles of one facet are one pose
    return normals[order], heights[order]
