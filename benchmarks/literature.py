"""Numbers of papers against what their studies give: writes the table "Published numbers" of docs/validation.md.

    rock run studies/literature studies/objects/rocking_frame.yaml --skip-missing --no-plots --out results/literature
    python benchmarks/literature.py results/literature

Reads the datasets of the studies, nothing else.  A row whose dataset is not there stays as it stands in the page.
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from pages import section, write_section

PAGE = Path(__file__).resolve().parents[1] / "docs" / "validation.md"
BEGIN, END = "<!-- literature: begin -->", "<!-- literature: end -->"
HEAD = ["| paper | what | published | here | deviation |", "| --- | --- | --- | --- | --- |"]
G = 9.81
STANDS, AFTER_IMPACT = 1, 3

Found = tuple[str, str]
"""What the dataset says, and how far that is from the paper."""


@dataclass(frozen=True)
class Row:
    """A number, or a few of one kind, of a paper: where it is, as printed, the study, and how its dataset is read."""

    paper: str
    what: str
    published: str
    study: str
    read: Callable[[xarray.Dataset], Found]


def between(number: float, low: float, high: float) -> str:
    """How far a number lies outside of what the paper allows."""
    if low <= number <= high:
        return "none"
    outside = low if number < low else high
    return f"{100.0 * (number / outside - 1.0):+.2g} %"


def threshold(low: float, high: float, digits: int = 5, **where: Any) -> Callable[[xarray.Dataset], Found]:
    """The lowest overturning amplitude in g, beside the amplitudes at which the paper has the body stable and overturned."""

    def read(dataset: xarray.Dataset) -> Found:
        found = float(dataset["motion_pulse_a_p_overturning"].sel(where)) / G
        return f"{found:.{digits}f} g", between(found, low, high)

    return read


def amplitudes(published: tuple[float, ...], axis: str, digits: int = 3) -> Callable[[xarray.Dataset], Found]:
    """The lowest overturning amplitudes in g along an axis, each beside the paper's."""

    def read(dataset: xarray.Dataset) -> Found:
        found = dataset["motion_pulse_a_p_overturning"].values.ravel() / G
        assert len(found) == dataset.sizes[axis] == len(published)
        off = [f"{100.0 * (f / p - 1.0):+.1f}" for f, p in zip(found, published, strict=True)]
        return f"{', '.join(f'{f:.{digits}f}' for f in found)} g", f"{', '.join(off)} %"

    return read


def bands(dataset: xarray.Dataset) -> Found:
    """Where the outcome changes along the amplitudes over alpha g: lowest, end of the first band, start of the second."""
    over, times = dataset["outcome"].values >= 2, dataset["times"].values
    edges = [(times[i], times[i + 1]) for i in np.flatnonzero(np.diff(over.astype(int)))]
    assert len(edges) == 3
    printed = ((3.00, 3.01), (6.32, 6.33), (7.17, 7.18))
    off = [between(float(np.mean(edge)), *paper) for edge, paper in zip(edges, printed, strict=True)]
    return ", ".join(f"{a:.3f}-{b:.3f}" for a, b in edges), ", ".join(off)


def ends(dataset: xarray.Dataset) -> Found:
    """Between which omega_p/p the overturning after an impact ends."""
    printed = ((6.59, 7.58), (4.7, 5.8))
    omega = dataset["motion_pulse_omega_p"].values
    said, off = [], []
    for case, numbers in zip(dataset["case"].values, printed, strict=True):
        for model, number in zip(("linearized", "rigid"), numbers, strict=True):
            band = dataset["outcome"].sel(case=case, model=model) == AFTER_IMPACT
            last = int(np.flatnonzero(band.any("a_p_over_g_tan_alpha").values).max())
            said.append(f"{omega[last]:g}-{omega[last + 1]:g}")
            off.append(f"{100.0 * (0.5 * (omega[last] + omega[last + 1]) / number - 1.0):+.1f}")
    return ", ".join(said), f"{', '.join(off)} %"


def cycles(dataset: xarray.Dataset) -> Found:
    """The longest cycle and that after it: from an impact, or the uplift, to the next but one."""
    said = []
    for degrees, period in ((15, 7.0), (20, 4.0)):
        case = dataset.sel(period=period).sel(block_alpha=np.radians(degrees), method="nearest")
        times = np.r_[float(case["t_uplift"]), case["t_impact"].values[np.isfinite(case["t_impact"].values)]]
        lengths = times[2:] - times[:-2]
        first = int(lengths.argmax())
        said.append((lengths[first], lengths[first + 2]))
    off = max(abs(f - p) for f, p in zip(itertools.chain(*said), (2.11, 1.82, 1.39, 0.98), strict=True))
    return "; ".join(f"{a:.2f}, {b:.2f}" for a, b in said) + " s", f"up to {off:.2f} s"


def fates(dataset: xarray.Dataset) -> Found:
    """Up to which size the block of 10 degrees overturns, and what that of 20 degrees does."""
    period = dataset["period"].values
    over = dataset["outcome"].values >= 2
    ten, _, twenty = over
    said = f"10 deg: overturns up to {period[ten].max():g} s; 20 deg: overturns at {period[twenty].max():g} s, stable from {period[~twenty].min():g} s on"
    return said, "at the boundary: another processing of the record"


def friction(dataset: xarray.Dataset) -> Found:
    ratio = float(dataset["mu_required"]) / np.tan(0.25)
    return f"{ratio:.3f} tan(alpha)", f"{100.0 * (ratio / 2.0 - 1.0):+.1f} %"


def impulse(dataset: xarray.Dataset) -> Found:
    found = dataset["times_overturning"].values
    return f"{found.min():.3f} to {found.max():.3f}", between(float(found.min()), 1.525, 1.545)


def frame(dataset: xarray.Dataset) -> Found:
    gamma, alpha = dataset["gamma"].values, np.arctan(1.0 / 6.0)
    p = np.sqrt(0.75 * G / np.hypot(4.8, 0.8) * (1.0 + 2.0 * gamma) / (1.0 + 3.0 * gamma))
    eta = (1.0 - 1.5 * np.sin(alpha) ** 2 + 3.0 * gamma * np.cos(2.0 * alpha)) / (1.0 + 3.0 * gamma)
    off = max(
        float(np.abs(dataset["p"].values / p - 1.0).max()), float(np.abs(dataset["eta"].values / eta - 1.0).max())
    )
    return "equal", "none" if off < 1e-12 else f"{off:.0e}"


def sizes(dataset: xarray.Dataset) -> Found:
    """The amplitudes over alpha g that overturn, larger with the size and smaller with the duration."""
    found = dataset["times_overturning"].transpose("t1", "block_R").values
    assert (np.diff(found, axis=1) > 0.0).all()
    assert (np.diff(found, axis=0) < 0.0).all()
    p = np.sqrt(0.75 * G / dataset["block_R"].values)
    off = np.abs(found * -np.expm1(-p * dataset["t1"].values[:, None]) - 1.0).max()
    return f"{found.min():.3f} to {found.max():.3f}", "none" if off < 1e-6 else f"{off:.0e}"


def steady(dataset: xarray.Dataset) -> Found:
    """The amplitudes of steady rocking beside those of the closed form, which the study expects."""
    found = dataset["theta_peak_over_alpha"].values
    off = np.abs(found / (0.431060333331, 0.221203093843, 0.200777447045, 0.172218815485) - 1.0).max()
    return f"{', '.join(f'{value:.6f}' for value in found)}", "none" if off < 1e-9 else f"{off:.0e}"


def ends_of_steady(dataset: xarray.Dataset) -> Found:
    """What one per cent of the amplitude does at either limit of the symmetric steady state."""
    at_rest, rocks = (float(dataset["theta"].sel(case=f"{side} the first")[-1]) == 0.0 for side in ("below", "above"))
    near, far = dataset["theta_peak_over_alpha"].values[2:] / (0.6409576529, 0.6514437057) - 1.0
    assert at_rest
    assert not rocks
    return (
        f"by 1 % of A: comes to rest, rocks on; keeps within {100.0 * near:.1f} %, swings {100.0 * far:.0f} % farther to one side",
        "none",
    )


RIGID = "Makris and Roussos 2000"
SPECTRUM = "Makris and Konstantinidis 2003"
CYCLOIDS = "Zhang and Makris 2001"

ROWS = (
    Row(
        "Housner 1963, the scale effect",
        "constant acceleration for .15, .3, .6 s, R .5 to 8 m, linearized: over alpha g",
        "1/(1 - exp(-p t))",
        "housner-1963",
        sizes,
    ),
    Row(
        "Spanos and Koh 1984",
        "steady rocking under A cos(omega t), linearized: amplitude for (omega/p, A/(alpha g), eta) of (1.5, .3, .8), (3, 1, .9), (5, 4, .925), (8, 10, .9)",
        "closed form, derived anew",
        "spanos-koh-1984",
        steady,
    ),
    Row(
        "Hogan 1989",
        "limits of it, omega/p 3, eta .9: none below A = .12115 alpha g; not stable above 5.25440 alpha g",
        "closed forms, derived anew",
        "hogan-1989",
        ends_of_steady,
    ),
    Row(
        f"{RIGID}, Fig. 2",
        "half sine of 1 s, b .2 m, h .6 m, linearized",
        "stable at .5535 g, overturns at .5545 g",
        "makris-roussos-2000",
        threshold(0.5535, 0.5545, case="Fig. 2"),
    ),
    Row(
        f"{RIGID}, Fig. 9",
        "one sine of 1 s, b .5 m, h 1.5 m, linearized",
        ".4513 g, .4514 g",
        "makris-roussos-2000",
        threshold(0.4513, 0.4514, case="Fig. 9"),
    ),
    Row(
        f"{RIGID}, Fig. 11",
        "one cosine of 1 s, the same block, large rotations",
        ".6245 g, .6255 g",
        "makris-roussos-2000",
        threshold(0.6245, 0.6255, case="Fig. 11"),
    ),
    Row(
        f"{SPECTRUM}, Fig. 4",
        "one cosine of 2 s, p 2 rad/s, 15 deg",
        ".315 g, .316 g",
        "makris-konstantinidis-2003",
        threshold(0.315, 0.316),
    ),
    Row(
        f"{SPECTRUM}, Fig. 7",
        "longest cycles under Pacoima Dam: 15 deg, 2 pi/p 7 s; 20 deg, 4 s",
        "2.11, 1.82; 1.39, .98 s",
        "makris-konstantinidis-pacoima",
        cycles,
    ),
    Row(
        SPECTRUM,
        "Pacoima Dam: 2 pi/p of those that overturn",
        "10 deg: below 4 s; 20 deg: stable at 2 s",
        "makris-konstantinidis-pacoima",
        fates,
    ),
    Row(
        CYCLOIDS,
        "one sine of 2.5 Hz, p 2.14 rad/s, alpha .25: linearized, rigid",
        "3.24, 2.22 g",
        "zhang-makris-2001",
        amplitudes((3.24, 2.22), "model"),
    ),
    Row(
        f"{CYCLOIDS}, Figs 7, 8",
        "one sine, omega_p/p 5, amplitudes over alpha g: lowest, end of the first band, start of the second",
        "3.00-3.01, 6.32-6.33, 7.17-7.18",
        "zhang-makris-modes",
        bands,
    ),
    Row(
        CYCLOIDS,
        "omega_p/p at which mode 1 ends: alpha .25 linearized, rigid; .349 linearized, rigid",
        "6.59, 7.58; 4.7, 5.8 (off a plot)",
        "zhang-makris-mode-1",
        ends,
    ),
    Row(CYCLOIDS, "friction needed, one cosine of 6 alpha g", "about 2 tan(alpha)", "zhang-makris-friction", friction),
    Row(
        "Anooshehpoor et al. 1999",
        "one sine of 1, 1.5, 2 Hz on a train, eta .925 assumed",
        ".35, .5, 1.05 g",
        "anooshehpoor-1999",
        amplitudes((0.35, 0.50, 1.05), "f_p"),
    ),
    Row(
        "Nabeshima et al. 2016",
        "one sine over the critical double impulse, alpha .05 to .2",
        "1.53 to 1.54",
        "nabeshima-2016",
        impulse,
    ),
    Row("Makris and Vassiliou 2013", "rocking frame: eta and p by formula", "formulae", "rocking-frame", frame),
)


def line(row: Row, folder: Path, standing: dict[tuple[str, str], str]) -> str:
    """A row of the table; the one that stands in the page where the dataset is not there."""
    path = folder / row.study / f"{row.study}.nc"
    if not path.is_file():
        return standing.get((row.paper, row.what), f"| {row.paper} | {row.what} | {row.published} | not run | |")
    here, off = row.read(xarray.load_dataset(path))
    return f"| {row.paper} | {row.what} | {row.published} | {here} | {off} |"


def lines_of(folder: Path, table: str) -> list[str]:
    """The table anew, from the datasets there are and the table that stands."""
    cells = [
        [cell.strip() for cell in text.split("|")[1:3]] + [text] for text in table.splitlines() if text.startswith("|")
    ]
    standing = {(paper, what): text for paper, what, text in cells}
    return [*HEAD, *(line(row, folder, standing) for row in ROWS)]


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit("usage: python benchmarks/literature.py FOLDER_OF_RESULTS")
    write_section(PAGE, BEGIN, END, lines_of(Path(sys.argv[1]), section(PAGE, BEGIN, END)))
    print(f"wrote {PAGE}")


if __name__ == "__main__":
    main()
