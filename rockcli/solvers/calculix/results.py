"""Reads what CalculiX writes: displacements from the .dat file, the time reached from the .sta file."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


DIGITS = 5e-6
"""Relative rounding of the times of the .sta file, which have six digits."""


class UnreadableError(ValueError):
    """A file of CalculiX does not hold what it should; the sentence says what."""


class Displacements:
    """The printed displacements of some nodes, read as they are written.

    Args:
        path: the .dat file; it may not be there yet.
        nodes: how many nodes a block holds.
        start: total time at which the dynamic step begins [s].
    """

    def __init__(self, path: Path, nodes: int, start: float) -> None:
        self.path = path
        self.nodes = nodes
        self.start = start
        self._place = 0
        self._rest = ""
        self._inside = False
        self._at = 0.0
        self._rows: list[list[float]] = []
        self._times: list[float] = []
        self._blocks: list[list[list[float]]] = []

    def read_on(self) -> int:
        """Read what has been written since the last call and return the number of whole blocks known.

        Raises:
            UnreadableError: a line inside a block is not a node's.
        """
        if not self.path.exists():
            return 0
        with self.path.open("rb") as file:
            file.seek(self._place)
            new = file.read()
        self._place += len(new)
        # a line is whole when its end has been written
        *lines, self._rest = (self._rest + new.decode("ascii", errors="replace")).split("\n")
        for line in lines:
            self._line(line)
        return len(self._times)

    def _line(self, line: str) -> None:
        if line.lstrip().startswith("displacements"):
            self._inside, self._rows = True, []
            self._at = _number(line.split()[-1], line, self.path)
        elif self._inside and line.strip():
            words = line.split()
            if len(words) != 4:
                raise UnreadableError(
                    f"{self.path.name}: a node and three displacements are expected, not {line.strip()!r}"
                )
            self._rows.append([_number(word, line, self.path) for word in words[1:]])
            if len(self._rows) == self.nodes:
                self._inside = False
                self._times.append(self._at)
                self._blocks.append(self._rows)

    def latest(self) -> tuple[Array, Array]:
        """The last two blocks: times (2,) [s] and displacements (2, nodes, 3) [m]; fewer while there are fewer."""
        return np.array(self._times[-2:]) - self.start, np.array(self._blocks[-2:])

    def arrays(self) -> tuple[Array, Array]:
        """Times from the end of the static steps on, (k,) [s], the first 0, and displacements, (k, nodes, 3) [m].

        Raises:
            UnreadableError: there are none, they are not finite, or time does not grow.
        """
        if not self._times:
            raise UnreadableError(f"{self.path.name} holds no displacements")
        t = np.array(self._times) - self.start
        u = np.array(self._blocks)
        kept = t > -1e-6 * max(self.start, 1.0)
        t, u = t[kept], u[kept]
        if not len(t):
            raise UnreadableError(f"{self.path.name} ends before the motion begins")
        if not (np.isfinite(u).all() and np.isfinite(t).all()):
            raise UnreadableError(f"{self.path.name} holds displacements that are not finite")
        # seven digits are printed of a time: neighbours may agree
        t[0] = max(t[0], 0.0)
        if np.any(np.diff(t) < 0.0):
            raise UnreadableError(f"{self.path.name}: time does not increase")
        new = np.concatenate([[True], np.diff(t) > 0.0])
        return t[new], u[new]


def _number(word: str, line: str, path: Path) -> float:
    try:
        return float(word)
    except ValueError:
        raise UnreadableError(f"{path.name}: a number is expected in {line.strip()!r}") from None


class Progress(NamedTuple):
    """Of the dynamic step: time reached [s], increments that converged, iterations of all attempts."""

    reached: float = 0.0
    increments: int = 0
    iterations: int = 0


def progress(path: Path, start: float, until: float = np.inf) -> Progress:
    """How far CalculiX got after its static steps, which end at `start` [s], from the .sta file, up to `until` [s].

    A line holds step, increment, attempt (U: not converged), iterations, total time, step time, increment.
    What cannot be read is passed over: this is for people.
    """
    found, tried = Progress(), 0
    try:
        text = path.read_text(encoding="ascii", errors="replace")
    except OSError:
        return found
    for line in text.splitlines():
        words = line.split()
        try:
            iterations, done = int(words[3]), float(words[4]) - start
        except (IndexError, ValueError):
            continue
        if done <= 1e-9:
            continue
        tried += iterations
        if words[2].endswith("U"):
            continue
        if done > until + DIGITS * (start + until):
            return found
        found = Progress(max(found.reached, done), found.increments + 1, found.iterations + tried)
        tried = 0
    return found._replace(iterations=found.iterations + tried)
