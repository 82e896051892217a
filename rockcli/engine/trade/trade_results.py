"""The dataset of `rock trade`: every setting over every case of the sample, with its error, outcome and cost."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from rockcli.engine.lock import locked
from rockcli.engine.provenance import as_json, versions
from rockcli.engine.trade.measurements import Point, Trade, middle
from rockcli.scene.counted import counted
from rockcli.scene.units import Units, g_of
from rockcli.storage import netcdf
from rockcli.storage.contents import Contents, Field, root_attributes, text, variable_field
from rockcli.study.study import Study
from rockcli.version import __version__

AXES = ("setting", "case")


def trade_path(study: Study, out_dir: Path) -> Path:
    """DIR/<name>-trade/<name>-trade.nc."""
    return out_dir / f"{study.name}-trade" / f"{study.name}-trade.nc"


def write_trade(study: Study, found: Trade, out_dir: Path) -> Path:
    """Write the dataset whole; OutputError if it cannot be written."""
    path = trade_path(study, out_dir)
    with locked(path.parent):
        netcdf.write(contents_of(study, found), path)
    return path


def contents_of(study: Study, found: Trade) -> Contents:
    """Scalars over (setting, case), what they come to over (setting)."""
    points = found.points
    fields = {
        "setting": Field(("setting",), text([p.setting.label for p in points]), {"long_name": "setting"}, True),
        "case": Field(("case",), text(_places(study, found)), {"long_name": "case of the sample"}, True),
    }

    def words(name: str, values: list[str], sentence: str) -> None:
        fields[name] = Field(("setting",), text(values), {"long_name": sentence}, True)

    words("part", [p.setting.part for p in points], "kind of error: of numerics, of the model, of the data")
    words("model", [p.setting.model_word for p in points], "model and geometry")
    words("family", [p.setting.family for p in points], "backend, and its method")
    words("step", [p.setting.step for p in points], "setting within its family")
    words("against", [p.setting.against for p in points], "reference of the error")
    stacked: dict[str, Any] = {
        "outcome": np.array([p.answers.outcome for p in points]),
        "theta_peak_over_alpha": np.array([p.answers.peak for p in points]),
        "error_theta_peak_over_alpha": np.array([p.error for p in points]),
        "same_outcome": np.array([p.same for p in points]),
        "n_steps": np.array([p.answers.steps for p in points]),
        "n_rhs": np.array([p.answers.rhs for p in points]),
    }
    for name, values in stacked.items():
        fields[name] = variable_field(name, AXES, values)
    fields["same_outcome"].attrs["comment"] = "-1: one of both has no outcome"
    for name, numbers in {
        "cost": np.array([p.cost for p in points]),
        "error_median": np.array([p.quantile(0.5) for p in points]),
        "error_p90": np.array([p.quantile(0.9) for p in points]),
        "wrong_outcomes": np.array([p.wrong_share for p in points]),
        "on_front": np.array([p.on_front for p in points], dtype=np.int8),
    }.items():
        fields[name] = variable_field(name, ("setting",), numbers)
    return Contents(AXES, fields, _attributes(study, found))


def _places(study: Study, found: Trade) -> list[str]:
    """Coordinates of every case in words, over the axes that the trade leaves as they are."""
    at = np.unravel_index(found.cases, study.shape) if study.axes else ()
    units = Units(g_of(study.case, {axis.path for axis in study.axes}))
    places = []
    for row in range(len(found.cases)):
        pairs = [(axis, axis.values[int(index[row])]) for axis, index in zip(study.axes, at, strict=True)]
        own = [
            f"{a.name}={units.word(v, a.unit, a.path) if a.numeric else v}"
            for a, v in pairs
            if a.path.split(".")[0] not in ("model", "solver")
        ]
        places.append(", ".join(own) or "the case")
    return places


def _attributes(study: Study, found: Trade) -> dict[str, str]:
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    more = {
        "study": study.resolved_yaml,
        "case": as_json(study.case),
        "study_name": f"{study.name}-trade",
        "identity": f"trade of {study.identity}",
        "inputs": as_json(study.inputs),
        "sample": f"{len(found.cases)} of {counted(found.size, 'case')}",
        "trade_references": json.dumps(found.references),
        "trade_notes": "; ".join(found.notes),
        "skipped": json.dumps(found.skipped, ensure_ascii=False),
        "versions": as_json(versions()),
        "date_created": now,
    }
    return root_attributes(
        title=study.title or study.name,
        source=f"rockcli {__version__}",
        history=f"{now} measured by `rock trade` of rockcli {__version__}",
        references=study.references,
        more=more,
    )


def as_dict(found: Trade, path: Path, drawn: tuple[Path, ...]) -> dict[str, Any]:
    """The summary for `--json`; None where there is no number."""
    return {
        "file": str(path),
        "plots": [str(file) for file in drawn],
        "sample": {"cases": len(found.cases), "of": found.size},
        "references": found.references,
        "notes": found.notes,
        "points": [_point_as_dict(p) for p in found.points],
        "skipped": [{"setting": setting, "why": why} for setting, why in found.skipped],
    }


def _point_as_dict(point: Point) -> dict[str, Any]:
    setting, answers = point.setting, point.answers
    numbers = {
        "median": point.quantile(0.5),
        "p90": point.quantile(0.9),
        "wrong": point.wrong,
        "compared": point.compared,
        "seconds": point.cost,
        "n_steps": middle(answers.steps),
        "n_rhs": middle(answers.rhs),
    }
    return {
        "part": setting.part,
        "model": setting.model_word,
        "family": setting.family,
        "setting": setting.step,
        "against": setting.against,
        **{name: value if np.isfinite(value) else None for name, value in numbers.items()},
        "on_front": point.on_front,
    }
