"""Environment variables that the program reads, as `rock show environment` lists them."""

from __future__ import annotations

ENVIRONMENT: dict[str, str] = {
    "ROCK_RECORDS": "folders in which records are searched for too, separated as in PATH",
    "ROCK_CACHE_DIR": "the cache of compiled kernels, instead of `rockcli` in `$XDG_CACHE_HOME` or `~/.cache`",
    "ROCK_KERNELS": "`interpreted`: always plain Python; `compiled`: never; `ahead` or `jit`: compiled this way only",
    "ROCK_BUILD_KERNELS": "`no` when the program is installed or a wheel is built: compile no kernels then",
    "ROCK_OPENSEES_PYTHON": "the Python that runs the scripts of the backend `opensees`, instead of this one",
    "ROCK_CALCULIX_LIMIT": "wall time a case of the backend `calculix` may take [s], default 4 h",
    "ROCK_CALCULIX_DIR": "folder that keeps finished runs of CalculiX, by its version and the hash of their deck, to "
    "be used again: an interrupted study repeats only the run it was in",
    "ROCK_DEBUG": "`1`: a fault of the program ends with its traceback",
}
"""Name -> meaning."""
