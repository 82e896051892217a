"""Scores of all predictions of a table of runs: a study's, those in its columns, and baselines, side by side."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.experiments.baselines import Fit, cross_validated, forest, has_forest, logistic, with_squares
from rockcli.analysis.experiments.scores import Bin, McNemar, Scored, divide_groups, mcnemar, reliability, scored
from rockcli.engine.experiments.runs import MEASURES, Runs
from rockcli.engine.experiments.simulated import Simulated, channels_of, simulate
from rockcli.engine.sweep.sweep import Progress
from rockcli.engine.sweep.work import Team
from rockcli.errors import StudyError
from rockcli.motion.measures import measures
from rockcli.motion.spectrum import Stretch, pseudo_acceleration
from rockcli.scene.constants import STANDARD_G
from rockcli.scene.counted import counted

Array = NDArray[np.float64]

STUDY, COLUMN, BASELINE = "study", "column", "baseline"

INTENSITIES = ("pga", "pgv", "pgv_over_pga", "pgd", "arias", "cav", "d5_95", "t_mean")
SPECTRAL = (0.3, 0.5, 1.0, 2.0)
"""The twelve measures of a random forest: these, and pseudo-accelerations at 5 % damping at these periods [s]."""


@dataclass(frozen=True)
class Options:
    """How predictions are scored.

    Attributes:
        count: folds of a cross-validation; 0 = one per group.
        repeats: how often the runs are divided into folds anew.
        seed: of the folds and of the bootstrap.
        baselines: fit those that know the ground motion alone.
        against: the prediction that all others are tested against; None = the study's, or the first column.
    """

    count: int = 5
    repeats: int = 5
    seed: int = 0
    baselines: bool = True
    against: str | None = None


@dataclass(frozen=True, eq=False)
class Prediction:
    """Probabilities of the runs by one source.

    Attributes:
        kind: STUDY, COLUMN or BASELINE.
        p: (n,) NaN where it says nothing.
        low, high: (n,) interval of 95 % of a calibrated probability, else None.
        repeats: (r, n) of every division into folds, of which p is the mean; None where nothing was fitted.
    """

    kind: str
    p: Array
    low: Array | None = None
    high: Array | None = None
    repeats: Array | None = None


@dataclass(frozen=True, eq=False)
class Report:
    """Scores of all predictions on the runs of one specimen.

    Attributes:
        runs: that were scored.
        against: name of the prediction that the others are tested against; "" where there is none.
        predictions, scores, reliability: by name.
        mcnemar: of `against` as first, by name of the other.
        notes: sentences about what was not done, and why.
    """

    specimen: str
    runs: Runs
    against: str
    predictions: dict[str, Prediction]
    scores: dict[str, Scored]
    reliability: dict[str, tuple[Bin, ...]]
    mcnemar: dict[str, McNemar]
    notes: tuple[str, ...]


def by_specimen(runs: Runs, specimen: str | None) -> list[tuple[str, Runs]]:
    """The runs of every specimen apart, or of one; raises StudyError for one that is not there."""
    labels = list(dict.fromkeys(runs.specimen)) or [""]
    if specimen is not None and specimen not in labels:
        known = ", ".join(labels) if runs.specimen else "none: there is no column `specimen`"
        raise StudyError(f"has no specimen {specimen!r}; it has {known}", file=runs.file)
    chosen = labels if specimen is None else [specimen]
    return [(label, runs.of(label) if runs.specimen else runs) for label in chosen]


def unfitted(simulated: Simulated) -> tuple[Prediction, tuple[str, ...]]:
    """The mean share that overturns over all bodies of a study; those without an answer count as 1/2."""
    share = simulated.share[:, :, 0]
    unknown = np.isnan(share)
    notes: tuple[str, ...] = ()
    if unknown.any():
        notes = (f"{int(unknown.sum())} of {unknown.size} cases have no answer and count as 1/2",)
    return Prediction(STUDY, np.where(unknown, 0.5, share).mean(axis=1)), notes


def predicted_by(
    source: Path | dict[str, Any], runs: Runs, *, team: Team | None = None, progress: Progress | None = None
) -> tuple[str, Prediction, tuple[str, ...]]:
    """Name and prediction of a study, nothing fitted, and remarks."""
    simulated = simulate(source, runs, [1.0], team=team, progress=progress)
    return (simulated.study, *unfitted(simulated))


def report_of(
    runs: Runs,
    *,
    specimen: str = "",
    study: tuple[str, Prediction] | None = None,
    source: Path | dict[str, Any],
    options: Options | None = None,
    notes: tuple[str, ...] = (),
    fitted_on: Runs | None = None,
) -> Report:
    """Score a study's prediction, the columns and the baselines on one table of runs.

    Args:
        runs: of one specimen.
        specimen: its name, "" where the table has none.
        study: name and probabilities of a study's prediction.
        source: study by whose settings records are read for the baselines.
        options: how.
        notes: of what came before.
        fitted_on: other runs that the baselines are fitted on; None = on other folds of these.

    Raises:
        StudyError: there is nothing to score, or `against` is no prediction.
    """
    how = options or Options()
    told = list(notes)
    found: dict[str, Prediction] = {}
    if study is not None:
        found[study[0]] = study[1]
    for name, p in runs.predictions.items():
        found[name if name not in found else f"{name} (column)"] = Prediction(COLUMN, p)
    if runs.unread:
        told.append(f"no predictions, as not all their cells are: columns {', '.join(runs.unread)}")
    if how.baselines:
        fitted, why = baselines(runs, source, how, fitted_on)
        found |= {name: p for name, p in fitted.items() if name not in found}
        told += why
    if not found:
        reasons = f" ({'; '.join(told)})" if told else ""
        raise StudyError(
            f"has nothing to score: no study, no column of predictions, no baseline{reasons}", file=runs.file
        )
    against = next(iter(found)) if how.against is None else how.against
    if against not in found:
        raise StudyError(f"has no prediction {against!r}; there are {', '.join(found)}", file=runs.file)
    scores, bins = {}, {}
    for name, each in found.items():
        known = ~np.isnan(each.p)
        scores[name] = scored(runs.outcome[known], each.p[known], runs.groups[known], how.seed)
        bins[name] = reliability(runs.outcome[known], each.p[known])
        if not known.all():
            told.append(f"{name} says nothing of {counted(int((~known).sum()), 'run')}, on which it is not scored")
    return Report(specimen, runs, against, found, scores, bins, _tests(runs, found, against), tuple(told))


def _tests(runs: Runs, found: dict[str, Prediction], against: str) -> dict[str, McNemar]:
    tests = {}
    for name, other in found.items():
        both = ~np.isnan(found[against].p) & ~np.isnan(other.p)
        if name != against and both.any():
            tests[name] = mcnemar(runs.outcome[both], found[against].p[both], other.p[both])
    return tests


def baselines(
    runs: Runs, source: Path | dict[str, Any], how: Options, fitted_on: Runs | None = None
) -> tuple[dict[str, Prediction], list[str]]:
    """Predictions of what knows the ground motion alone, and why some are missing.

    Each run is predicted by fits on the other folds, or all runs by a fit on others.
    """
    if fitted_on is None and len(np.unique(runs.groups)) < 2:
        return {}, ["no baselines: a single group of runs cannot be divided into folds"]
    tables = [_logs(some, source) for some in (runs, fitted_on) if some is not None]
    known = [name for name in tables[0] if name in tables[-1]]
    if not known:
        return {}, ["no baselines: there is no column `record`, and none of pga and pgv"]
    wanted: list[tuple[str, Fit, list[str]]] = [
        ("logistic: pga", logistic, ["pga"]),
        ("logistic: pgv", logistic, ["pgv"]),
        ("logistic: pga, pgv", logistic, ["pga", "pgv"]),
        ("logistic: pga, pgv, squares", with_squares, ["pga", "pgv"]),
    ]
    told = []
    if len(known) <= len(MEASURES):
        told.append("no random forest: it needs records, and the table has no column `record`")
    elif not has_forest():
        told.append("no random forest: scikit-learn is not installed")
    else:
        wanted.append(("random forest", forest, known))
    found = {}
    for name, fit, columns in wanted:
        if not set(columns) <= set(known):
            continue
        x = [np.column_stack([table[column] for column in columns]) for table in tables]
        if fitted_on is not None:
            found[name] = Prediction(BASELINE, fit(x[1], fitted_on.outcome)(x[0]))
            continue
        divided = np.array([divide_groups(runs.groups, how.count, how.seed + k) for k in range(how.repeats)])
        p = cross_validated(fit, x[0], runs.outcome, divided)
        found[name] = Prediction(BASELINE, p.mean(axis=0), repeats=p)
    return found, told


def _logs(runs: Runs, source: Path | dict[str, Any]) -> dict[str, Array]:
    return {name: np.log(np.maximum(values, 1e-12)) for name, values in intensities(runs, source).items()}


def intensities(runs: Runs, source: Path | dict[str, Any]) -> dict[str, Array]:
    """Intensity measures of every run, (n,) by name: of the records, `pga` and `pgv` of the table before them."""
    table: dict[str, Array] = {}
    if runs.record:
        known: dict[int, list[float]] = {}
        rows = []
        channels = channels_of(source, runs)
        for channel in channels:  # one object for all runs of a motion
            if id(channel) not in known:
                known[id(channel)] = _measured(channel.values * channel.factor[0], channel.dt)
            rows.append(known[id(channel)])
        names = (*INTENSITIES, *(f"sa({period:g})" for period in SPECTRAL))
        table = {name: np.array(column) for name, column in zip(names, zip(*rows, strict=True), strict=True)}
    return table | runs.measures


def _measured(a: Array, dt: float) -> list[float]:
    """The measures of INTENSITIES, then those of SPECTRAL, of one motion (k,) [m/s²]."""
    found = measures(a, dt, STANDARD_G)
    found["pgv_over_pga"] = found["pgv"] / found["pga"] if found["pga"] > 0.0 else 0.0
    periods = np.array(SPECTRAL)
    steps = (Stretch(0.0, dt, np.column_stack([a[:-1], np.diff(a) / dt])),)
    spectrum: list[float] = pseudo_acceleration(steps, periods).tolist()
    return [float(np.nan_to_num(found[name])) for name in INTENSITIES] + spectrum
