"""Memory that one chunk gives back is the next one's: it is not returned to the system in between."""

from __future__ import annotations

import contextlib
import ctypes

TRIM_THRESHOLD, MMAP_THRESHOLD = -1, -3
"""Parameters of glibc's mallopt."""

KEPT, LARGEST = 1 << 28, 1 << 25
"""Free memory kept at most; block above which memory comes from the system all the same (glibc's limit) [bytes]."""


def keep_freed() -> None:
    """Let the C library keep what is freed, where it can be told so.

    The arrays of a chunk are given back when it is solved.  Asking the system for the same pages again, and having them
    cleared, took a tenth of the time of a large sweep.
    """
    with contextlib.suppress(OSError, AttributeError, TypeError):
        mallopt = ctypes.CDLL(None).mallopt
        mallopt(MMAP_THRESHOLD, LARGEST)
        mallopt(TRIM_THRESHOLD, KEPT)
