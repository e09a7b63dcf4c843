"""What is timed: the charts of `study measure`, and what the ``bench_*.py`` files share.

The other programs of the charts are in ``other_programs``, beside this folder. They get the same
equations and the same located events. SUNDIALS' CVODE is called from a compiled C program too, so
that compiled code is compared with compiled code. Other integrators are called from Python;
CalculiX and Exudyn have a contact of their own. Nothing here imports pytest.
"""
