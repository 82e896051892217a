"""`rock cache`: where compiled kernels are, how large they are, and to have them before they are needed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rockcli.cli.say import say


def cache(
    fill: Annotated[
        bool,
        typer.Option("--fill", help="Compile the kernels into the cache, for images and CI: one to three minutes."),
    ] = False,
    level: Annotated[
        list[str] | None,
        typer.Option(
            metavar="LEVEL", help="Fill for other processors: x86-64-v2, x86-64-v3, x86-64-v4; may be repeated."
        ),
    ] = None,
    prune: Annotated[bool, typer.Option("--prune", help="Remove what other versions of the program left.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the answer as JSON.")] = False,
) -> None:
    """Say where compiled kernels are and how large; fill the cache beforehand.

    `ROCK_CACHE_DIR` names another place for the cache.
    """
    from rockcli.errors import StudyError
    from rockcli.kernels import ahead, places

    levels = list(dict.fromkeys(level or [ahead.level()]))
    if level and not fill:
        raise StudyError("--level says what --fill is for: give both")
    if unknown := [x for x in levels if x not in {*ahead.LEVELS, ahead.level()}]:
        known = ", ".join(dict.fromkeys([*ahead.LEVELS, ahead.level()]))
        raise StudyError(f"--level {unknown[0]}: expected one of {known}")
    if prune:
        _prune(places.cache_base(), places.cache_dir())
    if fill:
        _fill(levels)
    there = ahead.objects()
    found = {
        "cache": str(places.cache_base()),
        "bytes": _size(places.cache_base()),
        "bytes_of_this_version": _size(places.cache_dir()),
        "writable": places.cache_takes_files(),
        "processor": ahead.level(),
        "ahead_of_time": None if there is None else str(there),
        "ahead_of_time_bytes": 0 if there is None else _size(there),
    }
    if as_json:
        import json

        say(json.dumps(found, indent=2))
        return
    of_this = f"{_mega(found['bytes_of_this_version'])} of this version"
    can = "" if found["writable"] else ", cannot be written: kernels compiled just in time are compiled in every run"
    say(f"cache      {found['cache']}: {_mega(found['bytes'])}, {of_this}{can}")
    say(f"processor  {found['processor']}")
    if there is None:
        say("kernels    compiled when first needed, 15 to 60 s; `rock cache --fill` does it beforehand")
    else:
        whose = "in the cache" if there.is_relative_to(places.cache_base()) else "with the program"
        say(f"kernels    compiled ahead of time, {whose}: {there}, {_mega(_size(there))}")


def _fill(levels: list[str]) -> None:
    """Compile what is missing for some levels into the cache."""
    from rockcli.errors import OutputError, StudyError
    from rockcli.kernels import ahead, places
    from rockcli.kernels.build import build

    missing = [
        x
        for x in levels
        if not any((base / ahead.folder_of(x)).is_dir() for base in (places.installed(), places.cache_dir()))
    ]
    if not missing:
        return
    if not places.cache_takes_files():
        raise StudyError(f"{places.cache_dir()}: cannot be written; ROCK_CACHE_DIR names another place")
    say(f"compiling the kernels for {', '.join(missing)}: minutes", err=True)
    try:
        build(places.cache_dir(), missing)
    except (OSError, RuntimeError) as error:
        raise OutputError(f"{places.cache_dir()}: {getattr(error, 'strerror', None) or error}") from error


def _prune(base: Path, own: Path) -> None:
    """Remove the kernels of other versions from the cache."""
    import shutil

    for folder in base.glob("kernels-*"):
        if folder != own:
            shutil.rmtree(folder, ignore_errors=True)


def _size(folder: Path) -> int:
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def _mega(size: object) -> str:
    return f"{float(str(size)) / 1e6:.1f} MB"
