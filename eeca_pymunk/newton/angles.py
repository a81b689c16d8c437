"""Rows of joints that act on angles alone; the equations stand in `rows`."""

from __future__ import annotations

from ..arrays import FloatArray
from ..compiled import nonallocating
from ..model.joint_steps import STIFF_ALL, STIFF_NONE, BodyStep, JointStep
from ..model.joints import GEAR, RATCHET, ROTARY_SPRING, Joint
from .motion import find_turned
from .springs import mean_force


@nonallocating
def shared_turn(a: BodyStep, b: BodyStep) -> float:
    """s = (turned_b - turned_a) / (chi_b - chi_a) of bodies that turn by 2 atan(chi/2): with this common factor torques
    are opposite and energy is conserved. Near 0/0 it is (atan(y)/y) / p, y = (chi_b - chi_a)/2p, p = 1 + chi_a
    chi_b/4."""
    chi_a, chi_b = a.way[2], b.way[2]
    if abs(chi_b - chi_a) > 0.1:
        return float((b.turned - a.turned) / (chi_b - chi_a))
    product = 1.0 + 0.25 * chi_a * chi_b
    y = 0.5 * (chi_b - chi_a) / product
    return float((1.0 - y * y / 3.0 + y**4 / 5.0 - y**6 / 7.0 + y**8 / 9.0 - y**10 / 11.0) / product)


@nonallocating
def angle_rows(
    kind: int, side: int, bounded: bool, h: float, joint: Joint, hinge: JointStep, a: BodyStep, b: BodyStep,
    stiff: FloatArray,
) -> int:  # fmt: skip
    """`joint_rows` of gears, rotary limits, ratchets, motors and rotary springs. `arm_a[0]` and `arm_b[0]` are the
    angles of both bodies at the start; `measure` is angle_b - angle_a at the end, of a spring its mean torque without
    damping. share: 1/ratio of a gear, else 1.  factor: the common s of both bodies if both turn by 2 atan(chi/2); else
    each has its own turned/chi."""
    find_turned(a)
    find_turned(b)
    for r in range(2):
        hinge.value[r] = 0.0
        for c in range(6):
            hinge.rows[r, c] = hinge.slopes[r, c] = 0.0
    for c in range(6):
        hinge.force[c] = 0.0
    lam = hinge.lam[0]
    angle_a, angle_b = hinge.arm_a[0] + a.turned, hinge.arm_b[0] + b.turned
    hinge.measure = angle_b - angle_a
    share = 1.0 / joint.ratio if kind == GEAR else 1.0
    if bounded:
        hinge.rows[0, 2], hinge.rows[0, 5] = -share, 1.0
        hinge.slopes[0, 2], hinge.slopes[0, 5] = -share, 1.0
        hinge.force[2], hinge.force[5] = -share * lam, lam
        hinge.value[0] = 0.5 * h * (b.v1[2] - share * a.v1[2] - hinge.target[0])
        return STIFF_NONE
    both = a.cayley > 0 and b.cayley > 0 and kind != GEAR
    factor = shared_turn(a, b) if both else 0.0
    per_a = factor if both else a.per
    per_b = factor if both else b.per
    if kind == ROTARY_SPRING:
        phi = angle_a - angle_b
        began = hinge.began
        stiffness, drag = joint.stiffness, hinge.drag
        rest, bound = joint.rest, joint.max_force
        pull = mean_force(joint.push, stiffness, bound, began - rest, phi - rest)
        lam = h * max(-bound, min(bound, pull + drag * (phi - began) / h))
        hinge.measure = pull
        if abs(lam) >= abs(h) * bound:
            stiffness = drag = 0.0
        hinge.lam[0], hinge.ended = lam, phi
        slope = 0.5 * h * stiffness + drag
        hinge.force[2], hinge.force[5] = -lam * per_a, lam * per_b
    else:
        slope = 0.0
        hinge.rows[0, 2], hinge.rows[0, 5] = -share * per_a, per_b
        hinge.slopes[0, 2], hinge.slopes[0, 5] = -share * a.slope, b.slope
        hinge.force[2], hinge.force[5] = -share * per_a * lam, per_b * lam
        if kind == GEAR:
            hinge.value[0] = angle_b - (angle_a + joint.phase) * share
        else:
            bound = joint.notch if kind == RATCHET else joint.lower if side < 0 else joint.upper
            hinge.value[0] = angle_b - angle_a - bound
    for r in range(6):
        for c in range(6):
            stiff[r, c] = 0.0
    if both:  # d s/d chi_b = half the second derivative of 2 atan(chi/2) at two thirds of the way from chi_a to chi_b
        t_a, t_b = a.way[2] / 6.0, b.way[2] / 6.0
        slope_a = -0.5 * (2.0 * t_a + t_b) / (1.0 + (2.0 * t_a + t_b) ** 2) ** 2
        slope_b = -0.5 * (t_a + 2.0 * t_b) / (1.0 + (t_a + 2.0 * t_b) ** 2) ** 2
        stiff[2, 5], stiff[5, 2] = -share * lam * slope_b, lam * slope_a
    else:
        slope_a, slope_b = a.per_slope, b.per_slope
    stiff[2, 2], stiff[5, 5] = -share * lam * slope_a, lam * slope_b
    if slope != 0.0:
        stiff[2, 2] -= slope * per_a * a.slope
        stiff[2, 5] += slope * per_a * b.slope
        stiff[5, 2] += slope * per_b * a.slope
        stiff[5, 5] -= slope * per_b * b.slope
    return STIFF_ALL
