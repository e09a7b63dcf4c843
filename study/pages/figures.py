"""One style for every figure, one colour and marker per law, and saving with the numbers drawn.

A figure is written as PNG with a CSV of what it shows. It is drawn from these numbers, rounded by
`as_saved`: on another processor the last digits of a solved number differ, and equal tables have to
give equal pictures, byte by byte.

The article scales a figure down to its text width of 6.61 in, and no text may be smaller than 7 pt
there: 9 pt * 6.61 / 8.4 = 7.08 pt, sub- and superscripts aside.
"""

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import combinations
from pathlib import Path
from string import ascii_lowercase
from typing import Any, cast

import matplotlib as mpl
import numpy as np
import pandas as pd
from cycler import cycler
from IPython.display import Image, display
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text
from numpy.typing import ArrayLike, NDArray
from pandas.io.formats.style import Styler

from study import checks, paths

WIDEST = 8.4  # width of a figure in inches
SMALLEST = 9.0  # size of its text in points
TOUCHING = 1.0  # points by which the boxes of two texts may overlap: letters do not fill them
OVERLAP = "Overlapping texts"  # key of the image's metadata with the texts that overlap more
DIGITS = 9  # of a number in a saved table

STYLE = {
    "figure.dpi": 100,
    "savefig.dpi": 200,
    "figure.constrained_layout.use": True,
    "font.size": SMALLEST,
    "axes.titlesize": SMALLEST,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "0.9",
    "legend.frameon": False,
    "lines.linewidth": 1.5,
    "lines.markersize": 4,
    "axes.prop_cycle": cycler(
        color=["#0072B2", "#D55E00", "#009E73", "#E69F00", "#56B4E9", "#CC79A7", "#000000"]
    ),
}

DEPTH = "penetration depth $\\delta^*=\\delta/\\Delta R$"
FORCE = "contact force $P^*=P/(E^*\\Delta R^2)$"
RADIUS = "socket radius $R_2^*=R_2/\\Delta R$"


@dataclass(frozen=True)
class Look:
    """How a law, a model or a method is drawn, everywhere."""

    label: str
    color: str
    marker: str
    line: str = "-"


def _looks(of):
    """Rows of ``looks.csv``; their colours are Okabe and Ito's, good for colour-blind readers."""
    rows = pd.read_csv(Path(__file__).with_name("looks.csv"), dtype=str, keep_default_na=False)
    rows = rows[rows["of"] == of].drop(columns="of").set_index("name")
    return {name: Look(*row) for name, row in rows.iterrows()}


LOOKS = _looks("law")  # and of the elastic solution
MODEL_LOOKS = _looks("model")  # of the mechanism's links
METHOD_LOOKS = _looks("method")  # of solvers and steppers, by the names in `study.measure.charts`


def new(
    columns: int = 1, rows: int = 1, width: float = 4.2, height: float = 3.2, **options: Any
) -> tuple[Figure, Axes | NDArray[np.object_]]:
    """Figure and axes in the study's style, of panels with a width and a height in inches.

    Options are those of ``Figure.subplots``. ``ValueError`` if they are wider than `WIDEST`.
    """
    checks.number("width of the figure", columns * width, "in", above=0, most=WIDEST)
    mpl.rcdefaults()
    mpl.rcParams.update(cast(Any, STYLE))
    figure = Figure(figsize=(columns * width, rows * height))
    return figure, figure.subplots(rows, columns, **options)


def panels(*titles: str, columns: int = 0, **options: Any) -> tuple[Figure, list[Axes]]:
    """Figure of `new` and its axes: lettered panels by title in rows of ``columns``, or in one."""
    columns = columns or len(titles)
    figure, grid = new(columns, -(-len(titles) // columns), squeeze=False, **options)
    axes = [*cast(Any, grid).flat]
    for letter, panel, title in zip(ascii_lowercase, axes, titles, strict=False):
        panel.set_title(f"({letter}) {title}")
    return figure, axes


def legend_above(figure: Figure, axes: Axes, columns: int = 3, **options: Any) -> None:
    """Put the legend of one panel above all of them."""
    entries = axes.get_legend_handles_labels()
    figure.legend(*entries, loc="outside upper center", ncols=columns, **options)


def ticks(axes: Axes, **places: Iterable[float] | Mapping[float, str]) -> None:
    """Label an axis, ``x`` or ``y``, at some places only, with their numbers or given labels."""
    for name, at in places.items():
        labels = at if isinstance(at, Mapping) else {place: f"{place:g}" for place in at}
        axis = getattr(axes, f"{name}axis")
        axis.set_ticks([*labels], [*labels.values()])
        axis.set_ticks([], minor=True)


def zero_line(axes: Axes, at: float = 0.0, **look: Any) -> None:
    """Draw a thin horizontal line behind the curves: at zero, or at one for ratios."""
    usual: dict[str, Any] = {"color": "0.5", "linewidth": 0.8, "zorder": 1}
    axes.axhline(at, **(usual | look))


def draw(axes: Axes, law: str, x: ArrayLike, y: ArrayLike, **options: Any) -> None:
    """Draw a law as a line, or the elastic solution as markers, in its look, `as_saved`."""
    look = LOOKS[law]
    style = {"color": look.color, "label": look.label, "linestyle": look.line}
    if look.line == "none":
        style |= {"marker": look.marker, "zorder": 3}
    axes.plot(as_saved(x), as_saved(y), **(style | options))


def draw_model(axes: Axes, model: str, time: ArrayLike, values: ArrayLike, **options: Any) -> None:
    """Draw a model's quantity over time in s, `as_saved`, the rigid one broad and behind."""
    look = MODEL_LOOKS[model]
    style = {"color": look.color, "linewidth": 0.9, "linestyle": look.line}
    if model == "rigid":
        style |= {"color": "0.75", "linewidth": 3.5}
    ms = as_saved(1e3 * np.asarray(time))
    axes.plot(ms, as_saved(values), label=look.label, **(style | options))
    axes.set_xlabel("time (ms)")


def save(figure: Figure, name: str, numbers: pd.DataFrame) -> None:
    """Write ``name.png``, what it draws to ``name.csv``, and show the image.

    The texts that overlap are named in the metadata of the image, where a test looks for them.
    Raises ``ValueError`` if a text is smaller than `SMALLEST`, or a number is not finite.
    """
    least = min(figure.findobj(Text), key=Text.get_fontsize)
    what = f"size of the text {least.get_text()!r} in {name}"
    checks.number(what, least.get_fontsize(), "pt", least=SMALLEST)
    path = _folder() / f"{name}.png"
    save_table(numbers, name)
    pairs = "; ".join(f"{a!r} and {b!r}" for a, b in overlapping_texts(figure))
    note = {OVERLAP: pairs} if pairs else {}
    with paths.whole(path) as temporary:
        figure.savefig(temporary, metadata={"Software": None} | note)
    display(Image(path, width=round(72 * figure.get_figwidth())))


def overlapping_texts(figure: Figure) -> list[tuple[str, str]]:
    """Pairs of texts in a figure whose upright boxes overlap by more than `TOUCHING`."""
    figure.draw_without_rendering()
    # Matplotlib keeps labels of ticks beyond the ends of an axis, which it does not draw.
    beyond = {
        label
        for axes in figure.axes
        for axis in (axes.xaxis, axes.yaxis)
        for tick in [*axis.get_major_ticks(), *axis.get_minor_ticks()]
        if not min(axis.get_view_interval()) <= tick.get_loc() <= max(axis.get_view_interval())
        for label in (tick.label1, tick.label2)
    }
    texts = [text for text in figure.findobj(Text) if text.get_visible() and text not in beyond]
    texts = [text for text in texts if text.get_text().strip()]
    boxes = [Text.get_window_extent(text).padded(-figure.dpi / 72 * TOUCHING) for text in texts]
    return [
        (a.get_text(), b.get_text())
        for (a, first), (b, second) in combinations(zip(texts, boxes, strict=True), 2)
        if first.overlaps(second)
    ]


def _folder():
    """Folder for the files of a result: that of the workflow's job, else one for experiments."""
    given = os.environ.get(paths.WRITE_VARIABLE)
    return Path(given) if given else _scratch()


@cache
def _scratch():
    folder = paths.BUILD / "scratch"
    print(f"This is no run of the workflow: results are written to {paths.shown(folder)}.")
    return folder


def as_saved(numbers: Any, digits: int = DIGITS) -> Any:
    """Numbers of a table, series or array, rounded to the digits with which they are saved."""

    def rounded(value):
        return float(f"{value:.{digits}g}") + 0.0 if isinstance(value, float) else value

    if isinstance(numbers, pd.DataFrame | pd.Series):
        return numbers.map(rounded)
    return np.vectorize(rounded, otypes=[float])(numbers) if np.size(numbers) else numbers


def rounded_up(value: float, digits: int = 2) -> str:
    """Text of an upper bound above zero: rounded upwards to significant digits.

    >>> rounded_up(1.044), rounded_up(56.2), rounded_up(1878, 3)
    ('1.1', '57', '1880')
    """
    return _rounded(value, digits, np.ceil)


def rounded_down(value: float, digits: int = 2) -> str:
    """Text of a lower bound above zero: rounded downwards to significant digits."""
    return _rounded(value, digits, np.floor)


def _rounded(value, digits, how):
    decimals = digits - 1 - int(np.floor(np.log10(value)))
    # the last digits of a solved number differ from one processor to another
    kept = how(round(value * 10.0**decimals, 6)) / 10.0**decimals
    return f"{kept:.{max(decimals, 0)}f}"


def save_table(table: pd.DataFrame, name: str) -> None:
    """Write a table to ``name.csv`` where `save` does; ``ValueError`` if a number is not finite."""
    numeric = table.select_dtypes("number")
    bad = ~np.isfinite(numeric.to_numpy())
    if bad.any():
        column = numeric.columns[bad.any(axis=0)][0]
        raise ValueError(f"all numbers of {name} must be finite, but column {column!r} has others")
    with paths.whole(_folder() / f"{name}.csv") as temporary:
        saved = as_saved(table)
        saved.to_csv(temporary, index=False, float_format=f"%.{DIGITS}g", lineterminator="\n")


def save_numbers(name: str, numbers: Mapping[str, Mapping[str, Any]]) -> Styler:
    """Write a notebook's numbers for the paper's statements, and show them.

    They are given as unit -> quantity -> a number, or reading of the paper's text -> number.
    """
    rows = []
    for unit, quantities in numbers.items():
        for quantity, values in quantities.items():
            readings = values if isinstance(values, Mapping) else {"reference joint": values}
            rows += [(quantity, reading, float(v), unit) for reading, v in readings.items()]
    table = pd.DataFrame(rows, columns=["quantity", "reading", "value", "unit"])
    save_table(table, name)
    return shown(table)


def shown(table: pd.DataFrame, precision: int = 4) -> Styler:
    """Table for a reader: headings without underscores, and no index."""
    styled = table.style.format(precision=precision).hide()
    return styled.format_index(lambda name: str(name).replace("_", " "), axis=1)


def tidy(*curves: tuple[str, pd.DataFrame, str, str, str | None], digits: int = 3) -> pd.DataFrame:
    """Numbers of several panels in one table, all but x as text.

    A curve is (panel, table, x, y, series): letter, DataFrame and names of its columns; a series of
    None is a single one, called ``y``. The figure draws the significant digits of y too, by
    ``as_saved(values, digits)``. Three are enough on a logarithmic axis.
    """
    parts = []
    for panel, table, x, y, series in curves:
        names = y if series is None else table[series].astype(str)
        columns = {"panel": panel, "series": names, "x_meaning": x, "x": table[x], "y_meaning": y}
        parts.append(pd.DataFrame(columns | {"y": (table[y] + 0.0).map(f"{{:.{digits}g}}".format)}))
    return pd.concat(parts, ignore_index=True)
