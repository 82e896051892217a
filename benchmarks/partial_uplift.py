"""Overturning amplitude of the column of Fig. 66: full mesh against the flexible column on a rigid and a Winkler base.

    ROCK_CALCULIX_DIR=FOLDER nice -n 19 python benchmarks/partial_uplift.py [--to 0.02] [--accuracy draft]

50 m x 5 m of concrete, zeta .01, a Ricker pulse of 4 s.  A real edge opens from M = m g b/3 on, the thesis's base all
at once at m g b.  For every model the amplitude a_p/(g tan(alpha)) is bisected between one that stands and one that
overturns.  A run of the mesh takes minutes, the bisection up to an hour: interrupted, it goes on where it stopped, from
../results/partial_uplift.json (delete it to begin again).  Nothing is kept of half a run; with ROCK_CALCULIX_DIR the
whole ones are kept too.  Needs `ccx`.  Writes results/partial_uplift.csv.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from machine import write_results

import rockcli

HERE = Path(__file__).resolve().parent
NOTES = HERE.parent / "results" / "partial_uplift.json"
TABLE = HERE / "results" / "partial_uplift.csv"

STANDS, OVERTURNS = 2.3, 3.3
"""Amplitudes a bisection begins between; widened where they do not bracket."""

T0, DURATION = 5.0, 24.0
"""The pulse's centre (1.25 T_p: a_g is 6e-6 of a_p at t = 0) and the end of a run [s]."""

COLUMN = {"E": "30*GPa", "rho": 2500, "zeta": 0.01}
FLEXIBLE = {"model": "flexible", "column": {**COLUMN, "elements": 40}}
MODELS: dict[str, dict[str, Any]] = {
    "flexible, rigid base": {**FLEXIBLE, "damping": "none"},
    "flexible, rigid base, eta": {**FLEXIBLE, "damping": "restitution"},
    "flexible, winkler 1e11": {**FLEXIBLE, "damping": "none", "base": {"law": "winkler", "kw": 1e11}},
    "flexible, winkler 1e12": {**FLEXIBLE, "damping": "none", "base": {"law": "winkler", "kw": 1e12}},
    "flexible, winkler 1e12, eta": {**FLEXIBLE, "damping": "restitution", "base": {"law": "winkler", "kw": 1e12}},
    "rigid block": {"model": "rigid", "damping": "none"},
    "mesh 4 x 40": {"model": "continuum", "column": COLUMN, "damping": "none"},
}


def outcome(how: dict[str, Any], amplitude: float, accuracy: str) -> tuple[bool | None, float | None, int]:
    """Whether it overturns (None: not to be told), theta_peak/alpha, impacts."""
    case = {
        "block": {"height": 50, "tan_alpha": 0.1},
        "motion": {
            "pulse": {"shape": "ricker", "a_p_over_g_tan_alpha": amplitude, "T_p": 4, "t0": T0},
            "duration": DURATION,
        },
        "solver": {"accuracy": accuracy if how["model"] == "continuum" else "standard"},
        **how,
    }
    found = rockcli.run({"name": "partial-uplift", "case": case, "save": {"histories": False}})
    flag = int(found.outcome)
    if flag == -1:
        return None, None, int(found.n_impacts)
    if flag < -1:
        said = found.reasons.values[int(found.reason)]
        raise SystemExit(f"{how['model']} at {amplitude:.6g} g tan(alpha): no outcome: {said}")
    return flag >= 2, float(found.theta_peak_over_alpha), int(found.n_impacts)


def bisected(name: str, notes: dict[str, Any], to: float, accuracy: str) -> dict[str, Any]:
    """Bracket the lowest overturning amplitude met from STANDS upward to within `to`; noted after every run."""
    how = MODELS[name]
    runs: dict[str, Any] = notes.setdefault(name, {})

    def overturns(amplitude: float) -> bool | None:
        key = f"{amplitude:.6f}"
        if key not in runs:
            runs[key] = outcome(how, amplitude, accuracy)
            said = {True: "overturns", False: "stands", None: "undecided"}[runs[key][0]]
            print(f"{name}: {key} g tan(alpha): {said}, peak {runs[key][1]}, impacts {runs[key][2]}", flush=True)
            NOTES.parent.mkdir(exist_ok=True)
            NOTES.write_text(json.dumps(notes, indent=1), encoding="utf-8")
        answer: bool | None = runs[key][0]
        return answer

    low, high = STANDS, OVERTURNS
    while overturns(low):
        low, high = 0.8 * low, low
    while not overturns(high):
        low, high = high, 1.25 * high
    while high - low > to:
        middle = 0.5 * (low + high)
        answer = overturns(middle)
        if answer is None:
            break  # so close to the boundary that the run does not tell
        low, high = (low, middle) if answer else (middle, high)
    return {"low": low, "high": high, "runs": len(runs), "impacts": runs[f"{high:.6f}"][2]}


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--to", type=float, default=0.02, help="width of the last bracket, over g tan(alpha)")
    options.add_argument("--accuracy", default="draft", help="of the mesh: draft, standard or reference")
    asked = options.parse_args()
    notes: dict[str, Any] = {}
    if NOTES.exists():
        notes = json.loads(NOTES.read_text(encoding="utf-8"))
    # the mesh's notes belong to the accuracy they were made with
    if notes.setdefault("accuracy", asked.accuracy) != asked.accuracy:
        notes.pop("mesh 4 x 40", None)
        notes["accuracy"] = asked.accuracy
    found = {
        name: bisected(name, notes, asked.to if how["model"] == "continuum" else 1e-4, asked.accuracy)
        for name, how in MODELS.items()
    }
    mesh = 0.5 * (found["mesh 4 x 40"]["low"] + found["mesh 4 x 40"]["high"])
    rows = []
    for name, row in found.items():
        against = 100.0 * (0.5 * (row["low"] + row["high"]) / mesh - 1.0)
        cells = [name, f"{row['low']:.4f}", f"{row['high']:.4f}", f"{against:+.1f}", row["impacts"], row["runs"]]
        rows.append(cells)
        print(*cells, sep="  ")
    head = ["model", "stands at [a_p/(g tan alpha)]", "overturns at", "against the mesh [%]", "impacts before", "runs"]
    write_results(TABLE, head, rows)


if __name__ == "__main__":
    main()
