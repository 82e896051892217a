"""`rock identify`: restitution, and the body if asked, from a measured motion."""

from __future__ import annotations

from math import inf, isfinite, pi
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rockcli.cli.say import say

if TYPE_CHECKING:
    from rockcli.engine.identify import Identified, Measured


def identify(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="Time [s] and rotation in two columns, or amplitudes in one.")
    ],
    study: Annotated[
        Path | None, typer.Option("--study", metavar="STUDY.yaml", help="The body, and the motion that drives it.")
    ] = None,
    alpha: Annotated[float | None, typer.Option("--alpha", help="Slenderness [rad], without --study.")] = None,
    p: Annotated[float | None, typer.Option("--p", help="Frequency parameter [rad/s], without --study.")] = None,
    fit: Annotated[
        str, typer.Option("--fit", metavar="NAMES", help="What to find beside eta: alpha, p; by commas.")
    ] = "",
    degrees: Annotated[bool, typer.Option("--degrees", help="Rotations are in degrees.")] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="FILE", help="Write measured and fitted as a table (.csv) or a figure (.png .pdf .svg)."
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Estimate eta, and alpha and p if asked, from a measured free-rocking or shake-table history.

    Intervals hold with a confidence of 95 %.  Free rocking starts with the first row; its state there is fitted too.
    """
    from rockcli.cli.progress import Progress
    from rockcli.engine.identify import (
        ALPHA,
        ETA,
        RATE,
        THETA,
        P,
        amplitudes_of,
        check_fit_place,
        check_history,
        eta_of_amplitudes,
        guess_of,
        identify_amplitudes,
        identify_history,
        read_measured,
        write_fit,
    )
    from rockcli.errors import StudyError

    asked = [name.strip() for name in fit.split(",") if name.strip()]
    wrong = [name for name in asked if name not in (ETA, ALPHA, P)]
    if wrong:
        raise StudyError(f"--fit {wrong[0]}: expected eta, alpha or p")
    source = _source(study, alpha, p)
    if out is not None:
        check_fit_place(out, file)
    measured = read_measured(file, degrees=degrees)
    guess = guess_of(source)
    if measured.time is None:
        found = identify_amplitudes(measured, guess[ALPHA], free=asked)
    elif study is None and p is None:
        raise StudyError("a history needs --p (sqrt(0.75 g/R) of a rectangle) beside --alpha, or --study")
    else:
        names = [ETA, *(name for name in (ALPHA, P) if name in asked)]
        driven = _driven(source)
        check_history(measured, None if driven or ALPHA in asked else guess[ALPHA])
        if not driven:
            guess |= {THETA: float(measured.theta[0]), RATE: 0.0}
            guess[ETA] = eta_of_amplitudes(amplitudes_of(measured), guess[ALPHA])
            names += [THETA, RATE]
        line = Progress(file.name, shown=True, what="stages")
        try:
            found = identify_history(measured, source, guess, names, line)
        finally:
            line.close()
    if out is not None:
        write_fit(measured, found, out)
    say(_as_json(found) if as_json else _in_words(found, measured, file))
    for note in found.notes:
        say(f"rock: {file}: {note}", err=True)


def _source(study: Path | None, alpha: float | None, p: float | None) -> Path | dict[str, Any]:
    """The study given, or one of a block that rocks freely."""
    from rockcli.errors import StudyError

    if study is not None:
        if alpha is not None or p is not None:
            raise StudyError("--alpha and --p describe the body where there is no --study")
        return study
    if alpha is None:
        raise StudyError("the body is missing: give --alpha (and --p for a history), or --study")
    if not 0.0 < alpha < 0.5 * pi:
        raise StudyError(f"--alpha {alpha:g}: expected an angle between 0 and pi/2 in radians (10 degrees are 0.1745)")
    if p is not None and not 0.0 < p < inf:
        raise StudyError(f"--p {p:g}: expected a number of rad/s greater than 0")
    g = 9.81
    block = {"R": 0.75 * g / (2.0 if p is None else p) ** 2, "alpha": alpha}
    return {"name": "identify", "case": {"g": g, "block": block, "initial": {"theta": 0.5 * alpha}}}


def _driven(source: Path | dict[str, Any]) -> bool:
    """Whether the ground of the study moves."""
    from rockcli.study.open import open_study

    _, batch = next(iter(open_study(source).batches()))
    return batch.excitation.horizontal is not None


def _in_words(found: Identified, measured: Measured, file: Path) -> str:
    what = "amplitudes" if measured.time is None else "points"
    lines = [f"{file.name}: {found.points} {what}, scatter {found.fit.scatter:.3g} rad"]
    for name, value, low, high in zip(found.names, found.fit.values, found.fit.low, found.fit.high, strict=True):
        interval = f"95 %: {low:.6g} to {high:.6g}{_unit(name)}" if isfinite(high - low) else "no interval"
        lines.append(f"  {name:<12} {value:.6g}   {interval}")
    return "\n".join(lines)


def _unit(name: str) -> str:
    units = {"alpha": " rad", "p": " rad/s", "theta_0": " rad", "theta_dot_0": " rad/s"}
    return units.get(name, "")


def _as_json(found: Identified) -> str:
    import json

    rows = zip(found.names, found.fit.values, found.fit.low, found.fit.high, strict=True)
    plain = {
        "points": found.points,
        "scatter": found.fit.scatter,
        "parameters": {
            name: {
                "value": v,
                "low": low if isfinite(low) else None,
                "high": high if isfinite(high) else None,
            }
            for name, v, low, high in rows
        },
        "notes": list(found.notes),
    }
    return json.dumps(plain, indent=2)
