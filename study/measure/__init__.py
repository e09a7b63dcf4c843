"""Speed against accuracy, and where methods fail.

Other programs (`peers`) get the same equations and the same located events. SUNDIALS' CVODE is
called from a compiled C program too, so that compiled code is compared with compiled code. Other
integrators are called from Python; CalculiX and Exudyn have a contact of their own.
"""
