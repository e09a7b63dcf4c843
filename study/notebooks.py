"""The notebooks: what each makes and reads, and how one is executed with parameters.

This module holds the catalogue and the few checks that papermill does not make. What is stale
is decided in `study.tasks`.
"""

import ast
import json
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path

from study import claims, contact, dataset, paths, tasks
from study.checks import StudyError

PARAMETERS_VARIABLE = "STUDY_PARAMETERS"  # hands parameters to notebooks/task_notebooks.py


class NotebookError(StudyError):
    """A cell of a notebook failed; the message names notebook, cell and error."""


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

    def products(self):
        """Files it makes: a PNG and a CSV per figure, a CSV per table, and its executed copy."""
        images = [paths.FIGURES / f"{name}.png" for name in self.figures]
        numbers = [paths.FIGURES / f"{name}.csv" for name in self.results]
        return [*images, *numbers, self.executed]

    def inputs(self):
        """Files it depends on: itself, the library but for the command line, and the data."""
        after = {"cli.py", "typeset.py", "report"}  # what comes after the notebooks
        names = ["tables", "joint", "peers"]
        if "claims" in self.tables:
            names.append("claims")
        else:
            after |= {"claims.py", "rules.py"}
        library = sorted((paths.ROOT / "study").rglob("*.py"))
        library = [path for path in library if not after & {path.name, path.parent.name}]
        published = [paths.DATA / f"published/{name}.csv" for name in names]
        data = [dataset.CURVES, dataset.LINKS, *published, contact.laws.COEFFICIENTS]
        read = [paths.FIGURES / f"{name}.csv" for name in self.reads]
        return [self.path, *library, *data, *read]


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
        "17-where-methods-fail",
        {
            "stability_steps": "limits of explicit steps, predicted and observed",
            "stability_impacts": "restitution delivered and asked for; how errors of impacts grow",
            "stability_contact": "the contact solver at its limits",
            "stability_laws": "the laws' formulas at their limits",
        },
        {"stability_limits": "threshold of each failure, and how the software tells of it"},
    ),
    Notebook(
        "18-which-statements-hold",
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
    study.claims.ClaimError
        As for `study.claims.load`, or for a figure or evidence that no notebook makes.
    """
    results = [name for notebook in CATALOGUE for name in notebook.results]
    for row in claims.load().itertuples():
        for name in (row.figure, *row.evidence.split()):
            if name not in results:
                raise claims.ClaimError(f"claim {row.claim}: no notebook makes {name!r}")


def parameters(notebook):
    """Parameters of a notebook with their default values, from its ``parameters`` cell.

    Parameters
    ----------
    notebook : Notebook

    Returns
    -------
    dict
    """
    import papermill

    found = papermill.inspect_notebook(str(notebook.path))
    return {name: ast.literal_eval(entry["default"]) for name, entry in found.items()}


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
        For a setting without ``=``, a parameter that no selected notebook has, or a value of
        another type than the default's.
    """
    defaults = {nb.name: parameters(nb) for nb in notebooks} if settings else {}
    chosen = {nb.name: {} for nb in notebooks}
    for setting in settings:
        key, equals, text = setting.partition("=")
        if not equals:
            raise ValueError(f"-p must be key=value, got {setting!r}")
        owners = [name for name, known in defaults.items() if key in known]
        if not owners:
            known = sorted({k for keys in defaults.values() for k in keys})
            raise ValueError(f"parameter must be one of {', '.join(known)}, got {key!r}")
        try:
            value = ast.literal_eval(text)
        except (SyntaxError, ValueError):
            value = text
        for name in owners:
            chosen[name][key] = _as_default(key, value, defaults[name][key])
    return chosen


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


def execute(notebook, settings):
    """Execute one notebook with papermill; its executed copy lands in ``build/notebooks``.

    Figures and tables reach ``figures/`` only if every cell succeeds. The kernel talks through
    sockets in a folder of its own, so that kernels started at the same time cannot take each
    other's ports.

    Parameters
    ----------
    notebook : Notebook
    settings : dict
        Values for its parameters.

    Raises
    ------
    NotebookError
        If a cell fails; names notebook, cell and error.
    """
    import nbformat
    import papermill
    from traitlets.config import Config

    notebook.executed.parent.mkdir(parents=True, exist_ok=True)
    with (
        tempfile.TemporaryDirectory(prefix="kernel-", ignore_cleanup_errors=True) as folder,
        tempfile.TemporaryDirectory(prefix="results-", dir=paths.BUILD) as results,
    ):
        os.environ[paths.RESULTS_VARIABLE] = results
        # kernels run side by side: with threads of their own they would wait for each other
        os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        config = Config()
        if os.name == "posix":
            config.KernelManager.transport = "ipc"
            config.KernelManager.ip = str(Path(folder, "socket"))
        try:
            papermill.execute_notebook(
                notebook.path,
                notebook.executed,
                parameters=settings,
                kernel_name="python3",
                progress_bar=False,
                cwd=folder,
                config=config,
            )
        except papermill.PapermillExecutionError as error:
            cell = f"cell In[{error.exec_count}]"
            raise NotebookError(f"{notebook.name}, {cell}: {error.ename}: {error.evalue}") from None
        except nbformat.reader.NotJSONError:
            raise NotebookError(f"{notebook.name}: the file is no notebook") from None
        for result in sorted(Path(results).iterdir()):
            result.replace(paths.FIGURES / result.name)


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
        As for `study.tasks.build`.

    Returns
    -------
    pytask.Session
    """
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
