"""The event loop of a step: one queue of impacts, margin circles left and searches to be continued.

A body is not moved at the events of others: its path begins at its own last impulse. An event that was predicted for an
older path version of the partner is predicted again when it is taken from the queue; it can only be too early.
"""

from __future__ import annotations

from ..compiled import inlined, kernel, nonallocating
from ..contacts.counts import note_unmet
from ..contacts.forces import table_has_room
from ..contacts.single import only_pair, strike_disk
from ..geometry.sides import remembers
from ..islands.accounting import end_rest_or_interval, lift_within_step
from ..islands.hits import hits_of, most_hits, passed_over
from ..islands.local import drop_ended
from ..islands.membership import island_size, jointed, members, persists_from
from ..jointed.ends import end_here
from ..jointed.ledger import most_looks, work_left
from ..model.bodies import LEAVE, RENEW
from ..model.joints import Joints
from ..model.parameters.events import AHEAD, EVENT_LOOKS, RESOLUTION
from ..model.scene import Scene
from ..model.step import BLOCK_DUE, DONE, HITS, IMPACTS, LOG_FULL, POOL_FULL, PUSHES_FULL
from ..pairs.grid import renew_circle
from ..pairs.rules import mark_pair
from ..prediction.disks import body_of, continue_path
from ..prediction.heap import pop, push_event, sweep_out
from ..prediction.next_event import margin_used
from ..prediction.scheduling import look_ahead, predict_next
from ..prediction.search import note_sides
from .intervals import cut_short, start_waiting
from .joint_impact import collide
from .resolution import strike
from .simultaneous import bring_to

# Rows of LOG that an event may need for each body: shapes of like size touch six others, three pairs for each body, and
# a wall, at two points each. An impact that needs more (`resolution.lacks_room`) is repeated.
_ROWS_OF_A_BODY = 8
# Contacts that an impact on joints may add, besides as many as there are; so many are also removed together.
_MORE_CONTACTS = 64


@inlined
def most_impacts(A: Scene, i: int, j: int) -> int:
    """Number of impacts that a step allows bodies i and j each: COUNT.limit; or RESOLUTION if one of the two is a body
    without mobility that is not the ground, and such bodies may squeeze others (`Count.closing`)."""
    if A.COUNT.closing == 0:
        return A.COUNT.limit
    ground = A.BODY.shape[0] - 1
    carried = (A.BODY[i].inv_mass == 0.0 and i != ground) or (A.BODY[j].inv_mass == 0.0 and j != ground)
    return min(A.COUNT.limit, RESOLUTION) if carried else A.COUNT.limit


@nonallocating
def run_events(A: Scene, may_persist: bool, most: float) -> int:
    """Process events up to the end of the step, or up to the next one that the loop does not process itself (BLOCK_DUE)
    or that needs more memory.

    Args:
        may_persist: False if no contact can, without losses, gravity and forces.  most: COUNT.work after which the step
            is to be cut short.
    """
    BODY, STATE, COUNT, TIME, OF = A.BODY, A.STATE, A.COUNT, A.HEAP_TIME, A.HEAP_BODY
    disks, moving = COUNT.disks, A.LIST.shape[0]
    one, two, t = -1, -1, 0.0  # bodies to be predicted
    while True:
        while one >= 0:
            predict_next(A, one, t, False)
            one, two = two, -1
        if COUNT.heap == 0:
            return DONE
        t, i = TIME[0], OF[0]
        if t != BODY[i].due:
            COUNT.heap = pop(TIME, OF, COUNT.heap)
            continue
        if COUNT.heap + BODY.shape[0] > TIME.shape[0]:
            COUNT.heap = sweep_out(TIME, OF, COUNT.heap, BODY)
        if COUNT.logged == A.LOG.shape[0]:
            return LOG_FULL
        COUNT.heap = pop(TIME, OF, COUNT.heap)
        look_ahead(A, i)
        s, o = STATE[i].own, STATE[i].other
        if o == RENEW or (COUNT.work > most and t > 0.0):
            A.PAR.now, COUNT.event_body = t, i
            return BLOCK_DUE
        if o == LEAVE:
            if i < disks and STATE[i].island < 0:
                room = continue_path(A, i, t)
            else:
                one, room = i, True
                if margin_used(A, s, t):
                    room = renew_circle(A, s, t, AHEAD) >= 0
            if not room:
                A.PAR.now = t
                COUNT.heap = push_event(TIME, OF, COUNT.heap, t, i)
                return POOL_FULL
            continue
        j = body_of(A, o) if o >= 0 else i
        if o < 0 or STATE[j].version != STATE[i].known:
            one = i
            continue
        impacts, allowed = max(STATE[i].impacts, STATE[j].impacts), most_impacts(A, i, j)
        if impacts >= allowed:
            note_unmet(A, IMPACTS, s, o, float(impacts), float(allowed))
            mark_pair(A, s, o, 1)
            one = i
            continue
        closed_form = STATE[i].island < 0 and STATE[j].island < 0 and i < disks and (o < disks or o >= moving)
        if closed_form and may_persist:
            closed_form = not persists_from(A, s, o, t)
        if not (closed_form and only_pair(A, i, o, t)):
            A.PAR.now, COUNT.event_body = t, i
            return BLOCK_DUE
        # The result is the same to the bit, whichever of the two predicted the impact.
        a, b = (o, i) if o < i else (i, o)
        strike_disk(A, a, b, t)
        COUNT.work += EVENT_LOOKS
        one, two = a, b if o < disks else -1


@nonallocating
def renew_island(A: Scene, J: Joints, i: int, t: float) -> int:
    """End the interval of the island of body i at instant t, within the step. Writes its bodies to A.BLOCK; returns
    their number."""
    if jointed(A, i):
        end_here(A, J, i, t)
    else:
        end_rest_or_interval(A, i, t)
        lift_within_step(A, i, t)
    return int(members(A, i, A.BLOCK))


@nonallocating
def end_event(A: Scene) -> None:
    """Count the last event of islands, with the work that it has taken; not if it is tried again, with more memory."""
    COUNT = A.COUNT
    if COUNT.present_bodies > 0 and COUNT.work > COUNT.work_before:
        COUNT.event_bodies += COUNT.present_bodies
        COUNT.events_work += COUNT.work - COUNT.work_before


@nonallocating
def begin_event(A: Scene, i: int, j: int) -> float:
    """Begin an event of bodies i and j. Returns what it will probably take, with the predictions that follow: for each
    body of their islands as much as such events of the step have taken so far."""
    COUNT = A.COUNT
    COUNT.present_bodies, COUNT.work_before = island_size(A, i) + (island_size(A, j) if j != i else 0), COUNT.work
    return float(COUNT.events_work * COUNT.present_bodies / max(COUNT.event_bodies, 1))


@kernel
def process_events(A: Scene, J: Joints, may_persist: bool) -> int:
    """Process all events of the step, with simultaneous impacts and islands. After a status other than DONE: provide
    more memory, and call again. may_persist: as in `run_events`."""
    COUNT, STATE = A.COUNT, A.STATE
    few = -1
    while True:
        if few < 0 or COUNT.pushes > 2 * few + _MORE_CONTACTS:
            drop_ended(A)
            few = COUNT.pushes
        status = start_waiting(A, J) if COUNT.waiting > 0 else DONE
        if status == DONE:
            status = run_events(A, may_persist, most_looks(A, J))
        if status != BLOCK_DUE:
            return status
        t, i = A.PAR.now, COUNT.event_body
        s, o = STATE[i].own, STATE[i].other
        j = i if o < 0 else A.LINK[o].owner
        # Each contact of an interval will have a row of LOG, too.
        if COUNT.logged + COUNT.pushes + max(_ROWS_OF_A_BODY * STATE.shape[0], COUNT.room) > A.LOG.shape[0]:
            COUNT.heap = push_event(A.HEAP_TIME, A.HEAP_BODY, COUNT.heap, t, i)
            return LOG_FULL
        end_event(A)
        # A step is not cut to nothing: impacts at its start act.
        if COUNT.work + begin_event(A, i, j) > most_looks(A, J) and t > 0.0:
            return cut_short(A, J, i, t)
        met = o != RENEW
        if met and remembers(A, s, o):
            note_sides(A, min(s, o), max(s, o), t)
        if met and (STATE[i].island >= 0 or STATE[j].island >= 0) and passed_over(A, s, o, t):
            note_unmet(A, HITS, s, o, float(hits_of(A, s, o)), float(most_hits(A, s, o)))
            mark_pair(A, s, o, 1)
            predict_next(A, i, t, False)
            continue
        joints, waiting = jointed(A, i) or jointed(A, j), 0
        if met and not joints:
            lasts = False
            if may_persist:
                bring_to(A, i, t)
                if A.BODY[j].inv_mass > 0.0:
                    bring_to(A, j, t)
                lasts = persists_from(A, s, o, t)
            waiting = strike(A, s, o, t, lasts)
            joints = waiting < 0  # others of the block are jointed: no impulse has acted
        if joints and work_left(A, J) < 0.0 and t > 0.0:
            return cut_short(A, J, i, t)
        more = 2 * COUNT.pushes + _MORE_CONTACTS
        if joints and (more > A.PUSHED.shape[0] or not table_has_room(A, more)):
            COUNT.heap = push_event(A.HEAP_TIME, A.HEAP_BODY, COUNT.heap, t, i)
            return PUSHES_FULL
        if not met:
            waiting = renew_island(A, J, i, t)
        elif joints:
            waiting = collide(A, J, s, o, t)
        if A.BODY[i].inv_mass == 0.0:
            # A body without mobility is in no island; its event is predicted too.
            A.BLOCK[waiting] = i
            waiting += 1
        COUNT.waiting = waiting
