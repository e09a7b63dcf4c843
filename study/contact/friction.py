"""Ambrosio's regularised Coulomb friction (Eqs. 32-33): no force below v0, full above v1.

The tangential force is -mu F_N times the factor computed here, which carries the sign of the
sliding speed. Between its four kinks, at -v1, -v0, v0 and v1, the factor is linear.
"""

from study.compiled import compiled


@compiled
def friction_regime(speed, v0, v1):
    """Number of the linear piece that a sliding speed lies in: -2, -1, 0, 1 or 2."""
    size = abs(speed)
    piece = 0 if size < v0 else (1 if size < v1 else 2)
    return piece if speed > 0 else -piece


@compiled
def friction_factor(speed, regime, v0, v1):
    """Signed factor c_d sign(v_T) of one linear piece, and its derivative by the speed."""
    if regime == 0:
        return 0.0, 0.0
    sign = 1.0 if regime > 0 else -1.0
    if abs(regime) == 2:
        return sign, 0.0
    return (speed - sign * v0) / (v1 - v0), 1 / (v1 - v0)
