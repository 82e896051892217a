"""Record maps of bodies with friction, apart from those without so that these do not wait for its compiler."""

from __future__ import annotations

from rockcli.kernels.ahead import MATRIX, VECTOR
from rockcli.kernels.constants import MAX_ORDER
from rockcli.kernels.contact import workspace as contact
from rockcli.kernels.jit import entry, rows
from rockcli.kernels.lanes.records import slips
from rockcli.kernels.lanes.records import state as lane
from rockcli.kernels.lanes.records.march import in_lanes
from rockcli.kernels.lanes.vector.plain import room
from rockcli.kernels.rigid.settings import Settings


def work_space_of_slips():
    """Work space of `march_slipping` for bodies that slip: state, series, cases that are to go on in lanes."""
    return room(slips.STATE), room(slips.SERIES), room(lane.LANES)


def work_space_of_feet():
    """The same of the kernel of contact, and the histories that it does not write."""
    return rows(contact.N_ROWS, MAX_ORDER + 2), rows(6, 0)


@entry(
    MATRIX, MATRIX, Settings, VECTOR, VECTOR, VECTOR, VECTOR, MATRIX, MATRIX, MATRIX, (VECTOR,) * 11, MATRIX, MATRIX,
    (VECTOR,) * 3, MATRIX, MATRIX, MATRIX,
)  # fmt: skip
def march_slipping(
    pars, bodies, how, values, slopes, blocks, tail, velocity, spans, starts, work, out, feet, slip_work, foot_work,
    nothing, felt,
):  # fmt: skip
    """`in_lanes` of bodies that slip on in lanes, on two equal edges."""
    in_lanes(
        pars, bodies, how, values, slopes, blocks, tail, velocity, spans, False, True, starts, work, out, feet,
        slip_work, foot_work, nothing, felt, None,
    )  # fmt: skip
