"""The parts of a step between instants at which limits are met, stored for the next solution of the same step.

The solutions of one interval, under successive impulses of contacts, differ little. Each part begins with the
accelerations and impulses of joints at the end of the same part of the last solution, and with the limit that it met,
at its instant. Only the start of iterations depends on this. A step that meets limits has no parts of order 4
(`foresight`), whose memory is used.
"""

from __future__ import annotations

from ..compiled import inlined, nonallocating
from ..model.joint_steps import Parts
from ..model.joints import Component, Workspace
from .foresight import DEPTH, store


@inlined
def meets_limit(component: Component) -> bool:
    """Whether the last solution from the present start has met a limit."""
    return bool(component.parts > 0 and component.part_limit[0] >= 0)


@nonallocating
def begin_next(W: Workspace, S: Parts, cold: bool) -> None:
    """Begin the next part as the last solution took it, if that is known: search the limit that it met, from its
    instant; else solve to the end of the step. cold: without impulses, as rows are redundant."""
    link, component, part = W.link, W.J.COMPONENT[W.s], S.part
    S.limit, S.side, S.when = -1, 0, S.left
    if part < component.parts:
        k, when = component.part_limit[part], component.part_length[part]
        if k < 0 or (link[k].side == 0 and when < S.left):
            S.limit, S.side, S.when = k, component.part_side[part], S.left if k < 0 else when
            for i in range(W.joints):
                joint = W.J.JOINT[link[i].joint]
                for c in range(6):
                    W.J.LOCAL[link[i].body[c // 3]].lead[c % 3] = joint.past_led[c, part]
                for r in range(0 if cold else link[i].rows):
                    W.J.HINGE[i].lam[r] = S.when * joint.past_push[r, part]
    S.foreseen = 1 if S.limit >= 0 else 0
    S.low, S.high, S.secants, S.solved, S.hopped = 0.0, S.left, 0, 0.0, 0
    S.events += S.foreseen


@nonallocating
def note_part(W: Workspace, part: int, k: int, side: int, when: float) -> None:
    """Store that part number `part`, of length `when`, ends where joint k meets its limit at this side; -1 if it was
    the last one."""
    component = W.J.COMPONENT[W.s]
    if part >= DEPTH:
        return
    if part >= component.parts or component.part_limit[part] != k:
        component.parts = part + 1  # what came after another limit is not known
    component.part_limit[part], component.part_side[part], component.part_length[part] = k, side, when
    store(W, part, when)


@nonallocating
def begin_as_before(W: Workspace, before: float, h: float) -> None:
    """Begin the solve of a part h with the mean accelerations (`lead`) and forces (`lam`) of the last solve from the
    same start, of length `before`."""
    local, hinge, longer = W.J.LOCAL, W.J.HINGE, h / before
    for i in range(W.bodies):
        for c in range(3):
            local[i].lead[c] = (local[i].v1[c] - local[i].v0[c]) / before - local[i].acceleration[c]
    for k in range(W.joints):
        hinge[k].lam[0] *= longer
        hinge[k].lam[1] *= longer
