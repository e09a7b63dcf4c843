"""Shapes of the paper's drawings: outlines, lines, arrows and names, and their numbers."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray

from study.pages.figures import LOOKS

SOCKET, BALL = LOOKS["hertz"].color, LOOKS["hyperbolic_winkler"].color
DIMENSION = "<|-|>"  # kind of arrow of a dimension line


def table(**panels: dict[str, NDArray[np.float64]]) -> pd.DataFrame:
    """What is drawn, a row per point, from panels of parts of shape (2, n)."""
    parts = [
        pd.DataFrame({"panel": panel, "part": part, "x": points[0], "y": points[1]})
        for panel, outlines in panels.items()
        for part, points in outlines.items()
    ]
    return pd.concat(parts, ignore_index=True).round({"x": 6, "y": 6})


def polar(radius: Any, angle: ArrayLike, centre: Any = (0, 0)) -> NDArray[np.float64]:
    """Points at polar angles (rad) from the downward vertical, shape (2, ...)."""
    x, y = radius * np.sin(angle), -radius * np.cos(angle)
    return np.array([x + centre[0], y + centre[1]])


def frame(axes: Axes, left: float, right: float, bottom: float, top: float) -> None:
    """Show this part of the plane to scale, without axes."""
    axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    axes.set_axis_off()


def line(axes: Axes, points: Any, color: Any = "k", style: Any = "-", width: float = 0.8) -> None:
    """Draw a line through points of shape (2, n)."""
    x, y = points
    axes.plot(x, y, color=color, linestyle=style, linewidth=width)


def fill(
    axes: Axes,
    outline: Any,
    color: Any,
    strength: float = 0.2,
    width: float = 1.2,
    hatch: bool = False,
) -> None:
    """Fill an outline of shape (2, n) with a pale shade of its colour, hatched or not."""
    axes.fill(*outline, facecolor=(color, strength), edgecolor=color, linewidth=width)
    if hatch:
        axes.fill(*outline, facecolor="none", edgecolor=(color, 0.35), hatch="////", linewidth=0)


def write(axes: Axes, text: str, at: Any, color: Any = "k", **style: Any) -> None:
    """Write a text at a point."""
    x, y = at
    axes.text(x, y, text, color=color, **({"ha": "center", "va": "center"} | style))


def arrow(
    axes: Axes,
    start: ArrayLike,
    end: ArrayLike,
    text: str = "",
    shift: float = 0.0,
    along: float = 0.5,
    *,
    kind: str = "-|>",
    color: Any = "k",
    width: float = 0.9,
    size: float = 8,
) -> None:
    """Draw an arrow with its name ``along`` its length, ``shift`` to the left of it."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    style: dict[str, Any] = {"arrowstyle": kind, "mutation_scale": size, "shrinkA": 0, "shrinkB": 0}
    axes.annotate(
        "", tuple(end), tuple(start), arrowprops=style | {"linewidth": width, "color": color}
    )
    left = np.array([start[1] - end[1], end[0] - start[0]]) / np.hypot(*(end - start))
    write(axes, text, start + along * (end - start) + shift * left, color)
