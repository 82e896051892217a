"""Units in which numbers are shown: accelerations in g of the case, all else in SI units.

Datasets and what programs read (`--json`) are in SI units throughout.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from rockcli.scene.constants import STANDARD_G

ACCELERATION = "m s-2"

_WRITTEN = {
    "1": "",
    "s-1": "Hz",
    "rad s-1": "rad/s",
    "m s-1": "m/s",
    "m s-2": "m/s²",
    "m2 s-2": "m²/s²",
    "kg m-3": "kg/m³",
    "N m-3": "N/m³",
    "year-1": "1/year",
}
"""Units of datasets that people write otherwise."""


def g_of(case: Mapping[str, Any], varied: Iterable[str]) -> float:
    """The unit of acceleration of a study [m/s²]: g of its case; 9.81 where it is not told or is varied.

    Args:
        case: the resolved case, as datasets carry it; varied: paths of the study's axes.
    """
    try:
        return STANDARD_G if "g" in varied else float(case.get("g", STANDARD_G))
    except ValueError:  # an expression
        return STANDARD_G


@dataclass(frozen=True)
class Units:
    """In which units numbers are shown: `g` [m/s²] is that of accelerations, None shows SI units."""

    g: float | None = None

    def of(self, unit: str, path: str = "") -> tuple[float, str]:
        """What a number in a unit of the dataset is divided by, and the unit it has then; g itself stays in m/s²."""
        in_g = self.g is not None and unit == ACCELERATION and path.rsplit(".", 1)[-1] != "g"
        return (float(self.g or 1.0), "g") if in_g else (1.0, unit)

    def word(self, value: float, unit: str, path: str = "", digits: int = 6) -> str:
        """A number, with its unit where that is g."""
        divisor, shown = self.of(unit, path)
        return f"{value / divisor:.{digits}g}" + (" g" if shown == "g" else "")

    def coordinate(self, value: float, unit: str, path: str = "") -> str:
        """A coordinate of an axis: with its unit for people, and none in SI units, as programs read it."""
        divisor, shown = self.of(unit, path)
        return f"{value / divisor:.6g}" + ("" if self.g is None else unit_words(shown))


SI = Units()


def written(unit: str) -> str:
    """A unit of a dataset as people write it."""
    return _WRITTEN.get(unit, unit)


def unit_words(unit: str) -> str:
    """A unit after a number, for people; "" where there is no dimension."""
    return f" {written(unit)}".rstrip()
