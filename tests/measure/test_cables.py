"""Flexible links in the chart of times: their limits, and Exudyn's cables where it is installed."""

from itertools import islice

import numpy as np
import pytest
from benchmarks import others

from study.measure import flexible, timing
from study.mechanism import paper_scene


def fine_impact(scene=flexible.SCENE):
    """Time and force of the first impact with particles on a fine mesh."""
    elements = (32, 64)
    step = 0.5 * flexible.longest_step("first impact", elements, scene)
    return flexible.simulated("particles", "first impact", elements, step, scene)


def test_without_shear_only_the_shear_stiffness_changes():
    scene, stiff = paper_scene(), others.shear_stiff(paper_scene())
    assert stiff.composite_modulus == pytest.approx(scene.composite_modulus, rel=1e-14)
    for body in ("crank", "coupler"):
        link, stiff_link = scene.link(body), stiff.link(body)
        assert stiff_link.shear == pytest.approx(1000 * link.shear, rel=1e-9)
        assert stiff_link._replace(shear=link.shear) == link


@pytest.mark.parametrize("method", ["particles", "beams"])
def test_the_first_impact_comes_to_that_of_a_fine_mesh(method):
    errors, exact = [], fine_impact()
    for elements in ((2, 4), (8, 16)):
        limit = flexible.longest_step("first impact", elements)
        step = 0.95 * limit if method == "particles" else 1e-6
        values = flexible.simulated(method, "first impact", elements, step)
        errors.append(flexible.error("first impact", exact, values)[1])
    assert errors[1] < 0.02
    assert errors[1] < errors[0] / 10


def test_the_rows_of_the_chart_name_joint_mesh_and_step(monkeypatch):
    exact = flexible.simulated("particles", "ideal joint", (4, 8), 1e-6)
    monkeypatch.setattr(flexible, "reference", lambda joint, scene: exact)  # saves a minute
    frame = timing.chart("flexible", list(islice(flexible.runs(), 2)), 1)
    assert frame.setting[0].startswith("ideal joint, 2 and 4 elements, step 4.1")
    assert set(frame.chart) == {"flexible"}
    assert frame.rms_error[0] < 1e-6
    assert (frame.time > 0).all()


def test_cables_of_exudyn_have_the_limit_of_links_without_shear():
    pytest.importorskip("exudyn", reason="Exudyn is not installed")
    first = others.cable("first impact", (4, 8), 1e-6)()
    scenes = others.SHEAR_STIFF, flexible.SCENE
    without, with_shear = (
        flexible.error("first impact", fine_impact(scene), first)[1] for scene in scenes
    )
    assert without < 0.02
    assert with_shear > 2 * without
    run = others.cable("ideal joint", (2, 4), 1e-5)
    places = run()
    step = 0.5 * flexible.longest_step("ideal joint", (8, 16), others.SHEAR_STIFF)
    exact = flexible.simulated("particles", "ideal joint", (8, 16), step, others.SHEAR_STIFF)
    assert flexible.error("ideal joint", exact, places)[0] < 1e-6
    assert np.array_equal(places, run())  # a second call starts anew
