"""Motion of the bodies of a component over a step, and back to its start."""

from __future__ import annotations

import numpy as np

from ..compiled import inlined, nonallocating
from ..compiled.records import Rows
from ..model.joint_steps import BodyStep
from ..model.joints import ComponentBody, Joints, Workspace


@inlined
def seat(local: BodyStep, joined: ComponentBody) -> None:
    """Copy the plan's values of a body to its scratch: its unknowns, how it turns, what acts on it, its joints."""
    local.column, local.freedoms = joined.column, joined.freedoms
    local.first, local.cayley = joined.first, joined.cayley
    local.acted = joined.acted


@nonallocating
def size_up(J: Joints, s: int, h: float) -> float:
    """Complete the scratch of the bodies of component s, whose pose, velocity and mobility are there: roots of
    mobilities, cosine and sine of the angle. Returns the component's size, the length by which errors of its joints are
    measured: its largest coordinate, way in h, anchor or radius of gyration, as round-off is relative to these."""
    component, local, extent = J.COMPONENT[s], J.LOCAL, 0.0
    for i in range(component.end_body - component.first_body):
        for c in range(3):
            root = np.sqrt(local[i].mobility[c])
            local[i].root[c], local[i].unroot[c] = root, 1.0 / root if root > 0.0 else 0.0
        local[i].cos, local[i].sin = np.cos(local[i].pose[2]), np.sin(local[i].pose[2])
        for c in range(2):
            extent = max(extent, abs(local[i].pose[c]), abs(h * local[i].v0[c]))
        extent = max(extent, local[i].root[0] * local[i].unroot[2])
    for k in range(component.first_joint, component.end_joint):
        joint = J.JOINT[J.COUPLING[k].joint]
        for c in range(2):
            extent = max(extent, abs(joint.anchor_a[c]), abs(joint.anchor_b[c]))
    return extent if extent > 0.0 else 1.0


@inlined
def move(local: Rows[BodyStep], bodies: int, h: float) -> None:
    """Fill in `way`, and `turn_cos`, `turn_sin`, `slope`, `lever`, from the present velocities v1 at the end of h. The
    angle itself is left to `find_turned`: an arctangent that joints between points do not need."""
    for i in range(bodies):
        for c in range(3):
            local[i].way[c] = 0.5 * h * (local[i].v0[c] + local[i].v1[c])
        chi = local[i].way[2]
        t = 0.5 * chi
        if local[i].cayley > 0 or chi == 0.0:
            slope = 1.0 / (1.0 + t * t)
            local[i].turn_cos = (1.0 - t * t) * slope
            local[i].turn_sin = chi * slope
            local[i].slope = slope
            local[i].lever = 1.0
        else:
            local[i].turn_cos = np.cos(chi)
            local[i].turn_sin = np.sin(chi)
            local[i].slope = 1.0
            local[i].lever = np.tan(t) / t if abs(t) > 1e-3 else 1.0 + t * t / 3.0 + 2.0 * t**4 / 15.0


@nonallocating
def find_turned(body: BodyStep) -> None:
    """Compute the angle by which a body turns (`turned`), its ratio to chi (`per`), and the derivative of `per` by chi
    (`per_slope`), after `move`: for joints of angles. Small angles use the series of 2 atan(chi/2)."""
    chi = body.way[2]
    t = 0.5 * chi
    if body.cayley > 0:
        slope, turned = body.slope, 2.0 * np.arctan(t)
        body.turned = turned
        if abs(t) < 1e-3:
            body.per = 1.0 - t * t / 3.0 + t**4 / 5.0
            body.per_slope = -t / 3.0 + 0.4 * t**3
        else:
            body.per = turned / chi
            body.per_slope = (slope - turned / chi) / chi
    else:
        body.turned = chi
        body.per = 1.0
        body.per_slope = 0.0


@inlined
def balance_velocities(W: Workspace, h: float) -> None:
    """Set the velocities v1 to v0 + h a + M^-1 `impulse`, so that the balance of momentum holds to round-off, and
    `move`."""
    local = W.J.LOCAL
    for i in range(W.bodies):
        for c in range(3):
            change = h * local[i].acceleration[c] + local[i].mobility[c] * local[i].impulse[c]
            local[i].v1[c] = local[i].v0[c] + change
    move(local, W.bodies, h)


@inlined
def accept_part(W: Workspace, h: float) -> None:
    """Make the end of a part h of the step the start of the next: poses and velocities move on, `travel` and `mean`
    are summed, and `lead` keeps the accelerations by joints in this part."""
    local, per = W.J.LOCAL, 1.0 / h
    for i in range(W.bodies):
        for c in range(3):
            local[i].lead[c] = (local[i].v1[c] - local[i].v0[c]) * per - local[i].acceleration[c]
            local[i].travel[c] += local[i].way[c]
        local[i].mean[0] += h * (local[i].pose[0] + 0.5 * local[i].way[0])
        local[i].mean[1] += h * (local[i].pose[1] + 0.5 * local[i].way[1])
        local[i].pose[0] += local[i].way[0]
        local[i].pose[1] += local[i].way[1]
        chi = local[i].way[2]
        for c in range(3):
            local[i].v0[c] = local[i].v1[c]
        if chi != 0.0:
            local[i].pose[2] += 2.0 * np.arctan(0.5 * chi) if local[i].cayley > 0 else chi
            # cos and sin of the new angle, up to round-off of each part.
            x, y, turn_x, turn_y = local[i].cos, local[i].sin, local[i].turn_cos, local[i].turn_sin
            local[i].cos, local[i].sin = x * turn_x - y * turn_y, y * turn_x + x * turn_y


@nonallocating
def save(W: Workspace) -> None:
    """Make the present poses and velocities the start of the step, to which `go_back` returns; ways are 0 but for the
    `shift` by the closing of joints."""
    local = W.J.LOCAL
    for i in range(W.bodies):
        for c in range(3):
            local[i].saved_pose[c], local[i].saved_velocity[c] = local[i].pose[c], local[i].v0[c]
            local[i].travel[c] = local[i].shift[c]
        local[i].mean[0] = local[i].mean[1] = 0.0


@nonallocating
def go_back(W: Workspace) -> None:
    """Return to the poses and velocities at the start of the step."""
    local = W.J.LOCAL
    for i in range(W.bodies):
        for c in range(3):
            local[i].pose[c], local[i].v0[c] = local[i].saved_pose[c], local[i].saved_velocity[c]
            local[i].travel[c] = local[i].shift[c]
        local[i].mean[0] = local[i].mean[1] = 0.0
        local[i].cos, local[i].sin = np.cos(local[i].pose[2]), np.sin(local[i].pose[2])
