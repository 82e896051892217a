"""A map on a Dask cluster of local workers against the same work without it, and with a worker that is killed on the way.

    python benchmarks/cluster.py [--cases N] [--workers N] [--scalars WORD ...] [--unharmed]

Processor time of whole commands: of `rock run` and, on the cluster, of what the scheduler and the workers spend meanwhile
(Linux).  A scheduler and workers that wait spend some hundredths of a second every second, which counts where a busy
machine stretches the run: the second ratio is without it.  The workers have solved a small map before, as those of a cluster have that stands.  The last run loses a worker
when a third is done, if not asked to leave all unharmed.  Checksums of the datasets must be the same.  Appends to results/cluster.csv.
"""

from __future__ import annotations

import argparse
import csv
import os
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Callable
from datetime import date
from pathlib import Path
from time import perf_counter, sleep

import netCDF4
from machine import machine
from scale import SIDES, STUDY

TABLE = Path(__file__).resolve().parent / "results" / "cluster.csv"

HEAD = (
    "cases", "scalars", "workers", "one process [s]", "rock run [s]", "scheduler [s]", "workers [s]", "ratio",
    "ratio without idling", "cases per second of a worker", "wall time, one process [s]", "wall time, cluster [s]", "after one was killed",
    "load before", "measured", "machine",
)  # fmt: skip


def spent(pid: int) -> float:
    """Processor time of a process that runs [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def command(study: Path, out: str, *more: str) -> list[str]:
    return [sys.executable, "-m", "rockcli", "run", str(study), "--out", str(study.parent / out), "--no-plots", *more]


def run(study: Path, out: str, *more: str, meanwhile: Callable[[Path], None] | None = None) -> tuple[float, float, str]:
    """Processor and wall time of a run [s], and the checksum of its dataset."""
    began = perf_counter()
    words = [*command(study, out, *more), "--quiet"]
    pid = os.spawnv(os.P_NOWAIT, words[0], words)
    if meanwhile is not None:
        meanwhile(study.parent / out)
    _, status, used = os.wait4(pid, 0)
    assert status == 0, status
    with netCDF4.Dataset(study.parent / out / "map" / "map.nc") as file:
        return used.ru_utime + used.ru_stime, perf_counter() - began, str(file.checksum)


def started(folder: Path, *words: str) -> subprocess.Popen[bytes]:
    with (folder / f"{len(list(folder.iterdir()))}.log").open("wb") as log:
        return subprocess.Popen([sys.executable, "-m", *words], cwd=folder, stdout=log, stderr=log)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=float, default=1e7)
    parser.add_argument("--workers", type=int, default=4)
    parser.add_argument("--scalars", nargs="+", default=["outcome"])
    parser.add_argument("--unharmed", action="store_true")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name, socket.socket() as free:
        folder = Path(name)
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
        free.close()
        address = f"tcp://127.0.0.1:{port}"

        def study(cases: int) -> Path:
            rows, columns = SIDES[cases]
            path = folder / f"{cases}.yaml"
            text = STUDY.format(rows=rows, columns=columns)
            path.write_text(text.replace("outcome, theta_peak_over_alpha", ", ".join(given.scalars)), encoding="utf-8")
            return path

        cases = int(given.cases)
        load = os.getloadavg()[0]
        alone, wall, wanted = run(study(cases), "alone", "--workers", "1")
        scheduler = started(
            folder, "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"
        )
        sleep(5.0)
        workers = [
            started(folder, "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard")
            for _ in range(given.workers)
        ]
        try:
            sleep(10.0)
            run(study(10**6), "warm", "--dask", address)
            everybody = [scheduler, *workers]
            before = [spent(process.pid) for process in everybody]
            sleep(10.0)
            idle = sum(spent(process.pid) - was for process, was in zip(everybody, before, strict=True)) / 10.0
            before = [spent(process.pid) for process in everybody]
            mine, wall_there, found = run(study(cases), "cluster", "--dask", address)
            theirs = [spent(process.pid) - was for process, was in zip(everybody, before, strict=True)]
            assert found == wanted

            def shoot(out: Path) -> None:
                """Kill a worker when a third of the cases is kept."""
                sizes = 9 if len(given.scalars) > 1 else 1
                while sum(path.stat().st_size for path in out.rglob("*.npz")) < cases * sizes / 3:
                    sleep(0.05)
                workers[0].send_signal(signal.SIGKILL)

            same = "not tried"
            if not given.unharmed:
                _, _, after = run(study(cases), "killed", "--dask", address, meanwhile=shoot)
                same = "same checksum" if after == wanted else "ANOTHER CHECKSUM"
        finally:
            for process in (*workers, scheduler):
                process.kill()
                process.wait()
    at_work = sum(theirs[1:])
    together = mine + theirs[0] + at_work
    row = [
        cases, " ".join(given.scalars), given.workers, f"{alone:.1f}", f"{mine:.1f}", f"{theirs[0]:.1f}",
        f"{at_work:.1f}", f"{together / alone:.2f}", f"{(together - idle * wall_there) / alone:.2f}", f"{cases / at_work:.0f}", f"{wall:.1f}", f"{wall_there:.1f}", same,
        f"{load:.1f}", date.today().isoformat(), machine(),
    ]  # fmt: skip
    print(*row, sep="; ")
    new = not TABLE.exists()
    with TABLE.open("a", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerows([HEAD, row] if new else [row])


if __name__ == "__main__":
    main()
