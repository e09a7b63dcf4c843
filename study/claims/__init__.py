"""Verdicts on the statements of the paper, and the reconstruction of its Table 2."""
