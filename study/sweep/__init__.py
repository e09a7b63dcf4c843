"""Parameter studies: many joints or scenes, on all cores, in one table."""

from study.sweep.cases import COLUMNS, random_cases
from study.sweep.run import Swept, run_study

__all__ = ["COLUMNS", "Swept", "random_cases", "run_study"]
