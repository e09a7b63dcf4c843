"""Each law with the options that its tests try."""

PAPER = {"socket_ratio": 1.298, "modulus_ratio": 1.0, "poisson": 0.3, "socket_poisson": 0.3}
VARIANTS = [
    ("hertz", {}),
    ("steuermann", {}),
    ("steuermann", {"n": 3}),
    ("steuermann", {"n": 2, "radius": "profile"}),
    ("liu", {}),
    ("winkler", {}),
    ("winkler", {"coefficient": 3.0}),
    ("hyperbolic_winkler", {}),
    ("hyperbolic_winkler", {"coefficient": 3.0}),
    ("hyperbolic_winkler", {"area": "sphere"}),
    ("stiffened_hertz", PAPER),
    ("stiffened_hertz", PAPER | {"socket_ratio": 1.1, "poisson": 0.45, "socket_poisson": 0.45}),
    (
        "stiffened_hertz",
        PAPER | {"socket_ratio": 3.0, "modulus_ratio": 0.01, "ball_drive": "clamped"},
    ),
    ("stiffened_hertz", PAPER | {"socket_poisson": 0.46, "modulus_ratio": 30.0, "rim": "free"}),
]
