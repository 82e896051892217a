"""The map of bodies that slide while they rock."""

from __future__ import annotations

import rockcli
from rockcli.plotting.kinds import map as kind


def labels(slides: bool) -> set[str]:
    lowest = 0.21 if slides else 2.0
    dataset = rockcli.run(
        {
            "name": "regimes",
            "case": {
                "block": {"h": 1.0, "tan_alpha": 0.2, "mu": 0.3},
                "motion": {"pulse": {"shape": "sine", "a_p": "0.4*g", "T_p": 0.3}},
            },
            "vary": {
                "block.tan_alpha": {"from": 0.18, "to": 0.2, "n": 5},
                "block.mu": {"from": lowest, "to": lowest + 0.1, "n": 5},
            },
            "save": {"histories": False},
        }
    )
    assert bool((dataset.slide_peak > 0.0).any()) == slides
    figure = kind.draw(dataset)
    return {text.get_text() for legend in figure.legends for text in legend.get_texts()}


def test_what_slides_besides_is_hatched():
    assert "also slides" in labels(True)
    assert "also slides" not in labels(False)
