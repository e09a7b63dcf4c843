"""One call for every model of the crank-slider: ``simulate(scene, model=...)``."""

from dataclasses import replace

from study import checks
from study.mechanism import auto, models
from study.mechanism.scene import Scene


def simulate(
    scene=None,
    *,
    model="rigid",
    joint=None,
    law=None,
    duration=0.1,
    outputs=1000,
    tolerance=None,
    step=None,
    elements=None,
    method=None,
    quantity=None,
    progress=None,
    **law_options,
):
    """Simulate the crank-slider from rest.

    Parameters
    ----------
    scene : Scene, optional
        By default the paper's.
    model : {"rigid", "particles", "beams", "auto"}
        Links; ``auto`` finds the least model that is accurate enough, with its joint, law,
        stepper and step (`study.mechanism.auto.choose_model`).
    joint : {"clearance", "ideal"}, optional
        Joint between coupler and slider, by default with clearance.
    law : str or callable, optional
        Contact law, a key of ``study.contact.LAWS``, by default ``hertz``, or a law itself:
        ``tabulated(curve)``.
    duration : float
        In s.
    outputs : int
        Number of equal intervals between the times of output.
    tolerance : float, optional
        Rigid links with clearance: largest local error of places and speeds, relative to the
        clearance, the depth of the impact and the speed that the drive gives; default 1e-8.
        ``auto``, which needs it: largest NRMS error of the slider's motion, see ``quantity``.
    step : float, optional
        Flexible links: largest time step, in s. Default for particles: half their limit of
        stability; for beams 1e-6 s.
    elements : tuple of int, optional
        Flexible links: number of elements of crank and coupler; default (4, 8).
    method : {"centred", "lagged", "unguarded"}, optional
        Particles: velocity in damping and friction at the joint, centred (default) or half a
        step old; ``unguarded`` is the latter without the checks of the limits of stability.
    quantity : {"slider_position", "slider_velocity", "slider_acceleration"}, optional
        ``auto``: what the tolerance is for; default position.
    progress : callable, optional
        Called with the simulated time, in s, after each of 100 parts.
    **law_options
        Of the law; ``auto``: ``socket_ratio`` of the joint, default 1.298.

    Returns
    -------
    study.mechanism.response.Response
        What was computed so far, and ``complete=False``, if interrupted by Ctrl-C. For
        ``auto``, ``choice`` tells what was chosen and why.

    Raises
    ------
    ValueError
        For an unknown name, a value out of range, or an option that the model does not have.
    study.mechanism.response.MechanismError
        If the simulation cannot go on; says when, with which step, and what limit was passed.
    """
    scene = Scene() if scene is None else checks.instance("scene", scene, Scene)
    checks.choice("model", model, (*models.MODELS, "auto"))
    given = {"joint": joint, "law": law, "step": step, "elements": elements, "method": method}
    given = {name: value for name, value in given.items() if value is not None}
    common = {"duration": duration, "outputs": outputs}
    if model != "auto":
        if quantity is not None:
            raise ValueError(f"quantity must be left out: model {model} has none")
        common |= {"tolerance": tolerance, "progress": progress}
        return models.run(scene, model, **given, **common, **law_options)
    for name in given:
        raise ValueError(f"{name} must be left out: model auto chooses it")
    if tolerance is None:
        raise ValueError("tolerance must be given: the largest error that model auto may make")
    for option in law_options:
        checks.choice("option of model auto", option, ("socket_ratio",))
    if quantity is not None:
        common |= {"quantity": quantity}
    choice = auto.choose_model(scene, tolerance, **common, **law_options)
    return replace(choice.run(scene, duration, outputs, progress), choice=choice)
