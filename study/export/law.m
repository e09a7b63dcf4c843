function [force, stiffness] = $law(depth, clearance, composite_modulus)
% $title
% $source
$described
%
% depth              penetration depths, m, any shape; no force where they are negative
% clearance          dR = R2 - R1, m
% composite_modulus  E*, Pa; 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2
% force, stiffness   N and N/m, in the shape of depth
%
% An argument out of range is an error. For MATLAB and GNU Octave.

    if ~(isscalar(clearance) && clearance > 0 && isfinite(clearance))
        error('$law:clearance', 'clearance must be one number > 0 m');
    end
    if ~(isscalar(composite_modulus) && composite_modulus > 0 && isfinite(composite_modulus))
        error('$law:modulus', 'composite_modulus must be one number > 0 Pa');
    end
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
