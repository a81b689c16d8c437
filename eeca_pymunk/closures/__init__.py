"""Closures: the free choice of psi2 in the paper, which fixes the instant in the step at which impulses act.

In: a world that was just read. Out: the method that steps its arrays, with energy and momentum exact, and reports.

Open first `time_of_impact.py`, the default, and `midstep.py`: both only choose compiled kernels (`..impacts`,
`..jointed`). `dashpot.py`, the paper's closure, moves single disks on numpy arrays; `motion.py` (start, near pairs,
motion of a step) and `refusals.py` (unsupported features) are shared with `..baselines`. `simultaneous.py` is its step
with one impulse for each contact.
"""
