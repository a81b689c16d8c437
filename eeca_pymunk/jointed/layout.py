"""The arrays of the joints of a scene."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import FloatArray, IntArray
from ..compiled import Opener
from ..compiled.records import Rows
from ..model.bodies import Body

# TALLY (8,) int
COMPONENTS, ORDER, WORST, REPEATS = 0, 1, 2, 3  # how many; 2 or 4; worst status of the step; steps of components
ANSWERS = 4  # the system with which the component that is `ready` answers
TALLY_LENGTH = 8

# STEPPED (components, 10): the ledger of a component in its span, and
TURNED_WORK = 8  # work of torques beyond that along the angle
LIFTED = 9  # energy that lifting bodies out of each other costs, paid from the losses of contacts
STEPPED_COLUMNS = 10


class Joints(NamedTuple):
    """JOINT, TIE: see `..joints.layout`; bodies as rows of BODY (n rows) or n + row of PARTNER (x,), which
    joints cannot move. SPAN, MEMBER, LINK: the plan (`..joints.scratch`), a component per row of SPAN. HINGE, LOCAL,
    NODE, MATRIX, RIGHT, MORE, STIFF, FOUND, PART, PIVOTS: scratch for the largest component. OF (n,): the component of
    a body, -1 for none. KEPT (j, JOINT_COLUMNS), SIDES (j, TIE_COLUMNS): the joints at the start of a span. STEPPED
    (components, 10): their ledgers in their spans."""

    JOINT: FloatArray
    TIE: IntArray
    PARTNER: Rows[Body]
    SPAN: IntArray
    MEMBER: IntArray
    LINK: IntArray
    HINGE: FloatArray
    LOCAL: FloatArray
    NODE: IntArray
    MATRIX: FloatArray
    RIGHT: FloatArray
    MORE: FloatArray
    STIFF: FloatArray
    FOUND: FloatArray
    PART: FloatArray
    PIVOTS: IntArray
    OF: IntArray
    KEPT: FloatArray
    SIDES: IntArray
    STEPPED: FloatArray
    TALLY: IntArray


# What steps change.
OF_JOINTS = (
    "JOINT", "TIE", "HINGE", "LOCAL", "NODE", "STIFF", "FOUND", "PART", "PIVOTS", "KEPT", "SIDES", "STEPPED", "TALLY",
)  # fmt: skip

joints_of = Opener(Joints)
