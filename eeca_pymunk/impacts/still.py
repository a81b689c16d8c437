"""Islands that stand still: an unchanged solve goes on, step after step, and costs next to nothing.

`calm.py` says which come to a stand. Their bodies then stay where they are, without velocity (what kinetic energy is
left is booked as restitution; disks without friction go on spinning), and their contacts keep their forces. An island
is solved again from when a body of it is hit, edited, or pulled otherwise than before; when a body that carries it
moves; and always where collision handlers have a say.

MEMBER[STILL]: of its bodies 1; of the root CHANGED when it is to be solved again, LIKELY at the end of a step in which
it may come to a stand; of a kinematic body CHANGED while it moves.
"""

from __future__ import annotations

from ..compiled import uncounted
from ..layout import ANGLE, AX, AY, DUE, IM, OWNER, SPIN, TWIST, VX, VY, X, Y
from ..pairs.lists import mark_pair
from ..sustained.memory import STAMP as OF_STEP
from ..sustained.memory import find, key_of
from .calm import WOKEN, hardly, later, speed, whirls
from .layout import (
    AFTER_ME,
    AMONG,
    ANEW,
    BETA,
    BUSY,
    CALM_FOR,
    CARRIES,
    DT,
    HITS,
    ISLAND,
    KINKS,
    LAM,
    LASTED,
    LEDGER,
    LOGGED,
    LOST,
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
    STAMP,
    STILL,
    STILL_DUE,
    UN_AFTER,
    UN_BEFORE,
    UT_AFTER,
    UT_BEFORE,
    WORK_OF,
    Scene,
)  # fmt: skip
from .strike import kinetic, note

CHANGED = 2


@uncounted
def as_left(A: Scene, i: int) -> bool:
    """Whether body i has no velocity, or a spin alone that nobody feels, and is where it was left."""
    BODY, BEGAN = A.BODY, A.BEGAN
    same = BODY[i, X] == BEGAN[i, 0] and BODY[i, Y] == BEGAN[i, 1] and BODY[i, ANGLE] == BEGAN[i, 2]
    return bool(same and BODY[i, VX] == 0.0 and BODY[i, VY] == 0.0 and (BODY[i, SPIN] == 0.0 or whirls(A, i)))


@uncounted
def stays(A: Scene, i: int, last: float) -> bool:
    """Whether body i stands as it stood; it then has no path but that, and its forecast of `last` ago."""
    BODY = A.BODY
    pulled = BODY[i, AX] == A.PULL[i, 0] and BODY[i, AY] == A.PULL[i, 1] and BODY[i, TWIST] == A.PULL[i, 2]
    if A.MEMBER[i, BUSY] > 0 or not pulled or not as_left(A, i):
        A.MEMBER[A.STATE[i, ISLAND], STILL] = CHANGED
        return False
    BODY[i, AX], BODY[i, AY], BODY[i, TWIST] = 0.0, 0.0, 0.0
    # What does not stand for long is not asked again for long.
    A.RESTING[i, CALM_FOR] = min(A.RESTING[i, CALM_FOR] + 1.0, WOKEN)
    BODY[i, DUE] = max(A.RESTING[i, STILL_DUE] - last, 0.0)
    return True


@uncounted
def watch(A: Scene, i: int) -> None:
    """Say of a body that impulses do not move whether it has moved since the last step, or will in this."""
    A.MEMBER[i, STILL] = 0 if as_left(A, i) else CHANGED


@uncounted
def touch(A: Scene, c: int, stamp: float) -> None:
    """Let the forces of contact number c be those of the step `stamp`."""
    a, b = A.PUSHED_BY[c, PUSH_A], A.PUSHED_BY[c, PUSH_B]
    key = key_of(A.SHAPE.shape[0], a, b)
    for z in range(2):
        row = find(A.KEYS, key + z)
        if row >= 0 and A.FORCES[row, OF_STEP] >= stamp - 1.0:
            A.FORCES[row, OF_STEP] = stamp


@uncounted
def spread_change(A: Scene) -> None:
    """What rests on bodies of an island that is CHANGED is so too, and so on."""
    MEMBER, more = A.MEMBER, A.COUNT[CARRIES] > 0
    while more:
        more = False
        for c in range(A.COUNT[PUSHES]):
            root = A.PUSHED_BY[c, ROOT]
            if root < 0 or MEMBER[root, STILL] == CHANGED:
                continue
            for side in range(2):
                j = A.LINK[A.PUSHED_BY[c, PUSH_A + side], OWNER]
                other = A.STATE[j, ISLAND]
                if A.BODY[j, IM] > 0.0 and other >= 0 and MEMBER[other, STILL] == CHANGED:
                    MEMBER[root, STILL], more = CHANGED, True


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
    spread_change(A)
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
    most = A.PAR[PULLED] * dt
    for i in range(ground):
        root = STATE[i, ISLAND]
        if root < 0 or MEMBER[root, STILL] == 1:
            continue
        slow = speed(A, i, 0.0) <= hardly(MEMBER[root, AMONG]) * most
        A.RESTING[i, CALM_FOR] = A.RESTING[i, CALM_FOR] + 1.0 if slow else 0.0
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
def stop(A: Scene, i: int) -> None:
    """Body i has no velocity any more, but for a spin that nobody feels; its energy is lost to restitution."""
    BODY = A.BODY
    A.PAR[LEDGER + RESTITUTION] += kinetic(BODY, i)
    BODY[i, VX], BODY[i, VY] = 0.0, 0.0
    if whirls(A, i):
        A.PAR[LEDGER + RESTITUTION] -= kinetic(BODY, i)
    else:
        BODY[i, SPIN] = 0.0
    A.STATE[i, KINKS] += 1


@uncounted
def halt(A: Scene, root: int) -> None:
    """At either end of a step, an island that comes to a stand: its bodies stop, but for spins that nobody feels. Once
    something wakes it, it is soon asked whether it stands again."""
    BODY, MEMBER = A.BODY, A.MEMBER
    MEMBER[root, ANEW] = 1
    i = root
    while i >= 0:
        stop(A, i)
        BODY[i, AX], BODY[i, AY], BODY[i, TWIST] = 0.0, 0.0, 0.0
        MEMBER[i, STILL], BODY[i, DUE], A.RESTING[i, CALM_FOR] = 1, 0.0, later(MEMBER[root, AMONG])
        i = MEMBER[i, AFTER_ME]


@uncounted
def leave(A: Scene) -> None:
    """What still bodies have to find again at the next step: where they are, and when they are due."""
    for i in range(A.BODY.shape[0] - 1):
        if A.MEMBER[i, STILL] == 1:
            A.RESTING[i, STILL_DUE] = A.BODY[i, DUE]
            for c in range(3):
                A.BEGAN[i, c] = A.BODY[i, X + c]
