"""One style for every figure, one colour and marker per law, and saving with the numbers drawn.

A figure is written as PNG together with a CSV of what it shows; both have the same bytes
whenever their content is the same.
"""

from contextlib import ExitStack
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
import pandas as pd
from cycler import cycler
from IPython.display import Image, display
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from study import paths

STYLE = {
    "figure.dpi": 100,
    "savefig.dpi": 200,
    "figure.constrained_layout.use": True,
    "font.size": 9,
    "axes.titlesize": 9,
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
    """How a law or the elastic solution is drawn, everywhere."""

    label: str
    color: str
    marker: str
    line: str = "-"


# Okabe and Ito's colours, which colour-blind readers can tell apart
LOOKS = {
    "exact": Look("elastic solution", "#000000", "o", "none"),
    "hertz": Look("Hertz", "#0072B2", "s", "--"),
    "steuermann": Look("Steuermann", "#56B4E9", "v", "-."),
    "liu": Look("Liu (reconstructed)", "#009E73", "^", ":"),
    "winkler": Look("Winkler (fitted)", "#E69F00", "D", "--"),
    "hyperbolic_winkler": Look("hyperbolic Winkler", "#D55E00", "P", "-"),
    "stiffened_hertz": Look("stiffened Hertz (for a free ball)", "#CC79A7", "X", "-"),
    "tabulated": Look("table of the solver", "0.4", "h", "-"),
}


# Models of the mechanism's links; the rigid ones are drawn behind the others
MODEL_LOOKS = {
    "rigid": Look("rigid links", "#000000", "o"),
    "particles": Look("particles", "#0072B2", "s"),
    "beams": Look("finite elements", "#D55E00", "^", "--"),
}


METHOD_LOOKS = {
    "series": Look("series, 10,000 orders", "#000000", "o"),
    "series of few orders": Look("series, fewest orders", "#000000", "o", ":"),
    "six-node triangles": Look("six-node triangles", "#0072B2", "s"),
    "three-node triangles": Look("three-node triangles", "#56B4E9", "^"),
    "CAX6": Look("CalculiX CAX6", "#D55E00", "D"),
    "CAX6, node to surface": Look("CalculiX CAX6, node to surface", "#D55E00", "D", ":"),
    "CAX3": Look("CalculiX CAX3", "#E69F00", "v"),
    "Rodas5P, events": Look("this study (Rodas5P, events)", "#000000", "o"),
    "symplectic Euler": Look("symplectic Euler", "#E69F00", "v"),
    "lagged": Look("central difference, lagged", "#E69F00", "^", ":"),
    "centred": Look("central difference, centred", "#D55E00", "D"),
    "velocity Verlet": Look("velocity Verlet", "#CC79A7", "P"),
    "RK4": Look("RK4", "#0072B2", "s"),
    "LSODA": Look("LSODA (SciPy)", "#56B4E9", "o", "--"),
    "Radau": Look("Radau (SciPy)", "#56B4E9", "s", "-."),
    "DOP853": Look("DOP853 (SciPy)", "#56B4E9", "^", ":"),
    "CVODE": Look("CVODE (SUNDIALS)", "#009E73", "o", "--"),
    "generalised alpha": Look("generalised alpha (Exudyn)", "0.5", "X"),
}
"""Solvers of the joint and steppers of the mechanism, by `study.measure.speed`'s names."""


_style = ExitStack()  # entered by `new`, left by `save`


def new(columns=1, rows=1, width=4.2, height=3.2, **options):
    """Figure and axes in the study's style, which lasts until the figure is saved.

    The session's own settings are back after `save`: a figure is drawn between the two.

    Parameters
    ----------
    columns, rows : int
        Number of panels.
    width, height : float
        Size of one panel, in inches.
    **options
        Passed to ``matplotlib.figure.Figure.subplots``.

    Returns
    -------
    figure : matplotlib.figure.Figure
    axes : matplotlib.axes.Axes or ndarray of them
    """
    _style.close()
    _style.enter_context(mpl.rc_context())
    mpl.rcdefaults()
    mpl.rcParams.update(STYLE)
    figure = Figure(figsize=(columns * width, rows * height))
    return figure, figure.subplots(rows, columns, **options)


def draw(axes, law, x, y, **options):
    """Draw a law as a line, or the elastic solution as markers, in its look."""
    look = LOOKS[law]
    style = {"color": look.color, "label": look.label}
    if look.line == "none":
        style |= {"linestyle": "none", "marker": look.marker, "zorder": 3}
    else:
        style |= {"linestyle": look.line}
    axes.plot(x, y, **(style | options))


def shade_map(axes, x, y, percent, levels):
    """Map of a relative error in percent: shades, and labelled contours at ``levels``.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    x, y : ndarray, shapes (n,) and (m,)
    percent : ndarray, shape (m, n)
    levels : sequence of float

    Returns
    -------
    matplotlib.collections.QuadMesh
        For the colour bar.
    """
    limit = np.ceil(np.abs(percent).max() / 5) * 5
    shades = axes.pcolormesh(
        x, y, percent, cmap="RdBu_r", vmin=-limit, vmax=limit, shading="gouraud", rasterized=True
    )
    lines = axes.contour(x, y, percent, levels=levels, colors="k", linewidths=0.8)
    for text in axes.clabel(lines, fmt="%+g %%", fontsize=7, inline=False):
        text.set(rotation=0, bbox={"facecolor": "w", "edgecolor": "none", "pad": 1})
    axes.grid(False)
    return shades


def draw_bars(axes, laws, series):
    """Bars of several series side by side, one group per law.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    laws : sequence of str
        Keys of `LOOKS`.
    series : dict
        Label -> (values, colour).
    """
    places, width = np.arange(len(laws)), 0.8 / len(series)
    for k, (label, (values, color)) in enumerate(series.items()):
        shift = (k - (len(series) - 1) / 2) * width
        axes.bar(places + shift, values, 0.9 * width, color=color, label=label)
    names = [LOOKS[law].label.split(" (")[0].replace(" ", "\n") for law in laws]
    axes.set_xticks(places, names, rotation=30)
    axes.grid(False, axis="x")


def draw_models(axes, responses, column, scale=1.0, others=None):
    """Draw one quantity of several models over time, the rigid one as a broad line behind.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    responses : dict
        Key of `MODEL_LOOKS` -> study.mechanism.Response.
    column : str
        Quantity, a column of the response.
    scale : float
        Factor to the drawn unit.
    others : dict, optional
        Responses whose quantity is subtracted, model by model.
    """
    for model, response in responses.items():
        look = MODEL_LOOKS[model]
        style = {"color": look.color, "linewidth": 0.9, "linestyle": look.line}
        if model == "rigid":
            style |= {"color": "0.75", "linewidth": 3.5}
        base = getattr(others[model], column) if others else 0.0
        values = scale * (getattr(response, column) - base)
        axes.plot(1e3 * response.time, values, label=look.label, **style)
    axes.set_xlabel("time (ms)")


def mark_peaks(axes, responses):
    """Mark the force's peak of every impact that has ended, which outputs may miss."""
    for model, response in responses.items():
        ended = response.impacts.dropna()
        look = MODEL_LOOKS[model]
        style = {"color": "0.45" if model == "rigid" else look.color, "markersize": 3}
        style["label"] = f"peaks, {look.label}"
        middle = 1e3 * (ended.time + ended.duration / 2)
        axes.plot(middle, ended.peak_force, look.marker, linestyle="none", **style)


def draw_trajectory(axes, response, clearance):
    """Draw the ball's centre in the circle of the clearance, in micrometres, time as colour.

    Returns the collection, for a colour bar in ms.
    """
    x, y = 1e6 * response.eccentricity_x, 1e6 * response.eccentricity_y
    axes.add_patch(Circle((0, 0), 1e6 * clearance, fill=False, color="k", linewidth=0.8))
    points = np.column_stack([x, y])[:, None]
    path = LineCollection(np.hstack([points[:-1], points[1:]]), cmap="viridis", linewidth=1)
    path.set_array(1e3 * response.time[:-1])
    axes.add_collection(path)
    limit = 1.08e6 * clearance
    axes.set(xlim=(-limit, limit), ylim=(-limit, limit), aspect="equal")
    axes.set(xlabel="$e_x$ (µm)", ylabel="$e_y$ (µm)")
    return path


def draw_impacts(over_time, over_depth, response):
    """Draw each impact's force over time, and over depth as a loop, one shade per impact."""
    depth, force, time = 1e6 * response.depth, response.normal_force, 1e3 * response.time
    shades = mpl.colormaps["viridis"](np.linspace(0, 0.9, max(len(response.impacts), 1)))
    ends = response.impacts.time + response.impacts.duration
    for shade, start, end in zip(shades, 1e3 * response.impacts.time, 1e3 * ends, strict=True):
        during = (time >= start) & (time <= end)
        over_time.plot(time[during], force[during], color=shade, linewidth=1)
        over_depth.plot(depth[during], force[during], color=shade, linewidth=1)
    over_time.set(xlabel="time (ms)", ylabel="normal force (N)")
    over_depth.set(xlabel="depth (µm)", ylabel="normal force (N)")


def draw_contact_times(axes, impacts, duration):
    """Draw when each of several runs is in contact: a row per run, bars from touch to parting.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    impacts : dict
        (links, variant) -> impacts of its response.
    duration : float
        In ms.
    """
    names = {"rigid links": LOOKS["exact"].color, "particles": MODEL_LOOKS["particles"].color}
    for row, ((links, _), table) in enumerate(impacts.items()):
        spans = 1e3 * table[["time", "duration"]].to_numpy()
        axes.broken_barh(spans, (row - 0.35, 0.7), facecolor=names[links], alpha=0.35)
        axes.vlines(spans[:, 0], row - 0.35, row + 0.35, color=names[links], linewidth=0.6)
    axes.set_yticks(range(len(impacts)), [f"{name} · {links}" for links, name in impacts])
    axes.set(
        xlim=(0, duration),
        ylim=(len(impacts) - 0.5, -0.5),
        xlabel="time (ms); tick: touch, pale: contact",
    )
    axes.grid(False, axis="y")


def draw_law_costs(axes, rows, cost, front):
    """Draw the largest (full) and RMS error (hollow) of each law over its relative cost.

    The solution at every call is beyond the axis, and named at its edge.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    rows : pandas.DataFrame
        Chart ``laws`` of ``study.measure.speed``.
    cost : {"relative", "vectorised"}
        Column.
    front : pandas.DataFrame
        Rows of the Pareto front of the largest error, joined by a line.
    """
    solver, laws = rows[rows.method == "solver"].iloc[0], rows[rows.method != "solver"]
    axes.plot(front[cost], front.largest_error, color="0.8", linewidth=5, zorder=0, label="front")
    for row in laws.itertuples():
        look = LOOKS[row.method]
        x, ends = getattr(row, cost), (row.rms_error, row.largest_error)
        axes.plot([x, x], ends, color=look.color, linewidth=0.8)
        axes.plot(x, ends[0], look.marker, color=look.color, markerfacecolor="w", markersize=6)
        axes.plot(x, ends[1], look.marker, color=look.color, markersize=6, label=look.label)
    text = f"beyond the right edge:\nsolved at every call,\n{solver[cost]:,.0f} times, "
    text += f"{solver.largest_error:.0e}"
    axes.text(0.03, 0.05, text, transform=axes.transAxes, fontsize=8)
    right = 1.25 * laws[cost].max()
    axes.set(yscale="log", xlim=(0, right), xlabel="time over that of Hertz's law")


def draw_times(axes, rows, front):
    """Draw error over time, a line per method, quartiles as bars, the Pareto front behind.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    rows : pandas.DataFrame
        One chart of ``study.measure.speed``.
    front : pandas.DataFrame
        Rows of the Pareto front.
    """
    axes.set(xscale="log", yscale="log", xlabel="time (s)")
    axes.plot(front.time, front.rms_error, color="0.75", linewidth=5, zorder=0, label="front")
    for method, part in rows.groupby("method", sort=False):
        look, part = METHOD_LOOKS[method], part.sort_values("time")
        spread = abs(part[["time_low", "time_high"]].to_numpy().T - part.time.to_numpy())
        style = {"color": look.color, "marker": look.marker, "linestyle": look.line}
        axes.errorbar(part.time, part.rms_error, xerr=spread, label=look.label, **style)
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), fontsize=8)


def draw_choice(axes, table, column):
    """Map of the cheapest adequate law over the largest depth and one parameter of the joint.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    table : pandas.DataFrame
        Columns depth_star, law and ``column``, on a grid.
    column : str
        What is drawn upwards.

    Returns
    -------
    list of str
        The laws in the map.
    """
    laws = [law for law in CHOICES if law in set(table.law)]
    codes = table.law.map({law: n for n, law in enumerate(CHOICES)})
    grid = table.assign(code=codes).pivot(index=column, columns="depth_star", values="code")
    colors = mpl.colors.ListedColormap([color for _, color in CHOICES.values()])
    limits = {"cmap": colors, "vmin": -0.5, "vmax": len(CHOICES) - 0.5, "shading": "nearest"}
    axes.pcolormesh(grid.columns, grid.index, grid, rasterized=True, **limits)
    axes.set(xscale="log", yscale="log")
    if column == "socket_ratio":
        axes.set_yticks(RATIO_TICKS, [f"{tick:g}" for tick in RATIO_TICKS])
        axes.minorticks_off()
    axes.grid(False)
    return laws


RATIO_TICKS = (1.1, 1.5, 2.0, 3.0)


def label_choices(figure, axes, laws):
    """Name the laws of `draw_choice`'s maps below them, and their common horizontal axis."""
    handles = [
        mpl.patches.Patch(color=color, label=label)
        for law, (label, color) in CHOICES.items()
        if law in laws
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
    for panel in axes[-1]:
        panel.set_xlabel("largest " + DEPTH.split(" ", 1)[1])


CHOICES = {
    law: (LOOKS[law].label.split(" (")[0], LOOKS[law].color)
    for law in ("hertz", "steuermann", "liu", "winkler", "hyperbolic_winkler", "stiffened_hertz")
} | {"tabulated": (LOOKS["tabulated"].label, "0.6")}


DEPTH_TICKS = (0.05, 0.1, 0.2, 0.5, 1.0)


def shade_reach(axes, law, table, levels, limit, scale="log"):
    """Map of a law's relative error in percent over depth, clipped at +-``limit``.

    Contours at ``levels`` are labelled one below the other; rows of the table with NaN, where
    the law is not defined, are left out and their place is hatched. The title names the law
    and its whole range of errors, unclipped.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    law : str
        Key of `LOOKS`.
    table : pandas.DataFrame
        Error in percent; rows in rising order of what is drawn upwards, a column per depth_star.
    levels : sequence of float
    limit : float
        Largest error that the shades tell apart, in percent.
    scale : {"log", "linear"}
        Of the vertical axis.

    Returns
    -------
    matplotlib.contour.QuadContourSet
        For the colour bar.
    """
    axes.set(xscale="log", yscale=scale, ylim=(table.index[0], table.index[-1]))
    table = table.dropna()
    x, y, percent = table.columns, table.index, table.to_numpy()
    bands = np.linspace(-limit, limit, 81)
    shades = axes.contourf(x, y, percent, levels=bands, cmap="RdBu_r", extend="both")
    inside = [level for level in levels if percent.min() < level < percent.max()]
    if inside:
        lines = axes.contour(x, y, percent, levels=inside, colors="k", linewidths=0.8)
        _label_in_steps(axes, lines)
    axes.patch.set(facecolor="0.95", hatch="///", edgecolor="0.7")
    axes.set_title(f"{LOOKS[law].label}: {percent.min():+.1f} to {percent.max():+.1f} %")
    axes.set_xticks(DEPTH_TICKS, [f"{tick:g}" for tick in DEPTH_TICKS])
    axes.minorticks_off()
    axes.grid(False)
    return shades


def _label_in_steps(axes, lines):
    """Label contours at heights that differ and apart, so that close ones stay legible."""
    axes.autoscale_view()
    heights = np.linspace(0.9, 0.1, len(lines.levels)) if len(lines.levels) > 1 else [0.5]
    placed = np.empty((0, 2))
    for level, path, height in zip(
        lines.levels[::-1], lines.get_paths()[::-1], heights, strict=True
    ):
        path = (axes.transScale + axes.transLimits).transform_path(path)
        pieces = [mpl.path.Path(p).interpolated(8) for p in path.to_polygons(closed_only=False)]
        points = np.vstack([piece.vertices for piece in pieces])
        off_edge = np.abs(points - np.clip(points, 0.1, 0.9)).sum(axis=1)
        apart = np.abs(points[:, None] - placed) / (0.16, 0.07)  # in sizes of a label
        crowd = np.clip(1.2 - apart.max(axis=2), 0, None).sum(axis=1)
        place = points[np.argmin(np.abs(points[:, 1] - height) + off_edge + 3 * crowd)]
        place = np.clip(place, 0.08, 0.92)
        placed = np.vstack([placed, place])
        style = {"fontsize": 7, "ha": "center", "va": "center", "transform": axes.transAxes}
        box = {"facecolor": "w", "edgecolor": "none", "alpha": 0.8, "pad": 0.8}
        axes.text(*place, f"{level:+g} %", bbox=box, **style)


VERDICT_COLORS = {
    "contradicted": "#D55E00",
    "cannot be decided": "0.7",
    "reproduced": "#009E73",
}


def draw_verdicts(axes, counts):
    """Draw how many statements have each verdict, a bar per part with the counts in it.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    counts : pandas.DataFrame
        A row per part, a column per key of `VERDICT_COLORS`.
    """
    left = np.zeros(len(counts))
    for verdict, color in VERDICT_COLORS.items():
        bars = axes.barh(counts.index, counts[verdict], left=left, color=color, label=verdict)
        axes.bar_label(bars, [f"{n or ''}" for n in counts[verdict]], label_type="center")
        left += counts[verdict]
    axes.invert_yaxis()
    axes.set_xlabel("number of statements")
    axes.legend(loc="upper left", bbox_to_anchor=(0, 1.12), ncols=4, fontsize=8)
    axes.grid(False, axis="y")


def draw_errors(axes, cases, color, label):
    """Draw the relative error of every case over the root of the depth, as thin lines.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    cases : pandas.DataFrame
        Columns ``case``, ``depth_star`` and ``relative_error_percent``.
    color, label : str
    """
    style = {"color": color, "linewidth": 0.6, "alpha": 0.7}
    for _, case in cases.groupby("case", sort=False):
        axes.plot(np.sqrt(case.depth_star), case.relative_error_percent, **style)
    axes.plot([], [], color=color, label=f"{label}: {cases.case.nunique()} curves")


def save(figure, name, numbers):
    """Write ``figures/name.png`` and its numbers to ``figures/name.csv``, and show the image.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    name : str
    numbers : pandas.DataFrame
        What the figure draws, in tidy form.
    """
    path = paths.results() / f"{name}.png"
    with _style:
        save_table(numbers, name)
        with paths.whole(path) as temporary:
            figure.savefig(temporary, metadata={"Software": None})
    display(Image(path, width=round(72 * figure.get_figwidth())))


def save_table(table, name):
    """Write a table to ``figures/name.csv``, with 9 significant digits.

    Parameters
    ----------
    table : pandas.DataFrame
    name : str

    Raises
    ------
    ValueError
        If a number of the table is NaN or infinite.
    """
    numeric = table.select_dtypes("number")
    bad = ~np.isfinite(numeric.to_numpy())
    if bad.any():
        column = numeric.columns[bad.any(axis=0)][0]
        raise ValueError(f"every number of {name} must be finite, column {column!r} is not")
    with paths.whole(paths.results() / f"{name}.csv") as temporary:
        positive = table.map(
            lambda value: 0.0 if value == 0 and isinstance(value, float) else value
        )
        positive.to_csv(temporary, index=False, float_format="%.9g", lineterminator="\n")


def tidy(*curves):
    """Numbers of several panels in one table, with 3 digits of what is drawn upwards.

    Parameters
    ----------
    *curves : tuple
        (panel, table, x, y, series): letter, DataFrame and names of its columns; a series of
        None is a single one, called ``y``.

    Returns
    -------
    pandas.DataFrame
        Columns panel, series, x_is, x, y_is, y, all but x as text.
    """
    parts = []
    for panel, table, x, y, series in curves:
        names = y if series is None else table[series].astype(str)
        columns = {"panel": panel, "series": names, "x_is": x, "x": table[x], "y_is": y}
        parts.append(pd.DataFrame(columns | {"y": (table[y] + 0.0).map("{:.3g}".format)}))
    return pd.concat(parts, ignore_index=True)
