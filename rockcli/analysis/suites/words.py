"""Suite statistics in words: for the run's report, and as warnings."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.fragility.curves import FITTED, NONE_EXCEEDS, WHY_NOT
from rockcli.analysis.fragility.misfit import LEVEL
from rockcli.analysis.places import coordinates, place, units_of
from rockcli.analysis.suites.intensity_correlation import LEAST
from rockcli.analysis.suites.risk import central, largest_tail
from rockcli.analysis.threshold_fields import found_by
from rockcli.scene.counted import counted
from rockcli.scene.ground.hazard import CONSISTENT, hazard_words
from rockcli.scene.limit_states import OVERTURNED, exceeded_when, in_full
from rockcli.scene.response import SLIDING
from rockcli.scene.thresholds import FOUND, threshold_words
from rockcli.scene.units import Units, unit_words
from rockcli.scene.variables import HAZARD, INPUT, LIMIT, MEASURE, PEAK, PERCENTILE, PERCENTILES
from rockcli.storage.contents import Contents
from rockcli.study.building.batch import SLIDES_FIRST
from rockcli.study.building.floors import ARRIVES
from rockcli.study.cases.uncertain import sentence
from rockcli.study.intensity import GROUND, period_of
from rockcli.study.study import MATCH, SAMPLE, Over, Study

MOST_BODIES = 6
"""Bodies of which the fragility is told in sentences; tables have all."""


OF_THE_BODY = ("block", "damping", "column", "base", "model", "let")
"""Where inputs are of the body, which the next motion finds as it was."""

DIRECTION = "block.direction"
"""Of a scan: whence the motion comes, another in every earthquake."""


def sentences(contents: Contents, study: Study, units: Units) -> list[str]:
    """What the statistics come to: capacity by limit state, and the measures that tell the demand best."""
    assert study.over is not None
    if study.search is not None:
        return [
            *_of_thresholds(contents, study, study.over, units),
            *_of_fragility(contents, study.over, units),
            *_of_any_sample(contents, study, units),
            *_of_risk(contents, study.over, units),
        ]
    said = [
        *_shares(contents, study, study.over, units),
        *_of_fragility(contents, study.over, units),
        *_of_any_sample(contents, study, units),
        *_of_risk(contents, study.over, units),
        *_of_demand(contents, study.over),
    ]
    return [*_of_samples(contents, study, study.over, units), *said]


def warnings(contents: Contents, study: Study) -> list[str]:
    """What must not be overlooked: members left out or divided, stable islands, curves refused, tails of hazard."""
    assert study.over is not None
    return [
        *of_what_arrives(contents, (study.over.intensity, study.over.second)),
        *_drawn_anew(study.over),
        *_begins_surely(contents, study.over),
        *_of_positive(contents, study.over),
        *_left_out(contents, study, study.over),
        *_divided(contents),
        *_below(contents, study),
        *_between(contents, study),
        *_islands(contents, study.over),
        *_refused(contents, study.over),
        *_missed(contents, study.over),
        *_rarer_than_its_part(contents),
        *_extrapolated(contents, study.over),
        *_tails(contents, study.over),
    ]


def of_what_arrives(contents: Contents, intensities: Iterable[str | None]) -> Iterator[str]:
    """Measures of a motion through floors are no longer the ground's, which a hazard curve of a site is of."""
    named = (name for name in intensities if name and name not in contents.axes)
    measures = [name for name in named if not name.startswith(GROUND)]
    of_ground = [f"{GROUND}{name}" for name in measures if name in ("pga", "pgv") or period_of(name) is not None]
    if measures and ARRIVES in str(contents.attrs.get("processing", "")):
        yield (
            f"the intensity {' and '.join(measures)} is that of the motion that arrives at the body through the "
            f"floors, not of the ground, which hazard curves are of{': that is ' if of_ground else ''}"
            f"{' and '.join(of_ground)}"
        )


def _of_the_body(path: str) -> bool:
    """Whether an input is the same in every earthquake."""
    return path.split(".")[0] in OF_THE_BODY and path != DIRECTION


def _drawn_anew(over: Over) -> Iterator[str]:
    """A body that is not well known is the same in all earthquakes: its survival is no power of the mean."""
    unknown = [path for path in over.inputs if _of_the_body(path)]
    if over.hazard and over.age is not None and unknown:
        said = (
            f"survival takes {', '.join(unknown)} as drawn anew in every earthquake, which makes it too low for one "
            "body that is not well known"
        )
        others = [axis for axis in over.axes if axis != SAMPLE]
        if others:
            axes = others[0] if len(others) == 1 else f"[{', '.join(others)}]"
            said += f"; `over: {axes}` tells the survival of every sample, and their mean is that of the body"
        yield said


def _begins_surely(contents: Contents, over: Over) -> Iterator[str]:
    """What is added to beta does not move where curves begin, near which their small percentiles lie."""
    if over.beta_added and "fragility_begins_at" in contents.fields and contents.values("fragility_begins_at").any():
        yield (
            "beta_added widens what curves are above where they begin, which it takes as known: small percentiles "
            "hardly feel it; where uplift is uncertain too, `begins_at: 0` widens the whole"
        )


def _of_positive(contents: Contents, over: Over) -> Iterator[str]:
    """A motion turned round is another one, and a curve over the logarithm has no room for it."""
    name = over.told_against
    against = contents.fields.get("fragility_intensity", contents.fields.get(name))
    if "fragility_median" not in contents.fields or against is None:
        return
    negative = int((against.values < 0.0).sum())
    if negative:
        yield (
            f"fragility curves are of positive {name} alone: {negative} of its {against.values.size} values are "
            "negative; `intensity: pga` takes motions of both signs together"
        )


def _left_out(contents: Contents, study: Study, over: Over) -> Iterator[str]:
    answered = contents.values("n_answered")
    total = len(contents.values(over.axis)) * answered.size
    missing = total - int(answered.sum())
    if missing and study.search is not None:
        yield (
            f"{missing} of {total} searches met a point without an answer (failed or unresolved); they enter the "
            f"statistics as the bracket that is known; see {study.search.name}_state"
        )
    elif missing:
        yield (
            f"{missing} of {total} cases have no answer and are left out of the statistics (n_answered"
            f"{_most_of(contents, over)}); if all of them remained stable, or all overturned, {_bracket(contents)}"
        )


def _most_of(contents: Contents, over: Over) -> str:
    """At which point beside the intensity most members have no answer, and how many of its; "" of one point."""
    item = contents.fields["n_answered"]
    members = len(contents.values(over.axis))
    dims = [dim for dim in item.dims if dim != over.along]
    along = tuple(i for i, dim in enumerate(item.dims) if dim == over.along)
    missing = (members - item.values).sum(axis=along)
    if missing.size == 1:
        return ""
    most = np.unravel_index(int(np.argmax(missing)), missing.shape)
    of = members * item.values.size // missing.size
    return f"; most at {place(contents, dims, most, units_of(contents))}: {int(missing[most])} of {of}"


def _bracket(contents: Contents) -> str:
    """What the members without an answer could make of the statistics, where that is most."""
    low, high = (contents.values(f"p_overturned_{end}").ravel() for end in ("low", "high"))
    widest = int(np.argmax(high - low))
    said = f"p_overturned would be {low[widest]:.3g} or {high[widest]:.3g}"
    if "fragility_median" in contents.fields:
        told, least, most = (contents.values(f"fragility_median{end}")[..., -1] for end in ("", "_low", "_high"))
        # an end without a curve leaves the median open on that side
        known = np.isfinite([told, least, most]).any(axis=0)
        apart = np.where(known, np.nan_to_num(np.abs(np.log(most / least)), nan=np.inf), -1.0)
        worst = np.unravel_index(int(np.argmax(apart)), apart.shape)
        if apart[worst] >= 0.0:
            units = units_of(contents)
            divisor, unit = units.of(str(contents.fields["fragility_median"].attrs["units"]))
            dims = contents.fields["fragility_median"].dims[:-1]
            of = f" at {place(contents, dims, worst, units)}" if apart.size > 1 else ""
            ends = " or ".join(f"{end[worst] / divisor:.4g}" if end[worst] > 0.0 else "none" for end in (most, least))
            said += f", the median of overturning{of} {ends}{unit_words(unit)}"
    return said if low.size == 1 else f"{said} (where most)"


def _divided(contents: Contents) -> Iterator[str]:
    if "overturn_share" not in contents.fields:
        return
    share = contents.values("overturn_share")
    n = int(((share > 0.0) & (share < 1.0)).sum())
    if n:
        yield (
            f"{n} of {share.size} cases overturn in some of their perturbed runs: they count by that share "
            "(overturn_share), and in fractiles of peaks as overturned where it is at least one half"
        )


def _below(contents: Contents, study: Study) -> Iterator[str]:
    if study.search is None:
        return
    rocks = found_by(contents, study.search.name).rocks_at_lowest
    if rocks is not None and rocks.any():
        yield (
            f"{int(rocks.sum())} of {rocks.size} cases rock at the lowest point of the range already and may overturn "
            "below it: begin it where nothing uplifts, or the statistics are those of the range alone"
        )


def _between(contents: Contents, study: Study) -> Iterator[str]:
    """Where the outcome changes more than once, the lowest change may lie between two points of the scan."""
    if study.search is None:
        return
    islands = found_by(contents, study.search.name).islands
    if islands is not None and islands.any():
        some, points = int((islands > 0).sum()), study.search.axis.size
        yield (
            f"{some} of {islands.size} cases remain stable again above the lowest value that overturns them; as bands "
            f"narrower than the spacing of the {points} points are not seen, lower ones may be missed, and the "
            "statistics told too high: see what more points (n) find"
        )


def _islands(contents: Contents, over: Over) -> Iterator[str]:
    if "safe_island" not in contents.fields:
        return
    island = contents.values("safe_island") > 0
    curves = island.any(axis=contents.axes.index(over.along))
    if curves.any():
        where = place(contents, contents.axes, np.argwhere(island)[0], units_of(contents))
        yield (
            f"stable islands: on {int(curves.sum())} of {curves.size} curves along {over.along} a body "
            f"remains stable above an intensity that overturned it (first: {where}); the share that overturns need not "
            "grow with it"
        )


def _refused(contents: Contents, over: Over) -> Iterator[str]:
    if "fragility_status" not in contents.fields:
        if over.told_against:
            names = " or ".join(filter(None, (over.told_against, over.second)))
            yield f"no fragility curves: the intensity {names} is not known of these motions"
        return
    item = contents.fields["fragility_status"]
    points = item.values[..., 0].size
    told: dict[str, list[str]] = {}  # where and why -> the limit states of which it is so
    for i, label in enumerate(contents.values(LIMIT)):
        of_limit = item.values[..., i]
        for status in WHY_NOT:
            bad = np.argwhere(of_limit == status)
            if len(bad):
                why = why_no_curve(contents, status)
                where = place(contents, item.dims[:-1], bad[0], units_of(contents))
                at = f" at {len(bad)} of {points} points (first: {where})" if points > 1 else ""
                told.setdefault(f"{at}: {why}", []).append(limit_words(label))
    for words, (*others, last) in told.items():
        yield f"no fragility curve for {', '.join(others)}{' or ' if others else ''}{last}{words}"


def why_no_curve(contents: Contents, status: int) -> str:
    """Why there is no curve; that no case exceeds a limit state may be due to bodies that only slide."""
    if "outcome" in contents.fields:
        slid = bool((contents.values("outcome") == SLIDING).any())
    else:  # a search saves no outcomes
        slid = SLIDES_FIRST in json.loads(str(contents.attrs.get("warnings", "[]")))
    return WHY_NOT[status] + (", or bodies slide and do not rock" if slid and status == NONE_EXCEEDS else "")


def _missed(contents: Contents, over: Over) -> Iterator[str]:
    """Curves that miss the shares they were fitted to."""
    if "fragility_misfit_p" not in contents.fields:
        return
    item = contents.fields["fragility_misfit_p"]
    divisor, unit = units_of(contents).of(str(contents.fields["fragility_misfit_at"].attrs["units"]))
    for i, label in enumerate(contents.values(LIMIT)):
        bad = np.argwhere(item.values[..., i] < LEVEL)
        if not len(bad):
            continue
        worst = min(bad, key=lambda at: float(item.values[(*at, i)]))
        where = f" at {place(contents, item.dims[:-1], worst, units_of(contents))}" if len(worst) else ""
        many = f" of {len(bad)} of {item.values[..., i].size} bodies (most:{where})" if where else ""
        at = float(contents.values("fragility_misfit_at")[(*worst, i)]) / divisor
        yield (
            f"the fragility curve for {limit_words(label)}{many} misses the suite: near {over.told_against} "
            f"{at:.4g}{unit_words(unit)} the share that exceeds it is farther from the curve than chance would have it "
            f"(probability {max(float(item.values[(*worst, i)]), 1e-6):.1g} at most)"
            + (": use the shares (rock table FILE.nc --of stripes)" if over.along is not None else "")
            + (", or try fit: lognormal" if over.fit == "ordinal" and len(contents.values(LIMIT)) > 1 else "")
        )


def _rarer_than_its_part(contents: Contents) -> Iterator[str]:
    """Limits of the slide, which overturning exceeds too, that are told as less probable than overturning."""
    if "fragility_median" not in contents.fields:
        return
    tails = contents.values("fragility_percentile")
    told = {"median": contents.values("fragility_median")[..., None]}  # the larger, the less probable
    told |= {f"{PERCENTILES[k]:g} % value": tails[..., k : k + 1] for k in (1, 0)}
    if "annual_rate" in contents.fields:
        with np.errstate(divide="ignore"):
            told["annual rate"] = 1.0 / contents.values("annual_rate")
    for i, label in enumerate(contents.values(LIMIT)):
        if exceeded_when(str(label)) == str(label):
            continue
        found = []
        for name, values in told.items():
            with np.errstate(invalid="ignore"):
                above = np.nan_to_num(values[..., i, :] / values[..., -1, :] - 1.0, nan=-1.0).max(axis=-1)
            beyond = above > MATCH
            if beyond.any():
                many = f" of {int(beyond.sum())} of {beyond.size} bodies" if beyond.ndim else ""
                most = 100.0 * float(above[beyond].max())
                found.append(f"{name}{many} by {_percent(most)} %{' at most' if many else ''}")
        if found:
            yield (
                f"{limit_words(label)} is told as less probable than overturning, which it includes: {', '.join(found)}"
                ": two fits to nearly the same shares, of which the more probable holds for both"
            )


def _extrapolated(contents: Contents, over: Over) -> Iterator[str]:
    """Percentiles beyond the intensities of the suite."""
    if "fragility_lowest" not in contents.fields:
        return
    low, high = (contents.values(f"fragility_{end}")[..., None, None] for end in ("lowest", "highest"))
    tail = contents.values("fragility_percentile")
    divisor, unit = units_of(contents).of(str(contents.fields["fragility_median"].attrs["units"]))
    told = []
    for beyond, end, words in ((tail < low, low, "below"), (tail > high, high, "above")):
        found = []
        for i, label in enumerate(contents.values(LIMIT)):
            percents = [
                f"{p:g} %" for p, some in zip(contents.values(PERCENTILE), _any(beyond[..., i, :]), strict=True) if some
            ]
            if percents:
                found.append(f"{', '.join(percents)} of {limit_words(label)}")
        if found:
            least = np.nanmin(end) if words == "below" else np.nanmax(end)
            told.append(f"{words} {least / divisor:.4g}{unit_words(unit)} ({'; '.join(found)})")
    if told:
        bodies = " of some bodies" if tail.ndim > 2 else ""
        yield (
            f"percentiles{bodies} lie outside the intensities of the suite and are extrapolated by the curve: "
            f"{over.told_against} {'; '.join(told)}"
        )


def _any(values: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether any body has it, by percentile."""
    return np.asarray(values.reshape(-1, values.shape[-1]).any(axis=0))


def _shares(contents: Contents, study: Study, over: Over, units: Units) -> Iterator[str]:
    """The share of the suite that overturns where no intensity is varied, at the points at which it is largest."""
    if over.along is not None or study.search is not None or "p_overturned_se" in contents.fields:
        return
    item = contents.fields["p_overturned"]
    share = item.values.ravel()
    known = np.flatnonzero(np.isfinite(share))
    if not known.size:
        return
    said = f"share of {_members(over, len(contents.values(over.axis)))} that overturns"
    if not item.dims:
        yield f"{said}: {share[0]:.3g}"
        return
    falls = known[np.argsort(-share[known], kind="stable")][: int((share[known] > 0.0).sum())]
    if not falls.size:
        yield f"{said}: 0 at all {known.size} points"
        return
    shown = falls[:MOST_BODIES]
    at = (place(contents, item.dims, np.unravel_index(int(i), item.values.shape), units) for i in shown)
    words = [f"{share[i]:.3g} at {where}" for i, where in zip(shown, at, strict=True)]
    left = known.size - len(shown)
    more = f"; no larger at {left} more: rock table FILE.nc --of suite --sort -p_overturned" if left else ""
    yield f"{said}: {'; '.join(words)}{more}"


def _of_samples(contents: Contents, study: Study, over: Over, units: Units) -> Iterator[str]:
    """The probability of overturning with its error, and what matters, at the first points of the other axes."""
    if study.uncertain is None or "p_overturned_se" not in contents.fields:
        return
    dims = contents.fields["p_overturned_se"].dims
    n = next(axis.size for axis in study.axes if axis.name == SAMPLE)
    others = " x ".join(
        f"{a.size} {'records' if a.name == 'record' else f'points of {a.name}'}"
        for a in study.axes
        if a.name in over.axes and a.name != SAMPLE
    )
    yield sentence(study.uncertain, n) + (f", over {others}" if others else "")
    shape = contents.values("p_overturned_se").shape
    every = list(np.ndindex(*shape))
    listed = [every[int(i)] for i in np.unique(np.linspace(0, len(every) - 1, min(len(every), MOST_BODIES)).round())]
    names = [str(path) for path in contents.values(INPUT)]
    for at in listed:
        where = f"{place(contents, dims, at, units)}: " if dims else ""
        p, se, low, high = (
            float(contents.values(f"p_overturned{end}")[at]) for end in ("", "_se", "_ci_low", "_ci_high")
        )
        if np.isfinite(p):
            yield (
                f"{where}overturned with probability {p:.4g}, standard error {se:.2g} (95 % {low:.3g} to {high:.3g})"
            )
        for kind, words in MATTERS.items():
            if kind not in contents.fields or not np.isfinite(found := contents.values(kind)[at]).any():
                continue
            order = np.argsort(-np.abs(np.nan_to_num(found)))
            shown = (f"{names[i]} {_index(contents, kind, (*at, i))}" for i in order)
            yield f"{where}{words}: {', '.join(shown)}"
    if int(np.prod(shape, dtype=int)) > len(listed):
        left = counted(int(np.prod(shape)) - len(listed), "more point")
        yield f"and {left}: rock table FILE.nc --of inputs, --of suite"


def _index(contents: Contents, kind: str, at: tuple[int, ...]) -> str:
    """A rank correlation; Sobol indices of first order and total, each with its standard error."""
    if not kind.startswith("sobol"):
        return f"{contents.values(kind)[at]:.2f}"
    of = kind.removeprefix("sobol_first")
    found = (
        (contents.values(f"sobol_{order}{error}{of}")[at] for error in ("", "_se")) for order in ("first", "total")
    )
    return " / ".join(f"{value:.2f} ± {se:.2g}" for value, se in found)


MATTERS: dict[str, str] = {
    "input_spearman": "which input matters, rank correlation with the peak (Spearman)",
    "sobol_first": "which input decides whether it overturns, Sobol indices, first order / total (± standard error)",
    "sobol_first_peak": "which input decides the peak, Sobol indices, first order / total (± standard error)",
}


def _of_fragility(contents: Contents, over: Over, units: Units) -> Iterator[str]:
    if "fragility_median" not in contents.fields:
        return
    status = contents.values("fragility_status")
    begins = contents.values("fragility_begins_at")
    bodies = contents.fields["fragility_begins_at"].dims
    divisor, unit = units.of(str(contents.fields["fragility_median"].attrs["units"]))
    n = len(contents.values(over.axis))
    many = int(np.prod(status.shape[:-1], dtype=int))
    listed = _worst(contents.values("fragility_median")[..., -1])
    first = "uplift or slip" if any(limit.quantity != PEAK for limit in over.limits) else "uplift"
    lowest, highest = (contents.values(f"fragility_{end}") for end in ("lowest", "highest"))
    for at in listed:

        def beyond(x: float, at: tuple[int, ...] = at) -> str:
            return "" if lowest[at] <= x <= highest[at] else ", extrapolated"

        where = f"{place(contents, bodies, at, units)}: " if bodies else ""
        if begins[at] > 0.0:
            last = float(contents.values("fragility_begins_at_last")[at])
            others = f" of the first member to move; the last moves from {last / divisor:.4g}{unit_words(unit)}"
            yield (
                f"{where}curves begin at {first}, {over.told_against} {begins[at] / divisor:.4g}{unit_words(unit)}"
                + (others if last > begins[at] * (1.0 + MATCH) else "")
            )
        for i, label in enumerate(contents.values(LIMIT)):
            if status[(*at, i)] != FITTED:
                continue
            median, low, high, beta, total = (
                float(contents.values(f"fragility_{name}")[(*at, i)])
                for name in ("median", "median_ci_low", "median_ci_high", "beta", "beta_total")
            )
            added = f" ({total:.3g} with beta_added)" if over.beta_added else ""
            tails = []
            for k in (1, 0):  # 5 %, 1 %
                x, least, most = (
                    float(contents.values(f"fragility_percentile{end}")[(*at, i, k)])
                    for end in ("", "_ci_low", "_ci_high")
                )
                limits = _limits(least / divisor, most / divisor, "", beyond(x))
                tails.append(f"{PERCENTILES[k]:g} % at {x / divisor:.3g}{limits}")
            yield (
                f"{where}{limit_words(label)}: median {over.told_against} {median / divisor:.3g}{unit_words(unit)}"
                f"{_limits(low / divisor, high / divisor, more=beyond(median))}, beta {beta:.3g}{added}, "
                f"{', '.join(tails)}{unit_words(unit)} ({_members(over, n)})"
            )
            if over.second:
                c, c_low, c_high = (
                    float(contents.values(f"fragility_{name}")[(*at, i)])
                    for name in ("exponent", "exponent_ci_low", "exponent_ci_high")
                )
                size, shown = units.of(str(contents.fields["fragility_second"].attrs["units"]))
                yield (
                    f"{where}{limit_words(label)}: this at {over.second} "
                    f"{contents.values('fragility_second')[at] / size:.4g}{unit_words(shown)}; "
                    f"{'the median' if begins[at] == 0.0 else f'what it is above {first}'} goes with its power {-c:.3g}"
                    f"{_limits(-c_high, -c_low)}"
                )
    if many > len(listed):
        yield (
            f"and {counted(many - len(listed), 'more body')}, of larger medians of overturning or none: "
            "rock table FILE.nc --of fragility --select limit_state=overturned --sort fragility_median"
        )


def _limits(low: float, high: float, level: str = "95 % ", more: str = "") -> str:
    """Confidence limits in brackets, and more that is to be said; "" where there is nothing, as of one member."""
    limits = "" if np.isnan(low) else f"{level}{low:.3g} to {high:.3g}"
    return f" ({f'{limits}{more}'.removeprefix(', ')})" if limits or more else ""


def _of_risk(contents: Contents, over: Over, units: Units) -> Iterator[str]:
    """Annual rates under every hazard curve, and what an age makes of that of overturning."""
    if "annual_rate" not in contents.fields:
        return
    rate = contents.values("annual_rate")
    bodies = contents.fields["fragility_begins_at"].dims
    divisor, unit = units.of(str(contents.fields["fragility_median"].attrs["units"]))
    many = int(np.prod(rate.shape[:-2], dtype=int))
    listed = _worst(np.asarray(-np.nan_to_num(rate[..., -1, :], nan=-1.0).max(axis=-1)))
    for at in listed:
        where = f"{place(contents, bodies, at, units)}: " if bodies else ""
        for i, label in enumerate(contents.values(HAZARD)):
            told = [
                f"{limit_words(limit)} {rate[(*at, j, i)]:.3g}"
                for j, limit in enumerate(contents.values(LIMIT))
                if np.isfinite(rate[(*at, j, i)])
            ]
            if not told:
                continue
            last = (*at, -1, i)
            said = f"{where}annual rate under {label}: {', '.join(told)}"
            if rate[last] > 0.0:
                low, high = (float(contents.values(f"annual_rate_ci_{end}")[last]) for end in ("low", "high"))
                limits = "" if np.isnan(low) else f"95 % {low:.3g} to {high:.3g}; "
                said += f" ({limits}{_whence(*central(contents, last), divisor, unit)})"
            yield said
            if over.age is not None and np.isfinite(rate[last]):
                of_age = ("probability_in_age", "survival", "likelihood_ratio")
                falls, survives, ratio = (float(contents.values(name)[last]) for name in of_age)
                known = f"is consistent with {label}" if survives >= CONSISTENT else f"contradicts {label} at 5 %"
                rates = (float(contents.values(f"annual_rate_ci_{end}")[last]) for end in ("high", "low"))
                least, most = (float(np.exp(-end * over.age)) for end in rates)
                if least < CONSISTENT <= most:
                    known += f", though not at the {'lower' if survives >= CONSISTENT else 'upper'} limit"
                beyond_it = float(contents.values("annual_rate_above")[last])
                if np.exp(-(rate[last] + beyond_it) * over.age) < CONSISTENT <= survives:
                    known += f", though not with what motions beyond its end can add, {beyond_it:.2g} a year"
                limits = "" if np.isnan(least) else f" (95 % {_near_one(least)} to {_near_one(most)})"
                yield (
                    f"{where}{over.age:g} years under {label}: overturns with probability {falls:.3g}, "
                    f"survives with {_near_one(survives)}{limits}; a body that stood so long {known} "
                    f"(likelihood ratio {ratio:.3g})"
                )
    if many > len(listed):
        yield (
            f"and {counted(many - len(listed), 'more body')}, overturned less often or without a rate: "
            "rock table FILE.nc --of risk --select limit_state=overturned --sort -annual_rate"
        )


def _whence(low: float, high: float, divisor: float, unit: str) -> str:
    """From which intensities most of a rate comes, by the ends of its middle 68 % (`central`)."""
    if np.isinf(low):
        return "more than 84 % of it from beyond the hazard curve"
    if np.isinf(high):
        return f"84 % of it from {low / divisor:.3g}{unit_words(unit)} on"
    return f"68 % of it from {low / divisor:.3g} to {high / divisor:.3g}{unit_words(unit)}"


def _of_any_sample(contents: Contents, study: Study, units: Units) -> Iterator[str]:
    """Mean survival of the samples of a body: that of one that is not well known, the same in all earthquakes."""
    if study.over is None or study.over.age is None or study.uncertain is None or "survival" not in contents.fields:
        return
    age, bodies = study.over.age, contents.fields["fragility_begins_at"].dims
    if SAMPLE not in bodies or not all(_of_the_body(each.path) for each in study.uncertain.inputs):
        return
    survives = np.moveaxis(contents.values("survival")[..., -1, :], bodies.index(SAMPLE), -1)
    dims, n = tuple(axis for axis in bodies if axis != SAMPLE), survives.shape[-1]
    known = np.isfinite(survives)
    with np.errstate(invalid="ignore"):
        means = np.where(known, survives, 0.0).sum(axis=-1) / known.sum(axis=-1)
    for at in _worst(np.asarray(np.nan_to_num(means, nan=2.0).min(axis=-1))):
        where = f"{place(contents, dims, at, units)}: " if dims else ""
        for i, label in enumerate(contents.values(HAZARD)):
            of = survives[(*at, i)][known[(*at, i)]]
            if not len(of):
                continue
            mean, part = float(means[(*at, i)]), len(of) / n
            which = f"the {n} samples" if len(of) == n else f"the {len(of)} of {n} samples that have a curve"
            least, most = part * mean, part * mean + 1.0 - part  # whatever the survival of the others
            body = "a body that is one of them and stood so long"
            verdict = (
                f"{body} is consistent with {label}" if least >= CONSISTENT else f"{body} contradicts {label} at 5 %"
            )
            if least < CONSISTENT <= most:
                others = f"with the others the mean is {_near_one(least)} to {_near_one(most)}"
                verdict = f"{others}, so whether {verdict} is open: see fragility_status"
            yield (
                f"{where}{age:g} years under {label}: survives with {_near_one(mean)} on the mean of {which}, "
                f"{_near_one(float(of.min()))} to {_near_one(float(of.max()))} by sample; {verdict}"
            )


def _percent(share: float) -> str:
    """Two digits, and no power of ten where it is above 100."""
    return f"{float(f'{share:.2g}'):g}"


def _near_one(probability: float) -> str:
    """A probability with the digits that tell it from 1: .9997 is not 1."""
    digits = max(3, int(-np.floor(np.log10(max(1.0 - probability, 1e-12)))))
    return f"{probability:.{digits}g}"


def _worst(measure: NDArray[np.float64]) -> list[tuple[int, ...]]:
    """The bodies that are told of: all, in their order, or the first `MOST_BODIES` by a measure, NaN last."""
    every = list(np.ndindex(*measure.shape))
    if len(every) <= MOST_BODIES:
        return every
    return [every[i] for i in np.argsort(measure.ravel(), kind="stable")[:MOST_BODIES]]


def _tails(contents: Contents, over: Over) -> Iterator[str]:
    """Hazard curves that end where the fragility needs them, and what was changed when they were read."""
    for curve in over.hazard:
        for note in curve.notes:
            yield f"{hazard_words(curve.label)}: {note}"
    for label, end, more, rate in largest_tail(contents):
        if end == "above" and more > 10.0 * rate:
            doubt = ": are its units right?" if rate < 1e-3 * more else ""
            yield (
                f"{hazard_words(label)} ends below the intensities that exceed a limit state: motions beyond its end "
                f"can add up to {more:.2g} a year to a rate of {rate:.2g} (annual_rate_above){doubt}"
            )
        elif end == "above":
            yield (
                f"{hazard_words(label)} ends where bodies may remain stable: motions beyond its end, counted as if at "
                f"it, can add up to {_percent(100.0 * more / rate)} % to a rate (annual_rate_above)"
            )
        else:
            yield (
                f"{hazard_words(label)} begins where a limit state is exceeded already: were its first power law to go "
                f"on, motions below its first point would add {_percent(100.0 * more / rate)} % to a rate "
                "(annual_rate_below)"
            )


def _of_demand(contents: Contents, over: Over) -> Iterator[str]:
    if "demand_spearman" not in contents.fields:
        return
    rho = contents.values("demand_spearman")
    flat = rho.reshape(-1, rho.shape[-1])
    found = []
    for name, column in zip(contents.values(MEASURE), flat.T, strict=True):
        known = column[np.isfinite(column)]
        if len(known):
            found.append((float(np.median(known)), str(name)))
    if found:
        found.sort(key=lambda item: -abs(item[0]))
        words = ", ".join(f"{name} {value:.2f}" for value, name in found)
        points = "" if len(flat) == 1 else f", median of {len(flat)} points"
        yield f"rank correlation of the peak: {words} (Spearman{points})"
    few = contents.values("n_answered").ravel() < LEAST
    if few.any():
        where = "" if few.all() else f" at {int(few.sum())} of {few.size} points"
        why = f"fewer than {_members(over, LEAST)} with an answer"
        yield f"correlations with measures of the motion are left out{where}: {why}"


def _of_thresholds(contents: Contents, study: Study, over: Over, units: Units) -> Iterator[str]:
    assert study.search is not None
    sought, n = study.search, len(contents.values(over.axis))
    axes = {name: coordinates(contents, name, units) for name in contents.axes if name != over.axis}
    what = f"lowest overturning {sought.name.removesuffix(FOUND)} of {_members(over, n)}"
    for end, words in (("p16", "16th percentile"), ("p50", "median"), ("p84", "84th percentile")):
        found = found_by(contents, sought.name, f"_{end}")
        yield f"{what}, {words}: {threshold_words(found, axes, sought.axis.unit, units)}"


def limit_words(label: Any) -> str:
    """A limit state for people."""
    if label == OVERTURNED:
        return "overturning"
    return in_full(exceeded_when(str(label)))


def _members(over: Over, n: int) -> str:
    """`42 records`, `1 sample`, `9 points of T_p`."""
    return counted(n, over.axis) if over.axis in ("record", "sample") else f"{counted(n, 'point')} of {over.axis}"
