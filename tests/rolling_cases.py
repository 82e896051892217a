"""Random convex outlines under pulses and records, compared with an independent march (`rolling_reference`)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rolling_reference import Rock, roll
from scipy.spatial import ConvexHull

from rockcli.errors import StudyError
from rockcli.scene.ground.excitation import Pulses, Samples, acceleration
from rockcli.scene.response import overturned
from rockcli.solvers.event.solver import solve
from rockcli.solvers.rolling.pack import facets_in
from rockcli.study.open import open_study

SHAPES = ("sine", "ricker", "cosine", "ricker_antisymmetric", "half_sine")


FOUND = (
    "outcome", "theta_peak", "t_peak", "t_uplift", "n_impacts", "residual_tilt", "theta_peak_left", "theta_peak_right",
    "u_top_peak",
)  # fmt: skip

PATH = ("theta_dot_peak", "mu_required", "mu_impact", "N_min_over_mg", "energy_residual", "t_overturn", "t_end")
"""What else lanes find where they follow the path of a body to its end."""


def random_outline(rng):
    """A base, up to three facets that rise on each side of it, and a top: the hull of them, (k, 2)."""
    width, top = rng.uniform(0.15, 0.5), rng.uniform(0.6, 2.0)
    base = rng.uniform(0.3, 1.0, 2) * width * [-1.0, 1.0]
    points = [(x, 0.0) for x in base]
    for side, x in zip((-1.0, 1.0), base, strict=True):
        z = angle = 0.0
        for _ in range(int(rng.integers(0, 4))):
            angle += rng.uniform(0.05, 0.5)
            length = rng.uniform(0.05, 0.25)
            x, z = x + side * length * np.cos(angle), z + length * np.sin(angle)
            points.append((x, z))
    xs, z = [p[0] for p in points], max(p[1] for p in points)
    points += [(0.8 * max(xs), z + top), (0.8 * min(xs), z + top)]
    return np.array(points)[ConvexHull(points).vertices]


def random_case(seed, record=None):
    """A batch of one body that rolls, under a record of noise or a pulse; if not said, every third a record."""
    record = seed % 3 == 2 if record is None else record
    rng = np.random.default_rng(seed)
    while True:
        outline = random_outline(rng)
        strength, period = rng.uniform(1.2, 5.0), rng.uniform(0.3, 1.5)
        noise = np.cumsum(rng.normal(size=300))
        shape = str(rng.choice(SHAPES))
        motion = {"pulse": {"shape": shape, "a_p": f"{strength}*g*tan_alpha", "T_p": period}}
        if record:
            noise = np.convolve(noise - np.linspace(noise[0], noise[-1], 300), np.ones(9) / 9, mode="same")
            noise *= np.hanning(300) / np.abs(noise).max()
        case = {"block": {"outline": outline.tolist(), "stands": "settled"}, "motion": motion}
        try:
            ((_, batch),) = open_study({"name": "a", "case": case}).batches()
        except StudyError:
            continue
        if not batch.block.rolls.all():
            continue
        if record:
            pga = 0.7 * strength * 9.81 * batch.block.tan_alpha.min()
            record = Samples(noise, 0.02, np.array([pga]), name="noise")
            batch = replace(batch, excitation=replace(batch.excitation, horizontal=record))
        return batch


def reference(batch, finer=1, report=np.inf):
    vertices = batch.block.vertices[0]
    rock = Rock(vertices[np.isfinite(vertices[:, 0])], np.sqrt(batch.block.r_g2[0]))
    channel = batch.excitation.horizontal
    if isinstance(channel, Pulses):
        breaks = sorted({float(x) for row in channel.table[0] for x in row[:2]} - {0.0})

        def motion(t, middle):
            after, before = [b for b in breaks if b > middle], [b for b in breaks if b <= middle]
            t = min(max(t, (before[-1] if before else 0.0) + 1e-13), (after[0] if after else np.inf) - 1e-13)
            return float(acceleration(channel, np.array([t]), 0)[0]), 0.0

        return roll(rock, motion, breaks, float(np.max(channel.end)), finer=finer, report=report)
    values, dt = np.asarray(channel.values * channel.factor[0]), channel.dt
    breaks = [i * dt for i in range(1, len(values))]

    def sampled(t, middle):
        i = int(middle / dt)
        if i >= len(values) - 1:
            return 0.0, 0.0
        return values[i] + (values[i + 1] - values[i]) * (t - i * dt) / dt, 0.0

    return roll(rock, sampled, breaks, breaks[-1], linear=True, finer=finer, report=report)


def looked_at(ours):
    """Until when the forces of a body count."""
    return min(ours["t_end"], ours["t_overturn"]) if overturned(ours["outcome"]) else ours["t_end"]


def compare_forces(ours, theirs, seed):
    """Of a body that falls, forces up to its passage of the last barrier alone (`looked_at`)."""
    assert ours["N_min_over_mg"] == pytest.approx(theirs.normal, rel=1e-5, abs=1e-5), seed
    if theirs.normal > 0.05:
        assert ours["mu_required"] == pytest.approx(theirs.friction, rel=1e-5), seed
    if theirs.fell:
        return
    assert ours["theta_dot_peak"] == pytest.approx(theirs.rate, rel=1e-6, abs=1e-9), seed
    assert ours["mu_impact"] == pytest.approx(theirs.push, rel=1e-9), seed


def compare(seed):
    batch = random_case(seed)
    ours = {name: values[0] for name, values in solve(batch).scalars.items()}
    theirs = reference(batch, report=looked_at(ours))
    if not theirs.fell and abs(abs(ours["theta_peak"]) - theirs.peak) > 1e-8:
        theirs = reference(batch, 10, looked_at(ours))  # a facet touched and left within one step
    if 0.0 < ours["overturn_share"] < 1.0 or ours["error_estimate"] > 1e-7:
        return "chaos"
    assert bool(overturned(ours["outcome"])) == theirs.fell, seed
    assert abs(ours["energy_residual"]) < 1e-9, seed
    compare_forces(ours, theirs, seed)
    if not theirs.fell:
        assert abs(abs(ours["theta_peak"]) - theirs.peak) < 1e-8, seed
        assert abs(ours["theta_peak_left"] - theirs.peak_left) < 1e-8, seed
        if theirs.rested:
            assert ours["residual_tilt"] == pytest.approx(theirs.theta, abs=1e-9), seed
        else:
            return "rocks on"  # longer than the reference has followed it
    return "falls" if theirs.fell else "elsewhere" if abs(theirs.theta) > 1e-6 else "stands"


def in_lanes(batch, scalars=FOUND):
    some = replace(batch, save=replace(batch.save, histories=False, scalars=frozenset(scalars)))
    response = solve(some)
    assert "lanes" in response.used["method"]
    return response.scalars


def compare_with_march(seed, record=False, path=False):
    batch = random_case(seed, record)
    ours = {name: values[0] for name, values in in_lanes(batch, FOUND + PATH if path else FOUND).items()}
    report = looked_at(ours) if path else np.inf
    theirs = reference(batch, report=report)
    if not theirs.fell and abs(abs(ours["theta_peak"]) - theirs.peak) > 1e-8:
        theirs = reference(batch, 10, report)
    assert bool(overturned(ours["outcome"])) == theirs.fell, seed
    if path:
        barrier = facets_in(batch).barrier  # the residual is told over the least, which may be next to nothing
        assert abs(ours["energy_residual"]) * barrier.min() < 1e-9 * barrier.max(), seed
        compare_forces(ours, theirs, seed)
    if not theirs.fell:
        assert abs(abs(ours["theta_peak"]) - theirs.peak) < 1e-8, seed
        assert abs(ours["theta_peak_left"] - theirs.peak_left) < 1e-8, seed
        if theirs.rested:
            assert ours["residual_tilt"] == pytest.approx(theirs.theta, abs=1e-9), seed
