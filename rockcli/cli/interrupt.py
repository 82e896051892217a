"""Ctrl-C and SIGTERM answered at once, also while compiled code runs, which lets no signal handler in."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

INTERRUPTED = 130

ASKING = (signal.SIGINT, signal.SIGTERM)
"""Signals that are answered; both mean the same: stop, and keep what is finished."""

DEFAULT = (signal.default_int_handler, signal.SIG_DFL)
"""Their handlers, if nobody else answers or ignores them."""

PATIENCE = 0.3
"""Time the interpreter is given to hear of it [s]."""

_advice: list[str] = []
_told = threading.Lock()


def advise(sentence: str) -> None:
    """What to say if this process is interrupted from now on."""
    _advice[:] = [sentence]


def tell() -> None:
    """Say that the command was interrupted; once."""
    if _told.acquire(blocking=False):
        words = ["interrupted", *_advice]
        sys.stderr.write("\r" * sys.stderr.isatty() + f"rock: {'; '.join(words)}\n")
        sys.stderr.flush()


@contextmanager
def answered() -> Iterator[None]:
    """Turn the signals of ASKING into `KeyboardInterrupt`; unheard, or asked twice, tidy up and end the process.

    A thread is woken by the signal itself.  It ends the process only if the interpreter does not come to its own
    handler within `PATIENCE`, so that whoever is tidying up is not cut short.
    """
    _advice.clear()
    if _told.locked():
        _told.release()
    ours = threading.current_thread() is threading.main_thread()
    free = [number for number in ASKING if signal.getsignal(number) in DEFAULT]  # in the background SIGINT is ignored
    if not ours or not free:
        yield
        return
    heard = threading.Event()

    def handler(number: int, frame: FrameType | None) -> None:
        heard.set()
        raise KeyboardInterrupt

    woken, wake = os.pipe()
    os.set_blocking(wake, False)
    threading.Thread(target=_watch, args=(woken, heard), daemon=True).start()
    before = {number: signal.signal(number, handler) for number in free}
    other = signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
    try:
        yield
    finally:
        signal.set_wakeup_fd(other)
        for number, old in before.items():
            signal.signal(number, old)
        os.close(wake)  # the thread reads the end of it and is done


def _watch(woken: int, heard: threading.Event) -> None:
    interrupts = 0
    while numbers := os.read(woken, 64):
        for _ in range(sum(numbers.count(number) for number in ASKING)):
            interrupts += 1
            if interrupts > 1 or not heard.wait(PATIENCE):
                _end()
    os.close(woken)


def _end() -> None:
    from rockcli.storage.places import remove_passing

    tell()
    remove_passing()
    os._exit(INTERRUPTED)
