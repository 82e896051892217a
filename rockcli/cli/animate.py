"""`rock animate`: an animation of a body in motion, from a dataset alone."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rockcli.cli.say import say


def animate(
    file: Annotated[Path, typer.Argument(metavar="FILE.nc", help="Dataset with histories, written by `rock run`.")],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE.gif|.mp4", help="The animation; default: animation.gif beside FILE."),
    ] = None,
    case: Annotated[int | None, typer.Option("--case", metavar="N", help="Which case, counted from 1.")] = None,
    at: Annotated[
        list[str] | None,
        typer.Option("--at", "--select", metavar="AXIS=VALUE", help="Which case, by its values on axes."),
    ] = None,
    speed: Annotated[float, typer.Option("--speed", help="Seconds of the response per second of animation.")] = 1.0,
    fps: Annotated[float, typer.Option("--fps", help="Frames per second, at most 50.")] = 25.0,
    magnify: Annotated[float, typer.Option("--magnify", help="Factor on the bending of a flexible column.")] = 1.0,
    start: Annotated[float | None, typer.Option("--start", metavar="S", help="Start of the part shown [s].")] = None,
    end: Annotated[float | None, typer.Option("--end", metavar="S", help="End of the part shown [s].")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress, no notes; errors only.")] = False,
) -> None:
    """Animate one case: the body on the ground, its rotation and the ground's acceleration."""
    from rockcli.cli.progress import Progress
    from rockcli.engine import animate as engine
    from rockcli.errors import StudyError

    chosen: dict[str, str] = {}
    for words in at or ():
        axis, equals, value = words.partition("=")
        if not equals or not axis.strip() or axis.strip() in chosen:
            raise StudyError(f"--at {words}: expected AXIS=VALUE, each axis once")
        chosen[axis.strip()] = value.strip()
    line = Progress(file.stem, shown=not quiet, what="frames")
    try:
        animation = engine.animate(
            file, out, case=case, at=chosen, speed=speed, fps=fps, magnify=magnify, start=start, end=end, progress=line
        )
    finally:
        line.close()
    say(str(animation.path))
    for note in () if quiet else animation.notes:
        say(f"rock: {note}", err=True)
