"""Static curves against printed formulas, geometry and high-precision numbers."""

from __future__ import annotations

import numpy as np
import pytest

from rockcli.scene.body.block import make_block
from rockcli.scene.laws.curves import BLOCK, ENERGY, KINDS, critical_ratio, curves_of, errors_of, variables_of
from rockcli.scene.laws.models import MODELS
from rockcli.scene.variables import VARIABLES

NEGATIVE, AT_R, AT_H = ("1", "negative_stiffness"), ("1", "corotational"), ("3", "corotational")
RATIO = np.linspace(0.0, 1.0, 41)

# 30-digit evaluations of the printed formulas and of a rigid body's turn, rounded; R = 1, theta = ratio alpha.
POINTS = [
    {
        "tan_alpha": 0.1, "ratio": 0.25,
        "u_free_corner": 0.0496436521649694895, "v_free_corner": 0.00434043587789541184,
        "u_pivot_corner": 0.0495818769829297333, "v_pivot_corner": -0.000617751820397561495,
        "F": (0.0748910330270632475, 0.0750776788645895575, 0.0749844285235770204, 0.0751087301482173092),
        "M": (0.0746818929385141688, 0.0745891341839908872, 0.0747127805295340469),
        "M_over": 0.997513963666045866,
    },
    {
        "tan_alpha": 0.1, "ratio": 0.5,
        "u_free_corner": 0.0993800342816783039, "v_free_corner": 0.00744267342961984762,
        "u_pivot_corner": 0.0991329719055844443, "v_pivot_corner": -0.0024706237609385968,
        "F": (0.0498756211208902702, 0.0501243788791097298, 0.0499999227455305589, 0.0502486805037500185),
        "M": (0.0498137018801597616, 0.049690017140839152, 0.0499372330682066914),
        "M_over": 0.995037190209989136,
    },
    {
        "tan_alpha": 0.1, "ratio": 1.0,
        "u_free_corner": 0.199007438041997827, "v_free_corner": 0.00992561958002172867,
        "u_pivot_corner": 0.19801980198019802, "v_pivot_corner": -0.00987636061799807331,
        "F": (0.0, 0.0, 0.0, 0.000498756211208902702),
        "M": (0.0, 0.0, 0.000493818030899903666),
        "M_over": 0.990099009900990099,
    },
    {
        "tan_alpha": 0.2, "ratio": 0.25,
        "u_free_corner": 0.0972193656955300795, "v_free_corner": 0.0169608354738598013,
        "u_pivot_corner": 0.0967418584522134998, "v_pivot_corner": -0.00238753621658289868,
        "F": (0.149137857378654719, 0.150611010978798692, 0.149876694898428732, 0.15085478963237248),
        "M": (0.147506452290418992, 0.14678727273527726, 0.147745205912077282),
        "M_over": 0.990218818726664369,
    },
    {
        "tan_alpha": 0.2, "ratio": 1.0,
        "u_free_corner": 0.392232270276368064, "v_free_corner": 0.0388386486181596808,
        "u_pivot_corner": 0.384615384615384615, "v_pivot_corner": -0.0380844283049172423,
        "F": (0.0, 0.0, 0.0, 0.0039607805437113932),
        "M": (0.0, 0.0, 0.00380844283049172423),
        "M_over": 0.961538461538461538,
    },
]  # fmt: skip

# max |model - block| / block(0) over [0, alpha], on a grid of 200 000 points of the printed formulas.
# tan alpha: (2.22), (2.23), (2.24), (2.9), (2.10), horizontal and vertical displacement of the top
ERRORS = {
    0.1: (0.002487577582194478, 0.0012430181753417258, 0.004987562112089006, 0.0012430162464028267,
          0.004962809790010834, 0.004962809790010847, 0.04987562112089009),
    0.2: (0.00980486407215167, 0.004890592656906015, 0.01980390271855703, 0.004890473669718833,
          0.01941932430907985, 0.01941932430907989, 0.09901951359278507),
    0.3: (0.02154109130988846, 0.010714436503868423, 0.04403065089105503, 0.010713159758933895,
          0.042173714778848626, 0.04217371477884857, 0.1467688363035166),
    0.333: (0.026284093588569535, 0.013059137235623715, 0.05398719157302863, 0.01305680669376568,
            0.051221866835454766, 0.05122186683545471, 0.16212369841750318),
    0.5: (0.055728090000841224, 0.027509181904568414, 0.11803398874989501, 0.02748629674601562,
          0.10557280900008417, 0.10557280900008414, 0.23606797749978975),
}  # fmt: skip


def block_of(tan_alpha, R=1.0, **more):
    alpha = np.arctan(tan_alpha)
    return make_block(h=R * np.cos(alpha), b=R * np.sin(alpha), R=R, alpha=alpha, tan_alpha=tan_alpha, **more)


def curve(kind, name, pair, block, ratio=RATIO):
    return curves_of(kind, MODELS[pair], block, np.atleast_1d(ratio))[name][0]


@pytest.mark.parametrize("point", POINTS, ids=lambda p: f"{p['tan_alpha']}-{p['ratio']}")
def test_numbers(point):
    block, at = block_of(point["tan_alpha"]), point["ratio"]
    corners = ("u_free_corner", "v_free_corner", "u_pivot_corner", "v_pivot_corner")
    got = [curve("displacements", name, AT_H, block, at)[0] for name in corners]
    np.testing.assert_allclose(got, [point[name] for name in corners], atol=1e-15)
    rigid, *models = point["F"]
    assert curve("pushover", "pushover_force_block", AT_R, block, at)[0] == pytest.approx(rigid, abs=1e-15)
    for pair, force in zip((NEGATIVE, AT_R, AT_H), models, strict=True):
        assert curve("pushover", "pushover_force", pair, block, at)[0] == pytest.approx(force, abs=1e-15)
    for pair, moment in zip((NEGATIVE, AT_R, AT_H), point["M"], strict=True):
        assert curve("moment_rotation", "restoring_moment", pair, block, at)[0] == pytest.approx(moment, abs=1e-15)
    both = curves_of("overturning_moment", MODELS[AT_R], block, np.array([at]))
    ratio = both["overturning_moment"] / both["overturning_moment_block"]
    assert ratio[0, 0] == pytest.approx(point["M_over"], abs=1e-15)


@pytest.mark.parametrize("tan_alpha", ERRORS)
def test_errors(tan_alpha):
    block = block_of(tan_alpha)
    f22, f23, f24, m9, m10, u, v = ERRORS[tan_alpha]
    force = [errors_of("pushover", MODELS[p], block)["curve_error_pushover"][0] for p in (NEGATIVE, AT_R, AT_H)]
    np.testing.assert_allclose(force, (f22, f23, f24), atol=1e-9)
    moment = [
        errors_of("moment_rotation", MODELS[p], block)["curve_error_moment_rotation"][0] for p in (NEGATIVE, AT_R, AT_H)
    ]
    np.testing.assert_allclose(moment, (0.0, m9, m10), atol=1e-9)
    top = errors_of("displacements", MODELS[NEGATIVE], block)
    assert top["curve_error_displacements"][0] == pytest.approx(u, abs=1e-12)
    assert top["curve_error_displacements_vertical"][0] == pytest.approx(v, abs=1e-12)


def test_errors_as_the_source_rounds_them():
    """.25/.98/2.6 % (2.22), .12/.49/1.3 % (2.23), .5/2.0/5.4 % (2.24) at tan alpha .1/.2/.333."""
    block = block_of(np.array([0.1, 0.2, 0.333]), n=3)
    said = {NEGATIVE: (0.25, 0.98, 2.6), AT_R: (0.12, 0.49, 1.3), AT_H: (0.5, 2.0, 5.4)}
    for pair, percent in said.items():
        error = 100.0 * errors_of("pushover", MODELS[pair], block)["curve_error_pushover"]
        np.testing.assert_allclose(error, percent, rtol=0.04)


@pytest.mark.parametrize("tan_alpha", [0.05, 0.2, 0.7, 0.99])
@pytest.mark.parametrize("pair", MODELS, ids=str)
def test_printed_formulas(pair, tan_alpha):
    block = block_of(tan_alpha)
    alpha = np.arctan(tan_alpha)
    theta = RATIO * alpha
    name, geometry = pair
    if name == "linearized":
        force, moment = alpha - theta, alpha - theta
    elif geometry is None:
        force, moment = np.tan(alpha - theta), np.sin(alpha - theta)
    elif geometry == "negative_stiffness":
        force, moment = tan_alpha - np.tan(theta), np.sin(alpha - theta)
    elif name in ("1", "4"):
        force = tan_alpha / np.cos(theta) - np.tan(theta) / np.cos(alpha)
        moment = np.sin(alpha) - np.sin(theta)
    else:
        force = tan_alpha / np.cos(theta) - np.tan(theta)
        moment = np.sin(alpha) - np.cos(alpha) * np.sin(theta)
    np.testing.assert_allclose(curve("pushover", "pushover_force", pair, block), force, atol=1e-15)
    np.testing.assert_allclose(curve("moment_rotation", "restoring_moment", pair, block), moment, atol=1e-15)


def corners(block, theta):
    """All four corners of the turned block (x, z) over theta, from the top's displacements and a turn of the base."""
    b, top = block.b[0], block.top[0]
    pivot = int(block.weak[0])
    width = b.sum()
    got = curves_of("displacements", BLOCK, block, theta / block.of_weak_edge(block.alpha)[0])
    free = np.stack([-width + got["u_free_corner"][0], top + got["v_free_corner"][0]])
    above = np.stack([got["u_pivot_corner"][0], top + got["v_pivot_corner"][0]])
    base = np.stack([-width * np.cos(theta), width * np.sin(theta)])
    assert pivot in (0, 1)
    return {"free": free, "above": above, "base": base, "pivot": np.zeros_like(base)}


@pytest.mark.parametrize("b", [0.05, 0.3, 0.9, [0.5, 0.2]])
def test_the_block_stays_rigid_and_above_ground(b):
    block = make_block(h=1.0, b=b)
    width = float(np.sum(block.b[0]))
    theta = RATIO * block.of_weak_edge(block.alpha)[0]
    found = corners(block, theta)
    lengths = {
        ("free", "above"): width,
        ("pivot", "above"): 2.0,
        ("base", "free"): 2.0,
        ("base", "above"): np.hypot(width, 2.0),
        ("pivot", "free"): np.hypot(width, 2.0),
    }
    for (one, other), length in lengths.items():
        np.testing.assert_allclose(np.hypot(*(found[one] - found[other])), length, rtol=1e-14)
    assert min(float(z.min()) for _, z in found.values()) >= 0.0
    # theta = alpha: the centroid, midway along the diagonal of a rectangle, stands above the pivot
    if np.ndim(b) == 0:
        np.testing.assert_allclose(found["free"][0, -1], 0.0, atol=1e-14)


def test_the_printed_corners_do_not_stay_rigid():
    """What (2.11), (2.12) print changes the width of the top: docs/curves.md."""
    alpha, R = np.arctan(0.1), 1.0
    width, sin, cos = 2.0 * R * np.sin(alpha), np.sin, np.cos
    u_1, v_1 = 2 * R * (sin(alpha) - sin(2 * alpha)), 2 * R * (cos(2 * alpha) - cos(alpha))
    u_2, v_2 = 2 * R * cos(alpha) * sin(alpha), -2 * R * cos(alpha) * (1 - cos(alpha))
    assert np.hypot(width + u_2 - u_1, v_2 - v_1) == pytest.approx(0.594389347318955817, abs=1e-14)
    u_1, v_1 = -2 * R * cos(alpha) * sin(alpha), v_2
    u_2, v_2 = 2 * R * sin(alpha), 2 * R * (1.0 - cos(alpha))
    assert np.hypot(width + u_2 - u_1, v_2 - v_1) == pytest.approx(0.596364, abs=1e-6)


def test_tops_of_the_models():
    """(2.13)-(2.20): u as the corner above the pivot, v nothing or as that corner."""
    block = block_of(0.2, R=3.0)
    theta, h = RATIO * np.arctan(0.2), 3.0 * np.cos(np.arctan(0.2))
    for pair, v in ((NEGATIVE, 0.0 * theta), (AT_H, -2.0 * h * (1.0 - np.cos(theta)))):
        np.testing.assert_allclose(curve("displacements", "u_model", pair, block), 2.0 * h * np.sin(theta), atol=1e-14)
        np.testing.assert_allclose(curve("displacements", "v_model", pair, block), v, atol=1e-14)


def test_where_the_moment_vanishes():
    block = block_of(np.array([0.1, 0.333, 1.2]), n=3)
    assert critical_ratio(MODELS[AT_H], block)[0] == pytest.approx(1.00500426822206708, rel=1e-14)
    assert critical_ratio(MODELS[AT_H], block)[2] == np.inf
    np.testing.assert_array_equal(critical_ratio(MODELS[AT_R], block), 1.0)
    np.testing.assert_array_equal(critical_ratio(BLOCK, block), 1.0)


def test_the_spring_alone():
    block = block_of(0.2)
    plateau = curve("moment_rotation", "spring_moment", AT_H, block)
    np.testing.assert_allclose(plateau, 0.2 / np.sqrt(1.04), rtol=1e-15)
    whole = curve("moment_rotation", "spring_moment", NEGATIVE, block)
    np.testing.assert_array_equal(whole, curve("moment_rotation", "restoring_moment", NEGATIVE, block))
    assert np.isnan(curve("moment_rotation", "spring_moment", ("rigid", None), block)).all()


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != ENERGY])
def test_the_block_errs_nowhere_and_every_variable_is_described(kind):
    block = block_of(np.array([0.1, 0.9]), n=2)
    for name, error in errors_of(kind, BLOCK, block).items():
        assert name in VARIABLES
        np.testing.assert_array_equal(error, 0.0)
    got = curves_of(kind, MODELS[AT_R], block, RATIO)
    assert set(got) == set(KINDS[kind].model + KINDS[kind].block)
    assert all(values.shape == (2, 41) for values in got.values())
    assert set(variables_of((kind,))) <= set(VARIABLES)
