/* $title
 * $source
$described
 *
 * depth              penetration depth, m; no force where it is negative
 * tilt               direction of the displacement off the axis, deg
$about_inputs * along, across      results, N: along the displacement, and across it towards larger tilt
 *
 * Returns 0, or the number of an argument out of range (nothing is written then).
 */
#include <float.h>
#include <math.h>

/* forces over Hertz's, at equal steps of sqrt(ds) and of tilt, and one step before and behind */
static const double along_table[$rows][$columns] = {
$along
};
static const double across_table[$rows][$columns] = {
$across
};

static void weigh(double x, double weight[4])
{
    weight[0] = x * (x * (2 - x) - 1) / 2;
    weight[1] = (x * x * (3 * x - 5) + 2) / 2;
    weight[2] = x * (x * (4 - 3 * x) + 1) / 2;
    weight[3] = x * x * (x - 1) / 2;
}

int $law(double depth, double tilt, $inputs
    double *along, double *across)
{
    double ds, x, y, scale, by_row[4], by_column[4];
    int row, column, a, b;$sizes
$checks
    ds = depth / clearance;
    if (!(ds <= $deepest * (1 + $margin))) return 1;
    if (!(fabs(tilt) <= $largest * (1 + $margin))) return 2;
    *along = *across = 0;
    if (ds <= 0) return 0;

    x = sqrt(ds) * $row_steps;
    y = fabs(tilt) * $column_steps;
    row = x < $rows - 4 ? (int)x : $rows - 4;
    column = y < $columns - 4 ? (int)y : $columns - 4;
    weigh(x - row, by_row);
    weigh(y - column, by_column);
    scale = composite_modulus * clearance * clearance * $scale * ds * sqrt(ds);
    for (a = 0; a < 4; a++)
        for (b = 0; b < 4; b++) {
            x = scale * by_row[a] * by_column[b];
            *along += x * along_table[row + a][column + b];
            *across += (tilt < 0 ? -x : x) * across_table[row + a][column + b];
        }
    return 0;
}
