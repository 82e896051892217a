"""Identity of results, by which they are reused: a hash of what changes numbers; and the resolved study."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import yaml

from rockcli import version
from rockcli.study.cases.file_names import names_in
from rockcli.study.cases.variation import Variation
from rockcli.study.document.loader import scalar
from rockcli.study.document.overlay import Path, overlaid, remaining
from rockcli.study.document.tree import Map, value_at
from rockcli.study.schema import CasePart


def identity(
    case: dict[str, Any],
    let: dict[str, Any],
    variations: Sequence[Variation],
    save: dict[str, Any],
    inputs: dict[str, str],
    *,
    refine: bool = False,
    laid: bool = False,
) -> str:
    """SHA-256 of what changes numbers: case, let, axes, save, refine, the bytes of all files, the program's version.

    `laid` (see `lays_over`) tells such a study from what it meant in builds in which a setting replaced the whole
    mapping at its path.
    """
    content = {
        "case": _canonical(case),
        "let": _canonical(let),
        "vary": [_axis(variation) for variation in variations],
        "save": _canonical(save),
        "inputs": dict(sorted(inputs.items())),
        "version": version.__version__,
    } | {word: True for word, said in (("refine", refine), ("laid", laid)) if said}
    return hashlib.sha256(json.dumps(content, sort_keys=True, allow_nan=True).encode()).hexdigest()


def sweep_id(
    case: dict[str, Any],
    let: dict[str, Any],
    variations: Sequence[Variation],
    save: dict[str, Any],
    inputs: dict[str, str],
) -> str:
    """What tells whether the results of one study are among those of another, as JSON; not for refined maps.

    `base` is the hash of all but the axes and what none of their points leaves; an axis has the hash of what each of
    its points puts into a case, with its label where labels fill in names of files, or None where the coordinate says
    it.  A file counts where its name stands, one that is named nowhere in the base, and a table in its rows.
    """

    encoder = json.JSONEncoder(sort_keys=True)

    def content(value: Any) -> str:
        named = inputs.keys() & set(_texts(value))
        told = [_canonical(value, nothing=True), sorted((name, inputs[name]) for name in named)]
        return hashlib.sha256(encoder.encode(told).encode()).hexdigest()[:32]

    said = {key: value for key, value in save.items() if key != "dt_out" or save["histories"] is not False}
    base: dict[str, Any] = {"case": case, "let": let}
    put = [value for variation in variations for point in variation.settings for _, value, _ in point]
    filled = names_in([case, put])
    axes = []
    for variation in variations:
        axis, points = variation.axis, None
        if not axis.numeric:  # a point is told alike whether all are columns or, beside one of words, settings
            columns = {".".join(path): of.tolist() for path, of in (variation.columns or {}).items()}
            told: Iterable[dict[str, Any]] = (
                ({".".join(path): value for path, value, _ in point} for point in variation.settings)
                if variation.settings
                else (dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True))
            )
            names = axis.values if axis.name in filled else [""] * axis.size
            points = [content([name, point]) for name, point in zip(names, told, strict=True)]
        axes.append([axis.name, axis.path, points, variation.find])
        base = _only(base, remaining(base, variation.points()))
    placed = {*_texts([base, put]), *(variation.table for variation in variations)}
    rest = sorted((name, sha256) for name, sha256 in inputs.items() if name not in placed)
    # the coordinate does not tell the samples: they are those of the same design only
    sampled = [_axis(variation) for variation in variations if variation.sampled]
    base_hash = content([base.get("case"), base.get("let"), said, version.__version__, rest, *sampled])
    return json.dumps({"base": base_hash, "axes": axes})


def _only(tree: dict[str, Any], paths: set[Path], at: Path = ()) -> dict[str, Any]:
    """What a tree says at some paths."""
    kept = {
        key: _only(item, paths, (*at, key)) if isinstance(item, dict) else item
        for key, item in tree.items()
        if isinstance(item, dict) or (*at, key) in paths
    }
    return {key: item for key, item in kept.items() if item != {}}


def _texts(value: Any) -> Iterator[str]:
    """All texts in a tree."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list | tuple):
        for item in value.values() if isinstance(value, dict) else value:
            yield from _texts(item)


def as_yaml(resolved: dict[str, Any]) -> str:
    """A study as YAML that this program reads back unchanged."""
    return str(yaml.dump(resolved, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=120))


def plain(value: Any, *, nothing: bool = False) -> Any:
    """A tree of ordinary dicts and lists; `nothing`: also with the keys that say so, as a setting `motion: null`."""
    if isinstance(value, dict):
        said = value.items() if nothing else ((key, item) for key, item in value.items() if item is not None)
        return {str(key): plain(item, nothing=nothing) for key, item in said}
    if isinstance(value, list | tuple):
        return [plain(item, nothing=nothing) for item in value]
    return value


def lays_over(study: dict[str, Any], variations: Sequence[Variation]) -> bool:
    """Whether a setting that is a mapping leaves something of the mapping of the base case that it is laid over.

    What it leaves of a resolved study that is the default anyway does not count.
    """
    defaults = {"case": CasePart.model_validate({"block": {}, "column": {}, "base": {}}).model_dump()}
    for variation in variations:
        for point in variation.points():
            for path, value, where in point:
                if isinstance(value, Map):
                    alone, over = (value_at(overlaid(s, [(path, value, where)]), path) for s in (defaults, study))
                    if _canonical(alone) != _canonical(over):
                        return True
    return False


def _axis(variation: Variation) -> list[Any]:
    axis = variation.axis
    if variation.columns is not None and not variation.settings:
        content: Any = {".".join(p): hashlib.sha256(v.tobytes()).hexdigest() for p, v in variation.columns.items()}
    else:
        content = [
            [[".".join(path), _canonical(value, nothing=True)] for path, value, _ in point]
            for point in variation.settings
        ]
    said = [axis.name, ".".join(variation.path), [] if axis.numeric else list(axis.values), content]
    return [*said, variation.find] if variation.find else said


def _canonical(value: Any, *, nothing: bool = False) -> Any:
    """The same for 5 and 5.0, for any order of keys, and for an absent key and an empty one.

    `nothing`: not for these in a setting, of which an empty key takes away what the base case has there.
    """
    if isinstance(value, dict):
        said = ((key, item) for key, item in value.items() if nothing or item is not None)
        return {str(key): _canonical(item, nothing=nothing) for key, item in said}
    if isinstance(value, list | tuple):
        return [_canonical(item, nothing=nothing) for item in value]
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    return value


class _Dumper(yaml.SafeDumper):
    """Quotes the text that YAML 1.2 would read as a number, and writes short lists in one line."""

    def ignore_aliases(self, data: Any) -> bool:
        """Never write anchors: equal parts are written twice."""
        return True


def _text(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    style = None if isinstance(scalar(text), str) else "'"
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)


def _list(dumper: yaml.SafeDumper, items: list[Any]) -> yaml.SequenceNode:
    short = all(not isinstance(item, dict | list) for item in items)
    return dumper.represent_sequence("tag:yaml.org,2002:seq", items, flow_style=short)


_Dumper.add_representer(str, _text)
_Dumper.add_representer(list, _list)
