"""Rows of joints between points of two bodies: pins, slides, pivots, springs, grooves; equations stand in `rows`."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import merged, uncounted
from .layout import LENGTH, LOWER, MAX_FORCE, OFFSET, PIVOT, PUSH, REST, SLIDE, SPRING, STIFFNESS, UPPER
from .scratch import (
    APART,
    ARM_A,
    ARM_B,
    BEGAN,
    DRAG,
    ENDED,
    FORCE,
    FULL_BEND,
    LAM,
    LEVER,
    MEASURE,
    NORMAL,
    OWN_TURN,
    ROWS,
    SLOPE,
    SLOPES,
    TURN_COS,
    TURN_SIN,
    VALUE,
    WAY,
)
from .springs import mean_force


@merged
def point_rows(
    kind: int, side: int, soft: bool, h: float, joint: FloatArray, j: int, hinge: FloatArray, k: int,
    local: FloatArray, a: int, b: int, bends: bool, stiff: FloatArray,
) -> int:  # fmt: skip
    """`joint_rows` of pins, slides, pivots and springs; MEASURE of a spring is its mean force without damping."""
    ca, sa, slope_a, lever_a = local[a, TURN_COS], local[a, TURN_SIN], local[a, SLOPE], local[a, LEVER]
    cb, sb, slope_b, lever_b = local[b, TURN_COS], local[b, TURN_SIN], local[b, SLOPE], local[b, LEVER]
    rax0, ray0, rbx0, rby0 = hinge[k, ARM_A], hinge[k, ARM_A + 1], hinge[k, ARM_B], hinge[k, ARM_B + 1]
    rax1, ray1 = ca * rax0 - sa * ray0, sa * rax0 + ca * ray0
    rbx1, rby1 = cb * rbx0 - sb * rby0, sb * rbx0 + cb * rby0
    rax, ray, rbx, rby = 0.5 * (rax0 + rax1), 0.5 * (ray0 + ray1), 0.5 * (rbx0 + rbx1), 0.5 * (rby0 + rby1)
    dx0, dy0 = hinge[k, APART], hinge[k, APART + 1]
    dx1 = dx0 + local[b, WAY] - local[a, WAY] + (rbx1 - rbx0) - (rax1 - rax0)
    dy1 = dy0 + local[b, WAY + 1] - local[a, WAY + 1] + (rby1 - rby0) - (ray1 - ray0)
    dx, dy = 0.5 * (dx0 + dx1), 0.5 * (dy0 + dy1)
    # How d1 moves with chi_a and chi_b.
    uax, uay, ubx, uby = slope_a * ray1, -slope_a * rax1, -slope_b * rby1, slope_b * rbx1
    if kind == PIVOT:
        fx, fy = hinge[k, LAM], hinge[k, LAM + 1]
        hinge[k, VALUE], hinge[k, VALUE + 1] = dx1, dy1
        hinge[k, ROWS], hinge[k, ROWS + 1], hinge[k, ROWS + 2] = -1.0, 0.0, lever_a * ray
        hinge[k, ROWS + 3], hinge[k, ROWS + 4], hinge[k, ROWS + 5] = 1.0, 0.0, -lever_b * rby
        hinge[k, ROWS + 6], hinge[k, ROWS + 7], hinge[k, ROWS + 8] = 0.0, -1.0, -lever_a * rax
        hinge[k, ROWS + 9], hinge[k, ROWS + 10], hinge[k, ROWS + 11] = 0.0, 1.0, lever_b * rbx
        hinge[k, SLOPES], hinge[k, SLOPES + 1], hinge[k, SLOPES + 2] = -1.0, 0.0, uax
        hinge[k, SLOPES + 3], hinge[k, SLOPES + 4], hinge[k, SLOPES + 5] = 1.0, 0.0, ubx
        hinge[k, SLOPES + 6], hinge[k, SLOPES + 7], hinge[k, SLOPES + 8] = 0.0, -1.0, uay
        hinge[k, SLOPES + 9], hinge[k, SLOPES + 10], hinge[k, SLOPES + 11] = 0.0, 1.0, uby
        bend = OWN_TURN
    else:
        bend = FULL_BEND
        hxx = hxy = hyx = hyy = 0.0  # dF/dd1
        if kind == SPRING:
            began, ended = hinge[k, BEGAN], np.sqrt(dx1 * dx1 + dy1 * dy1)
            mean, stiffness, drag = 0.5 * (began + ended), joint[j, STIFFNESS], hinge[k, DRAG]
            rest, bound = joint[j, REST], joint[j, MAX_FORCE]
            pull = mean_force(joint[j, PUSH], -stiffness, bound, began - rest, ended - rest)
            lam = h * max(-bound, min(bound, pull - drag * (ended - began) / h))
            hinge[k, MEASURE] = pull
            if abs(lam) >= abs(h) * bound:
                stiffness = drag = 0.0
            over = 1.0 / mean if mean > 0.0 else 0.0
            fx, fy = lam * over * dx, lam * over * dy
            steep = (-(0.5 * h * stiffness + drag) - 0.5 * lam * over) * over / ended if ended > 0.0 else 0.0
            hxx = 0.5 * lam * over + steep * dx * dx1
            hxy, hyx = steep * dx * dy1, steep * dy * dx1
            hyy = 0.5 * lam * over + steep * dy * dy1
            hinge[k, LAM], hinge[k, ENDED] = lam, ended
        else:
            length = joint[j, LENGTH]  # or LOWER, which is the same column
            if kind == SLIDE:
                hinge[k, MEASURE] = np.sqrt(dx1 * dx1 + dy1 * dy1)
                length = joint[j, UPPER] if side > 0 else length if side < 0 else hinge[k, MEASURE]
            if soft or length == 0.0:
                length = np.sqrt(dx * dx + dy * dy)
            over = 1.0 / length if length > 0.0 else 0.0
            nx, ny, mx, my = dx1 * over, dy1 * over, dx * over, dy * over
            lam = hinge[k, LAM]
            fx, fy = lam * mx, lam * my
            hxx = hyy = 0.5 * lam * over
            hinge[k, VALUE] = 0.5 * (dx1 * dx1 + dy1 * dy1) * over - 0.5 * length
            hinge[k, ROWS], hinge[k, ROWS + 1], hinge[k, ROWS + 2] = -mx, -my, -lever_a * (rax * my - ray * mx)
            hinge[k, ROWS + 3], hinge[k, ROWS + 4], hinge[k, ROWS + 5] = mx, my, lever_b * (rbx * my - rby * mx)
            hinge[k, SLOPES], hinge[k, SLOPES + 1], hinge[k, SLOPES + 2] = -nx, -ny, nx * uax + ny * uay
            hinge[k, SLOPES + 3], hinge[k, SLOPES + 4], hinge[k, SLOPES + 5] = nx, ny, nx * ubx + ny * uby
        for c in range(6 if bends else 0):
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
    if bend == OWN_TURN:
        stiff[2, 2] = stiff[5, 5] = 0.0
    stiff[2, 2] += 0.5 * slope_a * (rax1 * fx + ray1 * fy)
    stiff[5, 5] -= 0.5 * slope_b * (rbx1 * fx + rby1 * fy)
    hinge[k, FORCE], hinge[k, FORCE + 1], hinge[k, FORCE + 2] = -fx, -fy, -lever_a * (rax * fy - ray * fx)
    hinge[k, FORCE + 3], hinge[k, FORCE + 4], hinge[k, FORCE + 5] = fx, fy, lever_b * (rbx * fy - rby * fx)
    return bend


@uncounted
def groove_rows(
    side: int, joint: FloatArray, j: int, hinge: FloatArray, k: int,
    local: FloatArray, a: int, b: int, stiff: FloatArray,
) -> int:  # fmt: skip
    """`joint_rows` of a groove: row 0 keeps the point on its line, row 1 inside the end at `side`."""
    ca, sa, slope_a, lever_a = local[a, TURN_COS], local[a, TURN_SIN], local[a, SLOPE], local[a, LEVER]
    cb, sb, slope_b, lever_b = local[b, TURN_COS], local[b, TURN_SIN], local[b, SLOPE], local[b, LEVER]
    rbx0, rby0 = hinge[k, ARM_B], hinge[k, ARM_B + 1]
    rbx1, rby1 = cb * rbx0 - sb * rby0, sb * rbx0 + cb * rby0
    rbx, rby = 0.5 * (rbx0 + rbx1), 0.5 * (rby0 + rby1)
    yx0, yy0 = hinge[k, APART], hinge[k, APART + 1]
    yx1 = yx0 + local[b, WAY] - local[a, WAY] + (rbx1 - rbx0)
    yy1 = yy0 + local[b, WAY + 1] - local[a, WAY + 1] + (rby1 - rby0)
    yx, yy = 0.5 * (yx0 + yx1), 0.5 * (yy0 + yy1)
    for r in range(6):
        for c in range(6):
            stiff[r, c] = 0.0
    for c in range(6):
        hinge[k, FORCE + c] = 0.0
    for r in range(2):
        nx0, ny0 = hinge[k, NORMAL], hinge[k, NORMAL + 1]
        offset = joint[j, OFFSET]
        if r == 1:
            nx0, ny0 = ny0, -nx0  # the direction of the groove
            offset = joint[j, UPPER if side > 0 else LOWER]
        nx1, ny1 = ca * nx0 - sa * ny0, sa * nx0 + ca * ny0
        nx, ny = 0.5 * (nx0 + nx1), 0.5 * (ny0 + ny1)
        lam = hinge[k, LAM + r]
        hinge[k, VALUE + r] = nx1 * yx1 + ny1 * yy1 - offset
        hinge[k, MEASURE] = nx1 * yx1 + ny1 * yy1
        row, slope = ROWS + 6 * r, SLOPES + 6 * r
        hinge[k, row], hinge[k, row + 1], hinge[k, row + 3], hinge[k, row + 4] = -nx, -ny, nx, ny
        hinge[k, row + 2] = -lever_a * (yx * ny - yy * nx)
        hinge[k, row + 5] = lever_b * (rbx * ny - rby * nx)
        hinge[k, slope], hinge[k, slope + 1], hinge[k, slope + 3], hinge[k, slope + 4] = -nx1, -ny1, nx1, ny1
        hinge[k, slope + 2] = -slope_a * (yx1 * ny1 - yy1 * nx1)
        hinge[k, slope + 5] = slope_b * (rbx1 * ny1 - rby1 * nx1)
        if r == 1 and side == 0:
            break
        for c in range(6):
            hinge[k, FORCE + c] += lam * hinge[k, ROWS + 6 * r + c]
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
    return FULL_BEND
