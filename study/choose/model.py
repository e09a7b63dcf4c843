"""The least model of the crank-slider that is accurate enough, and how one knows.

Models in order of detail: an ideal joint, rigid links with Hertz's contact, with a law that
knows the joint, links of particles. The rigid ones take milliseconds, so that they are run and
compared. What flexible links would change is first bounded from their compliance and frequency
(`study.choose.links`), and only if that bound is too large are particles run and compared,
on two meshes and with two steps: what these change tells how far they can be trusted.
The ideal joint comes first because it asks for nothing about the contact, though integrated to
the last digit by SciPy it takes longer here than the compiled clearance joint.
"""

from dataclasses import dataclass, field
from functools import partial
from math import inf
from time import perf_counter

import numpy as np

from study import checks, dataset
from study.checks import StudyError
from study.choose import links
from study.choose.law import SHALLOWEST, choose
from study.contact import SOCKET_RATIO, hertz
from study.contact.forces import pack
from study.joint import Joint, Material
from study.mechanism import simulate
from study.mechanism.compare import difference
from study.mechanism.particles import usual_step
from study.mechanism.scene import Scene

LEAST_R2_STAR = 3  # of less, a ball cannot go one clearance deep
LAW_TOLERANCE = 0.01
"""Of the force of the law that stands for the exact one."""
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
FINEST_TOLERANCE = 1e-10
STEP_SHARE = 0.1  # of the tolerance, for the error of the steps
ELEMENTS = ((2, 4), links.ELEMENTS)
SAFETY = 3.0
"""On the largest difference that mesh and step of flexible links make, for what others make."""
STEPPERS = {"rigid": "Rodas5P", "particles": "central difference"}
WARM_UP = 1e-5  # s, simulated once before a model is timed


class ModelError(StudyError):
    """No model is known to be within the tolerance; ``known`` is the least bound of any."""

    def __init__(self, message, known):
        super().__init__(message)
        self.known = known


@dataclass(frozen=True)
class ModelChoice:
    """A model of a scene, with the evidence.

    Attributes
    ----------
    model, joint, law : str
        Links (``rigid`` or ``particles``), joint (``ideal`` or ``clearance``), contact law
        (``none`` for an ideal joint).
    settings : dict
        Stepper, and its tolerance, or its step (s) and elements.
    error_bound : float
        Of the NRMS error of the slider's motion: RMS of the error over RMS of the change since
        t = 0, over the duration chosen for. Not proven: an estimate with a margin (`SAFETY`
        here and in `links`), as impacts of flexible links are chaotic.
    relative_cost : float
        Time over that of rigid links with Hertz's law, measured while choosing.
    links : str
        How the links' share of the bound is known: ``bounded`` or ``compared``.
    quantity : str
        What the tolerance is for.
    compliance_ratio, frequency_ratio : float
        Links over contact at the largest depth, and the slider's frequency on the contact over
        the crank's axial one; 0 without contact.
    depth_star : float
        Largest depth of rigid links with Hertz's law, in clearances.
    note : str
        Why the random scenes behind ``bounded`` do not speak for this one; empty if they do.
    evidence : tuple of dict
        The same attributes, from ``model`` to ``links``, of every model that was looked at, in
        order of detail.
    run : callable
        Runs the model: of scene, duration, outputs and progress.
    """

    model: str
    joint: str
    law: str
    settings: dict
    error_bound: float
    relative_cost: float
    links: str
    quantity: str
    compliance_ratio: float
    frequency_ratio: float
    depth_star: float
    note: str
    evidence: tuple
    run: object = field(repr=False, compare=False)


def choose_model(
    scene,
    tolerance,
    duration=0.1,
    outputs=1000,
    quantity="slider_position",
    socket_ratio=SOCKET_RATIO,
):
    """Least model whose motion of the slider is known to be within a tolerance.

    Parameters
    ----------
    scene : study.mechanism.scene.Scene
    tolerance : float
        Largest NRMS error, > 0 and <= 1: RMS of the error over RMS of the change since t = 0.
    duration : float
        In s.
    outputs : int
        Number of equal intervals between the times of output.
    quantity : {"slider_position", "slider_velocity", "slider_acceleration"}
        What the tolerance is for.
    socket_ratio : float
        Outer over inner radius of the socket; its supports are the defaults of
        `study.joint.Joint`.

    Returns
    -------
    ModelChoice

    Raises
    ------
    ValueError
        For a value outside its range.
    ModelError
        If no model is known to be within the tolerance; says what is.
    study.checks.StudyError
        If the contact force is not known by any law within `LAW_TOLERANCE`.
    study.mechanism.MechanismError
        If a simulation cannot go on.
    """
    checks.instance("scene", scene, Scene)
    checks.number("tolerance", tolerance, above=0, most=1, scalar=True)
    checks.choice("quantity", quantity, links.QUANTITIES)
    run = partial(_Run, scene, duration, outputs)
    simple = run("rigid", "hertz", {"tolerance": FINEST_TOLERANCE})
    for values in (getattr(simple.response, name) for name in links.QUANTITIES):
        if not np.ptp(values) > 0:
            raise ValueError(f"duration must be so long that the slider moves, got {duration:g} s")
    impacts = simple.response.impacts
    depth = float(impacts.peak_depth.max()) if len(impacts) else 0.0
    law, law_share = _law(scene, depth, socket_ratio)
    best = run("rigid", law, {"tolerance": FINEST_TOLERANCE})
    of_law = law_share * _apart(simple, best, quantity)
    note = links.outside(scene, duration)
    of_links = inf if note else links.bounds(scene, simple.response, dataset.links())[quantity]

    rigid = [run("rigid", "hertz", {"joint": "ideal"})]
    for finest in (simple, best):
        allowed = STEP_SHARE * tolerance
        looser = (run("rigid", finest.law, {"tolerance": t}) for t in TOLERANCES)
        near = (r for r in looser if _apart(r, finest, quantity) <= allowed)
        rigid.append(next(near, finest))
    apart = [_apart(r, best, quantity) for r in rigid]
    found = [(r, a + of_law + of_links, "bounded") for r, a in zip(rigid, apart, strict=True)]
    spread = {}
    if all(error > tolerance for _, error, _ in found):
        coarse, fine = (run("particles", law, {"elements": n}) for n in ELEMENTS)
        half = run("particles", law, {"elements": ELEMENTS[-1], "share": 0.5})
        spread = {
            "the mesh": _apart(coarse, fine, quantity),
            "half the step": _apart(half, fine, quantity),
        }
        doubt = SAFETY * max(spread.values()) + of_law
        of_links = _apart(best, fine, quantity) + doubt
        found = [
            (r, min(error, a + of_links), "compared")
            for (r, error, _), a in zip(found, apart, strict=True)
        ]
        found += [(r, doubt, "compared") for r in (coarse, fine)]
    unit = rigid[1].cost
    evidence = tuple(
        r.tell() | {"error_bound": error, "relative_cost": r.cost / unit, "links": how}
        for r, error, how in found
    )
    good = [n for n, (_, error, _) in enumerate(found) if error <= tolerance]
    if not good:
        known = min(row["error_bound"] for row in evidence)
        cause = max(spread, key=spread.get)
        raise ModelError(
            f"no model's {quantity.replace('_', ' ')} is known to be within the tolerance "
            f"{tolerance:g}, the best within {known:.2g}: {cause} of flexible links changes it by "
            f"{spread[cause]:.2g} over {duration:g} s",
            known,
        )
    chosen = found[good[0]][0]
    stiffness = links.stiffness(scene, depth) if depth > 0 else None
    return ModelChoice(
        **evidence[good[0]],
        quantity=quantity,
        compliance_ratio=stiffness.compliance_ratio if stiffness else 0.0,
        frequency_ratio=stiffness.frequency_ratio if stiffness else 0.0,
        depth_star=depth / scene.clearance,
        note=note,
        evidence=evidence,
        run=chosen.again,
    )


def _apart(one, other, quantity):
    """NRMS difference of two runs' responses; inf where the other one does not move."""
    try:
        return difference(one.response, other.response, quantity)
    except checks.RangeError:
        return inf


def table_row(scene, tolerance, quantity):
    """What is chosen for a scene of 0.1 s, in words and numbers for a table.

    Parameters
    ----------
    scene, tolerance, quantity
        As for `choose_model`.

    Returns
    -------
    dict
        ``model``, ``joint``, ``law``, ``error_bound`` (2 digits), ``links``; ``none`` and the
        least bound of any model where none is known to be good enough.
    """
    names = ("model", "joint", "law", "error_bound", "links")
    try:
        choice = choose_model(scene, tolerance, quantity=quantity)
        found = {name: getattr(choice, name) for name in names}
    except ModelError as error:
        found = dict(zip(names, ("none", "none", "none", error.known, "compared"), strict=True))
    return found | {"error_bound": float(f"{found['error_bound']:.2g}")}


def _law(scene, depth, socket_ratio):
    """Law that stands for the exact one, with its options, and its error over Hertz's law's."""
    material = Material(scene.youngs_modulus, scene.poisson)
    r2_star = scene.socket_radius / scene.clearance
    checks.number("socket radius over clearance", r2_star, least=LEAST_R2_STAR)
    joint = Joint(r2_star, socket_ratio, material, material)
    choice = choose(joint, 1.0, LAW_TOLERANCE)
    if choice.evaluate is None:
        raise StudyError(
            f"no law for calls at every step is known to be within {LAW_TOLERANCE:g} of the "
            f"contact force of this joint, only the {choice.law} itself"
        )
    law = (choice.evaluate, {}) if choice.law == "tabulated" else (choice.law, choice.options)
    at = max(depth / scene.clearance, SHALLOWEST), joint.r2_star
    of_hertz = abs(hertz(*at) / choice.evaluate(*at) - 1)
    return law, choice.error_bound / of_hertz if of_hertz > 0 else 1.0


class _Run:
    """A model that was run: its response, its time, and how to run it again.

    ``law`` is a name, or a law or name with its options.
    """

    def __init__(self, scene, duration, outputs, model, law, settings):
        self.law, self._model, self._settings = law, model, dict(settings)
        name, options = law if isinstance(law, tuple) else (law, {})
        self._name = name if isinstance(name, str) else "tabulated"
        if model == "particles":
            packed = pack(
                name, scene.ball_radius, scene.socket_radius, scene.composite_modulus, **options
            )
            share = self._settings.pop("share", 1.0)
            self._settings["step"] = share * usual_step(scene, packed, settings["elements"])
        self._given = {"law": name} | options | self._settings
        self.again(scene, min(WARM_UP, duration), 1)
        start = perf_counter()
        self.response = self.again(scene, duration, outputs)
        self.cost = perf_counter() - start

    def again(self, scene, duration, outputs, progress=None):
        """Run the model: `study.mechanism.simulate`."""
        given = {"duration": duration, "outputs": outputs, "progress": progress}
        return simulate(scene, model=self._model, **given, **self._given)

    def tell(self):
        """Model, joint, law and settings."""
        settings = {k: v for k, v in self._settings.items() if k != "joint"}
        joint = self._settings.get("joint", "clearance")
        ideal = joint == "ideal"
        stepper = "DOP853" if ideal else STEPPERS[self._model]
        law = "none" if ideal else self._name
        return {
            "model": self._model,
            "joint": joint,
            "law": law,
            "settings": {"stepper": stepper} | settings,
        }
