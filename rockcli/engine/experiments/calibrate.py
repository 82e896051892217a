"""Calibrations: the bodies of a study and the errors of its model, as outcomes of runs leave them; kept as JSON."""

from __future__ import annotations

import base64
import json
import zlib
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.experiments.calibration import (
    AMPLITUDES,
    WALKS,
    Errors,
    Evidence,
    capacities,
    errors,
    evidence,
    predict,
    summary,
)
from rockcli.analysis.experiments.scores import Bools, Index, divide_groups, numbered
from rockcli.engine.experiments.runs import GROUP, SESSION, Runs
from rockcli.engine.experiments.score import STUDY, Options, Prediction, predicted_by
from rockcli.engine.experiments.simulated import Simulated, simulate
from rockcli.engine.sweep.sweep import Progress
from rockcli.engine.sweep.work import Team
from rockcli.errors import StudyError
from rockcli.scene.counted import counted
from rockcli.storage.atomic import write_text
from rockcli.version import __version__

Array = NDArray[np.float64]

LEAST = 10
"""Runs that a calibration needs."""

FORMAT = 2
"""Of the file; 1 did not name the column of the groups."""

_UNKNOWN = 255
_STEPS = 200
"""A share is kept as a whole number of 200ths."""


@dataclass(frozen=True, eq=False)
class Calibration:
    """Runs with what every body of a study does in them.

    Attributes:
        simulated: of the runs.
        outcome: whether the body overturned, (n,).
        labels: group of each run.
        table: name of the file of the runs.
        session: in which the body was set up for each run; () where the table does not say.
        grouped_by: column of the table that holds the groups.
    """

    simulated: Simulated
    outcome: NDArray[np.bool_]
    labels: tuple[str, ...]
    table: str
    session: tuple[str, ...] = ()
    grouped_by: str = GROUP

    def as_plain(self) -> dict[str, Any]:
        """All of it, and what it says of the body, as plain values for JSON."""
        known = self.simulated
        group = numbered(self.labels)
        every = np.ones(len(group), dtype=bool)
        fit = _Fit.of(self, self.session)
        body, found = fit.known(every)
        capacity, scatter = found.summaries()
        wandering = {"session_walk": float(found.walk @ WALKS)} if self.session else {}
        return {
            "calibration": FORMAT,
            "version": __version__,
            "study": known.study,
            "identity": known.identity,
            "table": self.table,
            "runs": len(self.outcome),
            "overturned": int(self.outcome.sum()),
            "groups": len(set(self.labels)),
            "capacity_factor": asdict(capacity),
            "capacity_scatter": asdict(scatter),
            **wandering,
            "bodies": known.share.shape[1],
            "bodies_effective": float(1.0 / (body**2).sum()),
            "posterior": {path: _told(values, body) | _unit(known, path) for path, values in known.inputs.items()},
            "amplitudes": known.amplitudes.tolist(),
            "inputs": {path: values.tolist() for path, values in known.inputs.items()},
            "units": known.units,
            "outcome": [int(fell) for fell in self.outcome],
            "group": list(self.labels),
            "grouped_by": self.grouped_by,
            "session": list(self.session),
            "share": _packed(known.share),
        }


def _unit(known: Simulated, path: str) -> dict[str, str]:
    return {"unit": known.units[path]} if known.units.get(path) else {}


def _told(values: NDArray[Any], weight: Array) -> dict[str, Any]:
    """The distribution of an input: of numbers its moments and percentiles, of labels the probability of each."""
    if np.issubdtype(values.dtype, np.number):
        prior = np.full(len(weight), 1.0 / len(weight))
        of = values.astype(float)
        return {"prior": asdict(summary(of, prior)), "posterior": asdict(summary(of, weight))}
    labels = list(dict.fromkeys(values.tolist()))
    return {"probability": {str(label): float(weight[values == label].sum()) for label in labels}}


def _packed(share: Array) -> str:
    whole = np.where(np.isnan(share), _UNKNOWN, np.round(np.nan_to_num(share) * _STEPS)).astype(np.uint8)
    return base64.b64encode(zlib.compress(whole.tobytes(), 9)).decode("ascii")


def _unpacked(text: str, shape: tuple[int, ...]) -> Array:
    whole = np.frombuffer(zlib.decompress(base64.b64decode(text, validate=True)), dtype=np.uint8).reshape(shape)
    return np.where(whole == _UNKNOWN, np.nan, whole / _STEPS)


def calibrate(
    source: Path | dict[str, Any], runs: Runs, *, team: Team | None = None, progress: Progress | None = None
) -> Calibration:
    """Solve the bodies of a study in the runs of one specimen, at all amplitudes.

    Raises:
        StudyError: fewer than LEAST runs; as `simulate`.
    """
    if runs.size < LEAST:
        raise StudyError(f"a calibration needs at least {LEAST} runs, and has {runs.size}", file=runs.file)
    if len(names := sorted(set(runs.specimen))) > 1:
        mend = "choose one with --specimen, as each has its own errors"
        raise StudyError(f"has {len(names)} specimens ({', '.join(names)}): {mend}", file=runs.file)
    known = simulate(source, runs, AMPLITUDES.tolist(), team=team, progress=progress)
    return Calibration(known, runs.outcome, runs.labels, runs.file.name, runs.session, runs.grouped_by)


def write(calibration: Calibration, path: Path) -> None:
    """Write a calibration; raises OutputError where it cannot be written."""
    write_text(path, json.dumps(calibration.as_plain(), indent=1) + "\n")


def read(path: Path) -> Calibration:
    """Read a calibration.

    Raises:
        StudyError: it cannot be read or is none.
    """
    try:
        plain = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise StudyError("there is no such file", file=path) from None
    except OSError as error:
        raise StudyError(f"cannot be read: {error.strerror}", file=path) from None
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        line = getattr(error, "lineno", None)
        raise StudyError("is no JSON: expected a calibration of `rock calibrate`", file=path, line=line) from None
    if not isinstance(plain, dict) or plain.get("calibration") != FORMAT:
        raise StudyError("is no calibration as `rock calibrate` writes it now: make it anew", file=path)
    try:
        amplitudes = np.array(plain["amplitudes"], dtype=float)
        shape = (len(plain["outcome"]), int(plain["bodies"]), len(amplitudes))
        known = Simulated(
            share=_unpacked(plain["share"], shape),
            amplitudes=amplitudes,
            inputs={name: np.array(values) for name, values in plain["inputs"].items()},
            units=dict(plain["units"]),
            study=str(plain["study"]),
            identity=str(plain["identity"]),
        )
        outcome, labels = np.array(plain["outcome"], dtype=bool), tuple(str(label) for label in plain["group"])
        session, grouped_by = tuple(str(label) for label in plain["session"]), str(plain["grouped_by"])
        if len(labels) != len(outcome) or len(outcome) < LEAST or len(session) not in (0, len(outcome)):
            raise ValueError("runs")
    except (KeyError, TypeError, ValueError, AttributeError, zlib.error):
        raise StudyError("is a damaged calibration: `rock calibrate` makes it anew", file=path) from None
    return Calibration(known, outcome, labels, str(plain.get("table", "")), session, grouped_by)


def check_same(calibration: Calibration, simulated: Simulated, file: Path) -> None:
    """`StudyError` if a calibration is of other bodies than those of a study."""
    if calibration.simulated.identity != simulated.identity:
        raise StudyError(
            f"is a calibration of other bodies or motions than those of the study {simulated.study}; "
            "`rock calibrate` makes it anew",
            file=file,
        )


@dataclass(frozen=True, eq=False)
class _Fit:
    """What a calibration says, of any part of its runs."""

    calibration: Calibration
    found: Evidence
    group: Index
    log_capacity: Array
    session: Index
    sessions: tuple[str, ...]

    @staticmethod
    def of(calibration: Calibration, sessions: tuple[str, ...]) -> _Fit:
        """With sessions also of other runs; they follow one another by name, as dates and numbers do."""
        known, group = calibration.simulated, numbered(calibration.labels)
        names = _ordered(set(calibration.session) | set(sessions)) if calibration.session else ("",)
        return _Fit(
            calibration,
            evidence(known.share, calibration.outcome, group, known.amplitudes),
            group,
            capacities(known.share, known.amplitudes),
            places(calibration.session, names, len(group)),
            names,
        )

    def known(self, runs: Bools) -> tuple[Array, Errors]:
        """Weights of the bodies and errors of their mean, as some of the runs (whole groups) leave them."""
        groups = np.zeros(int(self.group.max()) + 1, dtype=bool)
        groups[self.group[runs]] = True
        body = self.found.weights(groups)
        outcome, session = self.calibration.outcome[runs], self.session[runs]
        return body, errors(self.log_capacity[runs] @ body, outcome, session, len(self.sessions))


def _ordered(names: set[str]) -> tuple[str, ...]:
    try:
        return tuple(sorted(names, key=lambda name: (float(name), name)))
    except ValueError:
        return tuple(sorted(names))


def places(session: tuple[str, ...], names: tuple[str, ...], size: int) -> Index:
    """The place of each run's session among the names; all 0 where there are no sessions."""
    at = {name: i for i, name in enumerate(names)}
    return np.array([at[name] for name in session], dtype=np.int64) if session else np.zeros(size, dtype=np.int64)


def predicted(
    calibration: Calibration,
    simulated: Simulated,
    labels: tuple[str, ...],
    options: Options,
    *,
    leave_out: bool,
    session: tuple[str, ...] = (),
) -> tuple[Prediction, tuple[str, ...]]:
    """Probabilities of runs by a calibration, and remarks.

    Args:
        calibration: of the same bodies as `simulated`.
        simulated: of the runs to predict, at the amplitudes of the calibration.
        labels: group of each.
        options: count and repeats of the folds, seed.
        leave_out: divide the runs into folds of whole groups, and predict each without the runs of its groups.
        session: of each, where those of the calibration have one.
    """
    fit = _Fit.of(calibration, session)
    log_capacity = capacities(simulated.share, simulated.amplitudes)
    where = places(session if calibration.session else (), fit.sessions, len(labels))
    own = np.array(calibration.labels)
    if not leave_out:
        body, found = fit.known(np.ones(len(own), dtype=bool))
        p, low, high = predict(log_capacity @ body, found, where)
        shared = len(set(labels) & set(calibration.labels))
        told = (
            f"{counted(shared, 'group')} of the runs {'is' if shared == 1 else 'are'} among those of the calibration: "
            "this is a fit, no prediction; --folds"
        )
        return Prediction(STUDY, p, low, high), (told,) if shared else ()
    group, each = numbered(labels), np.array(labels)
    out = np.zeros((3, options.repeats, len(labels)))
    alone = False
    for repeat in range(options.repeats):
        fold = divide_groups(group, options.count, options.seed + repeat)
        for number in np.unique(fold):
            asked = fold == number
            others = ~np.isin(own, each[asked])
            alone |= not others.any()
            body, found = fit.known(others)
            out[:, repeat, asked] = predict(log_capacity[asked] @ body, found, where[asked])
    p, low, high = out.mean(axis=1)
    told = "nothing is fitted to predict some runs: the calibration has no runs of other groups"
    return Prediction(STUDY, p, low, high, out[0]), (told,) if alone else ()


def by_study(
    source: Path | dict[str, Any],
    runs: Runs,
    calibration: Path | None = None,
    options: Options | None = None,
    *,
    leave_out: bool = False,
    team: Team | None = None,
    progress: Progress | None = None,
) -> tuple[str, Prediction, tuple[str, ...]]:
    """Name of a study, its prediction of the runs of one specimen, and remarks.

    Nothing is fitted without a calibration, unless `leave_out` asks to calibrate on the other groups of the runs.

    Raises:
        StudyError: as `calibrate`, `read` and `simulate`; the calibration is of other bodies.
    """
    how = options or Options()
    if calibration is None and not leave_out:
        return predicted_by(source, runs, team=team, progress=progress)
    if calibration is None:
        known = calibrate(source, runs, team=team, progress=progress)
        found = known.simulated
        return (found.study, *predicted(known, found, runs.labels, how, leave_out=True, session=runs.session))
    known = read(calibration)
    if known.session and not runs.session:
        raise StudyError(f"has no column `{SESSION}`, as the runs of the calibration have", file=runs.file)
    told: tuple[str, ...] = ()
    if known.grouped_by != runs.grouped_by:
        apart = f"groups its runs by `{known.grouped_by}` and not by `{runs.grouped_by}`"
        if leave_out:  # of other names none would be found, and runs be predicted by their own outcomes
            raise StudyError(
                f"{apart}, so none can be left out: `rock calibrate --folds {runs.grouped_by}` makes it anew",
                file=calibration,
            )
        told = (f"{calibration.name} {apart}: whether runs are in both, which would be a fit, is not known",)
    found = simulate(source, runs, known.simulated.amplitudes.tolist(), team=team, progress=progress)
    check_same(known, found, calibration)
    prediction, notes = predicted(known, found, runs.labels, how, leave_out=leave_out, session=runs.session)
    return found.study, prediction, (*told, *notes)
