"""Bodies that roll over the vertices of an outline: closed forms, the limit of two edges, losses, rests, errors."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

import rockcli
from rockcli.engine.preview import preview
from rockcli.errors import StudyError
from rockcli.scene.response import NO_UPLIFT, OVERTURNED_AFTER_IMPACT, ROCKING, SLIDING, UNRESOLVED
from rockcli.solvers.event.solver import solve
from rockcli.solvers.rolling.solver import solve as solve_rolling
from rockcli.study.open import open_study


def batch_of(case, **more):
    ((_, batch),) = open_study({"name": "a", "case": case, **more}).batches()
    return batch


def ngon(k, R=1.0):
    angle = 2 * np.pi * (np.arange(k) + 0.5) / k - np.pi / 2
    return np.column_stack([R * np.cos(angle), R * np.sin(angle)]).tolist()


def half_disc(k):
    """Of radius 1 on the middle one of k (odd) sides, with the centre of mass and the inertia of the round one."""
    angle = np.pi * np.arange(k + 1) / k - np.pi
    return {
        "outline": np.column_stack([np.cos(angle), np.sin(angle)]).tolist(),
        "centre": [0.0, -4 / (3 * np.pi)],
        "r_g": np.sqrt(0.5 - (4 / (3 * np.pi)) ** 2),
    }


MOTIONS = (
    {"pulse": {"shape": "ricker", "a_p": "2.6*g*tan_alpha", "T_p": 0.9}},
    {"pulse": {"shape": "sine", "a_p": "3*g*tan_alpha", "T_p": 0.6}, "vertical": {"pulse": {"shape": "sine", "a_p": "0.3*g", "T_p": 0.4}}},
    {"pulse": {"shape": "cosine", "a_p": "6*g*tan_alpha", "T_p": 1.5}},
)  # fmt: skip


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("block", [{"width": 0.5, "height": 2.0}, {"b": [0.2, 0.3], "h": 0.9}])
def test_of_two_vertices_it_is_the_body_on_two_edges(block, motion):
    batch = batch_of({"block": block, "motion": motion})
    h, (left, right) = batch.block.h[0], batch.block.b[0]
    vertices = np.array([[[-left, -h], [right, -h]]])
    ours = solve_rolling(
        replace(batch, block=replace(batch.block, vertices=vertices), damping=replace(batch.damping, loss=np.ones(1)))
    )
    theirs = solve(batch)
    for name in ("theta_peak", "theta_peak_over_alpha", "t_peak", "t_uplift", "t_overturn", "theta_dot_peak", "mu_required",
                 "mu_impact", "N_min_over_mg", "outcome", "overturn_share"):  # fmt: skip
        np.testing.assert_allclose(ours.scalars[name], theirs.scalars[name], rtol=1e-10, err_msg=name)
    last = min(len(ours.time), len(theirs.time))
    for name in ("theta", "M_base"):
        np.testing.assert_allclose(
            ours.histories[name][0, :last], theirs.histories[name][0, :last], atol=1e-9, err_msg=name
        )


def test_vertices_beyond_reach_change_nothing():
    """The same base with a side that is never touched, by the present kernels and by these."""
    flat = {"outline": [[-0.25, 0], [0.25, 0], [0.2, 2], [-0.2, 2]], "centre": [0, 0.9], "r_g": 0.6}
    wide = flat | {"outline": [[-0.25, 0], [0.25, 0], [0.6, 0.8], [0.2, 2], [-0.2, 2], [-0.6, 0.8]]}
    one, two = (batch_of({"block": block, "motion": MOTIONS[0]}) for block in (flat, wide))
    assert not one.block.rolls.any()
    assert two.block.rolls.all()
    np.testing.assert_allclose(solve(two).scalars["theta_peak"], solve(one).scalars["theta_peak"], rtol=1e-11)


@pytest.mark.parametrize("k", [6, 12, 30])
def test_a_regular_polygon_loses_at_a_vertex_what_the_closed_form_says(k):
    """A solid polygon: k_G^2 = R^2 (2 + cos(2 pi/k))/6, about a vertex R^2 more; r_i . r_j = R^2 cos(2 pi/k)."""
    c = np.cos(2 * np.pi / k)
    eta = ((2 + c) / 6 + c) / ((2 + c) / 6 + 1)
    dataset = rockcli.run(
        {"name": "a", "case": {"block": {"outline": ngon(k)}, "initial": {"theta_dot": 2.5}}, "plots": []}
    )
    before, after = dataset.theta_dot_before.values, dataset.theta_dot_after.values
    assert len(before) >= 1
    np.testing.assert_allclose(after / before, eta, rtol=1e-11)


def test_loss_and_eta_are_powers_of_it():
    c = np.cos(2 * np.pi / 12)
    eta = ((2 + c) / 6 + c) / ((2 + c) / 6 + 1)
    for damping, expected in (({"loss": 0.5}, eta**0.5), ({"eta": 0.97}, 0.97), ({"r_energy": 0.81}, 0.9)):
        case = {
            "block": {"outline": ngon(12)},
            "initial": {"theta_dot": 2.5},
            "damping": {"scheme": "restitution", **damping},
        }
        dataset = rockcli.run({"name": "a", "case": case, "plots": []})
        np.testing.assert_allclose(dataset.theta_dot_after / dataset.theta_dot_before, expected, rtol=1e-11)


def test_loss_of_a_body_on_two_edges():
    for block in ({"R": 2.0, "tan_alpha": 0.2}, {"b": [0.2, 0.3], "h": 0.9}):
        eta = batch_of({"block": block, "initial": {"theta": 0.05}}).damping.eta
        case = {"block": block, "initial": {"theta": 0.05}, "damping": {"scheme": "restitution", "loss": 2}}
        np.testing.assert_allclose(batch_of(case).damping.eta.prod(), eta.prod() ** 2, rtol=1e-14)


def exact_half_period(theta_0, g=9.81):
    """Of a half-disc of radius 1 that rolls: 1/2 [k^2 + 1 + e^2 - 2 e cos] theta'^2 - g e cos(theta) is kept."""
    e = 4 / (3 * np.pi)
    k2 = 0.5 - e * e

    def slowness(phi):  # sin(theta/2) = sin(theta_0/2) sin(phi) takes the singular end away
        theta = 2 * np.arcsin(np.sin(theta_0 / 2) * np.sin(phi))
        return np.sqrt((k2 + 1 + e * e - 2 * e * np.cos(theta)) / (g * e)) / np.cos(theta / 2)

    return 2 * quad(slowness, 0, np.pi / 2, epsabs=1e-13)[0]


def half_period(k, m):
    """Of the polygon of k sides let go between its sides m - 1 and m, without loss."""
    theta_0 = (m - 0.5) * np.pi / k
    case = {"block": half_disc(k), "initial": {"theta": theta_0}, "damping": "none", "motion": {"duration": 6.0}}
    t = rockcli.run({"name": "a", "case": case, "plots": []}).t_impact.values
    return theta_0, t[3 * m - 2] - t[m - 1]


def test_a_half_disc_rolls_with_its_period_as_its_sides_grow_in_number():
    errors = []
    for k in (11, 33, 99):
        theta_0, period = half_period(k, (k + 3) // 4 if k != 99 else 25)
        errors.append(abs(period / exact_half_period(theta_0) - 1))
    orders = np.log(np.array(errors[:-1]) / errors[1:]) / np.log(3)
    assert errors[-1] < 2e-3
    # sides count in pairs, but for the last one on the way, where the body tarries in proportion to its root
    assert (orders > 1.3).all(), (errors, orders)


def test_a_lossless_body_keeps_its_energy():
    case = {"block": half_disc(21), "initial": {"theta": 0.5}, "damping": "none", "motion": {"duration": 20.0}}
    dataset = rockcli.run({"name": "a", "case": case, "plots": []})
    assert abs(float(dataset.energy_residual)) < 1e-9
    assert np.isnan(float(dataset.residual_tilt))
    assert int(dataset.outcome) == ROCKING


def test_a_rest_on_another_side_is_told():
    study = {"name": "a", "case": {"block": {"outline": ngon(12)}, "initial": {"theta_dot": 0.72}}, "plots": []}
    dataset = rockcli.run(study)
    tilt = float(dataset.residual_tilt)
    assert tilt == pytest.approx(np.pi / 6, rel=1e-12)
    assert int(dataset.outcome) == ROCKING
    reason = str(dataset.reasons.values[int(dataset.reason)])
    assert "another facet" in reason
    # the report ends 20/p after the motion, when it still bounces there
    assert dataset.theta.values[np.isfinite(dataset.theta.values)][-1] == pytest.approx(tilt, abs=0.01)


def test_a_push_of_just_enough_passes_the_last_barrier():
    """A hexagon's first barrier is its last: energy with the loss at none says at which rate."""
    k = 6
    outline = ngon(k)
    r_g2 = (2 + np.cos(2 * np.pi / k)) / 6
    needed = np.sqrt(2 * 9.81 * (1 - np.cos(np.pi / k)) / (r_g2 + 1))

    # the hexagon turns on its right vertex at once, so nothing is lost before the first barrier at 30 degrees
    def fate(rate):
        case = {"block": {"outline": outline}, "initial": {"theta_dot": rate}}
        return batch_of(case)

    below, above = (solve(fate(needed * factor)).scalars for factor in (1 - 1e-9, 1 + 1e-9))
    assert below["residual_tilt"][0] == 0.0
    assert above["outcome"][0] == OVERTURNED_AFTER_IMPACT  # of the facets it rolls over


def test_friction_that_does_not_hold_leaves_it_unresolved():
    block = {"outline": ngon(12), "mu": 0.2}
    batch = batch_of({"block": block, "motion": {"pulse": {"shape": "ricker", "a_p": "3*g*tan_alpha", "T_p": 0.7}}})
    response = solve(replace(batch, block=replace(batch.block, mu=np.array([0.3]))))
    assert response.scalars["outcome"][0] == UNRESOLVED
    assert "would slide" in response.reasons[0]
    assert "not solved for a body that rolls over several vertices (block.stands: toes" in response.reasons[0]


@pytest.mark.parametrize("damping", ["restitution", "none"])
def test_a_body_that_slides_flat_ends_on_its_stand(damping):
    """Beside one on its two edges alone: no rotation to either side, none left."""
    outline = [[-0.3, 0.1], [-0.2, 0.0], [0.2, 0.0], [0.3, 0.1], [0.3, 2.0], [-0.3, 2.0]]
    motion = {"pulse": {"shape": "sine", "a_p": 3.0, "T_p": 0.5}}
    study = {
        "name": "a",
        "case": {"block": {"outline": outline, "mu": 0.1}, "motion": motion, "damping": damping},
        "vary": {"block.stands": ["outline", "toes"], "motion.pulse.a_p": [0.3, 3.0]},
        "plots": [],
    }
    dataset = rockcli.run(study)
    assert dataset.outcome.values.tolist() == [[NO_UPLIFT, SLIDING]] * 2
    assert (dataset.residual_tilt.values == 0.0).all()
    for side in (dataset.theta_peak_left, dataset.theta_peak_right):  # of two like edges there is but one number
        assert (side.values[0] == 0.0).all()
        assert np.isnan(side.values[1]).all()


def test_a_suite_says_of_which_body_answers_are_missing_and_why():
    bodies = {"stout": {"height": 1, "width": 0.8, "mu": 0.4}, "round": {"outline": ngon(12), "mu": 0.3}}
    study = {
        "name": "a",
        "case": {"block": {"height": 1, "width": 0.8}, "motion": MOTIONS[0]},
        "vary": {
            "block": bodies,
            "motion.pulse.T_p": [0.5, 0.7],
            "motion.pulse.a_p": {"from": "0.1*g", "to": "1.5*g", "n": 6},
        },
        "over": {"axis": "T_p", "along": "a_p"},
        "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]},
    }
    data = rockcli.run(study)
    missing = int((data.outcome.sel(block="round") == UNRESOLVED).sum())
    assert missing
    assert int((data.outcome == UNRESOLVED).sum()) == missing
    said = json.loads(data.attrs["warnings"])
    assert any("not followed where it would slide" in one for one in said)
    assert any(f"{missing} of 24 cases have no answer" in one for one in said)
    assert any(f"most at block=round: {missing} of 12)" in one for one in said)
    assert any("no case exceeds it, so the range is too low, or bodies slide and do not rock" in one for one in said)
    study["vary"]["block"]["round"]["stands"] = "toes"
    assert not any("not followed" in one for one in json.loads(rockcli.run(study).attrs["warnings"]))


def test_a_check_says_where_it_rests_and_falls():
    """A regular twelve-sided body: sides every 30 degrees, barriers at 15, 45 and 75 degrees, all R (1 - cos 15 deg)."""
    study = {"name": "a", "case": {"block": {"outline": ngon(12), "mu": 0.5}, "motion": MOTIONS[0]}}
    told = {row.key: row.value for row in preview(open_study(study)).body}
    assert told["vertices"] == 6  # at 15, 45, ... 165 degrees below the level of its middle
    assert told["rests_deg"] == "-60, -30, 0, 30, 60"
    assert (told["fall_deg_left"], told["fall_deg_right"]) == pytest.approx((-75.0, 75.0))
    barrier = 1.0 - np.cos(np.deg2rad(15.0))
    assert (told["barrier_left"], told["barrier_right"]) == pytest.approx((barrier, barrier))
    assert "unresolved" in told["sliding"]
    study["case"]["block"]["stands"] = "toes"
    assert not {"vertices", "sliding"} & {row.key for row in preview(open_study(study)).body}


def test_a_batch_of_both_kinds():
    study = {
        "name": "a",
        "let": {"w": 0.5},
        "case": {
            "block": {"outline": [[-0.25, 0], [0.25, 0], ["w/2", 0.5], [0.2, 2], [-0.2, 2], ["-w/2", 0.5]]},
            "motion": MOTIONS[0],
        },
        "vary": {"let.w": [0.5, 0.52, 0.6]},
        "plots": [],
    }
    dataset = rockcli.run(study)
    assert (dataset.outcome.values >= 0).all()
    one = rockcli.run({**study, "let": {"w": 0.5}, "vary": {"let.w": [0.5]}})
    np.testing.assert_array_equal(dataset.theta.values[0], np.pad(one.theta.values[0], (0, len(dataset.time) - len(one.time)), constant_values=np.nan))  # fmt: skip


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"model": "linearized"}, r"case\.model: is linearized, which knows but two edges"),
        ({"damping": "dashpot"}, r"case\.damping.*dashpot, instead of restitution or none"),
        ({"solver": {"backend": "scipy"}}, r"case\.solver\.backend: is scipy"),
        ({"damping": {"scheme": "restitution", "loss": 1, "eta": 0.9}}, "say the same thing"),
        ({"initial": {"slide_rate": 0.1}}, r"case\.initial\.slide_rate: is a velocity of a body that rolls"),
    ],
)
def test_what_knows_two_edges_only_is_refused(more, words):
    with pytest.raises(StudyError, match=words):
        batch_of({"block": {"outline": ngon(12)}, "motion": MOTIONS[0], **more})


def test_figures_show_the_body_on_the_ground_as_it_rolls():
    from rockcli.plotting.common.shape import body_of, outline

    study = {"name": "a", "case": {"block": {"outline": ngon(12)}, "initial": {"theta_dot": 0.9}}}
    for stands, rolls in (("outline", True), ("toes", False)):
        study["case"]["block"]["stands"] = stands
        body = body_of(rockcli.run({**study, "plots": []}), ())
        assert (body.vertices is not None) == rolls
        if rolls:
            for theta in np.linspace(-1.5, 1.5, 61):
                points = outline(body, float(theta))
                assert abs(points[:, 1].min()) < 1e-12
                # a regular polygon has its middle that far from its lowest vertex, and rolls along its circle or less
                assert abs(points.mean(axis=0)[0]) <= abs(theta) + 0.3
