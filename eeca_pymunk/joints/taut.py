"""Components whose joints pull so hard that bodies hardly move across them: a string, a bridge as long as its gap.

To first order such joints allow motion across. Only their pull, whose direction turns with the motion, prevents it: a
solution has to begin with that pull.
"""

from __future__ import annotations

import math

from ..compiled import nonallocating
from ..model.joint_steps import POSES
from ..model.joints import PIN, PIVOT, SLIDE, Workspace
from ..model.parameters.joints import TAUT
from ..newton.rows import start_joint


@nonallocating
def is_taut(W: Workspace, h: float) -> bool:
    """Whether (h/4) dF/dx > TAUT of a body's inertia, for the impulse F of a joint between points that pulls; this is
    the entry of STIFF (`..newton.response.inertia_taken`). `turn` is -dF/dx for the body's angle, arm . F; `per` that
    across a pin or slide, F over its length."""
    hinge, link = W.J.HINGE, W.link
    for k in range(W.joints):
        kind = link[k].kind
        if link[k].bounded != 0 or (kind != PIVOT and kind != PIN and kind != SLIDE):
            continue
        start_joint(W, k, POSES, h)
        rax, ray, rbx, rby = hinge[k].arm_a[0], hinge[k].arm_a[1], hinge[k].arm_b[0], hinge[k].arm_b[1]
        fx, fy, per = hinge[k].lam[0], hinge[k].lam[1], 0.0
        if kind != PIVOT:
            dx, dy = hinge[k].apart[0], hinge[k].apart[1]
            length = math.sqrt(dx * dx + dy * dy)
            if length > 0.0:
                per = hinge[k].lam[0] / length
            fx, fy, per = per * dx, per * dy, max(-per, 0.0)
        for end in range(2):
            i = link[k].body[0] if end == 0 else link[k].body[1]
            turn = -(rax * fx + ray * fy) if end == 0 else rbx * fx + rby * fy
            if 0.25 * abs(h) * max(turn * W.J.LOCAL[i].mobility[2], per * W.J.LOCAL[i].mobility[0]) > TAUT:
                return True
    return False
