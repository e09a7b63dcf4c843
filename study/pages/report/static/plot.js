// Force-depth curves of the dataset's cases, and laws over them. The page's hash is the view.
"use strict";
(() => {
  const { parameters, looks, depths, cases } = window.STUDY_DATA, { svg: shape, html } = window.ELEMENTS;
  const form = document.getElementById("plot"), keys = Object.keys(parameters);
  const names = Object.keys(looks).filter((name) => name !== "elastic_solution");
  const boxes = Object.fromEntries([...form.elements.law].map((box) => [box.value, box]));
  const NUMERIC = new Set(["modulus_ratio", "socket_ratio", "poisson", "r2_star"]);
  const WEIGHTS = { group: 1, kinematics: 30, support: 30, modulus_ratio: 30 };
  const DASHES = { "-": "", "--": "7 4", "-.": "8 3 2 3", ":": "2 3" };
  const MARKERS = {
    o: "M-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0Z", s: "M-3-3H3V3H-3Z", v: "M-3.6-3H3.6L0 3.6Z",
    "^": "M-3.6 3H3.6L0-3.6Z", D: "M0-4L4 0L0 4L-4 0Z",
    P: "M-1.4-4H1.4V-1.4H4V1.4H1.4V4H-1.4V1.4H-4V-1.4H-1.4Z",
    "<": "M-4 0L4-4V4Z", ">": "M4 0L-4-4V4Z", h: "M0-4L3.5-2V2L0 4L-3.5 2V-2Z",
    p: "M0-4L3.8-1.2L2.4 3.2H-2.4L-3.8-1.2Z",
    "*": "M0-4.5L1-1.4H4.3L1.6.5L2.6 3.6L0 1.7L-2.6 3.6L-1.6.5L-4.3-1.4H-1Z",
    X: "M-4-2.2L-2.2-4L0-1.8L2.2-4L4-2.2L1.8 0L4 2.2L2.2 4L0 1.8L-2.2 4L-4 2.2L-1.8 0Z",
  };
  const state = { case: "paper-linear-200", laws: ["hertz", "hyperbolic_winkler", "stiffened_hertz"],
    x: "linear", y: "linear", at: 19 };
  let filled = null, saving = 0;

  const current = () => cases.find((item) => item.name === state.case);
  const depthsOf = (item) => depths[item.depths];
  const digits = (value) => value === 0 ? "0" : Math.abs(value) >= 1e5 || Math.abs(value) < 1e-3
    ? value.toExponential(3) : String(+value.toPrecision(4));
  const percent = (value) => (value > 0 ? "+" : "") + (Math.abs(value) < 0.0005 ? "0.000"
    : Math.abs(value) < 1 ? value.toFixed(3) : value.toPrecision(4)) + " %";
  const error = (item, law, k) => 100 * (item.laws[law][k] / item.force[k] - 1);

  // The case with a wanted value that differs least in everything else.
  function nearest(key, value) {
    const now = current();
    const distance = (item) => keys.reduce((sum, other) => {
      if (other === key || item[other] === now[other]) return sum;
      const far = NUMERIC.has(other) ? Math.abs(Math.log((+item[other] + .1) / (+now[other] + .1))) : 0;
      return sum + (WEIGHTS[other] ?? 10) + far;
    }, 0);
    return cases.filter((item) => item[key] === value)
      .reduce((best, item) => (distance(item) < distance(best) ? item : best));
  }

  // Every value can be chosen; those for which other settings must change stand apart.
  function fill(key) {
    const now = current(), values = [...new Set(cases.map((item) => item[key]))];
    if (NUMERIC.has(key)) values.sort((a, b) => parseFloat(a) - parseFloat(b));
    const alone = new Set(cases.filter((item) => keys.every((other) => other === key ||
      other === "group" || item[other] === now[other])).map((item) => item[key]));
    const options = (kept) => kept.map((value) => new Option(value, value, false, value === now[key]));
    const far = document.createElement("optgroup");
    far.label = "with other settings changed";
    far.append(...options(values.filter((value) => !alone.has(value))));
    form.elements[key].replaceChildren(...options(values.filter((value) => alone.has(value))),
      ...(far.children.length ? [far] : []));
  }

  function ticks(low, high, log) {
    if (log) {
      const steps = high / low < 500 ? [1, 2, 5] : [1], found = [];
      for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high); e++)
        for (const m of steps) found.push(+(m * 10 ** e).toPrecision(2));
      return found.filter((t) => t >= low * 0.999 && t <= high * 1.001);
    }
    const raw = (high - low) / 6, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw), found = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++)
      found.push(+(k * step).toPrecision(10));
    return found;
  }

  function scale(values, log, from, to) {
    let low = Math.min(...values), high = Math.max(...values);
    if (log) [low, high] = [low / 1.15, high * 1.15];
    else if (low === high) [low, high] = [low - 1, high + 1];
    else [low, high] = [low - (low < 0 ? 0.05 * (high - low) : 0), high + 0.05 * (high - low)];
    const by = log ? Math.log : (value) => value;
    const place = (value) => from + (to - from) * (by(value) - by(low)) / (by(high) - by(low));
    return Object.assign(place, { ticks: ticks(low, high, log) });
  }

  // One chart: `series` is a list of [name, values]; values may be missing.
  function chart(id, label, x, series, logs) {
    const svg = document.getElementById(id), width = Math.max(280, svg.clientWidth || 720);
    const height = id === "force" ? Math.min(420, 0.7 * width) : Math.min(260, 0.55 * width);
    const [left, right, top, bottom] = [62, width - 12, 24, height - 42];
    const across = scale(logs[0] ? x : [0, ...x], logs[0], left, right);
    const all = series.flatMap(([, values]) => values).filter((value) => !logs[1] || value > 0);
    const up = scale(logs[1] ? all : [0, ...all], logs[1], bottom, top);
    const path = (kind, d) => shape("path", { class: kind, d });
    const words = (text, x, y, anchor = "start") => shape("text", { x, y, "text-anchor": anchor }, text);
    const parts = [];
    for (const t of across.ticks)
      parts.push(path("grid", `M${across(t)} ${top}V${bottom}`), words(t, across(t), bottom + 16, "middle"));
    for (const t of up.ticks) parts.push(path(t === 0 ? "axis" : "grid", `M${left} ${up(t)}H${right}`),
      words(Math.abs(t) >= 1e5 ? t.toExponential(0) : t, left - 6, up(t) + 4, "end"));
    parts.push(path("axis", `M${left} ${top}V${bottom}H${right}`),
      words("penetration depth δ* = δ/ΔR (clearances)", (left + right) / 2, height - 6, "middle"),
      words(label, 4, 14), path("cursor", `M${across(x[state.at])} ${top}V${bottom}`));
    for (const [name, values] of series) {
      const look = looks[name], points = [], named = { "data-name": name };
      values.forEach((value, k) => { if (!logs[1] || value > 0) points.push([across(x[k]).toFixed(1), up(value).toFixed(1), k]); });
      if (look.line !== "none") parts.push(shape("path", { ...named, class: "line", fill: "none", stroke: look.color,
        "stroke-dasharray": DASHES[look.line], d: `M${points.map(([a, b]) => `${a} ${b}`).join("L")}` }));
      const every = look.line === "none" ? 1 : 6, first = look.line === "none" ? 0 : 1 + names.indexOf(name) % 6;
      const marks = points.filter(([, , k]) => k % every === first % every)
        .map(([a, b]) => shape("path", { transform: `translate(${a} ${b})`, d: MARKERS[look.marker] }));
      parts.push(shape("g", { ...named, class: "marks", fill: look.color }, ...marks));
    }
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    svg.replaceChildren(...parts);
    svg.onpointermove = svg.onpointerdown = (event) => {
      const at = (event.clientX - svg.getBoundingClientRect().left) * width / svg.clientWidth;
      const gaps = x.map((depth) => Math.abs(across(depth) - at)), k = gaps.indexOf(Math.min(...gaps));
      if (k !== state.at) { state.at = k; draw(); save(); }
    };
  }

  function draw() {
    const item = current(), x = depthsOf(item), shown = names.filter((law) => state.laws.includes(law) && item.laws[law]);
    state.at = Math.min(Math.max(0, state.at), x.length - 1);
    if (filled !== item) keys.forEach(fill);
    filled = item;
    form.elements.x.value = state.x;
    form.elements.y.value = state.y;
    Object.assign(form.elements.at, { max: x.length - 1, value: state.at });
    form.elements.at.setAttribute("aria-valuetext", `${x[state.at]} clearances`);
    for (const law of names) {
      Object.assign(boxes[law], { checked: state.laws.includes(law) && law in item.laws, disabled: !(law in item.laws) });
      boxes[law].parentElement.title = item.undefined[law] ?? "";
    }
    const logs = [state.x === "log", state.y === "log"];
    chart("force", "contact force P* = P/(E* ΔR²)", x, [["elastic_solution", item.force], ...shown.map((law) => [law, item.laws[law]])], logs);
    document.getElementById("error").style.display = shown.length ? "" : "none";
    if (shown.length) chart("error", "relative error of the law (percent)", x,
      shown.map((law) => [law, x.map((_, k) => error(item, law, k))]), [logs[0], false]);
    const table = document.getElementById("values"), rows = [["elastic_solution", item.force], ...shown.map((law) => [law, item.laws[law]])];
    table.caption.textContent = `At a depth of ${digits(x[state.at])} clearances, ${state.at + 1} of ${x.length}`;
    table.tBodies[0].replaceChildren(...rows.map(([name, values]) => html("tr", {}, html("td", {}, looks[name].label),
      html("td", { class: "num" }, digits(values[state.at])),
      html("td", { class: "num" }, name === "elastic_solution" ? "" : percent(error(item, name, state.at))))));
    const missing = names.filter((law) => item.undefined[law]).map((law) => [looks[law].label + " is not defined here", item.undefined[law]]);
    const told = [["Case", item.name], ["Solver", item.solver],
      ["Half-angle of the contact at the largest depth", `${item.half_angle} degrees, at ${x.at(-1)} clearances`],
      ["Estimated error of the force", `at most ${digits(item.error)} %`], ...missing];
    document.getElementById("case").replaceChildren(...told.flatMap(([term, text]) => [html("dt", {}, term), html("dd", {}, text)]));
  }

  function save() {  // the view in the address, not at every move: browsers allow few changes in a short time
    clearTimeout(saving);
    saving = setTimeout(() => history.replaceState(null, "", "#" + new URLSearchParams({ ...state, laws: state.laws.join(",") })), 200);
  }

  function read() {
    const given = new URLSearchParams(location.hash.slice(1));
    const asked = given.get("case"), known = cases.some((item) => item.name === asked);
    if (known) state.case = asked;
    form.querySelector(".changed").textContent = asked && !known ? `There is no case ${asked}.` : "";
    if (given.has("laws")) state.laws = given.get("laws").split(",").filter((law) => names.includes(law));
    for (const axis of ["x", "y"]) if (["linear", "log"].includes(given.get(axis))) state[axis] = given.get(axis);
    if (given.has("at")) state.at = Number(given.get("at")) || 0;
    draw();
  }

  form.addEventListener("input", ({ target }) => {
    let changed = [];
    if (keys.includes(target.name)) {
      const before = current(), depth = depthsOf(before)[state.at], after = nearest(target.name, target.value);
      changed = keys.filter((key) => key !== target.name && before[key] !== after[key]);
      state.case = after.name;
      const gaps = depthsOf(after).map((value) => Math.abs(value - depth));
      state.at = gaps.indexOf(Math.min(...gaps));
      changed = changed.map((key) => `${parameters[key]} ${after[key]}`);
    } else if (target.name === "law") {
      state.laws = target.checked ? [...state.laws, target.value] : state.laws.filter((law) => law !== target.value);
    } else if (target.name === "at") state.at = Number(target.value);
    else state[target.name] = target.value;
    draw();
    save();
    form.querySelector(".changed").textContent = changed.length ? `Also changed: ${changed.join("; ")}` : "";
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  for (const law of names) {
    const look = looks[law];
    boxes[law].parentElement.querySelector("svg").replaceChildren(
      shape("path", { class: "line", stroke: look.color, "stroke-dasharray": DASHES[look.line], d: "M0 7H34" }),
      shape("path", { transform: "translate(17 7)", fill: look.color, d: MARKERS[look.marker] }));
  }
  window.addEventListener("hashchange", read);
  window.addEventListener("resize", draw);
  window.addEventListener("beforeprint", draw);
  read();
})();
