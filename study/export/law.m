function [force, stiffness] = $law(depth$inputs)
% $title
% $source
$described
%
% depth              penetration depths, m, any shape; no force where they are negative
$about_inputs% force, stiffness   N and N/m, in the shape of depth
%
% An argument out of range is an error. For MATLAB and GNU Octave.
$sizes$checks
    ds = depth / clearance;
    if ~all(ds(:) <= $deepest * (1 + $margin))
        error('$law:depth', 'depth must be <= %g m', $deepest * clearance);
    end
    force = zeros(size(depth));
    stiffness = force;
    touching = ds > 0;
    ds = reshape(ds(touching), [], 1);
$tables
$body
    scale = composite_modulus * clearance * $scale;
    force(touching) = scale * clearance * value;
    stiffness(touching) = scale * slope;
end
