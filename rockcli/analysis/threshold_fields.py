"""Overturning thresholds (`find: overturning`) as variables of a dataset, written and read."""

from __future__ import annotations

from typing import Any

import numpy as np

from rockcli.scene.thresholds import BESIDE, PARTS, SENTENCES, STATES, Thresholds
from rockcli.storage.contents import Contents, Field
from rockcli.study.study import Searched


def threshold_fields(
    search: Searched, found: Thresholds, dims: tuple[str, ...], *, end: str = "", before: str = ""
) -> dict[str, Field]:
    """What a search found, or a statistic of it, as variables over `dims`.

    Args:
        search: what was searched.
        found: arrays over `dims`.
        dims: names of the axes.
        end: end of the names of a statistic, such as `p50`; before: the words for it.
    """
    fields = {}
    for part in ("", *PARTS, *(() if found.islands is None else BESIDE)):
        attrs: dict[str, Any] = {"long_name": before + SENTENCES[part].format(search.axis.path)}
        if part == "state":
            attrs |= {"flag_values": np.array(list(STATES), dtype=np.int8), "flag_meanings": " ".join(STATES.values())}
        else:
            attrs["units"] = "1" if part in ("islands", "rocks_at_lowest") else search.axis.unit
        name = "_".join(filter(None, (search.name, part, end)))
        fields[name] = Field(dims, getattr(found, part or "value"), attrs)
    return fields


def found_by(contents: Contents, name: str, end: str = "") -> Thresholds:
    """What a search found for every case, or a statistic of it, from the variable of that name and those beside it."""
    return Thresholds.read(name, lambda one: contents.values(one) if one in contents.fields else None, end)
