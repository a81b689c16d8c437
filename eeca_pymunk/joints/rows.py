"""Rows of a joint: its function g at the end of the step, its discrete gradient J, and how both bend.

With x = h v_m the way of a body, r its arm, d = anchor b - anchor a, subscript m the mean of both ends:

    pin, slide     g = (|d|^2 - R^2) / 2R            J_b = (d_m, r_mb x d_m) / R
    pivot          g = d                             J_b = (1, z x r_mb)
    groove, ends   g = n.y - c, y = x_b + r_b - x_a  J_b = (n_m, r_mb x n_m), J_a = -(n_m, y_m x n_m)
    gear           g = angle_b - (angle_a + phase)/ratio   J = (-1/ratio, 1) turned/chi
    limits         g = angle_b - angle_a - bound     J = (-1, 1) s, one s = (turned_b - turned_a)/(chi_b - chi_a)

    spring         F = h p d_m / l_m on b,  p = push - k (l_m - rest) - c (l1 - l0)/h,  l_m = (l0 + l1)/2
    rotary spring  T = h p s on b,          p = push + k (phi_m - rest) + c (phi1 - phi0)/h,  phi = angle_a - angle_b

Each satisfies g1 - g0 = J x, and a spring's work is exactly what it stores and damps. Soft joints and motors have rows
of velocity: (J v1 - speed) h/2, of angles with J = (-1, 1) or (-1/ratio, 1).
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import merged, uncounted
from .angles import angle_rows
from .layout import (
    ANCHOR_AX,
    ANCHOR_AY,
    ANCHOR_BX,
    ANCHOR_BY,
    DAMPING,
    GEAR,
    GROOVE,
    NORMAL_X,
    NORMAL_Y,
    PIVOT,
    ROTARY_SPRING,
    SPRING,
)
from .points import groove_rows, point_rows
from .scratch import (
    AFTER,
    APART,
    ARM_A,
    ARM_B,
    BEGAN,
    COS,
    DRAG,
    ENDED,
    L_A,
    L_B,
    L_JOINT,
    L_KIND,
    L_ROWS,
    L_SIDE,
    L_SOFT,
    MOBILITY,
    NORMAL,
    POSE,
    ROWS,
    SIN,
    SLOPES,
    TARGET,
    VALUE,
)


@merged
def joint_rows(
    joint: FloatArray, hinge: FloatArray, link: IntArray, k: int, local: FloatArray, h: float, bends: bool,
    stiff: FloatArray,
) -> int:  # fmt: skip
    """Joint k at the present iterate: VALUE to SLOPES of `hinge`, and `stiff`, if how rows bend is asked for, as far as
    the result says (`scratch`)."""
    kind, a, b, side = link[k, L_KIND], link[k, L_A], link[k, L_B], link[k, L_SIDE]
    soft, j = link[k, L_SOFT] != 0, link[k, L_JOINT]
    if kind >= GEAR:
        return angle_rows(kind, side, soft, h, joint, j, hinge, k, local, a, b, stiff)
    if kind == GROOVE:
        bend = groove_rows(side, joint, j, hinge, k, local, a, b, stiff)
    else:
        bend = point_rows(kind, side, soft, h, joint, j, hinge, k, local, a, b, bends, stiff)
    if soft:
        for r in range(link[k, L_ROWS]):
            speed = -hinge[k, TARGET + r]
            for c in range(3):
                speed += (
                    hinge[k, ROWS + 6 * r + c] * local[a, AFTER + c]
                    + hinge[k, ROWS + 6 * r + 3 + c] * local[b, AFTER + c]
                )
            for c in range(6):
                hinge[k, SLOPES + 6 * r + c] = hinge[k, ROWS + 6 * r + c]
            hinge[k, VALUE + r] = 0.5 * h * speed
    return bend


@merged
def start_joint(joint: FloatArray, hinge: FloatArray, link: IntArray, k: int, local: FloatArray, h: float) -> None:
    """What stays the same over the iterations: arms, distance and normal at the start, a spring's damping."""
    kind, a, b, j = link[k, L_KIND], link[k, L_A], link[k, L_B], link[k, L_JOINT]
    if kind >= GEAR:
        hinge[k, ARM_A], hinge[k, ARM_B] = local[a, POSE + 2], local[b, POSE + 2]
        if kind == ROTARY_SPRING:
            hinge[k, BEGAN] = hinge[k, ENDED] = local[a, POSE + 2] - local[b, POSE + 2]
            hinge[k, DRAG] = drag(joint[j, DAMPING], local[a, MOBILITY + 2] + local[b, MOBILITY + 2], h)
        return
    ca, sa, cb, sb = local[a, COS], local[a, SIN], local[b, COS], local[b, SIN]
    rbx = cb * joint[j, ANCHOR_BX] - sb * joint[j, ANCHOR_BY]
    rby = sb * joint[j, ANCHOR_BX] + cb * joint[j, ANCHOR_BY]
    rax = ray = 0.0
    if kind == GROOVE:
        hinge[k, NORMAL] = ca * joint[j, NORMAL_X] - sa * joint[j, NORMAL_Y]
        hinge[k, NORMAL + 1] = sa * joint[j, NORMAL_X] + ca * joint[j, NORMAL_Y]
    else:
        rax = ca * joint[j, ANCHOR_AX] - sa * joint[j, ANCHOR_AY]
        ray = sa * joint[j, ANCHOR_AX] + ca * joint[j, ANCHOR_AY]
    dx, dy = local[b, POSE] - local[a, POSE] + (rbx - rax), local[b, POSE + 1] - local[a, POSE + 1] + (rby - ray)
    hinge[k, ARM_A], hinge[k, ARM_A + 1], hinge[k, ARM_B], hinge[k, ARM_B + 1] = rax, ray, rbx, rby
    hinge[k, APART], hinge[k, APART + 1] = dx, dy
    if kind == SPRING:
        length = np.sqrt(dx * dx + dy * dy)
        hinge[k, BEGAN] = hinge[k, ENDED] = length
        turn_a, turn_b = 0.0, 0.0
        if length > 0.0:
            turn_a, turn_b = (rax * dy - ray * dx) / length, (rbx * dy - rby * dx) / length
        mobility = local[a, MOBILITY] + local[b, MOBILITY]
        mobility += local[a, MOBILITY + 2] * turn_a * turn_a + local[b, MOBILITY + 2] * turn_b * turn_b
        hinge[k, DRAG] = drag(joint[j, DAMPING], mobility, h)


@uncounted
def drag(damping: float, mobility: float, h: float) -> float:
    """The damping for which the midpoint rule slows a free pair by exp(-damping mobility h), as native does.

    The midpoint rule makes (1 - x)/(1 + x) of the speed, x = drag mobility h / 2: hence x = tanh(damping mobility h/2).
    """
    rate = 0.5 * abs(h) * mobility
    return np.tanh(damping * rate) / rate if rate > 0.0 else damping


@uncounted
def row_count(kind: int) -> int:
    """Number of impulses of a joint of this kind that are unknowns."""
    if kind in (SPRING, ROTARY_SPRING):
        return 0
    return 2 if kind in (PIVOT, GROOVE) else 1
