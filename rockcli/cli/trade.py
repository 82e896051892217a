"""`rock trade`: what accuracy costs on the cases of a study, by backend, model and setting."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rockcli.cli.options import PlotFormat, Results, Settings
from rockcli.cli.say import say
from rockcli.cli.tables import table
from rockcli.scene.counted import counted

if TYPE_CHECKING:
    from rockcli.engine.trade.measurements import Point, Trade
    from rockcli.study.study import Study

_UNITS = {"": 1.0, "s": 1.0, "min": 60.0, "h": 3600.0}


def trade(
    study: Annotated[Path, typer.Argument(metavar="STUDY.yaml", help="A study.")],
    out: Results = Path("results"),
    settings: Settings = None,
    sample: Annotated[int, typer.Option("--sample", metavar="N", min=1, help="Cases measured, at most.")] = 20,
    budget: Annotated[
        str,
        typer.Option(
            "--budget",
            metavar="TIME",
            help="Time for all that is measured, such as 60s, '5 min', 1h; a setting once begun is finished.",
        ),
    ] = "60s",
    every: Annotated[bool, typer.Option("--all", help="List every setting, not only the Pareto front.")] = False,
    no_plots: Annotated[bool, typer.Option("--no-plots", help="Draw nothing.")] = False,
    plot_format: PlotFormat = "png",
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No progress, no table; errors only.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")] = False,
) -> None:
    """Measure what accuracy costs on the cases of a study.

    Every backend and setting that solves the study's model, from coarse to fine; errors of numerics, model and data
    apart; DIR/<name>-trade/<name>-trade.nc, a work-precision plot, and the Pareto front on stdout.
    """
    from rockcli.cli.interrupt import advise
    from rockcli.cli.progress import Progress
    from rockcli.cli.sources import open_all
    from rockcli.engine.draw import check_format
    from rockcli.engine.trade.trade import trade as measure
    from rockcli.engine.trade.trade_results import as_dict, trade_path, write_trade
    from rockcli.errors import StudyError
    from rockcli.storage.places import check_file

    check_format(plot_format)
    seconds = _seconds(budget)
    if os.path.isdir(study):
        raise StudyError("is a folder; give one study", file=study)
    opened = open_all([study], settings or ())
    given = opened.studies[0]
    check_file(trade_path(given, out))
    advise("nothing was written")
    line = Progress(given.name, shown=not quiet, what="settings")
    from rockcli import kernels

    kernels.announce = line.note
    try:
        found = measure(given, sample=sample, budget=seconds, progress=line)
    finally:
        kernels.announce = None
        line.close()
    if not found.points:
        raise StudyError(f"no setting was measured: {'; '.join(_families(found.skipped))}", file=given.file)
    path = write_trade(given, found, out)
    advise(f"{path} is written")
    drawn = () if no_plots else _draw(path, plot_format)
    if as_json:
        import json

        say(json.dumps(as_dict(found, path, drawn), indent=2))
    elif not quiet:
        say(_text(given, found, path, drawn, every=every))


def _seconds(budget: str) -> float:
    """`60 s`, `5min`, `90` -> seconds."""
    import re

    from rockcli.errors import StudyError

    read = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*(s|min|h|)\s*", budget)
    if read is None or not float(read[1]) > 0.0:
        raise StudyError(f"--budget {budget}: expected a time such as 60s, '5 min' or 1h")
    return float(read[1]) * _UNITS[read[2]]


def _draw(path: Path, plot_format: str) -> tuple[Path, ...]:
    from rockcli.engine.draw import draw
    from rockcli.scene.looks import Look

    drawn, complaints = draw(path, (("work_precision", Look()),), plot_format)
    for complaint in complaints:
        say(f"rock: {complaint}", err=True)
    return tuple(one.path for one in drawn)


def _text(study: Study, found: Trade, path: Path, drawn: tuple[Path, ...], *, every: bool) -> str:
    from rockcli.engine.trade.measurements import best_of_others, by_reference, on_front
    from rockcli.engine.trade.settings import DATA, MODEL, NUMERICS

    lines = [
        f"{study.name}: {len(found.cases)} of {counted(found.size, 'case')}, {counted(len(found.points), 'setting')}"
    ]
    lines += [f"  reference {name}: {words}" for name, words in found.references.items()]
    lines += [f"  note      {note}" for note in found.notes]
    parts = {part: [p for p in found.points if p.setting.part == part] for part in (MODEL, DATA, NUMERICS)}
    lines += _headed("error of the model, against a better one", parts[MODEL])
    lines += _headed("error of the data, against the record as it is", parts[DATA])
    for against, points in by_reference(parts[NUMERICS]).items():
        head = f"error of the numerics, against {against}"
        if every:
            lines += _headed(head, points)
        else:
            lines += _headed(f"{head}: Pareto front", on_front(points))
            lines += _headed("the most accurate of every other family", best_of_others(points))
    lines += [f"  skipped   {words}" for words in _families(found.skipped)]
    lines.append(f"  file      {path}")
    if drawn:
        lines.append(f"  plots     {' '.join(file.name for file in drawn)}")
    return "\n".join(lines)


def _headed(head: str, points: list[Point]) -> list[str]:
    """A table below its head; nothing for no points."""
    return [f"  {head}", _table(points)] if points else []


def _families(skipped: list[tuple[str, str]]) -> list[str]:
    """Settings that were not measured, those of a family that share a reason together."""
    groups: dict[tuple[str, str], list[str]] = {}
    for label, why in skipped:
        family, _, setting = label.rpartition(", ")
        groups.setdefault((family, why), []).append(setting)
    return [": ".join(filter(None, (family, ", ".join(names), why))) for (family, why), names in groups.items()]


def _table(points: Iterable[Point]) -> str:
    """Columns: model, backend and setting, median and 90 % of |error| in theta/alpha, wrong outcomes, cost.

    Cost is the time per case, and the median numbers of steps and of evaluations of the right-hand side.
    """
    from rockcli.engine.trade.measurements import middle
    from rockcli.engine.trade.settings import MODEL

    head = ("model", "setting", "median", "90 %", "wrong", "per case", "steps", "rhs")
    rows = []
    for p in points:
        setting = f"against {p.setting.against}" if p.setting.part == MODEL else f"{p.setting.family}, {p.setting.step}"
        rows.append(
            (
                p.setting.model_word,
                setting,
                _error(p.quantile(0.5)),
                _error(p.quantile(0.9)),
                f"{p.wrong} of {p.compared}",
                f"{p.cost * 1e3:.3g} ms" if p.cost < 1.0 else f"{p.cost:.3g} s",
                _count(middle(p.answers.steps)),
                _count(middle(p.answers.rhs)),
            )
        )
    return table(head, rows, right=6, indent=4, keys=2)


def _count(value: float) -> str:
    return "-" if value != value else f"{value:.0f}"


def _error(value: float) -> str:
    return "-" if value != value else f"{value:.1e}"
