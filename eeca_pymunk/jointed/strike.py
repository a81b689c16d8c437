"""An impact on an island with joints: to its instant on the island's own path, then impulses that joints pass on."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from ..geometry.flight import pose
from ..geometry.gap import gap_at
from ..impacts.block import Block, gather, lay_out, owing
from ..impacts.booking import book
from ..impacts.collide import finish, rejoin
from ..impacts.islands import members, unite
from ..impacts.layout import (
    BODIES,
    DAMPED,
    DT,
    EXTERNAL,
    FRICTIONAL,
    ISLAND,
    JOINTED,
    KINKS,
    LEDGER,
    LIFT,
    LOST,
    OPEN,
    PENDING,
    PUSH_A,
    PUSH_B,
    PUSHES,
    RESTITUTION,
    ROOT,
    STORED,
    Scene,
)  # fmt: skip
from ..impacts.settle import comes_to_rest
from ..impacts.spans import dismiss
from ..impacts.strike import move_to
from ..joints.layout import CLAMPED, CLOSED, LIMITED, MOTORS, PROJECTED, SUPPORTS
from ..joints.layout import DAMPED as DAMPED_JOINTS
from ..joints.layout import STORED as STORED_JOINTS
from ..joints.scratch import BEFORE as LOCAL_BEFORE
from ..joints.scratch import BODY_0, BODY_1, FREEDOMS
from ..layout import AX, AY, IM, OWNER, SINCE, SIZE, SPIN, TWIST, VX, VY
from ..pairs.lists import mark_pair
from ..rows.blocks import CONVERGED, D_NORMAL, D_TANGENTIAL, OUT_SIZE, SCALE_LOCK, TRUNCATED
from ..rows.build import aim, conserves, rates
from ..rows.energy import scale_of, works
from .columns import fill_free, fill_group, find_groups, make_columns, push_columns, weigh
from .component import answer, find_places, gather_component, ready, restore_joints
from .layout import LIFTED, TURNED_WORK, Joints
from .newton import solve_columns
from .solve import begin_span

_MEET = 1e-13  # gap at an impact, over the smaller shape
_SECANTS, _LOADED_SECANTS = 5, 2  # also where other contacts push
_SWEEPS = 1000
_INSTANT = 1e-12  # of a step, below which a span is none


@uncounted
def book_component(A: Scene, J: Joints, s: int) -> None:
    """Book what the joints of component s have done in their span."""
    PAR, B = A.PAR, J.STEPPED[s]
    PAR[LEDGER + EXTERNAL] += B[MOTORS] + B[SUPPORTS] + B[CLOSED] + B[TURNED_WORK]
    PAR[LEDGER + DAMPED] += B[DAMPED_JOINTS]
    PAR[LEDGER + RESTITUTION] += B[LIMITED] + B[PROJECTED] - B[LIFTED]
    PAR[LEDGER + FRICTIONAL] += B[CLAMPED]
    PAR[STORED] += B[STORED_JOINTS]
    for c in range(len(B)):
        B[c] = 0.0


@kernel
def components_of(A: Scene, J: Joints, root: int) -> IntArray:
    """The components in an island."""
    MINE = np.empty(A.MEMBER[root, BODIES], np.int64)
    n = members(A, root, MINE)
    found = np.empty(n, np.int64)
    count = 0
    for q in range(n):
        s = J.OF[MINE[q]]
        if s < 0:
            continue
        known = False
        for c in range(count):
            known = known or found[c] == s
        if not known:
            found[count] = s
            count += 1
    return found[:count]


@uncounted
def take_back(A: Scene, root: int) -> None:
    """Forget the contacts of the span that an island has begun."""
    c = 0
    while c < A.COUNT[PUSHES]:
        if A.PUSHED_BY[c, ROOT] == root:
            mark_pair(A.LIST, A.POOL, A.FLAG, A.LIST.shape[0], A.PUSHED_BY[c, PUSH_A], A.PUSHED_BY[c, PUSH_B], 0)
            last = A.COUNT[PUSHES] - 1
            for w in range(A.PUSHED.shape[1]):
                A.PUSHED[c, w] = A.PUSHED[last, w]
            for w in range(3):
                A.PUSHED_BY[c, w] = A.PUSHED_BY[last, w]
            A.COUNT[PUSHES] = last
        else:
            c += 1


@kernel
def shorten(A: Scene, J: Joints, root: int, t: float) -> bool:
    """Let the span of an island end at instant t, not booked yet; whether it has contacts. Nothing if it is over."""
    if root < 0 or A.MEMBER[root, JOINTED] == 0 or A.MEMBER[root, OPEN] == 0:
        return False
    before = A.COUNT[PUSHES]
    take_back(A, root)
    began = A.BODY[root, SINCE]
    some = before != A.COUNT[PUSHES]
    found = components_of(A, J, root)
    for c in range(len(found)):
        restore_joints(J, found[c])
    if t - began > _INSTANT * A.PAR[DT]:
        begin_span(A, J, root, began, t - began)
    return some


@kernel
def end_here(A: Scene, J: Joints, root: int, t: float) -> None:
    """End the span of an island at instant t, its own end: book it, and bring its bodies there."""
    if root < 0 or A.MEMBER[root, JOINTED] == 0 or A.MEMBER[root, OPEN] == 0:
        return
    for c in range(A.COUNT[PUSHES]):
        if A.PUSHED_BY[c, ROOT] == root:
            book(A, c, t)
    empty = t - A.BODY[root, SINCE] <= _INSTANT * A.PAR[DT]
    found = components_of(A, J, root)
    for c in range(len(found)):
        if empty:
            for w in range(J.STEPPED.shape[1]):
                J.STEPPED[found[c], w] = 0.0
        A.RESTING[root, LOST] -= J.STEPPED[found[c], LIFTED]
        book_component(A, J, found[c])
    A.MEMBER[root, OPEN] = 0
    MINE = np.empty(A.MEMBER[root, BODIES], np.int64)
    n = members(A, root, MINE)
    for q in range(n):
        i = MINE[q]
        A.STATE[i, KINKS] += 1
        if not empty:
            move_to(A.BODY, i, t)
            for c in range(3):
                A.BODY[i, VX + c] += A.RESTING[i, LIFT + 3 + c]
                A.RESTING[i, LIFT + 3 + c] = 0.0


@kernel
def meet(A: Scene, J: Joints, a: int, b: int, t: float) -> float:
    """Bring the islands of shapes a and b, which are seen to meet at instant t, to the instant at which they do."""
    i, j = A.LINK[a, OWNER], A.LINK[b, OWNER]
    roots = (A.STATE[i, ISLAND], A.STATE[j, ISLAND] if A.BODY[j, IM] > 0.0 else -1)
    least = 0.0
    for root in roots:
        if root >= 0 and A.MEMBER[root, OPEN] > 0 and A.MEMBER[root, JOINTED] > 0:
            least = max(least, A.BODY[root, SINCE])
    small = min(A.SHAPE[a, SIZE], A.SHAPE[b, SIZE])
    before, gap_before = -1.0, 0.0
    for tries in range(_SECANTS):
        loaded = shorten(A, J, roots[0], t)
        if roots[1] != roots[0]:
            loaded = shorten(A, J, roots[1], t) or loaded
        xi, yi, qi = pose(A.BODY, i, t)
        xj, yj, qj = pose(A.BODY, j, t)
        g, nx, ny, px, py = gap_at(A.SHAPE, A.LINK, A.VERTEX, A.WORK, a, xi, yi, qi, b, xj, yj, qj)
        if (loaded and tries + 1 >= _LOADED_SECANTS) or abs(g) <= _MEET * small:
            break
        slope = 0.0
        if before >= 0.0 and t != before:
            slope = (g - gap_before) / (t - before)
        else:
            vi = path_rate(A, i, t, nx, ny, px - xi, py - yi)
            slope = path_rate(A, j, t, nx, ny, px - xj, py - yj) - vi
        # The islands end where they were brought last.
        if not slope < 0.0 or tries + 1 == _SECANTS:
            break
        before, gap_before = t, g
        then = min(max(t - g / slope, least), A.PAR[DT])
        if then == t:
            break
        t = then
    end_here(A, J, roots[0], t)
    if roots[1] != roots[0]:
        end_here(A, J, roots[1], t)
    return t


@uncounted
def path_rate(A: Scene, i: int, t: float, nx: float, ny: float, x: float, y: float) -> float:
    """Velocity along n of the point at (x, y) from body i on its path."""
    BODY, s = A.BODY, t - A.BODY[i, SINCE]
    vx, vy = BODY[i, VX] + s * BODY[i, AX], BODY[i, VY] + s * BODY[i, AY]
    spin = BODY[i, SPIN] + s * BODY[i, TWIST]
    return float(nx * vx + ny * vy + (x * ny - y * nx) * spin)


@uncounted
def energy_of(block: Block, V: FloatArray, n: int) -> float:
    """Kinetic energy of the n bodies of a block at velocities V."""
    total = 0.0
    for q in range(n):
        total += 0.5 * (V[q, 0] * V[q, 0] + V[q, 1] * V[q, 1]) / block.IM[q]
        if block.II[q] > 0.0:
            total += 0.5 * V[q, 2] * V[q, 2] / block.II[q]
    return total


@uncounted
def carried_along(J: Joints, s: int) -> bool:
    """Whether component s hangs on something that moves; its bodies are in the scratch."""
    for i in range(J.SPAN[s, BODY_1] - J.SPAN[s, BODY_0]):
        if J.NODE[i, FREEDOMS] == 0:
            for c in range(3):
                if J.LOCAL[i, LOCAL_BEFORE + c] != 0.0:
                    return True
    return False


@kernel
def collide(A: Scene, J: Joints, disks: int, a: int, b: int, t: float) -> tuple[int, int]:
    """The impact of shapes a and b, seen at instant t, with all that hangs on them: results as `..impacts.strike`."""
    k = A.SHAPE.shape[0]
    i, j = A.LINK[a, OWNER], A.LINK[b, OWNER]
    t = meet(A, J, a, b, t)
    n, m, PAIRS = gather(A, disks, a, b, t)
    again, ended = True, 0
    ENDED = np.empty(A.BODY.shape[0], np.int64)
    while again:
        again = False
        for q in range(n):
            root = A.STATE[A.BLOCK[q], ISLAND]
            if root >= 0 and A.MEMBER[root, OPEN] > 0 and A.MEMBER[root, JOINTED] > 0:
                shorten(A, J, root, t)
                end_here(A, J, root, t)
                ENDED[ended] = root
                ended += 1
                again = True
        if again:
            dismiss(A, A.BLOCK, n)
            n, m, PAIRS = gather(A, disks, a, b, t)
    rest = comes_to_rest(A, a, b, t)
    owed, _ = owing(A, n)
    block = lay_out(A, disks, n, m, PAIRS, min(a, b) * k + max(a, b), rest, t)
    P, Q, ROWS, V = block.A, block.B, block.ROWS, block.V
    rows = len(ROWS)
    L, LOSS, OUT = np.zeros((rows, 2)), np.zeros((rows, 2)), np.zeros(OUT_SIZE)
    OUT[SCALE_LOCK] = 1.0
    WHO = np.full(len(block.IM), -1, np.int64)
    WHO[:n] = A.BLOCK[:n]
    groups = find_groups(WHO, block.IM, J.OF)
    C = make_columns(groups, P, Q, rows)
    fill_free(groups, C, P, Q, ROWS, block.IM, block.II, rows)
    BEFORE = V.copy()
    INDEX = np.full(len(block.IM), -1, np.int64)
    for g in range(len(groups.COMPONENT)):
        s = groups.COMPONENT[g]
        if s < 0:
            continue
        gather_component(A, J, s, block.POSE, V, np.zeros_like(V), block.IM, block.II, t, 0.0)
        size = find_places(A, J, s, INDEX)
        PUSH = np.zeros((size, 3))
        if not ready(J, s, 2.0, False):
            continue
        fill_group(J, groups, C, g, INDEX, False, P, Q, ROWS, rows, PUSH)
        if carried_along(J, s):
            continue
        # Velocities that joints would not let through take no part in the impact, and stay.
        PUSH[:] = 0.0
        for q in range(n):
            if groups.GROUP[q] == g:
                for c in range(3):
                    mobility = block.II[q] if c == 2 else block.IM[q]
                    PUSH[INDEX[q], c] = V[q, c] / mobility if mobility > 0.0 else 0.0
        answer(J, s, False, PUSH)
        for q in range(n):
            if groups.GROUP[q] == g:
                for c in range(3):
                    V[q, c] = PUSH[INDEX[q], c]
    FITTED = V.copy()
    weigh(groups, C, P, Q, ROWS, rows)
    rates(P, Q, ROWS, V, rows)
    speed = aim(ROWS, rows)
    status = CONVERGED
    if speed > 0.0:
        FREE = V.copy()
        elastic = conserves(ROWS, rows)
        tolerance = (1e-15 if elastic else 1e-10) * speed
        worst = solve_columns(C, P, Q, ROWS, L, V, rows, tolerance, _SWEEPS)
        V[:] = FREE
        push_columns(C, L, rows, 1.0, V)
        scale, _ = scale_of(P, Q, ROWS, L, V, FREE, rows, owed, elastic)
        if scale != 1.0:
            L *= scale
            V[:] = FREE
            push_columns(C, L, rows, 1.0, V)
        OUT[SCALE_LOCK] = scale
        OUT[D_NORMAL], OUT[D_TANGENTIAL] = works(P, Q, ROWS, L, V, rows, LOSS)
        status = CONVERGED if worst <= 10.0 * tolerance else TRUNCATED
    if conserves(ROWS, rows):
        V[:] = BEFORE
        push_columns(C, L, rows, 1.0, V)
    else:
        OUT[D_NORMAL] += energy_of(block, BEFORE, n) - energy_of(block, FITTED, n)
    finish(A, block, n, m, L, OUT, status, t)
    A.STATE[i, KINKS] += 1
    if A.BODY[j, IM] > 0.0:
        A.STATE[j, KINKS] += 1
    status, n = rejoin(A, a, b, t, n, rest, OUT[D_NORMAL] + OUT[D_TANGENTIAL] - owed)
    # Islands that were brought here, and do not touch after all, begin anew with those that do.
    root = A.STATE[i if A.BODY[i, IM] > 0.0 else j, ISLAND]
    for c in range(ended):
        other = A.STATE[ENDED[c], ISLAND]
        if other != root:
            MINE = np.empty(A.MEMBER[other, BODIES], np.int64)
            members(A, other, MINE)
            for q in range(len(MINE)):
                known = False
                for p in range(n):
                    known = known or A.BLOCK[p] == MINE[q]
                if not known:
                    A.BLOCK[n] = MINE[q]
                    n += 1
            root = unite(A, root, other)
    A.COUNT[PENDING] = root
    return status, n
