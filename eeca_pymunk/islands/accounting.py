"""The end of an island's interval: its works up to there enter the ledger. They are exact, as forces are constant and
velocities linear.

Forces of an interval that was cut may have given energy (a soft landing pushes before it touches): that is owed, and
taken out by what follows. So may they have turned the island, as their arms are about the middle of the whole interval.
"""

from __future__ import annotations

from ..compiled import Table, uncounted
from ..contacts.single import move_to, note
from ..model.bodies import AT_REST, CHANGED
from ..model.contacts import ENDED, LASTED
from ..model.scene import Scene, scene_of
from ..pairs.lists import mark_pair
from .at_rest import mark_changed, wake_supported
from .excess import repay
from .membership import unite
from .rest import spins_freely


@uncounted
def flag_again(TABLE: Table) -> None:
    """Flag the pairs of all intervals, in lists that were made anew. TABLE: `table_of` a Scene."""
    flag_pairs(scene_of(TABLE))


@uncounted
def flag_pairs(A: Scene) -> None:
    """Flag the pairs of all intervals, whose flags are not set."""
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root >= 0:
            a, b = A.PUSHED_BY[c].a, A.PUSHED_BY[c].b
            mark_pair(A, a, b, 1)


@uncounted
def book(A: Scene, c: int, t: float) -> None:
    """Book what contact number c has done in its interval until instant t, note its impulse, and end it.

    Velocities go linearly through an interval, so that after the part f of it D_n = -f lam (u_n + f (u_n+ - u_n) / 2).
    What a contact's friction gives back counts against its restitution, and the other way round.
    """
    PAR, COUNT, R = A.PAR, A.COUNT, A.PUSHED[c]
    root, a, b = A.PUSHED_BY[c].root, A.PUSHED_BY[c].a, A.PUSHED_BY[c].b
    A.PUSHED_BY[c].root = LASTED if t == PAR.dt else ENDED
    mark_pair(A, a, b, 0)
    f = (t - R.start) / R.length
    if f == 0.0 or (R.normal == 0.0 and R.tangential == 0.0):
        return
    normal = -f * R.normal * (R.un_before + 0.5 * f * (R.un_after - R.un_before))
    tangential = -f * R.tangential * (R.ut_before + 0.5 * f * (R.ut_after - R.ut_before))
    both = normal + tangential
    if normal < 0.0:
        normal, tangential = min(both, 0.0), max(both, 0.0)
    elif tangential < 0.0:
        normal, tangential = both, 0.0
    PAR.restitution += normal
    PAR.frictional += tangential
    PAR.external += f * R.work
    A.RESTING[root].lost += both
    if f > 0.0 and COUNT.logged < A.LOG.shape[0]:
        note(
            A.LOG[COUNT.logged], a, b, R.start + 0.5 * f * R.length, f * R.normal, f * R.tangential, R.nx,
            R.ny, R.px, R.py, f * R.change, R.gap,
        )  # fmt: skip
        A.LOG[COUNT.logged].duration = f * R.length
        COUNT.logged += 1


@uncounted
def gained(A: Scene, c: int, t: float) -> float:
    """Angular momentum that contact number c makes if its interval h is cut after s: its arms are about the middle of
    the whole, so that bodies without mobility aside it is -(1/2) s (h - s) (v_b - v_a) x f, v at the start of the
    interval."""
    R, BODY = A.PUSHED[c], A.BODY
    i, j = A.LINK[A.PUSHED_BY[c].a].owner, A.LINK[A.PUSHED_BY[c].b].owner
    s, h = t - R.start, R.length
    fx = (R.normal * R.nx - R.tangential * R.ny) / h
    fy = (R.normal * R.ny + R.tangential * R.nx) / h
    back_i, back_j = BODY[i].since - R.start, BODY[j].since - R.start
    vx = BODY[j].vx - back_j * BODY[j].ax - BODY[i].vx + back_i * BODY[i].ax
    vy = BODY[j].vy - back_j * BODY[j].ay - BODY[i].vy + back_i * BODY[i].ay
    return -0.5 * s * max(h - s, 0.0) * (vx * fy - vy * fx)


@uncounted
def turn_back(A: Scene, root: int, excess: float) -> None:
    """Take an angular momentum out of a free island, whose bodies are at one instant, by a common turn of all of it,
    which changes no contact's velocity; spins that nobody feels stay. Its energy is lost, or owed."""
    BODY = A.BODY
    mass, x, y, vx, vy = 0.0, 0.0, 0.0, 0.0, 0.0
    i = root
    while i >= 0:
        if BODY[i].inv_inertia == 0.0:
            return
        m = 1.0 / BODY[i].inv_mass
        mass, x, y = mass + m, x + m * BODY[i].x, y + m * BODY[i].y
        vx, vy = vx + m * BODY[i].vx, vy + m * BODY[i].vy
        i = A.MEMBER[i].following
    x, y, vx, vy = x / mass, y / mass, vx / mass, vy / mass
    whirl, inertia = 0.0, 0.0
    i = root
    while i >= 0:
        rx, ry = BODY[i].x - x, BODY[i].y - y
        whirl += (rx * (BODY[i].vy - vy) - ry * (BODY[i].vx - vx)) / BODY[i].inv_mass
        inertia += (rx * rx + ry * ry) / BODY[i].inv_mass
        if not spins_freely(A, i):
            whirl += BODY[i].spin / BODY[i].inv_inertia
            inertia += 1.0 / BODY[i].inv_inertia
        i = A.MEMBER[i].following
    turn = -excess / inertia
    i = root
    while i >= 0:
        BODY[i].vx -= turn * (BODY[i].y - y)
        BODY[i].vy += turn * (BODY[i].x - x)
        if not spins_freely(A, i):
            BODY[i].spin += turn
        i = A.MEMBER[i].following
    lost = -turn * (whirl + 0.5 * inertia * turn)
    A.PAR.restitution += lost
    A.RESTING[root].lost += lost


@uncounted
def wake(A: Scene, root: int, t: float) -> int:
    """An island that stands does so no longer from instant t on: it and all that rests on it become one, whose root is
    returned, and end their intervals."""
    MEMBER, one = A.MEMBER, root
    MEMBER[root].rest = CHANGED
    wake_supported(A)
    for i in range(A.BODY.shape[0] - 1):
        if A.STATE[i].island == i and A.BODY[i].inv_mass > 0.0 and MEMBER[i].rest == CHANGED:
            mark_changed(A, i)
            close_interval(A, i, t)
            one = unite(A, one, i)
    return one


@uncounted
def end_interval(A: Scene, root: int, t: float) -> None:
    """End the interval of an island at instant t, and of what rests on it."""
    if A.MEMBER[root].rest == AT_REST:
        wake(A, root, t)
    else:
        close_interval(A, root, t)


@uncounted
def close_interval(A: Scene, root: int, t: float) -> None:
    """End the interval of one island at instant t: book its contacts, and bring its bodies there."""
    free, excess = A.MEMBER[root].jointed == 0, 0.0
    if free:
        repay(A, root, t)
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root == root:
            for shape in (A.PUSHED_BY[c].a, A.PUSHED_BY[c].b):
                j = A.LINK[shape].owner
                free = free and A.BODY[j].inv_mass > 0.0 and A.STATE[j].island == root
            if free:
                excess += gained(A, c, t)
            book(A, c, t)
    A.MEMBER[root].open = 0
    i = root
    while i >= 0:
        move_to(A.BODY, i, t)
        i = A.MEMBER[i].following
    if free and excess != 0.0:
        turn_back(A, root, excess)


@uncounted
def alight(A: Scene, i: int, end: float) -> None:
    """Bring body i of an island with joints to the end of its interval: what happens there is in the books of
    joints."""
    move_to(A.BODY, i, end)
    body, rest = A.BODY[i], A.RESTING[i]
    body.x += rest.lift_x
    body.y += rest.lift_y
    body.angle += rest.lift_angle
    body.vx, body.vy, body.spin = rest.lift_vx, rest.lift_vy, rest.lift_spin
    rest.lift_x, rest.lift_y, rest.lift_angle = 0.0, 0.0, 0.0


@uncounted
def lift_out(A: Scene, root: int, end: float) -> None:
    """Lift the bodies of an island, at the end of its interval, out of each other; the losses pay what that costs
    beyond the work of forces: the change of kinetic energy, less m a.D + I alpha dtheta for displacements D."""
    PAR, BODY, PULL, JUMP = A.PAR, A.BODY, A.PULL, A.RESTING
    spent = 0.0
    i = root
    if A.MEMBER[root].jointed > 0:
        while i >= 0:
            if A.MEMBER[root].open > 0:
                alight(A, i, end)
            i = A.MEMBER[i].following
        return
    while i >= 0:
        move_to(BODY, i, end)
        linear = PULL[i, 0] * JUMP[i].lift_x + PULL[i, 1] * JUMP[i].lift_y
        linear -= JUMP[i].lift_vx * (BODY[i].vx + 0.5 * JUMP[i].lift_vx)
        linear -= JUMP[i].lift_vy * (BODY[i].vy + 0.5 * JUMP[i].lift_vy)
        spent -= linear / BODY[i].inv_mass
        if BODY[i].inv_inertia > 0.0:
            turning = JUMP[i].lift_spin * (BODY[i].spin + 0.5 * JUMP[i].lift_spin)
            spent += (turning - PULL[i, 2] * JUMP[i].lift_angle) / BODY[i].inv_inertia
        BODY[i].x += JUMP[i].lift_x
        BODY[i].y += JUMP[i].lift_y
        BODY[i].angle += JUMP[i].lift_angle
        BODY[i].vx += JUMP[i].lift_vx
        BODY[i].vy += JUMP[i].lift_vy
        BODY[i].spin += JUMP[i].lift_spin
        i = A.MEMBER[i].following
    if A.MEMBER[root].raised > 0:
        PAR.external += spent
        return
    PAR.restitution -= spent
    if PAR.restitution < 0.0 and PAR.frictional > 0.0:
        PAR.frictional += PAR.restitution
        PAR.restitution = 0.0
