"""Crank-sliders at random, far from the paper's."""

import numpy as np

from study.contact.forces import DAMPINGS
from study.mechanism import paper_scene


def random_scenes(count):
    generator = np.random.default_rng(7)
    for _ in range(count):
        size = generator.uniform
        crank = 10 ** size(-2, -0.7)
        yield paper_scene(
            crank_length=crank,
            coupler_length=crank * size(1.5, 5),
            crank_mass=10 ** size(-1.5, 0.5),
            coupler_mass=10 ** size(-1.5, 0.5),
            slider_mass=10 ** size(-1.5, 0.5),
            clearance=10 ** size(-5.5, -3.5),
            restitution=size(0.05, 1),
            friction=size(0, 0.9),
            damping=str(generator.choice(list(DAMPINGS))),
            driving_moment=size(-1, 1) * 10 ** size(-2, 0),
            gravity=size(-20, 20),
        )
