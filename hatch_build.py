"""Compiles the kernels ahead of time while the program is installed or a wheel is built (docs/building.md).

ROCK_BUILD_KERNELS=no leaves it out; where it cannot be done the program compiles them when it first needs them.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

LEVELS = ("x86-64-v2", "x86-64-v3", "x86-64-v4")
"""What a wheel carries."""

OBJECTS = "rockcli/kernels/objects"


class CompiledKernels(BuildHookInterface[Any]):
    """Objects for this machine beside the sources of an editable install; for three levels of x86-64 in a wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile what is missing; a wheel that carries it is one for Linux on x86-64."""
        wheel = version != "editable"
        linux = platform.system() == "Linux" and platform.machine() == "x86_64"
        if os.environ.get("ROCK_BUILD_KERNELS") == "no" or (wheel and not linux):
            return
        levels = LEVELS if wheel else ()
        folder = Path(self.root, OBJECTS)
        done = subprocess.run(
            [sys.executable, "-m", "rockcli.kernels.build", str(folder), *levels], cwd=self.root, check=False
        )
        if done.returncode:
            self.app.display_warning("the kernels could not be compiled ahead of time; they will be when first needed")
        elif wheel:
            build_data["force_include"][str(folder)] = OBJECTS
            build_data["pure_python"] = False
            build_data["tag"] = "py3-none-manylinux_2_17_x86_64"  # they call nothing but the usual functions of C
