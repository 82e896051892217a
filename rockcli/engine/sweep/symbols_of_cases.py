"""What is known of cases before they are solved: their symbols and warnings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.measures import peaks
from rockcli.analysis.uplift import factor_of, lifts_at
from rockcli.engine.sweep.chunk_result import Description
from rockcli.engine.sweep.chunk_symbols import Values
from rockcli.engine.sweep.chunks import CHUNK, Chunks
from rockcli.engine.sweep.results import Results
from rockcli.engine.sweep.symbols import Symbols
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.ground.excitation import Pulses, Samples, codes_of_motions
from rockcli.scene.variables import LARGE, MOTION, OF_SOURCE
from rockcli.study.cases.buildable import buildable
from rockcli.study.schema import OUTLINES
from rockcli.study.study import Index, Study

SIDES = ((LEFT, "left"), (RIGHT, "right"))


def describe_cases(study: Study) -> Results:
    """What is known of the cases without solving them: their symbols and warnings."""
    with np.errstate(all="ignore"):
        results = Results.of(study, symbols_of(study), solved=False)
        describe_rest(study, results, None)
        return results


def describe_rest(study: Study, results: Results, which: NDArray[np.bool_] | None) -> None:
    """Add the symbols and warnings of some cases to results; None = of all."""
    chunks = Chunks(study.size, which)
    while chunks.left:
        cases = chunks.take(CHUNK)
        built = list(buildable(study.suites, cases))
        results.describe(describe(study, built))


def describe(study: Study, built: list[tuple[Index, Batch]]) -> Description:
    """Symbols and warnings of the batches of a chunk."""
    parts = [part for part, _ in built]
    cases = np.sort(np.concatenate(parts)) if len(parts) > 1 else parts[0] if parts else np.empty(0, dtype=np.int64)
    found = Description(cases, {}, [])
    symbols: dict[str, Any] = {}
    edges = study.size <= LARGE and _may_be_asymmetric(study.resolved)
    for part, batch in built:
        block, motion = batch.block, batch.excitation.horizontal
        symmetric = bool(block.symmetric.all())
        both = {"R": block.R, "alpha": block.alpha, "p": batch.p, "eta": batch.damping.eta}
        values = {name: of[:, LEFT] if symmetric else block.of_weak_edge(of) for name, of in both.items()}
        if edges:
            values |= {f"{name}_{side}": of[:, at] for name, of in both.items() for at, side in SIDES}
        if edges and not symmetric:
            values["pga_uplift"] = lifts_at(batch)
        values |= {"g": batch.g, "uplift_factor": factor_of(batch)}
        if isinstance(motion, Pulses):
            values |= {"a_p": motion.a_p, "omega_p": motion.omega_p}
        if isinstance(motion, Samples):
            known = {name: motion.measures[name] for name in OF_SOURCE if name in motion.measures}
            values |= {name: np.full(batch.size, value) for name, value in known.items()}
        if (suite := batch.excitation.suite) is not None:
            values |= {name: said for name in OF_SOURCE if not np.isnan(said := suite.measure(name)).all()}
        if study.size <= LARGE:
            values["pga"], values["pgv"] = (
                peaks(motion, batch.size, batch.excitation.duration)
                if suite is None
                else (np.abs(suite.factor) * suite.measure(name) for name in ("pga", "pgv"))
            )
        if study.histories:
            values[MOTION] = codes_of_motions(batch.excitation, batch.size)
        if len(built) == 1:
            symbols = values
            break
        rows = rows_of(cases, part)
        for name, of_batch in values.items():
            if name not in symbols:
                symbols[name] = np.full(len(cases), np.nan)
            symbols[name][rows] = of_batch
    for _, batch in built:
        found.has_mass &= bool(np.isfinite(batch.block.mass).all())
        found.symmetric &= bool(batch.block.symmetric.all())
        found.warnings += [sentence for sentence in batch.warnings if sentence not in found.warnings]
    for name, values_of in symbols.items():
        first = values_of[0]
        same = bool((values_of == first).all()) or bool(np.isnan(values_of).all())
        found.symbols[name] = float(first) if same else values_of
    return found


def symbols_of(study: Study, folder: Path | None = None) -> Symbols:
    """Where the symbols of a study are collected; `folder`: where what is too large for memory lies."""

    def look(cases: Index) -> Values:
        built = list(buildable(study.suites, cases))
        return describe(study, built).symbols

    return Symbols(study.shape, look, folder)


def _may_be_asymmetric(resolved: dict[str, Any]) -> bool:
    """Whether a study speaks of an outline or a mesh, of two distances b, or of a file or a setting that may."""
    case = resolved.get("case") or {}
    block = case.get("block") or {}
    varied = " ".join(resolved.get("vary") or {})
    by_itself = not block.keys().isdisjoint(OUTLINES) or isinstance(block.get("b"), list)
    return by_itself or "block" in varied or "case" in varied


def rows_of(cases: Index, part: Index) -> Any:
    """Where some of the cases stand among all of a chunk."""
    return slice(None) if len(part) == len(cases) else np.searchsorted(cases, part)
