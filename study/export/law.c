/* $title
 * $source
$described
 *
 * depth              penetration depth, m; no force where it is negative
 * clearance          dR = R2 - R1, m
 * composite_modulus  E*, Pa; 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2
 * force, stiffness   results, N and N/m
 *
 * Returns 0, or the number of an argument out of range (nothing is written then).
 */
#include <float.h>
#include <math.h>
$tables
int $law(double depth, double clearance, double composite_modulus,
    double *force, double *stiffness)
{
    double ds, scale, $names;

    if (!(clearance > 0 && clearance <= DBL_MAX)) return 2;
    if (!(composite_modulus > 0 && composite_modulus <= DBL_MAX)) return 3;
    ds = depth / clearance;
    if (!(ds <= $deepest * (1 + $margin))) return 1;
    if (ds <= 0) { *force = 0; *stiffness = 0; return 0; }

$body
    scale = composite_modulus * clearance * $scale;
    *force = scale * clearance * value;
    *stiffness = scale * slope;
    return 0;
}
