"""Wrong input to every public function: one clear error for each value, never a silent number.

A table of functions with wrong values for every argument, the same by hypothesis with numbers of
any size, and the command line. An error is one line and names the argument, or shows the value. A
test goes through all wrong values of its function, and reports every one that is not refused so.
"""

import re
from dataclasses import replace
from functools import partial
from math import inf, nan

import numpy as np
import pandas as pd
import pytest
from benchmarks import charts
from helpers.laws import IN_SI_UNITS
from hypothesis import given, settings
from hypothesis import strategies as st

from study import checks, choose, cli, contact, dataset, export
from study.choose import choose_model, model
from study.claims import search, statistics, table_alone, verdicts
from study.contact import damping, power_fit
from study.dataset import fitting
from study.joint import (
    DimensionalJoint,
    DirectionalLaw,
    Joint,
    Material,
    UnresolvedError,
    directional_law,
    fem,
    first_yield,
    force_curve,
    material,
    paper_joint,
    series,
    stress,
    whole_curve,
)
from study.measure import explicit, limits, stability
from study.mechanism import (
    MechanismError,
    Scene,
    compare,
    measures,
    paper_scene,
    simulate,
    stable_step,
)
from study.mechanism.spatial import ClearanceJoint

ERRORS = (ValueError, TypeError, checks.StudyError)

MASKED = np.ma.masked_array([0.1, 0.2], [False, True])
RAGGED = [[0.1], [0.2, 0.3]]
NO_NUMBER = (nan, inf, -inf, None, "0.1", True, 1j, {}, MASKED, RAGGED, 1e308, 10**400)
LIST = (*NO_NUMBER, [0.1, nan], ["a"], [None])
NUMBER = (*NO_NUMBER, [0.1, 0.2], [], np.eye(2))
POSITIVE = (*NUMBER, 0, -1, 1e-300)
WHOLE = (*NUMBER, 0.5, -3, 1e30)
NAME = ("", "x", None, 3, nan, ["x"], {}, np.array(["x", "y"]), np.eye(2))
FLAG = (-1, 2, None, "yes", nan, [True], np.array([True, False]))
THING = (None, 3, nan, "joint", {}, [1, 2], np.eye(2), object)
TABLE = (None, 3, [1, 2], {}, np.eye(2), pd.DataFrame(), pd.DataFrame({"x": [1]}))

GOOD = {"ball_radius": 9.95e-3, "socket_radius": 0.01, "composite_modulus": 1.1e11}
CURVE = force_curve(Joint(200), np.linspace(0.025, 1, 40) ** 2, 64)
BODIES = series.ball_compliance(0.3, 64), series.socket_compliance(1.3, 0.3, 64)
RESPONSE = simulate(duration=1e-3, outputs=10)
IDEAL = simulate(joint="ideal", duration=1e-3, outputs=10)
RUNS = dataset.set_ups().dropna(subset="energy_error").head(2)
STATE = np.array([0.1, 3e-5, 4.1e-5, 1.0, 0.0, 0.0])
SCENE = Scene()
PACKED = stability.packed(SCENE, "hertz")
FORCES = [1.0, 2.0, 4.0]
TWICE = np.full((2, 6, 6), 2.0)


def curve_with(**changes):
    return contact.tabulated(replace(CURVE, **changes))


def rows(function, **arguments):
    """A row of the table: a function with good arguments, and what is wrong for each of them."""
    good = {name: value for name, (value, _) in arguments.items()}
    yield (
        function,
        good,
        [(name, value) for name, (_, wrong) in arguments.items() for value in wrong],
    )


def law_rows():
    for name, law in contact.LAWS.items():
        yield from rows(
            law,
            depth_star=(0.3, LIST if name != "hyperbolic_winkler" else (*LIST, 1.3, [0.1, 5])),
            r2_star=(200, (*LIST, 1, 0, -5, [2, 1])),
            derivative=(False, FLAG),
        )
    tiny = (1e-300, 1e-45, [0.1, 1e-320])
    yield from rows(contact.hertz, depth_star=(0.3, (*tiny, 1e50)), r2_star=(200, (1e200,)))
    yield from rows(partial(contact.steuermann, 0.3, 200), n=(1, WHOLE), radius=("profile", NAME))
    yield from rows(
        partial(contact.winkler, 0.3, 200), coefficient=(1.0, set_without(POSITIVE, None))
    )
    yield from rows(partial(contact.hyperbolic_winkler, 0.3, 200), area=("flat", NAME))
    yield from rows(
        contact.stiffened_hertz,
        depth_star=(0.3, (1.1, [0.1, 2])),
        r2_star=(200, (19, 2)),
        socket_ratio=(1.3, (*NUMBER, 1, 1e7)),
        modulus_ratio=(1.0, (*NUMBER, -1, 1e10)),
        poisson=(0.3, (*NUMBER, 0.1, 0.5)),
        socket_poisson=(0.3, (*set_without(NUMBER, None), 0.1, 0.5)),
        ball_drive=("plane", (*NAME, "point")),
        rim=("mirror", NAME),
    )
    yield from rows(partial(contact.DimensionalLaw, **GOOD), law=("hertz", (*NAME, print)))
    yield from rows(partial(contact.DimensionalLaw, **GOOD, law="hertz"), n=(1, (1,)))
    yield from rows(
        partial(contact.DimensionalLaw, "hertz"),
        ball_radius=(9.95e-3, (*POSITIVE, 0.02)),
        socket_radius=(0.01, (*POSITIVE, 0.009)),
        composite_modulus=(1.1e11, POSITIVE),
    )
    sizes = {"ball_radius": 9.95e-3, "socket_radius": 0.01, "composite_modulus": 1.1e11}
    law = contact.DimensionalLaw("hyperbolic_winkler", **sizes)
    yield from rows(law.force, depth=(1e-5, (*LIST, 1e-60, 1e-4, 1e60)))
    yield from rows(law.stiffness, depth=(1e-5, (*LIST, 1e-60, 1e-4, 1e60)))
    yield from rows(law.depth, force=(10.0, (*LIST, -1.0, 1e9)))
    yield from rows(
        contact.composite_modulus,
        ball_modulus=(2e11, POSITIVE),
        ball_poisson=(0.3, (*NUMBER, 0.5, -1)),
        socket_modulus=(2e11, POSITIVE),
        socket_poisson=(0.3, (*NUMBER, 0.5, -1)),
    )
    yield from rows(
        curve_with,
        depth_star=(CURVE.depth_star, (*LIST, [0.1, 0.2], np.zeros(40), -CURVE.depth_star)),
        force_star=(CURVE.force_star, (*LIST, [0.1, 0.2], np.zeros(40), -CURVE.force_star)),
    )
    yield from rows(
        power_fit.fit_power,
        depth=([0.1, 0.2], (*LIST, [0.1], [0.1, 0.1], [0.0, 0.1], [0.1, 0.2, 0.3])),
        force=([1.0, 2.0], (*LIST, [0.1], [0.0, 0.1], [0.1, 0.2, 0.3])),
    )
    table = contact.tabulated(CURVE)
    yield from rows(table, depth_star=(0.3, (*LIST, 1.1)), r2_star=(200, (*LIST, 100)))
    yield from rows(
        damping.damping_factor, damping=("exact", NAME), restitution=(0.5, (*NUMBER, -0.1, 1.1, 0))
    )


def set_without(values, right):
    return tuple(value for value in values if value is not right)


def hashable(good, wrong):
    """Values of an argument of a function that is remembered by its arguments."""
    return good, [value for value in wrong if type(value).__hash__]


def joint_rows():
    poisson = (0.3, (*NUMBER, 0.5, -1, 0.6))
    strength = (1e9, set_without(POSITIVE, None))
    yield from rows(
        Material, youngs_modulus=(2e11, POSITIVE), poisson=poisson, yield_stress=strength
    )
    steel = Material(yield_stress=1e9)
    yield from rows(
        first_yield,
        joint=(Joint(200, ball=steel), (Joint(200),)),
        depth_star=(0.3, (*POSITIVE, 30)),
    )
    yield from rows(
        partial(stress.stresses, CURVE),
        body=("ball", NAME),
        radius=(0.5, (*LIST, 0, -1, 1.1)),
        angle=(0.5, (*LIST, -0.1, 2)),
    )
    for function in (Joint, paper_joint):
        yield from rows(
            function,
            r2_star=(200, (*NUMBER, 1, 0, -5)),
            socket_ratio=(1.3, (*NUMBER, 1, 0.5, 1e100)),
            ball=(Material(), THING),
            socket=(Material(), (*THING, Material(2e-4), Material(2e30))),
            ball_drive=("plane", (*NAME, "core:2", "neck:x")),
            rim=("mirror", set_without(NAME, None)),
            kinematics=("linear", NAME),
            opening=(90.0, (*NUMBER, 29, 91)),
            backing=("whole", (*NAME, "60,30", "0,95", "0,1")),
        )
    yield from rows(paper_joint, colour=("red", ("red",)))
    yield from rows(material, given=("steel", (*NAME, "1e9", "1,2,3,4")))
    yield from rows(
        DimensionalJoint,
        socket_radius=(0.01, POSITIVE),
        clearance=(1e-4, (*POSITIVE, 0.01, 1e-13)),
        wall=(3e-3, (*POSITIVE, 1e-9)),
        ball=("steel", (*NAME, object)),
        socket=("bronze", (*NAME, object)),
        liner=((), (3, "PTFE", ("PTFE",), ((1e-4,),), ((-1e-4, "PTFE"),), ((1, "PTFE"),))),
        ball_drive=("plane", NAME),
        rim=("mirror", set_without(NAME, None)),
        kinematics=("linear", NAME),
        opening=(90.0, (*NUMBER, 29, 91)),
        backing=("whole", (*NAME, "60,30")),
    )
    sized = DimensionalJoint(0.01, 1e-4, 3e-3)
    wrong = (*set_without(LIST, None), 0, -1, [], np.eye(2), 1e-30, 1e9)
    yield from rows(sized.solve, depth=(1e-5, wrong))
    yield from rows(sized.solve, force=(100.0, wrong))
    solution = sized.solve(force=100.0)
    yield from rows(solution.friction_torque, friction=(0.1, (*NUMBER, -0.1)))
    path = (100.0, (*NUMBER, -1))
    yield from rows(solution.wear_depth, coefficient=(1e-15, (*NUMBER, -1)), path=path)
    yield from rows(
        partial(force_curve, Joint(200)),
        depth_star=(0.3, (*LIST, -0.1, 30, 1e-9, [], np.eye(2))),
        resolution=(64, (*set_without(WHOLE, None), 0, 16, 48, 1920)),
        solver=("series", set_without((*NAME, "bem"), None)),
    )
    core = Joint(200, ball_drive="core:0.2")
    yield from rows(
        directional_law,
        joint=(core, THING),
        depth_star=(0.3, (*POSITIVE, 0.1, 30)),
        tilt=(20.0, (*POSITIVE, 121)),
        resolution=(48, (*WHOLE, 16, 50, 112)),
    )
    table = DirectionalLaw(core, *np.array([[0.1, 0.4], [0, 9]]), *np.ones((2, 2, 2)), 0, TWICE)
    yield from rows(
        table.force, depth_star=(0.3, (*LIST, 0.5)), tilt=(5.0, (*LIST, 10, -10, [1, 2, 30]))
    )
    free = partial(force_curve, Joint(200, rim="free"), 0.3)
    yield from rows(free, solver=("quadratic", ("series",)), resolution=(64, (640, 1e6)))
    ratio, poisson = (1.3, (*NUMBER, 1, 1e100)), (0.3, (*NUMBER, 0.5, -1))
    mesh = (64, (*WHOLE, 0, 50, 2000))
    yield from rows(fem.ball_mesh, resolution=mesh, nodes=(6, (*WHOLE, 4)))
    yield from rows(fem.socket_mesh, ratio=ratio, resolution=mesh, nodes=(6, (*WHOLE, 4)))
    ratio, poisson, mesh = (hashable(*argument) for argument in (ratio, poisson, mesh))
    of_ball = {"poisson": poisson, "resolution": mesh}
    for ball in (fem.ball, fem.ball_compliance):
        yield from rows(ball, **of_ball)
    for socket in (fem.socket, fem.socket_compliance):
        yield from rows(socket, ratio=ratio, resolution=mesh)
    yield from rows(fem.ball, drive=hashable("plane", NAME))
    yield from rows(partial(fem.socket, 1.3), rim=hashable("mirror", NAME))


def table_2_rows():
    published = dataset.published_table_2()
    table = table_alone.printed(published)
    yield from rows(table_alone.printed, published=(published, (*TABLE, published[1:])))
    yield from rows(table_alone.interval, values=(FORCES, (*LIST, 1.0, [], np.eye(2))))
    sample = {
        "table": (table, (None, 3, {}, [1, 2], {"hertz": table["hertz"]})),
        "depths": (FORCES, (*LIST, 0.1, [0.1], np.eye(2))),
        "factor": (1.0, POSITIVE),
    }
    known = table_alone.known_forces([0.1, 0.2, 0.4])
    yield from rows(
        table_alone.totals,
        **sample,
        known=(known, (3, "x", known[:1], ([nan, 1, 2], known[1]), ([1], known[1]))),
        opposite=(False, FLAG),
    )
    sample["depths"] = ([0.1, 0.2, 0.3, 0.4, 0.5], sample["depths"][1])
    for function in (table_alone.coefficients, table_alone.disagreement, table_alone.forces):
        names = ("winkler", *NAME) if function is table_alone.forces else NAME
        yield from rows(function, law=("hyperbolic_winkler", names), **sample)
    sample["depths"] = (fitting.SAMPLE, sample["depths"][1])
    law = ("hyperbolic_winkler", ("winkler", *NAME))
    yield from rows(table_alone.needed_rounding, law=law, **sample)


def study_rows():
    pair = (FORCES, (*LIST, 1.0, [1.0], [1, 2], np.eye(2)))
    for measure in (
        statistics.determination,
        statistics.determination_as_published,
        statistics.rmse,
        statistics.relative_rmse,
        statistics.agreement,
    ):
        yield from rows(measure, truth=pair, prediction=pair)
    yield from rows(
        partial(statistics.determination, prediction=FORCES), truth=(FORCES, ([2, 2, 2],))
    )
    yield from rows(
        partial(statistics.relative_rmse, prediction=FORCES), truth=(FORCES, ([-1, 0, 1],))
    )
    yield from rows(
        statistics.adjusted,
        determination=(0.9, NUMBER),
        size=(20, WHOLE[:-1]),
        predictors=(1, (*WHOLE, 19)),
    )
    yield from table_2_rows()
    curve = pd.DataFrame({"r2_star": 200, "depth_star": [0.1, 0.2], "force_star": [1, 2]})
    yield from rows(
        fitting.coefficient,
        law=("winkler", NAME),
        depth_star=(FORCES, (*LIST, [0, 0, 0], [0.1, 0.2])),
        force_star=(FORCES, (*LIST, [0.1, 0.2])),
    )
    yield from rows(fitting.shape, law=("winkler", NAME), depth_star=([0.1], LIST))
    yield from rows(fitting.sampled, curve=(None, (*TABLE, curve)))
    yield from rows(
        fitting.coefficients_by_case, law=("winkler", NAME), curves=(curve, (*TABLE, curve * nan))
    )
    yield from rows(
        fitting.surrogate,
        r2_star=(FORCES, (*LIST, [1], [1, 1, 1], [1, 2])),
        f1=(FORCES, (*LIST, [1], [1, 2])),
    )
    yield from rows(
        partial(fitting.liu_coefficient, unit=np.ones(20)),
        force_star=(np.ones(21), LIST),
        published_determination=(-1.6, (*NUMBER, 2)),
    )
    yield from rows(partial(fitting.fit_laws, published=None), curves=(None, TABLE))
    yield from rows(
        choose.choose,
        joint=(Joint(200), THING),
        depth_star=(0.3, (*POSITIVE, 30)),
        tolerance=(0.01, (*POSITIVE, 1.1, 1e-15)),
    )
    yield from rows(
        export.export,
        law=("tabulated", NAME),
        form=("c", NAME),
        joint=(Joint(200), THING),
        depth_star=(0.3, (*set_without(LIST, None), 0, -1, 30, [], [0.1, 0.2, 0.3], [0.2, 0.1])),
    )
    core = Joint(200, ball_drive="core:0.2")
    yield from rows(
        partial(export.export, "tabulated", joint=core, depth_star=0.3),
        form=("c", (*NAME, "json")),
        tilt=(10.0, (*set_without(POSITIVE, None), 121)),
    )
    yield from rows(partial(export.export, form="c", joint=core, tilt=9.0), law=("tabulated", NAME))
    yield from rows(
        choose.axial_law_suffices,
        joint=(core, THING),
        depth_star=(0.3, (*POSITIVE, 30)),
        tilt=(10.0, (*POSITIVE, 121)),
        tolerance=(0.01, (*POSITIVE, 1.1)),
    )
    yield from rows(dataset.load, r2_star=(200, (nan, None, 7, "x")), case=("x", ("x", None, 3)))
    yield from rows(dataset.load, colour=("red", ("red",)))
    yield from rows(dataset.published, where=("Table 2", set_without(NAME, None)))
    yield from rows(dataset.measured, chart=("laws", set_without(NAME, None)))
    yield from rows(verdicts.result, name=("table2", (345, None)))


def mechanism_rows():
    lengths = dict.fromkeys(
        ("crank_length", "coupler_length", "clearance", "socket_radius"), POSITIVE
    )
    masses = dict.fromkeys(
        ("crank_mass", "coupler_mass", "slider_mass", "youngs_modulus", "density", "full_speed"),
        POSITIVE,
    )
    others = {
        "poisson": (*NUMBER, 0.5),
        "restitution": (*NUMBER, 1.1, -0.1),
        "friction": (*NUMBER, -0.1),
        "slow_speed": (*NUMBER, -1, 1),
        "driving_moment": (*NUMBER, 1e9),
        "gravity": (*NUMBER, 1e9),
        "damping": NAME,
        "initial_eccentricity": (*NO_NUMBER, [1e-5], (1, 2), (nan, 0), (None, 0), RAGGED),
        "crank_inertia": set_without((*NUMBER, -1), None),
        "link_modulus": set_without(POSITIVE, None),
        "ball": set_without(THING, None),
        "socket": set_without(NAME, None),
    }
    for name, wrong in (lengths | masses | others).items():
        yield from rows(Scene, **{name: (None, wrong)})
    yield from rows(Scene, colour=("red", ("red",)))
    yield from rows(SCENE.link, body=("crank", NAME))
    things = set_without(THING, None)
    yield from rows(
        simulate,
        scene=(SCENE, things),
        model=("rigid", NAME),
        joint=("clearance", set_without(NAME, None)),
        law=("hertz", set_without((*NAME, print), None)),
        duration=(0.01, POSITIVE),
        outputs=(10, (*WHOLE, 0, 10**7)),
        tolerance=(1e-8, set_without((*POSITIVE, 0.1, 1e-15), None)),
        progress=(None, (3, "x", [])),
        step=(None, (1e-6,)),
        elements=(None, ((4, 8),)),
        method=(None, ("centred",)),
    )
    yield from rows(simulate, colour=("red", ("red",)))
    yield from rows(paper_scene, colour=("red", ("red",)))
    yield from rows(
        partial(simulate, law="tabulated", duration=1e-4, outputs=2),
        wall=(3e-3, POSITIVE),
        liner=((), (3, "PTFE", ((1e-3,),), ((-1e-3, "PTFE"),))),
        colour=("red", ("red",)),
    )
    yield from rows(
        partial(simulate, law="tabulated", duration=1e-4, outputs=2),
        socket_ratio=(1.3, (*NUMBER, 1.0)),
    )
    for flexible_model in ("particles", "beams"):
        flexible = partial(simulate, model=flexible_model, duration=1e-3, outputs=2)
        yield from rows(
            flexible,
            step=(None, set_without(POSITIVE, None)),
            elements=(
                None,
                (3, (4,), (4, 0), (4, 1e9), (4.5, 8), ("4", 8), (None, 8), "48", RAGGED),
            ),
        )
    yield from rows(
        partial(simulate, model="particles", duration=1e-3, outputs=2),
        method=("centred", set_without(NAME, None)),
    )
    yield from rows(
        choose_model,
        scene=(SCENE, THING),
        tolerance=(0.1, (*POSITIVE, 1.1)),
        socket_ratio=(1.3, ()),
        quantity=("slider_position", (*NAME, "depth")),
    )
    yield from rows(
        compare.motion_nrms,
        truth=(RESPONSE, THING),
        response=(RESPONSE, THING),
        column=("slider_position", (*NAME, "motion")),
    )
    yield from rows(
        compare.normalised_rms,
        truth=(FORCES, (*LIST, [2, 2, 2])),
        values=(FORCES, (*LIST, [1, 2])),
    )
    yield from rows(compare.lead, response=(RESPONSE, THING), ideal=(RESPONSE, THING))
    yield from rows(
        measures.measures,
        response=(RESPONSE, THING),
        ideal=(IDEAL, (*THING, RESPONSE)),
        end=(1e-3, (*set_without(POSITIVE, None), 1e-4, 1.0)),
        early=(5e-4, (*POSITIVE, 1.0)),
    )
    yield from rows(search.held, runs=(RUNS, (*THING, RUNS[["model"]])))
    yield from rows(search.group, runs=(RUNS, THING))
    yield from rows(search.never_together, holds=(search.held(RUNS), THING))
    yield from rows(
        explicit.integrate,
        scene=(SCENE, THING),
        law=(PACKED, (None, 3, "hertz", [1], RAGGED)),
        duration=(1e-4, POSITIVE),
        outputs=(2, (*WHOLE, 0, 10**9)),
        step=(1e-6, (*POSITIVE, 1e-20)),
        scheme=("RK4", NAME),
        start=(None, set_without((*LIST, [0] * 5), None)),
        approach=(inf, set_without(POSITIVE, inf)),
        guarded=(True, FLAG),
    )
    yield from rows(
        ClearanceJoint,
        law=(DimensionalJoint(0.01, 1e-4, 3e-3), (*THING, "hertz", Joint(200))),
        restitution=(0.5, (*NUMBER, -0.1, 1.1, 0)),
        damping=("exact", NAME),
        friction=(0.1, (*NUMBER, -0.1)),
        slow_speed=(1e-4, (*NUMBER, -1, 1)),
        full_speed=(0.01, POSITIVE),
        tension=(False, FLAG),
    )
    yield from rows(stable_step, scene=(SCENE, THING), elements=((4, 8), (None, 3, (4,), (4, nan))))


def stability_rows():
    scene, law, state = (SCENE, THING), ("hertz", NAME), (STATE, (*LIST, [0] * 6, [1] * 5))
    yield from rows(stability.packed, scene=scene, law=law)
    yield from rows(limits.bisect, fails=(bool, (None, 3)), low=(1, POSITIVE), high=(2, POSITIVE))
    yield from rows(stability.lasting_contact, scene=scene, law=law, duration=(1e-4, POSITIVE))
    yield from rows(stability.oscillator, scene=scene, law=law, state=state)
    yield from rows(
        stability.observed_step, scene=scene, law=law, state=state, scheme=("RK4", NAME)
    )
    yield from rows(
        stability.step_limit, scheme=("RK4", NAME), frequency=(1.0, POSITIVE), rate=(0.0, (nan, -1))
    )
    yield from rows(damping.delivered_restitution, factor=(0.5, (*NUMBER, -1)))


TABLE_OF_CASES = [
    case
    for part in (law_rows, joint_rows, study_rows, mechanism_rows, stability_rows)
    for case in part()
]


def name_of(function):
    while isinstance(function, partial):
        function = function.func
    return getattr(function, "__name__", "law")


def message_of(call):
    """Message of the error that a call ends in, or None."""
    try:
        call()
    except ERRORS as error:
        return str(error)
    return None


def wrong_message(message, *signs):
    """What is wrong with the message of an error, if anything."""
    if message is None:
        return "no error"
    if "\n" in message.strip():
        return f"several lines: {message}"
    return "" if any(sign in message for sign in signs) else f"names nothing: {message}"


def tells(error, pattern="must be .* got"):
    assert re.search(pattern, str(error))


def signs_of(name, value):
    """What a message may name an argument by: its name, a word of it, or its value."""
    words = [word for word in re.split("[_ ]", name) if len(word) > 3]
    shown = [f"{value:g}"] if isinstance(value, (int, float)) and abs(value) < 1e300 else []
    return name, checks.shown(value), *words, *shown


@pytest.mark.parametrize(
    ("function", "good", "wrong"),
    [pytest.param(*case, id=name_of(case[0])) for case in TABLE_OF_CASES],
)
def test_wrong_arguments_are_one_clear_error_each(function, good, wrong):
    failures = []
    for name, value in wrong:
        message = message_of(partial(function, **(good | {name: value})))
        if why := wrong_message(message, *signs_of(name, value)):
            failures.append(f"{name} = {checks.shown(value)}: {why}")
    assert not failures, "\n".join(failures)


def test_the_table_is_long_enough():
    assert sum(len(wrong) for _, _, wrong in TABLE_OF_CASES) >= 3100


def test_steuermanns_profile_of_high_order_on_a_nearly_full_ball():
    # (R2/R1)^99 overflows; mpmath with 60 digits
    force = contact.steuermann(0.3, 1.0005, n=50, radius="profile")
    assert force == pytest.approx(3.315413834728e-4, rel=1e-12)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: force_curve(Joint(200, 1.01, rim="free"), 0.3), "socket_ratio must be >= 1.02"),
        (lambda: force_curve(Joint(1e9, kinematics="finite"), 0.3), "r2_star must be <= 1e+08"),
        (lambda: force_curve(Joint(1.01), 0.3), "depth_star must be < 0.00995"),
        (lambda: Joint(200, 1e100, rim="free"), "socket_ratio must be >= 1.0001 and <= 1e+06"),
        (lambda: Joint(1e308), "r2_star must be > 1 and <= 1e+40 in size, got 1e+308"),
        (lambda: Joint(200, socket=Material(2e-4)), "over that of the ball must be >= 1e-09"),
        (lambda: simulate(Scene(crank_length=1e-9)), "speed of the crank must be <= 1e+06"),
        (lambda: simulate(Scene(crank_length=2e-5)), "speed of the crank must be <= 1e+06"),
        (lambda: contact.hertz([0.1, 0.2], [20, 30, 40]), "depth_star and r2_star must have"),
        (lambda: contact.hertz(10**5000, 200), "depth_star must be a number, got"),
    ],
)
def test_a_limit_says_what_it_limits(call, message):
    assert not wrong_message(message_of(call), message)


SIZES = st.floats(1e-40, 1e40)
ANY = st.floats()


@given(depth=ANY, r2_star=ANY, n=st.integers(1, 50))
def test_a_law_gives_a_positive_force_or_refuses(depth, r2_star, n):
    calls = [partial(law, depth, r2_star) for law in contact.LAWS.values()]
    for call in [*calls, partial(contact.steuermann, depth, r2_star, n=n, radius="profile")]:
        for derivative in (False, True):
            try:
                value = call(derivative=derivative)
            except ValueError as error:
                tells(error)
                continue
            assert np.isfinite(value)
            assert (value > 0) == (depth > 0)


@given(depth=SIZES, gap=st.floats(1e-15, 1), socket=SIZES, modulus=SIZES)
def test_a_force_in_si_units_neither_overflows_nor_vanishes(depth, gap, socket, modulus):
    ball = socket * (1 - gap)
    for law in contact.LAWS:
        options = IN_SI_UNITS[law]
        sizes = {"ball_radius": ball, "socket_radius": socket, "composite_modulus": modulus}
        for derivative in ("force", "stiffness"):
            try:
                value = getattr(contact.DimensionalLaw(law, **sizes, **options), derivative)(depth)
            except ValueError as error:
                tells(error)
                continue
            assert 0 < value < inf


@given(ANY, ANY, ANY, ANY)
def test_a_composite_modulus_is_between_half_of_the_lesser_and_infinity(e1, nu1, e2, nu2):
    try:
        found = contact.composite_modulus(e1, nu1, e2, nu2)
    except ValueError as error:
        tells(error)
        return
    assert min(e1, e2) / 2.01 <= found < inf


@settings(max_examples=30)
@given(ratio=st.floats(1e-9, 1e9), r2_star=st.floats(3, 1e40), thickness=st.floats(1.0001, 1e6))
def test_a_joint_inside_its_limits_is_solved_or_refused(ratio, r2_star, thickness):
    joint = Joint(r2_star, thickness, socket=Material(ratio * 2e11))
    try:
        curve = force_curve(joint, [0.2, 0.4], 64)
    except ERRORS as error:
        tells(error, "must|did not converge")
        return
    assert (curve.force_star > 0).all()
    assert np.isfinite(curve.force_star).all()


@given(st.lists(ANY, min_size=2, max_size=6), st.lists(ANY, min_size=2, max_size=6))
def test_measures_of_agreement_are_finite_or_refused(truth, prediction):
    try:
        found = statistics.agreement(truth, prediction)
    except ValueError as error:
        tells(error, "must .* got")
        return
    assert np.isfinite(list(found.values())).all()


@given(st.lists(ANY, max_size=5), st.lists(ANY, max_size=5))
def test_a_line_is_finite_or_refused(r2_star, f1):
    try:
        line = fitting.surrogate(r2_star, f1)
    except ValueError as error:
        tells(error, "must .* got")
        return
    assert np.isfinite(list(line.values())).all()


JOINT = ("joint", "--r2-star", 200, "--depth-star", 0.3)
CHOOSE = ("choose", "--r2-star", 200, "--depth-star", 0.3, "--tolerance", 0.01)
NUMBERS = ("nan", "inf", "-inf", "1e308", "x", "")
COMMANDS = [
    *((*JOINT, "--modulus-ratio", value) for value in (*NUMBERS, "0", "-1", "1e-15", "1e15")),
    *((*JOINT, "--socket-ratio", value) for value in (*NUMBERS, "0", "1", "1e100")),
    *((*JOINT, "--socket-ratio", "1e100", "--rim", value) for value in ("free", "x")),
    *((*JOINT, "--poisson", value) for value in (*NUMBERS, "0.5", "-1")),
    *((*JOINT, "--socket-poisson", value) for value in (*NUMBERS, "0.5", "-1")),
    *(
        (*JOINT, "--layer", value)
        for value in (*NUMBERS, "1.2,1", "1,1,0.3", "1.2,0,0.3", "1.2,1,1")
    ),
    (*JOINT, "--layer", "1.2,1,0.3", "--layer", "1.1,1,0.3"),
    *((*JOINT, "--depth-star", value) for value in (*NUMBERS, "-1", "99", "1e-9")),
    *((*JOINT, "--r2-star", value) for value in (*NUMBERS, "1", "-5")),
    *((*JOINT, f"--{name}", "x") for name in ("drive", "rim", "kinematics", "solver", "colour")),
    *((*CHOOSE, "--tolerance", value) for value in (*NUMBERS, "0", "2", "1e-15")),
    *((*CHOOSE, "--depth-star", value) for value in (*NUMBERS, "0", "99")),
    *(("law", law, "--r2-star", 200, "--depth-star", v) for law in contact.LAWS for v in NUMBERS),
    *(("law", "hertz", "--r2-star", value, "--depth-star", 1) for value in (*NUMBERS, "1")),
    *(("export", "--law", "tabulated", "--format", "csv", "--r2-star", v) for v in NUMBERS),
    *(
        (*words, "--drive", drive, "--tilt", tilt)
        for words in (CHOOSE, ("export", "--law", "tabulated", "--format", "c"))
        for drive, tilt in (("plane", 9), ("point", 9), *(("core:0.2", v) for v in NUMBERS))
    ),
    ("export", "--law", "tabulated", "--format", "csv", "--modulus-ratio", "1e-15"),
    ("export", "--law", "x", "--format", "csv"),
    ("export", "--law", "tabulated", "--format", "x"),
    *(("simulate", "--duration", value) for value in (*NUMBERS, "0", "-1", "1e12", "1e6")),
    *(("simulate", "--outputs", value) for value in (*NUMBERS, "0", "1e9", "10000000")),
    *(("simulate", "--tolerance", value) for value in (*NUMBERS, "0", "1", "1e-30")),
    *(("simulate", "--model", "beams", "--step", value) for value in (*NUMBERS, "0", "1e-30")),
    *(("simulate", "--elements", value) for value in ("", "4", "4,8,9", "a,b", "4.5,8", "4,8")),
    *(("simulate", "--inertia", value) for value in ("", "1", "a,b", "nan,1", "-1,1", "1e99,1")),
    *(
        ("simulate", "--scene", f"{name}={value}")
        for name in Scene.__dataclass_fields__
        for value in ("", "x", "nan", "inf", "1e308", "-1e300")
    ),
    *(("simulate", "--wall", value) for value in (*NUMBERS, "0", "-1", "1e9")),
    *(("simulate", "--liner", value) for value in ("", "PTFE", "1e-3", "a,PTFE", "1,PTFE")),
    ("simulate", "--scene", "crank_length=1e-9"),
    ("simulate", "--scene", "x=1"),
    ("simulate", "--model", "auto", "--tolerance", "0"),
    *(("data", "show", "--r2-star", value) for value in (*NUMBERS, "7")),
    ("data", "show", "--case", "x"),
    ("data", "show", "--group", "x"),
    ("measure", "--repeats", "0"),
    ("measure", "--chart", "x"),
    ("run", "x"),
    ("run", "fig10", "--jobs", "0"),
    ("x",),
]


@pytest.mark.parametrize("command", sorted({words[0] for words in COMMANDS}))
def test_a_wrong_command_line_is_one_line_and_status_2(command, monkeypatch, capsys):
    failures = []
    for words in (words for words in COMMANDS if words[0] == command):
        monkeypatch.setattr("sys.argv", ["study", *map(str, words)])
        with pytest.raises(SystemExit) as stop:
            cli.main()
        out, err = capsys.readouterr()
        if (stop.value.code, out, err.count("\n")) != (2, "", 1):
            failures.append(f"{' '.join(map(str, words))}: {stop.value.code} {out}{err}")
    assert not failures, "\n".join(failures)


def test_a_scene_whose_contact_only_the_solver_knows_is_refused_by_auto(monkeypatch):
    only = choose.choose(Joint(200), 0.3, 0.01)
    monkeypatch.setattr(model, "choose", lambda *_: replace(only, law="solver", evaluate=None))
    with pytest.raises(checks.StudyError, match="no law for calls at every step is known"):
        choose_model(SCENE, 0.01)


def test_an_error_of_the_program_is_not_taken_for_a_law_out_of_range(monkeypatch):
    def broken(*arguments, **options):
        raise ValueError("a slip")

    monkeypatch.setitem(contact.LAWS, "hertz", broken)
    with pytest.raises(ValueError, match="a slip"):
        choose.choose(Joint(200), 0.3, 0.01)


def test_an_error_of_the_program_is_not_taken_for_a_wrong_claim(monkeypatch):
    def broken(*arguments):
        raise ValueError("a slip")

    monkeypatch.setattr(verdicts, "verdict", broken)
    with pytest.raises(ValueError, match="a slip"):
        verdicts.judge()


def test_a_stepper_that_fails_is_not_dropped_from_its_chart(monkeypatch):
    def too_deep(*arguments):
        raise MechanismError("too deep")

    monkeypatch.setattr(charts, "_ours", lambda _: np.ones(3))
    monkeypatch.setattr(charts, "_explicit", too_deep)
    with pytest.raises(MechanismError, match="too deep"):
        charts.steppers(1, [("RK4", 4e-6)], compile_times=False)


@pytest.mark.parametrize("kind", [np.float32, np.float64, np.longdouble, np.int64, np.array])
def test_numpys_numbers_are_stored_as_pythons(kind):
    joint = Joint(kind(200), kind(2), Material(kind(2**37), poisson=0.25))
    assert joint == Joint(200, 2, Material(2**37, poisson=0.25))
    assert hash(joint) == hash(Joint(200, 2, Material(2**37, poisson=0.25)))
    assert {type(joint.r2_star), type(joint.socket_ratio)} == {float}
    assert force_curve(joint, [0.1]).force_star > 0
    scene = Scene(coupler_length=kind(2), gravity=kind(9))
    assert (scene, type(scene.gravity)) == (Scene(coupler_length=2, gravity=9), float)
    assert hash(DimensionalJoint(kind(1), 1e-3, kind(2))) == hash(DimensionalJoint(1, 1e-3, 2))


@pytest.mark.parametrize("supports", [{}, {"ball_drive": "clamped"}, {"kinematics": "finite"}])
@pytest.mark.parametrize("depth", [1e-12, 4.7e-9, 1e-7])
def test_a_contact_too_small_for_the_elements_is_said_to_be_so(supports, depth):
    joint = Joint(200, **supports)
    for solve in (lambda: force_curve(joint, [depth]), lambda: whole_curve(joint, depth)):
        with pytest.raises(UnresolvedError, match=r"elements resolve the contact|16 elements"):
            solve()
    with pytest.raises(UnresolvedError, match=r"elements resolve the contact|16 elements"):
        choose.choose(joint, depth, 0.05)


def test_choose_at_small_depths_with_large_displacements():
    joint = Joint(200, kinematics="finite")
    assert choose.choose(joint, 0.02, 0.2).error_bound <= 0.2


def test_radii_whose_ratio_is_lost_in_rounding_are_refused():
    with pytest.raises(checks.RangeError, match="socket_radius over clearance must be > 1, got 1"):
        contact.DimensionalLaw(
            "hertz", ball_radius=1e-30, socket_radius=1.0, composite_modulus=1e11
        )
