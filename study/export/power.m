function [force, stiffness] = $name(depth)
% $title
% $source
$described
%
% depth              penetration depths in $unit_of_depth, any shape; no force where they are negative
% force, stiffness   in $unit_of_force and $unit_of_stiffness, in the shape of depth: k depth^n with
%                    k = $coefficient, n = $exponent
%
% For MATLAB and GNU Octave.
    touching = ~(depth <= 0);
    force = zeros(size(depth));
    stiffness = force;
    force(touching) = $coefficient * depth(touching) .^ $exponent;
    stiffness(touching) = $exponent * force(touching) ./ depth(touching);
end
