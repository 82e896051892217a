"""`rock new`: a commented study to begin with."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rockcli.cli.say import say

KINDS: dict[str, str] = {
    "block": "one block under one pulse or record",
    "map": "outcomes over two parameters",
    "statue": "a statue measured by hand, as it stands and on a low-friction pad",
    "cabinets": "several bodies: which slide, rock, fall",
    "fragility": "a suite: IDA and fragility",
    "rocks": "balanced rocks against hazard curves",
    "uncertain": "uncertain inputs: a probability, and which input matters",
}
"""Studies by kind, and what they are about; each is a file of `templates`."""

EXAMPLES = "examples"
"""Beside the kinds: a folder with what examples and tutorials run."""

SHIPPED = ("studies/examples", "studies/tutorials", "records")
"""Folders of the sources that the wheel carries below `rockcli/shipped`."""


_ALL = KINDS | {EXAMPLES: "a folder: the studies and records of examples and tutorials"}


def _kinds(incomplete: str) -> list[tuple[str, str]]:
    return [(kind, words) for kind, words in _ALL.items() if kind.startswith(incomplete)]


def new(
    kind: Annotated[str, typer.Argument(metavar="[KIND]", help=f"{', '.join(_ALL)}.", autocompletion=_kinds)] = "block",
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE.yaml", help="The study; default: KIND.yaml here. Of examples the folder."),
    ] = None,
) -> None:
    """Write a commented study to begin with; it runs as it is.

    Or, as `rock new examples`, a folder with the studies and records of examples and tutorials.  Nothing that is
    there is replaced.
    """
    from importlib.resources import files

    from rockcli.errors import StudyError
    from rockcli.storage.atomic import write_text
    from rockcli.storage.places import check_folder

    if kind == EXAMPLES:
        _write_examples(Path(EXAMPLES) if out is None else out)
        return
    if kind not in KINDS:
        listed = "; ".join(f"{name}: {words}" for name, words in _ALL.items())
        raise StudyError(f"there is no study {kind!r} to begin with; there are {listed}")
    path = Path(f"{kind}.yaml") if out is None else out
    if path.suffix.lower() not in (".yaml", ".yml"):
        raise StudyError("expected a name that ends in .yaml", file=path)
    if path.exists():
        raise StudyError("is there already; give another name with --out, or remove it", file=path)
    check_folder(path.parent)
    text = (files("rockcli.cli") / "templates" / f"{kind}.yaml").read_text(encoding="utf-8")
    write_text(path, text.replace(f"{kind}.yaml", str(path)))
    say(f"{path}: rock check {path}, rock run {path}")


def _write_examples(folder: Path) -> None:
    """Studies and records of examples and tutorials, below a new folder; all of them or none."""
    import os
    import re
    import shutil
    from tempfile import TemporaryDirectory

    import rockcli
    from rockcli.errors import OutputError, StudyError
    from rockcli.process_groups import is_running
    from rockcli.storage.places import check_folder, reason

    def copied(source: str, target: str) -> None:
        try:
            shutil.copy2(source, target)
        except OSError as error:
            raise OutputError(f"cannot be written: {reason(error)}", file=folder) from error

    if folder.exists():
        raise StudyError("is there already; give another folder with --out, or remove it", file=folder)
    check_folder(folder.parent)
    folder.parent.mkdir(parents=True, exist_ok=True)
    package = Path(rockcli.__file__).parent
    source = package / "shipped"
    if not source.is_dir():  # run from the sources
        source = package.parent
    for left in folder.parent.glob(".rock-new.*"):  # by one that was killed
        if (begun := re.fullmatch(r"\.rock-new\.(\d+)\.\w+", left.name)) and not is_running(int(begun[1])):
            shutil.rmtree(left, ignore_errors=True)
    with TemporaryDirectory(prefix=f".rock-new.{os.getpid()}.", dir=folder.parent) as place:
        for name in SHIPPED:
            left_out = shutil.ignore_patterns("__pycache__", "results", "catalog.yaml")  # of records that are not there
            shutil.copytree(source / name, Path(place, "new", name), ignore=left_out, copy_function=copied)
        Path(place, "new").rename(folder)
    say(f"{folder}: cd {folder}, rock run studies/examples/first_rock.yaml")
