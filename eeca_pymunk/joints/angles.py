"""Rows of joints that act on angles alone; the equations stand in `rows`."""

from __future__ import annotations

from ..arrays import FloatArray
from ..compiled import uncounted
from .layout import GEAR, MAX_FORCE, NOTCH, PHASE, PUSH, RATCHET, RATIO, REST, ROTARY_SPRING, STIFFNESS, UPPER
from .motion import turn
from .scratch import (
    AFTER,
    ARM_A,
    ARM_B,
    BEGAN,
    BEND,
    CAYLEY,
    DRAG,
    ENDED,
    FORCE,
    FULL_BEND,
    LAM,
    MEASURE,
    NO_BEND,
    PER,
    ROWS,
    SLOPE,
    SLOPES,
    TARGET,
    TURNED,
    VALUE,
    WAY,
    WEIGHT,
)
from .springs import mean_force


@uncounted
def shared_turn(local: FloatArray, a: int, b: int) -> float:
    """(turned_b - turned_a) / (chi_b - chi_a): the one factor with which torques are opposite and energy is kept."""
    chi_a, chi_b = local[a, WAY + 2], local[b, WAY + 2]
    if abs(chi_b - chi_a) > 0.1:
        return float((local[b, TURNED] - local[a, TURNED]) / (chi_b - chi_a))
    product = 1.0 + 0.25 * chi_a * chi_b
    y = 0.5 * (chi_b - chi_a) / product
    return float((1.0 - y * y / 3.0 + y**4 / 5.0 - y**6 / 7.0 + y**8 / 9.0) / product)


@uncounted
def angle_rows(
    kind: int, side: int, soft: bool, h: float, joint: FloatArray, j: int, hinge: FloatArray, k: int,
    local: FloatArray, a: int, b: int, stiff: FloatArray,
) -> int:  # fmt: skip
    """`joint_rows` of gears, rotary limits, ratchets, motors and rotary springs."""
    turn(local, a)
    turn(local, b)
    for c in range(VALUE, WEIGHT):
        hinge[k, c] = 0.0
    lam = hinge[k, LAM]
    angle_a, angle_b = hinge[k, ARM_A] + local[a, TURNED], hinge[k, ARM_B] + local[b, TURNED]
    hinge[k, MEASURE] = angle_b - angle_a
    share = 1.0 / joint[j, RATIO] if kind == GEAR else 1.0
    if soft:
        hinge[k, ROWS + 2], hinge[k, ROWS + 5] = -share, 1.0
        hinge[k, SLOPES + 2], hinge[k, SLOPES + 5] = -share, 1.0
        hinge[k, FORCE + 2], hinge[k, FORCE + 5] = -share * lam, lam
        hinge[k, VALUE] = 0.5 * h * (local[b, AFTER + 2] - share * local[a, AFTER + 2] - hinge[k, TARGET])
        return NO_BEND
    both = local[a, CAYLEY] > 0.0 and local[b, CAYLEY] > 0.0 and kind != GEAR
    factor = shared_turn(local, a, b) if both else 0.0
    per_a = factor if both else local[a, PER]
    per_b = factor if both else local[b, PER]
    if kind == ROTARY_SPRING:
        phi = angle_a - angle_b
        began = hinge[k, BEGAN]
        stiffness, drag = joint[j, STIFFNESS], hinge[k, DRAG]
        rest, bound = joint[j, REST], joint[j, MAX_FORCE]
        pull = mean_force(joint[j, PUSH], stiffness, bound, began - rest, phi - rest)
        lam = h * max(-bound, min(bound, pull + drag * (phi - began) / h))
        hinge[k, MEASURE] = pull
        if abs(lam) >= abs(h) * bound:
            stiffness = drag = 0.0
        hinge[k, LAM], hinge[k, ENDED] = lam, phi
        slope = 0.5 * h * stiffness + drag
        hinge[k, FORCE + 2], hinge[k, FORCE + 5] = -lam * per_a, lam * per_b
    else:
        slope = 0.0
        hinge[k, ROWS + 2], hinge[k, ROWS + 5] = -share * per_a, per_b
        hinge[k, SLOPES + 2], hinge[k, SLOPES + 5] = -share * local[a, SLOPE], local[b, SLOPE]
        hinge[k, FORCE + 2], hinge[k, FORCE + 5] = -share * per_a * lam, per_b * lam
        if kind == GEAR:
            hinge[k, VALUE] = angle_b - (angle_a + joint[j, PHASE]) * share
        else:
            bound = joint[j, NOTCH] if kind == RATCHET or side < 0 else joint[j, UPPER]
            hinge[k, VALUE] = angle_b - angle_a - bound
    for r in range(6):
        for c in range(6):
            stiff[r, c] = 0.0
    if both:  # d s/d chi_b = half the second derivative of 2 atan(chi/2) at two thirds of the way from chi_a to chi_b
        t_a, t_b = local[a, WAY + 2] / 6.0, local[b, WAY + 2] / 6.0
        bend_a = -0.5 * (2.0 * t_a + t_b) / (1.0 + (2.0 * t_a + t_b) ** 2) ** 2
        bend_b = -0.5 * (t_a + 2.0 * t_b) / (1.0 + (t_a + 2.0 * t_b) ** 2) ** 2
        stiff[2, 5], stiff[5, 2] = -share * lam * bend_b, lam * bend_a
    else:
        bend_a, bend_b = local[a, BEND], local[b, BEND]
    stiff[2, 2], stiff[5, 5] = -share * lam * bend_a, lam * bend_b
    if slope != 0.0:
        stiff[2, 2] -= slope * per_a * local[a, SLOPE]
        stiff[2, 5] += slope * per_a * local[b, SLOPE]
        stiff[5, 2] += slope * per_b * local[a, SLOPE]
        stiff[5, 5] -= slope * per_b * local[b, SLOPE]
    return FULL_BEND
