// Force-depth curves of the cases of the dataset, and the laws. The hash of the URL stores the view.
"use strict";
(() => {
  const { parameters, looks, depths, cases } = window.STUDY_DATA;
  const form = document.getElementById("plot"), keys = Object.keys(parameters);
  const laws = Object.keys(looks).filter((name) => name !== "elastic_solution");
  const NUMERIC = new Set(["modulus_ratio", "socket_ratio", "poisson", "r2_star"]);
  const SHOWN = ["hertz", "hyperbolic_winkler", "stiffened_hertz"];  // the legend shows and hides others
  const DASHES = { "-": "solid", "--": "dash", "-.": "dashdot", ":": "dot" };
  const MARKERS = { o: "circle", s: "square", v: "triangle-down", "^": "triangle-up", D: "diamond", P: "cross",
    X: "x", "*": "star", h: "hexagon", p: "pentagon", "<": "triangle-left", ">": "triangle-right" };
  const state = { case: "paper-linear-200", x: "linear", y: "linear" };
  const current = () => cases.find((item) => item.name === state.case);

  // The case with a wanted value that agrees with the current one in most other settings.
  function nearest(key, value) {
    const now = current(), others = keys.filter((other) => other !== key && other !== "group");
    const distance = (item) => others.reduce((sum, other) => sum + (item[other] === now[other] ? 0 : 1 +
      (NUMERIC.has(other) ? Math.abs(Math.log((+item[other] + 0.1) / (+now[other] + 0.1))) || 0 : 3)), 0);
    return cases.filter((item) => item[key] === value).reduce((best, item) => (distance(item) < distance(best) ? item : best));
  }

  function fill() {
    for (const key of keys) {
      const values = [...new Set(cases.map((item) => item[key]))], now = current()[key];
      if (NUMERIC.has(key)) values.sort((a, b) => parseFloat(a) - parseFloat(b));
      form.elements[key].replaceChildren(...values.map((value) => new Option(value, value, false, value === now)));
    }
    form.elements.x.value = state.x;
    form.elements.y.value = state.y;
  }

  function traces() {
    const item = current(), x = depths[item.depths];
    const look = (name) => ({ name: looks[name].label, legendgroup: name, marker: { symbol: MARKERS[looks[name].marker], size: 6 },
      mode: name === "elastic_solution" ? "markers" : "lines", line: { dash: DASHES[looks[name].line] },
      hovertemplate: "%{y:.4g}", visible: name === "elastic_solution" || SHOWN.includes(name) || "legendonly" });
    const coloured = (name) => {
      const trace = look(name);
      trace.marker.color = trace.line.color = looks[name].color;
      return trace;
    };
    const present = laws.filter((law) => item.laws[law]);
    return [{ ...coloured("elastic_solution"), x, y: item.force },
      ...present.map((law) => ({ ...coloured(law), x, y: item.laws[law] })),
      ...present.map((law) => ({ ...coloured(law), x, y: item.laws[law].map((force, k) => 100 * (force / item.force[k] - 1)),
        yaxis: "y2", showlegend: false, hovertemplate: "%{y:+.3g} %" }))];
  }

  function draw() {
    const item = current(), style = getComputedStyle(document.body), ink = style.color;
    const axis = { gridcolor: "rgba(128,128,128,0.25)", zerolinecolor: "rgba(128,128,128,0.6)", linecolor: ink };
    Plotly.react("chart", traces(), {
      uirevision: "kept", height: 720, margin: { l: 65, r: 10, t: 10, b: 50 }, hovermode: "x unified",
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: { color: ink },
      hoverlabel: { bgcolor: style.backgroundColor, font: { color: ink } }, legend: { orientation: "h", y: 1.02, yanchor: "bottom" },
      xaxis: { ...axis, type: state.x, anchor: "y2", title: { text: "penetration depth δ* = δ/ΔR" }, exponentformat: "power" },
      yaxis: { ...axis, type: state.y, domain: [0.48, 1], title: { text: "contact force P* = P/(E* ΔR²)" }, exponentformat: "power" },
      yaxis2: { ...axis, domain: [0, 0.42], title: { text: "relative error of the law, %" } },
    }, { responsive: true, displayModeBar: false });
    const facts = [["Case", item.name], ["Elastic solution", item.solver],
      ["Contact half-angle at the maximum depth", `${item.half_angle} degrees`],
      ["Estimated error of the force", `at most ${+item.error.toPrecision(3)} %`],
      ...laws.filter((law) => item.undefined[law]).map((law) => [`${looks[law].label} is not valid here`, item.undefined[law]])];
    document.getElementById("case").replaceChildren(...facts.flatMap((pair) => pair.map((text, k) => {
      const element = document.createElement(k ? "dd" : "dt");
      element.textContent = text;
      return element;
    })));
  }

  function open() {  // the view that the URL describes
    const given = new URLSearchParams(location.hash.slice(1)), asked = given.get("case");
    const known = cases.some((item) => item.name === asked);
    if (known) state.case = asked;
    for (const axis of ["x", "y"]) if (["linear", "log"].includes(given.get(axis))) state[axis] = given.get(axis);
    form.querySelector(".changed").textContent = asked && !known ? `There is no case ${asked}.` : "";
    fill();
    draw();
  }

  form.addEventListener("input", ({ target }) => {
    const before = current();
    if (keys.includes(target.name)) state.case = nearest(target.name, target.value).name;
    else state[target.name] = target.value;
    const after = current(), changed = keys.filter((key) => key !== target.name && before[key] !== after[key]);
    form.querySelector(".changed").textContent =
      changed.length ? `Also changed: ${changed.map((key) => `${parameters[key]} ${after[key]}`).join("; ")}` : "";
    history.replaceState(null, "", `#${new URLSearchParams(state)}`);
    fill();
    draw();
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  window.addEventListener("hashchange", open);
  new MutationObserver(draw).observe(document.body, { attributes: true, attributeFilter: ["data-theme"] });
  open();
})();
