"""Joints that move bodies by themselves, or hold them with a bounded impulse only."""

from __future__ import annotations

from ..compiled import nonallocating
from ..model.joints import BOXED, MOTOR, PRESCRIBED, Joints
from ..newton.entries import is_limit


@nonallocating
def keeps_speed(J: Joints, s: int) -> bool:
    """Whether joints of component s have rows of speeds at the end of an interval: motors, joints with a max_force."""
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        if J.COUPLING[k].bounded != 0:
            return True
    return False


@nonallocating
def is_driven(J: Joints, s: int) -> bool:
    """Whether component s has a motor of unlimited force, whose speed an impulse of contacts alone would change."""
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        if J.COUPLING[k].kind == MOTOR and J.JOINT[J.COUPLING[k].joint].bounded == 0:
            return True
    return False


@nonallocating
def acts_at_once(J: Joints, s: int) -> bool:
    """Whether component s has joints without bounds; with none its bodies are free at an instant."""
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        if J.COUPLING[k].bounded == 0:
            return True
    return False


@nonallocating
def let_slip(J: Joints, s: int, slips: bool, limits: bool) -> None:
    """Let bounded impulses count as given in answers, or no longer: those of joints with a max_force, where they are
    few enough for `..newton.boxes`, and, if `limits`, those of limits that hold."""
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        link = J.COUPLING[k]
        if link.bounded != 0 and J.JOINT[link.joint].max_force < 1e300 and J.COMPONENT[s].boxes > 0:
            link.bounded = PRESCRIBED if slips else BOXED
        elif limits and is_limit(link.kind) and J.JOINT[link.joint].bounded == 0:
            link.bounded = PRESCRIBED if slips and link.side != 0 else 0
