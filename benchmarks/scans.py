"""What a scan costs in processor time: from the bytes of a mesh to volume, inertia, rests, and the barriers of all directions.

    python benchmarks/scans.py [FILE.obj ...]

Made-up boulders of 320 to 20 480 triangles, and the files named; writes benchmarks/results/scans.csv (made-up ones).
"""

from __future__ import annotations

import csv
import sys
import time
from pathlib import Path

import numpy as np
import trimesh

from rockcli.study.building.body_mesh import measured

RESULTS = Path(__file__).resolve().parent / "results" / "scans.csv"


def boulder(subdivisions):
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions)
    x, y, z = mesh.vertices.T
    r = 1 + 0.1 * np.sin(2.3 * x + 1.1) * np.cos(1.7 * y - 0.4) + 0.07 * np.sin(3.1 * z + 2 * y)
    corners = mesh.vertices * r[:, None] * [0.42, 0.33, 0.62]
    corners[:, 2] = np.maximum(corners[:, 2], -0.5)
    return trimesh.Trimesh(corners, mesh.faces).export(file_type="obj").encode()


def timed(data, kind, units):
    begun = time.process_time()
    scan = measured(data, kind, units)
    read = time.process_time()
    weakest = scan.weakest
    done = time.process_time()
    return [scan.triangles, len(scan.hull), len(scan.poses), round(read - begun, 3), round(done - read, 3),
            round(float(np.degrees(weakest)), 3), round(1e3 * scan.profile(weakest).barriers[1], 4)]  # fmt: skip


def main():
    head = ["body", "triangles", "hull_corners", "rests", "read_s", "barriers_s", "weakest_deg", "least_barrier_mm"]
    measured(boulder(1), "obj", "m")  # imports
    rows = [[f"boulder_{n}", *timed(boulder(n), "obj", "m")] for n in (2, 3, 4, 5)]
    with RESULTS.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *rows])
    rows += [[name, *timed(Path(name).read_bytes(), Path(name).suffix[1:], None)] for name in sys.argv[1:]]
    for row in (head, *rows):
        print(*row)


if __name__ == "__main__":
    main()
