"""Banded matrices of beams."""

import numpy as np

from study.mechanism.beams import BAND


def dense(band):
    """The square matrix of a band."""
    size = len(band)
    full = np.zeros((size, size + 2 * BAND))
    for i in range(size):
        full[i, i : i + 2 * BAND + 1] = band[i]
    return full[:, BAND:-BAND]
