"""The contact problem: impulses of one impact of a disk, and of an island over one interval, with a ledger that closes.

In: bodies (pose, velocity, mobility, acceleration), pairs of shapes that may touch, the forces of the last step, an
interval h. Out: velocities at its end (each path is the parabola between), impulses, losses, penetration corrections.
Open `interval.py` first: rows (`gathering.py`), targets (`targets.py`), test for static forces (`statics.py`), solve
(`relaxation.py`), energy lock, works (`works.py`), penetration correction (`correction.py`), memory of forces
(`forces.py`). `single.py` is the closed law of one disk's impact; `counts.py` notes budgets and tolerances that were
not met, and the work of solves.

Names of arguments are those of `..rows`; A is the scene. V and VN (k, 3) are velocities at the start and the end of an
interval of length h, ACC (k, 3) accelerations without contacts, EXTENT (k,) largest distances of points of bodies from
their centres of mass. |a| is the largest acceleration of any point of the island, by rotation too (`pull`), |a| h the
velocity that others are measured by. v- and v+ (u-, u+) are velocities at the start and the end.
"""
