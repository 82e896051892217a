"""Preview of a study (`rock check`): what it will solve, without solving it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rockcli.analysis.measures import peaks
from rockcli.analysis.uplift import factor_of
from rockcli.engine.auto import prospect
from rockcli.engine.backends import choose
from rockcli.engine.bodies import Bodies, uplift_words
from rockcli.engine.cost import (
    ARRIVING,
    BATCH,
    REFINED,
    STARTING,
    memory,
    seconds_of_reading,
    seconds_of_rules,
    seconds_of_statistics,
    seconds_of_tables,
    seconds_per_case,
    share_refined,
)
from rockcli.engine.speed import slowness
from rockcli.engine.sweep.history_size import HISTORIES_AT_MOST, histories_size
from rockcli.engine.sweep.refine import CELLS
from rockcli.errors import SolverError
from rockcli.scene.auto import AUTO, highest
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT, Block
from rockcli.scene.body.lower_outline import facets_of
from rockcli.scene.ground.excitation import Channel, Pulses, Samples
from rockcli.scene.laws.contact import slides_first
from rockcli.scene.laws.damping import SCHEMES
from rockcli.scene.laws.models import DEFORMABLE, MODELS
from rockcli.study.study import Study

SLOW, WIDE = 10.0, 200
"""Estimated time [s], and points on each of two axes, from which `refine` is proposed for a map."""

LOOKED_AT = 20_000
"""Cases looked at for warnings and cost."""

POSES = 6
"""Poses of a mesh that are listed, the lowest ones."""

POSES_APART = np.radians(20.0)
"""Poses nearer than this to a lower one are not listed: the facets of one round side [rad]."""


@dataclass(frozen=True)
class Row:
    """A line of a preview: `key` for programs, `words` (with the unit) for people."""

    key: str
    words: str
    value: float | str


@dataclass(frozen=True)
class Preview:
    """A study before it is solved; all but `cases`, `axes`, cost and warnings are those of the first case.

    Attributes:
        cases: how many; axes: (name, path, points) outermost first.
        body: mass, sizes, inertia and friction; both edges of an asymmetric body.
        model: model, geometry, damping, initial state.
        motion: accelerations in g and over that of uplift; of a record also its scaling.
        processing: what was done to the records, a sentence each.
        bodies: every distinct body (of more than `LOOKED_AT` under one motion, those of the first): where it stands
            on the axes (`body`), `cases`, h, b, alpha, p, mu, uplift in g, whether it rocks or slides first.
        uplift: what that uplift is, in words.
        backend: name, or why there is none.
        seconds: estimated processor time of a run of one process without plots, on this machine.
        memory: estimated memory of that process [MB]; megabytes: of histories, 0 if not saved.
        warnings: about the study and its cases (of a large study, about its first cases).
    """

    name: str
    title: str
    cases: int
    axes: tuple[tuple[str, str, int], ...]
    body: tuple[Row, ...]
    model: tuple[Row, ...]
    motion: tuple[Row, ...]
    processing: dict[str, tuple[str, ...]]
    bodies: tuple[dict[str, float | str], ...]
    uplift: str
    backend: str
    seconds: float
    memory: float
    megabytes: float
    warnings: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """The same for programs: sections as {key: value}, SI units and radians, NaN as None."""
        sections = {
            name: {row.key: _plain(row.value) for row in rows}
            for name, rows in (("body", self.body), ("model", self.model), ("motion", self.motion))
        }
        return {
            "name": self.name,
            "title": self.title,
            "cases": self.cases,
            "axes": [{"name": name, "path": path, "points": points} for name, path, points in self.axes],
            "first_case": sections,
            "bodies": [{key: _plain(value) for key, value in row.items()} for row in self.bodies],
            "processing": {name: list(steps) for name, steps in self.processing.items()},
            "backend": self.backend,
            "seconds": self.seconds,
            "memory": self.memory,
            "megabytes": self.megabytes,
            "warnings": list(self.warnings),
        }


def _plain(value: float | str) -> float | str | None:
    return value if isinstance(value, str) or np.isfinite(value) else None


def preview(study: Study) -> Preview:
    """Look at a study; `StudyError` or `RecordError` if a case cannot be built."""
    with np.errstate(all="ignore"):
        return _preview(study)


def _preview(study: Study) -> Preview:
    _, batch = next(iter(study.batches(np.array([0]))))
    looked_at = min(study.size, LOOKED_AT)
    said: list[str] = []
    seconds = 0.0
    bodies = Bodies(study, LOOKED_AT)
    arrive: dict[int, int] = {}
    for indices, part in study.batches(np.arange(looked_at)):
        said += part.warnings
        if looked_at == study.size:
            bodies.add(indices, part)
        motion = part.excitation.horizontal
        if isinstance(motion, Samples) and motion.ground is not None:
            arrive[id(motion.values)] = len(motion.values)
    if looked_at < study.size:
        bodies.add_under_one_motion()
    for number, (indices, part) in enumerate(study.suites(np.arange(looked_at))):
        each = seconds_per_case(part, _backend(part)) + seconds_of_rules(study.rules, part)
        seconds += len(indices) * each + (BATCH if number else 0.0)  # the first is in what cases take
    seconds = seconds / looked_at * study.size * (1.0 if _narrow(study) else share_refined(study))
    seconds += STARTING + seconds_of_reading(batch) * len(study.inputs) + seconds_of_statistics(study)
    seconds += ARRIVING * sum(arrive.values()) + seconds_of_tables(study)
    seconds *= slowness()
    histories = histories_size(study, HISTORIES_AT_MOST).bytes
    said += _proposals(study, seconds)
    return Preview(
        name=study.name,
        title=study.title,
        cases=study.size,
        axes=tuple((axis.name, axis.path, axis.size) for axis in study.axes),
        body=tuple(_body(batch)),
        model=tuple(_model(batch, study.search is not None)),
        motion=tuple(_motion(batch)),
        processing=study.processing,
        backend=_backend(batch),
        bodies=tuple(bodies.rows()),
        uplift=bodies.uplift,
        seconds=seconds,
        memory=memory(study, histories) / 1e6,
        megabytes=histories / 1e6,
        warnings=tuple(dict.fromkeys((*study.warnings, *said))),
    )


def _proposals(study: Study, seconds: float) -> list[str]:
    """What would save most of the time of a map, or does not where it was meant to."""
    numeric = [axis for axis in study.axes if axis.numeric]
    if study.refine:
        return [f"`refine` solves all of a map of fewer than {2 * CELLS} points a side"] if _narrow(study) else []
    wide = len(numeric) == 2 and min(axis.size for axis in numeric) >= WIDE
    if not wide or seconds < SLOW or study.search is not None or study.over is not None:
        return []
    share = REFINED / max(axis.size for axis in numeric)
    return [f"`refine: true` would solve only where the outcome of this map changes: about {100.0 * share:.2g} % of it"]


def _narrow(study: Study) -> bool:
    """Whether a map is too small to be refined, so that all of it is solved."""
    return bool(study.refine) and min(axis.size for axis in study.axes if axis.name in study.refine) < 2 * CELLS


def _backend(batch: Batch) -> str:
    try:
        return choose(batch).name
    except SolverError as error:
        return str(error)


def _body(batch: Batch) -> list[Row]:
    """What the equations of motion know of the body, edge by edge, and what it was made from."""
    block = batch.block
    h, top = float(block.h[0]), float(block.top[0])
    both = {
        "b": ("b, centre of mass to edge [m]", block.b),
        "R": ("R [m]", block.R),
        "alpha": ("alpha [rad]", block.alpha),
        "alpha_deg": ("alpha [deg]", np.degrees(block.alpha)),
        "tan_alpha": ("tan alpha", block.tan_alpha),
        "g_tan_alpha": ("g tan alpha [m/s2]", batch.g[:, None] * block.tan_alpha),
        "inertia": ("I_O/(m R2)", block.inertia),
        "I_O": ("I_O [kg m2]", block.inertia * block.R**2 * block.mass[:, None]),
        "p": ("p [rad/s]", batch.p),
    }
    tall = abs(top - 2.0 * h) <= 1e-9 * h
    rows = [
        Row("mass", "mass [kg]", float(block.mass[0])),
        Row("height", "height 2h [m]", top) if tall else Row("top", "height of the top [m]", top),
        Row("width", "width of the base [m]", float(block.b[0].sum())),
        Row("h", "h, height of centre of mass [m]", h),
    ]
    if rise := float(block.rise[0]):
        rows.append(Row("rise", "right edge above the left one [m]", rise))
    if block.outline is not None:
        x, z = np.ptp(block.outline[0][np.isfinite(block.outline[0, :, 0])], axis=0)
        rows += [
            Row("outline_width", "outline, width [m]", float(x)),
            Row("outline_height", "outline, height [m]", float(z)),
        ]
    rows += _mesh(block)
    for name, (words, values) in both.items():
        rows += [Row(f"{name}{key}", f"{words}{side}", float(values[0, edge])) for key, side, edge in _edges(block)]
    r_g = float(np.sqrt((block.inertia[0, LEFT] - 1.0) * block.R[0, LEFT] ** 2))
    rows.append(Row("r_g", "r_g, radius of gyration [m]", r_g))
    if np.isfinite(mu := float(block.mu[0])):
        slides = slides_first(mu, block.tan_alpha[0])
        begins = "slide (mu <= tan alpha)" if slides.all() else "rock (mu > tan alpha)"
        begins = "slide or rock, by direction" if slides.any() and not slides.all() else begins
        rows += [Row("mu", "friction mu", mu), Row("begins", "from rest it begins to", begins)]
    rows += _rolling(block)
    return [row for row in rows if isinstance(row.value, str) or not np.isnan(row.value)]


def _rolling(block: Block) -> list[Row]:
    """Where a body that rolls over several vertices can rest and falls, and what is not asked of its friction."""
    if not block.rolls[0]:
        return []
    assert block.vertices is not None
    facets = facets_of(block.vertices[:1])
    tilts = np.degrees(facets.tilt[0][facets.stable[0]])
    rows = [
        Row("vertices", "rolls over vertices", float(facets.count[0] + 1)),
        Row("rests_deg", "can rest turned by theta [deg]", ", ".join(f"{tilt:.4g}" for tilt in tilts)),
    ]
    for side, edge in (("left", LEFT), ("right", RIGHT)):
        fall, barrier = float(np.degrees(facets.fall[0, edge])), float(facets.barrier[0, edge])
        rows += [
            Row(f"fall_deg_{side}", f"overturns beyond theta [deg], {side}", fall),
            Row(f"barrier_{side}", f"barrier on the way [m], {side}", barrier),
        ]
    if np.isfinite(block.mu[0]):
        rows.append(Row("sliding", "where mu does not suffice", "unresolved: a body that rolls is not solved sliding"))
    return rows


_OF_A_FILE, _OF_AN_ANGLE = 8, 4
"""Decimals of a coordinate [m] and of an angle [deg] beyond which a file of single precision says nothing."""


def _mesh(block: Block) -> list[Row]:
    """What the mesh tells of its body as a whole, and of the direction in which it rocks."""
    scan = block.scan
    if scan is None or block.direction is None:
        return []
    profile = scan.profile(float(block.direction[0]))
    x, y, z = (np.round(scan.centre, _OF_A_FILE) + 0.0).tolist()
    weakest = scan.profile(scan.weakest)
    turns = np.round(np.degrees(np.arccos(np.clip(-scan.poses[:, 2], -1.0, 1.0))), _OF_AN_ANGLE)
    apart = scan.poses_apart(POSES_APART)
    poses = [f"{scan.heights[i]:.4g} m ({turns[i]:.3g} deg)" for i in apart]
    more = f", {len(poses) - POSES} more" if len(poses) > POSES else ""
    return [
        Row("triangles", "mesh, triangles", float(scan.triangles)),
        Row("volume", "mesh, volume [m3]", scan.volume),
        Row("centre", "mesh, centre of mass x, y, z [m]", f"{x:.6g}, {y:.6g}, {z:.6g}"),
        Row("poses", "mesh, can rest at heights (turned by)", f"{', '.join(poses[:POSES])}{more}"),
        Row("weakest_deg", "mesh, weakest direction [deg]", float(np.degrees(scan.weakest))),
        Row("weakest_barrier", "mesh, least barrier [m]", float(weakest.barriers[RIGHT])),
        Row("weakest_tilt_deg", "mesh, tilt at it [deg]", float(np.degrees(weakest.tilts[RIGHT]))),
        Row("direction_deg", "direction, theta > 0 [deg]", float(np.degrees(block.direction[0]))),
        Row("barrier", "barrier in it [m]", float(profile.barriers[RIGHT])),
        Row("barrier_back", "barrier against it [m]", float(profile.barriers[LEFT])),
    ]


def _edges(block: Block) -> list[tuple[str, str, int]]:
    """Ends of keys and of words, and the column, of each edge; one for a symmetric body."""
    if block.symmetric[0]:
        return [("", "", LEFT)]
    return [("_left", ", left edge", LEFT), ("_right", ", right edge", RIGHT)]


def _model(batch: Batch, searched: bool) -> list[Row]:
    damping, column = batch.damping, batch.column
    rows = [Row("model", "model", batch.model)]
    if batch.model == AUTO:
        rows += [Row(*said) for said in prospect(batch, searched)]
    if batch.geometry is not None:
        rows.append(Row("geometry", "geometry", batch.geometry))
    if column is not None and np.isfinite(column.E[0]):
        rows += [
            Row("E", "column E [Pa]", float(column.E[0])),
            Row("rho", "column rho [kg/m3]", float(column.rho[0])),
            Row("zeta", "column zeta", float(column.zeta[0])),
        ]
    if batch.base is not None and batch.base.kw is not None:
        rows.append(Row("kw", "base kw [N/m3]", float(batch.base.kw[0])))
    rows.append(Row("damping", "damping", damping.scheme))
    if SCHEMES[damping.scheme].impacts:
        rows += [Row(f"eta{key}", f"eta{side}", float(damping.eta[0, edge])) for key, side, edge in _edges(batch.block)]
    if damping.coefficient is not None:
        rows.append(Row("coefficient", "dashpot coefficient", float(damping.coefficient[0])))
    if damping.alpha_d is not None:
        rows.append(Row("alpha_d", "hht alpha_d", float(damping.alpha_d[0])))
    rows += [
        Row("theta_0", "initial theta [rad]", float(batch.theta_0[0])),
        Row("theta_dot_0", "initial angular velocity [rad/s]", float(batch.theta_dot_0[0])),
    ]
    return rows


def _motion(batch: Batch) -> list[Row]:
    """Uplift at g tan(alpha), or g alpha of the linearized block; measures of the motion as it is used."""
    block, pair = batch.block, (batch.model, batch.geometry)
    alpha, tan_alpha = block.of_weak_edge(block.alpha)[:1], block.of_weak_edge(block.tan_alpha)[:1]
    uplift = float((MODELS[pair].law(alpha, tan_alpha).threshold if pair in MODELS else tan_alpha)[0])
    words = uplift_words(deforms=highest(batch).model in DEFORMABLE, vertical=batch.excitation.vertical is not None)
    factor = float(factor_of(batch)[0])  # NaN: FEMA-356 asks a spectrum, not the PGA
    rows = [] if np.isnan(factor) else [Row("uplift_g", words, uplift * factor)]
    rows += _channel(batch, batch.excitation.horizontal, uplift, "")
    if batch.excitation.vertical is not None:
        rows += _channel(batch, batch.excitation.vertical, None, "vertical ")
    if np.isfinite(duration := float(batch.excitation.duration[0])):
        rows.append(Row("duration", "duration [s]", duration))
    return rows


def _channel(batch: Batch, channel: Channel | None, uplift: float | None, which: str) -> list[Row]:
    key = which.replace(" ", "_")
    if channel is None:
        return [Row(f"{key}motion", f"{which}motion", "none (free rocking)")]
    g = float(batch.g[0])
    pga, pgv = _peaks(batch, channel)
    ground = channel.ground if isinstance(channel, Samples) else None
    whose = "" if ground is None else " of what arrives at the body"
    if isinstance(channel, Pulses):
        rows = [
            Row(f"{key}motion", f"{which}motion", f"{channel.shape} pulse"),
            Row(f"{key}a_p", f"{which}a_p [m/s2]", float(channel.a_p[0])),
            Row(f"{key}a_p_g", f"{which}a_p [g]", float(channel.a_p[0]) / g),
            Row(f"{key}omega_p", f"{which}omega_p [rad/s]", float(channel.omega_p[0])),
        ]
    else:
        rows = _record(channel, g, which, key)
    if ground is not None:
        below, rate = _peaks(batch, ground)
        rows += [
            Row(f"{key}pga_ground", f"{which}PGA of the ground [m/s2]", below),
            Row(f"{key}pga_ground_g", f"{which}PGA of the ground [g]", below / g),
            Row(f"{key}pgv_ground", f"{which}PGV of the ground [m/s]", rate),
        ]
    rows += [
        Row(f"{key}pga", f"{which}PGA{whose} [m/s2]", pga),
        Row(f"{key}pga_g", f"{which}PGA{whose} [g]", pga / g),
        Row(f"{key}pgv", f"{which}PGV{whose} [m/s]", pgv),
    ]
    if uplift is not None:
        angle = "alpha" if batch.model == "linearized" else "tan alpha"
        rows.append(Row("pga_over_uplift", f"PGA{whose} over g {angle}", pga / (g * uplift)))
    return rows


def _peaks(batch: Batch, channel: Channel) -> tuple[float, float]:
    """PGA [m/s2] and PGV [m/s] of the first case."""
    pga, pgv = peaks(channel, batch.size, batch.excitation.duration)
    return float(pga[0]), float(pgv[0])


def _record(samples: Samples, g: float, which: str, key: str) -> list[Row]:
    raw = samples.measures
    in_file = [
        Row(f"{key}pga_raw_g", f"{which}PGA in the file [g]", raw.get("pga_raw", np.nan) / g),
        Row(f"{key}pgv_raw", f"{which}PGV in the file [m/s]", raw.get("pgv_raw", np.nan)),
        Row(f"{key}factor", f"{which}factor", float(samples.factor[0])),
    ]
    return [
        Row(f"{key}motion", f"{which}motion", samples.name),
        Row(f"{key}dt", f"{which}time step [s]", samples.dt),
        Row(f"{key}end", f"{which}length [s]", samples.end),
        *(in_file if samples.files else ()),
    ]
