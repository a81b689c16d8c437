"""Islands whose joints pull so hard that bodies hardly give way across: a bridge that is as long as its gap, a string.

To first order such joints let bodies go across; only their pull, which turns as the bodies move, holds them. A solution
has to begin with that pull.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .layout import ANCHOR_AX, ANCHOR_AY, ANCHOR_BX, ANCHOR_BY, PIN, PIVOT, SLIDE
from .scratch import COS, L_A, L_B, L_JOINT, L_KIND, L_SOFT, LAM, MOBILITY, POSE, SIN

_TAUT = 0.5  # stiffness of a joint's pull times h^2/4, over a body's inertia


@uncounted
def taut(joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, h: float) -> bool:
    """Whether the impulses LAM of some joint between points pull so that (h/2) dF/dx > _TAUT of a body's inertia."""
    for k in range(joints):
        kind = link[k, L_KIND]
        if link[k, L_SOFT] != 0 or (kind != PIVOT and kind != PIN and kind != SLIDE):
            continue
        j, a, b = link[k, L_JOINT], link[k, L_A], link[k, L_B]
        ca, sa, cb, sb = local[a, COS], local[a, SIN], local[b, COS], local[b, SIN]
        rax = ca * joint[j, ANCHOR_AX] - sa * joint[j, ANCHOR_AY]
        ray = sa * joint[j, ANCHOR_AX] + ca * joint[j, ANCHOR_AY]
        rbx = cb * joint[j, ANCHOR_BX] - sb * joint[j, ANCHOR_BY]
        rby = sb * joint[j, ANCHOR_BX] + cb * joint[j, ANCHOR_BY]
        fx, fy, per = hinge[k, LAM], hinge[k, LAM + 1], 0.0
        if kind != PIVOT:
            dx, dy = local[b, POSE] - local[a, POSE] + rbx - rax, local[b, POSE + 1] - local[a, POSE + 1] + rby - ray
            length = math.sqrt(dx * dx + dy * dy)
            if length > 0.0:
                per = hinge[k, LAM] / length
            fx, fy, per = per * dx, per * dy, max(-per, 0.0)
        for end in range(2):
            i = a if end == 0 else b
            turn = -(rax * fx + ray * fy) if end == 0 else rbx * fx + rby * fy
            if 0.5 * abs(h) * max(turn * local[i, MOBILITY + 2], per * local[i, MOBILITY]) > _TAUT:
                return True
    return False
