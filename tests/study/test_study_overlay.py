"""Settings are laid over the base case key by key: each point is the study that one would write out by hand."""

import pytest
import yaml

from rockcli.errors import StudyError
from rockcli.study.open import open_study

RECORD = "synthetic_rock_m65.AT2"
OTHER = "synthetic_pulse_m70.AT2"
SINE = {"shape": "sine", "a_p": 4, "omega_p": 6, "cycles": 2}
BASE = {
    "block": {"R": 2, "tan_alpha": 0.2, "top": 3.0, "mu": 0.6},
    "motion": {"pulse": SINE, "duration": 9},
    "damping": {"scheme": "restitution", "eta": 0.9},
    "initial": {"theta": 0.01},
}


def cases_of(case, vary=None, overrides=()):
    """The checked case of every point, short forms written out."""
    study = {"name": "x", "case": case} | ({"vary": vary} if vary else {})
    opened = open_study(study, overrides=overrides)
    points = [(i,) for i in range(opened.size)] if opened.cases.structural else [()]
    return [_said(opened.cases.checked(point)[0]["case"]) for point in points]


def _said(tree):
    """Without what says nothing."""
    if not isinstance(tree, dict):
        return tree
    said = {key: _said(item) for key, item in tree.items() if item is not None}
    return {key: item for key, item in said.items() if item != {}}


def one(vary, case=BASE):
    """The case of the only point of an axis."""
    ((path, value),) = vary.items()
    (made,) = cases_of(case, {path: {"a": value}})
    return made


def merged(**parts):
    """The base case with some of its parts written anew."""
    return cases_of({**BASE, **parts})[0]


class TestKeyByKey:
    """(axis and setting, what changes in the base case when it is written out by hand)."""

    @pytest.mark.parametrize(
        ("vary", "by_hand"),
        [
            ({"block": {"mu": 0.3}}, {"block": {**BASE["block"], "mu": 0.3}}),
            ({"case": {"block": {"mu": 0.3}}}, {"block": {**BASE["block"], "mu": 0.3}}),
            ({"case": {"block.mu": 0.3}}, {"block": {**BASE["block"], "mu": 0.3}}),
            ({"motion": {"pulse": {"cycles": 1}}}, {"motion": {"pulse": {**SINE, "cycles": 1}, "duration": 9}}),
            ({"motion": {"pulse.cycles": 1}}, {"motion": {"pulse": {**SINE, "cycles": 1}, "duration": 9}}),
            ({"case": {"motion.pulse.cycles": 1}}, {"motion": {"pulse": {**SINE, "cycles": 1}, "duration": 9}}),
            (
                {"case": {"motion": {"pulse": {"a_p": 5}}, "initial": {"theta_dot": 0.1}}},
                {
                    "motion": {"pulse": {**SINE, "a_p": 5}, "duration": 9},
                    "initial": {"theta": 0.01, "theta_dot": 0.1},
                },
            ),
            ({"damping": {"scheme": "restitution"}}, {}),
            ({"solver": {"accuracy": "draft"}}, {"solver": {"accuracy": "draft"}}),
        ],
    )
    def test_what_a_setting_does_not_say_stays(self, vary, by_hand):
        assert one(vary) == merged(**by_hand)

    @pytest.mark.parametrize("first", ["pulse", "record"])
    def test_nulls_of_a_record_leave_the_pulse_and_the_other_way_round(self, first, tmp_path):
        """Rows of pulses and of records in one table, whichever columns stand first."""
        columns = {"pulse": {"a_p": ("5", "null")}, "record": {"file": ("null", OTHER), "pga": ("null", "3")}}
        order = [first, *(columns.keys() - {first})]
        head = [f"motion.{key}.{name}" for key in order for name in columns[key]]
        rows = [[cells[i] for key in order for cells in columns[key].values()] for i in range(2)]
        lines = [["name", *head], ["a", *rows[0]], ["b", *rows[1]]]
        (tmp_path / "motions.csv").write_text("\n".join(",".join(line) for line in lines))
        pulse, record = cases_of(BASE, {"case": str(tmp_path / "motions.csv")})
        assert pulse == merged(motion={"pulse": {**SINE, "a_p": 5}, "duration": 9})
        assert record == merged(motion={"record": {"file": OTHER, "pga": 3}, "duration": 9})

    @pytest.mark.parametrize(
        "point",
        [
            {"motion.pulse.a_p": 5, "motion.record.file": OTHER},
            {"motion.record": OTHER, "motion.pulse": SINE | {"a_p": 5}},
            {"motion.vertical.record.file": OTHER, "motion.vertical.pulse.shape": "ricker"},
        ],
    )
    def test_a_point_is_of_a_pulse_or_of_a_record(self, point):
        """Which of them counted hung on their order, and of two points on that of the first."""
        names = [next(key for key in point if word in key) for word in ("pulse", "record")]
        with pytest.raises(StudyError, match=r"vary\.case\.a: .*(exclude each other|say the same thing)") as error:
            one({"case": point})
        assert all(name in str(error.value) for name in names)

    def test_the_top_of_the_base_case_is_not_lost(self):
        assert one({"block": {"height": 2.0, "width": 0.5}})["block"]["top"] == 3.0

    def test_settings_in_a_list_too(self):
        (made,) = cases_of(BASE, {"initial": [{"theta_dot": 0.1}]})
        assert made["initial"] == {"theta": 0.01, "theta_dot": 0.1}

    @pytest.mark.parametrize(
        ("path", "left"),
        [
            ("damping", {"damping": {}}),
            ("damping.scheme", {"damping": {"eta": 0.9}}),
            ("initial", {"initial": {}}),
            ("initial.theta", {"initial": {}}),
            ("motion.duration", {"motion": {"pulse": SINE}}),
            ("solver.accuracy", {}),
            ("model", {}),
            ("g", {}),
        ],
    )
    def test_null_takes_a_key_away_whatever_it_is(self, path, left):
        (made,) = cases_of(BASE, {"case": {"a": {path: None}}})
        assert made == merged(**left)
        assert cases_of(BASE, overrides=[(f"case.{path}", "null")]) == [made]

    def test_null_takes_a_key_away_from_a_base_case_that_says_more(self):
        more = {"model": {"name": "linearized"}, "g": 3.7, "solver": {"accuracy": "draft", "backend": "event"}}
        made = one({"case": {"model": None, "g": None, "solver.accuracy": None}}, {**BASE, **more})
        assert made == merged(solver={"backend": "event"})

    def test_and_set(self):
        (made,) = cases_of(BASE, overrides=[("case.initial", "{theta_dot: 0.1}"), ("case.block", "{h: 1, b: 0.2}")])
        assert made["initial"] == {"theta": 0.01, "theta_dot": 0.1}
        assert made["block"] == {"h": 1, "b": 0.2, "top": 3.0, "mu": 0.6}

    @pytest.mark.parametrize("base", [{"R": 2, "tan_alpha": 0.2}, {"outline": [[0, 0], [1, 0], [1, 4], [0, 4]]}])
    def test_two_sizes_by_two_options_are_those_of_the_body(self, base):
        base = {"block": base | {"top": 3.0}, "initial": {"theta": 0.01}}
        sets = [("case.block.b", "0.3"), ("case.block.R", "1.5"), ("case.block.b", "0.2")]
        for given in (sets, sets[1:], sets[:0:-1]):
            (made,) = cases_of(base, overrides=given)
            assert made["block"] == {"R": 1.5, "b": float(dict(given)["case.block.b"]), "top": 3.0}
        for wrong in ([*sets, ("case.block.height", "3")], sets[:1]):
            with pytest.raises(StudyError, match=r"R|outline"):
                open_study({"name": "x", "case": base}, overrides=wrong)

    def test_what_is_no_part_of_the_case_is_set_as_a_whole(self):
        study = {"name": "x", "case": BASE, "vary": {"block.mu": {"from": 0.3, "to": 0.6, "n": 2, "spacing": "log"}}}
        opened = open_study(study, overrides=[("vary.block.mu", "{from: 0.2, to: 0.6, n: 3}")])
        assert opened.axes[0].values == pytest.approx([0.2, 0.4, 0.6])

    def test_the_vertical_motion_in_short(self):
        base = {**BASE, "motion": {"record": RECORD, "vertical": {"file": RECORD, "scale": 0.5}}}
        made = one({"motion": {"vertical": {"polarity": -1}}}, base)
        assert made["motion"]["vertical"] == {"record": {"file": RECORD, "scale": 0.5, "polarity": -1}}


class TestAlternatives:
    @pytest.mark.parametrize(
        ("vary", "by_hand"),
        [
            ({"motion": {"record": {"file": RECORD}}}, {"motion": {"record": {"file": RECORD}, "duration": 9}}),
            (
                {"case": {"motion": {"record": RECORD, "vertical": OTHER}}},
                {"motion": {"record": RECORD, "vertical": {"record": OTHER}, "duration": 9}},
            ),
            (
                {"motion.pulse": {"T_p": 1.0, "a_p_over_g_tan_alpha": 2}},
                {
                    "motion": {
                        "pulse": {"shape": "sine", "cycles": 2, "T_p": 1.0, "a_p_over_g_tan_alpha": 2},
                        "duration": 9,
                    }
                },
            ),
            (
                {"motion": {"pulse": {"shape": "ricker"}}},
                {"motion": {"pulse": {"shape": "ricker", "a_p": 4, "omega_p": 6}, "duration": 9}},
            ),
            ({"damping": {"r_energy": 0.8}}, {"damping": {"scheme": "restitution", "r_energy": 0.8}}),
            (
                {"damping": {"scheme": "dashpot", "coefficient": 0.03}},
                {"damping": {"scheme": "dashpot", "coefficient": 0.03}},
            ),
            ({"block": {"slenderness": 4}}, {"block": {"R": 2, "slenderness": 4, "top": 3.0, "mu": 0.6}}),
            ({"block": {"h": 1, "width": 0.5}}, {"block": {"h": 1, "width": 0.5, "top": 3.0, "mu": 0.6}}),
            (
                {"case": {"block.height": 2.0, "block.width": 0.5}},
                {"block": {"height": 2.0, "width": 0.5, "top": 3.0, "mu": 0.6}},
            ),
            (
                {"block": {"outline": [[0, 0], [0.5, 0], [0.5, 2], [0, 2]]}},
                {"block": {"outline": [[0, 0], [0.5, 0], [0.5, 2], [0, 2]], "top": 3.0, "mu": 0.6}},
            ),
        ],
    )
    def test_one_takes_the_place_of_the_others(self, vary, by_hand):
        assert one(vary) == merged(**by_hand)

    def test_sizes_take_the_place_of_an_outline(self):
        base = {**BASE, "block": {"outline": [[0, 0], [0.5, 0], [0.5, 2], [0, 2]], "density": 2000, "mu": 0.4}}
        assert one({"block": {"R": 2, "alpha": 0.2}}, base)["block"] == {"R": 2, "alpha": 0.2, "mu": 0.4}

    def test_a_table_of_sizes(self, tmp_path):
        (tmp_path / "bodies.csv").write_text("name,block.height,block.width\na,2,0.5\nb,3,0.5\n")
        (tmp_path / "s.yaml").write_text(yaml.dump({"name": "x", "case": BASE, "vary": {"case": "bodies.csv"}}))
        ((_, batch),) = open_study(tmp_path / "s.yaml").batches()
        assert batch.block.h == pytest.approx([1.0, 1.5])
        assert batch.block.top == pytest.approx([3.0, 3.0])

    @pytest.mark.parametrize(
        ("rows", "said"),
        [
            ("block.R\na,2\nb,null\n", r"under-determined.*\(at case = b\)"),
            ("block.h\na,null\nb,0.4\n", r"over-determined.*\(at case = b\)"),
        ],
    )
    def test_the_row_whose_sizes_do_not_suit_is_named(self, tmp_path, rows, said):
        (tmp_path / "bodies.csv").write_text("name," + rows)
        study = {"name": "x", "case": BASE, "vary": {"case": "bodies.csv", "motion.pulse.a_p": [2, 3]}}
        (tmp_path / "s.yaml").write_text(yaml.dump(study))
        with pytest.raises(StudyError, match=said):
            list(open_study(tmp_path / "s.yaml").batches())

    @pytest.mark.parametrize(
        ("vary", "expected"),
        [
            ({"block": {"h": 1.5}}, "over-determined by R, h, tan_alpha"),
            ({"motion": {"pulse": {"shape": "sine"}, "record": {"file": RECORD}}}, "a pulse or a record, not both"),
            ({"damping": {"coefficient": 0.02}}, "coefficient: is no key of the damping scheme restitution"),
            ({"motion": {"record": {"pga": 3}}}, "the key 'file' is missing in case.motion.record"),
            ({"case": {"block": {"mu": 0.5}, "block.mu": 0.4}}, "block.mu and block.mu say the same thing"),
            ({"motion": {"pulse": {"a_p": 3}, "pulse.a_p_over_g_tan_alpha": 2}}, "say the same thing"),
            ({"motion": {"puls.a_p": 3}}, "'motion.puls.a_p' is not a path inside the case"),
            ({"case": {"let": {"k": 3}}}, "a symbol of `let` is set by itself, as let.NAME"),
        ],
    )
    def test_what_cannot_stand_together_is_said(self, vary, expected):
        with pytest.raises(StudyError, match=expected):
            one(vary)


class TestWordsAndNothing:
    def test_a_word_stands_for_the_whole(self):
        assert one({"damping": "restitution"})["damping"] == {"scheme": "restitution"}
        assert one({"case": {"damping": "none"}})["damping"] == {"scheme": "none"}

    @pytest.mark.parametrize("nothing", [None, "none"])
    @pytest.mark.parametrize("path", ["motion", "case"])
    def test_no_motion(self, path, nothing):
        value = nothing if path == "motion" else {"motion": nothing}
        still, moved = cases_of(BASE, {path: {"still": value, "moved": {"initial": {}} if path == "case" else {}}})
        assert "motion" not in still
        assert moved["motion"] == {"pulse": SINE, "duration": 9}

    def test_an_empty_setting_is_the_base_case(self):
        as_it_is, other = cases_of(BASE, {"case": {"as it is": {}, "other": {"block": {"mu": 0.1}}}})
        assert as_it_is["block"] == {"R": 2, "tan_alpha": 0.2, "top": 3.0, "mu": 0.6}
        assert other["block"]["mu"] == 0.1
        study = open_study({"name": "x", "case": BASE, "vary": {"case": {"as it is": {}, "other": {"g": 9}}}})
        assert not study.warnings
        assert open_study(yaml.safe_load(study.resolved_yaml)).identity == study.identity

    def test_null_takes_a_key_away_and_displaces_nothing(self):
        assert one({"block": {"top": None}})["block"] == {"R": 2, "tan_alpha": 0.2, "mu": 0.6}
        assert one({"motion": {"record": None}})["motion"] == {"pulse": SINE, "duration": 9}
        assert one({"block": {"mu": None, "h": None}})["block"] == {"R": 2, "tan_alpha": 0.2, "top": 3.0}

    @pytest.mark.parametrize(
        "setting", [{"motion": None}, {"motion": "none"}, {"motion": {"pulse": None}}, {"block": {"top": None}}]
    )
    def test_it_survives_the_resolved_study(self, setting):
        vary = {"case": {"bare": setting, "as it is": {"initial": {"theta": 0.01}}}}
        first = open_study({"name": "x", "case": BASE, "vary": vary})
        again = open_study(yaml.safe_load(first.resolved_yaml))
        assert again.identity == first.identity
        for i in range(2):
            assert _said(again.cases.checked((i,))[0]["case"]["motion"]) == _said(
                first.cases.checked((i,))[0]["case"]["motion"]
            )
            assert again.cases.checked((i,))[0]["case"]["block"].get("top") == first.cases.checked((i,))[0]["case"][
                "block"
            ].get("top")

    @pytest.mark.parametrize(
        ("path", "setting"),
        [("motion.record", RECORD), ("motion", {"record": RECORD}), ("case", {"motion": {"record": RECORD}})],
    )
    def test_a_word_that_drops_what_is_said_of_a_record_says_so(self, path, setting):
        base = {**BASE, "motion": {"record": {"file": OTHER, "pga": 3}}}
        said = open_study({"name": "x", "case": base, "vary": {path: {"a": setting}}}).warnings
        assert any(f"the axis {path} replaces the whole record, `pga` with it" in sentence for sentence in said)
        spelt = open_study({"name": "x", "case": base, "vary": {"motion": {"a": {"record": {"file": RECORD}}}}})
        assert not any("replaces" in sentence for sentence in spelt.warnings)
        assert spelt.cases.checked((0,))[0]["case"]["motion"]["record"]["pga"] == 3


def test_a_case_that_is_all_in_its_settings():
    settings = {"case": {"a": {"block": BASE["block"], "initial.theta": 0.1}}}
    assert cases_of({}, settings) == [{"block": BASE["block"], "initial": {"theta": 0.1}}]
    assert yaml.safe_load(open_study({"name": "x", "case": {}, "vary": settings}).resolved_yaml)["case"] == {}


class TestOwnSymbols:
    def test_they_stand_for_nothing_but_themselves(self):
        study = {"name": "x", "let": {"q": 0.01, "pga": 2}, "case": {**BASE, "initial": {"theta": "q*pga"}}}
        study["vary"] = {"case": {"a": {"let.scale": 3, "initial.theta_dot": "scale*0.01"}}}
        opened = open_study(study)
        ((_, batch),) = opened.batches()
        assert batch.theta_0 == pytest.approx([0.02])
        assert batch.theta_dot_0 == pytest.approx([0.03])


class TestIdentity:
    @staticmethod
    def kin(vary, **case):
        return open_study({"name": "x", "case": {**BASE, **case}, "vary": vary}).sweep_id

    def test_what_no_point_leaves_does_not_count(self):
        vary = {"block": {"a": {"h": 1, "b": 0.2}, "b": {"h": 2, "b": 0.3}}}
        assert self.kin(vary) == self.kin(vary, block={"height": 3, "slenderness": 4, "top": 3.0, "mu": 0.6})
        assert self.kin(vary) != self.kin(vary, block={"R": 2, "tan_alpha": 0.2, "top": 2.0, "mu": 0.6})

    def test_what_one_point_leaves_counts(self):
        vary = {"block": {"a": {"h": 1, "b": 0.2}, "b": {"mu": 0.3}}}
        assert self.kin(vary) != self.kin(vary, block={"R": 3, "tan_alpha": 0.2, "top": 3.0, "mu": 0.6})

    def test_the_motion_that_is_taken_away(self):
        vary = {"motion": {"still": None, "record": {"record": {"file": RECORD}, "duration": 4}}}
        assert self.kin(vary) == self.kin(vary, motion={"pulse": {**SINE, "a_p": 5}, "duration": 8})
