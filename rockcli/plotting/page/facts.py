"""The result of a dataset in a few numbers with their units, for a reader who has never heard of rocking."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rockcli.plotting.common.case_law import model_of
from rockcli.plotting.common.cases import Array, axes_of, is_numeric, number_at
from rockcli.plotting.common.labels import (
    axis_values,
    coordinate_words,
    deforms,
    has_floors,
    lifts_from,
    lifts_without,
    lifts_words,
    path_of,
    shown_unit,
    two_edged,
    unit_g,
    whose,
)
from rockcli.plotting.common.shape import body_of
from rockcli.plotting.common.suite import medians_beyond
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.body.lower_outline import facets_of
from rockcli.scene.ground.amplitudes import AMPLITUDES
from rockcli.scene.response import OUTCOMES, overturned
from rockcli.scene.thresholds import BELOW, FOUND, IN_RANGE, NONE, Thresholds
from rockcli.scene.variables import HAZARD, LIMIT, PEAK

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray


_FEW_SHARES = 12
"""Points up to which probabilities are told one by one."""


@dataclass(frozen=True)
class Fact:
    """A number with its unit, what it is, and a sentence about it."""

    value: str
    what: str
    sentence: str = ""


def facts_of(dataset: xarray.Dataset) -> list[Fact]:
    """Peak, top, margin, slide, uplift, overturning, probability, rate; what the dataset does not tell is absent."""
    return [
        *_peak(dataset),
        *_slide(dataset),
        *_uplift(dataset),
        *_overturning(dataset),
        *_probability(dataset),
        *_rate(dataset),
    ]


def sentence_of(dataset: xarray.Dataset) -> str:
    """What became of the body, in a sentence; "" where there are no outcomes."""
    if "outcome" not in dataset.variables:
        return ""
    flags = np.ravel(dataset["outcome"].values)
    names = [OUTCOMES[int(flag)] for flag in flags[np.isfinite(flags)]]  # what `dataset.where` masks is no case
    fallen = int(overturned(flags).sum())
    rocks, slides, still = (names.count(name) for name in ("rocking", "sliding", "no_uplift"))
    unknown = len(names) - fallen - rocks - slides - still
    if len(names) == 1:
        return {
            "no_uplift": "The body stays at rest: the motion does not lift it.",
            "rocking": "The body rocks from edge to edge and comes back: it does not overturn.",
            "sliding": "The body slides along the ground without lifting.",
            "failed": "The case has no answer; see the notes.",
        }.get(names[0], "The body overturns." if fallen else "The outcome cannot be told: see the notes.")
    parts = (
        (fallen, "overturns", "overturn"),
        (rocks, "rocks and comes back", "rock and come back"),
        (slides, "slides", "slide"),
        (still, "stays at rest", "stay at rest"),
        (unknown, "has no certain answer", "have no certain answer"),
    )
    words = [f"{n} {one if n == 1 else many}" for n, one, many in parts if n]
    return (
        f"Of {len(names)} cases "
        + (" and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else words[0])
        + "."
    )


def _peak(dataset: xarray.Dataset) -> list[Fact]:
    """The rotation that comes nearest to alpha of a case that comes back, what the top moves then, and what is left."""
    if PEAK not in dataset.variables:
        return []
    axes = axes_of(dataset)
    peaks = np.asarray(dataset[PEAK].transpose(*axes).values, dtype=float)
    if not np.isfinite(peaks).any() or np.nanmax(np.where(np.isfinite(peaks), peaks, -1.0)) <= 0.0:
        return []
    at = tuple(int(i) for i in np.unravel_index(int(np.argmax(np.where(np.isfinite(peaks), peaks, -1.0))), peaks.shape))
    ratio = float(peaks[at])
    where = _where(dataset, at)
    several = peaks.size > 1
    theta = abs(number_at(dataset, "theta_peak", at))
    theta = theta if np.isfinite(theta) else ratio * _alpha(dataset, at)
    alpha = _falls_beyond(dataset, at)
    if np.isnan(alpha) and "theta_peak_left" in dataset.variables:  # the largest may be to the other side
        theta = min(theta, ratio * _alpha_of_peak(dataset, at))
    found = []
    if np.isfinite(theta):
        what, words = "largest rotation", "the largest of the cases that come back"
        if theta < (1.0 - 1e-9) * _largest(dataset, "theta_peak"):  # of a body with another alpha
            what, words = "rotation nearest to alpha", "of the cases that come back, the nearest to its alpha"
        words = words + (f", at {where}" if where else "") if several else ""
        found.append(Fact(f"{np.degrees(theta):.3g}\N{DEGREE SIGN}", what, words))
    top = number_at(dataset, "u_top_peak", at)
    said = "sideways at most"
    if np.isnan(top) and np.isfinite(theta) and "alpha" in dataset.variables and "outline_x" not in dataset.variables:
        top = 2.0 * number_at(dataset, "R", at) * np.cos(number_at(dataset, "alpha", at)) * np.sin(theta)
        said = "sideways at most, of a rigid rectangle"
    if np.isfinite(top):
        found.append(Fact(_length(top), "the top moves", said + (", in that case" if several else "")))
    if np.isnan(alpha):
        alpha, weak = _equilibrium(dataset, at), _alpha_of_peak(dataset, at)
        if np.isinf(alpha):  # models 2 and 3 of bodies wider than high
            return found
        ratio = ratio * weak / alpha if alpha != weak and np.isfinite(alpha) else ratio
    else:  # of one that rolls it is no alpha
        ratio = theta / alpha
    said = f"the body reaches {100.0 * ratio:.3g} % of the angle"
    said += f" ({np.degrees(alpha):.3g}\N{DEGREE SIGN})" if np.isfinite(alpha) else ""
    said += " at which its weight" + (", were it rigid," if deforms(dataset) else "") + " no longer brings it back"
    margin = f"{100.0 * (1.0 - ratio):.3g} %" if ratio < 1.0 else "none"
    return [*found, Fact(margin, "margin" if not several else "margin of that case", said)]


def _slide(dataset: xarray.Dataset) -> list[Fact]:
    """How far a body slides along the ground, where one does."""
    if "slide_peak" not in dataset.variables:
        return []
    slides = dataset["slide_peak"].transpose(*axes_of(dataset)).values
    endless = int(np.isinf(slides).sum())
    slides = np.where(np.isfinite(slides), slides, 0.0)
    never = f"in {endless} of {slides.size} cases " * (slides.size > 1) + "no friction stops it"
    if not slides.max(initial=0.0) > 0.0:
        return [Fact("without end", "slides on", never)] if endless else []
    at = tuple(int(i) for i in np.unravel_index(int(np.argmax(slides)), slides.shape))
    said = "along the ground at most"
    if slides.size > 1:
        where = _where(dataset, at)
        said += f", in {int((slides > 0.0).sum())} of {slides.size} cases" + (f"; most at {where}" if where else "")
    said += f"; {never}" if endless else ""
    return [Fact(_length(float(slides[at])), "largest slide", said)]


def _length(metres: float) -> str:
    return f"{metres:.3g} m" if metres >= 1.0 else f"{1e3 * metres:.3g} mm"


def _largest(dataset: xarray.Dataset, name: str) -> float:
    """Largest finite |value| of a variable, 0 where there is none."""
    values = np.abs(dataset[name].values.astype(float)) if name in dataset.variables else np.empty(0)
    return float(np.max(values[np.isfinite(values)], initial=0.0))


def _alpha_of_peak(dataset: xarray.Dataset, at: tuple[int, ...]) -> float:
    """The alpha that theta_peak_over_alpha is over: of a body with two different edges that of the side it is of."""
    sides = ("left", "right")
    peaks, alphas = ([number_at(dataset, f"{of}_{side}", at) for side in sides] for of in ("theta_peak", "alpha"))
    if not np.isfinite([*peaks, *alphas]).all():
        return _alpha(dataset, at)
    return alphas[int(np.argmax(np.divide(peaks, alphas)))]


def _equilibrium(dataset: xarray.Dataset, at: tuple[int, ...]) -> float:
    """The rotation at which the restoring moment of a body on two edges vanishes, to the side of its peak; inf: never.

    It is alpha but for corotational models 2 and 3.
    """
    alpha = _alpha_of_peak(dataset, at)
    model = model_of(dataset.isel(dict(zip(axes_of(dataset), at, strict=True))))
    return alpha if model is None or np.isnan(alpha) else float(model.law(np.array(alpha), np.tan(alpha)).q_star)


def _falls_beyond(dataset: xarray.Dataset, at: tuple[int, ...]) -> float:
    """The rotation beyond which a body that rolls falls to the side of its peak; NaN of those on two edges."""
    if "outline_x" not in dataset.variables or (vertices := body_of(dataset, at).vertices) is None:
        return np.nan
    fall = np.abs(facets_of(vertices[None]).fall[0])
    theta = number_at(dataset, "theta_peak", at)
    return float(fall.min() if np.isnan(theta) else fall[RIGHT if theta > 0.0 else LEFT])


def _alpha(dataset: xarray.Dataset, at: tuple[int, ...]) -> float:
    sides = [number_at(dataset, name, at) for name in ("alpha_left", "alpha_right", "alpha")]
    known = [side for side in sides if np.isfinite(side)]
    return min(known, default=np.nan)


def _where(dataset: xarray.Dataset, at: tuple[int, ...]) -> str:
    axes = axes_of(dataset)
    words = [f"{name_of(dataset, a)} {coordinate_words(dataset, a)[i]}" for a, i in zip(axes, at, strict=True)
             if dataset.sizes[a] > 1]  # fmt: skip
    return ", ".join(words)


def name_of(dataset: xarray.Dataset, axis: str) -> str:
    """An axis in plain words: the last part of its path."""
    last = path_of(dataset, axis).rsplit(".", 1)[-1]
    plain = {"pga": "PGA", "pgv": "PGV", "sa": "Sa", "file": "record"}.get(last, last.replace("_", " "))
    return plain + whose(dataset, axis)


_PLAIN = {
    r"g\,\tan\alpha": "g tan(alpha)",
    r"g\,\alpha": "g alpha",
    r"(W/Mg)\,g\,\tan\alpha": "(W/Mg) g tan(alpha)",
}
"""What bodies lift from, without mathematics."""


def _uplift(dataset: xarray.Dataset) -> list[Fact]:
    """The ground acceleration at which rigid bodies lift about their weaker edge."""
    if "alpha" not in dataset.variables or "outcome" not in dataset.variables or deforms(dataset):
        return []
    levels = lifts_from(dataset).values / unit_g(dataset)
    values: Array = levels[np.isfinite(levels)]
    if not values.size:
        return []
    low, high = float(values.min()), float(values.max())
    one = high - low <= 1e-6 * high
    word = " or ".join(_PLAIN[word] for word in lifts_words(dataset))
    said = "of what arrives at its base" if has_floors(dataset) else "ground acceleration"
    word += " of the weaker edge" if two_edged(dataset) else ""
    value = f"{low:.3g} g" if one else f"{low:.3g} to {high:.3g} g"
    return [Fact(value, "lifts from", f"{said}, {word}{lifts_without(dataset)}")]


def _overturning(dataset: xarray.Dataset) -> list[Fact]:
    """The lowest intensity that overturns: searched for, or the lowest of the study."""
    found = [
        str(name) for name in dataset.data_vars if str(name).endswith(FOUND) and dataset[name].dims == axes_of(dataset)
    ]
    if found:
        return _of_search(dataset, found[0])
    if "outcome" not in dataset.variables:
        return []
    for axis in axes_of(dataset):
        role = path_of(dataset, axis).rsplit(".", 1)[-1]
        if role in AMPLITUDES and is_numeric(dataset, axis):
            flags = dataset["outcome"].transpose(axis, ...).values
            fell = overturned(flags).any(axis=tuple(range(1, flags.ndim)))
            if fell.any():
                unit = shown_unit(dataset, axis)[1]
                lowest = min(axis_values(dataset, axis)[fell].tolist(), key=abs)  # to either side
                return [
                    Fact(
                        _with_unit(f"{lowest:.3g}", unit),
                        "overturns from",
                        f"{_plain(axis)}{whose(dataset, axis)}, the lowest of the study that overturns a case",
                    )
                ]
            return [Fact("nowhere", "overturns", f"within the {_plain(axis)}{whose(dataset, axis)} of the study")]
    return []


def _of_search(dataset: xarray.Dataset, name: str) -> list[Fact]:
    """The lowest thresholds of the cases, of which some may overturn below the range and some nowhere in it."""
    divisor, unit = shown_unit(dataset, name)
    found = Thresholds.read(name, lambda one: dataset[one].values if one in dataset.variables else None)
    axis = searched_words(dataset, name.removesuffix(FOUND))
    known, none, below = (found.state == state for state in (IN_RANGE, NONE, BELOW))

    def cases(which: NDArray[np.bool_]) -> str:
        return f"{int(which.sum())} of {which.size} cases"

    words = f"{axis}, the lowest that overturns"
    if below.any():
        number = f"{found.high[below].min() / divisor:.3g}"
        words = f"{axis}, the lowest searched" + (f": {cases(below)} overturn there already" if below.size > 1 else "")
        value = f"{_with_unit(number, unit)} or less"
    elif known.any():
        low, high = (float(end) / divisor for end in (found.high[known].min(), found.high[known].max()))
        value = _with_unit(f"{low:.3g}" + (f" to {high:.3g}" if known.sum() > 1 else ""), unit)
    elif none.all():
        return [Fact("nowhere", "overturns", f"up to {axis} {_with_unit(f'{found.low.max() / divisor:.3g}', unit)}")]
    else:
        return []
    if none.any():
        words += f"; {cases(none)} overturn nowhere up to {_with_unit(f'{found.low[none].max() / divisor:.3g}', unit)}"
    return [Fact(value, "overturns from", words)]


def searched_words(dataset: xarray.Dataset, name: str) -> str:
    """What a search goes along, in plain words, of a name as `motion_record_pga`."""
    return _plain(name) + whose(dataset, name)


def _with_unit(number: str, unit: str) -> str:
    return number if unit == "1" else f"{number} {unit}"


def _plain(axis: str) -> str:
    words = axis.removeprefix("motion_record_").removeprefix("motion_pulse_")
    known = {
        "pga": "PGA",
        "pgv": "PGV",
        "sa": "Sa",
        "a_p": "peak acceleration of the pulse",
        "scale": "scale of the motion",
    }
    return known.get(words, words.replace("_over_g_tan_alpha", " over g tan(alpha)").replace("_", " "))


def _probability(dataset: xarray.Dataset) -> list[Fact]:
    """Of a suite: the median intensity of overturning, or the share that overturns."""
    if "fragility_median" in dataset.variables and LIMIT in dataset.dims:
        labels = [str(label) for label in dataset[LIMIT].values]
        if "overturned" in labels:
            divisor, unit = shown_unit(dataset, "fragility_median")
            part = dataset.isel({LIMIT: labels.index("overturned")})
            every = np.ravel(part["fragility_median"].values) / divisor
            medians = every[np.isfinite(every)]
            if medians.size:
                span = f"{medians.min():.3g}" + (f" to {medians.max():.3g}" if medians.size > 1 else "")
                said = "intensity at which one half of the suite overturns" + (", by body" if medians.size > 1 else "")
                said += ", at the second intensity of the table" if "fragility_second" in dataset.variables else ""
                said += _extrapolated(part) + _without_curve(every)
                return [Fact(_with_unit(span, unit), "median of overturning", said)]
        return []
    if "p_overturned" in dataset.variables and dataset["p_overturned"].size <= _FEW_SHARES:
        shares = 100.0 * np.ravel(dataset["p_overturned"].values)
        shares = shares[np.isfinite(shares)]
        if shares.size:
            span = f"{shares.min():.3g}" + (f" to {shares.max():.3g}" if np.ptp(shares) > 0.0 else "")
            return [Fact(f"{span} %", "probability of overturning", "share of the suite that overturns")]
    return []


def _extrapolated(of_falls: xarray.Dataset) -> str:
    """How many medians lie beyond the intensities of the suite; "" where none does."""
    beyond, every = int(medians_beyond(of_falls).sum()), of_falls["fragility_median"].size
    some = f"{beyond} of {every} lie " if every > 1 else ""
    return f"; {some}beyond the intensities of the suite, extrapolated" if beyond else ""


def _without_curve(of_bodies: Array) -> str:
    """How many bodies are left out of a number, as they have no fragility curve; "" where none is."""
    missing = int(np.isnan(of_bodies).sum())
    return f"; {missing} of {of_bodies.size} bodies have no curve and are not in it" if missing else ""


def _rate(dataset: xarray.Dataset) -> list[Fact]:
    """How often a year the hazard overturns, and with which probability within the age."""
    if "annual_rate" not in dataset.variables:
        return []
    of_falls = dataset.isel({LIMIT: -1})
    rates, least, most = _span(of_falls["annual_rate"].values)
    if not rates:
        return []
    curves = [str(label) for label in dataset[HAZARD].values]
    under = f"under the hazard {' and '.join(curves)}" + (", by body" if of_falls["annual_rate"].ndim > 1 else "")
    often = f"once in {float(f'{1.0 / most:.2g}'):g} years" if most > 0.0 else "by no motion of it"
    once = often + (" or less often" if least < most else "") + _beyond_the_curve(of_falls)
    within = ""
    age = json.loads(dataset.attrs.get("ensemble", "{}")).get("age")
    if age:
        chances = of_falls["probability_in_age"].values
        ends = dict.fromkeys(_percent(end) for end in (np.nanmin(chances), np.nanmax(chances)))
        within = f"; within {age:g} years with a probability of {' to '.join(ends)} %"
    left_out = _without_curve(of_falls["annual_rate"].values[..., 0])
    return [Fact(f"{rates} a year", "rate of overturning", f"{under}: {once}{within}{left_out}")]


def _percent(probability: float) -> str:
    """Two digits of a probability in %, and as many as tell it from 100."""
    if probability > 0.9999:
        return "more than 99.99"
    return f"{100.0 * probability:.2g}" if probability < 0.99 else f"{100.0 * probability:.4g}"


def _beyond_the_curve(of_falls: xarray.Dataset) -> str:
    """What motions beyond the last point of a hazard curve may add, where that is more than a rate itself."""
    rate, more = (np.ravel(of_falls[name].values) for name in ("annual_rate", "annual_rate_above"))
    larger = more > rate
    return f"; motions beyond its last point may add up to {more[larger].max():.2g}" if larger.any() else ""


def _span(values: Array) -> tuple[str, float, float]:
    """The least to the most of values in words, and both; "" where none is known."""
    known = values[np.isfinite(values)]
    if not known.size:
        return "", np.nan, np.nan
    low, high = float(known.min()), float(known.max())
    return f"{low:.2g}" + (f" to {high:.2g}" if f"{high:.2g}" != f"{low:.2g}" else ""), low, high
