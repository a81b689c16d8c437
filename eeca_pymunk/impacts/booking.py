"""The end of an island's span: its works up to there are booked, exactly, as forces are constant and velocities linear.

Forces of a span that was cut may have given energy (a soft landing pushes before it touches): that is owed, and taken
out by what follows. So may they have turned the island, as their arms are about the middle of the whole span.
"""

from __future__ import annotations

from ..compiled import Table, uncounted
from ..layout import (
    AX,
    AY,
    II,
    IM,
    OWNER,
    SINCE,
    SPIN,
    VX,
    VY,
    X,
    Y,
)  # fmt: skip
from ..pairs.lists import mark_pair
from .calm import whirls
from .islands import unite
from .layout import (
    AFTER_ME,
    BETA,
    DT,
    ENDED,
    EXTERNAL,
    FRICTIONAL,
    ISLAND,
    JOINTED,
    LAM,
    LASTED,
    LEDGER,
    LIFT,
    LOGGED,
    LOST,
    OPEN,
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
    STILL,
    UN_AFTER,
    UN_BEFORE,
    UT_AFTER,
    UT_BEFORE,
    WORK_OF,
    Scene,
    scene_of,
)  # fmt: skip
from .still import CHANGED, disturb, spread_change
from .strike import move_to, note


@uncounted
def flag_again(TABLE: Table) -> None:
    """Flag the pairs of all spans, in lists that were made anew. TABLE: `table_of` a Scene."""
    flag_spans(scene_of(TABLE))


@uncounted
def flag_spans(A: Scene) -> None:
    """Flag the pairs of all spans, whose flags are not set."""
    for c in range(A.COUNT[PUSHES]):
        if A.PUSHED_BY[c, ROOT] >= 0:
            a, b = A.PUSHED_BY[c, PUSH_A], A.PUSHED_BY[c, PUSH_B]
            mark_pair(A.LIST, A.POOL, A.FLAG, A.LIST.shape[0], a, b, 1)


@uncounted
def book(A: Scene, c: int, t: float) -> None:
    """Book what contact number c has done in its span until instant t, note its impulse, and end it.

    Velocities go linearly through a span, so that after the part f of it D_n = -f lam (u_n + f (u_n+ - u_n) / 2). What
    a contact's friction gives back counts against its restitution, and the other way round.
    """
    PAR, COUNT, R = A.PAR, A.COUNT, A.PUSHED[c]
    root, a, b = A.PUSHED_BY[c, ROOT], A.PUSHED_BY[c, PUSH_A], A.PUSHED_BY[c, PUSH_B]
    A.PUSHED_BY[c, ROOT] = LASTED if t == PAR[DT] else ENDED
    mark_pair(A.LIST, A.POOL, A.FLAG, A.LIST.shape[0], a, b, 0)
    f = (t - R[SPAN_FROM]) / R[SPAN]
    if f == 0.0 or (R[LAM] == 0.0 and R[BETA] == 0.0):
        return
    normal = -f * R[LAM] * (R[UN_BEFORE] + 0.5 * f * (R[UN_AFTER] - R[UN_BEFORE]))
    tangential = -f * R[BETA] * (R[UT_BEFORE] + 0.5 * f * (R[UT_AFTER] - R[UT_BEFORE]))
    both = normal + tangential
    if normal < 0.0:
        normal, tangential = min(both, 0.0), max(both, 0.0)
    elif tangential < 0.0:
        normal, tangential = both, 0.0
    PAR[LEDGER + RESTITUTION] += normal
    PAR[LEDGER + FRICTIONAL] += tangential
    PAR[LEDGER + EXTERNAL] += f * R[WORK_OF]
    A.RESTING[root, LOST] += both
    if f > 0.0 and COUNT[LOGGED] < A.LOG.shape[0]:
        note(
            A.LOG, COUNT[LOGGED], a, b, R[SPAN_FROM] + 0.5 * f * R[SPAN], f * R[LAM], f * R[BETA], R[PUSH_NX],
            R[PUSH_NY], R[PUSH_X], R[PUSH_Y], f * R[PUSH_CHANGE], R[PUSH_GAP],
        )  # fmt: skip
        COUNT[LOGGED] += 1


@uncounted
def gained(A: Scene, c: int, t: float) -> float:
    """Angular momentum that contact number c makes if its span h is cut after s: its arms are about the middle of the
    whole, so that bodies without mobility aside it is -(1/2) s (h - s) (v_b - v_a) x f, v at the start of the span."""
    R, BODY = A.PUSHED[c], A.BODY
    i, j = A.LINK[A.PUSHED_BY[c, PUSH_A], OWNER], A.LINK[A.PUSHED_BY[c, PUSH_B], OWNER]
    s, h = t - R[SPAN_FROM], R[SPAN]
    fx = (R[LAM] * R[PUSH_NX] - R[BETA] * R[PUSH_NY]) / h
    fy = (R[LAM] * R[PUSH_NY] + R[BETA] * R[PUSH_NX]) / h
    back_i, back_j = BODY[i, SINCE] - R[SPAN_FROM], BODY[j, SINCE] - R[SPAN_FROM]
    vx = BODY[j, VX] - back_j * BODY[j, AX] - BODY[i, VX] + back_i * BODY[i, AX]
    vy = BODY[j, VY] - back_j * BODY[j, AY] - BODY[i, VY] + back_i * BODY[i, AY]
    return -0.5 * s * max(h - s, 0.0) * (vx * fy - vy * fx)


@uncounted
def turn_back(A: Scene, root: int, excess: float) -> None:
    """Take an angular momentum out of a free island, whose bodies are at one instant, by a common turn of all of it,
    which changes no contact's velocity; spins that nobody feels stay. Its energy is lost, or owed."""
    BODY = A.BODY
    mass, x, y, vx, vy = 0.0, 0.0, 0.0, 0.0, 0.0
    i = root
    while i >= 0:
        if BODY[i, II] == 0.0:
            return
        m = 1.0 / BODY[i, IM]
        mass, x, y = mass + m, x + m * BODY[i, X], y + m * BODY[i, Y]
        vx, vy = vx + m * BODY[i, VX], vy + m * BODY[i, VY]
        i = A.MEMBER[i, AFTER_ME]
    x, y, vx, vy = x / mass, y / mass, vx / mass, vy / mass
    whirl, inertia = 0.0, 0.0
    i = root
    while i >= 0:
        rx, ry = BODY[i, X] - x, BODY[i, Y] - y
        whirl += (rx * (BODY[i, VY] - vy) - ry * (BODY[i, VX] - vx)) / BODY[i, IM]
        inertia += (rx * rx + ry * ry) / BODY[i, IM]
        if not whirls(A, i):
            whirl += BODY[i, SPIN] / BODY[i, II]
            inertia += 1.0 / BODY[i, II]
        i = A.MEMBER[i, AFTER_ME]
    turn = -excess / inertia
    i = root
    while i >= 0:
        BODY[i, VX] -= turn * (BODY[i, Y] - y)
        BODY[i, VY] += turn * (BODY[i, X] - x)
        if not whirls(A, i):
            BODY[i, SPIN] += turn
        i = A.MEMBER[i, AFTER_ME]
    lost = -turn * (whirl + 0.5 * inertia * turn)
    A.PAR[LEDGER + RESTITUTION] += lost
    A.RESTING[root, LOST] += lost


@uncounted
def wake(A: Scene, root: int, t: float) -> int:
    """An island that stands does so no longer from instant t on: it and all that rests on it become one, whose root is
    returned, and end their spans."""
    MEMBER, one = A.MEMBER, root
    MEMBER[root, STILL] = CHANGED
    spread_change(A)
    for i in range(A.BODY.shape[0] - 1):
        if A.STATE[i, ISLAND] == i and A.BODY[i, IM] > 0.0 and MEMBER[i, STILL] == CHANGED:
            disturb(A, i)
            close_span(A, i, t)
            one = unite(A, one, i)
    return one


@uncounted
def end_span(A: Scene, root: int, t: float) -> None:
    """End the span of an island at instant t, and of what rests on it."""
    if A.MEMBER[root, STILL] == 1:
        wake(A, root, t)
    else:
        close_span(A, root, t)


@uncounted
def close_span(A: Scene, root: int, t: float) -> None:
    """End the span of one island at instant t: book its contacts, and bring its bodies there."""
    free, excess = A.MEMBER[root, JOINTED] == 0, 0.0
    for c in range(A.COUNT[PUSHES]):
        if A.PUSHED_BY[c, ROOT] == root:
            for side in range(2):
                j = A.LINK[A.PUSHED_BY[c, PUSH_A + side], OWNER]
                free = free and A.BODY[j, IM] > 0.0 and A.STATE[j, ISLAND] == root
            if free:
                excess += gained(A, c, t)
            book(A, c, t)
    A.MEMBER[root, OPEN] = 0
    i = root
    while i >= 0:
        move_to(A.BODY, i, t)
        i = A.MEMBER[i, AFTER_ME]
    if free and excess != 0.0:
        turn_back(A, root, excess)


@uncounted
def alight(A: Scene, i: int, end: float) -> None:
    """Bring body i of an island with joints to the end of its span: what happens there is in the books of joints."""
    move_to(A.BODY, i, end)
    for c in range(3):
        A.BODY[i, X + c] += A.RESTING[i, LIFT + c]
        A.BODY[i, VX + c] = A.RESTING[i, LIFT + 3 + c]
        A.RESTING[i, LIFT + c] = 0.0


@uncounted
def lift_out(A: Scene, root: int, end: float) -> None:
    """Lift the bodies of an island, at the end of its span, out of each other; the losses pay what that costs beyond
    the work of forces: the change of kinetic energy, less m a.D + I alpha dtheta for displacements D."""
    PAR, BODY, PULL, JUMP = A.PAR, A.BODY, A.PULL, A.RESTING
    spent = 0.0
    i = root
    if A.MEMBER[root, JOINTED] > 0:
        while i >= 0:
            if A.MEMBER[root, OPEN] > 0:
                alight(A, i, end)
            i = A.MEMBER[i, AFTER_ME]
        return
    while i >= 0:
        move_to(BODY, i, end)
        linear = PULL[i, 0] * JUMP[i, LIFT] + PULL[i, 1] * JUMP[i, LIFT + 1]
        for c in range(2):
            linear -= JUMP[i, LIFT + 3 + c] * (BODY[i, VX + c] + 0.5 * JUMP[i, LIFT + 3 + c])
        spent -= linear / BODY[i, IM]
        if BODY[i, II] > 0.0:
            turning = JUMP[i, LIFT + 5] * (BODY[i, SPIN] + 0.5 * JUMP[i, LIFT + 5])
            spent += (turning - PULL[i, 2] * JUMP[i, LIFT + 2]) / BODY[i, II]
        for c in range(6):
            BODY[i, X + c] += JUMP[i, LIFT + c]
        i = A.MEMBER[i, AFTER_ME]
    PAR[LEDGER + RESTITUTION] -= spent
    if PAR[LEDGER + RESTITUTION] < 0.0 and PAR[LEDGER + FRICTIONAL] > 0.0:
        PAR[LEDGER + FRICTIONAL] += PAR[LEDGER + RESTITUTION]
        PAR[LEDGER + RESTITUTION] = 0.0
