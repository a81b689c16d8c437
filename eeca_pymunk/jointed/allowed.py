"""How fast shapes close at the start of an interval by velocities that joints allow.

The mean velocity over any interval, however short, satisfies the joints, so the part of a velocity that they do not
allow (an error of a step, which elastic impacts keep) is reversed within it. Shapes that touch and open by that part
alone close from the start on.
"""

from __future__ import annotations

from ..compiled import nonallocating
from ..geometry.flight import opening_rate, pose, rate
from ..geometry.gap import gap
from ..joints.start import release_limits
from ..joints.workspace import workspace
from ..model.joints import Joints
from ..model.scene import Scene
from .component import fit_speeds
from .gathered import gather_alone


@nonallocating
def allowed_velocity(A: Scene, J: Joints, i: int, t: float) -> tuple[float, float, float]:
    """The velocity of body i at instant t; where its path begins at t, the part of it that its joints allow."""
    s = J.OF[i]
    if s >= 0 and A.BODY[i].since == t:
        W, first = workspace(J, s), J.COMPONENT[s].first_body
        length = gather_alone(A, J, s, t, 0.0)
        release_limits(W)
        fit_speeds(J, s, length)
        for w in range(W.bodies):
            if J.JOINED[first + w].body == i:
                return J.LOCAL[w].v0[0], J.LOCAL[w].v0[1], J.LOCAL[w].v0[2]
    return rate(A.BODY, i, t)


@nonallocating
def gap_and_rate(A: Scene, J: Joints, a: int, b: int, t: float, allowed: bool) -> tuple[float, float]:
    """Gap of shapes a and b on the paths of their bodies at instant t, and its rate, negative if it closes; by the
    velocities that joints allow, if `allowed`."""
    i, j = A.LINK[a].owner, A.LINK[b].owner
    g, nx, ny, px, py = gap(A, a, b, t)
    xi, yi, _ = pose(A.BODY, i, t)
    xj, yj, _ = pose(A.BODY, j, t)
    one = allowed_velocity(A, J, i, t) if allowed else rate(A.BODY, i, t)
    two = allowed_velocity(A, J, j, t) if allowed else rate(A.BODY, j, t)
    arm_i, arm_j = (px - xi) * ny - (py - yi) * nx, (px - xj) * ny - (py - yj) * nx
    still = 0.0, 0.0, 0.0
    return g, opening_rate(nx, ny, 0.0, arm_j, still, two) - opening_rate(nx, ny, 0.0, arm_i, still, one)
