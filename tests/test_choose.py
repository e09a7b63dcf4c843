"""The choice of a law against joints solved anew, and of a model against finer ones."""

import numpy as np
import pytest

from study import choose, contact
from study.checks import StudyError
from study.choose import SHALLOWEST
from study.joint import Joint, Material, force_curve
from study.mechanism import Scene, compare, links, simulate
from study.mechanism.auto import choose_model

MATERIALS = 16
PER_MATERIAL = 13


def joint(r2_star=200.0, ratio=1.19, poisson=0.3, **options):
    return Joint(r2_star, ratio, Material(poisson=poisson), Material(poisson=poisson), **options)


def random_scenes():
    """Joints at random in the dataset's range, largest depths, tolerances, exact curves."""
    draw = np.random.default_rng(11)
    for _ in range(MATERIALS):
        ratio, poisson = 1.1 * (3 / 1.1) ** draw.random(), draw.uniform(0.2, 0.45)
        for _ in range(PER_MATERIAL):
            scene = joint(20 * 500 ** draw.random(), ratio, poisson)
            deepest = SHALLOWEST * (1 / SHALLOWEST) ** draw.random()
            tolerance = 0.002 * 250 ** draw.random()
            depths = np.linspace(np.sqrt(SHALLOWEST), np.sqrt(deepest), 12) ** 2
            yield scene, deepest, tolerance, force_curve(scene, depths)


def true_error(law, scene, curve):
    options = choose.law_options(law, scene)
    force = contact.LAWS[law](curve.depth_star, scene.r2_star, **options)
    return np.abs(force / curve.force_star - 1).max()


def test_choice_is_within_tolerance_and_rarely_too_dear():
    """On 250 random scenes that were not used to set the bounds."""
    costs, count, missed, laws = choose.relative_costs(), 0, 0, set()
    for scene, deepest, tolerance, curve in random_scenes():
        choice = choose.choose(scene, deepest, tolerance)
        count += 1
        laws.add(choice.law)
        assert choice.error_bound <= tolerance
        if choice.law in contact.LAWS:
            assert true_error(choice.law, scene, curve) <= choice.error_bound
        elif choice.law == "tabulated":
            force = choice.evaluate(curve.depth_star)
            assert np.abs(force / curve.force_star - 1).max() <= tolerance
        cheaper = [law for law in contact.LAWS if costs[law] < costs[choice.law]]
        missed += any(true_error(law, scene, curve) <= tolerance for law in cheaper)
    print(count, missed, laws)
    assert count >= 200
    assert missed <= 0.05 * count
    assert {"hertz", "stiffened_hertz", "tabulated"} <= laws
