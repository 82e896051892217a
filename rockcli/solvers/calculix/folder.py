"""The working folder of a deck: a run is there whole or not at all."""

from __future__ import annotations

import hashlib
import json
import logging
import os
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import SolverError
from rockcli.solvers.calculix.body import rotation
from rockcli.solvers.calculix.deck import Deck
from rockcli.solvers.calculix.results import Displacements, UnreadableError, progress
from rockcli.solvers.calculix.run import JOB, run, version

Array = NDArray[np.float64]

LIMIT = "ROCK_CALCULIX_LIMIT"
"""Environment variable: wall time a case may take [s]."""

DEFAULT_LIMIT = 4 * 3600.0

KEEP = "ROCK_CALCULIX_DIR"
"""Environment variable: folder where finished runs are kept and found again; without it nothing is kept."""

FINISHED = "finished.json"

log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Result:
    """Of a run.

    Attributes:
        complaint: why there is no result; "" if there is.
        t, u: times (k,) [s] and displacements (k, nodes, 3) [m] of the base nodes and the two top corners.
        increments, iterations: of the dynamic step, the latter with those of attempts that did not converge.
        ends: time at which the file ends, not before that of t [s].
    """

    complaint: str
    t: Array
    u: Array
    increments: int
    iterations: int
    ends: float = 0.0


Enough = Callable[[Array, Array], int | None]
"""The first of times (k,) [s] with base rotations (k,) [rad] at which a run may end, None if there is none."""


def solve_deck(deck: Deck, enough: Enough) -> Result:
    """Run a deck, or read a run that is kept, up to where it is `enough`, which is asked now and then.

    How far CalculiX got by then depends on the machine; the result does not.
    """
    text = deck.text()
    kept = os.environ.get(KEEP)
    if not kept:
        with tempfile.TemporaryDirectory(prefix="rock-calculix-") as name:
            return _solved(Path(name), deck, text, enough)
    home = Path(kept)
    home.mkdir(parents=True, exist_ok=True)
    key = hashlib.sha256(f"{version()}\n{text}".encode()).hexdigest()[:20]
    if (home / key / FINISHED).exists():
        try:
            return _kept(home / key, deck, enough)
        except UnreadableError as error:
            log.warning("%s is run again: %s", home / key, error)
    _sweep(home, key)
    folder = home / f".{key}.{os.getpid()}"
    folder.mkdir(exist_ok=True)
    try:
        result = _solved(folder, deck, text, enough)
        if not result.complaint:
            (folder / FINISHED).write_text(json.dumps({"t_end": result.ends}), encoding="utf-8")
            shutil.rmtree(home / key, ignore_errors=True)
            folder.rename(home / key)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return result


def _sweep(home: Path, key: str) -> None:
    """Remove what killed processes have left of this run."""
    for left in home.glob(f".{key}.*"):
        owner = left.name.rpartition(".")[2]
        if owner.isdigit() and not Path(f"/proc/{owner}").exists():
            shutil.rmtree(left, ignore_errors=True)


def _limit() -> float:
    said = os.environ.get(LIMIT, "")
    try:
        limit = float(said) if said else DEFAULT_LIMIT
    except ValueError:
        limit = -1.0
    if not limit > 0.0:
        raise SolverError(f"{LIMIT} must be a number of seconds greater than 0, not {said!r}")
    return limit


def _solved(folder: Path, deck: Deck, text: str, enough: Enough) -> Result:
    (folder / f"{JOB}.inp").write_text(text, encoding="ascii")
    seen = Displacements(folder / f"{JOB}.dat", len(deck.mesh.base) + 2, deck.t_static)
    told = 0

    def look() -> bool:
        nonlocal told
        if seen.read_on() == 0:
            return False
        t, u = seen.latest()
        tenth = int(10.0 * t[-1] / deck.t_stop)
        if tenth > told:
            told = tenth
            log.info("t = %.4g s of %.4g s", t[-1], deck.t_stop)
        return bool(t[-1] > 0.0) and enough(t, rotation(deck.mesh.x_base, u[:, :-2])) is not None

    nothing = np.empty(0), np.empty((0, len(deck.mesh.base) + 2, 3))
    stopped = False
    try:
        complaint, stopped = run(folder, limit=_limit(), enough=look)
        result = None if complaint else _read(folder, deck, enough)
    except UnreadableError as error:
        complaint, result = f"what CalculiX wrote cannot be read: {error}", None
    so_far = progress(folder / f"{JOB}.sta", deck.t_static)
    if result is not None and not stopped and result.ends < deck.t_stop * (1.0 - 1e-4):
        complaint = "CalculiX ended early without a message"
    if complaint:
        said = f"{complaint}; it reached t = {so_far.reached:.4g} of {deck.t_stop:.4g} s"
        return Result(said, *nothing, so_far.increments, so_far.iterations)
    assert result is not None
    return result


def _kept(folder: Path, deck: Deck, enough: Enough) -> Result:
    """Read a run that is kept.

    Raises:
        UnreadableError: as `_read`, or it does not end where it ended when it was finished.
    """
    try:
        t_end = json.loads((folder / FINISHED).read_text(encoding="utf-8"))["t_end"]
    except (ValueError, KeyError, TypeError, OSError):
        raise UnreadableError(f"{FINISHED} cannot be read") from None
    result = _read(folder, deck, enough)
    if result.ends != t_end:
        raise UnreadableError(f"{JOB}.dat ends at {result.ends:.4g} s, not at {t_end!r} s")
    return result


def _read(folder: Path, deck: Deck, enough: Enough) -> Result:
    """Read a finished run up to where it is `enough`.

    Raises:
        UnreadableError: its file does not hold what it should.
    """
    found = Displacements(folder / f"{JOB}.dat", len(deck.mesh.base) + 2, deck.t_static)
    found.read_on()
    t, u = found.arrays()
    last = enough(t, rotation(deck.mesh.x_base, u[:, :-2]))
    kept = slice(None if last is None else last + 1)
    until = np.inf if last is None else float(t[last])
    done = progress(folder / f"{JOB}.sta", deck.t_static, until)
    return Result("", t[kept], u[kept], done.increments, done.iterations, float(t[-1]))
