"""The mesh and its deck, without CalculiX."""

from __future__ import annotations

import numpy as np
import pytest
from mesh_cases import fig60, mesh_batch
from scenes import pulse, record, still
from scipy.integrate import trapezoid

import rockcli
from rockcli.errors import StudyError
from rockcli.scene.body.block import make_block
from rockcli.solvers.calculix.case import Refused, breakpoints, prepare
from rockcli.solvers.calculix.mesh import make_mesh
from rockcli.solvers.common.ground import ground_of_case


def test_bricks_fill_the_body_and_are_not_inside_out():
    mesh = make_mesh(50.0, 5.0, 4, 40)
    a, b, d, e = (mesh.nodes[mesh.bricks[:, i]] for i in (0, 1, 3, 4))
    volumes = np.einsum("ij,ij->i", np.cross(b - a, d - a), e - a)
    assert (volumes > 0.0).all()
    assert volumes.sum() == pytest.approx(50.0 * 5.0 * mesh.depth, rel=1e-12)
    assert len(np.unique(mesh.bricks)) == len(mesh.nodes) == 2 * mesh.layer


def test_base_and_top_are_where_they_should_be():
    mesh = make_mesh(8.0, 2.0, 3, 5)
    np.testing.assert_allclose(
        mesh.nodes[mesh.base], [[-1, 0, 0], [-1 / 3, 0, 0], [1 / 3, 0, 0], [1, 0, 0]], atol=1e-15
    )
    np.testing.assert_allclose(mesh.nodes[mesh.top], [[-1, 8, 0], [1, 8, 0]])
    assert mesh.share.sum() == pytest.approx(2.0)
    np.testing.assert_allclose(mesh.nodes[mesh.layer :] - mesh.nodes[: mesh.layer], [[0, 0, mesh.depth]] * mesh.layer)


def test_struts_are_as_stiff_as_the_base():
    deck = prepare(mesh_batch(still(1.0), kw=3e11), 0).deck
    upright = 2.0 * deck.strut.sum() * np.cos(np.pi / 4.0) ** 2
    assert upright == pytest.approx(3e11 * 5.0 * deck.mesh.depth, rel=1e-12)
    assert deck.mass == pytest.approx(2500.0 * 50.0 * 5.0 * deck.mesh.depth)


def test_a_rigid_base_scales_with_the_body():
    one, ten = (prepare(mesh_batch(still(1.0), h=h, E=E), 0).deck for h, E in ((25.0, 30e9), (250.0, 300e9)))
    for deck in (one, ten):
        sinks = deck.rho * deck.g * deck.mesh.nodes[:, 1].max() / deck.kw / deck.mesh.share.sum()
        assert sinks == pytest.approx(2500.0 * 9.81 * 50.0 / (100.0 * 30e9 / 2.5) / 5.0, rel=1e-12)


def test_deck_asks_for_what_was_said():
    text = prepare(fig60(duration=2.0, zeta=0.01, scheme="hht", alpha_d=0.8, dt=0.004), 0).deck.text()
    T_1 = 12.3809 * np.sqrt(2500.0 / 30e9) * 25.0 / 0.1
    assert f"*DAMPING, ALPHA=0., BETA={0.01 * T_1 / np.pi:.6g}"[:34] in text
    assert "*DYNAMIC, ALPHA=-0.2" in text
    assert "0.0004, 2, 4e-10, 0.004" in text
    assert text.count("*GAP") == 2 * 3
    assert "*DAMPING" not in prepare(fig60(duration=2.0), 0).deck.text()


def test_amplitudes_have_opposite_signs_of_the_ground():
    deck = prepare(fig60(duration=2.0), 0).deck
    lines = deck.text().splitlines()
    start = lines.index("*AMPLITUDE, NAME=ACROSS") + 1
    table = np.array([[float(x) for x in line.split(",")] for line in lines[start : start + len(deck.t)]])
    np.testing.assert_allclose(table[:, 1], -deck.a_g, rtol=1e-12, atol=1e-14)
    assert deck.a_g.max() == pytest.approx(4.905, rel=1e-4)


def test_numbers_keep_their_exponents():
    """CalculiX reads 20 characters of a number: the middle of this mesh, and the motion, would be off by 1e16 and 1e5."""
    motion = record(np.full(3, 1.23456789012345e-05), 0.5, duration=1.0)
    batch = mesh_batch(motion, across=6, along=1, h=39.75, tan_alpha=0.1, theta_0=-1.23456789012345e-05)
    deck = prepare(batch, 0).deck
    assert deck.mesh.x_base[3] == -4.440892098500626e-16
    fields = [field.strip() for line in deck.text().splitlines() for field in line.split(",")]
    assert max(len(field) for field in fields if field.startswith("-")) <= 20


def test_jumps_have_a_time_on_each_side():
    batch = mesh_batch(pulse("rectangular", 2.0, np.pi, duration=3.0))  # T_p = 2 s: on for 1 s
    t = breakpoints(batch, 0, 3.0, 0.01)
    a, _ = ground_of_case(batch, 0, t)
    jump = int(np.argmax(np.abs(np.diff(a))))
    assert t[jump] == pytest.approx(1.0, abs=1e-7)
    assert t[jump + 1] - t[jump] < 1e-7
    assert trapezoid(a, t) == pytest.approx(2.0, rel=1e-6)


def test_a_record_is_taken_sample_by_sample():
    values = np.array([0.0, 1.0, -2.0, 0.5])
    batch = mesh_batch(record(values, 0.1, factor=2.0, vertical=0.5 * values, duration=1.0))
    deck = prepare(batch, 0).deck
    np.testing.assert_allclose(
        np.interp([0.05, 0.2, 0.25, 0.31, 0.9], deck.t, deck.a_g), [1, -4, -1.5, 0, 0], atol=1e-6
    )
    np.testing.assert_allclose(np.interp([0.2], deck.t, deck.a_v), [-1.0], atol=1e-6)


def test_an_initial_rotation_is_held_and_let_go():
    text = prepare(mesh_batch(still(1.0), theta_0=-0.03), 0).deck.text()
    assert text.count("*STATIC") == 2
    assert f"{5.0 * np.sin(-0.03):.10g}"[:12] in text
    dynamic = text[text.index("*DYNAMIC") :]
    assert "*BOUNDARY, OP=NEW" in dynamic
    assert "HANDLE" not in dynamic


@pytest.mark.parametrize(
    ("how", "sentence"),
    [
        ({"E": 1e8}, "buckles under its own weight"),
        ({"E": -1.0}, "must be positive"),
        ({"kw": -2.0}, "positive kw"),
        ({"kw": 1e7}, "too soft to keep the column upright"),
    ],
)
def test_what_is_no_mesh_is_refused(how, sentence):
    with pytest.raises(Refused, match=sentence):
        prepare(mesh_batch(still(1.0), **how), 0)


def test_a_step_that_does_not_see_the_body_vibrate_is_refused():
    period = 12.3809 * np.sqrt(2500.0 / 30e9) * 25.0 / 0.1
    prepare(mesh_batch(still(1.0), dt=period / 8.01), 0)
    with pytest.raises(Refused, match="too long for a body of clamped period"):
        prepare(mesh_batch(still(1.0), dt=period / 7.99), 0)


def test_asymmetric_moving_or_columnless_cases_are_refused():
    from dataclasses import replace

    batch = mesh_batch(still(1.0))
    lopsided = replace(batch, block=make_block(h=25.0, b=[2.0, 3.0]))
    for bad, sentence in (
        (lopsided, "one b"),
        (replace(batch, block=make_block(h=25.0, b=2.5, inertia=1.2)), "rectangle"),
        (replace(batch, theta_dot_0=np.array([0.1])), "from rest"),
        (replace(batch, column=None), "needs a column"),
    ):
        with pytest.raises(Refused, match=sentence):
            prepare(bad, 0)


def test_a_rate_at_the_start_is_refused_before_anything_is_solved():
    case = {
        "block": {"h": 25.0, "b": 2.5},
        "initial": {"theta": 0.01, "theta_dot": 0.1},
        "model": "continuum",
        "column": {"E": 3e10, "rho": 2500.0},
        "damping": "none",
    }
    with pytest.raises(StudyError, match=r"initial\.theta_dot = 0\.1: model continuum starts from rest"):
        rockcli.check({"name": "pushed", "case": case})
    rockcli.check({"name": "let-go", "case": case | {"initial": {"theta": 0.01}}})
