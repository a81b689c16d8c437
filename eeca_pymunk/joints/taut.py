"""Islands whose joints pull so hard that bodies hardly give way across: a bridge that is as long as its gap, a string.

To first order such joints let bodies go across; only their pull, which turns as the bodies move, holds them. A solution
has to begin with that pull.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .layout import PIN, PIVOT, SLIDE
from .rows import start_joint
from .scratch import APART, ARM_A, ARM_B, L_A, L_B, L_KIND, L_SOFT, LAM, MOBILITY

_TAUT = 0.5  # stiffness of a joint's pull times h^2/4, over a body's inertia


@uncounted
def taut(joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, h: float) -> bool:
    """Whether the impulses LAM of some joint between points pull so that (h/2) dF/dx > _TAUT of a body's inertia."""
    for k in range(joints):
        kind = link[k, L_KIND]
        if link[k, L_SOFT] != 0 or (kind != PIVOT and kind != PIN and kind != SLIDE):
            continue
        start_joint(joint, hinge, link, k, local, h)
        rax, ray, rbx, rby = hinge[k, ARM_A], hinge[k, ARM_A + 1], hinge[k, ARM_B], hinge[k, ARM_B + 1]
        fx, fy, per = hinge[k, LAM], hinge[k, LAM + 1], 0.0
        if kind != PIVOT:
            dx, dy = hinge[k, APART], hinge[k, APART + 1]
            length = math.sqrt(dx * dx + dy * dy)
            if length > 0.0:
                per = hinge[k, LAM] / length
            fx, fy, per = per * dx, per * dy, max(-per, 0.0)
        for end in range(2):
            i = link[k, L_A] if end == 0 else link[k, L_B]
            turn = -(rax * fx + ray * fy) if end == 0 else rbx * fx + rby * fy
            if 0.5 * abs(h) * max(turn * local[i, MOBILITY + 2], per * local[i, MOBILITY]) > _TAUT:
                return True
    return False
