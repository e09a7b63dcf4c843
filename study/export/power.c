/* $title
 * $source
$described
 *
 * depth              penetration depth in $unit_of_depth; no force where it is negative
 * force, stiffness   results in $unit_of_force and $unit_of_stiffness: k depth^n with k = $coefficient, n = $exponent
 * returned value     1 if the depth is beyond the range, else 0
 */
#include <math.h>

int $name(double depth, double *force, double *stiffness)
{
    *force = *stiffness = 0;
    if (depth <= 0) return 0;
    *force = $coefficient * pow(depth, $exponent);
    *stiffness = $exponent * *force / depth;
    return depth > $deepest;
}
