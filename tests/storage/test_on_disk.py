"""Arrays in files: the same values, all of them looked at once, and no memory kept."""

from __future__ import annotations

import resource
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from rockcli.errors import OutputError
from rockcli.storage import on_disk
from rockcli.storage.on_disk import blocks, full, in_blocks, let_go, put, taken

SHAPES = [(), (0,), (1,), (5,), (100,), (3, 4), (4, 25), (25, 4), (7, 3, 11), (2, 3, 4, 5), (3, 0, 2)]


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(on_disk, "IN_MEMORY", 64)
    monkeypatch.setattr(on_disk, "BLOCK", 10)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("pitch", [1, 2, 3])
def test_blocks_cover_every_value_once(small: None, shape: tuple[int, ...], pitch: int) -> None:
    seen = np.zeros(shape, dtype=int)
    for at in blocks(shape, (pitch,) * len(shape)):
        seen[at] += 1
        assert seen[at].size <= max(10, 2 * pitch ** len(shape))
        assert all(part.start % pitch == 0 for part in at)
        assert all(part.stop % pitch == 0 or part.stop == n for part, n in zip(at, shape, strict=True))
    assert (seen == 1).all()


@pytest.mark.parametrize("shape", SHAPES)
def test_blocks_follow_the_values(small: None, shape: tuple[int, ...]) -> None:
    values = np.arange(np.prod(shape, dtype=int)).reshape(shape)
    found = [values[at].ravel() for at in in_blocks(values)]
    np.testing.assert_array_equal(np.concatenate([[], *found]), values.ravel())


@pytest.mark.parametrize(("fill", "dtype"), [(np.nan, float), (-2, np.int8), (True, bool), (0, np.int32)])
def test_a_large_array_is_one_of_one_value(small: None, tmp_path: Path, fill: float, dtype: type) -> None:
    for shape in ((7, 11), 3, (1, 65)):
        one, other = full(shape, fill, dtype, tmp_path), full(shape, fill, dtype, None)
        assert (type(one), one.dtype, one.shape) == (np.ndarray, other.dtype, other.shape)
        np.testing.assert_array_equal(one, other)
        one[..., 0] = 1
        let_go(one.reshape(-1))
        other[..., 0] = 1
        np.testing.assert_array_equal(one, other)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("shape", [(100,), (200, 3), (150, 90), (70, 5, 9)])
def test_blocks_are_taken_and_put_whole(small: None, tmp_path: Path, shape: tuple[int, ...]) -> None:
    wanted = np.random.default_rng(3).random(shape)
    values = full(shape, np.nan, float, tmp_path)
    for at in blocks(shape, (66,) * len(shape)):
        put(values, at, wanted[at])
        np.testing.assert_array_equal(taken(values, at), wanted[at])
    np.testing.assert_array_equal(values, wanted)


def shared() -> int:
    """Memory of this process that files stand behind [bytes]."""
    return int(Path("/proc/self/statm").read_text().split()[2]) * resource.getpagesize()


@pytest.mark.skipif(sys.platform != "linux", reason="asks Linux")
def test_memory_is_given_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    size = 1 << 25
    monkeypatch.setattr(on_disk, "IN_MEMORY", size - 1)
    before = shared()
    values = full(size, 0, np.int8, tmp_path)
    values += 1
    assert shared() - before > 0.9 * size
    let_go(values.reshape(2, -1)[1:])
    assert shared() - before < 0.1 * size
    for at in in_blocks(values):
        assert values[at].all()
    assert shared() - before < 0.1 * size


@pytest.fixture
def cramped() -> Iterator[None]:
    """No file may be longer than 4 kB."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_no_room_is_said_before_anything_is_solved(small: None, tmp_path: Path, cramped: None) -> None:
    with pytest.raises(OutputError, match="cannot be written in"):
        full(5000, 0, np.int8, tmp_path)
    with pytest.raises(OutputError, match="cannot be written in"):
        full(5000, 0, np.int8, tmp_path / "missing")
