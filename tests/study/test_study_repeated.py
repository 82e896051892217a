"""What no case of a batch varies is kept, and computed, once; every case has the bits it has by itself."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest
import yaml

from rockcli.scene.batch import Batch
from rockcli.scene.repeated import is_repeated
from rockcli.solvers.event.solver import solve
from rockcli.study.open import open_study

AMPLITUDE = "motion.pulse.a_p_over_g_tan_alpha"
BODIES = [
    {"R": 2, "tan_alpha": 0.2},
    {"R": 2, "alpha": 0.2},
    {"h": 1.5, "b": 0.3, "mu": 0.3},
    {"slenderness": 5, "height": 3, "mass": 100},
    {"h": 1.5, "b": [0.2, 0.3]},
]
DAMPINGS = [{"scheme": "none"}, {"scheme": "restitution"}, {"scheme": "restitution", "eta": 0.9}, {"scheme": "dashpot"}]


def batch_of(tmp_path, block, damping, vary) -> Batch:
    pulse = {"shape": "sine", "omega_p_over_p": 2, "a_p_over_g_tan_alpha": 2}
    study = {"name": "s", "case": {"block": block, "damping": damping, "motion": {"pulse": pulse}}, "vary": vary}
    (tmp_path / "s.yaml").write_text(yaml.safe_dump(study))
    opened = open_study(tmp_path / "s.yaml")
    ((_, batch),) = opened.suites(np.arange(opened.size))
    return batch


def written_out(value):
    """With an array of its own for every row."""
    if isinstance(value, np.ndarray):
        return np.array(value)
    if not is_dataclass(value):
        return value
    return replace(value, **{f.name: written_out(getattr(value, f.name)) for f in fields(value)})


@pytest.mark.parametrize("damping", DAMPINGS, ids=lambda d: "-".join(map(str, d.values())))
@pytest.mark.parametrize("block", BODIES, ids=lambda b: "-".join(b))
def test_the_bits_are_those_of_rows_that_are_written_out(tmp_path, block, damping):
    batch = batch_of(tmp_path, block, damping, {AMPLITUDE: {"from": 0.9, "to": 8, "n": 9}})
    one, other = (
        solve(batch),
        solve(replace(batch, **{f.name: written_out(getattr(batch, f.name)) for f in fields(batch)})),
    )
    for name in one.scalars.keys() - {"wall_time"}:
        np.testing.assert_array_equal(one.scalars[name], other.scalars[name], err_msg=name)


def test_one_body_is_one_row(tmp_path):
    batch = batch_of(tmp_path, BODIES[0], {"scheme": "restitution"}, {AMPLITUDE: {"from": 0.9, "to": 8, "n": 9}})
    assert all(map(is_repeated, (batch.block.alpha, batch.block.R, batch.p, batch.damping.eta, batch.g, batch.theta_0)))
    np.testing.assert_array_equal(batch.block.alpha, np.full((9, 2), np.arctan(0.2)))


@pytest.mark.parametrize("axis", ["block.R", "block.tan_alpha", "g"])
def test_bodies_that_differ_are_rows_of_their_own(tmp_path, axis):
    batch = batch_of(tmp_path, BODIES[0], {"scheme": "restitution"}, {axis: [0.1, 0.2, 0.3]})
    given = {"block.R": batch.block.R[:, 0], "block.tan_alpha": batch.block.tan_alpha[:, 1], "g": batch.g}
    np.testing.assert_array_equal(given[axis], [0.1, 0.2, 0.3])
    p = np.sqrt(0.75 * batch.g / batch.block.R[:, 0])
    np.testing.assert_allclose(batch.p[:, 0], p, rtol=1e-14)
    assert len(np.unique(batch.p[:, 0])) == (1 if axis == "block.tan_alpha" else 3)
