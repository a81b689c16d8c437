"""Corrections at an instant: velocities made to fit the joints, joints that are apart closed, impacts at limits.

With G the gradients of the held rows:  M dv = G^T lam,  G (v + dv) = 0  (kinetic energy only falls, momentum stays),
and of positions  M dq = G^T mu,  g(q + dq) = target.
"""

from __future__ import annotations

import numpy as np

from ..compiled import kernel
from .banded import solve_banded
from .motion import move
from .newton import held, put_bodies, put_rows, scale_rows
from .rows import joint_rows, start_joint
from .scratch import (
    AFTER,
    BEFORE,
    COLUMN,
    COS,
    FREEDOMS,
    KEPT,
    L_A,
    L_ROW,
    L_ROWS,
    L_SIDE,
    L_SOFT,
    MOBILITY,
    POSE,
    PUSHED,
    ROWS,
    SCALE,
    SIN,
    SIZE,
    TARGET,
    VALUE,
    FloatArray,
    IntArray,
)  # fmt: skip
from .solve import LEAST_EPSILON, clear, regularise


@kernel
def stand_still(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, bodies: int
) -> None:
    """No motion, so that rows are those of the present poses."""
    for i in range(bodies):
        for c in range(3):
            local[i, AFTER + c] = -local[i, BEFORE + c]
    move(local, bodies, 1.0)
    for k in range(joints):
        start_joint(joint, hinge, link, k, local, 1.0)


@kernel
def correction(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    of_poses: bool, band: int, size: int, matrix: FloatArray, right: FloatArray, one: FloatArray,
) -> float:  # fmt: skip
    """Solve for what puts g on its targets, or G v at 0, to first order; the worst error before, -1 on failure.

    `right` then holds the scaled changes and impulses.
    """
    stand_still(joint, hinge, link, joints, local, bodies)
    clear(matrix, size, band)
    put_bodies(local, node, bodies, band, matrix)
    for i in range(size):
        right[i] = 0.0
    worst = 0.0
    for k in range(joints):
        joint_rows(joint, hinge, link, k, local, 1.0, one)
        scale_rows(link, hinge, local, k, one)
        if link[k, L_SOFT] == 0:
            put_rows(link, hinge, local, node, k, one, ROWS, band, matrix)
        for r in range(link[k, L_ROWS]):
            row = link[k, L_ROW] + r
            if link[k, L_SOFT] != 0 or not held(link, k, r):
                matrix[row, band] = 1.0
                continue
            error = 0.0
            if of_poses:
                error = one[VALUE, r] - hinge[k, TARGET + r]
            else:
                for end in range(2):
                    for c in range(3):
                        error += one[ROWS + r, 3 * end + c] * local[link[k, L_A + end], BEFORE + c]
            right[row] = -error * hinge[k, SCALE + r]
            worst = max(worst, abs(error) / hinge[k, SIZE])
    regularise(link, joints, LEAST_EPSILON, band, matrix)
    return worst if solve_banded(matrix, size, band, right) else -1.0


@kernel
def kinetic(local: FloatArray, bodies: int, column: int) -> float:
    """Kinetic energy of what joints can move, of the velocities at `column`."""
    total = 0.0
    for i in range(bodies):
        for c in range(3):
            if local[i, MOBILITY + c] > 0.0:
                total += 0.5 * local[i, column + c] ** 2 / local[i, MOBILITY + c]
    return total


@kernel
def project_velocities(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    band: int, size: int, matrix: FloatArray, right: FloatArray, one: FloatArray,
) -> float:  # fmt: skip
    """Take from BEFORE what violates held rows, and let go of limits that would pull; the kinetic energy lost."""
    energy = kinetic(local, bodies, BEFORE)
    for i in range(bodies):
        for c in range(3):
            local[i, KEPT + c] = local[i, BEFORE + c]
    for _ in range(joints + 1):
        for k in range(joints):
            hinge[k, PUSHED] = hinge[k, PUSHED + 1] = 0.0
        for _ in range(2):  # the second takes back what epsilon left
            if correction(joint, hinge, link, joints, local, node, bodies, False, band, size, matrix, right, one) < 0.0:
                break
            for k in range(joints):
                for r in range(link[k, L_ROWS]):
                    hinge[k, PUSHED + r] += right[link[k, L_ROW] + r] * hinge[k, SCALE + r]
            for i in range(bodies):
                for c in range(node[i, FREEDOMS]):
                    local[i, BEFORE + c] += right[node[i, COLUMN] + c] * np.sqrt(local[i, MOBILITY + c])
        pulling, pull = -1, 0.0
        for k in range(joints):
            last = link[k, L_ROWS] - 1
            if last >= 0 and hinge[k, PUSHED + last] * link[k, L_SIDE] > pull and link[k, L_SOFT] == 0:
                pulling, pull = k, hinge[k, PUSHED + last] * link[k, L_SIDE]
        if pulling < 0:
            break
        link[pulling, L_SIDE] = 0
        for i in range(bodies):
            for c in range(3):
                local[i, BEFORE + c] = local[i, KEPT + c]
    return energy - kinetic(local, bodies, BEFORE)


@kernel
def close_joints(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    band: int, size: int, matrix: FloatArray, right: FloatArray, one: FloatArray,
) -> None:  # fmt: skip
    """Move the bodies along M^-1 G^T until g is at its targets."""
    for _ in range(8):
        worst = correction(joint, hinge, link, joints, local, node, bodies, True, band, size, matrix, right, one)
        if not worst > 1e-14:
            return
        for i in range(bodies):
            for c in range(node[i, FREEDOMS]):
                local[i, POSE + c] += right[node[i, COLUMN] + c] * np.sqrt(local[i, MOBILITY + c])
            local[i, COS], local[i, SIN] = np.cos(local[i, POSE + 2]), np.sin(local[i, POSE + 2])
