"""Prints lines to stdout and stderr.  Where nobody reads any more the work goes on; its outcome is the exit code."""

from __future__ import annotations

import os
import shutil
import sys
import textwrap
from typing import TextIO

import typer

from rockcli.errors import OutputError


def say(words: str, *, err: bool = False) -> None:
    """Print a line.

    Raises:
        OutputError: standard output takes nothing, as on a full disk.
    """
    stream = sys.stderr if err else sys.stdout
    try:
        typer.echo(words, err=err)
    except BrokenPipeError:
        forget(stream)
    except OSError as error:
        from rockcli.storage.places import reason

        forget(stream)
        if not err:
            raise OutputError(reason(error), file="standard output") from error


def warn(name: str, words: str) -> None:
    """Print a warning about a study to stderr, as wide as the terminal; one line where nobody looks on."""
    line = f"rock: {name}: warning: {words}"
    if sys.stderr.isatty():
        line = textwrap.fill(
            line, max(shutil.get_terminal_size().columns, 40), subsequent_indent="      ", break_on_hyphens=False
        )
    say(line, err=True)


def forget(stream: TextIO) -> None:
    """Let what is still to be written to a stream that takes nothing go nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
