"""How figures look: sizes of a journal column, fonts, colours that everyone can distinguish, files."""

from __future__ import annotations

import re
import textwrap
import warnings
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.transforms import blended_transform_factory
from numpy.typing import NDArray

from rockcli.scene.looks import WIDTHS, Look

INCH = 25.4
"""[mm]"""

SINGLE, DOUBLE = WIDTHS["single"] / INCH, WIDTHS["double"] / INCH
"""Widths of one and two journal columns [in]."""

DPI, SCREEN_DPI = 300, 110

COLOURS: tuple[str, ...] = (
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#5D3A9B", "#000000",
)  # fmt: skip
"""Okabe and Ito's palette (its yellow, too pale for a line, replaced by a violet)."""

LIFTS: Any = {"color": "black", "linewidth": 0.8, "linestyle": (0, (1, 1.5))}
"""Look of the line at which a body lifts."""

LINES: tuple[Any, ...] = ("-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (5, 1.2, 1.2, 1.2)))
"""Styles of neighbouring curves, in turn: told apart without colours."""

MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")

OUTCOME_COLOURS: dict[str, str] = {
    "failed": "#000000",
    "unresolved": "#CC79A7",
    "no_uplift": "#ECECEC",
    "sliding": "#EBDD6E",
    "rocking": "#A8D1EA",
    "overturned_without_impact": "#A33B00",
    "overturned_after_impact": "#DE8A1C",
}
"""Neighbours in a map differ in lightness too, which print without colour leaves: L* 93, 82, 65 and 39."""

BODY_FACE, BODY_EDGE, GROUND_LINE = "#D5DEE6", "#2F3E4C", "#8C7B6B"

QUIET = "#8A8A8A"
"""Reference lines."""

_OF_PLACE = ("backend", "backend_fallback", "animation")
"""Settings of Matplotlib that are of a place and its programs, not of figures."""

_DEFAULTS = {key: mpl.rcParamsDefault[key] for key in mpl.rcParamsDefault if key.split(".")[0] not in _OF_PLACE}

RC: Any = _DEFAULTS | {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9.0,
    "legend.fontsize": 8.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.unicode_minus": True,
    "xtick.direction": "out",
    "ytick.direction": "out",
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "xtick.minor.size": 1.8,
    "ytick.minor.size": 1.8,
    "lines.linewidth": 1.0,
    "lines.solid_joinstyle": "round",
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "legend.borderaxespad": 0.0,
    "figure.constrained_layout.h_pad": 0.03,
    "figure.constrained_layout.w_pad": 0.06,
    "figure.constrained_layout.hspace": 0.02,
    "svg.hashsalt": "rockcli",
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
}
"""All that Matplotlib can be told of a figure: what a `matplotlibrc` says, as `text.usetex`, is not for these."""

_UNDATED: dict[str, dict[str, Any]] = {"pdf": {"CreationDate": None}, "svg": {"Date": None}, "png": {}}

_WRITTEN: dict[str, dict[str, Any]] = {"png": {"pil_kwargs": {"compress_type": zlib.Z_RLE}}, "pdf": {}, "svg": {}}
"""Lines on white are runs of one colour: to look for no more takes half the time, and files grow by a tenth."""

_NOTES = {"pdf": "Subject", "svg": "Description", "png": "Description"}


MOST_PANELS, MOST_COLUMNS, PANELS_ACROSS = 6, 3, 3
"""Panels of a figure; columns of a dataset drawn beside one another; panels beside one another, more go below."""

MOST_CURVES, MOST_LINES = 8, 7
"""Curves distinguished by colour in one panel; lines that differ in style too."""


_NARROW = 1.65
"""Width below which a panel is no longer read [in]."""

SHORTEST = 1.6
"""Height below which a panel of curves is no longer read [in]."""

_TURNS = 3
"""Layouts after which words stand beside panels that are no wider or higher than what they show at their scale."""

_SHARE = 0.3
"""Part of a figure that a legend takes before it makes it higher."""

_ROOM = 10.0
"""More than titles and legends take [in]."""

_FEWEST = 12
"""Letters of a line that is broken no further."""

_BESIDE = 0.65
"""What a panel of traces leaves of its width to numbers and words beside it [in]."""

PAIR = 4.2
"""Width from which two panels of different content have room beside one another [in]."""

_look: ContextVar[tuple[Look, str]] = ContextVar("look", default=(Look(), ""))
"""How the figure that is being drawn is wanted, and what was selected for it."""


@contextmanager
def wanted(look: Look, selected: str = "") -> Iterator[None]:
    """Draw figures as they are wanted: style, width, title."""
    token = _look.set((look, selected))
    try:
        with mpl.rc_context(RC), no_word_of_glyphs():
            yield
    finally:
        _look.reset(token)


def width_or(natural: float) -> float:
    """The width that is wanted, else the natural one [in]."""
    width = _look.get()[0].width
    return natural if width is None else width / INCH


def lay_out(figure: Figure) -> None:
    """Find where the panels of a figure go; a drawing without pixels does so too, and more that nobody needs."""
    engine = figure.get_layout_engine()
    scaled = any(axes.get_aspect() != "auto" for axes in figure.axes)
    for _ in range(_TURNS if scaled else 1):
        if engine is not None:
            engine.execute(figure)


def fit_panels(figure: Figure, axes: Axes, height: float, rows: int = 1, *, at_least: bool = False) -> None:
    """Make a figure as high as lets each of its rows of panels be `height` [in]: titles and legends take none of it.

    `at_least`: one whose panels are higher stays as it is.
    """
    figure.set_figheight(figure.get_figheight() + _ROOM)  # they may be higher than it is, and nothing is laid out then
    lay_out(figure)
    now = axes.get_position(original=True).height * figure.get_figheight()
    wanted = max(height, now - _ROOM / rows) if at_least else height
    figure.set_figheight(figure.get_figheight() + rows * (wanted - now))


def grid_of(n: int) -> tuple[int, int]:
    """Rows and columns for n panels: as many abreast as the width that is wanted has room for."""
    columns = min(1 if n == 1 else 2 if n in (2, 4) else 3, MOST_COLUMNS, abreast())
    return -(-n // columns), columns


def abreast() -> int:
    """Panels beside one another that the width that is wanted has room for."""
    return max(1, int(width_or(DOUBLE) / _NARROW))


class NotebookFigure(Figure):
    """A figure that a notebook shows by itself, drawn as it is in files."""

    def _repr_png_(self) -> bytes:
        data = BytesIO()
        with mpl.rc_context(RC), no_word_of_glyphs():
            settle(self)
            self.savefig(data, format="png", dpi=SCREEN_DPI, metadata=_UNDATED["png"])
        return data.getvalue()


def new_figure(width: float, height: float) -> Figure:
    """An empty figure, width x height [in], laid out so that nothing overlaps."""
    figure = NotebookFigure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def headline(figure: Figure, title: str, note: str = "", over: Axes | None = None) -> None:
    """Title of a figure, wrapped to its width, with a lighter second line; `over` centres it over these axes.

    Where no title is wanted its words are in the file alone.
    """
    look, selected = _look.get()
    title = look.title or title
    note = "; ".join(filter(None, (selected, note)))
    figure.set_label("\n".join(filter(None, (title, note))))
    if look.title is None:
        return
    columns = int(figure.get_figwidth() * (14.5 if over is None else 12.5))
    words = "\n".join(wrapped(title, columns))
    if note:
        words += "\n" + "\n".join(wrapped(note, columns + 6))
    shown = figure.suptitle(words, fontsize=9.5, linespacing=1.3)
    if over is not None:  # wherever they will be
        shown.set_transform(blended_transform_factory(over.transAxes, figure.transSubfigure))


def untold(figure: Figure) -> str:
    """The note of a figure without the title that it would stand below, in plain letters; "" where it is shown."""
    note = "" if figure.get_suptitle() else str(figure.get_label()).partition("\n")[2]
    note = re.sub(r"\\mathrm\{(\w+)\}", r"\1", note).replace("\\,", " ").replace("\\max", "max")
    note = re.sub(r"\\(?:tan|sin)?\s*\\?(theta|alpha|mu|omega|eta|pi)\b", r"\1", note)
    return re.sub(r"[$\\{}]|_(?=max)", "", note)


_GREEK = re.compile(r"\\(?!tan|sin|cos|max|min|sup)[A-Za-z]+")
"""Commands of mathematics that are one letter, unlike names of functions."""

_UNIT, _JOINED = re.compile(r" (?== )|(?<= =) |(?<=\d) (?=(?:g|mm?|s|rad|Hz|m/s²?)(?:[,;)\s]|$))"), "\N{NO-BREAK SPACE}"
"""Blanks at which a line does not end, and what stands for them."""


_MATHEMATICS, _PRIVATE = re.compile(r"\\\$|\$.*?(?<!\\)\$"), 0xE000
"""What stands between dollars, and the first letter of those that no text has, which stand for it."""


def wrapped(words: str, columns: int) -> list[str]:
    """Words in as few lines as `columns` letters a line allow, of nearly one length; numbers keep their units."""
    words = _UNIT.sub(_JOINED, words)
    lines = textwrap.wrap(words, columns)
    for fewer in range(columns - 1, max(1, *map(len, words.split(" "))) - 1, -1):
        narrower = textwrap.wrap(words, fewer)
        if len(narrower) > len(lines):
            break
        lines = narrower
    return [line.replace(_JOINED, " ") for line in lines]


def panel_title(axes: Axes, words: str, width: float, fontsize: float = 8.5) -> None:
    """Title of a panel, wrapped to its width [in]."""
    axes.set_title(_in_lines(words, max(int(width * 135.0 / fontsize), _FEWEST)), fontsize=fontsize)


def trace_title(axes: Axes, words: str, width: float) -> None:
    """Name of a trace above the left end of its panel, wrapped to its width [in]."""
    columns = max(int((width - _BESIDE) * 16.0), _FEWEST)
    axes.set_title(_in_lines(words, columns), loc="left", fontsize=8.0, pad=2.0)


def _in_lines(words: str, columns: int) -> str:
    """Words in lines of at most so many letters that are seen; mathematics stays whole."""
    shown, pieces = _as_seen(words)
    lines = "\n".join(wrapped(shown, max([columns, *map(shown.count, pieces)])))
    return re.sub(r"([\ue000-\uf8ff])\1*", lambda found: pieces.get(found[1], found[0]), lines)


def _as_seen(words: str) -> tuple[str, dict[str, str]]:
    """Words as long as they are seen, with letters instead of mathematics and dollars, and what these stand for."""
    pieces = {chr(_PRIVATE + i): piece for i, piece in enumerate(_MATHEMATICS.findall(words))}
    for letter, piece in pieces.items():
        words = words.replace(piece, letter * max(len(_seen(piece)), 1), 1)
    return words, pieces


def _seen(words: str) -> str:
    """Words without what mathematics is written with, which takes no room; a Greek letter is one of them."""
    return re.sub(r"[${}\\]", "", _GREEK.sub("x", re.sub(r"\\(?:mathrm|dot|hat|,)", "", words)))


def panel_label(axes: Axes, words: str, width: float) -> None:
    """Label below a panel, wrapped to its width [in]."""
    axes.set_xlabel(_in_lines(words, max(int(width * 12.5), _FEWEST)))


def name_panels(grid: NDArray[Any], titles: Sequence[str], x: str, y: str) -> None:
    """Titles of the first panels of a grid that share their axes, and labels of the outer ones; the rest is empty."""
    columns = grid.shape[1]
    width = grid.flat[0].figure.get_figwidth() / columns
    for number, axes in enumerate(grid.flat):
        if number >= len(titles):
            axes.set_axis_off()
            continue
        if titles[number]:
            panel_title(axes, titles[number], width)
        if number + columns >= len(titles):
            panel_label(axes, x, width)
            axes.tick_params(labelbottom=True)
        if number % columns == 0:
            axes.set_ylabel(y)


def legend_below(figure: Figure, handles: Sequence[Artist], most: int = 4, **style: Any) -> Legend | None:
    """One legend below the figure, in as many columns as there is room for, at most `most`, their rows filled alike.

    Words that one column has no room for take several lines, and what is high makes the figure higher.
    """
    if not handles:
        return None
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    rows = -(-len(handles) // most)
    words = [str(handle.get_label()) for handle in handles]
    letters = max(len(_as_seen(each)[0]) for each in words)
    while True:
        columns = -(-len(handles) // rows)
        how: dict[str, Any] = {"columnspacing": 1.4, **style, "ncols": columns}
        labels = [_in_lines(each, letters) for each in words]
        legend = figure.legend(list(handles), labels, loc="outside lower center", **how)
        size = legend.get_window_extent(renderer)
        if (columns == 1 and letters <= _FEWEST) or size.width <= 0.98 * figure.bbox.width:
            more = size.height / figure.dpi - _SHARE * figure.get_figheight()
            figure.set_figheight(figure.get_figheight() + max(more, 0.0))
            return legend
        legend.remove()
        if columns > 1:
            rows += 1
        else:
            letters = int(0.95 * letters)


def legend_of(figure: Figure, axes: Axes, most: int = 4) -> None:
    """One legend below the figure of what some axes show."""
    legend_below(figure, axes.get_legend_handles_labels()[0], most)


def save(figure: Figure, path: Path) -> None:
    """Write a figure as png, pdf or svg, by the ending of the name; the same figure gives the same bytes.

    Its title and note are in the file's metadata too.
    """
    plot_format = path.suffix.lower().lstrip(".")
    title, _, note = str(figure.get_label()).partition("\n")
    named = {"Title": title, _NOTES[plot_format]: note}
    metadata = _UNDATED[plot_format] | {key: words for key, words in named.items() if words}
    with mpl.rc_context(RC), no_word_of_glyphs():
        settle(figure)
        figure.savefig(path, format=plot_format, dpi=DPI, metadata=metadata, **_WRITTEN[plot_format])


def settle(figure: Figure) -> None:
    """Lay the panels out and round where they are.

    The solver of the layout adds in the order of memory addresses, so that panels move by a last bit from run to run.
    """
    if figure.get_layout_engine() is None:
        return
    lay_out(figure)
    with mpl.rc_context({"figure.autolayout": False, "figure.constrained_layout.use": False}):
        figure.set_layout_engine(None)  # "none" would have the figure laid out once more when it is written
    for axes in figure.axes:
        left, bottom, width, height = axes.get_position(original=True).bounds
        axes.set_position((round(left, 9), round(bottom, 9), round(width, 9), round(height, 9)))


@contextmanager
def no_word_of_glyphs() -> Iterator[None]:
    """A title in letters that the font lacks is drawn with boxes, which everyone sees, without a warning each."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")
        yield
