"""Bodies from outlines against closed forms: rectangle, triangles, trapezoid, polygon, L, a statue on its plate."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import rockcli
from rockcli.errors import StudyError
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.study.open import open_study


def opened(block, folder=None, **more):
    study = {"name": "a", "case": {"block": block, "initial": {"theta": 0.01}}, **more}
    if folder is None:
        return open_study(study)
    import yaml

    file = folder / "a.yaml"
    file.write_text(yaml.safe_dump(study, sort_keys=False), encoding="utf-8")
    return open_study(file)


def body(block, **more):
    ((_, batch),) = opened(block, **more).batches()
    return batch.block


def rectangle(left, bottom, right, top):
    return [[left, bottom], [right, bottom], [right, top], [left, top]]


def r_g2(block):
    return (block.inertia[:, LEFT] - 1.0) * block.R[:, LEFT] ** 2


CLOSE = {"rtol": 4e-15, "atol": 0.0}


@pytest.mark.parametrize("corner", [(0.0, 0.0), (-0.25, 0.0), (1000.0, -50.0)])
def test_a_rectangle_is_the_block(corner):
    x, z = corner
    width, height = 0.5, 2.0
    ours = body({"outline": rectangle(x, z, x + width, z + height), "density": 2000, "depth": 0.25, "mu": 0.4})
    block = body({"width": width, "height": height, "mass": 500, "mu": 0.4})
    for name in ("h", "b", "tan_alpha", "alpha", "R", "top", "mass", "mu"):
        np.testing.assert_array_equal(getattr(ours, name), getattr(block, name), name)
    np.testing.assert_allclose(ours.inertia, 4.0 / 3.0, **CLOSE)


def test_a_rectangle_answers_like_the_block():
    motion = {"pulse": {"shape": "ricker", "a_p": "2.2*g*tan_alpha", "T_p": 0.7}}
    answers = [
        rockcli.run({"name": "a", "case": {"block": block, "motion": motion}})
        for block in ({"width": 0.5, "height": 2.0}, {"outline": rectangle(3.0, 1.0, 3.5, 3.0)})
    ]
    block, ours = (float(answer.theta_peak_over_alpha) for answer in answers)
    assert 0.1 < block < 1.0
    assert ours == pytest.approx(block, rel=1e-12)


def test_an_isosceles_triangle():
    w, H = 0.9, 2.4
    ours = body({"outline": [[0, 0], [w, 0], [w / 2, H]]})
    assert ours.symmetric.all()
    np.testing.assert_allclose([ours.h[0], ours.b[0, 0], ours.top[0]], [H / 3, w / 2, H], **CLOSE)
    np.testing.assert_allclose(r_g2(ours), H**2 / 18 + w**2 / 24, rtol=1e-14)
    assert np.isnan(ours.mass).all()


def test_a_right_triangle_has_two_edges():
    w, H = 0.9, 1.2
    ours = body({"outline": [[0, 0], [w, 0], [0, H]], "density": 1000, "depth": 2})
    np.testing.assert_allclose(ours.b[0], [w / 3, 2 * w / 3], **CLOSE)
    np.testing.assert_allclose(r_g2(ours), (H**2 + w**2) / 18, rtol=1e-14)
    np.testing.assert_allclose(ours.mass, 1000 * 2 * w * H / 2, **CLOSE)
    # about the left edge: I = rho depth (w H^3 + H w^3)/12, R from the thirds
    np.testing.assert_allclose(ours.inertia[0, LEFT], (w * H**3 + H * w**3) / 12 / (w * H / 2) / ((w**2 + H**2) / 9))


@pytest.mark.parametrize(("a", "c"), [(1.0, 0.4), (0.6, 0.9)])
def test_a_trapezoid(a, c):
    H = 1.5
    ours = body({"outline": [[-a / 2, 0], [a / 2, 0], [c / 2, H], [-c / 2, H]]})
    I_x = H**3 * (a * a + 4 * a * c + c * c) / (36 * (a + c))
    I_z = H * (a + c) * (a * a + c * c) / 48
    np.testing.assert_allclose(ours.h, H / 3 * (a + 2 * c) / (a + c), **CLOSE)
    np.testing.assert_allclose(r_g2(ours), (I_x + I_z) / (0.5 * (a + c) * H), rtol=1e-14)
    np.testing.assert_array_equal(ours.b, a / 2)


def test_a_regular_polygon():
    k, R = 12, 0.8
    angle = 2 * np.pi * (np.arange(k) + 0.5) / k - np.pi / 2
    ours = body({"outline": np.column_stack([R * np.cos(angle), R * np.sin(angle)]).tolist()})
    np.testing.assert_allclose(ours.h, R * np.cos(np.pi / k), rtol=1e-14)
    np.testing.assert_allclose(ours.b, R * np.sin(np.pi / k), rtol=1e-13)
    np.testing.assert_allclose(r_g2(ours), R**2 / 6 * (2 + np.cos(2 * np.pi / k)), rtol=1e-13)


def by_parallel_axes(rectangles):
    """Mass, x, z and r_g^2 of rectangles (left, bottom, right, top, density x depth)."""
    left, bottom, right, top, weight = np.array(rectangles).T
    m = weight * (right - left) * (top - bottom)
    x, z = 0.5 * (left + right), 0.5 * (bottom + top)
    own = ((right - left) ** 2 + (top - bottom) ** 2) / 12
    x_c, z_c = (m * x).sum() / m.sum(), (m * z).sum() / m.sum()
    return m.sum(), x_c, z_c, (m * (own + (x - x_c) ** 2 + (z - z_c) ** 2)).sum() / m.sum()


def test_an_L_is_two_rectangles():
    outline = [[0, 0], [1.2, 0], [1.2, 0.3], [0.4, 0.3], [0.4, 2.0], [0, 2.0]]
    ours = body({"outline": outline, "density": 1800, "depth": 0.5})
    mass, x, z, radius2 = by_parallel_axes([(0, 0, 1.2, 0.3, 900), (0, 0.3, 0.4, 2.0, 900)])
    np.testing.assert_allclose(ours.mass, mass, rtol=1e-14)
    np.testing.assert_allclose(ours.b[0], [x, 1.2 - x], rtol=1e-14)
    np.testing.assert_allclose(ours.h, z, rtol=1e-14)
    np.testing.assert_allclose(r_g2(ours), radius2, rtol=1e-14)
    np.testing.assert_allclose(ours.R[0], np.hypot([x, 1.2 - x], z), rtol=1e-14)


def test_a_slender_statue_on_a_wide_plate():
    parts = [
        {"outline": rectangle(-0.5, 0, 0.7, 0.05), "density": 7850, "depth": 1.0},
        {"outline": rectangle(-0.1, 0.05, 0.1, 1.8), "density": 2700, "depth": 0.2},
    ]
    ours = body({"parts": parts, "top": 1.5})
    mass, x, z, radius2 = by_parallel_axes([(-0.5, 0, 0.7, 0.05, 7850), (-0.1, 0.05, 0.1, 1.8, 540)])
    np.testing.assert_allclose(ours.mass, mass, rtol=1e-14)
    np.testing.assert_allclose(ours.b[0], [x + 0.5, 0.7 - x], rtol=1e-14)
    np.testing.assert_allclose(ours.h, z, rtol=1e-14)
    np.testing.assert_allclose(r_g2(ours), radius2, rtol=1e-14)
    np.testing.assert_array_equal(ours.top, 1.5)
    np.testing.assert_array_equal(body({"parts": parts}).top, 1.8)


def test_turned_mirrored_moved_and_begun_elsewhere():
    points = np.array([[0, 0], [0.9, 0], [0.6, 0.8], [0.7, 2.1], [0.1, 1.9]])
    first = body({"outline": points.tolist()})
    mirrored = body({"outline": (points * [-1, 1]).tolist()})
    np.testing.assert_allclose(mirrored.b[0], first.b[0, ::-1], rtol=1e-14)
    for other in (
        points[::-1],
        np.roll(points, 2, axis=0),
        points + np.array([100, 7]),
        np.vstack([points, points[:1]]),
    ):
        ours = body({"outline": other.tolist()})
        for name in ("h", "b", "R", "inertia", "top"):
            np.testing.assert_allclose(getattr(ours, name), getattr(first, name), rtol=1e-12)


def test_a_clockwise_outline_is_said():
    batch = next(iter(opened({"outline": rectangle(0, 0, 1, 3)[::-1]}).batches()))[1]
    assert any("clockwise" in sentence for sentence in batch.warnings)
    batch = next(iter(opened({"outline": rectangle(0, 0, 1, 3)}).batches()))[1]
    assert not batch.warnings


def test_points_may_be_expressions_and_vary():
    outline = [[0, 0], ["w", 0], ["w", "180*cm"], [0, 1.8]]
    study = opened({"outline": outline}, let={"w": 0.3}, vary={"let.w": [0.3, 0.45, 0.6]})
    ((_, batch),) = study.batches()
    np.testing.assert_allclose(batch.block.b[:, RIGHT], [0.15, 0.225, 0.3], rtol=1e-15)


class TestFiles:
    def test_a_file_beside_the_study(self, tmp_path):
        (tmp_path / "o.csv").write_text("x, z  # metres\n0,0\n0.5,0\n\n0.5,2\n0,2\n", encoding="utf-8")
        study = opened({"outline": "o.csv"}, tmp_path)
        ((_, batch),) = study.batches()
        np.testing.assert_array_equal(batch.block.b, 0.25)
        assert list(study.inputs) == ["o.csv"]

    def test_its_bytes_identify_the_results(self, tmp_path):
        text = "0,0\n0.5,0\n0.5,2\n0,2\n"
        identities = []
        for content in (text, text, text.replace("2\n0,2", "2.0\n0,2")):
            (tmp_path / "o.csv").write_text(content, encoding="utf-8")
            identities.append(opened({"outline": "o.csv"}, tmp_path).identity)
        assert identities[0] == identities[1] != identities[2]

    @pytest.mark.parametrize(
        ("head", "words"),
        [
            ("x [cm],z [cm]", "says cm, .* give `pixel: 0.01`"),
            ("x_mm;z_mm", "says mm, .* give `pixel: 0.001`"),
            ("x (in), z (in)", "says in, .* give `pixel: 0.0254`"),
            ("z,x", "names z, x; an outline is x, z"),
            ("# x [mm], z [mm]", "says mm, "),
            ("# units: cm", "says cm, "),
        ],
    )
    def test_a_head_that_says_otherwise_is_refused(self, head, words, tmp_path):
        (tmp_path / "o.csv").write_text(head + "\n0,0\n50,0\n50,200\n0,200\n", encoding="utf-8")
        with pytest.raises(StudyError, match=words) as caught:
            opened({"outline": "o.csv"}, tmp_path)
        assert caught.value.line == 1

    def test_a_head_may_say_the_unit(self, tmp_path):
        for head, pixel, metres in (
            ("x [m],z [m]", {}, 1.0),
            ("x [cm],z [cm]", {"pixel": "1*cm"}, 0.01),
            ("right,up", {"pixel": 0.004}, 0.004),
        ):
            (tmp_path / "o.csv").write_text(head + "\n0,0\n50,0\n50,200\n0,200\n", encoding="utf-8")
            ((_, batch),) = opened({"outline": "o.csv", **pixel}, tmp_path).batches()
            np.testing.assert_allclose(batch.block.b, 25.0 * metres, rtol=1e-12)

    def test_files_as_an_axis(self, tmp_path):
        (tmp_path / "o.csv").write_text("0,0\n0.5,0\n0.5,2\n0,2\n", encoding="utf-8")
        (tmp_path / "p.csv").write_text("0,0\n0.7,0\n0.7,2\n0,2\n", encoding="utf-8")
        study = opened({"outline": "o.csv"}, tmp_path, vary={"block.outline": ["o.csv", "p.csv"]})
        assert study.axes[0].values == ("o.csv", "p.csv")
        assert set(study.inputs) == {"o.csv", "p.csv"}

    @pytest.mark.parametrize(
        ("content", "line", "words"),
        [("0,0\n1,0\n1,x\n", 3, "x, z"), ("0,0\n1,0,3\n1,1\n", 2, "x, z"), ("x,z\n0,0\n1,0\n", None, "2 points")],
    )
    def test_a_bad_file_is_named_with_its_line(self, content, line, words, tmp_path):
        (tmp_path / "o.csv").write_text(content, encoding="utf-8")
        with pytest.raises(StudyError, match=words) as caught:
            opened({"outline": "o.csv"}, tmp_path)
        assert caught.value.file == str(tmp_path / "o.csv")
        assert caught.value.line == line

    def test_an_absent_file(self, tmp_path):
        with pytest.raises(StudyError, match=r"case\.block\.outline: the outline .*o\.csv does not exist"):
            opened({"outline": "o.csv"}, tmp_path)


SQUARE = rectangle(0, 0, 1, 1)


@pytest.mark.parametrize(
    ("block", "words"),
    [
        ({"outline": [[0, 0], [1, 0], [0, 1], [1, 1]]}, r"case\.block\.outline: crosses or touches itself.* 2 and 4"),
        ({"outline": [[0, 0], [1, 0], [0.5, 0], [0.5, 1]]}, "crosses or touches itself"),
        ({"outline": [[0, 0], [2, 0], [2, 1], [1, 0], [0, 1]]}, "crosses or touches itself"),
        ({"outline": [[0, 0], [1, 0], [1, 0], [0, 1]]}, "points 2 and 3 are the same"),
        ({"outline": [[0, 0], [1, 1], [-1, 1]]}, "rests on one point"),
        ({"outline": [[0, 0], [0.1, 0], [1, 1], [0.5, 1]]}, "falls by itself: its centre of mass, x = 0.47"),
        ({"outline": [[0, 0], [1, 0]]}, "at least 3 points"),
        ({"outline": [[0, 0], [1, 0], [1]]}, r"point 3 .* \[x, z\]"),
        ({"outline": [[0, 0], [1, 0], [1, "h"]]}, "known only once the block is"),
        ({"outline": "o.txt"}, "FILE.csv"),
        ({"outline": SQUARE, "density": 0}, "greater than 0"),
        ({"outline": SQUARE, "density": 2, "mass": 3}, "say the same thing"),
        ({"outline": SQUARE, "r_g": 1}, r"case\.block\.r_g: follows from the outline"),
        ({"R": 1, "tan_alpha": 0.2, "depth": 3}, "belongs to an outline"),
        ({"outline": SQUARE, "parts": [{"outline": SQUARE}]}, "is given beside parts"),
        ({"parts": [{"outline": SQUARE}, {"outline": rectangle(0, 0.5, 1, 2)}]}, r"parts\.1\.outline: overlaps part 1"),
        ({"parts": [{"outline": SQUARE}, {"outline": SQUARE}]}, "overlaps part 1"),
        ({"parts": [{"outline": SQUARE, "density": 1}, {"outline": rectangle(0, 1, 1, 2)}]}, "has no density"),
        ({"parts": []}, "parts"),
        ({"parts": [{"density": 3}]}, "'outline' is missing"),
        ({"parts": [{"outline": SQUARE, "colour": 1}]}, "unknown key 'colour'"),
    ],
)
def test_what_is_no_body_is_refused(block, words):
    with pytest.raises(StudyError, match=words):
        opened(block)


@pytest.mark.parametrize(("lean", "shift"), [(0.0, 0.0), (0.1, 1000.0)])
def test_parts_that_touch_but_for_rounding_do_not_overlap(lean, shift):
    """Blocks on one another at heights that are summed up, straight or leaning; a micrometre in common is refused."""
    rng = np.random.default_rng(8)
    for _ in range(40):
        steps, z, parts = rng.uniform(0.1, 0.4, 4), shift, []
        for step in steps:
            low, high = (lean * (height - shift) + shift for height in (z, z + step))
            parts.append({"outline": [[low, z], [low + 0.3, z], [high + 0.3, z + step], [high, z + step]]})
            z = shift + (z - shift) + step * (1.0 + rng.choice([-1.0, 0.0, 1.0]) * 1e-15)
        opened({"parts": parts})
        for point in parts[2]["outline"]:
            point[1] -= 1e-6
        with pytest.raises(StudyError, match="overlaps part 2"):
            opened({"parts": parts})


def test_an_outline_from_a_photograph() -> None:
    """Pixels, z down, and two contacts: the body is that of the same outline in metres on its feet."""
    x0, z0, pixel = 120.0, 900.0, 0.004
    metres = [[0.0, 0.0], [0.5, 0.0], [0.6, 1.2], [0.1, 1.6]]
    pixels = [[x0 + x / pixel, z0 - z / pixel] for x, z in metres]
    # a bulge below the feet that the photograph shows and that does not stand on the floor
    belly = [[0.0, 0.0], [0.25, -0.02], [0.5, 0.0], [0.6, 1.2], [0.1, 1.6]]

    def block(**body: object):
        case = {"block": body, "motion": {"pulse": {"shape": "sine", "a_p": 4.0, "f_p": 2.0}}}
        return rockcli.run({"name": "photograph", "case": case, "save": {"histories": False}})

    plain = block(outline=metres)
    seen = block(outline=pixels, pixel=pixel, z_down=True)
    feet = [[x0, z0], [x0 + 0.5 / pixel, z0]]
    told = block(outline=pixels, pixel=pixel, z_down=True, contacts=feet)
    for name in ("R_left", "R_right", "alpha_left", "alpha_right", "p_left", "theta_peak"):
        assert float(seen[name]) == pytest.approx(float(plain[name]), rel=1e-9)
        assert float(told[name]) == pytest.approx(float(plain[name]), rel=1e-9)
    stands = block(outline=belly, contacts=[[0.0, 0.0], [0.5, 0.0]])
    base = 0.5 * (stands["R_left"] * np.sin(stands["alpha_left"]) + stands["R_right"] * np.sin(stands["alpha_right"]))
    assert float(base) == pytest.approx(0.25, rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"contacts": [[0.0, 0.1], [0.5, 0.0]], "mu": 0.5}, "a tilted support, on which friction is not solved"),
        ({"contacts": [[0.0, 0.3], [0.5, 0.0]], "outline": [[0.0, 0.0], [0.5, 0.0], [0.6, 0.5]]}, "below its contacts"),
        ({"contacts": [[0.0, 0.0], [0.1, 0.0]]}, "falls by itself"),
        ({"contacts": [[0.0, 1.4], [0.5, 1.4]]}, "below its contacts"),
        ({"contacts": [[0.0, 0.0]]}, "contacts"),
        ({"pixel": 0}, "pixel"),
    ],
)
def test_wrong_contacts(changes: dict[str, object], words: str) -> None:
    block = {"outline": [[0.0, 0.0], [0.5, 0.0], [0.6, 1.2], [0.1, 1.6]]} | changes
    with pytest.raises(StudyError, match=words):
        rockcli.run({"name": "wrong", "case": {"block": block, "initial": {"theta": 0.01}}})


def by_coordinates(outline, contacts, pulse, t_end, g=9.81):
    """Peak angles to the right and to the left, and impacts, of a body that turns about two points at any heights.

    Nothing is known of alpha: positions are turned, torques and angular momenta are products of vectors.
    """
    x, z = np.transpose(outline)
    x_, z_ = np.roll(x, -1), np.roll(z, -1)
    cross = x * z_ - x_ * z
    area = 0.5 * cross.sum()
    centre = np.array([((x + x_) * cross).sum(), ((z + z_) * cross).sum()]) / (6.0 * area)
    polar = ((x * x + x * x_ + x_ * x_ + z * z + z * z_ + z_ * z_) * cross).sum() / (12.0 * area)
    k2 = polar - centre @ centre
    arms = {sign: centre - np.array(contact) for sign, contact in zip((-1.0, 1.0), contacts, strict=True)}

    def turned(arm, theta):
        c, s = np.cos(theta), np.sin(theta)  # clockwise, to the right
        return np.array([c * arm[0] + s * arm[1], -s * arm[0] + c * arm[1]])

    def moment(side, t, theta):
        rx, rz = turned(arms[side], theta)
        return (rx * g - rz * pulse(t)) / (k2 + arms[side] @ arms[side])

    t, side, state, peaks, impacts = 0.0, 0.0, np.zeros(2), {-1.0: 0.0, 1.0: 0.0}, 0
    dt = 1e-4
    while side == 0.0 and t < t_end:  # at rest on both: until one of them alone would turn it
        for one in (-1.0, 1.0):
            if one * moment(one, t, 0.0) > 0.0:
                side = one
        t += dt if side == 0.0 else 0.0
    t = brentq(lambda y: moment(side, y, 0.0), t - dt, t)
    while t < t_end:

        def flow(y, q, side=side):
            return [q[1], moment(side, y, q[0])]

        def touches(y, q, side=side):
            return side * q[0] if y > t + 1e-9 else 1.0

        def top(y, q):
            return q[1]

        touches.terminal, touches.direction = True, -1.0
        run = solve_ivp(flow, (t, t_end), state, "DOP853", events=[touches, top], rtol=1e-12, atol=1e-14)
        peaks[side] = max([peaks[side], *(abs(q[0]) for q in run.y_events[1])])
        t = run.t[-1]
        if not len(run.t_events[0]):
            break
        other = arms[-side]
        keeps = (k2 + other @ arms[side]) / (k2 + other @ other)
        rate, side, impacts = run.y[1, -1] * keeps, -side, impacts + 1
        state = np.array([0.0, rate])
        if abs(rate) < 1e-3:
            break
    return peaks[1.0], peaks[-1.0], impacts


@pytest.mark.parametrize(("rise", "a_p"), [(0.12, 4.8), (-0.1, 4.5), (0.03, -4.2), (0.0, 4.6)])
def test_a_tilted_support(rise: float, a_p: float) -> None:
    """Rocking between contacts at different heights, against an integration by coordinates."""
    outline = [[0.0, -0.05], [0.5, -0.05], [0.62, 1.2], [0.1, 1.6]]
    contacts = [[0.02, 0.0], [0.5, rise]]
    omega = 2.0 * np.pi / 0.5

    def pulse(t):
        return a_p * np.sin(omega * t) if t < 0.5 else 0.0

    case = {
        "block": {"outline": outline, "contacts": contacts},
        "motion": {"pulse": {"shape": "sine", "a_p": a_p, "T_p": 0.5}, "duration": 1.2},
        "damping": {"eta": "housner"},
    }
    case["solver"] = {"accuracy": "reference"}
    ours = rockcli.run({"name": "tilted", "case": case})
    right, left, impacts = by_coordinates(outline, contacts, pulse, 1.2)
    assert impacts >= 1
    assert min(right, left) > 1e-3
    assert float(ours.theta_peak_right) == pytest.approx(right, rel=1e-8)
    assert float(ours.theta_peak_left) == pytest.approx(left, rel=1e-8)
    assert np.isnan(float(ours.mu_required)) == (rise != 0.0)
    u_top = max((1.6 - rise) * np.sin(right), 1.6 * np.sin(left))  # of the highest point, straight above the contact
    assert float(ours.u_top_peak) == pytest.approx(u_top, rel=1e-8)
    assert np.nanmax(np.abs(ours.u_top)) == pytest.approx(u_top, rel=1e-3)
    case["solver"] = {"backend": "scipy"}
    assert float(rockcli.run({"name": "tilted", "case": case}).u_top_peak) == pytest.approx(u_top, rel=1e-6)


def test_displacements_on_a_tilted_support_are_from_the_contact_it_turns_about() -> None:
    """The right contact, 0.1 m above the left one, is the weak one of a rectangle of 0.4 by 2 m pushed to that side."""
    block = {"outline": rectangle(0.0, 0.0, 0.4, 2.0), "contacts": [[0.0, 0.0], [0.36, 0.1]]}
    alpha = np.arctan2(0.16, 0.9)
    curves = rockcli.run({"case": {"block": block}, "curves": ["displacements"]})
    assert float(curves.u_pivot_corner[-1]) == pytest.approx(1.9 * np.sin(alpha), rel=1e-12)
    assert float(curves.v_pivot_corner[-1]) == pytest.approx(1.9 * (np.cos(alpha) - 1.0), rel=1e-12)
    damping = {"scheme": "fema356", "spectrum": {"shape": "flat_S_v", "S_v": 0.15}}
    found = rockcli.run({"case": {"block": block, "damping": damping}})
    assert float(found.fema_delta) == pytest.approx(0.9 * float(found.theta_peak_over_alpha) * alpha, rel=1e-9)
    assert float(found.fema_u_top / found.fema_delta) == pytest.approx(1.9 / 0.9, rel=1e-12)


def test_a_tilted_support_turned_by_hand() -> None:
    """Contacts above each other's level are a body of its own angles: tan(alpha) is where the vertical passes."""
    outline = rectangle(0.0, 0.0, 0.4, 2.0)
    block = body({"outline": outline, "contacts": [[0.0, 0.0], [0.4, 0.1]]})
    np.testing.assert_allclose(block.tan_alpha[0], [0.2 / 1.0, 0.2 / 0.9], rtol=1e-14)
    np.testing.assert_allclose(block.R[0], [np.hypot(0.2, 1.0), np.hypot(0.2, 0.9)], rtol=1e-14)
    assert not block.symmetric[0]
    level = body({"outline": outline, "contacts": [[0.0, 0.1], [0.4, 0.1]]})
    assert level.symmetric[0]
