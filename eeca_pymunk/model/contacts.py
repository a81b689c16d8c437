"""Records of contacts: impulses of a step, contacts of intervals, rows of a contact problem."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

from ..arrays import FloatArray, IntArray
from ..compiled.records import Record, Rows, kind_of


class Impulse(Record):
    """An impulse of a step, as reports read it. All fields are floats."""

    first: float  # row of the shape of a
    second: float  # row of the shape of b
    when: float  # time after the start of the step
    normal: float  # impulse, mass length/time, >= 0
    nx: float  # unit normal from a to b
    ny: float
    px: float  # point, halfway between the surfaces at that instant: length
    py: float
    gap: float  # length, at the start of the step, negative in overlap
    change: float  # of the contact's normal velocity by this impulse alone, length/time
    tangential: float  # impulse along t = (-n_y, n_x), mass length/time
    duration: float  # time over which a constant force acted, centred at `when`; 0 for an impact


class ContactPoint(Record):
    """A contact point of two shapes, see `..geometry.manifold`."""

    nx: float  # unit normal from one shape to the other
    ny: float
    px: float  # point halfway between their surfaces: length
    py: float
    gap: float  # length


class Pair(Record):
    """The shapes of a contact of an island's present interval, a row of PUSHED_BY; row c of PUSHED has its impulses."""

    a: int
    b: int
    root: int  # first body of the island; ENDED or LASTED once the interval is over


ENDED, LASTED = -1, -2  # the interval ended before the end of the step; with it


class Pushed(Record):
    """Impulses and velocities of a contact over the interval of its island."""

    normal: float  # impulse over the interval, mass length/time
    tangential: float
    un_before: float  # normal velocity at the start and the end of the interval, length/time
    un_after: float
    ut_before: float  # tangential velocity likewise
    ut_after: float
    work: float  # energy that kinematic bodies and moving surfaces give over the interval
    work_unaccelerated: float  # the same if these kept their velocities of its start
    # Normal impulse at the end of the interval by which velocities projected onto joints do not close the contact; its
    # loss is in the ledger.
    held: float
    start: float  # instant at which the interval begins
    length: float  # of the interval: time
    nx: float  # unit normal from a to b
    ny: float
    px: float  # point, length
    py: float
    change: float  # of the normal velocity by the impulse alone, length/time
    gap: float  # length, at the start of the step; nan if the interval began later


class Row(Record):
    """A row of a contact problem, between local bodies a and b.

    The contact acts along n, the unit normal from a to b, and t = (-n_y, n_x):

        u_n = n.(v_b - v_a) + arm_nb w_b - arm_na w_a,   arm_n = r x n,  r from the centre of mass to the point,
        u_t = t.(v_b - v_a) + arm_tb w_b - arm_ta w_a + surface,   arm_t = r x t.
    """

    a: int  # local bodies
    b: int
    nx: float  # unit normal from a to b
    ny: float
    arm_na: float  # arms of the normal impulse: length
    arm_nb: float
    arm_ta: float  # arms of the tangential impulse: length
    arm_tb: float
    gap: float  # length, negative in overlap
    un: float  # u_n and u_t before the impulses, without what forces add in a step: length/time
    ut: float
    k_n: float  # effective masses, 1 / a_nn and 1 / a_tt
    k_t: float
    elasticity: float  # of the contact: products of both shapes' values
    friction: float
    target: float  # b: the law is 0 <= lam _|_ u_n - b >= 0
    # t.(surface velocity of B's shape - that of A's), length/time; on walls that turn (`..contacts.turning_walls`) such
    # that u_t at the end of the interval is 0 for what sticks.
    surface: float
    # Where a wall turns, by the symbols of `..contacts.turning_walls`:
    turned: float  # c_0, if positive: by so much u_n is less than with the geometry of the start
    swung: float  # (c_0 + c_1) / 2 along t; the velocity surface + swung does work
    unsure: float  # error of u_t
    # Activation velocity: the contact is inactive while u_n without its own impulse is above it; infinite once active.
    activation: float
    a_nn: float  # change of u_n and u_t by unit impulses along n and t: 1/mass
    a_nt: float
    a_tt: float
    w_nn: float  # inverse of [[a_nn, a_nt], [a_nt, a_tt]] of contacts with friction; nan where it is singular: mass
    w_nt: float
    w_tt: float
    key: int  # the pair of shapes, and which of its two points this is (`..contacts.forces.key_of`), across steps


class Problem(NamedTuple):
    """A contact problem: m rows ROWS. The k bodies have inverse masses IM and moments II, (k,), and poses POSE (k, 3);
    impulses move the first n of them."""

    ROWS: Rows[Row]
    IM: FloatArray
    II: FloatArray
    POSE: FloatArray
    n: int
    m: int


class Columns(NamedTuple):
    """Of contact i: AT[i] : AT[i + 1] the entries BODY, N and T (., 3) of its columns; LEFT_OUT (m,) 1 if it takes no
    part. WORK (1,): operations that solutions with these columns have taken."""

    AT: IntArray
    BODY: IntArray
    N: FloatArray
    T: FloatArray
    LEFT_OUT: IntArray
    WORK: FloatArray


class BoundedRow(Record):
    """A row of bounded impulse, a motor's for instance, beside the contacts of an island."""

    speed: float  # velocity of what does not move along it, less its target: length/time
    low: float  # least and largest impulse
    high: float
    part: float  # SINGLE, or the place in a disc (`..rows.bounded`)
    now: float  # impulse of the last motion
    a_own: float  # change of the velocity along it by a unit impulse
    cross: float  # of the first row of a disc: by one of the second row


BOUNDED_ROW = kind_of(BoundedRow)


class Bounded(NamedTuple):
    """Bounded rows; of row i < NUMBER[0]:

    AT[i] : AT[i + 1] the entries BODY and N (., 3) of its column, AT[0] = 0; END (n, 2) its bodies in the island, -1
    for what does not move; ROW (n, 6) the row; ROWS (n,): its bounds; OF (n, 2): joint (of LINK), row.
    """

    NUMBER: IntArray
    AT: IntArray
    BODY: IntArray
    N: FloatArray
    END: IntArray
    ROW: FloatArray
    ROWS: Rows[BoundedRow]
    OF: IntArray


class JointedProblem(NamedTuple):
    """A contact problem of bodies that joints hold: m rows ROWS, columns C that say how the bodies answer, and bounded
    rows B of joints, whose impulses stand behind those of the contacts."""

    ROWS: Rows[Row]
    C: Columns
    B: Bounded
    m: int


AnyProblem: TypeAlias = Problem | JointedProblem


class Solved(Record):
    """What the solve of an island, or of an impact, reports."""

    restitution: float  # energies: losses >= 0 by restitution and by friction
    friction: float
    lock: float  # scale of the energy lock
    residual: float  # of the contact problem: length/time
    tolerance: float  # of the residual
    sweeps: int
    direct: int  # direct solutions
    operations: float  # of homotopies
    at_rest: int  # 1 if the island was put to rest


class Force(Record):
    """The forces of a contact in the last step, see `..contacts.forces`."""

    normal: float  # force, mass length/time²
    tangential: float
    load: float  # part of the normal force that bears loads, without the part that stopped an approach
    length: float  # of the interval in which they acted: time
    stamp: float  # number of the step that wrote the row


class Edge(Record):
    """An edge of a contact's friction cone in the interior-point method of `..rows.equilibrium`."""

    x: float  # impulse along it, >= 0
    s: float  # multiplier of x >= 0
    guess: float  # impulse that x shall be close to
    a_gg: float  # change of the velocity along it by a unit impulse
    dx: float  # Newton step of x
    ds: float  # Newton step of s


ROW, SOLVED, EDGE, CONTACT_POINT = kind_of(Row), kind_of(Solved), kind_of(Edge), kind_of(ContactPoint)
