"""All components of a set of bodies without contacts, stepped by one call, for the tests of `newton/` and `joints/`.

Steps of scenes take one component at a time (`..jointed.alone`).
"""

from __future__ import annotations

from ..compiled import Table, nonallocating
from ..compiled.records import Rows
from ..model.bodies import Body
from ..model.joints import Joints, joints_of
from ..newton.motion import read_body, seat, size_up
from .step import take_step
from .workspace import workspace


@nonallocating
def read_bodies(bodies: Rows[Body], J: Joints, s: int, h: float) -> float:
    """Copy the bodies of component s to its scratch; its size, as of `size_up` for a step h."""
    C = J.COMPONENT[s]
    for i in range(C.end_body - C.first_body):
        body, local = bodies[J.JOINED[C.first_body + i].body], J.LOCAL[i]
        seat(local, J.JOINED[C.first_body + i])
        read_body(local, body)
        local.acceleration[0], local.acceleration[1], local.acceleration[2] = body.ax, body.ay, body.angular
    return size_up(J, s, h)


@nonallocating
def step_all(JOINTS: Table, bodies: Rows[Body], h: float) -> int:
    """Step all components of a plan by h, in place of the poses and velocities of `bodies`; the worst status.

    Bodies outside components are not moved. STEPPED is filled in.
    """
    J = joints_of(JOINTS)
    worst = 0
    for s in range(J.TALLY.components):
        length = read_bodies(bodies, J, s, h)
        W = workspace(J, s)
        W.J.COMPONENT[s].parts = 0
        worst = max(worst, take_step(W, h, J.TALLY.order, length, J.STEPPED[s]))
        for i in range(W.bodies):
            b, L = bodies[J.JOINED[W.J.COMPONENT[W.s].first_body + i].body], J.LOCAL[i]
            if b.inv_mass > 0.0 or b.inv_inertia > 0.0:
                b.x, b.y, b.angle = L.pose[0], L.pose[1], L.pose[2]
                b.vx, b.vy, b.spin = L.v0[0], L.v0[1], L.v0[2]
    return worst
