"""The progress bar of a run, in a terminal only."""

from __future__ import annotations

import sys
from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

NOT_OFTENER = 0.1
"""Time between two looks of the bar [s]; chunks may be done a thousand times a second."""


class Progress:
    """Call with (done, in all) of `what`; `close` wipes the bar.  Silent unless `shown` and stderr is a terminal."""

    def __init__(self, name: str, *, shown: bool, what: str = "cases") -> None:
        self.name = name
        self.what = what
        self.shown = shown and sys.stderr.isatty()
        self.bar: Bar | None = None
        self.drawn = -1.0

    def __call__(self, done: int, total: int) -> None:
        """Move the bar."""
        if not self.shown or total < 2:
            return
        bar, words = self._open(), f"{done}/{total} {self.what}"
        if bar.tasks and bar.tasks[0].total is not None:
            bar.update(bar.task_ids[0], completed=done, total=total)
            speed = bar.tasks[0].speed or 0.0
            rate = f", {speed:,.0f}/s" if speed >= 10.0 else f", {speed:.2g}/s" * bool(speed)
            bar.update(bar.task_ids[0], words=words + rate)
        else:  # a new task, so that what earlier runs had is in no rate
            self._begin(words, total, done)
        self._draw(at_once=done >= total)

    def note(self, words: str) -> None:
        """Say beside the bar what keeps it from moving."""
        if not self.shown:
            return
        bar = self._open()
        if bar.tasks:
            bar.update(bar.task_ids[0], words=words)
        else:
            self._begin(words)
        self._draw(at_once=True)

    def listen(self) -> None:
        """Show beside the bar what a long case, the statistics and figures tell of themselves (logged at INFO)."""
        if not self.shown:
            return
        import logging

        line = self

        class Logged(logging.Handler):
            def emit(self, record: logging.LogRecord) -> None:
                line.note(record.getMessage())

        logger = logging.getLogger("rockcli")
        logger.setLevel(logging.INFO)
        logger.handlers = [Logged()]

    def close(self) -> None:
        """Wipe the bar."""
        if self.bar is not None:
            self.bar.stop()
        self.bar = None

    def _begin(self, words: str, total: int | None = None, done: int = 0) -> None:
        bar = self._open()
        for old in bar.task_ids:
            bar.remove_task(old)
        bar.add_task("", total=total, completed=done, words=words)

    def _open(self) -> Bar:
        """The bar, drawn by this process when it is told something: a thread would not survive the fork of workers."""
        if self.bar is None:
            from rich.console import Console
            from rich.markup import escape
            from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
            from rich.progress import Progress as Bar

            columns = (
                TextColumn(escape(self.name) + ":"),
                BarColumn(bar_width=30),
                TimeRemainingColumn(),
                TextColumn("{task.fields[words]}", markup=False),
            )
            console = Console(file=sys.stderr, highlight=False, emoji=False)
            self.bar = Bar(
                *columns,
                console=console,
                transient=True,
                auto_refresh=False,
                redirect_stdout=False,
                redirect_stderr=False,
                get_time=perf_counter,
            )
            self.bar.start()
            console.show_cursor(True)  # a killed process could not bring it back
        return self.bar

    def _draw(self, *, at_once: bool) -> None:
        assert self.bar is not None
        now = perf_counter()
        if at_once or now - self.drawn > NOT_OFTENER:
            self.drawn = now
            self.bar.refresh()


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
