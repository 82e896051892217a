"""`rock score`: predictions of experiments against what happened."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rockcli.cli.options import Specimen, Workers
from rockcli.cli.say import say

if TYPE_CHECKING:
    from rockcli.analysis.experiments.scores import Score
    from rockcli.cli.progress import Progress
    from rockcli.engine.experiments.runs import Runs
    from rockcli.engine.experiments.score import Options, Prediction, Report
    from rockcli.engine.sweep.work import Team
    from rockcli.study.schema import ScorePart


def score(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="[STUDY.yaml] [RUNS.csv]", help="The study that predicts, and the table of runs; or its `score`."
        ),
    ],
    folds: Annotated[
        str | None,
        typer.Option("--folds", metavar="COLUMN", help="Predict by a calibration on other groups."),
    ] = None,
    calibration: Annotated[
        Path | None, typer.Option("--calibration", metavar="FILE.json", help="What `rock calibrate` wrote.")
    ] = None,
    count: Annotated[
        int | None, typer.Option("--count", metavar="K", min=0, help="Folds; 0 = one per group; default 5.")
    ] = None,
    repeats: Annotated[
        int | None, typer.Option("--repeats", metavar="N", min=1, help="Divisions into folds; default 5.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option("--seed", min=0, help="Of the folds and of the bootstrap; default 0.")
    ] = None,
    predictions: Annotated[
        str | None, typer.Option("--predictions", metavar="A,B", help="Columns to score; default: all that can be.")
    ] = None,
    against: Annotated[
        str | None, typer.Option("--against", metavar="NAME", help="Prediction that the others are tested against.")
    ] = None,
    specimen: Specimen = None,
    units: Annotated[
        str | None, typer.Option("--units", metavar="g|m/s2|...", help="Of records that do not say; without a study.")
    ] = None,
    dt: Annotated[
        float | None, typer.Option("--dt", metavar="SECONDS", help="Of records that do not say; without a study.")
    ] = None,
    no_baselines: Annotated[bool, typer.Option("--no-baselines", help="Fit none.")] = False,
    workers: Workers = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="Write a page (.html), a figure (.png .pdf .svg).")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the scores as JSON.")] = False,
) -> None:
    """Score predictions of overturning against experiments.

    A study may say all of it under `score`: rock score STUDY.yaml; options given here replace what it says.
    Without a study the predictions are columns of the table: probabilities, or outcomes.  With a study and --folds each
    run is predicted by a calibration on the other groups, without them as the study stands.
    """
    from rockcli.cli.progress import Progress
    from rockcli.engine.experiments.runs import GROUP, read_runs
    from rockcli.engine.experiments.score import Options, by_specimen
    from rockcli.engine.experiments.score_page import check_target, write
    from rockcli.engine.sweep.executors import usable_cores
    from rockcli.engine.sweep.work import Team
    from rockcli.errors import StudyError

    study, table, said = _sources(files)
    folds, specimen, against = folds or said.groups, specimen or said.specimen, against or said.against
    if calibration is None and said.calibration is not None:
        calibration = Path(said.calibration)
    reading = {key: value for key, value in (("units", units), ("dt", dt)) if value is not None}
    if study is not None and reading:
        raise StudyError("--units and --dt are for records without a study, which says them itself")
    if study is None and calibration is not None:
        raise StudyError("--calibration is of a study's bodies: give STUDY.yaml too")
    if out is not None:
        check_target(out)
    named = said.predictions
    if predictions is not None:
        named = [name.strip() for name in predictions.split(",") if name.strip()]
    runs = read_runs(table, group=folds or GROUP, predictions=named)
    asked = {"count": count, "repeats": repeats, "seed": seed}
    numbers = {key: getattr(said, key) if given is None else given for key, given in asked.items()}
    numbers = {key: value for key, value in numbers.items() if value is not None}
    options = Options(**numbers, baselines=said.baselines and not no_baselines, against=against)
    chosen = by_specimen(runs, specimen)
    if calibration is not None and len(chosen) > 1:
        raise StudyError(f"has {len(chosen)} specimens, a calibration is of one: choose with --specimen", file=table)
    line = Progress(table.name, shown=True)
    try:
        team = Team(workers or usable_cores())
        reports = _reports(chosen, study, calibration, options, reading, folds is not None, team, line)
    finally:
        line.close()
    if out is not None:
        write(reports, out)
    if as_json:
        import json

        plain = {"runs": str(table), "study": None if study is None else str(study), "seed": options.seed}
        say(json.dumps(plain | {"specimens": [as_plain(report) for report in reports]}, indent=2))
    else:
        say("\n\n".join(text(report) for report in reports))
    for report in reports:
        for note in report.notes:
            say(f"rock: {table.name}{f', {report.specimen}' * bool(report.specimen)}: {note}", err=True)
    if out is not None:
        say(str(out), err=True)


def _reports(
    chosen: list[tuple[str, Runs]],
    study: Path | None,
    calibration: Path | None,
    options: Options,
    reading: dict[str, Any],
    leave_out: bool,
    team: Team,
    line: Progress,
) -> list[Report]:
    """The scores of every specimen; `reading`: how records are read where there is no study."""
    from rockcli.engine.experiments.calibrate import by_study
    from rockcli.engine.experiments.score import report_of
    from rockcli.engine.experiments.simulated import any_body

    source = any_body(reading) if study is None else study
    reports = []
    for label, some in chosen:
        found: tuple[str, Prediction] | None = None
        notes: tuple[str, ...] = ()
        if study is not None:
            name, prediction, notes = by_study(
                study, some, calibration, options, leave_out=leave_out, team=team, progress=line
            )
            found = name, prediction
        reports.append(report_of(some, specimen=label, study=found, source=source, options=options, notes=notes))
    return reports


def _sources(files: list[Path]) -> tuple[Path | None, Path, ScorePart]:
    """The study, if any, the table, and what a study without a table says of how it is scored."""
    from rockcli.errors import StudyError
    from rockcli.study.schema import ScorePart
    from rockcli.study.scoring import read_score

    yaml = [file for file in files if file.suffix.lower() in (".yaml", ".yml")]
    tables = [file for file in files if file not in yaml]
    if len(tables) > 1 or len(yaml) > 1:
        raise StudyError("expected RUNS.csv, STUDY.yaml RUNS.csv, or a STUDY.yaml with `score`")
    if tables:
        return (yaml[0] if yaml else None), tables[0], ScorePart(file=str(tables[0]))
    said = read_score(yaml[0])
    return yaml[0], Path(said.file), said


def text(report: Report) -> str:
    """The scores as tables for the terminal."""
    from rockcli.analysis.experiments.scores import NAMES
    from rockcli.cli.tables import table
    from rockcli.scene.counted import counted

    runs = report.runs
    title = f"{runs.file.name}{f', {report.specimen}' * bool(report.specimen)}: {counted(runs.size, 'run')}"
    title += f" in {counted(len(set(runs.groups.tolist())), 'group')}, {int(runs.outcome.sum())} overturned"
    rows = []
    for name, found in report.scores.items():
        cells = [_interval(found.scores[score]) for score in NAMES]
        rows.append([name, *cells, str(found.missed), str(found.false)])
    head = ["prediction", *(name.replace("_", " ") for name in NAMES), "missed", "false"]
    parts = [title, table(head, rows, right=len(head) - 1, indent=2)]
    parts.append("  95 % in brackets; missed: fell and was to stand; false: stood and was to fall")
    if report.mcnemar:
        rows = [[name, *test.cells()] for name, test in report.mcnemar.items()]
        head = [f"{report.against} against", "runs", "it alone right", "other alone right", "p (McNemar)"]
        parts.append("\n" + table(head, rows, right=4, indent=2))
    rows = [
        [f"{each.p:.2f}", str(each.n), f"{each.share:.2f}", f"{each.low:.2f} to {each.high:.2f}"]
        for each in report.reliability[report.against]
    ]
    parts.append("\n" + table([f"p of {report.against}", "runs", "overturned", "95 %"], rows, right=3, indent=2))
    return "\n".join(parts)


def _interval(found: Score) -> str:
    value = "-" if found.value != found.value else f"{found.value:.3f}"
    return value if found.low != found.low else f"{value} [{found.low:.3f}, {found.high:.3f}]"


def as_plain(report: Report) -> dict[str, Any]:
    """The scores as plain values for JSON; what is not finite is null."""
    from dataclasses import asdict
    from math import isfinite

    def number(value: float) -> float | None:
        return value if isfinite(value) else None

    predictions: dict[str, Any] = {}
    for name, found in report.scores.items():
        each = report.predictions[name]
        predictions[name] = {
            "kind": each.kind,
            "n": found.n,
            "events": found.events,
            **{score: number(value.value) for score, value in found.scores.items()},
            "interval": {score: [number(value.low), number(value.high)] for score, value in found.scores.items()},
            "missed": found.missed,
            "false": found.false,
            "reliability": [asdict(one) for one in report.reliability[name]],
        }
        if each.repeats is not None:
            shares = ((each.repeats >= 0.5) == report.runs.outcome).mean(axis=1)
            predictions[name]["accuracy_of_repeats"] = shares.tolist()
    against = report.predictions[report.against]
    rows = []
    for i, line in enumerate(report.runs.line):
        row = {"line": line, "outcome": int(report.runs.outcome[i]), "p": number(float(against.p[i]))}
        if against.low is not None and against.high is not None:
            row |= {"low": float(against.low[i]), "high": float(against.high[i])}
        rows.append(row)
    return {
        "specimen": report.specimen or None,
        "n": report.runs.size,
        "groups": len(set(report.runs.groups.tolist())),
        "overturned": int(report.runs.outcome.sum()),
        "predictions": predictions,
        "against": report.against,
        "mcnemar": {name: asdict(test) for name, test in report.mcnemar.items()},
        "probabilities": rows,
        "notes": list(report.notes),
    }
