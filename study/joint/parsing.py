"""A joint from texts: the options of a command, or the cells of a table."""

from typing import Any

from study import checks
from study.contact import Material
from study.joint.joint import Joint, Layer


def joint(
    r2_star: float = 200.0,
    *,
    modulus_ratio: float | None = None,
    socket_poisson: float | None = None,
    layer: list[str] | None = None,
    yield_stress: float | None = None,
    **others: Any,
) -> Joint:
    """Joint whose materials are relative to the ball's, of Young's modulus 2e11 Pa.

    Parameters
    ----------
    modulus_ratio
        Young's modulus of the socket over that of the ball, > 0 [default: 1.0].
    socket_poisson
        Poisson's ratio of the socket; default that of the ball.
    layer
        Outer radius over R2, Young's modulus over the ball's and Poisson's ratio of a layer of the
        socket: N,N,N; may be repeated, from the inside out. It replaces the options of a socket of
        one material.
    yield_stress
        Yield stress of ball and socket in Pa, where the ball's modulus is 2e11 Pa.
    **others
        ``poisson`` of the ball, and attributes of `Joint`.

    Raises
    ------
    ValueError
        For a value outside its range, a text that is not three numbers, or both forms of socket.
    """
    poisson = others.pop("poisson", Material.poisson)
    ball = Material(poisson=poisson, yield_stress=yield_stress)
    unit = ball.youngs_modulus
    if layer:
        of_one_material = {
            "modulus_ratio": modulus_ratio,
            "socket_poisson": socket_poisson,
            "socket_ratio": others.get("socket_ratio"),
            "yield_stress": yield_stress,
        }
        for name, value in of_one_material.items():
            if value is not None:
                raise ValueError(f"{name} must be left out: layer describes the socket")
        others["layers"] = tuple(_layer(text, unit) for text in layer)
    else:
        of_socket = ball.poisson if socket_poisson is None else socket_poisson
        ratio = 1.0 if modulus_ratio is None else modulus_ratio
        modulus = unit * checks.number("modulus_ratio", ratio, above=0)
        others["socket"] = Material(modulus, of_socket, yield_stress)
    return Joint(r2_star, ball=ball, **others)


def _layer(text, unit):
    """Layer of a text, ``1.125,0.0025,0.46``, with its modulus in a unit."""
    ratio, modulus, poisson = checks.read_several("layer", text, 3)
    modulus = unit * checks.number("modulus of layer", modulus, above=0)
    return Layer(ratio, Material(modulus, poisson))


def liner(text: str) -> tuple[float, str]:
    """Thickness in m and material of a liner's text, ``0.5e-3,PTFE``, or raise ``ValueError``."""
    thickness, _, material = text.partition(",")
    try:
        return checks.read("thickness of liner", thickness), material.strip()
    except ValueError:
        wanted = "liner must be a thickness in m and a material, such as 0.5e-3,PTFE"
        raise ValueError(f"{wanted}, got {text!r}") from None
