"""Summary of a run: counts, checks, files, and the exit code that follows."""

from __future__ import annotations

import json
import re
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from rockcli.analysis.expect import Verdict, expected_failures, judge
from rockcli.analysis.places import coordinates, place, units_of
from rockcli.analysis.rules import Misled, misled
from rockcli.analysis.threshold_fields import found_by
from rockcli.scene.response import FAILED, OUTCOMES
from rockcli.scene.thresholds import FOUND, threshold_words
from rockcli.scene.units import SI, Units
from rockcli.storage.contents import Contents
from rockcli.storage.on_disk import in_blocks
from rockcli.study.study import Study

_NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")

SOLVED, UP_TO_DATE, SKIPPED, SHARE = "solved", "up to date", "skipped", "share solved"


@dataclass(frozen=True)
class RunReport:
    """One study's run.

    Attributes:
        name: of the study; status: SOLVED, UP_TO_DATE, SKIPPED or SHARE; file: the dataset, None without one.
        cases: number of cases; outcomes: cases by outcome, without those that have none.
        failed: cases that failed although no clause expected it.
        peak: largest finite theta_peak_over_alpha (None without one); peak_at: its place on the axes.
        slide: largest finite slide_peak [m] (None where nothing slides); slide_at: its place on the axes.
        slides_on: cases that no friction stops, whose slide_peak is infinite.
        verdicts: of the `expect` clauses, in order.
        reasons: sentence -> number of cases, most first; sentences that differ in numbers only count as the first.
        suite: what the ensemble statistics come to, in sentences; audit: what an audit found.
        fragility: a row of numbers per body and limit state, by the names of the dataset, in SI units.
        samples: the same of the probability of overturning and the uncertain inputs, a row per point of the other axes.
        risk: the same of annual rates, per body, limit state and hazard curve.
        overturns: searched axis -> its lowest overturning values, in words.
        rules: what the rules of thumb would have said of the same cases.
        warnings: about the physics and the study.
        plots: files drawn; seconds: wall time of solving and writing, without drawing.
        taken_over: cases that the results of a study of fewer points had; resumed: cases from parts of earlier runs
            (of a search, trials), after a share: cases that all shares have by now.
        share: (K, N) of a share.
        refined: cases of a refined map that were solved; None where every case is.
        drawn: of those, drawn at random to check the outcomes filled in; drawn_wrong: how many of them had a wrong one.
        wrong_at_most: share of all cases that are filled in wrongly, at most, at 95 % confidence; None: nothing drawn.
    """

    name: str
    status: str
    file: Path | None = None
    cases: int = 0
    outcomes: dict[str, int] = field(default_factory=dict)
    failed: int = 0
    peak: float | None = None
    peak_at: str = ""
    slide: float | None = None
    slide_at: str = ""
    slides_on: int = 0
    verdicts: tuple[Verdict, ...] = ()
    reasons: dict[str, int] = field(default_factory=dict)
    overturns: dict[str, str] = field(default_factory=dict)
    rules: tuple[Misled, ...] = ()
    suite: tuple[str, ...] = ()
    fragility: tuple[dict[str, Any], ...] = ()
    samples: tuple[dict[str, Any], ...] = ()
    risk: tuple[dict[str, Any], ...] = ()
    audit: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    plots: tuple[Path, ...] = ()
    seconds: float = 0.0
    taken_over: int = 0
    resumed: int = 0
    share: tuple[int, int] | None = None
    refined: int | None = None
    drawn: int | None = None
    drawn_wrong: int | None = None
    wrong_at_most: float | None = None

    @property
    def unmet(self) -> int:
        """Number of clauses that are not met."""
        return sum(not verdict.passed for verdict in self.verdicts)

    @property
    def exit_code(self) -> int:
        """3 some cases failed, 1 an expectation is not met, 0."""
        return 3 if self.failed else 1 if self.unmet else 0

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON; verdicts in words."""
        plain = asdict(self) | {
            "file": None if self.file is None else str(self.file),
            "plots": [str(path) for path in self.plots],
            "exit_code": self.exit_code,
        }
        plain["expect"] = [
            {
                "clause": v.text,
                "passed": v.passed,
                "points": v.points,
                "failing": v.failing,
                "worst": v.worst,
                "where": v.where,
                "references": v.clause.references,
            }
            for v in self.verdicts
        ]
        del plain["verdicts"]
        for rule in plain["rules"]:  # the old names of the two stay for one release
            rule |= {"unsafe": rule["unconservative"], "wary": rule["false_alarms"]}
        return plain


def report_on(study: Study, contents: Contents, *, si: bool = False, **more: Any) -> RunReport:
    """Report on a dataset of a study, whether just solved or read back; `si`: accelerations in m/s², not in g."""
    units = SI if si else units_of(contents)
    peak, peak_at = largest(contents, "theta_peak_over_alpha", units)
    slide, slide_at = largest(contents, "slide_peak", units)
    return RunReport(
        name=study.name,
        cases=study.size,
        outcomes=outcomes_of(contents),
        failed=_failed(study, contents),
        peak=peak,
        peak_at=peak_at,
        slide=slide or None,
        slide_at=slide_at if slide else "",
        slides_on=infinite(contents, "slide_peak"),
        **_refined(contents),
        verdicts=tuple(judge(contents, study.expect, units)),
        reasons=_reasons(contents),
        overturns=_overturns(contents, units),
        rules=misled(contents),
        suite=tuple(json.loads(contents.attrs.get("ensemble", "{}")).get("says" if si else "shown", ())),
        **_suite_rows(contents),
        audit=tuple(json.loads(contents.attrs.get("audit", "{}")).get("says", ())),
        **more,
    )


def _suite_rows(contents: Contents) -> dict[str, Any]:
    """The rows of numbers of a dataset with statistics of suites, which take modules that others need not load."""
    if "ensemble" not in contents.attrs:
        return {}
    from rockcli.analysis.suites.fragility import fragility_rows
    from rockcli.analysis.suites.risk import risk_rows
    from rockcli.analysis.suites.uncertainty import sample_rows

    rows = {"fragility": fragility_rows, "samples": sample_rows, "risk": risk_rows}
    return {name: tuple(rows_of(contents)) for name, rows_of in rows.items()}


def _refined(contents: Contents) -> dict[str, Any]:
    """What was solved of a refined map, and what is known of the rest."""
    if "solved" not in contents.fields:
        return {}
    attrs = contents.fields["solved"].attrs
    kinds = {"drawn": int, "drawn_wrong": int, "wrong_at_most": float}
    told = {name: kind(attrs[name]) for name, kind in kinds.items() if name in attrs}
    return {"refined": int(contents.values("solved").sum()), **told}


def exit_code(reports: list[RunReport]) -> int:
    """The first that applies: 3, 1, 0."""
    codes = {report.exit_code for report in reports}
    return 3 if 3 in codes else 1 if 1 in codes else 0


def outcomes_of(contents: Contents) -> dict[str, int]:
    """Cases by outcome, without those that have none."""
    if "outcome" not in contents.fields:
        return {}
    flags = contents.values("outcome")
    counts = dict.fromkeys(OUTCOMES, 0)
    for at in in_blocks(flags):
        for flag in counts:
            counts[flag] += int(np.count_nonzero(flags[at] == flag))
    return {name: counts[flag] for flag, name in OUTCOMES.items() if counts[flag]}


def _failed(study: Study, contents: Contents) -> int:
    if "outcome" not in contents.fields:  # of a search: a trial of the case failed
        return int(np.sum(contents.values("reason") > 0)) if study.search and "reason" in contents.fields else 0
    flags = contents.values("outcome")
    return sum(
        int(np.sum((flags[at] == FAILED) & ~expected_failures(contents, study.expect, at))) for at in in_blocks(flags)
    )


def largest(contents: Contents, name: str, units: Units) -> tuple[float | None, str]:
    """The largest finite value of a scalar, None without one, and its place on the axes."""
    if name not in contents.fields:
        return None, ""
    values = contents.values(name)
    most, where = -1.0, ()
    for at in in_blocks(values):
        finite = np.where(np.isfinite(values[at]), values[at], -1.0)
        if finite.size and finite.max() > most:
            inside = np.unravel_index(int(np.argmax(finite)), finite.shape)
            most, where = float(finite[inside]), tuple(s.start + int(i) for s, i in zip(at, inside, strict=True))
    return (None, "") if most < 0.0 else (most, place(contents, contents.axes, where, units))


def infinite(contents: Contents, name: str) -> int:
    """How many values of a scalar are infinite."""
    if name not in contents.fields:
        return 0
    values = contents.values(name)
    return sum(int(np.sum(np.isinf(values[at]))) for at in in_blocks(values))


def _overturns(contents: Contents, units: Units) -> dict[str, str]:
    axes = {name: coordinates(contents, name, units) for name in contents.axes}
    return {
        name.removesuffix(FOUND): threshold_words(found_by(contents, name), axes, item.attrs.get("units", "1"), units)
        for name, item in contents.fields.items()
        if name.endswith(FOUND) and item.dims == contents.axes
    }


def _reasons(contents: Contents) -> dict[str, int]:
    if "reason" not in contents.fields:
        return {}
    codes, sentences = contents.values("reason"), contents.values("reasons")
    counts = np.zeros(len(sentences), dtype=np.int64)
    for at in in_blocks(codes):
        counts += np.bincount(codes[at].ravel(), minlength=len(sentences))
    kinds: dict[str, tuple[str, int]] = {}
    for code in np.flatnonzero(counts):
        sentence, count = str(sentences[code]), counts[code]
        if sentence:
            # what `model: auto` expects are numbers that belong to the sentence; others tell one case from the next
            kind = sentence if sentence.startswith("auto: ") else _NUMBER.sub("#", sentence)
            example, before = kinds.get(kind, (sentence, 0))
            kinds[kind] = (example, before + int(count))
    return dict(sorted(kinds.values(), key=lambda item: -item[1]))
