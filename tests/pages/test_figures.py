"""The saved drawings are to scale, their arrows add up to the laws' forces; style and saving."""

from ast import literal_eval

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from PIL import Image

from study import paths
from study.contact import SOCKET_RATIO, HyperbolicWinkler, Winkler
from study.pages import build, catalogue, drawings, figures

(NOTEBOOK,) = catalogue.select(["fig01"])
DRAWN = {name: literal_eval(value) for name, (value, _) in build.parameters(NOTEBOOK).items()}
R2_STAR, DEPTH_STAR = DRAWN["drawn_r2_star"], DRAWN["depth_star"]


def panel(name, letter):
    """Parts of a saved drawing, each of shape (2, n)."""
    rows = pd.read_csv(paths.FIGURES / f"{name}.csv").query("panel == @letter")
    return {part: points[["x", "y"]].to_numpy().T for part, points in rows.groupby("part")}


def test_gaps_are_the_clearance_and_the_eccentricity():
    socket = np.hypot(*panel("fig01", "a")["socket"])
    assert (socket.min(), socket.max()) == pytest.approx((1, SOCKET_RATIO), abs=2e-6)
    free, eccentricity = panel("fig01", "b"), DRAWN["eccentricity_star"]
    assert np.hypot(*np.diff(free["e"]).ravel()) == pytest.approx(eccentricity / R2_STAR, abs=2e-6)
    ball = np.hypot(*free["ball and rod"][:, :181])
    assert 1 - ball.max() == pytest.approx((1 - eccentricity) / R2_STAR, rel=1e-3)


def test_overlap_is_as_deep_as_the_depth():
    parts, depth = panel("fig02", "a"), DEPTH_STAR / R2_STAR
    along = drawings.polar(1, np.radians(DRAWN["direction"]))
    assert np.ptp(along @ parts["depth"]) == pytest.approx(depth, abs=2e-6)
    assert (along @ parts["overlap"]).max() == pytest.approx(1 + depth, abs=2e-6)
    eccentricity = np.hypot(*np.diff(parts["e"]).ravel())
    assert eccentricity == pytest.approx(depth + 1 / R2_STAR, abs=2e-6)
    assert (np.hypot(*(parts["overlap"] - parts["e"][:, 1:])) <= 1 - 1 / R2_STAR + 2e-6).all()
    assert (np.hypot(*parts["overlap"]) >= 1 - 2e-6).all()


@pytest.mark.parametrize("depth", [0.1, 0.25, 0.5])
def test_pressure_ends_steeply_and_adds_up_to_the_force(depth):
    radius, pressure = panel("fig03", "a")[f"elastic_solution, depth_star {depth:g}"]
    slope = np.diff(pressure) / np.diff(radius)
    assert pressure[-1] == 0
    assert slope[-1] == slope.min() < 5 * slope[-10]
    r2_star = DRAWN["r2_star"]
    scale = r2_star * (1 - 1 / r2_star) ** 2  # the pressure acts on the surface of the ball
    total = scale * np.trapezoid(2 * np.pi * radius * pressure, radius)
    force = pd.read_csv(paths.FIGURES / "trend.csv").set_index("depth_star").elastic_solution
    assert total == pytest.approx(force[depth], rel=0.002)


def test_arrows_add_up_to_the_laws():
    """Of the flat foundation, and along the arc: K d/h on rings of a disc, in E* dR/R2."""
    x, share = panel("fig04", "a")["pressure"]
    coefficient = Winkler()(1.0, R2_STAR)  # pi R/h, with R = R1 R2/dR
    peak = DEPTH_STAR * coefficient / (np.pi * (R2_STAR - 1))
    total = R2_STAR * peak * np.sum(np.pi * np.abs(x) * share) * np.diff(x)[0]
    assert total == pytest.approx(Winkler()(DEPTH_STAR, R2_STAR), rel=0.01)
    theta, share = panel("fig06", "a")["pressure"]
    coefficient = HyperbolicWinkler().parts(R2_STAR).scale  # pi R2^2/(h dR)
    peak = DEPTH_STAR * coefficient / (np.pi * R2_STAR)
    rings = np.pi * np.abs(theta) * np.diff(theta)[0]
    total = R2_STAR * peak * np.sum(rings * share * np.cos(theta))
    assert total == pytest.approx(HyperbolicWinkler()(DEPTH_STAR, R2_STAR), rel=0.01)


@pytest.mark.parametrize(("letter", "depth"), [("a", "small_depth_star"), ("b", "depth_star")])
def test_vertical_arrows_are_components_of_the_radial_ones(letter, depth):
    parts = panel("fig05", letter)
    radial, vertical = (parts[name] - parts["tails"] for name in ("radial", "vertical"))
    np.testing.assert_allclose(vertical[1], radial[1], atol=3e-6)
    np.testing.assert_allclose(vertical[0], 0, atol=3e-6)
    edge = np.arctan2(*(parts["arc of contact"][:, -1] * [1, -1]))
    assert edge == pytest.approx(np.sqrt(2 * DRAWN[depth]), abs=3e-6)


def test_supports_are_drawn_at_first_contact_and_moved_by_the_depth():
    (notebook,) = catalogue.select(["supports"])
    drawn = {name: literal_eval(value) for name, (value, _) in build.parameters(notebook).items()}
    parts, clearance = panel("supports", "a"), 1 / drawn["sketched_r2_star"]
    socket = np.hypot(*parts["socket"])
    assert (socket.min(), socket.max()) == pytest.approx((1, drawn["socket_ratio"]), abs=2e-6)
    assert parts["ball"][1].min() == pytest.approx(-1, abs=2e-6)
    assert np.ptp(parts["ball"], axis=1) == pytest.approx([1 - clearance] * 2, abs=2e-6)
    assert parts["plane"][1] == pytest.approx([-clearance] * 2, abs=2e-6)
    moved = parts["plane"][1] - parts["plane moved"][1]
    assert moved == pytest.approx([drawn["sketched_depth"] * clearance] * 2, abs=2e-6)


def test_overview_has_the_reference_joint_and_its_force_in_kilonewtons():
    rows = pd.read_csv(paths.FIGURES / "overview.csv").groupby(["panel", "series"])
    parts = {name: points[["x", "y"]].to_numpy().T for name, points in rows}
    socket, ball = np.hypot(*parts["a", "socket"]), parts["a", "ball"]
    assert (socket.min(), socket.max()) == pytest.approx((1, SOCKET_RATIO), abs=2e-6)
    assert ball[1].min() == pytest.approx(-1, abs=2e-6)
    assert np.ptp(ball, axis=1) == pytest.approx([2 * np.ptp(ball[1]), 1 + ball[1].max()])
    depth, force = parts["b", "elastic_solution"]
    normalised = pd.read_csv(paths.FIGURES / "trend.csv").elastic_solution
    assert depth.max() == 50  # um
    assert force == pytest.approx(normalised * 200e6 / (2 * 0.91) * 50e-6**2, rel=1e-6)


@pytest.mark.parametrize("digits", [figures.DIGITS, 3])
def test_equal_tables_give_equal_pictures(digits, tmp_path, monkeypatch):
    """The digits that are not saved differ, by what is visible on these axes."""
    monkeypatch.setenv(paths.WRITE_VARIABLE, str(tmp_path))
    unit, made = 10.0 ** (1 - digits), []  # in the last digit that is saved
    for unsaved in (-0.4, 0.4):
        table = pd.DataFrame({"x": [0.0, 1.0], "y": 1 + unit * (np.array([2, 5]) + unsaved)})
        drawn = figures.as_saved(table, digits)
        figure, axes = figures.new()
        axes.plot(drawn.x, drawn.y)
        if digits == figures.DIGITS:
            figures.draw(axes, "hertz", table.x, table.y + 3 * unit)
            figures.draw_model(axes, "beams", table.x / 1e3, table.y + 6 * unit)
        axes.set_ylim(1, 1 + 12 * unit)
        figures.save(figure, "fig", drawn)
        made.append([path.read_bytes() for path in sorted(tmp_path.iterdir())])
    assert len(made[0]) == 2
    assert made[0] == made[1]


def test_what_is_saved_is_what_was_rounded(tmp_path, monkeypatch):
    monkeypatch.setenv(paths.WRITE_VARIABLE, str(tmp_path))
    table = pd.DataFrame({"law": ["hertz", ""], "n": [2, 3], "force": [2e10 / 3, -1e-12 / 7]})
    figures.save_table(table, "table")
    saved = pd.read_csv(tmp_path / "table.csv", keep_default_na=False)
    pd.testing.assert_frame_equal(saved, figures.as_saved(table), check_exact=True)
    assert figures.as_saved(table.force, 3).tolist() == [6.67e9, -1.43e-13]
    assert figures.as_saved([]) == []


@pytest.mark.parametrize("place", ["legend", "ticks", "text"])
def test_what_is_too_wide_or_too_small_for_print_is_an_error(place, tmp_path, monkeypatch):
    with pytest.raises(ValueError, match=r"width of the figure must be .*8\.4 in, got 8\.7"):
        figures.new(columns=3, width=2.9)
    monkeypatch.setenv(paths.WRITE_VARIABLE, str(tmp_path))
    figure, axes = figures.new()
    axes.plot([0, 1], label="law $R_2^*$")
    axes.legend(fontsize=8 if place == "legend" else None)
    axes.tick_params(labelsize=8 if place == "ticks" else 9)
    axes.text(0, 0, "here", fontsize=8 if place == "text" else 9)
    with pytest.raises(ValueError, match=r"size of the text .* in fig must be .* 9 pt, got 8"):
        figures.save(figure, "fig", pd.DataFrame({"x": [1.0]}))
    assert not list(tmp_path.iterdir())


def test_every_kept_figure_is_readable_in_print_and_has_no_overlapping_texts():
    images = {path.stem: Image.open(path) for path in paths.FIGURES.glob("*.png")}
    widest = figures.WIDEST * figures.STYLE["savefig.dpi"]
    assert images
    assert not {name for name, image in images.items() if image.width > widest}
    assert not {name for name, image in images.items() if figures.OVERLAP in image.info}


def test_numbers_for_statements_have_a_row_for_each_reading(monkeypatch, tmp_path):
    monkeypatch.setenv(paths.WRITE_VARIABLE, str(tmp_path))
    figures.save_numbers("numbers", {"%": {"error": {"soft": 2, "stiff": 1}}, "1": {"ratio": 3.0}})
    table = pd.read_csv(tmp_path / "numbers.csv")
    assert list(table) == ["quantity", "reading", "value", "unit"]
    assert table.to_numpy().tolist() == [
        ["error", "soft", 2, "%"],
        ["error", "stiff", 1, "%"],
        ["ratio", "reference joint", 3, "1"],
    ]
    with pytest.raises(ValueError, match="all numbers of numbers must be finite"):
        figures.save_numbers("numbers", {"1": {"ratio": np.nan}})


@pytest.mark.parametrize(
    ("place", "angle", "found"),
    [((0.5, 0.5), 0, True), ((0.5, 0.6), 0, False), ((0.5, 0.6), 90, False)],
)
def test_overlapping_texts_are_found(place, angle, found):
    figure = Figure(figsize=(5, 5))
    figure.text(0.5, 0.5, "penetration depth")
    figure.text(*place, "contact force", rotation=angle)
    assert bool(figures.overlapping_texts(figure)) == found


def test_labels_of_ticks_that_are_not_drawn_do_not_count():
    figure = Figure()
    axes = figure.add_subplot(xticks=[0, 1, 1.001], xlim=(0, 1))
    assert figures.overlapping_texts(figure) == []
    axes.set_xlim(0, 1.001)
    assert len(figures.overlapping_texts(figure)) == 1
