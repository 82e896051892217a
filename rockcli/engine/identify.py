"""Restitution and body from a measured motion: the study's own solver, fitted to data."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.draw import FORMATS, format_of, write_figure
from rockcli.engine.run import solve
from rockcli.errors import StudyError
from rockcli.scene.counted import counted
from rockcli.scene.response import overturned
from rockcli.solvers.fit import Fit, least_squares_fit
from rockcli.storage.atomic import write_text
from rockcli.storage.places import check_file
from rockcli.study.document.values import reads_as_number
from rockcli.study.open import open_study

Array = NDArray[np.float64]

STAGES = (0.15, 0.3, 0.6, 1.0)
"""Shares of the data fitted one after the other: a late swing depends so much on eta that it misleads a first guess."""

SHAKEN_STAGES = tuple(np.linspace(0.1, 1.0, 19).tolist())
"""The same under a ground motion, of which the sum of squares has many minima, narrower as the data grow."""

BESIDE = np.outer([-1.0, 1.0], np.geomspace(3e-5, 0.05, 20)).ravel()
"""Under a ground motion eta so far beside what earlier data say is tried before each stage, and the best taken up."""

FAR = np.linspace(-0.7, 0.7, 281)
"""Also tried, in a second attempt, after a stage whose residuals are no noise."""

ETA, ALPHA, P, THETA, RATE = "eta", "alpha", "p", "theta_0", "theta_dot_0"

TOGETHER, VISIBLE = 4.0, 1e-3
"""Correlation of n residuals next to each other, over that which chance leaves, 1/sqrt(n), above which they are not
noise alone, unless they are below this part of the data: what the output times of the solver leave is smooth too."""

_LEAST = 0.2
"""Smallest alpha and p that are tried, relative to the first guess; the inverse is the largest p."""

_UNIT = re.compile(r"[\[(]\s*([a-z°]+)\s*[\])]", re.I)
_DEGREES, _RADIANS = ("deg", "degree", "degrees", "°"), ("rad", "radian", "radians")
_OTHERS = ("ms", "msec", "mrad")

_DECIMAL_COMMAS = re.compile(r"\d,\d+\s*[;\t]")
_ONE_COMMA = re.compile(r"\s*[+-]?\d+,\d+\s*$")


@dataclass(frozen=True, eq=False)
class Measured:
    """What was measured: rotations (n,) [rad] at times (n,) [s], or the amplitudes |theta| of successive swings."""

    theta: Array
    time: Array | None
    file: Path | None = None


@dataclass(frozen=True, eq=False)
class Identified:
    """What came out: one row per parameter in the order asked, how well it fits, the fitted rotations, and remarks."""

    names: tuple[str, ...]
    fit: Fit
    points: int
    fitted: Array
    notes: tuple[str, ...]


def read_measured(path: Path, *, degrees: bool) -> Measured:
    """Two columns are time [s] and rotation, one column holds amplitudes; # and % begin comments.

    Blanks, commas or semicolons separate; lines above the numbers that begin with a word are headings.

    Raises:
        StudyError: naming file and line: no numbers, other numbers of columns, times that do not grow, a heading or
            comment above the numbers that says other units.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()  # spreadsheets put a mark before the first number
    except OSError as error:
        raise StudyError(f"cannot be read: {error.strerror}", file=path) from None
    except UnicodeDecodeError:
        raise StudyError("is not text in UTF-8: expected lines of numbers", file=path) from None
    rows: list[list[float]] = []
    for number, line in enumerate(lines, start=1):
        if not rows:
            _check_units(line, path, number, degrees=degrees)
        words = line.split("#")[0].split("%")[0].replace(",", " ").replace(";", " ").split()
        if not words:
            continue
        try:
            row = [float(word) for word in words]
        except ValueError:
            if not rows and not reads_as_number(words[0]):  # a line of headings
                continue
            raise StudyError(f"expected numbers, not {line.strip()!r}", file=path, line=number) from None
        if _DECIMAL_COMMAS.search(line):
            raise StudyError("commas stand in the numbers: write decimals with a point", file=path, line=number)
        if len(row) not in (1, 2) or (rows and len(row) != len(rows[0])) or not np.isfinite(row).all():
            raise StudyError("expected one column (amplitudes) or two (time, rotation)", file=path, line=number)
        if rows and len(row) == 2 and row[0] <= rows[-1][0]:
            hint = "; a comma parts columns: write decimals with a point" if _ONE_COMMA.match(line) else ""
            raise StudyError(f"the times do not increase{hint}", file=path, line=number)
        rows.append(row)
    if len(rows) < 3:
        raise StudyError("holds fewer than three rows of numbers", file=path)
    table = np.array(rows) * np.array([1.0, np.pi / 180.0 if degrees else 1.0])[-len(rows[0]) :]
    if len(rows[0]) == 1:
        return Measured(np.abs(table[:, 0]), None, path)
    return Measured(table[:, 1], table[:, 0], path)


def _check_units(line: str, path: Path, number: int, *, degrees: bool) -> None:
    """Refuse units in brackets above the numbers that are not those the numbers are taken in."""
    for unit in map(str.lower, _UNIT.findall(line)):
        if unit in _DEGREES and not degrees:
            message = f"says [{unit}], and rotations are taken in radians: give --degrees"
        elif unit in _RADIANS and degrees:
            message = f"says [{unit}]: leave --degrees out"
        elif unit in _OTHERS:
            message = f"says [{unit}]; expected time [s] and rotation [rad], or [deg] with --degrees"
        else:
            continue
        raise StudyError(message, file=path, line=number)


def amplitudes_of(measured: Measured) -> Array:
    """Largest |theta| of each swing of one sign; the first from the beginning of the data."""
    theta = measured.theta
    if measured.time is None:
        return theta
    noise = 0.02 * np.max(np.abs(theta))
    sign = np.zeros(len(theta))
    sign[theta > noise], sign[theta < -noise] = 1.0, -1.0
    seen = np.flatnonzero(sign)
    breaks = np.flatnonzero(np.diff(sign[seen])) + 1
    return np.array([np.max(np.abs(theta[part])) for part in np.split(seen, breaks) if len(part)])


def height_lost(theta: Array, alpha: Array | float) -> Array:
    """Potential energy of a rigid block at |theta| over m g R: cos(alpha - |theta|) - cos(alpha)."""
    q = np.abs(theta)
    return np.asarray(2.0 * np.sin(alpha - 0.5 * q) * np.sin(0.5 * q))


def eta_of_amplitudes(amplitudes: Array, alpha: float) -> float:
    """Geometric mean of sqrt(U_{k+1}/U_k): an impact keeps eta² of the energy."""
    U = height_lost(amplitudes, alpha)
    U = U[: int(np.argmax(U <= 0.0))] if (U <= 0.0).any() else U
    if len(U) < 2:
        return 0.9
    return float(np.clip((U[-1] / U[0]) ** (0.5 / (len(U) - 1)), 0.05, 0.999))


def identify_amplitudes(measured: Measured, alpha: float, *, free: Sequence[str]) -> Identified:
    """Fit U_k = U_0 eta^(2k) to the amplitudes: eta and theta_0, and alpha if asked (free rocking of a rigid block).

    Raises:
        StudyError: an amplitude is 0 or beyond alpha, or p is asked for: amplitudes know nothing of time.
    """
    a = measured.theta
    if P in free:
        raise StudyError("amplitudes alone say nothing of p: give times too")
    wrong = np.flatnonzero((a <= 0.0) | (a >= alpha))
    if len(wrong):
        what = f"amplitude {wrong[0] + 1} is {a[wrong[0]]:.6g} rad: expected between 0 and alpha = {alpha:.6g} rad"
        raise StudyError(f"{what}; --degrees if it is in degrees", file=measured.file)
    if len(a) <= (k := 2 + (ALPHA in free)):
        raise StudyError(_too_few(k, len(a), "amplitude"), file=measured.file)
    names = (ETA, THETA, *((ALPHA,) if ALPHA in free else ()))

    def residuals(x: Array) -> Array:
        eta, theta_0, top = x[:, :1], x[:, 1:2], x[:, 2:] if len(names) > 2 else np.full((len(x), 1), alpha)
        U = height_lost(np.minimum(theta_0, top), top) * eta ** (2.0 * np.arange(len(a)))
        # cos(alpha - theta) = U + cos(alpha)
        theta = top - 2.0 * np.arcsin(np.sqrt(np.clip(np.sin(0.5 * top) ** 2 - 0.5 * U, 0.0, 1.0)))
        return np.asarray(theta - a)

    start = np.array([eta_of_amplitudes(a, alpha), a[0], alpha])[: len(names)]
    step = 1e-6 * start
    low = np.array([0.0, 1e-6 * a[0], 1.0001 * a.max()])[: len(names)]
    high = np.array([1.0, alpha, 1.5])[: len(names)]
    fit = least_squares_fit(residuals, start, step, (low, high), size=float(a.max()), final=True)
    left = residuals(fit.values[None])[0]
    missed = float(np.sqrt(np.mean(left**2) / np.mean(a**2)))
    return Identified(names, fit, len(a), a + left, _notes(names, fit, missed))


def _notes(names: Sequence[str], fit: Fit, missed: float) -> tuple[str, ...]:
    """What speaks against a fit: `missed` is the root mean square of its residuals over that of the data."""
    notes = [] if missed < 0.2 else [f"the fit leaves {missed:.0%} of the motion unexplained (root mean square)"]
    if not fit.converged:
        notes.append("the search stopped before it found a minimum")
    unknown = ", ".join(name for name, low in zip(names, fit.low, strict=True) if not np.isfinite(low))
    if unknown:
        notes.append(f"the data do not determine all of {unknown}: no intervals, and the first guess may be unchanged")
    return tuple(notes)


def check_history(measured: Measured, alpha: float | None) -> None:
    """What a rotation history cannot be.

    Args:
        measured: with times.
        alpha: beyond it a body that rocks freely does not come back; None where the ground moves or alpha is sought.

    Raises:
        StudyError: nothing moves, or rotations no rocking body reaches.
    """
    size = float(np.max(np.abs(measured.theta)))
    if size == 0.0:
        raise StudyError("all rotations are 0", file=measured.file)
    if size > 0.5 * np.pi:
        raise StudyError(
            f"rotations up to {size:.6g} rad, beyond pi/2: --degrees if they are in degrees", measured.file
        )
    if alpha is not None and size > 1.05 * alpha:  # a little of it may be noise
        what = (
            f"rotations up to {size:.6g} rad, beyond alpha = {alpha:.6g} rad, from where free rocking does not return"
        )
        raise StudyError(f"{what}: leave out the fall, or give another alpha", file=measured.file)


def guess_of(source: Path | dict[str, Any]) -> dict[str, float]:
    """First values of all parameters, from a study of one case of a rigid block; and `inertia`, `g`, which stay.

    Raises:
        StudyError: the study has axes, another model or an asymmetric body.
    """
    study = open_study(source)
    if study.axes:
        raise StudyError("a study to be fitted has one case: take away `vary`", file=study.file)
    _, batch = next(iter(study.batches()))
    if batch.model != "rigid" or batch.damping.scheme != "restitution" or np.ptp(batch.block.alpha) > 0.0:
        message = "expected model rigid with damping restitution and a symmetric body"
        raise StudyError(message, file=study.file)
    return {
        ETA: float(batch.damping.eta[0, 0]),
        ALPHA: float(batch.block.alpha[0, 0]),
        P: float(batch.p[0, 0]),
        THETA: float(batch.theta_0[0]),
        RATE: float(batch.theta_dot_0[0]),
        "inertia": float(batch.block.inertia[0, 0]),
        "g": float(batch.g[0]),
    }


def identify_history(
    measured: Measured,
    source: Path | dict[str, Any],
    guess: dict[str, float],
    free: Sequence[str],
    progress: Callable[[int, int], None] | None = None,
) -> Identified:
    """Fit the solver's rotation to a measured one, over growing shares of the data.

    Args:
        measured: with times; the study's time 0 is the first of them.
        source: the study whose motion, if any, drives the body.
        guess: of `guess_of`, changed as the caller sees fit; parameters not in `free` stay.
        free: parameters to find.
        progress: told of every stage that begins how many were before it, and of how many; anew in another attempt.

    Raises:
        StudyError: the study is wrong, or there are not more rows than unknowns.
    """
    assert measured.time is not None
    if len(measured.theta) <= len(free):
        raise StudyError(_too_few(len(free), len(measured.theta), "row"), file=measured.file)
    time, theta = measured.time - measured.time[0], measured.theta
    size = float(np.max(np.abs(theta)))
    scales = {ETA: 1.0, ALPHA: guess[ALPHA], P: guess[P], THETA: size, RATE: size * guess[P]}
    limits = {ETA: (0.0, 1.0), ALPHA: (_LEAST * guess[ALPHA], 1.5), P: (_LEAST * guess[P], guess[P] / _LEAST)}
    low, high = np.array([limits.get(name, (-np.inf, np.inf)) for name in free]).T
    step = 1e-5 * np.array([scales[name] for name in free])
    stages = STAGES if THETA in free else SHAKEN_STAGES
    shaken = stages is SHAKEN_STAGES and ETA in free

    def residuals(n: int, rows: Array) -> Array:
        values = [guess | dict(zip(free, row.tolist(), strict=True)) for row in rows]
        return _rotations(source, values, time[:n]) - theta[:n]

    def through_stages(beyond: Sequence[Array]) -> tuple[Fit, Array]:
        """The last fit and what it leaves, (n,); `beyond`: where else eta is sought where a stage leaves no noise."""
        x = np.array([guess[name] for name in free])
        for done, share in enumerate(stages):
            if progress is not None:
                progress(done, len(stages))
            n = min(max(int(share * len(time)), len(free) + 2), len(time))
            at, fits = partial(residuals, n), []
            for beside in (BESIDE, *beyond) if shaken else (np.empty(0),):
                start = _best_beside(at, x, free.index(ETA), beside, (low, high)) if shaken else np.clip(x, low, high)
                fit = least_squares_fit(at, start, step, (low, high), size=size, final=share == stages[-1])
                fits.append((fit, at(fit.values[None])[0]))
                if not _correlation(fits[-1][1], theta[:n]):
                    break
            fit, left = min(fits, key=lambda each: float(each[1] @ each[1]))
            x = fit.values
        return fit, left

    fit, left = through_stages(())
    if shaken and _correlation(left, theta):
        other, others = through_stages((FAR,))
        fit, left = (other, others) if others @ others < left @ left else (fit, left)
    missed = float(np.sqrt(np.mean(left**2) / np.mean(theta**2)))
    notes = _notes(free, fit, missed) + _note_of_neighbours(_correlation(left, theta))
    return Identified(tuple(free), fit, len(time), theta + left, notes)


def _best_beside(at: Callable[[Array], Array], x: Array, eta: int, beside: Array, bounds: tuple[Array, Array]) -> Array:
    """x or, if it fits better, x with its number `eta` so far beside: the residuals `at` are (m, k) -> (m, n)."""
    starts = np.repeat(x[None], 1 + len(beside), axis=0)
    starts[1:, eta] += beside
    starts = np.clip(starts, *bounds)
    return np.asarray(starts[np.argmin((at(starts) ** 2).sum(axis=1))])


def _correlation(left: Array, theta: Array) -> float:
    """Of residuals next to each other, (n,); 0 where they may be independent noise or are too small beside theta."""
    if left @ left <= VISIBLE**2 * (theta @ theta):
        return 0.0
    found = float(left[:-1] @ left[1:] / (left @ left))
    return found if found > TOGETHER / np.sqrt(len(left)) else 0.0


def _note_of_neighbours(correlation: float) -> tuple[str, ...]:
    """What residuals that are no independent noise say against a fit."""
    if not correlation:
        return ()
    return (
        f"residuals next to each other correlate by {correlation:.2f}: the intervals, which take them for independent "
        "noise, are too narrow; if they are larger than the noise of the instrument, the body is not the model, or the "
        "fit went astray: try another first guess",
    )


def check_fit_place(path: Path, measured: Path) -> None:
    """Refuse a place for the fit before anything is fitted.

    Raises:
        StudyError: its name ends as no format does, nothing can be written there, or what was measured would be lost.
    """
    if format_of(path) not in ("csv", *FORMATS):
        raise StudyError(f"--out {path}: expected a name that ends in .csv, .{', .'.join(FORMATS)}")
    check_file(path)
    if path.exists() and measured.exists() and path.samefile(measured):
        raise StudyError("is what was measured, and would be lost: give another name", file=path)


def write_fit(measured: Measured, found: Identified, path: Path) -> None:
    """Write what was measured beside what was fitted [rad]: a table (.csv), or a figure (.png .pdf .svg).

    Raises:
        OutputError: it cannot be written.
    """
    head = "swing" if measured.time is None else "time [s]"
    along = np.arange(found.points, dtype=float) if measured.time is None else measured.time
    if format_of(path) == "csv":
        rows = zip(along.tolist(), measured.theta.tolist(), found.fitted.tolist(), strict=True)
        lines = [f"{head},measured [rad],fitted [rad]", *(",".join(map(repr, row)) for row in rows)]
        write_text(path, "\n".join(lines) + "\n")
        return
    from rockcli.plotting.fit import figure

    title = "" if measured.file is None else measured.file.stem
    write_figure(figure(along, head, measured.theta, found.fitted, title), path)


def _rotations(source: Path | dict[str, Any], values: list[dict[str, float]], time: Array) -> Array:
    """Rotations [rad] of cases with these values at times (n,), 0 after they have come to rest: (cases, n)."""
    spacing = float(np.min(np.diff(time)))
    uniform = np.allclose(time, spacing * np.arange(len(time)), rtol=0.0, atol=1e-6 * spacing)
    # rows close together, as one taken twice, ask for no finer history than the others
    dt_out = spacing if uniform else max(spacing, float(time[-1]) / (8.0 * (len(time) - 1))) / 8.0
    cases = [_numbers(row) for row in values]
    settings = ", ".join(f"case_{number}: {_mapping(case)}" for number, case in enumerate(cases))
    study = open_study(
        source,
        overrides=[
            *((f"case.{part}", _mapping(of_part)) for part, of_part in _parts(cases[0]).items()),
            ("case.motion.duration", repr(float(time[-1]) + spacing)),
            ("vary", f"{{case: {{{settings}}}}}"),
            ("save", f"{{histories: true, dt_out: {dt_out!r}, scalars: [outcome]}}"),
        ],
    )
    contents = solve(study)
    out = np.empty((len(values), len(time)))
    for row, history, outcome in zip(out, contents.values("theta"), contents.values("outcome"), strict=True):
        missing = np.isnan(history)
        fallen = bool(overturned(outcome)) and not missing.all()
        lies = np.copysign(0.5 * np.pi, history[~missing][-1]) if fallen else 0.0
        row[:] = np.interp(time, contents.values("time"), np.where(missing, lies, history))
    return out


def _numbers(values: dict[str, float]) -> dict[str, float]:
    """The numbers of a case by their paths: cases that differ in nothing else are solved together."""
    return {
        "block.R": values["g"] / (values["inertia"] * values[P] ** 2),
        "block.alpha": values[ALPHA],
        "block.inertia": values["inertia"],
        "damping.eta": values[ETA],
        "initial.theta": values[THETA],
        "initial.theta_dot": values[RATE],
    }


def _parts(case: dict[str, float]) -> dict[str, dict[str, float | str]]:
    """The parts of a case that has these numbers, whatever the study says there."""
    parts: dict[str, dict[str, float | str]] = {"damping": {"scheme": "restitution"}}
    for path, value in case.items():
        part, key = path.split(".")
        parts.setdefault(part, {})[key] = value
    return parts


def _mapping(values: Mapping[str, float | str]) -> str:
    return "{" + ", ".join(f"{key}: {value!r}" for key, value in values.items()) + "}"


def _too_few(unknowns: int, data: int, what: str) -> str:
    return f"{counted(unknowns, 'unknown')} need{'s' * (unknowns == 1)} more than {counted(data, what)}"
