"""What is hardly meant is doubted aloud; how records are scaled is told."""

import numpy as np
import pytest

from rockcli.study.open import open_study
from rockcli.study.plausibility import STILL

BLOCK = {"R": 2, "tan_alpha": 0.2}
SINE = {"shape": "sine", "a_p": 4, "T_p": 1}


def warnings_of(case=None, **more):
    return open_study({"name": "x", "case": {"block": BLOCK, **(case or {})}, **more}).warnings


class TestDoubts:
    def test_an_ordinary_study_has_none(self):
        assert warnings_of({"motion": {"pulse": SINE}}) == ()
        assert warnings_of({"initial": {"theta": "0.5*alpha"}}) == ()

    def test_nothing_moves(self):
        assert warnings_of() == (STILL,)
        assert warnings_of(curves=["pushover"]) == ()
        assert warnings_of(vary={"initial.theta": [0, 0.1]}) == ()

    @pytest.mark.parametrize(("mu", "doubted"), [(0.6, False), (10, False), (60, True)])
    def test_a_friction_in_per_cent(self, mu, doubted):
        said = warnings_of({"block": {**BLOCK, "mu": mu}, "motion": {"pulse": SINE}})
        assert any("a mu is 60: if per cent are meant, write 60/100" in one for one in said) is doubted

    @pytest.mark.parametrize(
        ("density", "words"),
        [
            (2650, ""),
            (15, ""),
            (2.65, "a density is 2.65 kg/m³: if t/m³ or g/cm³ are meant, write 2.65*1000"),
            (2.65e6, "a density is 2.65e+06 kg/m³: is it in kg/m³?"),
        ],
    )
    def test_a_density_in_other_units(self, density, words):
        outline = [[-0.3, 0], [0.3, 0], [0.2, 1.8], [-0.2, 1.8]]
        part = {"outline": outline, "density": density, "depth": 0.5}
        column = {"model": "flexible", "damping": "none", "column": {"E": 1e9, "rho": density}}
        for case in ({"block": {**part}}, {"block": {"parts": [part]}}, {"block": BLOCK, **column}):
            doubts = [one for one in warnings_of({"motion": {"pulse": SINE}, **case}) if "density" in one]
            assert [words in one for one in doubts] == [True] * bool(words)

    @pytest.mark.parametrize(
        ("limit", "words"),
        [
            (0.5, ""),
            (5, "theta/alpha > 5 is exceeded by hardly a body that does not overturn"),
            ("1/4", ""),
            ("5*deg", "5*deg is taken as theta/alpha > 0.0872665, deg being a unit: limits of the rotation are shares"),
            ("50*mm", "mm being a unit: limits of the rotation are shares of alpha; of the slide they are {slide_peak"),
            ({"slide_peak": "50*mm"}, ""),
            ({"slide_peak": 0.05}, ""),
            ({"slide_residual": 50}, "a slide of 50 m: limits of the slide are in metres"),
        ],
    )
    def test_limits_in_degrees_or_millimetres(self, limit, words):
        vary = {"motion.pulse.T_p": [0.5, 1.0], "motion.pulse.a_p": [3.0, 4.0]}
        case = {"block": {**BLOCK, "mu": 0.6}, "motion": {"pulse": SINE}}
        said = warnings_of(case, vary=vary, over={"axis": "T_p", "limits": [limit]}, save={"histories": False})
        told = [one for one in said if "limits" in one]
        assert (len(told), words in "".join(told)) == (bool(words), True)

    def test_limits_that_are_not_told(self):
        """At one strength of the motion, and of a search, overturning alone is."""
        case, over = {"motion": {"pulse": SINE}}, {"axis": "T_p", "limits": [0.3]}
        wanted = {"over": over, "save": {"histories": False}}
        periods = {"motion.pulse.T_p": [0.5, 1.0]}
        (said,) = warnings_of(case, vary=periods, **wanted)
        assert said.startswith("over.limits is not told where no intensity is varied")
        assert warnings_of(case, vary=periods, over="T_p", save={"histories": False}) == ()
        assert warnings_of(case, vary={**periods, "motion.pulse.a_p": [4.0]}, **wanted) == ()
        sought = {"from": 2.0, "to": 9.0, "n": 8, "find": "overturning"}
        (said,) = warnings_of(case, vary={**periods, "motion.pulse.a_p": sought}, over=over)
        assert said.startswith("over.limits is not told of a search")

    def test_limits_of_the_slide_of_a_body_without_friction(self):
        """It cannot slide: what is told of it is overturning, which a reader of a list may take for both."""
        blocks = {"known": {**BLOCK, "mu": 0.6}, "unknown": BLOCK}
        vary = {"block": blocks, "motion.pulse.T_p": [0.5, 1.0], "motion.pulse.a_p": [3.0, 4.0]}
        wanted = {"over": {"axis": "T_p", "limits": [{"slide_peak": 0.05}]}, "save": {"histories": False}}
        (said,) = warnings_of({"motion": {"pulse": SINE}}, vary=vary, **wanted)
        assert said.startswith("limits of the slide tell of overturning alone where a body has no mu")
        assert "block = unknown" in said
        vary["block"] = {"known": blocks["known"]}
        assert warnings_of({"motion": {"pulse": SINE}}, vary=vary, **wanted) == ()

    @pytest.mark.parametrize(
        ("vary", "where"), [("block.mu: {a: 0.5,\n    b: null}", "x.yaml:5"), ("case: t.csv", "t.csv:3")]
    )
    def test_a_friction_that_is_taken_away_is_placed_where_that_is_said(self, tmp_path, vary, where):
        (tmp_path / "t.csv").write_text("name,block.mu\na,0.5\nb,null\n")
        case = "case: {block: {h: 1.0, b: 0.2, mu: 0.4}, motion: {pulse: {shape: sine, a_p: 3, T_p: 1}}}"
        more = (
            "  motion.pulse.a_p: [3, 4]\n  motion.pulse.T_p: [0.5, 1]\nover: {axis: T_p, limits: [{slide_peak: 0.05}]}"
        )
        file = tmp_path / "x.yaml"
        file.write_text(f"name: x\n{case}\nvary:\n  {vary}\n{more}\n")
        (said,) = (each for each in open_study(file).warnings if "limits of the slide" in each)
        assert said.endswith(f"{where})")

    def test_too_strong(self):
        (said,) = warnings_of({"motion": {"pulse": {**SINE, "a_p": 400}}})
        assert "the PGA of the sine pulse is 40.77 g" in said
        relative = {"shape": "sine", "a_p_over_g_tan_alpha": 20, "T_p": 1}
        assert warnings_of({"motion": {"pulse": relative}}) == ()

    def test_a_pgv_in_other_units(self):
        record = {"values": 0.3 * np.sin(np.arange(500.0)), "dt": 0.01, "units": "g", "name": "r"}
        (said,) = (one for one in warnings_of({"motion": {"record": {**record, "pgv": 30}}}) if "units right" in one)
        assert "pgv in m/s)" in said
        for meant in ("30*m/s", 0.3):
            assert not any("units" in one for one in warnings_of({"motion": {"record": {**record, "pgv": meant}}}))

    @pytest.mark.parametrize(("zeta", "doubted"), [(0.05, False), (1.0, False), (5, True)])
    def test_a_damping_ratio_in_per_cent(self, zeta, doubted):
        floors = {"pulse": SINE, "through": [{"T": 0.5, "zeta": 0.02}, {"T": 0.3, "zeta": zeta}]}
        said = " ".join(warnings_of({"motion": floors}))
        assert (
            "motion.through[1].zeta is 5, more than critical: if per cent are meant, write 5/100" in said
        ) == doubted
        column = {"model": "flexible", "column": {"E": 1e9, "rho": 2000, "zeta": zeta}, "motion": {"pulse": SINE}}
        said = " ".join(warnings_of(column | {"block": {"h": 4, "b": 0.5}}))
        assert ("column.zeta is 5, more than critical" in said) == doubted

    def test_a_vertical_record_made_strong_by_the_factor_of_others_is_told_once(self):
        """The records are weak beside the vertical one: its units are right."""
        arrays = [{"values": 0.01 * k * np.sin(np.arange(500.0)), "dt": 0.01, "units": "g"} for k in (1, 2, 3)]
        up = {"values": np.cos(np.arange(500.0)), "dt": 0.01, "units": "g", "name": "up"}
        records = {f"r{k}": one | {"name": f"r{k}", "pga": "0.4*g"} for k, one in enumerate(arrays)}
        motion = {"record": records["r0"], "vertical": {"record": up}}
        (said,) = (one for one in warnings_of({"motion": motion}, vary={"motion.record": records}) if "than 3 g" in one)
        assert said.startswith("the vertical up takes the factor of the horizontal record")
        assert not any("units right" in one for one in warnings_of({"motion": motion}))
        own = motion | {"vertical": {"record": up | {"pga": "0.3*g"}}}
        assert not any("vertical" in one for one in warnings_of({"motion": own}))

    def test_what_says_its_unit_is_meant(self):
        for a_p in ("40*g", "400*m/s**2", "g*R/m*20"):
            assert warnings_of({"motion": {"pulse": {**SINE, "a_p": a_p}}}) == ()
        motion = {"motion": {"pulse": SINE}}
        assert warnings_of(motion, vary={"motion.pulse.a_p": ["0.5*g", "40*g"]}) == ()
        assert warnings_of(motion, vary={"motion.pulse.a_p": {"from": "0.5*g", "to": "40*g", "n": 5}}) == ()
        settings = {"weak": {"pulse": {**SINE, "a_p": "0.5*g"}}, "strong": {"pulse": {**SINE, "a_p": "40*g"}}}
        assert warnings_of(motion, vary={"motion": settings}) == ()

    def test_what_an_axis_puts_there_counts(self):
        motion = {"motion": {"pulse": {**SINE, "a_p": "4*g"}}}
        (said,) = warnings_of(motion, vary={"motion.pulse.a_p": [4, 400]})
        assert "is 40.77 g" in said
        (said,) = warnings_of(motion, vary={"motion": {"strong": {"pulse": {**SINE, "a_p": 400}}}})
        assert "is 40.77 g" in said

    def test_the_end_of_a_searched_range_is_no_motion(self):
        for to in (400, "40*g"):
            searched = {"from": 2, "to": to, "n": 5, "find": "overturning"}
            assert warnings_of({"motion": {"pulse": SINE}}, vary={"motion.pulse.a_p": searched}) == ()

    def test_too_tall(self):
        (said,) = warnings_of({"motion": {"pulse": SINE}, "block": {"height": 2100, "width": 550}})
        assert "2100 m high" in said
        rows = {"first": {"block.height": 1.8}, "second": {"block.height": 180}}
        (said,) = warnings_of({"motion": {"pulse": SINE}, "block": {"height": 2, "width": 0.5}}, vary={"case": rows})
        assert said == "a body is 180 m high: are its sizes in metres? (at case = second)"

    @pytest.mark.parametrize("given", [{"r_g": 57}, {"inertia": 800}])
    def test_too_large_a_moment_of_inertia(self, given):
        block = {"h": 1.0, "b": 0.2}
        (said,) = warnings_of({"motion": {"pulse": SINE}, "block": block | given})
        assert said.startswith("I_O/(m R²) of a body is ")
        assert said.endswith("is r_g in metres, inertia over m R²?")
        assert warnings_of({"motion": {"pulse": SINE}, "block": block | {"r_g": 2.5}}) == ()

    def test_a_wide_body_on_a_narrow_foot_is_one(self):
        beam = [[-0.1, 0], [0.1, 0], [0.1, 1], [6, 1], [6, 1.2], [-6, 1.2], [-6, 1], [-0.1, 1]]
        assert warnings_of({"motion": {"pulse": SINE}, "block": {"outline": beam}, "damping": "none"}) == ()

    def test_too_weak(self):
        (said,) = warnings_of({"motion": {"pulse": {**SINE, "a_p": "0.041*g"}}})
        assert said == "the sine pulse: PGA 0.041 g = 0.205 g tan alpha: too weak to uplift"
        (said,) = warnings_of({"motion": {"pulse": SINE}}, vary={"motion.pulse.a_p": [0.5, 1]})
        assert "PGA 0.051 to 0.102 g = 0.255 to 0.51 g tan alpha" in said

    def test_a_sweep_that_only_begins_weak_is_fine(self):
        assert warnings_of({"motion": {"pulse": SINE}}, vary={"motion.pulse.a_p": [0.5, 4]}) == ()
        a_p = {"from": 0.1, "to": 8, "n": 300}
        scales = {"motion.pulse.a_p": a_p, "motion.pulse.T_p": {"from": 0.1, "to": 2, "n": 200}}
        assert warnings_of({"motion": {"pulse": SINE}}, vary=scales) == ()

    def test_a_motion_that_uplifts_one_body_is_not_too_weak(self):
        bodies = {
            "slender": {"height": 2, "width": 0.3, "mu": 0.6},
            "stout": {"outline": [[0, 0], [2, 0], [2, 1], [0, 1]]},
        }
        weak = {"motion": {"pulse": {**SINE, "a_p": "0.3*g"}}, "damping": "none"}
        assert warnings_of(weak, vary={"block": bodies}) == ()
        assert "too weak" in warnings_of(weak, vary={"block": {"stout": bodies["stout"]}})[0]

    def test_many_that_are_too_weak_are_one_sentence(self, tmp_path):
        for i in range(5):
            (tmp_path / f"q{i}.txt").write_text(f"0 0\n0.01 {0.1 * (i + 1):.1f}\n0.02 0\n")
        record = {"file": str(tmp_path / "q0.txt"), "units": "m/s2"}
        motion = {"motion": {"record": record}, "damping": "none"}
        files = {"motion.record.file": str(tmp_path / "q*.txt")}
        bodies = {"slender": {"height": 2, "width": 0.3}, "stout": {"outline": [[0, 0], [2, 0], [2, 1], [0, 1]]}}
        (said,) = warnings_of(motion, vary={**files, "block": bodies})
        low, high = 0.1 / 9.81, 0.5 / 9.81
        assert said == (
            f"5 motions are too weak to uplift a body: PGA {low:.3g} to {high:.3g} g = {low / 2:.3g} to "
            f"{high / 0.15:.3g} g tan alpha (such as q0.txt)"
        )

    @pytest.mark.parametrize("together", [True, False])
    def test_many_that_are_too_strong_are_one_sentence(self, tmp_path, together):
        """A PGA without its g made a line for every record, 3000 for 3000."""
        for i in range(5):
            (tmp_path / f"q{i}.txt").write_text(f"0 0\n0.01 {40 + i}.0\n0.02 0\n")
        record = {"file": str(tmp_path / "q0.txt"), "units": "m/s2"}
        axes = {"motion.record.file": str(tmp_path / "q*.txt")}
        if not together:
            axes["case"] = {"flat": {"motion.vertical": {"pulse": {**SINE, "a_p": 0.1}}}}
        (said,) = warnings_of({"motion": {"record": record}}, vary=axes)
        asks = "are its units right (a_p and pga are in m/s², pgv in m/s)?"
        assert said == f"the PGA of 5 motions is {40 / 9.81:.3g} to {44 / 9.81:.3g} g (such as q4.txt): {asks}"

    def test_the_linearized_block_uplifts_at_alpha(self):
        case = {"block": {"R": 2, "tan_alpha": 1.0}, "motion": {"pulse": {**SINE, "a_p": "0.9*g"}}}
        assert "too weak" in warnings_of(case)[0]
        assert warnings_of({**case, "model": "linearized"}) == ()

    def test_an_upward_motion_may_help(self):
        weak = {"pulse": {**SINE, "a_p": "0.19*g"}}
        assert "too weak" in warnings_of({"motion": weak})[0]
        assert warnings_of({"motion": {**weak, "vertical": {"pulse": {**SINE, "a_p": "0.1*g"}}}}) == ()


@pytest.fixture
def record(tmp_path):
    path = tmp_path / "quake.txt"
    t = np.arange(400) * 0.01
    values = 0.3 * np.sin(2 * np.pi * t) * np.exp(-t)
    path.write_text("# units: g\n" + "".join(f"{a:.2f} {b:.10e}\n" for a, b in zip(t, values, strict=True)))
    return {"file": str(path)}


class TestScaling:
    def told(self, record, vary=None, **motion):
        study = open_study(
            {"name": "x", "case": {"block": BLOCK, "motion": {"record": record, **motion}}, "vary": vary or {}}
        )
        return study.processing

    def test_to_a_pga(self, record):
        ((said,),) = self.told({**record, "pga": "0.4*g"}).values()
        raw = 0.3 * np.abs(np.sin(2 * np.pi * (t := np.arange(400) * 0.01)) * np.exp(-t)).max()
        assert said.startswith(f"scaled by {0.4 / raw:.6g} to pga 0.4 g: PGA {raw:.4g} -> 0.4 g, PGV ")
        assert said.endswith("m/s")

    @pytest.mark.parametrize(
        ("key", "value", "words"),
        [
            ("scale", 0.5, "scaled by 0.5: PGA"),
            ("pgv", 0.2, " to pgv 0.2 m/s: PGA"),
            ("pga_over_g_tan_alpha", 2, " to pga_over_g_tan_alpha 2: PGA"),
        ],
    )
    def test_other_ways(self, record, key, value, words):
        assert words in self.told({**record, key: value})["quake.txt"][-1]

    def test_unscaled_and_turned(self, record):
        assert self.told(record)["quake.txt"][-1].startswith("not scaled: PGA 0.")
        assert "turned by polarity -1" in self.told({**record, "polarity": -1})["quake.txt"][-1]

    def test_a_factor_that_varies(self, record):
        said = self.told(record, vary={"motion.record.scale": [0.5, 2], "model": ["rigid", "linearized"]})
        assert said["quake.txt"][-1].startswith("scaled by factors from 0.5 to 2, case by case: PGA")
        assert len(said) == 1

    def test_the_raw_measures_stay_known(self, record):
        steps = self.told({**record, "lowpass": 1, "scale": 2})["quake.txt"]
        assert steps[0].startswith("lowpass")
        assert "; in the file PGA 0." in steps[-1]

    def test_an_inherited_factor(self, record):
        said = self.told({**record, "scale": 2}, vertical=record)
        assert {steps[-1].split(": ")[0] for steps in said.values()} == {
            "scaled by 2",
            "scaled by 2, the horizontal factor",
        }

    def test_it_is_in_the_dataset(self, record):
        import rockcli

        study = {"case": {"block": BLOCK, "motion": {"record": {**record, "pga": "0.4*g"}}}}
        assert "to pga 0.4 g" in rockcli.run(study).attrs["processing"]


def all_warnings(case):
    """Of the study, and of its batches."""
    study = open_study({"name": "x", "case": case})
    return [*study.warnings, *(sentence for _, batch in study.batches() for sentence in batch.warnings)]


class TestTimeAndAngles:
    @pytest.mark.parametrize(("step", "doubted"), [(5, True), (20, True), (0.005, False), (0.1, False)])
    def test_a_column_of_time_in_milliseconds(self, tmp_path, step, doubted):
        (tmp_path / "q.txt").write_text("".join(f"{i * step:g} {(-1) ** i}\n" for i in range(20)))
        record = {"file": str(tmp_path / "q.txt"), "units": "m/s2"}
        said = " ".join(all_warnings({"block": {"R": 2, "tan_alpha": 0.2}, "motion": {"record": record}}))
        assert (f"the time step is {step:g} s: is the time in seconds, and not in ms?" in said) == doubted

    @pytest.mark.parametrize(
        ("angle", "doubted"), [(30, True), (-45, True), ("30*deg", False), (0.5, False), ("2*pi", False)]
    )
    def test_a_direction_in_degrees(self, tmp_path, angle, doubted):
        for name in ("q.txt", "r.txt"):
            (tmp_path / name).write_text("0 0\n0.01 3\n0.02 0\n")
        files = [str(tmp_path / name) for name in ("q.txt", "r.txt")]
        record = {"file": files, "units": "m/s2", "angle": angle}
        said = " ".join(all_warnings({"block": {"R": 2, "tan_alpha": 0.2}, "motion": {"record": record}}))
        assert ("if degrees are meant" in said) == doubted
        assert ("write 30*deg" in said) == (angle == 30)


def test_a_geometry_that_no_model_has_is_told():
    motion = {"motion": {"pulse": SINE}, "geometry": "corotational"}
    (said,) = warnings_of(motion)
    assert said.startswith("geometry is ignored")
    assert warnings_of(motion, vary={"model": ["rigid", 1]}) == ()
    assert warnings_of({**motion, "model": "auto"}) == ()


def test_a_column_that_no_model_reads_is_told():
    motion = {"motion": {"pulse": SINE}, "column": {"E": "30*GPa", "rho": 2500}}
    (said,) = warnings_of(motion)
    assert said.startswith("column is ignored")
    for model in ("auto", "flexible", 4):
        assert warnings_of({**motion, "model": model}) == ()
    assert warnings_of(motion, vary={"model": ["rigid", "flexible"]}) == ()


@pytest.mark.parametrize(
    ("vary", "key"),
    [
        ({"column.E": [1e10, 3e10]}, "column"),
        ({"geometry": ["corotational", "negative_stiffness"]}, "geometry"),
        ({"case": {"stiff": {"column": {"E": 3e10, "rho": 2500}}, "as it is": {}}}, "column"),
    ],
)
def test_what_only_an_axis_says_and_no_model_reads_is_told(vary, key):
    (said,) = warnings_of({"motion": {"pulse": SINE}}, vary=vary)
    assert said.startswith(f"{key} is ignored")


def test_a_negative_eta_is_told_with_the_body_it_is_of(tmp_path):
    free = "initial: {theta: 0.1}"
    (tmp_path / "t.csv").write_text("name,block.h,block.b\ntall,2,1.0\nflat,1,1.5\n")
    (tmp_path / "x.yaml").write_text(f"name: x\ncase:\n  block: {{h: 1, b: 0.2}}\n  {free}\nvary: {{case: t.csv}}\n")
    (said,) = open_study(tmp_path / "x.yaml").warnings
    assert "eta is negative" in said
    assert said.endswith("(at case = flat, t.csv:3)")
    for vary, where in (("vary:\n  block.b: [0.2, 1.5]\n", "(at block.b = 1.5, x.yaml:6)"), ("", "(at x.yaml:3)")):
        (tmp_path / "x.yaml").write_text(f"name: x\ncase:\n  block: {{h: 1, b: 1.5}}\n  {free}\n{vary}")
        (said,) = open_study(tmp_path / "x.yaml").warnings
        assert said.endswith(where)
    given = {"block": {"h": 1, "b": 1.5}, "initial": {"theta": 0.1}, "damping": {"scheme": "restitution", "eta": 0.5}}
    assert warnings_of(given) == ()


def test_where_a_study_lies_is_no_matter(tmp_path):
    """Warnings are in the dataset, whose checksum is that of a copy elsewhere."""
    found = []
    for folder in (tmp_path / "a", tmp_path / "elsewhere"):
        (folder / "lists").mkdir(parents=True)
        (folder / "lists" / "t.csv").write_text("name,block.h,block.b\nhigh,100,9\n")
        (folder / "x.yaml").write_text(
            "name: x\ncase: {block: {h: 1, b: 1}, initial: {theta: 0.01}}\nvary: {case: lists/t.csv}\n"
        )
        found.append(open_study(folder / "x.yaml").warnings)
    assert found[0] == found[1]
    assert found[0][0].endswith("(at case = high, lists/t.csv:2)")


@pytest.mark.parametrize(
    ("vary", "named"),
    [
        ({"motion.pulse.T_p": [0.5, 1], "block.R": [2, 80], "model": ["rigid", "linearized"]}, "(at block.R = 80"),
        ({"case": {"weak": {"motion": {"pulse": {**SINE, "a_p": 3}}}}, "block.R": [80]}, "(at block.R = 80"),
        ({"motion.pulse.T_p": [0.5, 1], "case": {"high": {"block.R": 80}}}, "(at case = high"),
    ],
)
def test_a_doubted_body_is_named_by_the_axes_that_make_it(vary, named):
    (said,) = warnings_of({"motion": {"pulse": SINE}}, vary=vary)
    assert said.startswith("a body is 156.9 m high")
    assert named in said


FALLING = {"pulse": SINE, "vertical": {"pulse": {"shape": "sine", "a_p": "1.5*g", "T_p": 0.4}}}


class TestFallingGround:
    """g + a_v < 0: of a sine of 1.5 g and 0.4 s from 0.2 s + asin(2/3)/(5 pi) on."""

    def told(self, case=None, **more):
        return [said for said in warnings_of({"motion": FALLING, **(case or {})}, **more) if "falls away" in said]

    def test_cases_are_counted_and_the_first_time_told(self):
        amplitudes = {"motion.vertical.pulse.a_p": ["0.5*g", "0.99*g", "1.5*g", "1.2*g"]}
        (said,) = self.told(vary=amplitudes)
        assert "(g + a_v < 0) in 2 of 4 cases," in said
        assert float(said.split("t = ")[1].split(" s")[0]) == pytest.approx(
            0.2 + np.arcsin(2.0 / 3.0) / (5.0 * np.pi), abs=1e-3
        )
        many = {"motion.vertical.pulse.a_p": {"from": "0.5*g", "to": "1.5*g", "n": 201}, "block.R": [*range(1, 151)]}
        (said,) = self.told(vary=many)
        assert "cases looked at" in said

    def test_of_a_record(self, tmp_path):
        t = 0.01 * np.arange(100)
        np.savetxt(tmp_path / "v.txt", np.column_stack([t, np.sin(5.0 * np.pi * t)]))
        record = {"file": str(tmp_path / "v.txt"), "units": "g"}
        vertical = {"pulse": SINE, "vertical": {"record": record}}
        scales = {"motion.vertical.record.scale": [0.9, 1.5]}
        (said,) = [one for one in warnings_of({"motion": vertical}, vary=scales) if "falls away" in one]
        assert "in 1 of 2 cases, first at t = 0.25 s" in said

    def test_who_leaves_the_ground_or_is_not_there_any_more(self):
        column = {"model": "flexible", "column": {"E": 3e10, "rho": 2500}}
        assert len(self.told({"model": "linearized"})) == len(self.told(column)) == 1
        for case in (
            {"block": {**BLOCK, "mu": 0.6}},
            {**column, "base": {"law": "winkler", "kw": 1e9}},
            {"motion": {**FALLING, "duration": 0.24}},
        ):
            assert self.told(case) == []
