"""The parts of a step between the instants at which limits are met, as the solution before has taken them.

The solutions of one interval, under impulses of contacts that come nearer to the right ones, differ by little: each
part begins with the accelerations and forces of joints that the same part of the last solution has ended with, and with
the limit that it has met, at its instant. This is where iterations begin, and changes no result. A step that meets
limits has no parts of order 4 (`foresight`), whose memory serves.
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
    """Begin the next part as the last solution took it, if that is known: with the search for the limit that it met, at
    its instant, or to the end of the step if it met none. cold: without impulses, as rows are redundant."""
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
    """Note that a part of length `when` has been taken, at whose end joint k met its limit at this side; -1: none, it
    was the last one."""
    component = W.J.COMPONENT[W.s]
    if part >= DEPTH:
        return
    if part >= component.parts or component.part_limit[part] != k:
        component.parts = part + 1  # what came after another limit is not known
    component.part_limit[part], component.part_side[part], component.part_length[part] = k, side, when
    store(W, part, when)


@nonallocating
def begin_as_before(W: Workspace, before: float, h: float) -> None:
    """Let the solve of a part h begin with the mean accelerations and forces of the last solve, of a part `before` from
    the same start: `lead` and `lam`."""
    local, hinge, longer = W.J.LOCAL, W.J.HINGE, h / before
    for i in range(W.bodies):
        for c in range(3):
            local[i].lead[c] = (local[i].v1[c] - local[i].v0[c]) / before - local[i].acceleration[c]
    for k in range(W.joints):
        hinge[k].lam[0] *= longer
        hinge[k].lam[1] *= longer


@nonallocating
def weaken_lead(W: Workspace, share: float) -> None:
    """Let the next part begin with this share of the accelerations by joints in the part before: the shorter that was,
    the more of them is due to velocities that did not fit, and the less to forces."""
    for i in range(W.bodies):
        for c in range(3):
            W.J.LOCAL[i].lead[c] *= share
