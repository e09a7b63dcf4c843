"""What a call of each law costs, in a compiled loop, relative to a call of Hertz's law."""

import json
from pathlib import Path

RELATIVE_COSTS = Path(__file__).with_name("relative_costs.json")


def relative_costs() -> dict[str, float]:
    """Law -> time of a call over that of Hertz's law, as `study measure` last timed it.

    ``tabulated`` and ``solver`` are included. A law that has not been timed is missing, and
    `study.choose.choose` does not choose it.
    """
    return json.loads(RELATIVE_COSTS.read_text(encoding="utf-8"))
