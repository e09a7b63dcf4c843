// The page "Your own joint": form, results, plot and texts to copy. The hash of the URL stores the input.
"use strict";
(() => {
  const { law: lawOf, general, read, number } = window.STIFFENED_HERTZ;
  const html = (tag, attributes = {}, ...content) => {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.append(...content);
    return element;
  };
  const { judged, materials, quantities } = window.JOINT_DATA;
  const form = document.getElementById("joint"), fields = form.elements, part = (id) => document.getElementById(id);
  const MICRO = 1e-6, ROUGHNESS = 0.1 * MICRO, BODIES = ["ball", "socket"], UNITS = { mm: 1e-3, um: MICRO, GPa: 1e9, MPa: 1e6, "N/um": 1e6 };
  const FIELDS = { socket_radius: "socket_radius_mm", clearance: "clearance_um", r2_star: "clearance_um", wall: "wall_mm", socket_ratio: "wall_mm", force: "value", depth: "value" };
  const MEANS = { r2_star: "r2_star is the socket's inner radius over the clearance", socket_ratio: "socket_ratio is 1 + wall/inner radius" };
  let found = {}, saving = 0;

  const few = (value, digits = 4) => general(+value.toPrecision(digits));
  const rounded = (value) => +value.toPrecision(12);
  const unitOf = (name) => quantities[name].read.replace("um", "µm"), inUnit = (name) => UNITS[quantities[name].read] ?? 1;
  const result = (name, value, more = "") => [quantities[name].meaning, `${few(value / inUnit(name))} ${unitOf(name)}${more}`];
  const known = (body) => materials.find((row) => row.name === fields[body].value);
  const numbersOf = (body) => ["youngs_modulus_GPa", "poisson", "yield_stress_MPa"].map((name) => `${body}_${name}`);

  function si(name, as) {  // a field's number in SI units, by the end of its name
    const unit = as ?? name.split("_").at(-1), plain = name.replace(`_${unit}`, "");
    return rounded(read(plain, fields[name].value) * (UNITS[unit] ?? 1));
  }

  function material(body) {  // as study joint takes it
    const names = numbersOf(body).filter((name, k) => k < 2 || fields[name].value);
    return known(body) ? fields[body].value : names.map((name) => si(name)).join();
  }

  function showMaterial(body) {  // another material begins with the numbers of the last
    numbersOf(body).forEach((name, k) => {
      const value = known(body)?.[["youngs_modulus", "poisson", "yield_stress"][k]], unit = UNITS[name.split("_").at(-1)] ?? 1;
      if (known(body)) fields[name].value = value && rounded(value / unit);
      fields[name].parentElement.hidden = Boolean(known(body));
    });
  }

  function list(id, pairs, copied) {  // terms and texts; those to copy with a button
    part(id).replaceChildren(...pairs.flatMap(([term, text]) => {
      const code = html(copied ? "code" : "span", {}, text), button = html("button", { type: "button" }, "Copy");
      button.addEventListener("click", () => {
        getSelection().selectAllChildren(code);
        if (document.execCommand("copy")) button.textContent = "Copied";
      });
      return [html("dt", {}, term), html("dd", {}, code, ...(copied ? [" ", button] : []))];
    }));
  }

  const supports = () => (fields.ball_support.value === "clamped" ? " --ball-support clamped" : "") + (fields.rim.value === "free" ? " --rim free" : "");
  const quoted = (text) => text.includes(" ") ? `"${text}"` : text;

  function draw() {
    let message = "", command = "";
    try {
      const depthGiven = fields.given.value === "depth", asked = si("value", depthGiven ? "um" : "N");
      const joint = { socket_radius: si("socket_radius_mm"), clearance: si("clearance_um"), wall: si("wall_mm"),
        ball: material("ball"), socket: material("socket"), ball_support: fields.ball_support.value, rim: fields.rim.value };
      command = `study joint --socket-radius ${joint.socket_radius} --clearance ${joint.clearance} --wall ${joint.wall} ` +
        `--ball ${quoted(joint.ball)} --socket ${quoted(joint.socket)}${supports()} --${fields.given.value} ${asked}`;
      number(fields.given.value, asked, depthGiven ? "m" : "N", { ">": 0 });
      const law = lawOf(joint), depth = depthGiven ? asked : law.depth(asked), [from, to] = [si("from"), si("to")];
      found = { law, depth, force: law.force(depth), from, to, power: law.power(from, to), command };
      show(found);
    } catch (error) {
      const outside = error.message.includes("stiffened_hertz") ? `. The law stiffened_hertz is not valid for this joint; this command solves it: ${command}` : "";
      const name = error.message.split(" ")[0], field = fields[FIELDS[name]]?.parentElement.firstChild.textContent.trim();
      const means = MEANS[name] ? ` (${MEANS[name]})` : "";
      [message, found] = [(field ? `${field}: ` : "") + error.message + means + outside, {}];
    }
    form.querySelector(".message").textContent = message;
    form.classList.toggle("without", Boolean(message));
  }

  function show({ law, depth, force, from, to, power: { k, n, error }, command }) {
    const perMm = general(k * 1000 ** -n), off = 100 * (law.hertz(depth) / force - 1), nine = (value) => general(value, 9);
    list("results", [
      result("depth", depth, `, or ${few(depth / law.clearance)} clearances`),
      result("force", force),
      result("stiffness", law.stiffness(depth)),
      ["Error of the force, relative to elastic solutions for small displacements", `at most ${few(judged.validation, 2)} % on random joints, ${few(judged.ends, 2)} % at the ends of its ranges of validity`],
      [`Power law F = k dⁿ of stiffened_hertz, from ${from} to ${to} clearances`, `n = ${general(n)}, k = ${general(k)} N/mⁿ = ${perMm} N/mmⁿ`],
      ["Maximum relative error of the power law", `${few(100 * error, 2)} %`],
    ]);
    const sentences = [
      "The bodies are elastic and smooth, without friction. The load is along the axis.",
      "The outside of the socket is held rigidly.",
      Math.abs(off) < 1 ? `Hertz's law agrees with it within ${few(Math.abs(off), 2)} %.` : `The force of Hertz's law is ${few(Math.abs(off), 2)} % too ${off < 0 ? "small" : "large"} at this depth.`,
      "The command study joint, below, also computes contact pressure, stresses and the factor to yield.",
      "The socket has no liner. For a joint with a liner, use study joint with --liner.",
      depth < 20 * ROUGHNESS ? `A roughness of ${ROUGHNESS / MICRO} µm (RMS) is not small compared with the depth.` : "",
    ];
    part("applies").replaceChildren(...sentences.filter(Boolean).map((text) => html("li", {}, text)));
    list("texts", [
      ["Command that solves the joint, with stresses", command],
      ["Command that exports the law for another program", command.replace("joint", "export --law stiffened_hertz --format c").replace(/ --(force|depth) .*/, "")],
      ["Power law for Adams, in N and mm, with markers at the centres", `-IMPACT(-DM(ball, socket), -VR(ball, socket), -${nine(1000 * law.clearance)}, ${perMm}, ${general(n)}, 0, ${nine(1000 * law.clearance)})`],
      ["Power law for Modelica, in N and m", `f = if d > 0 then ${general(k)}*d^${general(n)} else 0;`],
    ], true);
    plot();
  }

  function plot() {
    if (!found.law) return;
    const { law, depth, force, from, to, power: { k, n } } = found, ink = getComputedStyle(document.body).color;
    const most = Math.min(law.deepest, 1.2 * Math.max(depth, to * law.clearance));
    const curve = (name, of, color, dash, start, end) => {
      const at = Array.from({ length: 101 }, (_, step) => start + (step / 100) * (end - start));
      return { name, x: at.map((d) => d / MICRO), y: at.map(of), line: { color, dash }, mode: "lines", hovertemplate: "%{y:.4g} N" };
    };
    const axis = (text) => ({ title: { text }, rangemode: "tozero", gridcolor: "rgba(128,128,128,0.25)", zerolinecolor: ink });
    Plotly.react("curve", [
      curve("stiffened_hertz", law.force, "#3d85c6", "solid", 0, most),
      curve("power law", (d) => k * d ** n, "#c2701c", "dash", from * law.clearance, Math.min(to * law.clearance, most)),
      curve("Hertz's law", law.hertz, "#888888", "dot", 0, most),
      { name: "given", x: [depth / MICRO], y: [force], mode: "markers", marker: { size: 10, color: "#3d85c6" }, hovertemplate: "%{y:.4g} N" },
    ], { height: 360, margin: { l: 70, r: 10, t: 10, b: 50 }, hovermode: "x", paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
      font: { color: ink }, legend: { orientation: "h", y: 1.02, yanchor: "bottom" },
      xaxis: axis(`${quantities.depth.meaning}, ${unitOf("depth")}`), yaxis: axis(`${quantities.force.meaning}, ${unitOf("force")}`) },
    { responsive: true, displayModeBar: false });
  }

  function open() {  // the joint that the URL describes
    form.reset();
    for (const [name, value] of new URLSearchParams(location.hash.slice(1))) if (fields[name]) fields[name].value = value;
    BODIES.forEach(showMaterial);
    draw();
  }

  form.addEventListener("input", ({ target }) => {
    if (BODIES.includes(target.name)) showMaterial(target.name);
    if (target.name === "given" && found.law) fields.value.value = few(target.value === "depth" ? found.depth / MICRO : found.force, 6);
    draw();
    clearTimeout(saving);  // browsers allow few changes of the URL in a short time
    saving = setTimeout(() => history.replaceState(null, "", "#" + new URLSearchParams(new FormData(form))), 200);
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  window.addEventListener("hashchange", open);
  new MutationObserver(plot).observe(document.body, { attributes: true, attributeFilter: ["data-theme"] });
  open();
})();
