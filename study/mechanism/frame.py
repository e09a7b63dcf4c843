"""The frame of crank and coupler as particles with elements between them, which `particles` steps.

Its highest natural frequency limits an explicit step.
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from study.compiled import one_thread
from study.mechanism.angles import arcsine, sine_cosine
from study.mechanism.scene import Link, Scene

Array = NDArray[np.float64]
Elements = tuple[int, int]  # numbers of elements of crank and coupler
ELEMENT = np.dtype([(name, float) for name in ("length", "axial", "near", "far")])
"""Length (m), axial stiffness (N/m), and bending stiffnesses (N m) of an element: the moment at an
end by the rotations of the near and of the far end."""


def lump(link: Link, elements: int) -> tuple[Array, Array]:
    """Particles of one link: masses in kg, rotary inertias of the half elements at each in kg m^2.

    With two or more elements, a part of each end's mass goes to its neighbour. Mass, centre and
    moment of inertia of the link are then exact: stiff links move as rigid ones, with any number of
    elements. A single element has its mass at its ends, and too much inertia.
    """
    length, halves = link.length / elements, np.full(elements + 1, 2.0)
    halves[[0, -1]] = 1.0
    masses = halves / 2
    if elements > 1:
        shift = elements / (8 * (elements - 1))
        masses[[0, -1]] -= shift
        masses[1] += shift
        masses[-2] += shift
    rotary = link.mass_per_length * length**3 / 24 + link.rotary_per_length * length / 2
    return link.mass_per_length * length * masses, rotary * halves


def straight_links(scene: Scene, elements: Elements, ideal: bool) -> tuple[Array, ...]:
    """Straight links at t = 0, divided into elements, with the ball at rest in its socket.

    Returns places and rates, with a row (x, y) for each end of an element; rotations, of which the
    pin has two, and their rates; place and rate of the slider.
    """
    e_x, e_y = (0.0, 0.0) if ideal else scene.initial_eccentricity
    theta, omega = scene.initial_crank_angle, scene.starting_speed
    st, ct = sine_cosine(theta)
    phi = arcsine((e_y - scene.crank_length * st) / scene.coupler_length)
    _, cp = sine_cosine(phi)
    psi = -scene.crank_length * ct * omega / (scene.coupler_length * cp)
    angles, speeds = (theta, phi), (omega, psi)
    lengths = np.repeat([scene.crank_length, scene.coupler_length] / np.array(elements), elements)
    units = np.repeat([sine_cosine(angle)[::-1] for angle in angles], elements, axis=0)
    chords = lengths[:, None] * units
    swept = np.repeat(speeds, elements)[:, None] * chords[:, ::-1] * (-1, 1)
    places, rates = (np.vstack([(0.0, 0.0), np.cumsum(x, axis=0)]) for x in (chords, swept))
    ends, (x, _), (u, _) = np.array(elements) + 1, places[-1], rates[-1]
    slide = np.array([x - e_x, u])
    return places, rates, np.repeat(angles, ends), np.repeat(speeds, ends), slide


class Frame:
    """Particles and elements (`ELEMENT`) of both links, laid out on +x.

    Particle 0 is the crank's fixed end, ``pin`` the one that both links share, the last one the
    ball. The pin has two rotations, one for each link.
    """

    def __init__(self, scene: Scene, elements: Elements) -> None:
        links, rows = (scene.link("crank"), scene.link("coupler")), []
        for link, n in zip(links, elements, strict=True):
            length = link.length / n
            shear = 12 * link.bending / (link.shear * length**2)
            bending = link.bending / (length * (1 + shear))
            row = length, link.axial / length, (4 + shear) * bending, (2 - shear) * bending
            rows += [row] * n
        self.elements = np.array(rows, ELEMENT)
        (m1, j1), (m2, j2) = (lump(link, n) for link, n in zip(links, elements, strict=True))
        self.pin, _ = elements
        self.masses = np.concatenate([m1[:-1], [m1[-1] + m2[0]], m2[1:]])
        self.rotaries = np.concatenate([j1, j2])

    @one_thread
    def highest_frequency(self, end_mass: float, held: bool) -> float:
        """Highest natural frequency of the straight frame, in rad/s.

        ``end_mass``, in kg, is added to the last particle along the slide, where it is ``held``.
        """
        from scipy.linalg import eigvalsh  # rigid links need no SciPy

        turns, size = 2 * len(self.masses), 3 * len(self.masses) + 1
        stiffness, mass = np.zeros((size, size)), np.zeros(size)
        for e, (length, axial, near, far) in enumerate(self.elements):
            along, turn = [2 * e, 2 * e + 2], turns + e + (e >= self.pin)
            bent = [2 * e + 1, 2 * e + 3, turn, turn + 1]
            strain = np.array([[1 / length, -1 / length, 1, 0], [1 / length, -1 / length, 0, 1]])
            stiffness[np.ix_(along, along)] += axial * np.array([[1, -1], [-1, 1]])
            stiffness[np.ix_(bent, bent)] += strain.T @ [[near, far], [far, near]] @ strain
        mass[:turns] = np.repeat(self.masses, 2)
        mass[turns:] = self.rotaries
        mass[turns - 2] += end_mass
        free = np.delete(np.arange(size), [0, 1, turns - 1] if held else [0, 1])
        root = np.sqrt(mass[free])
        scaled = stiffness[np.ix_(free, free)] / np.outer(root, root)
        return sqrt(eigvalsh(scaled).max())
