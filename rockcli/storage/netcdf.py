"""Contents <-> netCDF-4 file, with the netCDF4 library alone."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import OutputError, StudyError, is_file
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
    with Writer(path) as file:
        file.finish(contents)


class _Rest:
    """What is left to be written of a variable: blocks of its values, of some values each, the first one last."""

    def __init__(self, variable: Any, values: NDArray[Any], most: int = 0) -> None:
        self.variable, self.values = variable, values
        self.blocks = list(blocks(values.shape, _pitch(variable), most))[::-1]

    def next_is_known(self, n: int) -> bool:
        """Whether the next block is among the first n values."""
        last = [part.stop - 1 for part in self.blocks[-1]] if self.blocks else []
        return bool(last) and int(np.ravel_multi_index(last, self.values.shape)) < n

    def write_next(self) -> None:
        """Write the next block."""
        at = self.blocks.pop()
        self.variable[at or ...] = taken(self.values, at)  # the library works on a copy
        let_go(self.values)


class Writer:
    """A file that is being written: its large variables while their values are found, all others in the end.

    `path` appears whole, when it is finished, or not at all.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._held = ExitStack()
        self._scratch: Path | None = None
        self._file: Any = None
        self._made: dict[str, Any] = {}
        self._rests: dict[str, _Rest] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *raised: Any) -> None:
        self._close()
        self._held.__exit__(*raised)

    def begin(self, fields: Mapping[str, Field]) -> None:
        """Make the first variables of the file; the values of those that are compressed come later, in this memory.

        What hinders it is told in the end, if it still does then.
        """
        try:
            self._open()
            for item in fields.values():
                self._make_dimensions(dict(zip(item.dims, item.values.shape, strict=True)))
            self._made = {name: _variable(self._file, name, item) for name, item in fields.items()}
            for name, variable in self._made.items():
                if not fields[name].coordinate and _pitch(variable):
                    self._rests[name] = _Rest(variable, fields[name].values, _PIECE)
        except (RuntimeError, OSError, OutputError):
            self._forget()

    def write_known(self, n: int) -> None:
        """Write a piece of each variable that was begun, where it is among their first n values, known by now."""
        try:
            for rest in self._rests.values():
                if rest.next_is_known(n):
                    rest.write_next()
        except (RuntimeError, OSError):
            self._forget()

    def finish(self, contents: Contents) -> None:
        """Write all that is left.

        Raises:
            OutputError: it cannot be written.
        """
        if not self._goes_on_with(contents):
            self._forget()
        try:
            self._open()
            self._write(contents)
            self._file.close()
        except (RuntimeError, OSError) as error:  # a system that refuses, in the library's words
            why = _why(self._scratch or self._path, error)
            raise OutputError(f"cannot be written: {why}", file=self._path) from error
        self._file = None
        self._held.close()

    def _goes_on_with(self, contents: Contents) -> bool:
        """Whether contents begin with the variables there are, those of which values are written in the same memory."""
        values = {name: contents.fields[name].values for name in self._rests.keys() & contents.fields.keys()}
        return list(contents.fields)[: len(self._made)] == list(self._made) and all(
            values[name].__array_interface__ == rest.values.__array_interface__ for name, rest in self._rests.items()
        )

    def _write(self, contents: Contents) -> None:
        with _summed(contents) as digest:
            self._make_dimensions(contents.sizes)
            for name, item in contents.fields.items():
                self._write_field(contents, name, item)
            for name, value in (contents.attrs | {checksum.NAME: digest()} | contents.named_axes).items():
                self._file.setncattr_string(name, value)

    def _write_field(self, contents: Contents, name: str, item: Field) -> None:
        variable = self._made[name] if name in self._made else _variable(self._file, name, item)
        for key, value in item.attrs.items():
            variable.setncattr(key, value)
        beside = [other for other, coord in contents.fields.items() if _is_auxiliary(other, coord, item)]
        if beside and not item.coordinate:
            variable.setncattr("coordinates", " ".join(beside))
        if item.is_text:
            variable[...] = item.values
            return
        rest = self._rests[name] if name in self._rests else _Rest(variable, item.values)
        while rest.blocks:
            rest.write_next()

    def _open(self) -> None:
        import netCDF4

        if self._scratch is None:
            self._scratch = self._held.enter_context(replacing(self._path))
        if self._file is None:
            self._file = netCDF4.Dataset(self._scratch, "w", format="NETCDF4")

    def _make_dimensions(self, sizes: Mapping[str, int]) -> None:
        for name, size in sizes.items():
            if name not in self._file.dimensions:
                self._file.createDimension(name, size)

    def _forget(self) -> None:
        """Begin anew."""
        self._close()
        self._made, self._rests = {}, {}

    def _close(self) -> None:
        if self._file is not None:
            with contextlib.suppress(RuntimeError, OSError):
                self._file.close()
            self._file = None


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


def _variable(file: Any, name: str, item: Field) -> Any:
    """A new variable for the values of a field."""
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
    if compressed:  # pieces are written whole: none waits in memory for its compression until the file is closed
        variable.set_var_chunk_cache(size=1, nelems=1, preemption=1.0)
    return variable


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
    if os.path.isdir(path):
        return "is a folder; give the dataset in it (<name>.nc)"
    if not (os.path.exists(path) or is_file(path)):
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
            folder = path.parent if os.access(path.parent, os.W_OK) else Path(tempfile.gettempdir())
            fields = {name: _read_field(each, name, listed, folder) for name, each in file.variables.items()}
        except OutputError:
            raise
        except Exception as error:
            raise StudyError(f"is damaged: {error}", file=path) from None
    return Contents(axes, fields, attrs)


def _read_field(variable: Any, name: str, listed: set[str], folder: Path) -> Field:
    kept = [key for key in variable.ncattrs() if key not in ("_FillValue", "coordinates")]
    dims = tuple(variable.dimensions)
    values = _read_values(variable, folder)
    return Field(dims, values, {k: variable.getncattr(k) for k in kept}, name in listed or dims == (name,))


def _read_values(variable: Any, folder: Path) -> NDArray[Any]:
    if variable.dtype is str or variable.size * variable.dtype.itemsize <= on_disk.IN_MEMORY:
        return np.asarray(variable[...])
    values = full(variable.shape, 0, variable.dtype, folder)
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
