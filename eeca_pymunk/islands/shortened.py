"""Intervals that are cut short give no energy.

Forces of an interval are right for the whole of it: a soft landing pushes before the shapes touch. Cut after s, an
impulse J with the mean relative velocity u has lost D = -J.u, and has given energy if that is negative. Then the island
is solved again, over the interval from its start to the cut, and gives none. Where that is no interval (bodies would
move too far, or too far from the paths on which impacts were predicted), all impulses of bodies that press on each
other are scaled by one q instead. With E = sum J.u > 0 and the energy C = sum m w^2 / 2 of the changes of velocity w
that they cause, scaled impulses give q (E - C) + q^2 C, which is 0 for q = 1 - E / C.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import inlined, kernel, nonallocating
from ..contacts.correction import connect
from ..contacts.counts import count_solve, note_solution
from ..contacts.interval import make_contacts, step_island
from ..geometry.flight import move_to, norm
from ..model.contacts import ENDED
from ..model.parameters.intervals import INTERVAL_DEPTH, INTERVAL_RETRY, REPAY_ROUND_OFF
from ..model.scene import Scene
from ..pairs.rules import mark_pair
from ..rows.energy import scale_to_lose
from .candidates import sweeps_of
from .depths import times_too_long
from .local import (
    clear_places,
    contact_range,
    give_places,
    local_island,
    number_bodies,
    take_places,
    write_contacts,
)


@inlined
def losses_up_to(A: Scene, c: int, t: float) -> tuple[float, float]:
    """Losses (energy) of contact c of an interval by normal impulse and by friction up to instant t. As velocities are
    linear, D_n = -f lam (u_n + f (u_n+ - u_n) / 2) with the part f of the interval that is over, and D_t likewise."""
    pushed = A.PUSHED[c]
    f = (t - pushed.start) / pushed.length
    normal = -f * pushed.normal * (pushed.un_before + 0.5 * f * (pushed.un_after - pushed.un_before))
    tangential = -f * pushed.tangential * (pushed.ut_before + 0.5 * f * (pushed.ut_after - pushed.ut_before))
    return normal, tangential


@nonallocating
def gave_energy(A: Scene, first: int, end: int, t: float) -> bool:
    """Whether contacts [first, end) of an island have given energy up to instant t."""
    lost, size = 0.0, 0.0
    for c in range(first, end):
        normal, tangential = losses_up_to(A, c, t)
        lost += normal + tangential
        size += abs(normal) + abs(tangential)
    return lost < -REPAY_ROUND_OFF * size


@kernel
def pairs_of(A: Scene, first: int, end: int) -> IntArray:
    """(p, 2) the pairs of shapes of contacts [first, end)."""
    found, p = np.empty((end - first, 2), np.int64), 0
    for c in range(first, end):
        one = A.PUSHED_BY[c]
        if p == 0 or one.a != found[p - 1, 0] or one.b != found[p - 1, 1]:
            found[p, 0], found[p, 1] = one.a, one.b
            p += 1
    return found[:p]


@nonallocating
def leave_paths(A: Scene, MINE: IntArray, VN: FloatArray, s: float) -> bool:
    """Whether velocities VN (k, 3) after a time s take one of the bodies MINE so far from its path that it may be in
    others: impacts were predicted on that path only."""
    for q in range(len(MINE)):
        body = A.BODY[MINE[q]]
        x, y = VN[q, 0] - body.vx - s * body.ax, VN[q, 1] - body.vy - s * body.ay
        turn = abs(VN[q, 2] - body.spin - s * body.angular) * body.extent
        if 0.5 * s * (norm(x, y) + turn) > INTERVAL_DEPTH * body.extent:
            return True
    return False


@kernel
def pressing_groups(A: Scene, MINE: IntArray, first: int, end: int) -> IntArray:
    """Of the bodies MINE, which have their places: the groups that forces of contacts [first, end) connect, as the
    least place of each."""
    GROUP = np.arange(len(MINE))
    for c in range(first, end):
        one, two = A.PLACE[A.LINK[A.PUSHED_BY[c].a].owner], A.PLACE[A.LINK[A.PUSHED_BY[c].b].owner]
        if one >= 0 and two >= 0 and A.PUSHED[c].normal > 0.0:
            connect(GROUP, one, two)
    return GROUP


@kernel
def scale_impulses(A: Scene, root: int, t: float) -> None:
    """Scale the impulses of an island, whose bodies are at the start of its interval, so that they give no energy up to
    instant t: q in the docstring of the module, or 0, for each group of bodies that press on each other. Bodies
    stood too high by the energy that was given, and sink by it; groups whose contacts have given none keep their
    impulses."""
    first, end = contact_range(A, root)
    start = A.PUSHED[first].start
    MINE = number_bodies(A, root)
    n = len(MINE)
    GROUP, LOST, SQUARE, Q = pressing_groups(A, MINE, first, end), np.zeros(n), np.zeros(n), np.ones(n)
    for c in range(first, end):
        normal, tangential = losses_up_to(A, c, t)
        LOST[group_of(A, GROUP, c)] += normal + tangential
    for q in range(n):
        body, pull = A.BODY[MINE[q]], A.PULL[MINE[q]]
        x, y, turn = body.ax - pull[0], body.ay - pull[1], body.angular - pull[2]
        SQUARE[GROUP[q]] += 0.5 * (x * x + y * y) * (t - start) ** 2 / body.inv_mass
        if body.inv_inertia > 0.0:
            SQUARE[GROUP[q]] += 0.5 * (turn * (t - start)) ** 2 / body.inv_inertia
    for g in range(n):
        if LOST[g] < 0.0:
            Q[g] = scale_to_lose(LOST[g] + SQUARE[g], SQUARE[g], 0.0, False)
    for q in range(n):
        body, pull, part = A.BODY[MINE[q]], A.PULL[MINE[q]], Q[GROUP[q]]
        if part != 1.0:
            body.ax = pull[0] + part * (body.ax - pull[0])
            body.ay = pull[1] + part * (body.ay - pull[1])
            body.angular = pull[2] + part * (body.angular - pull[2])
    for c in range(first, end):
        pushed, part = A.PUSHED[c], Q[group_of(A, GROUP, c)]
        if part != 1.0:
            pushed.normal, pushed.tangential = part * pushed.normal, part * pushed.tangential
            pushed.work, pushed.work_unaccelerated = part * pushed.work, part * pushed.work_unaccelerated
            pushed.change *= part
            # Their sum has no losses, by the choice of q; velocities 0 enter none for each.
            pushed.un_before, pushed.un_after, pushed.ut_before, pushed.ut_after = 0.0, 0.0, 0.0, 0.0
    clear_places(A, MINE)


@nonallocating
def group_of(A: Scene, GROUP: IntArray, c: int) -> int:
    """The group of contact c."""
    one, two = A.PLACE[A.LINK[A.PUSHED_BY[c].a].owner], A.PLACE[A.LINK[A.PUSHED_BY[c].b].owner]
    return int(GROUP[one] if one >= 0 else GROUP[two])


@kernel
def solve_again(A: Scene, root: int, t: float, first: int, end: int) -> None:
    """Solve contacts [first, end) of an island again, for the time up to instant t, or scale their impulses, see
    `repay`."""
    found = pairs_of(A, first, end)
    start, s = A.PUSHED[first].start, t - A.PUSHED[first].start
    MINE = number_bodies(A, root)
    n = len(MINE)
    for q in range(n):
        # Tests whether contacts persist may have moved the body along its path, to an instant within the interval.
        move_to(A.BODY, MINE[q], start)
    isle = local_island(A, MINE, found, start)
    clear_places(A, MINE)
    contacts = make_contacts(len(found), len(isle.WHO))
    VN, OUT, owed = contacts.VN, contacts.OUT, max(-A.RESTING[root].lost, 0.0)
    m = step_island(A, isle, contacts, n, s, sweeps_of(n, start), 0.0, owed, 0.0)
    count_solve(A, n, len(found), m, OUT)
    too_long = m < 0 or m > end - first or times_too_long(A, isle, contacts, m, s) > INTERVAL_RETRY
    if too_long or leave_paths(A, MINE, VN, s):
        scale_impulses(A, root, t)
        return
    note_solution(A, isle, OUT)
    for c in range(first, end):
        A.PUSHED_BY[c].root = ENDED
        mark_pair(A, A.PUSHED_BY[c].a, A.PUSHED_BY[c].b, 0)
    write_contacts(A, root, isle, contacts, VN, m, first, start, s)
    for q in range(n):
        body = A.BODY[MINE[q]]
        body.ax, body.ay, body.angular = (VN[q, 0] - body.vx) / s, (VN[q, 1] - body.vy) / s, (VN[q, 2] - body.spin) / s


@kernel
def repay(A: Scene, root: int, t: float) -> None:
    """Before the interval of an island ends at instant t: if its contacts have given energy up to t, solve them again
    for the time up to t; if they become more, or move too far for one interval, scale their impulses."""
    first, end = contact_range(A, root)
    if not gave_energy(A, first, end, t):
        return
    GATHERED = take_places(A)
    solve_again(A, root, t, first, end)
    give_places(A, GATHERED)
