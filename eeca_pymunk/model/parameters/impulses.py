"""Impulses of many contacts at one instant: residuals, budgets, proximal terms."""

from __future__ import annotations

from .record import accuracy, heuristic, round_off, work

# fmt: off
SINGULAR = round_off(1e-12, "of the product of its diagonal",
    "Determinant of a contact's 2 x 2 matrix below which normal and tangential impulse are not solved together.")
JAMMED = round_off(1e-09, "of A_nn", "Mobility along the impulse of a slipping contact below which it jams.")
ARM_ROUND_OFF = round_off(1e-15, "of the point's coordinates", "Arm of a normal impulse that is 0.")
ON_CONE = round_off(1e-12, "of the largest friction",
    "Friction nearer than this to the edge of its cone counts as that of slip.")
WEDGED = heuristic(0.01, "of |a| h, or of the approach speed of an impact",
    "Velocity that a solve leaves, or part of its impulses that the energy lock takes, from which on contacts count "
    "as wedged: without friction.")
ON_CONE_SWEPT = round_off(1e-9, "of the largest friction", "The same at the start of a homotopy, after sweeps.")
FACTOR_LEAST = round_off(0.001, "of a body's inertia",
    "Pivot of sparse factors, at least; it is 1 or more in exact arithmetic.")
PROXIMAL_DENSE = round_off(100000000.0, "over the effective mass",
    "Stiffness of the proximal term that makes redundant contacts solvable with dense factors.")
PROXIMAL_STATICS = round_off(100000000000.0, "over the effective mass",
    "Stiffness of the proximal term in the search for static forces with sparse factors.")
FACE_LINE = accuracy(1e-06, "of a face's length",
    "Distance from one tangent line up to which the two points of a face share their friction.")
BLOCK_RESIDUAL = accuracy(1e-14, "of the approach speed", "Residual of simultaneous impacts without friction.")
BLOCK_RESIDUAL_FRICTION = accuracy(1e-10, "of the approach speed",
    "Residual of simultaneous impacts with friction, which minimise no energy.")
RATE_ROUND_OFF = round_off(2.3e-16, "of the terms of a contact's velocity",
    "Residual of simultaneous impacts that always suffices.")
BLOCK_SWEEPS = work(12, "sweeps", "Sweeps of a simultaneous impact before the first direct solution.")
BLOCK_SWEEPS_FRICTION = work(100, "sweeps",
    "Sweeps before the first direct solution of a simultaneous impact with friction.")
BLOCK_SWEEPS_AFTER = work(3, "sweeps", "Sweeps after each direct solution of a simultaneous impact.")
BLOCK_DIRECT = work(40, "direct solutions", "Direct solutions of a simultaneous impact, at most.")
BLOCK_DIRECT_FRICTION = work(8, "direct solutions", "Direct solutions of a simultaneous impact with friction, at most.")
BLOCK_PROGRESS = work(0.5, "ratio of residuals", "Progress of a direct solution and its sweeps that is enough.")
BLOCK_STALLS = work(8, "direct solutions", "Direct solutions without such progress after which there are no more.")
BLOCK_LAST_SWEEPS = work(400, "sweeps", "Sweeps of a simultaneous impact whose direct solutions have not converged.")
BLOCK_LAST_SWEEPS_FRICTION = work(200, "sweeps",
    "Sweeps of one with friction whose direct solutions have not converged.")
DRIFT_STEADY = work(0.1, "of the residual",
    "Change of the residual in a sweep up to which the impulses of redundant contacts drift.")
DRIFTS = work(2, "number", "Ends of such drifts that are sought in a simultaneous impact with friction, at most.")
DRIFT_SLIPS = round_off(1e-12, "of the friction limit", "Friction that is below its limit by less slips.")
SMALL_BLOCK = work(16, "contacts", "Number up to which sweeps alone are cheaper than a first direct solution.")
DENSE_CONTACTS = work(20, "contacts", "Number up to which the matrix of an island is dense.")
AUGMENTATION = round_off(8.0, "log10 of a ratio",
    "Largest augmentation of a direct solution, with which each island begins: it leaves half the digits of a double.")
AUGMENTATION_LEAST = work(2.0, "log10 of a ratio",
    "Smallest augmentation. Smaller: a direct solution changes more active contacts at once.")
AUGMENTATION_STEP = work(2.0, "log10 of a ratio", "Change of the augmentation from one direct solution to the next.")
AUGMENTATION_MORE = work(0.9, "of the step to a direct solution",
    "Part that is taken from which on the next augmentation is larger.")
AUGMENTATION_LESS = work(0.3, "of the step to a direct solution",
    "Part that is taken below which the next augmentation is smaller.")
REFINEMENTS_SPARSE = work(8, "number", "Refinements of a sparse direct solution of a simultaneous impact, at most.")
REFINEMENTS_INTERVAL = work(6, "number",
    "These refinements in an interval whose augmentation is above REFINED_AUGMENTATION; else one.")
REFINED_AUGMENTATION = work(6.0, "log10 of a ratio",
    "Augmentation up to which sparse direct solutions are not refined: it is small where little of the steps to them "
    "was taken.")
DIRECT_RESIDUAL = accuracy(0.1, "of the residual of sweeps", "Residual at which refinements of a direct solution end.")
DIRECT_LOST = work(1e3, "of the residual of the last sweep",
    "Residual from which on a direct solution is dropped: its active contacts are not those of the solution.")
DIRECT_SINGLE = work(1e-3, "of the residual of the last sweep",
    "Residual of a dense direct solution above which it is tried again, with friction that energy limits shared by "
    "the two contacts of a face.")
REFINEMENTS = work(4, "number", "Passes of a direct solution's refinement.")
DISSECTION_LEAF = work(6, "bodies", "Number up to which nested dissection does not divide further.")
LATE_NEIGHBOURS = work(24, "neighbours", "Number from which on a body is eliminated last.")
FACE_ROUND_OFF = round_off(16.0, "times the gap's round-off",
    "Difference of gaps up to which both ends of parallel faces touch at once.")
ROCKING = heuristic(1e-06, "of the smaller shape",
    "Difference of gaps up to which both ends of a lossy face touch at once. Smaller: long cascades of impacts.")
BLOCK_BODIES = heuristic(16, "bodies", "Bodies of a large island on which a hit acts at once. Larger: slower hits.")
HOMOTOPY_CHANGES = work(1, "changes of state for each contact",
    "Length of a homotopy to the solution of a contact problem.")
HOMOTOPY_CHANGES_ANEW = work(4, "changes of state for each contact", "This length of one that begins without impulses.")
RESTORED_FIRST = round_off(1e-3, "of what an impulse changes by itself",
    "Pivot of an impulse below which it waits for others where a homotopy begins.")
HOMOTOPY_REFINEMENTS = work(2, "number", "Refinements of the solution at the end of a homotopy.")
