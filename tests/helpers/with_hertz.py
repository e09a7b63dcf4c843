"""The paper's crank-slider with Hertz's law: its numbers are known, and other programs have it."""

from study import mechanism


def simulate(scene=None, **options):
    """As `study.mechanism.simulate`, of the paper's scene and Hertz's law unless told otherwise."""
    scene = mechanism.paper_scene() if scene is None else scene
    return mechanism.simulate(scene, **({"law": "hertz"} | options))
