"""An island in local numbering, for its solve: its bodies, its contacts, and the report of the solve; the search for an
impact of islands."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from ..arrays import FloatArray, IntArray
from ..compiled import Opener
from ..compiled.records import Record, Rows, kind_of
from .contacts import Row, Solved


class Island(NamedTuple):
    """The k bodies of an island: first the n bodies that impulses move, then the others that they touch.

    The ground is among the k if a contact touches it. An island with k = n whose joints connect only these bodies is
    *free* (`..jointed.groups.is_free`): its momenta are conserved. WHO (k,): rows of BODY. POSE, V, ACC (k, 3): poses,
    velocities, and accelerations without contacts, at the start of the interval. IM, II (k,): inverse masses and
    moments. EXTENT (k,): lengths. LEVER (k,): the length by which spin counts in speeds: EXTENT, or 0 if contacts exert
    no torque on the body, so that it spins on. PAIRS (p, 4): shapes a and b, local bodies of a and b.
    """

    WHO: IntArray
    POSE: FloatArray
    V: FloatArray
    ACC: FloatArray
    IM: FloatArray
    II: FloatArray
    EXTENT: FloatArray
    LEVER: FloatArray
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


class Meeting(Record):
    """The search for the impact of two shapes of islands with joints (`..jointed.meet`): lengths, instants."""

    a: int  # shapes
    b: int
    roots: Annotated[IntArray, 2]  # islands of their bodies, -1 for none
    t: float  # instant at which both intervals end at present
    least: float  # earliest and latest instant at which the shapes may meet
    latest: float
    apart: float  # last instant at which they are known to be apart
    small: float  # extent of the smaller one
    level: float  # gap at which they meet: 0, or that of the start
    start: float  # gap and its rate at the start, negative if it closes
    rate: float
    gap: float  # gap at t, less `level`
    touch: float  # largest |gap| with which the shapes count as touching
    pressing: int  # contacts of both intervals
    crosses: int  # 1 if the paths of both cross before t: the shapes have passed through each other
    crossed: int  # 1 if t was halved since paths crossed, or a body had moved too far: it may be no instant of contact


MEETING = kind_of(Meeting)

island_of, contacts_of = Opener(Island), Opener(IslandContacts)
