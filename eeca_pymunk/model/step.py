"""Records of a step: its settings and ledger, its counters."""

from __future__ import annotations

from ..compiled.records import Record


class Step(Record):
    """Settings, instants and energies of a step."""

    dt: float  # length of the step, as far as it is not cut short
    planned: float  # its length before
    share: float  # part of the budgets of a step that it may spend; below 1 if it may have to be repeated
    spent: float  # part that it has spent, if `share` was below 1
    instant: float  # length up to which intervals of islands with joints are empty
    now: float  # instant at which the event loop has stopped for more memory
    gravity_x: float
    gravity_y: float
    half_damping: float  # factor by which the damping of half a step multiplies velocities
    lock: float  # scale of the energy lock that was farthest from 1
    last: float  # length of the step before
    # The book of the step, from which `..energy.ledger` makes its ledger: energies.
    restitution: float  # loss
    frictional: float  # loss
    external: float  # work of forces, kinematic bodies and moving surfaces
    damped: float  # loss by `space.damping`
    stored: float  # change of the energy of springs; contained in `after`
    before: float  # kinetic energy and -m g.x at the start of the step
    after: float  # the same at its end, and `stored`
    stamp: float  # number of the step
    pulled: float  # |a|, largest acceleration without contacts: length/time²
    rules: float  # `pairs.rules.checksum` of the laws of pairs when islands were last built


class Count(Record):
    """Counters, flags, limits and the state of a step that stopped for more memory."""

    heap: int  # rows of the heap in use
    logged: int  # rows of LOG in use
    blocks: int  # number of simultaneous impacts of several pairs of shapes
    limit: int  # impacts that a body may have in a step
    unmet: int  # number of budgets and tolerances that the step has not met
    closing: int  # 1 if bodies that impulses do not move may move relative to each other, and squeeze others
    budget: int  # largest work of the events of a step no longer than `BUDGET_TIME`, in looks
    work: float  # work of the events so far, in looks: evaluations of a gap in the search for an impact
    event_bodies: int  # bodies of the islands of earlier events of the step, counted in each event
    events_work: float  # work of these events, and of the predictions that followed
    present_bodies: int  # bodies of the islands of the present event
    work_before: float  # work before it
    event_body: int  # body of the event at which the event loop has stopped
    room: int  # rows of LOG that the impact needs which is to be repeated with more memory
    pushes: int  # rows of PUSHED in use: contacts of intervals
    solves: int  # number of intervals of islands in the step
    waiting: int  # number of bodies in BLOCK to be predicted after their islands have begun intervals
    bits: int  # status of the step so far
    phase: int  # stage of the step at which it is resumed, see `impacts.step.act`
    direct: int  # number of direct solves
    remembered: int  # rows in use of the memory of forces
    lossy: int  # 1 if any shape's elasticity is below 1
    together: int  # 1 if all contacts of a step act together (`Midstep`), without events
    even: int  # 1 while all bodies that impulses move have the same acceleration, and none is in an island
    quiet: int  # number of steps in a row at whose end `even` was 1
    disks: int  # number of single disks of the scene
    solved: int  # number of bodies of all solves
    may_support: int  # 1 if islands at rest may support moving ones (`islands/support.py`)
    any_placed: int  # 1 if the program has placed bodies, or freed them of joints; 2 if the rows are others, too


class Missed(Record):
    """A budget or tolerance that was not met."""

    kind: float  # index into `KINDS`
    first: float  # shapes, -1 for none
    second: float
    value: float  # value reached, in the unit of its kind
    limit: float  # largest value allowed


# Kinds of `Missed`: what is counted or measured.
KINDS = (
    "impacts",  # of a body in a step (`TimeOfImpact.max_impacts`): later ones are left out
    "hits",  # on an island in a step: later ones are left for the next step
    "impact",  # velocity that the impulses of an impact leave
    "solves",  # work of all events and solves: the step ends before its time
    "contacts",  # velocity that contacts of an interval leave
    "joints",  # status of the solve of a component
)
IMPACTS, HITS, IMPACT, SOLVES, CONTACTS, JOINTS = 0, 1, 2, 3, 4, 5

# Status of a step: bits (there are impulses, or something is unmet; forces have to be reset; angles or spins have to be
# written), or a negative code.
EVENTS, FORCES, TURNS = 1, 2, 4
# The bodies are others; a static one was moved; a number that was read, a state or the energy at the end is not finite.
OTHER_BODIES, MOVED_STATIC, NOT_FINITE, OVERFLOW, ENERGY = -1, -2, -3, -4, -5
# Lists, log, contacts, or the impacts that a run stores, need more memory: provide it, and resume the step.
POOL_FULL, LOG_FULL, PUSHES_FULL, IMPACTS_FULL = -10, -11, -12, -13
# Of the stages of a step: done; an event is due that the event loop itself does not process.
DONE, BLOCK_DUE = 0, 1
# Of an interval, with nothing done: it is to be shorter; there is no work left for it in this step.
AGAIN, SPENT = -1, -2


def needs_memory(status: int) -> bool:
    """Whether a step has stopped for more memory."""
    return status <= POOL_FULL
