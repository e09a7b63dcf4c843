  function contact_force "Contact force and stiffness: k depth^n with k = $coefficient, n = $exponent"
    input Real depth(unit = "m");
    output Real force(unit = "N");
    output Real stiffness(unit = "N/m");
  algorithm
    force := if depth <= 0 then 0 else $coefficient * depth ^ $exponent;
    stiffness := if depth <= 0 then 0 else $exponent * force / depth;
  end contact_force;
