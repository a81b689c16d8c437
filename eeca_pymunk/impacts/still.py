"""Islands that stand still: an unchanged solve goes on, step after step, and costs next to nothing.

An island stands still once, over a whole step that nobody disturbed, every body of it was slower than STANDS |a| dt at
both ends, so that its contacts bear its weight to that accuracy, and no contact slipped or was driven; and once it has
hardly moved for some steps and `..sustained.statics` finds the forces that hold it. Its bodies then stay where they
are, without velocity (what kinetic energy is left is booked as restitution), and its contacts keep their forces. It is
solved again from when a body of it is hit, edited, or pulled otherwise than before; when a body that carries it moves;
and always where collision handlers have a say.

MEMBER[STILL]: of its bodies 1; of the root CHANGED when it is to be solved again, LIKELY at the end of a step in which
it may come to a stand; of a kinematic body CHANGED while it moves.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from ..layout import ANGLE, AX, AY, DUE, EXTENT, II, IM, OWNER, SPIN, TWIST, VX, VY, X, Y
from ..pairs.lists import mark_pair
from ..sustained.memory import STAMP as OF_STEP
from ..sustained.memory import find
from ..sustained.statics import CALM, STANDS
from .layout import (
    AFTER_ME,
    BETA,
    BUSY,
    CALM_FOR,
    DT,
    HITS,
    ISLAND,
    JOINTED,
    KINKS,
    LAM,
    LASTED,
    LEDGER,
    LIFT,
    LOGGED,
    LOST,
    OPEN,
    PULLED,
    PUSH_A,
    PUSH_B,
    PUSH_CHANGE,
    PUSH_GAP,
    PUSH_NX,
    PUSH_NY,
    PUSH_X,
    PUSH_Y,
    PUSHES,
    RESTITUTION,
    ROOT,
    SPAN,
    SPAN_FROM,
    STAMP,
    STILL,
    STILL_DUE,
    TOGETHER,
    UN_AFTER,
    UN_BEFORE,
    UNTIL,
    UT_AFTER,
    UT_BEFORE,
    WORK_OF,
    Scene,
)  # fmt: skip
from .strike import note

CHANGED, LIKELY = 2, 3
_SURE = 2  # steps that an island hardly moves, before it is asked whether it stands
_AGAIN, _LATEST = 4, 32  # and until it is asked again, one more for every fourth body


@uncounted
def stays(A: Scene, i: int, last: float) -> bool:
    """Whether body i stands as it stood; it then has no path but that, and its forecast of `last` ago."""
    BODY = A.BODY
    same = A.MEMBER[i, BUSY] == 0
    same = same and BODY[i, AX] == A.PULL[i, 0] and BODY[i, AY] == A.PULL[i, 1] and BODY[i, TWIST] == A.PULL[i, 2]
    same = same and BODY[i, VX] == 0.0 and BODY[i, VY] == 0.0 and BODY[i, SPIN] == 0.0
    same = same and BODY[i, X] == A.BEGAN[i, 0] and BODY[i, Y] == A.BEGAN[i, 1] and BODY[i, ANGLE] == A.BEGAN[i, 2]
    if not same:
        A.MEMBER[A.STATE[i, ISLAND], STILL] = CHANGED
        return False
    BODY[i, AX], BODY[i, AY], BODY[i, TWIST] = 0.0, 0.0, 0.0
    BODY[i, DUE] = max(A.RESTING[i, STILL_DUE] - last, 0.0)
    return True


@uncounted
def watch(A: Scene, i: int) -> None:
    """Say of a body that impulses do not move whether it has moved since the last step, or will in this."""
    BODY = A.BODY
    moves = BODY[i, VX] != 0.0 or BODY[i, VY] != 0.0 or BODY[i, SPIN] != 0.0
    moves = moves or BODY[i, X] != A.BEGAN[i, 0] or BODY[i, Y] != A.BEGAN[i, 1] or BODY[i, ANGLE] != A.BEGAN[i, 2]
    A.MEMBER[i, STILL] = CHANGED if moves else 0


@uncounted
def touch(A: Scene, c: int, stamp: float) -> None:
    """Let the forces of contact number c be those of the step `stamp`."""
    a, b = A.PUSHED_BY[c, PUSH_A], A.PUSHED_BY[c, PUSH_B]
    key = (min(a, b) * A.SHAPE.shape[0] + max(a, b)) << 1
    for z in range(2):
        row = find(A.KEYS, key + z)
        if row >= 0 and A.FORCES[row, OF_STEP] >= stamp - 1.0:
            A.FORCES[row, OF_STEP] = stamp


@uncounted
def rouse(A: Scene) -> None:
    """At the start of a step: islands that something has changed are no longer still; the rows of the others stay, at
    the front, with the impulses of this step."""
    STATE, MEMBER, BODY = A.STATE, A.MEMBER, A.BODY
    ground = BODY.shape[0] - 1
    dt = A.PAR[DT]
    for c in range(A.COUNT[PUSHES]):
        root = A.PUSHED_BY[c, ROOT]
        if root < 0:
            continue
        for side in range(2):
            j = A.LINK[A.PUSHED_BY[c, PUSH_A + side], OWNER]
            if j != ground and BODY[j, IM] == 0.0 and MEMBER[j, STILL] == CHANGED:
                MEMBER[root, STILL] = CHANGED
        if A.RULE.shape[0] > 0:
            MEMBER[root, STILL] = CHANGED
    for c in range(A.COUNT[PUSHES]):
        root = A.PUSHED_BY[c, ROOT]
        if root >= 0 and MEMBER[root, STILL] == CHANGED:
            A.PUSHED_BY[c, ROOT] = LASTED
            mark_pair(A.LIST, A.POOL, A.FLAG, A.LIST.shape[0], A.PUSHED_BY[c, PUSH_A], A.PUSHED_BY[c, PUSH_B], 0)
        elif root >= 0:
            R = A.PUSHED[c]
            for column in (LAM, BETA, PUSH_CHANGE):
                R[column] *= dt / R[SPAN]
            R[SPAN] = dt
    calm = CALM * A.PAR[PULLED] * dt
    for i in range(ground):
        root = STATE[i, ISLAND]
        if root < 0 or MEMBER[root, STILL] == 1:
            continue
        A.RESTING[i, CALM_FOR] = A.RESTING[i, CALM_FOR] + 1.0 if speed(BODY, i, 0.0) <= calm else 0.0
        if MEMBER[i, STILL] > 0:
            BODY[i, AX], BODY[i, AY], BODY[i, TWIST] = A.PULL[i, 0], A.PULL[i, 1], A.PULL[i, 2]
            STATE[i, KINKS] += 1
        # Its forecast left out the pairs of its span.
        BODY[i, DUE] = min(BODY[i, DUE], 0.0)
    for i in range(ground):
        root = STATE[i, ISLAND]
        if root < 0:
            continue
        if MEMBER[root, STILL] != 1:
            STATE[i, ISLAND] = -1
            if i != root:
                MEMBER[i, STILL] = 0
        else:
            A.RESTING[i, LOST], MEMBER[i, HITS] = 0.0, 0
    for i in range(ground):
        if STATE[i, ISLAND] < 0 and BODY[i, IM] > 0.0:
            MEMBER[i, STILL] = 0


@uncounted
def disturb(A: Scene, root: int) -> None:
    """A still island is hit, or joined: its span of this step is an ordinary one."""
    for c in range(A.COUNT[PUSHES]):
        if A.PUSHED_BY[c, ROOT] == root:
            touch(A, c, A.PAR[STAMP])
    i = root
    while i >= 0:
        A.MEMBER[i, STILL] = 0
        i = A.MEMBER[i, AFTER_ME]


@uncounted
def speed(BODY: FloatArray, i: int, s: float) -> float:
    """A bound on the speed of the points of body i in s."""
    vx, vy = BODY[i, VX] + s * BODY[i, AX], BODY[i, VY] + s * BODY[i, AY]
    return abs(vx) + abs(vy) + BODY[i, EXTENT] * abs(BODY[i, SPIN] + s * BODY[i, TWIST])


@uncounted
def calm(A: Scene, root: int, MINE: IntArray, n: int, t: float) -> bool:
    """Whether the island of the n bodies MINE may come to a stand at instant t; if so, it is asked again much later."""
    if t > 0.0 or A.COUNT[TOGETHER] > 0 or A.RULE.shape[0] > 0 or A.MEMBER[root, HITS] > 0:
        return False
    for q in range(n):
        if A.RESTING[MINE[q], CALM_FOR] < _SURE or A.MEMBER[MINE[q], BUSY] > 0:
            return False
    for q in range(n):
        A.RESTING[MINE[q], CALM_FOR] = -min(_AGAIN + n // 4, _LATEST)
    return True


@uncounted
def slow(A: Scene, root: int) -> bool:
    """Whether all bodies of an island were as good as at rest at both ends of this step, undisturbed."""
    BODY, MEMBER = A.BODY, A.MEMBER
    dt = A.PAR[DT]
    if MEMBER[root, OPEN] == 0 or MEMBER[root, JOINTED] > 0 or MEMBER[root, HITS] > 0:
        return False
    if A.RESTING[root, UNTIL] < math.inf:
        return False
    limit = STANDS * A.PAR[PULLED] * dt
    i = root
    while i >= 0:
        if MEMBER[i, BUSY] > 0:
            return False
        if max(speed(BODY, i, 0.0), speed(BODY, i, dt)) > limit:
            return False
        for c in range(6):
            if A.RESTING[i, LIFT + c] != 0.0:
                return False
        i = MEMBER[i, AFTER_ME]
    return True


@uncounted
def find_still(A: Scene) -> None:
    """At the end of a step, before its contacts are booked: which islands come to a stand."""
    if A.PAR[PULLED] == 0.0 or A.COUNT[TOGETHER] > 0 or A.RULE.shape[0] > 0:
        return
    some = False
    for i in range(A.BODY.shape[0] - 1):
        if A.STATE[i, ISLAND] == i and A.MEMBER[i, STILL] == 0 and slow(A, i):
            A.MEMBER[i, STILL] = LIKELY
            some = True
    if not some:
        return
    limit = STANDS * A.PAR[PULLED] * A.PAR[DT]
    for c in range(A.COUNT[PUSHES]):
        root = A.PUSHED_BY[c, ROOT]
        if root < 0 or A.MEMBER[root, STILL] != LIKELY:
            continue
        R = A.PUSHED[c]
        slips = max(max(abs(R[UN_BEFORE]), abs(R[UN_AFTER])), max(abs(R[UT_BEFORE]), abs(R[UT_AFTER])))
        driven = abs(R[WORK_OF]) > limit * (abs(R[LAM]) + abs(R[BETA]))
        if R[SPAN_FROM] != 0.0 or slips > 4.0 * limit or driven:
            A.MEMBER[root, STILL] = 0


@uncounted
def keep(A: Scene, c: int, root: int) -> None:
    """Contact number c, just booked, goes on: its island comes to a stand."""
    R = A.PUSHED[c]
    A.PUSHED_BY[c, ROOT] = root
    mark_pair(A.LIST, A.POOL, A.FLAG, A.LIST.shape[0], A.PUSHED_BY[c, PUSH_A], A.PUSHED_BY[c, PUSH_B], 1)
    for column in (UN_BEFORE, UN_AFTER, UT_BEFORE, UT_AFTER, WORK_OF):
        R[column] = 0.0


@uncounted
def stand(A: Scene, c: int) -> None:
    """Contact number c, of an island that stands still: its impulse is noted, and goes on."""
    R = A.PUSHED[c]
    touch(A, c, A.PAR[STAMP])
    if A.COUNT[LOGGED] < A.LOG.shape[0] and (R[LAM] != 0.0 or R[BETA] != 0.0):
        note(
            A.LOG, A.COUNT[LOGGED], A.PUSHED_BY[c, PUSH_A], A.PUSHED_BY[c, PUSH_B], 0.5 * A.PAR[DT], R[LAM], R[BETA],
            R[PUSH_NX], R[PUSH_NY], R[PUSH_X], R[PUSH_Y], R[PUSH_CHANGE], R[PUSH_GAP],
        )  # fmt: skip
        A.COUNT[LOGGED] += 1


@uncounted
def halt(A: Scene, root: int) -> None:
    """At either end of a step, an island that comes to a stand: its bodies stop."""
    BODY, MEMBER = A.BODY, A.MEMBER
    i = root
    while i >= 0:
        vx, vy, spin = BODY[i, VX], BODY[i, VY], BODY[i, SPIN]
        left = 0.5 * (vx * vx + vy * vy) / BODY[i, IM]
        if BODY[i, II] > 0.0:
            left += 0.5 * spin * spin / BODY[i, II]
        A.PAR[LEDGER + RESTITUTION] += left
        BODY[i, VX], BODY[i, VY], BODY[i, SPIN] = 0.0, 0.0, 0.0
        BODY[i, AX], BODY[i, AY], BODY[i, TWIST] = 0.0, 0.0, 0.0
        MEMBER[i, STILL], BODY[i, DUE] = 1, 0.0
        A.STATE[i, KINKS] += 1
        i = MEMBER[i, AFTER_ME]


@uncounted
def leave(A: Scene) -> None:
    """What still bodies have to find again at the next step: where they are, and when they are due."""
    for i in range(A.BODY.shape[0] - 1):
        if A.MEMBER[i, STILL] == 1:
            A.RESTING[i, STILL_DUE] = A.BODY[i, DUE]
            for c in range(3):
                A.BEGAN[i, c] = A.BODY[i, X + c]
