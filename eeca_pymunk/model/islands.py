"""An island as its solve takes it: its bodies one after the other, its contacts, and what the solve answers."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import FloatArray, IntArray
from ..compiled import Opener
from ..compiled.records import Rows
from .contacts import Row, Solved


class Island(NamedTuple):
    """The bodies of an island, n that impulses move and then those that they do not.

    A body without mobility that rests (the ground) is among the k as well; an island without any is free. WHO (k,):
    rows of BODY. POSE, V, ACC (k, 3): poses, velocities and accelerations without contacts, IM, II (k,): inverse masses
    and moments, EXTENT (k,): lengths, at the start of its interval. FELT (k,): EXTENT, 0 of bodies on which contacts
    exert no torque. PAIRS (p, 4): shapes a and b, local bodies of a and b.
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


class Contacts(NamedTuple):
    """The contacts of an island over an interval.

    ROWS: rows between local bodies A and B. KEY int64 tells pair and place, the same as long as the shapes stay on each
    other. L, LOSS (., 2): impulses, and losses (D_n, D_t). VN (k, 3): velocities at the end. JUMP (k, 6): what to add
    to pose and velocity then. OUT (1,): the report.
    """

    A: IntArray
    B: IntArray
    ROWS: Rows[Row]
    KEY: IntArray
    L: FloatArray
    LOSS: FloatArray
    VN: FloatArray
    JUMP: FloatArray
    OUT: Rows[Solved]


island_of, contacts_of = Opener(Island), Opener(Contacts)
