"""The numbers of the report's pages that compute: the dataset's plot, and a joint of one's own."""

from typing import Any

from study import checks, dataset
from study.contact import COMPARED_LAWS, LAWS, materials, stiffening
from study.contact.laws import LIMIT_MARGIN, StiffenedHertz
from study.contact.power_fit import USUAL_RANGE
from study.dataset import design
from study.joint.compliance import THICKEST_RATIO, THINNEST_RATIO
from study.joint.joint import LARGEST_R2_STAR
from study.joint.solution import quantities
from study.joint.supports import RIMS
from study.pages import catalogue
from study.pages.figures import LOOKS

PARAMETERS = {
    "group": "Set of cases",
    "kinematics": "Kinematics",
    "support": "Supports of ball and socket",
    "modulus_ratio": "Modulus ratio, socket/ball",
    "socket_ratio": "Socket ratio, outer/inner",
    "layers": "Layers: outer ratio, modulus, Poisson's ratio",
    "poisson": "Poisson's ratio",
    "r2_star": "Socket radius R2* = R2/ΔR",
}
"""What a case is chosen by -> its name."""
COPIED = ("UNIT", "DIGITS", "LEAST_R2_STAR", "RANGES")


def curves() -> dict:
    """Cases, laws and their looks, as ``dataset.js`` takes them, with 5 digits.

    ``depths`` are lists of depths, of which a case names one by its number; ``undefined`` says
    why a law does not apply. The power law is fitted to the case's forces in its default range.
    """
    frames = dict(iter(dataset.load().sort_values("depth_star").groupby("case")))
    depths: dict[Any, int] = {}
    cases = []
    for group, name, joint, _ in design.every_case():
        frame = frames[name]
        depth = frame["depth_star"].to_numpy()
        last = frame.iloc[-1]
        case = {"name": name, "group": group, "solver": last["solver"]} | _parameters(joint)
        case["half_angle"] = _rounded(last["contact_half_angle_deg"])
        case["error"] = _rounded(100 * frame["error_estimate"].max())
        case["depths"] = depths.setdefault(tuple(map(_rounded, depth)), len(depths))
        case["force"] = [_rounded(force) for force in frame["force_star"]]
        case["laws"], case["undefined"] = {}, {}
        usual = frame[frame["depth_star"].between(*USUAL_RANGE)]
        fitted_to = usual["depth_star"], usual["force_star"]
        for law in COMPARED_LAWS:
            try:
                force = LAWS[law].fit(joint, *fitted_to)(depth, joint.r2_star)
                case["laws"][law] = [_rounded(value) for value in force]
            except ValueError as error:
                case["undefined"][law] = str(error)
        cases.append(case)
    looks = {name: vars(LOOKS[name]) for name in ("elastic_solution", *COMPARED_LAWS)}
    named = {"parameters": PARAMETERS, "groups": design.GROUPS, "looks": looks}
    return named | {"depths": list(depths), "cases": cases}


def _parameters(joint):
    bodies = joint.ball, joint.innermost
    return {
        "kinematics": joint.kinematics,
        "support": f"{joint.ball_support}, {joint.rim}",
        "modulus_ratio": f"{joint.modulus_ratio:g}",
        "socket_ratio": f"{joint.socket_ratio:g}",
        "layers": joint.columns()["layers"] or "none",
        "poisson": " / ".join(dict.fromkeys(f"{of.poisson:g}" for of in bodies)),
        "r2_star": f"{joint.r2_star:g}",
    }


def _rounded(value):
    return float(f"{value:.5g}")


def joint_data() -> dict:
    """Every number that ``joint.js`` computes with, as the library has it; the table as CSV."""
    (judged,) = (result for result in catalogue.results() if result.name == "judged")
    head, *rows = judged.rows()
    errors = sorted((float(row[head.index("largest_percent")]), row[0].split()[0]) for row in rows)
    return {
        "table": stiffening.TABLE.read_text(encoding="utf-8"),
        **{name.lower(): getattr(stiffening, name) for name in COPIED},
        "to_powers": stiffening._POWERS.tolist(),
        "quantities": {name: vars(of) for name, of in quantities(dimensions=True).items()},
        "deepest": StiffenedHertz.deepest,
        "margin": LIMIT_MARGIN,
        "least_clearance": 1 / LARGEST_R2_STAR,
        "walls": [THINNEST_RATIO - 1, THICKEST_RATIO - 1],
        "choices": {"ball_support": ("guided", "clamped"), "rim": RIMS},
        "softest": checks.SOFTEST,
        "materials": materials.table(),
        "judged": {group: largest for largest, group in errors},
    }
