function [along, across] = $law(depth, tilt$inputs)
% $title
% $source
$described
%
% depth              penetration depths, m, any shape; no force where they are negative
% tilt               directions of the displacement off the axis, deg, one or as many
$about_inputs% along, across      N, along the displacement, and across it towards larger tilt
%
% An argument out of range is an error. For MATLAB and GNU Octave.
$sizes$checks
    if isscalar(tilt)
        tilt = repmat(tilt, size(depth));
    end
    ds = depth / clearance;
    if ~all(ds(:) <= $deepest * (1 + $margin))
        error('$law:depth', 'depth must be <= %g m', $deepest * clearance);
    end
    if ~isequal(size(tilt), size(depth)) || ~all(abs(tilt(:)) <= $largest * (1 + $margin))
        error('$law:tilt', 'tilt must be one or as many, and <= %g deg in size', $largest);
    end
    % forces over Hertz's, at equal steps of sqrt(ds) and of tilt, and one step before and behind
    along_table = [
$along
    ];
    across_table = [
$across
    ];
    touching = ds > 0;
    ds = reshape(ds(touching), [], 1);
    tilt = reshape(tilt(touching), [], 1);
    x = sqrt(ds) * $row_steps;
    y = abs(tilt) * $column_steps;
    row = min(floor(x), $rows - 4);
    column = min(floor(y), $columns - 4);
    weigh = @(x) [x .* (x .* (2 - x) - 1), x .* x .* (3 * x - 5) + 2, ...
        x .* (x .* (4 - 3 * x) + 1), x .* x .* (x - 1)] / 2;
    by_row = weigh(x - row);
    by_column = weigh(y - column);
    scale = composite_modulus * clearance * clearance * $scale * ds .* sqrt(ds);
    force = zeros(numel(ds), 2);
    for a = 1:4
        for b = 1:4
            part = scale .* by_row(:, a) .* by_column(:, b);
            place = row + a + (column + b - 1) * $rows;
            force = force + [part .* along_table(place), sign(tilt) .* part .* across_table(place)];
        end
    end
    along = zeros(size(depth));
    across = along;
    along(touching) = force(:, 1);
    across(touching) = force(:, 2);
end
