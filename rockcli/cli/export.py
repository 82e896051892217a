"""`rock export`: the cases of a study as scripts, or its fragility curves, for other programs to carry on from."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rockcli.cli.options import Settings
from rockcli.cli.say import say, warn

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rockcli.scene.batch import Batch
    from rockcli.solvers.opensees.script import Script
    from rockcli.study.study import Study

MOST = 100
"""Cases written without being asked for one by one."""


def export(
    study_file: Annotated[
        Path, typer.Argument(metavar="STUDY.yaml|FILE.nc", help="The study; for openquake its dataset.")
    ],
    to: Annotated[str, typer.Option("--to", metavar="opensees|openquake", help="What to write for.")] = "opensees",
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Where the files go.")] = Path("results"),
    case: Annotated[int | None, typer.Option("--case", metavar="N", help="Only this case, counted from 1.")] = None,
    settings: Settings = None,
) -> None:
    """Write each case as a plain OpenSeesPy script, or the fragility curves of a dataset for OpenQuake.

    Scripts and their ground motions go to DIR/<name>/opensees/; they run with OpenSeesPy alone.  A fragility model goes
    to DIR/<name>/openquake/fragility_model.xml.  Solves nothing.
    """
    from rockcli.cli.sources import overrides
    from rockcli.errors import SolverError, StudyError
    from rockcli.storage.places import check_folder
    from rockcli.study.building.batch import friction_said
    from rockcli.study.open import open_study

    if to == "openquake":
        if case is not None or settings:
            raise StudyError("--case and --set belong to --to opensees")
        _openquake(study_file, out)
        return
    if to != "opensees":
        raise StudyError(f"--to {to}: expected opensees or openquake")
    study = open_study(study_file, overrides=overrides(settings or ()))
    if case is not None and not 1 <= case <= study.size:
        raise StudyError(f"--case {case}: the study has the cases 1 to {study.size}", file=study.file)
    if case is None and study.size > MOST:
        raise StudyError(f"{study.size} cases are too many for a script each: choose one by --case", file=study.file)
    folder = out / study.name / "opensees"
    check_folder(folder)
    written = 0
    said: dict[str, None] = {}
    refused: dict[str, list[str]] = {}
    for number, batch, i in _cases(study, case):
        label = _label(study, number)
        try:
            script = _script(batch, i, f"case_{number}", f"Study {study.name}, case {number}{label}.")
        except SolverError as error:
            refused.setdefault(str(error), []).append(f"case {number}{label}")
            continue
        _write(folder, script)
        say(str(folder / f"{script.name}.py"))
        written += 1
        said |= dict.fromkeys(friction_said(batch.block, batch.slide_rate_0, batch.model, "opensees"))
    for why, cases in refused.items():
        many = f"{len(cases)} cases, the first {cases[0]}" if len(cases) > 1 else cases[0]
        say(f"rock: {study.name}: {many}: {why}", err=True)
    if written and study.search is not None:
        axis = study.search.axis
        begins = f"the scripts have {axis.path} = {study.search.first:g}, where its search begins"
        said[f"{begins}: for others --set 'vary.{axis.path}=[VALUE, ...]'"] = None
    for words in said:
        warn(study.name, words)
    if not written:
        what = "no case of it can be written for OpenSees (rock show backends: what it solves)"
        raise StudyError(what, file=study.file)


def _openquake(file: Path, out: Path) -> None:
    """Write the fragility model of a dataset."""
    from rockcli.analysis.nrml import fragility_model
    from rockcli.errors import StudyError
    from rockcli.storage import netcdf
    from rockcli.storage.atomic import write_text
    from rockcli.storage.places import check_file

    if file.suffix != ".nc":
        raise StudyError("--to openquake writes the fragility curves of a dataset: expected FILE.nc", file=file)
    contents = netcdf.read(file)
    try:
        model = fragility_model(contents)
    except StudyError as error:
        raise StudyError(error.message, file=file) from None
    target = out / contents.attrs.get("study_name", file.stem) / "openquake" / "fragility_model.xml"
    check_file(target)
    write_text(target, model.text)
    for why in model.left_out:
        say(f"rock: left out: {why}", err=True)
    for warning in model.warnings:
        say(f"rock: warning: {warning}", err=True)
    say(str(target))


def _cases(study: Study, case: int | None) -> Iterator[tuple[int, Batch, int]]:
    """Number from 1, batch and place in it of the cases wanted."""
    import numpy as np

    indices = np.arange(study.size) if case is None else np.array([case - 1])
    for part, batch in study.batches(indices):
        for i, index in enumerate(part):
            yield int(index) + 1, batch, i


def _script(batch: Batch, i: int, name: str, title: str) -> Script:
    """The script of a case; `SolverError` where OpenSees cannot do it."""
    from dataclasses import replace

    from rockcli.engine.backends import choose
    from rockcli.solvers.opensees.script import script_of
    from rockcli.solvers.opensees.solver import check

    asked = replace(batch, numerics=replace(batch.numerics, backend="opensees"))
    choose(asked)
    check(asked)
    return script_of(asked, i, name=name, title=title)


def _label(study: Study, number: int) -> str:
    """` (tan_alpha = 0.2, model = 3)`: where on the axes a case stands."""
    import numpy as np

    if not study.axes:
        return ""
    at = np.unravel_index(number - 1, study.shape)
    values = ((axis.name, axis.values[k]) for axis, k in zip(study.axes, at, strict=True))
    points = (f"{name} = {value:.10g}" if isinstance(value, float) else f"{name} = {value}" for name, value in values)
    return f" ({', '.join(points)})"


def _write(folder: Path, script: Script) -> None:
    from rockcli.storage.atomic import write_text
    from rockcli.storage.places import check_file

    for name in script.files:
        check_file(folder / name)
    for name, text in reversed(script.files.items()):  # a script that is there has what it reads
        write_text(folder / name, text)
