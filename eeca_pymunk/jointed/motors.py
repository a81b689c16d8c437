"""Joints that drive bodies, or hold them with bounded impulses only."""

from __future__ import annotations

from ..compiled import nonallocating
from ..model.joints import BOXED, MOTOR, PRESCRIBED, Joints
from ..newton.entries import is_limit


@nonallocating
def keeps_speed(J: Joints, s: int) -> bool:
    """Whether component s has motors or joints with a max_force: their rows prescribe speeds at the end of an
    interval."""
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
    """Whether component s has joints without bounds. If it has none, impulses at one instant move its bodies freely."""
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        if J.COUPLING[k].bounded == 0:
            return True
    return False


@nonallocating
def is_exact_limit(J: Joints, k: int) -> bool:
    """Whether coupling k is a limit of unlimited force."""
    return bool(is_limit(J.COUPLING[k].kind) and J.JOINT[J.COUPLING[k].joint].bounded == 0)


@nonallocating
def let_slip(J: Joints, s: int, slips: bool, limits: bool) -> None:
    """Count bounded impulses as given in responses, or (`slips` False) no longer: those of joints with a max_force that
    are BOXED, and, if `limits`, those of limits that act."""
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        link = J.COUPLING[k]
        if link.bounded != 0 and J.JOINT[link.joint].max_force < 1e300 and J.COMPONENT[s].boxes > 0:
            link.bounded = PRESCRIBED if slips else BOXED
        elif limits and is_exact_limit(J, k):
            link.bounded = PRESCRIBED if slips and link.side != 0 else 0
