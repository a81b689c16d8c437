"""Closures: the paper's free choice of psi2, which says when in the step impulses act. One file each.

In: the bodies at the start of a step and the pairs that may meet (`motion.py`). Out: how the bodies moved, with energy
and momentum exact, and the report of the step.

Open first `time_of_impact.py`, the default. `simultaneous.py` is the frame of the two closures that solve all contacts
of a step at once, `midstep.py` and `dashpot.py`; `locked.py` is what those share: restitution and the locked motion.
"""
