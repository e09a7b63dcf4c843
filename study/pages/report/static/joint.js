// The law `stiffened_hertz` of one joint in SI units, as `study.contact` computes it from its table.
// Without a page: `window.JOINT_DATA` holds every number, see `study/pages/report/numbers.py`.
"use strict";
window.STIFFENED_HERTZ = (() => {
  const data = window.JOINT_DATA, count = data.to_powers.length;
  const LEAST_R2_STAR = 10;  // of a joint; that of the law is in the data
  const table = data.table.trim().split("\n").slice(1).map((line) => line.split(",").map(Number));

  function general(value, digits = 6) {  // as Python's format g
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e"), size = Math.abs(exponent);
    if (value === 0 || (exponent >= -4 && exponent < digits)) return String(+value.toPrecision(digits));
    return `${+mantissa}e${exponent < 0 ? "-" : "+"}${size < 10 ? "0" : ""}${size}`;
  }

  const within = { ">": (a, b) => a > b, ">=": (a, b) => a >= b, "<": (a, b) => a < b, "<=": (a, b) => a <= b };

  // The refusals of `study.checks.number`: name, range, value, unit.
  function number(name, value, unit, limits) {
    const limit = Object.entries(limits), of = unit && ` ${unit}`, texts = limit.map(([sign, end]) => `${sign} ${general(end)}`);
    if (limit.every(([sign, end]) => within[sign](value, end))) return value;
    throw new Error(`${name} must be ${texts.join(" and ")}${of}, got ${general(value)}${of}`);
  }

  function read(name, text) {
    if (text?.trim() && !Number.isNaN(+text)) return +text;
    throw new Error(`${name} must be a number, got '${text ?? ""}'`);
  }

  // A material by its name, or by Young's modulus in Pa, Poisson's ratio and perhaps yield stress in Pa.
  function material(body, text) {
    const known = data.materials.find((row) => row.name === text), parts = text.split(",");
    if (known) return known;
    if (parts.length < 2 || parts.length > 3 || parts.some((part) => !part.trim() || Number.isNaN(+part))) {
      const names = data.materials.map((row) => row.name).join(", ");
      throw new Error(`${body} must be one of ${names}, or Young's modulus and Poisson's ratio, for example 210GPa,0.3, got '${text}'`);
    }
    const [youngs_modulus, poisson, yield_stress = null] = parts.map(Number);
    number(`Young's modulus of ${body}`, youngs_modulus, "Pa", { ">=": data.softest });
    number("poisson", poisson, "", { ">": -1, "<": 0.5 });
    if (yield_stress !== null) number("yield_stress", yield_stress, "Pa", { ">": 0 });
    return { name: text, youngs_modulus, poisson, yield_stress };
  }

  const scaled = (value, least, most) => (2 * value - least - most) / (most - least);
  const byPoisson = (nu) => Math.log(1 - 1.8 * nu);
  const chebyshev = (degree, place) => Math.cos(degree * Math.acos(Math.min(Math.max(place, -1), 1)));

  // Coefficients of u to u^9 in S - 1, where S is the force over Hertz's.
  function powers({ share, poisson, socket_poisson, socket_ratio, clamped, free }, r2_star) {
    const ends = data.ranges.poisson.map(byPoisson), thinnest = Math.log(1 - 1 / data.ranges.socket_ratio[0]);
    const places = [2 * Math.sqrt(share) - 1, scaled(byPoisson(poisson), ...ends), scaled(byPoisson(socket_poisson), ...ends),
      scaled(Math.log1p(-1 / socket_ratio), thinnest, 0), 2 * data.least_r2_star / r2_star - 1];
    const logarithms = Array(count).fill(0);
    for (const [onlyClamped, onlyFree, ...row] of table) {
      if (onlyClamped > clamped || onlyFree > free) continue;
      const factor = places.reduce((product, place, k) => product * chebyshev(row[k], place), data.unit);
      for (let k = 0; k < count; k++) logarithms[k] += factor * row[places.length + k];
    }
    const round = 10 ** data.digits, rises = logarithms.map((logarithm) => Math.round(Math.expm1(logarithm) * round) / round);
    return data.to_powers.map((row) => row.reduce((sum, value, k) => sum + value * rises[k], 0));
  }

  // Value and slope over ds of ds^(3/2) S, and S = 1 + c1 u + ..., with u = s/(1 + s), s = sqrt(ds).
  function shape(depth, constants) {
    const root = Math.sqrt(depth), u = root / (1 + root);
    let factor = 0, slope = 0;
    for (const constant of [...constants].reverse().concat(1)) [factor, slope] = [factor * u + constant, slope * u + factor];
    return [depth * root * factor, root * 1.5 * factor + depth * slope * (1 - u) ** 2 / 2, factor];
  }

  // A law of a joint; checks are those of `study.joint.Joint` and of the law, in their order.
  function law({ socket_radius, clearance, wall, ball, socket, ball_support, rim }) {
    const margin = 1 + data.margin;
    number("socket_radius", socket_radius, "m", { ">": 0 });
    number("clearance", clearance, "m", { ">": 0 });
    if (+(socket_radius / clearance).toPrecision(12) < LEAST_R2_STAR)
      throw new Error(`clearance must be <= ${general(socket_radius / LEAST_R2_STAR)} m, a tenth of the radius of the socket, got ${general(clearance)} m; ` +
        "such a loose ball is not in a clearance joint, for which the solution assumes small displacements");
    number("clearance", clearance, "m", { ">=": (1 - 1e-9) * data.least_clearance * socket_radius });
    number("wall", wall, "m", { ">=": data.walls[0] * socket_radius, "<=": data.walls[1] * socket_radius });
    const [first, second] = [material("ball", ball), material("socket", socket)], modulus_ratio = second.youngs_modulus / first.youngs_modulus;
    const name = "Young's modulus of the socket divided by that of the ball", most = data.ranges.modulus_ratio[1];
    number(name, modulus_ratio, "", { ">=": 1 / most, "<=": most });
    const gap = socket_radius - (socket_radius - clearance), r2_star = socket_radius / gap;
    number("r2_star of stiffened_hertz", r2_star, "", { ">=": data.least_r2_star * (1 - data.margin) });
    const options = { socket_ratio: 1 + wall / socket_radius, modulus_ratio, poisson: first.poisson, socket_poisson: second.poisson };
    for (const [key, value] of Object.entries(options)) {
      const [least, highest] = data.ranges[key];
      number(`${key} of stiffened_hertz`, value, "", { ">=": least * (1 - data.margin), "<=": highest });
    }
    for (const [key, value] of Object.entries({ ball_support, rim })) if (!data.choices[key].includes(value))
      throw new Error(`${key} of stiffened_hertz must be one of ${data.choices[key].join(", ")}, got '${value}'`);
    const clamped = +(ball_support === "clamped"), free = +(rim === "free");
    const compliances = [first, second].map((body) => (1 - body.poisson ** 2) / body.youngs_modulus);
    const composite = 1 / (compliances[0] + compliances[1]);
    const ofBall = (1 - first.poisson ** 2) * modulus_ratio, share = ofBall / (ofBall + 1 - second.poisson ** 2);
    const constants = powers({ ...options, share, clamped, free }, r2_star);
    const unit = 4 / 3 * Math.sqrt(r2_star * (r2_star - 1)) * composite * gap ** 2, deepest = gap * data.deepest;
    const inside = (depth) => number("depth of stiffened_hertz", depth, "m", { "<=": deepest * margin }) / gap;
    const force = (depth) => unit * shape(inside(depth), constants)[0], stiffness = (depth) => unit / gap * shape(inside(depth), constants)[1];

    function depth(given) {  // by Newton's method in logarithms
      number("force of stiffened_hertz", given, "N", { ">=": 0, "<=": force(deepest) * margin });
      const wanted = given / unit;
      let found = Math.min(wanted ** (2 / 3), data.deepest), before = 0;  // Hertz's
      while (given > 0 && Math.abs(found - before) > 1e-10 * found) {
        const [value, slope] = shape(found, constants);
        [before, found] = [found, found * Math.exp(-Math.log(value / wanted) * value / (slope * found))];
      }
      return given > 0 ? gap * found : 0;
    }

    // The k d^n, d in m, with the least largest relative error between two depths in clearances.
    function power(from, to) {
      number("minimum depth of the power law in clearances", from, "", { ">": 0, "<": data.deepest });
      number("maximum depth of the power law in clearances", to, "", { ">": from, "<=": data.deepest });
      const logs = Array.from({ length: 60 }, (_, k) => Math.log(from * gap) + k / 59 * Math.log(to / from));
      const forces = logs.map((x) => Math.log(force(Math.min(Math.exp(x), deepest)))), golden = (Math.sqrt(5) - 1) / 2;
      const off = (n) => logs.map((x, k) => n * x - forces[k]), spread = (n) => Math.max(...off(n)) - Math.min(...off(n));
      let [low, high] = [0, 10];  // the spread is convex in n
      while (high - low > 1e-10) {
        const [a, b] = [high - golden * (high - low), low + golden * (high - low)];
        if (spread(a) < spread(b)) high = b; else low = a;
      }
      const n = (low + high) / 2, least = Math.exp(Math.min(...off(n))), most = Math.exp(Math.max(...off(n)));
      return { n, k: 2 / (least + most), error: (most - least) / (most + least) };
    }

    const hertz = (depth) => unit * (depth / gap) ** 1.5;
    return { ...options, r2_star, clearance: gap, deepest, force, stiffness, depth, power, hertz };
  }

  return { law, general, read, number };
})();
