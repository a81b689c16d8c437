"""The start of a step: what joints shall reach, joints that are apart closed at native's rate, velocities made to fit."""

from __future__ import annotations

import numpy as np

from ..compiled import kernel
from .correct import close_joints, project_velocities, stand_still
from .layout import (
    CLOSED,
    ERROR_BIAS,
    GEAR,
    GROOVE,
    IMPULSE_1,
    IMPULSE_2,
    LAST_STEP,
    LENGTH,
    MAX_BIAS,
    MAX_FORCE,
    MOTOR,
    PIN,
    PROJECTED,
    PUSH,
    RATE,
    REST,
    ROTARY_SPRING,
    SIDE,
    SOFT,
    SPRING,
    STIFFNESS,
    TOUCHED,
    WORK,
)  # fmt: skip
from .limits import approach, bounded, gap
from .newton import held
from .rows import joint_rows
from .scratch import (
    APART,
    BEFORE,
    BEGAN,
    BOUND,
    FREE,
    L_JOINT,
    L_KIND,
    L_ROWS,
    L_SIDE,
    L_SOFT,
    LAM,
    MOBILITY,
    POSE,
    SAVED,
    SIZE,
    TARGET,
    TOTAL,
    VALUE,
    FloatArray,
    IntArray,
)  # fmt: skip

APART_FROM = 1e-10  # joints farther apart than this, over the size of the island, close at their own rate


@kernel
def read_joints(
    joint: FloatArray, tie: IntArray, hinge: FloatArray, link: IntArray, joints: int, h: float, length: float,
    loops: bool,
) -> bool:  # fmt: skip
    """Fill in what the joints bring from before; whether one was touched. Redundant rows begin without impulse."""
    touched = False
    for k in range(joints):
        j = link[k, L_JOINT]
        kind = link[k, L_KIND]
        link[k, L_SIDE] = tie[j, SIDE]
        spring = kind in (SPRING, ROTARY_SPRING)
        link[k, L_SOFT] = 1 if kind == MOTOR or (tie[j, SOFT] != 0 and not spring) else 0
        warm = 0.0 if loops or joint[j, LAST_STEP] == 0.0 else h / joint[j, LAST_STEP]
        hinge[k, LAM], hinge[k, LAM + 1] = joint[j, IMPULSE_1] * warm, joint[j, IMPULSE_2] * warm
        hinge[k, TOTAL] = hinge[k, TOTAL + 1] = 0.0
        hinge[k, TARGET] = hinge[k, TARGET + 1] = 0.0
        hinge[k, BOUND] = joint[j, MAX_FORCE]
        hinge[k, SIZE] = 1.0 if kind >= GEAR else length
        joint[j, WORK] = 0.0
        if kind == MOTOR:
            hinge[k, TARGET] = -joint[j, RATE]
        touched = touched or tie[j, TOUCHED] != 0
    return touched


@kernel
def shares(joint: FloatArray, j: int, error: float, h: float) -> float:
    """The share of an error that native takes back in a step h: 1 - error_bias^h, not faster than max_bias."""
    share = 1.0 - joint[j, ERROR_BIAS] ** h
    return min(share, joint[j, MAX_BIAS] * h / error) if error > 0.0 else share


@kernel
def soft_targets(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, h: float, one: FloatArray
) -> None:
    """Speeds at which soft joints close, and which soft limits act: those beyond their bound or about to pass it."""
    for k in range(joints):
        if link[k, L_SOFT] == 0 or link[k, L_KIND] == MOTOR:
            continue
        j = link[k, L_JOINT]
        link[k, L_SIDE] = 0
        for side in (-1, 1):
            if not bounded(joint, link, k, side):
                continue
            room = gap(joint, hinge, link, k, side, local, 1.0, one)
            rate = approach(link, k, side, local, BEFORE, one)
            if room <= 0.0 or room + h * rate < 0.0:
                link[k, L_SIDE] = side
                speed = room / h if room > 0.0 else -shares(joint, j, -room, h) * -room / h
                hinge[k, TARGET + link[k, L_ROWS] - 1] = side * speed
                break
        if (bounded(joint, link, k, 1) and link[k, L_KIND] != GROOVE) or (
            bounded(joint, link, k, -1) and link[k, L_ROWS] == 1
        ):
            continue
        link[k, L_SOFT] = 0
        joint_rows(joint, hinge, link, k, local, 1.0, one)
        link[k, L_SOFT] = 1
        rows = 1 if link[k, L_KIND] == GROOVE else link[k, L_ROWS]
        if link[k, L_KIND] == PIN:
            one[VALUE, 0] = np.sqrt(hinge[k, APART] ** 2 + hinge[k, APART + 1] ** 2) - joint[j, LENGTH]
        error = abs(one[VALUE, 0])
        if rows == 2:
            error = np.sqrt(error * error + one[VALUE, 1] ** 2)
        for r in range(rows):
            hinge[k, TARGET + r] = -one[VALUE, r] * shares(joint, j, error, h) / h


@kernel
def springs_hold(joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int) -> float:
    """The energy that springs hold at the start."""
    total = 0.0
    for k in range(joints):
        j, kind = link[k, L_JOINT], link[k, L_KIND]
        if kind in (SPRING, ROTARY_SPRING):
            at = hinge[k, BEGAN]
            total += 0.5 * joint[j, STIFFNESS] * (at - joint[j, REST]) ** 2
            total += joint[j, PUSH] * at * (-1.0 if kind == SPRING else 1.0)
    return total


@kernel
def fit(
    joint: FloatArray, tie: IntArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray,
    node: IntArray, bodies: int, h: float, band: int, size: int, matrix: FloatArray, right: FloatArray,
    one: FloatArray, ledger: FloatArray,
) -> None:  # fmt: skip
    """After the user's changes: close what is apart by one step's share, and take velocities that violate joints.

    Joints still apart keep TOUCHED = 2 and hold the rest of their error over the step, so that it does no work.
    """
    stand_still(joint, hinge, link, joints, local, bodies)
    stored = springs_hold(joint, hinge, link, joints)
    fresh, apart = False, False
    for k in range(joints):
        j, rows = link[k, L_JOINT], link[k, L_ROWS]
        fresh = fresh or tie[j, TOUCHED] == 1
        tie[j, TOUCHED] = 0
        if link[k, L_SOFT] != 0 or rows == 0:
            continue
        for side in (-1, 1):
            if bounded(joint, link, k, side):
                if gap(joint, hinge, link, k, side, local, 1.0, one) < -APART_FROM * hinge[k, SIZE]:
                    link[k, L_SIDE] = side
                elif link[k, L_SIDE] == side and one[VALUE, rows - 1] * side < -APART_FROM * hinge[k, SIZE]:
                    link[k, L_SIDE] = 0
        joint_rows(joint, hinge, link, k, local, 1.0, one)
        error = 0.0
        for r in range(rows):
            if held(link, k, r):
                error += one[VALUE, r] ** 2
        error = np.sqrt(error)
        if error > APART_FROM * hinge[k, SIZE]:
            apart = True
            left = 1.0 - shares(joint, j, error, h)
            for r in range(rows):
                hinge[k, TARGET + r] = one[VALUE, r] * left
            tie[j, TOUCHED] = 2 if left > 0.0 else 0
    if apart:
        close_joints(joint, hinge, link, joints, local, node, bodies, band, size, matrix, right, one)
        stand_still(joint, hinge, link, joints, local, bodies)
        for i in range(bodies):
            for c in range(3):
                if local[i, MOBILITY + c] > 0.0:
                    way = local[i, POSE + c] - local[i, SAVED + c]
                    ledger[CLOSED] -= local[i, FREE + c] * way / local[i, MOBILITY + c]
        ledger[CLOSED] += springs_hold(joint, hinge, link, joints) - stored
        for k in range(joints):  # hold what closing reached
            if link[k, L_SOFT] == 0 and link[k, L_ROWS] > 0:
                joint_rows(joint, hinge, link, k, local, 1.0, one)
                for r in range(link[k, L_ROWS]):
                    if abs(hinge[k, TARGET + r]) > 0.0 and held(link, k, r):
                        hinge[k, TARGET + r] = one[VALUE, r]
    if fresh:
        ledger[PROJECTED] += project_velocities(
            joint, hinge, link, joints, local, node, bodies, band, size, matrix, right, one
        )
