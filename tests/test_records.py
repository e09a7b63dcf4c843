"""The records of the study are what is made from the catalogue and the kept results."""

from dataclasses import replace

import pytest

from study import paths
from study.checks import StudyError
from study.pages import records
from study.pages.catalogue import CATALOGUE
from study.pages.report.results import results

RESULTS = {result.name: result for result in results(paths.FIGURES)}


def test_reproducing_is_what_is_made():
    seconds = records.kept_seconds()
    assert list(seconds) == [notebook.name for notebook in CATALOGUE]
    assert records.REPRODUCING.read_text(encoding="utf-8") == records.reproducing(seconds)


def test_what_is_expected_is_one_number_of_the_result():
    assert records.expected(RESULTS["table4"]) == "`value` = 0.5 at parameter = restitution"
    assert records.expected(RESULTS["fig08"]) == "10160 rows"
    assert all(notebook.expect.keys() <= notebook.results.keys() for notebook in CATALOGUE)


@pytest.mark.parametrize(
    "text", ["value", "value at parameter = rest", "mass at parameter = restitution"]
)
def test_what_names_no_number_is_told(text):
    notebook = replace(RESULTS["table4"].notebook, expect={"table4": text})
    with pytest.raises(StudyError, match=r"catalogue\.toml: table4 must .*, got '" + text):
        records.expected(replace(RESULTS["table4"], notebook=notebook))
