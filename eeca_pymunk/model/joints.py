"""Records of joints: the joints of a scene, the plan of their components.

A component is a set of bodies that hang together by joints. Bodies that joints cannot move bind nothing: they take part
in several components.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from ..arrays import FloatArray, IntArray
from ..compiled import Opener
from ..compiled.records import Record, Rows
from .bodies import Body
from .joint_steps import Agreement, BodyStep, JointLedger, JointStep, Newton, Parts, Progress


class Joint(Record):
    """A joint, in the order of the space: its parameters, and what steps leave in it.

    A joint's impulse `lam` acts along its rows J, which are the *discrete* gradient of its function g over a step:
    g1 - g0 = J . (h v_m), v_m = (v0 + v1)/2, so that J^T lam does no work where g does not change.
    """

    kind: int  # PIN ... ROTARY_SPRING
    body: Annotated[IntArray, 2]  # rows of its bodies a and b
    finite_force: int  # 1 if max_force is finite: |lam| <= max_force h
    anchor_a: Annotated[FloatArray, 2]  # in the frame of body a, from its centre of mass: length
    anchor_b: Annotated[FloatArray, 2]
    max_force: float  # force or torque; infinite for a joint that holds exactly
    error_bias: float  # part of an error that is left after a unit of time
    max_bias: float  # fastest closing speed
    length: float  # of a pin: length, > 0
    lower: float  # limits of a slide (length), of angle_b - angle_a (rad), of a groove's ends along it (length)
    upper: float
    normal: Annotated[FloatArray, 2]  # of a groove, on body a: unit normal
    offset: float  # of a groove: n . (its points - centre of mass), length
    stiffness: float  # of springs: force/length, torque/rad
    damping: float  # of springs: force time/length, torque time/rad
    rest: float  # of springs: length, rad
    push: float  # of springs: force (torque on b) added to the linear law
    ratio: float  # of a gear: angle_b ratio - angle_a = phase
    phase: float
    rate: float  # of a motor: spin_a - spin_b, rad/time
    tooth: float  # of a ratchet: angle between notches, signed
    tooth_phase: float  # of a ratchet: angle of one notch
    notch: float  # of a ratchet: angle_b - angle_a does not go back beyond it, rad
    side: int  # of a limit that holds: -1 the lower, 1 the upper, lam side <= 0; 0 between them
    touched: int  # 0, EDITED, APART, LEFT_APART, GIVES_WAY or TAKEN_OVER
    impulse: Annotated[FloatArray, 2]  # of the last step along the rows; of a spring along d, of a rotary one on b
    struck: Annotated[FloatArray, 2]  # impulses by which the joint has answered impacts of the last step
    last_step: float  # its dt; 0 if none
    led: Annotated[FloatArray, 2, 3]  # accelerations that joints gave to bodies a and b last
    known_parts: int  # parts of steps of order 4 that are known (`..joints.foresight`); the length of their steps
    known_step: float
    past_led: Annotated[FloatArray, 6, 6]  # accelerations of bodies a and b along their three ways in parts of a step
    past_push: Annotated[FloatArray, 2, 6]  # impulses along two rows, over the lengths of the parts
    compliance: float  # of the first joint of a component: with which compliance (time²) joints gave way in the last
    # step, 0 if they held


# Kinds of joints.
PIN, PIVOT, GROOVE, SLIDE, SPRING = 0, 1, 2, 3, 4
GEAR, ROTARY_LIMIT, RATCHET, MOTOR, ROTARY_SPRING = 5, 6, 7, 8, 9

# Why a joint is not taken to be closed. The user changed the joint or its bodies since the last step; it is still apart
# from that; linear rows of a step left it so; it gives way elastically; no step of any of its bodies is known.
EDITED, APART, LEFT_APART, GIVES_WAY, TAKEN_OVER = 1, 2, 3, 4, 5

# Fields that steps change.
OF_STEPS = (
    "touched", "side", "impulse", "struck", "last_step", "led", "known_parts", "known_step", "past_led",
    "past_push", "compliance",
)  # fmt: skip


class Component(Record):
    """A component: its slices of JOINED and COUPLING, its linear systems."""

    first_body: int
    end_body: int
    first_joint: int
    end_joint: int
    unknowns: int  # size and half-width of its matrix
    band: int
    cycles: int  # joints whose rows may depend on those of others (`..joints.plan.count_cycles`)
    cycles_with_bounded: int  # the same, if bounded rows held exactly
    system: int  # WHOLE or CONDENSED
    impulses: int  # number of unknowns beside the matrix
    dual_size: int  # of its matrix in the rows alone: size and half-width
    dual_band: int
    dual_for: int  # what its dual system is taken for: UNUSED, INSTANTS (POSES, SPEEDS) or STEPS too
    taut: int  # 1 if impulses of the last step pull so hard that this one begins with them (`..joints.step`)
    dependence: int  # of its rows at the present start: UNTESTED, INDEPENDENT, DEPENDENT (`..joints.step.rows_depend`)
    bounded_rows: int  # most rows of bounded impulses that may act, if few enough to be solved with contacts; else 0
    bounded_joints: int  # its motors, and joints with a finite max_force
    driven: int  # 1 if it has a motor of unlimited force
    factored: int  # 1 if the present step can begin with the factors in the scratch; or OTHERWISE
    parts: int  # parts of the last solution from the present start that are known (`..joints.parts`)
    parts_within: float  # length of its step
    part_limit: Annotated[IntArray, 6]  # joint (`Coupling`) whose limit each part met, -1 for the last; its side
    part_side: Annotated[IntArray, 6]
    part_length: Annotated[FloatArray, 6]


# Linear systems: of bodies and rows; of bodies alone (`..newton.condensed`); of rows alone (`..newton.dual`).
WHOLE, CONDENSED, DUAL = 0, 1, 2
UNUSED, INSTANTS, STEPS = 0, 1, 2  # uses of a dual one: `Component.dual_for`
UNTESTED, INDEPENDENT, DEPENDENT = 0, 1, 2  # `Component.dependence`; UNTESTED where no joint closes a cycle
FORCES_ON, TORQUES_ON = 1, 2  # bits: what joints exert on a body


class ComponentBody(Record):
    """A body of a component."""

    body: int  # row of `Body`, or their number + row of PARTNER
    column: int  # first unknown of the body
    freedoms: int  # number of its unknowns: 0 (joints cannot move it), 2 (joints do not turn it) or 3
    cayley: int  # 1 if the body turns by 2 atan(chi/2), see `BodyStep`
    acted: int  # what joints exert on it: FORCES_ON, TORQUES_ON, or both
    first: int  # first joint with impulses on it, as `Coupling.following`


class Coupling(Record):
    """A joint of a component: its place there."""

    kind: int  # as `Joint.kind`
    body: Annotated[IntArray, 2]  # bodies a and b by their numbers in the component
    side: int  # as `Joint.side`, in the present step
    let_go: int  # `side` of a limit at the start of the present part of the step, if it was released since, else 0
    bounded: int  # 0 for rows that hold exactly; BOUNDED or PRESCRIBED
    rows: int  # number of rows, and first unknown of their impulses
    first_row: int
    joint: int  # row of `Joint`
    first_dual: int  # its first unknown in a system in the rows alone
    following: Annotated[IntArray, 2]  # next joint on body a, on body b: 2 k + (0 as its body a, 1 as b), -1 for none


# Impulses within bounds; these given, for an answer to other impulses.
BOUNDED, PRESCRIBED = 1, 2
OTHERWISE = -1  # of `factored`: other rows act since, or have come to their bounds or left them


FREE, WHOLLY, CENTRE, WELDED = 0, 1, 2, 3  # what of a body joints hold where it is


class Pinned(Record):
    """A body that joints hold where it is (`..joints.pinned`)."""

    body: int  # row of `Body`
    kind: int  # WHOLLY, CENTRE or WELDED
    weld: Annotated[IntArray, 2]  # of a welded body: 2 j + (0 as its body a, 1 as b) of its pivot and its gear
    link: int  # of a welded body: number of welds from there to the fixed body
    x: float  # pose: length, length, rad
    y: float
    angle: float
    inv_mass: float  # of the body, whose rows of BODY say that nothing moves it
    inv_inertia: float


class Tally(Record):
    """Counters of the components of a scene."""

    components: int
    order: int  # of steps without dissipation, drives and contacts: 4, or 2
    pinned: int  # rows of PINNED in use
    worst: int  # status of the step
    answers: int  # linear system of the response that was prepared last (`..newton.response`)
    passes: int  # of each answer if that is condensed
    refined: int  # refinements of each answer, as rows may be redundant


class Joints(NamedTuple):
    """The arrays of the joints of a scene.

    JOINT (j,): bodies are rows of BODY (n rows) or n + row of PARTNER (x,), which joints cannot move; STILL (n + x,): 1
    for static partners, and for kinematic bodies of BODY at rest, (0,) if there can be none. PINNED: bodies that joints
    hold where they are, sorted. The plan: COMPONENT (components,), with the bodies of each in JOINED and its joints in
    COUPLING; ROOM (6,): see `measure_plan`. Scratch for the largest component: HINGE, LOCAL, of its joints and bodies;
    MATRIX, banded; RIGHT, right sides; PIVOTS; MORE, of linear systems and bounded rows; STIFF (6, 6), derivative of a
    joint's impulse by the ways of its bodies; PROGRESS; NEWTON; PARTS; AGREEMENT; RUNG_LEDGER, of the present attempt
    at a step. OF (n,): the component of a body, -1 for none. AT_START (j,): the joints at the start of an interval.
    STEPPED (components,): their ledgers in their intervals.
    """

    JOINT: Rows[Joint]
    PARTNER: Rows[Body]
    STILL: IntArray
    PINNED: Rows[Pinned]
    ROOM: IntArray
    COMPONENT: Rows[Component]
    JOINED: Rows[ComponentBody]
    COUPLING: Rows[Coupling]
    HINGE: Rows[JointStep]
    LOCAL: Rows[BodyStep]
    MATRIX: FloatArray
    RIGHT: FloatArray
    MORE: FloatArray
    STIFF: FloatArray
    PROGRESS: Progress
    NEWTON: Newton
    PARTS: Parts
    AGREEMENT: Agreement
    RUNG_LEDGER: JointLedger
    PIVOTS: IntArray
    OF: IntArray
    AT_START: Rows[Joint]
    STEPPED: Rows[JointLedger]
    TALLY: Tally


# What a return to an earlier step restores; the rest is scratch that each step writes first.
OF_JOINTS = (
    "JOINT", "HINGE", "LOCAL", "STIFF", "PROGRESS", "PARTS", "RUNG_LEDGER", "PIVOTS", "AT_START", "STEPPED", "TALLY"
)  # fmt: skip

joints_of = Opener(Joints)


class Workspace(NamedTuple):
    """Component s of the joints J, for its step: link (joints,) are its joints; how many joints and bodies it has."""

    J: Joints
    s: int
    link: Rows[Coupling]
    joints: int
    bodies: int
