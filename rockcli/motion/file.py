"""Reads the bytes of a record file, whatever its format, and refuses what is no record."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from rockcli.errors import RecordError

LARGEST = 1 << 28
"""Size of a file above which it is no record [bytes]: ten million samples as text, a day of shaking."""


def record_bytes(path: Path) -> bytes:
    """The bytes of a file.

    Raises:
        RecordError: there is none, it is something else than a file, too large, or cannot be read.
    """
    try:
        found = os.stat(path)
        if not (stat.S_ISREG(found.st_mode) or stat.S_ISDIR(found.st_mode)):
            raise RecordError("is a device or a pipe, not a record", path)
        with open(path, "rb") as file:
            if found.st_size > LARGEST:
                most = f"a record has at most {LARGEST / 2**20:g} MiB"
                raise RecordError(f"has {found.st_size / 2**20:,.0f} MiB, and {most}; cut out what is to be used", path)
            # memory is asked for as much as may be read: for LARGEST the system takes three times the time of reading
            return file.read(found.st_size + 1 if found.st_size else LARGEST)
    except FileNotFoundError:
        raise RecordError("there is no such file", path) from None
    except IsADirectoryError:
        raise RecordError("this is a folder, not a record; name a file in it", path) from None
    except ValueError as error:  # a name that no file can have
        raise RecordError(f"cannot be read: {error}", path) from error
    except OSError as error:
        raise RecordError(f"cannot be read: {error.strerror or error}", path) from error
