"""Records of bodies: paths, next events, islands, rest."""

from __future__ import annotations

from ..compiled.records import Record, kind_of


class Body(Record):
    """A body's path, and how impulses move it.

    Rows [0, disks) are single disks: dynamic bodies with one shape, a circle about the centre of mass. Then come the
    other dynamic bodies, then the kinematic ones. The last row is the ground, the body of all static shapes (pose and
    velocity 0, inverse mass and moment 0, shapes in world coordinates). From `since` on the path is the parabola

        q(t) = q + v s + a s^2 / 2,   s = t - since,   of each of x, y and the angle.
    """

    x: float  # pose of the centre of mass at `since`: length, length, rad
    y: float
    angle: float
    vx: float  # velocity there: length/time, length/time, rad/time
    vy: float
    spin: float
    since: float  # instant at which the present path began: time after the start of the step
    extent: float  # length from the centre of mass to the farthest point of the shapes; the radius of a single disk
    ax: float  # acceleration from `since` on: length/time², length/time²
    ay: float
    angular: float  # angular acceleration: rad/time²
    inv_mass: float  # 1/mass; 0 for bodies that impulses do not move
    inv_inertia: float  # 1/moment; 0 for bodies that impulses do not turn
    elasticity: float  # of a single disk
    friction: float  # of a single disk
    # Time of the body's next event after the start of the step. Negative at the start of a step: the event has to be
    # predicted again. -1 after a new velocity or acceleration, `..layout.PLACED` if the body counts as placed by the
    # program, `..layout.SHIFTED` - way / extent if the program has moved it by this way.
    due: float


BODIES = kind_of(Body)
POSE, VELOCITY = ("x", "y", "angle"), ("vx", "vy", "spin")
MOBILITY, OF_SHAPES = ("inv_mass", "inv_inertia"), ("extent", "elasticity", "friction")  # no step changes these


class Next(Record):
    """A body's next event, its path version, its shapes, its island."""

    own: int  # shape of the body in its next event; -1 for RENEW
    other: int  # the other shape, or LEAVE, CHECK, NOTHING, RENEW
    known: int  # path version of the other body when the event was predicted
    version: int  # path version: number of paths so far
    first_shape: int  # its shapes are [first_shape, first_shape + shapes)
    shapes: int
    impacts: int  # impacts of the body in this step
    island: int  # first body (root) of its island, -1 for none


# `Next.other`: `own` leaves its margin circle (`shapes.Mark`); the event has to be predicted again then; no event.
LEAVE, CHECK, NOTHING = -1, -2, -3
RENEW = -4  # the interval of the body's island ends


# `Member.rest`; `..islands` has the transitions. AWAKE: solved in every step. AT_REST: held by static forces. CHANGED,
# of the root of an island at rest: to be solved again; of a kinematic body: it moves, or the program has moved it.
AWAKE, AT_REST, CHANGED = 0, 1, 2

# `Member.placed`: overlaps are searched where the body is, or where the program has moved it.
UNMOVED, MOVED = 1, 2


class Member(Record):
    """A body's place in an island. The bodies of an island are a chain from the first one, the root, whose row also
    holds what is true of the whole island."""

    following: int  # next body of the chain, -1 for none
    last: int  # of the root: last body of the chain
    bodies: int  # of the root: number of bodies
    hits: int  # of the root: hits of the island in this step
    busy: int  # steps for which shapes that come near join the island instead of hitting it; no test for rest meanwhile
    open: int  # of the root: 1 while contacts of its interval have no entries in the ledger
    tied: int  # first body of its component, -1 if no joint holds the body
    next_tied: int  # next body of the component, in a ring
    jointed: int  # of the root: 1 if joints hold bodies of its island
    rest: int  # AWAKE, AT_REST or CHANGED
    unverified: int  # of the root of an island at rest: 1 while support of moving neighbours is unverified
    with_supports: int  # of the root: `bodies`, and those of the islands that support them; after a partial rest those
    # of the whole island
    placed: int  # UNMOVED or MOVED while the body may overlap others deeply; else 0
    # Of the root of an island at rest: 1 while the islands below have not been tested with its new forces.
    new_forces: int


class Rest(Record):
    """A body in an island: corrections at the end of the interval, state of the island's solver, timers of rest."""

    lift_x: float  # to add to the pose at the end of the interval
    lift_y: float
    lift_angle: float
    lift_vx: float  # without joints: to add to the velocity there
    lift_vy: float
    lift_spin: float
    end_vx: float  # with joints: the velocity there, which is not that of the parabola
    end_vy: float
    end_spin: float
    augmentation: float  # of the island's first body by row: log10 of R in direct solves, see `contacts/relaxation.py`
    wait: float  # likewise: solves until the next direct one
    backoff: float  # likewise: solves to wait after its next failure
    payable: float  # of the root: cost of the correction up to which losses pay; the rest is external work
    lost: float  # of the root: energy lost in this step; if negative, energy that later intervals have to take out
    until: float  # of the root: instant at which the interval ends
    longest: float  # in an island with joints: length with which its next interval is tried, at most
    excess_left: float  # of its root: how many times too long its interval still is; of one that is solved, and not
    # tried again, for the depth of its contacts alone
    rest_timer: float  # steps in a row at whose start the body was slow, in islands; -REST_RETRY after a failed test
    speed: float  # `Midstep`: bound of the speed of the body's points in the step, length/time
    rest_due: float  # `due` of a body at rest at the end of the last step
