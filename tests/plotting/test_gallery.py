"""The gallery of docs/plots.md has every kind of plot, each drawn from a study of the project."""

from __future__ import annotations

import importlib.util
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from rockcli.plotting.figures import KINDS

ROOT = Path(__file__).resolve().parents[2]

_spec = importlib.util.spec_from_file_location("docs_gallery", ROOT / "docs" / "tools" / "gallery.py")
gallery = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(gallery)


def test_every_kind_has_its_picture_and_no_other_is_there():
    assert [*gallery.PICTURES] == [*KINDS]
    assert {path.name for path in gallery.FOLDER.iterdir()} == {f"{kind}.png" for kind in KINDS}


def test_the_page_lists_what_is_drawn():
    text = gallery.PAGE.read_text(encoding="utf-8")
    assert text == gallery.page(text), "run python docs/tools/gallery.py"


@pytest.mark.parametrize(("kind", "picture"), gallery.PICTURES.items(), ids=gallery.PICTURES)
def test_a_picture_is_of_a_study_and_small(kind, picture):
    assert (ROOT / "studies" / picture.study).is_file()
    path = gallery.FOLDER / f"{kind}.png"
    assert path.stat().st_size < 30_000
    with Image.open(path) as shown:
        assert shown.width == int(picture.width / 25.4 * 110)


def ink(shown: Image.Image) -> float:
    """Share of a picture that is not white."""
    return float((np.asarray(shown.convert("L")) < 250).mean())


@pytest.mark.parametrize("kind", ["phase", "polar", "body"])
def test_a_picture_is_drawn_anew_as_it_is_there(kind):
    with Image.open(BytesIO(gallery.drawn(kind))) as anew, Image.open(gallery.FOLDER / f"{kind}.png") as there:
        assert anew.width == there.width
        assert anew.height == pytest.approx(
            there.height, rel=0.03
        )  # versions of Matplotlib lay figures out differently
        assert ink(anew) == pytest.approx(ink(there), rel=0.1)
