"""The numbers of the page of a joint of one's own: tables, ranges, materials, the law's errors."""

from pathlib import Path

from study import checks
from study.contact import materials, shapes, stiffening
from study.contact.laws import LIMIT_MARGIN, stiffened_hertz
from study.joint.compliance import THICKEST_RATIO, THINNEST_RATIO
from study.joint.dimensional import LEAST_CLEARANCE
from study.pages import catalogue

COPIED = ("UNIT", "DIGITS", "LEAST_R2_STAR", "RANGES")
SIZES = Path(__file__).with_name("contact_size.csv")
LEAST_STRESS = 0.8  # a body's largest von Mises stress, at least, over that of a confined layer


def joint_data() -> dict:
    """Every number that ``joint.js`` computes with, as the library has it; tables as CSV."""
    (judged,) = (result for result in catalogue.results() if result.name == "judged")
    head, *rows = judged.rows()
    errors = sorted((float(row[head.index("largest_percent")]), row[0].split()[0]) for row in rows)
    return {
        "tables": [path.read_text(encoding="utf-8") for path in (stiffening.TABLE, SIZES)],
        **{name.lower(): getattr(stiffening, name) for name in COPIED},
        "to_powers": stiffening._POWERS.tolist(),
        "deepest": shapes.stiffened.deepest,
        "margin": LIMIT_MARGIN,
        "least_clearance": LEAST_CLEARANCE,
        "walls": [THINNEST_RATIO - 1, THICKEST_RATIO - 1],
        "choices": {name: of.choices for name, of in stiffened_hertz.options.items() if of.choices},
        "softest": checks.SOFTEST,
        "least_stress": LEAST_STRESS,
        "materials": materials.table(),
        "judged": {group: largest for largest, group in errors},
    }
