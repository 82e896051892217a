"""Record maps with a vertical component, apart from those without so that these do not pay for it."""

from __future__ import annotations

from rockcli.kernels.ahead import MATRIX, VECTOR
from rockcli.kernels.jit import entry
from rockcli.kernels.lanes.records.march import in_lanes
from rockcli.kernels.rigid.settings import Settings


@entry(
    MATRIX, Settings, VECTOR, VECTOR, VECTOR, VECTOR, MATRIX, MATRIX, bool, (VECTOR,) * 4, MATRIX, MATRIX,
    (VECTOR,) * 11, MATRIX,
)  # fmt: skip
def march_vertical(
    pars, how, values, slopes, blocks, tail, velocity, spans, two_sided, heave, bodies, starts, work, out
):
    """`in_lanes` of bodies without friction under two components: no `bodies`, no `starts`.

    heave: values, slopes, blocks and tail of the vertical one, below g; linear bodies without forces.
    """
    in_lanes(
        pars, bodies, how, values, slopes, blocks, tail, velocity, spans, two_sided, False, starts, work, out, None,
        None, None, None, None, heave,
    )  # fmt: skip
