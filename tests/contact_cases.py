"""The contact kernel run by hand: parameters, motions and results of one case."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scenes import SHARED

from rockcli import kernels
from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import results as to
from rockcli.kernels.handover import N_HANDOVER
from rockcli.motion.at2 import parse_at2
from rockcli.scene.ground.excitation import BELL, LINEAR, PIECE_WIDTH, WAVES

MODES = ["rest", "slide", "rock", "slide_rock", "flight"]
G = 9.81
NOTHING = (0, 1.0, 0, [0.0])


def kernel(name: str):
    """A module of contact kernels, compiled if the tests run compiled anyhow."""
    return kernels.load(f"contact.{name}", compile_them=False)


def array(values):
    """Numbers as the kernels take them: compiled code has no lists."""
    kernel("march")  # which decides how they run
    return np.array(values, dtype=float) if kernels.compiled else list(values)


def table(*shape):
    nothing = np.full(shape, np.nan)
    return nothing if kernels.compiled else nothing.tolist()


def body(b, h=1.0, mu=0.5, *, mu_k=None, eta=None, e_n=0.0, r_g2=None, g=G, t_motion=0.0, **initial):
    """Parameters of a rectangle, or of a body with two edge distances b = (left, right) and a radius of gyration."""
    left, right = b if isinstance(b, tuple) else (b, b)
    par = [0.0] * at.N_PAR
    par[at.G], par[at.H], par[at.E_N], par[at.TOP] = g, h, e_n, 2 * h
    par[at.RG2] = (0.25 * (left + right) ** 2 + h * h) / 3 if r_g2 is None else r_g2
    par[at.MU_S], par[at.MU_K] = mu, mu if mu_k is None else mu_k
    for edge, b_j, b_i in ((at.LEFT, left, right), (at.RIGHT, right, left)):
        par[edge + at.B], par[edge + at.ALPHA], par[edge + at.RADIUS] = b_j, math.atan2(b_j, h), math.hypot(b_j, h)
        par[edge + at.PLACE] = b_j if eta is None else (par[at.RG2] + h * h) * (1 - eta) / (b_i + eta * b_j)
    for name, value in initial.items():
        par[getattr(at, name.upper())] = value
    par[at.T_MOTION] = t_motion
    par[at.T_STOP] = t_motion + 20 * math.sqrt(math.hypot(min(left, right), h) / (0.75 * g))
    par[at.FACTOR_H] = par[at.FACTOR_V] = 1.0
    return par


def piece(t_end, kind, *numbers):
    row = [0.0] * PIECE_WIDTH
    row[1], row[2] = t_end, kind
    row[3 : 3 + len(numbers)] = numbers
    return (2, 1.0, 1, row)


def motion(words: str):
    """A channel (kind, dt, pieces, data) from words: `sine a_p omega t_end`, `constant a t_end`, `FILE first last factor`, or nothing."""
    if not words:
        return NOTHING
    kind, *numbers = words.split()
    x = [float(n) for n in numbers]
    if kind == "constant":
        return piece(x[1], LINEAR, x[0])
    if kind in ("sine", "cosine"):
        return piece(x[2], WAVES, 0.0, x[0], x[1], 0.0 if kind == "sine" else 0.5 * math.pi)
    if kind == "ricker":
        return piece(x[3], BELL, x[2], x[1] / math.sqrt(2), x[0], 0.0, -x[0], 0.0)
    path = SHARED / "records" / kind
    found = parse_at2(path.read_bytes(), path.name)
    values = [float(v) * x[2] for v in found.values[int(x[0]) : int(x[1]) + 1]]
    tail = np.maximum.accumulate(np.abs(values)[::-1])[::-1]
    return (1, float(found.dt), len(values) - 1, [*values, *tail])


@dataclass
class Run:
    out: list
    t: list
    modes: list
    histories: dict
    impacts: list

    def __getitem__(self, name: str) -> float:
        return float(self.out[getattr(to, name)])


def run(
    par, horizontal=NOTHING, vertical=NOTHING, *, tol=1e-16, order=24, rest_speed=1e-9, dt=1.0, n=0, watched=True
) -> Run:
    """Solve a case; one that is not `watched` tells no modes, and free swings are left out."""
    march = kernel("march")
    out, events = array([[0.0] * to.N_OUT]), table(1, 2, 4000 if watched else 0)
    names = ("theta", "theta_dot", "slide", "slide_dot", "contact_mode", "lift")
    histories, impacts = table(1, 6, n), table(1, 3, 1000)
    channels = []
    for kind, spacing, pieces, data in (horizontal, vertical):
        channels += [march.Channel(kind, spacing, pieces), array([data])]
    how = march.Settings(
        tol=tol, rest_speed=rest_speed, max_steps=1_000_000, order=order, balance=True, extremes=True, hands_back=False
    )
    starts = array([[-1.0] * N_HANDOVER])
    march.march_all(
        array([par]),
        how,
        *channels,
        dt,
        starts,
        histories,
        impacts,
        events,
        march.work_space(),
        out,
    )
    (out,), (histories,), (impacts,), ((t, modes),) = out, histories, impacts, events
    n_events = min(int(out[to.N_EVENTS]), len(t))
    found = [MODES[int(m)] for m in modes[:n_events]]
    count = int(out[to.IMPACTS_STORED])
    by_name = dict(zip(names, histories, strict=True))
    return Run(out, list(t[:n_events]), found, by_name, [list(x[:count]) for x in impacts])


def scenes() -> list[dict[str, str]]:
    """The rows of `scenes.csv`."""
    with (Path(__file__).parent / "contact" / "scenes.csv").open(newline="") as file:
        return list(csv.DictReader(file))
