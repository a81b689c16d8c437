"""An island in local numbering, for its solve: its bodies, its contacts, and the report of the solve."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import FloatArray, IntArray
from ..compiled import Opener
from ..compiled.records import Rows
from .contacts import Row, Solved


class Island(NamedTuple):
    """The k bodies of an island: first the n bodies that impulses move, then the others that they touch.

    The ground is among the k if a contact touches it. An island with k = n is *free*: its momenta are conserved. WHO
    (k,): rows of BODY. POSE, V, ACC (k, 3): poses, velocities, and accelerations without contacts, at the start of the
    interval. IM, II (k,): inverse masses and moments. EXTENT (k,): lengths. FELT (k,): the length by which spin adds to
    the speed of the body's points; EXTENT, or 0 if contacts exert no torque on the body. PAIRS (p, 4): shapes a and b,
    local bodies of a and b.
    """

    WHO: IntArray
    POSE: FloatArray
    V: FloatArray
    ACC: FloatArray
    IM: FloatArray
    II: FloatArray
    EXTENT: FloatArray
    FELT: FloatArray
    PAIRS: IntArray


class IslandContacts(NamedTuple):
    """The contacts of an island over an interval.

    ROWS: between local bodies. L (., 2): impulses. VN (k, 3): velocities at the end. JUMP (k, 6): correction of pose
    and velocity at the end. OUT (1,): the report.
    """

    ROWS: Rows[Row]
    L: FloatArray
    VN: FloatArray
    JUMP: FloatArray
    OUT: Rows[Solved]


island_of, contacts_of = Opener(Island), Opener(IslandContacts)
