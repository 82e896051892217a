#!/usr/bin/env python3
"""Draws a picture of every kind of plot from a study of the project, into docs/gallery, and lists them in docs/plots.md.

    python docs/tools/gallery.py [KIND ...]

Without kinds, all are drawn, which takes a minute or two.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import xarray

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "docs" / "gallery"
PAGE = ROOT / "docs" / "plots.md"
MADE = "<!-- from here made by docs/tools/gallery.py -->\n"

os.environ.setdefault("ROCK_RECORDS", str(ROOT / "records"))


class Picture(NamedTuple):
    """The study of a picture, below studies/, how wide the picture is [mm], and what else is asked of `rockcli.plot`."""

    study: str
    width: float = 120.0
    options: Mapping[str, Any] = MappingProxyType({})


PICTURES: dict[str, Picture] = {
    "histories": Picture("objects/sliding.yaml"),
    "motion": Picture("examples/record.yaml"),
    "bending": Picture("seed/fig64.yaml"),
    "phase": Picture("examples/first_rock.yaml"),
    "map": Picture("gallery/boundaries.yaml"),
    "curve": Picture("gallery/curve.yaml"),
    "ranking": Picture("tutorials/cabinets.yaml", options={"select": {"through": "roof", "pga": "0.45g"}}),
    "polar": Picture("objects/direction.yaml", options={"select": {"scale": 0.8}}),
    "boundaries": Picture("gallery/boundaries.yaml"),
    "ida": Picture("suites/balanced_rock.yaml"),
    "fragility": Picture("suites/balanced_rock.yaml"),
    "intensities": Picture("suites/two_intensities.yaml"),
    "risk": Picture("suites/balanced_rock.yaml"),
    "samples": Picture("suites/uncertain.yaml"),
    "spectrum": Picture("suites/rocking_spectrum.yaml"),
    "work_precision": Picture("examples/first_rock.yaml"),
    "body": Picture("objects/statue.yaml"),
    "barriers": Picture("objects/boulder.yaml"),
    "curves": Picture("seed/fig21.yaml"),
}
"""One of every kind."""

MEASURED = "work_precision"
"""The kind that is drawn from what `rock trade` measures; the others from what `rock run` solves."""


def dataset(kind: str) -> xarray.Dataset:
    """What the picture of a kind is drawn from."""
    import rockcli

    study = ROOT / "studies" / PICTURES[kind].study
    if kind != MEASURED:
        return rockcli.run(study)
    from tempfile import TemporaryDirectory

    from rockcli.cli.main import app

    with TemporaryDirectory() as folder:
        app(["trade", str(study), "--budget", "20s", "--out", folder, "--no-plots", "--quiet"], standalone_mode=False)
        (path,) = Path(folder).rglob("*.nc")
        return rockcli.open_dataset(path).load()


def drawn(kind: str, source: xarray.Dataset | None = None) -> bytes:
    """A picture as PNG, at the resolution of a screen and in 128 colours, which suffice."""
    from PIL import Image

    import rockcli

    picture = PICTURES[kind]
    figure = rockcli.plot(dataset(kind) if source is None else source, kind, width=picture.width, **picture.options)
    shown = Image.open(BytesIO(figure._repr_png_())).convert("RGB")  # type: ignore[attr-defined]
    small = BytesIO()
    shown.quantize(128, method=Image.Quantize.MAXCOVERAGE).save(small, format="png", optimize=True)
    return small.getvalue()


def listed() -> str:
    """The gallery in Markdown."""
    from rockcli.plotting.figures import KINDS

    parts = []
    for kind, picture in PICTURES.items():
        chosen = "".join(f" --select {axis}={value}" for axis, value in picture.options.get("select", {}).items())
        command = "trade" if kind == MEASURED else "run"
        parts.append(
            f"### {kind}\n\n{KINDS[kind].sentence[0].upper()}{KINDS[kind].sentence[1:]}.\n\n"
            f"![{kind}: {KINDS[kind].sentence.replace('`', '')}](gallery/{kind}.png)\n\n"
            f"`rock {command}` [{picture.study}](../studies/{picture.study}), `--kind {kind}{chosen} --width {picture.width:g}`\n"
        )
    return "\n".join(parts)


def page(text: str) -> str:
    """The page with its gallery as it is to be."""
    return f"{text.partition(MADE)[0]}{MADE}\n{listed()}"


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for each in sys.argv[1:] or PICTURES:
        (FOLDER / f"{each}.png").write_bytes(drawn(each))
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
