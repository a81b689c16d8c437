"""The start of a step: what joints shall reach; after the user's changes, joints closed and velocities made to fit."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .bounds import approach, bounded, gap
from .entries import held
from .layout import (
    ERROR_BIAS,
    GEAR,
    GROOVE,
    IMPULSE_1,
    IMPULSE_2,
    LAST_STEP,
    LED,
    LENGTH,
    MAX_BIAS,
    MAX_FORCE,
    MOTOR,
    PIN,
    RATCHET,
    RATE,
    ROTARY_LIMIT,
    ROTARY_SPRING,
    SIDE,
    SLIDE,
    SOFT,
    SPRING,
    TOUCHED,
    WORK,
)
from .rows import joint_rows
from .scratch import (
    APART,
    BEFORE,
    BOUND,
    BOUNDED,
    BOXED,
    FREE,
    L_A,
    L_JOINT,
    L_KIND,
    L_ROWS,
    L_SIDE,
    L_SOFT,
    LAM,
    LEAD,
    MOBILITY,
    POSE,
    POSES,
    SAVED,
    SCALE,
    SHIFT,
    SIZE,
    TARGET,
    TOTAL,
    VALUE,
)
from .solve import begin

APART_FROM = 1e-10  # joints farther apart than this, over the size of the island, close at their own rate


@uncounted
def read_joints(
    joint: FloatArray, tie: IntArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, h: float,
    length: float, boxes: int,
) -> int:  # fmt: skip
    """Fill in what the joints bring from before. Rows of bounded impulses are boxed if they are `boxes` at most.

    Returns 0, plus 1 if a joint was touched, plus 2 if a soft joint needs its target.
    """
    touched, soft, bounded = 0, 0, 0
    for k in range(joints):
        j, kind = link[k, L_JOINT], link[k, L_KIND]
        link[k, L_SIDE] = tie[j, SIDE]
        is_soft = tie[j, SOFT] != 0 and kind not in (SPRING, ROTARY_SPRING)
        link[k, L_SOFT] = BOUNDED if kind == MOTOR or is_soft else 0
        bounded += link[k, L_ROWS] if link[k, L_SOFT] != 0 else 0
        warm = 0.0 if joint[j, LAST_STEP] == 0.0 else h / joint[j, LAST_STEP]
        hinge[k, LAM], hinge[k, LAM + 1] = joint[j, IMPULSE_1] * warm, joint[j, IMPULSE_2] * warm
        hinge[k, TOTAL] = hinge[k, TOTAL + 1] = 0.0
        hinge[k, TARGET] = hinge[k, TARGET + 1] = hinge[k, SCALE] = hinge[k, SCALE + 1] = 0.0
        hinge[k, BOUND] = joint[j, MAX_FORCE]
        hinge[k, SIZE] = 1.0 if kind >= GEAR else length
        joint[j, WORK] = 0.0
        # Bodies that were put elsewhere start as those that are new: they go the same ways again, bit by bit.
        edited = tie[j, TOUCHED] == 1
        for end in range(2):
            for c in range(3):
                local[link[k, L_A + end], LEAD + c] = 0.0 if edited else joint[j, LED + 3 * end + c]
        if kind == MOTOR:
            hinge[k, TARGET] = -joint[j, RATE]
        elif is_soft:
            soft = 2
        if tie[j, TOUCHED] != 0:
            touched = 1
    for k in range(joints if bounded <= boxes else 0):
        if link[k, L_SOFT] != 0:
            link[k, L_SOFT] = BOXED
    return touched + soft


@uncounted
def look(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    stiff: FloatArray,
) -> None:  # fmt: skip
    """Compute rows and values of all joints at the present poses, of soft ones too."""
    begin(int(POSES), joint, hinge, link, joints, local, node, bodies, 2.0)
    for k in range(joints):
        soft = link[k, L_SOFT]
        link[k, L_SOFT] = 0
        joint_rows(joint, hinge, link, k, local, 2.0, False, stiff)
        link[k, L_SOFT] = soft


@uncounted
def share(joint: FloatArray, j: int, error: float, h: float) -> float:
    """The share of an error that native takes back in a step h: 1 - error_bias^h, not faster than max_bias."""
    part = 1.0 - joint[j, ERROR_BIAS] ** h
    return float(min(part, joint[j, MAX_BIAS] * h / error)) if error > 0.0 else part


@uncounted
def soft_targets(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, h: float
) -> None:
    """Speeds at which soft joints close, and which soft limits act: those beyond their bound or about to pass it.

    Rows must be those of the present poses.
    """
    for k in range(joints):
        kind, j, rows = link[k, L_KIND], link[k, L_JOINT], link[k, L_ROWS]
        if link[k, L_SOFT] == 0 or kind == MOTOR:
            continue
        link[k, L_SIDE] = 0
        for side in (-1, 1):
            if not bounded(joint, link, k, side) or link[k, L_SIDE] != 0:
                continue
            room = gap(joint, hinge, link, k, side)
            if room <= 0.0 or room + h * approach(hinge, link, k, side, local, BEFORE) < 0.0:
                link[k, L_SIDE] = side
                speed = room / h if room > 0.0 else share(joint, j, -room, h) * room / h
                hinge[k, TARGET + rows - 1] = side * speed
        if kind in (SLIDE, ROTARY_LIMIT, RATCHET):
            continue
        if kind == GROOVE:
            rows = 1
        elif kind == PIN:
            hinge[k, VALUE] = np.sqrt(hinge[k, APART] ** 2 + hinge[k, APART + 1] ** 2) - joint[j, LENGTH]
        error = abs(hinge[k, VALUE])
        if rows == 2:
            error = np.sqrt(error * error + hinge[k, VALUE + 1] ** 2)
        for r in range(rows):
            hinge[k, TARGET + r] = -hinge[k, VALUE + r] * share(joint, j, error, h) / h


@uncounted
def find_apart(
    joint: FloatArray, tie: IntArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, h: float,
    stiff: FloatArray,
) -> int:  # fmt: skip
    """After the user's changes: targets of joints that are apart, one step's share nearer, and limits that are passed.

    Rows must be those of the present poses. Joints that will still be apart keep TOUCHED = 2, and hold the rest of
    their error over the step, so that it does no work; or 3 if a step has left them so. Those that give way elastically
    stay as they are. Returns 1 if a touch is fresh, plus 2 if a joint is to be closed, plus 4 if only steps have left
    any so.
    """
    fresh, apart, own = 0, 0, 4
    for k in range(joints):
        j, rows = link[k, L_JOINT], link[k, L_ROWS]
        if tie[j, TOUCHED] == 1:
            fresh = 1
        was = tie[j, TOUCHED]
        tie[j, TOUCHED] = 0
        if link[k, L_SOFT] != 0 or rows == 0:
            continue
        for side in (-1, 1):
            if bounded(joint, link, k, side):
                room = gap(joint, hinge, link, k, side)
                if room < -APART_FROM * hinge[k, SIZE]:
                    link[k, L_SIDE] = side
                elif link[k, L_SIDE] == side and room > APART_FROM * hinge[k, SIZE]:
                    link[k, L_SIDE] = 0
        joint_rows(joint, hinge, link, k, local, 2.0, False, stiff)
        error = 0.0
        for r in range(rows):
            if held(link, k, r):
                error += hinge[k, VALUE + r] ** 2
        error = np.sqrt(error)
        if error > APART_FROM * hinge[k, SIZE] and was == 4:
            tie[j, TOUCHED] = 4
        elif error > APART_FROM * hinge[k, SIZE]:
            apart = 2
            left = 1.0 - share(joint, j, error, h)
            for r in range(rows):
                hinge[k, TARGET + r] = hinge[k, VALUE + r] * left
            tie[j, TOUCHED] = 0 if not left > 0.0 else 3 if was == 3 else 2
            own = own if was == 3 else 0
    return fresh + apart + (own if fresh == 0 else 0)


@uncounted
def farthest(hinge: FloatArray, link: IntArray, joints: int) -> float:
    """The largest error of a held row, over the size of the island. Rows must be those of the present poses."""
    worst = 0.0
    for k in range(joints):
        for r in range(link[k, L_ROWS]):
            if link[k, L_SOFT] == 0 and held(link, k, r):
                worst = max(worst, abs(hinge[k, VALUE + r]) / hinge[k, SIZE])
    return worst


@uncounted
def closing_work(local: FloatArray, bodies: int) -> float:
    """The work of closing, from SAVED to POSE, against the bodies' accelerations."""
    work = 0.0
    for i in range(bodies):
        for c in range(3):
            if local[i, MOBILITY + c] > 0.0:
                work -= local[i, FREE + c] * (local[i, POSE + c] - local[i, SAVED + c]) / local[i, MOBILITY + c]
    return work


@uncounted
def keep_closed(hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, bodies: int) -> None:
    """Note how far closing has shifted bodies, and let joints hold what it reached."""
    for i in range(bodies):
        for c in range(3):
            if local[i, MOBILITY + c] > 0.0:
                local[i, SHIFT + c] = local[i, POSE + c] - local[i, SAVED + c]
    for k in range(joints):
        for r in range(link[k, L_ROWS]):
            if hinge[k, TARGET + r] != 0.0 and link[k, L_SOFT] == 0 and held(link, k, r):
                hinge[k, TARGET + r] = hinge[k, VALUE + r]
