"""Statistics over several axes: laid end to end they are one axis, and what it has is laid out over them again."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.storage.contents import Contents, Field, text
from rockcli.storage.reduced import reduce
from rockcli.study.study import Over

NAMED = 100_000
"""Members up to which they have names."""


def end_to_end(contents: Contents, over: Over) -> Contents:
    """The cases with the axes of the ensemble as one of the name `over.axis`; of other dimensions only what has none.

    The axes stand side by side, so that the order of the cases stays what it is.
    """
    if len(over.axes) == 1:
        return contents
    sizes = {axis: len(contents.values(axis)) for axis in over.axes}
    at = contents.axes.index(over.axes[0])
    axes = (*contents.axes[:at], over.axis, *contents.axes[at + len(over.axes) :])
    fields: dict[str, Field] = {}
    for name, item in contents.fields.items():
        inside = set(item.dims) & set(over.axes)
        if not inside:
            fields[name] = item
        elif set(item.dims) <= set(contents.axes) and name not in over.axes:
            first = min(item.dims.index(axis) for axis in inside)
            before, after = item.dims[:first], item.dims[first + len(inside) :]
            index = tuple(slice(None) if axis in inside else None for axis in over.axes)
            whole = (*item.values.shape[:first], *sizes.values(), *item.values.shape[first + len(inside) :])
            values = np.broadcast_to(item.values[(*(slice(None),) * len(before), *index)], whole)
            shape = (*whole[:first], -1, *whole[first + len(sizes) :])
            fields[name] = replace(item, dims=(*before, over.axis, *after), values=values.reshape(shape))
    fields[over.axis] = Field((over.axis,), _labels(contents, over), {"long_name": over.axis})
    return Contents(axes, fields, contents.attrs)


def _labels(contents: Contents, over: Over) -> NDArray[Any]:
    """What the members are called, `a.AT2, 1`; of very many their number."""
    points = [contents.values(axis) for axis in over.axes]
    n = int(np.prod([len(values) for values in points]))
    if n > NAMED:
        return np.arange(float(n))
    words = [[value if isinstance(value, str) else f"{value:.6g}" for value in values] for values in points]
    return text([", ".join(one) for one in product(*words)])


def laid_out(fields: dict[str, Field], contents: Contents, over: Over) -> dict[str, Field]:
    """Fields of cases laid end to end over the axes of `contents` again."""
    if len(over.axes) == 1:
        return fields
    sizes = tuple(len(contents.values(axis)) for axis in over.axes)
    found = {}
    for name, item in fields.items():
        if over.axis in item.dims:
            at = item.dims.index(over.axis)
            dims = (*item.dims[:at], *over.axes, *item.dims[at + 1 :])
            values = item.values.reshape((*item.values.shape[:at], *sizes, *item.values.shape[at + 1 :]))
            if item.coordinate:
                dims, values = reduce(values, dims)
            item = replace(item, dims=dims, values=values)
        found[name] = item
    return found
