"""``python -m study.cli``, as the program ``study``."""

from study.cli import main

main()
