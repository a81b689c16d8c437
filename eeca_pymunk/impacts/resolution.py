"""The simultaneous impact of a block of bodies: impulses, and the islands afterwards. Islands with bodies in the block
unite, and begin a new interval."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows, zeros
from ..contacts.counts import looks_of, note_lock, note_unmet, spend
from ..contacts.forces import shapes_of
from ..contacts.single import log_impulse
from ..contacts.works import external_work
from ..geometry.sides import pair_of
from ..islands.building import join_reachable
from ..islands.hits import make_busy, most_hits
from ..islands.local import clear_places, set_places
from ..islands.membership import jointed, members, unite
from ..model.bodies import AT_REST
from ..model.contacts import SOLVED, Problem, Solved
from ..model.parameters.events import BUSY_WORK
from ..model.scene import Scene
from ..model.step import IMPACT
from ..pairs.rules import law
from ..prediction.work import most_work
from ..rows.blocks import CONVERGED, solve_block, solve_frictionless
from ..rows.laws import solved_exactly
from .simultaneous import Block, gather_block, make_block, take_owed_energy


@nonallocating
def finish_block(
    A: Scene, block: Block, n: int, m: int, L: FloatArray, OUT: Rows[Solved], status: int, t: float
) -> float:
    """Write the velocities of a block of n bodies and m pairs after the impulses L (c, 2) of its c contacts to BODY,
    and enter losses and impulses in ledger and log. status, OUT: result and report of `..rows.blocks.solve_block`.
    Returns the energy lost."""
    BODY, COUNT = A.BODY, A.COUNT
    V, ROWS = block.V, block.ROWS
    if status != CONVERGED:
        a, b = shapes_of(A, ROWS[0])
        note_unmet(A, IMPACT, a, b, OUT[0].residual, OUT[0].tolerance)
    note_lock(A, OUT)
    A.PAR.restitution += OUT[0].restitution
    A.PAR.frictional += OUT[0].friction
    A.PAR.external += external_work(ROWS, L, V, V, block.IM, block.II, len(ROWS))
    for q in range(n):
        i = A.BLOCK[q]
        BODY[i].vx, BODY[i].vy, BODY[i].spin = V[q, 0], V[q, 1], V[q, 2]
        A.STATE[i].version += 1
        A.STATE[i].impacts += 1
    clear_places(A, A.BLOCK[:n])
    for z in range(len(ROWS)):
        if L[z, 0] > 0.0:
            a, b = shapes_of(A, ROWS[z])
            log_impulse(
                A.LOG[COUNT.logged], a, b, t, L[z, 0], L[z, 1], ROWS[z].nx, ROWS[z].ny,
                block.POINTS[z, 0], block.POINTS[z, 1], L[z, 0] / ROWS[z].k_n, math.nan,
            )  # fmt: skip
            COUNT.logged += 1
    COUNT.blocks += 1 if m > 1 else 0
    return float(OUT[0].restitution + OUT[0].friction)


@nonallocating
def lacks_room(A: Scene, n: int, m: int) -> bool:
    """Whether LOG is too short for the impulses of a block of n bodies and m pairs, two for each pair. If so, the block
    is dissolved, and its impact has to be repeated with more memory (COUNT.room)."""
    COUNT = A.COUNT
    if COUNT.logged + COUNT.pushes + 2 * m <= A.LOG.shape[0]:
        return False
    COUNT.room = 2 * m
    clear_places(A, A.BLOCK[:n])
    return True


@nonallocating
def list_ended(A: Scene, n: int) -> int:
    """Add to the n bodies in A.BLOCK those of all other islands whose intervals have ended, as these were brought to
    the instant of an impact: they begin new ones, though they may not touch. How many bodies there are then."""
    set_places(A, A.BLOCK[:n])
    for root in range(A.BODY.shape[0] - 1):
        if A.STATE[root].island != root or A.MEMBER[root].open > 0 or A.MEMBER[root].rest == AT_REST:
            continue
        i = root
        while i >= 0:
            if A.PLACE[i] < 0:
                A.BLOCK[n], A.PLACE[i] = i, n
                n += 1
            i = A.MEMBER[i].following
    clear_places(A, A.BLOCK[:n])
    return n


@kernel
def strike(A: Scene, a: int, b: int, t: float, lasts: bool) -> int:
    """The simultaneous impact of shapes a and b at instant t. Writes the bodies to predict to A.BLOCK, after their
    islands have begun new intervals; returns their number, or -1 if joints take part: then no impulse has acted, but
    intervals of the block have ended at t.

    Args:
        lasts: whether the contact of a and b persists from now on.
    """
    n, m, PAIRS = gather_block(A, a, b, t)
    for q in range(n):
        if A.MEMBER[A.BLOCK[q]].tied >= 0 or jointed(A, A.BLOCK[q]):
            clear_places(A, A.BLOCK[:n])
            return -1
    if lacks_room(A, n, m):
        return list_ended(A, n)
    owed, in_islands = take_owed_energy(A, n)
    block = make_block(A, n, m, PAIRS, pair_of(A, a, b), lasts, t)
    rows = len(block.ROWS)
    L, OUT = np.zeros((rows, 2)), zeros(1, SOLVED)
    problem = Problem(block.ROWS, block.IM, block.II, block.POSE, n, rows)
    FREE = block.V.copy()
    status = solve_block(problem, L, block.V, owed, in_islands, OUT)
    if solved_exactly(n, rows):
        status = solve_frictionless(problem, L, block.V, FREE, owed, status, False, OUT)
    lost = finish_block(A, block, n, m, L, OUT, status, t) - owed
    spend(A, n, m, looks_of(rows, OUT))
    return unite_block(A, a, b, t, n, lasts, lost, A.COUNT.work / most_work(A))


@kernel
def unite_block(A: Scene, a: int, b: int, t: float, n: int, lasts: bool, lost: float, spent: float) -> int:
    """After the impact of the n bodies in A.BLOCK: unite their islands, and with them the bodies of shapes a and b if
    their contact persists (`lasts`). Returns the number of bodies in A.BLOCK: those of the block and of that island.

    An island that has been hit as often as a step allows becomes `busy`: further shapes are contacts of the interval
    that now begins. With joints if nothing bounces, as this is the same law; others, and those that bounce, once
    BUSY_WORK of the step is spent: each hit on a crowd of thin shapes costs a solve of all, and steps end early.

    Args:
        lost: energy lost in the impact.  spent: part of the work of the step that is spent.
    """
    STATE, BODIES = A.STATE, A.BLOCK
    root = -1
    for q in range(n):
        if STATE[BODIES[q]].island >= 0:
            root = unite(A, BODIES[q], BODIES[q] if root < 0 else root)
    if root < 0 and not lasts:
        return n
    QUEUE = np.empty(A.BODY.shape[0], np.int64)
    queued = 0
    for s in (a, b):
        i = A.LINK[s].owner
        if A.BODY[i].inv_mass > 0.0:
            if STATE[i].island < 0:
                QUEUE[queued] = i
                queued += 1
            root = unite(A, i, i if root < 0 else root)
    join_reachable(A, QUEUE, queued, t)
    root = STATE[root].island
    A.RESTING[root].lost += lost
    A.MEMBER[root].hits += 1
    e = law(A, a, b)[0]
    if (jointed(A, root) and e == 0.0) or (e < 1.0 and spent > BUSY_WORK):
        if A.MEMBER[root].hits >= most_hits(A, a, b):
            make_busy(A, root)
    # Bodies of the block that are in no island are predicted too.
    free = 0
    for q in range(n):
        if STATE[BODIES[q]].island != root:
            BODIES[free] = BODIES[q]
            free += 1
    return free + members(A, root, BODIES[free:])
