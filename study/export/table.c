/* $title
 * $source
$described
 *
 * depth              penetration depth in $unit_of_depth; no force where it is negative
 * force, stiffness   results in $unit_of_force and $unit_of_stiffness
 * returned value     1 if the depth is beyond the range, else 0
 */
#include <math.h>

/* force/depth^1.5 and its derivative, at equal steps of sqrt(depth) */
static const double ${name}_table[$count][2] = {
$rows
};

int $name(double depth, double *force, double *stiffness)
{
    const double steps = $steps, deepest = $deepest;
    double inside, s, x, factor, slope, rise, c2, c3;
    const double *row;
    int k;

    *force = *stiffness = 0;
    if (depth <= 0) return 0;
    inside = depth < deepest ? depth : deepest;
    s = sqrt(inside);
    k = steps * s < $last ? (int)(steps * s) : $last;
    x = steps * s - k;
    row = ${name}_table[k];
    rise = steps * (row[2] - row[0]);
    c2 = 3 * rise - 2 * row[1] - row[3];
    c3 = row[1] + row[3] - 2 * rise;
    factor = row[0] + x / steps * (row[1] + x * (c2 + x * c3));
    slope = row[1] + x * (2 * c2 + x * 3 * c3);
    *stiffness = 1.5 * s * factor + inside * slope / 2;
    *force = inside * s * factor + *stiffness * (depth - inside);
    return depth > deepest;
}
