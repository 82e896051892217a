"""Words and symbols for axes, curves and panels."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any

import numpy as np

from rockcli.plotting.common.case_settings import DATASET, every_case, may_vary, resolved_case, resolved_cases
from rockcli.scene.axis_path import axis_path
from rockcli.scene.constants import STANDARD_G
from rockcli.scene.response import SLIDING
from rockcli.scene.units import Units, g_of, unit_words, written
from rockcli.scene.variables import VARIABLES

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

_SYMBOLS: dict[str, str] = {
    "tan_alpha": r"$\tan\alpha$",
    "slenderness": r"$h/b$",
    "h": r"$h$",
    "b": r"$b$",
    "height": r"$2h$",
    "width": r"$2b$",
    "mu": r"$\mu$",
    "inertia": r"$I_O/mR^2$",
    "a_p_over_g_tan_alpha": r"$a_p/(g\,\tan\alpha)$",
    "omega_p_over_p": r"$\omega_p/p$",
    "T_p": r"$T_p$",
    "f_p": r"$f_p$",
    "t0": r"$t_0$",
    "pga_over_g_tan_alpha": r"PGA$/(g\,\tan\alpha)$",
    "initial.theta": r"$\theta_0$",
    "initial.theta_dot": r"$\dot\theta_0$",
    "sa": r"$S_a$",
    "r_energy": r"$r$",
    "g": r"$g$",
    "gamma": r"$\gamma$",
    "nu": r"$\nu$",
    "zeta": r"$\zeta$",
    "rho": r"$\rho$",
}

_PERIOD = re.compile(r"([0-9.]+)(?:\*s)?")
"""A number of seconds, as studies write it."""

_POWERS = r"(-?\d+(?:\.\d+)?)e\+?(-?\d+)"

_ENDING = re.compile(r"\.(at2|csv|txt|dat|acc|smc|v1a?|v2a?|mseed|asc|th)$", re.I)
"""Of files of records."""


def unit_in_brackets(unit: str) -> str:
    """` [m/s²]`, or nothing where there is no dimension."""
    shown = written(unit)
    return f" [{shown}]" if shown else ""


def variable_label(name: str) -> str:
    """Symbol and unit of a variable of the dataset."""
    row = VARIABLES[name]
    return row.symbol + unit_in_brackets(row.unit)


def path_of(dataset: xarray.Dataset, name: str) -> str:
    """Path inside the case of an axis of the study."""
    return axis_path(dataset[name].attrs, name)


def axis_symbol(dataset: xarray.Dataset, axis: str) -> str:
    """Symbol of an axis of the study, or its name where it has none."""
    path = path_of(dataset, axis)
    if path == "motion.record.sa" and (T := _PERIOD.fullmatch(_period_of_sa(dataset))):
        return f"$S_a$({T[1]} s, 5 %)"
    names = (".".join(path.split(".")[-2:]), path.split(".")[-1], axis)
    symbol = next(filter(None, map(symbol_of, names)), "")
    if symbol and path.startswith("motion.vertical."):
        return f"vertical {symbol}"
    return symbol or axis.replace("_", " ")


def _period_of_sa(dataset: xarray.Dataset) -> str:
    """The period of `sa` in the base case; "" where an axis, a table or a setting gives another."""
    if may_vary(dataset, "motion.record.sa_period"):
        return ""
    record = (resolved_case(dataset).get("motion") or {}).get("record") or {}
    return str(record.get("sa_period", ""))


def symbol_of(name: str) -> str:
    """Symbol of a key or a variable; "" where it has none."""
    if name in _SYMBOLS:
        return _SYMBOLS[name]
    return VARIABLES[name].symbol if name in VARIABLES and VARIABLES[name].symbol != name else ""


def axis_label(dataset: xarray.Dataset, axis: str) -> str:
    """Symbol and unit of an axis of the study, and that a peak is the ground's where floors stand between."""
    return axis_symbol(dataset, axis) + whose(dataset, axis) + unit_in_brackets(shown_unit(dataset, axis)[1])


def searched_symbol(dataset: xarray.Dataset, name: str) -> str:
    """Symbol of what a search goes along (`find: overturning`), which has no axis but a name as `motion_record_pga`."""
    key = name.rsplit("motion_record_", 1)[-1].rsplit("motion_pulse_", 1)[-1]
    return (symbol_of(key) or key.replace("_", " ")) + whose(dataset, name)


def whose(dataset: xarray.Dataset, axis: str) -> str:
    """Of a peak of the ground, varied or searched along: that it is the ground's below floors; ""."""
    path = path_of(dataset, axis) if axis in dataset.variables else axis.replace("motion_record_", "motion.record.")
    below = path in ("motion.record.pga", "motion.record.pgv", "motion.record.sa") and has_floors(dataset)
    return " of the ground" if below else ""


def has_floors(dataset: xarray.Dataset) -> bool:
    """Whether the base case, an axis or a setting has something stand between the ground and the body."""
    motions = [case.get("motion") or {} for case in resolved_cases(dataset)]
    axes = str(dataset.attrs.get("axes", "")).split()
    if any(motion.get("through") for motion in motions) or any(
        path_of(dataset, axis) == "motion.through" for axis in axes
    ):
        return True
    processing = json.loads(dataset.attrs.get("processing", "{}"))
    return any(step.startswith("through ") for steps in processing.values() for step in steps)


def deforms(dataset: xarray.Dataset) -> bool:
    """Whether all bodies are deformable columns, which lift below g tan(alpha) where they are pushed suddenly."""
    return {*np.ravel(_models(dataset)).tolist()} <= {"flexible", "continuum"}


def _models(dataset: xarray.Dataset) -> Any:
    """Names of the models: over their axis, or that of several datasets, or one name."""
    axes = [axis for axis in str(dataset.attrs.get("axes", "")).split() if path_of(dataset, axis) == "model"]
    if axes:
        return dataset[axes[0]].astype(str)
    models = [case.get("model") for case in resolved_cases(dataset)]
    names = [str(model.get("name") if isinstance(model, dict) else model) for model in models]
    if len({*names}) == 1:
        return names[0]
    return dataset[DATASET].copy(data=np.array(names, dtype=object)).astype(str)


def lifts_words(dataset: xarray.Dataset) -> list[str]:
    """What `lifts_from` is, in mathematics: that of rigid bodies, that of linearized blocks, or both."""
    models = {*np.ravel(_models(dataset)).tolist()}
    words = [r"g\,\tan\alpha"] * bool(models - {"linearized"}) + [r"g\,\alpha"] * ("linearized" in models)
    if "uplift_factor" not in dataset.variables:
        return words
    factors = dataset["uplift_factor"].values
    return words * bool((factors == 1.0).any()) + [r"(W/Mg)\,g\,\tan\alpha"] * bool(
        (np.nan_to_num(factors, nan=1.0) != 1.0).any()
    )


def lifts_word(dataset: xarray.Dataset) -> str:
    """The same in one line, for between dollars."""
    return "$ or $".join(lifts_words(dataset))


def uplift_label(dataset: xarray.Dataset) -> str:
    """What a line of uplift is, for legends."""
    which = " about either edge" if two_edged(dataset) else f", ${lifts_word(dataset)}$"
    return f"uplift{lifts_without(dataset)}{which}"


def lifts_without(dataset: xarray.Dataset) -> str:
    """` without vertical motion and slip`: what changes where a body lifts and is not in `lifts_from`; or nothing."""
    slides = "outcome" in dataset.variables and bool((dataset["outcome"].values == SLIDING).any())
    left = ["vertical motion"] * _has_vertical(dataset) + ["slip"] * slides
    return f" without {' and '.join(left)}" if left else ""


def _has_vertical(dataset: xarray.Dataset) -> bool:
    """Whether the base case, an axis or a setting, may have vertical motion."""
    motions = [case.get("motion") or {} for case in resolved_cases(dataset)]
    return any(motion.get("vertical") for motion in motions) or may_vary(dataset, "motion.vertical")


def unit_g(dataset: xarray.Dataset) -> float:
    """Unit of acceleration in plots [m/s²]: the g of the study's case; 9.81 where it is not told or is varied.

    Panels of several datasets have one unit, 9.81 where these differ.
    """
    varied = {path_of(dataset, str(name)) for name in dataset.coords}
    found = {g_of(case, varied) for case in every_case(dataset)}
    return found.pop() if len(found) == 1 else STANDARD_G


def lifts_from(dataset: xarray.Dataset, of: str = "alpha") -> xarray.DataArray:
    """g tan(alpha) of the weaker edge, of linearized blocks g alpha, from which rigid bodies lift [m/s²].

    Of FEMA-356 times its weight; over the axes that change it.  NaN where it is not known, as where FEMA-356 asks a
    spectrum and where datasets of earlier versions have settings that may choose g.  `of`: the alpha of another edge.
    """
    g, alpha, models = _gravity(dataset), dataset[of], _models(dataset)
    if "uplift_factor" in dataset.variables:
        factor = dataset["uplift_factor"]
        g = g * (factor if factor.ndim else float(factor))
    tangent = alpha.copy(data=np.tan(alpha.values))
    if isinstance(models, str) and isinstance(g, float):
        return alpha.copy(data=(alpha if models == "linearized" else tangent).values * g)
    level: xarray.DataArray = (tangent + (models == "linearized") * (alpha - tangent)) * g
    return level


def two_edged(dataset: xarray.Dataset) -> bool:
    """Whether bodies have two different edges, so that from where they lift depends on the side they are pushed to."""
    if "alpha_left" not in dataset.variables:
        return False
    left, right = (dataset[f"alpha_{side}"].values for side in ("left", "right"))
    return bool((np.abs(left - right) > 1e-9 * np.abs(left)).any())


def _gravity(dataset: xarray.Dataset) -> Any:
    """g of the cases [m/s²], over the axes that change it.

    Of datasets of earlier versions over an axis or a table of it, over several datasets, or one number.
    """
    if "g" in dataset.variables:
        g = dataset["g"]
        return g if g.ndim else float(g)
    varied = next((str(name) for name in dataset.coords if path_of(dataset, str(name)) == "g"), "")
    if varied:
        return dataset[varied]
    if may_vary(dataset, "g"):
        return np.nan
    own = [g_of(case, ()) for case in resolved_cases(dataset)]
    return own[0] if len({*own}) == 1 else dataset[DATASET].copy(data=np.array(own))


def units_of(dataset: xarray.Dataset) -> Units:
    """How the numbers of a dataset are shown: accelerations in g of its case."""
    return Units(unit_g(dataset))


def shown_unit(dataset: xarray.Dataset, name: str) -> tuple[float, str]:
    """What the values of an axis or variable are divided by to be shown, and the unit they have then."""
    attrs = dataset[name].attrs
    return units_of(dataset).of(str(attrs.get("units", "1")), path_of(dataset, name))


def axis_values(dataset: xarray.Dataset, axis: str) -> NDArray[np.float64]:
    """Coordinates of a numeric axis in the unit of its label."""
    return np.asarray(dataset[axis].values, dtype=float) / shown_unit(dataset, axis)[0]


def coordinate_label(dataset: xarray.Dataset, axis: str, position: int) -> str:
    """`$R$ = 5 m` for a numeric axis; the label itself, or `model 3` for a bare number, for a labelled one."""
    value: Any = dataset[axis].values[position]
    if isinstance(value, (str, np.str_)):
        label = _label(str(value))
        return f"{axis.replace('_', ' ')} {label}" if label.replace(".", "").isdigit() else label
    values = axis_values(dataset, axis)
    number = number_words(float(values[position]), _digits(values, position))
    return f"{axis_symbol(dataset, axis)} = {number}{unit_words(shown_unit(dataset, axis)[1])}"


def _digits(values: NDArray[np.float64], position: int) -> int:
    """Four, or as many as tell a value from all others of its axis."""
    others = np.delete(values, position)
    close = others[np.abs(others - values[position]) <= 2e-3 * np.abs(values[position])].tolist()
    told = (n for n in range(4, 17) if f"{values[position]:.{n}g}" not in {f"{other:.{n}g}" for other in close})
    return next(told, 17)


def number_words(value: float, digits: int = 4) -> str:
    """At most so many digits; powers of ten as such, where %g would write 1e+09."""
    words = f"{value:.{digits}g}"
    return _power(re.match(_POWERS, words)) if "e" in words else words


def _power(found: re.Match[str] | None) -> str:
    assert found is not None
    factor = "" if found[1] == "1" else rf"{found[1]}\times"
    return rf"${factor}10^{{{int(found[2])}}}$"


def _label(words: str) -> str:
    """A label that a study gives to a point, for people: a record without the ending of its file."""
    words = _ENDING.sub("", words)
    words = escape(words if "." in words else words.replace("_", " "))  # names of files stay as they are
    words = re.sub(rf"(?<![\w.]){_POWERS}(?![\w.])", _power, words)
    return re.sub(r"\bfema ?356\b", "FEMA-356", words)


def coordinate_words(dataset: xarray.Dataset, axis: str) -> list[str]:
    """The coordinates of an axis as plain words, with their unit."""
    item, units = dataset[axis], units_of(dataset)
    if item.dtype.kind != "f":
        return [str(value) for value in item.values]
    unit, path = str(item.attrs.get("units", "1")), path_of(dataset, axis)
    return [units.coordinate(float(value), unit, path) for value in item.values]


def escape(words: str) -> str:
    """Words in which a dollar sign means a dollar."""
    return words.replace("$", r"\$")


def title_of(dataset: xarray.Dataset) -> str:
    """The study's title."""
    return escape(str(dataset.attrs.get("title", "")))
