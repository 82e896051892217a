"""Ctrl-C and SIGTERM answered at once, also while compiled code runs, which lets no signal handler in."""

from __future__ import annotations

import _thread
import os
import select
import signal
import socket
import sys
import threading
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

INTERRUPTED = 130

ASKING = (signal.SIGINT, signal.SIGTERM)
"""Signals that are answered; both mean the same: stop, and keep what is finished."""

DEFAULT = (signal.default_int_handler, signal.SIG_DFL)
"""Their handlers, if nobody else answers or ignores them."""

PATIENCE = 0.3
"""Time the interpreter is given to hear of it [s]."""

AGAIN = 0.2
"""Time between two looks at whether it was lost [s]."""


class Asked(KeyboardInterrupt):
    """The interrupt that is raised.  As long as somebody handles it, it lives; if nobody told of it, it was lost."""


_advice: list[str] = []
_told = threading.Lock()
_said = threading.Event()


def advise(sentence: str) -> None:
    """What to say if this process is interrupted from now on."""
    _advice[:] = [sentence]


def tell() -> None:
    """Say that the command was interrupted; once, and while another thread says it, wait for that."""
    if not _told.acquire(blocking=False):
        _said.wait(PATIENCE)
        return
    words = ["interrupted", *_advice]
    sys.stderr.write("\r\x1b[2K" * sys.stderr.isatty() + f"rock: {'; '.join(words)}\n")
    sys.stderr.flush()
    _said.set()


@contextmanager
def answered() -> Iterator[None]:
    """Turn the signals of ASKING into `KeyboardInterrupt`; unheard, or asked twice, tidy up and end the process.

    A thread is woken by the signal itself.  It ends the process only if the interpreter does not come to its own
    handler within `PATIENCE`, so that whoever is tidying up is not cut short.  What is raised in a callback or a
    finalizer, as the compiler has many, is dropped there: it is then raised again, until it is told.
    """
    _advice.clear()
    _said.clear()
    if _told.locked():
        _told.release()
    ours = threading.current_thread() is threading.main_thread()
    free = [number for number in ASKING if signal.getsignal(number) in DEFAULT]  # in the background SIGINT is ignored
    if not ours or not free:
        yield
        return
    heard = threading.Event()
    raised: list[weakref.ref[Asked]] = []

    def asked() -> Asked:
        error = Asked()
        raised[:] = [weakref.ref(error)]
        heard.set()
        return error

    def handler(number: int, frame: FrameType | None) -> None:
        if _told.locked() or (raised and raised[0]() is not None):  # `heard` may be locked by this very thread then
            return
        raise asked()  # and no name for it here, by which its own traceback would keep it alive

    def lost() -> bool:
        return heard.is_set() and raised[0]() is None and not _told.locked()

    def unraisable(what: Any) -> None:
        # what was interrupted while it was made cannot be finalized: no news beside the interrupt
        if not heard.is_set() and not issubclass(what.exc_type, Asked):
            hook(what)

    woken, wake = socket.socketpair()  # Windows waits for no pipe
    wake.setblocking(False)
    threading.Thread(target=_watch, args=(woken, heard, lost), daemon=True).start()
    hook, sys.unraisablehook = sys.unraisablehook, unraisable
    before = {number: signal.signal(number, handler) for number in free}
    other = signal.set_wakeup_fd(wake.fileno(), warn_on_full_buffer=False)
    try:
        yield
    finally:
        signal.set_wakeup_fd(other)
        sys.unraisablehook = hook
        wake.close()  # the thread reads the end of it and is done
        for number, old in before.items():
            signal.signal(number, old)


def _watch(woken: socket.socket, heard: threading.Event, lost: Callable[[], bool]) -> None:
    main = threading.main_thread().ident
    assert main is not None
    asked = repeated = 0
    latest = signal.SIGINT
    while True:
        if not select.select([woken], [], [], AGAIN if asked else None)[0]:
            if lost():
                heard.clear()
                repeated += 1
                _raise_again(main, latest)
            continue
        numbers = woken.recv(64)
        if not numbers:
            break
        for number in (signal.Signals(each) for each in numbers if each in ASKING):
            latest = number
            if repeated:
                repeated -= 1
            else:
                asked += 1
            if asked > 1 or not heard.wait(PATIENCE):
                _end()
    woken.close()


def _raise_again(main: int, number: signal.Signals) -> None:
    """Send the main thread a signal, or where threads get none, as on Windows, tell its interpreter of one."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(main, number)
    else:
        _thread.interrupt_main(number)


def _end() -> None:
    from rockcli.storage.places import remove_passing

    tell()
    remove_passing()
    os._exit(INTERRUPTED)
