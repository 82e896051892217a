"""Fragility models for OpenQuake: the rules of NRML 0.5, and the curves that its reader makes of them.

The rules are those of its documentation: one `imls` per function with a known intensity and unit, ascending levels,
the limit states of the model in their order, probabilities that grow with the level and fall from one state to the
next.  `as_read` evaluates a function as the engine does.
"""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from scenes import G
from scipy import stats
from test_table import SUITE

from rockcli.analysis.nrml import NAMESPACE, fragility_model
from rockcli.engine.run import solve
from rockcli.errors import StudyError
from rockcli.study.open import open_study

TAG = f"{{{NAMESPACE}}}"


def study(**more):
    return {
        "name": "for-openquake",
        "title": "Two <blocks> & a pulse",
        "case": {
            "block": {"R": 2.0, "tan_alpha": 0.2},
            "motion": {"pulse": {"shape": "half_sine", "a_p": 1.0, "omega_p": 1.0}},
        },
        "over": {"axis": "motion.pulse.omega_p", "along": "a_p", "intensity": "pga", "limits": [0.1, 0.5]},
        "vary": {
            "block.tan_alpha": [0.15, 0.2],
            "motion.pulse.omega_p": [2.0, 3.0, 4.0, 5.0, 6.0],
            "motion.pulse.a_p": {"from": "0.1*g", "to": "2*g", "n": 20},
        },
        "save": {"histories": False},
    } | more


def model_of(**more):
    contents = solve(open_study(study(**more)))
    return contents, fragility_model(contents)


def as_read(function, x):
    """Probabilities of every limit state at intensities, as OpenQuake evaluates a function of its model."""
    imls = function.find(f"{TAG}imls")
    no_damage = float(imls.get("noDamageLimit"))
    found = []
    if function.get("format") == "discrete":
        levels = [no_damage, *map(float, imls.text.split())]
        for poes in function.findall(f"{TAG}poes"):
            p = np.interp(x, levels, [0.0, *map(float, poes.text.split())])
            found.append(np.where(x < no_damage, 0.0, p))
    else:
        inside = np.clip(x, float(imls.get("minIML")), float(imls.get("maxIML")))
        for params in function.findall(f"{TAG}params"):
            mean, deviation = float(params.get("mean")), float(params.get("stddev"))
            sigma = np.sqrt(np.log1p((deviation / mean) ** 2))
            p = stats.lognorm.cdf(inside, sigma, scale=mean**2 / np.sqrt(deviation**2 + mean**2))
            found.append(np.where(x < no_damage, 0.0, p))
    return np.array(found)


def check_rules(text):
    """What NRML 0.5 and its reader ask of a fragility model; its functions by id."""
    root = ElementTree.fromstring(text.encode())
    assert root.tag == f"{TAG}nrml"
    (model,) = root
    assert model.tag == f"{TAG}fragilityModel"
    assert set(model.attrib) == {"id", "assetCategory", "lossCategory"}
    assert re.fullmatch(r"[\w\-:]+", model.get("id"))
    assert model.get("lossCategory") in ("structural", "nonstructural", "contents", "business_interruption")
    description, states, *functions = model
    assert description.tag == f"{TAG}description"
    assert description.text.strip()
    assert states.tag == f"{TAG}limitStates"
    names = states.text.split()
    assert all(re.fullmatch(r"[A-Za-z_]\w*", name) for name in names)
    assert len(set(names)) == len(names)
    assert len({f.get("id") for f in functions}) == len(functions) > 0
    for function in functions:
        assert function.tag == f"{TAG}fragilityFunction"
        imls, *rows = function
        assert imls.tag == f"{TAG}imls"
        assert re.fullmatch(r"PGA|PGV|IA|SA\(\d+(\.\d+)?\)", imls.get("imt"))
        no_damage = float(imls.get("noDamageLimit"))
        assert no_damage > 0.0
        assert [row.get("ls") for row in rows] == names
        if function.get("format") == "discrete":
            assert "shape" not in function.attrib
            levels = np.array(imls.text.split(), dtype=float)
            assert no_damage < levels[0]
            assert (np.diff(levels) > 0.0).all()
            poes = np.array([row.text.split() for row in rows], dtype=float)
            assert poes.shape == (len(names), len(levels))
            assert ((poes >= 0.0) & (poes <= 1.0)).all()
            assert (np.diff(poes, axis=1) >= 0.0).all()
            assert (np.diff(poes, axis=0) <= 0.0).all()
        else:
            assert function.get("shape") == "logncdf"
            assert 0.0 < float(imls.get("minIML")) < float(imls.get("maxIML"))
            assert all(float(row.get(key)) > 0.0 for row in rows for key in ("mean", "stddev"))
    return {function.get("id"): function for function in functions}


@pytest.mark.parametrize("begins", ["uplift", 0])
def test_the_model_is_the_curves_of_the_dataset(begins):
    more = {"axis": "motion.pulse.omega_p", "along": "a_p", "intensity": "pga", "limits": [0.1, 0.5], "beta_added": 0.2}
    contents, model = model_of(over=more | {"begins_at": begins})
    functions = check_rules(model.text)
    assert list(functions) == ["tan_alpha=0.15", "tan_alpha=0.2"]
    x = np.geomspace(0.05, 4.0, 500)
    for i, function in enumerate(functions.values()):
        begin = float(contents.values("fragility_begins_at")[i]) / G
        assert begin == pytest.approx(((0.15, 0.2)[i]) if begins else 0.0)
        if begins:
            assert float(function.find(f"{TAG}imls").get("noDamageLimit")) == pytest.approx(begin, rel=1e-7)
        for j, p in enumerate(as_read(function, x)):
            median, beta = (float(contents.values(f"fragility_{name}")[i, j]) for name in ("median", "beta_total"))
            expected = stats.lognorm.cdf(x, beta, loc=begin, scale=median / G - begin)
            np.testing.assert_allclose(p, expected, atol=2e-3 if begins else 2e-4)


@pytest.mark.parametrize(("intensity", "kind", "unit"), [("pgv", "PGV", 0.01), ("sa(0.5)", "SA(0.5)", G)])
def test_intensities_are_in_openquakes_units(intensity, kind, unit):
    contents, model = model_of(
        over={"axis": "motion.pulse.omega_p", "along": "a_p", "intensity": intensity, "limits": [], "begins_at": 0}
    )
    function = next(iter(check_rules(model.text).values()))
    assert function.find(f"{TAG}imls").get("imt") == kind
    median = float(contents.values("fragility_median")[0, 0]) / unit
    assert as_read(function, np.array([median]))[0, 0] == pytest.approx(0.5, abs=1e-6)


def test_what_openquake_cannot_take_is_refused():
    axis = {"axis": "motion.pulse.omega_p", "along": "a_p"}
    with pytest.raises(StudyError, match="told against pgv_over_pga"):
        model_of(over=axis | {"intensity": "pgv_over_pga"})
    with pytest.raises(StudyError, match="no fragility curves"):
        model_of(over=None)
    with pytest.raises(StudyError, match="no body has a curve"):
        model_of(over=axis | {"intensity": "pga", "limits": [5000]}, vary={
            "motion.pulse.omega_p": [2.0, 3.0], "motion.pulse.a_p": [0.1, 0.2, 0.3],
        })  # fmt: skip


def test_a_limit_state_that_no_case_exceeds_is_left_out():
    """A cabinet that slides never overturns, and has curves of its slide all the same."""
    case = study()["case"] | {"block": {"height": 2.0, "width": 1.0, "mu": 0.15}}
    limits = {"axis": "motion.pulse.omega_p", "along": "a_p", "intensity": "pga", "limits": [{"slide_peak": 0.5}]}
    vary = {name: values for name, values in study()["vary"].items() if name != "block.tan_alpha"}
    contents, model = model_of(case=case, over=limits, vary=vary)
    (function,) = check_rules(model.text).values()
    assert [row.get("ls") for row in list(function)[1:]] == ["slide_peak_0p5"]
    assert model.left_out == ("the limit state overturned, which no case exceeds",)
    median = float(contents.values("fragility_median")[0]) / G
    assert as_read(function, np.array([median]))[0, 0] == pytest.approx(0.5, abs=2e-3)


def test_the_command_writes_a_file(rock, tmp_path, capsys):
    (tmp_path / "tabled.yaml").write_text(SUITE.replace("limits", "intensity: pga, limits"), encoding="utf-8")
    assert rock("run", "tabled.yaml", "--quiet") == 0
    assert rock("export", "results/tabled/tabled.nc", "--to", "openquake") == 0
    said = capsys.readouterr().out.split()
    assert said[-1] == "results/tabled/openquake/fragility_model.xml"
    check_rules((tmp_path / said[-1]).read_text(encoding="utf-8"))
    assert rock("export", "tabled.yaml", "--to", "openquake") == 2
    assert rock("export", "results/tabled/tabled.nc", "--to", "openquake", "--case", 1) == 2
    assert rock("export", "tabled.yaml", "--to", "sap") == 2


def test_bodies_have_the_names_of_their_labels():
    vary = study()["vary"] | {"block": {"slim one": {"tan_alpha": 0.15}, "stout": {"tan_alpha": 0.2}}}
    del vary["block.tan_alpha"]
    assert model_of(vary=vary)[1].bodies == ("slim_one", "stout")


def test_every_body_has_a_name_of_its_own():
    vary = study()["vary"] | {"block.tan_alpha": [0.15, 0.15000001]}
    assert model_of(vary=vary)[1].bodies == ("tan_alpha=0.15", "tan_alpha=0.15000001")
    del vary["block.tan_alpha"]
    alike = {"slim one": {"tan_alpha": 0.15}, "slim_one": {"tan_alpha": 0.2}}
    with pytest.raises(StudyError, match="all be called slim_one in OpenQuake: 'slim one' and 'slim_one'"):
        model_of(vary={"block": alike} | vary)


@pytest.mark.parametrize(("intensity", "warned"), [("pga", True), ("ground_pga", False), ("sa(0.5)", True)])
def test_intensities_of_what_arrives_through_floors_are_told(intensity, warned):
    floored = study()["case"] | {
        "motion": {"record": {"file": "synthetic_rock_m65.AT2", "pga": 1.0}, "through": [{"f": 2, "zeta": 0.03}]}
    }
    records = ["synthetic_rock_m65.AT2", "synthetic_pulse_m70.AT2", "synthetic_soil_m70.AT2"]
    _, model = model_of(
        case=floored,
        over={"axis": "record", "along": "pga", "intensity": intensity, "limits": []},
        vary={"motion.record.file": records, "motion.record.pga": {"from": "0.02*g", "to": "0.6*g", "n": 12}},
    )
    assert bool(model.warnings) is warned
    assert all(f"that is ground_{intensity}" in warning for warning in model.warnings)
