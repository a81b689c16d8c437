"""Islands of bodies in sustained contact: who belongs to one, and which contacts are sustained."""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from ..geometry.gap import gap_at
from ..layout import (
    ANGLE,
    ELASTICITY,
    II,
    IM,
    OWNER,
    SINCE,
    SIZE,
    SPIN,
    VX,
    VY,
    X,
    Y,
)
from ..pairs.rules import law
from ..sustained.contacts import CROWD
from ..sustained.memory import find, key_of
from .layout import (
    AFTER_ME,
    BODIES,
    CARRIES,
    DT,
    EVEN,
    FIRST_SHAPE,
    HITS,
    ISLAND,
    JOINTED,
    LAST_ONE,
    LOST,
    OPEN,
    PULLED,
    SHAPES,
    SOLVED,
    STAMP,
    STILL,
    TIED,
    Scene,
)  # fmt: skip

_PLENTY = 3  # solves in a step of every body of the scene, on the average
TOUCH = 1e-7  # gap relative to the smaller shape, within which shapes are in touch
_STILL, _WAS_STILL = 1e-6, 1e-3  # speed relative to |a| dt, below which elastic contacts rest; if they did before


@uncounted
def carrier(A: Scene, i: int) -> bool:
    """Whether what rests on body i takes it for fixed: impulses do not move it, or it stands still."""
    return bool(A.BODY[i, IM] == 0.0 or (A.COUNT[CARRIES] > 0 and A.MEMBER[i, STILL] == 1))


@uncounted
def unite(A: Scene, i: int, j: int) -> int:
    """Put bodies i and j, with their islands, into one; its root."""
    MEMBER, STATE = A.MEMBER, A.STATE
    for k in (i, j):
        if STATE[k, ISLAND] < 0:
            A.COUNT[EVEN] = 0
            STATE[k, ISLAND] = k
            MEMBER[k, AFTER_ME], MEMBER[k, LAST_ONE], MEMBER[k, BODIES], MEMBER[k, HITS] = -1, k, 1, 0
            MEMBER[k, OPEN] = 0
            MEMBER[k, JOINTED] = 1 if MEMBER[k, TIED] >= 0 else 0
            A.RESTING[k, LOST] = 0.0
    a, b = STATE[i, ISLAND], STATE[j, ISLAND]
    if a == b:
        return a
    if MEMBER[a, BODIES] < MEMBER[b, BODIES] or (MEMBER[a, BODIES] == MEMBER[b, BODIES] and b < a):
        a, b = b, a
    k = b
    while k >= 0:
        STATE[k, ISLAND] = a
        k = MEMBER[k, AFTER_ME]
    MEMBER[MEMBER[a, LAST_ONE], AFTER_ME] = b
    MEMBER[a, LAST_ONE] = MEMBER[b, LAST_ONE]
    MEMBER[a, BODIES] += MEMBER[b, BODIES]
    MEMBER[a, HITS] = max(MEMBER[a, HITS], MEMBER[b, HITS])
    MEMBER[a, JOINTED] = max(MEMBER[a, JOINTED], MEMBER[b, JOINTED])
    A.RESTING[a, LOST] += A.RESTING[b, LOST]
    return a


@uncounted
def worn(A: Scene, root: int) -> bool:
    """Whether the island is a crowd that is not solved again in this step, as bodies have been solved often enough."""
    if root < 0 or A.MEMBER[root, BODIES] < CROWD or A.MEMBER[root, OPEN] == 0:
        return False
    return bool(A.COUNT[SOLVED] > _PLENTY * A.BODY.shape[0])


@uncounted
def members(A: Scene, root: int, MINE: IntArray) -> int:
    """The bodies of an island into MINE; how many they are."""
    i, n = root, 0
    while i >= 0:
        MINE[n] = i
        n += 1
        i = A.MEMBER[i, AFTER_ME]
    return n


@uncounted
def lossy(A: Scene, root: int) -> bool:
    """Whether any shape of an island has an elasticity below 1."""
    i = root
    while i >= 0:
        for s in range(A.STATE[i, FIRST_SHAPE], A.STATE[i, FIRST_SHAPE] + A.STATE[i, SHAPES]):
            if A.SHAPE[s, ELASTICITY] < 1.0:
                return True
        i = A.MEMBER[i, AFTER_ME]
    return False


@uncounted
def remembered(KEYS: IntArray, FORCES: FloatArray, shapes: int, a: int, b: int, since: float) -> tuple[float, float]:
    """Normal force and load of a pair of shapes, of the steps from number `since` on; 0 if there is none."""
    key = key_of(shapes, a, b)
    force, load = 0.0, 0.0
    for z in range(2):
        row = find(KEYS, key + z)
        if row >= 0 and FORCES[row, 3] >= since:
            force += FORCES[row, 0]
            load += FORCES[row, 2]
    return force, load


@uncounted
def approach(
    BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, VERTEX: FloatArray, WORK: FloatArray, PULL: FloatArray,
    a: int, b: int, t: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Gap of shapes a and b, whose paths begin at instant t or that move evenly; its rate; the acceleration with which
    it closes without contacts; and the mass that it feels."""
    i, j = LINK[a, OWNER], LINK[b, OWNER]
    h = t - BODY[j, SINCE]
    g, nx, ny, px, py = gap_at(
        SHAPE, LINK, VERTEX, WORK, a, BODY[i, X], BODY[i, Y], BODY[i, ANGLE],
        b, BODY[j, X] + BODY[j, VX] * h, BODY[j, Y] + BODY[j, VY] * h, BODY[j, ANGLE] + BODY[j, SPIN] * h,
    )  # fmt: skip
    xi, yi, xj, yj = (
        px - BODY[i, X],
        py - BODY[i, Y],
        px - BODY[j, X] - BODY[j, VX] * h,
        py - BODY[j, Y] - BODY[j, VY] * h,
    )
    arm_i, arm_j = xi * ny - yi * nx, xj * ny - yj * nx
    u = nx * (BODY[j, VX] - BODY[i, VX]) + ny * (BODY[j, VY] - BODY[i, VY])
    u += arm_j * BODY[j, SPIN] - arm_i * BODY[i, SPIN]
    closing = nx * (PULL[i, 0] - PULL[j, 0]) + ny * (PULL[i, 1] - PULL[j, 1])
    closing += arm_i * PULL[i, 2] - arm_j * PULL[j, 2]
    mass = 1.0 / (BODY[i, IM] + BODY[j, IM] + BODY[i, II] * arm_i * arm_i + BODY[j, II] * arm_j * arm_j)
    return g, u, closing, mass


@uncounted
def rests(A: Scene, a: int, b: int, t: float, lossy: bool) -> bool:
    """Whether a pair whose bodies are at instant t is in sustained contact until the end of the step.

    e < 1: iff its bounce e |u| is below half of what presses it together, P = max(a_n h, A_nn f h) with f the load it
    carried, and it is in touch (u <= P) or carried a force and closes again. e = 1: iff it touches without speed and
    against what does not move is pressed.
    """
    e = law(A.SHAPE, A.RULE, a, b)[0]
    g, u, closing, mass = approach(A.BODY, A.SHAPE, A.LINK, A.VERTEX, A.WORK, A.PULL, a, b, t)
    h = A.PAR[DT] - t
    small = min(A.SHAPE[a, SIZE], A.SHAPE[b, SIZE])
    force, load = remembered(A.KEYS, A.FORCES, A.SHAPE.shape[0], a, b, A.PAR[STAMP] - 1.0)
    if e >= 1.0 and not lossy:
        limit = (_WAS_STILL if force > 0.0 else _STILL) * A.PAR[PULLED] * A.PAR[DT]
        fixed = A.BODY[A.LINK[b, OWNER], IM] == 0.0 or A.BODY[A.LINK[a, OWNER], IM] == 0.0
        return g <= TOUCH * small and abs(u) <= limit and (not fixed or closing > 0.0 or force > 0.0)
    press = max(closing, load / mass) * h
    if not -e * min(u, 0.0) < 0.5 * press:
        return False
    if g <= TOUCH * small:
        return u <= press
    return force > 0.0 and g + u * h - 0.5 * press * h <= 0.0
