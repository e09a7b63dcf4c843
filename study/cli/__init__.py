"""The command line, study: notebooks, paper, report, dataset, laws, joints and simulations.

Wrong input is reported in one line on standard error, with exit status 2. Other failures have exit
status 1.
"""

import re
import sys
from difflib import get_close_matches
from pathlib import Path

import typer
from typer.main import get_group

from study import checks, paths
from study.cli.options import INTERRUPTED, InterruptionError, app

_LISTED = re.compile(r"\bone of (?P<known>.+), got '(?P<asked>[^'=]+)[^']*'$")
_LISTED_BY_TYPER = re.compile(r"'(?P<asked>[^']+)' is not one of (?P<known>.+)\.$")
UsageError = typer.BadParameter.__base__  # of every wrong option or argument


def main():
    """Run the command line and exit with its status."""
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="replace")  # a line with "?" is better than none
    try:
        _refuse_copied_program()
        status = get_group(app)(standalone_mode=False)
    except (UsageError, ValueError) as error:
        text = error.format_message() if isinstance(error, UsageError) else str(error)
        if text.startswith("Usage:"):  # a command group alone: its help is the answer
            print(text, file=sys.stderr)
            sys.exit(2)
        _complain(_hinted(text), 2)
    except checks.StudyError as error:
        _complain(str(error), 1)
    except OSError as error:  # its own text begins with a number
        _complain(f"{error.filename}: {error.strerror}" if error.filename else str(error), 1)
    except MemoryError as error:
        _complain(f"there is not enough memory: {error}".rstrip(": "), 1)
    except InterruptionError as kept:
        _complain(f"interrupted{kept}", INTERRUPTED)
    if status == INTERRUPTED:  # before a command began
        _complain("interrupted", status)
    sys.exit(status or 0)


def _refuse_copied_program():
    """Raise an error in a copied checkout, where the program would build the original folder."""
    for copied in Path(sys.argv[0]).resolve().parents[2:3]:  # above .venv/bin
        if copied != paths.ROOT and (copied / "study/paths.py").is_file():
            raise checks.StudyError(
                f"the folder {copied} is a copy whose environment belongs to {paths.ROOT}; create "
                "a new environment with: make setup"
            )


def _hinted(text):
    """A message with the most similar of the names that it lists, if one is similar."""
    found = _LISTED.search(text) or _LISTED_BY_TYPER.search(text)
    if found is None:
        return text
    known = [name.strip("'") for name in found["known"].split(", ")]
    near = get_close_matches(found["asked"], known, 1)
    return f"{text.rstrip('.')}: did you mean {near[0]}?" if near else text


def _complain(text, status):
    print(f"study: {' '.join(text.split())}", file=sys.stderr)
    sys.exit(status)
