"""The HTML report of a study: one page that needs no network and no other file, from `template.html`."""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Iterable, Sequence
from html import escape
from importlib.resources import files
from string import Template
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np

from rockcli.plotting.common import style
from rockcli.plotting.common.cases import axes_of, thresholds_in
from rockcli.plotting.common.labels import coordinate_words, units_of
from rockcli.plotting.common.style import OUTCOME_COLOURS
from rockcli.plotting.common.table import case_table
from rockcli.plotting.figures import KINDS, default_kinds, figure, why_not
from rockcli.scene.response import OUTCOMES, outcome_words
from rockcli.scene.thresholds import FOUND, threshold_words

if TYPE_CHECKING:
    import xarray

_DPI = 200
"""Sharp on a laptop at twice its nominal resolution."""


def page(dataset: xarray.Dataset, verdicts: Sequence[tuple[bool, str]] = (), kinds: Sequence[str] = ()) -> str:
    """The report of a dataset, from the dataset alone.

    Args:
        dataset: written by `rock run`.
        verdicts: (met, words) of the clauses of `expect`.
        kinds: kinds of plot; () = those its content suggests.
    """
    attrs = dataset.attrs
    name, title = str(attrs.get("study_name", "study")), str(attrs.get("title", ""))
    parts = [
        _section(
            "Result",
            _outcomes(dataset) + _thresholds(dataset) + _suite(dataset) + _verdicts(verdicts) + _warnings(dataset),
        ),
        *_plots(dataset, kinds),
        _section("Cases", _table(*case_table(dataset))),
        _section("Study", f"<pre>{escape(str(attrs.get('study', '')).strip())}</pre>"),
        _section("Provenance", _provenance(dataset)),
    ]
    references = f'<p class="quiet">{escape(str(attrs["references"]))}</p>' if attrs.get("references") else ""
    template = Template(files(__package__).joinpath("template.html").read_text(encoding="utf-8"))
    sections = "\n".join(part for part in parts if part)
    return template.substitute(name=escape(name), title=escape(title), references=references, sections=sections)


def _section(title: str, body: str) -> str:
    return f"<section><h2>{escape(title)}</h2>\n{body}</section>" if body else ""


def _outcomes(dataset: xarray.Dataset) -> str:
    """How many cases ended how, as a bar with its numbers."""
    if "outcome" not in dataset.variables:
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
    return f'<p>{total} {many}</p><div class="bar">{"".join(bar)}</div><ul class="key">{"".join(words)}</ul>\n'


def _thresholds(dataset: xarray.Dataset) -> str:
    """The lowest overturning values that a search found."""
    axes = axes_of(dataset)
    units = units_of(dataset)
    coordinates = {axis: np.array(coordinate_words(dataset, axis), dtype=str) for axis in axes}
    said = []
    for name, item in dataset.data_vars.items():
        if str(name).endswith(FOUND) and item.dims == axes:
            words = threshold_words(thresholds_in(dataset, str(name)), coordinates, item.attrs.get("units", "1"), units)
            said.append(f"<p>Lowest overturning {escape(f'{str(name).removesuffix(FOUND)}: {words}')}.</p>\n")
    return "".join(said)


def _suite(dataset: xarray.Dataset) -> str:
    """What the ensemble statistics come to."""
    said = json.loads(dataset.attrs.get("ensemble", "{}")).get("shown", ())
    return "".join(f"<p>{escape(sentence[:1].upper() + sentence[1:])}.</p>\n" for sentence in said)


def _verdicts(verdicts: Sequence[tuple[bool, str]]) -> str:
    if not verdicts:
        return ""
    met = sum(passed for passed, _ in verdicts)
    rows = [
        f'<li class="{"ok" if passed else "bad"}"><b>{"met" if passed else "not met"}</b> {escape(words)}</li>'
        for passed, words in verdicts
    ]
    return f'<h3>Expected: {met} of {len(verdicts)} met</h3><ul class="verdicts">{"".join(rows)}</ul>\n'


def _warnings(dataset: xarray.Dataset) -> str:
    """Warnings about the study, and what the cases have to say, with how many say it."""
    said = [str(sentence) for sentence in json.loads(dataset.attrs.get("warnings", "[]"))]
    if "reason" in dataset.variables and "reasons" in dataset.variables:
        codes, counts = np.unique(dataset["reason"].values, return_counts=True)
        sentences = dataset["reasons"].values
        for code, count in zip(codes, counts, strict=True):
            if sentence := str(sentences[int(code)]):
                said.append(f"{sentence} ({int(count)} of the cases)" if dataset["reason"].size > 1 else sentence)
    items = "".join(f"<li>{escape(sentence)}</li>" for sentence in said)
    return f'<h3>Notes and warnings</h3><ul class="notes">{items}</ul>\n' if items else ""


def _plots(dataset: xarray.Dataset, kinds: Sequence[str]) -> Iterable[str]:
    for kind in kinds or default_kinds(dataset):
        if why := why_not(kind, dataset):
            yield _section(kind.capitalize(), f'<p class="quiet">not drawn: {escape(why)}</p>')
            continue
        drawn, picture = figure(kind, dataset), io.BytesIO()
        with mpl.rc_context(style.RC), style.no_word_of_glyphs():
            drawn.savefig(picture, format="png", dpi=_DPI)
        code = base64.b64encode(picture.getvalue()).decode("ascii")
        width = int(drawn.get_figwidth() * 130)
        sentence = escape(KINDS[kind].sentence)
        image = f'<img src="data:image/png;base64,{code}" alt="{sentence}" style="width:{width}px">'
        yield _section(kind.capitalize(), f'<p class="quiet">{sentence}</p><div class="plot">{image}</div>')


def _table(header: Sequence[str], rows: Sequence[Sequence[str]], note: str) -> str:
    if not rows:
        return ""
    head = "".join(f"<th>{escape(word).replace('_', '_<wbr>')}</th>" for word in header)
    body = "".join("<tr>" + "".join(f"<td>{escape(word)}</td>" for word in row) + "</tr>" for row in rows)
    below = f'<p class="quiet">{escape(note)}</p>' if note else ""
    return f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>{below}'


def _provenance(dataset: xarray.Dataset) -> str:
    attrs = dataset.attrs
    rows = [("solved by", str(attrs.get("source", ""))), ("when", str(attrs.get("date_created", "")))]
    rows += [("axes", ", ".join(axes_of(dataset)) or "none: one case"), ("backends", str(attrs.get("backends", "")))]
    for settings in json.loads(attrs.get("solver_settings", "[]")):
        words = ", ".join(f"{key}: {value}" for key, value in settings.items())
        rows.append(("settings", words))
    for record, digest in json.loads(attrs.get("inputs", "{}")).items():
        rows.append((f"record {record}", f"SHA-256 {digest}"))
    for record, steps in json.loads(attrs.get("processing", "{}")).items():
        rows += [(f"processing of {record}", str(step)) for step in steps]
    versions = json.loads(attrs.get("versions", "{}"))
    rows.append(("versions", ", ".join(f"{key} {value}" for key, value in versions.items())))
    rows.append(("identity", str(attrs.get("identity", ""))))
    body = "".join(f"<tr><th>{escape(key)}</th><td>{escape(value)}</td></tr>" for key, value in rows if value)
    return f'<table class="facts">{body}</table>'
