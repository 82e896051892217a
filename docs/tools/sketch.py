#!/usr/bin/env python3
"""Draws docs/figures/block.svg: the block with R, alpha, h, b and theta.

python docs/tools/sketch.py
"""

from __future__ import annotations

from math import atan2, cos, hypot, sin
from pathlib import Path

B, H, THETA = 62.0, 150.0, 0.16
ALPHA, R = atan2(B, H), hypot(B, H)
EDGE = (250.0, 352.0)
"""The edge about which the block turns, theta > 0: the right one."""

STYLE = """\
text { font: italic 17px Georgia, 'Times New Roman', serif; fill: #222 }
text.word { font: 12px Helvetica, Arial, sans-serif; fill: #555 }
.body { fill: #eceae4; stroke: #333; stroke-width: 1.8 }
.rest { fill: none; stroke: #999; stroke-width: 1; stroke-dasharray: 5 4 }
.thin { fill: none; stroke: #333; stroke-width: 1 }
.axis { fill: none; stroke: #888; stroke-width: 1; stroke-dasharray: 8 3 2 3 }
.radius { stroke: #b3541e; stroke-width: 2; fill: none }
.angle { stroke: #1f5f8b; stroke-width: 1.6; fill: none }"""


def turned(x: float, y: float) -> tuple[float, float]:
    """A point of the block at rest, from its right edge (x to the right, y up), in the picture after a turn by THETA."""
    return EDGE[0] + x * cos(THETA) + y * sin(THETA), EDGE[1] + x * sin(THETA) - y * cos(THETA)


def upright(x: float, y: float) -> tuple[float, float]:
    """The same of the block at rest."""
    return EDGE[0] + x, EDGE[1] - y


def line(a: tuple[float, float], b: tuple[float, float], kind: str, arrows: str = "") -> str:
    """A line; `arrows`: "end", "both"."""
    marks = {"": "", "end": ' marker-end="url(#tip)"', "both": ' marker-end="url(#tip)" marker-start="url(#tip)"'}[
        arrows
    ]
    return f'<line class="{kind}" x1="{a[0]:.1f}" y1="{a[1]:.1f}" x2="{b[0]:.1f}" y2="{b[1]:.1f}"{marks}/>'


def polygon(points: list[tuple[float, float]], kind: str) -> str:
    """A closed outline."""
    return f'<polygon class="{kind}" points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in points)}"/>'


def arc(centre: tuple[float, float], radius: float, begin: float, end: float) -> str:
    """Part of a circle, between two angles from the vertical, to the right positive."""
    (x0, y0), (x1, y1) = ((centre[0] + radius * sin(a), centre[1] - radius * cos(a)) for a in (begin, end))
    return f'<path class="angle" d="M{x0:.1f},{y0:.1f} A{radius},{radius} 0 0 1 {x1:.1f},{y1:.1f}"/>'


def text(at: tuple[float, float], words: str, kind: str = "") -> str:
    """Words, centred."""
    what = f' class="{kind}"' if kind else ""
    return f'<text{what} x="{at[0]:.1f}" y="{at[1]:.1f}" text-anchor="middle">{words}</text>'


def drawn() -> str:
    """The picture."""
    corners = [(-2 * B, 0), (0, 0), (0, 2 * H), (-2 * B, 2 * H)]
    centre, foot, side = turned(-B, H), turned(-B, 0), turned(0, H)
    parts = [
        f'<line class="thin" x1="70" y1="{EDGE[1]}" x2="400" y2="{EDGE[1]}"/>',
        *[f'<line class="thin" x1="{x}" y1="{EDGE[1]}" x2="{x - 9}" y2="{EDGE[1] + 9}"/>' for x in range(80, 401, 16)],
        polygon([upright(*corner) for corner in corners], "rest"),
        polygon([turned(*corner) for corner in corners], "body"),
        line(turned(-B, -8), turned(-B, 2 * H + 14), "axis"),
        line(EDGE, upright(0, 2 * H + 40), "axis"),
        line(EDGE, centre, "radius"),
        line(EDGE, turned(0, 2 * H + 34), "axis"),
        arc(EDGE, 325, 0, THETA),
        text((EDGE[0] + 334 * sin(THETA / 2), EDGE[1] - 336 * cos(THETA / 2)), "θ"),
        arc(EDGE, 92, THETA - ALPHA, THETA),
        text((EDGE[0] + 76 * sin(THETA - ALPHA / 2), EDGE[1] - 72 * cos(THETA - ALPHA / 2)), "α"),
        f'<circle cx="{centre[0]:.1f}" cy="{centre[1]:.1f}" r="4" fill="#222"/>',
        text(((centre[0] + EDGE[0]) / 2 - 15, (centre[1] + EDGE[1]) / 2 - 12), "R"),
        line(foot, centre, "thin", "both"),
        text((turned(-B - 15, 0.55 * H)[0], turned(-B - 15, 0.55 * H)[1]), "h"),
        line(centre, side, "thin", "both"),
        text((turned(-B / 2, H + 12)[0], turned(-B / 2, H + 12)[1]), "b"),
        f'<circle cx="{EDGE[0]}" cy="{EDGE[1]}" r="3.5" fill="#b3541e"/>',
        text((EDGE[0] + 46, EDGE[1] - 10), "edge", "word"),
        text((centre[0] - 31, centre[1] - 24), "centre of", "word"),
        text((centre[0] - 31, centre[1] - 10), "mass", "word"),
        line((345, 300), (392, 300), "thin", "end"),
        '<text x="347" y="290">a<tspan font-size="12" dy="4">g</tspan></text>',
    ]
    body = "\n".join(parts)
    return f"""<svg xmlns="http://www.w3.org/2000/svg" viewBox="60 0 350 375" width="350" height="375" role="img">
<title>A block turned by theta about its edge: R from the edge to the centre of mass, h and b its sides, alpha the angle between R and the side</title>
<style>
{STYLE}
</style>
<defs><marker id="tip" viewBox="0 0 8 8" refX="7.5" refY="4" markerWidth="7" markerHeight="7" orient="auto-start-reverse"><path d="M0,1 L8,4 L0,7" fill="none" stroke="#333"/></marker></defs>
<rect x="60" y="0" width="350" height="375" fill="#fff"/>
{body}
</svg>
"""


if __name__ == "__main__":
    Path(__file__).resolve().parents[1].joinpath("figures", "block.svg").write_text(drawn(), encoding="utf-8")
