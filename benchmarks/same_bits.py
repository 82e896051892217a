"""Whether two installations of the program write the same numbers, bit for bit: for changes that are to change none.

    python benchmarks/same_bits.py ROCK_BEFORE [STUDY|FOLDER ...] [--keep FOLDER]

ROCK_BEFORE is the `rock` of the other installation, of another checkout's environment for instance.  Both solve every
study (default: all of studies/ but the full meshes; those without their record are skipped) and every variable and
coordinate of the two datasets is compared as bytes, NaN with NaN, but `wall_time`.  Printed are the studies of which
the numbers differ, with each variable and its largest difference, the variables only one of them has, and the counts.
With --keep the datasets stay in FOLDER, and those that are there already are not solved again.

The exit code is 1 if a number that both have differs, else 0.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

ROOT = Path(__file__).resolve().parents[1]
AFTER = Path(sys.executable).with_name("rock")
TIMES = {"wall_time"}
"""Variables that no two runs share."""


def main() -> None:
    """Solve, compare, print."""
    words = sys.argv[1:]
    if not words:
        sys.exit(__doc__)
    before, given = words[0], words[1:]
    with tempfile.TemporaryDirectory() as own:
        kept = Path(own)
        if "--keep" in given:
            place = given.index("--keep")
            kept = Path(given[place + 1])
            del given[place : place + 2]
        counts = {"studies": 0, "variables": 0, "values": 0, "differ": 0}
        for study in studies([Path(name) for name in given] or [ROOT / "studies"]):
            pair = [dataset(rock, study, kept / side) for rock, side in ((before, "before"), (str(AFTER), "after"))]
            if None in pair:
                print(f"{study.name}: {['no dataset', 'a dataset'][pair[0] is not None]} before, "
                      f"{['none', 'one'][pair[1] is not None]} after")  # fmt: skip
                continue
            counts["studies"] += 1
            with (
                xr.open_dataset(pair[0], decode_times=False) as old,
                xr.open_dataset(pair[1], decode_times=False) as new,
            ):  # type: ignore[arg-type]
                for sentence in differences(old, new, counts):
                    print(f"{study.name}: {sentence}", flush=True)
    print(", ".join(f"{n} {name}" for name, n in counts.items()))
    sys.exit(int(counts["differ"] > 0))


def studies(places: list[Path]) -> Iterator[Path]:
    """Studies in files and folders; full meshes only where they are named, as they take an hour."""
    for place in places:
        yield from [place] if place.is_file() else sorted(p for p in place.rglob("*.yaml") if "mesh" not in p.parts)


def dataset(rock: str, study: Path, out: Path) -> Path | None:
    """What `rock` makes of a study, in a folder of the study's own as names may repeat; None if it makes none."""
    out = out / "_".join(study.resolve().with_suffix("").parts[-2:])
    found = sorted(out.rglob("*.nc"))
    if not found:
        options = ["--out", str(out), "--no-plots", "--quiet", "--skip-missing", "--fresh"]
        subprocess.run([rock, "run", str(study), *options], capture_output=True, check=False)
        found = sorted(out.rglob("*.nc"))
    return found[0] if found else None


def differences(old: xr.Dataset, new: xr.Dataset, counts: dict[str, int]) -> Iterator[str]:
    """Sentences on what differs; counts what was compared."""
    for side, names in (
        ("before", set(old.variables) - set(new.variables)),
        ("now", set(new.variables) - set(old.variables)),
    ):
        if names:
            yield f"only {side}: {', '.join(sorted(map(str, names)))}"
    for name in sorted(map(str, (set(old.variables) & set(new.variables)) - TIMES)):
        a, b = old[name].values, new[name].values
        counts["variables"] += 1
        counts["values"] += a.size
        if a.dtype == b.dtype and a.shape == b.shape and same(a, b):
            continue
        counts["differ"] += 1
        yield f"{name} differs: {how_much(a, b)}"


def same(a: np.ndarray, b: np.ndarray) -> bool:
    """Equal as bytes, or as text; all NaN are one."""
    if a.dtype.kind != "f":
        return bool(np.array_equal(a, b))
    nan = np.isnan(a)
    return bool(np.array_equal(nan, np.isnan(b)) and a[~nan].tobytes() == b[~nan].tobytes())


def how_much(a: np.ndarray, b: np.ndarray) -> str:
    """The size of a difference in words."""
    if a.dtype.kind not in "fiu" or b.dtype.kind not in "fiu":
        return "text"
    if a.shape != b.shape:
        return f"shape {a.shape} and {b.shape}"
    a, b = a.astype(float), b.astype(float)
    both = np.isfinite(a) & np.isfinite(b)
    apart = ~((a == b) | (np.isnan(a) & np.isnan(b)))
    largest = np.abs(a - b)[both].max(initial=0.0)
    return f"{apart.sum()} of {a.size} values, by up to {largest:.3g}, {(apart & ~both).sum()} in what is finite"


if __name__ == "__main__":
    main()
