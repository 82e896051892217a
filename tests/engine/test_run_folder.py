"""What stands in a result folder: whole or nothing, the right study, one process at a time."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from handmade import MODEL, SLENDER, answer, clause, make_study, solve_by

from rockcli.cli.sources import study_files
from rockcli.engine.lock import LOCK_NAME, locked
from rockcli.engine.run import run_study
from rockcli.engine.summary import SOLVED, UP_TO_DATE, RunReport, exit_code
from rockcli.errors import StudyError
from rockcli.scene.batch import Batch
from rockcli.scene.response import Response
from rockcli.storage import netcdf
from rockcli.storage.read import open_dataset


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Sizes of the batches a hand-made solver was given."""
    sizes: list[int] = []

    def solver(batch: Batch) -> Response:
        sizes.append(batch.size)
        return answer(batch)

    solve_by(monkeypatch, solver)
    return sizes


def names(folder: Path) -> list[str]:
    return sorted(file.name for file in folder.iterdir())


def test_a_finished_study_is_not_run_twice(tmp_path: Path, calls: list[int]) -> None:
    study = make_study(SLENDER, MODEL)
    first = run_study(study, tmp_path, plots=False)
    before = (tmp_path / "made" / "made.nc").read_bytes()
    second = run_study(study, tmp_path, plots=False)
    assert (first.status, second.status, calls) == (SOLVED, UP_TO_DATE, [6])
    assert (tmp_path / "made" / "made.nc").read_bytes() == before
    assert names(tmp_path / "made") == ["made.nc"]
    assert second.outcomes == {"rocking": 6}
    assert (second.peak, second.peak_at) == (0.05, "tan_alpha=0.3, model=linearized")


def test_words_and_comparisons_are_renewed_without_solving(tmp_path: Path, calls: list[int]) -> None:
    study = make_study(SLENDER, MODEL)
    run_study(study, tmp_path, plots=False)
    other = replace(
        study,
        title="A better title",
        resolved_yaml="name: made\ntitle: A better title\n",
        compare_to={"model": "rigid"},
        expect=(clause("error_theta_peak_over_alpha", "max", 0.02),),
    )
    report = run_study(other, tmp_path, plots=False)
    assert (report.status, report.unmet, calls) == (UP_TO_DATE, 0, [6])
    found = open_dataset(tmp_path / "made" / "made.nc")
    assert found.attrs["title"] == "A better title"
    assert "error_theta_peak_over_alpha" in found
    back = run_study(study, tmp_path, plots=False)
    assert back.status == UP_TO_DATE
    assert "same_outcome" not in open_dataset(tmp_path / "made" / "made.nc")


def test_other_results_are_refused_unless_fresh(tmp_path: Path, calls: list[int]) -> None:
    study = make_study(SLENDER)
    run_study(study, tmp_path, plots=False)
    other = replace(study, identity="another")
    with pytest.raises(StudyError, match="--fresh"):
        run_study(other, tmp_path, plots=False)
    assert netcdf.identity(tmp_path / "made" / "made.nc") == "abc"
    assert run_study(other, tmp_path, fresh=True, plots=False).status == SOLVED
    assert netcdf.identity(tmp_path / "made" / "made.nc") == "another"
    assert len(calls) == 2


def test_a_foreign_file_is_refused(tmp_path: Path, calls: list[int]) -> None:
    (tmp_path / "made").mkdir()
    (tmp_path / "made" / "made.nc").write_text("mine")
    with pytest.raises(StudyError, match="not a dataset"):
        run_study(make_study(), tmp_path, plots=False)
    assert not calls


def test_an_interrupted_run_leaves_nothing_half_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def solver(batch: Batch) -> Response:
        raise KeyboardInterrupt

    solve_by(monkeypatch, solver)
    with pytest.raises(KeyboardInterrupt):
        run_study(make_study(SLENDER), tmp_path, plots=False)
    assert names(tmp_path / "made") == []


def test_a_held_folder_is_refused(tmp_path: Path, calls: list[int]) -> None:
    with locked(tmp_path / "made"), pytest.raises(StudyError, match="another process"):
        run_study(make_study(), tmp_path, plots=False)
    assert not calls
    assert run_study(make_study(), tmp_path, plots=False).status == SOLVED


def test_a_lock_dies_with_its_process(tmp_path: Path) -> None:
    hold = (
        "import os, pathlib, sys\nfrom rockcli.engine.lock import locked\n"
        "with locked(pathlib.Path(sys.argv[1])):\n    os._exit(0)\n"
    )
    subprocess.run([sys.executable, "-c", hold, str(tmp_path)], check=True)
    assert (tmp_path / LOCK_NAME).exists()  # the file stays, the lock does not
    with locked(tmp_path):
        pass
    assert names(tmp_path) == []


def test_an_expected_failure_does_not_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def solver(batch: Batch) -> Response:
        if 2.0 in batch.theta_0:
            raise ValueError("no")
        return answer(batch)

    solve_by(monkeypatch, solver)
    study = make_study(SLENDER)
    failed = run_study(study, tmp_path, plots=False)
    assert (failed.failed, failed.exit_code) == (1, 3)
    wanted = replace(study, expect=(clause("outcome", "is", (-2,), at={"tan_alpha": 0.3}),))
    report = run_study(wanted, tmp_path, plots=False)
    assert (report.failed, report.exit_code) == (0, 0)
    assert list(report.reasons.values()) == [1]


def test_the_first_exit_code_that_applies() -> None:
    good, lost = RunReport("a", SOLVED), RunReport("b", SOLVED, failed=1)
    assert exit_code([good, good]) == 0
    assert exit_code([good, lost]) == 3


def test_the_dataset_carries_its_provenance(tmp_path: Path, calls: list[int]) -> None:
    study = make_study(
        SLENDER, inputs={"x.AT2": "00ff"}, processing={"x.AT2": ("detrended",)}, references="Fig. 1", warnings=("mind",)
    )
    report = run_study(study, tmp_path, plots=False)
    attrs = open_dataset(tmp_path / "made" / "made.nc").attrs
    assert attrs["study"] == "name: made\n"
    assert attrs["references"] == "Fig. 1"
    assert attrs["inputs"] == '{"x.AT2": "00ff"}'
    assert attrs["backends"] == "hand"
    assert "detrended" in attrs["processing"]
    assert '"numpy"' in attrs["versions"]
    assert report.warnings == ("mind",)


def test_a_study_is_run_once_whatever_leads_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a").mkdir()
    first, other = tmp_path / "a" / "x.yaml", tmp_path / "a" / "y.yaml"
    first.write_text("name: x\n")
    other.write_text("name: y\n")
    (tmp_path / "link.yaml").symlink_to(first)
    monkeypatch.chdir(tmp_path)
    given = [Path("a/y.yaml"), first, Path("a"), Path("a/../a/x.yaml"), Path("link.yaml"), Path("a/y.yaml")]
    assert study_files(given) == [Path("a/y.yaml"), first]
