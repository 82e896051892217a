"""The truth tests fail on a spoilt program: one fault at a time, in every family of kernels, a solver and the sweep.

What is asked of the spoilt program is what the tests of that family ask, on a few of their cases.  Kernels run as plain
Python here, which takes seconds where whole paths are followed: those with `-m slow`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
import pytest
import rolling_cases
import swept
from analytic import test_asymmetric as asymmetric
from contact import test_contact_closed_forms as contact
from contact import test_contact_decay as decay
from contact import test_contact_turns as turns_of_contact
from contact_tables import LANDINGS, SLIDES_UNDER_A_CONSTANT
from cross import test_lanes_pulses as lanes_pulses
from cross import test_lanes_pulses_path as paths_of_lanes
from cross import test_lanes_records as lanes_records
from cross import test_lanes_records_duration as lanes_that_end
from cross import test_lanes_records_forces as forces_of_lanes
from cross import test_lanes_records_vertical as lifted_lanes
from engine import test_sweep
from flexible import test_column as column
from frame import test_models as frame
from frame.frames import ricker
from general import test_located as general
from literature import test_thesis_pulses as thesis
from plain import in_plain_lanes, spoilt
from plain import plain as plain
from scenes import G, block, make_batch, pulse
from tables import SOURCE_PULSES

from rockcli.engine.run import run_study
from rockcli.scene.batch import Batch


def march() -> None:
    thesis.test_peak_uplift_and_impacts(SOURCE_PULSES[3])
    asymmetric.test_against_an_independent_integration([0.2, 0.3], 2)


def pulse_lanes() -> None:
    lanes_pulses.assert_same(lanes_pulses.map_of("ricker", 3), 1e-10)


def pulse_paths() -> None:
    with in_plain_lanes():
        paths_of_lanes.assert_same(lanes_pulses.map_of("ricker", 3, scalars=paths_of_lanes.FOUND))


def late_extremes() -> None:
    with in_plain_lanes():
        paths_of_lanes.assert_same(paths_of_lanes.late_extremes())


def paths_until_the_fall() -> None:
    with in_plain_lanes():
        batch = lanes_pulses.map_of("ricker", 6, scalars=paths_of_lanes.FOUND)
        paths_of_lanes.assert_same_as_to_the_ground(batch)


def uneven_paths() -> None:
    with in_plain_lanes():
        paths_of_lanes.assert_same(
            lanes_pulses.uneven(lanes_pulses.map_of("sine", 3, scalars=paths_of_lanes.FOUND), 1.1, 0.7)
        )


TIME = np.arange(90) * 0.02


def shaken(scale: list[float]) -> Batch:
    """Bodies under one motion of 1.8 s at several scales."""
    values = np.sin(7.0 * TIME) * np.exp(-0.6 * TIME) + 0.2 * np.sin(23.0 * TIME)
    return lanes_records.suite(values, 0.02, scale, [1.5], [0.2], eta=0.8)


def record_lanes() -> None:
    with in_plain_lanes():
        lanes_records.assert_same(shaken([1.1, 1.4, 1.7]))


def lifted_in_a_record() -> None:
    with in_plain_lanes():
        lanes_records.test_lifted_for_a_moment()


def record_forces() -> None:
    with in_plain_lanes():
        forces_of_lanes.assert_forces(*forces_of_lanes.everything(shaken([1.1, 1.7, 2.5])))


def record_durations() -> None:
    with in_plain_lanes():
        lanes_that_end.assert_ends(lanes_that_end.lasting(shaken([1.1, 1.4, 1.7]), [0.123, 0.344, 0.567]))


def of_both_components(scale: list[float]) -> Batch:
    return lifted_lanes.lifted(shaken(scale), [0.4, -0.3, 0.2], np.cos(11.0 * TIME) * np.exp(-0.3 * TIME), 0.02)


def record_components() -> None:
    both = of_both_components([0.95, 1.4, 1.7])
    with in_plain_lanes():
        for batch in (both, replace(both, model="linearized")):
            lanes_records.assert_same(batch, most=1e-7)


def record_forces_of_both() -> None:
    with in_plain_lanes():
        forces_of_lanes.assert_forces(*forces_of_lanes.everything(of_both_components([0.4, 1.7, 2.5])))


def rolling() -> None:
    rolling_cases.compare(139)


def rolling_pulses() -> None:
    with in_plain_lanes():
        for seed in (16, 139):
            rolling_cases.compare_with_march(seed, path=True)


def rolling_records() -> None:
    with in_plain_lanes():
        for seed in (210, 1044):
            rolling_cases.compare_with_march(seed, record=True, path=True)


def slips() -> None:
    with in_plain_lanes():
        turns_of_contact.assert_a_few_slip_in_lanes_as_alone()


def planar_contact() -> None:
    contact.test_slide_under_a_constant_acceleration(SLIDES_UNDER_A_CONSTANT[0])
    for row in LANDINGS[:4]:
        contact.test_landing(row)


def swings_left_out() -> None:
    decay.test_as_followed_to_the_rest(0)


def flexible() -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("rockcli.solvers.flexible.solver.MAX_STEPS", 2000)  # a spoilt one may never come to its end
        column.test_stiff_column_is_model_3(1e20, "housner")
        column.test_lumped_masses_of_five_elements()


def beam_elements() -> None:
    motion = pulse("ricker", 3.6 * G * 0.1, 3.0 * np.pi, duration=2.4)
    frame.error_of_step(ricker("3", "negative_stiffness", eta=0.8, excitation=motion), 2e-3)


def scipy_backend() -> None:
    motion = pulse("sine", 2.5 * G * 0.333, 3.0 * np.pi, duration=2.0)
    general.assert_agree(make_batch(block(2.0, 0.333), motion, histories=True, dt_out=0.02))


def sweep() -> None:
    with pytest.MonkeyPatch.context() as patch:
        test_sweep.test_results_stand_where_their_case_stands(patch)


def shares() -> None:
    """What `test_parts` asks of the shares of a study: together they solve every case once."""
    with pytest.MonkeyPatch.context() as patch, TemporaryDirectory() as folder:
        patch.setattr("rockcli.solvers.event.solver.solve", swept.made_up)
        for k in (1, 2, 3):
            run_study(swept.study(), Path(folder), plots=False, share=(k, 3))
        assert run_study(swept.study(), Path(folder), plots=False).resumed == swept.CASES


class Fault(NamedTuple):
    """A passage of the source that stands in a module once, and what it is replaced with."""

    truth: Callable[[], None]
    module: str
    right: str
    wrong: str


K = "rockcli.kernels."
FAULTS = {
    "march: sign": Fault(march, K + "rigid.ground", "s, c = A * math.sin(phase), A", "s, c = -A * math.sin(phase), -A"),
    "march: restitution": Fault(march, K + "rigid.march", "other.eta * abs(s * min", "1.001 * other.eta * abs(s * min"),
    "march: no reset": Fault(march, K + "rigid.march", "            s = -s\n", ""),
    "march: wrong edge": Fault(
        march,
        K + "rigid.march",
        "edge, other = (right, left) if s > 0.0 else (left, right)",
        "edge, other = (left, right) if s > 0.0 else (right, left)",
    ),
    "march: end of a step": Fault(
        march, K + "rigid.march", "(event == NO_EVENT and x == t_next - t) else t + x", "(event == NO_EVENT) else t + x"
    ),
    "march: late root": Fault(march, K + "rigid.march", "x = first_root(c, n, h, skip)", "x = first_root(c, n, h, skip) * 1.001"),
    "law: coefficient": Fault(march, K + "rigid.law", "par[e + at.RS], par", "par[e + at.RS] * 1.00001, par"),
    "law: moment": Fault(march, K + "formulas", "return fc * cosine + fs * sine", "return fc * cosine - fs * sine"),
    "pulse lanes: sign": Fault(
        pulse_lanes, K + "lanes.pulses.series", "along = along + load(state, a)", "along = along - load(state, a)"
    ),
    "pulse lanes: restitution": Fault(
        pulse_lanes, K + "lanes.pulses.march", "after = load(state, o + lane.L_ETA * WIDTH) * rate", "after = rate"
    ),
    "pulse lanes: no reset": Fault(
        pulse_lanes, K + "lanes.pulses.march", "s = select(lands, -s, s)", "s = select(lands, s, s)"
    ),
    "pulse lanes: wrong edge": Fault(
        pulse_lanes,
        K + "lanes.pulses.events",
        "state[i + lane.TOP_SIDE * WIDTH] = state[i + lane.S * WIDTH]",
        "state[i + lane.TOP_SIDE * WIDTH] = -state[i + lane.S * WIDTH]",
    ),
    "pulse lanes: end of a step": Fault(
        pulse_lanes, K + "lanes.pulses.march", "(h == t_next - t), t_next, t + x)", "(h == t_next - t), t_next, t + h)"
    ),
    "record lanes: sign": Fault(
        record_lanes, K + "lanes.records.rest", "-p2 * par[at.RIGHT + at.RS], -p2", "p2 * par[at.RIGHT + at.RS], -p2"
    ),
    "record lanes: restitution": Fault(
        record_lanes, K + "lanes.records.impacts", "gather(st, lanes + lane.ETA) * inward", "inward"
    ),
    "record lanes: no reset": Fault(
        record_lanes, K + "lanes.records.impacts", "select(hit, 0.0 * q - 1.0, 1.0)", "select(hit, 0.0 * q + 1.0, 1.0)"
    ),
    "record lanes: wrong edge": Fault(
        record_lanes, K + "lanes.records.impacts", "lanes + lane.SIDE, side * turned)", "lanes + lane.SIDE, side)"
    ),
    "record lanes: end of a step": Fault(
        record_lanes, K + "lanes.records.impacts", "now = fma(x, h, place)", "now = fma(0.999 * x, h, place)"
    ),
    "record lanes: no zero told": Fault(
        lifted_in_a_record, K + "lanes.records.impacts", "if some(going):  #", "if False:  #"
    ),
    "record lanes: cut sample": Fault(
        record_durations, K + "lanes.records.rest", "(last - 1.0 - st[lane.FIRST + i]) * dt\n\n", "(last - 1.2 - st[lane.FIRST + i]) * dt\n\n"
    ),
    "record lanes: cut off while rising": Fault(
        record_durations, K + "lanes.records.events", "(given or verdict != RETURNS)", "verdict != RETURNS"
    ),
    "record lanes: gravity": Fault(
        record_components, K + "lanes.records.step", "fma(share, a_v, 1.0), share", "fma(share, -a_v, 1.0), share"
    ),
    "record lanes: change of gravity": Fault(
        record_components, K + "lanes.records.step", "fma(fs, a1, rs * w1), fma(fc, a1, rc * w1)", "fma(fs, a1, rs * w1), fma(fc, a1, 0.99 * rc * w1)"
    ),
    "record lanes: gravity of a linear body": Fault(
        record_components, K + "lanes.records.step", "d4 = I3 * fma(r, I2 * d2, r1 * d1)", "d4 = I3 * fma(r, I2 * d2, 0.99 * r1 * d1)"
    ),
    "record lanes: lighter at rest": Fault(
        record_components, K + "lanes.records.rest", "d, dd = own * weight + sign", "d, dd = own + sign"
    ),
    "record lanes: weight": Fault(
        record_forces_of_both, K + "lanes.records.forces", "heavy, heavy_1, change = weight * w, weight * (w + w1), weight * w1", "heavy, heavy_1, change = weight, weight * (w + w1), weight * w1"
    ),
    "record lanes: weight at rest": Fault(
        record_forces_of_both, K + "lanes.records.rest", "* shake / weight)", "* shake)"
    ),
    "record lanes: work of both": Fault(
        record_forces_of_both, K + "lanes.records.forces", "work = gather(st, lanes + lane.INERTIA) * (w1 * area_up)", "work = gather(st, lanes + lane.INERTIA) * (0.99 * w1 * area_up)"
    ),
    "paths of pulses: friction": Fault(
        pulse_paths, K + "lanes.pulses.forces", "T = fma(shake, ground, fma(cos_b, acc", "T = fma(shake, ground, fma(-cos_b, acc"
    ),
    "paths of pulses: work": Fault(pulse_paths, K + "lanes.pulses.path", "fc * new[4] + fs * new[3]", "fc * new[4] - fs * new[3]"),
    "paths of pulses: between places": Fault(
        pulse_paths, K + "lanes.pulses.forces", "where = where & (f_low > 0.0)", "where = where & (f_low > 1e9)"
    ),
    "paths of pulses: until it falls": Fault(
        late_extremes, K + "lanes.pulses.forces", "<= state[i + lane.OVER_T * WIDTH]", "<= -1.0"
    ),
    "paths of pulses: brought back": Fault(
        paths_until_the_fall, K + "lanes.pulses.path", "lost = v > pull * select(right, plus, minus)", "lost = v > 0.0 * pull"
    ),
    "paths of pulses: friction at rest": Fault(
        uneven_paths, K + "lanes.pulses.forces", "size * shake / weight, most)", "most, most)"
    ),
    "paths of pulses: other edge": Fault(uneven_paths, K + "lanes.pulses.path", "mass - onto * eta * eta", "mass - mass * eta * eta"),
    "paths of pulses: last bounces": Fault(
        uneven_paths, K + "lanes.pulses.march", "slow = min(slow, rest_speed", "slow = max(slow, rest_speed"
    ),
    "paths of pulses: passage": Fault(pulse_paths, K + "lanes.pulses.path", "miss = q - star", "miss = q - 1.01 * star"),
    "record lanes: friction": Fault(
        record_forces, K + "lanes.records.forces", "T = fma(shake, a, fma(cos_b, acc", "T = fma(shake, a, fma(-cos_b, acc"
    ),
    "record lanes: normal force": Fault(record_forces, K + "lanes.records.forces", "weight - cos_b * vv)", "weight + cos_b * vv)"),
    "record lanes: inside a step": Fault(record_forces, K + "lanes.records.forces", "return fast | light | rough", "return fast & light & rough"),
    "record lanes: work": Fault(record_forces, K + "lanes.records.forces", "work = load(st, lane.INERTIA + i) * (a1 * area)", "work = load(st, lane.INERTIA + i) * (0.999 * a1 * area)"),
    "rolling: restitution": Fault(rolling, K + "rolling.march", "v = end.eta * abs(rate)", "v = 1.001 * end.eta * abs(rate)"),
    "rolling: impulses": Fault(rolling, K + "rolling.law", "pushed = other_b + eta * b", "pushed = other_b - eta * b"),
    "rolling, pulse lanes: next facet": Fault(
        rolling_pulses, K + "lanes.pulses.rolling", "facet += 1 if s > 0.0 else -1\n    mass", "facet += 0\n    mass"
    ),
    "rolling, pulse lanes: loss": Fault(
        rolling_pulses, K + "lanes.pulses.rolling", "(mass - onto * eta * eta)", "(mass - mass * eta * eta)"
    ),
    "rolling, pulse lanes: impulses": Fault(
        rolling_pulses, K + "lanes.pulses.rolling", "(lane.ONTO_LEFT, at.LEFT, at.RIGHT)", "(lane.ONTO_LEFT, at.RIGHT, at.LEFT)"
    ),
    "rolling, pulse lanes: levers": Fault(
        rolling_pulses, K + "lanes.pulses.rolling", "put_levers(state, i, end, end.fs, end.fc)", "put_levers(state, i, end, end.fc, end.fs)"
    ),
    "rolling, record lanes: loss": Fault(
        rolling_records, K + "lanes.records.rolling", "0.5 * (inertia * rate**2 - st", "0.5 * (inertia * rate**2 - 0.99 * st"
    ),
    "rolling, record lanes: work": Fault(
        rolling_records, K + "lanes.records.rolling", "* drive(st, i, extent, False)", "* drive(st, i, 0.9 * extent, False)"
    ),
    "rolling, record lanes: height": Fault(
        rolling_records, K + "lanes.records.facets", "return par[RISEN] if rolls(par) else 0.0", "return 0.0"
    ),
    "rolling, record lanes: landing": Fault(
        rolling_records, K + "lanes.records.impacts", "loss = 0.0 * q if onward else select(", "loss = select("
    ),
    "slips in lanes: friction": Fault(slips, K + "lanes.records.slips", "grip, lever, weight = mu * sigma,", "grip, lever, weight = 0.99 * mu * sigma,"),
    "slips in lanes: way": Fault(slips, K + "lanes.records.slips", "path = fma(u, h, path)", "path = fma(u, 0.9 * h, path)"),
    "slips in lanes: work": Fault(slips, K + "lanes.records.slips", "- grip * grips / h2", "+ grip * grips / h2"),
    "slips in lanes: normal force": Fault(
        slips, K + "lanes.records.slips", "held = 1.0 + stiff, held + g", "held = 1.0 + stiff, held + 1.01 * g"
    ),
    "slips in lanes: parts": Fault(slips, K + "lanes.records.stick_slip", "sl[slips.WORK + j] - energy_on_edge(par, foot)", "sl[slips.WORK + j]"),
    "contact: sign": Fault(planar_contact, K + "contact.flows", "-(a[k] + mu * foot.sigma * W[k])", "-(a[k] - mu * foot.sigma * W[k])"),
    "contact: restitution": Fault(
        planar_contact, K + "contact.impacts", "dw = -(h * f + place) / rg2", "dw = -(h * f + 0.99 * place) / rg2"
    ),
    "contact: wrong edge": Fault(
        planar_contact,
        K + "contact.impacts",
        "b_i, b_j, place = par[i + at.B], par[j + at.B], par[j + at.PLACE]",
        "b_i, b_j, place = par[i + at.B], -par[j + at.B], par[j + at.PLACE]",
    ),
    "contact: time of a swing": Fault(swings_left_out, K + "contact.decay", "- 2.0 * p2 * cos_a * u", "- 1.99 * p2 * cos_a * u"),
    "contact: swings counted": Fault(swings_left_out, K + "contact.decay", "if counts(par, -foot.s, v)", "if counts(par, -foot.s, v / 3.0)"),
    "column: sign": Fault(flexible, K + "column.law", "- g * theta - a * cos)", "+ g * theta - a * cos)"),
    "column: restitution": Fault(flexible, K + "column.automaton", "        v[m] *= par[at.ETA]\n", "        v[m] *= 1.0\n"),
    "column: no reset": Fault(
        flexible,
        K + "column.automaton",
        "switch(T, False, z, v, z_x, v_x)\n    for m in range(len(z)):\n        z[m], v[m] = z_x[m], v_x[m]\n",
        "switch(T, False, z, v, z_x, v_x)\n    for m in range(len(z)):\n        z[m] = z_x[m]\n",
    ),
    "column: wrong edge": Fault(flexible, K + "column.law", "        return s * full\n", "        return -s * full\n"),
    "column: end of a step": Fault(
        flexible,
        K + "column.automaton",
        "t = t_next if lands and h == wanted and not event else t + x",
        "t = t_next if lands and h == wanted else t + h",
    ),
    "frame: sign": Fault(beam_elements, K + "frame.newmark", "-a_g * pull[i] - down", "a_g * pull[i] - down"),
    "frame: restitution": Fault(beam_elements, K + "frame.march", "v[k] *= eta", "v[k] *= 0.97 * eta"),
    "frame: no reset": Fault(beam_elements, K + "frame.march", "            armed = False\n", "            armed = True\n"),
    "frame: wrong edge": Fault(
        beam_elements, K + "frame.march", "armed, side = True, 1.0 if u[2] > 0.0 else -1.0", "armed, side = True, 1.0"
    ),
    "frame: end of a step": Fault(
        beam_elements, K + "frame.newmark", "((1.0 - gamma) * a[i] + gamma * a_1[i])", "(gamma * a_1[i] + gamma * a_1[i])"
    ),
    "scipy: sign": Fault(
        scipy_backend,
        "rockcli.solvers.general.body",
        "edge.fc * math.cos(q) + edge.fs * math.sin(q)",
        "edge.fc * math.cos(q) - edge.fs * math.sin(q)",
    ),
    "scipy: restitution": Fault(
        scipy_backend, "rockcli.solvers.general.event_located", "after = other.eta * before", "after = 1.001 * other.eta * before"
    ),
    "scipy: no reset": Fault(
        scipy_backend, "rockcli.solvers.general.event_located", "0.0, after, other.sign", "0.0, after, self.sign"
    ),
    "sweep: lost chunk": Fault(
        sweep, "rockcli.engine.sweep.results", "            self.scalars[name][at] = values\n",
        "            self.scalars[name][at] = values if self.answered < self.size else self.scalars[name][at]\n",
    ),
    "sweep: wrong place": Fault(
        sweep, "rockcli.engine.sweep.results", "slice(int(cases[0]), int(cases[-1]) + 1) if contiguous else cases", "cases[::-1]"
    ),
    "sweep: wrong share": Fault(
        shares, "rockcli.engine.sweep.sweep", "range((k - 1) * block, n, shares * block)", "range(k * block, n, shares * block)"
    ),
}  # fmt: skip
"""By family and kind of fault."""


LONG = (
    *(pulse_paths, late_extremes, paths_until_the_fall, uneven_paths, rolling, rolling_pulses, rolling_records),
    *(lifted_in_a_record, record_forces_of_both, slips),
)
"""Truths that take plain Python seconds."""


def _marked(value: object, truth: Callable[[], None]):
    return pytest.param(value, marks=[pytest.mark.slow] if truth in LONG else [])


@pytest.mark.parametrize(
    "truth",
    [_marked(truth, truth) for truth in dict.fromkeys(fault.truth for fault in FAULTS.values())],
    ids=lambda f: f.__name__,
)
def test_the_program_as_it_is_passes(truth, plain):
    truth()


@pytest.mark.parametrize("name", [_marked(name, fault.truth) for name, fault in FAULTS.items()])
def test_fault_is_noticed(name, plain):
    fault = FAULTS[name]
    with spoilt(fault.module, fault.right, fault.wrong), pytest.raises((AssertionError, ArithmeticError)):
        fault.truth()
