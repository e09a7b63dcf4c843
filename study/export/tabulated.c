/* Contact force of one spherical clearance joint, from its force-depth curve.
 * $source
$described
 *
 * depth              penetration depth, m; no force where it is negative; at most the clearance
 * clearance          R2 - R1, m
 * composite_modulus  E*, Pa; 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2
 * force, stiffness   results, N and N/m
 *
 * Returns 0, or the number of an argument out of range (nothing is written then).
 */
#include <float.h>
#include <math.h>

int tabulated(double depth, double clearance, double composite_modulus,
              double *force, double *stiffness)
{
    /* stiffening over Hertz and its slope, at equal steps of sqrt(depth/clearance) */
    static const double table[$knots][2] = $table;
    double ds, s, x, rise, m0, m1, c2, c3, factor, slope, scale;
    int k;

    if (!(clearance > 0 && clearance <= DBL_MAX)) return 2;
    if (!(composite_modulus > 0 && composite_modulus <= DBL_MAX)) return 3;
    ds = depth / clearance;
    if (!(ds <= 1 + $margin)) return 1;
    if (ds <= 0) { *force = 0; *stiffness = 0; return 0; }

    s = sqrt(ds);
    x = s * $steps;
    k = x < $last ? (int)x : $last;
    x -= k;
    rise = table[k + 1][0] - table[k][0];
    m0 = table[k][1] / $steps;
    m1 = table[k + 1][1] / $steps;
    c2 = 3 * rise - 2 * m0 - m1;
    c3 = m0 + m1 - 2 * rise;
    factor = table[k][0] + x * (m0 + x * (c2 + x * c3));
    slope = (m0 + x * (2 * c2 + x * 3 * c3)) * $steps;
    scale = composite_modulus * clearance * $scale;
    *force = scale * clearance * ds * s * factor;
    *stiffness = scale * (1.5 * s * factor + ds * slope / 2);
    return 0;
}
