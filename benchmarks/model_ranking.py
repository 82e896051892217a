"""How far the simple models are from the block: writes the table of docs/validation.md between its markers.

    python benchmarks/model_ranking.py [FOLDER_WITH_AT2_RECORDS]

Peak theta/alpha of the linearized block and of models 1-4 in both geometries against the rigid block (event solver,
accuracy reference), on the thesis's 18 pulse cases (R = 2, 5, 10 m; tan alpha = .1, .2, .333; Ricker and sine;
a_p = 3.6 g tan alpha) and on 20 recorded motions scaled to 2 g tan alpha (R = 2 m), each undamped and with Housner's
restitution.  Without a folder of records the part on records is left as it stands.
"""

from __future__ import annotations

import itertools
import sys
from dataclasses import replace
from datetime import date
from pathlib import Path

import numpy as np

from rockcli.motion.reading import read_record
from rockcli.scene.batch import Batch, Save
from rockcli.scene.body.block import housner_eta, make_block
from rockcli.scene.ground.excitation import Excitation, Samples
from rockcli.scene.ground.pulses import make_pulses
from rockcli.scene.laws.damping import Damping
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import OVERTURNED_WITHOUT_IMPACT
from rockcli.solvers.event.solver import solve

G = 9.81
TAN_ALPHA = (0.1, 0.2, 0.333)
PULSES = {2.0: (3.0, 4.44), 5.0: (2.0, 2.66), 10.0: (1.4, 1.905)}
"""R [m]: omega_p over pi of the Ricker and of the sine pulse (Figs 7-16)."""

MODELS: tuple[tuple[str, str | None], ...] = (
    ("linearized", None),
    ("1", "negative_stiffness"),
    ("1", "corotational"),
    ("3", "negative_stiffness"),
    ("3", "corotational"),
)
"""Models 4 and 2 have the equations of 1 and 3."""

LABELS = {
    ("linearized", None): "linearized block (2.3)",
    ("1", "negative_stiffness"): "1-4, negative stiffness (2.4)-(2.8)",
    ("1", "corotational"): "1 and 4, corotational (2.9)",
    ("3", "corotational"): "2 and 3, corotational (2.10)",
}


def block_batch(R: float, tan_alpha: float, motion: Excitation, damped: bool) -> Batch:
    alpha = np.arctan(tan_alpha)
    body = make_block(h=R * np.cos(alpha), b=R * np.sin(alpha), R=R, alpha=alpha, tan_alpha=tan_alpha)
    eta = np.maximum(housner_eta(body), 0.0) if damped else np.ones((1, 2))
    zero = np.zeros(1)
    return Batch(
        g=np.full(1, G),
        block=body,
        excitation=motion,
        theta_0=zero,
        theta_dot_0=zero,
        model="rigid",
        geometry=None,
        damping=Damping("restitution" if damped else "none", eta),
        numerics=Numerics(accuracy="reference"),
        save=Save(False, 0.01, frozenset({"outcome", "theta_peak_over_alpha"})),
    )


def pulse_motions(tan_alpha: float) -> list[tuple[float, Excitation]]:
    found = []
    for R, (ricker, sine) in PULSES.items():
        for shape, over_pi in (("ricker", ricker), ("sine", sine)):
            pulse = make_pulses(shape, a_p=np.array([3.6 * G * tan_alpha]), omega_p=np.array([over_pi * np.pi]))
            found.append((R, Excitation(pulse, None, np.array([np.nan]))))
    return found


def record_motions(folder: Path, tan_alpha: float) -> list[tuple[float, Excitation]]:
    found = []
    for path in sorted(folder.rglob("*.AT2"))[::2][:20]:
        motion = read_record(path)
        values = motion.acceleration(G)
        factor = 2.0 * G * tan_alpha / np.abs(values).max()
        found.append((2.0, Excitation(Samples(values, motion.dt, np.array([factor])), None, np.array([np.nan]))))
    return found


def row(model: tuple[str, str | None], tan_alpha: float, damped: bool, motions: list[tuple[float, Excitation]]) -> str:
    errors, agree = [], []
    for R, motion in motions:
        batch = block_batch(R, tan_alpha, motion, damped)
        truth = solve(batch).scalars
        found = solve(replace(batch, model=model[0], geometry=model[1])).scalars
        fell = [bool(x["outcome"][0] >= OVERTURNED_WITHOUT_IMPACT) for x in (truth, found)]
        agree.append(fell[0] == fell[1] and min(truth["outcome"][0], found["outcome"][0]) >= 0)
        if not any(fell):
            true = truth["theta_peak_over_alpha"][0]
            if true > 0.0:
                errors.append(abs(found["theta_peak_over_alpha"][0] - true) / true)
    median, p90 = (f"{100.0 * q:.2f} %" for q in np.quantile(errors, (0.5, 0.9)))
    damping = "Housner" if damped else "none"
    return (
        f"| {LABELS.get(model, ' '.join(filter(None, model)))} | {tan_alpha:g} | {damping} | {median} | {p90} "
        f"| {sum(agree)} of {len(agree)} |"
    )


def table(motions_of) -> list[str]:
    lines = [
        "| model | tan alpha | loss at impacts | median error | 90th percentile | same outcome |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    chosen = [m for m in MODELS if m in LABELS]
    for damped, tan_alpha, model in itertools.product((False, True), TAN_ALPHA, chosen):
        lines.append(row(model, tan_alpha, damped, motions_of(tan_alpha)))
    return lines


def main() -> None:
    page = Path(__file__).resolve().parents[1] / "docs" / "validation.md"
    text = page.read_text(encoding="utf-8")
    parts = {"pulses": table(pulse_motions)}
    if len(sys.argv) > 1:
        folder = Path(sys.argv[1])
        parts["records"] = table(lambda tan_alpha: record_motions(folder, tan_alpha))
    for name, lines in parts.items():
        begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
        before, rest = text.split(begin)
        after = rest.split(end)[1]
        stamp = f"Measured {date.today().isoformat()}."
        text = "\n".join([before + begin, *lines, "", stamp, end]) + after
    page.write_text(text, encoding="utf-8")
    print(f"wrote {page}")


if __name__ == "__main__":
    main()
