"""Matplotlib as a command that draws files needs it: imported in three quarters of the time."""

from __future__ import annotations

import sys
import warnings

_COMMANDS, _SOLIDS = "rockcli.cli.main", "mpl_toolkits.mplot3d"


def import_lean() -> None:
    """Import Matplotlib without three dimensions, and without the tables of properties in its docstrings.

    In commands alone, of which nobody asks for either: a process of Python has it whole, as has one that imported it.
    """
    if _COMMANDS not in sys.modules or "matplotlib.figure" in sys.modules or _SOLIDS in sys.modules:
        return
    from matplotlib import artist

    tabled = artist.kwdoc
    artist.kwdoc = lambda artist: ""  # every class asks for its own as it is made
    sys.modules[_SOLIDS] = None  # type: ignore[assignment]
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Unable to import Axes3D")
            import matplotlib.figure  # noqa: F401
    finally:
        artist.kwdoc = tabled
        del sys.modules[_SOLIDS]
