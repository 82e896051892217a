"""What a study says and nobody reads is said to be ignored."""

import pytest

from rockcli.study.open import open_study

BLOCK = {"R": 2.0, "tan_alpha": 0.2}
PULSE = {"shape": "ricker", "a_p": 7, "omega_p": "3*pi"}


def warnings_of(solver, **case):
    study = {"name": "x", "case": {"block": BLOCK, "motion": {"pulse": PULSE}, "solver": solver, **case}}
    ((_, batch),) = open_study(study).batches()
    return [sentence for sentence in batch.warnings if "ignored" in sentence]


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
