// The search box of every page: all words of the question must occur; titles count more.
"use strict";
(() => {
  const root = document.currentScript.dataset.root;
  const input = document.getElementById("search"), list = document.getElementById("found");
  const MOST = 30;
  let index = null;

  const flat = (text) => text.toLowerCase().replaceAll("_", " ");
  const element = (name, text, className = "") =>
    Object.assign(document.createElement(name), { textContent: text, className });

  function load() {
    if (index) return;
    index = [];
    const script = document.createElement("script");
    script.src = root + "search-index.js";
    script.onload = () => {
      index = window.SEARCH_INDEX.map((entry) => ({
        ...entry, heading: flat(entry.title), all: flat(entry.title + " " + entry.text),
      }));
      show();
    };
    document.head.append(script);
  }

  // 4 for a title that is the question, 3 where one of its words starts so, 2 inside, 1 in the text
  function rank(entry, words) {
    let sum = entry.heading === words.join(" ") ? 4 : 0;
    for (const word of words) {
      if (!entry.all.includes(word)) return 0;
      const at = entry.heading.indexOf(word);
      sum += at < 0 ? 1 : at === 0 || !/[\p{L}\p{N}]/u.test(entry.heading[at - 1]) ? 3 : 2;
    }
    return sum - (entry.kind === "case" ? 0.5 : 0);
  }

  function excerpt(entry, words) {
    const at = Math.max(0, ...words.map((word) => flat(entry.text).indexOf(word)));
    const start = at > 50 ? entry.text.lastIndexOf(" ", at - 50) + 1 : 0;
    return (start ? "… " : "") + entry.text.slice(start, start + 140) + (entry.text.length > start + 140 ? " …" : "");
  }

  function show() {
    const words = flat(input.value).split(/\s+/).filter(Boolean);
    const found = words.length
      ? index.map((entry) => [rank(entry, words), entry]).filter(([score]) => score > 0) : [];
    found.sort((a, b) => b[0] - a[0]);
    list.replaceChildren(...found.slice(0, MOST).map(([, entry]) => {
      const item = element("li", ""), link = element("a", "");
      link.href = root + entry.url;
      link.append(element("span", entry.kind, "kind"), element("b", entry.title),
        element("small", excerpt(entry, words)));
      link.addEventListener("click", close);
      item.append(link);
      return item;
    }));
    if (words.length && !found.length) list.append(element("li", "Nothing has all of these words."));
    if (found.length > MOST) list.append(element("li", `${found.length - MOST} more: add a word.`));
    list.hidden = !words.length;
    input.setAttribute("aria-expanded", String(!list.hidden));
  }

  function close() {
    list.hidden = true;
    input.setAttribute("aria-expanded", "false");
  }

  input.addEventListener("focus", load);
  input.addEventListener("input", () => { load(); show(); });
  input.form.addEventListener("submit", (event) => {
    event.preventDefault();
    list.querySelector("a")?.click();
  });
  input.form.addEventListener("keydown", (event) => {
    const links = [...list.querySelectorAll("a")], at = links.indexOf(document.activeElement);
    if (event.key === "Escape") { close(); input.blur(); }
    if (event.key !== "ArrowDown" && event.key !== "ArrowUp") return;
    event.preventDefault();
    (links[at + (event.key === "ArrowDown" ? 1 : -1)] ?? (at > 0 ? links.at(-1) : input)).focus();
  });
  document.addEventListener("keydown", (event) => {
    if (event.key !== "/" || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.closest("input:not([type=radio]):not([type=checkbox]), select, textarea")) return;
    event.preventDefault();
    input.focus();
    input.select();
  });
  document.addEventListener("click", (event) => { if (!input.form.contains(event.target)) close(); });
})();
