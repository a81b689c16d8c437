"""Records of bodies: paths, next events, islands, rest."""

from __future__ import annotations

from ..compiled.records import Record


class Body(Record):
    """A body's path, and how impulses move it.

    Rows [0, disks) are dynamic bodies with one shape, a circle about the centre of mass; then the other dynamic bodies;
    then kinematic ones; the last row is the ground, on which all static shapes stand (pose and velocity 0, no
    mobility, shapes in world coordinates). From `since` on the path is the parabola

        q(t) = q + v s + a s^2 / 2,   s = t - since,   of each of x, y and the angle.
    """

    x: float  # pose of the centre of mass at `since`: length, length, rad
    y: float
    angle: float
    vx: float  # velocity there: length/time, length/time, rad/time
    vy: float
    spin: float
    since: float  # time after the start of the step
    extent: float  # length from the centre of mass to the farthest point of the shapes; the radius of a lone disk
    ax: float  # acceleration from `since` on: length/time², length/time², rad/time²
    ay: float
    angular: float
    inv_mass: float  # 1/mass and 1/moment; 0 for what impulses do not move
    inv_inertia: float
    elasticity: float  # of a lone disk
    friction: float
    due: float  # time after the start of the step of the body's next event


POSE, VELOCITY, ACCELERATION = ("x", "y", "angle"), ("vx", "vy", "spin"), ("ax", "ay", "angular")


class Next(Record):
    """A body's next event, and where its shapes are."""

    own: int  # shapes of the next event; `other` may be LEAVE, CHECK, NOTHING or RENEW
    other: int
    known: int  # path version of the other body when the event was predicted
    version: int  # of the path: how often it has changed
    first_shape: int
    shapes: int
    events: int  # impacts of the body in this step
    island: int  # first body of the island it is solved in, -1 for none


LEAVE, CHECK, NOTHING = -1, -2, -3  # `own` leaves its margin circle; to be predicted again; no event
RENEW = -4  # the interval of the body's island ends


AWAKE, AT_REST, CHANGED, CANDIDATE = 0, 1, 2, 3  # `Member.rest`; CHANGED also of a kinematic body that moves


class Member(Record):
    """A body's place in an island: bodies in sustained contact, a chain from the first one, the root."""

    following: int  # next body of the chain, -1 for none
    last: int  # of the root: the last body, and how many there are
    bodies: int
    hits: int  # of the root: how often the island was hit in this step
    busy: int  # steps for which what comes near joins the island rather than hits it
    open: int  # of the root: 1 while contacts of its interval have no entries in the ledger
    tied: int  # of a body held by joints: the first body of its component, else -1; the next one
    next_tied: int
    jointed: int  # of the root: 1 if bodies of its island are held by joints
    rest: int  # AWAKE to CANDIDATE, see `..islands`
    loaded: int  # of the root of an island at rest: 1 while support of moving neighbours is unverified
    among: int  # of the root: `bodies`, and those of the islands that support them
    put: int  # 1 if the body was placed where it is, and may overlap others
    raised: int  # of the root: 1 if a body without mobility was put into its bodies, which it lifts from outside
    anew: int  # of the root of an island at rest: 1 while its forces are new to what supports it


class Rest(Record):
    """Of a body in an island: displacements to add at the end of the interval, timers of rest."""

    lift_x: float  # to add to pose and velocity at the end of the interval; of an open island with joints, what to add
    lift_y: float  # to the pose, and the velocity itself
    lift_angle: float
    lift_vx: float
    lift_vy: float
    lift_spin: float
    augmentation: float  # of the root: its log10 in direct solves, see `contacts/relaxation.py`
    wait: float  # of the root: steps to wait before the next direct solve; the wait that its next failure brings
    backoff: float
    lost: float  # of the root: energy lost in this step; below 0 it is owed
    until: float  # of the root: instant at which the interval ends
    calm_for: float  # steps in a row at whose start the body hardly moved
    speed: float  # that points of the body may get in the step, where all contacts act together
    still_due: float  # `due` of a body at rest at the end of the last step
