"""An impact on islands with joints, at its instant (`..jointed.meet`): its impulses act through the joints."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows, zeros
from ..contacts.counts import spend
from ..contacts.works import external_work, gained_energy, kinetic_energy
from ..geometry.sides import pair_of
from ..islands.local import clear_places
from ..islands.membership import jointed, members, persists_from
from ..jointed.columns import count_operations, fill_unjointed, make_columns, set_effective_masses
from ..jointed.ends import under_way
from ..jointed.groups import Groups, find_groups
from ..jointed.ledger import work_left
from ..jointed.meet import end_by, locate_impact
from ..joints.start import release_limits
from ..joints.workspace import workspace
from ..model.contacts import SOLVED, JointedProblem, Row, Solved
from ..model.joints import Joints
from ..model.parameters.events import EVENT_LOOKS
from ..model.parameters.joints import CLOSES, COLUMN_CONTACTS, IMPACT_ENERGY, IMPACT_LIMITS
from ..model.scene import Scene
from ..rows.blocks import TRUNCATED, close_block, solve_block, solve_frictionless
from ..rows.bounded import room_for_rows
from ..rows.build import aim, conserves, normal_rate
from ..rows.energy import offset_gain, scale_to_lose
from ..rows.gentle import excessive, sweep_gently
from ..rows.inplace import copy
from ..rows.sweeps import velocities
from .joint_answers import activate_limits, add_joint_impulses, answer_impact
from .resolution import finish_block, lacks_room, list_ended, unite_block
from .simultaneous import Block, gather_block, make_block, take_owed_energy


@nonallocating
def closes(ROWS: Rows[Row], BEFORE: FloatArray, V: FloatArray, rows: int) -> bool:
    """Whether a contact closes by more than round-off at the velocities V after an impact, BEFORE being those before
    it: then the velocities did not satisfy the joints, and the same impact would repeat at the same instant."""
    fastest, least = 0.0, 0.0
    for i in range(rows):
        fastest = max(fastest, abs(normal_rate(ROWS[i], BEFORE)))
        least = min(least, normal_rate(ROWS[i], V))
    return bool(least < -CLOSES * fastest)


@nonallocating
def list_apart(A: Scene, i: int, j: int) -> int:
    """Write bodies i and j, which have not met yet, to A.BLOCK, each with its island if that has joints, whose interval
    has ended; how many they are."""
    n = 0
    for body in (i, j):
        root = A.STATE[body].island
        if A.BODY[body].inv_mass == 0.0:
            continue
        if not jointed(A, body):
            A.BLOCK[n] = body
            n += 1
        elif body == i or root != A.STATE[i].island:
            n += int(members(A, root, A.BLOCK[n:]))
    return n


@kernel
def account_impact(
    A: Scene, block: Block, n: int, L: FloatArray, BEFORE: FloatArray, FREE: FloatArray, driven: bool, owed: float,
    exact: bool, OUT: Rows[Solved],
) -> None:  # fmt: skip
    """Enter the change of energy from velocities BEFORE to those of the block after its impulses L: FREE are those
    without impulses, BEFORE or its part that joints allow; the other part is lost.

    Where nothing moves but by impulses, all that walls have not done is lost, whatever the error of the response of
    the joints, and impulses are scaled until that is `owed` at least (if `exact`, just that). Where a component is
    `driven` by partners, what contacts and projections have not done is work of these.
    """
    ROWS, V, IM, II, rows = block.ROWS, block.V, block.IM, block.II, len(block.ROWS)
    outside = external_work(ROWS, L, V, V, IM, II, rows)
    gained, square = gained_energy(V, FREE, IM, II, n), kinetic_energy(V - FREE, IM, II, n)
    if driven:
        OUT[0].restitution += kinetic_energy(BEFORE - FREE, IM, II, n)
        A.PAR.external += gained_energy(V, BEFORE, IM, II, n) + OUT[0].restitution + OUT[0].friction - outside
        return
    s = scale_to_lose(outside - gained + square, square, owed, exact)
    if abs(outside - gained - owed) <= IMPACT_ENERGY * kinetic_energy(FREE, IM, II, n):
        s = 1.0  # a small impact on what moves fast would be scaled by round-off
    for z in range(rows):
        L[z, 0], L[z, 1] = s * L[z, 0], s * L[z, 1]
    for q in range(n):
        for c in range(3):
            V[q, c] = FREE[q, c] + s * (V[q, c] - FREE[q, c])
    OUT[0].lock *= s
    lost = s * (outside - gained + square) - s * s * square
    OUT[0].restitution, OUT[0].friction = offset_gain(lost - s * OUT[0].friction, s * OUT[0].friction)
    OUT[0].restitution += gained_energy(BEFORE, FREE, IM, II, n)


@kernel
def gather_ended(A: Scene, J: Joints, a: int, b: int, t: float) -> tuple[int, int, IntArray]:
    """`gather_block`, with the intervals of all its islands with joints ended at instant t. Their bodies then are
    elsewhere than on the paths by which the block was gathered, so that it is gathered again."""
    n, m, PAIRS = gather_block(A, a, b, t)
    ended = True
    while ended:
        ended = False
        for q in range(n):
            root = A.STATE[A.BLOCK[q]].island
            if under_way(A, root):
                end_by(A, J, root, t)
                ended = True
        if ended:
            clear_places(A, A.BLOCK[:n])
            n, m, PAIRS = gather_block(A, a, b, t)
    return n, m, PAIRS


@kernel
def solve_with_limits(
    A: Scene, J: Joints, problem: JointedProblem, block: Block, groups: Groups, n: int, t: float, owed: float,
    L: FloatArray, OUT: Rows[Solved],
) -> tuple[int, bool, FloatArray]:  # fmt: skip
    """Compute the impulses L (c, 2) of the contacts of a block, and the limits that take part: each solution may move
    into others, IMPACT_LIMITS times at most. Gentle impulses take the place of excessive ones. Returns the status,
    whether partners drive a component, and FITTED: the velocities without impulses, as far as joints allow them."""
    ROWS, V, C, rows = block.ROWS, block.V, problem.C, problem.m
    many, BEFORE = rows > COLUMN_CONTACTS, V.copy()
    status, driven, FITTED = TRUNCATED, False, BEFORE
    for s in groups.JOINTED:
        release_limits(workspace(J, s))  # no limit takes part yet, and no joint of bounded force
    for solution in range(IMPACT_LIMITS):
        driven = answer_impact(A, J, block, groups, C, n, t)
        FITTED = V.copy()
        set_effective_masses(groups, C, ROWS, rows)
        status = solve_block(problem, L, V, owed, many, OUT)
        if solution + 1 == IMPACT_LIMITS or not activate_limits(A, J, block, groups, t):
            break
        copy(V, BEFORE)
        L[:] = 0.0
    status = solve_frictionless(problem, L, V, FITTED, owed, status, many, OUT)
    fastest = aim(ROWS, rows)
    for q in range(n):
        fastest = max(fastest, math.hypot(FITTED[q, 0], FITTED[q, 1]))
    if excessive(L, rows, block.IM, n, fastest):
        L[:] = 0.0
        velocities(problem, L, FITTED, V)
        OUT[0].residual = sweep_gently(problem, L, V)
        close_block(problem, L, V, FITTED, owed, conserves(ROWS, rows), OUT)
        status = TRUNCATED
    return status, driven, FITTED


@kernel
def act_through_joints(
    A: Scene, J: Joints, block: Block, n: int, t: float, owed: float, L: FloatArray, OUT: Rows[Solved]
) -> int:
    """The impulses L (c, 2) of a block of n bodies at instant t, the velocities after them, and the impulses of joints;
    returns the status of `solve_block`."""
    ROWS, V, rows = block.ROWS, block.V, len(block.ROWS)
    WHO = np.full(len(block.IM), -1, np.int64)
    for q in range(n):
        WHO[q] = A.BLOCK[q]
    groups = find_groups(WHO, block.IM, J, True)
    C = make_columns(groups, ROWS, rows)
    fill_unjointed(groups, C, ROWS, block.IM, block.II, rows)
    BEFORE = V.copy()
    problem = JointedProblem(ROWS, C, room_for_rows(0, 0), rows)
    status, driven, FITTED = solve_with_limits(A, J, problem, block, groups, n, t, owed, L, OUT)
    # `fits`: whether the velocities satisfy the joints afterwards. If all contacts are elastic and without friction,
    # the part that joints do not allow is kept, unless a contact closes by it.
    exact = conserves(ROWS, rows)
    fits = not exact
    if not fits:
        velocities(problem, L, BEFORE, V)
        fits = closes(ROWS, BEFORE, V, rows)
    if fits:
        velocities(problem, L, FITTED, V)
    account_impact(A, block, n, L, BEFORE, FITTED if fits else BEFORE, driven, owed, exact, OUT)
    add_joint_impulses(A, J, block, groups, L, BEFORE if fits else np.zeros_like(BEFORE), t)
    count_operations(J, C)
    return status


@kernel
def collide(A: Scene, J: Joints, a: int, b: int, t: float) -> int:
    """The impact of shapes a and b, predicted for instant t, with the components of their bodies; results as
    `resolution.strike`, at PAR.now, the instant at which they meet on their paths with joints."""
    t, apart = locate_impact(A, J, a, b, t)
    A.PAR.now = t
    if apart:
        A.COUNT.work += EVENT_LOOKS
        return list_ended(A, list_apart(A, A.LINK[a].owner, A.LINK[b].owner))
    n, m, PAIRS = gather_ended(A, J, a, b, t)
    if lacks_room(A, n, m):
        return list_ended(A, n)
    lasts = persists_from(A, a, b, t)
    owed, _ = take_owed_energy(A, n)
    block = make_block(A, n, m, PAIRS, pair_of(A, a, b), lasts, t)
    L, OUT = np.zeros((len(block.ROWS), 2)), zeros(1, SOLVED)
    status = act_through_joints(A, J, block, n, t, owed, L, OUT)
    lost = finish_block(A, block, n, m, L, OUT, status, t) - owed
    spend(A, n, m, 0.0)  # besides the operations of its solutions
    n = unite_block(A, a, b, t, n, lasts, lost, 1.0 - work_left(A, J) / J.PROGRESS.budget)
    return list_ended(A, n)
