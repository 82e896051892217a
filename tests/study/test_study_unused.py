"""What a study says and nobody reads is said to be ignored."""

import numpy as np
import pytest
import yaml

from rockcli.study.open import open_study

BLOCK = {"R": 2.0, "tan_alpha": 0.2}
PULSE = {"shape": "ricker", "a_p": 7, "omega_p": "3*pi"}


def warnings_of(solver, **case):
    study = {"name": "x", "case": {"block": BLOCK, "motion": {"pulse": PULSE}, "solver": solver, **case}}
    ((_, batch),) = open_study(study).batches()
    return [sentence for sentence in batch.warnings if "ignored" in sentence]


@pytest.mark.parametrize(("top", "said"), [(None, False), (4.0 / np.hypot(1.0, 0.2), False), (2.5, True)])
def test_a_top_of_its_own_is_said_to_have_no_use_in_a_column(top, said):
    case = {"block": BLOCK | ({} if top is None else {"top": top}), "motion": {"pulse": PULSE}}
    for model, more in (("flexible", {"column": {"E": 1e10, "rho": 2000}}), ("rigid", {})):
        ((_, batch),) = open_study({"name": "x", "case": case | {"model": model} | more}).batches()
        told = any(sentence.startswith("block.top has no use in model flexible") for sentence in batch.warnings)
        assert told == (said and model == "flexible")


@pytest.mark.parametrize(
    ("case", "who"),
    [
        ({"model": "flexible", "column": {"E": 1e10, "rho": 2000}}, "model flexible"),
        ({"model": "auto", "column": {"E": 1e10, "rho": 2000}}, "model flexible"),
        ({"model": "auto"}, ""),
        ({"model": 3, "solver": {"backend": "frame"}}, "backend frame"),
        ({"solver": {"backend": "scipy"}}, "backend scipy"),
        ({"damping": "fema356"}, "backend fema356"),
        ({}, ""),
        ({"model": "linearized", "solver": {"backend": "event"}}, ""),
    ],
)
@pytest.mark.parametrize("mu", [0.1, 0.5, {"static": 0.6, "kinetic": 0.5}, None])
def test_friction_that_nothing_looks_at_is_said(case, who, mu):
    block = BLOCK if mu is None else BLOCK | {"mu": mu}
    said = [each for each in warnings_of(**{"solver": {}, "block": block} | case) if each.startswith("block.mu")]
    assert said == ([f"block.mu is ignored by {who}, which solves no sliding"] if who and mu is not None else [])


@pytest.mark.parametrize(
    ("save", "keys"),
    [
        ({"histories": True, "scalars": ["outcome"]}, ["histories", "scalars"]),
        ({"histories": {"tan_alpha": 0.1}}, ["histories"]),
        ({"histories": False, "dt_out": 0.01}, []),
        (None, []),
    ],
)
def test_what_a_search_does_not_save_is_said(save, keys):
    searched = {"motion.pulse.a_p": {"from": 1, "to": 9, "n": 3, "find": "overturning"}}
    vary = {"block.tan_alpha": [0.1, 0.2], **searched}
    study = {"name": "x", "case": {"block": BLOCK, "motion": {"pulse": PULSE}}, "vary": vary}
    told = open_study(study | ({} if save is None else {"save": save})).warnings
    assert list(told) == [
        f"save.{key} has no effect: a search (`find`) keeps the values it finds alone" for key in keys
    ]


@pytest.mark.parametrize(("backend", "told"), [("auto", True), ("event", True), ("frame", False), ("opensees", False)])
def test_fibres_that_a_base_does_not_have_are_said(backend, told):
    base = {"law": "winkler", "kw": 1e10, "fibres": 11}
    case = {"model": "flexible", "column": {"E": 1e10, "rho": 2000}, "base": base}
    said = [each for each in warnings_of({"backend": backend}, **case) if "fibres" in each]
    assert bool(said) == told
    assert all(each.startswith("base.fibres is ignored by backend event") for each in said)


@pytest.mark.parametrize(
    ("model", "column", "ignored"),
    [
        ("flexible", {"E": "30*GPa", "rho": 2500, "across": 3, "mass": "lumped"}, ["across"]),
        ("continuum", {"E": "30*GPa", "rho": 2500, "mass": "lumped", "zeta": 0.01}, ["mass"]),
        ("4", {"elements": 20, "zeta": 0.01, "rho": 2500}, ["rho", "zeta"]),
        ("continuum", {"E": "30*GPa", "rho": 2500, "across": 3, "elements": 9}, []),
    ],
)
def test_keys_of_a_column_that_the_model_does_not_read_are_told(model, column, ignored):
    backend = {"4": "frame", "continuum": "calculix"}.get(model, "auto")
    damping = {"scheme": "hht" if model == "4" else "none"}
    case = {"model": model, "column": column, "damping": damping}
    told = [each for each in warnings_of({"backend": backend}, **case) if each.startswith("column.")]
    assert [each.split()[0] for each in told] == [f"column.{key}" for key in ignored]


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ({}, True),
        ({"case": {"block": BLOCK | {"mu": 0.3}}}, False),
        ({"vary": {"block.mu": [0.2, 0.3]}}, False),
        ({"vary": {"block": {"a": BLOCK | {"mu": 0.3}, "b": BLOCK}}}, False),
        ({"vary": {"case": {"a": {"block": {"mu": 0.3}}, "b": {}}}}, False),
        ({"vary": {"case": {"a": {"block.mu": 0.3}, "b": {}}}}, False),
        ({"vary": {"block.R": [1.0, 2.0]}}, True),
        ({"uncertain": {"block.mu": {"uniform": [0.2, 0.5]}}}, False),
        ({"rules": ["west"]}, False),
    ],
)
def test_a_rule_about_sliding_without_friction_is_said(more, told):
    study = {"name": "x", "case": {"block": BLOCK, "motion": {"pulse": PULSE}}, "rules": ["west", "asce43_sliding"]}
    more = more | ({"case": study["case"] | more["case"]} if "case" in more else {})
    said = [each for each in open_study(study | more).warnings if each.startswith("rules: asce43_sliding says nothing")]
    assert bool(said) == told


class TestSolverKeys:
    @pytest.mark.parametrize(
        ("solver", "keys", "backend"),
        [
            ({"dt": 0.1}, ["dt"], "event"),
            (
                {"method": "RK45", "events": False, "yield_rotation": 1e-4},
                ["method", "events", "yield_rotation"],
                "event",
            ),
            ({"backend": "event", "dt": 0.1, "rtol": 1e-9}, ["dt"], "event"),
            ({"backend": "scipy", "dt": 0.1, "method": "RK45", "events": True}, ["dt"], "scipy"),
            ({"backend": "frame", "events": True, "dt": 0.1, "yield_rotation": 1e-4}, ["events"], "frame"),
        ],
    )
    def test_ignored_ones_are_named_with_the_backend(self, solver, keys, backend):
        said = warnings_of(solver)
        assert len(said) == len(keys)
        for key, sentence in zip(keys, said, strict=True):
            assert sentence.startswith(f"solver.{key} is ignored by backend {backend}")
            assert ("which auto takes" in sentence) == ("backend" not in solver)

    @pytest.mark.parametrize(
        "solver",
        [{}, {"accuracy": "draft"}, {"rtol": 1e-9}, {"backend": "scipy", "method": "RK45", "events": False}],
    )
    def test_used_ones_are_not(self, solver):
        assert warnings_of(solver) == []

    def test_the_equivalent_linear_method_has_no_settings(self):
        (said,) = warnings_of({"accuracy": "draft"}, damping="fema356")
        assert said.startswith("solver.accuracy is ignored by backend fema356, which auto takes")

    def test_the_flexible_body_is_solved_in_steps(self):
        flexible = {"model": "flexible", "column": {"E": "30*GPa", "rho": 2500}}
        assert warnings_of({"dt": 0.001}, **flexible) == []
        (said,) = warnings_of({"rtol": 1e-9}, **flexible)
        assert "solver.rtol is ignored by backend event (flexible)" in said


class TestSymbols:
    @staticmethod
    def unused(let, vary=None, **case):
        study = {"name": "x", "let": let, "case": {"block": BLOCK, **case}, "vary": vary or {}}
        return [sentence.split()[0] for sentence in open_study(study).warnings if "used nowhere" in sentence]

    def test_used_ones(self):
        assert self.unused({"q": 0.1, "r": "2*q"}, initial={"theta": "r*alpha"}) == []
        assert self.unused({"q": 0.1}, {"initial.theta": ["q*alpha", 0]}) == []
        assert self.unused({"q": 0.1}, {"case": {"a": {"block.R": "q"}, "b": {"let.q": 2}}}) == []
        assert self.unused({}, {"let.q": [0.1, 0.2]}, initial={"theta": "q*alpha"}) == []

    def test_unused_ones(self):
        assert self.unused({"q": 0.1, "z": 3}, initial={"theta": "q*alpha"}) == ["let.z"]
        assert self.unused({}, {"let.q": [0.1, 0.2]}) == ["let.q"]
        assert self.unused({"q": 0.1, "r": "2*q"}) == ["let.q", "let.r"]

    def test_one_set_from_outside(self):
        study = open_study({"name": "x", "case": {"block": BLOCK}}, overrides=[("let.q", "3")])
        assert "let.q is used nowhere" in study.warnings


A_P = "motion.pulse.a_p"
BY_NAME = {"a": {A_P: 1}, "b": {A_P: 2}}
TREE = {"a": {"motion": {"pulse": {"a_p": 1}}}, "b": {"motion": {"pulse": {"a_p": 2}}}}


class TestOverriddenAxes:
    @staticmethod
    def opened(vary):
        return open_study({"name": "x", "case": {"block": BLOCK, "motion": {"pulse": PULSE}}, "vary": vary})

    def said(self, vary):
        return [sentence for sentence in self.opened(vary).warnings if "nothing is left" in sentence]

    @pytest.mark.parametrize(
        ("vary", "whose", "by"),
        [
            ({"case": BY_NAME, A_P: [3, 4]}, "the axis case", A_P),
            ({A_P: [3, 4], "case": BY_NAME}, f"the axis {A_P}", "case"),  # of two as near the later one counts
            ({A_P: [3, 4], "case": TREE}, "the axis case", A_P),  # the longer path counts
            ({"damping": {"a": {"eta": 0.9}, "b": {"eta": 0.8}}, "damping.r_energy": [0.7, 0.8]}, "the axis damping",
             "damping.r_energy"),  # another way to say it
            ({"case": {"a": {A_P: 1, "motion.pulse.T_p": 1}, "b": {A_P: 2, "motion.pulse.T_p": 2}}, A_P: [3, 4],
              "motion.pulse.omega_p": [5, 6]}, "the axis case", f"{A_P} and motion.pulse.omega_p"),
            ({"case": {**BY_NAME, "c": {"block.R": 3}}, A_P: [3, 4]}, "'a', 'b' of the axis case", A_P),
            ({"block": {"a": {"R": 1}, "b": {"R": 3}}, "case": {"c": {"block": {"height": 2, "width": 0.5}},
              "d": {"block.R": 1, "model": 3}}}, "the axis block", "case"),
        ],
    )  # fmt: skip
    def test_an_axis_of_which_nothing_is_left_is_named(self, vary, whose, by):
        assert self.said(vary) == [
            f"nothing is left of {whose}: all of it is overridden by {by}; leave one of the axes out"
        ]

    @pytest.mark.parametrize(
        ("vary", "lost", "by"),
        [
            ({"case": "t.csv", "motion.pulse.a_p": [3, 4]}, "motion.pulse.a_p", A_P),
            ({"case": "t.csv", "motion.pulse.a_p_over_g_tan_alpha": [1, 2]}, "motion.pulse.a_p", f"{A_P}_over_g_tan_alpha"),
            ({"case": "t.csv", "block.R": [1, 2]}, "", ""),  # the same R in both rows, as in complete settings
            ({"case": "t.csv", "block.tan_alpha": [0.1, 0.2]}, "block.alpha", "block.tan_alpha"),
            ({"case": "t.csv", "motion.pulse.T_p": [0.5, 1]}, "", ""),
            ({"case": {"a": {"block": {"R": 1, "alpha": 0.2}}, "b": {A_P: 2}}, A_P: [3, 4]}, "", ""),  # told otherwise
            ({"case": {"a": {"block.R": 1, A_P: 1}, "b": {"block.R": 2, A_P: 2}}, A_P: [3, 4]}, A_P, A_P),
            ({"case": {"a": {"block.R": 1, A_P: 1}, "b": {"block.R": 2, A_P: 1}}, A_P: [3, 4]}, "", ""),
        ],
    )  # fmt: skip
    def test_a_column_of_which_nothing_is_left_is_named(self, vary, lost, by, tmp_path):
        """A list of bodies, each with its strength of motion, beside an axis of strengths had no warning."""
        (tmp_path / "t.csv").write_text("name,block.R,block.alpha,motion.pulse.a_p\na,2,0.2,1\nb,2,0.25,2\n")
        case = {"block": BLOCK, "motion": {"pulse": PULSE}}
        (tmp_path / "x.yaml").write_text(yaml.safe_dump({"name": "x", "case": case, "vary": vary}, sort_keys=False))
        told = [each for each in open_study(tmp_path / "x.yaml").warnings if "has no effect" in each]
        words = f"{lost} of the axis case has no effect: it is overridden by {by}; leave one of the two out"
        assert told == [words] * bool(lost)

    @pytest.mark.parametrize(
        ("vary", "axis"), [({"case": BY_NAME, A_P: [3, 4]}, 0), ({A_P: [3, 4], "case": BY_NAME}, 1)]
    )
    def test_the_cases_are_those_without_it(self, vary, axis):
        found = np.empty(4)
        for indices, batch in self.opened(vary).batches():
            found[indices] = batch.excitation.horizontal.a_p
        assert (
            np.diff(found.reshape(2, 2), axis=0) == 0
        ).all()  # along the outer axis, which is the one without effect
        assert (np.diff(found.reshape(2, 2), axis=1) == 1).all()

    @pytest.mark.parametrize(
        "vary",
        [
            {"case": {"a": {A_P: 1, "model": 3}, "b": {A_P: 2}}, "motion.pulse.T_p": [0.5, 1]},
            {"motion.pulse": {"a": {"shape": "sine", "a_p": 1}, "b": {"shape": "cosine", "a_p": 1}}, A_P: [1, 2]},
            {"damping": {"a": {"scheme": "restitution", "eta": 0.7}, "b": "restitution"}, "damping.eta": [0.8, 0.9]},
            {"model": ["rigid", 3], "case": {"a": {"model": "rigid"}, "b": {"block.R": 3}}},
            {"case": {"still": {"motion": None, "initial.theta": 0.1}, "moved": {A_P: 1}}, "block.R": [1, 2]},
        ],
    )
    def test_one_of_which_something_is_left_is_not(self, vary):
        assert self.said(vary) == []


RECORD = {"file": "synthetic_pulse_m70.AT2"}


class TestAlternativesLeftOut:
    """Two things in the base case of which a case has one: an axis of one drops the other, and says so."""

    @staticmethod
    def said(case, vary):
        study = open_study({"name": "x", "case": case, "vary": vary})
        return [sentence for sentence in study.warnings if "cannot stand" in sentence]

    @pytest.mark.parametrize(
        ("case", "vary", "lost", "axis"),
        [
            ({"block": BLOCK, "motion": {"pulse": PULSE, "record": RECORD}}, {A_P: [3, 4]}, "case.motion.record", A_P),
            ({"block": BLOCK, "motion": {"pulse": PULSE, "record": RECORD}}, {"motion.record.pga": [3, 4]},
             "case.motion.pulse", "motion.record.pga"),
            ({"block": BLOCK, "damping": {"eta": 0.9, "r_energy": 0.8}}, {"damping.eta": [0.8, 0.9]},
             "case.damping.r_energy", "damping.eta"),
        ],
    )  # fmt: skip
    def test_what_an_axis_drops_is_named(self, case, vary, lost, axis):
        (sentence,) = self.said(case | {"initial": {"theta": 0.01}}, vary)
        assert sentence.startswith(f"{lost} has no effect: the axis {axis} is of ")

    @pytest.mark.parametrize(
        ("motion", "vary"),
        [
            ({"pulse": PULSE, "record": RECORD}, {"motion": {"a": {"pulse": None}, "b": {"record": None}}}),
            ({"pulse": PULSE}, {A_P: [3, 4]}),
            ({"record": RECORD}, {"motion": {"a": {"pulse": PULSE}, "b": {}}}),
        ],
    )
    def test_settings_that_choose_are_not(self, motion, vary):
        assert self.said({"block": BLOCK, "motion": motion}, vary) == []


@pytest.mark.parametrize(
    ("motion", "vary", "name", "axis"),
    [
        ({"pga": "0.4*g"}, {"motion.record.scale": [1, 2]}, "motion.record.pga", "the axis motion.record.scale"),
        ({"pgv": 0.3}, {"case": {"a": {}, "b": {"motion.record.scale": 2}}}, "motion.record.pgv",
         "the axis case, of motion.record.scale"),
        ({"scale": 2}, {"motion.record.scale": [1, 2]}, "", ""),
        ({"scale": 2}, {"motion.record.pga": [1, 2]}, "", ""),
        ({"pga": "0.4*g"}, {"motion.record.pga": [1, 2]}, "", ""),
        ({}, {"motion.record.scale": [1, 2]}, "", ""),
    ],
)  # fmt: skip
def test_factors_are_not_on_a_strength_of_the_base_case(motion, vary, name, axis):
    """Half, once and twice 0.4 g was half, once and twice the record, whatever its strength, without a word."""
    record = {"file": "synthetic_rock_m65.AT2"} | motion
    study = {"name": "x", "case": {"block": BLOCK, "motion": {"record": record}}, "vary": vary}
    told = [each for each in open_study(study).warnings if "counts for nothing" in each]
    assert [each.startswith(f"{name} of the base case counts for nothing beside {axis}: its") for each in told] == (
        [True] * bool(name)
    )


@pytest.mark.parametrize(
    ("sets", "said"),
    [
        ([("motion.record.scale", "2")], "motion.record.pga of the study counts for nothing beside --set"),
        ([("motion.record", "{scale: 2}")], "motion.record.pga of the study counts for nothing beside --set"),
        ([("motion.record", "synthetic_pulse_m70.AT2")], "replaces the whole record, `pga` with it"),
        ([("motion.record", "synthetic_pulse_m70.AT2"), ("motion.record.pga", "3")], ""),
        ([("motion.record.scale", "2"), ("motion.record.pga", "3")], ""),
        ([("motion.record.pga", "3")], ""),
        ([("motion.record.file", "synthetic_pulse_m70.AT2")], ""),
    ],
)
def test_what_options_drop_of_a_record_is_told(sets, said):
    """`--set case.motion.record.scale=2` of a record at 0.4 g is twice the record as it is, whatever its strength."""
    record = {"file": "synthetic_rock_m65.AT2", "pga": "0.4*g"}
    study = {"name": "x", "case": {"block": BLOCK, "motion": {"record": record}}}
    told = open_study(study, overrides=[(f"case.{path}", value) for path, value in sets]).warnings
    assert [said in each for each in told] == [True] * bool(said)


def test_tolerances_of_clauses_that_have_no_value_are_said():
    clause = {"quantity": "theta_peak", "rtol": 0.1}
    study = {"name": "x", "case": {"block": BLOCK, "motion": {"pulse": PULSE}}}
    for kind, told in (({"min": 0.5}, "min"), ({"max": 0.5}, "max"), ({"value": 0.5}, None)):
        opened = open_study(study | {"expect": [clause | kind]})
        said = [each for each in opened.warnings if each.startswith("expect[0].rtol has no effect")]
        assert said == ([f"expect[0].rtol has no effect: it is for `value`, not `{told}`"] if told else [])
        again = open_study(yaml.safe_load(opened.resolved_yaml))
        assert [each for each in again.warnings if each.startswith("expect[0]")] == said
    (said,) = open_study(study | {"expect": [{"quantity": "theta_peak", "min": 0.5, "rtol": 1e-6, "atol": 1}]}).warnings
    assert said.startswith("expect[0].atol")
