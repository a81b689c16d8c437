"""Closures: the paper's free choice of psi2, which says when in the step impulses act. One file each.

In: a world that was read anew. Out: the method that steps its arrays, with energy and momentum exact, and reports.

Open first `time_of_impact.py`, the default, and `midstep.py`: both hand over to compiled kernels. `dashpot.py`, the
paper's closure, moves lone disks on numpy arrays (`motion.py`: start, near pairs, motion); `simultaneous.py` is its
frame, one impulse for each contact of a step, `locked.py` restitution and the locked motion.
"""
