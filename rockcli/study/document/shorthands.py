"""Short forms of the study file, written out before anything looks at them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rockcli.study.document.tree import List, Map, Where
from rockcli.study.schema import RecordPart


def expanded(study: Map) -> Map:
    """A copy of a study with the short forms of its case written out; anything of another form is left as it is."""
    return _within(study, "case", expanded_case)


def expanded_case(case: Any) -> Any:
    """`damping: restitution` -> {scheme: restitution}, `model: 3` -> {name: "3"}, and so on."""
    if not isinstance(case, Map):
        return case
    case = _put(case, "damping", _named("scheme"))
    case = _put(case, "model", _named("name"))
    case = _within(case, "model", lambda model: _put(model, "tolerance", _percent))
    case = _put(case, "motion", lambda value, where: Map(whole=True) if value in (None, "none") else value)
    return _within(case, "motion", _motion)


def _motion(motion: Map) -> Map:
    motion = _put(motion, "record", _record)
    return _put(motion, "vertical", _vertical)


def _vertical(value: Any, where: Where) -> Any:
    bare = (
        isinstance(value, Map)
        and value.keys() & RecordPart.model_fields.keys()
        and not value.keys() & {"pulse", "record"}
    )
    if isinstance(value, str) or bare:
        value = Map({"record": value}, {"record": where})
    return _put(value, "record", _record) if isinstance(value, Map) else value


def _record(value: Any, where: Where) -> Any:
    if isinstance(value, str):
        return Map({"file": value}, {"file": where}, whole=True)
    if not isinstance(value, Map):
        return value
    for name, inner in (("taper", "fraction"), ("highpass", "freq"), ("lowpass", "freq")):
        value = _put(value, name, _wrapped(inner))
    return _put(value, "bandpass", _band)


def _named(inner: str) -> Callable[[Any, Where], Any]:
    def named(value: Any, where: Where) -> Any:
        if isinstance(value, int | float) and not isinstance(value, bool):
            value = str(value)
        if isinstance(value, Map) and inner in value:
            return _put(value, inner, lambda v, w: str(v) if type(v) is int else v)
        return Map({inner: value}, {inner: where}, whole=True) if isinstance(value, str) else value

    return named


def _percent(value: Any, where: Where) -> Any:
    """`2 %` is 0.02."""
    if isinstance(value, str) and value.rstrip().endswith("%"):
        try:
            return float(value.rstrip()[:-1]) / 100.0
        except ValueError:
            return value
    return value


def _wrapped(inner: str) -> Callable[[Any, Where], Any]:
    def wrapped(value: Any, where: Where) -> Any:
        if isinstance(value, int | float | str) and not isinstance(value, bool):
            return Map({inner: value}, {inner: where}, whole=True)
        return value

    return wrapped


def _band(value: Any, where: Where) -> Any:
    if isinstance(value, List) and len(value) == 2:
        ends = dict(zip(("freqmin", "freqmax"), value, strict=True))
        return Map(ends, dict.fromkeys(ends, where), whole=True)
    return value


def _put(mapping: Map, name: str, change: Callable[[Any, Where], Any]) -> Map:
    if name not in mapping:
        return mapping
    old, where = mapping[name], mapping.where.get(name)
    new = change(old, where)
    if new is old:
        return mapping
    copy = Map(mapping, mapping.where, whole=mapping.whole)
    copy[name] = new
    return copy


def _within(mapping: Map, name: str, change: Callable[[Any], Any]) -> Map:
    return _put(mapping, name, lambda value, where: change(value) if isinstance(value, Map) else value)
