"""What notebooks import, imported once by the process that kernels are forked from (`kernel`)."""

import os

from study import threads

os.environ |= threads.ONE
os.environ["MPLBACKEND"] = "module://matplotlib_inline.backend_inline"  # as in every kernel

import ipykernel.kernelapp
import ipykernel.zmqshell  # noqa: F401
import pandas.io.formats.style  # noqa: F401

import study.claims.identification
import study.mechanism
import study.pages.figures  # noqa: F401
