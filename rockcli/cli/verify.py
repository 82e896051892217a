"""`rock verify`: closed forms against the solvers, printed with tolerances, or datasets against their checksums."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from rockcli.cli.say import say
from rockcli.cli.tables import table

_STATES = {True: "intact", False: "damaged, or changed by another program", None: "without a checksum"}


def verify(
    paths: Annotated[
        list[Path] | None,
        typer.Argument(metavar="[FILE.nc|FOLDER...]", help="Datasets; folders are searched. Without any: the solvers."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the checks as JSON.")] = False,
) -> None:
    """Check the solvers against closed forms, or datasets against the checksums that they carry.

    Exit code 1 if a closed form is missed, or a dataset is damaged.
    """
    if paths:
        raise typer.Exit(0 if _intact(paths, as_json=as_json) else 1)
    from rockcli.engine.verify import checks

    made = list(checks())
    agree = sum(check.passed for check in made)
    if as_json:
        import json

        say(json.dumps([check.as_dict() for check in made], indent=2))
    else:
        rows = [
            (
                "OK" if check.passed else "FAIL",
                check.name,
                f"{check.expected:.12g}",
                f"{check.got:.12g}",
                f"{check.difference:.1e}",
                f"{check.tolerance:.0e}",
            )
            for check in made
        ]
        say(table(("", "closed form", "expected", "got", "difference", "allowed"), rows, right=4, keys=2))
        say(f"{agree} of {len(made)} agree; differences are relative")
    raise typer.Exit(0 if agree == len(made) else 1)


def _intact(paths: Sequence[Path], *, as_json: bool) -> bool:
    """Say of datasets whether they are as they were written; whether none is damaged."""
    from rockcli.errors import StudyError, is_file
    from rockcli.scene.counted import counted
    from rockcli.storage import netcdf
    from rockcli.storage.atomic import datasets_below

    files: dict[Path, None] = {}
    for path in paths:
        found = datasets_below(path) if os.path.isdir(path) else [path]
        if not found or not is_file(found[0]):
            raise StudyError("no *.nc in this folder" if path.is_dir() else "no such file or folder", file=path)
        files.update(dict.fromkeys(found))
    states = {file: netcdf.is_intact(file) for file in files}
    if as_json:
        import json

        say(json.dumps([{"file": str(file), "intact": state} for file, state in states.items()], indent=2))
    else:
        for file, state in states.items():
            if not state:
                say(f"{file}: {_STATES[state]}")
        whole = sum(state is True for state in states.values())
        say(f"{counted(len(states), 'dataset')}, {whole} intact")
    return False not in states.values()
