"""Baselines: the steppers that EECA is compared with, with the interface of `..stepper.Stepper`.

In: a pymunk space. Out: a StepReport; that of `Native` has no contacts, and none has a ledger.

Open first `native.py`, pymunk's own solver. `penalty.py` has steppers with penalty springs and the energy-momentum
scheme that EECA enhances, `newmark.py` Newmark's rules on the same springs (paper, Table I).
"""
