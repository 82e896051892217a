"""Animation files: GIF, and MP4 where the program ffmpeg is there."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from rockcli.errors import StudyError

Picture = NDArray[np.uint8]
"""(height, width, 3), red green blue."""

Progress = Callable[[int, int], None]

SUFFIXES = (".gif", ".mp4")

HOLD = 1.0
"""The last picture stays this long before a GIF begins again [s]."""

_COLOURS = 64


def check_output(path: Path) -> None:
    """`StudyError` if no animation of that name can be made here."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise StudyError(f"--out {path}: an animation is a .gif or an .mp4")
    if suffix == ".mp4" and shutil.which("ffmpeg") is None:
        raise StudyError(f"--out {path}: an .mp4 needs ffmpeg, which is not installed; a .gif needs no program")


def interval(path: Path, fps: float) -> float:
    """Time between pictures [s]: those of a GIF are whole hundredths of a second."""
    return max(0.02, round(100.0 / fps) / 100.0) if path.suffix.lower() == ".gif" else 1.0 / fps


def write(path: Path, pictures: Iterable[Picture], count: int, step: float, progress: Progress | None = None) -> None:
    """Write `count` pictures, `step` seconds apart; the suffix of `path` says how.

    Raises:
        StudyError: ffmpeg cannot write it.
    """
    counted = _counted(pictures, count, progress)
    if path.suffix.lower() == ".gif":
        _write_gif(path, counted, count, step)
    else:
        _write_mp4(path, counted, step)


def _counted(pictures: Iterable[Picture], count: int, progress: Progress | None) -> Iterator[Picture]:
    for number, picture in enumerate(pictures, start=1):
        yield picture
        if progress is not None:
            progress(number, count)


def _write_gif(path: Path, pictures: Iterator[Picture], count: int, step: float) -> None:
    first = Image.fromarray(next(pictures))
    palette = first.quantize(_COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)

    colours = np.array(palette.getpalette(), dtype=np.uint8).reshape(-1, 3)
    colours[colours.min(axis=1) > 245] = 255  # the paper stays white
    palette.putpalette(colours.tobytes())

    def reduced(picture: Image.Image) -> Image.Image:
        return picture.quantize(palette=palette, dither=Image.Dither.NONE)

    milliseconds = round(1000.0 * step)
    reduced(first).save(
        path,
        format="GIF",
        save_all=True,
        append_images=(reduced(Image.fromarray(picture)) for picture in pictures),
        duration=[milliseconds] * (count - 1) + [round(1000.0 * HOLD)],
        loop=0,
    )


def _write_mp4(path: Path, pictures: Iterator[Picture], step: float) -> None:
    first = next(pictures)
    height, width = first.shape[:2]
    command = [
        "ffmpeg", "-loglevel", "error", "-y",
        "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", f"{1.0 / step:.6f}", "-i", "-",
        "-an", "-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart",
        "-f", "mp4", str(path),
    ]  # fmt: skip
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as ffmpeg:
        assert ffmpeg.stdin is not None
        assert ffmpeg.stderr is not None
        try:
            ffmpeg.stdin.write(first.tobytes())
            for picture in pictures:
                ffmpeg.stdin.write(picture.tobytes())
            ffmpeg.stdin.close()
        except BrokenPipeError:
            pass  # it says below what is wrong
        except BaseException:
            ffmpeg.kill()
            raise
        said = ffmpeg.stderr.read().decode(errors="replace").strip()
        if ffmpeg.wait() != 0:
            raise StudyError(f"ffmpeg cannot write an .mp4: {said.splitlines()[-1] if said else 'no message'}")
