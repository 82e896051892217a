"""Animation of a body: frames of it over the ground, with the histories of both."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch

from rockcli.errors import StudyError
from rockcli.plotting.common.cases import Array, has_overturned, number_at, outcome_at
from rockcli.plotting.common.labels import title_of, unit_g
from rockcli.plotting.common.response import SHOWN_UP_TO, over_alpha, window
from rockcli.plotting.common.shape import Body, body_of, friction_marks, motion_of, outline, path_of
from rockcli.plotting.common.style import BODY_EDGE, BODY_FACE, COLOURS, GROUND_LINE, QUIET, RC, headline
from rockcli.plotting.common.video import Picture

if TYPE_CHECKING:
    import xarray
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

LONGEST = 20.0
"""Length of an animation nobody asked to be longer [s]."""

MOST_PICTURES = 3000

_WIDTH, _HEIGHT, _DPI = 6.4, 5.6, 100
_MARK = "#D55E00"

Position = tuple[int, ...]


@dataclass(frozen=True)
class Scenes:
    """What an animation shows.

    Attributes:
        times: of the pictures [s].
        magnify: factor on the bending.
        note: what it leaves out, "" if nothing.
    """

    times: Array
    magnify: float
    note: str = ""


def why_still(dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be animated; "" if it can."""
    missing = [name for name in ("theta", "alpha", "R", "time") if name not in dataset.variables]
    return "the dataset holds no histories (save: {histories: true})" if missing else ""


def scenes(
    dataset: xarray.Dataset,
    position: Position,
    *,
    step: float,
    speed: float = 1.0,
    magnify: float = 1.0,
    start: float | None = None,
    end: float | None = None,
) -> Scenes:
    """Choose what to show of a case: the response, at most `LONGEST` of animation unless start and end are both given.

    An animation that has to be cut shows the beginning of the response, or the fall if there is one.

    Raises:
        StudyError: the case has no history, does not bend though bending is magnified, or it would take too long.
    """
    motion = motion_of(dataset, position)
    if len(motion.time) < 2:
        raise StudyError(f"this case has no history to show: {outcome_at(dataset, position) or 'none was saved'}")
    if magnify != 1.0 and not motion.bends:
        raise StudyError("--magnify: this body does not bend")
    whole = float(motion.time[-1])
    seen = window(dataset, [position])
    fell = has_overturned(dataset, position)
    first = seen.start if start is None else start
    last = (whole if fell else min(seen.end, whole)) if end is None else end
    if not 0.0 <= first < last <= whole * (1.0 + 1e-9):
        raise StudyError(f"cannot show {first:g} s to {last:g} s: the history goes from 0 to {whole:g} s")
    note = ""
    longest = LONGEST * speed
    if (start is None or end is None) and last - first > longest * (1.0 + 1e-9):
        if start is None and (fell or end is not None):
            first = last - longest
        else:
            last = first + longest
        note = f"shows {first:.4g} to {last:.4g} s of {whole:.4g} s (--start, --end and --speed choose)"
    count = int(np.floor((last - first) / (step * speed) + 1e-9)) + 1
    if count > MOST_PICTURES:
        raise StudyError(
            f"the animation would have {count} frames, more than {MOST_PICTURES}: shorten it or raise --speed"
        )
    if count < 2:
        raise StudyError(f"from {first:g} s to {last:g} s there is only one frame: lower --speed or raise --fps")
    times = first + step * speed * np.arange(count)
    if last - times[-1] > 1e-9 * last:
        times = np.append(times, last)
    return Scenes(np.asarray(times, dtype=np.float64), magnify, note)


def pictures(dataset: xarray.Dataset, position: Position, shown: Scenes, label: str = "") -> Iterator[Picture]:
    """Draw the scenes one after the other, (height, width, 3) each."""
    with mpl.rc_context(RC):
        stage = _Stage(dataset, position, shown, label)
        background = stage.empty()
    for number in range(len(shown.times)):
        with mpl.rc_context(RC):
            picture = stage.picture(number, background)
        yield picture


class _Stage:
    """A figure whose moving parts are drawn anew over a background drawn once."""

    def __init__(self, dataset: xarray.Dataset, position: Position, shown: Scenes, label: str) -> None:
        motion, body = motion_of(dataset, position), body_of(dataset, position)
        self.times = shown.times
        theta = np.interp(shown.times, motion.time, motion.theta)
        bending = np.interp(shown.times, motion.time, motion.w_top) * shown.magnify
        slide, lift = (np.interp(shown.times, motion.time, of) for of in (motion.slide, motion.lift))
        self.outlines = [
            outline(body, float(q), float(w)) + np.array([u, z])
            for q, w, u, z in zip(theta, bending, slide, lift, strict=True)
        ]
        self.slide = slide
        self.scratches, self.scratched_at = friction_marks(body, motion)
        self.ratio = over_alpha(dataset, position, theta)
        fell = has_overturned(dataset, position)
        self.fall = number_at(dataset, "t_overturn", position) if fell else np.inf
        self.figure = Figure(figsize=(_WIDTH, _HEIGHT), dpi=_DPI, layout="constrained")
        self.canvas: Any = FigureCanvasAgg(self.figure)
        moving = bool(np.any(motion.a_g != 0.0))
        heights = [4.6, 0.8, 0.8] if moving else [4.6, 0.8]
        panels = self.figure.subplots(len(heights), 1, height_ratios=heights)
        self.markers: list[tuple[Line2D, Line2D, Array]] = []
        ratio = over_alpha(dataset, position, motion.theta)
        if moving:
            self._trace(panels[1], motion.time, motion.a_g / unit_g(dataset), "$a_g$ [g]", "#333333")
            panels[1].tick_params(labelbottom=False)
        most = SHOWN_UP_TO if fell else np.inf
        self._trace(panels[-1], motion.time, ratio, r"$\theta/\alpha$", COLOURS[0], most)
        panels[-1].set_xlabel("time [s]")
        self.figure.align_ylabels(panels[1:])
        headline(self.figure, title_of(dataset), label)
        scale = "to scale" if shown.magnify == 1.0 else rf"$\times$ {shown.magnify:g}"
        self._scene(panels[0], body, f"bending {scale},\nshape interpolated" if motion.bends else "")

    def _scene(self, axes: Axes, body: Body, words: str) -> None:
        """The ground, the body at rest as a ghost, the body, what there is to read."""
        axes.set_axis_off()
        self.figure.draw_without_rendering()
        self.figure.set_layout_engine("none")
        points = np.concatenate([*self.outlines, outline(body, 0.0)])
        left, right = np.nanmin(points[:, 0]), np.nanmax(points[:, 0])
        box = axes.get_window_extent()
        unit = 1.08 * max((right - left) / box.width, np.nanmax(points[:, 1]) / (0.93 * box.height))  # m per dot
        middle = 0.5 * (left + right)
        axes.set_xlim(middle - 0.5 * unit * box.width, middle + 0.5 * unit * box.width)
        axes.set_ylim(-0.07 * unit * box.height, 0.93 * unit * box.height)
        ground = -0.5 * abs(body.rise)
        axes.axhspan(-unit * box.height, ground, facecolor="#EDE7E0", zorder=1)
        axes.axhline(ground, color=GROUND_LINE, linewidth=1.2, zorder=2)
        if body.rise:
            axes.plot([-body.left, body.right], [-0.5 * body.rise, 0.5 * body.rise], color=GROUND_LINE, linewidth=2.0)
        ghost: dict[str, Any] = {
            "facecolor": "none",
            "edgecolor": QUIET,
            "linewidth": 0.7,
            "linestyle": (0, (4, 3)),
        }
        axes.add_patch(PathPatch(path_of(outline(body, 0.0)), zorder=2, **ghost))
        self.body = PathPatch(
            path_of(self.outlines[0]), facecolor=BODY_FACE, edgecolor=BODY_EDGE, linewidth=1.0, zorder=3
        )
        axes.add_patch(self.body)
        self.stamp = axes.text(0.01, 0.99, "", transform=axes.transAxes, va="top", fontsize=11.0, linespacing=1.5)
        axes.text(0.99, 0.99, words, transform=axes.transAxes, va="top", ha="right", fontsize=9.0, color="#555555")
        (self.marks,) = axes.plot(
            [], [], color=GROUND_LINE, linewidth=3.5, solid_capstyle="butt", zorder=4, animated=True
        )
        self.body.set_animated(True)
        self.stamp.set_animated(True)

    def _trace(self, axes: Axes, time: Array, values: Array, label: str, colour: str, most: float = np.inf) -> None:
        """A history over the animation's time, cut off beyond `most`, and the marker that will move along it."""
        axes.plot(time, values, color=colour, linewidth=0.7)
        axes.axhline(0.0, color=QUIET, linewidth=0.4, zorder=0)
        axes.set_xlim(self.times[0], self.times[-1])
        axes.set_ylabel(label)
        seen = values[(time >= self.times[0]) & (time <= self.times[-1])]
        seen = np.clip(seen, -most, most)
        low, high = min(0.0, float(seen.min(initial=0.0))), max(0.0, float(seen.max(initial=0.0)))
        margin = 0.1 * (high - low) or 0.1
        axes.set_ylim(low - margin, high + margin)
        line = axes.axvline(self.times[0], color=_MARK, linewidth=0.8, animated=True)
        (dot,) = axes.plot([], [], "o", color=_MARK, markersize=4.0, markeredgewidth=0.0, animated=True, zorder=5)
        self.markers.append((line, dot, np.interp(self.times, time, values)))

    def empty(self) -> Any:
        """The picture without what moves."""
        self.canvas.draw()
        return self.canvas.copy_from_bbox(self.figure.bbox)

    def picture(self, number: int, background: Any) -> Picture:
        """One picture."""
        self.canvas.restore_region(background)
        now = float(self.times[number])
        self.body.set_path(path_of(self.outlines[number]))
        words = f"$t$ = {now:.2f} s\n" + rf"$\theta/\alpha$ = ${self.ratio[number]:+.3f}$"
        slid = rf"$u$ = ${self.slide[number]:+.3f}$ m" if self.slide.any() else ""
        self.stamp.set_text("\n".join(filter(None, [words + ("  overturns" if now >= self.fall else ""), slid])))
        made = self.scratches[: np.searchsorted(self.scratched_at, now, side="right")]
        gaps = np.column_stack([made, np.full(len(made), np.nan)]).ravel()
        self.marks.set_data(gaps, np.zeros(len(gaps)))
        artists: list[Artist] = [self.body, self.marks, self.stamp]
        for line, dot, values in self.markers:
            line.set_xdata([now, now])
            dot.set_data([now], [values[number]])
            artists += [line, dot]
        for artist in artists:
            if artist.axes is not None:
                artist.axes.draw_artist(artist)
        return np.asarray(self.canvas.buffer_rgba())[:, :, :3].copy()
