"""The start of a step: what joints shall reach; after the user's changes, joints closed and velocities made to fit."""

from __future__ import annotations

import numpy as np

from ..compiled import nonallocating
from ..compiled.records import Rows
from ..model.joint_steps import POSES, BodyStep
from ..model.joints import (
    APART,
    BOUNDED,
    BOXED,
    EDITED,
    GEAR,
    GIVES_WAY,
    GROOVE,
    LEFT_APART,
    MOTOR,
    PIN,
    ROTARY_SPRING,
    SPRING,
    Joint,
    Workspace,
)
from ..model.parameters.joints import JOINT_APART
from .bounds import approach, bounded, gap
from .entries import held, is_limit
from .rows import joint_rows
from .solve import begin


@nonallocating
def read_joints(W: Workspace, h: float, length: float, boxes: int) -> int:
    """Fill in what the joints bring from before. Rows of bounded impulses are boxed if they are `boxes` at most.

    Returns 0, plus 1 if a joint was touched, plus 2 if a soft joint needs its target.
    """
    joint, hinge, link = W.J.JOINT, W.J.HINGE, W.link
    touched, soft, bounded = 0, 0, 0
    for k in range(W.joints):
        j, kind = link[k].joint, link[k].kind
        link[k].side = joint[j].side
        is_soft = joint[j].soft != 0 and kind not in (SPRING, ROTARY_SPRING)
        link[k].soft = BOUNDED if kind == MOTOR or is_soft else 0
        bounded += link[k].rows if link[k].soft != 0 else 0
        warm = 0.0 if joint[j].last_step == 0.0 else h / joint[j].last_step
        hinge[k].lam[0], hinge[k].lam[1] = joint[j].impulse[0] * warm, joint[j].impulse[1] * warm
        hinge[k].total[0] = hinge[k].total[1] = 0.0
        hinge[k].target[0] = hinge[k].target[1] = hinge[k].scale[0] = hinge[k].scale[1] = 0.0
        hinge[k].bound = joint[j].max_force
        hinge[k].size = 1.0 if kind >= GEAR else length
        joint[j].work = 0.0
        # Bodies that were put elsewhere start as those that are new: they go the same ways again, bit by bit.
        edited = joint[j].touched == EDITED
        for end in range(2):
            for c in range(3):
                W.J.LOCAL[link[k].body[end]].lead[c] = 0.0 if edited else joint[j].led[end, c]
        if kind == MOTOR:
            hinge[k].target[0] = -joint[j].rate
        elif is_soft:
            soft = 2
        if joint[j].touched != 0:
            touched = 1
    for k in range(W.joints if bounded <= boxes else 0):
        if link[k].soft != 0:
            link[k].soft = BOXED
    return touched + soft


@nonallocating
def look(W: Workspace) -> None:
    """Compute rows and values of all joints at the present poses, of soft ones too."""
    link = W.link
    begin(W, int(POSES), 2.0)
    for k in range(W.joints):
        soft = link[k].soft
        link[k].soft = 0
        joint_rows(W, k, 2.0, False)
        link[k].soft = soft


@nonallocating
def share(joint: Rows[Joint], j: int, error: float, h: float) -> float:
    """The share of an error that native takes back in a step h: 1 - error_bias^h, not faster than max_bias."""
    part = 1.0 - joint[j].error_bias ** h
    return float(min(part, joint[j].max_bias * h / error)) if error > 0.0 else part


@nonallocating
def soft_targets(W: Workspace, h: float) -> None:
    """Speeds at which soft joints close, and which soft limits act: those beyond their bound or about to pass it.

    Rows must be those of the present poses.
    """
    joint, hinge, link = W.J.JOINT, W.J.HINGE, W.link
    for k in range(W.joints):
        kind, j, rows = link[k].kind, link[k].joint, link[k].rows
        if link[k].soft == 0 or kind == MOTOR:
            continue
        link[k].side = 0
        for side in (-1, 1):
            if not bounded(joint, link, k, side) or link[k].side != 0:
                continue
            room = gap(joint, hinge, link, k, side)
            a, b = W.J.LOCAL[link[k].body[0]], W.J.LOCAL[link[k].body[1]]
            if room <= 0.0 or room + h * approach(hinge[k], rows, side, a.v0, b.v0) < 0.0:
                link[k].side = side
                speed = room / h if room > 0.0 else share(joint, j, -room, h) * room / h
                hinge[k].target[rows - 1] = side * speed
        if is_limit(kind):
            continue
        if kind == GROOVE:
            rows = 1
        elif kind == PIN:
            hinge[k].value[0] = np.sqrt(hinge[k].apart[0] ** 2 + hinge[k].apart[1] ** 2) - joint[j].length
        error = abs(hinge[k].value[0])
        if rows == 2:
            error = np.sqrt(error * error + hinge[k].value[1] ** 2)
        for r in range(rows):
            hinge[k].target[r] = -hinge[k].value[r] * share(joint, j, error, h) / h


@nonallocating
def find_apart(W: Workspace, h: float) -> int:
    """After the user's changes: targets of joints that are apart, one step's share nearer, and limits that are passed.

    Rows must be those of the present poses. Joints that will still be apart are APART, and hold the rest of their error
    over the step, so that it does no work; or LEFT_APART if a step has left them so. Those that give way elastically
    stay as they are. Returns 1 if a touch is fresh, plus 2 if a joint is to be closed, plus 4 if only steps have left
    any so.
    """
    joint, hinge, link = W.J.JOINT, W.J.HINGE, W.link
    fresh, apart, own = 0, 0, 4
    for k in range(W.joints):
        j, rows = link[k].joint, link[k].rows
        if joint[j].touched == EDITED:
            fresh = 1
        was = joint[j].touched
        joint[j].touched = 0
        if link[k].soft != 0 or rows == 0:
            continue
        for side in (-1, 1):
            if bounded(joint, link, k, side):
                room = gap(joint, hinge, link, k, side)
                if room < -JOINT_APART * hinge[k].size:
                    link[k].side = side
                elif link[k].side == side and room > JOINT_APART * hinge[k].size:
                    link[k].side = 0
        joint_rows(W, k, 2.0, False)
        error = 0.0
        for r in range(rows):
            if held(link, k, r):
                error += hinge[k].value[r] ** 2
        error = np.sqrt(error)
        if error > JOINT_APART * hinge[k].size and was == GIVES_WAY:
            joint[j].touched = GIVES_WAY
        elif error > JOINT_APART * hinge[k].size:
            apart = 2
            left = 1.0 - share(joint, j, error, h)
            for r in range(rows):
                hinge[k].target[r] = hinge[k].value[r] * left
            joint[j].touched = 0 if not left > 0.0 else LEFT_APART if was == LEFT_APART else APART
            own = own if was == LEFT_APART else 0
    return fresh + apart + (own if fresh == 0 else 0)


@nonallocating
def farthest(W: Workspace) -> float:
    """The largest error of a held row, over the size of the island. Rows must be those of the present poses."""
    link = W.link
    worst = 0.0
    for k in range(W.joints):
        for r in range(link[k].rows):
            if link[k].soft == 0 and held(link, k, r):
                worst = max(worst, abs(W.J.HINGE[k].value[r]) / W.J.HINGE[k].size)
    return worst


@nonallocating
def closing_work(local: Rows[BodyStep], bodies: int) -> float:
    """The work of closing, from the saved to the present poses, against the bodies' accelerations."""
    work = 0.0
    for i in range(bodies):
        for c in range(3):
            if local[i].mobility[c] > 0.0:
                work -= local[i].acceleration[c] * (local[i].pose[c] - local[i].saved_pose[c]) / local[i].mobility[c]
    return work


@nonallocating
def keep_closed(W: Workspace) -> None:
    """Note how far closing has shifted bodies, and let joints hold what it reached."""
    hinge, link, local = W.J.HINGE, W.link, W.J.LOCAL
    for i in range(W.bodies):
        for c in range(3):
            if local[i].mobility[c] > 0.0:
                local[i].shift[c] = local[i].pose[c] - local[i].saved_pose[c]
    for k in range(W.joints):
        for r in range(link[k].rows):
            if hinge[k].target[r] != 0.0 and link[k].soft == 0 and held(link, k, r):
                hinge[k].target[r] = hinge[k].value[r]
