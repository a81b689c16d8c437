"""The start of a step: what joints keep from the last one, and their targets."""

from __future__ import annotations

import numpy as np

from ..compiled import nonallocating
from ..compiled.records import Rows
from ..model.joint_steps import POSES
from ..model.joints import GEAR, GROOVE, MOTOR, PIN, ROTARY_SPRING, SPRING, Joint, Workspace
from ..model.parameters.joints import STALLED
from ..newton.entries import is_limit
from ..newton.rows import joint_rows, unit_of
from ..newton.springs import potential
from ..newton.systems import first_iterate
from .bounds import limit_gap, limit_gap_rate


@nonallocating
def release_limits(W: Workspace) -> None:
    """At one instant: let no limit act, until velocities show which of them close."""
    for k in range(W.joints):
        W.link[k].side = W.link[k].let_go = 0
        W.J.HINGE[k].target[0] = W.J.HINGE[k].target[1] = 0.0


@nonallocating
def spring_torque(W: Workspace, k: int, extent: float) -> float:
    """The scale of the torque of joint k, a spring, with arms of the size `extent` of the component."""
    joint, link = W.J.JOINT[W.link[k].joint], W.link[k]
    if link.kind == SPRING:
        return float(extent * (abs(joint.push) + joint.stiffness * extent))
    turned = W.J.LOCAL[link.body[0]].pose[2] - W.J.LOCAL[link.body[1]].pose[2] - joint.rest
    return float(abs(joint.push) + joint.stiffness * abs(turned))


@nonallocating
def load_of(W: Workspace, h: float, extent: float) -> float:
    """The scale of the work of forces on a component over its size `extent`, and of torques: of accelerations, springs,
    and bounded joints in a step h."""
    total = 0.0
    for i in range(W.bodies):
        for c in range(3):
            if W.J.LOCAL[i].mobility[c] > 0.0:
                arm = 1.0 if c == 2 else extent
                total += arm * abs(W.J.LOCAL[i].acceleration[c]) / W.J.LOCAL[i].mobility[c]
    for k in range(W.joints):
        if W.link[k].kind in (SPRING, ROTARY_SPRING):
            total += spring_torque(W, k, extent)
        elif W.link[k].bounded != 0:
            arm = 1.0 if W.link[k].kind >= GEAR else extent
            total += arm * (abs(W.J.HINGE[k].total[0]) + abs(W.J.HINGE[k].total[1])) / h
    return total


@nonallocating
def most_impulse(W: Workspace, h: float, extent: float) -> float:
    """The scale of angular momentum in a component over a step h, with arms of its size `extent`: the sum of the
    magnitudes of momenta, of those by accelerations, springs and bounded joints, and of what motors, or partners with
    their velocities, would transfer; times the ratios of all gears."""
    total, geared, mass, moment, speed, spin = 0.0, 1.0, 0.0, 0.0, 0.0, 0.0
    for i in range(W.bodies):
        local = W.J.LOCAL[i]
        for c in range(3):
            if local.mobility[c] > 0.0:
                arm = 1.0 if c == 2 else extent
                total += arm * (abs(local.v0[c]) + abs(h * local.acceleration[c])) / local.mobility[c]
            elif c == 2:
                spin = max(spin, abs(local.v0[c]))
            else:
                speed = max(speed, abs(local.v0[c]))
        mass += 1.0 / local.mobility[0] if local.mobility[0] > 0.0 else 0.0
        moment += 1.0 / local.mobility[2] if local.mobility[2] > 0.0 else 0.0
    total += extent * mass * (speed + spin * extent) + moment * spin
    for k in range(W.joints):
        joint, kind, turning = W.J.JOINT[W.link[k].joint], W.link[k].kind, 0.0
        a, b = W.J.LOCAL[W.link[k].body[0]], W.J.LOCAL[W.link[k].body[1]]
        if kind in (SPRING, ROTARY_SPRING):
            turning = abs(h) * spring_torque(W, k, extent)
        elif joint.finite_force != 0:
            turning = abs(h) * joint.max_force * (1.0 if kind >= GEAR else extent)
        elif kind == MOTOR and a.mobility[2] + b.mobility[2] > 0.0:
            turning = abs(joint.rate) / (a.mobility[2] + b.mobility[2])
        elif kind == GEAR:
            geared *= max(abs(joint.ratio), 1.0 / abs(joint.ratio))
        total += turning
    return geared * total


@nonallocating
def bound_motors(W: Workspace, h: float, extent: float) -> None:
    """Bound the torque of motors of unlimited force by STALLED times `most_impulse`: if a motor drives against a limit,
    no finite impulse satisfies both."""
    most = -1.0
    for k in range(W.joints):
        if W.link[k].kind == MOTOR and not W.J.HINGE[k].bound < np.inf:
            most = STALLED * most_impulse(W, h, extent) / abs(h) if most < 0.0 else most
            W.J.HINGE[k].bound = most


@nonallocating
def read_joints(W: Workspace, h: float, extent: float) -> tuple[bool, bool]:
    """Read what joints keep from the last step: impulses, scaled to the length h of this one, `lead`, the limits on
    which they stand. Returns whether a joint was `touched`, and whether there is a bounded joint other than a motor,
    whose target `bounded_targets` sets."""
    joint, hinge, link = W.J.JOINT, W.J.HINGE, W.link
    touched, bounded = False, False
    for k in range(W.joints):
        j, kind = link[k].joint, link[k].kind
        link[k].side, link[k].let_go = joint[j].side, 0
        warm = 0.0 if joint[j].last_step == 0.0 else h / joint[j].last_step
        hinge[k].lam[0], hinge[k].lam[1] = joint[j].impulse[0] * warm, joint[j].impulse[1] * warm
        hinge[k].total[0] = hinge[k].total[1] = 0.0
        hinge[k].target[0] = hinge[k].target[1] = hinge[k].scale[0] = hinge[k].scale[1] = 0.0
        hinge[k].bound = joint[j].max_force
        hinge[k].unit = unit_of(joint[j], extent)
        for end in range(2):
            for c in range(3):
                W.J.LOCAL[link[k].body[end]].lead[c] = joint[j].led[end, c]
        if kind == MOTOR:
            hinge[k].target[0] = -joint[j].rate
        bounded = bounded or (link[k].bounded != 0 and kind != MOTOR)
        touched = touched or joint[j].touched != 0
    bound_motors(W, h, extent)
    return touched, bounded


@nonallocating
def compute_rows(W: Workspace) -> None:
    """Compute rows and values g of all joints at the present poses; bounded ones as if they held exactly."""
    link = W.link
    first_iterate(W, POSES, 2.0)
    for k in range(W.joints):
        bounded = link[k].bounded
        link[k].bounded = 0
        joint_rows(W, k, 2.0, False)
        link[k].bounded = bounded


@nonallocating
def springs_of(W: Workspace) -> float:
    """Energy stored in springs at the present poses; `compute_rows` is called first."""
    compute_rows(W)
    total = 0.0
    for k in range(W.joints):
        joint, kind = W.J.JOINT[W.link[k].joint], W.link[k].kind
        if kind in (SPRING, ROTARY_SPRING):
            sign = 1.0 if kind == SPRING else -1.0
            at = sign * (W.J.HINGE[k].began - joint.rest)
            total += potential(joint.push, -joint.stiffness, joint.max_force, at)
    return total


@nonallocating
def closing_share(joint: Rows[Joint], j: int, error: float, h: float) -> float:
    """Share of the error of joint j that pymunk corrects in a step h: 1 - error_bias^h, at most at the speed max_bias.
    error: an amount of g, length or rad."""
    part = 1.0 - joint[j].error_bias ** h
    return float(min(part, joint[j].max_bias * h * unit_of(joint[j], 1.0) / error)) if error > 0.0 else part


@nonallocating
def bounded_targets(W: Workspace, h: float) -> None:
    """Set the speeds at which bounded joints close (`target`), and which bounded limits act (`side`): those beyond
    their bound or about to pass it. Rows must be those of the present poses."""
    joint, hinge, link = W.J.JOINT, W.J.HINGE, W.link
    for k in range(W.joints):
        kind, j, rows = link[k].kind, link[k].joint, link[k].rows
        if link[k].bounded == 0 or kind == MOTOR:
            continue
        link[k].side = 0
        for side in (-1, 1):
            room = limit_gap(W, k, side)
            a, b = W.J.LOCAL[link[k].body[0]], W.J.LOCAL[link[k].body[1]]
            passes = room <= 0.0 or room + h * limit_gap_rate(hinge[k], rows, side, a.v0, b.v0) < 0.0
            if passes and link[k].side == 0:
                link[k].side = side
                speed = room / h if room > 0.0 else closing_share(joint, j, -room, h) * room / h
                hinge[k].target[rows - 1] = side * speed
        if is_limit(kind):
            continue
        if kind == GROOVE:
            rows = 1
        elif kind == PIN:
            hinge[k].value[0] = np.sqrt(hinge[k].span[0] ** 2 + hinge[k].span[1] ** 2) - joint[j].length
        error = abs(hinge[k].value[0])
        if rows == 2:
            error = np.sqrt(error * error + hinge[k].value[1] ** 2)
        for r in range(rows):
            hinge[k].target[r] = -hinge[k].value[r] * closing_share(joint, j, error, h) / h
