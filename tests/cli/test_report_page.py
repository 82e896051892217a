"""`rock report`: one page that holds everything and needs nothing."""

from __future__ import annotations

import base64
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rockcli.cli.main import app
from rockcli.engine.run import solve
from rockcli.storage import netcdf
from rockcli.study.open import open_study

VOID = {"meta", "img", "br", "wbr"}


class Outline(HTMLParser):
    """Checks that tags are closed in order, and gathers text and what is loaded from elsewhere."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.words: list[str] = []
        self.outside: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in VOID:
            self.open.append(tag)
        self.outside += [v or "" for k, v in attrs if k in ("src", "href") and not (v or "").startswith("data:")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    study = {
        "name": "paged",
        "title": "Peaks < 1 & more",
        "case": {
            "block": {"R": 2.0, "tan_alpha": 0.2, "mu": 0.21},
            "motion": {"pulse": {"shape": "ricker", "a_p_over_g_tan_alpha": 3.6, "omega_p": "3*pi"}},
        },
        "vary": {"model": ["rigid", 3]},
        "expect": [
            {"quantity": "theta_peak_over_alpha", "at": {"model": "rigid"}, "max": 0.01},
            {"quantity": "eta", "min": 0.5},
        ],
    }
    path = tmp_path_factory.mktemp("report") / "paged.nc"
    netcdf.write(solve(open_study(study)), path)
    told = CliRunner().invoke(app, ["report", str(path)])
    assert told.exit_code == 0, told.output
    assert told.stdout.strip() == str(path.with_suffix(".html"))
    return path, path.with_suffix(".html").read_text(encoding="utf-8")


def test_the_page_is_whole_and_loads_nothing(written: tuple[Path, str]) -> None:
    outline = Outline()
    outline.feed(written[1])
    assert outline.open == []
    assert outline.outside == []
    assert "Peaks < 1 & more" in outline.words


def test_result_verdicts_reasons_study_and_provenance(written: tuple[Path, str]) -> None:
    outline = Outline()
    outline.feed(written[1])
    words = " ".join(outline.words)
    for expected in (
        "Expected: 1 of 2 met",
        "not met",
        "theta_peak_over_alpha at model=rigid <= 0.01",
        "tan_alpha: 0.2",
        "rtol: 1e-12",
        "numba",
    ):
        assert expected in words
    with netcdf_open(written[0]) as file:
        for sentence in set(file["reasons"][:]) - {""}:
            assert str(sentence) in words
        assert file.identity in words


def netcdf_open(path: Path):  # type: ignore[no-untyped-def]
    import netCDF4

    return netCDF4.Dataset(path)


def test_plots_are_pictures(written: tuple[Path, str]) -> None:
    codes = re.findall(r"data:image/png;base64,([A-Za-z0-9+/=]+)", written[1])
    assert len(codes) >= 2
    assert all(base64.b64decode(code).startswith(b"\x89PNG") for code in codes)


def test_wrong_targets(written: tuple[Path, str], tmp_path: Path) -> None:
    rock = CliRunner()
    for arguments in (
        [str(written[0]), "--out", str(written[0])],
        [str(tmp_path / "absent.nc")],
        [str(written[0]), str(written[0]), "--out", str(tmp_path / "a.html")],
    ):
        result = rock.invoke(app, ["report", *arguments])
        assert result.exit_code != 0
    netcdf.read(written[0])
