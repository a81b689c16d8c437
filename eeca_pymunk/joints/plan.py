"""Which bodies joints connect to components, and the order of the unknowns of each in its banded matrix.

A plan stays valid while the set of bodies and joints, their kinds, anchors and bodies, and which bodies move, stay the
same. Bodies that joints cannot move do not connect: they are partners of several components. Nodes of a component's
graph are its movable bodies (two or three unknowns) and its joints with impulses; the order is reverse Cuthill-McKee.
"""

from __future__ import annotations

import numpy as np

from ..arrays import IntArray
from ..compiled import kernel
from ..compiled.records import Rows, empty
from ..model import joints as model
from ..model.bodies import BODIES, Body
from ..model.joints import GEAR, GROOVE, Joint, Joints
from ..model.parameters.joints import CONDENSE_BAND, MOST_BOUNDED
from ..newton.rows import row_count
from .ordering import order_rows, order_unknowns


@kernel
def representative(parent: IntArray, i: int) -> int:
    """The representative of i in the forest `parent` (n,) of sets. Halves the paths to it."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@kernel
def find_components(bodies: Rows[Body], joint: Rows[Joint]) -> tuple[int, IntArray]:
    """Number the components in the order of their first joints: how many there are, and (joints,) that of each joint,
    -1 if it moves none of its bodies."""
    parent, component_of = np.arange(len(bodies)), np.empty(len(joint), np.int64)
    for j in range(len(joint)):
        a, b = joint[j].body[0], joint[j].body[1]
        if movable(bodies, a) and movable(bodies, b) and moves_body(bodies, joint[j]):
            p, q = representative(parent, a), representative(parent, b)
            if p != q:
                parent[max(p, q)] = min(p, q)
    number = np.full(len(parent), -1, np.int64)
    count = 0
    for j in range(len(joint)):
        a, b = joint[j].body[0], joint[j].body[1]
        component_of[j] = -1
        if moves_body(bodies, joint[j]):
            top = representative(parent, a if movable(bodies, a) else b)
            if number[top] < 0:
                number[top] = count
                count += 1
            component_of[j] = number[top]
    return count, component_of


@kernel
def movable(bodies: Rows[Body], i: int) -> bool:
    """Whether joints can move body i."""
    return bool(bodies[i].inv_mass > 0.0 or bodies[i].inv_inertia > 0.0)


@kernel
def moves_body(bodies: Rows[Body], joint: Joint) -> bool:
    """Whether a joint can move one of its bodies; a joint of angles cannot move bodies of infinite moment."""
    a, b = joint.body[0], joint.body[1]
    if joint.kind >= GEAR:
        return bool(bodies[a].inv_inertia > 0.0 or bodies[b].inv_inertia > 0.0)
    return movable(bodies, a) or movable(bodies, b)


@kernel
def find_turning(bodies: Rows[Body], joint: Rows[Joint]) -> tuple[IntArray, IntArray]:
    """(bodies,) 1 for bodies that joints turn, and (bodies,) 1 for those of them that turn by 2 atan(chi/2)
    (`..model.joint_steps.BodyStep`): bodies held off their centre, and bodies whose angle a joint binds to such a
    body's; else 0."""
    turns, cayley = np.zeros(len(bodies), np.int64), np.zeros(len(bodies), np.int64)
    for j in range(len(joint)):
        a, b, kind = joint[j].body[0], joint[j].body[1], joint[j].kind
        off_a = kind == GROOVE or (kind < GEAR and (joint[j].anchor_a[0] != 0.0 or joint[j].anchor_a[1] != 0.0))
        off_b = kind < GEAR and (joint[j].anchor_b[0] != 0.0 or joint[j].anchor_b[1] != 0.0)
        if bodies[a].inv_inertia > 0.0 and (off_a or kind >= GEAR):
            turns[a] = 1
            cayley[a] = max(cayley[a], 1 if off_a else 0)
        if bodies[b].inv_inertia > 0.0 and (off_b or kind >= GEAR):
            turns[b] = 1
            cayley[b] = max(cayley[b], 1 if off_b else 0)
    changed = True
    while changed:
        changed = False
        for j in range(len(joint)):
            a, b = joint[j].body[0], joint[j].body[1]
            if joint[j].kind >= GEAR and turns[a] == 1 and turns[b] == 1 and cayley[a] != cayley[b]:
                cayley[a] = cayley[b] = 1
                changed = True
    return turns, cayley


@kernel
def mark_actions(J: Joints, s: int) -> None:
    """Mark the bodies of component s that its joints push, and those on which they exert torques."""
    link, component = J.COUPLING, J.COMPONENT[s]
    for i in range(component.first_body, component.end_body):
        J.JOINED[i].acted = 0
    for k in range(component.first_joint, component.end_joint):
        joint, kind = J.JOINT[link[k].joint], link[k].kind
        for end in range(2):
            one = J.JOINED[component.first_body + link[k].body[end]]
            anchor = joint.anchor_a if end == 0 else joint.anchor_b
            off = anchor[0] != 0.0 or anchor[1] != 0.0 or (kind == GROOVE and end == 0)
            one.acted |= model.FORCES_ON if kind < GEAR else 0
            one.acted |= model.TORQUES_ON if kind >= GEAR or off else 0


@kernel
def mark_joints(J: Joints, s: int) -> tuple[bool, bool]:
    """Mark the joints of component s whose impulses are bounded, and set what the component has of them. Returns
    whether a disc bounds two impulses of a joint, and whether all joints hold exactly, those with limits included."""
    link, one, discs, hard, rows = J.COUPLING, J.COMPONENT[s], False, True, 0
    one.bounded_joints = one.driven = 0
    for k in range(one.first_joint, one.end_joint):
        motor, limited = link[k].kind == model.MOTOR, J.JOINT[link[k].joint].finite_force != 0
        bounded = motor or (limited and link[k].kind not in (model.SPRING, model.ROTARY_SPRING))
        link[k].bounded = model.BOUNDED if bounded else 0
        if bounded:
            rows, one.bounded_joints = rows + link[k].rows, one.bounded_joints + 1
        if motor and not limited:
            one.driven = 1
        discs = discs or (limited and link[k].rows == 2)
        hard = hard and not (link[k].rows == 0 or motor or limited)
    one.bounded_rows = rows if rows <= MOST_BOUNDED else 0  # too many are not solved with contacts
    return discs, hard


@kernel
def make_plan(bodies: Rows[Body], J: Joints) -> int:
    """Fill in COMPONENT, JOINED, COUPLING, and OF, which is -1, of J, whose joints are between `bodies`; how many
    components there are."""
    joint, component, member, link, joints = J.JOINT, J.COMPONENT, J.JOINED, J.COUPLING, len(J.JOINT)
    count, component_of = find_components(bodies, joint)
    turns, cayley = find_turning(bodies, joint)
    room = np.zeros(count + 1, np.int64)
    for j in range(joints):
        if component_of[j] >= 0:
            room[component_of[j] + 1] += 1
    for s in range(count):
        room[s + 1] += room[s]
        component[s].first_joint, component[s].end_joint = room[s], room[s]
    for j in range(joints):
        if component_of[j] >= 0:
            s = component_of[j]
            link[component[s].end_joint].joint = j
            component[s].end_joint += 1
    place = np.full(len(bodies), -1, np.int64)
    used = 0
    for s in range(count):
        component[s].first_body = used
        for k in range(component[s].first_joint, component[s].end_joint):
            j = link[k].joint
            link[k].kind, link[k].rows = joint[j].kind, row_count(joint[j].kind)
            for end in range(2):
                body = joint[j].body[end]
                if place[body] < component[s].first_body:
                    place[body] = used
                    member[used].body, member[used].cayley = body, cayley[body]
                    freedoms = 3 if turns[body] == 1 else 2
                    member[used].freedoms = freedoms if movable(bodies, body) else 0
                    if movable(bodies, body):
                        J.OF[body] = s
                    used += 1
                link[k].body[end] = place[body] - component[s].first_body
        component[s].end_body = used
        discs, hard = mark_joints(J, s)
        order_unknowns(J, s, False)
        if component[s].band > CONDENSE_BAND and not discs:  # which couple two impulses: no condensed system has that
            order_unknowns(J, s, True)
        order_rows(J, s)
        cost = component[s].unknowns * component[s].band ** 2
        pays = 0 < component[s].dual_size * component[s].dual_band ** 2 <= cost
        mark_actions(J, s)
        component[s].dual_for = model.UNUSED if not pays else model.STEPS if hard else model.INSTANTS
        component[s].cycles = count_cycles(bodies, J, s, False)
        component[s].cycles_with_bounded = count_cycles(bodies, J, s, True)
    return count


@kernel
def count_cycles(bodies: Rows[Body], J: Joints, s: int, bounded: bool) -> int:
    """Number of joints of component s that close a cycle in the graph of joints of points, or in that of joints of
    angles; all bodies that nothing moves, or nothing turns, are one node. Without cycles rows are independent,
    including limits: those of points by their effect on places, those of angles on angles. bounded: whether
    bounded rows count."""
    link, component, count = J.COUPLING, J.COMPONENT[s], 0
    n = component.end_body - component.first_body
    parent, ends = np.arange(2 * (n + 1)), np.empty(2, np.int64)
    for k in range(component.first_joint, component.end_joint):
        if link[k].rows == 0 or (link[k].bounded != 0 and not bounded):
            continue
        for end in range(2):
            body = bodies[J.JOINED[component.first_body + link[k].body[end]].body]
            if link[k].kind >= GEAR:
                ends[end] = n + 1 + (link[k].body[end] if body.inv_inertia > 0.0 else n)
            else:
                ends[end] = link[k].body[end] if body.inv_mass > 0.0 else n
        p, q = representative(parent, ends[0]), representative(parent, ends[1])
        if p == q:
            count += 1
        else:
            parent[p] = q
    return count


@kernel
def together(BODY: Rows[Body], PARTNER: Rows[Body]) -> Rows[Body]:
    """(n + x,) a copy of the rows of bodies (n,) and of partners (x,)."""
    n = BODY.shape[0]
    copied = empty(n + PARTNER.shape[0], BODIES)
    for i in range(n):
        copied[i] = BODY[i]
    for i in range(PARTNER.shape[0]):
        copied[n + i] = PARTNER[i]
    return copied
