"""Bodies that joints hold where they are, which count as bodies that nothing moves: those on straight chains between
fixed points (`straight`), and welded ones (`welds`)."""

from __future__ import annotations

import numpy as np

from ..arrays import IntArray
from ..compiled import Table, kernel, nonallocating
from ..compiled.records import Rows
from ..model.bodies import Body
from ..model.joints import CENTRE, FREE, GEAR, PIN, PIVOT, SLIDE, WHOLLY, Joints, joints_of
from ..model.scene import scene_of
from .plan import find_turning, together
from .straight import hold_chains
from .welds import weld


@nonallocating
def may_hold(J: Joints) -> bool:
    """Whether two joints that may hold a body end at bodies that do not move (`STILL`)."""
    joint, still, ends = J.JOINT, J.STILL, 0
    for j in range(len(joint) if len(still) > 0 else 0):
        fixed = still[joint[j].body[0]] > 0 or still[joint[j].body[1]] > 0
        if fixed and joint[j].finite_force == 0 and joint[j].kind in (PIN, PIVOT, SLIDE, GEAR):
            ends += 1
    return ends >= 2


@nonallocating
def note_pinned(J: Joints, k: int, body: Body, row: int, kind: int, weld: IntArray) -> bool:
    """Write row k of PINNED: a body at its pose, and how it is held; returns whether it differs from the last one."""
    one = J.PINNED[k]
    same = one.body == row and one.kind == kind and one.link == weld[2]
    same = same and one.weld[0] == weld[0] and one.weld[1] == weld[1]
    same = same and one.x == body.x and one.y == body.y and one.angle == body.angle
    same = same and one.inv_mass == body.inv_mass and one.inv_inertia == body.inv_inertia
    one.body, one.kind, one.weld[0], one.weld[1], one.link = row, kind, weld[0], weld[1], weld[2]
    one.x, one.y, one.angle = body.x, body.y, body.angle
    one.inv_mass, one.inv_inertia = body.inv_mass, body.inv_inertia
    return not same


@kernel
def find_pinned(table: Table, joints: Table) -> bool:
    """Find the bodies that joints hold where they are, at their present poses, which lose their mobilities; returns
    whether PINNED differs from the last one. A body that is held at its centre spins on if it has no friction; else it
    is held wholly. What was held before is released first (`release_held`)."""
    A, J = scene_of(table), joints_of(joints)
    BODY, SHAPE, LINK = A.BODY, A.SHAPE, A.LINK
    before, found, changed = J.TALLY.pinned, 0, False
    if may_hold(J):
        bodies = together(BODY, J.PARTNER)
        still, spins = np.zeros(len(bodies), np.int64), np.zeros(len(bodies), np.int64)
        spins[: len(BODY)] = CENTRE
        for i in range(len(bodies)):  # joints hold no body whose motion they cannot change
            still[i] = 0 if i < len(BODY) and BODY[i].inv_mass > 0.0 else 1 if J.STILL[i] > 0 else -1
        for s in range(len(LINK)):
            if SHAPE[s].friction > 0.0:
                spins[LINK[s].owner] = WHOLLY
        turns, _ = find_turning(bodies, J.JOINT)
        kinds, welds = np.zeros(len(bodies), np.int64), np.full((len(bodies), 3), -1, np.int64)
        for i in range(len(bodies)):
            spins[i] = spins[i] if turns[i] == 0 else FREE
        held = hold_chains(bodies, J.JOINT, still, spins, kinds) + weld(bodies, J.JOINT, still, kinds, welds)
        for i in range(len(BODY) if held > 0 else 0):
            if kinds[i] != FREE:
                changed = note_pinned(J, found, BODY[i], i, kinds[i], welds[i]) or found >= before or changed
                BODY[i].inv_mass, BODY[i].inv_inertia = 0.0, 0.0
                found += 1
    J.TALLY.pinned = found
    return bool(changed or found != before)


@nonallocating
def release_held(table: Table, joints: Table) -> None:
    """Give the bodies that joints hold their mobilities back; PINNED is kept, to be compared with the next one."""
    A, J = scene_of(table), joints_of(joints)
    for k in range(J.TALLY.pinned):
        body = A.BODY[J.PINNED[k].body]
        body.inv_mass, body.inv_inertia = J.PINNED[k].inv_mass, J.PINNED[k].inv_inertia


@nonallocating
def mass_of(inverse: float) -> float:
    """Mass or moment by its inverse; 0 for an infinite one, which nothing moves."""
    return 1.0 / inverse if inverse > 0.0 else 0.0


@nonallocating
def put_pinned(J: Joints, BODY: Rows[Body]) -> float:
    """Put pinned bodies where they are, at rest but for the spin of those that are pinned at their centre; the kinetic
    energy that they lose, which joints take as they take that of any velocity that does not fit them."""
    lost = 0.0
    for k in range(J.TALLY.pinned):
        pinned, body = J.PINNED[k], BODY[J.PINNED[k].body]
        lost += 0.5 * mass_of(pinned.inv_mass) * (body.vx * body.vx + body.vy * body.vy)
        body.x, body.y, body.vx, body.vy, body.ax, body.ay, body.angular = pinned.x, pinned.y, 0.0, 0.0, 0.0, 0.0, 0.0
        if pinned.kind != CENTRE:
            lost += 0.5 * mass_of(pinned.inv_inertia) * body.spin * body.spin
            body.angle, body.spin = pinned.angle, 0.0
    return lost
