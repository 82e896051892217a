"""Provenance of a dataset: versions, inputs, settings, and when."""

from __future__ import annotations

import json
import platform
import re
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, distribution
from typing import Any

from rockcli.engine.sweep.results import Results
from rockcli.storage.contents import root_attributes
from rockcli.study.study import Study
from rockcli.version import __version__

_VERSION = re.compile(r"^Version: *(\S+)", re.M)

_LIBRARIES = ("numpy", "scipy", "numba", "obspy", "netCDF4")


def attributes(study: Study, results: Results) -> dict[str, str]:
    """Root attributes of a fresh dataset; only `history` and `date_created` differ from run to run."""
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    more = {
        "study": study.resolved_yaml,
        "case": as_json(study.case),
        "varied": as_json(study.varied),
        "study_name": study.name,
        "identity": study.identity,
        "sweep_id": study.sweep_id,
        "compare_to": as_json(study.compare_to),
        "inputs": as_json(study.inputs),
        "processing": as_json({name: list(steps) for name, steps in study.processing.items()}),
        "backends": ", ".join(sorted({used["backend"] for used in results.used if "backend" in used})),
        "solver_settings": as_json(results.used),
        "warnings": as_json([*study.warnings, *results.warnings]),
        "versions": as_json(versions()),
        "date_created": now,
    }
    return root_attributes(
        title=study.title or study.name,
        source=f"rockcli {__version__}",
        history=f"{now} solved by rockcli {__version__}",
        references=study.references,
        more=more,
    )


def refreshed(attrs: dict[str, str], study: Study) -> dict[str, str]:
    """Attributes of an older file of the same identity, with the words the study uses now."""
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    return attrs | {
        "title": study.title or study.name,
        "references": study.references,
        "study": study.resolved_yaml,
        "case": as_json(study.case),
        "varied": as_json(study.varied),
        "compare_to": as_json(study.compare_to),
        "history": f"{attrs['history']}\n{now} described again by rockcli {__version__}",
    }


def versions() -> dict[str, str]:
    """Versions of Python and of the libraries that touch numbers, without importing them."""
    found = {"rockcli": __version__, "python": platform.python_version(), "machine": platform.machine()}
    for name in _LIBRARIES:
        try:
            said = distribution(name).read_text("METADATA") or ""
        except PackageNotFoundError:
            continue
        if match := _VERSION.search(said):  # `version` would parse all of it, licences too, as an e-mail
            found[name] = match[1]
    return found


def as_json(value: Any) -> str:
    """Compact, sorted, readable JSON."""
    return json.dumps(value, ensure_ascii=False, sort_keys=True)
