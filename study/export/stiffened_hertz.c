/* Contact force of one spherical clearance joint: stiffened Hertz.
 * $source
$described
 *
 * P = E* dR^2 scale ds^(3/2) S, S = 1 + c1 u + ... + c9 u^9, u = s/(1 + s), s = sqrt(ds),
 * ds = depth/dR
 *
 * depth              penetration depth, m; no force where it is negative; at most the clearance
 * clearance          dR = R2 - R1, m
 * composite_modulus  E*, Pa; 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2
 * force, stiffness   results, N and N/m
 *
 * Returns 0, or the number of an argument out of range (nothing is written then).
 */
#include <float.h>
#include <math.h>

int stiffened_hertz(double depth, double clearance, double composite_modulus,
                    double *force, double *stiffness)
{
    /* from c9 to c1 */
    static const double c[9] = {$coefficients};
    double ds, s, u, rise = 0, steepness = 0, factor, scale;
    int k;

    if (!(clearance > 0 && clearance <= DBL_MAX)) return 2;
    if (!(composite_modulus > 0 && composite_modulus <= DBL_MAX)) return 3;
    ds = depth / clearance;
    if (!(ds <= $deepest * (1 + $margin))) return 1;
    if (ds <= 0) { *force = 0; *stiffness = 0; return 0; }

    s = sqrt(ds);
    u = s / (1 + s);
    for (k = 0; k < 9; k++) {
        steepness = steepness * u + rise;
        rise = rise * u + c[k];
    }
    factor = 1 + u * rise;
    steepness = (rise + u * steepness) * (1 - u) * (1 - u);
    scale = composite_modulus * clearance * $scale;
    *force = scale * clearance * ds * s * factor;
    *stiffness = scale * (1.5 * s * factor + ds * steepness / 2);
    return 0;
}
