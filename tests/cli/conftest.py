"""What tests of several commands share."""

import sys

import pytest


@pytest.fixture
def on_a_terminal(run, monkeypatch):
    """What a command prints on a terminal of 80 columns, as lines."""

    def printed(*words):
        with monkeypatch.context() as patch:
            patch.setenv("COLUMNS", "80")
            patch.setattr(sys.stdout, "isatty", lambda: True)
            status, out, err = run(*words)
        assert (status, err) == (0, "")
        return out.splitlines()

    return printed
