"""The notebooks: what each makes and reads, and how one is executed with parameters.

This module holds the catalogue and the few checks that papermill does not make. What is stale
is decided in `study.pages.tasks`.
"""

import ast
import json
import os
import re
from dataclasses import dataclass

from study import checks, paths
from study.claims import verdicts
from study.contact import LAWS
from study.dataset import provenance
from study.pages import kept, tasks
from study.pages.execute import NotebookError

LONGEST = 1000  # setting, in characters
PARAMETERS_VARIABLE = "STUDY_PARAMETERS"  # hands parameters to notebooks/task_notebooks.py


@dataclass(frozen=True)
class Notebook:
    """A notebook and the results it makes.

    Attributes
    ----------
    name : str
        File name without suffix.
    figures, tables : dict
        Name of each figure and table -> what it shows.
    reads : tuple of str
        Results of other notebooks whose numbers it reads.
    """

    name: str
    figures: dict
    tables: dict
    reads: tuple = ()

    @property
    def path(self):
        """Where the notebook is."""
        return paths.NOTEBOOKS / f"{self.name}.ipynb"

    @property
    def executed(self):
        """Where the executed copy goes."""
        return paths.BUILD / "notebooks" / f"{self.name}.ipynb"

    @property
    def results(self):
        """Name of every figure and table -> what it shows."""
        return self.figures | self.tables

    def files(self):
        """File names of its results: a CSV each, and a PNG for a figure."""
        return [file for name in self.results for file in kept.files(name, name in self.figures)]

    def products(self):
        """Files it makes: those of its results, and its executed copy."""
        return [*(paths.FIGURES / name for name in self.files()), self.executed]

    def inputs(self):
        """Files it depends on: itself, the code it reaches by imports, and what they read."""
        read = [paths.FIGURES / f"{name}.csv" for name in self.reads]
        return [*provenance.inputs(self.path), *read]


CATALOGUE = (
    Notebook(
        "00-joint-and-foundations",
        {
            "fig01": "spherical clearance joint: radii and clearance",
            "fig02": "penetration depth, eccentricity and contact force",
            "fig03": "Hertz's pressure over the contact, and the exact one",
            "fig04": "flat Winkler foundation under a rigid profile",
            "fig05": "contact arc in the socket: radial and vertical pressure",
            "fig06": "circumferential Winkler foundation, and the laws' half-angles",
        },
        {},
    ),
    Notebook(
        "01-joint-and-mesh",
        {"fig08": "geometry and finite-element mesh of ball and socket"},
        {},
    ),
    Notebook(
        "02-coefficient-over-socket-radius",
        {
            "fig07": "procedure from cases to the surrogate of f1",
            "fig09": "coefficient f1 of the hyperbolic Winkler law over R2*, fits and surrogate",
        },
        {"table1": "agreement of the surrogate with the fits"},
    ),
    Notebook(
        "03-force-against-depth",
        {
            "fig10": "force against depth: finite elements and all laws, four ranges",
            "trend": "force, relative error, slope and exponent of all laws in the paper's joint",
        },
        {},
    ),
    Notebook(
        "04-agreement-of-the-laws",
        {"fig11": "R2, adjusted R2 and RMSE of all laws"},
        {
            "table2": "agreement of all laws with finite elements, as published and computed",
            "assumptions": "how much socket ratio, drive, rim and kinematics matter",
        },
    ),
    Notebook(
        "05-range-of-depth",
        {
            "fig12": "the hyperbolic Winkler law up to depth dR, and its relative error",
            "fig13": "map of its relative error over depth and socket radius",
        },
        {},
    ),
    Notebook(
        "06-range-of-socket-radius",
        {
            "fig14": "agreement of the hyperbolic Winkler law over R2*",
            "fig15": "its largest error over R2*, from 20 to 10,000",
        },
        {},
    ),
    Notebook(
        "07-crank-slider-and-its-parameters",
        {"fig16": "crank-slider with a clearance joint, lengths to scale"},
        {
            "table3": "geometry and masses of the crank-slider",
            "table4": "material, joint and drive of the crank-slider",
            "scene": "what the paper leaves out, and what is assumed instead",
        },
    ),
    Notebook(
        "08-motion-of-the-slider",
        {
            "fig17": "position of the slider, ideal and clearance joint",
            "fig18": "velocity of the slider, ideal and clearance joint",
            "fig19": "acceleration of the slider, ideal and clearance joint",
        },
        {"agreement": "how far particles, finite elements and rigid links agree"},
    ),
    Notebook(
        "09-force-and-path-in-the-joint",
        {
            "fig20": "force in the joint, ideal and clearance",
            "fig21": "path of the ball's centre in the clearance",
            "first_impacts": "the first 12 ms: depth, force and hysteresis of each impact",
        },
        {
            "impacts": "every impact of rigid links, particles and finite elements",
            "durations": "largest depth and force by duration and socket radius",
        },
    ),
    Notebook(
        "10-what-keeps-impacts-going",
        {"persistence": "when impacts happen, one assumption changed at a time"},
        {"variants": "impacts, last separation and lead, one assumption changed at a time"},
    ),
    Notebook(
        "11-convergence-of-the-models",
        {"convergence": "the flexible models towards each other and towards rigid links"},
        {},
    ),
    Notebook(
        "12-exact-series-and-kinematics",
        {
            "truth": "finite elements against the exact series, and what a free rim changes",
            "kinematics": "small, linear and finite kinematics over R2*",
        },
        {"accuracy": "the joint's forces against independent values"},
    ),
    Notebook(
        "13-what-the-paper-computed",
        {"identification": "which set-ups explain Table 2: ratio, drive, depths, area"},
        {
            "candidates": "every candidate with its misfit and likelihood",
            "definitions": "what other readings of R2 would give",
            "liu_forms": "forms that Liu's lost law may have",
        },
    ),
    Notebook(
        "14-where-the-laws-apply",
        {
            "reach_socket": "relative error of each law over depth and socket ratio",
            "reach_radius": "relative error of each law over depth and R2*",
            "reach_material": "relative error of the laws over Poisson's ratio and moduli",
        },
        {"reach": "largest relative error of each law, by range of depth"},
    ),
    Notebook(
        "15-stiffened-hertz",
        {"stiffening": "stiffening over Hertz: exact, fitted and tabulated"},
        {"judged": "error of stiffened_hertz on what it was fitted to and what it was not"},
    ),
    Notebook(
        "16-speed-against-accuracy",
        {
            "speed_laws": "cost of a call against error, every law and the direct solution",
            "speed_solvers": "time of a curve of 20 depths against error, ours and CalculiX",
            "speed_steppers": "time of 0.3 s of the mechanism against error, ours and others",
            "choice": "cheapest law that is accurate enough, over depth, R2* and socket ratio",
        },
        {
            "speed_winners": "fastest method at each level of accuracy",
            "choice_mechanism": "least model of the mechanism that is accurate enough",
        },
    ),
    Notebook(
        "17-where-explicit-steps-fail",
        {"stability_steps": "limits of explicit steps, predicted and observed"},
        {"limits_steps": "limits of steps, and how the software tells of them"},
    ),
    Notebook(
        "18-where-impacts-go-wrong",
        {"stability_impacts": "restitution delivered and asked for; how errors of impacts grow"},
        {"limits_impacts": "limits of impacts, and how the software tells of them"},
    ),
    Notebook(
        "19-where-the-contact-solver-fails",
        {"stability_contact": "the contact solver at its limits"},
        {"limits_contact": "limits of the contact solver, and how it tells of them"},
    ),
    Notebook(
        "20-where-the-laws-formulas-fail",
        {"stability_laws": "the laws' formulas at their limits"},
        {"stability_limits": "threshold of each failure, and how the software tells of it"},
        reads=("limits_steps", "limits_impacts", "limits_contact"),
    ),
    Notebook(
        "21-which-statements-hold",
        {"verdicts": "how many of the paper's statements hold, by part"},
        {"claims": "every checkable statement of the paper, judged by a stated rule"},
        reads=(
            *("table1", "table2", "trend", "fig06", "fig14", "durations", "fig15", "fig10"),
            *("assumptions", "reach_socket", "reach_material", "speed_solvers"),
            *("speed_laws", "fig17", "fig18", "fig19", "impacts"),
            *("fig20", "fig21", "stability_limits"),
        ),
    ),
)


def select(names):
    """Notebooks by their own names or by those of their results; all for no name.

    Parameters
    ----------
    names : sequence of str

    Returns
    -------
    list of Notebook
        In the order of the catalogue, each once.

    Raises
    ------
    ValueError
        For an unknown name; lists the known ones.
    """
    paths.require_checkout(paths.NOTEBOOKS)
    known = [name for nb in CATALOGUE for name in (nb.name, *nb.results)]
    for name in names:
        if name not in known:
            raise ValueError(f"NAME must be one of {', '.join(known)}, got {name!r}")
    wanted = set(names)
    return [nb for nb in CATALOGUE if not names or wanted & {nb.name, *nb.results}]


def check_claims():
    """Check the rows of ``data/published/claims.csv``, before anything runs for minutes.

    Raises
    ------
    study.claims.verdicts.ClaimError
        As for `study.claims.verdicts.load`, or for a figure or evidence that no notebook makes.
    """
    results = [name for notebook in CATALOGUE for name in notebook.results]
    for row in verdicts.load().itertuples():
        for name in (row.figure, *row.evidence.split()):
            if name not in results:
                raise verdicts.ClaimError(f"claim {row.claim}: no notebook makes {name!r}")


def parameters(notebook):
    """Parameters of a notebook with default value and comment, from its ``parameters`` cell.

    A comment ends with the values that are allowed, in brackets: ``[20 to 10000]`` for a number
    or each of a list, ``[linear, small]`` for a word, ``[a law]`` for those of ``study law``.

    Parameters
    ----------
    notebook : Notebook

    Returns
    -------
    dict
        Name -> (default, comment).
    """
    import papermill

    found = papermill.inspect_notebook(str(notebook.path))
    return {
        name: (ast.literal_eval(entry["default"]), entry["help"]) for name, entry in found.items()
    }


def check_parameters(notebooks, settings):
    """Turn ``key=value`` settings into parameters per notebook, before anything runs.

    Papermill itself only warns of an unknown parameter and runs the default.

    Parameters
    ----------
    notebooks : list of Notebook
    settings : list of str
        Each ``key=value``, the value a Python literal or a bare word.

    Returns
    -------
    dict
        Notebook name -> {parameter: value}; a notebook gets the parameters it has.

    Raises
    ------
    ValueError
        For a setting without ``=`` or too long, a parameter that no selected notebook has, or a
        value of another type than the default's or out of its range.
    """
    defaults = {nb.name: parameters(nb) for nb in notebooks} if settings else {}
    chosen = {nb.name: {} for nb in notebooks}
    for setting in settings:
        if len(setting) > LONGEST:
            raise ValueError(
                f"-p must have at most {LONGEST} characters, got {len(setting)}: {setting[:20]}..."
            )
        key, equals, text = setting.partition("=")
        if not equals:
            raise ValueError(f"-p must be key=value, got {setting!r}")
        owners = [name for name, known in defaults.items() if key in known]
        if not owners:
            known = sorted({k for keys in defaults.values() for k in keys})
            raise ValueError(f"parameter must be one of {', '.join(known)}, got {key!r}")
        try:
            value = ast.literal_eval(text)
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            value = text
        for name in owners:
            default, comment = defaults[name][key]
            chosen[name][key] = _as_default(key, value, default)
            _check_range(key, chosen[name][key], comment)
    return chosen


def _check_range(key, value, comment):
    """Refuse a value, or one of a list, outside what the parameter's comment allows."""
    allowed = re.search(r"\[([^][]*)\]$", comment)
    if allowed is None:
        return
    low, to, high = allowed[1].partition(" to ")
    for item in value if isinstance(value, list | tuple) else [value]:
        if to:
            checks.number(f"parameter {key}", item, least=float(low), most=float(high))
        else:
            names = LAWS if allowed[1] == "a law" else allowed[1].split(", ")
            checks.choice(f"parameter {key}", item, tuple(names))


def _as_default(key, value, default):
    """``value`` in the type of ``default``: a whole number may stand for a float."""
    if isinstance(default, float) and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    same = type(value) is type(default)
    if same and isinstance(default, (list, tuple)) and default:
        value = type(default)(_as_default(key, item, default[0]) for item in value)
    if not same:
        kind = type(default).__name__
        raise ValueError(f"parameter {key} must be of type {kind}, got {value!r}")
    return value


def compare(notebooks):
    """Compare the results of some notebooks, as made last, with the kept ones.

    Parameters
    ----------
    notebooks : list of Notebook

    Returns
    -------
    list of study.pages.kept.Comparison
        In the order of the catalogue.
    """
    return [
        kept.compare(name, name in notebook.figures, other)
        for notebook in notebooks
        for other in [_has_other_parameters(notebook)]
        for name in notebook.results
    ]


def _has_other_parameters(notebook):
    """Whether a notebook was executed last with parameters that are not its own."""
    if not notebook.executed.is_file():
        return False
    executed = json.loads(notebook.executed.read_text(encoding="utf-8"))
    return bool(executed["metadata"]["papermill"]["parameters"])


def run(notebooks, settings, report=False, **options):
    """Run the stale ones of some notebooks, and of those that they read from, as pytask tasks.

    Parameters
    ----------
    notebooks : list of Notebook
    settings : dict
        Parameters per notebook, from `check_parameters`.
    report : bool
        Write paper and report afterwards, for which all notebooks are run.
    **options
        As for `study.pages.tasks.build`.

    Returns
    -------
    pytask.Session
    """
    paths.require_checkout(paths.NOTEBOOKS)
    for notebook in notebooks:
        if not notebook.path.is_file():
            raise NotebookError(f"notebooks/{notebook.path.name} is missing")
        for product in notebook.products():
            if product.is_dir():
                raise NotebookError(
                    f"{product.relative_to(paths.ROOT)} must be a file, not a folder"
                )
    for product in (paths.BUILD / "paper.pdf", paths.BUILD / "report/index.html"):
        if report and product.is_dir():
            raise NotebookError(f"{product.relative_to(paths.ROOT)} must be a file, not a folder")
    os.environ[PARAMETERS_VARIABLE] = json.dumps(settings, sort_keys=True)
    if report:
        return tasks.build([paths.NOTEBOOKS, paths.PAPER], "task_report", **options)
    selected = " or ".join(f"[{nb.name}]" for nb in notebooks)
    return tasks.build([paths.NOTEBOOKS], selected, **options)
