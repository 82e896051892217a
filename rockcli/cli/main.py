"""The command `rock` and its exit codes; imports typer only, so that help is instant."""

from __future__ import annotations

import atexit
import gc
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from copy import copy
from pathlib import Path
from typing import Annotated

import typer

from rockcli.cli import (
    animate,
    cache,
    calibrate,
    check,
    compare,
    export,
    identify,
    new,
    plot,
    report,
    run,
    score,
    show,
    table,
    trade,
    verify,
)
from rockcli.cli.interrupt import INTERRUPTED, answered, tell
from rockcli.cli.say import forget, say
from rockcli.errors import RockError, StudyError

BROKE = 4

SHARED = "shared object"
"""Words of the system's loader that has no memory or no file for a library: no bug of this program."""

SELDOM = 200_000
"""New objects after which those in circles are looked for.  By default that is after every 700: the objects of modules,
none of which is freed, would be looked through 150 times before the first case, a tenth of a short command's time."""

app = typer.Typer(
    name="rock",
    help="Seismic response of rocking bodies: studies in, datasets out.",
    context_settings={"help_option_names": ["--help", "-h"]},
    no_args_is_help=True,
    add_completion=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
app.command("run")(run.run)
app.command("check")(check.check)
app.command("new")(new.new)
app.command("plot")(plot.plot)
app.command("animate")(animate.animate)
app.command("table")(table.table)
app.command("compare")(compare.compare)
app.command("trade")(trade.trade)
app.command("report")(report.report)
app.command("identify")(identify.identify)
app.command("calibrate")(calibrate.calibrate)
app.command("score")(score.score)
app.command("export")(export.export)
app.command("show")(show.show)
app.command("verify")(verify.verify)
app.command("cache")(cache.cache)


def _version(asked: bool) -> None:
    if asked:
        from rockcli import __version__

        say(f"rock {__version__}")
        raise typer.Exit


@app.callback()
def _rock(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


@app.command(
    "records",
    context_settings={"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []},
    add_help_option=False,
)
def _records(context: typer.Context) -> None:
    """Look at records and convert them."""
    from rockcli.cli.records import app as records

    records(args=context.args, prog_name="rock records")


def main() -> None:
    """Run the command; every error the user can mend is one sentence on stderr."""
    gc.set_threshold(SELDOM)
    atexit.register(gc.freeze)  # nothing is looked through when the process ends: a seventh of a short command's time
    _open_what_is_closed()
    _print_what_a_stream_lacks()
    with answered(), _dask_left_alone():
        try:
            _run()
        except KeyboardInterrupt:  # also one that comes while the end of the command is told
            tell()
            sys.exit(INTERRUPTED)


def _open_what_is_closed() -> None:
    """Let streams that were closed before the command began go nowhere; no file of ours is to have their numbers."""
    while (number := os.open(os.devnull, os.O_RDWR)) < len(("stdin", "stdout", "stderr")):
        pass
    os.close(number)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115 - until the process ends


def _print_what_a_stream_lacks() -> None:
    """Let streams print a character that their encoding lacks, as cp1252 an alpha, by its number, and not refuse it."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and stream.errors == "strict":
            stream.reconfigure(errors="backslashreplace")


def _asked() -> typer.Typer:
    """The command that is asked for alone, as making all of them takes 20 ms; all where none is, for help and hints."""
    named = [command for command in app.registered_commands if sys.argv[1:2] == [command.name]]
    if not named:
        return app
    alone = copy(app)
    alone.registered_commands = named
    return alone


@contextmanager
def _dask_left_alone() -> Iterator[None]:
    """Nobody imports Dask but a command that asks for it: xarray would, two thirds of a second, to ask it of arrays."""
    there = {"dask", "xarray"} & sys.modules.keys()  # xarray asks once, when it is imported, and remembers
    spared = not any(word.startswith("--dask") for word in sys.argv) and not there
    if spared:
        sys.modules["dask"] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        if spared:
            sys.modules.pop("dask", None)


def _run() -> None:
    if storage := sys.modules.get("rockcli.storage.netcdf"):  # of an earlier command of this process
        storage.checksum.forget_opened()
    try:
        _asked()()
    except SystemExit as left:
        if left.code == INTERRUPTED:  # typer keeps the interrupt to itself
            tell()
        elif left.code in (None, 0, 1) and sys.argv[1:2] != ["run"]:  # a run refuses it
            _warn_of_changes()
        raise
    except RockError as error:
        say(f"rock: {error}", err=True)
        sys.exit(error.exit_code)
    except BrokenPipeError:  # the reader of our output went away
        forget(sys.stdout)
        sys.exit(0)
    except OSError as error:  # the system refuses: no space, no permission, too many open files
        from rockcli.storage.places import reason

        where = f"{error.filename}: " if isinstance(error.filename, str) else ""
        say(f"rock: {where}{reason(error)}", err=True)
        _trace(error)
        sys.exit(BROKE)
    except MemoryError as error:
        say(f"rock: out of memory {error}".rstrip(), err=True)
        _trace(error)
        sys.exit(BROKE)
    except Exception as error:  # a damaged dataset, or a bug: say so, and show the way to its trace
        if damaged := _damaged():
            say(f"rock: {damaged}: is damaged, or was changed by another program ({_words(error)})", err=True)
            _trace(error)
            sys.exit(StudyError.exit_code)
        if isinstance(error, ImportError) and SHARED in str(error):
            say(f"rock: a library cannot be loaded: {error}", err=True)
            _trace(error)
            sys.exit(BROKE)
        if not _trace(error):
            say(f"rock: this is a bug in rock: {_words(error)}", err=True)
            say("rock: set ROCK_DEBUG=1 for the traceback", err=True)
        sys.exit(BROKE)


def _warn_of_changes() -> None:
    """Name the datasets among those read that are not as they were written, of those that are small enough to tell."""
    storage = sys.modules.get("rockcli.storage.netcdf")
    if storage is None:
        return
    for path in storage.checksum.opened():
        if storage.is_soon_told(path) and storage.is_intact(path) is False:
            say(f"rock: {path}: warning: is damaged, or was changed by another program: do not trust it", err=True)


def _damaged() -> str:
    """The first dataset among those read that is not as it was written; "" if all are."""
    storage = sys.modules.get("rockcli.storage.netcdf")
    if storage is None:
        return ""
    return next((str(path) for path in storage.checksum.opened() if storage.is_intact(path) is False), "")


def _words(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"


def _trace(error: Exception) -> bool:
    """Print the traceback if it is asked for, and whether it was."""
    if os.environ.get("ROCK_DEBUG") != "1":
        return False
    import traceback

    traceback.print_exception(error)
    return True


if __name__ == "__main__":
    main()
