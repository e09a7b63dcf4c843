"""Speed of the rigid stepper at equal accuracy, beside its peers: run with ``make bench``.

0.3 s of the paper's scene with Hertz's law, 3,000 outputs. Every method is timed at its
loosest setting whose NRMS error of the slider's acceleration, against a tolerance of 1e-11,
meets the target; the error found is part of the name. SUNDIALS and Exudyn are timed where
they are installed (extra ``peers``), Exudyn at a step of 1e-6 s, which misses the targets.
"""

import subprocess
import sys
from functools import cache
from math import atan2, cos, hypot, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from study.compiled import compiled
from study.contact.forces import pack
from study.contact.friction import friction_branch
from study.mechanism import Scene, rigid, simulate

SCENE, DURATION, OUTPUTS = Scene(), 0.3, 3000
TIMES = DURATION * np.arange(1, OUTPUTS + 1) / OUTPUTS
P = rigid.describe(SCENE)
LAW = pack("hertz", SCENE.ball_radius, SCENE.socket_radius, SCENE.composite_modulus)


def ours(tolerance):
    response = simulate(SCENE, duration=DURATION, outputs=OUTPUTS, tolerance=tolerance)
    return response.slider_acceleration[1:]


@compiled
def slopes(y, approach, p, law, out):
    """Rates of (theta, e, theta', e') in flight (approach 0) or contact, and x'' of the slider."""
    f, seen, unused = np.zeros(5), np.zeros(10), np.zeros((5, 6))
    z = np.zeros(8)
    z[:6] = y
    r = hypot(y[1], y[2])
    contact = approach > 0 and r > law[1]
    out[:3] = y[3:]
    if not contact:
        rigid.motion(z, (False, 0, 1.0), p, law, False, f, seen, unused)
        out[3], out[4], out[5] = f[0], f[1], f[2]
        return seen[rigid.SLIDER]
    nx, ny = y[1] / r, y[2] / r
    z[1], z[2] = r - law[1], atan2(ny, nx)
    z[4], z[5] = nx * y[4] + ny * y[5], (nx * y[5] - ny * y[4]) / r
    sp = (y[2] - p[rigid.L1] * sin(y[0])) / p[rigid.L2]
    psi = (y[5] - p[rigid.L1] * cos(y[0]) * y[3]) / (p[rigid.L2] * sqrt(1 - sp * sp))
    branch = friction_branch(r * z[5] + p[rigid.R1] * psi, p[rigid.V0], p[rigid.V1])
    rigid.motion(z, (True, branch, approach), p, law, False, f, seen, unused)
    c, s = cos(z[2]), sin(z[2])
    outward, across = f[1] - r * z[5] * z[5], r * f[2] + 2 * z[4] * z[5]
    out[3], out[4], out[5] = f[0], outward * c - across * s, outward * s + across * c
    return seen[rigid.SLIDER]


ABSOLUTE = np.array([1e-2, 1e-6, 1e-6, 1.0, 1e-2, 1e-2])  # of the state's parts, times rtol


def in_pieces(integrate):
    """Flight and contact in turn, each ended by ``integrate`` where the gap vanishes."""
    y, t, approach, found = np.zeros(6), 0.0, 0.0, []
    out = np.zeros(6)
    while True:
        times = TIMES[t < TIMES]
        states, end = integrate(t, y, approach, times)
        found += [slopes(z, approach, P, LAW, out) for z in states]
        if end is None:
            return np.array(found)
        t, y = end
        n = y[1:3] / np.hypot(y[1], y[2])
        approach = float(y[4:] @ n) if approach == 0 else 0.0


def gap(now, start, y, approach):
    """Event function; disarmed just after a start, where the gap is rounding only."""
    apart = -1.0 if approach == 0 else 1.0
    return hypot(y[1], y[2]) - SCENE.clearance if now > start + 1e-9 else apart


def lsoda(rtol):
    """SciPy's LSODA with the same compiled equations, and terminal events."""
    out = np.zeros(6)

    def right(_, y, approach):
        slopes(y, approach, P, LAW, out)
        return out

    def integrate(t, y, approach, times):
        def meet(now, y, approach):
            return gap(now, t, y, approach)

        meet.terminal, meet.direction = True, 1 if approach == 0 else -1
        part = solve_ivp(
            right,
            (t, DURATION),
            y,
            "LSODA",
            t_eval=times,
            events=meet,
            args=(approach,),
            rtol=rtol,
            atol=rtol * ABSOLUTE,
            max_step=2e-4 if approach == 0 else np.inf,
        )
        end = (part.t_events[0][0], part.y_events[0][0]) if part.status == 1 else None
        return np.transpose(part.y), end

    return in_pieces(integrate)


def sundials(rtol):
    """SUNDIALS' CVODE through scikit-sundae, in the same way."""
    from sksundae.cvode import CVODE

    def integrate(t, y, approach, times):
        def right(_, y, out):
            slopes(y, approach, P, LAW, out)

        def meet(now, y, events):
            events[0] = gap(now, t, y, approach)

        meet.terminal, meet.direction = [True], [1 if approach == 0 else -1]
        step = 2e-4 if approach == 0 else 0.0
        solver = CVODE(
            right,
            rtol=rtol,
            atol=rtol * ABSOLUTE,
            eventsfn=meet,
            num_events=1,
            max_step=step,
            max_num_steps=1_000_000,
        )
        part = solver.solve(np.append(t, times), y)
        inside = part.t > t
        if part.t_events is None or len(part.t_events) == 0:
            return part.y[inside], None
        end = part.t_events[0], part.y_events[0]
        return part.y[inside & (part.t < end[0])], end

    return in_pieces(integrate)


def exudyn(step):
    """Exudyn's own sphere in a sphere; its restitution set so that its damping is ours."""
    import exudyn as exu
    from exudyn import itemInterface as item  # noqa: N813
    from exudyn.utilities import SensorNode

    system = exu.SystemContainer().AddSystem()
    s = SCENE
    ground = system.AddObject(item.ObjectGround())
    bodies = {}
    for name, mass, inertia, x in (
        ("crank", s.crank_mass, s.inertias[0], s.crank_length / 2),
        ("coupler", s.coupler_mass, s.inertias[1], s.crank_length + s.coupler_length / 2),
        ("slider", s.slider_mass, 1e-4, s.crank_length + s.coupler_length),
    ):
        node = system.AddNode(item.NodeRigidBody2D(referenceCoordinates=[x, 0, 0]))
        body = item.ObjectRigidBody2D(mass=mass, inertia=inertia, nodeNumber=node)
        bodies[name] = node, system.AddObject(body)

    def at(body, x):
        number = ground if body == "ground" else bodies[body][1]
        return system.AddMarker(item.MarkerBodyRigid(bodyNumber=number, localPosition=[x, 0, 0]))

    half = s.crank_length / 2, s.coupler_length / 2
    for pair in (("ground", 0, "crank", -half[0]), ("crank", half[0], "coupler", -half[1])):
        markers = [at(*pair[:2]), at(*pair[2:])]
        system.AddObject(item.ObjectJointRevolute2D(markerNumbers=markers))
    fixed = system.AddNode(item.NodePointGround())
    fixed = system.AddMarker(item.MarkerNodeCoordinate(nodeNumber=fixed, coordinate=0))
    for coordinate in (1, 2):
        own = item.MarkerNodeCoordinate(nodeNumber=bodies["slider"][0], coordinate=coordinate)
        pair = [fixed, system.AddMarker(own)]
        system.AddObject(item.ObjectConnectorCoordinate(markerNumbers=pair))
    torque = [0, 0, s.driving_moment]
    system.AddLoad(item.LoadTorqueVector(markerNumber=at("crank", 0), loadVector=torque))
    start = [s.clearance, 0, 0, 0]  # the gap must start positive, or the first impact is missed
    data = item.NodeGenericData(initialCoordinates=start, numberOfDataCoordinates=4)
    contact = item.ObjectContactSphereSphere(
        markerNumbers=[at("coupler", half[1]), at("slider", 0)],
        nodeNumber=system.AddNode(data),
        spheresRadii=[s.ball_radius, s.socket_radius],
        isHollowSphere1=True,
        contactStiffness=LAW[2] / s.clearance**1.5,
        contactStiffnessExponent=1.5,
        impactModel=1,
        restitutionCoefficient=1 - (1 - s.restitution**2) / 2,
        contactDamping=0.0,
        dynamicFriction=s.friction,
        frictionProportionalZone=s.full_speed,
    )
    system.AddObject(contact)
    sensor = system.AddSensor(
        SensorNode(
            nodeNumber=bodies["slider"][0],
            outputVariableType=exu.OutputVariableType.Acceleration,
            storeInternal=True,
        )
    )
    system.Assemble()
    settings = exu.SimulationSettings()
    time = settings.timeIntegration
    time.numberOfSteps, time.endTime = round(DURATION / step), DURATION
    time.generalizedAlpha.spectralRadius = 0.9
    time.newton.useModifiedNewton = True
    time.discontinuous.useRecommendedStepSize = False
    time.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = DURATION / OUTPUTS
    system.SolveDynamic(settings)
    return system.GetSensorStoredData(sensor)[1:, 1]


@cache
def truth():
    return ours(1e-11)


def error(found):
    return np.sqrt(np.mean((found - truth()) ** 2) / np.mean(truth() ** 2))


@cache
def loosest(run, target):
    """Loosest setting of a ladder that meets the target, and its error."""
    for setting in 10 ** np.arange(-3, -12, -0.25):
        size = error(run(float(setting)))
        if size <= target:
            return float(setting), size
    raise AssertionError(f"no setting meets {target}")


@pytest.mark.parametrize("target", [1e-5, 1e-7])
@pytest.mark.parametrize("run", [ours, lsoda, sundials])
def test_rigid_clearance(benchmark, run, target):
    if run is sundials:
        pytest.importorskip("sksundae")
    setting, size = loosest(run, target)
    benchmark.group = f"0.3 s with clearance, NRMS error <= {target:g}"
    benchmark.name = f"{run.__name__}({setting:.1e}), error {size:.1e}"
    benchmark.pedantic(run, args=(setting,), rounds=7, warmup_rounds=1)


def test_exudyn(benchmark):
    pytest.importorskip("exudyn")
    size = error(exudyn(1e-6))
    benchmark.group = "0.3 s with clearance, Exudyn (misses both targets)"
    benchmark.name = f"exudyn(1e-06), error {size:.1e}"
    benchmark.pedantic(exudyn, args=(1e-6,), rounds=2)


@pytest.mark.parametrize("model", ["particles", "beams"])
def test_flexible_links(benchmark, model):
    benchmark.group = "0.1 s with clearance, flexible links"
    benchmark.pedantic(simulate, kwargs={"model": model}, rounds=3, warmup_rounds=1)


def test_start_of_stepping_in_a_new_process(benchmark):
    """Time from the loaded library to the first millisecond simulated, with a warm cache."""
    code = (
        "import time; from study.mechanism import simulate; start = time.perf_counter(); "
        "simulate(duration=1e-3); print(time.perf_counter() - start)"
    )

    def start():
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
        return float(done.stdout)

    start()
    benchmark.group = "start"
    benchmark.name = f"whole process; of it stepping starts after {min(start(), start()):.2f} s"
    benchmark.pedantic(start, rounds=3)
