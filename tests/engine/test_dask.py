"""A Dask cluster on this machine: a scheduler and two workers, real processes that talk over loopback."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from swept import STUDY, assert_same, study

from rockcli.engine import sweep
from rockcli.engine.cluster import check_cluster
from rockcli.engine.executors import Team
from rockcli.engine.run import run_study, solve
from rockcli.engine.sweep import Sweep
from rockcli.errors import StudyError
from rockcli.storage import netcdf
from rockcli.study.study import Study


def test_nobody_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("rockcli.engine.cluster.ANSWERS_WITHIN", 0.5)
    with socket.socket() as closed:
        closed.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{closed.getsockname()[1]}"
        with pytest.raises(StudyError, match="no Dask scheduler answers there"):
            check_cluster(address)


def test_dask_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(StudyError, match=r"pip install 'rockcli\[distributed\]'"):
        check_cluster("tcp://127.0.0.1:1")


def start(*command: str, folder: Path) -> subprocess.Popen[bytes]:
    environment = os.environ | {
        "PYTHONPATH": str(Path(__file__).parent),
        "ROCK_KERNELS": "interpreted",
        "DASK_DISTRIBUTED__WORKER__USE_FILE_LOCKING": "false",
    }
    log = (folder / f"log-{time.monotonic_ns()}").open("wb")
    with log:
        return subprocess.Popen([sys.executable, "-m", *command], cwd=folder, stdout=log, stderr=log, env=environment)


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Address, and the two workers."""
    pytest.importorskip("distributed")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    scheduler = start(
        "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard", folder=tmp_path
    )
    workers = [
        start(
            "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard",
            "--local-directory", str(tmp_path), folder=tmp_path,
        )
        for _ in range(2)
    ]  # fmt: skip
    try:
        import distributed

        with distributed.Client(address, timeout=60.0, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60.0)
        yield address, workers
    finally:
        for process in (*workers, scheduler):
            process.send_signal(signal.SIGKILL)
            process.wait()


def real() -> Study:
    """Solved by the real solver: a worker knows no other."""
    return study(vary=STUDY["vary"] | {"model": ["linearized"], "initial.theta": [0.02, 0.05, 0.1]})


@pytest.mark.slow
def test_the_same_bits(cluster: tuple[str, list[subprocess.Popen[bytes]]], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROCK_KERNELS", "interpreted")
    monkeypatch.setattr(sweep, "CHUNK", 2)
    assert_same(solve(real()), solve(real(), sweep=Sweep(Team(dask=cluster[0]))))


@pytest.mark.slow
def test_a_killed_worker_changes_nothing(
    cluster: tuple[str, list[subprocess.Popen[bytes]]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROCK_KERNELS", "interpreted")
    monkeypatch.setattr(sweep, "CHUNK", 1)
    address, workers = cluster
    done: list[int] = []

    def shoot(finished: int, _: int) -> None:
        done.append(finished)
        if finished == 2:
            workers[0].send_signal(signal.SIGKILL)

    report = run_study(real(), tmp_path / "out", plots=False, team=Team(dask=address), progress=shoot)
    assert done == list(range(1, 10))
    assert (report.cases, report.failed) == (9, 0)
    assert_same(solve(real()), netcdf.read(tmp_path / "out" / "swept" / "swept.nc"))


@pytest.mark.slow
def test_a_search_on_the_cluster(
    cluster: tuple[str, list[subprocess.Popen[bytes]]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROCK_KERNELS", "interpreted")
    searched = study(
        vary={
            "block.R": [1.0, 2.0],
            "initial.theta": {"from": 0.1, "to": 0.3, "n": 3, "find": "overturning"},
        },
        save={},
    )
    assert_same(solve(searched), solve(searched, sweep=Sweep(Team(dask=cluster[0]))))
