"""Forces in islands at rest under what moves on them: the loads, and the statics problem of the bodies at rest."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..compiled.records import empty
from ..contacts.counts import note_unmet
from ..contacts.forces import find, key_of, remember_force, table_has_room
from ..geometry.flight import fastest_point
from ..model.bodies import AT_REST
from ..model.contacts import ROW, Problem
from ..model.parameters.rest import REST_CANDIDATE, REST_SPEED, STATICS_FACTORS, SUPPORT_ROUNDS
from ..model.scene import Scene
from ..model.step import CONTACTS
from ..pairs.rules import law
from ..rows.build import place_row
from ..rows.equilibrium import equilibrium
from ..rows.sweeps import velocities
from .local import contact_range, give_places, take_places
from .membership import members_of, pressed_island
from .rest import candidate_speed, spins_freely


@nonallocating
def add_load(
    A: Scene, root: int, a: int, b: int, fx: float, fy: float, px: float, py: float, LOAD: FloatArray
) -> None:  # fmt: skip
    """Add to LOAD (., 3), a row for each body of the island in the order of A.PLACE, the changes of velocity by an
    impulse f at the point p between shapes a and b, on b, if one of them is of the island and the other is not."""
    BODY, STATE = A.BODY, A.STATE
    i, j = A.LINK[a].owner, A.LINK[b].owner
    of_a, of_b = BODY[i].inv_mass > 0.0 and STATE[i].island == root, BODY[j].inv_mass > 0.0 and STATE[j].island == root
    if of_a == of_b:
        return
    k, sign = (j, 1.0) if of_b else (i, -1.0)
    q = A.PLACE[k]
    LOAD[q, 0] += sign * BODY[k].inv_mass * fx
    LOAD[q, 1] += sign * BODY[k].inv_mass * fy
    LOAD[q, 2] += sign * BODY[k].inv_inertia * ((px - BODY[k].x) * fy - (py - BODY[k].y) * fx)


@nonallocating
def add_loads(A: Scene, root: int, t: float, LOAD: FloatArray) -> None:
    """Add to LOAD, as `add_load`, the changes of velocity by contacts of other islands from the start of the step to
    instant t: by impulses that are logged, and by intervals that have not ended."""
    for e in range(A.COUNT.logged):
        one = A.LOG[e]
        fx, fy = one.normal * one.nx - one.tangential * one.ny, one.normal * one.ny + one.tangential * one.nx
        add_load(A, root, int(one.first), int(one.second), fx, fy, one.px, one.py, LOAD)
    for c in range(A.COUNT.pushes):
        r = A.PUSHED_BY[c].root
        if r < 0 or r == root:
            continue
        pushed = A.PUSHED[c]
        part = (t - pushed.start) / pushed.length
        fx = part * (pushed.normal * pushed.nx - pushed.tangential * pushed.ny)
        fy = part * (pushed.normal * pushed.ny + pushed.tangential * pushed.nx)
        add_load(A, root, A.PUSHED_BY[c].a, A.PUSHED_BY[c].b, fx, fy, pushed.px, pushed.py, LOAD)


@kernel
def unsupported(A: Scene, root: int, t: float, factors: int) -> float:
    """Speed that the impulses of its contacts leave to an island, at rest since the start of the step, under its loads
    up to instant t; 0 if some impulses balance these loads. Then the contacts get these, scaled to a whole step.
    factors: factorisations for that, at most."""
    BODY, planned = A.BODY, A.PAR.planned / t
    MINE, GATHERED = members_of(A, root), take_places(A)
    n = len(MINE)
    # One local body, the last, stands for all fixed ones that support the island.
    POSE, IMS, IIS, LEVER = np.zeros((n + 1, 3)), np.zeros(n + 1), np.zeros(n + 1), np.zeros(n + 1)
    START = np.zeros((n + 1, 3))
    for q in range(n):
        i = MINE[q]
        A.PLACE[i] = q
        IMS[q], IIS[q], LEVER[q] = BODY[i].inv_mass, BODY[i].inv_inertia, 0.0 if spins_freely(A, i) else BODY[i].extent
        POSE[q, 0], POSE[q, 1], POSE[q, 2] = BODY[i].x, BODY[i].y, BODY[i].angle
        for c in range(3):
            START[q, c] = t * A.PULL[i, c]
    add_loads(A, root, t, START)
    first, end = contact_range(A, root)
    ROWS, L, OF = empty(end - first, ROW), np.empty((end - first, 2)), np.empty(end - first, np.int64)
    open_to, m = 0.5 * candidate_speed(A.MEMBER[root].with_supports) * A.PAR.pulled * t * t, 0
    for c in range(first, end):
        pushed = A.PUSHED[c]
        # Contacts without an impulse take part if their gap is no larger than the way in which a body may stop when it
        # is put to rest.
        if not (pushed.normal > 0.0 or pushed.gap <= open_to):
            continue
        a, b = A.PUSHED_BY[c].a, A.PUSHED_BY[c].b
        p, q = A.PLACE[A.LINK[a].owner], A.PLACE[A.LINK[b].owner]
        e, mu, _, _ = law(A, a, b)
        row = ROWS[m]
        row.a, row.b = p if p >= 0 else n, q if q >= 0 else n
        row.nx, row.ny, row.gap, row.elasticity, row.friction, row.surface = pushed.nx, pushed.ny, 0.0, e, mu, 0.0
        place_row(row, pushed.px, pushed.py, POSE, IMS, IIS)
        L[m, 0], L[m, 1], OF[m] = pushed.normal / planned, pushed.tangential / planned, c
        m += 1
    give_places(A, GATHERED)
    problem, slow = Problem(ROWS, IMS, IIS, POSE, n, m), REST_SPEED * A.PAR.pulled * t
    LEFT = np.zeros((n + 1, 3))
    velocities(problem, L[:m], START, LEFT)
    found, taken = equilibrium(problem, L, START, LEVER, slow, factors)
    A.COUNT.direct += taken
    if not found:
        return fastest_point(LEFT, LEVER, n)
    for z in range(m):
        pushed, normal = A.PUSHED[OF[z]], planned * L[z, 0]
        pushed.normal, pushed.tangential, pushed.change = normal, planned * L[z, 1], normal / ROWS[z].k_n
        remember_forces(A, OF[z])
    return 0.0


@nonallocating
def remember_forces(A: Scene, c: int) -> None:
    """Write the forces of contact c into the memory of forces (`..contacts.forces`)."""
    a, b = A.PUSHED_BY[c].a, A.PUSHED_BY[c].b
    key = key_of(A, a, b)
    if c > 0 and A.PUSHED_BY[c - 1].a == a and A.PUSHED_BY[c - 1].b == b:
        key += 1  # the other end of a face
    if find(A.KEYS, key) >= 0 or table_has_room(A, 1):
        pushed = A.PUSHED[c]
        force = pushed.normal / pushed.length
        remember_force(A, key, force, pushed.tangential / pushed.length, force, pushed.length)


@nonallocating
def presses_on(A: Scene, c: int, root: int) -> bool:
    """Whether contact c is between an island and a body of another one, of root `root`."""
    return root in (pressed_island(A, c, A.PUSHED_BY[c].a), pressed_island(A, c, A.PUSHED_BY[c].b))


@nonallocating
def mark_loaded(A: Scene, c: int) -> bool:
    """Mark the islands at rest on which contact c of another one presses; returns whether there are any."""
    found = False
    for shape in (A.PUSHED_BY[c].a, A.PUSHED_BY[c].b):
        other = pressed_island(A, c, shape)
        if other >= 0 and A.MEMBER[other].rest == AT_REST:
            A.MEMBER[other].unverified, found = 1, True
    return found


@nonallocating
def mark_under_moving(A: Scene, since: float) -> bool:
    """`mark_loaded` by the contacts of moving islands whose intervals have ended or do not last until the end of the
    step, as those that were solved again for a part of it, or have begun after instant `since`; returns whether there
    are any."""
    found = False
    for c in range(A.COUNT.pushes):
        root, pushed = A.PUSHED_BY[c].root, A.PUSHED[c]
        part = pushed.start > since or pushed.start + pushed.length < A.PAR.dt
        if root < 0 or (part and A.MEMBER[root].rest != AT_REST):
            found = mark_loaded(A, c) or found
    return found


@kernel
def renew_loads(A: Scene, t: float) -> None:
    """Islands at rest whose loads have changed within the step, as intervals of what moves on them have ended early,
    get the impulses that balance the momenta of all loads up to instant t; those of their contacts were for the loads
    at its start. Where there are no such impulses these stay, and `unmet` says so."""
    # Impacts at the start of the step begin intervals there anew.
    since, rounds = -1.0 if A.COUNT.event_bodies + A.COUNT.present_bodies > 0 else 0.0, 0
    more = A.COUNT.may_support > 0 and mark_under_moving(A, since)
    while more and rounds < SUPPORT_ROUNDS:
        more = False
        for i in range(A.BODY.shape[0] - 1):
            if A.MEMBER[i].unverified == 0:
                continue
            A.MEMBER[i].unverified = 0
            if A.STATE[i].island != i or A.MEMBER[i].rest != AT_REST:
                continue
            first, end = contact_range(A, i)
            left, limit = unsupported(A, i, t, STATICS_FACTORS), REST_CANDIDATE * A.PAR.pulled * t
            if left > limit:
                note_unmet(A, CONTACTS, A.PUSHED_BY[first].a, A.PUSHED_BY[first].b, left, limit)
            for c in range(first, end if left == 0.0 else first):
                more = mark_loaded(A, c) or more
        rounds += 1


@kernel
def renew_support(A: Scene) -> None:
    """At the end of a step: `renew_loads`; islands at rest that have no forces for their loads wake in the next step,
    at whose start all that bear moving islands are tested again: these may have left."""
    renew_loads(A, A.PAR.dt)
    if A.COUNT.may_support > 0:
        mark_under_moving(A, -1.0)
