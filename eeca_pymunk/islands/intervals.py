"""The interval of an island: its bodies follow parabolas from an instant on, on which others may hit it."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FlagArray, FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..contacts.correction import correct_penetration, without_turning
from ..contacts.counts import count_solve, note_solution
from ..contacts.interval import make_contacts, step_island
from ..model.contacts import Problem
from ..model.islands import Island, IslandContacts
from ..model.parameters.intervals import INTERVAL_RETRY, INTERVAL_TRIES
from ..model.scene import Scene
from ..model.step import AGAIN, DONE, PUSHES_FULL
from . import candidates
from .at_rest import put_to_rest
from .depths import left_to_lift, lifts_through, times_too_long
from .local import clear_places, lacks_rows, local_island, number_bodies, open_interval
from .membership import lossy
from .payment import payment, was_placed
from .rest import rest_threshold


@nonallocating
def bodies_with_supports(A: Scene, isle: Island, n: int) -> int:
    """Number of bodies of an island, n, and of the islands at rest that support it."""
    found, last = n, -1
    for q in range(n, len(isle.WHO)):
        root = A.STATE[isle.WHO[q]].island
        if A.BODY[isle.WHO[q]].inv_mass > 0.0 and root >= 0 and root != last:
            found, last = found + A.MEMBER[root].bodies, root
    return found


@kernel
def begin_interval(A: Scene, root: int, t: float) -> int:
    """Begin an interval of an island at instant t, at which all its bodies are. Bodies without contacts leave it.

    The interval ends with the step, or earlier: before a normal rotates far (`interval_length`), before bodies move far
    by their present velocities (`interval_within_way`), or where slip ends (`slip_time`). If the motion that was solved
    goes too far (`depths.times_too_long`), it is solved again, shorter; the last attempt is kept.

    Returns DONE, or PUSHES_FULL, which leaves everything as it was.
    """
    longest = A.PAR.dt - t
    for attempt in range(INTERVAL_TRIES):
        status, longest = try_interval(A, root, t, longest, attempt + 1 == INTERVAL_TRIES or A.COUNT.together > 0)
        if status != AGAIN:
            return status
    return DONE  # not reached: the last attempt is never AGAIN


@nonallocating
def begin_paths(A: Scene, MINE: IntArray, V: FloatArray, VN: FloatArray, h: float, TOUCHED: FlagArray) -> int:
    """Set the paths of the bodies MINE over the interval h, from velocities V to VN (k, 3), and join those that are
    TOUCHED (k,) to the chain of the island; others leave it, without forces of contacts.

    Returns the first body of the chain, the root of the island, -1 if there is none.
    """
    BODY, STATE, MEMBER = A.BODY, A.STATE, A.MEMBER
    head, tail, size = -1, -1, 0
    for q in range(len(MINE)):
        i = MINE[q]
        STATE[i].version += 1
        if TOUCHED[q] == 0:
            STATE[i].island = -1
            BODY[i].ax, BODY[i].ay, BODY[i].angular = A.PULL[i, 0], A.PULL[i, 1], A.PULL[i, 2]
            continue
        BODY[i].ax, BODY[i].ay = (VN[q, 0] - V[q, 0]) / h, (VN[q, 1] - V[q, 1]) / h
        BODY[i].angular = (VN[q, 2] - V[q, 2]) / h
        if head < 0:
            head = i
        else:
            MEMBER[tail].following = i
        tail = i
        size += 1
        STATE[i].island, MEMBER[i].following = head, -1
    if head >= 0:
        MEMBER[head].last, MEMBER[head].bodies = tail, size
    return head


@kernel
def correct_interval(
    A: Scene, root: int, isle: Island, contacts: IslandContacts, n: int, m: int, t: float, h: float, placed: bool
) -> float:  # fmt: skip
    """Set the penetration correction at the end of an interval h from instant t, as `contacts.JUMP`: 0 where it would
    lift a body through another, and in a second attempt without rotations where there are walls. Returns what may
    still be paid for it (`payment`). placed: whether the program has placed a body of the island."""
    ROWS, L, VN, JUMP, OUT = contacts.ROWS, contacts.L, contacts.VN, contacts.JUMP, contacts.OUT
    lost, before = OUT[0].restitution + OUT[0].friction, A.RESTING[root].lost
    budget, payable = payment(A, isle, ROWS, L, VN, n, m, lost, before, placed, False)
    problem, middle = Problem(ROWS, isle.IM, isle.II, isle.POSE, n, m), isle.POSE + 0.5 * h * isle.V
    left, last_pose = left_to_lift(A, t + h), middle + 0.5 * h * VN
    correct_penetration(problem, L, middle, VN, isle.ACC, h, isle.EXTENT, budget, left, JUMP)
    through = lifts_through(A, isle, last_pose, JUMP, n, t + h)
    if through and len(isle.WHO) > n:
        correct_penetration(without_turning(problem), L, middle, VN, isle.ACC, h, isle.EXTENT, budget, left, JUMP)
        through = lifts_through(A, isle, last_pose, JUMP, n, t + h)
    if through:
        JUMP[:] = 0.0
    return payable


@kernel
def take_interval(
    A: Scene, root: int, isle: Island, contacts: IslandContacts, MINE: IntArray, m: int, t: float, h: float,
    payable: float, with_supports: int,
) -> None:  # fmt: skip
    """Let the bodies MINE go along a solved interval h from instant t, with m contacts. payable: what may still be paid
    for its correction.  with_supports: see `bodies_with_supports`."""
    TOUCHED = np.zeros(len(isle.WHO), np.uint8)
    for z in range(m):
        TOUCHED[contacts.ROWS[z].a] = TOUCHED[contacts.ROWS[z].b] = 1
    lost, hits = A.RESTING[root].lost, A.MEMBER[root].hits
    set_lifts(A, MINE, contacts.JUMP)
    head = begin_paths(A, MINE, isle.V, contacts.VN, h, TOUCHED)
    if head >= 0:
        open_interval(A, head, isle, contacts, contacts.VN, m, t, h)
        A.MEMBER[head].hits, A.MEMBER[head].with_supports = hits, with_supports
        A.RESTING[head].payable, A.RESTING[head].lost = payable, lost
        if contacts.OUT[0].at_rest > 0:
            put_to_rest(A, head)


@kernel
def try_interval(A: Scene, root: int, t: float, longest: float, last: bool) -> tuple[int, float]:
    """One attempt of `begin_interval`, with an interval no longer than `longest`. Returns DONE, PUSHES_FULL, or, if the
    interval is too long, AGAIN and the length for the next attempt; no path is changed then. AGAIN is never the result
    of the `last` attempt."""
    COUNT, MINE, may_lose = A.COUNT, number_bodies(A, root), lossy(A, root)
    n = len(MINE)
    found = candidates.pairs_within(A, root, t, longest, may_lose, MINE)
    h = candidates.interval_within_way(A, found, longest) if A.COUNT.together == 0 else longest
    if h < longest:
        found = candidates.pairs_within(A, root, t, h, may_lose, MINE)
    p = len(found)
    h = min(h, candidates.interval_length(A, found, t))
    if lacks_rows(A, p):
        clear_places(A, MINE)
        return PUSHES_FULL, 0.0
    isle = local_island(A, MINE, found, t)
    clear_places(A, MINE)
    contacts, least_reach = make_contacts(p, len(isle.WHO)), 0.0
    VN, OUT = contacts.VN, contacts.OUT
    if COUNT.together > 0:
        for i in isle.WHO:
            least_reach = max(least_reach, candidates.travel_bound(A, i, h))
    sweeps = candidates.sweeps_of(n, t)
    m = 0
    with_supports = bodies_with_supports(A, isle, n)
    placed = was_placed(A, isle, n)
    rest_speed = 0.0 if placed else rest_threshold(A, root, MINE, with_supports, may_lose, t)
    payable = 0.0 if placed else math.inf
    owed = max(-A.RESTING[root].lost, 0.0)
    if p > 0 and h > 0.0:
        m = step_island(A, isle, contacts, n, h, sweeps, least_reach, owed, rest_speed)
        # Where slip turns round, intervals of elastic islands end; of lossy ones only a first of one contact.
        turns = COUNT.together == 0 and (not may_lose or (m == 1 and t == 0.0))
        sticks, stuck = not candidates.to_end_of_step(A), h
        if (turns or sticks) and OUT[0].at_rest == 0:
            stuck = candidates.slip_time(contacts.ROWS, contacts.L, isle.V + h * isle.ACC, VN, m, h, turns, sticks)
        if stuck < h:
            # The interval ends where slip ends, as the law of friction changes there.
            h = min(max(stuck, candidates.shortest_interval(A)), h)
            count_solve(A, n, p, m, OUT)
            m = step_island(A, isle, contacts, n, h, sweeps, least_reach, owed, 0.0)
        far = 0.0
        if not last and OUT[0].at_rest == 0:
            far = times_too_long(A, isle, contacts, m, h)
        if far > INTERVAL_RETRY:
            count_solve(A, n, p, m, OUT)
            return AGAIN, h / far
        if m > 0 and OUT[0].at_rest == 0:
            payable = correct_interval(A, root, isle, contacts, n, m, t, h, placed)
    note_solution(A, isle, OUT)
    count_solve(A, n, p, m, OUT)
    take_interval(A, root, isle, contacts, MINE, m, t, h, payable, with_supports)
    return DONE, 0.0


@nonallocating
def set_lifts(A: Scene, MINE: IntArray, JUMP: FloatArray) -> None:
    """Store the penetration corrections JUMP (k, 6) of the bodies MINE."""
    for q in range(len(MINE)):
        rest = A.RESTING[MINE[q]]
        rest.lift_x, rest.lift_y, rest.lift_angle = JUMP[q, 0], JUMP[q, 1], JUMP[q, 2]
        rest.lift_vx, rest.lift_vy, rest.lift_spin = JUMP[q, 3], JUMP[q, 4], JUMP[q, 5]
