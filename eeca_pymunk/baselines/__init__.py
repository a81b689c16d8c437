"""Baselines: the steppers that EECA is compared with, behind the same contract.

In: a pymunk space. Out: the same report as every stepper's.

Open first `native.py`, pymunk's own solver. `penalty.py` has the steppers on penalty springs and the energy-momentum
scheme that EECA enhances, `newmark.py` Newmark's rules on the same springs (paper, Table I).
"""
