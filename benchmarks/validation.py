"""What the thesis claims against what its figures' studies give: writes the table of docs/validation.md.

    rock run studies/seed/*.yaml studies/seed/mesh/*.yaml studies/damping/other_restitution.yaml studies/flexible/size.yaml --skip-missing --no-plots --out results/seed
    python benchmarks/validation.py results/seed

Reads the datasets of the studies, nothing else.  A row whose datasets are not all there (records, mesh) stays as it
stands in the page.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from pages import section, write_section

PAGE = Path(__file__).resolve().parents[1] / "docs" / "validation.md"
BEGIN, END = "<!-- claims: begin -->", "<!-- claims: end -->"
OVERTURNED = 2
"""Outcomes from this flag on are overturnings."""


@dataclass(frozen=True)
class Claim:
    """A row: the figures, what the thesis says of them, and what their datasets say: a sentence and a verdict."""

    figures: str
    says: str
    names: tuple[str, ...]
    measure: Callable[..., tuple[str, str]]


def figures(*numbers: int) -> tuple[str, ...]:
    return tuple(f"fig{number:02d}" for number in numbers)


def at(dataset: xarray.Dataset, name: str, **where: Any) -> np.ndarray:
    """Values of a variable at labels; axes of one point (a record found by a pattern) are dropped."""
    return np.asarray(dataset[name].sel(where).squeeze().values)


def peaks(dataset: xarray.Dataset, **where: Any) -> np.ndarray:
    return at(dataset, "theta_peak_over_alpha", **where)


def percent(values: Any, digits: int = 1) -> str:
    """Numbers in per cent, separated by slashes."""
    return " / ".join(f"{100.0 * value:.{digits}f}" for value in np.ravel(values)) + " %"


def within(value: float, limit: float) -> str:
    return f"holds within {percent(value)}" if value <= limit else "does not hold"


def solvers(fig03: xarray.Dataset) -> tuple[str, str]:
    worst = {str(name): float(at(fig03, "error_history", solver=name).max()) for name in fig03["solver"].values}
    text = ", ".join(f"{name} {worst[name]:.2g}" for name in worst if name != "exact")
    better = worst["ode45_events"] < worst["ode23s_naive"]
    return (
        f"largest error of theta/alpha at equal tolerances: {text} (events: impacts located)",
        "depends on tolerances and located impacts, not on the equation" if better else "holds",
    )


def linearized(fig04: xarray.Dataset) -> tuple[str, str]:
    error = peaks(fig04, model="linearized") / peaks(fig04, model="rigid") - 1.0  # pulse, tan_alpha
    text = f"peak at tan alpha .1 / .333: {percent(error[0])} (Ricker), {percent(error[1])} (sine)"
    good = max(abs(error[:, 0])) < 0.02 and abs(error[0, 1]) > 0.05
    return text, f"holds within {percent(np.abs(error[:, 0]).max())} at .1" if good else "does not hold"


def undamped(*found: xarray.Dataset) -> tuple[str, str]:
    errors = np.array([np.abs(peaks(d).T[1] / peaks(d).T[0] - 1.0) for d in found])  # figure, tan_alpha
    return (
        f"largest error of the peak at tan alpha .1 / .2 / .333: {percent(errors.max(axis=0), 2)}; histories part in phase, "
        f"by up to {max(float(d['error_history'].max()) for d in found):.2f} alpha in 20/p",
        within(float(errors.max()), 0.1),
    )


def masses(fig18: xarray.Dataset) -> tuple[str, str]:
    found = fig18["theta_peak_over_alpha"].transpose("elements", "case").values
    # a column of n lumped elements is low in proportion to 1/n²: extrapolated from 10 and 20
    full = found[2] + (found[2] - found[1]) / 3.0
    low = (1.0 - found / full).max(axis=1)
    return f"peak low by {percent(low)} with 5 / 10 / 20 elements, lumped masses", within(float(low[0]), 0.05)


def curve_errors(kind: str, limit: float) -> Callable[..., tuple[str, str]]:
    def measure(*found: xarray.Dataset) -> tuple[str, str]:
        errors = [np.ravel(d[f"curve_error_{kind}"].values) for d in found]
        slopes = " / ".join(f"{value:g}" for value in found[0]["tan_alpha"].values)
        text = f"at tan alpha {slopes}: " + "; ".join(percent(error, 2) for error in errors)
        return text, within(float(max(error.max() for error in errors)), limit)

    return measure


def vertical(fig25: xarray.Dataset) -> tuple[str, str]:
    return f"largest v of a model {float(fig25['v_model'].max()):.2g} m", "holds"


def restitution(fig30: xarray.Dataset) -> tuple[str, str]:
    loss = 1.0 - peaks(fig30, damping="restitution") / peaks(fig30, damping="none")  # pulse, tan_alpha
    return f"peak lower by {percent(loss[0])} (Ricker), {percent(loss[1])} (sine) at tan alpha .1 / .2 / .333", "holds"


def dampers(*found: xarray.Dataset) -> tuple[str, str]:
    peak = np.stack([peaks(d) for d in found])  # figure, tan_alpha, case
    error = np.abs(peak[..., 1:] / peak[..., :1] - 1.0).max(axis=(0, 2))
    spread = (peak[..., 1:].max(axis=(0, 2)) / peak[..., 1:].min(axis=(0, 2)) - 1.0).max()
    apart = np.stack([at(d, "error_history")[:, 1:] for d in found])
    return (
        f"peaks of the four models within {percent(spread)} of one another and {percent(error)} (tan alpha .1 / .2 / .333) of the "
        f"block's; histories up to {apart.max():.2f} alpha from it",
        "holds" if spread < 0.02 < apart.min() else "does not hold",
    )


def hht_pulse(fig36: xarray.Dataset) -> tuple[str, str]:
    block = peaks(fig36, case="rigid block")
    stiff, soft = (peaks(fig36, case=name) / block - 1.0 for name in ("kw = 2e14", "kw = 1e12"))
    return (
        f"peak {percent(stiff)} above the block's at kw = 2e14 N/m³, {percent(soft)} at 1e12 (tan alpha .1 / .2 / .333)",
        "depends on kw and on the step",
    )


def hht_records(*found: xarray.Dataset) -> tuple[str, str]:
    texts = []
    for dataset in found:
        block, *rest = peaks(dataset)
        texts.append(percent(np.array(rest) / block - 1.0, 0))
    return (
        f"error of the peak: {'; '.join(texts)} (kw = 1e14; Fig. 37 also 1e12, Fig. 38 also 1, 2, 3e-9 of it more: a matter of rounding)",
        "holds",
    )


def fema(fig41: xarray.Dataset, fig42: xarray.Dataset) -> tuple[str, str]:
    block, answer = peaks(fig41)
    fell, stands = peaks(fig42)
    return (
        f"{answer:.3f} alpha against {block:.3f} ({percent(answer / block - 1.0)}; {int(at(fig41, 'fema_n_roots')[1])} solutions); "
        f"{stands:.3f} alpha where the block {'overturns' if np.isinf(fell) else f'reaches {fell:.3f}'} (stand-ins)",
        "holds",
    )


def event_pulses(*found: xarray.Dataset) -> tuple[str, str]:
    error = [np.abs(peaks(d)[:, 1:] / peaks(d)[:, :1] - 1.0).max(axis=1) for d in found]  # by tan_alpha
    return (
        f"peak at tan alpha .1 / .2 / .333: {percent(error[0])} (Ricker), {percent(error[1])} (sine)",
        within(float(max(e.max() for e in error)), 0.05),
    )


def other_restitution(dataset: xarray.Dataset) -> tuple[str, str]:
    apart = abs(dataset["error_theta_peak_over_alpha"]).max(["pulse", "damping_eta", "case"]).values
    eta = dataset["damping_eta"].values
    return (
        f"eta from {eta.min():g} to {eta.max():g}: same outcomes, peaks up to {' / '.join(f'{value:.4f}' for value in apart)} alpha apart "
        "(tan alpha .1 / .2 / .333)",
        "holds" if bool((dataset["same_outcome"] == 1).all()) and apart.max() < 0.05 else "does not hold",
    )


def spectra(fig45: xarray.Dataset, fig46: xarray.Dataset) -> tuple[str, str]:
    block, model = (d["outcome"].values >= OVERTURNED for d in (fig45, fig46))
    other = np.argwhere(block != model)
    beside = sum(len(np.unique(block[max(i - 1, 0) : i + 2, max(j - 1, 0) : j + 2])) > 1 for i, j in other)
    share = len(other) / block.size
    return (
        f"{percent(share)} of {block.size} pulses have another outcome, {beside} of those {len(other)} beside a boundary of the "
        "block's map, the rest in bands thinner than the grid",
        within(share, 0.02),
    )


def event_records(*found: xarray.Dataset) -> tuple[str, str]:
    same = close = stand = 0
    worst = 0.0
    for dataset in found:
        peak = peaks(dataset)
        same += bool(np.all(np.isinf(peak) == np.isinf(peak[0])))
        if np.isfinite(peak).all():
            stand += 1
            error = float(np.abs(peak / peak[0] - 1.0).max())
            close += error < 0.01
            worst = max(worst, error)
    return (
        f"same outcome in {same} of {len(found)}; where they remain stable, peaks within 1 % in {close} of {stand}, worst {percent(worst, 0)}: "
        "peaks that come late, after histories have parted",
        "outcomes hold; peaks depend on the motion",
    )


def mesh(dataset: xarray.Dataset) -> tuple[str, str]:
    peak = dataset["theta_peak_over_alpha"].transpose("zeta", "case").values
    error = peak[:, 1] / peak[:, 0] - 1.0
    gap = dataset["error_history"].transpose("zeta", "case").values[:, 1]
    return (
        f"peak {percent(error, 0 if np.abs(error).max() > 0.1 else 1)} off that of CalculiX, histories up to "
        f"{' / '.join(f'{value:.2f}' for value in gap)} alpha apart (zeta {' / '.join(f'{value:g}' for value in dataset['zeta'].values)})",
        within(float(np.abs(error).max()), 0.05),
    )


def damped_column(fig63: xarray.Dataset, fig64: xarray.Dataset) -> tuple[str, str]:
    lumped, five, twenty = peaks(fig63)
    names = [str(name) for name in fig64["case"].values]
    fate = ["overturns" if np.isinf(value) else f"{value:.3f}" for value in peaks(fig64)]
    listed = ", ".join(f"{name}: {end}" for name, end in zip(names, fate, strict=True))
    return (
        f"Fig. 63: {lumped:.3f} alpha with the thesis's lumped masses, {five:.3f} / {twenty:.3f} with consistent ones (5 / 20). Fig. 64: {listed}",
        "Fig. 64 depends on the masses: it is at the boundary",
    )


def short_pulse(fig65: xarray.Dataset) -> tuple[str, str]:
    block, lumped, twenty = peaks(fig65)
    holds = np.isinf(block) and np.isfinite([lumped, twenty]).all()
    return (
        f"block overturns, column remains stable at {lumped:.3f} / {twenty:.3f} alpha (lumped / consistent)",
        "holds" if holds else "no",
    )


def long_pulse(fig66: xarray.Dataset) -> tuple[str, str]:
    block, lumped, twenty, cut, winkler, higher = peaks(fig66)
    falls = {True: "overturns", False: "remains stable"}
    return (
        f"block {block:.3f} alpha, stable; column {lumped:.3f} / {twenty:.3f} alpha (lumped / consistent), stable. It "
        f"{falls[bool(np.isinf(higher))]} at 2.58 g tan alpha; at 2.5 with the pulse cut off it {falls[bool(np.isinf(cut))]}, on a no-tension "
        f"base of 1e11 N/m³ it {falls[bool(np.isinf(winkler))]}",
        "first half does not hold (by 1 % of the amplitude); second holds",
    )


def bending(*found: xarray.Dataset) -> tuple[str, str]:
    """The mean deformation of the top between impacts, on either side of each impact."""
    means = []
    for dataset in found:
        case = dataset.sel(case="20 elements")
        impacts = case["t_impact"].values[np.isfinite(case["t_impact"].values)]
        top = case["u_top_bending"]
        spans = zip(np.r_[float(case["t_uplift"]), impacts[:-1]], impacts, strict=True)
        means.append([float(top.sel(time=slice(*span)).mean()) for span in spans])
    turns = sum(int((np.diff(np.sign(each)) != 0).sum()) for each in means)
    every = sum(len(each) - 1 for each in means)
    size = np.abs(np.concatenate(means))
    return (
        f"the mean between impacts changes its sign at {turns} of {every} impacts, from {1e3 * size.min():.0f} to {1e3 * size.max():.0f} mm",
        "holds" if turns == every else "does not hold",
    )


def size(dataset: xarray.Dataset) -> tuple[str, str]:
    peak = dataset["theta_peak_over_alpha"].transpose("case", "block_R").values
    same = np.abs(np.ptp(peak[[0, 2]], axis=1)).max()
    less = 1.0 - peak[1] / peak[0]
    return (
        f"R {' / '.join(f'{value:g}' for value in dataset['block_R'].values)} m of concrete: peak {percent(less)} below the rigid "
        f"column's; with E in proportion to R peaks equal to {same:.0e}",
        "holds" if same < 1e-9 and (np.diff(less) > 0.0).all() else "does not hold",
    )


CLAIMS = (
    Claim("3", "ode45 and ode23s do not match so well; ode23s fits the real response", figures(3), solvers),
    Claim(
        "4", "linearized: agrees very well if tan alpha is small; errors for larger slenderness", figures(4), linearized
    ),
    Claim(
        "7-8, 11-12, 15-16, 19-20",
        "models 1-4: small differences, due to the term of the ground acceleration",
        figures(7, 8, 11, 12, 15, 16, 19, 20),
        undamped,
    ),
    Claim("18", "6 and more masses reach the desired outcome", figures(18), masses),
    Claim(
        "21-22",
        "restoring moment with large displacements: models 1, 4; models 2, 3",
        figures(21, 22),
        curve_errors("moment_rotation", 0.06),
    ),
    Claim(
        "23-24",
        "displacements match well up to a slenderness of 0.3 (error over the width)",
        figures(23, 24),
        curve_errors("displacements", 0.06),
    ),
    Claim("25", "the models give only negative vertical displacements", figures(25), vertical),
    Claim(
        "26-27",
        "pushover, negative stiffness; models 1, 4 corotational: almost perfect in every case",
        figures(26, 27),
        curve_errors("pushover", 0.03),
    ),
    Claim(
        "28", "pushover, model 3 corotational: only up to tan alpha = .2", figures(28), curve_errors("pushover", 0.06)
    ),
    Claim(
        "29", "the error of the overturning moment is acceptable", figures(29), curve_errors("overturning_moment", 0.11)
    ),
    Claim("30", "the coefficient of restitution influences the response", figures(30), restitution),
    Claim(
        "31-34",
        "base damper: all models alike, and different from the block because of the coefficient",
        figures(31, 32, 33, 34),
        dampers,
    ),
    Claim(
        "36", "numerical damping: works perfectly for pulses, not sensitive to fibres and step", figures(36), hht_pulse
    ),
    Claim("37-39", "numerical damping: under real records not likeable", figures(37, 38), hht_records),
    Claim("41-42", "FEMA-356: not acceptable for real records", figures(41, 42), fema),
    Claim("43-44", "event-based damping: works perfectly under pulses", figures(43, 44), event_pulses),
    Claim(
        "(3.5, 5)",
        "with another coefficient of restitution event-based damping needs that coefficient only",
        ("other-restitution",),
        other_restitution,
    ),
    Claim("45-46", "event-based model 3: an equivalent overturning spectrum", figures(45, 46), spectra),
    Claim(
        "47-58",
        "event-based damping: works perfectly in almost every case, very close to the real response",
        figures(*range(47, 59)),
        event_records,
    ),
    Claim(
        "60",
        "undamped column of five elements under a sine: pretty well, against a full mesh",
        ("fig60-mesh",),
        mesh,
    ),
    Claim("61", "the same under a record (a stand-in, first 20 s)", ("fig61-mesh",), mesh),
    Claim(
        "62",
        "the same under another record (first 20 s, base of 1e11 N/m³)",
        ("fig62-mesh",),
        mesh,
    ),
    Claim("63-64", "(histories of damped flexible columns)", figures(63, 64), damped_column),
    Claim("65", "T_p = 2 s: the rigid column overturns, the flexible one is stable", figures(65), short_pulse),
    Claim("66", "T_p = 4 s: the flexible column overturns, the rigid one continues rocking", figures(66), long_pulse),
    Claim(
        "65-66",
        "at each impact the deformation of the top due to bending changes its direction",
        figures(65, 66),
        bending,
    ),
    Claim("(4.2)", "departs from the rigid column where E/(rho g) is small or R large", ("flexible-size",), size),
)


def row(claim: Claim, folder: Path, standing: dict[str, str]) -> str:
    """The row of a claim; the one that stands in the page where a dataset is not there."""
    paths = [folder / name / f"{name}.nc" for name in claim.names]
    if not all(path.is_file() for path in paths):
        return standing.get(claim.figures, f"| {claim.figures} | {claim.says} | not run | |")
    found = [xarray.load_dataset(path) for path in paths]
    text, verdict = claim.measure(*found)
    return f"| {claim.figures} | {claim.says} | {text} | {verdict} |"


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit("usage: python benchmarks/validation.py FOLDER_OF_RESULTS")
    table = section(PAGE, BEGIN, END)
    standing = {line.split("|")[1].strip(): line for line in table.splitlines() if line.startswith("|")}
    lines = ["| Fig. | the thesis says | measured | result |", "| --- | --- | --- | --- |"]
    lines += [row(claim, Path(sys.argv[1]), standing) for claim in CLAIMS]
    write_section(PAGE, BEGIN, END, lines)
    print(f"wrote {PAGE}")


if __name__ == "__main__":
    main()
