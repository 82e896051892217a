"""OpenSees's RockingBC element beside this program's model 3, its flexible column and the rigid block.

    python benchmarks/rocking_bc.py          ROCK_OPENSEES_PYTHON names another Python with OpenSeesPy

RockingBC (Avgenakis and Psycharis 2017, 2020) is a macroelement: an elastic body whose base is a row of points without
tension, with stiffness-proportional damping, so that what an impact loses comes from E, zeta and the step, and no
coefficient of restitution is given.  The body is 1 x 4.93 m (alpha = 0.2), rho = 2500 kg/m3, E = 30 GPa, its mass at the centre,
elastic (yield far away), without sliding; it rocks freely from alpha/2, or stands under one sine of omega_p = 6 p and
2 g alpha.  Steps of 2e-4 s and 1e-4 s, Newmark, zeta = 0.05 of the first mode.

Of each: extremes |theta|/alpha one after another, the ratio of energy that each impact keeps, from these, beside
Housner's eta squared, and processor time.  Writes results/rocking_bc.csv.
"""

from __future__ import annotations

import csv
import json
import math
import os
import subprocess
import tempfile
from datetime import date
from itertools import pairwise
from pathlib import Path

import numpy as np
from machine import machine

import rockcli
from rockcli.solvers.opensees.run import interpreter, version_of_opensees

HERE = Path(__file__).resolve().parent
G, ALPHA, WIDTH, RHO, E = 9.81, 0.2, 1.0, 2500.0, 30e9
HEIGHT = WIDTH / math.tan(ALPHA)
R = math.hypot(WIDTH, HEIGHT) / 2.0
P = math.sqrt(0.75 * G / R)
OMEGA_P, A_P = 6.0 * P, 2.0 * G * ALPHA
END = {"free": 4.2, "sine": 4.0}
STEPS = (2e-4, 1e-4)
KEPT = 3
"""Extremes that are compared."""

SCRIPT = """
import json, math, sys, time
import openseespy.opensees as ops
kind, dt, end, B, H, rho, E, theta_0, omega_p, a_p, g = json.loads(sys.argv[1])
m = rho*B*H
ops.model("basic", "-ndm", 2, "-ndf", 3)
ops.node(1, 0.0, 0.0); ops.node(2, 0.0, H/2)
ops.element("RockingBC", 1, 2, 1, 15, E, 0.0, -rho*g*H/5e-6, B, 1.0, 0.0, "-convlim", 1e-14)
ops.fix(1, 1, 1, 1)
ops.mass(2, m, m, m*(B*B + H*H)/12)
ops.timeSeries("Linear", 1); ops.pattern("Plain", 1, 1); ops.load(2, 0.0, -m*g, 0.0)
ops.constraints("Transformation"); ops.numberer("RCM"); ops.system("UmfPack")
ops.test("EnergyIncr", 1e-10, 100); ops.algorithm("Newton")
ops.integrator("LoadControl", 0.1); ops.analysis("Static"); ops.analyze(10)
ops.loadConst("-time", 0.0)
omega = math.sqrt(ops.eigen("-fullGenLapack", 1)[0])
if kind == "free":
    ops.pattern("Plain", 2, 1); ops.load(2, 1.0, 0.0, 0.0)
    for _ in range(400):
        ops.integrator("DisplacementControl", 2, 3, -theta_0/400)
        if ops.analyze(1): sys.exit("the push did not converge")
    ops.remove("loadPattern", 2)
ops.setTime(0.0); ops.wipeAnalysis()
ops.rayleigh(0.0, 2*0.05/omega, 0.0, 0.0)
if kind == "sine":
    n = int(round(2*math.pi/omega_p/dt))
    ops.timeSeries("Path", 2, "-dt", dt, "-values", *[a_p*math.sin(omega_p*i*dt) for i in range(n + 1)])
    ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
ops.constraints("Transformation"); ops.numberer("RCM"); ops.system("UmfPack")
ops.test("RelativeNormUnbalance", 1e-8, 100); ops.algorithm("Newton")
ops.integrator("Newmark", 0.5, 0.25); ops.analysis("Transient")
began, rows, t = time.process_time(), [], 0.0
while t < end:
    step = dt
    while ops.analyze(1, step):
        step /= 10
        if step < 1e-9: sys.exit(f"no convergence at t = {t:.4f} s")
    t = ops.getTime()
    rows.append((t, -ops.nodeDisp(2, 3)))
open(sys.argv[2], "w").write(json.dumps({"rows": rows[::max(1, int(1e-3/dt))], "seconds": time.process_time() - began}))
"""


def element(kind: str, dt: float) -> tuple[np.ndarray, float] | str:
    """History (t, theta) of RockingBC and its processor time; or why there is none."""
    case = [kind, dt, END[kind], WIDTH, HEIGHT, RHO, E, 0.5 * ALPHA, OMEGA_P, A_P, G]
    with tempfile.TemporaryDirectory() as place:
        out = Path(place, "out.json")
        words = [interpreter(), "-c", SCRIPT, json.dumps(case), str(out)]
        done = subprocess.run(words, capture_output=True, text=True, timeout=1800.0, check=False)
        if not out.is_file():
            return (done.stderr.strip().splitlines() or ["no answer"])[-1]
        found = json.loads(out.read_text())
    return np.array(found["rows"]), found["seconds"]


def study(kind: str, **more: object) -> tuple[np.ndarray, float]:
    """The same by this program."""
    case: dict[str, object] = {"block": {"height": HEIGHT, "width": WIDTH}, "model": "rigid", "damping": "restitution"}
    case["motion"] = {"duration": END[kind]}
    if kind == "free":
        case["initial"] = {"theta": 0.5 * ALPHA}
    else:
        case["motion"] |= {"pulse": {"shape": "sine", "a_p": A_P, "omega_p": OMEGA_P}}  # type: ignore[operator]
    given = {"name": "one", "case": case | more, "save": {"dt_out": 1e-3}}
    rockcli.run(given)  # loads and compiles
    began = sum(os.times()[:4])
    dataset = rockcli.run(given)
    seconds = sum(os.times()[:4]) - began
    theta = dataset.theta.values.reshape(-1)
    return np.column_stack([dataset.time.values[: theta.size], theta]), seconds


def extremes(history: np.ndarray) -> list[float]:
    """|theta|/alpha at the first extremes, one between two passages of zero."""
    theta = history[:, 1]
    cuts = [0, *(np.flatnonzero(np.sign(theta[1:]) * np.sign(theta[:-1]) < 0) + 1), theta.size]
    peaks = [np.abs(theta[a:b]).max() / ALPHA for a, b in pairwise(cuts) if b > a]
    return [float(x) for x in peaks if x > 0.01][:KEPT]


def kept(peaks: list[float]) -> float:
    """Energy an impact keeps, the mean over free extremes: U = cos(alpha - theta) - cos(alpha)."""
    energy = [math.cos(ALPHA * (1.0 - x)) - math.cos(ALPHA) for x in peaks]
    ratios = [b / a for a, b in pairwise(energy)]
    return float(np.mean(ratios)) if ratios else math.nan


def main() -> None:
    """Every model, free and under the sine."""
    column = {"model": "flexible", "column": {"E": E, "rho": RHO, "elements": 5}}
    rows = []
    for kind in END:
        found: dict[str, tuple[np.ndarray, float] | str] = {}
        for dt in STEPS:
            found[f"RockingBC, dt {dt:g} s"] = element(kind, dt)
        found["rigid block, Housner's eta"] = study(kind)
        found["model 3, OpenSees, Housner's eta"] = study(
            kind, model="3", geometry="corotational", solver={"backend": "opensees"}
        )
        found["flexible column, no restitution, zeta 0.05"] = study(
            kind,
            **(column | {"damping": "none", "column": column["column"] | {"zeta": 0.05}}),  # type: ignore[operator]
        )
        for name, answer in found.items():
            if isinstance(answer, str):
                rows.append([kind, name, "", "", answer])
                continue
            peaks = extremes(answer[0])
            energy = f"{kept(peaks):.3f}" if kind == "free" else ""
            rows.append([kind, name, " ".join(f"{x:.4f}" for x in peaks), energy, f"{answer[1]:.2g}"])
            print(rows[-1], flush=True)
    housner = (1.0 - 1.5 * math.sin(ALPHA) ** 2) ** 2
    with (HERE / "results" / "rocking_bc.csv").open("w", newline="") as file:
        write = csv.writer(file)
        write.writerow(
            [f"{date.today()}, {machine()}, openseespy {version_of_opensees()}, Housner keeps {housner:.3f}"]
        )
        write.writerow(["motion", "model", "extremes of |theta|/alpha", "energy kept per impact", "processor time [s]"])
        write.writerows(rows)


if __name__ == "__main__":
    main()
