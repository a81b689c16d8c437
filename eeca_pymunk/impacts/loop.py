"""The event loop of a step: one queue of impacts, leaves and looks, each body on its own clock.

Nobody is moved at another's event: a body's path begins at its own last kink. What was forecast with a path that has
kinked since is forecast anew when it comes up; until then it can only be too early.
"""

from __future__ import annotations

from ..compiled import kernel, merged, uncounted
from ..contacts.single import alone, strike_disk
from ..contacts.unmet import most_work, note_unmet
from ..geometry.sides import remembers
from ..islands.accounting import close_interval, end_interval
from ..islands.building import comes_to_rest, hits_of, most_hits, passed_over
from ..islands.intervals import solve
from ..islands.membership import members
from ..model.bodies import AT_REST, LEAVE, RENEW
from ..model.parameters.events import AHEAD, EVENT_LOOKS, SQUEEZED_IMPACTS
from ..model.scene import Scene
from ..model.step import BLOCK_DUE, DONE, HITS, IMPACTS, JOINTS_DUE, LOG_FULL, POOL_FULL, SOLVES
from ..pairs.grid import renew
from ..pairs.lists import mark_pair
from ..prediction.disks import carrier, go_on
from ..prediction.heap import pop, push, sweep_out
from ..prediction.next_event import has_left
from ..prediction.scheduling import forecast, forecast_all, look_ahead
from ..prediction.turning import follow_side
from .resolution import strike
from .simultaneous import arrive


@uncounted
def jointed(A: Scene, i: int) -> bool:
    """Whether body i is in an island that is held by joints."""
    root = A.STATE[i].island
    return bool(root >= 0 and A.MEMBER[root].jointed > 0)


@merged
def give_up(A: Scene, i: int, j: int) -> bool:
    """Whether bodies i and j have met as often as a step allows."""
    limit = A.COUNT.limit
    if A.STATE[i].events >= limit or A.STATE[j].events >= limit:
        return True
    if A.COUNT.closing == 0:
        return False
    ground = A.BODY.shape[0] - 1
    carried = (A.BODY[i].inv_mass == 0.0 and i != ground) or (A.BODY[j].inv_mass == 0.0 and j != ground)
    return carried and max(A.STATE[i].events, A.STATE[j].events) >= SQUEEZED_IMPACTS


@uncounted
def run(A: Scene, may_rest: bool) -> int:
    """Follow the events until the end of the step, or the next one that is a block (BLOCK_DUE) or wants more room.

    Args:
        may_rest: whether contacts may be sustained.
    """
    BODY, STATE, COUNT, TIME, OF = A.BODY, A.STATE, A.COUNT, A.HEAP_TIME, A.HEAP_BODY
    disks, moving, end, most = COUNT.disks, A.LIST.shape[0], A.PAR.dt, most_work(A)
    one, two, t = -1, -1, 0.0  # bodies to be forecast
    while True:
        while one >= 0:
            forecast(A, one, t, end, False)
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
        if o == LEAVE:
            if i < disks and STATE[i].island < 0:
                room = go_on(A, i, t, end)
            else:
                one, room = i, True
                if has_left(A, s, t):
                    room = renew(A, s, t, AHEAD) >= 0
            if not room:
                A.PAR.now = t
                COUNT.heap = push(TIME, OF, COUNT.heap, t, i)
                return POOL_FULL
            continue
        if o == RENEW:
            A.PAR.now, COUNT.struck = t, i
            return BLOCK_DUE
        j = carrier(A, o) if o >= 0 else i
        if o < 0 or STATE[j].version != STATE[i].known:
            COUNT.stale += 1
            one = i
            continue
        if give_up(A, i, j):
            note_unmet(A, IMPACTS, s, o, float(max(STATE[i].events, STATE[j].events)), float(COUNT.limit))
            mark_pair(A, s, o, 1)
            one = i
            continue
        single = STATE[i].island < 0 and STATE[j].island < 0 and i < disks and (o < disks or o >= moving)
        if single and may_rest:
            single = not comes_to_rest(A, s, o, t)
        body, other = i, o
        for _ in range(2):
            if single and body >= 0:
                single = alone(A, body, other, t)
            body, other = (j, i) if o < disks else (-1, -1)
        if not single or COUNT.work > most:
            A.PAR.now, COUNT.struck = t, i
            return BLOCK_DUE
        # The same bits, whoever of the two has foreseen it.
        a, b = (o, i) if o < i else (i, o)
        strike_disk(A, a, b, t)
        COUNT.work += EVENT_LOOKS
        one, two = a, b if o < disks else -1


@uncounted
def with_mover(A: Scene, i: int, n: int) -> int:
    """How many of A.BLOCK are to be forecast after an event of body i that changed n: i too, if no impulse moves it."""
    if A.BODY[i].inv_mass > 0.0:
        return n
    A.BLOCK[n] = i
    return n + 1


@uncounted
def cut_short(A: Scene, t: float) -> int:
    """Let the step end at instant t: so nothing that it has no work left for is passed over. Spans end there, without
    what they would have lifted at their own end."""
    a, b = A.STATE[A.COUNT.struck].own, A.STATE[A.COUNT.struck].other
    note_unmet(A, SOLVES, a, b, float(A.COUNT.work), most_work(A))
    A.PAR.dt = t
    A.COUNT.heap = 0
    for i in range(A.BODY.shape[0] - 1):
        root = A.STATE[i].island
        if root < 0 or A.MEMBER[root].jointed > 0 or A.MEMBER[root].rest == AT_REST:
            continue
        if root == i and A.MEMBER[i].open > 0:
            close_interval(A, i, t)
        rest = A.RESTING[i]
        rest.lift_x, rest.lift_y, rest.lift_angle = 0.0, 0.0, 0.0
        rest.lift_vx, rest.lift_vy, rest.lift_spin = 0.0, 0.0, 0.0
    return DONE


@kernel
def follow(A: Scene, may_rest: bool) -> int:
    """The events of the step, blocks and islands included. After a status other than DONE, make room and call again.

    JOINTS_DUE: the interval of island COUNT[PENDING], or if there is none the event of body COUNT[STRUCK], is to be
    done: its impact, or the end of the interval of its island.
    """
    COUNT, STATE, BLOCK = A.COUNT, A.STATE, A.BLOCK
    end = A.PAR.dt
    if COUNT.pending >= 0:
        status = solve(A, COUNT.pending, A.PAR.now)
        if status != DONE:
            return status
        COUNT.pending = -1
        forecast_all(A, COUNT.waiting, A.PAR.now, end)
    while True:
        status = run(A, may_rest)
        if status != BLOCK_DUE:
            return status
        t, i = A.PAR.now, COUNT.struck
        s, o = STATE[i].own, STATE[i].other
        if COUNT.work > most_work(A):
            return cut_short(A, t)
        if COUNT.logged + COUNT.pushes + 8 * STATE.shape[0] > A.LOG.shape[0]:
            COUNT.heap = push(A.HEAP_TIME, A.HEAP_BODY, COUNT.heap, t, i)
            return LOG_FULL
        if o == RENEW and jointed(A, i):
            return JOINTS_DUE
        if o == RENEW:
            end_interval(A, i, t)
            n = members(A, i, BLOCK)
            status = solve(A, i, t)
            COUNT.waiting, COUNT.pending = n, -1 if status == DONE else i
            if status != DONE:
                return status
            forecast_all(A, n, t, end)
            continue
        j = A.LINK[o].owner
        if remembers(A, s, o):
            follow_side(A, s, o, t, end)
        if (STATE[i].island >= 0 or STATE[j].island >= 0) and passed_over(A, s, o, t):
            note_unmet(A, HITS, s, o, float(hits_of(A, s, o)), float(most_hits(A, s, o)))
            mark_pair(A, s, o, 1)
            forecast(A, i, t, end, False)
            continue
        if jointed(A, i) or jointed(A, j):
            return JOINTS_DUE
        rest = False
        if may_rest:
            arrive(A, i, t)
            if A.BODY[j].inv_mass > 0.0:
                arrive(A, j, t)
            rest = comes_to_rest(A, s, o, t)
        status, n = strike(A, s, o, t, rest)
        n = with_mover(A, i, n)
        COUNT.waiting = n
        if status != DONE:
            return status
        forecast_all(A, n, t, end)
