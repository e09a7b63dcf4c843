"""Natural frequencies of one flexible link against those of a thin beam, in both models: modes 1
and 2, both ends pinned (sin x = 0) or free (cos x cosh x = 1; x is wave number times length)."""

import numpy as np
import pytest
from helpers.beams import dense
from scipy.linalg import eigh

from study.mechanism import beams, paper_scene
from study.mechanism.frame import Frame, lump

THIN = paper_scene(density=1e9)  # a thin section, so that shear does not matter
LINK = THIN.link("crank")
WAVES = {"pinned": (np.pi, 2 * np.pi), "free": (4.730040744862704, 7.853204624095838)}
"""Wave numbers of modes 1 and 2 times the length of the beam."""
MESHES = (4, 8, 16, 32)
INDEPENDENT = (-0.061, -0.0113, -0.0022, -0.00046)
"""Errors of mode 1 of pinned particles on these meshes, computed by an independent program."""


def particles(elements):
    """Stiffness and mass by deflection and rotation of each particle of the crank."""
    masses, rotaries = lump(LINK, elements)
    stiffness = np.zeros((2 * elements + 2, 2 * elements + 2))
    for e, (length, _, near, far) in enumerate(Frame(THIN, (elements, 1)).elements[:elements]):
        strain = np.array([[1 / length, 1, -1 / length, 0], [1 / length, 0, -1 / length, 1]])
        at = slice(2 * e, 2 * e + 4)
        stiffness[at, at] += strain.T @ [[near, far], [far, near]] @ strain
    return stiffness, np.diag(np.column_stack([masses, rotaries]).ravel())


def elements_of_beams(elements):
    """Stiffness and mass by deflection and rotation of each node of the crank."""
    system = beams.assemble(THIN, (elements, 1), ideal=True)
    sections, unknowns = system.sections[:elements], system.unknowns[:elements]
    size, places = len(system.initial), system.initial
    stiffness, force = np.zeros((size, 2 * beams.BAND + 1)), np.zeros(size)
    beams._internal(places, sections, unknowns, force, stiffness, 1.0)
    mass, _ = beams._mass_and_weight(sections, unknowns, size, 0.0)
    across = np.append(unknowns[:, 1:3].ravel(), unknowns[-1, 4:6])
    return tuple(dense(band)[np.ix_(across, across)] for band in (stiffness, mass))


def errors(matrices, ends):
    """Relative errors of the frequencies of modes 1 and 2."""
    exact = np.array(WAVES[ends]) ** 2 * np.sqrt(LINK.bending / LINK.mass_per_length)
    exact /= LINK.length**2
    held = [0, len(matrices[0]) - 2] if ends == "pinned" else []
    stiffness, mass = (np.delete(np.delete(m, held, 0), held, 1) for m in matrices)
    shift = exact[0] ** 2  # the mass of beams is singular, and the stiffness of a free beam, too
    squares = 1 / eigh(mass, stiffness + shift * mass, eigvals_only=True)[::-1][:4] - shift
    rigid = 0 if ends == "pinned" else 2
    return np.sqrt(squares[rigid : rigid + 2]) / exact - 1


@pytest.mark.parametrize("ends", WAVES)
@pytest.mark.parametrize("model", [particles, elements_of_beams])
def test_frequencies_converge_to_those_of_a_thin_beam_with_order_2(model, ends):
    found = np.array([errors(model(n), ends) for n in MESHES])
    orders = np.log2(found[:-1] / found[1:])
    assert orders[-1] == pytest.approx([2, 2], abs=0.4)
    assert (np.abs(found[-1]) < 0.004).all()


def test_particles_have_the_frequencies_of_an_independent_program():
    found = [errors(particles(n), "pinned")[0] for n in MESHES]
    assert found == pytest.approx(INDEPENDENT, rel=0.02, abs=3e-5)
