"""What overturns the bodies of a study's meshes, by direction, and the direction in which they rock."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rockcli.analysis.over_bodies import Array, over_bodies
from rockcli.scene.body.block import RIGHT, Block
from rockcli.scene.body.scan import DIRECTIONS
from rockcli.scene.variables import AZIMUTH
from rockcli.storage.contents import Contents, variable_field
from rockcli.storage.reduced import reduce
from rockcli.study.study import Study

BARRIER = "barrier"
OF_CASES = ("rocks_towards", "barrier_towards")

_KEYS = frozenset({"mesh"})


def with_barriers(contents: Contents, study: Study) -> Contents:
    """Add what is known of a mesh, where bodies have one.

    `barrier` over `azimuth` and the axes that change the mesh; `rocks_towards` and `barrier_towards` of the cases.

    Raises:
        StudyError, RecordError: a case cannot be built.
    """
    fields = {name: item for name, item in contents.fields.items() if name not in (AZIMUTH, BARRIER, *OF_CASES)}
    found = over_bodies(study, _KEYS, _barriers)
    if found is not None:
        dims, values = found
        azimuth = np.arange(DIRECTIONS) * 2.0 * np.pi / DIRECTIONS
        fields[AZIMUTH] = replace(variable_field(AZIMUTH, (AZIMUTH,), azimuth), coordinate=True)
        fields[BARRIER] = variable_field(BARRIER, (*dims, AZIMUTH), values)
        towards = over_bodies(study, _KEYS, _directions)
        if towards is not None:
            for column, name in enumerate(OF_CASES):
                fields[name] = variable_field(name, *reduce(towards[1][..., column], towards[0]))
    return Contents(contents.axes, fields, contents.attrs)


def _barriers(block: Block) -> list[Array] | None:
    return None if block.scan is None else [block.scan.barriers] * block.size


def _directions(block: Block) -> list[Array] | None:
    if block.scan is None or block.direction is None:
        return None
    scan = block.scan
    return [np.array([each, scan.profile(each).barriers[RIGHT]]) for each in block.direction.tolist()]
