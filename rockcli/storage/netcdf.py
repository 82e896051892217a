"""Contents <-> netCDF-4 file, with the netCDF4 library alone."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import OutputError, StudyError
from rockcli.storage import checksum, on_disk
from rockcli.storage.atomic import replacing
from rockcli.storage.contents import AXES, POINTS, Contents, Field
from rockcli.storage.on_disk import blocks, full, let_go, put, taken
from rockcli.storage.places import reason, unnameable

_COMPRESSED_FROM = 4096
"""Values from which a variable is compressed (lossless)."""

_PIECE = 1 << 17
"""Values that are compressed together, at most: as many as stay in a fast memory."""

_SUMMED_BESIDE = 1 << 24
"""Size from which the checksum has a thread of its own, some 10 ms of work [bytes]."""

_SOON = 1 << 25
"""Size up to which commands that only read a dataset see whether it is intact, a tenth of a second [bytes]."""


def write(contents: Contents, path: Path) -> None:
    """Write a netCDF-4 file; `path` appears whole or not at all.

    Raises:
        OutputError: it cannot be written.
    """
    with replacing(path) as scratch:
        try:
            _write(contents, scratch)
        except (
            RuntimeError,
            OSError,
        ) as error:  # a system that refuses, in the library's words
            raise OutputError(f"cannot be written: {_why(scratch, error)}", file=path) from error


def _write(contents: Contents, scratch: Path) -> None:
    import netCDF4

    with _summed(contents) as digest, netCDF4.Dataset(scratch, "w", format="NETCDF4") as file:
        for name, size in contents.sizes.items():
            file.createDimension(name, size)
        for name, item in contents.fields.items():
            _write_field(file, contents, name, item)
        for name, value in (contents.attrs | {checksum.NAME: digest()} | contents.named_axes).items():
            file.setncattr_string(name, value)


@contextmanager
def _summed(contents: Contents) -> Iterator[Callable[[], str]]:
    """Give what tells the checksum; that of large contents is made while they are written."""
    if sum(item.values.nbytes for item in contents.fields.values()) < _SUMMED_BESIDE:
        yield lambda: checksum.checksum(contents)
        return
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(max_workers=1) as beside:
        yield beside.submit(checksum.checksum, contents).result


def _why(scratch: Path, error: RuntimeError | OSError) -> str:
    """Ask the system for what the library does not tell."""
    try:
        with scratch.open("ab") as file:
            file.write(bytes(65536))
            file.flush()
            os.fsync(file.fileno())
    except OSError as refused:
        return reason(refused)
    return reason(error) if isinstance(error, OSError) else f"no space or memory left, or the folder is gone ({error})"


def _write_field(file: Any, contents: Contents, name: str, item: Field) -> None:
    is_float = item.values.dtype.kind == "f"
    compressed = item.values.size >= _COMPRESSED_FROM and not item.is_text
    variable = file.createVariable(
        name,
        str if item.is_text else item.values.dtype,
        item.dims,
        fill_value=np.nan if is_float and not item.coordinate else False if not item.is_text else None,
        compression="zlib" if compressed else None,
        complevel=1,
        chunksizes=_piece_of(item.values.shape) if compressed else None,
    )
    for key, value in item.attrs.items():
        variable.setncattr(key, value)
    beside = [other for other, coord in contents.fields.items() if _is_auxiliary(other, coord, item)]
    if beside and not item.coordinate:
        variable.setncattr("coordinates", " ".join(beside))
    if item.is_text:
        variable[...] = item.values
        return
    for at in blocks(item.values.shape, _pitch(variable)):  # the library works on a copy
        variable[at or ...] = taken(item.values, at)
        let_go(item.values)


def _piece_of(shape: tuple[int, ...]) -> tuple[int, ...]:
    """The part of a variable that is compressed as one: whole rows, so that it is one piece in memory too."""
    piece: list[int] = []
    left = _PIECE
    for n in reversed(shape):
        piece.append(min(n, left))
        left = max(left // n, 1)
    return tuple(reversed(piece))


def _pitch(variable: Any) -> tuple[int, ...]:
    """What is compressed together, and so is written and read at once."""
    found = variable.chunking()
    return () if found == "contiguous" else tuple(found)


def _is_auxiliary(name: str, coordinate: Field, of: Field) -> bool:
    return coordinate.coordinate and coordinate.dims != (name,) and set(coordinate.dims) <= set(of.dims)


def read(path: Path) -> Contents:
    """Read a file this program wrote; `StudyError` if it is not one, or damaged so that it cannot be read."""
    checksum.note_opened(path)
    contents = _read(path)
    contents.attrs.pop(checksum.NAME, None)
    return contents


def is_intact(path: Path) -> bool | None:
    """Whether a dataset is as it was written; None for none, and for one without a checksum, of an earlier build."""
    try:
        here = path.stat()
    except OSError:
        return None
    return _is_intact(path, here.st_ino, here.st_size, here.st_mtime_ns)


def is_soon_told(path: Path) -> bool:
    """Whether `is_intact` takes but a moment: of a dataset of at most `_SOON` bytes of numbers."""
    try:
        with open_file(path) as file:
            numbers = (item for item in file.variables.values() if item.dtype is not str)
            return int(sum(item.size * item.dtype.itemsize for item in numbers)) <= _SOON
    except StudyError:
        return True


@lru_cache(maxsize=64)
def _is_intact(path: Path, *unchanged: int) -> bool | None:
    try:
        contents = _read(path)
    except StudyError:
        return False
    wanted = contents.attrs.get(checksum.NAME)
    return None if wanted is None else wanted == checksum.checksum(contents)


@contextmanager
def open_file(path: Path) -> Iterator[Any]:
    """Give an open netCDF4 file; `StudyError` if it is not one this program wrote, or damaged where it is read."""
    import netCDF4

    try:
        file = netCDF4.Dataset(path, "r")
    except OSError as error:
        raise StudyError(no_dataset(path) or f"cannot be opened as netCDF: {error.strerror or error}", path) from None
    except Exception as error:  # the library has many words for bytes that mean nothing
        raise StudyError(no_dataset(path) or f"is damaged: {error}", file=path) from None
    with file:
        try:
            names = set(file.ncattrs())
        except Exception as error:  # long attributes are kept apart, where damage is met only now
            raise StudyError(f"is damaged: {error}", file=path) from None
        if not {AXES, "identity"} <= names:
            raise StudyError("is not a dataset written by `rock run`", file=path)
        yield file


def no_dataset(path: Path) -> str:
    """What a file is instead of a dataset, and what to type; "" where that is not to be seen."""
    if path.is_dir():
        return "is a folder; give the dataset in it (<name>.nc)"
    if not path.exists():
        return "no such file"
    if path.suffix.lower() in (".yaml", ".yml"):
        return f"is a study, not a dataset: `rock run {path}` makes one, results/NAME/NAME.nc"
    if path.is_file() and path.suffix.lower() not in (".nc", ".nc4", ""):
        return f"is no dataset: one that `rock run` wrote is expected, NAME.nc, not *{path.suffix}"
    if path.is_file() and not path.stat().st_size:
        return "is empty: a dataset that `rock run` wrote is expected"
    return unnameable(path.absolute())


def _read(path: Path) -> Contents:
    with open_file(path) as file:
        try:
            file.set_auto_mask(False)
            attrs = {name: str(file.getncattr(name)) for name in file.ncattrs()}
            axes = tuple(attrs.pop(AXES).split())
            attrs.pop(POINTS, None)  # none in those of earlier builds
            listed = {c for v in file.variables.values() for c in getattr(v, "coordinates", "").split()}
            room = path.parent if os.access(path.parent, os.W_OK) else Path(tempfile.gettempdir())
            fields = {name: _read_field(each, name, listed, room) for name, each in file.variables.items()}
        except OutputError:
            raise
        except Exception as error:
            raise StudyError(f"is damaged: {error}", file=path) from None
    return Contents(axes, fields, attrs)


def _read_field(variable: Any, name: str, listed: set[str], room: Path) -> Field:
    kept = [key for key in variable.ncattrs() if key not in ("_FillValue", "coordinates")]
    dims = tuple(variable.dimensions)
    values = _read_values(variable, room)
    return Field(dims, values, {k: variable.getncattr(k) for k in kept}, name in listed or dims == (name,))


def _read_values(variable: Any, room: Path) -> NDArray[Any]:
    if variable.dtype is str or variable.size * variable.dtype.itemsize <= on_disk.IN_MEMORY:
        return np.asarray(variable[...])
    values = full(variable.shape, 0, variable.dtype, room)
    for at in blocks(variable.shape, _pitch(variable)):
        put(values, at, np.asarray(variable[at]))
    return values


def identity(path: Path) -> str | None:
    """Identity of the results in a file; None if there is no such file or it is not a dataset of this program."""
    import netCDF4

    try:
        with netCDF4.Dataset(path, "r") as file:
            return str(file.getncattr("identity"))
    except Exception:  # whatever the library says of bytes that mean nothing
        return None
