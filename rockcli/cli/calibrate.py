"""`rock calibrate`: what outcomes of experiments say of a body and of its model."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rockcli.cli.options import Specimen, Workers
from rockcli.cli.say import say

if TYPE_CHECKING:
    from rockcli.engine.experiments.calibrate import Calibration


def calibrate(
    study: Annotated[Path, typer.Argument(metavar="STUDY.yaml", help="Bodies, by axes and uncertain inputs.")],
    runs: Annotated[Path, typer.Argument(metavar="RUNS.csv", help="Experiments with their outcomes, at least ten.")],
    out: Annotated[Path, typer.Option("--out", metavar="CALIBRATION.json", help="Where the calibration goes.")],
    folds: Annotated[
        str | None, typer.Option("--folds", metavar="COLUMN", help="Column of the runs that belong together.")
    ] = None,
    specimen: Specimen = None,
    workers: Workers = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print what was found as JSON.")] = False,
) -> None:
    """Find which bodies of a study experiments speak for, and how far its model is off.

    `rock score STUDY.yaml OTHERS.csv --calibration CALIBRATION.json` predicts other runs with it.
    """
    from rockcli.cli.progress import Progress
    from rockcli.engine.experiments.calibrate import calibrate as calibrated
    from rockcli.engine.experiments.calibrate import write
    from rockcli.engine.experiments.runs import GROUP, read_runs
    from rockcli.engine.experiments.score import by_specimen
    from rockcli.engine.sweep.executors import usable_cores
    from rockcli.engine.sweep.work import Team
    from rockcli.errors import StudyError
    from rockcli.storage.places import check_file

    if out.suffix.lower() != ".json":
        raise StudyError(f"--out ends in {out.suffix!r}; expected .json", file=out)
    check_file(out)
    table = read_runs(runs, group=folds or GROUP, predictions=[])
    some = table if specimen is None else by_specimen(table, specimen)[0][1]
    line = Progress(study.name, shown=True)
    try:
        found = calibrated(study, some, team=Team(workers or usable_cores()), progress=line)
    finally:
        line.close()
    write(found, out)
    say(_as_json(found) if as_json else _text(found))
    say(str(out), err=True)


_KEPT = ("amplitudes", "inputs", "units", "outcome", "group", "session", "share")
"""Of the file alone, for predictions."""


def _as_json(found: Calibration) -> str:
    import json

    return json.dumps({key: value for key, value in found.as_plain().items() if key not in _KEPT}, indent=2)


def _text(found: Calibration) -> str:
    from rockcli.cli.tables import table
    from rockcli.scene.counted import counted

    plain = found.as_plain()
    title = f"{found.table}: {counted(plain['runs'], 'run')} in {counted(plain['groups'], 'group')}, "
    title += f"{plain['overturned']} overturned"
    rows = [
        ["capacity, body over model", *_cells(plain["capacity_factor"])],
        ["scatter of ln(capacity)", *_cells(plain["capacity_scatter"])],
    ]
    walk = []
    if "session_walk" in plain:
        walk.append(f"  ln(capacity) changes by {plain['session_walk']:.2g} from a session to the next")
    labels = []
    for path, told in plain["posterior"].items():
        if "posterior" in told:
            unit = f" [{told['unit']}]" if told.get("unit", "1") != "1" else ""
            rows.append([f"{path}{unit}", *_cells(told["posterior"])])
        else:
            likely = sorted(told["probability"].items(), key=lambda pair: -pair[1])[:5]
            labels.append(f"  {path}: " + ", ".join(f"{label} {share:.2f}" for label, share in likely))
    head = ["after the runs", "mean", "sd", "2.5 %", "median", "97.5 %"]
    bodies = f"  {counted(plain['bodies'], 'body')}, as if {plain['bodies_effective']:.3g} were equally likely"
    return "\n".join([title, table(head, rows, right=5, indent=2), bodies, *walk, *labels])


_NO_NUMBER = 1e-12
"""Numbers below this part of the standard deviation are 0, as the mean of a polarity is."""


def _cells(told: dict[str, Any]) -> list[str]:
    numbers = [float(told[key]) for key in ("mean", "sd", "p2_5", "p50", "p97_5")]
    return [f"{0.0 if abs(number) < _NO_NUMBER * told['sd'] else number:.4g}" for number in numbers]
