"""The `score` of a study file: with which experiments it is compared, and how."""

from __future__ import annotations

from pathlib import Path

from rockcli.errors import StudyError
from rockcli.study.document.check import check_with_base
from rockcli.study.document.loader import load_file
from rockcli.study.document.shorthands import expanded
from rockcli.study.document.tree import Map, Source
from rockcli.study.schema import ScorePart


def read_score(study: Path) -> ScorePart:
    """What a study file says under `score`; files in it stand beside the study.

    Raises:
        StudyError: it says nothing there, or is wrong.
    """
    tree = expanded(load_file(study))
    source = Source(study)
    said = check_with_base(source, tree).score if isinstance(tree.get("case"), Map) else None
    if said is None:
        raise StudyError("expected RUNS.csv too, or `score: {file: RUNS.csv}` in the study", file=study)
    beside = {key: str(study.parent / name) for key in ("file", "calibration") if (name := getattr(said, key))}
    return said.model_copy(update=beside)
