"""The validated case is kept and read: what the schema has as default is what is built."""

import pytest
from pydantic import ValidationError

from rockcli.study.open import open_study
from rockcli.study.schema import CasePart

STUDY = {
    "name": "x",
    "case": {
        "block": {"R": 2.0, "tan_alpha": 0.2},
        "motion": {"pulse": {"shape": "sine", "a_p": 4, "omega_p": 6}},
        "column": {"E": "30*GPa", "rho": 2500},
        "solver": {"rtol": 1e-9},
    },
    "vary": {"block.R": [1, 2]},
}


def checked():
    return open_study(STUDY).cases.checked(())


def test_the_case_that_is_built_from_is_frozen_with_all_its_parts():
    _, case = checked()
    for part, key in (
        (case, "g"),
        (case.block, "R"),
        (case.column, "mass"),
        (case.motion.pulse, "a_p"),
        (case.solver, "rtol"),
    ):
        with pytest.raises(ValidationError, match="frozen"):
            setattr(part, key, 1)


def test_it_is_validated_once_for_all_numbers_of_an_axis():
    study = open_study(STUDY)
    assert study.cases.checked(())[1] is study.cases.checked(())[1]
    assert [batch.block.R[:, 0].tolist() for _, batch in study.batches()] == [[1.0, 2.0]]


@pytest.mark.parametrize(
    ("path", "value", "built"),
    [
        (("g",), 3.71, lambda batch: batch.g[0]),
        (("initial", "theta"), 0.05, lambda batch: batch.theta_0[0]),
        (("solver", "accuracy"), "draft", lambda batch: batch.numerics.accuracy),
        (("solver", "backend"), "scipy", lambda batch: batch.numerics.backend),
        (("model", "name"), "linearized", lambda batch: batch.model),
        (("damping", "scheme"), "none", lambda batch: batch.damping.scheme),
    ],
)
def test_another_default_of_the_schema_is_built(monkeypatch, path, value, built):
    """The default is changed on its way out of the schema; nothing else has one of its own."""
    validate = CasePart.model_validate

    def changed(tree, **how):
        case = validate(tree, **how)
        part = case
        for key in path[:-1]:
            part = getattr(part, key)
        part = part.model_copy(update={path[-1]: value})
        return case.model_copy(update={path[0]: part}) if len(path) > 1 else part

    monkeypatch.setattr(CasePart, "model_validate", changed)
    ((_, batch),) = open_study(STUDY).batches()
    assert built(batch) == value
