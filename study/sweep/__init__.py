"""Parameter studies: solve many joints, or simulate many mechanisms, and write one table."""

from study.sweep.cases import COLUMNS, random_cases
from study.sweep.run import Swept, run_study

__all__ = ["COLUMNS", "Swept", "random_cases", "run_study"]
