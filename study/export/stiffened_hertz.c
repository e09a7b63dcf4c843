/* Contact force of a ball in a spherical socket: stiffened Hertz.
 * $source
 * $scope
 * Kinematics: $kinematics.
$formula
 *
 * depth              penetration depth, m; no force where it is negative; at most the clearance
 * ball_radius        R1, m
 * socket_radius      R2, m; R2/(R2 - R1) at least $least_r2_star
 * composite_modulus  E*, Pa; 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2
 * socket_ratio       outer over inner radius of the socket, $thin to $thick
 * poisson            Poisson's ratio of both bodies, $low to $high
 * force, stiffness   results, N and N/m
 *
 * Returns 0, or the number of an argument out of range (nothing is written then).
 */
#include <float.h>
#include <math.h>

int stiffened_hertz(double depth, double ball_radius, double socket_radius,
                    double composite_modulus, double socket_ratio, double poisson,
                    double *force, double *stiffness)
{
    static const double limit[5][9] = $limit;
    static const double first_order[5][9] = $first_order;
    const double most = 1 + $margin, least = 1 - $margin;
    double clearance, r2_star, ds, thickness[3], material[3], c[5];
    double s, u, factor, growth, scale;
    int i, j, k;

    if (!(ball_radius > 0)) return 2;
    clearance = socket_radius - ball_radius;
    r2_star = socket_radius / clearance;
    if (!(clearance > 0 && r2_star >= $double_r2_star * least)) return 3;
    if (!(composite_modulus > 0 && composite_modulus <= DBL_MAX)) return 4;
    if (!(socket_ratio >= $thin && socket_ratio <= $double_thick)) return 5;
    if (!(poisson >= $low && poisson <= $high)) return 6;
    ds = depth / clearance;
    if (!(ds <= $deepest * most)) return 1;
    if (ds <= 0) { *force = 0; *stiffness = 0; return 0; }

    thickness[0] = 1; thickness[1] = 1 / socket_ratio; thickness[2] = pow(socket_ratio, -4);
    material[0] = 1; material[1] = poisson; material[2] = 1 / (1 - $pole * poisson);
    for (i = 0; i < 5; i++) {
        c[i] = 0;
        for (j = 0; j < 3; j++)
            for (k = 0; k < 3; k++)
                c[i] += (limit[i][3*j + k] + first_order[i][3*j + k] / r2_star)
                        * thickness[j] * material[k];
    }
    s = sqrt(ds);
    u = s / (s + $reach * (socket_ratio - 1));
    factor = 1 + u * (c[0] + u * c[1]) + ds * (c[2] + ds * (c[3] + ds * c[4]));
    growth = u * (1 - u) * (c[0] / 2 + u * c[1]) + ds * (c[2] + ds * (2 * c[3] + ds * 3 * c[4]));
    scale = composite_modulus * clearance * 4 / 3 * sqrt(r2_star * (r2_star - 1));
    *force = scale * clearance * ds * s * factor;
    *stiffness = scale * s * (1.5 * factor + growth);
    return 0;
}
