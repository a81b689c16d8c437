"""Rows of joints between points of two bodies: pins, slides, pivots, springs, grooves; equations stand in `rows`."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..model.joint_steps import STIFF_ALL, STIFF_TURNS, BodyStep, JointStep
from ..model.joints import PIVOT, SLIDE, SPRING, Joint
from .springs import mean_force


@inlined
def point_rows(
    kind: int, side: int, bounded: bool, h: float, joint: Joint, hinge: JointStep, a: BodyStep, b: BodyStep,
    stiffens: bool, stiff: FloatArray,
) -> int:  # fmt: skip
    """`joint_rows` of pins, slides, pivots and springs; `measure` of a slide is its length at the end, of a spring its
    mean force without damping. Names end in 0 at the start, 1 at the end, nothing at the mean of both."""
    ca, sa, slope_a, lever_a = a.turn_cos, a.turn_sin, a.slope, a.lever
    cb, sb, slope_b, lever_b = b.turn_cos, b.turn_sin, b.slope, b.lever
    rax0, ray0, rbx0, rby0 = hinge.arm_a[0], hinge.arm_a[1], hinge.arm_b[0], hinge.arm_b[1]
    rax1, ray1 = ca * rax0 - sa * ray0, sa * rax0 + ca * ray0
    rbx1, rby1 = cb * rbx0 - sb * rby0, sb * rbx0 + cb * rby0
    rax, ray, rbx, rby = 0.5 * (rax0 + rax1), 0.5 * (ray0 + ray1), 0.5 * (rbx0 + rbx1), 0.5 * (rby0 + rby1)
    dx0, dy0 = hinge.span[0], hinge.span[1]
    dx1 = dx0 + b.way[0] - a.way[0] + (rbx1 - rbx0) - (rax1 - rax0)
    dy1 = dy0 + b.way[1] - a.way[1] + (rby1 - rby0) - (ray1 - ray0)
    dx, dy = 0.5 * (dx0 + dx1), 0.5 * (dy0 + dy1)
    # Derivatives of d1 by chi_a (ua) and chi_b (ub), each (x, y).
    uax, uay, ubx, uby = slope_a * ray1, -slope_a * rax1, -slope_b * rby1, slope_b * rbx1
    if kind == PIVOT:
        fx, fy = hinge.lam[0], hinge.lam[1]
        hinge.value[0], hinge.value[1] = dx1, dy1
        hinge.rows[0, 0], hinge.rows[0, 1], hinge.rows[0, 2] = -1.0, 0.0, lever_a * ray
        hinge.rows[0, 3], hinge.rows[0, 4], hinge.rows[0, 5] = 1.0, 0.0, -lever_b * rby
        hinge.rows[1, 0], hinge.rows[1, 1], hinge.rows[1, 2] = 0.0, -1.0, -lever_a * rax
        hinge.rows[1, 3], hinge.rows[1, 4], hinge.rows[1, 5] = 0.0, 1.0, lever_b * rbx
        hinge.slopes[0, 0], hinge.slopes[0, 1], hinge.slopes[0, 2] = -1.0, 0.0, uax
        hinge.slopes[0, 3], hinge.slopes[0, 4], hinge.slopes[0, 5] = 1.0, 0.0, ubx
        hinge.slopes[1, 0], hinge.slopes[1, 1], hinge.slopes[1, 2] = 0.0, -1.0, uay
        hinge.slopes[1, 3], hinge.slopes[1, 4], hinge.slopes[1, 5] = 0.0, 1.0, uby
        filled = STIFF_TURNS
    else:
        filled = STIFF_ALL
        hxx = hxy = hyx = hyy = 0.0  # derivative of the impulse (fx, fy) on b by d1
        if kind == SPRING:
            began, ended = hinge.began, np.sqrt(dx1 * dx1 + dy1 * dy1)
            mean, stiffness, drag = 0.5 * (began + ended), joint.stiffness, hinge.drag
            rest, bound = joint.rest, joint.max_force
            pull = mean_force(joint.push, -stiffness, bound, began - rest, ended - rest)
            lam = h * max(-bound, min(bound, pull - drag * (ended - began) / h))
            hinge.measure = pull
            if abs(lam) >= abs(h) * bound:
                stiffness = drag = 0.0
            over = 1.0 / mean if mean > 0.0 else 0.0
            fx, fy = lam * over * dx, lam * over * dy
            steep = (-(0.5 * h * stiffness + drag) - 0.5 * lam * over) * over / ended if ended > 0.0 else 0.0
            hxx = 0.5 * lam * over + steep * dx * dx1
            hxy, hyx = steep * dx * dy1, steep * dy * dx1
            hyy = 0.5 * lam * over + steep * dy * dy1
            hinge.lam[0], hinge.ended = lam, ended
        else:
            length = joint.lower if kind == SLIDE else joint.length
            if kind == SLIDE:
                hinge.measure = np.sqrt(dx1 * dx1 + dy1 * dy1)
                length = joint.upper if side > 0 else length if side < 0 else hinge.measure
            if bounded or length == 0.0:
                length = np.sqrt(dx * dx + dy * dy)
            over = 1.0 / length if length > 0.0 else 0.0
            nx, ny, mx, my = dx1 * over, dy1 * over, dx * over, dy * over
            lam = hinge.lam[0]
            fx, fy = lam * mx, lam * my
            hxx = hyy = 0.5 * lam * over
            hinge.value[0] = 0.5 * (dx1 * dx1 + dy1 * dy1) * over - 0.5 * length
            hinge.rows[0, 0], hinge.rows[0, 1], hinge.rows[0, 2] = -mx, -my, -lever_a * (rax * my - ray * mx)
            hinge.rows[0, 3], hinge.rows[0, 4], hinge.rows[0, 5] = mx, my, lever_b * (rbx * my - rby * mx)
            hinge.slopes[0, 0], hinge.slopes[0, 1], hinge.slopes[0, 2] = -nx, -ny, nx * uax + ny * uay
            hinge.slopes[0, 3], hinge.slopes[0, 4], hinge.slopes[0, 5] = nx, ny, nx * ubx + ny * uby
        for c in range(6 if stiffens else 0):  # (ux, uy): derivative of (fx, fy) by way c of both bodies
            if c == 0 or c == 3:
                ux, uy = hxx, hyx
            elif c == 1 or c == 4:
                ux, uy = hxy, hyy
            elif c == 2:
                ux, uy = hxx * uax + hxy * uay, hyx * uax + hyy * uay
            else:
                ux, uy = hxx * ubx + hxy * uby, hyx * ubx + hyy * uby
            if c < 2:
                ux, uy = -ux, -uy
            stiff[0, c], stiff[1, c] = -ux, -uy
            stiff[2, c] = -lever_a * (rax * uy - ray * ux)
            stiff[3, c], stiff[4, c] = ux, uy
            stiff[5, c] = lever_b * (rbx * uy - rby * ux)
    if filled == STIFF_TURNS:
        stiff[2, 2] = stiff[5, 5] = 0.0
    stiff[2, 2] += 0.5 * slope_a * (rax1 * fx + ray1 * fy)
    stiff[5, 5] -= 0.5 * slope_b * (rbx1 * fx + rby1 * fy)
    hinge.force[0], hinge.force[1], hinge.force[2] = -fx, -fy, -lever_a * (rax * fy - ray * fx)
    hinge.force[3], hinge.force[4], hinge.force[5] = fx, fy, lever_b * (rbx * fy - rby * fx)
    return filled


@nonallocating
def groove_rows(side: int, joint: Joint, hinge: JointStep, a: BodyStep, b: BodyStep, stiff: FloatArray) -> int:
    """`joint_rows` of a groove: row 0 keeps the point of b on the line of the groove; row 1, which acts if the joint
    stands on an end (`side`), inside that end. `measure` is the place of the point along the groove. y is the vector
    from the centre of mass of a to the point of b."""
    ca, sa, slope_a, lever_a = a.turn_cos, a.turn_sin, a.slope, a.lever
    cb, sb, slope_b, lever_b = b.turn_cos, b.turn_sin, b.slope, b.lever
    rbx0, rby0 = hinge.arm_b[0], hinge.arm_b[1]
    rbx1, rby1 = cb * rbx0 - sb * rby0, sb * rbx0 + cb * rby0
    rbx, rby = 0.5 * (rbx0 + rbx1), 0.5 * (rby0 + rby1)
    yx0, yy0 = hinge.span[0], hinge.span[1]
    yx1 = yx0 + b.way[0] - a.way[0] + (rbx1 - rbx0)
    yy1 = yy0 + b.way[1] - a.way[1] + (rby1 - rby0)
    yx, yy = 0.5 * (yx0 + yx1), 0.5 * (yy0 + yy1)
    for r in range(6):
        for c in range(6):
            stiff[r, c] = 0.0
    for c in range(6):
        hinge.force[c] = 0.0
    for r in range(2):
        nx0, ny0 = hinge.normal[0], hinge.normal[1]
        offset = joint.offset
        if r == 1:
            nx0, ny0 = ny0, -nx0  # the direction of the groove
            offset = joint.upper if side > 0 else joint.lower
        nx1, ny1 = ca * nx0 - sa * ny0, sa * nx0 + ca * ny0
        nx, ny = 0.5 * (nx0 + nx1), 0.5 * (ny0 + ny1)
        lam = hinge.lam[r]
        hinge.value[r] = nx1 * yx1 + ny1 * yy1 - offset
        hinge.measure = nx1 * yx1 + ny1 * yy1
        row, slope = hinge.rows[r], hinge.slopes[r]
        row[0], row[1], row[3], row[4] = -nx, -ny, nx, ny
        row[2] = -lever_a * (yx * ny - yy * nx)
        row[5] = lever_b * (rbx * ny - rby * nx)
        slope[0], slope[1], slope[3], slope[4] = -nx1, -ny1, nx1, ny1
        slope[2] = -slope_a * (yx1 * ny1 - yy1 * nx1)
        slope[5] = slope_b * (rbx1 * ny1 - rby1 * nx1)
        if r == 1 and side == 0:
            break
        for c in range(6):
            hinge.force[c] += lam * hinge.rows[r, c]
        half_a, half_b = 0.5 * lam * slope_a, 0.5 * lam * slope_b
        stiff[0, 2] += half_a * ny1
        stiff[1, 2] -= half_a * nx1
        stiff[3, 2] -= half_a * ny1
        stiff[4, 2] += half_a * nx1
        stiff[5, 5] -= half_b * (rbx1 * nx + rby1 * ny)
        stiff[5, 2] += half_a * (rbx * nx1 + rby * ny1)
        stiff[2, 0] += 0.5 * lam * ny
        stiff[2, 1] -= 0.5 * lam * nx
        stiff[2, 3] -= 0.5 * lam * ny
        stiff[2, 4] += 0.5 * lam * nx
        stiff[2, 5] += half_b * (rbx1 * nx + rby1 * ny)
        stiff[2, 2] -= half_a * (yx * nx1 + yy * ny1)
    return STIFF_ALL
