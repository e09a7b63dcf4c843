  constant Real table[$count, 2] = {
$rows
  } "Force over depth^1.5 and its derivative, at equal steps of sqrt(depth)";

  function contact_force
    "Contact force and stiffness; beyond the range it continues linearly, with a warning"
    input Real depth(unit = "m");
    output Real force(unit = "N");
    output Real stiffness(unit = "N/m");
  protected
    constant Real steps = $steps, deepest = $deepest;
    Real inside, s, x, factor, slope, rise, c2, c3;
    Integer k;
  algorithm
    if depth <= 0 then
      force := 0;
      stiffness := 0;
      return;
    end if;
    assert(depth <= deepest, "$beyond.",
      level = AssertionLevel.warning);
    inside := min(depth, deepest);
    s := sqrt(inside);
    k := integer(min(floor(steps * s), $last)) + 1;
    x := steps * s - (k - 1);
    rise := steps * (table[k + 1, 1] - table[k, 1]);
    c2 := 3 * rise - 2 * table[k, 2] - table[k + 1, 2];
    c3 := table[k, 2] + table[k + 1, 2] - 2 * rise;
    factor := table[k, 1] + x / steps * (table[k, 2] + x * (c2 + x * c3));
    slope := table[k, 2] + x * (2 * c2 + x * 3 * c3);
    stiffness := 1.5 * s * factor + inside * slope / 2;
    force := inside * s * factor + stiffness * (depth - inside);
  end contact_force;
