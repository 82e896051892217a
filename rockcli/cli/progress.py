"""One line that tells how far a run is, in a terminal only."""

from __future__ import annotations

import sys
from collections import deque
from time import perf_counter

REMEMBERED = 32
"""Steps that the rate is taken over; what was finished by earlier runs is in none of them."""


class Progress:
    """Call with (done, in all) of `what`; `close` wipes the line.  Silent unless `shown` and stderr is a terminal."""

    def __init__(self, name: str, *, shown: bool, what: str = "cases") -> None:
        self.name = name
        self.what = what
        self.shown = shown and sys.stderr.isatty()
        self.seen: deque[tuple[float, int]] = deque(maxlen=REMEMBERED)
        self.width = 0

    def __call__(self, done: int, total: int) -> None:
        """Rewrite the line."""
        if not self.shown or total < 2:
            return
        self.seen.append((perf_counter(), done))
        (since, before), (now, _) = self.seen[0], self.seen[-1]
        words = f"{self.name}: {done}/{total} {self.what}"
        if done > before and now > since:
            rate = (done - before) / (now - since)
            shown = f"{rate:,.0f}" if rate >= 10.0 else f"{rate:.2g}"
            words += f", {shown}/s, {duration((total - done) / rate)} left"
        self._put(words)

    def note(self, words: str) -> None:
        """Rewrite the line with what keeps it from moving."""
        if self.shown:
            self._put(f"{self.name}: {words}")

    def listen(self) -> None:
        """Show on the line what a long case tells of itself (`rockcli.solvers` logs it at INFO)."""
        if not self.shown:
            return
        import logging

        line = self

        class Told(logging.Handler):
            def emit(self, record: logging.LogRecord) -> None:
                line.note(record.getMessage())

        logger = logging.getLogger("rockcli.solvers")
        logger.setLevel(logging.INFO)
        logger.handlers = [Told()]

    def close(self) -> None:
        """Wipe the line."""
        if self.width:
            self._put("")
            sys.stderr.write("\r")
            sys.stderr.flush()

    def _put(self, words: str) -> None:
        sys.stderr.write("\r" + words.ljust(self.width))
        sys.stderr.flush()
        self.width = len(words)


def counted(number: int, what: str) -> str:
    """`1 case`, `2 cases`, `2 studies`."""
    plural = f"{what[:-1]}ies" if what.endswith("y") else f"{what}s"
    return f"{number} {what if number == 1 else plural}"


def duration(seconds: float) -> str:
    """`0.41 s`, `12 s`, `3 min 20 s`, `2 h 5 min`."""
    if seconds < 10.0:
        return f"{seconds:.2g} s"
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
