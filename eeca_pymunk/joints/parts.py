"""The parts of a step between the instants at which limits are met, as the solution before has taken them.

The solutions of one interval, under impulses of contacts that come nearer to the right ones, differ by little: each
part begins with the accelerations and forces of joints that the same part of the last solution has ended with, and with
the limit that it has met, at its instant. This is where iterations begin, and changes no result. A step that meets
limits has no parts of order 4 (`foresight`), whose memory serves.
"""

from __future__ import annotations

from ..compiled import inlined, nonallocating
from ..model.joints import Component, Workspace
from .foresight import DEPTH, store


@inlined
def meets_limit(component: Component) -> bool:
    """Whether the last solution from the present start has met a limit."""
    return bool(component.parts > 0 and component.part_limit[0] >= 0)


@nonallocating
def begin_as_known(W: Workspace, part: int, left: float, cold: bool) -> tuple[int, int, float]:
    """Let a part of a step, of which `left` is left, begin as the last solution took it: the joint whose limit it met,
    the side of that, and the length of the part; -1, 0 and `left` if it met none, or if that is not known. cold:
    without impulses, as rows are redundant."""
    joint, link, component = W.J.JOINT, W.link, W.J.COMPONENT[W.s]
    if part >= component.parts:
        return -1, 0, left
    k, side, when = component.part_limit[part], component.part_side[part], component.part_length[part]
    if k < 0:
        when = left
    elif link[k].side != 0 or not when < left:
        return -1, 0, left
    for i in range(W.joints):
        j = link[i].joint
        for c in range(6):
            W.J.LOCAL[link[i].body[c // 3]].lead[c % 3] = joint[j].past_led[c, part]
        for r in range(0 if cold else link[i].rows):
            W.J.HINGE[i].lam[r] = when * joint[j].past_push[r, part]
    return k, side, when


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
