"""Opens a study: a YAML file or a mapping in, a checked `Study` out."""

from __future__ import annotations

import dataclasses
import keyword
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from rockcli.errors import RecordError, StudyError
from rockcli.scene.auto import AUTO
from rockcli.scene.batch import Save
from rockcli.scene.laws.models import MODELS
from rockcli.scene.variables import (
    LARGE,
    SCALARS,
    SCALARS_ASYMMETRIC,
    SCALARS_AUTO,
    SCALARS_FEMA,
    SCALARS_FLEXIBLE,
    SCALARS_LARGE,
    SCALARS_ROLLING,
    SCALARS_SLIDING,
)
from rockcli.study.building.batch import build_batch, build_pieces
from rockcli.study.building.numbers import Numbers
from rockcli.study.building.records import MissingRecordError, Records
from rockcli.study.building.resolved import DT_OUT, Found
from rockcli.study.cases.axes import read_axes
from rockcli.study.cases.cases import Cases
from rockcli.study.cases.hazard_curves import read_hazard
from rockcli.study.cases.refined_axes import RECORDS, read_refine
from rockcli.study.cases.searched_range import Search, doubted_range, make_search, searched
from rockcli.study.cases.suite_axes import doubted_limits, of_search, read_over
from rockcli.study.cases.uncertain import placed, read_uncertain
from rockcli.study.cases.variation import Variation
from rockcli.study.document.check import check_study, check_with_base
from rockcli.study.document.complaints import Complaints
from rockcli.study.document.dimensions import stated_number
from rockcli.study.document.expressions import CONSTANTS, FUNCTIONS, SYMBOLS, ExpressionError
from rockcli.study.document.loader import load_file, load_mapping
from rockcli.study.document.overrides import apply_overrides, settings_of, without_effect
from rockcli.study.document.shorthands import expanded
from rockcli.study.document.tree import Map, Source, Where, dotted, place, value_at
from rockcli.study.expect import check_histories, match, read_expect
from rockcli.study.given_records import taken_out
from rockcli.study.identity import as_yaml, identity, lays_over, plain, sweep_id
from rockcli.study.plausibility import surely_meant
from rockcli.study.plots import looks_of, said_of
from rockcli.study.rules_spectrum import read_rules_spectrum
from rockcli.study.schema import NO_PLOTS, CasePart, OverPart, StudyPart
from rockcli.study.study import BASES, SAMPLE, Axis, Expect, Index, Over, Study, Uncertain
from rockcli.study.unused import (
    alternatives_left_out,
    overridden_axes,
    overridden_by_options,
    replaced_records,
    rules_without_friction,
    saved_beside_a_search,
    strengths_left_out,
    unused_symbols,
    unused_tolerances,
)

HISTORIES_UP_TO = 100
"""Cases up to which histories are saved unless the study says otherwise."""

NOT_SCORED = "`score` is for `rock score`, which puts the bodies on the motions of experiments; nothing is scored here"

RULES_OF_TWO_EDGES = (
    "rules know two edges: of a body that rolls over several vertices they tell of its base alone, and from beyond the "
    "alpha of that it may come back"
)

DECIDES = ("solver.method", "solver.events", "solver.backend", "base", "damping", "geometry", "model")
"""Keys of the case that decide on the backend, those that only one backend reads first."""

SAMPLES_WITH_ALL = 10_000
"""Cases of a study of uncertain inputs up to which all scalars are saved unless it says otherwise."""


def open_study(
    source: Path | str | dict[str, Any], *, overrides: Sequence[tuple[str, str]] = (), readers: int = 1
) -> Study:
    """Read and check a study: everything that can be said against it is said here, before anything is solved.

    Args:
        source: path of a YAML file, or a mapping of the same form.
        overrides: (path, text of a YAML value) as of `--set case.block.R=2`, in order.
        readers: processes that read records, where there are many.

    Raises:
        StudyError: the study is wrong; names file, line and key.
        RecordError: a record is missing (`MissingRecordError`) or cannot be read.
    """
    if not isinstance(source, dict | str | os.PathLike):
        raise StudyError(f"a study is a file or a mapping, not {_kind(source)}")
    where = Source(None if isinstance(source, dict) else Path(source))
    source, given = taken_out(source) if isinstance(source, dict) else (source, {})
    tree = load_mapping(source) if isinstance(source, dict) else load_file(Path(source))
    said, settings = expanded(tree), settings_of(overrides)
    tree = apply_overrides(said, settings)
    part = _check_top(where, tree)
    base = Map({"case": tree["case"], "let": tree.get("let") or Map()}, tree.where)
    cases, uncertain, sought = _with_axes(where, tree, part, base, Records(where, given=given, readers=readers))
    variations = cases.variations
    found = Found(meant=surely_meant(tree, None if sought is None else sought.axis.path))
    _probe(cases, found)
    axes = tuple(v.axis for v in variations if v is not sought)
    _check_curves(where, tree, found.models)
    saved, at = _save(where, tree, cases, found)
    if sought is not None:
        saved, at = {"histories": False, "dt_out": saved["dt_out"], "scalars": []}, None
    histories, dt_out, scalars = saved["histories"] is not False, saved["dt_out"], tuple(saved["scalars"])
    points = {i: axis.values.index(at[axis.name]) for i, axis in enumerate(axes) if at and axis.name in at}
    cases = dataclasses.replace(cases, save=Save(histories, dt_out, frozenset(scalars)), histories_at=points)
    search = None if sought is None else make_search(cases, sought)
    g = _gravity(cases, base)
    over = _statistics(where, tree, part, axes, scalars, uncertain, search, g)
    refine = read_refine(where, tree, part, axes, scalars, searches=search is not None, over=over)
    expect = read_expect(where, tree, axes, cases.evaluate, () if search is None else search.results(over), over)
    check_histories(where, tree, expect, axes, at if histories else None, saved=histories)
    compare_to = tree.get("compare_to")
    resolved = _resolved(part, base, variations, saved, expect)
    if over is not None and over.hazard:  # in numbers, so that a dataset's study needs no file
        resolved["hazard"] = [
            {"label": one.label, "intensity": one.intensity.tolist(), "rate": one.rate.tolist()} for one in over.hazard
        ]
    content = resolved["case"], resolved.get("let", {}), variations, saved
    return Study(
        name=part.name,
        title=part.title,
        references=part.references,
        file=where.file,
        axes=axes,
        cases=cases if search is None else search,
        compare_to=match(where, tree, ("compare_to",), compare_to, axes, cases.evaluate) if compare_to else None,
        expect=expect,
        plots=None if part.plots is None else tuple(looks_of(part.plots, tree)),
        histories=histories,
        dt_out=dt_out,
        scalars=scalars,
        resolved=resolved,
        resolved_yaml=as_yaml(resolved),
        identity=identity(*content, where.inputs.hashes, refine=bool(refine), laid=lays_over(resolved, variations)),
        sweep_id="" if refine else sweep_id(*content, where.inputs.hashes),
        inputs=dict(sorted(where.inputs.hashes.items())),
        processing=found.processing(),
        warnings=(
            *overridden_by_options(said, tree, settings),
            *_ineffective(tree, part, base, variations, overrides),
            *unused_tolerances(where, tree, expect),
            *((RULES_OF_TWO_EDGES,) if found.rolling and part.rules else ()),
            *found.plausibility_warnings(tree, int(np.prod(cases.shape, dtype=np.int64))),
            *doubted_limits(part.over, over, found.unheld),
            *doubted_range(search),
            *((RECORDS,) if refine and found.uses else ()),
            *((NOT_SCORED,) if part.score is not None else ()),
        ),
        histories_at=at,
        curves=tuple(dict.fromkeys(part.curves)),
        rules=tuple(dict.fromkeys(part.rules)),
        rules_spectrum=read_rules_spectrum(where, tree, part),
        search=search,
        over=over,
        uncertain=uncertain,
        refine=refine,
        audit=part.audit,
        g=g,
        varied=tuple(sorted({dotted(path[path[0] == "case" :]) for one in variations for path in one.paths})),
        places=_places(tree, axes),
    )


def _check_curves(where: Source, tree: Map, models: Iterable[tuple[str, str | None]]) -> None:
    """Refuse static curves (`curves`) of a model that has no law of its own."""
    for pair in models:
        if tree.get("curves") and pair not in MODELS:
            raise where.error(tree, ("curves",), f": model {pair[0]} has no static curves")


def _with_axes(
    where: Source, tree: Map, part: StudyPart, base: Map, records: Records
) -> tuple[Cases, Uncertain | None, Variation | None]:
    """The cases of all axes, what is uncertain of them, and the axis along which a threshold is searched."""
    provisional = Save(histories=False, dt_out=DT_OUT, scalars=frozenset())

    def cases_of(known: list[Variation]) -> Cases:
        return Cases(where, base, known, records, provisional)

    variations = read_axes(where, tree, part, records, lambda known: cases_of(known).evaluate)
    drawn = read_uncertain(where, tree, part, variations, cases_of(variations).evaluate)
    if drawn is not None:
        variations = placed(variations, drawn[0], part.over)
    sought = searched(where, tree, variations)
    if sought is not None:  # innermost, so that every other case has its points side by side
        variations = [*(v for v in variations if v is not sought), sought]
    return cases_of(variations), None if drawn is None else drawn[1], sought


def _statistics(
    where: Source,
    tree: Map,
    part: StudyPart,
    axes: tuple[Axis, ...],
    scalars: tuple[str, ...],
    uncertain: Uncertain | None,
    search: Search | None,
    g: float | None,
) -> Over | None:
    """What is told over an axis, and the rates that hazard curves make of it; samples are told over unless asked.

    Static curves of uncertain bodies, of which no scalar is saved, have no statistics unless `over` asks for them.
    """
    of_samples = uncertain is not None and (scalars or search is not None)
    wanted = part.over or (OverPart(axis=SAMPLE) if of_samples else None)
    over = read_over(where, tree, wanted, axes, scalars, searches=search is not None)
    if over is not None and uncertain is not None and SAMPLE in over.axes:
        over = dataclasses.replace(over, inputs=tuple(each.path for each in uncertain.inputs))
    if over is not None and search is not None:
        over = of_search(where, tree, over, search, axes)
    return read_hazard(where, tree, part, over, axes if search is None else (*axes, search.axis), g)


def _gravity(cases: Cases, base: Map) -> float | None:
    """What an expression for g comes to, where that is one number in all cases; None where there is none."""
    said = value_at(base, ("case", "g"))
    if not isinstance(said, str):
        return None
    try:
        return cases.evaluate("g")
    except ExpressionError:
        return None


def _ineffective(
    tree: Map, part: StudyPart, base: Map, variations: list[Variation], overrides: Sequence[tuple[str, str]]
) -> tuple[str, ...]:
    """What is said of keys, symbols and settings that no case reads."""
    return (
        *without_effect(base, variations, overrides),
        *unused_symbols(tree, variations),
        *replaced_records(base, variations),
        *alternatives_left_out(base, variations),
        *strengths_left_out(base, variations),
        *overridden_axes(variations),
        *rules_without_friction(base, variations, part.rules),
        *saved_beside_a_search(tree, variations),
    )


def _places(tree: Map, axes: tuple[Axis, ...]) -> dict[str, Where]:
    """Where a study says what decides on the backend, and each value of an axis over the base."""
    paths = {key: ("case", *key.split(".")) for key in DECIDES}
    said = {key: place(tree, keys) for key, keys in paths.items() if value_at(tree, keys) is not None}
    of_base = ((axis.path, i) for axis in axes if axis.path in BASES for i in range(axis.size))
    return said | {f"vary.{path}[{i}]": place(tree, ("vary", path, i)) for path, i in of_base}


def _kind(value: Any) -> str:
    return "nothing" if value is None else f"a value of type {type(value).__name__}"


def _check_top(source: Source, tree: Map) -> StudyPart:
    """The study without its case, which is checked with the values of the axes in it."""
    case = tree.get("case")
    part = check_with_base(source, tree) if isinstance(case, Map) else check_study(source, tree)
    for name in part.let:
        check_symbol(source, tree, name)
    return part


def check_symbol(source: Source, tree: Map, name: str) -> None:
    """Refuse a symbol of `let` that means something else already."""
    keys = ("let", name)
    if not name.isascii() or not name.isidentifier() or keyword.iskeyword(name):
        raise source.error(tree, keys, "is no name for a symbol: letters, digits and _ only, a letter first")
    taken = "a symbol of the case" if name in (*SYMBOLS, "g") else "a function" if name in FUNCTIONS else "a unit"
    if name in (*SYMBOLS, "g") or name in FUNCTIONS or name in CONSTANTS:
        raise source.error(tree, keys, f"is {taken} already; choose another name")


def _probe(cases: Cases, found: Found) -> None:
    """Build what shows all that can be wrong (see `Cases.probe`), and tell all of it that is."""
    complaints = Complaints()
    with complaints.gathered():
        for part, combination, points, named in cases.groups_of_suites(cases.probe()):
            try:
                _look(cases, found, cases.numbers(combination, points, len(part), named))
            except (StudyError, RecordError):
                _gather(cases, found, part, complaints)
            if complaints.enough:
                break
    complaints.tell(MissingRecordError)


def _gather(cases: Cases, found: Found, part: Index, complaints: Complaints) -> None:
    """What is wrong with cases, each with its own record, so that places are told; halved to find what else is."""
    pending = [part]
    while pending and not complaints.enough:
        some, before = pending.pop(0), complaints.tried
        for these, combination, points in cases.groups(some):
            numbers, tried = cases.numbers(combination, points, len(these)), complaints.tried
            with complaints.gathered():
                _look(cases, found, numbers)
            if complaints.tried > tried:
                for piece in build_pieces(numbers, cases.records):
                    with complaints.gathered(), np.errstate(all="ignore"):
                        piece()
        if complaints.tried > before and len(some) > 1:
            pending += np.array_split(some, 2)


def _look(cases: Cases, found: Found, numbers: Numbers) -> None:
    for name in numbers.tree.get("let") or ():
        check_symbol(cases.source, numbers.tree, name)
        numbers.let(name)
    found.look(numbers, build_batch(numbers, cases.records, cases.save))


def _of_limits(over: Any) -> list[str]:
    """The quantities that limit states name: `{slide_peak: 0.05}`."""
    limits = over.get("limits") if isinstance(over, dict) else None
    return [str(quantity) for limit in limits or () if isinstance(limit, dict) for quantity in limit]


def _save(source: Source, tree: Map, cases: Cases, found: Found) -> tuple[dict[str, Any], dict[str, Any] | None]:
    """`save` with its defaults filled in, and the only points whose histories are saved, if not all.

    A study of static curves in which nothing moves saves nothing else unless it says so.
    """
    save: Map = tree.get("save") or Map()
    size = int(np.prod(cases.shape, dtype=np.int64))
    curves_only = bool(tree.get("curves")) and found.still
    histories: Any = save.get("histories")
    at = None
    if isinstance(histories, dict):
        at = match(source, tree, ("save", "histories"), histories, [v.axis for v in cases.variations], cases.evaluate)
    elif histories is None:
        histories = size <= HISTORIES_UP_TO and not curves_only and not tree.get("refine")
    wanted = save.get("scalars")
    if wanted is None:
        most = SAMPLES_WITH_ALL if tree.get("uncertain") else LARGE
        wanted = () if curves_only else SCALARS if size <= most and not tree.get("refine") else SCALARS_LARGE
        if wanted is SCALARS_LARGE and found.friction:
            wanted = [*SCALARS_LARGE, *_of_limits(tree.get("over"))]
    special = {*SCALARS_FEMA, *SCALARS_FLEXIBLE, *SCALARS_SLIDING, *SCALARS_ASYMMETRIC, *SCALARS_AUTO, *SCALARS_ROLLING}
    if found.friction:
        special -= set(SCALARS_SLIDING)
    if found.asymmetric:
        special -= set(SCALARS_ASYMMETRIC)
    if found.rolling:
        special -= {*SCALARS_ROLLING, *SCALARS_ASYMMETRIC}
    if "fema356" in found.schemes:
        special -= set(SCALARS_FEMA)
    if any(model == AUTO for model, _ in found.models):
        special -= {*SCALARS_AUTO, *SCALARS_FLEXIBLE}
    if any(model == "flexible" for model, _ in found.models):
        special -= set(SCALARS_FLEXIBLE)
    every = [name for name in SCALARS if name not in special]
    if wanted == "all" or wanted is SCALARS:
        wanted = every
    always = {"outcome"} if wanted else set()  # a case that failed is told, whatever else is saved
    if "error_estimate" in wanted:  # an outcome that its runs leave open is told by it
        always.add("overturn_share")
    scalars = [name for name in SCALARS if name in {*wanted, *always}]
    dt_out: Any = save.get("dt_out")
    if dt_out is None:
        dt_out = found.dt_out
    else:
        keys = ("save", "dt_out")
        dt_out = stated_number(source, tree, keys, dt_out)
        if not dt_out > 0.0:
            raise source.error(tree, keys, f"is {dt_out:g}; must be greater than 0")
    return {"histories": plain(histories), "dt_out": dt_out, "scalars": scalars}, at


def _resolved(
    part: StudyPart, base: Map, variations: Sequence[Variation], saved: dict[str, Any], expect: Sequence[Expect]
) -> dict[str, Any]:
    """The study with short forms written out and defaults filled in; globs as the files they matched.

    Points of `expect` are given by their coordinates, and what is expected by its number, which need no case to be
    understood.
    """
    dumped: dict[str, Any] = plain(part.model_dump(by_alias=True))
    for written, clause in zip(dumped["expect"], expect, strict=True):
        if clause.at:
            written["at"] = dict(clause.at)
        if isinstance(clause.target, float) and isinstance(written[clause.check], str):
            written[clause.check] = clause.target
    try:
        dumped["case"] = plain(CasePart.model_validate(base["case"]).model_dump(by_alias=True))
    except ValidationError:  # a case that is complete only with the values of the axes
        dumped["case"] = plain(base["case"])
    model = dumped["case"].get("model")
    if isinstance(model, dict) and model.keys() == {"name"}:  # as everybody writes it
        dumped["case"]["model"] = int(model["name"]) if model["name"].isdigit() else model["name"]
    vary = dumped["vary"] = plain(part.vary, nothing=True)
    for variation in variations:
        path = variation.axis.path
        if not variation.sampled and isinstance(vary[path], str) and variation.table is None:
            vary[path] = [point[0][1] for point in variation.settings]
    if part.plots is not None:
        dumped["plots"] = [said_of(plot) for plot in part.plots] or NO_PLOTS
    if not part.uncertain:
        for key in ("samples", "seed", "sampling"):
            del dumped[key]
    dumped["save"] = {key: value for key, value in saved.items() if value != []}
    said = {key: value for key, value in dumped.items() if value is not False}  # not those equal to it, as a seed of 0
    return {key: value for key, value in said.items() if key == "case" or value not in ("", [], {}, None)}
