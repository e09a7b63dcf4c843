"""Output of study joint for a joint with its dimensions: in readable units, and as JSON in SI."""

from dataclasses import replace

from study import checks
from study.contact import LAWS
from study.joint import DimensionalJoint, DimensionalSolution, Joint, Layer, Material
from study.joint.dimensional import usual_depth

MICRO, MEGA, PERCENT = 1e-6, 1e6, 0.01
DEEPER = (1, 4, 12)
"""Factors of the depth: laws are compared up to the least of these depths that elements resolve.
The range begins at a twelfth of its end at most, so that the depth itself is within it."""
LARGE = 1.0  # m: a socket's radius that is probably in mm
NO_LAW = {
    "tabulated": "tabulated, the table of this joint's own curve",
    "solver": "none: the joint has to be solved at every depth",
}


def described(
    joint: DimensionalJoint, solution: DimensionalSolution, tolerance: float
) -> tuple[dict, list]:
    """One JSON object of a solved joint, and its parts as text."""
    plain = joint.joint
    columns = ("depth", "force", "stiffness", "contact_half_angle_deg", "peak_pressure")
    values = {name: getattr(solution, name).tolist() for name in (*columns, "error_estimate")}
    for body, stress in solution.von_mises.items():
        name, factor = body.replace(" ", "_"), solution.yield_factor[body]
        values[f"von_mises_{name}"] = stress.tolist()
        values[f"von_mises_{name}_place"] = list(solution.von_mises_place[body])
        values[f"yield_factor_{name}"] = None if factor is None else factor.tolist()
    values |= {name: getattr(joint, name) for name in ("socket_radius", "clearance", "wall")}
    values["materials"] = {body: vars(material) for body, material in joint.materials.items()}
    without = ("r2_star", "socket_ratio", "modulus_ratio", "composite_modulus")
    values |= {name: getattr(plain, name) for name in without}
    values["depth_star"] = (solution.depth / joint.clearance).tolist()
    law, sentences = _law(joint, float(solution.depth.max()), tolerance)
    if joint.socket_radius >= LARGE:
        sentences.append(f"The socket's radius is {joint.socket_radius:g} m: are the sizes in m?")
    return values | law, [_contact(solution), _stresses(joint, solution), *sentences]


def _contact(solution):
    columns = {
        "depth um": solution.depth / MICRO,
        "force N": solution.force,
        "stiffness N/um": solution.stiffness * MICRO,
        "half_angle deg": solution.contact_half_angle_deg,
        "peak_pressure MPa": solution.peak_pressure / MEGA,
    }
    errors = [_digits(error / PERCENT, 2) for error in solution.error_estimate]
    table = {head: [_digits(value) for value in column] for head, column in columns.items()}
    return table | {"error %": errors}


def _stresses(joint, solution):
    rows = []
    for k, depth in enumerate(solution.depth):
        for body, stress in solution.von_mises.items():
            strength, factor = joint.materials[body].yield_stress, solution.yield_factor[body]
            row = {
                "depth um": _digits(depth / MICRO),
                "body": body,
                "von_mises MPa": _digits(stress[k] / MEGA),
                "place": solution.von_mises_place[body][k],
                "yield_stress MPa": None if strength is None else _digits(strength / MEGA),
                "factor_to_yield": None if factor is None else _digits(factor[k]),
            }
            rows.append(row)
    return {head: [row[head] for row in rows] for head in rows[0]}


def _digits(value, count=4):
    return float(f"{value:.{count}g}")


def _percent(error):
    return f"{error / PERCENT:.2g} %"


def _law(joint, largest, tolerance):
    """The cheapest law within the tolerance up to a depth, as JSON and in words."""
    plain = joint.joint
    try:
        choice = _choice(plain, largest / joint.clearance, tolerance)
    except (checks.StudyError, ValueError) as error:  # no checkout, or no law is known well enough
        none = {"law": None, "law_error_bound": None, "export": None}
        return none, [f"No law is chosen: {error}"]
    least, most = (_digits(joint.clearance * depth / MICRO) for depth in choice.depths)
    sentences = [
        f"The cheapest law that is within {_percent(tolerance)} from {least:g} to {most:g} um: "
        f"{NO_LAW.get(choice.law, choice.law)}. Its error is at most "
        f"{_percent(choice.error_bound)}."
    ]
    best = min(choice.errors, key=choice.errors.__getitem__)
    if choice.errors[best] > tolerance:
        sentences[0] += (
            f" No closed law is within it: {best} is the best, with an error up to "
            f"{_percent(choice.errors[best])}."
        )
    line = None
    if choice.law != "solver":
        line = f"study export --law {choice.law} --format c {_options(plain, choice.depths[1])}"
        sentences.append(
            f"To take it into another program, with the clearance {joint.clearance:g} m and the "
            f"composite modulus {plain.composite_modulus:.9g} Pa:\n{line}"
        )
    return {
        "law": choice.law,
        "law_error_bound": choice.error_bound,
        "law_depths": [joint.clearance * depth for depth in choice.depths],
        "law_errors": choice.errors,
        "export": line,
    }, sentences


def _choice(joint, depth_star, tolerance):
    """Choice for a joint up to a depth, or up to a deeper one that elements resolve."""
    from study.choose import choose
    from study.choose.law import errors

    is_small = max(DEEPER) * depth_star <= usual_depth(joint)
    for deeper in DEEPER if is_small else (1,):
        try:
            return choose(_without_yield(joint), deeper * depth_star, tolerance)
        except checks.RangeError:
            if not is_small:
                raise
    errors_of_laws = errors(joint, depth_star, LAWS["hertz"](depth_star, joint.r2_star))
    known = errors_of_laws.get("stiffened_hertz")  # which begins as Hertz's law
    hertz = "" if known is None else f": there Hertz's law holds within {_percent(known)}"
    raise checks.RangeError(f"the contact is too small for laws to be compared{hertz}")


def _without_yield(joint: Joint) -> Joint:
    """A joint of materials without a yield stress: its factors to yield are shown already."""

    def elastic(material):
        return Material(material.youngs_modulus, material.poisson)

    layers = tuple(Layer(layer.outer_ratio, elastic(layer.material)) for layer in joint.layers)
    ball, socket = elastic(joint.ball), elastic(joint.socket)
    return replace(joint, ball=ball, socket=socket, layers=layers)


def _options(joint: Joint, deepest: float) -> str:
    """Options of study export that describe a joint without its dimensions."""
    numbers = {"r2-star": joint.r2_star, "poisson": joint.ball.poisson}
    if not joint.layers:
        numbers |= {"socket-ratio": joint.socket_ratio, "modulus-ratio": joint.modulus_ratio}
        numbers |= {"socket-poisson": joint.socket.poisson}
    if deepest > usual_depth(joint):
        numbers["depth-star"] = deepest
    supports = {"drive": "ball_drive", "rim": "rim", "kinematics": "kinematics"}
    usual = Joint(joint.r2_star)
    options = [(name, f"{value:.9g}") for name, value in numbers.items()]
    options += [
        (name, getattr(joint, attribute))
        for name, attribute in supports.items()
        if getattr(joint, attribute) != getattr(usual, attribute)
    ]
    layers = filter(None, joint.layers_text.split(";"))
    options += [("layer", layer.replace(":", ",")) for layer in layers]
    return " ".join(f"--{name} {text}" for name, text in options)
