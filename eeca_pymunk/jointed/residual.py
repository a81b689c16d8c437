"""What the impulses of contacts of an island with joints leave of the contacts' laws, where no solution was found."""

from __future__ import annotations

from ..arrays import FloatArray
from ..compiled import kernel
from ..contacts.counts import note_unmet
from ..contacts.memory import shapes_of
from ..geometry.sides import depth_limit
from ..model.contacts import JointedProblem
from ..model.scene import Scene
from ..model.step import CONTACTS
from ..rows.bounded import room_for_rows
from ..rows.build import normal_rate
from ..rows.columns import breach
from ..rows.laws import give_slips, take_slips
from .advance import Interval
from .lengths import forced_deeper


@kernel
def residual_of(interval: Interval, L: FloatArray) -> float:
    """The largest velocity by which impulses L (m, 2) and the motion under them break the laws of contacts, with
    Coulomb's friction (`take_slips`). Joints hold in any case."""
    ROWS, C, m = interval.ROWS, interval.C, interval.m
    SLIP = take_slips(ROWS, m)
    worst = breach(JointedProblem(ROWS, C, room_for_rows(0, 0), m), L, interval.motion.MEAN)
    give_slips(ROWS, m, SLIP)
    return worst


@kernel
def note_residual(A: Scene, interval: Interval, L: FloatArray, solved: bool, tolerance: float) -> None:
    """Report a contact that joints force deeper, with its velocities, present and allowed; else, if the laws of
    contacts are not `solved`, the velocity by which they are broken, if above `tolerance`."""
    ROWS, h, z = interval.ROWS, interval.h, forced_deeper(A, interval)
    if z >= 0:
        a, b = shapes_of(A, ROWS[z])
        most = max(ROWS[z].gap + depth_limit(A, a, b), 0.0) / h
        note_unmet(A, CONTACTS, a, b, -normal_rate(ROWS[z], interval.motion.WAY) / h, most)
    elif not solved and interval.m > 0:
        residual = residual_of(interval, L)
        if not residual <= tolerance:
            a, b = shapes_of(A, ROWS[0])
            note_unmet(A, CONTACTS, a, b, residual, tolerance)
