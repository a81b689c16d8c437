"""Joints that move bodies by themselves, or hold them with a bounded impulse only."""

from __future__ import annotations

from ..compiled import uncounted
from ..joints.layout import MAX_FORCE, MOTOR, ROTARY_SPRING, SOFT, SPRING
from ..joints.scratch import BOXED, BOXES, GIVEN, JOINT_0, JOINT_1, L_JOINT, L_KIND, L_SOFT
from .layout import Joints


@uncounted
def drives(J: Joints, s: int) -> bool:
    """Whether the joints of component s move its bodies by themselves: springs, motors, joints with a max_force."""
    some = False
    for k in range(J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1]):
        kind = J.LINK[k, L_KIND]
        some = some or kind in (SPRING, ROTARY_SPRING, MOTOR) or J.TIE[J.LINK[k, L_JOINT], SOFT] != 0
    return some


@uncounted
def keeps_speed(J: Joints, s: int) -> bool:
    """Whether joints of component s have rows of speeds at the end of a span: motors, joints with a max_force."""
    some = False
    for k in range(J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1]):
        some = some or J.LINK[k, L_SOFT] != 0
    return some


@uncounted
def let_slip(J: Joints, s: int, slips: bool) -> None:
    """Let bounded impulses count as given in answers, or no longer, where they are few enough for `..joints.boxes`."""
    if J.SPAN[s, BOXES] == 0:
        return
    for k in range(J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1]):
        if J.LINK[k, L_SOFT] != 0 and J.JOINT[J.LINK[k, L_JOINT], MAX_FORCE] < 1e300:
            J.LINK[k, L_SOFT] = GIVEN if slips else BOXED
