"""The report: complete, without links to the network, reproducible, and working in a browser."""

import base64
import csv
import html
import json
import os
import re
import shutil
import subprocess
import sys
from contextlib import suppress
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import nbformat
import pytest
from docutils.nodes import make_id
from helpers.programs import CHROMIUM
from nbformat import v4

from study import checks, dataset, paths
from study.checks import StudyError
from study.contact import COMPARED_LAWS
from study.joint import Joint
from study.pages import catalogue, execute, report
from study.pages.catalogue import CATALOGUE, results
from study.pages.report import pages as sources_of_pages
from study.pages.report.numbers import PARAMETERS, curves
from study.pages.report.pages import VERDICTS

pytestmark = pytest.mark.slow

SHOWN = tuple(catalogue.select(["trend", "claims", "fig10", "table2", "fig02", "judged"]))
RESULTS = {name: nb for nb in SHOWN for name in nb.results}
FIGURES = [result.name for result in results() if result.is_figure]
HOSTILE = 'A law with "quotes", <b>&amp; & </b></script><script>alert(1)</script>'
CLAIMS = [
    {"claim": f"claim_{k}", "where": "Sec. 3", "statement": f"Statement {k}", "measure": "error, %"}
    | {"kind": kind, "relation": "=", "expected": "1.5", "tolerance": "1", "found": "own: 1.4"}
    | {"lowest": "1.4", "highest": "1.4", "verdict": verdict, "figure": "fig10"}
    | {"evidence": "fig10 table2"}
    for k, (verdict, kind) in enumerate(
        zip([*VERDICTS, "reproduced"], ["stated"] * 3 + ["implied only"], strict=True)
    )
]
CLAIMS[0] |= {"statement": HOSTILE, "found": "<b>: 1; <i>: 2", "claim": "hostile <claim>"}
CLAIMS[3] |= {"claim": "crossing"}  # the catalogue names the number to expect of it
PROBED = "03-force-against-depth"
PDFS = ("paper.pdf", "supplement.pdf")


@pytest.fixture(scope="module")
def results_shown(tmp_path_factory):
    """Folder of results, a paper, and notebooks that were not run, but for two outputs."""
    folder = tmp_path_factory.mktemp("shown")
    figures, executed = folder / "figures", folder / "notebooks"
    figures.mkdir()
    executed.mkdir()
    for name in FIGURES:
        image = paths.FIGURES / f"{name}.png"
        shutil.copy(image if image.is_file() else paths.FIGURES / "fig09.png", figures / image.name)
    for name in (result.name for result in results()):
        numbers = paths.FIGURES / f"{name}.csv"
        if numbers.is_file():
            shutil.copy(numbers, figures)
        else:
            (figures / numbers.name).write_text("a,b\n1,x\n")
    with open(figures / "claims.csv", "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, CLAIMS[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(CLAIMS)
    for notebook in CATALOGUE:
        shutil.copy(notebook.path, executed)
    probed = nbformat.read(executed / f"{PROBED}.ipynb", as_version=4)
    image = base64.b64encode((figures / "fig10.png").read_bytes()).decode()
    text = "Within 1 % for $R_2^* \\ge 20$ at $$\\delta^{*3/2} = \\tfrac43\\sin\\theta$$"
    outputs = [v4.new_output("display_data", {"image/png": image})]
    outputs.append(v4.new_output("display_data", {"text/markdown": text}))
    probed.cells.append(v4.new_code_cell("x = 1", outputs=outputs))
    probed.metadata["papermill"] = {"output_path": str(paths.ROOT / "build")}
    nbformat.write(probed, executed / f"{PROBED}.ipynb")
    for name in PDFS:
        (folder / name).write_bytes(b"%PDF-1.4\n%%EOF\n")
    return folder


def show(patch, folder):
    """Let the report show the results of a folder."""
    patch.setattr(paths, "FIGURES", folder / "figures")
    patch.setattr(paths, "BUILD", folder)
    patch.setattr(sources_of_pages, "PDFS", [folder / name for name in PDFS])


PACKAGES = ("", "contact", "claims", "pages", "pages/report")
FEW = ("contact/laws", "claims/verdicts", "pages/report/pages")
IN_ANOTHER_PROCESS = """
import sys
from pathlib import Path
import pytest
import test_report
from study.pages import report
with pytest.MonkeyPatch.context() as patch:
    test_report.show_little(patch, Path(sys.argv[1]))
    report.build(Path(sys.argv[2]) / "sources", Path(sys.argv[2]) / "pages")
"""


def show_little(patch, folder):
    """Let the report show a few modules and notebooks only, as each takes long."""
    show(patch, folder)
    for module in (catalogue, sources_of_pages):
        patch.setattr(module, "CATALOGUE", SHOWN)
    library = paths.ROOT / "study"
    files = [*(library / name / "__init__.py" for name in PACKAGES)]
    files += [library / f"{name}.py" for name in FEW]
    patch.setattr(sources_of_pages, "modules", lambda: files)


@pytest.fixture(scope="module")
def twice(results_shown, tmp_path_factory):
    """Two small reports of processes that hash text otherwise."""
    folders, started = [tmp_path_factory.mktemp("small") for _ in range(2)], []
    for seed, folder in enumerate(folders):
        command = [sys.executable, "-c", IN_ANOTHER_PROCESS, str(results_shown), str(folder)]
        environment = os.environ | {"PYTHONHASHSEED": str(seed), "OMP_NUM_THREADS": "1"}
        searched = [paths.ROOT, paths.ROOT / "tests", paths.ROOT / "tests/pages"]
        environment["PYTHONPATH"] = os.pathsep.join(map(str, searched))
        started.append(subprocess.Popen(command, env=environment, cwd=paths.ROOT))
    assert [process.wait() for process in started] == [0, 0]
    return folders


@pytest.fixture(scope="module")
def built(twice):
    return twice[0] / "pages"


class Page(HTMLParser):
    """Anchors, links and loaded resources of a page."""

    def __init__(self, text):
        super().__init__()
        self.anchors, self.links, self.loaded, self.data = set(), [], [], {}
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.anchors.add(given.get("id"))
        self.data |= {k: v for k, v in given.items() if k.startswith("data-probe")}
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        elif tag in ("link", "script", "img", "iframe", "source", "object", "embed"):
            self.loaded += [given[k] for k in ("href", "src", "srcset", "data") if given.get(k)]
        self.loaded += re.findall(r"url\(['\"]?([^'\")]+)", given.get("style") or "")


@pytest.fixture(scope="module")
def pages(built):
    return {path: Page(path.read_text(encoding="utf-8")) for path in built.rglob("*.html")}


@pytest.fixture(scope="module")
def index(built):
    text = (built / "searchindex.js").read_text(encoding="utf-8")
    return json.loads(text.removeprefix("Search.setIndex(").removesuffix(")"))


def resolves(pages, page, link):
    path, _, place = link.partition("#")
    path = path.partition("?")[0]
    target = (page.parent / unquote(path)).resolve() if path else page
    if target.name == "data.html" and place.startswith("case="):
        return True  # a state of the plot
    return target.is_file() and (not place or unquote(place) in pages[target].anchors)


def test_every_link_leads_somewhere(pages):
    broken = [
        (str(page), link)
        for page, content in pages.items()
        for link in content.links + content.loaded
        if not link.startswith(("https://", "http://", "data:", "mailto:"))
        and not resolves(pages, page, link)
    ]
    assert not broken


def test_nothing_is_loaded_from_outside(built, pages):
    for page, content in pages.items():
        outside = [u for u in content.loaded if re.match(r"(\w+:)?//", u)]
        assert not outside, page
    for style in built.rglob("*.css"):
        text = style.read_text(encoding="utf-8")
        assert "@import" not in text
        assert not re.search(r"url\(['\"]?(\w+:)?//", text), style
    for script in ("dataset", "joint", "joint_page"):
        text = (built / f"_static/{script}.js").read_text(encoding="utf-8")
        assert not re.search(r"fetch\(|XMLHttp|import\(|innerHTML|https?://(?!www\.w3\.org/)", text)


def test_no_path_of_a_machine_and_no_date(built):
    for path in built.rglob("*"):
        if path.suffix in (".html", ".js", ".css"):
            text = path.read_text(encoding="utf-8")
            assert str(paths.ROOT) not in text, path
            assert str(Path.home()) + "/" not in text, path


def test_every_figure_and_table_has_its_page(built, pages):
    for name, notebook in RESULTS.items():
        page = pages[built / f"figures/{name}.html"]
        assert f"{name}.csv" in page.links
        assert (built / f"figures/{name}.csv").is_file()
        assert f"../notebooks/{notebook.name}.html" in page.links
        assert f"../figures/{name}.html" in pages[built / f"notebooks/{notebook.name}.html"].links
        assert f"figures/{name}.html" in pages[built / "figures.html"].links
        assert f"notebooks/{notebook.name}.html" in pages[built / "notebooks.html"].links
        assert f"figures/{name}.html" in pages[built / "results.html"].links
        if name in FIGURES:
            assert f"{name}.png" in page.links + page.loaded
            assert (built / f"figures/{name}.png").is_file()


def test_a_figure_tells_what_to_conclude_and_a_notebook_its_parameters(built):
    def text(page):
        return html.unescape((built / page).read_text(encoding="utf-8"))

    for notebook in SHOWN:
        for name, result in notebook.results.items():
            if result.is_figure:
                assert f'<p class="tells">{result.tells}</p>' in text(f"figures/{name}.html")
        page = text(f"notebooks/{notebook.name}.html")
        assert '<input type="checkbox" id="code">' in page  # the code is folded
        for key, (default, allowed, meaning) in execute.parameters(notebook).items():
            allowed = f" [{allowed}]" if allowed else ""
            assert f"<dt><code>{key}</code> = {default}{allowed}</dt><dd>{meaning}</dd>" in page


def test_one_table_has_every_result_with_a_number_to_expect(built):
    text = html.unescape((built / "results.html").read_text(encoding="utf-8"))
    for notebook in SHOWN:
        assert f'<a href="notebooks/{notebook.name}.html">' in text
        for name, result in notebook.results.items():
            assert f'<a href="figures/{name}.html">{result.label}</a>' in text
            assert result.shows in text
            assert result.tells in text
    assert "<code>elastic_solution = 203.6 at depth_star = 0.5</code>" in text


def test_statements_are_counted_once_by_kind(built):
    """As README counts them: verdicts of the stated ones alone."""
    counted = "3 statements of the paper: 1 reproduced, 1 undecided, 1 contradicted."
    for page in ("index.html", "evidence.html", "statements.html"):
        text = " ".join(re.sub("<[^>]+>", "", (built / page).read_text("utf-8")).split())
        assert counted in text
        assert "not counted: assumptions that the paper only implies (1 reproduced)." in text


def test_every_claim_is_shown_and_escaped(built, pages):
    text = (built / "statements.html").read_text(encoding="utf-8")
    assert "claim-hostile-claim" in pages[built / "statements.html"].anchors
    for claim in CLAIMS[1:]:
        anchor = make_id(f"claim-{claim['claim']}")
        assert anchor in pages[built / "statements.html"].anchors
        assert claim["statement"] in text
        assert f"../statements.html#{anchor}" in pages[built / "figures/fig10.html"].links
    for verdict, sign in VERDICTS.items():
        assert f'aria-hidden="true">{sign}</span> {verdict}' in text
    for page in ("statements.html", "figures/fig10.html"):
        text = (built / page).read_text(encoding="utf-8")
        assert "<b>&amp;" not in text
        assert "<script>alert" not in text
        assert "&lt;b&gt;&amp;amp; &amp; &lt;/b&gt;&lt;/script&gt;" in text


def test_search_knows_every_kind(index, pages, built):
    """Each place it names is there."""
    found = {}
    for prefix, items in index["objects"].items():
        for page, kind, _, anchor, name in items:
            title = f"{prefix}.{name}" if prefix else name
            kind = index["objnames"][str(kind)][1]
            found.setdefault(kind, []).append(title)
            anchor = {"": title, "-": f"{kind}-{title}"}.get(anchor, anchor)
            link = f"{index['docnames'][page]}.html#{anchor}"
            assert resolves(pages, built / "start", link), link
    assert found.keys() >= {"claim", "figure", "table", "case", "function", "class", "module"}
    assert "claim_1: Statement 1" in found["claim"]
    assert len(found["case"]) == len(set(dataset.load().case))


def test_formulas_become_mathml(built):
    text = (built / f"notebooks/{PROBED}.html").read_text(encoding="utf-8")
    assert 'display="block"' in text
    assert "$$" not in text
    assert re.search(
        r'href="../figures/fig10.html" aria-label="[^"]+"><img src="../figures/fig', text
    )
    assert "data:image/png" not in text
    for page in (built / "notebooks").glob("*.html"):
        for formula in re.findall(r"<math.*?</math>", page.read_text("utf-8"), re.DOTALL):
            assert "\\" not in formula, page  # a command that was not understood


def test_data_hold_every_case_and_law(built):
    text = (built / "data.js").read_text(encoding="utf-8")
    assert len(text) < 2e6
    data = json.loads(text.removeprefix("window.STUDY_DATA=").removesuffix(";\n"))
    assert list(data["looks"]) == ["elastic_solution", *COMPARED_LAWS]
    for case in data["cases"]:
        assert set(case["laws"]) | set(case["undefined"]) == set(COMPARED_LAWS)
        for force in (case["force"], *case["laws"].values()):
            assert len(force) == len(data["depths"][case["depths"]])
    by_name = {case["name"]: case for case in data["cases"]}
    assert "layers" in by_name["ptfe-steel-linear-80"]["undefined"]["stiffened_hertz"]
    paper = by_name["paper-linear-200"]
    assert paper["laws"]["stiffened_hertz"] == pytest.approx(paper["force"], rel=0.005)


def test_same_sources_give_the_same_bytes(twice):
    first, second = (
        {
            path.relative_to(top): path.read_bytes()
            for part in ("sources", "pages")
            for path in (top / part).rglob("*.*")
        }
        for top in twice
    )
    assert first.keys() == second.keys()
    assert f"pages/api/study.{FEW[0].replace('/', '.')}.html" in map(str, first)
    assert not [path for path in first if first[path] != second[path]]


def test_what_sphinx_warns_of_is_one_clear_error_and_leaves_the_report(tmp_path, monkeypatch):
    (tmp_path / "report").mkdir()
    (tmp_path / "report/index.html").write_text("old")

    def write_one_page(sources, pages):
        (Path(sources) / "index.md").write_text("# One page\n\nSee {doc}`nowhere`.\n")
        return []

    monkeypatch.setattr(sources_of_pages, "write", write_one_page)
    with pytest.raises(StudyError, match=r"^the report: index\S+ WARNING.*nowhere"):
        report.write(tmp_path / "report")
    assert (tmp_path / "report/index.html").read_text() == "old"


# ---- in a browser ----

FLAGS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
    *("--virtual-time-budget=5000", "--enable-logging=stderr"),
)


@pytest.fixture
def browse(built, tmp_path):
    """Document of a page after it, and a script at its end, have run; fails on console errors."""
    if CHROMIUM is None:
        pytest.skip("no Chromium found")

    def browse(name, script="", place="", width=1200):
        page = probe = built / name
        if script:
            probe = page.with_name("probe.html")
            script = f"<script>window.addEventListener('load', () => {{ {script} }});</script>"
            text = page.read_text(encoding="utf-8").replace("</body>", f"{script}</body>")
            probe.write_text(text, encoding="utf-8")
        options = (f"--window-size={width},1000", f"--user-data-dir={tmp_path / 'profile'}")
        command = [CHROMIUM, *FLAGS, *options, "--dump-dom", probe.as_uri() + place]
        try:
            done = subprocess.run(command, capture_output=True, text=True)
        finally:
            if script:
                probe.unlink()
        errors = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
        assert not errors
        return done.stdout

    return browse


@pytest.mark.parametrize(
    "name",
    ["index.html", f"notebooks/{PROBED}.html", "joint.html", "statements.html", "data.html"],
)
def test_pages_load_without_errors(browse, name):
    assert "</article>" in browse(name)


TELL = "const tell = (value) => { document.body.dataset.probe = JSON.stringify(value); };"
PLOT = """const chart = document.getElementById("chart"), form = document.getElementById("plot");
const choose = (name, value) => { form.elements[name].value = value;
  form.elements[name].dispatchEvent(new Event("input", { bubbles: true })); };
"""


def told(document):
    return json.loads(Page(document).data["data-probe"])


def test_the_chart_has_the_numbers_of_the_case_that_is_chosen(browse):
    script = """
    choose("r2_star", "20");
    choose("y", "log");
    const traces = chart.data.map((of) =>
      ({ name: of.name, x: [...of.x], y: [...of.y], yaxis: of.yaxis }));
    const drawn = document.querySelectorAll("#chart .scatterlayer .trace").length;
    tell({ traces, drawn, type: chart.layout.yaxis.type, late: location.hash });
    """
    found = told(browse("data.html", TELL + PLOT + script, "#case=paper-linear-200"))
    shown = curves()
    (case,) = (case for case in shown["cases"] if case["name"] == "paper-linear-20")
    labels = {look["label"]: name for name, look in shown["looks"].items()}
    solved, *others = found["traces"]
    assert (solved["x"], solved["y"]) == ([*shown["depths"][case["depths"]]], case["force"])
    laws = {labels[of["name"]]: of["y"] for of in others if of.get("yaxis") != "y2"}
    assert laws == case["laws"]
    errors = {labels[of["name"]]: of["y"] for of in others if of.get("yaxis") == "y2"}
    for law, force in laws.items():
        off = [100 * (f / solved["y"][k] - 1) for k, f in enumerate(force)]
        assert errors[law] == pytest.approx(off)
    assert found["drawn"] == 1 + 2 * 3  # the elastic solution, and forces and errors of three laws
    assert (found["type"], found["late"]) == ("log", "#case=paper-linear-20&x=linear&y=log")


def test_a_choice_shows_a_curve(browse):
    script = """
    let count = 0, drawn = null;
    const empty = [];
    Plotly.react = (_, traces) => { drawn = traces; };  // which takes longer than the choice
    for (const key of Object.keys(window.STUDY_DATA.parameters))
      for (const value of [...form.elements[key].options].map((option) => option.value).slice(-3)) {
        choose(key, value);
        count++;
        if (form.elements[key].value !== value || !drawn[0].y.every(Number.isFinite))
          empty.push([key, value]);
      }
    tell([count, empty]);
    """
    count, empty = told(browse("data.html", TELL + PLOT + script))
    cases = curves()["cases"]
    assert count == sum(min(3, len({case[key] for case in cases})) for key in PARAMETERS)
    assert empty == []


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("statement 1", "statements.html#claim-claim-1"),
        ("paper-linear-200", "data.html#case=paper-linear-200"),
    ],
)
def test_search_finds(browse, words, found):
    document = browse("search.html", place=f"?q={words.replace(' ', '+')}")
    assert f'href="{found}"' in document


@pytest.mark.parametrize("name", ["index.html", "joint.html", "statements.html", "data.html"])
def test_pages_fit_a_small_screen(browse, name):
    """Wide tables scroll in their own boxes."""
    script = "tell(document.documentElement.scrollWidth);"
    assert told(browse(name, TELL + script, width=500)) <= 500


def test_claims_are_filtered_by_verdict(browse):
    script = """
    const shown = () => [...document.querySelectorAll("tr.claim")]
      .filter((row) => row.getClientRects().length).length;
    const counts = [shown()];
    for (const radio of document.querySelectorAll("[name=verdict]")) {
      radio.click();
      counts.push(shown());
    }
    tell(counts);
    """
    assert told(browse("statements.html", TELL + script)) == [4, 4, 1, 1, 1]


FORM = """
const form = document.getElementById("joint"), text = (id) => document.getElementById(id).innerText;
const choose = (name, value) => { form.elements[name].value = value;
  form.elements[name].dispatchEvent(new Event("input", { bubbles: true })); };
const refused = () => form.querySelector(".message").innerText;
"""


def test_a_joint_follows_its_form_and_the_address_follows_it(browse):
    script = """
    const found = { first: text("results"), copied: text("texts") };
    choose("socket", "");
    found.same = text("results");
    choose("given", "depth");
    found.depth = form.elements.value.value;
    choose("ball_support", "clamped");
    found.clamped = text("results");
    choose("value", "50");
    found.refused = refused();
    choose("value", "35");
    found.drawn = document.querySelectorAll("#curve .scatterlayer .trace").length;
    const wall = form.elements.wall_mm.value;
    choose("wall_mm", "1");
    found.thin = refused();
    choose("wall_mm", wall);
    setTimeout(() => tell({ ...found, address: location.hash }), 1000);
    """
    found = told(browse("joint.html", TELL + FORM + script))
    assert "4.233 µm, or 0.1058 clearances" in found["first"]

    def parsed(command):
        """Words of a command, with numbers in SI units."""
        words = command.split()
        for k, word in enumerate(words):
            for unit in ("m", "N"):
                with suppress(ValueError):
                    words[k] = checks.read("number", word, unit=unit)
        return words

    readme = (paths.ROOT / "README.md").read_text(encoding="utf-8")
    for command in ("study export --law stiffened_hertz .*", "study joint --socket-radius .*"):
        (line,) = re.findall(rf"^{command}$", readme, re.MULTILINE)
        (copied,) = re.findall(rf"^{command}$", found["copied"], re.MULTILINE)
        copied = copied.removesuffix(" Copy").replace(' --ball "bearing steel"', "")
        assert parsed(copied) == parsed(line)
    assert found["same"] == found["first"]
    sizes = {"socket_radius": 12.5e-3, "clearance": 40e-6, "wall": 6e-3, "socket": "bronze"}
    depth = Joint(**sizes).law("stiffened_hertz").depth(3000)
    assert found["depth"] == f"{1e6 * depth:.6g}"
    assert found["clamped"] != found["first"]
    beyond = "Value: depth of stiffened_hertz must be <= 4e-05 m, got 5e-05 m"
    assert found["refused"].startswith(beyond)
    assert found["thin"].startswith("Wall of the socket, mm: socket_ratio of stiffened_hertz must")
    assert found["drawn"] == 4
    assert "socket=&socket_youngs_modulus_GPa=110&socket_poisson=0.34" in found["address"]
    assert "ball_support=clamped" in found["address"]


def test_an_address_opens_its_joint_and_its_text_stays_text(browse):
    place = "#clearance_um=100&ball=cast+iron&rim=free&given=depth&value=50&socket=&"
    place += "socket_youngs_modulus_GPa=1&socket_poisson=0.4&socket_yield_stress_MPa=20"
    script = "tell([text('results'), text('texts'), form.elements.value.value, refused()]);"
    results, texts, value, refused = told(browse("joint.html", TELL + FORM + script, place))
    assert "50 µm, or 0.5 clearances" in results
    assert '--ball "cast iron" --socket 1000000000,0.4,20000000 --rim free --depth 0.00005' in texts
    assert (value, refused) == ("50", "")
    place = "#ball_support=%3Cimg%20src%3Dx%20onerror%3Dalert(1)%3E"
    script = "tell([refused(), document.querySelectorAll('form img').length]);"
    refused, images = told(browse("joint.html", TELL + FORM + script, place))
    assert "must be one of guided, clamped, got ''" in refused
    assert images == 0
