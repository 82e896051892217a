"""The HTML report of a study: one page that needs no network and no other file, from `template.html`."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from rockcli.plotting.common import style
from rockcli.plotting.common.cases import axes_of, thresholds_in
from rockcli.plotting.common.labels import coordinate_words, units_of
from rockcli.plotting.common.style import OUTCOME_COLOURS
from rockcli.plotting.common.suite import suite_axes
from rockcli.plotting.common.table import case_table
from rockcli.plotting.figures import KINDS, default_kinds, figure, why_not
from rockcli.plotting.kinds import suite_curve
from rockcli.plotting.page.elements import folded, image, laid_out, section, table
from rockcli.plotting.page.facts import facts_of, name_of, searched_words, sentence_of
from rockcli.scene.looks import Look
from rockcli.scene.response import OUTCOMES, outcome_words
from rockcli.scene.thresholds import FOUND, threshold_words

if TYPE_CHECKING:
    import xarray

Table = tuple[str, Sequence[str], Sequence[Sequence[str]], str]
"""Title, names of the columns, rows, a sentence below."""

_PLACES = re.compile(r"(?<![\w./\\<])(?:[A-Za-z]:)?[/\\](?:[^/\\\s'\",;:()<>]+[/\\])+([^/\\\s'\",;:()<>]+)")
"""Absolute paths: of no use to a reader elsewhere, and nobody's business."""

_FIRST = ("body", "barriers", "motion")
"""Kinds that come before the results."""


def page(
    dataset: xarray.Dataset,
    verdicts: Sequence[tuple[bool, str]] = (),
    tables: Sequence[Table] = (),
) -> str:
    """The report of a dataset, from the dataset alone.

    Args:
        dataset: written by `rock run`.
        verdicts: (met, words) of the clauses of `expect`.
        tables: what the suite and the rules come to.
    """
    attrs = dataset.attrs
    name, title = str(attrs.get("study_name", "study")), str(attrs.get("title", ""))
    plots = list(default_kinds(dataset))
    if "body" not in plots and not {"barriers", "curves", "work_precision"} & {*plots}:
        plots.append("body")
    if "motion" not in plots and not why_not("motion", dataset):
        plots.append("motion")
    first = [kind for kind in _FIRST if kind in plots and not why_not(kind, dataset)]
    drawn = {_title(dataset, kind) for kind in plots}
    parts = [
        section(
            "Result", _facts(dataset) + _outcomes(dataset) + _audit(dataset) + _suite(dataset) + _thresholds(dataset)
        ),
        *(_plot(dataset, kind) for kind in first),
        *(_plot(dataset, kind) for kind in plots if kind not in _FIRST),
        *(
            section(f"{title} in numbers" if title in drawn else title, table(head, rows, note))
            for title, head, rows, note in tables
            if rows
        ),
        section("Cases", table(*case_table(dataset))),
        section("Checks", _verdicts(verdicts)),
        folded("Notes and warnings", _warnings(dataset)),
        folded("Study", f"<pre>{_text(str(attrs.get('study', '')).strip())}</pre>" if attrs.get("study") else ""),
        section("Provenance", _provenance(dataset)),
    ]
    references = f'<p class="quiet">{_text(str(attrs["references"]))}</p>' if attrs.get("references") else ""
    return laid_out(_text(name), _text(title or name), references, parts)


def _text(words: str) -> str:
    """Words for the page, absolute paths without their folders."""
    return escape(_PLACES.sub(r"\1", words))


def _facts(dataset: xarray.Dataset) -> str:
    """The result in a sentence and a few numbers."""
    cards = "".join(
        f"<li><span>{escape(fact.what)}</span><strong>{escape(fact.value)}</strong><small>{_text(fact.sentence)}</small></li>"
        for fact in facts_of(dataset)
    )
    sentence = sentence_of(dataset)
    said = f'<p class="lead">{escape(sentence)}</p>\n' if sentence else ""
    return said + (f'<ul class="facts-first">{cards}</ul>\n' if cards else "")


def _outcomes(dataset: xarray.Dataset) -> str:
    """How many cases ended how, as a bar with its numbers; of one case the sentence says it."""
    if "outcome" not in dataset.variables or dataset["outcome"].size == 1:
        return ""
    flags = dataset["outcome"].values
    total = flags.size
    bar, words = [], []
    for flag, name in OUTCOMES.items():
        if count := int((flags == flag).sum()):
            colour = OUTCOME_COLOURS[name]
            bar.append(f'<span style="flex:{count};background:{colour}"></span>')
            words.append(f'<li><i style="background:{colour}"></i>{count} {escape(outcome_words(name))}</li>')
    many = "case" if total == 1 else "cases"
    key = f'<div class="bar">{"".join(bar)}</div><ul class="key">{"".join(words)}</ul>\n'
    return f'<p class="quiet">{total} {many}</p>{key}'


def _audit(dataset: xarray.Dataset) -> str:
    """What an audit found, as `rock run` says it."""
    said = "; ".join(json.loads(dataset.attrs.get("audit", "{}")).get("says", ()))
    return f'<p class="quiet">{_text(_plain(dataset, f"audit: {said}"))}</p>\n' if said else ""


def _thresholds(dataset: xarray.Dataset) -> str:
    """The lowest overturning values that a search found."""
    axes = axes_of(dataset)
    units = units_of(dataset)
    coordinates = {axis: np.array(coordinate_words(dataset, axis), dtype=str) for axis in axes}
    said = []
    for name, item in dataset.data_vars.items():
        if str(name).endswith(FOUND) and item.dims == axes:
            words = threshold_words(thresholds_in(dataset, str(name)), coordinates, item.attrs.get("units", "1"), units)
            sentence = f"lowest overturning {str(name).removesuffix(FOUND)}: {words}"
            said.append(f"<p>{escape(_plain(dataset, sentence))}</p>\n")
    return "".join(said)


def _suite(dataset: xarray.Dataset) -> str:
    """What the ensemble statistics come to."""
    said = json.loads(dataset.attrs.get("ensemble", "{}")).get("shown", ())
    items = "".join(f"<li>{_text(_plain(dataset, sentence))}</li>" for sentence in said)
    return f"<details><summary>The suite in sentences</summary><ul>{items}</ul></details>\n" if items else ""


def _plain(dataset: xarray.Dataset, sentence: str) -> str:
    """A sentence with names of axes, and of what was searched along, as they are said."""
    names = {axis: name_of(dataset, axis) for axis in axes_of(dataset)}
    found = [str(name).removesuffix(FOUND) for name in dataset.data_vars if str(name).endswith(FOUND)]
    names |= {name: searched_words(dataset, name) for name in found}
    sentence = re.sub(r"\w+", lambda word: names.get(word[0], word[0]), sentence)
    of_a_point = "=" in sentence.partition(" ")[0]  # `h=0.8`, which is not `H`
    return (sentence if of_a_point else sentence[:1].upper() + sentence[1:]) + "."


def _verdicts(verdicts: Sequence[tuple[bool, str]]) -> str:
    if not verdicts:
        return ""
    met = sum(passed for passed, _ in verdicts)
    rows = [
        f'<li class="{"ok" if passed else "bad"}"><b>{"met" if passed else "not met"}</b> {_text(words)}</li>'
        for passed, words in verdicts
    ]
    items = f'<ul class="verdicts">{"".join(rows)}</ul>'
    if met == len(verdicts):
        return f"<details><summary>Expected: {met} of {len(verdicts)} met</summary>{items}</details>\n"
    return f"<h3>Expected: {met} of {len(verdicts)} met</h3>{items}\n"


def _warnings(dataset: xarray.Dataset) -> str:
    """Warnings about the study, and what the cases have to say, with how many say it."""
    said = [str(sentence) for sentence in json.loads(dataset.attrs.get("warnings", "[]"))]
    if "reason" in dataset.variables and "reasons" in dataset.variables:
        numbers = dataset["reason"].values
        codes, counts = np.unique(numbers[np.isfinite(numbers)], return_counts=True)
        sentences = dataset["reasons"].values
        for code, count in zip(codes, counts, strict=True):
            if sentence := str(sentences[int(code)]):
                said.append(f"{sentence} ({int(count)} of the cases)" if dataset["reason"].size > 1 else sentence)
    items = "".join(f"<li>{_text(sentence)}</li>" for sentence in said)
    return f'<ul class="notes">{items}</ul>\n' if items else ""


def _plot(dataset: xarray.Dataset, kind: str) -> str:
    """A section with a drawing, which is a picture where that would be far smaller."""
    title = _title(dataset, kind)
    sentence = KINDS[kind].sentence.partition(";")[0] if kind in KINDS else ""  # the rest is of other content
    if why := why_not(kind, dataset):
        return section(title, f'<p class="quiet">not drawn: {_text(why)}</p>')
    drawn = figure(kind, dataset, Look(title=None))
    note = style.untold(drawn)
    said = "; ".join(filter(None, (sentence, note, _left_out(dataset, kind, note))))
    return section(title, f'<p class="quiet">{_text(said)}</p><div class="plot">{image(drawn, said)}</div>')


def _title(dataset: xarray.Dataset, kind: str) -> str:
    """Title of the section of a figure; a curve is also of what a search found, or of a suite."""
    if kind == "curve" and any(str(name).endswith(FOUND) for name in dataset.data_vars):
        return "Lowest overturning values"
    if kind == "curve" and suite_curve.along(dataset) is not None:
        return "Share that overturns"
    return _TITLES.get(kind, kind.replace("_", " ").capitalize())


def _left_out(dataset: xarray.Dataset, kind: str, note: str) -> str:
    """How to draw what a figure leaves out; "" where its note says nothing of it."""
    found = _SOME.search(note)
    if found is None:
        return ""
    gone = () if found[1] in ("cases", "motions", "bodies") else suite_axes(dataset)  # a part of a suite is no suite
    axes = [axis for axis in axes_of(dataset) if dataset.sizes[axis] > 1 and axis not in gone]
    if found[1] == "bodies":
        shape = {axis for name in ("R", "alpha") if name in dataset.variables for axis in dataset[name].dims}
        axes = [axis for axis in axes if axis in shape] or axes
    file = f"{dataset.attrs.get('study_name', 'FILE')}.nc"
    return f"the figure names them; others: rock plot {file} --kind {kind} --select AXIS=VALUE, of {', '.join(axes)}"


_SOME = re.compile(r"\d+ of \d+ (\w+) shown")
"""What `selection_note` says."""

_TITLES = {
    "body": "The body",
    "barriers": "The body",
    "motion": "The ground motion",
    "histories": "Response",
    "bending": "Bending",
    "phase": "Phase portrait",
    "map": "Outcomes",
    "curve": "Peak rotation",
    "polar": "Directions",
    "ida": "Incremental dynamic analysis",
    "fragility": "Fragility",
    "curves": "Static curves",
    "work_precision": "Error against cost",
}
"""Titles of sections, where the name of the kind is none."""


def _provenance(dataset: xarray.Dataset) -> str:
    attrs = dataset.attrs
    rows = [("solved by", str(attrs.get("source", ""))), ("when", str(attrs.get("date_created", "")))]
    rows += [("axes", ", ".join(axes_of(dataset)) or "none: one case"), ("backends", str(attrs.get("backends", "")))]
    for settings in json.loads(attrs.get("solver_settings", "[]")):
        words = ", ".join(f"{key}: {value}" for key, value in settings.items())
        rows.append(("settings", words))
    for file, digest in json.loads(attrs.get("inputs", "{}")).items():  # records, tables, outlines, meshes
        rows.append((f"file {file}", f"SHA-256 {digest}"))
    for record, steps in json.loads(attrs.get("processing", "{}")).items():
        rows += [(f"processing of {record}", str(step)) for step in steps]
    versions = json.loads(attrs.get("versions", "{}"))
    rows.append(("versions", ", ".join(f"{key} {value}" for key, value in versions.items())))
    rows.append(("identity", str(attrs.get("identity", ""))))
    body = "".join(f"<tr><th>{_text(key)}</th><td>{_text(value)}</td></tr>" for key, value in rows if value)
    return f'<table class="facts">{body}</table>'
