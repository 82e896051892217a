"""The outlines of a study's bodies, kept in its dataset so that figures and animations can draw them."""

from __future__ import annotations

from rockcli.analysis.over_bodies import over_bodies
from rockcli.scene.variables import OUTLINE
from rockcli.storage.contents import Contents, variable_field
from rockcli.study.schema import OUTLINES
from rockcli.study.study import Study

NAMES = ("outline_x", "outline_z")


def with_outlines(contents: Contents, study: Study) -> Contents:
    """Add `outline_x` and `outline_z` over the axes that change the body and `outline_point`, where bodies have any.

    Raises:
        StudyError, RecordError: a case cannot be built.
    """
    fields = {name: item for name, item in contents.fields.items() if name not in NAMES}
    found = over_bodies(study, frozenset(OUTLINES), lambda block: block.outline)
    if found is not None:
        dims, points = found
        for column, name in enumerate(NAMES):
            fields[name] = variable_field(name, (*dims, OUTLINE), points[..., column])
    return Contents(contents.axes, fields, contents.attrs)
