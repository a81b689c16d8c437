"""The implicit step of an island: Newton's iteration, and the linear step that always succeeds."""

from __future__ import annotations

import numpy as np

from ..compiled import kernel
from .banded import solve_banded
from .motion import move, settle
from .newton import assemble, held
from .rows import joint_rows, start_joint
from .scratch import (
    AFTER,
    BEFORE,
    COLUMN,
    FREE,
    FREEDOMS,
    GOT,
    L_A,
    L_ROW,
    L_ROWS,
    L_SOFT,
    LAM,
    MOBILITY,
    ROWS,
    SCALE,
    WAY,
    FloatArray,
    IntArray,
)  # fmt: skip

TOLERANCE = 2e-15  # of joints, over the size of the island
FLOOR = 1e-11  # below this, an error that no longer halves is round-off
MOST_ITERATIONS = 25
LEAST_EPSILON = 1e-10


@kernel
def clear(matrix: FloatArray, size: int, band: int) -> None:
    """Zero what `solve_banded` reads."""
    for i in range(size):
        for c in range(3 * band + 1):
            matrix[i, c] = 0.0


@kernel
def balance(local: FloatArray, node: IntArray, bodies: int, h: float, length: float, right: FloatArray) -> float:
    """Residuals of the balance of momentum, scaled, into `right`; the worst as a way, over length or as an angle."""
    worst = 0.0
    for i in range(bodies):
        for c in range(node[i, FREEDOMS]):
            mobility = local[i, MOBILITY + c]
            off = local[i, AFTER + c] - local[i, BEFORE + c] - h * local[i, FREE + c] - mobility * local[i, GOT + c]
            right[node[i, COLUMN] + c] = -off / np.sqrt(mobility) if mobility > 0.0 else 0.0
            worst = max(worst, abs(off * h) / (length if c < 2 else 1.0))
    return worst


@kernel
def apply(
    link: IntArray, hinge: FloatArray, joints: int, local: FloatArray, node: IntArray, bodies: int, right: FloatArray
) -> None:
    """Add the solution of a scaled system to velocities at the end and impulses."""
    for i in range(bodies):
        for c in range(node[i, FREEDOMS]):
            local[i, AFTER + c] += right[node[i, COLUMN] + c] * np.sqrt(local[i, MOBILITY + c])
    for k in range(joints):
        for r in range(link[k, L_ROWS]):
            hinge[k, LAM + r] += right[link[k, L_ROW] + r] * hinge[k, SCALE + r]


@kernel
def regularise(link: IntArray, joints: int, epsilon: float, band: int, matrix: FloatArray) -> None:
    """Add epsilon to the diagonal of the impulses' block."""
    for k in range(joints):
        for r in range(link[k, L_ROWS]):
            matrix[link[k, L_ROW] + r, band] += epsilon


@kernel
def guess(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, bodies: int, h: float
) -> None:
    """Begin a step: what stays the same over it, and free motion as first iterate."""
    for k in range(joints):
        start_joint(joint, hinge, link, k, local, h)
    for i in range(bodies):
        for c in range(3):
            local[i, AFTER + c] = local[i, BEFORE + c] + h * local[i, FREE + c]
    move(local, bodies, h)


@kernel
def newton_step(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    h: float, length: float, loops: bool, give: float, band: int, size: int, matrix: FloatArray, right: FloatArray,
    one: FloatArray,
) -> int:  # fmt: skip
    """Solve the step from the present LAM; the number of iterations, -1 if they do not converge.

    At convergence g is within 2e-15 of the island's size (or at round-off) of its targets, and the balance of momentum
    holds to round-off. A step is given up after 25 iterations, or 6 in which the error did not fall.
    """
    guess(joint, hinge, link, joints, local, bodies, h)
    best, stalls = 1e300, 0
    for iteration in range(MOST_ITERATIONS + 1):
        clear(matrix, size, band)
        worst = assemble(
            joint, hinge, link, joints, local, node, bodies, h, give, iteration == 0, band, matrix, right, one
        )
        worst = max(worst, balance(local, node, bodies, h, length, right))
        if iteration > 0 and (worst <= TOLERANCE or (iteration > 1 and worst > 0.5 * best and best < FLOOR)):
            settle(local, bodies, h)
            return iteration
        if worst < best:
            best = worst
        elif iteration > 3:
            stalls += 1
        if not worst < 1e100 or stalls > 6 or iteration == MOST_ITERATIONS:
            return -1
        if loops:
            regularise(link, joints, max(LEAST_EPSILON, min(1e-2, worst)), band, matrix)
        if not solve_banded(matrix, size, band, right):
            return -1
        apply(link, hinge, joints, local, node, bodies, right)
        move(local, bodies, h)
    return -1


@kernel
def linear_step(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    h: float, band: int, size: int, matrix: FloatArray, right: FloatArray, one: FloatArray,
) -> bool:  # fmt: skip
    """One linear system: rows of the start with J (v0 + v1) = 0, springs linearised. Last rung of the ladder."""
    guess(joint, hinge, link, joints, local, bodies, h)
    for i in range(bodies):
        for c in range(node[i, FREEDOMS]):
            local[i, AFTER + c] = -local[i, BEFORE + c]
    for k in range(joints):
        hinge[k, LAM] = hinge[k, LAM + 1] = 0.0
    move(local, bodies, h)
    clear(matrix, size, band)
    assemble(joint, hinge, link, joints, local, node, bodies, h, 0.0, True, band, matrix, right, one)
    balance(local, node, bodies, h, 1.0, right)
    for k in range(joints):
        if link[k, L_SOFT] != 0:
            continue
        joint_rows(joint, hinge, link, k, local, h, one)
        for r in range(link[k, L_ROWS]):
            if held(link, k, r):
                way = 0.0
                for c in range(3):
                    for end in range(2):
                        way += one[ROWS + r, 3 * end + c] * local[link[k, L_A + end], WAY + c]
                right[link[k, L_ROW] + r] = -way * hinge[k, SCALE + r] * 2.0 / h
    regularise(link, joints, 1e-8, band, matrix)
    if not solve_banded(matrix, size, band, right):
        return False
    apply(link, hinge, joints, local, node, bodies, right)
    move(local, bodies, h)
    for i in range(bodies):
        for c in range(3):
            if not abs(local[i, AFTER + c]) < 1e100:
                return False
    return True
