/* $title
 * $source
$described
 *
 * depth              penetration depth, m; no force where it is negative
$about_inputs * force, stiffness   results, N and N/m
 *
 * Returns 0, or the number of an argument out of range (nothing is written then).
 */
#include <float.h>
#include <math.h>
$tables
int $law(double depth, $inputs
    double *force, double *stiffness)
{
    double ds, scale, $names;$sizes
$checks
    ds = depth / clearance;
    if (!(ds <= $deepest * (1 + $margin))) return 1;
    if (ds <= 0) { *force = 0; *stiffness = 0; return 0; }

$body
    scale = composite_modulus * clearance * $scale;
    *force = scale * clearance * value;
    *stiffness = scale * slope;
    return 0;
}
