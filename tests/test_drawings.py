"""The drawings are to scale, and the pressures drawn add up to the laws' forces."""

import re

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest

from study import paths
from study.contact import hertz, hyperbolic_winkler, pressure, winkler
from study.joint import Joint, force_curve
from study.pages import drawings, figures


def new_axes(count=1):
    return figures.new(columns=count)[1]


def force(radius, values, r2_star):
    """Dimensionless force of a pressure over the distance from the axis."""
    return r2_star * np.trapezoid(2 * np.pi * radius * values, radius)


@pytest.mark.parametrize("depth_star", [0.02, 0.5])
@pytest.mark.parametrize("r2_star", [4.0, 200.0])
def test_hertz_pressure_adds_up_to_hertz(depth_star, r2_star):
    radius = pressure.contact_radius(depth_star, r2_star) * np.sin(np.linspace(0, np.pi / 2, 2001))
    values = pressure.hertz_pressure(radius, depth_star, r2_star)
    assert force(radius, values, r2_star) == pytest.approx(hertz(depth_star, r2_star), rel=1e-6)


def test_exact_pressure_tends_to_hertz():
    joint = Joint(2000.0, socket_ratio=3.0)
    curve = force_curve(joint, [0.001], resolution=640)
    peak = pressure.hertz_pressure(0.0, 0.001, joint.r2_star)
    radius = pressure.contact_radius(0.001, joint.r2_star)
    assert curve.peak_pressure[0] == pytest.approx(peak, rel=0.05)
    assert np.sin(curve.contact_half_angle[0]) == pytest.approx(radius, rel=0.03)


def test_hyperbolic_pressure_adds_up_to_its_law():
    depth, r2_star = 0.5, 200.0
    alpha = pressure.contact_half_angle("hyperbolic_winkler", depth, r2_star)
    theta = np.linspace(0, alpha, 2001)
    values = pressure.hyperbolic_pressure(theta, depth, r2_star)
    vertical, total = (  # with the law's area element, that of a disc
        r2_star * np.trapezoid(2 * np.pi * theta * values * share, theta)
        for share in (np.cos(theta), 1)
    )
    assert vertical == pytest.approx(hyperbolic_winkler(depth, r2_star), rel=1e-5)
    assert vertical / total == pytest.approx(pressure.vertical_share(depth), rel=1e-5)


def test_drawn_overlap_is_as_deep_as_the_depth():
    r2_star, depth_star, direction = 4.0, 0.5, 0.7
    axes = new_axes(2)
    parts = drawings.draw_penetration(*axes, r2_star, depth_star, direction)
    along = drawings.polar(1, direction) @ parts["overlap"]
    eccentricity = np.hypot(*np.diff(parts["e"]).ravel())
    assert np.ptp(parts["depth"].T @ drawings.polar(1, direction)) == pytest.approx(
        depth_star / r2_star
    )
    assert along.max() == pytest.approx(1 + depth_star / r2_star)
    assert eccentricity - 1 / r2_star == pytest.approx(depth_star / r2_star)
    in_ball = np.hypot(*(parts["overlap"] - parts["e"][:, 1:])) <= 1 - 1 / r2_star + 1e-12
    outside_socket = np.hypot(*parts["overlap"]) >= 1 - 1e-12
    assert in_ball.all()
    assert outside_socket.all()


def test_drawn_gaps_are_the_clearance_and_the_eccentricity():
    axes, other = new_axes(2)
    socket = np.hypot(*drawings.draw_radii(axes, 5.0, 1.3)["socket"])
    assert (socket.min(), socket.max()) == pytest.approx((1, 1.3))
    parts = drawings.draw_eccentricity(other, 5.0, 0.6, 0.4)
    assert np.hypot(*np.diff(parts["e"]).ravel()) == pytest.approx(0.6 / 5)
    ball = np.hypot(*parts["ball and rod"][:, :181])
    assert 1 - ball.max() == pytest.approx((1 - 0.6) / 5, rel=1e-3)


def test_arrows_of_the_flat_foundation_add_up_to_winkler():
    r2_star, depth_star = 4.0, 0.5
    axes = new_axes()
    parts = drawings.draw_foundation(axes, r2_star, depth_star)
    x, share = parts["pressure"]
    height = pressure.foundation_height("winkler", r2_star)
    peak = depth_star / height  # K d/h in E* dR/R2
    total = r2_star * peak * np.sum(np.pi * np.abs(x) * share) * np.diff(x)[0]
    assert total == pytest.approx(winkler(depth_star, r2_star), rel=0.01)


def test_arrows_along_the_arc_add_up_to_the_law():
    r2_star, depth_star = 4.0, 0.5
    axes = new_axes()
    theta, share = drawings.draw_circumferential(axes, r2_star, depth_star)["pressure"]
    peak = depth_star / pressure.foundation_height("hyperbolic_winkler", r2_star)
    rings = np.pi * np.abs(theta) * np.diff(theta)[0]  # of a disc
    total = r2_star * peak * np.sum(rings * share * np.cos(theta))
    assert total == pytest.approx(hyperbolic_winkler(depth_star, r2_star), rel=0.01)


def test_vertical_arrows_are_components_of_the_radial_ones():
    axes = new_axes()
    parts = drawings.draw_arc(axes, 0.3)
    radial, vertical = (parts[name] - parts["tails"] for name in ("radial", "vertical"))
    np.testing.assert_allclose(vertical[1], radial[1], atol=1e-12)
    np.testing.assert_allclose(vertical[0], 0, atol=1e-12)
    assert np.arctan2(*(parts["arc of contact"][:, -1] * [1, -1])) == pytest.approx(np.sqrt(0.6))


def test_half_angles_agree_where_they_must():
    assert pressure.contact_half_angle("hyperbolic_winkler", 0.5, 20.0) == pytest.approx(1.0)
    assert np.cos(pressure.contact_half_angle("steuermann", 1.0, 20.0)) == pytest.approx(0.5)
    tiny = [pressure.contact_half_angle(law, 1e-8, 1e6) for law in ("steuermann", "hertz")]
    assert tiny[0] / tiny[1] == pytest.approx(np.sqrt(2), rel=1e-4)


def test_numbers_of_a_drawing_are_tidy():
    axes = new_axes()
    table = drawings.table(a=drawings.draw_hertz(axes))
    assert list(table.columns) == ["panel", "part", "x", "y"]
    assert np.isfinite(table[["x", "y"]].to_numpy()).all()
    assert table.groupby("part").size().min() > 1


@pytest.mark.parametrize(
    ("name", "arguments", "message"),
    [
        ("draw_radii", (1.0,), "r2_star must be > 1, got 1"),
        ("draw_radii", (4.0, 0.9), "socket_ratio must be > 1, got 0.9"),
        ("draw_eccentricity", (4.0, 1.0, 0.5), "eccentricity_star must be > 0 and < 1, got 1"),
        ("draw_eccentricity", (4.0, 0.5, 3.0), "direction must be >= -1.2 and <= 1.2 rad, got 3"),
        ("draw_foundation", (4.0, -0.5), "depth_star must be > 0, got -0.5"),
        ("draw_foundation", (1.5, 2.0), "depth over the foundation's height must be < 1"),
        ("draw_arc", (1.5,), "depth_star must be <= 1.2337, got 1.5"),
        ("draw_circumferential", (4.0, np.nan), "depth_star must be finite"),
    ],
)
def test_wrong_values_are_one_clear_error(name, arguments, message):
    axes = new_axes()
    with pytest.raises(ValueError, match=re.escape(message)):
        getattr(drawings, name)(axes, *arguments)


def test_too_deep_an_overlap_is_refused():
    axes = new_axes(2)
    with pytest.raises(ValueError, match="depth_star must be > 0 and < 1.64575, got 2"):
        drawings.draw_penetration(*axes, 4.0, 2.0, 0.5)


def test_a_figure_leaves_the_settings_of_the_session(tmp_path, monkeypatch):
    monkeypatch.setenv(paths.RESULTS_VARIABLE, str(tmp_path))
    figures._style.close()  # of figures that other tests have not saved
    with mpl.rc_context({"lines.linewidth": 7.0, "font.size": 5.0}):
        before = dict(mpl.rcParams)
        figure, axes = figures.new()
        assert axes.plot([0, 1])[0].get_linewidth() == figures.STYLE["lines.linewidth"]
        figures.save(figure, "fig", pd.DataFrame({"x": [0.0, -0.0]}))
        assert dict(mpl.rcParams) == before
    assert (tmp_path / "fig.csv").read_text() == "x\n0\n0\n"
