"""Which study files the command line means, and their checked studies."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rockcli.cli.say import say
from rockcli.errors import RockError, StudyError, is_file

if TYPE_CHECKING:
    from collections.abc import Callable

    from rockcli.study.study import Study


@dataclass(frozen=True)
class Opened:
    """Studies that may run, and (file, why) of those skipped for want of a record."""

    studies: tuple[Study, ...]
    skipped: tuple[tuple[Path, str], ...]


def study_files(paths: Sequence[Path]) -> list[Path]:
    """Files as given, once each whatever leads there, folders searched for *.yaml and *.yml (sorted).

    Raises `StudyError` for what is not there.
    """
    files: list[Path] = []
    for path in paths:
        if os.path.isdir(path):
            found = sorted({*path.rglob("*.yaml"), *path.rglob("*.yml")})
            if not found:
                raise StudyError("no *.yaml in this folder", file=path)
            files += found
        elif is_file(path):
            files.append(path)
        else:
            likely = [path.with_suffix(suffix) for suffix in (".yaml", ".yml") if path.with_suffix(suffix).is_file()]
            raise StudyError("no such file or folder" + (f"; did you mean {likely[0]}?" if likely else ""), file=path)
    first: dict[str, Path] = {}
    for file in files:
        first.setdefault(os.path.realpath(file), file)
    return list(first.values())


def overrides(assignments: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """`case.block.R=2` -> ("case.block.R", "2"); `StudyError` without `=`."""
    pairs = []
    for assignment in assignments:
        path, equals, value = assignment.partition("=")
        if not equals or not path.strip():
            raise StudyError(f"--set {assignment}: expected PATH=VALUE, such as case.block.R=2")
        pairs.append((path.strip(), value.strip()))
    return tuple(pairs)


def open_all(
    paths: Sequence[Path],
    settings: Sequence[str] = (),
    *,
    skip_missing: bool = False,
    also: Callable[[Study], None] | None = None,
    readers: int = 1,
) -> Opened:
    """Open and check every study before any is solved.

    Args:
        paths: files and folders.
        settings: `--set` assignments, for every study.
        skip_missing: put studies whose record is absent aside.
        also: a further check of each study.
        readers: processes that read records.

    Raises:
        StudyError, RecordError: the last of all complaints, of studies that have the same one; those before it are
            printed to stderr.
    """
    from rockcli.study.building.records import MissingRecordError
    from rockcli.study.open import open_study

    pairs = overrides(settings)
    studies: list[Study] = []
    skipped: list[tuple[Path, str]] = []
    complaints: list[tuple[Path, RockError]] = []
    for file in study_files(paths):
        try:
            study = open_study(file, overrides=pairs, readers=readers)
            if also is not None:
                also(study)
        except RockError as error:
            if skip_missing and isinstance(error, MissingRecordError):
                skipped.append((file, str(error)))
            else:
                complaints.append((file, error))
        else:
            studies.append(study)
    complaints += _same_names(studies)
    told = _of_each_sentence(complaints)
    for complaint in told[:-1]:
        say(f"rock: {complaint}", err=True)
    if told:
        raise told[-1]
    return Opened(tuple(studies), tuple(skipped))


def _of_each_sentence(complaints: Sequence[tuple[Path, RockError]]) -> list[RockError]:
    """The complaints about some files, those of one sentence as one that names all of its files."""
    alike: dict[tuple[str | None, str], list[tuple[Path, RockError]]] = {}
    for file, error in complaints:
        elsewhere = None if error.file == str(file) else error.file
        alike.setdefault((elsewhere, error.message), []).append((file, error))
    return [_with_others(first, others) for first, *others in alike.values()]


def _with_others(first: tuple[Path, RockError], others: Sequence[tuple[Path, RockError]]) -> RockError:
    file, error = first
    if not others:
        return error
    told = error.file == str(file)  # else the place is none of a study, as that of --set
    places = [f"{one.file}:{one.line}" if told and one.line else str(each) for each, one in others]
    where = f"also in {', '.join(places)}" if told else f"in {', '.join([str(file), *places])}"
    return type(error)(f"{error.message}\n  {where}", file=error.file, line=error.line)


def _same_names(studies: Sequence[Study]) -> list[tuple[Path, RockError]]:
    first: dict[str, Study] = {}
    complaints: list[tuple[Path, RockError]] = []
    for study in studies:
        other = first.setdefault(study.name, study)
        if other is not study:
            assert study.file is not None
            error = StudyError(f"has the name of {other.file}: {study.name!r}", file=study.file)
            complaints.append((study.file, error))
    return complaints
