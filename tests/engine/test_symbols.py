"""Symbols collected chunk by chunk, in any order, are those of all cases at once."""

import numpy as np
import pytest

from rockcli.engine.sweep.symbols import Symbols

SHAPE = (3, 70, 4)
AXES = ("one", "two", "three")


def tables(hidden: bool) -> dict[str, np.ndarray]:
    i, j, k = np.meshgrid(*(np.arange(n) for n in SHAPE), indexing="ij")
    p = np.where((j == 34) & hidden, i + 10.0 * k, 1.0 * i)  # 34 is not among the points looked at
    return {
        "R": np.broadcast_to(2.0, SHAPE).ravel(),
        "alpha": (1.0 * j).ravel(),
        "p": p.ravel(),
        "eta": np.where(k == 1, np.nan, 1.0 * k).ravel(),
    }


def as_told(values: np.ndarray) -> np.ndarray | float:
    return float(values[0]) if (values == values[0]).all() or np.isnan(values).all() else values


@pytest.mark.parametrize("hidden", [False, True])
@pytest.mark.parametrize("seed", range(5))
def test_chunks_in_any_order_give_the_table(hidden, seed):
    table = tables(hidden)
    symbols = Symbols(SHAPE, lambda cases: {name: as_told(values[cases]) for name, values in table.items()})
    rng = np.random.default_rng(seed)
    n = int(np.prod(SHAPE))
    reduction = symbols.reduction
    for number, cases in enumerate(rng.permutation(np.arange(n).reshape(10, -1))):
        told = {name: as_told(values[cases]) for name, values in table.items()}
        symbols.put(cases, reduction(cases, told) if number % 3 else told)
    for name, values in table.items():
        dims, found = symbols.over(name, AXES)
        full = values.reshape(SHAPE)
        kept = [AXES.index(dim) for dim in dims]
        spread = found[tuple(slice(None) if axis in kept else None for axis in range(3))]
        assert np.array_equal(np.broadcast_to(spread, SHAPE), full, equal_nan=True), name
    assert symbols.over("alpha", AXES)[0] == ("two",)
    assert symbols.over("eta", AXES)[0] == ("three",)
    assert symbols.over("R", AXES)[0] == ()
