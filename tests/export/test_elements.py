"""Exported elements in their programs: the depth under a force is that of the joint.

Exudyn, MuJoCo and Rumoca (a Modelica compiler) are optional (the extra other-programs); Adams' line
is read back.
"""

import re
import warnings

import numpy as np
import pytest
from scipy.interpolate import Akima1DInterpolator
from scipy.optimize import brentq

from study import paths
from study.export import FORMATS, export
from study.joint import Joint

BRONZE = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
FORCES = 5e3, 3e4  # inside the range of the fits, 0.05 to 0.5 clearances
TABLE_ERROR = 1e-5  # of a text with the joint's own table
DAMPING = 1e5  # N s/m, so that a ball of 1 kg comes to rest


def stated_error(text):
    """The error that a text states, relative."""
    return float(re.search(r"at\s+most ([\d.]+) %", re.sub(r"\n[!#/* ]*", " ", text))[1]) / 100


def assert_depth(depth, force, error):
    """A depth is as good as an error of the force allows, whose exponent is above 1.5."""
    assert depth == pytest.approx(BRONZE.law().depth(force), rel=error / 1.5 + 1e-6)


@pytest.mark.parametrize("law", ["power", "tabulated"])
def test_exudyn(law):
    exudyn = pytest.importorskip("exudyn")
    from exudyn import itemInterface as item  # noqa: N813

    text, module = export(law, "exudyn", BRONZE), {}
    exec(text, module)
    error = stated_error(text) if law == "power" else TABLE_ERROR
    for force in FORCES:
        system = exudyn.SystemContainer().AddSystem()
        ground = system.AddObject(item.ObjectGround())
        start = [BRONZE.clearance + 0.9 * BRONZE.law().depth(force), 0, 0, 0, 0, 0]
        node = system.AddNode(item.NodeRigidBodyRxyz(referenceCoordinates=start))
        of_body = {"mass": 1, "inertia": [1, 1, 1, 0, 0, 0]}
        body = system.AddObject(item.ObjectRigidBody(nodeNumber=node, **of_body))
        socket, ball = (
            system.AddMarker(item.MarkerBodyRigid(bodyNumber=b)) for b in (ground, body)
        )
        module["add_joint"](system, socket, ball)
        damper = item.ObjectConnectorCartesianSpringDamper(damping=[DAMPING] * 3)
        damper.markerNumbers = [socket, ball]
        system.AddObject(damper)
        system.AddLoad(item.Force(markerNumber=ball, loadVector=[force, 0, 0]))
        system.Assemble()
        settings = exudyn.SimulationSettings()
        settings.timeIntegration.numberOfSteps = 1000
        settings.timeIntegration.endTime = 5e-3
        settings.solutionSettings.writeSolutionToFile = False
        system.SolveDynamic(settings)
        place = system.GetNodeOutput(node, exudyn.OutputVariableType.Position)
        assert_depth(place[0] - BRONZE.clearance, force, error)


def test_mujoco():
    mujoco = pytest.importorskip("mujoco")
    text = export("tabulated", "mujoco", BRONZE)
    other = export("tabulated", "mujoco", BRONZE, name="other")  # in the same model, at rest
    world = "".join(
        f'<site name="{prefix}socket"/><body><freejoint/><geom size="0.01" mass="1"/>'
        f'<site name="{prefix}ball"/></body>'
        for prefix in ("", "other_")
    )
    tendons = "".join(re.search(r"<tendon>.*</tendon>", x, re.DOTALL)[0] for x in (text, other))
    body = f"<worldbody>{world}</worldbody>{tendons}"
    model = mujoco.MjModel.from_xml_string(f"<mujoco>{body}</mujoco>")
    data = mujoco.MjData(model)

    def force_at(depth):
        data.qpos[0] = BRONZE.clearance + depth
        mujoco.mj_forward(model, data)
        return -data.qfrc_passive[0]

    assert force_at(-1e-6) == 0
    for force in FORCES:
        depth = brentq(lambda d, f=force: force_at(d) - f, 0, 0.5 * BRONZE.clearance, xtol=1e-15)
        assert_depth(depth, force, stated_error(text))
    depths = BRONZE.clearance * np.geomspace(0.001, 1, 50)
    off = np.array([force_at(depth) for depth in depths]) / BRONZE.law().force(depths) - 1
    assert 0.9 * stated_error(text) < np.abs(off).max() < 1.001 * stated_error(text) < 0.01
    outside = re.findall(r"at\s+(\S+) m it is (\S+) % too large", text)
    assert len(outside) == 2
    for depth, percent in outside:
        off = 100 * (force_at(float(depth)) / BRONZE.law().force(float(depth)) - 1)
        assert off == pytest.approx(float(percent), rel=0.05)
    turn = float(re.search(r"it\s+falls\s+from\s+(\S+)\s+m", text)[1])
    around = [force_at(turn * factor) for factor in (0.9, 1, 1.1)]
    assert max(around) == around[1]


@pytest.mark.parametrize("name", [None, "left"])
@pytest.mark.parametrize("gap", [0.0, 1e-5])
def test_exudyn_delivers_the_restitution(gap, name):
    """Of a ball that starts at first touch, or before it; Exudyn's own rule is rough at 0.2."""
    exudyn = pytest.importorskip("exudyn")
    from exudyn import itemInterface as item  # noqa: N813

    module, speed, prefix = {}, 0.1, f"{name}_" if name else ""
    exec(export("power", "exudyn", BRONZE, name=name), module)
    for restitution, error in ((1, 0.002), (0.8, 0.002), (0.5, 0.002), (0.2, 0.006)):
        system = exudyn.SystemContainer().AddSystem()
        ground = system.AddObject(item.ObjectGround())
        start = {"referenceCoordinates": [BRONZE.clearance - gap, 0, 0, 0, 0, 0]}
        start["initialVelocities"] = [speed, 0, 0, 0, 0, 0]
        node = system.AddNode(item.NodeRigidBodyRxyz(**start))
        of_body = {"mass": 1, "inertia": [1, 1, 1, 0, 0, 0]}
        body = system.AddObject(item.ObjectRigidBody(nodeNumber=node, **of_body))
        markers = [system.AddMarker(item.MarkerBodyRigid(bodyNumber=b)) for b in (ground, body)]
        module[f"add_{name or 'joint'}"](system, *markers, restitution)
        system.Assemble()
        settings = module[f"{prefix}solver_settings"]((gap + 6e-5) / speed, 500)
        settings.solutionSettings.writeSolutionToFile = False
        system.SolveDynamic(settings)
        velocity = system.GetNodeOutput(node, exudyn.OutputVariableType.Velocity)[0]
        assert -velocity / speed == pytest.approx(restitution, abs=error)


@pytest.mark.parametrize("law", ["power", "stiffened_hertz", "tabulated"])
def test_modelica(law):
    """The function runs; the component, which needs the standard library, is parsed."""
    rumoca = pytest.importorskip("rumoca")
    text = export(law, "modelica", BRONZE)
    assert not rumoca.validate_source(text)
    assert rumoca.validate_source(text.replace("algorithm", "algorithmus"))
    assert ("AssertionLevel.warning" in text) == (law != "power")
    function = text.replace("within;", "")[: text.index("  model Joint") - len("within;")]
    error = TABLE_ERROR if law == "tabulated" else stated_error(text)
    for force in FORCES:
        press = f"""
            model Press
              Real microns(start = 1, fixed = true) "so that tolerances are small beside it";
              Real force;
              Real stiffness;
            equation
              (force, stiffness) = ClearanceJoint.contact_force(1e-6 * microns);
              der(microns) = 1e6 * ({force} - force) / stiffness;
            end Press;"""
        model = rumoca.Session().loads(f"{function}end ClearanceJoint;{press}", model="Press")
        assert_depth(1e-6 * model.simulate(t=40)["microns"][-1], force, error)


def test_adams():
    text = export("power", "adams", BRONZE)
    line = text.splitlines()[-1]
    x, speed, ends, k, n, damping, _ = (
        re.fullmatch(r"-IMPACT\((.*)\)", line)[1].replace("(ball, socket)", "").split(", ")
    )
    assert (x, speed, damping) == ("-DM", "-VR", "0")
    assert float(ends) == pytest.approx(-1e3 * BRONZE.clearance)
    for force in FORCES:
        depth = 1e-3 * (force / float(k)) ** (1 / float(n))  # k in N/mm^n
        assert_depth(depth, force, stated_error(text))


SPLINES = {
    "axis": (BRONZE, "tabulated", None),
    "thin wall": (Joint(10e-3, 1e-4, 0.3e-3, socket_support="rim"), "tabulated", None),
    "plastic": (Joint(14e-3, 5e-5, 6e-3, socket="UHMWPE", ball_support="clamped"), "liu", None),
    "shallow": (BRONZE, "tabulated", 0.02),
    "ring": (
        Joint(
            *(14.53e-3, 30e-6, 2.97e-3),
            socket="bearing steel",
            opening="65.6:114.4",
            ball_support="pin:10mm,16mm",
        ),
        "tabulated",
        None,
    ),
}


@pytest.mark.parametrize("case", SPLINES)
def test_adams_spline(case):
    """The function, read back, with SciPy's interpolation by Akima's method."""
    joint, law, deepest = SPLINES[case]
    text = export(law, "adams", joint, deepest, name="hip")
    x, y = (
        np.array(re.sub(r"[&\s]", "", of).split(","), float)
        for of in re.search(r"\n    x = ([^=]*)&\n    y = (.*)", text, re.DOTALL).groups()
    )
    assert (len(x), x[0], y[0]) == (20, 0, 0)
    distance = r"DM\(hip_ball, hip_socket\) - (\S+)"
    function = rf"IF\({distance}: 0, 0, -AKISPL\({distance}, 0, hip_spline, 0\)\)"
    ends = re.search(function, text).groups()
    assert [float(end) for end in ends] == pytest.approx([1e3 * joint.clearance] * 2)
    assert "data_element create spline &\n    spline_name = hip_spline &" in text
    made = joint.law(law) if joint.default_tilt is None else joint.law()
    first = float(re.search(r"depths >= \S+ clearances \((\S+) um\)", text)[1])
    depth = np.geomspace(1e-6 * first, 0.9999e-3 * x[-1], 2000)
    off = np.abs(Akima1DInterpolator(x, y)(1e3 * depth) / made.force(depth) - 1).max()
    words = re.sub(r"\n! ", " ", text)
    told = float(re.search(r"adds an error of up to (\S+) %", words)[1]) / 100
    assert 0.8 * told < off < 1.05 * told < 0.005
    assert "Adams was not run" in words


def test_exudyn_warns_of_a_depth_beyond_the_table():
    pytest.importorskip("exudyn")
    module = {}
    exec(export("tabulated", "exudyn", BRONZE, 0.5), module)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        module["contact_force"](0.5 * BRONZE.clearance)
    with pytest.warns(UserWarning, match="its error is unknown"):
        module["contact_force"](0.51 * BRONZE.clearance)


@pytest.mark.slow
def test_three_cubics_follow_rings():
    """As precisely as the page about other programs and the changelog state."""
    wide = Joint(
        *(8.03e-3, 30e-6, 4e-3), socket="bronze", opening="55:125", ball_support="pin:4e-3,12e-3"
    )
    for joint, error in ((Joint.of(bearing="GE 20 E"), 0.0024), (wide, 0.00088)):
        assert stated_error(export("tabulated", "mujoco", joint)) == pytest.approx(error)


def test_the_page_about_other_programs_shows_what_is_written(run):
    page = (paths.ROOT / "examples/README.md").read_text(encoding="utf-8")
    command, shown = re.findall(r"```(?:sh|text)\n(.*?)\n```", page)
    status, out, _ = run(*command.split()[1:])
    assert status == 0
    assert out.splitlines()[-1] == shown
    (error,) = re.findall(r"maximum relative error is ([\d.]+) %", page)
    assert float(error) == pytest.approx(100 * stated_error(out))
    (error,) = re.findall(
        r"For the joint above, the error is at most ([\d.]+) % at depths of at least 0\.001", page
    )
    assert float(error) == pytest.approx(100 * stated_error(export("tabulated", "mujoco", BRONZE)))
    assert all(f"`{form}`" in page or f"`{form}`," in page for form in FORMATS)
