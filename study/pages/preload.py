"""What notebooks import, imported once by the process that kernels are forked from (`kernel`)."""

import os

# kernels run side by side: their own threads would wait for each other
os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
os.environ["MPLBACKEND"] = "module://matplotlib_inline.backend_inline"  # as in every kernel

import ipykernel.kernelapp
import ipykernel.zmqshell  # noqa: F401
import pandas.io.formats.style  # noqa: F401

import study.claims.identification
import study.mechanism
import study.pages.figures  # noqa: F401
