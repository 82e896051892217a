"""The summary of `rock run` in words, for a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rockcli.cli.progress import duration
from rockcli.scene.counted import counted
from rockcli.scene.response import outcome_words

if TYPE_CHECKING:
    from rockcli.analysis.expect import Verdict
    from rockcli.engine.summary import RunReport

_MOST_REASONS = 5

_MOST_MET = 5
"""Clauses up to which those that are met are listed too."""


def report_text(report: RunReport, *, every: bool = False) -> str:
    """A study's summary: a headline and a few aligned lines.

    `every`: with all clauses of `expect`; else, where they are many, those that are met are only counted.
    """
    if report.share is not None:
        return _share_text(report)
    time = f" in {duration(report.seconds)}" if report.status == "solved" else ""
    lines = [f"{report.name}: {counted(report.cases, 'case')}, {report.status}{time}"]
    for count, source in ((report.taken_over, "the existing results"), (report.resumed, "earlier runs")):
        if count:
            what = "trial" if report.overturns else "case"
            lines.append(_row("kept", f"{counted(count, what)} of {source}"))
    if report.refined is not None:
        share = report.refined / max(report.cases, 1)
        some = f"({min(100.0 * share, 99.0):.2g} %), the outcomes between them filled in"
        lines.append(_row("refined", f"{counted(report.refined, 'case')} solved {some if share < 1.0 else '(all)'}"))
    if report.drawn and report.wrong_at_most is not None:
        drawn = f"{report.drawn_wrong} of {counted(report.drawn, 'case')} drawn at random were filled in wrongly"
        lines.append(_row("", f"{drawn}: at most {100.0 * report.wrong_at_most:.2g} % of all are (95 % confidence)"))
    if report.outcomes:
        lines.append(_row("outcomes", ", ".join(f"{n} {outcome_words(name)}" for name, n in report.outcomes.items())))
    if report.peak is not None:
        where = f" at {report.peak_at}" if report.peak_at and report.peak > 0.0 else ""
        lines.append(_row("peak", f"|theta|/alpha = {report.peak:.6g}{where}" + _survivors(report)))
    if report.slide is not None:
        where = f" at {report.slide_at}" if report.slide_at else ""
        stops = f" (largest of those that stop; {counted(report.slides_on, 'case')} never)" if report.slides_on else ""
        lines.append(_row("slide", f"|displacement| = {report.slide:.6g} m{where}{stops}"))
    lines += [_row("overturns", f"lowest overturning {axis}: {words}") for axis, words in report.overturns.items()]
    for number, (sentence, count) in enumerate(list(report.reasons.items())[:_MOST_REASONS]):
        often = f" ({counted(count, 'case')})" if report.cases > 1 else ""
        lines.append(_row("notes" if number == 0 else "", sentence + often))
    if len(report.reasons) > _MOST_REASONS:
        others = counted(len(report.reasons) - _MOST_REASONS, "other message")
        lines.append(_row("", f"and {others}, in `reasons` of the dataset"))
    if report.failed and report.status == "up to date":
        again = "once the cause is mended, as a program installed, --fresh solves all again"
        lines.append(_row("failed", f"{counted(report.failed, 'case')} when this file was made; {again}"))
    lines += _rules(report)
    lines += [_row("suite" if number == 0 else "", words) for number, words in enumerate(report.suite)]
    lines += [_row("audit" if number == 0 else "", words) for number, words in enumerate(report.audit)]
    if report.verdicts:
        met = len(report.verdicts) - report.unmet
        lines.append(_row("expect", f"{met} of {len(report.verdicts)} met"))
        told = report.verdicts
        if not every and len(told) > _MOST_MET:
            told = tuple(verdict for verdict in told if not verdict.passed)
            lines[-1] += "" if told else " (-v lists them)"
        lines += ["    " + verdict_text(verdict) for verdict in told]
    lines.append(_row("file", str(report.file)))
    if report.plots:
        lines.append(_row("plots", " ".join(path.name for path in report.plots)))
    return "\n".join(lines)


def _share_text(report: RunReport) -> str:
    assert report.share is not None
    k, n = report.share
    left = report.cases - report.resumed
    then = f"{counted(left, 'case')} of other shares still missing" if left else "run without --part to merge"
    return f"{report.name}: share {k}/{n} solved in {duration(report.seconds)}, {then}"


def _rules(report: RunReport) -> list[str]:
    """What the rules of thumb would have made of the same cases."""
    speaking = [rule for rule in report.rules if rule.cases]
    if report.rules and not speaking:
        return [_row("rules", "held against no history, which needs a ground motion and an outcome")]
    lines = []
    for number, rule in enumerate(speaking):
        what = "slides farther" if rule.of_slide else "stable by the rule, overturned by the history"
        missed = f"{rule.unconservative:.4g} unconservative ({what})"
        alarms = f"{rule.false_alarms:.4g} false alarm{'' if rule.false_alarms == 1 else 's'}"
        words = f"{rule.name}: {missed}, {alarms}, of {rule.cases} ({rule.edition})"
        lines.append(_row("rules" if number == 0 else "", words))
    return lines


def _survivors(report: RunReport) -> str:
    if report.refined is not None:
        return " (largest of the solved cases that remain stable)"
    return (
        " (largest of the cases that remain stable)"
        if any(name.startswith("overturned") for name in report.outcomes)
        else ""
    )


def verdict_text(verdict: Verdict) -> str:
    """`ok    clause: got`, or `FAIL  clause: how many points fail, the worst and where`."""
    if verdict.points == 0:
        return f"FAIL  {verdict.text}: {verdict.worst}"
    where = f" at {verdict.where}" if verdict.where else ""
    if verdict.passed and verdict.points == 1:
        return f"ok    {verdict.text}: {verdict.worst}"
    if verdict.passed:
        closest = "" if verdict.clause.check in ("is", "is_not") else f", closest {verdict.worst}{where}"
        return f"ok    {verdict.text}: {verdict.points} points{closest}"
    verb = "fails" if verdict.failing == 1 else "fail"
    many = "" if verdict.points == 1 else f"{verdict.failing} of {verdict.points} points {verb}, worst "
    line = f" (line {verdict.clause.line})" if verdict.clause.line is not None else ""
    return f"FAIL  {verdict.text}: {many}{verdict.worst}{where}{line}"


def totals_text(reports: Sequence[RunReport]) -> str:
    """The last line of a run of several studies."""
    ran = [report for report in reports if report.status != "skipped"]
    clauses = sum(len(report.verdicts) for report in ran)
    unmet = sum(report.unmet for report in ran)
    parts = [counted(len(ran), "study"), counted(sum(report.cases for report in ran), "case")]
    if failed := sum(report.failed for report in ran):
        parts.append(f"{failed} failed")
    if clauses:
        parts.append(f"{clauses - unmet} of {counted(clauses, 'expectation')} met")
    if len(ran) < len(reports):
        parts.append(f"{len(reports) - len(ran)} skipped")
    return ", ".join(parts)


def _row(name: str, words: str) -> str:
    return f"  {name:<9} {words}"
