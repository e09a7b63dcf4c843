"""Runs of other programs for the charts of `study.measure.charts`: `others`.

``make speed`` times them in one process with the study's own methods, and keeps all times. The
programs are driven by ``other_programs``, beside this folder. They get the same equations and the
same located events. SUNDIALS' CVODE is called from a compiled C program too, so that compiled code
is compared with compiled code. Other integrators are called from Python; CalculiX and Exudyn have
a contact of their own. Nothing here imports pytest.
"""
