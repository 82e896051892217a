"""Model auto: what it chooses, that the answer is the chosen model's, and that its error table keeps its promise."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scripts import benchmark

import rockcli
from rockcli.engine.auto import decide, groups, peak_of, try_rigid
from rockcli.engine.preview import preview
from rockcli.errors import StudyError
from rockcli.scene import auto
from rockcli.scene.auto_table import CHANCES, TABLES
from rockcli.scene.ground.excitation import acceleration, scaled
from rockcli.scene.ground.pulses import SHAPES
from rockcli.study.open import open_study

INF, NAN = np.inf, np.nan

RICKER = {"shape": "ricker", "a_p_over_g_tan_alpha": 2.0, "omega_p_over_p": 5.0}
SLENDER = {"R": 2.0, "tan_alpha": 0.05}
STOUT = {"R": 2.0, "tan_alpha": 0.4}
MONUMENT = {"height": 50, "width": 5}
CONCRETE = {"E": "30*GPa", "rho": 2500, "zeta": 0.01}
STIFF = {"E": "30e4*GPa", "rho": 2500, "zeta": 0.01}
FLAGS = {name: flag for flag, name in auto.CANDIDATES.items()}


def study(model: Any = "auto", histories: bool = False, **case: Any) -> dict[str, Any]:
    vary = case.pop("vary", {})
    motion = case.pop("motion", {"pulse": RICKER})
    return {
        "name": "auto",
        "case": {"motion": motion, "model": model, **case},
        "vary": vary,
        "save": {"histories": histories},
    }


def batch_of(**case: Any) -> Any:
    ((_, batch),) = open_study(study(**case)).batches()
    return batch


def said(found: Any) -> str:
    return str(found.reasons.values[int(found.reason)])


@pytest.mark.parametrize(
    ("case", "candidate"),
    [
        ({"block": SLENDER, "motion": {"pulse": {**RICKER, "a_p_over_g_tan_alpha": 0.99}}}, "none"),
        ({"block": SLENDER}, "rigid"),
        ({"block": STOUT}, "rigid"),
    ],
)
def test_a_body_without_a_column_is_a_rigid_block(case: dict[str, Any], candidate: str) -> None:
    found = rockcli.run(study(**case))
    assert int(found.model_used) == FLAGS[candidate]
    assert said(found).startswith(f"auto: {candidate}")
    model = "rigid" if candidate == "none" else candidate
    alone = rockcli.run(study(model, **case))
    assert float(found.theta_peak_over_alpha) == float(alone.theta_peak_over_alpha)
    assert int(found.outcome) == int(alone.outcome)


def test_a_stiff_column_is_solved_as_a_rigid_block_and_a_monument_as_a_column() -> None:
    weak = {"pulse": {**RICKER, "a_p_over_g_tan_alpha": 0.8}}
    for column, motion, model in ((STIFF, weak, "rigid"), (CONCRETE, {"pulse": RICKER}, "flexible")):
        case = {"block": MONUMENT, "column": column, "motion": motion}
        found = rockcli.run(study(histories=True, **case))
        alone = rockcli.run(study(model, histories=True, **case))
        assert int(found.model_used) == FLAGS["none" if model == "rigid" else "flexible"]
        assert float(found.theta_peak_over_alpha) == float(alone.theta_peak_over_alpha)
        np.testing.assert_array_equal(found.theta.values, alone.theta.values)
        assert np.isnan(float(found.model_error)) == (model == "flexible")


def test_displacements_of_a_body_with_a_column_are_those_of_its_end() -> None:
    """u_top of the rigid block is 2h sin(theta), as of the column, and not that of `block.top`."""
    motion = {"pulse": {**RICKER, "a_p_over_g_tan_alpha": 1.5, "omega_p_over_p": 8.0}}
    case = {"block": {"R": 5, "tan_alpha": 0.1, "top": 4}, "motion": motion, "column": {**CONCRETE, "E": "300*GPa"}}
    found, alone = (rockcli.run(study(model, **case)) for model in ("auto", "flexible"))
    assert int(found.model_used) == FLAGS["rigid"]
    assert float(found.u_top_peak) == pytest.approx(10 * np.cos(np.arctan(0.1)) * abs(np.sin(float(found.theta_peak))))
    assert float(found.u_top_peak) == pytest.approx(float(alone.u_top_peak), rel=0.25)
    assert any(words.startswith("block.top has no use in model auto") for words in batch_of(**case).warnings)
    without = {key: value for key, value in case.items() if key != "column"}
    found = rockcli.run(study(**without))
    assert float(found.u_top_peak) == pytest.approx(4 * abs(np.sin(float(found.theta_peak))))


def test_of_what_overturns_no_model_is_a_number_off() -> None:
    case = {
        "block": MONUMENT,
        "column": STIFF,
        "motion": {"pulse": {**RICKER, "omega_p_over_p": 2.0, "a_p_over_g_tan_alpha": 4.0}},
    }
    found = rockcli.run(study(**case))
    assert int(found.model_used) == FLAGS["rigid"]
    assert np.isinf(float(found.theta_peak_over_alpha))
    assert np.isnan(float(found.model_error))
    assert said(found).endswith("flexible overturns too in 97.5 % of such cases")


@pytest.mark.parametrize(
    ("more", "why"),
    [
        ({"initial": {"theta": "0.2*alpha"}}, "moves at t = 0"),
        ({"motion": {"pulse": RICKER, "duration": 3.0}}, "cut off by `duration`"),
        ({"motion": {"pulse": RICKER, "vertical": {"pulse": {"shape": "sine", "a_p": 0.1, "T_p": 1}}}}, "vertical"),
        ({"motion": {"pulse": {**RICKER, "a_p_over_g_tan_alpha": 50}}}, "PGA/(g tan alpha) is not in"),
        ({"motion": {"pulse": {**RICKER, "shape": "square_cycle"}}}, "no pulse of shape square_cycle"),
        ({"motion": {"pulse": {**RICKER, "shape": "sine", "cycles": 2, "t0": 1}}}, "lasts longer than 1 T_p"),
        ({"motion": {"pulse": {**RICKER, "shape": "mavroeidis_papageorgiou", "gamma": 3}}}, "longer than 2 T_p"),
        ({"motion": {"pulse": RICKER, "through": [{"T": 0.5, "zeta": 0.05}]}}, "that of a floor"),
        ({"column": {"E": 1e20, "rho": 2500}}, "p T_1 is not in"),
        ({"base": {"law": "winkler", "kw": 1e15}}, "m g/(2 kw b^2 alpha) is not in"),
    ],
)
def test_outside_the_calibrated_range_the_highest_model_is_taken_and_that_is_said(
    more: dict[str, Any], why: str
) -> None:
    batch = batch_of(**{"block": MONUMENT, "column": CONCRETE, **more})
    choice = decide(batch)
    assert choice.candidate[0] == (auto.WINKLER if "base" in more else auto.COLUMN)
    assert np.isnan(choice.error[0])
    assert why in choice.said[0]


def test_a_column_that_a_train_of_weak_cycles_overturns_is_not_said_to_stay_at_rest() -> None:
    """Twenty cycles of 0.95 g tan(alpha), which lift no rigid block, build up the vibrations of this column."""
    pulse = {"shape": "cosine", "a_p_over_g_tan_alpha": 0.95, "omega_p_over_p": 1.5, "cycles": 20}
    column = {"E": "17.7*GPa", "rho": 2500, "zeta": 0.01}  # p T_1 = 0.28
    case = {"block": {"R": 5.0, "alpha": 0.1}, "motion": {"pulse": pulse}, "column": column}
    found, alone = (rockcli.run(study(model, **case)) for model in ("auto", "flexible"))
    assert np.isinf(float(alone.theta_peak_over_alpha))
    assert int(found.outcome) == int(alone.outcome)
    (once,) = decide(batch_of(**case | {"motion": {"pulse": {**pulse, "cycles": 1}}})).said
    assert "stays at rest" in once


def test_a_column_that_its_vibrations_lift_is_solved_as_a_column() -> None:
    a = "motion.pulse.a_p_over_g_tan_alpha"
    pulse = {"shape": "cosine", a.rsplit(".", 1)[-1]: 1, "omega_p_over_p": 8}
    column = {"E": "16.5*GPa", "rho": 2500, "zeta": 0.01}  # p T_1 = 0.29
    case = {"block": {"R": 5.0, "alpha": 0.1}, "motion": {"pulse": pulse}, "column": column, "vary": {a: [0.5, 0.95]}}
    found, alone = (rockcli.run(study(model, **case)) for model in ("auto", "flexible"))
    assert (np.asarray(alone.theta_peak_over_alpha) > auto.TOLERANCE).tolist() == [False, True]
    assert found.model_used.values.tolist() == [FLAGS["none"], FLAGS["flexible"]]
    stiff = decide(batch_of(**case | {"column": column | {"E": "600*GPa"}}))  # p T_1 = 0.048
    assert stiff.candidate.tolist() == [auto.NONE, auto.NONE]


def test_a_column_that_its_vibrations_lift_is_solved_on_the_base_it_has() -> None:
    """.95 g tan(alpha), p T_1 = .48: .063 alpha on a rigid base, .037 on a base that opens at 9e-5 alpha."""
    case = {
        "block": {"R": 5.0, "tan_alpha": 0.1},
        "motion": {"record": {"file": "synthetic_soil_m70.AT2", "pga_over_g_tan_alpha": 0.95}},
        "column": {"E": "6*GPa", "rho": 2500, "zeta": 0.005},
        "base": {"law": "winkler", "kw": 5.5e10},
    }
    found, alone = (rockcli.run(study(model, **case)) for model in ("auto", "flexible"))
    rigid_base = rockcli.run(study("flexible", **{**case, "base": {"law": "rigid"}}))
    assert abs(float(rigid_base.theta_peak_over_alpha - alone.theta_peak_over_alpha)) > auto.TOLERANCE
    assert int(found.model_used) == FLAGS["flexible_winkler"]
    assert float(found.theta_peak_over_alpha) == pytest.approx(float(alone.theta_peak_over_alpha))
    batch = batch_of(**case)
    assert auto.prospect(batch, groups(batch)) == "flexible on winkler"
    weak = {**case, "motion": {"record": {"file": "synthetic_soil_m70.AT2", "pga_over_g_tan_alpha": 0.4}}}
    assert decide(batch_of(**weak)).candidate.tolist() == [FLAGS["flexible"]]
    stiff = {**case, "column": {**case["column"], "E": "1e5*GPa"}}  # p T_1 = .012: it vibrates on its base
    assert decide(batch_of(**stiff)).candidate.tolist() == [FLAGS["flexible_winkler"]]
    assert decide(batch_of(**{**stiff, "base": {"law": "rigid"}})).candidate.tolist() == [FLAGS["none"]]


def test_what_is_chosen_for_a_case_does_not_depend_on_the_cases_beside_it() -> None:
    a = "motion.pulse.a_p_over_g_tan_alpha"
    case = {"block": {"R": 1.0, "tan_alpha": 0.15}, "column": CONCRETE, "vary": {a: {"from": 0.6, "to": 9, "n": 23}}}
    batch = batch_of(**case)
    whole = decide(batch)
    alone = [decide(batch.rows(np.array([i]))) for i in range(batch.size)]
    assert len(set(whole.candidate.tolist())) > 1
    assert whole.candidate.tolist() == [int(one.candidate[0]) for one in alone]
    np.testing.assert_array_equal(whole.error, [one.error[0] for one in alone])


def test_a_sweep_mixes_models_and_says_which() -> None:
    a = "motion.pulse.a_p_over_g_tan_alpha"
    case = {"block": SLENDER, "vary": {a: [0.5, 2.0], "model": ["auto", "rigid"]}}
    found = rockcli.run(study(**case))
    assert found.model_used.values.tolist() == [[FLAGS["none"], -1], [FLAGS["rigid"], -1]]
    assert found.model_used.attrs["flag_meanings"].split() == list(auto.CANDIDATES.values())
    np.testing.assert_array_equal(found.model_error.values, [[0.0, NAN], [NAN, NAN]])


@pytest.mark.parametrize(
    ("case", "message"),
    [
        ({"model": {"name": "rigid", "tolerance": 0.1}, "block": SLENDER}, "belongs to model auto"),
        ({"model": {"name": "auto", "tolerance": 2}, "block": SLENDER}, "must be at most 1"),
        ({"model": {"name": "auto", "tolerance": 0}, "block": SLENDER}, "must be greater than 0"),
        ({"block": SLENDER, "damping": "dashpot"}, "damping restitution or none"),
        ({"block": SLENDER, "solver": {"backend": "scipy"}}, "solved by backend event"),
        ({"block": SLENDER, "base": {"law": "winkler", "kw": 1e11}}, "needs a column"),
        ({"block": SLENDER, "column": {"E": 1e10}}, "E and rho"),
    ],
)
def test_what_auto_cannot_do_is_said_at_once(case: dict[str, Any], message: str) -> None:
    with pytest.raises(StudyError, match=message):
        open_study(study(**case))


def test_a_search_finds_the_threshold_of_the_highest_model() -> None:
    a = "motion.pulse.a_p_over_g_tan_alpha"
    vary = {a: {"from": 1.2, "to": 9.6, "n": 9, "find": "overturning"}}
    pulse = {"shape": "sine", "a_p_over_g_tan_alpha": 1, "omega_p_over_p": 3}
    case = {"block": {"R": 2.0, "tan_alpha": 0.1}, "motion": {"pulse": pulse}, "column": CONCRETE, "vary": vary}
    found, alone = (rockcli.run(study(m, **case)).a_p_over_g_tan_alpha_overturning for m in ("auto", "flexible"))
    assert np.isfinite(float(alone))
    assert float(found) == pytest.approx(float(alone), rel=auto.TOLERANCE)


def test_where_outcomes_alone_are_asked_for_the_column_decides_and_check_says_so() -> None:
    a, motion = "motion.pulse.a_p_over_g_tan_alpha", {"pulse": {**RICKER, "a_p_over_g_tan_alpha": 1.5}}
    case = {"block": MONUMENT, "column": STIFF, "motion": motion}
    said = []
    for vary, scalars in (
        ({}, None),
        ({a: {"from": 1.5, "to": 6, "n": 5, "find": "overturning"}}, None),
        ({}, ["outcome"]),
        ({}, ["outcome", "model_used", "reason"]),
    ):
        asked = study(**case, vary=vary)
        if scalars:
            asked["save"]["scalars"] = scalars
        said.append({row.key: row.value for row in preview(open_study(asked)).model}["takes"])
    assert str(said[0]).startswith("rigid if")
    assert set(said[1:]) == {"flexible, the highest model of this body: only it decides whether the body overturns"}
    found = rockcli.run(asked)
    assert int(found.model_used) == FLAGS["flexible"]


def test_classes() -> None:
    peak = np.array([0.0, 0.0, 0.5, 0.5, 0.5, 0.5, 0.9, INF, INF, 0.5])
    other = np.array([0.0, 0.1, 0.505, 0.48, 0.55, 0.7, INF, INF, 0.9, NAN])
    assert auto.class_of_rigid(peak, np.stack([other, peak])).tolist() == [0, 4, 1, 2, 3, 4, 5, 6, 5, 5]


@pytest.mark.parametrize(
    ("a_p", "column", "runs", "words"),
    [
        (0.94, CONCRETE, 0, "stays at rest, also with 5 % more motion"),
        (0.96, STIFF, 1, "none: the rigid block is accurate enough"),
        (9.0, CONCRETE, 0, "the rigid block is seldom accurate enough in such cases"),
        (1.5, STIFF, 1, "its peak is known to"),
    ],
)
def test_a_trial_is_run_only_where_it_may_pay(
    a_p: float, column: dict[str, Any], runs: int, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    called = []
    monkeypatch.setattr("rockcli.engine.auto.try_rigid", lambda batch: called.append(1) or try_rigid(batch))
    motion = {"pulse": {**RICKER, "a_p_over_g_tan_alpha": a_p}}
    (said,) = decide(batch_of(block=MONUMENT, column=column, motion=motion)).said
    assert len(called) == runs
    assert words in said


def test_a_body_that_is_said_to_stay_at_rest_does() -> None:
    """What is known without a trial agrees with the four blocks that a trial would run."""
    a = "motion.pulse.a_p_over_g_tan_alpha"
    vary = {a: {"from": 0.5, "to": 1.2, "n": 29}, "block.tan_alpha": [0.04, 0.2, 0.45]}
    batch = batch_of(block={"R": 3.0, "tan_alpha": 0.1}, column=STIFF, vary=vary)
    at_rest = auto.still(groups(batch))
    assert 0 < at_rest.sum() < batch.size
    np.testing.assert_array_equal(at_rest, auto.class_of_rigid(*try_rigid(batch)) == auto.STILL)


def test_shares_of_what_a_rigid_block_does_are_shares() -> None:
    edges, kinds = CHANCES
    for shares in map(np.array, kinds.values()):
        assert shares.shape == (len(edges) - 1, len(auto.RIGID_CLASSES))
        np.testing.assert_allclose(shares.sum(axis=1), 1.0, atol=0.031)  # rounded to 0.01
        assert not shares[:, auto.STILL].any()


def test_cases_alike_share_a_sentence() -> None:
    written = []
    candidate, error = np.array([2, 2, 3, 2, 2]), np.array([0.1, NAN, 0.1, 0.1, NAN])
    said = auto.sentences(lambda i: written.append(i) or f"case {i}", candidate, error)  # type: ignore[func-returns-value]
    assert said == ["case 0", "case 1", "case 2", "case 0", "case 1"]
    assert sorted(written) == [0, 1, 2]


def test_the_expected_error_never_shrinks_as_a_body_gets_softer_or_thicker() -> None:
    for edges, kinds in TABLES.values():
        assert np.all(np.diff(edges) > 0.0)
        for table in map(np.array, kinds.values()):
            assert len(table) == len(edges) - 1
            assert np.all(table[1:] >= table[:-1])


@pytest.mark.parametrize("shape", sorted(SHAPES))
def test_a_scaled_pulse_is_the_pulse_of_the_scaled_amplitude(shape: str) -> None:
    more = {"gamma": 2} if shape == "mavroeidis_papageorgiou" else {}
    small, large = (
        batch_of(block=SLENDER, motion={"pulse": {"shape": shape, "a_p": a, "T_p": 1, **more}}).excitation.horizontal
        for a in (1.0, 1.5)
    )
    t = np.linspace(0.0, 5.0, 1001)
    np.testing.assert_allclose(acceleration(scaled(small, 1.5), t), acceleration(large, t), rtol=1e-12, atol=1e-13)


def test_rows_of_a_batch_are_those_cases() -> None:
    case = {"block": SLENDER, "column": STIFF, "vary": {"block.tan_alpha": [0.05, 0.1, 0.2], "damping.eta": [0.8, 0.9]}}
    batch = batch_of(**case)
    some = np.array([4, 1])
    part = batch.rows(some)
    assert part.size == 2
    rigid, of_part = (peak_of(auto.as_candidate(b, auto.RIGID)) for b in (batch, part))
    np.testing.assert_array_equal(of_part, rigid[some])
    np.testing.assert_array_equal(part.column.E, batch.column.E[some])


@pytest.mark.slow
def test_scenes_the_calibration_has_not_seen_keep_the_tolerance() -> None:
    tolerances = {"pulse": (0.02,), "record": (0.02,)}
    with benchmark("trial_auto") as script:
        rows = script.trial(seed=3, per_shape=10, records=3, per_record=20, tolerances=tolerances, every=1)
    for row in rows:
        assert row["scenes"] == 60
        assert row["kept"] >= 58, row
        assert row["on a cheaper model"] > (10 if row["body"] == "column on winkler" else 15), row
