"""Velocities made to fit the joints, as an impact does at which nothing bounces."""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .bounds import TOUCH, approach, bounded, gap
from .scratch import BEFORE, KEPT, L_ROWS, L_SIDE, L_SOFT, MOBILITY, PUSHED, SIZE, SPEEDS
from .solve import solve


@uncounted
def kinetic(local: FloatArray, bodies: int, column: int) -> float:
    """Kinetic energy of what joints can move, of the velocities at `column`."""
    total = 0.0
    for i in range(bodies):
        for c in range(3):
            if local[i, MOBILITY + c] > 0.0:
                total += 0.5 * local[i, column + c] ** 2 / local[i, MOBILITY + c]
    return total


@uncounted
def project_velocities(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    length: float, condensed: bool, band: int, size: int, matrix: FloatArray, right: FloatArray, stiff: FloatArray,
    found: FloatArray,
) -> float:  # fmt: skip
    """Take from BEFORE what violates held rows, let go of limits that would pull; the kinetic energy lost, >= 0.

    Limits that are closed and closing are held first. Kinetic energy only falls, and momentum stays.
    """
    energy = kinetic(local, bodies, BEFORE)
    for i in range(bodies):
        for c in range(3):
            local[i, KEPT + c] = local[i, BEFORE + c]
    tries, passes = 0, 0
    while tries <= joints:
        if passes == 0:
            for k in range(joints):
                hinge[k, PUSHED] = hinge[k, PUSHED + 1] = 0.0
        if solve(
            int(SPEEDS), joint, hinge, link, joints, local, node, bodies, 2.0, length, condensed, 0.0, condensed, band,
            size, matrix, right, stiff, found,
        ) < 0:  # fmt: skip
            break
        passes += 1
        if passes == 1 and tries == 0 and touch(joint, hinge, link, joints, local):
            back(local, bodies)
            passes, tries = 0, 1
            continue
        if passes < 3 and found[2] > 0.0:  # the later ones take back what epsilon left
            continue
        pulling, pull = -1, 0.0
        for k in range(joints):
            last = link[k, L_ROWS] - 1
            if last >= 0 and hinge[k, PUSHED + last] * link[k, L_SIDE] > pull and link[k, L_SOFT] == 0:
                pulling, pull = k, hinge[k, PUSHED + last] * link[k, L_SIDE]
        if pulling < 0:
            break
        link[pulling, L_SIDE] = 0
        back(local, bodies)
        passes, tries = 0, tries + 1
    return energy - kinetic(local, bodies, BEFORE)


@uncounted
def back(local: FloatArray, bodies: int) -> None:
    """Take the velocities that were kept."""
    for i in range(bodies):
        for c in range(3):
            local[i, BEFORE + c] = local[i, KEPT + c]


@uncounted
def touch(joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray) -> bool:
    """Hold all free limits whose gap is closed and was closing with the kept velocities; whether there were any.

    Rows are those of the present poses.
    """
    found = False
    for k in range(joints):
        if link[k, L_SIDE] == 0 and link[k, L_SOFT] == 0:
            for side in (-1, 1):
                closed = bounded(joint, link, k, side) and gap(joint, hinge, link, k, side) <= TOUCH * hinge[k, SIZE]
                if closed and approach(hinge, link, k, side, local, KEPT) < 0.0:
                    link[k, L_SIDE] = side
                    found = True
    return found
