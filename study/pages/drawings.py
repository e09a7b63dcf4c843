"""The paper's drawings, to scale: joint, pressure, foundations, procedure, mesh, mechanism.

Lengths are in socket radii R2 unless stated otherwise, the contact is below, and polar angles
are measured from the downward vertical. Functions that draw shapes return them by name, for
`table`: the numbers beside the figure.
"""

import numpy as np
import pandas as pd
from matplotlib.collections import LineCollection
from matplotlib.patches import Arc, Circle, FancyBboxPatch, Rectangle

from study import checks
from study.contact import SOCKET_RATIO, pressure
from study.pages.figures import LOOKS, draw

SOCKET, BALL = LOOKS["hertz"].color, LOOKS["hyperbolic_winkler"].color
OPENING, ROD = np.radians(38), np.radians(16)  # half-angles, of the socket and of the ball
PEAK = 0.45  # length of the largest arrow of a pressure

PROCEDURE = (
    ("Choose the cases", "study/design.py", "$R_2^*$", ""),
    ("Solve each case", "study/joint.py, study/dataset.py", r"$\delta^*$", "$P^*$"),
    ("Fit a coefficient to each case", "study/fitting.py", r"$\delta^*$", "$P^*$"),
    ("Fit a surrogate to the coefficients", "study/fitting.py", "$R_2^*$", "$f_1$"),
    ("Check the surrogate", "study/statistics.py", "$R_2^*$", "error"),
    ("State the law", "study/contact/laws.py", r"$\delta^*$", "$P^*$"),
)
"""Steps of `draw_procedure`: title, module, and what its small picture shows over what."""


def table(**panels):
    """What is drawn, one row per point: columns panel, part, x and y.

    Parameters
    ----------
    **panels : dict
        Panel = {part: ndarray of shape (2, n)}.

    Returns
    -------
    pandas.DataFrame
    """
    parts = [
        pd.DataFrame({"panel": panel, "part": part, "x": points[0], "y": points[1]})
        for panel, outlines in panels.items()
        for part, points in outlines.items()
    ]
    return pd.concat(parts, ignore_index=True).round({"x": 6, "y": 6})


def polar(radius, angle, centre=(0.0, 0.0)):
    """Points at polar angles (rad) from the downward vertical, shape (2, ...)."""
    x, y = radius * np.sin(angle), -radius * np.cos(angle)
    return np.array([x + centre[0], y + centre[1]])


def _frame(axes, left, right, bottom, top):
    axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    axes.set_axis_off()


def _line(axes, points, color="k", style="-", width=0.8):
    axes.plot(*np.asarray(points), color=color, linestyle=style, linewidth=width)


def _fill(axes, outline, color, strength=0.2, width=1.2, hatch=None):
    axes.fill(*outline, facecolor=(color, strength), edgecolor=color, linewidth=width)
    if hatch:
        axes.fill(*outline, facecolor="none", edgecolor=(color, 0.35), hatch=hatch, linewidth=0)


def _name(axes, text, at, color="k", **style):
    axes.text(*at, text, color=color, **({"ha": "center", "va": "center"} | style))


def _point(axes, text, at, start, color="k"):
    """Name what is ``at`` a point, from ``start``, with a thin leader."""
    leader = {"arrowstyle": "-", "linewidth": 0.6, "color": color, "shrinkA": 0, "shrinkB": 0}
    axes.annotate(text, at, start, color=color, ha="center", va="center", arrowprops=leader)


def _arrow(
    axes, start, end, text="", shift=0.0, along=0.5, *, kind="-|>", color="k", width=0.9, size=8
):
    """Arrow, or dimension line of kind ``<|-|>``, with its name ``shift`` to the left of it."""
    start, end = np.asarray(start), np.asarray(end)
    style = {"arrowstyle": kind, "mutation_scale": size, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, start, arrowprops=style | {"linewidth": width, "color": color})
    left = np.array([start[1] - end[1], end[0] - start[0]]) / np.hypot(*(end - start))
    _name(axes, text, start + along * (end - start) + shift * left, color)


def _arrows(axes, tails, tips, color):
    scale = {"angles": "xy", "scale_units": "xy", "scale": 1, "width": 0.0045}
    axes.quiver(*tails, *(tips - tails), color=color, headwidth=4, headlength=5, zorder=3, **scale)


def _springs(axes, feet, heads, width):
    """Springs as zigzags between ``feet`` and ``heads``, each of shape (2, n)."""
    place = np.array([0, 0.1, *np.linspace(0.14, 0.86, 12), 0.9, 1])
    side = width * np.array([0, 0, *np.resize([0.5, -0.5], 12), 0, 0])
    along = heads - feet
    across = np.array([-along[1], along[0]]) / np.hypot(*along)
    lines = feet[..., None] + along[..., None] * place + across[..., None] * side
    axes.add_collection(LineCollection(lines.transpose(1, 2, 0), color=SOCKET, linewidth=0.7))


def _bodies(axes, r2_star, socket_ratio, centre):
    """Section of a socket open to the top and of a ball with its rod: their outlines."""
    inner = np.linspace(OPENING - np.pi, np.pi - OPENING, 181)
    socket = np.hstack([polar(1, inner), polar(socket_ratio, inner[::-1])])
    surface = np.linspace(ROD - np.pi, np.pi - ROD, 181)
    surface = polar(1 - 1 / r2_star, surface, centre)
    ball = np.hstack([surface, [surface[0, [-1, 0]], [1.2 * socket_ratio] * 2]])
    _fill(axes, socket, SOCKET, hatch="////")
    _fill(axes, ball, BALL)
    return {"socket": socket, "ball and rod": ball}


def _centres(axes, ball_centre, socket_at, ball_at):
    """Mark both centres, with their names at places relative to them."""
    for place, shift, name, color in (
        (np.zeros(2), socket_at, "$x_S$", SOCKET),
        (ball_centre, ball_at, "$x_B$", BALL),
    ):
        axes.plot(*place, "o", color=color, markersize=5, zorder=4)
        _point(axes, name, place, place + np.array(shift), color)


def draw_radii(axes, r2_star, socket_ratio=SOCKET_RATIO):
    """Draw the joint with ball and socket concentric: radii and clearance.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    r2_star : float
        Dimensionless socket radius R2/dR, > 1.
    socket_ratio : float
        Outer over inner radius of the socket, > 1.

    Returns
    -------
    dict
        Outlines by name, each of shape (2, n).

    Raises
    ------
    ValueError
        For a value outside its range; so do all functions here.
    """
    checks.number("r2_star", r2_star, above=1, scalar=True)
    checks.number("socket_ratio", socket_ratio, above=1, scalar=True)
    parts = _bodies(axes, r2_star, socket_ratio, (0, 0))
    ball_radius = 1 - 1 / r2_star
    for radius, angle, along, name in (
        (ball_radius, -1.1, 0.5, "$R_1$"),
        (1, -0.15, 0.38, "$R_2$"),
        (socket_ratio, 0.8, 0.35, "$R_{2o}$"),
    ):
        _arrow(axes, (0, 0), polar(radius, angle), name, 0.1, along)
    axes.plot(0, 0, "ko", markersize=4)
    gap = polar(np.array([ball_radius, 1]), 1.75)
    _arrow(axes, *gap.T, kind="<|-|>")
    _point(axes, r"$\Delta R$", gap.mean(axis=1), polar(1.3 * socket_ratio, 1.75))
    _name(axes, "ball", (0, 0.35), BALL)
    _name(axes, "socket", polar(1.22 * socket_ratio, -0.75), SOCKET)
    _frame(axes, -1.75, 1.75, -1.25, 1.45)
    return parts


def draw_eccentricity(axes, r2_star, eccentricity_star, direction, socket_ratio=SOCKET_RATIO):
    """Draw the ball off the socket's centre: eccentricity, and the gaps it leaves.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    r2_star, socket_ratio : float
        As for `draw_radii`.
    eccentricity_star : float
        Distance |e|/dR of the centres, > 0 and < 1: no contact.
    direction : float
        Polar angle of e, from -1.2 to 1.2 rad.

    Returns
    -------
    dict
        Outlines by name, each of shape (2, n).
    """
    checks.number("r2_star", r2_star, above=1, scalar=True)
    distance = checks.number("eccentricity_star", eccentricity_star, above=0, below=1, scalar=True)
    checks.number("direction", direction, "rad", least=-1.2, most=1.2, scalar=True)
    centre = polar(distance / r2_star, direction)
    parts = _bodies(axes, r2_star, socket_ratio, centre)
    reach = polar(1 / r2_star, np.linspace(0, 2 * np.pi, 181))
    _line(axes, reach, style=":")
    _arrow(axes, (0, 0), centre, width=1.5)
    _centres(axes, centre, (-0.42, 0.1), (0.35, -0.25))
    _point(axes, "$e$", centre / 2, centre / 2 + 0.28)
    _point(axes, r"radius $\Delta R$", reach[:, 165], (-0.1, -0.52))
    for angle, sign in ((direction, "-"), (direction - np.pi, "+")):
        far = polar(1, angle)
        near = far - polar((1 + float(sign + "1") * distance) / r2_star, angle)
        _arrow(axes, near, far, kind="<|-|>")
        _point(axes, rf"$\Delta R{sign}|e|$", (near + far) / 2, 1.4 * socket_ratio * far)
    _frame(axes, -1.75, 1.75, -1.25, 1.45)
    return parts | {"reach of the ball's centre": reach, "e": np.array([(0, 0), centre]).T}


def draw_penetration(whole, near, r2_star, depth_star, direction, socket_ratio=SOCKET_RATIO):
    """Draw the overlap of the undeformed bodies in contact, and the contact enlarged.

    Parameters
    ----------
    whole, near : matplotlib.axes.Axes
    r2_star, socket_ratio, direction : float
        As for `draw_eccentricity`.
    depth_star : float
        Dimensionless penetration depth d/dR, > 0 and < sqrt(2 R2* - 1) - 1.

    Returns
    -------
    dict
        Outlines by name, each of shape (2, n); ``depth`` joins both surfaces along e.
    """
    checks.number("r2_star", r2_star, above=1, scalar=True)
    checks.number("direction", direction, "rad", least=-1.2, most=1.2, scalar=True)
    widest = np.sqrt(2 * r2_star - 1) - 1
    depth = checks.number("depth_star", depth_star, above=0, below=widest, scalar=True) / r2_star
    ball_radius, distance = 1 - 1 / r2_star, depth + 1 / r2_star
    centre = polar(distance, direction)
    swing = np.linspace(-1, 1, 181)
    at_socket = np.arccos((1 + distance**2 - ball_radius**2) / (2 * distance))
    at_ball = np.arcsin(np.sin(at_socket) / ball_radius)
    rim = polar(1, direction + at_socket * swing)
    lens = np.hstack([rim, polar(ball_radius, direction - at_ball * swing, centre)])
    depths = polar(np.array([1, 1 + depth]), direction)
    for axes in (whole, near):
        parts = _bodies(axes, r2_star, socket_ratio, centre)
        _fill(axes, lens, "k", 0.3, 0)
    side = polar(1, direction + np.pi / 2)
    rows = (
        (-0.17, 0, 1, "$R_2$"),
        (-0.17, 1, 1 + depth, ""),
        (0.17, 0, distance, "$|e|$"),
        (0.17, distance, 1 + depth, "$R_1$"),
    )
    for shift, start, end, name in rows:
        ends = polar(np.array([start, end]), direction) + shift * side[:, None]
        _arrow(whole, *ends.T, name, np.sign(shift) * 0.09, kind="<|-|>")
        for place in (start, end):
            foot = polar(place, direction)
            _line(whole, np.array([foot, foot + 1.15 * shift * side]).T, width=0.5)
    _line(whole, polar(np.array([0, 1 + depth]), direction), style="-.", width=0.6)
    delta = polar(1 + depth / 2, direction) - 0.17 * side
    _point(whole, r"$\delta$", delta, delta + 0.42 * polar(1, direction - 0.5))
    _centres(whole, centre, -0.32 * side, 0.34 * side)
    _arrow(near, *depths.T, r"$\delta$", 0.04, kind="<|-|>")
    force = 0.2 * polar(1, direction)
    for point, sign, body, color in (
        (depths[:, 0], -1, "ball", BALL),
        (depths[:, 1], 1, "socket", SOCKET),
    ):
        tip = point + sign * force
        _arrow(near, point, tip, color=color, width=2)
        _name(near, f"$F_N$ on the {body}", tip + 0.3 * sign * force, color)
    middle, half = depths.mean(axis=1), 0.42
    limits = np.array([middle - half, middle + half]).T.ravel()
    _frame(near, *limits)
    _frame(whole, -1.45, 1.45, -1.25, 1.45)
    return parts | {"overlap": lens, "depth": depths, "e": np.array([(0, 0), centre]).T}


def draw_hertz(axes):
    """Draw Hertz's pressure over the circle of contact, lengths in a and pressure in p0.

    Parameters
    ----------
    axes : matplotlib.axes.Axes

    Returns
    -------
    dict
        Outlines by name, each of shape (2, n).
    """
    color, turn = LOOKS["hertz"].color, np.linspace(0, 2 * np.pi, 181)
    circle = np.array([np.cos(turn), 0.25 * np.sin(turn)])  # seen obliquely
    dome = np.array([np.cos(turn[:91]), np.sin(turn[:91])])
    _fill(axes, circle, "0.6", 0.4, 0.8)
    _fill(axes, dome, color, width=0)
    _line(axes, dome, color, width=1.5)
    x = np.linspace(-0.9, 0.9, 13)
    tails = np.array([x, np.sqrt(1 - x**2)])
    _arrows(axes, tails, tails * [[1], [0]], color)
    _arrow(axes, (-1.18, 0), (-1.18, 1), "$p_0$", 0.13, kind="<|-|>")
    _arrow(axes, (0, -0.42), (1, -0.42), "$a$", -0.1, kind="<|-|>")
    _arrow(axes, (0, -0.13), (x[10], -0.13), "$r$", -0.08, kind="<|-|>")
    for across, up in (
        ((-1.26, 0), (0, 0)),
        ((-1.26, 0), (1, 1)),
        ((0, 0), (0, -0.5)),
        ((1, 1), (0, -0.5)),
        ((x[10], x[10]), (0, -0.2)),
    ):
        _line(axes, (across, up), width=0.5)
    _point(axes, "$p(r)$", tails[:, 10], (1.05, 1.0))
    _name(axes, "circle of contact", (-0.65, -0.42))
    _frame(axes, -1.45, 1.45, -0.65, 1.12)
    return {"circle of contact": circle, "pressure": dome}


def draw_pressures(axes, curve):
    """Draw the exact pressure and Hertz's over the distance from the contact's axis.

    The exact one is drawn at the solution's nodes, but for those at the axis and next to the
    contact's edge, where it oscillates.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    curve : study.joint.ForceCurve
        Its depths are drawn, each > 0.

    Returns
    -------
    dict
        Distance r/R2 and pressure in E* dR/R2 by law and depth, each of shape (2, n).
    """
    parts, r2_star = {}, curve.joint.r2_star
    solved = curve.depth_star, curve.contact_half_angle, curve.pressure
    for depth, angle, exact in zip(*solved, strict=True):
        nodes = slice(1, np.count_nonzero(exact) - 2)
        edge = pressure.contact_radius(depth, r2_star)
        radius = edge * np.sin(np.linspace(0, np.pi / 2, 61))
        inside = np.array([np.sin(curve.angles[nodes]), exact[nodes]])
        inside = np.hstack([inside, [[np.sin(angle)], [0.0]]])
        hertz = np.array([radius, pressure.hertz_pressure(radius, depth, r2_star)])
        draw(axes, "exact", *inside, linestyle="-", marker="")
        draw(axes, "hertz", *hertz)
        parts |= {f"exact, depth_star {depth:g}": inside, f"hertz, depth_star {depth:g}": hertz}
        axes.annotate(rf"$\delta^*={depth:g}$", (max(edge, np.sin(angle)) + 0.01, 0.02), fontsize=8)
    axes.set(xlabel="distance from the axis $r/R_2$", ylabel=r"pressure $p\,R_2/(E^*\Delta R)$")
    axes.set(xlim=(0, axes.get_xlim()[1] + 0.1), ylim=(0, None))
    axes.legend(handles=axes.lines[:2])
    return parts


def _foundation(axes, place, span, edge, depth, height, color):
    """Draw springs from ``-height`` to the pressed surface, and the pressure as arrows.

    ``place`` maps a coordinate along the surface and an elevation above it to x and y, so that
    the flat foundation and the one along the socket's arc are the same drawing.
    """
    checks.number("depth over the foundation's height", depth / height, below=1)

    def share(s):
        return np.clip(1 - (s / edge) ** 2, 0, None)

    s = np.linspace(-span, span, 301)
    spots = np.linspace(-0.97 * span, 0.97 * span, 41)
    ground = np.hstack([place(s, -height), place(s[::-1], -height - 0.1)])
    _fill(axes, ground, "0.4", 0.1, 0, "////")
    _line(axes, ground[:, : s.size], width=1.2)
    heads = place(spots, -depth * share(spots))
    _springs(axes, place(spots, -height), heads, 1.1 * span / spots.size)
    surface = place(s, -depth * share(s))
    _line(axes, surface, SOCKET, width=1.8)
    _line(axes, place(s, 0 * s), SOCKET, ":")
    spots = (np.arange(18) - 8.5) * edge / 9
    _arrows(axes, *(place(spots, (up - depth) * share(spots)) for up in (0, PEAK)), color)
    s = s * edge / span
    _line(axes, place(s, (PEAK - depth) * share(s)), color, width=1)
    _arrow(axes, place(0, 0), place(0, -depth), kind="<|-|>", size=4)
    _point(axes, r"$\delta$", place(0, -depth / 2), place(0, PEAK + 0.02))
    return {"foundation": surface, "pressure": np.array([spots, share(spots)])}


def draw_foundation(axes, r2_star, depth_star):
    """Draw a flat Winkler foundation under a rigid indenter, of the height that K = E* implies.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    r2_star : float
        Dimensionless socket radius, > 1: the indenter's radius is R = R1 R2/dR.
    depth_star : float
        Dimensionless penetration depth, > 0.

    Returns
    -------
    dict
        Outlines by name, each of shape (2, n); ``pressure`` over its peak K d/h, at places x.
    """
    height = pressure.foundation_height("winkler", r2_star)
    depth = checks.number("depth_star", depth_star, above=0, scalar=True) / r2_star
    edge = np.sqrt(2 * (r2_star - 1) * depth)
    x = np.linspace(-1.3, 1.3, 181) * edge
    profile = np.array([x, depth * (x / edge) ** 2 - depth])
    top = PEAK + 0.15
    _fill(axes, np.hstack([profile, [x[[-1, 0]], [top, top]]]), "0.5", 0.15, 1)
    span, color = 1.75 * edge, LOOKS["winkler"].color
    parts = _foundation(
        axes, lambda x, z: np.array([x, z + 0 * x]), span, edge, depth, height, color
    )
    _arrow(axes, (0, top + 0.3), (0, top), "$P$", 0.07, width=2)
    _arrow(axes, (1.04 * span, -height), (1.04 * span, 0), "$h$", -0.06, kind="<|-|>")
    _line(axes, ((span, 1.06 * span), (0, 0)), width=0.5)
    low = -height - 0.2
    _arrow(axes, (0, low), (edge, low), "$a$", -0.07, kind="<|-|>")
    for x in (0, edge):
        _line(axes, ((x, x), (0 if x else -depth, low - 0.04)), style="-.", width=0.5)
    x = edge * np.array([-4, 5.0]) / 9
    z = depth * (x / edge) ** 2 - depth
    _arrow(axes, (x[0], 0), (x[0], z[0]), kind="<|-|>", size=4)
    _point(axes, r"$u=\delta-z$", (x[0], z[0] / 2), (-1.6 * edge, 0.22))
    _point(axes, "$p=Ku/h$", (x[1], z[1] + PEAK * (1 - (x[1] / edge) ** 2)), (1.5 * edge, 0.45))
    _point(axes, "$z=x^2/2R$", profile[:, -8], (1.55 * edge, 0.22), "0.4")
    _name(axes, "rigid", (-1.05 * edge, top - 0.1), "0.4")
    _frame(axes, -1.1 * span, 1.1 * span, low - 0.12, top + 0.34)
    return {"indenter": profile} | parts


def draw_arc(axes, depth_star):
    """Draw the arc of contact in the socket: radial pressure and its vertical component.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    depth_star : float
        Dimensionless penetration depth, > 0 and <= pi^2/8.

    Returns
    -------
    dict
        Outlines by name, each of shape (2, n).
    """
    checks.number("depth_star", depth_star, above=0, scalar=True)
    alpha = float(pressure.contact_half_angle("hyperbolic_winkler", depth_star, 2.0))
    wall = np.linspace(-1.5, 1.5, 181)
    _fill(axes, np.hstack([polar(1, wall), polar(SOCKET_RATIO, wall[::-1])]), SOCKET, hatch="////")
    arc = polar(1, np.linspace(-alpha, alpha, 91))
    _line(axes, arc, BALL, width=3)
    half = round(2 + 5 * alpha)  # arrows to either side
    angles = np.arange(-half, half + 1) * alpha / (half + 0.6)
    length = PEAK * (1 - (angles / alpha) ** 2)
    tails = polar(1, angles)
    tips = (1 - length) * tails, tails + np.outer((0, 1), length * np.cos(angles))
    names = ("0.5", "radial $p$", -1), (BALL, r"vertical $p\,\cos\theta$", 1)
    for points, (color, name, side) in zip(tips, names, strict=True):
        _arrows(axes, tails, points, color)
        _point(axes, name, points[:, half + side * (half // 2)], (0.58 * side, 0.12), color)
    for x, y in polar(1, np.array([-alpha, alpha])).T:
        _line(axes, ((0, x), (0, y)), style="--", width=0.7)
    _line(axes, ((0, 0), (0, -1)), style="-.", width=0.5)
    _line(axes, polar(0.27, np.linspace(0, alpha, 31)))
    _point(axes, r"$\alpha$", polar(0.27, alpha / 2), (0.32, -0.33))
    _frame(axes, -1.25, 1.25, -1.25, 0.2)
    return {"arc of contact": arc, "tails": tails, "radial": tips[0], "vertical": tips[1]}


def draw_circumferential(axes, r2_star, depth_star):
    """Draw the foundation along the socket's arc, its pressure and the ring of integration.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    r2_star : float
        Dimensionless socket radius, > 1.
    depth_star : float
        As for `draw_arc`.

    Returns
    -------
    dict
        Outlines by name, each of shape (2, n); ``pressure`` over its peak K d/h, at polar
        angles.
    """
    height = pressure.foundation_height("hyperbolic_winkler", r2_star)
    depth = checks.number("depth_star", depth_star, above=0, scalar=True) / r2_star
    alpha = float(pressure.contact_half_angle("hyperbolic_winkler", depth_star, r2_star))
    parts = _foundation(axes, lambda t, z: polar(1 - z, t), 1.5, alpha, depth, height, BALL)
    theta, share = parts["pressure"][:, 15]
    spot = polar(1 + depth * share, theta)
    tip = spot + np.array([0, PEAK * share * np.cos(theta)])
    _arrow(axes, spot, tip, width=2, size=9)
    turn = np.linspace(0, 2 * np.pi, 181)
    ring = np.array([spot[0] * np.cos(turn), spot[1] + 0.1 * spot[0] * np.sin(turn)])
    _line(axes, ring, width=1)
    _point(axes, r"$p\,\cos\theta$", tip, (0.72, -0.12))
    _point(axes, r"ring $2\pi R_2^2\,\theta\,d\theta$", ring[:, 70], (-0.48, -0.35))
    _arrow(axes, (0, 0), polar(1, -1.35), "$R_2$", -0.1)
    _arrow(axes, (1, 0.02), (1 + height, 0.02), "$h$", 0.08, kind="<|-|>")
    for angle, radius, name, at in (
        (alpha, 0.42, r"$\alpha$", 0.86 * alpha),
        (theta, 0.24, r"$\theta$", theta / 2),
    ):
        _line(axes, np.array([(0, 0), polar(1, angle)]).T, style="--", width=0.7)
        _line(axes, polar(radius, np.linspace(0, angle, 31)))
        _name(axes, name, polar(radius + 0.08, at))
    _line(axes, ((0, 0), (0, -0.42)), style="-.", width=0.5)
    reach = 1.15 + height
    _frame(axes, -reach, reach, -reach, 0.2)
    return parts | {"ring": ring}


def draw_procedure(axes, texts):
    """Draw the way from cases to the law as a flow chart: what is done, found, and by which module.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    texts : sequence of str
        What each step of `PROCEDURE` found.

    Returns
    -------
    list of matplotlib.axes.Axes
        Small axes in each step's box, to draw in.
    """
    small, left = [], {"ha": "left", "va": "center"}
    for row, ((title, module, x, y), text) in enumerate(zip(PROCEDURE, texts, strict=True)):
        low = len(texts) - 1 - row
        box = FancyBboxPatch((0, low + 0.12), 1, 0.76, "round,pad=0,rounding_size=0.015")
        box.set(facecolor="0.97", edgecolor="0.4", mutation_aspect=8)
        axes.add_patch(box)
        _name(axes, f"{row + 1}", (0.045, low + 0.5), SOCKET, fontsize=15, fontweight="bold")
        _name(axes, title, (0.1, low + 0.74), fontweight="bold", **left)
        _name(axes, text, (0.1, low + 0.5), **left)
        _name(axes, module, (0.1, low + 0.25), "0.35", fontsize=8, family="monospace", **left)
        if low:
            _arrow(axes, (0.5, low + 0.12), (0.5, low - 0.12), width=1.2, size=12)
        inset = axes.inset_axes((0.75, low + 0.31, 0.21, 0.51), transform=axes.transData)
        inset.set(xticks=[], yticks=[], facecolor="none")
        inset.set_xlabel(x, labelpad=2, fontsize=8)
        inset.set_ylabel(y, labelpad=2, fontsize=8)
        small.append(inset)
    _frame(axes, -0.005, 1.005, 0, len(texts))
    axes.set_aspect("auto")
    return small


def draw_mesh(axes, mesh, color, radius=1.0, shift=0.0):
    """Draw a meridian's triangles upside down (contact below), scaled and moved along z."""
    r, z = radius * mesh.p[:, : mesh.t.max() + 1] * np.array([[1], [-1]])
    axes.triplot(r, z + shift, mesh.t.T, color=color, linewidth=0.3)
    axes.set_aspect("equal")


def draw_joint(axes, ball_radius, socket_ratio, drop):
    """Draw the meridian of ball and socket, with radii and supports named (lengths in R2)."""
    angles = np.linspace(0, np.pi / 2, 181)
    r, z = np.sin(angles), -np.cos(angles)
    socket = np.hstack([np.array([r, z]), socket_ratio * np.array([r[::-1], z[::-1]])])
    ball = np.array([[0, *ball_radius * r], [drop, *(ball_radius * z + drop)]])
    for outline, law, name, at in (
        (socket, "hertz", "socket", (0.05, -1.12)),
        (ball, "hyperbolic_winkler", "ball", (0.05, -0.9)),
    ):
        color = LOOKS[law].color
        axes.fill(*outline, facecolor=color, alpha=0.2, edgecolor=color)
        axes.annotate(name, at, color=color, fontsize=8)
    axes.plot(*(socket_ratio * np.array([r, z])), color="k", linewidth=3, label="fixed")
    axes.plot([0, ball_radius], [drop, drop], "k--", linewidth=1.5, label="displaced, clamped")
    for radius, angle, name, centre in (
        (ball_radius, 1.2, "$R_1$", drop),
        (1.0, 0.75, "$R_2$", 0.0),
        (socket_ratio, 0.35, "$R_{2o}$", 0.0),
    ):
        tip = (radius * np.sin(angle), centre - radius * np.cos(angle))
        axes.annotate("", tip, (0, centre), arrowprops={"arrowstyle": "->", "linewidth": 0.8})
        axes.annotate(name, (0.55 * tip[0], centre + 0.55 * (tip[1] - centre) + 0.03), fontsize=8)
    axes.set(xlabel="$r/R_2$", ylabel="$z/R_2$", aspect="equal")
    axes.legend(loc="lower right", fontsize=7)
    axes.grid(False)


def draw_mechanism(axes, scene, angle):
    """Draw the crank-slider to scale at a crank's angle, lengths in mm, and its gap enlarged."""
    crank, coupler = 1e3 * scene.crank_length, 1e3 * scene.coupler_length
    pin = crank * np.array([np.cos(angle), np.sin(angle)])
    end = np.array([pin[0] + np.sqrt(coupler**2 - pin[1] ** 2), 0.0])
    radius = 1e3 * scene.socket_radius
    slider = 3.2 * radius
    axes.axhline(-slider / 2, color="0.6", linewidth=1)
    axes.axhline(slider / 2, color="0.6", linewidth=1)
    corner = end - slider / 2
    axes.add_patch(Rectangle(corner, slider, slider, facecolor="0.9", edgecolor="k"))
    axes.add_patch(Circle(end, radius, facecolor="w", edgecolor=LOOKS["hertz"].color, linewidth=2))
    ball = LOOKS["hyperbolic_winkler"].color
    axes.plot(*np.array([pin, end]).T, color=ball, linewidth=5, solid_capstyle="round")
    axes.add_patch(Circle(end, 0.8 * radius, facecolor=ball, alpha=0.6, edgecolor=ball))
    axes.plot(*np.array([(0, 0), pin]).T, color="0.3", linewidth=7, solid_capstyle="round")
    for place in ((0, 0), pin):
        axes.plot(*place, "wo", markeredgecolor="k", markersize=6, zorder=4)
    axes.add_patch(Arc((0, 0), 36, 36, theta1=0, theta2=np.degrees(angle), linewidth=0.8))
    axes.annotate(r"$\theta$", (20 * np.cos(angle / 2), 20 * np.sin(angle / 2) - 2))
    turning = {"arrowstyle": "->", "connectionstyle": "arc3,rad=-0.9", "linewidth": 1.5}
    sign = 1 if scene.driving_moment >= 0 else -1
    axes.annotate("", (-9, -9 * sign), (-9, 9 * sign), arrowprops=turning)
    texts = (
        (f"crank {crank:g} mm, {scene.crank_mass:g} kg", 0.6 * pin, (-115, 16)),
        (f"coupler {coupler:g} mm, {scene.coupler_mass:g} kg", (pin + end) / 2, (-40, 36)),
        (f"slider {scene.slider_mass:g} kg", (end[0], -slider / 2), (-20, -22)),
        (f"moment {scene.driving_moment:g} N m", (0, 0), (-52, -52)),
        (f"clearance {1e6 * scene.clearance:g} µm (enlarged)", (end[0], radius), (-62, 36)),
    )
    for text, place, shift in texts:
        arrow = {"arrowstyle": "-", "linewidth": 0.6, "color": "0.4"}
        axes.annotate(text, place, shift, textcoords="offset points", fontsize=8, arrowprops=arrow)
    axes.plot([0, end[0] + slider], [0, 0], "k-.", linewidth=0.5)
    axes.set(xlabel="$x$ (mm)", ylabel="$y$ (mm)", aspect="equal")
    axes.set(xlim=(-60, end[0] + slider), ylim=(-55, 75))
    axes.grid(False)
