"""Prints lines to stdout and stderr.  Where nobody reads any more the work goes on; its outcome is the exit code."""

from __future__ import annotations

import os
import sys
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


def forget(stream: TextIO) -> None:
    """Let what is still to be written to a stream that takes nothing go nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
