"""The rigid links once more, in absolute coordinates with Lagrange multipliers, by SciPy's DOP853.

Nothing of `study.mechanism` but the parameters is used. The unknowns are the centres and angles of
crank and coupler, and the position of the slider. Ideal joints, and a constant speed of the crank,
are constraints on the accelerations. A contact begins and ends at a located root of the gap.
"""

from math import inf

import numpy as np
from scipy.integrate import solve_ivp

from study.mechanism import Scene

TOLERANCE = 1e-12
LONGEST_STEP = 2e-5  # s, so that no contact is missed
DISARMED = 1e-10  # s after the start of a contact or a flight, in which the gap is rounding only


class Links:
    """Crank, coupler and slider of a scene with Hertz's law, at y = (q, q').

    With an ``ideal`` joint the ball stays in the centre of the socket.
    """

    def __init__(self, scene: Scene, ideal: bool) -> None:
        s = self.scene = scene
        self.ideal, self.a, self.b = ideal, s.crank_length / 2, s.coupler_length / 2
        (i1, i2), m1, m2 = s.inertias, s.crank_mass, s.coupler_mass
        self.masses = np.array([m1, m1, i1, m2, m2, i2, s.slider_mass])
        compliance = sum((1 - of.poisson**2) / of.youngs_modulus for of in s.materials)
        effective = (s.socket_radius - s.clearance) * s.socket_radius / s.clearance
        self.stiffness = 4 / 3 / compliance * np.sqrt(effective)
        self.damping = 0.75 * (1 - s.restitution**2)  # Lankarani and Nikravesh
        self.approach = inf  # speed at the start of the contact; inf in flight

    def start(self) -> np.ndarray:
        """Coordinates and speeds at t = 0, with the ball at rest in its socket."""
        s, theta = self.scene, self.scene.initial_crank_angle
        ex, ey = s.initial_eccentricity
        speed = s.initial_crank_speed if s.crank_speed is None else s.crank_speed
        phi = np.arcsin((ey - 2 * self.a * np.sin(theta)) / (2 * self.b))
        turning = -self.a * np.cos(theta) * speed / (self.b * np.cos(phi))
        (cx, cy), (px, py) = self._along(theta, self.a), self._along(phi, self.b)
        places = [cx, cy, theta, 2 * cx + px, 2 * cy + py, phi, 2 * cx + 2 * px - ex]
        x_rate = -2 * cy * speed - py * turning
        rates = [-cy * speed, cx * speed, speed, x_rate, 2 * cx * speed + px * turning, turning]
        return np.array([*places, *rates, x_rate - py * turning])

    @staticmethod
    def _along(angle, length):
        return length * np.cos(angle), length * np.sin(angle)

    def eccentricity(self, y: np.ndarray) -> np.ndarray:
        """Ball's centre from the socket's, and its rate: x, y, x', y'."""
        px, py = self._along(y[5], self.b)
        return np.array(
            [y[3] + px - y[6], y[4] + py, y[10] - py * y[12] - y[13], y[11] + px * y[12]]
        )

    def gap(self, y: np.ndarray) -> float:
        """Depth of penetration in m, negative without contact."""
        return float(np.hypot(*self.eccentricity(y)[:2])) - self.scene.clearance

    def contact(self, y: np.ndarray) -> tuple[float, float, np.ndarray]:
        """Normal and tangential force on the ball, and the direction of the eccentricity."""
        s, e = self.scene, self.eccentricity(y)
        n = e[:2] / np.hypot(*e[:2])
        rate, sliding = e[2:] @ n, n[0] * e[3] - n[1] * e[2] + s.ball_radius * y[12]
        depth = max(self.gap(y), 0.0)
        normal = self.stiffness * depth**1.5 * (1 + self.damping * rate / self.approach)
        ramp = np.clip((abs(sliding) - s.slow_speed) / (s.full_speed - s.slow_speed), 0, 1)
        return normal, -s.friction * ramp * np.sign(sliding) * normal, n

    def slopes(self, _: float, y: np.ndarray) -> np.ndarray:
        """Rates of y."""
        s, theta, phi, w, v = self.scene, y[2], y[5], y[9], y[12]
        (cx, cy), (px, py) = self._along(theta, self.a), self._along(phi, self.b)
        rows = [  # crank on its bearing, coupler on the crank: coefficients of q'', right side
            ([1, 0, cy, 0, 0, 0, 0], -cx * w * w),
            ([0, 1, -cx, 0, 0, 0, 0], -cy * w * w),
            ([1, 0, -cy, -1, 0, -py, 0], cx * w * w + px * v * v),
            ([0, 1, cx, 0, -1, px, 0], cy * w * w + py * v * v),
        ]
        load = np.zeros(7)
        load[[1, 4]] = -s.gravity * self.masses[[1, 4]]
        if s.crank_speed is None:
            load[2] = s.driving_moment
        else:
            rows.append(([0, 0, 1, 0, 0, 0, 0], 0.0))
        if self.ideal:
            rows.append(([0, 0, 0, 1, 0, -py, -1], px * v * v))
            rows.append(([0, 0, 0, 0, 1, px, 0], py * v * v))
        elif self.approach < inf:
            normal, tangential, (nx, ny) = self.contact(y)
            fx, fy = -normal * nx - tangential * ny, -normal * ny + tangential * nx
            load[3:] += fx, fy, px * fy - py * fx + s.ball_radius * tangential, -fx
        jacobian = np.array([row for row, _ in rows], dtype=float)
        n = 7 + len(rows)
        matrix, right = np.zeros((n, n)), np.append(load, [value for _, value in rows])
        matrix[:7, :7], matrix[:7, 7:], matrix[7:, :7] = np.diag(self.masses), jacobian.T, jacobian
        return np.append(y[7:], np.linalg.solve(matrix, right)[:7])


def motion(
    scene: Scene, times: list[float], ideal: bool = False, tolerance: float = TOLERANCE
) -> tuple[np.ndarray, list[dict[str, float]]]:
    """Rows (angle, speed of the crank; position, velocity, acceleration of the slider) at times.

    And the impacts: ``time``, ``approach_speed`` and ``peak_force`` of each that has begun.
    """
    links, t, found, impacts = Links(scene, ideal), 0.0, [], []
    y = links.start()
    scale = np.array([1, 1, 10, 1, 1, 10, 1, 100, 100, 1000, 100, 100, 1000, 100]) * 1e-4
    while t < times[-1]:
        touching = links.approach < inf

        def gap(now, z, begun=t, touching=touching):
            if now <= begun + DISARMED:
                return 1.0 if touching else -1.0
            return links.gap(z)

        gap.terminal, gap.direction = True, -1 if touching else 1
        events = [] if ideal else [gap]
        left = [at for at in times if at > t]
        part = solve_ivp(
            links.slopes,
            (t, times[-1]),
            y,
            "DOP853",
            dense_output=True,
            events=events,
            rtol=max(tolerance, 3e-14),
            atol=tolerance * scale,
            max_step=inf if ideal else LONGEST_STEP,
        )
        end = part.t[-1]
        for at in left:
            if at <= end:
                z = part.sol(at)
                found.append([z[2], z[9], z[6], z[13], links.slopes(at, z)[13]])
        if touching:
            impacts[-1]["peak_force"] = _largest(part, links)
        t, y = end, part.y[:, -1]
        if part.status == 1:
            e = links.eccentricity(y)
            speed = float(e[:2] @ e[2:] / np.hypot(*e[:2]))
            links.approach = inf if touching else speed
            if not touching:
                impacts.append({"time": t, "approach_speed": speed, "peak_force": 0.0})
    return np.array(found), impacts


def _largest(part, links):
    """Maximum normal force of a contact: of its steps, refined between the neighbours of one."""
    t = part.t
    for _ in range(4):
        forces = [links.contact(part.sol(at))[0] for at in t]
        k = int(np.argmax(forces))
        t = np.linspace(t[max(k - 1, 0)], t[min(k + 1, len(t) - 1)], 41)
    return max(forces)
