"""`rock run`: solve studies, judge and draw their results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rockcli.cli.options import PlotFormat, Results, Settings, SkipMissing, Studies, Workers
from rockcli.cli.say import say, warn

if TYPE_CHECKING:
    from rockcli.engine.summary import RunReport
    from rockcli.study.study import Study


def run(
    studies: Studies,
    out: Results = Path("results"),
    settings: Settings = None,
    workers: Workers = None,
    dask: Annotated[
        str | None, typer.Option("--dask", metavar="ADDRESS", help="Solve on a Dask cluster, as tcp://host:8786.")
    ] = None,
    part: Annotated[
        str | None, typer.Option("--part", metavar="K/N", help="Solve one share; a last plain run merges them.")
    ] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Replace results that are there.")] = False,
    skip_missing: SkipMissing = False,
    audit: Annotated[
        bool, typer.Option("--audit", help="Solve again at a tighter accuracy and report what disagrees.")
    ] = False,
    no_plots: Annotated[bool, typer.Option("--no-plots", help="Draw nothing.")] = False,
    plot_format: PlotFormat = "png",
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No progress, no summary; errors only.")] = False,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="List every clause of `expect`.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")] = False,
    junit: Annotated[
        Path | None, typer.Option("--junit", metavar="FILE", help="Write the `expect` checks as JUnit XML.")
    ] = None,
) -> None:
    """Solve studies, judge and draw their results.

    Results go to DIR/<name>/<name>.nc, plots beside it; `expect` clauses decide the exit code.
    """
    from rockcli.cli.interrupt import advise
    from rockcli.cli.junit import check_junit, write_junit
    from rockcli.cli.sources import open_all
    from rockcli.cli.words import totals_text
    from rockcli.engine.draw import check_format
    from rockcli.engine.run import check_study, dataset_path
    from rockcli.engine.summary import SKIPPED, RunReport, exit_code
    from rockcli.engine.sweep.executors import usable_cores
    from rockcli.engine.sweep.work import Team

    check_format(plot_format)
    share = _share(part, fresh=fresh)
    if dask is not None:
        from rockcli.engine.sweep.cluster import check_cluster

        check_cluster(dask)
    opened = open_all(
        studies,
        [*(settings or ()), *(["audit=true"] if audit else [])],
        skip_missing=skip_missing,
        also=lambda study: check_study(study, out, fresh=fresh),
        readers=workers or usable_cores(),
    )
    if junit is not None:
        check_junit(junit, [dataset_path(study, out) for study in opened.studies])
    reports = [RunReport(name=file.stem, status=SKIPPED, warnings=(why,)) for file, why in opened.skipped]
    for report in reports:
        say(f"rock: skipped {report.name}: {report.warnings[0]}", err=True)
    spoken = not quiet and not as_json
    advise(f"run again{' without --fresh' if fresh else ''} to continue: finished cases are kept")
    for study in opened.studies:
        team = Team(workers or usable_cores(), dask)
        how: dict[str, Any] = {"plots": not no_plots, "plot_format": plot_format, "team": team, "share": share}
        report = _run_one(study, out, progress=not quiet, fresh=fresh, si=as_json, **how)
        _tell(report, spoken=spoken, quiet=quiet, every=verbose)
        reports.append(report)
    if spoken and (len(reports) > 1 or opened.skipped):
        say(totals_text(reports))
    code = exit_code(reports)
    if junit is not None:
        write_junit(reports, junit)  # before the JSON, whose exit code is then that of the command
    if as_json:
        import json

        say(json.dumps({"exit_code": code, "units": "SI", "studies": [r.as_dict() for r in reports]}, indent=2))
    raise typer.Exit(code)


def _share(part: str | None, *, fresh: bool) -> tuple[int, int] | None:
    """`2/8` -> (2, 8)."""
    import re

    from rockcli.errors import StudyError

    if part is None:
        return None
    found = re.fullmatch(r"(\d{1,9})/(\d{1,9})", part)
    if found is None or not 1 <= int(found[1]) <= int(found[2]):
        raise StudyError(f"--part {part}: expected K/N with K from 1 to N, such as 2/8")
    if fresh:
        raise StudyError("--part does not go with --fresh: shares may run at the same time; remove the old results")
    return int(found[1]), int(found[2])


def _run_one(study: Study, out: Path, *, progress: bool, **options: Any) -> RunReport:
    from rockcli import kernels
    from rockcli.cli.progress import Progress
    from rockcli.engine.run import run_study

    line = Progress(study.name, shown=progress)
    line.listen()
    kernels.announce = line.note
    try:
        return run_study(study, out, progress=line, **options)
    finally:
        kernels.announce = None
        line.close()


def _tell(report: RunReport, *, spoken: bool, quiet: bool, every: bool) -> None:
    from rockcli.cli.words import report_text

    if not quiet:
        for warning in report.warnings:
            warn(report.name, warning)
    if spoken:
        say(report_text(report, every=every))
