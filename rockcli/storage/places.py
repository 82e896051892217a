"""Output paths: whether results can be written there, why not, and scratch files to remove."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import stat
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

from rockcli.errors import StudyError

_REASONS = {
    errno.ENOSPC: "no space left on the device",
    errno.EDQUOT: "no space left in the quota",
    errno.EFBIG: "no space: files may not be as large as this here",
    errno.EROFS: "the file system is read-only",
    errno.EACCES: "permission denied",
    errno.EPERM: "permission denied",
    errno.ELOOP: "a loop of symbolic links",
    errno.ENAMETOOLONG: "the name is too long",
}

_passing: set[Path] = set()


def reason(error: OSError) -> str:
    """Why the system refused, for people."""
    known = _REASONS.get(error.errno or 0)
    return known or (error.strerror or str(error) or type(error).__name__)


@contextmanager
def passing(path: Path) -> Iterator[None]:
    """A file that must not outlive what is done with it, however that ends (see `remove_passing`)."""
    _passing.add(path)
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            path.unlink(missing_ok=True)
        _passing.discard(path)


def remove_passing() -> None:
    """Remove all files in `passing`: for a process that has to end where it is."""
    for path in tuple(_passing):
        with contextlib.suppress(OSError):
            path.unlink(missing_ok=True)


def unnameable(path: Path) -> str:
    """Why netCDF cannot have a file of this name; "" if it can."""
    try:
        str(path).encode()
    except UnicodeEncodeError:  # bytes that are no text here
        return "the name is not in UTF-8, which netCDF needs: choose another"
    if "\\" in str(path) and os.sep != "\\":
        return "the name has a backslash, which netCDF takes for a slash: choose another"
    return ""


def check_folder(folder: Path) -> None:
    """`StudyError` if a folder neither is there to write in nor can be made."""
    last = Path()
    for place in (*reversed(folder.parents), folder):
        mode = _mode(place)
        if mode is None:
            if place.is_symlink():
                raise StudyError("is a broken symbolic link: results need a folder here", file=place)
            break
        if not stat.S_ISDIR(mode):
            raise StudyError("is not a folder: results cannot be put into it", file=place)
        last = place
    if not os.access(last, os.W_OK | os.X_OK):
        raise StudyError("is a folder in which this user may not write", file=last)


def check_file(path: Path) -> None:
    """`StudyError` if a file can neither be written nor replaced; its folder may be missing."""
    if path.suffix == ".nc" and (complaint := unnameable(path)):
        raise StudyError(complaint, file=path)
    check_folder(path.parent)
    mode = _mode(path)
    if mode is not None and stat.S_ISDIR(mode):
        raise StudyError("is a folder where a file is to be written", file=path)


def check_not_read(path: Path, hashes: Collection[str]) -> None:
    """`StudyError` if the file that would be replaced is of these SHA-256: one that the results were made of."""
    if not path.is_file():
        return
    try:
        with path.open("rb") as stream:
            digest = hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError:
        return
    if digest in hashes:
        raise StudyError("is a file that the results were made of, and would be lost: give another name", file=path)


def _mode(path: Path) -> int | None:
    """What stands at a path, followed through links; None for nothing."""
    try:
        return path.stat().st_mode
    except FileNotFoundError:
        return None
    except OSError as error:
        raise StudyError(f"cannot be used: {reason(error)}", file=path) from None
