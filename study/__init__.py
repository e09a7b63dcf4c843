"""Contact force laws for spherical clearance joints: the study's shared library.

Elastic bodies give a compliance, a compliance and a gap give a force-depth curve
(`study.joint`), curves give the dataset (`study.dataset`), the dataset gives the laws
their coefficients (`study.dataset.fitting`, `study.contact`), and notebooks only show it.
"""
