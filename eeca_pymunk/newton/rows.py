"""Rows of a joint: its function g at the end of the step, its discrete gradient J, its slope G, and how J bends.

With x = h v_m the way of a body, r its arm, d = anchor b - anchor a, subscript m the mean of start and end, z the unit
vector out of the plane; R the length of a pin or the bound of a slide; n the normal of a groove on body a, c its
offset; chi = h w_m, and *turned* the angle by which a body turns (`..model.joint_steps.BodyStep`):

    pin, slide     g = (|d|^2 - R^2) / 2R            J_b = (d_m, r_mb x d_m) / R
    pivot          g = d                             J_b = (1, z x r_mb)
    groove, ends   g = n.y - c, y = x_b + r_b - x_a  J_b = (n_m, r_mb x n_m), J_a = -(n_m, y_m x n_m)
    gear           g = angle_b - (angle_a + phase)/ratio   J = (-1/ratio, 1) turned/chi
    limits         g = angle_b - angle_a - bound     J = (-1, 1) s, one s = (turned_b - turned_a)/(chi_b - chi_a)

    spring         F = h p d_m / l_m on b,  p = push - k (l_m - rest) - c (l1 - l0)/h,  l_m = (l0 + l1)/2
    rotary spring  T = h p s on b,          p = push + k (phi_m - rest) + c (phi1 - phi0)/h,  phi = angle_a - angle_b

Where only J_b is given J_a is its negative, with the arm of a. p is the mean force of a spring over the step, l its
length, c its `drag`. Each row satisfies g1 - g0 = J x, and a spring's work is exactly what it stores and damps. Bounded
joints and motors have rows of velocity at the end, (J v1 - speed) h/2: a length or an angle as g is, and with the same
derivative by v1, (h/2) J. For angles J = (-1, 1) or (-1/ratio, 1).
"""

from __future__ import annotations

import numpy as np

from ..compiled import inlined, nonallocating
from ..model.joint_steps import POSES, STEP, BodyStep
from ..model.joints import APART, GEAR, GROOVE, LEFT_APART, PIVOT, ROTARY_SPRING, SPRING, Joint, Workspace
from .angles import angle_rows
from .points import groove_rows, point_rows


@inlined
def joint_rows(W: Workspace, k: int, h: float, stiffens: bool) -> int:
    """Compute the rows of joint k at the present iterate, `way` of its bodies and its `lam`.

    Sets `value`, `force`, `rows`, `slopes`, of limits `measure`, of springs `lam`, `ended` and `measure`, their mean
    force without damping; and STIFF if it is needed (`stiffens`). h: length of the part. Returns which entries of STIFF
    are not 0, and set: STIFF_NONE, STIFF_TURNS, STIFF_ALL.
    """
    joint, hinge, link, local, stiff = W.J.JOINT, W.J.HINGE, W.link, W.J.LOCAL, W.J.STIFF
    kind, a, b, side = link[k].kind, link[k].body[0], link[k].body[1], link[k].side
    bounded, j = link[k].bounded != 0, link[k].joint
    if kind >= GEAR:
        return angle_rows(kind, side, bounded, h, joint[j], hinge[k], local[a], local[b], stiff)
    if kind == GROOVE:
        filled = groove_rows(side, joint[j], hinge[k], local[a], local[b], stiff)
    else:
        filled = point_rows(kind, side, bounded, h, joint[j], hinge[k], local[a], local[b], stiffens, stiff)
    if bounded:
        for r in range(link[k].rows):
            speed = -hinge[k].target[r]
            for c in range(3):
                speed += hinge[k].rows[r, c] * local[a].v1[c] + hinge[k].rows[r, c + 3] * local[b].v1[c]
            for c in range(6):
                hinge[k].slopes[r, c] = hinge[k].rows[r, c]
            hinge[k].value[r] = 0.5 * h * speed
    return filled


@inlined
def shares_point(joint: Joint, what: int) -> bool:
    """Whether the anchors of a pivot are apart, and it acts at one point of both bodies all the same. Impulses at two
    points would turn the component by themselves. Elastic ones pull along the line between the anchors."""
    if joint.kind != PIVOT or what == POSES or joint.touched == 0:
        return False
    return what != STEP or joint.touched in (APART, LEFT_APART)


@inlined
def shared_part(a: BodyStep, b: BodyStep) -> float:
    """Where the point of a pivot that `shares_point` is between the anchors, from that of a on: in the middle, or at
    the centre of mass of a body that joints do not turn; -1 if that is so of both."""
    free_a, free_b = a.freedoms == 0 or a.cayley > 0, b.freedoms == 0 or b.cayley > 0
    if free_a:
        return 0.5 if free_b else 1.0
    return 0.0 if free_b else -1.0


@inlined
def start_joint(W: Workspace, k: int, what: int, h: float) -> None:
    """Set what is constant over the iterations of a part of length h, for `what`: arms, distance and normal at its
    start; of joints of angles the angles, in arm_a[0] and arm_b[0]; a spring's length or angle, and its `drag`."""
    joint, hinge, link, local = W.J.JOINT, W.J.HINGE, W.link, W.J.LOCAL
    kind, a, b, j = link[k].kind, link[k].body[0], link[k].body[1], link[k].joint
    if kind >= GEAR:
        hinge[k].arm_a[0], hinge[k].arm_b[0] = local[a].pose[2], local[b].pose[2]
        if kind == ROTARY_SPRING:
            hinge[k].began = hinge[k].ended = local[a].pose[2] - local[b].pose[2]
            hinge[k].drag = drag(joint[j].damping, local[a].mobility[2] + local[b].mobility[2], h)
        return
    ca, sa, cb, sb = local[a].cos, local[a].sin, local[b].cos, local[b].sin
    rbx = cb * joint[j].anchor_b[0] - sb * joint[j].anchor_b[1]
    rby = sb * joint[j].anchor_b[0] + cb * joint[j].anchor_b[1]
    rax = ray = 0.0
    if kind == GROOVE:
        hinge[k].normal[0] = ca * joint[j].normal[0] - sa * joint[j].normal[1]
        hinge[k].normal[1] = sa * joint[j].normal[0] + ca * joint[j].normal[1]
    else:
        rax = ca * joint[j].anchor_a[0] - sa * joint[j].anchor_a[1]
        ray = sa * joint[j].anchor_a[0] + ca * joint[j].anchor_a[1]
    dx, dy = local[b].pose[0] - local[a].pose[0] + (rbx - rax), local[b].pose[1] - local[a].pose[1] + (rby - ray)
    part = shared_part(local[a], local[b]) if shares_point(joint[j], what) else -1.0
    if part >= 0.0:
        rax, ray, rbx, rby = rax + part * dx, ray + part * dy, rbx - (1.0 - part) * dx, rby - (1.0 - part) * dy
        dx = dy = 0.0
    hinge[k].arm_a[0], hinge[k].arm_a[1], hinge[k].arm_b[0], hinge[k].arm_b[1] = rax, ray, rbx, rby
    hinge[k].span[0], hinge[k].span[1] = dx, dy
    if kind == SPRING:
        length = np.sqrt(dx * dx + dy * dy)
        hinge[k].began = hinge[k].ended = length
        turn_a, turn_b = 0.0, 0.0
        if length > 0.0:
            turn_a, turn_b = (rax * dy - ray * dx) / length, (rbx * dy - rby * dx) / length
        mobility = local[a].mobility[0] + local[b].mobility[0]
        mobility += local[a].mobility[2] * turn_a * turn_a + local[b].mobility[2] * turn_b * turn_b
        hinge[k].drag = drag(joint[j].damping, mobility, h)


@nonallocating
def unit_of(joint: Joint, extent: float) -> float:
    """Unit of g of a joint in a component of size `extent`: g over it is the error by the joint's own formula, over
    that size or in rad. A gear's is angle_b ratio - angle_a - phase = ratio g."""
    if joint.kind == GEAR:
        return float(1.0 / abs(joint.ratio))
    return 1.0 if joint.kind > GEAR else extent


@nonallocating
def drag(damping: float, mobility: float, h: float) -> float:
    """The damping for which the midpoint rule slows a free pair by exp(-damping mobility h), as pymunk's springs do.

    damping: force time/length (torque time/rad), as the result; mobility: change of the rate of a spring's length or
    angle by a unit impulse along it, with the sum of both bodies' inverse masses and moments.
    The midpoint rule makes (1 - x)/(1 + x) of the speed, x = drag mobility h / 2: hence x = tanh(damping mobility h/2).
    """
    rate = 0.5 * abs(h) * mobility
    return np.tanh(damping * rate) / rate if rate > 0.0 else damping


@nonallocating
def row_count(kind: int) -> int:
    """Number of impulses of a joint of this kind that are unknowns."""
    if kind in (SPRING, ROTARY_SPRING):
        return 0
    return 2 if kind in (PIVOT, GROOVE) else 1
