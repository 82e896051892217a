"""Makes the figures of the paper from studies of the project:   python paper/figures.py"""

from __future__ import annotations

from pathlib import Path

import rockcli

HERE = Path(__file__).resolve().parent
FIGURES = {
    "first_rock.png": ("studies/examples/first_rock.yaml", "histories"),
    "sine.png": ("studies/spectra/sine.yaml", "map"),
}
"""File -> study and kind of plot."""


def main() -> None:
    """Solve and draw."""
    for name, (study, kind) in FIGURES.items():
        rockcli.plot(rockcli.run(HERE.parent / study), kind, path=HERE / name)


if __name__ == "__main__":
    main()
