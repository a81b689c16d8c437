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
    impacts: int  # of single disks
    blocks: int  # simultaneous impacts
    forecasts: int  # predictions
    stale: int  # events that were predicted for an older path version
    limit: int  # impacts of a body in a step, at most
    unmet: int  # budgets and tolerances that were not met
    closing: int  # 1 if bodies that impulses do not move may move relative to each other, and squeeze others
    budget: int  # limit of `solved`, beyond which the step ends early
    struck: int  # body whose event has stopped the loop
    pushes: int  # rows of PUSHED in use
    solves: int  # of islands
    ignored: int  # impacts that were passed over
    pending: int  # island whose interval has to begin, -1 for none
    waiting: int  # bodies in BLOCK to be predicted afterwards
    phase: int  # 0 islands, 1 events, 2 end: where the step is resumed
    sweeps: int  # of all solves
    direct: int  # direct solutions of all solves
    remembered: int  # rows of the memory of forces in use
    together: int  # 1 in a step of `Midstep`: all contacts act together, no events are followed
    even: int  # 1 while all bodies that impulses move have one acceleration, and no body is in an island
    quiet: int  # number of steps in a row that ended with `even`
    disks: int  # single disks of the scene
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
    "impacts",  # number of impacts of a body in a step (`TimeOfImpact.max_impacts`): further ones are ignored
    "hits",  # number of hits on an island in a step: further impacts are passed over until the next step
    "impact",  # residual velocity of a simultaneous impact: length/time
    "solves",  # number of bodies in all solves: the step ends early
    "contacts",  # solve of the contacts of jointed bodies; value and limit are nan
    "joints",  # status of the joints' solve (`joints.EXACT` to `LINEAR`)
)
IMPACTS, HITS, IMPACT, SOLVES, CONTACTS, JOINTS = 0, 1, 2, 3, 4, 5

# Status of the event loop. All but DONE are resumable: lists, log or contacts need more memory, or an event is due that
# the loop itself does not process.
DONE, POOL_FULL, LOG_FULL, BLOCK_DUE, PUSHES_FULL = 0, 1, 2, 3, 4
JOINTS_DUE = 5  # an interval or an impact of an island with joints: `jointed/`
