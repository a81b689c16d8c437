"""Records of contacts: impulses of a step, contacts that last, rows of a contact problem."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

from ..arrays import FloatArray, IntArray
from ..compiled.records import Record, Rows, kind_of


class Impulse(Record):
    """An impulse of a step, as reports read it."""

    first: float  # rows of the shapes of a and of b
    second: float
    when: float  # time after the start of the step
    normal: float  # impulse, mass length/time, >= 0
    nx: float  # unit normal from a to b
    ny: float
    px: float  # point, halfway between the surfaces at that instant: length
    py: float
    gap: float  # length, at the start of the step, negative in overlap
    change: float  # of the contact's normal velocity by this impulse alone, length/time
    tangential: float  # impulse along t = (-n_y, n_x), mass length/time
    duration: float  # time over which a force made it, about `when`; 0 for an impact


class Pair(Record):
    """Which shapes a contact of an island's present interval joins."""

    a: int
    b: int
    root: int  # first body of the island; of an interval that is over ENDED or LASTED


ENDED, LASTED = -1, -2  # before the end of the step, with it


class Pushed(Record):
    """Impulses and velocities of a contact over the interval of its island."""

    normal: float  # impulses over the interval
    tangential: float
    un_before: float  # velocities of the contact at both ends
    un_after: float
    ut_before: float
    ut_after: float
    work: float  # energy that moving bodies and surfaces give over the interval
    start: float  # instant and length of the interval
    length: float
    nx: float
    ny: float
    px: float
    py: float
    change: float  # of the normal velocity by the impulse alone
    gap: float  # at the start of the step, nan where the interval began later


class Row(Record):
    """A row of a contact problem, between local bodies A and B.

    Contact i acts along n, the unit normal from A to B, and t = (-n_y, n_x):

        u_n = n.(v_b - v_a) + arm_nb w_b - arm_na w_a,   arm_n = r x n,  r from the centre of mass to the point,
        u_t = t.(v_b - v_a) + arm_tb w_b - arm_ta w_a + surface,   arm_t = r x t.
    """

    nx: float  # unit normal from A to B
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
    surface: float  # t.(surface velocity of B's shape - that of A's): length/time
    wake: float  # activation velocity: the contact acts once u_n without its own impulse falls below; then infinity
    a_nn: float  # what a unit impulse changes of u_n and u_t: 1/mass
    a_nt: float
    a_tt: float
    w_nn: float  # the inverse of these, with friction; nan where they are singular: mass
    w_nt: float
    w_tt: float


class Problem(NamedTuple):
    """A contact problem: m rows ROWS between local bodies A and B, of bodies (k,) with inverse masses and moments IM
    and II, at POSE (k, 3), of which impulses move the first n."""

    A: IntArray
    B: IntArray
    ROWS: Rows[Row]
    IM: FloatArray
    II: FloatArray
    POSE: FloatArray
    n: int
    m: int


class Columns(NamedTuple):
    """Of contact i: AT[i] : AT[i + 1] the entries BODY, N and T (., 3) of its columns; OUT (m,) 1 if it is left out."""

    AT: IntArray
    BODY: IntArray
    N: FloatArray
    T: FloatArray
    OUT: IntArray


class BoundedRow(Record):
    """A row of bounded impulse, a motor's for instance, beside the contacts of an island."""

    speed: float  # velocity of what does not move along it, less its target: length/time
    low: float  # least and largest impulse
    high: float
    part: float  # SINGLE, or the place in a disc (`..rows.bounded`)
    now: float  # impulse of the last motion


BOUNDED_ROW = kind_of(BoundedRow)


class Bounded(NamedTuple):
    """Bounded rows; of row i < USED[0]:

    AT[i] : AT[i + 1] the entries BODY and N (., 3) of its column, AT[0] = 0; END (n, 2) its bodies in the island, -1
    for what does not move; ROW (n, 6) the row; ROWS (n,): its bounds; OF (n, 2): joint (of LINK), row.
    """

    USED: IntArray
    AT: IntArray
    BODY: IntArray
    N: FloatArray
    END: IntArray
    ROW: FloatArray
    ROWS: Rows[BoundedRow]
    OF: IntArray


class JointedProblem(NamedTuple):
    """A contact problem of bodies that joints hold: m rows ROWS between local bodies A and B, columns C that say how
    the bodies answer, and bounded rows D of joints, whose impulses stand behind those of the contacts."""

    A: IntArray
    B: IntArray
    ROWS: Rows[Row]
    C: Columns
    D: Bounded
    m: int


AnyProblem: TypeAlias = Problem | JointedProblem


class Solved(Record):
    """What the solve of an island, or of an impact, reports."""

    restitution: float  # energies: losses >= 0 by restitution and by friction
    friction: float
    carried: float  # work of bodies that impulses do not move, and of moving surfaces
    lifted: float  # energy that separating overlapping bodies costs
    forces: float  # work of forces
    lock: float  # scale of the energy lock
    owed: float  # energy that is still to be taken out
    residual: float  # of the contact problem, and what it was to be at most: length/time
    tolerance: float
    deepest: float  # gap at the end before bodies are separated: length, negative in overlap
    sweeps: int
    direct: int  # direct solutions
    pushing: int  # contacts that push
    stood: int  # 1 if the island came to rest


class Force(Record):
    """The forces of a contact in the last step, see `..contacts.memory`."""

    normal: float
    tangential: float
    load: float  # the normal force without what stopped an impact
    stamp: float  # number of the step that wrote the row


class Edge(Record):
    """An edge of a contact's friction cone in the interior-point method of `..rows.equilibrium`."""

    x: float  # impulse along it, >= 0
    s: float  # multiplier of x >= 0
    guess: float  # impulse that x is to be next to
    a_gg: float  # what a unit impulse changes of the velocity along it
    dx: float  # Newton's step
    ds: float


ROW, SOLVED, EDGE = kind_of(Row), kind_of(Solved), kind_of(Edge)
