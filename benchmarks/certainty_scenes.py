"""Random scenes by family, the same ones every time, on which certainty is measured (certainty.py)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from accuracy_scenes import NOTHING_SAVED, G

from rockcli.motion.reading import read_record
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import Block, housner_eta, make_block
from rockcli.scene.ground.excitation import Channel, Excitation, Samples
from rockcli.scene.ground.pulses import make_pulses
from rockcli.scene.laws.damping import Damping
from rockcli.scene.numerics import Numerics

SHAPES = ("ricker", "sine", "cosine", "rectangular")
RATIO = 5.0
"""Largest ratio of the two edges of an asymmetric body."""


def bodies(rng: np.random.Generator, n: int, *, asymmetric: bool = False) -> Block:
    """Heights .2 to 10 m, tan(alpha) .05 to .5; of asymmetric ones the other edge up to RATIO times as far."""
    h, tan_alpha = np.exp(rng.uniform(np.log(0.2), np.log(10.0), n)), np.exp(rng.uniform(np.log(0.05), np.log(0.5), n))
    if not asymmetric:
        return make_block(h=h, b=h * tan_alpha, n=n)
    ratio = np.exp(rng.uniform(0.0, np.log(RATIO), n))
    both = np.column_stack([np.ones(n), ratio]) * (h * tan_alpha)[:, None]
    turned = rng.random(n) < 0.5
    both[turned] = both[turned, ::-1]
    return make_block(h=h, b=both, r_g=h * rng.uniform(0.4, 0.8, n), n=n)


def batch_of(body: Block, motion: Excitation, *, eta: float | None = None, theta_0=0.0) -> Batch:
    """Housner's restitution unless eta is given."""
    n = body.size
    ratio = np.clip(housner_eta(body), 0.0, 1.0) if eta is None else np.full((n, 2), eta)
    return Batch(
        g=np.full(n, G),
        block=body,
        excitation=motion,
        theta_0=np.broadcast_to(theta_0, n).astype(float),
        theta_dot_0=np.zeros(n),
        model="rigid",
        geometry=None,
        damping=Damping("restitution", np.ascontiguousarray(ratio)),
        numerics=Numerics(),
        save=NOTHING_SAVED,
    )


def excited(horizontal: Channel | None, n: int, vertical: Channel | None = None) -> Excitation:
    """No duration given."""
    return Excitation(horizontal, vertical, np.full(n, np.nan))


def uplift(body: Block) -> np.ndarray:
    """Horizontal acceleration that lifts each body (n,) [m/s^2]."""
    return np.asarray(G * body.of_weak_edge(body.tan_alpha))


def pulse(rng: np.random.Generator, body: Block, shape: str, most: float = 8.0, **options) -> Excitation:
    """Amplitudes 1.02 to `most` times what uplifts, omega_p/p 1 to 15."""
    n = body.size
    a_p = uplift(body) * np.exp(rng.uniform(np.log(1.02), np.log(most), n))
    p = body.p(np.full(n, G)).min(axis=1)
    omega_p = p * np.exp(rng.uniform(0.0, np.log(15.0), n))
    return excited(make_pulses(shape, a_p=a_p, omega_p=omega_p, **options), n)


def pulses(rng: np.random.Generator, n: int, *, asymmetric: bool = False, eta: float | None = None) -> Iterator[Batch]:
    """One of several shapes."""
    for shape in SHAPES:
        body = bodies(rng, n // len(SHAPES), asymmetric=asymmetric)
        yield batch_of(body, pulse(rng, body, shape), eta=eta)


def trains(rng: np.random.Generator, n: int, *, asymmetric: bool = False, eta: float | None = None) -> Iterator[Batch]:
    """3 to 15 cycles of a sine or a cosine, to twice what uplifts."""
    for shape in ("sine", "cosine"):
        body = bodies(rng, n // 2, asymmetric=asymmetric)
        cycles = rng.integers(3, 16, body.size).astype(float)
        yield batch_of(body, pulse(rng, body, shape, 2.0, cycles=cycles), eta=eta)


def free(rng: np.random.Generator, n: int) -> Iterator[Batch]:
    """Asymmetric bodies let go on still ground, on either side."""
    body = bodies(rng, n, asymmetric=True)
    side = rng.integers(0, 2, n)
    alpha = body.alpha[np.arange(n), side]
    yield batch_of(body, excited(None, n), theta_0=np.where(side == 0, -1.0, 1.0) * alpha * rng.uniform(0.05, 0.98, n))


def records(
    rng: np.random.Generator, n: int, paths: list[Path], *, vertical: bool = False, asymmetric: bool = False
) -> Iterator[Batch]:
    """Records at 1.02 to 4 times what uplifts; `vertical`: another record upward, at .2 to .8 of the horizontal one."""
    motions = [(m.acceleration(G), m.dt) for m in map(read_record, paths)]
    each = max(n // len(motions), 1)
    for i, (values, dt) in enumerate(motions):
        body = bodies(rng, each, asymmetric=asymmetric)
        pga = uplift(body) * np.exp(rng.uniform(np.log(1.02), np.log(4.0), each))
        up = None
        if vertical:
            other, other_dt = motions[(i + 1) % len(motions)]
            up = Samples(other, other_dt, pga * rng.uniform(0.2, 0.8, each) / np.abs(other).max())
        yield batch_of(body, excited(Samples(values, dt, pga / np.abs(values).max()), each, up))


def asymmetric(rng: np.random.Generator, n: int, paths: list[Path]) -> Iterator[Batch]:
    """Under pulses, trains and records, and let go."""
    yield from pulses(rng, n // 4, asymmetric=True)
    yield from trains(rng, n // 4, asymmetric=True)
    yield from records(rng, n // 4, paths, asymmetric=True)
    yield from free(rng, n // 4)


def undamped(rng: np.random.Generator, n: int) -> Iterator[Batch]:
    """Bodies that lose nothing at impacts, under pulses and trains."""
    yield from pulses(rng, n // 2, eta=1.0)
    yield from trains(rng, n - n // 2, eta=1.0)


def families(n: int, paths: list[Path], seed: int = 15) -> dict[str, list[Batch]]:
    """Family -> batches of about n cases altogether; another seed gives other ones."""
    makers = {
        "pulses": pulses,
        "trains of cycles": trains,
        "undamped": undamped,
        "records": lambda rng, n: records(rng, n, paths),
        "records with vertical": lambda rng, n: records(rng, n, paths, vertical=True),
        "asymmetric": lambda rng, n: asymmetric(rng, n, paths),
    }
    return {name: list(make(np.random.default_rng([seed, i]), n)) for i, (name, make) in enumerate(makers.items())}


def at(batch: Batch, accuracy: str, **more) -> Batch:
    """A batch at an accuracy."""
    return replace(batch, numerics=Numerics(accuracy=accuracy), **more)
