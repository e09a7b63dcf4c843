"""CalculiX on the joint: its forces, its deck, and what it says when it cannot work."""

import numpy as np
import pytest
from helpers.programs import needs_calculix
from other_programs import calculix, calculix_ring, calculix_tilted

from study import checks
from study.joint import Joint, Layer, Material

JOINT = Joint.from_ratios(200)
HELD = {"ball_support": "clamped", "rim": "free"}
CUT = Joint.from_ratios(200, ball_support="core:0.2", opening=70)
ROD_END = Joint.from_ratios(200, ball_support="bore:0.5,45", opening="55:125")
HOUSED = Layer(1.125, Material(5e8, 0.46)), Layer(1.5, Material())


def own(joint, depth, **how):
    return joint.solve(depth_star=depth, **how).force_star


@needs_calculix
@pytest.mark.parametrize(
    ("nodes", "resolution", "lowest", "highest"),
    [(6, 32, -2e-3, 2e-3), (3, 64, 0.02, 0.05)],  # linear triangles are too stiff
)
def test_force_is_that_of_the_exact_series(nodes, resolution, lowest, highest):
    depth = np.array([0.3, 0.0, 0.1])
    force = calculix.force_curve(JOINT, depth, resolution, nodes)
    assert force[1] == 0
    error = force[[0, 2]] / own(JOINT, depth[[0, 2]], resolution=640) - 1
    assert ((lowest < error) & (error < highest)).all()


@needs_calculix
@pytest.mark.parametrize("supports", [{}, HELD])
def test_force_of_a_lined_joint_is_the_same(supports):
    joint = Joint.from_ratios(200, layers=HOUSED, **supports)
    force = calculix.force_curve(joint, [0.3, 1.0], 32)
    assert force == pytest.approx(own(joint, [0.3, 1.0]), rel=3e-3)


@needs_calculix
@pytest.mark.parametrize("r2_star", [20, 80])
def test_large_displacements_differ_by_the_error_that_is_stated(r2_star):
    joint = Joint.from_ratios(r2_star, 1.3, socket=Material(1e11, 0.4), **HELD)
    small, large = (calculix.force_curve(joint, 0.4, 32, large=large) for large in (False, True))
    found = joint.solve(depth_star=0.4)
    assert small == pytest.approx(found.force_star, rel=3e-3)
    off = 1 - large / small
    assert 0.3 * found.formulation_error < off < 1.5 * found.formulation_error


@needs_calculix
def test_a_load_off_the_axis_whose_contact_is_cut_by_the_rim():
    found = CUT.solve(depth_star=0.5, tilt=60, resolution=32)
    expected = np.append(found.force_star, found.transverse_star)
    assert found.reaches_rim
    # this coarse mesh is 0.6 % too stiff; forces of finer ones are kept in `test_tilted`
    assert calculix_tilted.force(CUT, 0.5, 60) == pytest.approx(expected, abs=0.01 * expected[0])


@needs_calculix
def test_a_rod_end_whose_contact_is_cut_by_both_rims():
    found = ROD_END.solve(depth_star=0.5, resolution=32)
    assert found.reaches_rim
    force, pressure, _ = calculix_ring.pressed(ROD_END, 0.5, resolution=4, shells=2)
    # forces of finer meshes are kept in `test_tilted`
    assert force == pytest.approx(found.force_star[0], rel=5e-3)
    assert pressure == pytest.approx(found.peak_pressure_star[0], rel=0.03)


@needs_calculix
@pytest.mark.slow
def test_pressures_of_calculix_grow_with_the_resolution_at_a_rim_only():
    joint = Joint.of(bearing="GE 20 E", socket="bearing steel")
    (force, middle, rim), finer = (
        calculix_ring.pressed(joint, 0.68, resolution=n, shells=n // 2) for n in (4, 6)
    )
    assert finer[:2] == pytest.approx([force, middle], rel=3e-3)
    assert finer[2] > 1.08 * rim  # a sharp edge


def test_bricks_of_a_rod_end_are_right_handed_and_held_in_their_planes_of_symmetry():
    cards = _cards(calculix_ring.deck(ROD_END, 0.5, resolution=2, shells=1))
    place = {}
    for name in ("BALL", "SOCKET"):
        place |= {int(k): np.array(x, float) for k, *x in cards[f"*NODE, NSET={name}"]}
        rows = cards[f"*ELEMENT, TYPE=C3D20, ELSET={name}"]
        for first, rest in zip(rows[::2], rows[1::2], strict=True):
            nodes = [place[int(k)] for k in (first + rest)[1:]]
            sides = [nodes[k] - nodes[0] for k in (1, 3, 4)]
            assert np.linalg.det(sides) > 0
        of_body = {int(k) for k, *_ in cards[f"*NODE, NSET={name}"]}
        for what, axis in (("PLANE", 1), ("EQUATOR", 2)):
            held = {int(k) for (k,) in cards[f"*NSET, NSET={name}{what}"]}
            assert held == {k for k in of_body if abs(place[k][axis]) < 1e-12}
    bore = [place[int(k)] for (k,) in cards["*NSET, NSET=BALLHELD"]]
    radii = np.hypot(*(np.array(bore)[:, :2] - [1 / 200, 0]).T)
    assert radii == pytest.approx(0.5 * ROD_END.radius_ratio)
    z = np.cos(np.radians(55))
    for (rim, middle), radius in zip(
        np.reshape(cards["*NSET, NSET=READ"], (2, 2)), (ROD_END.radius_ratio, 1), strict=True
    ):
        assert place[int(rim)][2] == pytest.approx(radius * z)
        assert place[int(middle)] == pytest.approx([1, 0, 0])


@needs_calculix
@pytest.mark.slow
def test_a_soft_liner_differs_by_a_part_that_is_proportional_to_the_clearance():
    """The programs pair points of the surfaces differently (``data/README.md``)."""
    depth, off = np.array([0.3, 1.0]), []
    for r2_star in (200, 2000):
        joint = Joint.from_ratios(r2_star, layers=HOUSED)
        forces = [calculix.force_curve(joint, depth, 32, penalty=p) for p in (3e3, 1e4)]
        force = forces[0] + (forces[1] - forces[0]) / 0.7  # of a contact without compliance
        off.append(force / own(joint, depth) - 1)
    assert ((off[0] > 2e-3) & (off[0] < 5e-3)).all()
    assert (np.abs(off[1]) < 0.15 * off[0]).all()


@needs_calculix
def test_force_of_a_socket_that_is_held_at_its_rim_is_the_same():
    joint = Joint.from_ratios(200, 1.3, socket_support="rim")
    force = calculix.force_curve(joint, 0.1, 32)
    assert force == pytest.approx(own(joint, 0.1), rel=5e-3)  # its stress at the rim has no bound


@needs_calculix
@pytest.mark.slow
def test_a_load_off_the_axis_on_a_ball_at_a_neck():
    joint = Joint.from_ratios(200, 1.3, ball_support="neck:30", opening=80)
    found = joint.solve(depth_star=0.4, tilt=20)
    expected = np.append(found.force_star, found.transverse_star)
    # a finer mesh is in ``data/benchmark.csv``
    assert calculix_tilted.force(joint, 0.4, 20) == pytest.approx(expected, abs=0.01 * expected[0])


@needs_calculix
def test_failure_is_reported_with_its_reason():
    text = calculix.deck(JOINT, [0.1], 32, 3).replace("1., 1.", "one")
    with pytest.raises(checks.StudyError, match=r"with 0 of 1 depths solved: \*ERROR.*STATIC"):
        calculix.run(text, 1)


@pytest.mark.parametrize("nodes", [3, 6])
@pytest.mark.parametrize("name", ["BALL", "SOCKET"])
def test_elements_run_counterclockwise_and_boundaries_have_all_their_nodes(nodes, name):
    cards = _cards(calculix.deck(JOINT, [0.1], 32, nodes))
    radius, centre = (1.0, 0.0) if name == "SOCKET" else (1 - 1 / 200, 1 / 200)
    place = {int(k): np.array(x, float) - [0, centre] for k, *x in cards[f"*NODE, NSET={name}"]}
    rows = cards[f"*ELEMENT, TYPE=CAX{nodes}, ELSET={name}"]
    elements = {k: np.array([place[int(i)] for i in of]) for k, *of in rows}
    for corners in elements.values():
        assert np.linalg.det(corners[1:3] - corners[0]) > 0
        ends = np.roll(corners[:3], -1, axis=0)
        middles = (corners[:3] + ends) / 2 - corners[3:] if nodes == 6 else np.zeros((3, 2))
        assert (np.hypot(*middles.T) < 0.1 * np.hypot(*(ends - corners[:3]).T)).all()
    faces = cards[f"*SURFACE, NAME={name}SURFACE"]
    assert len(faces) == 32
    for element, face in faces:
        k = int(face.removeprefix("S")) - 1
        ends = elements[element][[k, (k + 1) % 3]]
        assert np.hypot(*ends.T) == pytest.approx(radius, rel=1e-12)
    for what, axis in (("AXIS", 0), ("EQUATOR" if name == "BALL" else "RIM", 1)):
        listed = {int(k) for (k,) in cards[f"*NSET, NSET={name}{what}"]}
        assert listed == {k for k, x in place.items() if abs(x[axis]) < 1e-12}


def test_the_joint_decides_what_is_held():
    usual = calculix.deck(JOINT, [0.1, 0.2], 32)
    other = calculix.deck(Joint.from_ratios(200, **HELD), [0.1], 32, large=True)
    cards = "*STEP", "SOCKETRIM, 2, 2", "BALLEQUATOR, 1, 1", "NLGEOM"
    assert [usual.count(card) for card in cards] == [2, 1, 0, 0]
    assert [other.count(card) for card in cards] == [1, 0, 1, 1]


def test_a_missing_program_is_named(monkeypatch):
    monkeypatch.setenv("PATH", "")
    assert calculix.version() is None
    with pytest.raises(checks.StudyError, match=r"ccx \(Debian's calculix-ccx\) is not installed"):
        calculix.force_curve(JOINT, 0.1, 32, 3)


def test_kinematics_that_calculix_has_not_are_refused():
    with pytest.raises(ValueError, match="kinematics must be one of linear, got 'small'"):
        calculix.force_curve(Joint.from_ratios(200, kinematics="small"), 0.1)


def _cards(text):
    """Rows of every keyword line."""
    cards = {}
    for line in text.splitlines():
        if line.startswith("*"):
            rows = cards.setdefault(line, [])
        else:
            rows.append([part.strip() for part in line.split(",") if part.strip()])
    return cards
