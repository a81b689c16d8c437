"""Records of a step: its settings and ledger, its counters."""

from __future__ import annotations

from ..compiled.records import Record


class Step(Record):
    """Settings, instants and energies of a step."""

    dt: float  # length of the step
    now: float  # instant at which the event loop has stopped for more memory
    gravity_x: float
    gravity_y: float
    left_over: float  # factor by which the damping of half a step multiplies velocities
    lock: float  # scale of the energy lock that was farthest from 1
    last: float  # length of the step before
    # The ledger of the step: energies, in the order of `..energy.ledger`.
    restitution: float  # loss
    frictional: float  # loss
    external: float  # work of forces, kinematic bodies and moving surfaces
    damped: float  # loss by `space.damping`
    stored: float  # change of the energy of springs; contained in `after`
    before: float  # kinetic energy and -m g.x at the start of the step
    after: float  # the same at its end, and `stored`
    stamp: float  # number of the step
    pulled: float  # |a|, largest acceleration without contacts: length/time²


class Count(Record):
    """Counters, flags, limits and the state of a step that stopped for more memory."""

    heap: int  # rows of the heap in use
    logged: int  # rows of LOG in use
    impacts: int
    blocks: int  # impacts of many contacts at one instant
    forecasts: int
    stale: int  # events out of date
    limit: int  # impacts that a body may have in a step
    unmet: int  # what was not met
    closing: int  # 1 where bodies that impulses do not move may move relative to one another, and squeeze others
    budget: int  # work of the events of a step of no more than `BUDGET_TIME`, beyond which it is cut short
    work: int  # of the events so far, in looks of the search for an impact
    struck: int
    pushes: int  # rows of PUSHED in use
    solves: int
    ignored: int
    waiting: int  # bodies in BLOCK to be forecast once their islands have begun intervals
    phase: int  # of the step that is to be resumed
    sweeps: int  # of all solves: sweeps, direct solutions
    direct: int
    remembered: int  # rows of the memory of forces in use
    lossy: int  # 1 if any shape's elasticity is below 1
    together: int  # 1 where all contacts of a step act together, and no events are followed
    even: int  # 1 while one acceleration holds for all that impulses move, and no body is in an island
    quiet: int  # steps in a row in which that was so to the end
    disks: int  # of the scene: lone disks
    solved: int  # bodies of all solves
    carries: int  # 1 if islands at rest may support others that move (`islands/support.py`)
    crammed: int  # 1 if the program has placed bodies, which may overlap


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
    "contacts",  # of joints: their solve
    "joints",  # their iteration
)
IMPACTS, HITS, IMPACT, SOLVES, CONTACTS, JOINTS = 0, 1, 2, 3, 4, 5

# Status of the event loop. All but DONE are resumable: lists, log or contacts need more memory, or an event is due that
# the loop itself does not process.
DONE, POOL_FULL, LOG_FULL, BLOCK_DUE, PUSHES_FULL = 0, 1, 2, 3, 4
