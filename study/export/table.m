function [force, stiffness] = $name(depth)
% $title
% $source
$described
%
% depth              penetration depths in $unit_of_depth, any shape; no force where they are negative
% force, stiffness   in $unit_of_force and $unit_of_stiffness, in the shape of depth
%
% For MATLAB and GNU Octave.
    steps = $steps;
    deepest = $deepest;
    % force/depth^1.5 and its derivative, at equal steps of sqrt(depth)
    table = [
$rows
    ];
    touching = ~(depth <= 0);
    d = reshape(depth(touching), [], 1);
    if any(d > deepest)
        warning('study:beyond', '$beyond.');
    end
    inside = min(d, deepest);
    s = sqrt(inside);
    k = min(floor(steps * s), $last);
    x = steps * s - k;
    left = table(k + 1, 1);
    slope0 = table(k + 1, 2);
    slope1 = table(k + 2, 2);
    rise = steps * (table(k + 2, 1) - left);
    c2 = 3 * rise - 2 * slope0 - slope1;
    c3 = slope0 + slope1 - 2 * rise;
    factor = left + x / steps .* (slope0 + x .* (c2 + x .* c3));
    slope = slope0 + x .* (2 * c2 + x .* (3 * c3));
    force = zeros(size(depth));
    stiffness = force;
    stiffness(touching) = 1.5 * s .* factor + inside .* slope / 2;
    force(touching) = inside .* s .* factor + reshape(stiffness(touching), [], 1) .* (d - inside);
end
