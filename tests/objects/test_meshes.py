"""Bodies from meshes: closed forms, trimesh's own stable poses, a search by brute force, what is refused."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.spatial import ConvexHull

import rockcli
from rockcli.errors import StudyError
from rockcli.scene.body.block import RIGHT
from rockcli.scene.body.lower_outline import facets_of, lower_hull, settling_turn, turned
from rockcli.scene.body.scan import DIRECTIONS, QUARTER, Profile, _overturning
from rockcli.study.building import body_mesh
from rockcli.study.building.body_mesh import measured
from rockcli.study.open import open_study

trimesh = pytest.importorskip("trimesh", reason="meshes are read by trimesh: pip install -e '.[meshes]'")

EXPERIMENTS = Path(__file__).resolve().parents[3] / "shared" / "experiments"


def scan_of(mesh, kind="ply", units="m"):
    data = mesh.export(file_type=kind)
    return measured(data.encode() if isinstance(data, str) else data, kind, units)


def standing(mesh):
    """A mesh on its lowest point, off the origin."""
    mesh.apply_translation([3.0, -2.0, -mesh.bounds[0][2]])
    return mesh


def box(a=0.6, b=0.4, c=1.5):
    return standing(trimesh.creation.box((a, b, c)))


def study_file(folder, block, **more):
    file = folder / "a.yaml"
    study = {"name": "a", "case": {"block": block, "initial": {"theta": 0.01}}, **more}
    file.write_text(yaml.safe_dump(study, sort_keys=False), encoding="utf-8")
    return file


@pytest.fixture
def folder(tmp_path):
    box().export(tmp_path / "box.obj")
    return tmp_path


ANGLES = np.radians([0.0, 10.0, 33.0, 90.0, 155.0, 270.0])


def test_a_box():
    a, b, c = 0.6, 0.4, 1.5
    scan = scan_of(box(a, b, c))
    assert scan.volume == pytest.approx(a * b * c, rel=1e-6)
    np.testing.assert_allclose(scan.centre, [3.0, -2.0, c / 2], rtol=1e-6)
    for angle in ANGLES.tolist():
        cos, sin = np.cos(angle), np.sin(angle)
        half = 0.5 * (a * abs(cos) + b * abs(sin))
        profile = scan.profile(angle)
        np.testing.assert_allclose(profile.barriers, np.hypot(half, c / 2) - c / 2, rtol=1e-5)
        np.testing.assert_allclose(profile.tilts, np.arctan2(half, c / 2), rtol=1e-6)
        np.testing.assert_allclose(profile.toes, [[-half, -c / 2], [half, -c / 2]], rtol=1e-6)
        assert profile.r_g**2 == pytest.approx((c**2 + a**2 * cos**2 + b**2 * sin**2) / 12, rel=1e-6)
    assert np.degrees(scan.weakest) % 180.0 == pytest.approx(90.0, abs=1e-6)
    np.testing.assert_allclose(np.unique(np.round(scan.heights, 6)), [b / 2, a / 2, c / 2], rtol=1e-5)
    assert len(scan.poses) == 6


def test_a_cylinder_and_a_cone():
    r, c = 0.3, 1.1
    for mesh, volume, height, r_g2 in (
        (trimesh.creation.cylinder(r, c, sections=256), np.pi * r**2 * c, c / 2, r**2 / 4 + c**2 / 12),
        (trimesh.creation.cone(r, c, sections=256), np.pi * r**2 * c / 3, c / 4, 3 * (4 * r**2 + c**2) / 80),
    ):
        scan = scan_of(standing(mesh))
        assert scan.volume == pytest.approx(volume, rel=5e-3)
        assert scan.centre[2] == pytest.approx(height, rel=5e-3)
        np.testing.assert_allclose(scan.barriers, np.hypot(r, height) - height, rtol=5e-3)
        for angle in ANGLES.tolist():
            profile = scan.profile(angle)
            assert profile.r_g**2 == pytest.approx(r_g2, rel=5e-3)
            np.testing.assert_allclose(profile.tilts, np.arctan2(r, height), rtol=5e-3)


def test_an_ellipsoid():
    """It has no edge: the centre rises until the long axis stands, at a quarter turn."""
    a, b, c = 0.7, 0.5, 0.3
    mesh = trimesh.creation.icosphere(subdivisions=4)
    mesh.apply_scale([a, b, c])
    scan = scan_of(standing(mesh))
    assert scan.volume == pytest.approx(4 / 3 * np.pi * a * b * c, rel=5e-3)
    for angle in ANGLES.tolist():
        across2 = (a * np.cos(angle)) ** 2 + (b * np.sin(angle)) ** 2
        profile = scan.profile(angle)
        assert profile.r_g**2 == pytest.approx((c**2 + across2) / 5, rel=5e-3)
        np.testing.assert_allclose(profile.barriers, np.sqrt(across2) - c, rtol=5e-3)
        np.testing.assert_allclose(profile.tilts, QUARTER, rtol=0.05)
    assert np.degrees(scan.weakest) % 180.0 == pytest.approx(90.0, abs=3.0)
    assert len(scan.barriers) == DIRECTIONS


def rock(seed):
    """A random convex body that stands on a facet."""
    random = np.random.default_rng(seed)
    hull = trimesh.convex.convex_hull(random.normal(size=(40, 3)) * [0.3, 0.25, 0.4])
    poses, chances = hull.compute_stable_poses()
    hull.apply_transform(poses[int(np.argmax(chances))])
    return hull


@pytest.mark.parametrize("seed", range(8))
def test_stable_poses_are_those_of_trimesh(seed):
    mesh = rock(seed)
    scan = scan_of(mesh)
    poses, _ = mesh.compute_stable_poses()
    heights = sorted((pose @ [*mesh.center_mass, 1.0])[2] for pose in poses)
    np.testing.assert_allclose(scan.heights, heights, rtol=1e-5)
    downwards = np.array([-pose[2, :3] for pose in poses])
    assert (np.abs(scan.poses @ downwards.T).max(axis=1) > 1.0 - 1e-6).all()


@pytest.mark.parametrize("seed", range(5))
def test_the_barrier_is_the_highest_point_of_the_way(seed):
    """Every corner of the mesh at 40 000 tilts, from the rest that the body rolls down to."""
    mesh = rock(seed + 20)
    mesh.apply_transform(trimesh.transformations.rotation_matrix(0.02, [1.0, 0.5, 0.0]))
    scan = scan_of(mesh)
    tilts = np.linspace(-np.pi, np.pi, 40_001)
    for angle in ANGLES.tolist():
        seen = mesh.vertices - mesh.center_mass
        x, z = seen[:, 0] * np.cos(angle) + seen[:, 1] * np.sin(angle), seen[:, 2]
        h = (np.outer(np.sin(tilts), x) - np.outer(np.cos(tilts), z)).max(axis=1)
        rest = len(tilts) // 2
        while h[rest + 1] < h[rest] or h[rest - 1] < h[rest]:
            rest += 1 if h[rest + 1] < h[rest - 1] else -1
        quarter = round(len(tilts) / 4)
        ways = h[rest - quarter : rest + 1][::-1], h[rest : rest + quarter + 1]
        profile = scan.profile(angle)
        assert profile.tilt == pytest.approx(tilts[rest], abs=2e-4)
        np.testing.assert_allclose(profile.barriers, [way.max() - h[rest] for way in ways], rtol=2e-3, atol=2e-5)
        np.testing.assert_allclose(profile.tilts, [np.argmax(way) * np.diff(tilts)[0] for way in ways], atol=2e-2)
    fine = np.array([scan.profile(each).barriers[RIGHT] for each in np.radians(np.arange(0.0, 360.0, 0.25))])
    assert scan.profile(scan.weakest).barriers[RIGHT] <= fine.min() * (1.0 + 1e-9)


def test_the_formats_seams_and_positions_of_a_file_do_not_matter():
    mesh = rock(3)
    one = scan_of(mesh)
    far = mesh.copy()
    far.apply_translation([500.0, -800.0, 300.0])
    inwards = mesh.copy()
    inwards.invert()
    soup = trimesh.Trimesh(mesh.triangles.reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3), process=False)
    millimetres = mesh.copy()
    millimetres.apply_scale(1000.0)
    for other in (
        scan_of(mesh, "obj"),
        scan_of(mesh, "stl"),
        scan_of(far, "obj"),
        scan_of(inwards, "obj"),
        scan_of(soup, "obj"),
        scan_of(millimetres, "obj", "mm"),
    ):
        assert other.volume == pytest.approx(one.volume, rel=1e-5)
        np.testing.assert_allclose(other.r2, one.r2, atol=1e-6)
        np.testing.assert_allclose(other.barriers, one.barriers, rtol=1e-3)


@pytest.mark.parametrize("digits", [17, 6])
def test_a_polygon_may_have_corners_on_its_straight_sides(digits):
    """A box whose edges have corners on them, in any position; its faces are polygons from any of their corners on."""
    rng = np.random.default_rng(8)
    for _ in range(12):
        sizes = rng.uniform(0.4, 2.0, 3)
        corners = [np.array([i >> 2 & 1, i >> 1 & 1, i & 1]) * sizes for i in range(8)]
        on = {}
        for a, b in ((a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit):
            shares = np.sort(rng.choice([0.1, 0.25, 0.5, 0.75, 0.9], rng.integers(0, 3), replace=False))
            on[a, b] = list(range(len(corners), len(corners) + len(shares)))
            on[b, a] = on[a, b][::-1]
            corners += [corners[a] + share * (corners[b] - corners[a]) for share in shares]
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        lines = ["v " + " ".join(f"{x:.{digits}g}" for x in turn @ corner + 3.0) for corner in corners]
        for face in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)):
            polygon = [i for a, b in zip(face, face[1:] + face[:1], strict=True) for i in (a, *on[a, b])]
            polygon = np.roll(polygon, rng.integers(len(polygon))) + 1
            lines.append("f " + " ".join(map(str, polygon)))
        scan = measured("\n".join(lines).encode(), "obj", None)
        exact = 1e-4 if digits == 6 else 1e-12
        assert scan.volume == pytest.approx(sizes.prod(), rel=exact)
        r2 = [(sizes @ sizes - size**2) / 12 for size in sizes]
        np.testing.assert_allclose(np.linalg.eigvalsh(scan.r2), np.sort(r2), rtol=exact)


def test_a_box_rocks_like_the_block(folder):
    motion = {"pulse": {"shape": "ricker", "a_p": "2.2*g*tan_alpha", "T_p": 0.7}}
    study = {
        "name": "a",
        "case": {"block": {"mesh": "box.obj", "direction": "90*deg", "density": 2000}, "motion": motion},
    }
    file = folder / "a.yaml"
    file.write_text(yaml.safe_dump(study), encoding="utf-8")
    ours = rockcli.run(file)
    block = rockcli.run({"name": "a", "case": {"block": {"height": 1.5, "width": 0.4}, "motion": motion}})
    assert 0.2 < float(block.theta_peak_over_alpha) < 1.0
    assert float(ours.theta_peak_over_alpha) == pytest.approx(float(block.theta_peak_over_alpha), rel=1e-6)
    assert float(ours.eta) == pytest.approx(float(block.eta), rel=1e-7)
    assert "R_left" not in ours.variables


def test_the_body_is_that_of_its_outline(tmp_path):
    """The projection of the hull given as an outline, with the centre of mass and the radius of gyration of the mesh."""
    mesh = rock(4)
    (tmp_path / "rock.obj").write_text(mesh.export(file_type="obj"), encoding="utf-8")
    for angle in (0.0, 0.7, 4.0):
        ((_, ours),) = open_study(study_file(tmp_path, {"mesh": "rock.obj", "direction": angle})).batches()
        seen = mesh.vertices - mesh.center_mass
        points = np.column_stack([seen[:, :2] @ [np.cos(angle), np.sin(angle)], seen[:, 2]])
        outline = points[ConvexHull(points).vertices].tolist()
        r_g = float(np.sqrt(scan_of(mesh, "obj").r2[1, 1])) if angle == 0.0 else ours.block.r_g2[0] ** 0.5
        block = {"outline": outline, "stands": "settled", "centre": [0, 0], "r_g": float(r_g)}
        ((_, theirs),) = open_study({"name": "a", "case": {"block": block, "initial": {"theta": 0.01}}}).batches()
        assert ours.block.vertices is not None
        for name in ("h", "b", "R", "alpha", "inertia", "rise", "vertices", "top"):
            one, other = getattr(ours.block, name), getattr(theirs.block, name)
            np.testing.assert_allclose(one, other, rtol=1e-6, atol=1e-7, err_msg=name)


def test_on_two_toes_it_turns_about_the_corners_that_it_balances_over(tmp_path):
    mesh = standing(trimesh.creation.cone(0.3, 1.1, sections=64))
    (tmp_path / "cone.obj").write_text(mesh.export(file_type="obj"), encoding="utf-8")
    ((_, two),) = open_study(study_file(tmp_path, {"mesh": "cone.obj", "stands": "toes"})).batches()
    assert two.block.vertices is None
    np.testing.assert_allclose(two.block.alpha, np.arctan2(0.3, 0.275), rtol=5e-3)
    flat = trimesh.creation.icosphere(subdivisions=2)
    flat.apply_scale([0.7, 0.5, 0.3])
    (tmp_path / "pebble.obj").write_text(flat.export(file_type="obj"), encoding="utf-8")
    with pytest.raises(StudyError, match="balances over no corner before a quarter turn"):
        open_study(study_file(tmp_path, {"mesh": "pebble.obj", "stands": "toes"}))


def test_the_mass_is_that_of_the_volume_and_the_direction_an_axis(folder, monkeypatch):
    read = []
    loaded = body_mesh._loaded
    monkeypatch.setattr(body_mesh, "_loaded", lambda data, kind: read.append(kind) or loaded(data, kind))
    measured.cache_clear()
    file = study_file(
        folder,
        {"mesh": "box.obj", "density": 2000},
        vary={"block.direction": ["0", "30*deg", "90*deg"]},
        save={"histories": False},
    )
    found = rockcli.run(file)
    assert read == ["obj"]
    half = 0.5 * np.array([0.6, 0.6 * np.cos(np.pi / 6) + 0.4 * np.sin(np.pi / 6), 0.4])
    assert found.direction.attrs["units"] == "rad"
    np.testing.assert_allclose(found.alpha, np.arctan2(half, 0.75), rtol=1e-6)
    np.testing.assert_allclose(found.barrier_towards, np.hypot(half, 0.75) - 0.75, rtol=1e-6)
    assert found.barrier.dims == ("azimuth",)
    assert found.barrier.sizes["azimuth"] == DIRECTIONS
    np.testing.assert_allclose(found.barrier.sel(azimuth=np.pi / 2), found.barrier_towards[2], rtol=1e-6)
    ((_, batch),) = open_study(file).batches()
    np.testing.assert_allclose(batch.block.mass, 0.6 * 0.4 * 1.5 * 2000, rtol=1e-6)


def test_the_direction_may_be_uncertain_and_is_the_weakest_by_default(folder):
    uncertain = {"block.direction": {"normal": ["90*deg", "5*deg"]}}
    found = rockcli.run(
        study_file(folder, {"mesh": "box.obj"}, uncertain=uncertain, samples=20, save={"histories": False})
    )
    assert found.rocks_towards.dims == ("sample",)
    assert 1 < len(np.unique(found.alpha)) <= 20
    ((_, batch),) = open_study(study_file(folder, {"mesh": "box.obj"})).batches()
    assert np.degrees(batch.block.direction[0]) % 180.0 == pytest.approx(90.0, abs=1e-6)


def test_what_check_tells(folder):
    (told,) = rockcli_check(study_file(folder, {"mesh": "box.obj", "mass": 700}))
    body = told["first_case"]["body"]
    assert body["volume"] == pytest.approx(0.36, rel=1e-6)
    assert body["weakest_deg"] % 180.0 == pytest.approx(90.0, abs=1e-6)
    assert body["barrier"] == pytest.approx(np.hypot(0.2, 0.75) - 0.75, rel=1e-6)
    assert body["mass"] == 700
    assert "0.75 m (0 deg)" in body["poses"]


def test_what_check_tells_of_a_mesh_in_single_precision(folder):
    """No digits of its rounding: `0.8081 m (8.54e-07 deg)`, `2.25072e-12`."""
    turned = box(0.6, 0.4, 1.5)
    turned.apply_translation(-turned.bounds.mean(axis=0))
    turned.apply_transform(trimesh.transformations.rotation_matrix(0.3, [0, 0, 1]))
    turned.vertices = turned.vertices.astype(np.float32)
    turned.apply_transform(trimesh.transformations.rotation_matrix(2e-8, [1, 1, 0]))
    turned.export(folder / "turned.ply")
    (told,) = rockcli_check(study_file(folder, {"mesh": "turned.ply", "mass": 700}))
    body = told["first_case"]["body"]
    assert "0.75 m (0 deg)" in body["poses"]
    assert "e-" not in body["poses"] + body["centre"]


def rockcli_check(file):
    import json

    from typer.testing import CliRunner

    from rockcli.cli.main import app

    shown = CliRunner().invoke(app, ["check", str(file), "--json"])
    assert shown.exit_code == 0, shown.output
    return json.loads(shown.stdout)


def leaking(mesh):
    mesh.update_faces(np.arange(len(mesh.faces)) != 3)
    return mesh


def twisted(mesh):
    mesh.faces[0] = mesh.faces[0][::-1]
    return mesh


def scaled(mesh, factor):
    mesh.apply_scale(factor)
    return mesh


REFUSED = {
    "leak": (lambda: leaking(box()), {}, "the surface leaks: 3 of its edges"),
    "twisted": (lambda: twisted(box()), {}, "not all turned outwards"),
    "two bodies": (
        lambda: trimesh.util.concatenate([box(), box().apply_translation([2.0, 0.0, 0.0])]),
        {},
        "is 2 surfaces",
    ),
    "millimetres": (lambda: scaled(box(), 1000.0), {}, "1500 m, read in metres, as no units are said"),
    "too small": (lambda: box(), {"units": "mm"}, "0.0015 m, read in mm"),
    "mass": (lambda: box(), {"mass": 700_000}, "in the 0.36 m³ of the mesh is no body"),
    "density and mass": (lambda: box(), {"mass": 700, "density": 2000}, "say the same thing"),
    "outline": (lambda: box(), {"outline": [[0, 0], [1, 0], [0, 1]]}, "leave one of the two out"),
    "height": (lambda: box(), {"height": 2}, "leave one of the two out"),
    "direction": (lambda: box(), {"direction": "north"}, "`north` is not known"),
    "the weakest": (lambda: box(), {"direction": "weekest"}, "'weekest' is no number; did you mean 'weakest'"),
}


@pytest.mark.parametrize(("made", "more", "words"), REFUSED.values(), ids=REFUSED)
def test_refused(tmp_path, made, more, words):
    (tmp_path / "rock.obj").write_bytes(made().export(file_type="obj").encode())
    file = study_file(tmp_path, {"mesh": "rock.obj", **more})
    with pytest.raises(StudyError) as caught:
        open_study(file)
    assert words in str(caught.value)
    assert str(caught.value).startswith(f"{file}:")
    assert "case.block." in str(caught.value)


@pytest.mark.parametrize(
    ("name", "data", "words"),
    [
        ("rock.obj", b"", "holds no body"),
        ("rock.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "holds no body"),
        ("rock.ply", b"ply\nformat ascii 1.0\nnonsense", "cannot be read"),
        ("rock.stl", b"solid", "holds no body"),
        ("rock.gltf", b"{}", "expected a file that ends in .obj, .ply, .stl"),
        ("absent.obj", None, "does not exist"),
    ],
)
def test_files_that_are_no_mesh(tmp_path, name, data, words):
    if data is not None:
        (tmp_path / name).write_bytes(data)
    with pytest.raises(StudyError, match=r"case\.block\.mesh") as caught:
        open_study(study_file(tmp_path, {"mesh": name}))
    assert words in str(caught.value)


def test_direction_and_units_belong_to_a_mesh():
    for block in ({"height": 1, "width": 0.3}, {"outline": [[0, 0], [1, 0], [1, 2], [0, 2]]}):
        for key, value in (("direction", 0.3), ("units", "mm")):
            with pytest.raises(StudyError, match=f"block.{key}: belongs to a mesh"):
                open_study({"name": "a", "case": {"block": {**block, key: value}, "initial": {"theta": 0.01}}})


def test_without_trimesh_it_is_said_what_to_install(folder, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "trimesh", None)
    measured.cache_clear()
    with pytest.raises(StudyError, match=r"pip install 'rockcli\[meshes\]'"):
        open_study(study_file(folder, {"mesh": "box.obj"}))


def test_a_setting_with_a_mesh_displaces_sizes_and_outlines(folder):
    file = study_file(
        folder,
        {"height": 2, "width": 0.5},
        vary={"block": {"sizes": {"height": 2.2}, "mesh": {"mesh": "box.obj", "direction": 0}}},
        save={"histories": False},
    )
    found = rockcli.run(file)
    np.testing.assert_allclose(found.alpha, [np.arctan(0.5 / 2.2), np.arctan(0.6 / 1.5)], rtol=1e-6)
    assert np.isnan(found.barrier[0]).all()
    assert np.isfinite(found.barrier[1]).all()


@pytest.mark.skipif(not EXPERIMENTS.is_dir(), reason="the folder of experiments is not beside the repository")
def test_the_outlines_of_a_scanned_rock():
    """Outlines of the scan in 43 directions, from the centre of mass, against what is told of the specimen."""
    with (EXPERIMENTS / "specimens.csv").open(newline="", encoding="utf-8") as file:
        specimen = next(row for row in csv.DictReader(file) if row["specimen"] == "unl_granite_sp1")
    with (EXPERIMENTS / "outline_unl_granite.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    barriers, tilts = {}, {}
    for degrees in {int(row["direction_deg"]) for row in rows}:
        mine = [row for row in rows if int(row["direction_deg"]) == degrees]
        outline = np.array([[float(row["x_m"]), float(row["z_m"])] for row in mine])
        facet = int(mine[0]["resting_facet"])
        side = outline[facet + 1] - outline[facet]
        tilt = settling_turn(outline, np.zeros(2))
        assert tilt == pytest.approx(np.arctan2(side[1], side[0]), abs=1e-12)
        assert -outline[:, 1].min() == pytest.approx(float(specimen["com_height_m"]), rel=5e-3)
        angle = np.radians(degrees)
        xx, yy, xy = (float(specimen[f"k2_{name}_m2"]) for name in ("xx", "yy", "xy"))
        k2 = xx * np.sin(angle) ** 2 + yy * np.cos(angle) ** 2 - 2 * xy * np.sin(angle) * np.cos(angle)
        assert float(mine[0]["k2_m2"]) == pytest.approx(k2, rel=5e-3)
        rests = turned(outline, tilt)
        _, barriers[degrees], tilts[degrees] = _overturning(rests, float(-rests[:, 1].min()))
    weakest = min(barriers, key=barriers.__getitem__)
    assert weakest == int(specimen["least_barrier_direction_deg"])
    assert np.degrees(tilts[weakest]) == pytest.approx(float(specimen["tilt_at_barrier_deg"]), rel=0.01)
    assert 1e3 * barriers[weakest] == pytest.approx(float(specimen["least_barrier_mm"]), rel=0.015)


def test_the_barriers_are_those_of_the_lower_outline():
    for seed in range(5):
        scan = scan_of(rock(seed))
        for angle in ANGLES.tolist():
            profile = scan.profile(angle)
            facets = facets_of(lower_hull(profile.outline)[None])
            np.testing.assert_allclose(facets.barrier[0], profile.barriers, rtol=1e-9)


def test_a_profile_is_what_its_words_say():
    profile = scan_of(rock(5)).profile(0.4)
    assert isinstance(profile, Profile)
    assert -profile.outline[:, 1].min() == pytest.approx(profile.h, rel=1e-12)
    flat = np.isclose(profile.outline[:, 1], -profile.h, atol=1e-9)
    assert flat.sum() == 2
    np.testing.assert_array_equal(np.sign(profile.outline[flat, 0]), [-1.0, 1.0])


@pytest.mark.parametrize(
    ("direction", "doubted"), [(45, True), ("45*deg", False), ("2*pi", False), ("weakest", False), (None, False)]
)
def test_a_direction_in_degrees_is_doubted(folder, direction, doubted):
    block = {"mesh": "box.obj", "density": 2000} | ({} if direction is None else {"direction": direction})
    said = " ".join(open_study(study_file(folder, block)).warnings)
    assert ("block.direction is 45 rad: if degrees are meant, write 45*deg" in said) == doubted


def test_directions_of_an_axis_in_degrees_are_doubted(folder):
    block = {"mesh": "box.obj", "density": 2000}
    file = study_file(folder, block, vary={"block.direction": [0, 30, 60]})
    assert "block.direction is 60 rad: if degrees are meant, write 60*deg" in " ".join(open_study(file).warnings)
    about_north = {"block.direction": {"normal": ["355*deg", "10*deg"]}}
    assert "degrees" not in " ".join(open_study(study_file(folder, block, uncertain=about_north)).warnings)
