"""Where each backend converges, where it is merely wrong and by how much, where it fails, and whether it says so.

    python benchmarks/stability_maps.py [--draw | MAP ...]

Writes `results/stability_maps.csv` (one row per case) and a picture `docs/figures/stability_<map>.png` per map; with names only
those maps are solved anew, with --draw none: pictures are drawn from the rows that are there.  Every map is a study over two axes; its error is that of the peak theta/alpha against another
solver: the event-driven one for stepping codes, DOP853 with located events for the event-driven one.
"""

from __future__ import annotations

import csv
import json
import sys
import textwrap
import time
import warnings
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from machine import machine
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

import rockcli
from rockcli.plotting.common.style import RC

HERE = Path(__file__).resolve().parent
RESULTS = HERE / "results" / "stability_maps.csv"
PICTURES = HERE.parent / "docs" / "figures"

COLUMNS = ("map", "panel", "y", "x", "outcome", "same_outcome", "error", "error_estimate", "seconds", "reason")

FAILED = -2

COLOURS, DARK = "Blues", 0.6
"""Pale is right, dark is wrong; share of the scale from which words are white."""

LOW, HIGH = 1e-14, 1.0
"""Ends of the colour scale, error of theta/alpha."""

Study = dict[str, Any]


@dataclass
class Map:
    """A map: `panels` by name, each a base case; the axes (path, name for people, points); the reference.

    `reference` is laid over the case and varies along `on_axes` only.
    """

    title: str
    panels: dict[str, Study]
    x: tuple[str, str, list[Any]]
    y: tuple[str, str, list[Any]]
    reference: Study
    on_axes: tuple[str, ...] = ()
    let: dict[str, float] = field(default_factory=dict)


RICKER: Study = {
    "block": {"R": 2, "tan_alpha": 0.1},
    "motion": {"duration": 4, "pulse": {"shape": "ricker", "a_p_over_g_tan_alpha": 3.6, "omega_p": "3*pi"}},
    "damping": "restitution",
}

COLUMN: Study = {
    "block": {"height": 50, "width": 5},
    "motion": {"duration": 6, "pulse": {"shape": "sine", "T_p": 1.6, "a_p": "5*g*tan_alpha"}},
    "model": "flexible",
    "damping": "restitution",
    "column": {"E": 30e9, "rho": 2500, "zeta": 0.01, "elements": 5},
}

MESH: Study = {
    **COLUMN,
    "motion": {**COLUMN["motion"], "duration": 6.5},
    "model": "continuum",
    "damping": "none",
    "column": {"E": 30e9, "rho": 2500, "zeta": 0.01, "across": 2},
    "solver": {"backend": "calculix", "dt": 1e-2},
}

SPREAD: Study = {
    "block": {"R": "0.75*g*s**2", "alpha": 0.2},
    "motion": {"pulse": {"shape": "sine", "a_p_over_g_tan_alpha": "0.5 + 0.5*sqrt(1 + W**2)", "omega_p_over_p": "W"}},
    "damping": "restitution",
}

STEPS = [1e-2, 3e-3, 1e-3, 3e-4, 1e-4]
MESH_STEPS = [5e-2, 2e-2, 1e-2, 5e-3]
YIELDS = [1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14]
MODULI = [1e9, 1e10, 3e10, 1e11, 1e12, 1e14, 1e16, 1e18, 1e20]
TOLERANCES = [1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10]
EVENT: Study = {"backend": "event", "accuracy": "reference"}


def model_3(backend: str) -> Study:
    return {**RICKER, "model": "3", "geometry": "corotational", "solver": {"backend": backend, "dt": 1e-3}}


def yielding(backend: str, steps: list[float]) -> Map:
    return Map(
        f"{backend}: model 3 (2.10), one Ricker pulse, R = 2 m, tan alpha = 0.1",
        {"": model_3(backend)},
        ("solver.dt", "step dt [s]", steps),
        ("solver.yield_rotation", "yield rotation of the base [rad]", YIELDS),
        {"solver": EVENT},
    )


MAPS: dict[str, Map] = {
    "event": Map(
        "event: sine half-way from uplift to overturning without impact, Housner's eta",
        {a: {**SPREAD, "solver": {"backend": "event", "accuracy": a}} for a in ("draft", "standard", "reference")},
        ("let.W", "omega_p/p", [0.1, 0.3, 1.0, 3.0, 10.0, 1e2, 1e3, 1e4]),
        ("block.alpha", "alpha [rad]", [1e-3, 1e-2, 0.1, 0.2, 0.4, 1.2]),
        {"solver": {"backend": "scipy", "method": "DOP853", "rtol": 1e-13}},
        ("x", "y"),
        {"W": 1.0},
    ),
    "scipy": Map(
        "scipy: rigid block, one Ricker pulse, R = 2 m, tan alpha = 0.1",
        {
            "events located": {**RICKER, "solver": {"backend": "scipy", "rtol": 1e-3}},
            "no events": {**RICKER, "damping": "none", "solver": {"backend": "scipy", "events": False, "rtol": 1e-3}},
        },
        ("solver.rtol", "rtol", TOLERANCES),
        ("solver.method", "method", ["RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA", "ode23s"]),
        {"solver": EVENT},
    ),
    "frame": yielding("frame", [*STEPS, 3e-5]),
    "opensees": yielding("opensees", STEPS),
    "flexible": Map(
        "event, flexible: 50 x 5 m column, Fig. 63, against the same with 120 elements",
        {"": COLUMN},
        ("column.elements", "elements", [1, 2, 3, 5, 10, 20, 40, 80]),
        ("column.E", "E [Pa]", MODULI),
        {"column": {**COLUMN["column"], "elements": 120}},
        ("y",),
    ),
    "flexible_frame": Map(
        "frame, flexible: 50 x 5 m column, Fig. 63, against the event-driven column of 5 elements",
        {"": {**COLUMN, "solver": {"backend": "frame", "dt": 1e-3}}},
        ("solver.dt", "step dt [s]", [1e-2, 3e-3, 1e-3, 3e-4]),
        ("column.E", "E [Pa]", MODULI),
        {"solver": EVENT},
        ("y",),
    ),
    "calculix": Map(
        "calculix: 50 x 5 m column, Fig. 60 with zeta = 0.01, against 6 x 60 elements at dt = 2.5e-3",
        {"": MESH},
        ("solver.dt", "largest step dt [s]", MESH_STEPS),
        ("column.across", "elements across (ten times as many along)", [1, 2, 3, 4]),
        {"column": {**MESH["column"], "across": 6}, "solver": {**MESH["solver"], "dt": 2.5e-3}},
    ),
    "calculix_modulus": Map(
        "calculix: the same on 2 x 20 elements, against the event-driven column of 20 elements",
        {"": MESH},
        ("solver.dt", "largest step dt [s]", [*MESH_STEPS, 2e-3]),
        ("column.E", "E [Pa]", [1e8, 1e9, 1e10, 3e10, 1e11, 1e12, 1e13, 1e14]),
        {"model": "flexible", "column": {"E": 30e9, "rho": 2500, "zeta": 0.01, "elements": 20}, "solver": EVENT},
        ("y",),
    ),
}


@cache
def _solved(study: str) -> Any:
    return rockcli.run(json.loads(study))


def solved(case: Study, vary: dict[str, list[Any]], let: dict[str, float]) -> Any:
    """Peak, outcome, error estimate and reasons over the axes of `vary`."""
    return _solved(json.dumps({"let": let, "case": case, "vary": vary, "save": {"histories": False}}))


def rows_of(name: str, what: Map) -> list[dict[str, Any]]:
    rows = []
    axes = {"y": what.y, "x": what.x}
    for panel, case in what.panels.items():
        began = time.perf_counter()
        found = solved(case, {path: points for path, _, points in axes.values()}, what.let)
        kept = {path: points for key, (path, _, points) in axes.items() if key in what.on_axes}
        other = solved({**case, **what.reference}, kept, what.let)
        shape = (len(what.y[2]), len(what.x[2]))
        form = tuple(n if key in what.on_axes else 1 for key, n in zip(("y", "x"), shape, strict=True))

        def grid(data: Any, quantity: str, form: tuple[int, ...] = form, shape: tuple[int, ...] = shape) -> Any:
            values = data[quantity].values
            return np.broadcast_to(values.reshape(shape if data is found else form), shape)  # noqa: B023

        reasons = [str(text) for text in found["reasons"].values] if "reasons" in found else [""]
        with np.errstate(invalid="ignore"):
            error = grid(found, "theta_peak_over_alpha") - grid(other, "theta_peak_over_alpha")
        for j, i in np.ndindex(*shape):
            outcome = int(grid(found, "outcome")[j, i])
            overturned = [int(grid(data, "outcome")[j, i]) >= 2 for data in (found, other)]
            rows.append(
                {
                    "map": name, "panel": panel, "y": what.y[2][j], "x": what.x[2][i], "outcome": outcome,
                    "same_outcome": int(overturned[0] == overturned[1]), "error": float(error[j, i]),
                    "error_estimate": float(grid(found, "error_estimate")[j, i]),
                    "seconds": round(float(grid(found, "wall_time")[j, i]), 5),
                    "reason": reasons[int(grid(found, "reason")[j, i])] if "reason" in found else "",
                }
            )  # fmt: skip
        print(f"{name} {panel}: {shape[0] * shape[1]} cases, {time.perf_counter() - began:.1f} s", flush=True)
    return rows


def in_words(value: Any) -> str:
    if isinstance(value, str) or 0.01 < abs(value) < 1000:
        return f"{value}" if isinstance(value, str) else f"{value:g}"
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


def draw(name: str, what: Map, rows: list[dict[str, Any]]) -> None:
    """One panel per base case: colour and number = error of theta/alpha; a frame where its own estimate is too small."""
    with rc_context(RC):
        nx, ny, n = len(what.x[2]), len(what.y[2]), len(what.panels)
        figure = Figure(figsize=(n * (0.4 * nx + 0.2) + 1.9, 0.3 * ny + 1.5), layout="constrained", dpi=180)
        FigureCanvasAgg(figure)
        norm = LogNorm(LOW, HIGH)
        image = None
        for k, panel in enumerate(what.panels):
            ax = figure.add_subplot(1, n, k + 1)
            mine = [row for row in rows if row["panel"] == panel]
            size = np.array([abs(float(row["error"])) for row in mine]).reshape(ny, nx)
            image = ax.imshow(
                np.ma.masked_invalid(np.clip(size, LOW, HIGH)),
                norm=norm,
                cmap=COLOURS,
                aspect="auto",
                origin="lower",
            )
            for row, (j, i) in zip(mine, np.ndindex(ny, nx), strict=True):
                mark(ax, row, i, j)
            ax.set_xticks(range(nx), [in_words(v) for v in what.x[2]], rotation=90)
            ax.set_yticks(range(ny), [in_words(v) for v in what.y[2]] if k == 0 else [""] * ny)
            ax.set_xlabel(what.x[1])
            ax.set_title(panel)
            if k == 0:
                ax.set_ylabel(what.y[1])
        figure.suptitle("\n".join(textwrap.wrap(what.title, int(13 * figure.get_figwidth()))), fontsize=9.5)
        figure.colorbar(image, ax=figure.axes, label="error of the peak theta/alpha")
        figure.savefig(PICTURES / f"stability_{name}.png")


def mark(ax: Any, row: dict[str, Any], i: int, j: int) -> None:
    """The number in a cell, `x` failed, `o` overturned as the reference does, `!` another outcome."""
    error, outcome, share = float(row["error"]), int(row["outcome"]), 0.0
    if outcome < 0:
        text = "x" if outcome == FAILED else "?"
    elif not int(row["same_outcome"]):
        text = "!"
    elif not np.isfinite(error):
        text = "o"
    else:
        share = np.log(np.clip(abs(error), LOW, HIGH) / LOW) / np.log(HIGH / LOW)
        text = "0" if abs(error) < LOW else in_words(abs(error)) if abs(error) < 0.01 else f"{abs(error):.1g}"
        if abs(error) > 3.0 * float(row["error_estimate"]) and abs(error) > 1e-11:
            ax.add_patch(Rectangle((i - 0.45, j - 0.45), 0.9, 0.9, fill=False, edgecolor="#D55E00", linewidth=1.4))
    colour = "white" if share > DARK else "#666666" if text == "o" else "black"
    ax.text(i, j, text, ha="center", va="center", fontsize=7, color=colour)


def kept_rows(anew: list[str]) -> list[dict[str, Any]]:
    """Rows of the maps that are not solved anew."""
    if not RESULTS.exists():
        return []
    with RESULTS.open() as lines:
        return [row for row in csv.DictReader(line for line in lines if line[0] != "#") if row["map"] not in anew]


def main() -> None:
    warnings.simplefilter("ignore")
    anew = [] if sys.argv[1:] == ["--draw"] else sys.argv[1:] or list(MAPS)
    rows = kept_rows(anew)
    for name in anew:
        rows += rows_of(name, MAPS[name])
    rows.sort(key=lambda row: list(MAPS).index(row["map"]))
    for name, what in MAPS.items():
        if mine := [row for row in rows if row["map"] == name]:
            draw(name, what, mine)
    if not anew:
        return
    with RESULTS.open("w", newline="") as out:
        out.write(f"# {machine()}\n")
        writer = csv.DictWriter(out, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
