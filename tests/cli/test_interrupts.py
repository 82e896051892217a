"""Ctrl-C and SIGTERM: answered within a second, whatever the process is at."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

STUDY = """\
name: long
case:
  block: {R: 2.0, tan_alpha: 0.2}
  motion: {pulse: {shape: sine, a_p: 1.0, omega_p: 9.0, cycles: 20}}
  damping: none
vary:
  motion.pulse.a_p_over_g_tan_alpha: {from: 1.0, to: 6.0, n: 200}
  motion.pulse.omega_p_over_p: {from: 1.0, to: 20.0, n: 200}
save: {histories: false}
"""

STUCK = """\
import ctypes, sys
from rockcli.solvers.event import solver as event
def solve(batch):
    print("at work", flush=True)
    ctypes.CDLL(None).sleep(30)  # as compiled code: no signal handler gets in
event.solve = solve
from rockcli.cli.main import main
main()
"""

DROPPED = """\
import ctypes, time
from rockcli.solvers.event import solver as event
def solve(batch):
    ctypes.CFUNCTYPE(None)(lambda: time.sleep(10.0))()  # ctypes drops what a callback raises, as LLVM's are
    time.sleep(30.0)
event.solve = solve
from rockcli.cli.main import main
main()
"""

ROCK = "import sys; from rockcli.cli.main import main; main()"


def interrupted(
    folder: Path, script: str, kernels: str, wait: float, by: int = signal.SIGINT
) -> tuple[int, str, float]:
    """Exit code, stderr and seconds that `rock run` takes to end, interrupted once the folder is locked."""
    (folder / "long.yaml").write_text(STUDY)
    process = subprocess.Popen(
        [sys.executable, "-c", script, "run", "long.yaml", "--no-plots"],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # a process that is started in the background may be born deaf to Ctrl-C, and has to hear SIGTERM all the same
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL if by == signal.SIGINT else signal.SIG_IGN),
        env=os.environ | {"ROCK_KERNELS": kernels, "ROCK_CACHE_DIR": str(folder / "cache")},
    )
    lock = folder / "results" / "long" / ".lock"
    limit = time.monotonic() + 60.0
    while not lock.exists() and process.poll() is None and time.monotonic() < limit:
        time.sleep(0.01)
    time.sleep(wait)
    began = time.monotonic()
    process.send_signal(by)
    try:
        _, told = process.communicate(timeout=20.0)
    finally:
        process.kill()
    return process.returncode, told, time.monotonic() - began


@pytest.mark.parametrize(
    ("script", "kernels", "wait", "by"),
    [
        (ROCK, "interpreted", 0.5, signal.SIGINT),
        pytest.param(ROCK, "jit", 3.0, signal.SIGINT, marks=pytest.mark.slow),
        (STUCK, "interpreted", 0.5, signal.SIGINT),
        (DROPPED, "interpreted", 1.0, signal.SIGINT),
        (DROPPED, "interpreted", 1.0, signal.SIGTERM),
        (ROCK, "interpreted", 0.5, signal.SIGTERM),
    ],
    ids=["interpreted", "compiling", "stuck", "dropped", "dropped, asked to end", "asked to end"],
)
def test_an_interrupt_is_answered(script: str, kernels: str, wait: float, by: int, tmp_path: Path) -> None:
    code, told, seconds = interrupted(tmp_path, script, kernels, wait, by)
    assert code == 130
    assert told.startswith("rock: interrupted; run again to continue")
    assert told.count("\n") == 1
    assert seconds < 15.0  # below one on an idle machine; half a minute without an answer
    assert list((tmp_path / "results" / "long").iterdir()) == []


def ended(script: str, *words: str, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    """A script that interrupts itself, which it could not where the tests run in the background of a shell."""
    return subprocess.run(
        [sys.executable, "-c", script, *words], cwd=folder, capture_output=True, text=True, check=False,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip


IMPORTING = """\
import os, signal, sys
class Slow:
    def find_spec(self, name, *_):
        if name == "rockcli.cli.main":
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Slow())
from rockcli.__main__ import main
main()
"""


def test_an_interrupt_while_modules_are_imported_ends_the_command() -> None:
    done = ended(IMPORTING, "run")
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "rock: interrupted\n")


LATE = """\
import os, signal
from rockcli.cli import main
main._warn_of_changes = lambda: os.kill(os.getpid(), signal.SIGINT)
main.main()
"""


def test_an_interrupt_while_the_end_is_told_has_no_traceback() -> None:
    done = ended(LATE, "show", "models")
    assert (done.returncode, done.stderr) == (130, "rock: interrupted\n")


ENDING = """\
import atexit, os, signal
atexit.register(lambda: os.kill(os.getpid(), signal.SIGINT))
from rockcli.__main__ import main
from rockcli.cli import main as command
if interrupted:
    command._run = lambda: os.kill(os.getpid(), signal.SIGINT)
main()
"""


@pytest.mark.parametrize(("interrupted", "told"), [(False, ""), (True, "rock: interrupted\n")])
def test_an_interrupt_while_python_ends_has_no_traceback(interrupted: bool, told: str) -> None:
    done = ended(f"interrupted = {interrupted}\n{ENDING}", "show", "models")
    assert (done.returncode, done.stderr) == (-signal.SIGINT, told)


TWICE = """\
import os, signal, sys, time
from rockcli.cli import main
lines = 0
def trace(frame, event, arg):
    global lines
    if frame.f_code.co_name == "answered":  # it is over: the handlers are those of before
        sys.settrace(None)
    elif frame.f_code.co_filename.endswith(("interrupt.py", "threading.py")):
        lines += event == "line"
        if event == "line" and lines == at:
            os.kill(os.getpid(), signal.SIGTERM)
        return trace
def ask():
    sys.settrace(trace)
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(30.0)
main._run = ask
for at in range(1, 31):
    if os.fork():
        os.write(1, b"%d " % os.waitstatus_to_exitcode(os.wait()[1]))
    else:
        signal.alarm(5)
        main.main()
"""


def test_an_interrupt_while_one_is_answered_ends_the_command() -> None:
    """Whatever line of answering the first it comes at; it waited for ever for what the first was at."""
    done = ended(TWICE)
    assert set(done.stdout.split()) == {"130"}, done.stdout
    assert set(done.stderr.splitlines()) == {"rock: interrupted"}
    assert done.stderr.count("\n") == 30


DRAWING = """\
import os, signal
from rockcli.cli import trade
from rockcli.cli.main import main
trade._draw = lambda *_: os.kill(os.getpid(), signal.SIGINT)
main()
"""


def test_an_interrupt_while_a_trade_is_drawn_says_what_is_written(tmp_path: Path) -> None:
    (tmp_path / "x.yaml").write_text(STUDY[: STUDY.index("vary")])
    done = ended(DRAWING, "trade", "x.yaml", "--budget", "1s", "-q", folder=tmp_path)
    assert done.returncode == 130
    assert done.stderr == "rock: interrupted; results/long-trade/long-trade.nc is written\n"
    assert (tmp_path / "results" / "long-trade" / "long-trade.nc").exists()
