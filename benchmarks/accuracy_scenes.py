"""The fixed sets of scenes on which the named accuracies are measured (accuracy_levels.py)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from rockcli.motion.reading import read_record
from rockcli.scene.batch import Batch, Save
from rockcli.scene.body.block import housner_eta, make_block
from rockcli.scene.body.column import Column
from rockcli.scene.ground.excitation import Excitation, Samples
from rockcli.scene.ground.pulses import make_pulses
from rockcli.scene.laws.damping import Damping
from rockcli.scene.numerics import Numerics

G = 9.81
PULSES = {2.0: (3.0, 4.44), 5.0: (2.0, 2.66), 10.0: (1.4, 1.905)}
"""R [m]: omega_p over pi of the Ricker and of the sine pulse (the thesis's Figs 7-16)."""

MOTIONS = (
    "P695FF01_NORTHR_MUL009", "P695FF06_DUZCE_BOL090", "P695FF12_KOBE_NIS090", "P695FF21_LANDERS_CLW-LN",
    "P695FF27_SUPERST_B-ICC000", "P695FF44_HECTOR_HEC090", "RSN6_IMPVALL.I_I-ELC180", "RSN77_SFERN_PUL164",
    "RSN143_TABAS_TAB-L1", "RSN169_IMPVALL.H_H-DLT352", "RSN171_IMPVALL.H_H-EMO270", "RSN182_IMPVALL.H_H-E07230",
    "RSN292_ITALY_A-STU000", "RSN723_SUPER.B_B-PTS225", "RSN738_LOMAP_NAS180", "RSN828_CAPEMEND_PET090",
    "RSN1063_NORTHR_RRS228", "RSN1106_KOBE_KJM000", "RSN1503_CHICHI_TCU065-E", "RSN4040_BAM_BAM-L",
)  # fmt: skip
"""Recorded motions: near and far from the fault, 9 to 100 s long."""

NOTHING_SAVED = Save(False, 0.01, frozenset())


def batch_of(R, tan_alpha, motion: Excitation, *, eta=None, theta_0=0.0, model="rigid", geometry=None) -> Batch:
    """Blocks (n,) under a motion; Housner's restitution unless eta is given."""
    n = len(motion.duration)
    R, tan_alpha = np.broadcast_to(R, n).astype(float), np.broadcast_to(tan_alpha, n).astype(float)
    alpha = np.arctan(tan_alpha)
    body = make_block(h=R * np.cos(alpha), b=R * np.sin(alpha), R=R, alpha=alpha, tan_alpha=tan_alpha, n=n)
    ratio = np.maximum(housner_eta(body), 0.0) if eta is None else np.full((n, 2), eta)
    return Batch(
        g=np.full(n, G),
        block=body,
        excitation=motion,
        theta_0=np.broadcast_to(theta_0, n) * alpha,
        theta_dot_0=np.zeros(n),
        model=model,
        geometry=geometry,
        damping=Damping("restitution", ratio),
        numerics=Numerics(),
        save=NOTHING_SAVED,
    )


def pulse(shape: str, a_p, omega_p, cycles: float | None = None) -> Excitation:
    a_p, omega_p = np.broadcast_arrays(np.atleast_1d(a_p).astype(float), np.atleast_1d(omega_p).astype(float))
    more = {} if cycles is None else {"cycles": np.full(len(a_p), cycles)}
    return Excitation(
        make_pulses(shape, a_p=a_p.copy(), omega_p=omega_p.copy(), **more), None, np.full(len(a_p), np.nan)
    )


def pulses() -> Iterator[Batch]:
    """The thesis's pulses at forty amplitudes, as the block and as models 1 and 3."""
    for R, both in PULSES.items():
        for shape, over_pi in zip(("ricker", "sine"), both, strict=True):
            tan_alpha = np.repeat([0.1, 0.2, 0.333], 40)
            a_p = G * tan_alpha * np.tile(np.linspace(1.1, 4.5, 40), 3)
            for model, geometry in (("rigid", None), ("1", "negative_stiffness"), ("3", "corotational")):
                yield batch_of(R, tan_alpha, pulse(shape, a_p, over_pi * np.pi), model=model, geometry=geometry)


def pulse_map() -> Iterator[Batch]:
    """200 x 200 over amplitude and frequency of a Ricker pulse: mostly plain, with every boundary in it."""
    p, tan_alpha = np.sqrt(3.0 * G / 8.0), 0.2
    a_p, omega_p = np.meshgrid(np.linspace(1.0, 12.0, 200) * G * tan_alpha, np.linspace(0.5, 8.0, 200) * p)
    yield batch_of(2.0, tan_alpha, pulse("ricker", a_p.ravel(), omega_p.ravel()))


def records(paths: list[Path], scales) -> Iterator[Batch]:
    """Two blocks under each motion, at PGA of some times g tan(alpha)."""
    for path in paths:
        motion = read_record(path)
        values = motion.acceleration(G)
        for R, tan_alpha in ((2.0, 0.2), (5.0, 0.1)):
            factor = np.asarray(scales) * G * tan_alpha / np.abs(values).max()
            yield batch_of(
                R, tan_alpha, Excitation(Samples(values, motion.dt, factor), None, np.full(len(factor), np.nan))
            )


def near_boundary(overturns: Callable[[Batch], np.ndarray]) -> Iterator[Batch]:
    """Amplitudes 1e-3 ... 1e-9 on both sides of the first that overturns, found by bisection."""
    for R, (ricker, _) in PULSES.items():
        for tan_alpha in (0.1, 0.2, 0.333):

            def at(times, R=R, tan_alpha=tan_alpha, ricker=ricker) -> Batch:
                a_p = np.atleast_1d(times) * G * tan_alpha
                return batch_of(R, tan_alpha, pulse("ricker", a_p, ricker * np.pi))

            grid = np.linspace(1.0, 12.0, 400)
            first = int(np.argmax(overturns(at(grid))))
            low, high = grid[first - 1], grid[first]
            for _ in range(45):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if overturns(at(middle))[0] else (middle, high)
            beside = np.concatenate([[-d, d] for d in 10.0 ** np.linspace(-3.0, -9.0, 57)])
            yield at(high * (1.0 + beside))


def chatter() -> Iterator[Batch]:
    """Long trains of impacts under ten cycles: from barely uplifted to twice that, from strongly to hardly damped."""
    amplitudes = np.concatenate([1.0 + np.geomspace(0.01, 1.0, 29), [1.05, 1.2, 1.5]])
    times, over_p = np.meshgrid(amplitudes, np.geomspace(2.0, 16.0, 31))
    a_p, omega_p = G * 0.2 * times.ravel(), np.sqrt(3.0 * G / 8.0) * over_p.ravel()
    for eta in (0.3, 0.45, 0.6, 0.75, 0.9, 0.95):
        for shape in ("cosine", "sine"):
            yield batch_of(2.0, 0.2, pulse(shape, a_p, omega_p, 10.0), eta=eta)


def chaotic_trains() -> Iterator[Batch]:
    """Ten cycles just above what uplifts a slender body that keeps its energy: here most motions forget their start."""
    a_p = G * 0.1 * np.linspace(1.02, 1.10, 1500)
    for shape in ("cosine", "sine"):
        yield batch_of(2.0, 0.1, pulse(shape, a_p, 2.0 * np.sqrt(3.0 * G / 8.0), 10.0), eta=0.9)


def columns() -> Iterator[Batch]:
    """Flexible columns of 50 x 5 m, two stiffnesses with and without damping."""
    for E, zeta in ((5e9, 0.0), (5e9, 0.02), (30e9, 0.02)):
        for shape in ("ricker", "sine"):
            a_p = G * 0.1 * np.linspace(2.0, 5.0, 40)
            batch = batch_of(25.125, 0.1, pulse(shape, a_p, 2.0 * np.pi / 1.6), model="flexible")
            ones = np.ones(len(a_p))
            yield replace(batch, column=Column(E=E * ones, rho=2500.0 * ones, zeta=zeta * ones))


def found_motions(folder: Path) -> list[Path]:
    """The files of MOTIONS in a folder and those below it."""
    files = {path.stem: path for path in sorted(folder.rglob("*.AT2"))}
    missing = [name for name in MOTIONS if name not in files]
    if missing:
        raise SystemExit(f"{folder} lacks {', '.join(missing)}")
    return [files[name] for name in MOTIONS]
