"""Arrays too large for memory: each in a nameless file, of which no more is in memory than is worked on."""

from __future__ import annotations

import mmap
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from rockcli.errors import OutputError
from rockcli.storage.places import reason

IN_MEMORY = 1 << 26
"""Size up to which an array is kept in memory, wherever it might lie [bytes]."""

BLOCK = 1 << 20
"""Values of an array that are worked on at a time."""

_ROWS = 64
"""Parts of rows brought in at a time."""

Block = tuple[slice, ...]


def full(shape: int | tuple[int, ...], fill: Any, dtype: DTypeLike, folder: Path | None) -> NDArray[Any]:
    """An array of one value; a large one lies in a file without a name, which goes with the process.

    Args:
        shape, fill, dtype: as of `numpy.full`; fill None: nothing in particular, and memory is taken as it is set.
        folder: where the file may lie; None = in memory, whatever the size.

    Raises:
        OutputError: there is no room in the folder.  (The file is written, not only made long: memory that is mapped to
            what a disk turns out not to have ends the process.)
    """
    dtype = np.dtype(dtype)
    size = int(np.prod(shape, dtype=np.int64))
    if folder is None or size * dtype.itemsize <= IN_MEMORY:
        return np.empty(shape, dtype=dtype) if fill is None else np.full(shape, fill, dtype=dtype)
    piece = np.full(min(size, BLOCK), 0 if fill is None else fill, dtype=dtype).data
    try:
        with tempfile.TemporaryFile(dir=folder) as file:
            for first in range(0, size, BLOCK):
                file.write(piece[: size - first])
            file.flush()
            return np.asarray(np.memmap(file, dtype=dtype, mode="r+", shape=shape))
    except OSError as error:
        raise OutputError(f"cannot be written in: {reason(error)}", file=folder) from error


def let_go(*arrays: NDArray[Any]) -> None:
    """Give back the memory of arrays, or of what they are views of, that lie in files; nothing is lost."""
    for each in arrays:
        held: Any = each
        while isinstance(held, np.ndarray) and not isinstance(held, np.memmap):
            held = held.base
        if isinstance(held, np.memmap) and hasattr(mmap, "MADV_DONTNEED"):
            held._mmap.madvise(mmap.MADV_DONTNEED)  # type: ignore[attr-defined]


def taken(values: NDArray[Any], at: Block) -> NDArray[Any]:
    """A block of an array, a copy where it is not one piece: with parts of rows the system brings in what is beside."""
    part = values[at]
    if part.flags.c_contiguous:
        return part
    copy = np.empty(part.shape, dtype=part.dtype)
    for first in range(0, len(part), _ROWS):
        copy[first : first + _ROWS] = part[first : first + _ROWS]
        let_go(values)
    return copy


def put(values: NDArray[Any], at: Block, block: NDArray[Any]) -> None:
    """Set a block of an array, in the way of `taken`."""
    part = values[at]
    for first in range(0, len(part), _ROWS):
        part[first : first + _ROWS] = block[first : first + _ROWS]
        let_go(values)


def in_blocks(*arrays: NDArray[Any]) -> Iterator[Block]:
    """Blocks that cover arrays of one shape in the order of their values; what was worked on is let go."""
    for at in blocks(arrays[0].shape):
        yield at
        let_go(*arrays)


def blocks(shape: tuple[int, ...], pitch: tuple[int, ...] = (), most: int = 0) -> Iterator[Block]:
    """Blocks that cover a shape, of some values each; one that is empty where there is no dimension.

    Args:
        shape: of an array.
        pitch: numbers of rows along every dimension of which each block has a multiple, but for the last; () = of one:
            blocks then follow the order of the values.
        most: values of a block, but for what goes together; 0 = `BLOCK`.
    """
    return _blocks(shape, pitch or (1,) * len(shape), most or BLOCK)


def _blocks(shape: tuple[int, ...], pitch: tuple[int, ...], most: int) -> Iterator[Block]:
    if not shape:
        yield ()
        return
    each = pitch[0]
    inner = int(np.prod(shape[1:], dtype=np.int64))
    rows = max(most // max(each * inner, 1), 1) * each
    for first in range(0, shape[0], rows):
        row = slice(first, min(first + rows, shape[0]))
        if each * inner > most:
            for rest in _blocks(shape[1:], pitch[1:], most // each):
                yield (row, *rest)
        else:
            yield (row, *(slice(0, n) for n in shape[1:]))
