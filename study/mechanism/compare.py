"""Comparing responses: how far they agree, which is ahead, and how models approach each other."""

import numpy as np
import pandas as pd

from study import checks
from study.mechanism.response import COLUMNS, Response
from study.mechanism.scene import Scene
from study.mechanism.simulate import simulate


def difference(response, truth, column):
    """Relative RMS difference of one quantity of two responses at the same times.

    Parameters
    ----------
    response, truth : Response
    column : str
        Quantity, a column of the motion.

    Returns
    -------
    float
        RMS of the difference over the RMS of what ``truth`` has changed since the start.

    Raises
    ------
    ValueError
        If the times differ.
    """
    _same_times(response=response, truth=truth)
    checks.choice("column", column, tuple(COLUMNS))
    one, other = getattr(response, column), getattr(truth, column)
    if not np.ptp(other) > 0:
        raise checks.RangeError(f"{column} of truth must change, got only {other[0]:g}")
    return float(np.sqrt(np.mean((one - other) ** 2) / np.mean((other - other[0]) ** 2)))


def _same_times(**responses):
    for name, response in responses.items():
        checks.instance(name, response, Response)
    first, second = responses.values()
    if not np.array_equal(first.time, second.time):
        raise ValueError(f"{' and '.join(responses)} must have the same times, got others")


def lead(response, ideal):
    """How far the crank is ahead of the ideal mechanism's, as time, at each output.

    Parameters
    ----------
    response, ideal : Response
        At the same times.

    Returns
    -------
    ndarray
        In s, negative where it is behind; 0 where the ideal one rests.
    """
    _same_times(response=response, ideal=ideal)
    ahead = response.crank_angle - ideal.crank_angle
    return np.divide(
        ahead, ideal.crank_speed, out=np.zeros_like(ahead), where=ideal.crank_speed != 0
    )


def ahead(response, ideal):
    """Where the slider is ahead of the ideal mechanism's, in the direction that one moves in.

    Parameters
    ----------
    response, ideal : Response
        At the same times.

    Returns
    -------
    ndarray of bool
    """
    _same_times(response=response, ideal=ideal)
    return (response.slider_position - ideal.slider_position) * ideal.slider_velocity > 0


def last_separation(response):
    """Time at which the surfaces part for the last time, in s; 0 if they never do."""
    checks.instance("response", response, Response)
    ends = (response.impacts.time + response.impacts.duration)[
        response.impacts.separation_speed.notna()
    ]
    return float(ends.max()) if len(ends) else 0.0


def summary(response, ideal):
    """What tells whether impacts keep going, in one row.

    Parameters
    ----------
    response, ideal : Response
        With clearance, and of the same scene with an ideal joint, at the same times.

    Returns
    -------
    dict
        Number of contacts, last separation (s), lead of the crank at the end (s), largest
        force of the contacts that ended, of all contacts, lowest normal force at the outputs
        (N), and the energy error.
    """
    _same_times(response=response, ideal=ideal)
    return {
        "contacts": len(response.impacts),
        "last_separation": last_separation(response),
        "lead_at_end": float(lead(response, ideal)[-1]),
        "peak_force": float(response.impacts.dropna().peak_force.max()),
        "largest_force": float(response.impacts.peak_force.max()),
        "lowest_force": float(response.normal_force.min()),
        "energy_error": response.energy_error,
    }


def refinement(scene, crank_elements, **options):
    """Largest difference of the slider's place between particles and finite elements.

    Relative to the way that the slider of the finest finite elements goes.

    Parameters
    ----------
    scene : Scene
    crank_elements : sequence of int
        Of the crank; the coupler has twice as many.
    **options
        Of `study.mechanism.simulate`; ``step`` is that of the finite elements.

    Returns
    -------
    pandas.DataFrame
        Columns elements, difference.
    """
    checks.instance("scene", scene, Scene)
    crank_elements = [checks.whole("crank_elements", n, least=1) for n in crank_elements]
    step, rows = options.pop("step"), []
    for n in crank_elements:
        pair = {"elements": (n, 2 * n), "joint": "ideal"}
        particles = simulate(scene, model="particles", **pair, **options)
        beams = simulate(scene, model="beams", step=step, **pair, **options)
        apart = np.abs(particles.slider_position - beams.slider_position).max()
        rows.append((n, float(apart)))
    table = pd.DataFrame(rows, columns=["elements", "difference"])
    table["difference"] /= _way(beams)
    return table


def stiffening(scene, factors, **options):
    """How the flexible models come to rigid links when the links' modulus grows.

    Parameters
    ----------
    scene : Scene
    factors : sequence of float
        On the links' Young's modulus.
    **options
        Of `study.mechanism.simulate`, for an ideal joint; ``step`` is that of the finite
        elements, and the particles' first impact is followed for twice the duration.

    Returns
    -------
    pandas.DataFrame
        Columns factor; particles, beams (largest differences of the slider's place, relative
        to its way); approach_speed, peak_force (of the particles' first impact, relative).
    """
    checks.instance("scene", scene, Scene)
    factors = np.atleast_1d(checks.number("factors", factors, above=0))
    step, elements, rows = options.pop("step"), {"elements": (2, 4)}, []
    rigid = simulate(scene, model="rigid", joint="ideal", **options)
    longer = options | {"duration": 2 * options["duration"]}
    truth = simulate(scene, model="rigid", **longer).impacts.iloc[0]
    for factor in factors:
        stiff = scene.but(link_modulus=factor * scene.youngs_modulus)
        apart = []
        for model, own in (("particles", {}), ("beams", {"step": step})):
            response = simulate(stiff, model=model, joint="ideal", **elements, **own, **options)
            largest = np.abs(response.slider_position - rigid.slider_position).max()
            apart.append(largest / _way(rigid))
        first = simulate(stiff, model="particles", **elements, **longer).impacts.iloc[0]
        changes = [abs(first[c] / truth[c] - 1) for c in ("approach_speed", "peak_force")]
        rows.append((factor, *apart, *changes))
    columns = ["factor", "particles", "beams", "approach_speed", "peak_force"]
    return pd.DataFrame(rows, columns=columns)


def _way(response):
    return np.abs(response.slider_position - response.slider_position[0]).max()


def order(x, y):
    """Slope of ``y`` over ``x``, all > 0, in logarithms, by least squares."""
    for name, values in {"x": x, "y": y}.items():
        checks.number(name, values, above=0)
    x, y = checks.same_length(2, x=x, y=y)
    if not np.ptp(np.log(x)) > 0:
        raise ValueError(f"x must vary for a slope, got only {x[0]:g}")
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])
