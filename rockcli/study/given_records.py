"""Records that a study given as a mapping holds itself: arrays, ObsPy traces, motions; each gets a name like a file."""

from __future__ import annotations

import hashlib
from typing import Any

import numpy as np

from rockcli.errors import StudyError
from rockcli.motion.motion import Given, Motion
from rockcli.study.document.loader import check_depth

Records = dict[str, Given | Motion]

_ARRAY = "{'values': ARRAY, 'dt': 0.01, 'units': 'm/s2'}"
"""A record from an array, as a study has it."""


def taken_out(study: dict[str, Any]) -> tuple[dict[str, Any], Records]:
    """The study with names where records stood, and the records by these names.

    A record is `{values: ARRAY, dt: ..., units: ...}`, an ObsPy Trace or a `Motion`, in place of a record, of its
    `values` or of its `file`, in a case, in settings or in a list of an axis.

    Raises:
        StudyError: the values are no row of numbers; the study has no end.
    """
    check_depth(study)
    found: Records = {}
    return _taken(study, found, of_record=False), found


def _taken(value: Any, found: Records, *, of_record: bool) -> Any:
    """`of_record`: the value belongs to a record, or to settings of one."""
    if isinstance(value, dict):
        taken: dict[str, Any] = {}
        for key, item in value.items():
            inside = of_record or str(key).rsplit(".", 1)[-1] in ("record", "vertical")
            if key in ("record", "vertical") and isinstance(item, np.ndarray) and item.dtype.kind == "f":
                raise StudyError(f"`{key}` is an array without a time step and units: write {_ARRAY}")
            whole = _is_record(item) and key != "file" and not str(key).endswith(".file")
            taken[key] = {"file": _name(item, found)} if whole else _taken(item, found, of_record=inside)
        if not of_record or "values" not in value:
            return taken
        if "file" in value:
            raise StudyError("a record has `values` or `file`, not both")
        del taken["values"]
        name = taken.pop("name", None)
        return {"file": _name(value["values"], found, None if name is None else str(name)), **taken}
    if _is_record(value):
        return _name(value, found)
    if isinstance(value, list | tuple):
        return [_taken(item, found, of_record=of_record) for item in value]
    return value


def _is_record(value: Any) -> bool:
    return isinstance(value, Motion) or _is_trace(value)


def _is_trace(value: Any) -> bool:
    return hasattr(value, "stats") and hasattr(value, "data") and hasattr(value.stats, "delta")


def _name(value: Any, found: Records, name: str | None = None) -> str:
    """The name of a record, of which every other with the same name and content is the same."""
    one: Given | Motion
    if isinstance(value, Motion):
        one, default = value, value.name or "motion"
    elif _is_trace(value):
        calib = float(value.stats.get("calib", 1.0))
        values = np.ma.filled(np.ma.asarray(value.data, dtype=float), np.nan) * calib
        component, start = str(value.stats.get("channel", "")), str(value.stats.get("starttime", ""))
        known = str(value.id).strip(".")  # of a trace without a station nothing is left
        one, default = Given(values, float(value.stats.delta), component, start), str(value.id) if known else "trace"
    else:
        one, default = Given(_numbers(value)), "array"
    name = name or default
    content = _digest(one)
    plain, number = name, 1
    while name in found and _digest(found[name]) != content:
        number += 1
        name = f"{plain} ({number})"
    found[name] = one
    return name


def _numbers(value: Any) -> Any:
    try:
        if np.iscomplexobj(value):
            raise StudyError(
                "`values` of a record are complex; expected a row of accelerations, such as their real part"
            )
        if np.asanyarray(value).dtype.kind in "bMmV":  # numpy makes numbers of truths, dates and rows of a table too
            raise TypeError
        values: Any = np.ma.filled(np.ma.array(value, dtype=float), np.nan)  # what a mask hides is no value
    except (TypeError, ValueError):
        raise StudyError("`values` of a record are not numbers; expected a row of accelerations") from None
    if values.ndim != 1 or len(values) < 2:
        raise StudyError(f"`values` of a record have the shape {values.shape}; expected a row of two or more")
    return values


def _digest(one: Given | Motion) -> str:
    # equal numbers in other units are another motion, and those of another time
    told = (one.dt, one.in_g, one.begins) if isinstance(one, Motion) else (one.dt, one.start)
    return hashlib.sha256(np.ascontiguousarray(one.values).tobytes() + repr(told).encode()).hexdigest()
