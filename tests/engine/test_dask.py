"""A Dask cluster on this machine: a scheduler and two workers, real processes that talk over loopback."""

from __future__ import annotations

import contextlib
import gc
import logging
import os
import pickle
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from swept import STUDY, assert_same, study, write_study

from rockcli.engine.run import run_study, solve
from rockcli.engine.sweep import cluster as cluster_of
from rockcli.engine.sweep import sweep
from rockcli.engine.sweep.chunk_result import spans_of
from rockcli.engine.sweep.chunks import Chunks, Pace
from rockcli.engine.sweep.cluster import check_cluster, on_cluster
from rockcli.engine.sweep.sweep import Sweep
from rockcli.engine.sweep.work import Team
from rockcli.errors import MachineError, StudyError
from rockcli.storage import netcdf
from rockcli.study.study import Index, Study


def test_nobody_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("rockcli.engine.sweep.cluster.ANSWERS_WITHIN", 0.5)
    with socket.socket() as closed:
        closed.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{closed.getsockname()[1]}"
        with pytest.raises(StudyError, match="no Dask scheduler answers there"):
            check_cluster(address)


ANSWERS = {
    "silence": b"",
    "garbage": bytes(range(256)) * 64,
    "another protocol": b"HTTP/1.1 400 Bad Request\r\n\r\n",
    "a huge message": (1 << 40).to_bytes(8, "little") + (1).to_bytes(8, "little") + bytes(64),  # one frame of 1 TiB
}


@contextlib.contextmanager
def answering(kind: str) -> Iterator[str]:
    """The address of something that listens, answers so, and is no scheduler."""
    callers: list[socket.socket] = []

    def serve() -> None:
        with contextlib.suppress(OSError):
            while True:
                callers.append(listening.accept()[0])
                callers[-1].sendall(ANSWERS[kind])

    with socket.create_server(("127.0.0.1", 0)) as listening:
        thread = threading.Thread(target=serve)
        thread.start()
        try:
            yield f"tcp://127.0.0.1:{listening.getsockname()[1]}"
        finally:
            listening.shutdown(socket.SHUT_RDWR)
            thread.join()
            for caller in callers:
                caller.close()


@pytest.mark.parametrize("kind", ANSWERS)
def test_what_answers_is_no_scheduler(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("rockcli.engine.sweep.cluster.ANSWERS_WITHIN", 0.5)
    began = time.monotonic()
    with answering(kind) as address, pytest.raises(StudyError, match=f"--dask {address}: no Dask scheduler answers"):
        check_cluster(address)
    assert time.monotonic() - began < 5.0


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # sockets of broken-off handshakes
class TestEncrypted:
    """`tls://` with the certificates of Dask's own configuration."""

    @pytest.fixture(autouse=True)
    def nothing_left(self) -> Iterator[None]:
        yield
        gc.collect()

    @pytest.fixture
    def certificates(self, tmp_path: Path) -> Iterator[dict[str, str]]:
        pytest.importorskip("distributed")
        if shutil.which("openssl") is None:
            pytest.skip("no openssl here, to make a certificate with")
        command = "openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=localhost -keyout key.pem -out cert.pem"
        subprocess.run(command.split(), cwd=tmp_path, check=True, capture_output=True)
        import dask

        cert, key = str(tmp_path / "cert.pem"), str(tmp_path / "key.pem")
        both = {"cert": cert, "key": key}
        tls = {f"{who}.{what}": path for who in ("client", "scheduler", "worker") for what, path in both.items()}
        with dask.config.set({f"distributed.comm.tls.{name}": path for name, path in {"ca-file": cert, **tls}.items()}):
            yield both

    def test_without_certificates_says_what_is_missing(self) -> None:
        pytest.importorskip("distributed")
        with pytest.raises(StudyError, match=r"tls needs certificates; name them .*distributed\.comm\.tls"):
            check_cluster("tls://127.0.0.1:1")

    def test_with_one_that_is_none(self, certificates: dict[str, str]) -> None:
        Path(certificates["cert"]).write_text("no certificate")
        with pytest.raises(StudyError, match="the certificates cannot be used"):
            check_cluster("tls://127.0.0.1:1")

    @pytest.mark.parametrize("kind", ANSWERS)
    def test_what_answers_is_no_scheduler(
        self, kind: str, certificates: dict[str, str], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr("rockcli.engine.sweep.cluster.ANSWERS_WITHIN", 0.5)
        began = time.monotonic()
        with answering(kind) as address, pytest.raises(StudyError, match="no Dask scheduler answers there"):
            check_cluster(address.replace("tcp:", "tls:"))
        assert time.monotonic() - began < 5.0

    @pytest.mark.slow
    def test_a_cluster(self, certificates: dict[str, str]) -> None:
        import distributed

        security = distributed.Security()
        with distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, protocol="tls://", security=security, dashboard_address=None
        ) as local:
            assert local.scheduler_address.startswith("tls://")
            check_cluster(local.scheduler_address)


@pytest.mark.slow
def test_the_command_keeps_to_the_ten_seconds(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    write_study(tmp_path)
    began = time.monotonic()
    with answering("silence") as address:
        command = [sys.executable, "-m", "rockcli.cli.main", "run", "swept.yaml", "--dask", address]
        found = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60.0, check=False)
    assert found.returncode == 2
    assert "no Dask scheduler answers there (nothing within 8 s)" in found.stderr
    assert (
        time.monotonic() - began < 30.0
    )  # of which the start of a process on a busy machine; silence without a bound would last for ever


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
    """Address, and the processes: two workers and the scheduler."""
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
        yield address, [*workers, scheduler]
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
def test_a_scheduler_that_goes_leaves_what_is_finished(
    cluster: tuple[str, list[subprocess.Popen[bytes]]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    monkeypatch.setenv("ROCK_KERNELS", "interpreted")
    monkeypatch.setattr(sweep, "CHUNK", 1)
    address, workers = cluster

    def shoot(finished: int, _: int) -> None:
        if finished == 2:
            workers[-1].send_signal(signal.SIGKILL)

    monkeypatch.setattr(logging.getLogger("distributed.client"), "propagate", True)
    monkeypatch.setattr(logging.getLogger("distributed"), "propagate", True)
    with pytest.raises(MachineError, match="the scheduler cannot be reached any more; run again"):
        run_study(real(), tmp_path / "out", plots=False, team=Team(dask=address), progress=shoot)
    assert not caplog.records  # the error says it, without tracebacks of Dask's client
    report = run_study(real(), tmp_path / "out", plots=False)
    assert (report.cases, report.failed) == (9, 0)
    assert report.resumed >= 2


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


class Grumbling:
    """Work on numbers that a machine refuses at one of them."""

    def __init__(self, refused: int) -> None:
        self.refused = refused

    def __call__(self, cases: Index) -> list[int]:
        if self.refused in cases:
            raise MemoryError("too much")
        return cases.tolist()

    def lost(self, cases: Index, why: str) -> str:
        return why


def test_a_task_of_many_chunks_gives_the_answer_of_each() -> None:
    cases = np.array([3, 4, 5, 6, 9, 12, 13])
    answers, refused, seconds = cluster_of._solve(pickle.dumps(Grumbling(-1)), spans_of(cases), 3)
    assert [pickle.loads(answer) for answer in answers] == [[3, 4, 5], [6, 9, 12], [13]]
    assert refused is None
    assert seconds >= 0.0


def test_what_the_machine_refuses_costs_its_chunk_alone() -> None:
    answers, refused, _ = cluster_of._solve(pickle.dumps(Grumbling(5)), spans_of(np.arange(9)), 2)
    assert [pickle.loads(answer) for answer in answers] == [[0, 1], [2, 3]]
    assert isinstance(refused, MemoryError)


@pytest.mark.slow
def test_nothing_is_lost_where_the_machine_refuses(cluster: tuple[str, list[subprocess.Popen[bytes]]]) -> None:
    """The answers before it count, what comes after it goes into other tasks, and the case itself is told."""
    pace = Pace(1e-3, 4)
    pace.learn(1000, 1.0)  # so that the first task holds many chunks
    found = {
        int(cases[0]): (cases.tolist(), answer)
        for cases, answer in on_cluster(Grumbling(37), Chunks(100), pace, Team(dask=cluster[0]))
    }
    assert found.pop(37) == ([37], "MemoryError: too much")
    assert all(cases == answer for cases, answer in found.values())
    assert sorted(case for cases, _ in found.values() for case in cases) == sorted({*range(100)} - {37})
