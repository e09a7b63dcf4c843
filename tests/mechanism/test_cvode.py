"""CVODE called from C on the rigid links, and times at equal error."""

import numpy as np
import pytest
from helpers.laws import packed
from helpers.with_hertz import simulate
from other_programs import cvode

from study import checks
from study.mechanism import paper_scene

pytestmark = pytest.mark.skipif(
    cvode.version() is None, reason="gcc or SUNDIALS 6 (libsundials-dev) is not installed"
)


def law_of(scene, name="hertz"):
    return packed(name, scene.ball_radius, scene.socket_radius, scene.composite_modulus)


@pytest.mark.parametrize("coordinates", cvode.SCALES)
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {
            "gravity": 9.81,
            "initial_crank_angle": 2.0,
            "initial_eccentricity": (1e-5, -3e-5),
            "restitution": 0.8,
            "friction": 0.2,
            "slow_speed": 1e-3,
        },
    ],
)
def test_cvode_agrees_with_our_stepper(coordinates, changes):
    scene, duration, outputs = paper_scene(**changes), 0.03, 300
    own = simulate(scene, duration=duration, outputs=outputs, tolerance=1e-11)
    arguments = scene, law_of(scene), duration, outputs, 1e-13, coordinates
    acceleration, _ = cvode.slider_acceleration(*arguments)
    scale = np.sqrt(np.mean(own.slider_acceleration**2))
    assert len(own.impacts) > 3
    assert acceleration == pytest.approx(own.slider_acceleration[1:], abs=1e-7 * scale)


def test_another_law_is_refused():
    scene = paper_scene()
    with pytest.raises(ValueError, match="law must be Hertz's, packed, got shape 1"):
        cvode.slider_acceleration(scene, law_of(scene, "winkler"), 0.01, 10, 1e-6)


def test_a_failure_is_told(monkeypatch):
    monkeypatch.setattr(cvode, "RELATIVE", -1.0)
    with pytest.raises(checks.StudyError, match="CVODE failed with status -22"):
        cvode.slider_acceleration(paper_scene(), law_of(paper_scene()), 0.01, 10, 1e-6)
