"""Joints that contradict one another: no poses of their bodies fit all of them, so no length of a part does.

The rows that act ask g(q1) = target of the poses q1 at the end of a part. Neither these functions nor the targets
depend on its length h, which decides only the impulses that lead there. So where no poses fit, all lengths fail.

Newton's method, with a term on the diagonal for redundant rows, then ends where the errors r = g - target, scaled, are
least: G^T s^2 r = 0, with the slopes G of the rows and their scales s. Elastic joints would be in equilibrium there. If
r is not 0, this is a proof where G is constant, as for joints of angles: rows times r s^2 add up to 0 on the left of
G (q1 - q0) = -r0 for all q1, but not on the right. Of other joints it says that no poses nearby fit. If also the errors
at the start were as large, they do not arise from the motion, which is less in shorter parts (a linkage that is driven
beyond its reach): what shorter parts have to close is the same.
"""

from __future__ import annotations

import math

from ..compiled import nonallocating
from ..model.joints import Workspace
from ..model.parameters.joints import BALANCED, JOINT_APART
from ..newton.entries import acting_rows
from ..newton.motion import move
from ..newton.rows import joint_rows


@nonallocating
def misfit(W: Workspace, h: float) -> tuple[float, float, float]:
    """At the present iterate of a part h: the sum of the squares of the scaled errors of exact rows; that of the scaled
    forces by which they would pull bodies if joints were elastic; the largest error, over its unit."""
    link, hinge, local = W.link, W.J.HINGE, W.J.LOCAL
    for i in range(W.bodies):
        for c in range(3):
            local[i].impulse[c] = 0.0
    errors, farthest = 0.0, 0.0
    for k in range(W.joints):
        if link[k].bounded != 0 or link[k].rows == 0:
            continue
        joint_rows(W, k, h, False)
        for r in range(acting_rows(link, k)):
            off, scale = hinge[k].value[r] - hinge[k].target[r], hinge[k].scale[r]
            errors += (off * scale) ** 2
            farthest = max(farthest, abs(off) / hinge[k].size)
            for end in range(2):
                for c in range(3):
                    local[link[k].body[end]].impulse[c] += off * scale**2 * hinge[k].slopes[r, 3 * end + c]
    forces = 0.0
    for i in range(W.bodies):
        for c in range(local[i].freedoms):
            forces += local[i].mobility[c] * local[i].impulse[c] ** 2
    return errors, forces, farthest


@nonallocating
def contradicts(W: Workspace, h: float) -> bool:
    """Whether joints contradict one another, at the last iterate of a part h whose solve has failed, and which begins
    at the start of the step. Velocities v1 become those of no motion.

    Other lengths fail alike if they have the same rows: if the limits that have been met were met at once, as here.
    """
    if W.J.PARTS.left != h:
        return False
    errors, forces, farthest = misfit(W, h)
    if not farthest > JOINT_APART or not forces <= BALANCED**2 * errors:
        return False
    for i in range(W.bodies):
        for c in range(3):
            W.J.LOCAL[i].v1[c] = -W.J.LOCAL[i].v0[c]
    move(W.J.LOCAL, W.bodies, h)
    at_start, _, _ = misfit(W, h)
    return bool(errors <= at_start and math.isfinite(at_start))
