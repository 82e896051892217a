"""Records read by several processes: the same study, the same errors, whatever becomes of the processes."""

from __future__ import annotations

import os
import signal

import numpy as np
import pytest

from rockcli.errors import RecordError
from rockcli.forks import FORKS, shared_out
from rockcli.motion.at2 import at2_text
from rockcli.study.building import records
from rockcli.study.open import open_study

pytestmark = pytest.mark.skipif(not FORKS, reason="processes are forked on Linux alone")


@pytest.fixture
def suite(tmp_path, monkeypatch):
    """A study of nine records, which are enough for several processes here."""
    monkeypatch.setattr(records, "MANY", 4)
    rng = np.random.default_rng(4)
    for k in range(9):
        text = at2_text(0.3 * rng.standard_normal(200 + k), 0.01, ["synthetic", "test"])
        (tmp_path / f"r{k}.AT2").write_text(text, encoding="ascii")
    study = tmp_path / "study.yaml"
    study.write_text(
        "name: many\ncase: {block: {R: 2, tan_alpha: 0.2}, motion: {record: {highpass: 0.1, pga: 0.5*g}}}\n"
        'vary: {motion.record.file: "*.AT2"}\nsave: {histories: false}\n',
        encoding="utf-8",
    )
    return study


def motions(study):
    ((_, batch),) = study.suites(np.arange(study.size))
    return batch.excitation.suite


def test_the_same_study_whoever_reads(suite):
    alone, together = open_study(suite), open_study(suite, readers=3)
    assert together.identity == alone.identity
    assert together.inputs == alone.inputs
    assert len(together.inputs) == 9
    assert together.processing == alone.processing
    assert together.warnings == alone.warnings
    for one, other in zip(motions(alone).records, motions(together).records, strict=True):
        np.testing.assert_array_equal(one.values, other.values)
        assert one.measures == other.measures
    np.testing.assert_array_equal(motions(alone).factor, motions(together).factor)


def test_others_read_too(suite, monkeypatch):
    here = []
    monkeypatch.setattr(records.Records, "_read", noting(here, records.Records._read))
    open_study(suite, readers=3)
    assert len(here) == 3


def noting(here, read):
    def note(self, name, path, reading):
        here.append(name)
        return read(self, name, path, reading)

    return note


def test_a_file_that_is_wrong_is_told_as_by_one_process(suite):
    """Whether this process has it or another one."""
    for k in (0, 4):
        path = suite.parent / f"r{k}.AT2"
        before = path.read_text(encoding="ascii")
        path.write_text(before.replace("E-01", "E-0x", 1), encoding="ascii")
        told = []
        for readers in (1, 2):
            with pytest.raises(RecordError) as error:
                open_study(suite, readers=readers)
            told.append(str(error.value))
        assert told[0] == told[1]
        assert path.name in told[0]
        path.write_text(before, encoding="ascii")


def test_what_is_shared_out_comes_back_in_order():
    def work(k):
        return k, np.arange(k, dtype=float), os.getpid()

    found = shared_out(work, range(7), 3)
    assert [number for number, _, _ in found] == list(range(7))
    for number, values, _ in found:
        np.testing.assert_array_equal(values, np.arange(number))
        values[:] = 0.0  # ours to write to
    assert len({process for _, _, process in found}) == 3


def test_what_is_raised_and_who_dies_leave_nothing():
    this = os.getpid()

    def work(k):
        if k == 2:
            raise ValueError
        if k == 3 and os.getpid() != this:
            os.kill(os.getpid(), signal.SIGKILL)
        return k

    assert shared_out(work, range(6), 2) == [0, None, None, None, 4, None]
    assert shared_out(work, range(3), 1) == [0, 1, None]


def test_an_interrupt_ends_all(monkeypatch):
    this, fork, children = os.getpid(), os.fork, []
    monkeypatch.setattr(os, "fork", lambda: children.append(fork()) or children[-1])

    def work(k):
        if os.getpid() == this:
            raise KeyboardInterrupt
        signal.pause()

    with pytest.raises(KeyboardInterrupt):
        shared_out(work, range(4), 3)
    assert len(children) == 2
    for child in children:
        with pytest.raises(ProcessLookupError):
            os.kill(child, 0)
