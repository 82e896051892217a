"""What axes of plots are called: the words of the schema for the path of an axis."""

from __future__ import annotations

import pytest

from rockcli.study.document.paths import ARRAYS, words_of
from rockcli.study.document.paths import _all_paths as all_paths


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("motion.pulse.a_p", "peak acceleration of the pulse"),
        ("motion.record.pga", "peak acceleration of the record"),
        ("motion.vertical.pulse.a_p", "peak acceleration of the pulse, vertical motion"),
        ("motion.record.file", "file name of the record"),
        ("block.tan_alpha", "tangent of the slenderness angle"),
        ("case.block.R", "distance from the edge to the centre of mass"),
        ("damping.eta", "restitution: angular velocity after / before an impact"),
        ("model", "model of the body"),
        ("g", "acceleration of gravity"),
        ("let.stiff_base", "stiff base"),
        ("sample", "sample"),
        ("case", "case"),
    ],
)
def test_a_path_in_words(path, words):
    assert words_of(path) == words


def test_every_key_has_words_without_units_or_defaults():
    for path in all_paths():
        words = words_of(path)
        assert words == words.strip() != "", path
        assert not set("[]{};`") & set(words), (path, words)
        assert "default" not in words, (path, words)


def test_two_numbers_that_are_varied_are_not_called_the_same():
    said = [words_of(".".join(path)) for path in ARRAYS]
    assert len(said) == len(set(said)) > 40
