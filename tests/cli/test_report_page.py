"""`rock report`: one page that holds everything and needs nothing."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from half_sines import SUITE
from typer.testing import CliRunner

import rockcli
from rockcli.cli.main import app
from rockcli.engine.run import solve
from rockcli.plotting.common.table import case_table
from rockcli.plotting.page.facts import facts_of, sentence_of
from rockcli.plotting.page.page import page
from rockcli.storage import netcdf
from rockcli.study.open import open_study

VOID = {"meta", "img", "br", "wbr"}


class Outline(HTMLParser):
    """Checks that tags are closed in order, and gathers text and what is loaded from elsewhere."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.words: list[str] = []
        self.outside: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in VOID:
            self.open.append(tag)
        self.outside += [v or "" for k, v in attrs if k in ("src", "href") and not (v or "").startswith("data:")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    study = {
        "name": "paged",
        "title": "Peaks < 1 & more",
        "case": {
            "block": {"R": 2.0, "tan_alpha": 0.2, "mu": 0.21},
            "motion": {"pulse": {"shape": "ricker", "a_p_over_g_tan_alpha": 3.6, "omega_p": "3*pi"}},
        },
        "vary": {"model": ["rigid", 3]},
        "expect": [
            {"quantity": "theta_peak_over_alpha", "at": {"model": "rigid"}, "max": 0.01},
            {"quantity": "eta", "min": 0.5},
        ],
    }
    path = tmp_path_factory.mktemp("report") / "paged.nc"
    netcdf.write(solve(open_study(study)), path)
    told = CliRunner().invoke(app, ["report", str(path)])
    assert told.exit_code == 0, told.output
    assert told.stdout.strip() == str(path.with_suffix(".html"))
    return path, path.with_suffix(".html").read_text(encoding="utf-8")


def test_the_page_is_whole_and_loads_nothing(written: tuple[Path, str]) -> None:
    outline = Outline()
    outline.feed(written[1])
    assert outline.open == []
    assert outline.outside == []
    assert "Peaks < 1 & more" in outline.words


def test_result_verdicts_reasons_study_and_provenance(written: tuple[Path, str]) -> None:
    outline = Outline()
    outline.feed(written[1])
    words = " ".join(outline.words)
    for expected in (
        "Expected: 1 of 2 met",
        "not met",
        "theta_peak_over_alpha at model=rigid <= 0.01",
        "tan_alpha: 0.2",
        "rtol: 1e-12",
        "numba",
    ):
        assert expected in words
    with netcdf_open(written[0]) as file:
        for sentence in set(file["reasons"][:]) - {""}:
            assert str(sentence) in words
        assert file.identity in words
        rigid = list(file["model"][:]).index("rigid")
        assert f"<= 0.01: {float(file['theta_peak_over_alpha'][rigid]):.9g}" in words


def netcdf_open(path: Path):  # type: ignore[no-untyped-def]
    import netCDF4

    return netCDF4.Dataset(path)


def test_plots_are_drawings(written: tuple[Path, str]) -> None:
    """Each has a scalable drawing with words for those who do not see it, and names itself by no file of its own."""
    drawings = re.findall(r"<svg .*?</svg>", written[1], flags=re.S)
    titles = re.findall(r"<h2>(.*?)</h2>", written[1])
    assert titles[:4] == ["Result", "The body", "The ground motion", "Response"]
    assert len(drawings) == 4  # and the phase portrait
    for drawing in drawings:
        root = ElementTree.fromstring(drawing)
        assert root.get("role") == "img"
        assert root.get("aria-label")
    assert "data:image" not in written[1]
    names = re.findall(r' id="([^"]*)"', written[1])
    assert len({*names}) == len(names)  # every drawing had a `figure_1`, an `axes_1` and the same letters
    assert {*re.findall(r'(?:href="|url\()#([^")]*)', written[1])} <= {*names}


def test_the_headline_is_in_words_with_units() -> None:
    """Of one case: its own numbers, in degrees, millimetres and g."""
    pulse = {"shape": "ricker", "a_p": "0.73*g", "omega_p": "3*pi"}
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}
    data = rockcli.run({"name": "one", "case": case})
    facts = {fact.what: fact.value for fact in facts_of(data)}
    theta = abs(float(data.theta_peak))
    assert facts["largest rotation"] == f"{np.degrees(theta):.3g}\N{DEGREE SIGN}"
    assert facts["the top moves"] == f"{4000.0 * np.cos(np.arctan(0.2)) * np.sin(theta):.3g} mm"
    assert facts["margin"] == f"{100.0 * (1.0 - theta / np.arctan(0.2)):.3g} %"
    assert facts["lifts from"] == "0.2 g"
    assert sentence_of(data) == "The body rocks from edge to edge and comes back: it does not overturn."
    bare = data.drop_vars("u_top_peak")
    assert {fact.what: fact.value for fact in facts_of(bare)}["the top moves"] == facts["the top moves"]


def test_one_of_several_is_said_of_in_the_singular() -> None:
    """Blocks of tan(alpha) = 0.05, 0.2 and 2 under a long pulse of 0.5 g, and a suite of it alone."""
    pulse = {"shape": "half_sine", "a_p": "0.5*g", "omega_p": 12.0}
    vary = {"motion.pulse.omega_p": [12.0], "block.tan_alpha": [0.05, 0.2, 2.0]}
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}
    data = rockcli.run({"name": "three", "case": case, "vary": vary, "over": "omega_p", "save": {"histories": False}})
    assert sentence_of(data) == "Of 3 cases 1 overturns, 1 rocks and comes back and 1 stays at rest."
    says = json.loads(data.attrs["ensemble"])["says"]
    assert any(words.startswith("share of 1 point of motion_pulse_omega_p that overturns") for words in says)
    assert rockcli.plot(data, "curve").get_label().count("1 value of") == 1


def test_a_motion_that_is_cut_off_is_not_called_weak() -> None:
    """3 g would lift the body after the first millisecond, the last of this motion."""
    pulse = {"shape": "sine", "a_p": 30.0, "T_p": 1.0}
    data = rockcli.run({"case": {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse, "duration": 0.001}}})
    assert int(data["outcome"]) == 0
    assert sentence_of(data) == "The body stays at rest: the motion does not lift it."


def test_the_headline_has_the_alpha_of_the_side_that_the_peak_is_of() -> None:
    """A push to the stronger side."""
    pulse = {"shape": "half_sine", "a_p": "-0.4*g", "omega_p": 6.0}
    case = {"block": {"h": 2.0, "b": [0.3, 0.5]}, "motion": {"pulse": pulse}, "damping": {"eta": 0.2}}
    data = rockcli.run({"name": "one", "case": case})
    theta, alpha = float(data.theta_peak), float(data.alpha_right)
    assert theta > 0.0
    facts = {fact.what: fact for fact in facts_of(data)}
    assert facts["largest rotation"].value == f"{np.degrees(theta):.3g}\N{DEGREE SIGN}"
    reaches = f"reaches {100.0 * theta / alpha:.3g} % of the angle ({np.degrees(alpha):.3g}\N{DEGREE SIGN})"
    assert reaches in facts["margin"].sentence


def test_the_headline_of_a_body_that_rolls_has_the_rotation_at_which_it_falls() -> None:
    """By hand: over its last corner, at x = 0.4 m and 0.15 m above the base; alpha of the base is passed long before."""
    side = [[0.1, 0.0], [0.22, 0.02], [0.33, 0.07], [0.4, 0.15], [0.4, 0.6]]
    pulse = {"shape": "ricker", "a_p": "1.5*g", "T_p": 0.5}
    block = {"outline": side + [[-x, z] for x, z in reversed(side)]}
    data = rockcli.run({"name": "one", "case": {"block": block, "motion": {"pulse": pulse}}})
    assert 1.0 < float(data.theta_peak_over_alpha) < np.inf
    falls = np.arctan(0.4 / (float(data.R * np.cos(data.alpha)) - 0.15))
    share = 100.0 * abs(float(data.theta_peak)) / falls
    (said,) = (fact for fact in facts_of(data) if fact.what == "margin")
    assert said.value == f"{100.0 - share:.3g} %"
    assert f"reaches {share:.3g} % of the angle ({np.degrees(falls):.3g}\N{DEGREE SIGN})" in said.sentence
    still = rockcli.run({"name": "one", "case": {"block": block, "motion": {"pulse": pulse | {"a_p": "0.1*g"}}}})
    assert str(float(still.u_top_peak)) == "0.0"  # not -0.0


def test_the_headline_tells_the_alpha_of_a_column_as_that_of_a_rigid_body() -> None:
    """A column that bends falls from less."""
    column = {"model": "flexible", "column": {"E": 1e9, "rho": 2500, "elements": 3}, "base": {"law": "rigid"}}
    case = {"block": {"height": 20, "width": 2}, "initial": {"theta": 0.02}, **column}
    data = rockcli.run({"name": "one", "case": case, "save": {"histories": False}})
    (said,) = (fact for fact in facts_of(data) if fact.what == "margin")
    assert said.sentence.endswith("at which its weight, were it rigid, no longer brings it back")


@pytest.mark.parametrize(("tan_alpha", "reached"), [(0.6, 1.1 * np.arctan(0.6) / np.arcsin(0.6)), (1.2, None)])
def test_the_margin_of_a_model_is_to_its_own_equilibrium(tan_alpha, reached):
    """Corotational model 2 falls beyond asin(tan alpha), if ever: beyond alpha a margin was told as none."""
    case = {"block": {"R": 2.0, "tan_alpha": tan_alpha}, "model": 2, "geometry": "corotational"}
    facts = facts_of(rockcli.run({"case": case | {"initial": {"theta": "1.1*alpha"}}}))
    said = [fact for fact in facts if fact.what == "margin"]
    assert [fact.value for fact in said] == ([] if reached is None else [f"{100.0 * (1.0 - reached):.3g} %"])


def test_the_headline_calls_no_rotation_the_largest_that_is_not() -> None:
    """Of bodies with different alpha the nearest to it need not turn farthest."""
    pulse = {"shape": "half_sine", "a_p": "0.45*g", "omega_p": 6.0}
    bodies = {"slender": {"h": 1.0, "b": 0.11}, "stout": {"h": 1.0, "b": 0.42}}
    case = {"block": {"h": 1.0, "b": 0.2}, "motion": {"pulse": pulse}}
    data = rockcli.run({"name": "two", "case": case, "vary": {"block": bodies}, "save": {"histories": False}})
    data["theta_peak"][:], data["theta_peak_over_alpha"][:], data["outcome"][:] = [0.06, 0.08], [0.5, 0.2], 1
    facts = {fact.what: fact for fact in facts_of(data)}
    assert "largest rotation" not in facts
    assert facts["rotation nearest to alpha"].value == f"{np.degrees(0.06):.3g}\N{DEGREE SIGN}"
    assert "the nearest to its alpha, at block slender" in facts["rotation nearest to alpha"].sentence
    data["theta_peak"][:] = [0.1, 0.08]
    assert "largest rotation" in {fact.what for fact in facts_of(data)}


def test_the_headline_has_the_weaker_edge_of_every_body() -> None:
    bodies = {"slender": {"h": 1.0, "b": [0.3, 0.1]}, "stout": {"h": 1.0, "b": [0.4, 0.6]}}
    data = rockcli.run({"name": "two", "case": {"block": {"h": 1, "b": 0.2}}, "vary": {"block": bodies}})
    (said,) = (fact for fact in facts_of(data) if fact.what == "lifts from")
    assert said.value == "0.1 to 0.4 g"


def test_the_headline_tells_whose_acceleration_it_is() -> None:
    record = {"values": [0.0, 1.0, 0.0, -1.0, 0.0], "dt": 0.2, "units": "m/s2"}
    motion = {"record": record | {"pga": 1.0}, "through": [{"T": 0.8, "zeta": 0.05}]}
    study = {"name": "floor", "case": {"block": {"h": 1.0, "b": 0.1}, "motion": motion}}
    data = rockcli.run(study | {"vary": {"motion.record.pga": [0.1, 20.0]}})
    facts = {fact.what: fact.sentence for fact in facts_of(data)}
    assert facts["overturns from"] == "PGA of the ground, the lowest of the study that overturns a case"
    assert facts["lifts from"].startswith("of what arrives at its base")


def test_the_headline_has_the_rate_and_the_probability_within_the_age() -> None:
    curve = {"label": "site", "intensity": ["0.05*g", "0.5*g", "3*g"], "rate": [1e-2, 1e-4, 1e-7]}
    data = rockcli.run(SUITE | {"hazard": [curve], "age": 50})
    (said,) = (fact for fact in facts_of(data) if fact.what == "rate of overturning")
    rate = float(data.annual_rate.sel(limit_state="overturned").squeeze())
    assert said.value == f"{rate:.2g} a year"
    years, share = float(f"{1.0 / rate:.2g}"), -100.0 * np.expm1(-50.0 * rate)
    assert said.sentence == (
        f"under the hazard site: once in {years:g} years; within 50 years with a probability of {share:.2g} %"
    )


@pytest.mark.parametrize(
    ("probability", "told"), [(0.4234, "42"), (0.9973, "99.73"), (0.99999, "more than 99.99"), (0.0, "0")]
)
def test_a_probability_near_one_keeps_the_digits_that_tell_it(probability: float, told: str) -> None:
    curve = {"label": "site", "intensity": ["0.05*g", "0.5*g", "3*g"], "rate": [1e-2, 1e-4, 1e-7]}
    data = rockcli.run(SUITE | {"hazard": [curve], "age": 50})
    data["probability_in_age"][:] = probability
    (said,) = (fact for fact in facts_of(data) if fact.what == "rate of overturning")
    assert said.sentence.endswith(f"; within 50 years with a probability of {told} %")


def test_the_headline_says_what_motions_beyond_a_hazard_curve_may_add() -> None:
    curve = {"label": "site", "intensity": [0.05, 0.2, 0.8], "rate": [2e-2, 1e-3, 1e-5]}  # in g, as one may forget
    data = rockcli.run(SUITE | {"hazard": [curve]})
    (said,) = (fact for fact in facts_of(data) if fact.what == "rate of overturning")
    assert said.value == "0 a year"
    assert said.sentence == (
        "under the hazard site: by no motion of it; motions beyond its last point may add up to 1e-05"
    )


def test_a_median_beyond_the_suite_is_told_as_extrapolated(tmp_path: Path) -> None:
    path = "motion.pulse.a_p"
    weak = SUITE | {"vary": {**SUITE["vary"], path: {"from": "0.1*g", "to": "0.33*g", "n": 8}}}  # type: ignore[dict-item]
    data = rockcli.run(weak)
    median, highest = float(data.fragility_median[-1]), float(data.fragility_highest)
    assert median > highest
    (said,) = (fact for fact in facts_of(data) if fact.what == "median of overturning")
    assert said.sentence.endswith("; beyond the intensities of the suite, extrapolated")
    (words,) = (one for one in json.loads(data.attrs["ensemble"])["says"] if one.startswith("overturning: "))
    assert re.search(r"median motion_pulse_a_p \S+ m/s² \(95 % .*?, extrapolated\), beta", words), words
    (whole,) = (fact for fact in facts_of(rockcli.run(SUITE)) if fact.what == "median of overturning")
    assert "extrapolated" not in whole.sentence


def test_the_headline_says_which_bodies_its_median_and_rate_leave_out() -> None:
    """A tiny body overturns at every level above uplift, and has no curve: the others must not speak for it."""
    curve = {"label": "site", "intensity": ["0.05*g", "0.5*g", "3*g"], "rate": [1e-2, 1e-4, 1e-7]}
    vary = {"block.R": [0.001, 2.0, 3.0], **SUITE["vary"]}  # type: ignore[dict-item]
    data = rockcli.run(SUITE | {"vary": vary, "hazard": [curve]})
    assert np.isnan(data.fragility_median.values[:, -1]).tolist() == [True, False, False]
    told = {fact.what: fact.sentence for fact in facts_of(data)}
    for what in ("median of overturning", "rate of overturning"):
        assert told[what].endswith("; 1 of 3 bodies have no curve and are not in it")


def test_tables_say_that_a_body_without_a_curve_may_only_slide(tmp_path: Path) -> None:
    """On mu < tan(alpha) no motion is strong enough: the range is not too low."""
    bodies = {"rocks": {"R": 2.0, "tan_alpha": 0.2, "mu": 0.8}, "slides": {"R": 2.0, "tan_alpha": 0.2, "mu": 0.15}}
    data = rockcli.run(SUITE | {"vary": {"block": bodies, **SUITE["vary"]}})  # type: ignore[dict-item]
    rockcli.report(data, tmp_path / "page.html")
    told = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "none (none exceeds): no case exceeds it, so the range is too low, or bodies slide and do not rock" in told


def test_the_files_of_a_study_are_called_files(tmp_path: Path) -> None:
    (tmp_path / "bodies.csv").write_text("body,block.R\none,1.0\ntwo,2.0\n", encoding="utf-8")
    (tmp_path / "s.yaml").write_text(
        "{name: s, case: {block: {R: 1, alpha: 0.2}, initial: {theta: 0.05}}, vary: {case: bodies.csv}}",
        encoding="utf-8",
    )
    rockcli.report(rockcli.run(tmp_path / "s.yaml"), tmp_path / "page.html")
    told = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "<th>file bodies.csv</th>" in told
    assert "<th>record bodies.csv</th>" not in told


def test_the_headline_has_the_largest_slide() -> None:
    """By hand: a block at rest on friction mu, thrown at speed v, slides v^2 / (2 mu g)."""
    case = {"block": {"R": 2.0, "tan_alpha": 0.5, "mu": 0.1}, "initial": {"slide_rate": 1.0}}
    one = rockcli.run({"name": "one", "case": case})
    (said,) = (fact for fact in facts_of(one) if fact.what == "largest slide")
    assert said.value == f"{1e3 / (2.0 * 0.1 * 9.81):.3g} mm"
    assert said.sentence == "along the ground at most"
    many = rockcli.run({"name": "many", "case": case, "vary": {"initial.slide_rate": [0.0, 1.0, 5.0]}})
    (said,) = (fact for fact in facts_of(many) if fact.what == "largest slide")
    assert said.value == f"{25.0 / (2.0 * 0.1 * 9.81):.3g} m"
    assert said.sentence == "along the ground at most, in 2 of 3 cases; most at slide rate 5 m/s"
    assert "largest slide" not in {fact.what for fact in facts_of(many.isel({many.slide_peak.dims[0]: [0]}))}


def test_motions_to_both_sides_overturn_from_the_weakest() -> None:
    """Amplitudes with a sign: a body falls to its narrow side under less than to the other."""
    pulse = {"shape": "half_sine", "a_p": 4.0, "T_p": 1.0}
    case = {"block": {"h": 1.0, "b": [0.2, 0.3]}, "motion": {"pulse": pulse}}
    over = {"motion.pulse.a_p": [-6.0, -4.0, -2.0, 1.0, 3.0, 4.0, 6.0]}
    data = rockcli.run({"case": case, "vary": over, "save": {"histories": False}})
    for part in (data, data.isel(motion_pulse_a_p=data.motion_pulse_a_p < 0.0)):
        fell = part.motion_pulse_a_p.values[part.outcome.isin([2, 3]).values]
        said = {fact.what: fact.value for fact in facts_of(part)}["overturns from"]
        assert said == f"{fell[np.argmin(np.abs(fell))] / 9.81:.3g} g"
    assert said == "-0.612 g"


def test_the_headline_of_many_cases() -> None:
    data = rockcli.run(SUITE)
    facts = {fact.what: fact.value for fact in facts_of(data)}
    fell = data.outcome.isin([2, 3])
    at = "motion_pulse_a_p" if "motion_pulse_a_p" in data.dims else "a_p"
    lowest = float(data[at].values[fell.any("motion_pulse_omega_p").values].min())
    assert facts["overturns from"] == f"{lowest / 9.81:.3g} g"
    median = float(data.fragility_median.values[-1]) / 9.81
    assert np.isfinite(median)
    assert facts["median of overturning"] == f"{median:.3g} g"
    assert sentence_of(data).startswith(f"Of 100 cases {int(fell.sum())} overturn, ")
    calm = data.isel({at: [0]}).assign_attrs(ensemble="null")
    assert {fact.what: fact.value for fact in facts_of(calm)}["overturns"] == "nowhere"


def test_the_headline_of_a_search_tells_what_lies_outside_its_range() -> None:
    """Half a sine at 0.5 g: the smallest body overturns there already, at the lowest point searched; the largest at 0.9 g
    does not."""
    case = {"block": {"R": 1.0, "tan_alpha": 0.2}, "motion": {"pulse": {"shape": "half_sine", "a_p": 1.0, "T_p": 1.0}}}
    sizes, ends = [0.2, 3.0, 50.0], ["0.5*g", "0.9*g"]

    def told(R: list[float], *a_p: str) -> tuple[str, str, str]:
        span = {"from": a_p[0], "to": a_p[1], "n": 20, "find": "overturning"}
        data = rockcli.run({"name": "s", "case": case, "vary": {"block.R": R, "motion.pulse.a_p": span}})
        (fact,) = (fact for fact in facts_of(data) if fact.what.startswith("overturns"))
        return fact.value, fact.what, fact.sentence

    at_ends = rockcli.run({"name": "e", "case": case, "vary": {"motion.pulse.a_p": ends, "block.R": sizes}})
    assert at_ends.outcome.isin([2, 3]).values.tolist() == [[True, False, False], [True, True, False]]
    what = "peak acceleration of the pulse"
    assert told(sizes, *ends) == (
        "0.5 g or less",
        "overturns from",
        f"{what}, the lowest searched: 1 of 3 cases overturn there already; 1 of 3 cases overturn nowhere up to 0.9 g",
    )
    value, _, sentence = told(sizes[1:], *ends)
    assert 0.5 < float(value.removesuffix(" g")) < 0.9
    assert sentence == f"{what}, the lowest that overturns; 1 of 2 cases overturn nowhere up to 0.9 g"
    assert told(sizes[2:], *ends) == ("nowhere", "overturns", f"up to {what} 0.9 g")


def test_a_page_calls_what_was_searched_along_by_its_name() -> None:
    """It had the name of a variable, `motion_record_pga`; with floors it is the ground's."""
    values = (np.sin(np.linspace(0.0, 6.0 * np.pi, 200)) * np.linspace(1.0, 0.1, 200)).tolist()
    record = {"values": values, "dt": 0.01, "units": "g"}
    vary = {
        "motion.record": {"one": record, "two": record | {"dt": 0.02}},
        "motion.record.pga": {"from": "0.1*g", "to": "6*g", "n": 30, "find": "overturning"},
    }
    case = {
        "block": {"R": 1.0, "tan_alpha": 0.2},
        "motion": {"record": record, "through": [{"T": 0.2, "zeta": 0.05}]},
    }
    data = rockcli.run({"case": case, "vary": vary, "over": "record"})
    text = page(data, [])
    assert "<li>Lowest overturning PGA of the ground of 2 records, median: " in text
    assert "<p>Lowest overturning PGA of the ground: " in text
    (fact,) = (fact for fact in facts_of(data) if fact.what == "overturns from")
    assert fact.sentence.startswith("PGA of the ground, ")


def test_sections_of_figures_say_what_is_in_them() -> None:
    """A search had `Peak rotation`, captions told what a figure is of other datasets, and two sections one title."""
    pulse = {"shape": "half_sine", "a_p": 4.0, "T_p": 1.0}
    case = {"block": {"R": 1.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}
    sizes, widths = [1.0, 2.0, 3.0, 4.0, 5.0], [0.6, 0.7, 0.8, 0.9, 1.0]
    span = {"from": "0.1*g", "to": "2*g", "n": 20, "find": "overturning"}
    studies = {
        "Lowest overturning values": {"motion.pulse.a_p": span, "motion.pulse.T_p": widths},
        "Share that overturns": {"motion.pulse.T_p": widths, "block.tan_alpha": [0.2, 0.25, 0.3]},
        "Peak rotation": {"motion.pulse.T_p": widths},
        "Outcomes": {"motion.pulse.T_p": widths, "block.R": sizes},
    }
    for title, vary in studies.items():
        over = {"over": "T_p"} if title.startswith("Share") else {}
        text = page(rockcli.run({"case": case, "vary": vary, "save": {"histories": False}} | over))
        titles = re.findall(r"<h2>(.*?)</h2>", text)
        assert title in titles
        assert len({*titles}) == len(titles)
        caption, drawing = re.findall(
            r'<p class="quiet">([^<]*)</p><div class="plot"><svg role="img" aria-label="([^"]*)"', text
        )[-1]
        assert caption == drawing
        assert "`" not in caption
        assert "of a suite the share" not in caption


def test_no_absolute_paths_and_a_page_for_paper(written: tuple[Path, str]) -> None:
    data = rockcli.open_dataset(written[0])
    told = data.assign_attrs(warnings=json.dumps(["read /home/someone/secret/a.AT2 and C:\\Users\\me\\b.AT2, 1 m/s/s"]))
    words = page(told)
    assert "secret" not in words
    assert "someone" not in words
    assert "Users" not in words
    assert "read a.AT2 and b.AT2, 1 m/s/s" in words
    assert "size: A4" in words
    assert words.index("<h2>Result") < words.index("<summary>Notes and warnings") < words.index("<h2>Provenance")


def test_tables_of_the_suite_and_the_rules(tmp_path: Path) -> None:
    data = rockcli.run(SUITE | {"rules": ["west"]})
    words = rockcli.report(data, tmp_path / "a.html").read_text(encoding="utf-8")
    for title in ("Fragility in numbers", "The suite", "Rules of thumb and code checks"):
        assert f"<h2>{title}</h2>" in words
    assert f"<td>{float(data.fragility_median.values[-1]) / 9.81:.4g}</td>" in words
    assert "<td>west</td><td>1885</td><td>100</td>" in words


def test_tables_of_the_suite_name_axes_as_the_page_does(tmp_path: Path) -> None:
    """They had `block R [m]`, the PGA of the ground as if it were that of what arrives, and units as `year-1`."""
    values = (np.sin(np.linspace(0.0, 6.0 * np.pi, 200)) * np.linspace(1.0, 0.1, 200)).tolist()
    record = {"values": values, "dt": 0.01, "units": "g"}
    case = {"block": {"R": 1.0, "tan_alpha": 0.2}}
    case["motion"] = {"record": record, "through": [{"T": 0.2, "zeta": 0.05}]}
    vary = {
        "motion.record": {"one": record, "two": record | {"dt": 0.02}},
        "motion.record.pga": {"from": "0.1*g", "to": "2*g", "n": 5},
        "block.R": [0.5, 1.0],
    }
    hazard = {"intensity": ["0.05*g", "0.5*g", "3*g"], "rate": [1e-2, 1e-4, 1e-7]}
    over = {"axis": "record", "intensity": "ground_pga"}
    data = rockcli.run({"case": case, "vary": vary, "over": over, "hazard": hazard, "save": {"histories": False}})
    words = rockcli.report(data, tmp_path / "a.html").read_text(encoding="utf-8")
    for head in ("R [m]", "PGA of the ground [g]", "annual rate [1/year]"):
        assert f"<th>{head}</th>" in words


def test_the_page_says_of_which_second_intensity_its_medians_are(tmp_path: Path) -> None:
    record = {"file": "synthetic_rock_m65.AT2", "pga": 1.0}
    axes = {
        "motion.record.file": "synthetic_*.AT2",
        "motion.record.highpass": [0.1, 0.4, 0.8],
        "motion.record.pga": {"from": 1.0, "to": 20.0, "n": 9, "spacing": "log"},
    }
    case = {"block": {"R": 1.0, "tan_alpha": 0.2}, "motion": {"record": record}}
    over = {"axis": ["record", "highpass"], "intensity": ["pga", "pgv_over_pga"], "limits": []}
    data = rockcli.run({"case": case, "vary": axes, "over": over, "save": {"histories": False}})
    words = rockcli.report(data, tmp_path / "a.html").read_text(encoding="utf-8")
    assert "at a second intensity of [s]" in words
    assert f"<td>{float(data.fragility_second):.4g}</td>" in words
    assert "one half of the suite overturns, at the second intensity of the table" in words


def test_counts_of_a_table_are_whole(tmp_path: Path) -> None:
    case = {"block": {"h": 1.5, "b": 0.3}, "initial": {"theta": 0.1}}
    study = {"case": case, "uncertain": {"initial.theta": {"uniform": [0.05, 0.25]}}, "samples": 10_001}
    words = rockcli.report(rockcli.run(study), tmp_path / "a.html").read_text(encoding="utf-8")
    assert "<td>10001</td>" in words


@pytest.mark.slow
def test_a_figure_that_leaves_out_bodies_says_how_they_are_drawn() -> None:
    bodies = {"block.h": [1.8, 1.9, 2.0, 2.1], "block.b": [0.4, 0.45]}
    for some, left_out in ((bodies, True), ({"block.h": [1.8, 1.9]}, False)):
        study = SUITE | {"name": "many", "vary": SUITE["vary"] | some}
        study["case"] = SUITE["case"] | {"block": {"h": 1.9, "b": 0.4}}
        text = page(rockcli.run(study), [])
        for kind in ("ida", "fragility"):
            said = f"6 of 8 panels shown.*others: rock plot many.nc --kind {kind} --select AXIS=VALUE, of h, b<"
            assert bool(re.search(said, text)) is left_out


def test_bodies_left_out_of_samples_are_chosen_by_the_sample() -> None:
    """Whatever the suite is over: the command named no axis behind its `of`."""
    study = {
        "name": "many",
        "case": SUITE["case"] | {"block": {"height": 2.0, "width": 0.5}},
        "vary": {"motion.pulse.T_p": [0.5, 0.8]},
        "uncertain": {"block.width": {"uniform": [0.4, 0.6]}},
        "samples": 8,
        "over": ["T_p", "sample"],
        "save": {"histories": False},
    }
    text = page(rockcli.run(study), [])
    assert "6 of 8 bodies shown; the figure names them; others: rock plot many.nc --kind body" in text
    assert "--kind body --select AXIS=VALUE, of sample<" in text


def test_a_refined_map_is_summed_up_over_what_was_solved() -> None:
    pulse = {"shape": "ricker", "omega_p_over_p": 2, "a_p_over_g_tan_alpha": 2}
    axes = {
        "motion.pulse.omega_p_over_p": {"from": 0.1, "to": 10, "n": 100},
        "motion.pulse.a_p_over_g_tan_alpha": {"from": 1, "to": 10.9, "n": 100},
    }
    case = {"block": {"R": 1, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}
    data = rockcli.run({"name": "map", "case": case, "vary": axes, "refine": True})
    solved = data["solved"].values == 1
    assert not solved.all()
    _, rows, note = case_table(data)
    assert note.startswith("over the solved cases")
    told = {row[0]: row[1:] for row in rows}
    impacts = data["n_impacts"].values[solved]
    assert told["n_impacts"][0] == "0"  # what was filled in has -1
    assert told["n_impacts"][2] == f"{np.median(impacts):.6g}"
    assert told["theta_peak_over_alpha"][-1] == str(int(np.isinf(data["theta_peak_over_alpha"].values[solved]).sum()))


def test_sentences_on_a_suite_keep_the_names_of_symbols() -> None:
    study = SUITE | {"vary": SUITE["vary"] | {"block.h": [1.9, 2.0]}}
    study["case"] = SUITE["case"] | {"block": {"h": 1.9, "b": 0.4}}
    text = page(rockcli.run(study), [])
    assert "<li>h=1.9 m: curves begin at uplift" in text
    assert "H=1.9" not in text


def test_wrong_targets(written: tuple[Path, str], tmp_path: Path) -> None:
    rock = CliRunner()
    for arguments in (
        [str(written[0]), "--out", str(written[0])],
        [str(tmp_path / "absent.nc")],
        [str(written[0]), str(written[0]), "--out", str(tmp_path / "a.html")],
    ):
        result = rock.invoke(app, ["report", *arguments])
        assert result.exit_code != 0
    netcdf.read(written[0])


def test_what_an_audit_found_stands_in_the_result() -> None:
    study = {
        "case": {
            "block": {"R": 2.0, "tan_alpha": 0.2},
            "motion": {"pulse": {"shape": "sine", "a_p_over_g_tan_alpha": 1.5, "omega_p": "4*pi"}},
        },
        "vary": {"block.R": [1.0, 2.0]},
    }
    audited, plain = (page(rockcli.run(study | {"name": "audited", "audit": audit})) for audit in (True, False))
    result = audited[audited.index("<h2>Result") : audited.index("The body")]
    assert re.search(
        r"Audit: all 2 cases again, standard -&gt; reference: 0 other outcomes, .*; peaks differ by", result
    )
    assert "Audit" not in plain
