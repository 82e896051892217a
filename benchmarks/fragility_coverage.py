"""How often the 95 % limits of a fragility curve hold the true value, in synthetic suites.

    python benchmarks/fragility_coverage.py [SUITES [PART OF A NAME]]

Capacities are lognormal above x_0 and those of a member at every intensity, so that stripes are not independent.  Told
of are the medians of three nested states (stripes and clouds), of searched thresholds of which a third lies above the
range, their beta, the exponent of a second intensity, and the 1 and 5 % values; beside them how often curves of
suites that they describe are said to miss them.  Writes results/fragility_coverage.csv, or of it the rows of the names
asked for.
"""

from __future__ import annotations

import csv
import sys
from datetime import date
from pathlib import Path

import numpy as np
from machine import machine
from scipy.stats import norm

from rockcli.analysis.fragility.curves import Curves, Seen, curve_of_capacities, curves
from rockcli.analysis.fragility.misfit import LEVEL

HERE = Path(__file__).resolve().parent
X = np.linspace(0.5, 8.0, 30)
MEDIANS, BETA, EXPONENT = np.array([2.0, 3.0, 4.0]), 0.5, 0.8


def capacities(rng: np.random.Generator, n: int, begins: float) -> np.ndarray:
    return begins + (MEDIANS - begins) * np.exp(BETA * rng.standard_normal((n, 1)))


def of_stripes(rng: np.random.Generator, n: int, begins: float) -> Curves:
    category = (capacities(rng, n, begins)[:, :, None] < X).sum(axis=1)
    x = np.broadcast_to(X, category.shape)
    return curves(Seen(x, category, category, np.ones(x.shape)), 3, begins_at=begins)


def of_a_cloud(rng: np.random.Generator, n: int, begins: float) -> Curves:
    x = np.exp(np.log(3.0) + 0.6 * rng.standard_normal((n, 1))) + begins
    category = (capacities(rng, n, begins) < x).sum(axis=1)[:, None]
    return curves(Seen(x, category, category, np.ones(x.shape)), 3, begins_at=begins)


def of_thresholds(rng: np.random.Generator, n: int, begins: float, *, cut: bool) -> Curves:
    x = capacities(rng, n, begins)[:, 1]
    top = begins + (MEDIANS[1] - begins) * np.exp(0.43 * BETA) if cut else np.inf
    return curve_of_capacities(np.minimum(x, top), np.where(x > top, np.inf, x), np.arange(n), begins)


def stripes(rng: np.random.Generator, n: int, begins: float) -> list[bool]:
    return held_medians(of_stripes(rng, n, begins))


def cloud(rng: np.random.Generator, n: int, begins: float) -> list[bool]:
    return held_medians(of_a_cloud(rng, n, begins))


def held_medians(found: Curves) -> list[bool]:
    low, high = found.median_limits()
    return ((low <= MEDIANS) & (high >= MEDIANS)).tolist()


def searched(rng: np.random.Generator, n: int, begins: float) -> list[bool]:
    low, high = of_thresholds(rng, n, begins, cut=True).median_limits()
    return [bool(low[0] <= MEDIANS[1] <= high[0])]


def beta_of_stripes(rng: np.random.Generator, n: int, begins: float) -> list[bool]:
    return held_beta(of_stripes(rng, n, begins))


def beta_of_a_cloud(rng: np.random.Generator, n: int, begins: float) -> list[bool]:
    return held_beta(of_a_cloud(rng, n, begins))


def beta_searched(rng: np.random.Generator, n: int, begins: float) -> list[bool]:
    return held_beta(of_thresholds(rng, n, begins, cut=False))


def beta_searched_cut(rng: np.random.Generator, n: int, begins: float) -> list[bool]:
    return held_beta(of_thresholds(rng, n, begins, cut=True))


def held_beta(found: Curves) -> list[bool]:
    low, high = found.beta_limits()
    return [bool(low[0] <= BETA <= high[0])]


def exponent(rng: np.random.Generator, n: int, begins: float) -> list[bool]:
    y = np.exp(0.5 * rng.standard_normal((n, 1)))
    category = (begins + (capacities(rng, n, begins)[:, 1:2] - begins) * y**-EXPONENT < X).astype(int)
    x = np.broadcast_to(X, category.shape)
    seen = Seen(x, category, category, np.ones(x.shape), second=np.broadcast_to(y, x.shape))
    low, high = curves(seen, 1, begins_at=begins).exponent_limits()
    return [bool(low[0] <= EXPONENT <= high[0])]


def small_percentiles(rng: np.random.Generator, n: int, begins: float) -> list[bool]:
    low, high = of_stripes(rng, n, begins).percentile_limits(0.0)
    return held_percentiles(low[1], high[1], begins)


def close_states(rng: np.random.Generator, n: int, begins: float) -> list[bool]:
    """The second and the third state at MEDIANS[1], a twentieth apart, so that few members are seen between them."""
    capacity = capacities(rng, n, begins)[:, [0, 1, 1]] * np.array([1.0, 1.0, 1.05])
    category = (capacity[:, :, None] < X).sum(axis=1)
    x = np.broadcast_to(X, category.shape)
    low, high = curves(Seen(x, category, category, np.ones(x.shape)), 3, begins_at=begins).percentile_limits(0.0)
    return held_percentiles(low[1], high[1], begins)


def small_percentiles_searched(rng: np.random.Generator, n: int, begins: float) -> list[bool]:
    low, high = of_thresholds(rng, n, begins, cut=False).percentile_limits(0.0)
    return held_percentiles(low[0], high[0], begins)


def held_percentiles(low: np.ndarray, high: np.ndarray, begins: float) -> list[bool]:
    """Of 1 and 5 %, the first of PERCENTILES."""
    true = begins + (MEDIANS[1] - begins) * np.exp(BETA * norm.ppf([0.01, 0.05]))
    return ((low[:2] <= true) & (high[:2] >= true)).tolist()


def not_missed(rng: np.random.Generator, n: int, begins: float) -> list[bool]:
    return (of_stripes(rng, n, begins).misfit_p >= LEVEL).tolist()


def missed(rng: np.random.Generator, n: int, begins: float) -> list[bool]:
    """Capacities of two kinds: a third of the members exceed at x_0 + 1, the others at x_0 + 4."""
    kind = rng.random(n) < 0.35
    capacity = begins + np.where(kind, 1.0, 4.0) * np.exp(0.1 * rng.standard_normal(n))
    category = (capacity[:, None] < X).astype(int)
    x = np.broadcast_to(X, category.shape)
    return (curves(Seen(x, category, category, np.ones(x.shape)), 1, begins_at=begins).misfit_p < LEVEL).tolist()


CASES = {
    "median, stripes": (stripes, [(42, 0.0), (42, 1.0), (100, 0.0), (12, 1.0)]),
    "median, cloud": (cloud, [(100, 0.0), (400, 1.0)]),
    "median, searched, a third above the range": (searched, [(42, 0.0), (42, 1.0)]),
    "beta, stripes": (beta_of_stripes, [(5, 0.0), (12, 1.0), (42, 0.0)]),
    "beta, cloud": (beta_of_a_cloud, [(40, 0.0), (100, 0.0)]),
    "beta, searched": (beta_searched, [(5, 0.0), (12, 0.0), (42, 0.0)]),
    "beta, searched, a third above the range": (beta_searched_cut, [(8, 0.0), (12, 0.0), (42, 0.0)]),
    "exponent of a second intensity": (exponent, [(42, 0.0), (100, 1.0)]),
    "1 and 5 %, stripes": (small_percentiles, [(12, 1.0), (42, 0.0), (100, 1.0)]),
    "1 and 5 %, stripes, two states close together": (close_states, [(12, 1.0), (20, 0.0), (42, 0.0)]),
    "1 and 5 %, searched": (small_percentiles_searched, [(12, 0.0), (42, 0.0)]),
    "no misfit told, where there is none": (not_missed, [(12, 1.0), (42, 0.0), (100, 1.0)]),
    "misfit told, capacities of two kinds": (missed, [(42, 0.5), (100, 0.5)]),
}


HEAD = ["limits of", "members", "x_0", "suites", "held [%]", "measured", "machine"]


def main() -> None:
    suites = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    asked = sys.argv[2] if len(sys.argv) > 2 else ""
    path = HERE / "results" / "fragility_coverage.csv"
    with path.open(newline="") as file:
        before = list(csv.reader(file))[1:]
    kept: dict[str, list[list[object]]] = {name: [list(r) for r in before if r[0] == name] for name in CASES}
    for name, (one, settings) in CASES.items():
        if asked not in name:
            continue
        kept[name] = []
        for n, begins in settings:
            held = np.array([one(np.random.default_rng(seed), n, begins) for seed in range(suites)])
            shares = " ".join(f"{100.0 * share:.1f}" for share in held.mean(axis=0))
            row = [name, n, begins, suites, shares]
            kept[name].append([*row, date.today().isoformat(), machine()])
            print(*row, sep="  ", flush=True)
        with path.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([HEAD, *(row for rows in kept.values() for row in rows)])


if __name__ == "__main__":
    main()
