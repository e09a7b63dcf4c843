// $title
// $source
$described
//
// The function is plain Modelica; the model needs the Modelica Standard Library 4.
within;
package $name "Contact of one spherical clearance joint"
  constant Real clearance(unit = "m") = $clearance;

$function

  model Joint "Ball in a socket: frame_a at the socket's centre, frame_b at the ball's"
    extends Modelica.Mechanics.MultiBody.Interfaces.PartialTwoFrames;
    Real eccentricity[3](each unit = "m") = frame_b.r_0 - frame_a.r_0;
    Real distance(unit = "m") = sqrt(eccentricity * eccentricity);
    Real force[3](each unit = "N") "On the socket, in the world's frame";
  equation
    force = if distance > clearance then
      contact_force(distance - clearance) * eccentricity / distance else zeros(3);
    frame_a.f = -Modelica.Mechanics.MultiBody.Frames.resolve2(frame_a.R, force);
    frame_b.f = Modelica.Mechanics.MultiBody.Frames.resolve2(frame_b.R, force);
    frame_a.t = zeros(3);
    frame_b.t = zeros(3);
  end Joint;
end $name;
