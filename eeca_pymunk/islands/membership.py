"""Membership of islands: which bodies are in one, and which contacts persist."""

from __future__ import annotations

import numpy as np

from ..arrays import IntArray
from ..compiled import inlined, kernel, nonallocating
from ..contacts.forces import find, key_of
from ..contacts.targets import hardly_bounces
from ..geometry.flight import move_to, opening_rate, pose, rate
from ..geometry.gap import gap_at
from ..geometry.widths import smaller
from ..model.bodies import AT_REST, Body
from ..model.parameters.events import RESOLUTION, WORK_JOINTED
from ..model.parameters.intervals import ELASTIC_REST, ELASTIC_REST_ON, LARGE_ISLAND, SOLVES_BEFORE_HASTE, TOUCH
from ..model.scene import Scene
from ..pairs.rules import law


@nonallocating
def fixed_support(A: Scene, i: int) -> bool:
    """Whether body i is fixed for bodies that rest on it: impulses do not move it, or it is at rest."""
    return bool(A.BODY[i].inv_mass == 0.0 or (A.COUNT.may_support > 0 and A.MEMBER[i].rest == AT_REST))


@nonallocating
def unite(A: Scene, i: int, j: int) -> int:
    """Unite the islands of bodies i and j, or the bodies themselves; with i = j a body becomes an island. Returns the
    root."""
    MEMBER, STATE = A.MEMBER, A.STATE
    for k in (i, j):
        if STATE[k].island < 0:
            A.COUNT.even = 0
            STATE[k].island = k
            MEMBER[k].following, MEMBER[k].last, MEMBER[k].bodies, MEMBER[k].hits = -1, k, 1, 0
            MEMBER[k].open = 0
            MEMBER[k].jointed = 1 if MEMBER[k].tied >= 0 else 0
            A.RESTING[k].lost = 0.0
    a, b = STATE[i].island, STATE[j].island
    if a == b:
        return a
    if MEMBER[a].bodies < MEMBER[b].bodies or (MEMBER[a].bodies == MEMBER[b].bodies and b < a):
        a, b = b, a
    k = b
    while k >= 0:
        STATE[k].island = a
        k = MEMBER[k].following
    MEMBER[MEMBER[a].last].following = b
    MEMBER[a].last = MEMBER[b].last
    MEMBER[a].bodies += MEMBER[b].bodies
    MEMBER[a].hits = max(MEMBER[a].hits, MEMBER[b].hits)
    MEMBER[a].jointed = max(MEMBER[a].jointed, MEMBER[b].jointed)
    A.RESTING[a].lost += A.RESTING[b].lost
    A.RESTING[a].longest = min(A.RESTING[a].longest, A.RESTING[b].longest)
    return a


@nonallocating
def jointed(A: Scene, i: int) -> bool:
    """Whether body i is in an island with joints."""
    root = A.STATE[i].island
    return bool(root >= 0 and A.MEMBER[root].jointed > 0)


@inlined
def island_size(A: Scene, i: int) -> int:
    """Number of bodies of the island of body i, 0 if it is in none."""
    return A.MEMBER[A.STATE[i].island].bodies if A.STATE[i].island >= 0 else 0


@inlined
def pressed_island(A: Scene, c: int, shape: int) -> int:
    """The root of the island on which contact c of another one presses with a shape; -1 if there is none."""
    j = A.LINK[shape].owner
    other = A.STATE[j].island
    return other if A.BODY[j].inv_mass > 0.0 and other != A.PUSHED_BY[c].root else -1


@nonallocating
def largest_island(A: Scene, a: int, b: int) -> int:
    """Number of bodies of the larger of the islands of shapes a and b, 0 for none."""
    return max(island_size(A, A.LINK[a].owner), island_size(A, A.LINK[b].owner))


@nonallocating
def in_large_island(A: Scene, a: int, b: int) -> bool:
    """Whether a lossy impact of shapes a and b is on a large island: it acts at once on the nearest bodies only."""
    if law(A, a, b)[0] >= 1.0:
        return False
    return bool(largest_island(A, a, b) >= LARGE_ISLAND)


@nonallocating
def budget_spent(A: Scene, root: int) -> bool:
    """Whether bodies were solved so often in this step that a large island is not joined any more, and is hit only by
    what would otherwise get too deep (`hits.passed_over`)."""
    if root < 0 or A.MEMBER[root].bodies < LARGE_ISLAND or A.MEMBER[root].open == 0:
        return False
    most = SOLVES_BEFORE_HASTE * (WORK_JOINTED if A.MEMBER[root].jointed > 0 else 1)
    return bool(A.COUNT.solved > most * A.BODY.shape[0])


@nonallocating
def members(A: Scene, root: int, MINE: IntArray) -> int:
    """Write the bodies of an island to MINE; returns their number."""
    i, n = root, 0
    while i >= 0:
        MINE[n] = i
        n += 1
        i = A.MEMBER[i].following
    return n


@kernel
def members_of(A: Scene, root: int) -> IntArray:
    """The bodies of an island, in the order of its chain."""
    MINE = np.empty(A.MEMBER[root].bodies, np.int64)
    members(A, root, MINE)
    return MINE


@nonallocating
def lossy(A: Scene, root: int) -> bool:
    """Whether any shape of an island has an elasticity below 1."""
    i = root
    while i >= 0:
        for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
            if A.SHAPE[s].elasticity < 1.0:
                return True
        i = A.MEMBER[i].following
    return False


@nonallocating
def remembered_force(A: Scene, a: int, b: int, since: float) -> tuple[float, float]:
    """Normal force and load (mass length/time²) of a pair of shapes a and b, summed over its points, as of the steps
    from number `since` on; 0 if there is none."""
    key = key_of(A, a, b)
    force, load = 0.0, 0.0
    for z in range(2):
        row = find(A.KEYS, key + z)
        if row >= 0 and A.FORCES[row].stamp >= since:
            force += A.FORCES[row].normal
            load += A.FORCES[row].load
    return force, load


@nonallocating
def turning_acceleration(
    i: Body, j: Body, nx: float, ny: float, x: float, y: float, vx: float, vy: float, spin_i: float, spin_j: float
) -> float:  # fmt: skip
    """Acceleration (length/time²) with which bodies i and j close along n, from i to j, as one without mobility turns
    with spin w: w² n.x - 2 w t.v, with the way x and the velocity v from i to j, and t = z x n."""
    spin = spin_j if j.inv_mass == 0.0 else spin_i
    if (i.inv_mass > 0.0 and j.inv_mass > 0.0) or spin == 0.0:
        return 0.0
    return spin * (spin * (nx * x + ny * y) - 2.0 * (nx * vy - ny * vx))


@nonallocating
def approach(A: Scene, a: int, b: int, t: float) -> tuple[float, float, float, float, float]:
    """Gap (length) of shapes a and b at instant t, its rate u (length/time, negative when closing), the accelerations
    (length/time²) with which it closes without contacts and on the present paths, both with `turning_acceleration`, and
    the effective mass of the contact. The path of a's body begins at t; that of b's body may begin earlier."""
    BODY, PULL, i, j = A.BODY, A.PULL, A.LINK[a].owner, A.LINK[b].owner
    x, y, angle = pose(BODY, j, t)
    g, nx, ny, px, py = gap_at(A, a, BODY[i].x, BODY[i].y, BODY[i].angle, b, x, y, angle)
    xi, yi, xj, yj = px - BODY[i].x, py - BODY[i].y, px - x, py - y
    arm_i, arm_j = xi * ny - yi * nx, xj * ny - yj * nx
    one, two = (BODY[i].vx, BODY[i].vy, BODY[i].spin), rate(BODY, j, t)
    u = opening_rate(nx, ny, arm_i, arm_j, one, two)
    closing = nx * (PULL[i, 0] - PULL[j, 0]) + ny * (PULL[i, 1] - PULL[j, 1])
    closing += arm_i * PULL[i, 2] - arm_j * PULL[j, 2]
    present = nx * (BODY[i].ax - BODY[j].ax) + ny * (BODY[i].ay - BODY[j].ay)
    present += arm_i * BODY[i].angular - arm_j * BODY[j].angular
    turns = turning_acceleration(
        BODY[i], BODY[j], nx, ny, x - BODY[i].x, y - BODY[i].y, two[0] - one[0], two[1] - one[1], one[2], two[2]
    )
    of_spins = BODY[i].inv_inertia * arm_i * arm_i + BODY[j].inv_inertia * arm_j * arm_j
    mass = 1.0 / (BODY[i].inv_mass + BODY[j].inv_mass + of_spins)
    return g, u, closing + turns, present + turns, mass


@nonallocating
def persists(A: Scene, a: int, b: int, t: float) -> bool:
    """Whether shapes a and b, whose bodies are at instant t and need not touch, are in contact from there to the end of
    the step, by what they carried before; of shapes that meet at t see `persists_from`.

    e < 1: its bounce e |u| is below half of P = max(-a_n h, A_nn f h), with the load f that it carried; and it touches
    with u <= P, or carried a force and closes again. e = 1: it touches with almost no speed, and a contact with a body
    without mobility is pressed together, perhaps by joints or other contacts.
    """
    e = law(A, a, b)[0]
    g, u, closing, present, mass = approach(A, a, b, t)
    h = A.PAR.dt - t
    small = smaller(A, a, b)
    force, load = remembered_force(A, a, b, A.PAR.stamp - 1.0)
    if e >= 1.0:
        limit = (ELASTIC_REST_ON if force > 0.0 else ELASTIC_REST) * A.PAR.pulled * A.PAR.dt
        i, j = A.LINK[a].owner, A.LINK[b].owner
        fixed = A.BODY[j].inv_mass == 0.0 or A.BODY[i].inv_mass == 0.0
        pressed = max(closing, present) > 0.0 or force > 0.0 or A.MEMBER[i].tied >= 0 or A.MEMBER[j].tied >= 0
        return g <= TOUCH * small and abs(u) <= limit and (pressed or not fixed)
    press = max(closing, load / mass) * h
    if not hardly_bounces(e, u, press):
        return False
    if g <= TOUCH * small:
        return u <= press
    return force > 0.0 and g + u * h - 0.5 * press * h <= 0.0


@nonallocating
def persists_from(A: Scene, a: int, b: int, t: float) -> bool:
    """Whether the contact of shapes a and b, which meet at instant t, persists from then on: their impact is the last.
    The paths of their bodies then begin at t (`flight.move_to`).

    e < 1: all bounces of e |u| under the acceleration a_n of the gap end within the step, 2 e |u| <= -a_n (1 - e)
    (dt - t); or a body had n >= RESOLUTION impacts in the step, or e^n <= 1/RESOLUTION if no force or gravity acts on
    any body.
    e = 1: as `persists`, if |a| > 0; or a body had n >= RESOLUTION impacts, and either a_n < 0, without
    contacts or on the present paths, and |u| < |a| dt / RESOLUTION, or a body is in an island with joints and n would
    exceed COUNT.limit at the end of the step.
    """
    i, j = A.LINK[a].owner, A.LINK[b].owner
    if A.BODY[i].inv_mass > 0.0:
        move_to(A.BODY, i, t)
    if A.BODY[j].inv_mass > 0.0:
        move_to(A.BODY, j, t)
    e = law(A, a, b)[0]
    _, u, closing, present, _ = approach(A, a, b, t)
    end = A.PAR.dt
    met = max(A.STATE[i].impacts, A.STATE[j].impacts)
    if e < 1.0:
        if A.PAR.pulled == 0.0 and e**met * RESOLUTION <= 1.0:
            return True
        return met >= RESOLUTION or (closing > 0.0 and 2.0 * e * max(-u, 0.0) <= closing * (1.0 - e) * (end - t))
    if met >= RESOLUTION and max(closing, present) > 0.0 and -u * RESOLUTION < A.PAR.pulled * end:
        return True
    if met >= RESOLUTION and t * A.COUNT.limit < met * end and (jointed(A, i) or jointed(A, j)):
        return True
    return A.PAR.pulled > 0.0 and persists(A, a, b, t)
