"""Records of a component's step: scratch of its bodies and joints, how far its solution is, its energies."""

from __future__ import annotations

from typing import Annotated

from ..arrays import FloatArray
from ..compiled.records import Record


class BodyStep(Record):
    """Scratch of a body over a step h of its component. Velocities and ways are along x, along y, about the centre.

    The body takes the way h v_m = h (v0 + v1)/2 and turns by 2 atan(chi/2), chi = h w_m (Cayley), for then
    r1 - r0 = chi z x r_m with r_m = (r0 + r1)/2 exactly, and energy and angular momentum are conserved both. A body
    that no joint holds off its centre of mass, and one that cannot be turned, turns by chi; its levers are
    tan(chi/2)/(chi/2) r_m.
    """

    pose: Annotated[FloatArray, 3]  # x, y, angle of the centre of mass at the start
    v0: Annotated[FloatArray, 3]  # velocity at the start
    v1: Annotated[FloatArray, 3]  # at the end; the unknowns
    acceleration: Annotated[FloatArray, 3]  # without joints
    mobility: Annotated[FloatArray, 3]  # 1/mass, 1/mass, 1/moment; 0 where joints cannot move
    root: Annotated[FloatArray, 3]  # square roots of the mobilities
    unroot: Annotated[FloatArray, 3]  # reciprocals of these, 0 where they are
    cos: float  # of the angle at the start
    sin: float
    way: Annotated[FloatArray, 3]  # h v_m; the last is chi
    turn_cos: float  # of the angle turned
    turn_sin: float
    slope: float  # derivative of the angle turned by chi
    lever: float  # levers over r_m
    turned: float  # angle turned
    per: float  # turned/chi
    per_slope: float  # derivative of `per` by chi
    impulse: Annotated[FloatArray, 3]  # of the joints
    lead: Annotated[FloatArray, 3]  # acceleration by joints that Newton's method begins with
    inertia: Annotated[FloatArray, 3]  # diagonal of the bodies' part of a dual system, scaled; factored, the reciprocal
    v_before: Annotated[FloatArray, 3]  # velocities to come back to
    saved_pose: Annotated[FloatArray, 3]  # at the start of the whole step
    saved_velocity: Annotated[FloatArray, 3]
    shift: Annotated[FloatArray, 3]  # how far closing of joints moved it at the start
    travel: Annotated[FloatArray, 3]  # `shift` and the sum of `way` over all parts of the step
    mean: Annotated[FloatArray, 2]  # integral of x, y over the parts' time: a constant force acts at that over h
    cayley: int  # as in `ComponentBody`
    acted: int
    column: int
    freedoms: int
    first: int


class JointStep(Record):
    """Scratch of a joint over a step of its component. Rows have six entries: three for body a, three for body b, along
    x, along y, about the centre of mass."""

    arm_a: Annotated[FloatArray, 2]  # arms at the start; of joints of angles the angle at the start, and nothing
    arm_b: Annotated[FloatArray, 2]
    span: Annotated[FloatArray, 2]  # d = anchor b - anchor a at the start; of a groove: anchor b - centre a
    normal: Annotated[FloatArray, 2]  # of a groove, at the start
    drag: float  # damping that makes the midpoint rule as exact as exp(-c K h)
    began: float  # of springs: length, or angle_a - angle_b, at the start
    ended: float  # and at the end
    lam: Annotated[FloatArray, 2]  # impulse along the rows, of springs their own
    target: Annotated[FloatArray, 2]  # what the functions g shall be at the end; of bounded joints: the speed
    scale: Annotated[FloatArray, 2]  # 1/sqrt of the diagonal of J M^-1 J^T
    bound: float  # largest force of a bounded joint: max_force, or that of a stalled motor (`..joints.start`)
    unit: float  # of g (`..newton.rows.unit_of`): length of the component, 1 for angles, 1/|ratio| for gears
    measure: float  # of limits what they bound, at the end: length, angle, place in a groove; of springs the mean force
    total: Annotated[FloatArray, 2]  # impulse over all parts of the step
    pushed: Annotated[FloatArray, 2]  # impulse of a correction
    value: Annotated[FloatArray, 2]  # g at the end of the present iterate
    force: Annotated[FloatArray, 6]  # J^T lam
    rows: Annotated[FloatArray, 2, 6]  # J
    slopes: Annotated[FloatArray, 2, 6]  # G = dg/d(h v_m)
    weight: Annotated[FloatArray, 2]  # of the rows in a condensed system; 0 if they do not act, -1 if lam is known
    missing: Annotated[FloatArray, 2]  # what a condensed system still lacks of its rows
    frozen_rows: Annotated[FloatArray, 2, 6]  # scaled J of the factors of a linear system
    frozen_slopes: Annotated[FloatArray, 2, 6]  # scaled G of these


STIFF_NONE, STIFF_TURNS, STIFF_ALL = 0, 1, 2  # what of STIFF is there: nothing, [2, 2] and [5, 5], all

# What is solved for: the implicit step; poses or velocities that fit the joints; the step with rows of the start.
STEP, POSES, SPEEDS, LINEAR_STEP = 0, 1, 2, 3


class Progress(Record):
    """How far the solutions of a component are, and what they may take."""

    near: float  # error of a step that is near enough, 0 for round-off
    tolerance: float  # by which velocities and contacts' laws may differ in the last interval that had contacts
    effort: float  # operations that solutions have taken since the step of the scene began; how many they may
    budget: float
    share: float  # of `effort`, at which an interval gives up
    limit: float  # of `effort`, at which the step of a component gives up what its ladder has before linear rows
    most_epsilon: float  # largest term on the diagonal of redundant rows (`..newton.solve`)
    attempt: int  # at an interval with contacts: FINAL, SHORT or LONG
    factors_of: int  # 1 + number of the component of whose last motion in this interval the scratch has factors; or 0


class Newton(Record):
    """A solve of a component by Newton's method (`..newton.solve`). Errors are parts of the size of the component."""

    error: float  # of the present iterate
    least: float  # the least before, infinite at first
    last: float  # that of the iteration before
    pace: float  # how many times as large as the one before it
    iteration: int
    since: int  # the iteration in which it has begun again, with factors FULL
    stalls: int  # iterations without progress
    factors: int  # OLD, NEW or FULL
    renewed: int  # 1 if those of the iteration before were NEW
    system: int  # the linear system in use


class Agreement(Record):
    """How far the contacts and the components of an interval agree (`..jointed.iteration`). Differences, tolerances
    and residuals are velocities."""

    slow: float  # root mean square of the speeds of the island's bodies, and the largest
    fast: float
    pull: float  # the largest acceleration of a point, |a|
    owed: float  # energy >= 0 that the contacts have to lose at least
    top_speed: float  # the largest speed that impulses may explain
    scale: float  # the unit of errors, and three tolerances (`..jointed.contact_laws.set_aims`)
    agree: float
    enough: float
    fine: float
    residual: float  # by which the last solution of the contacts' laws breaks them
    least: float  # smallest difference between contacts and components since contacts last gained energy
    reached: float  # smallest of all
    of_least: int  # the iteration of `least`
    rough: int  # 1 if the laws' solution is rough (`..jointed.contact_laws.solve_laws`)
    limited: int  # 1 if friction is limited by energy
    filled: int  # 1 if the columns are those of the motion with which iterations ended
    agreed: int  # 1 if iterations ended as contacts and components agree
    converged: int  # 1 if contacts are solved
    bent: float  # error of the arms of contacts (`..jointed.advance.align`)


class Parts(Record):
    """A step taken in parts between instants at which limits are met: what is left of it, the solve of the present
    part, and the search for the instant at which a limit is met."""

    left: float  # time from the start of the part to the end of the step
    when: float  # length of the next solve, and of the last one from the start of the part, 0 for none
    solved: float
    low: float  # instants before and after that at which the limit is met
    high: float
    last: float  # the last instant that was looked at, and the gap there
    gap: float
    limit: int  # the joint whose limit is searched, -1 for none, and the side of that
    side: int
    foreseen: int  # 1 if the last solution of the step has met it
    secants: int  # instants looked at for it
    part: int  # parts that have been taken
    events: int  # limits that were passed, solves, limits held after a hop in this part
    solves: int
    hopped: int


class JointLedger(Record):
    """Energies of a step of a component. K is kinetic energy, W the work of the bodies' constant accelerations:

    K1 - K0 - W + stored = motors + supports + closed - damped - limited - clamped - projected.
    """

    stored: float  # change of what springs hold
    damped: float  # loss >= 0 in damped springs
    limited: float  # loss >= 0 at limits; all of a step whose joints did not hold, or that moved as one
    clamped: float  # loss >= 0 in joints that slip at their max_force
    projected: float  # loss >= 0 of velocities that violated joints
    motors: float  # work of motors, and of joints with a finite max_force where it is positive
    supports: float  # work of bodies that move without being moved
    frame_work: float  # the same by the balance of momentum, of supports that move as one (`..joints.frame`)
    closed: float  # work of closing joints that were apart at the start, of elastic joints, of linear steps
    turned_work: float  # with contacts: work of torques beyond that along the angle
    lifted: float  # energy that separating overlapping bodies costs, paid from the losses of contacts
    misfit: float  # largest error of a joint at the start, over its unit, and how much more of it at the end
    misfit_added: float
    status: int  # of the step


# Status of a component's step: joints hold to round-off; the step was taken in parts, or elastically with errors up to
# NEARLY_HELD; joints gave way elastically in some part; rows of the start held at mid-velocity in some part (energy
# conserved, joints to O(h^2)), or all bodies moved as one (`..joints.lock.move_rigidly`).
EXACT, NEARLY, ELASTIC, UNHELD = 0, 1, 2, 3
# Attempts at an interval with contacts: no other follows; a shorter one may, also for a LONG one, in which no component
# is stepped in parts.
FINAL, SHORT, LONG = 0, 1, 2
