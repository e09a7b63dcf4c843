"""A joint from named values: options of a command, a row of a table, or a saved file.

The names are those of the arguments of `Joint`, or of `Joint.from_ratios` for a joint without
dimensions, and what catalogues print instead of some of them (`FROM_CATALOGUE`).
"""

import json
import tomllib
from collections.abc import Mapping
from math import acos, degrees
from pathlib import Path
from typing import Any

from study import checks, paths
from study.joint.joint import SUPPORTS, Joint
from study.parameters import Parameter, described

SIZES = ("socket_radius", "clearance", "wall")
"""What every joint with dimensions needs."""
FROM_CATALOGUE = {
    "play": Parameter(
        "Total play of the ball in the socket, instead of the clearance, which is half of it; "
        "bearing catalogues call this play radial clearance",
        "m",
        {"above": 0},
    ),
    "ring_width": Parameter(
        "Width of a ring-shaped socket that is open on both sides, instead of the angles of its "
        "opening: 55:125 is a ring whose width is 1.147 times the radius of the socket",
        "m",
        {"above": 0},
    ),
}
"""What catalogues print, and can be given instead of clearance and opening."""
_INSTEAD_OF = {"play": "clearance", "ring_width": "opening"}
_OF_SUPPORTS = {name: described(Joint)[name] for name in SUPPORTS}
DIMENSIONS: dict[str, Parameter] = {
    **{name: of for name, of in described(Joint).items() if name not in SUPPORTS},
    **FROM_CATALOGUE,
}
"""Parameters that only a joint with dimensions has."""
RATIOS: dict[str, Parameter] = {
    "layer" if name == "layers" else name: of for name, of in described(Joint.from_ratios).items()
}
"""Parameters that only a joint without dimensions has. A layer may be given several times."""
PARAMETERS: dict[str, Parameter] = DIMENSIONS | RATIOS | _OF_SUPPORTS
"""Every parameter of a joint."""


def joint_of(values: Mapping[str, Any], *, off_axis: bool = False) -> Joint:
    """Joint of named values, with dimensions or by ratios.

    Parameters
    ----------
    values
        Values of `PARAMETERS` by name, as objects, numbers or texts such as ``12.5mm``.
    off_axis
        Whether the load is off the axis, for which the rim of the socket is free by default.

    Raises
    ------
    ValueError
        If a value is missing, outside its range, or does not apply to this form of a joint.

    Examples
    --------
    >>> joint = joint_of({"socket_radius": "12.5mm", "play": "80um", "wall": "6mm"})
    >>> joint.clearance
    4e-05
    """
    values = {name: _value(name, value) for name, value in values.items()}
    if off_axis:
        values = {"rim": "free"} | values
    sized = [name for name in values if name in DIMENSIONS]
    by_ratios = [name for name in values if name in RATIOS]
    if sized and by_ratios:
        raise ValueError(
            f"{by_ratios[0]} and {sized[0]} must not both be given, because one is for a joint "
            "without dimensions and the other for a joint with dimensions; remove one of them"
        )
    if by_ratios:
        if "r2_star" not in values:
            raise ValueError("r2_star must be given for a joint without dimensions")
        layers = {"layers": values.pop("layer")} if "layer" in values else {}
        return Joint.from_ratios(**values, **layers)
    for name, other in _INSTEAD_OF.items():
        if name in values and other in values:
            raise ValueError(f"{name} and {other} must not both be given; remove one of them")
    if "play" in values:
        values["clearance"] = values.pop("play") / 2
    missing = [name for name in SIZES if name not in values]
    if missing:
        raise ValueError(
            f"{', '.join(missing)} must be given for a joint with dimensions; a joint without "
            "dimensions is described by r2_star instead"
        )
    if "ring_width" in values:
        width, radius = values.pop("ring_width"), values["socket_radius"]
        checks.number("ring_width", width, "m", below=2 * radius)
        first = degrees(acos(width / 2 / radius))  # the rims are half the width from the centre
        values["opening"] = f"{first:.9g}:{180 - first:.9g}"
    return Joint(**values)


def _value(name, value):
    """A number of a text; other texts are read by the joint itself."""
    about = PARAMETERS[checks.choice("parameter of a joint", name, PARAMETERS)]
    if about.typed is float:
        value = about.read(name, value) if isinstance(value, str) else value
        return about.taken(name, value) if name in FROM_CATALOGUE else value
    return value


def values_of(joint: Joint) -> dict[str, Any]:
    """Values from which `joint_of` makes a joint: texts, and numbers of 9 digits."""
    values = joint.arguments()
    if values.get("rim") == "mirror":  # the default of the joints that can have it
        del values["rim"]
    if "layers" in values:
        values["layer"] = values.pop("layers")
    return ({} if joint.has_dimensions else {"r2_star": joint.r2_star}) | values


def save(joint: Joint, path: Path) -> None:
    """Write a joint to a TOML file that `load` reads."""
    values = values_of(joint)
    lines = [f"# {joint}", *(f"{name} = {json.dumps(of)}" for name, of in values.items())]
    with paths.whole(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")


def load(path: Path) -> dict[str, Any]:
    """Values of a saved joint by name, for `joint_of`.

    Raises ``ValueError`` if the file cannot be read, or has other names than `PARAMETERS`.
    """
    try:
        values = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or f"it is not a TOML file ({error})"
        wanted = "joint must be a file that study joint --save wrote"
        raise ValueError(f"{wanted}, got {path}: {why}") from None
    for name, value in values.items():
        if name not in PARAMETERS or not isinstance(value, str | int | float):
            raise ValueError(
                f"joint must be a file of parameters of a joint, but {path} has the line {name} = "
                f"{checks.shown(value)}"
            )
    return values


def merged(saved: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """Values of a saved joint, of which the given ones replace those with the same meaning."""
    replaced = {*given, *(_INSTEAD_OF[name] for name in given if name in _INSTEAD_OF)}
    replaced |= {name for name, other in _INSTEAD_OF.items() if other in given}
    return {name: of for name, of in saved.items() if name not in replaced} | dict(given)
