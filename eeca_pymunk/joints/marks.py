"""What the plan of a component marks of its joints: which impulses are bounded, and on what of bodies joints act."""

from __future__ import annotations

from ..compiled import kernel
from ..compiled.records import Rows
from ..model.joints import (
    BOUNDED,
    FORCES_ON,
    GEAR,
    GROOVE,
    MOTOR,
    ROTARY_SPRING,
    SPRING,
    TORQUES_ON,
    Component,
    ComponentBody,
    Coupling,
    Joint,
)
from ..model.parameters.joints import MOST_BOUNDED


@kernel
def mark_actions(
    joint: Rows[Joint], member: Rows[ComponentBody], link: Rows[Coupling], component: Rows[Component], s: int
) -> None:
    """Mark the bodies of component s that its joints push, and those on which they exert torques."""
    for i in range(component[s].first_body, component[s].end_body):
        member[i].acted = 0
    for k in range(component[s].first_joint, component[s].end_joint):
        j, kind = link[k].joint, link[k].kind
        for end in range(2):
            one = member[component[s].first_body + link[k].body[end]]
            anchor = joint[j].anchor_a if end == 0 else joint[j].anchor_b
            off = anchor[0] != 0.0 or anchor[1] != 0.0 or (kind == GROOVE and end == 0)
            one.acted |= FORCES_ON if kind < GEAR else 0
            one.acted |= TORQUES_ON if kind >= GEAR or off else 0


@kernel
def mark_bounded(joint: Rows[Joint], link: Rows[Coupling], component: Rows[Component], s: int) -> int:
    """Mark the joints of component s whose impulses are bounded; how many rows they have, 0 if these are too many to be
    solved with contacts."""
    first, end, bounded = component[s].first_joint, component[s].end_joint, 0
    for k in range(first, end):
        acts = joint[link[k].joint].bounded != 0 and link[k].kind not in (SPRING, ROTARY_SPRING)
        link[k].bounded = BOUNDED if link[k].kind == MOTOR or acts else 0
        bounded += link[k].rows if link[k].bounded != 0 else 0
    return bounded if bounded <= MOST_BOUNDED else 0


@kernel
def has_disc(joint: Rows[Joint], link: Rows[Coupling], component: Rows[Component], s: int) -> bool:
    """Whether component s has a joint with two bounded impulses: their disc couples both, which condensed systems
    cannot represent."""
    for k in range(component[s].first_joint, component[s].end_joint):
        if joint[link[k].joint].bounded != 0 and link[k].rows == 2:
            return True
    return False


@kernel
def hard(joint: Rows[Joint], link: Rows[Coupling], component: Rows[Component], s: int) -> bool:
    """Whether all joints of component s hold exactly, including those with limits."""
    for k in range(component[s].first_joint, component[s].end_joint):
        j = link[k].joint
        if link[k].rows == 0 or joint[j].kind == MOTOR or joint[j].bounded != 0:
            return False
    return True
