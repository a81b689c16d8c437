"""The span of an island with joints: contacts in one bounded solve, joints exact.

    M (v+ - v) = h M a + F_s + J^T Lam + G^T lam + T^T beta,    J, F_s the discrete rows of the joints,

contact rows at the predicted middle, as `..sustained.contacts`. The contacts' impulses act on the components as forces
that are constant over the span, so that joints, springs, limits and motors are those of `..joints` to round-off however
badly contacts are truncated, and a contact loses -lam . (way of its row)/h exactly. Impulses follow from Newton's
method in the space of contacts: components are stepped with the present impulses, answer by their columns, and the
contacts' laws are solved with these; until the velocities of both agree.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from ..impacts.coming import pairs_of
from ..impacts.islands import members
from ..impacts.layout import (
    BODIES,
    DONE,
    FIRST_SHAPE,
    KINKS,
    LIFT,
    LOST,
    OPEN,
    PUSHES,
    PUSHES_FULL,
    REMEMBERED,
    ROOT,
    SHAPES,
    SOLVES,
    STAMP,
    UN_AFTER,
    UN_BEFORE,
    UNMET,
    UNTIL,
    UT_AFTER,
    UT_BEFORE,
    Scene,
)  # fmt: skip
from ..impacts.spans import Local, dismiss, lay_out_island, open_contacts
from ..joints.layout import PROJECTED
from ..joints.scratch import BEFORE, BODY_0, BODY_1, M_BODY
from ..layout import AX, ELASTICITY
from ..rows.build import conserves, normal_rate, rates, tangent_rate
from ..rows.layout import ARM_NA, ARM_NB, ARM_TA, ARM_TB, K_N, NX, NY, ROW_COLUMNS, SURFACE, TARGET, UN, UT
from ..sustained.contacts import gather
from ..sustained.memory import remember
from ..sustained.step import moved, recall, speeds
from ..sustained.targets import target
from .columns import (
    Columns,
    Groups,
    fill_free,
    fill_group,
    find_groups,
    leave_out,
    make_columns,
    push_columns,
    weigh,
)
from .component import (
    drives,
    find_places,
    fit_speeds,
    gather_component,
    keep_joints,
    let_slip,
    may_slip,
    ready,
    restore_joints,
    step_component,
)
from .layout import LIFTED, TURNED_WORK, Joints
from .lifting import lift
from .newton import solve_columns

_OUTER, _ELASTIC_OUTER = 6, 12  # steps of the components
_AGREE, _REST_AGREE, _ELASTIC_AGREE = 1e-6, 1e-11, 1e-13  # velocities of both solutions, over |a| h and the speed
_SWEEPS, _FEW_SWEEPS, _FEW, _ELASTIC_SWEEPS = 60, 200, 24, 400
_FINE, _REST_FINE = 1e-9, 1e-12  # residual of the sweeps, likewise
_LOCKS = 4
_TRIES, _MORE = 12, 4.0  # impulses against a motor, each so many times the last
NOT_AT_ALL, AS_IT_IS, AS_IF_SLIPPING = 0, 1, 2  # what columns are filled with
_CHORD = 3  # steps of the components between which their answers are taken to be the same


class Motion(NamedTuple):
    """Of the bodies of an island, (k, 3) each: velocities V and poses END at the end, ways WAY (sums of h v_m)."""

    V: FloatArray
    WAY: FloatArray
    END: FloatArray


@uncounted
def is_hit(groups: Groups, P: IntArray, Q: IntArray, m: int, g: int) -> bool:
    """Whether any contact is on group g."""
    hits = 0
    for i in range(m):
        if groups.GROUP[P[i]] == g or groups.GROUP[Q[i]] == g:
            hits += 1
    return hits > 0


@kernel
def advance(
    A: Scene, J: Joints, isle: Local, groups: Groups, P: IntArray, Q: IntArray, ROWS: FloatArray, L: FloatArray, m: int,
    t: float, h: float, motion: Motion, C: Columns, fill: int,
) -> None:  # fmt: skip
    """Step all bodies of an island by h under the impulses L of its contacts, from where its joints were; `fill` the
    columns C about that step: not at all, as joints stand, or as if motors and the like were at their max_force."""
    k = len(isle.IM)
    ACC = isle.ACC.copy()
    for i in range(m):
        fx = (L[i, 0] * ROWS[i, NX] - L[i, 1] * ROWS[i, NY]) / h
        fy = (L[i, 0] * ROWS[i, NY] + L[i, 1] * ROWS[i, NX]) / h
        for side in range(2):
            q, sign = (P[i], -1.0) if side == 0 else (Q[i], 1.0)
            arm_n, arm_t = (ARM_NA, ARM_TA) if side == 0 else (ARM_NB, ARM_TB)
            ACC[q, 0] += sign * isle.IM[q] * fx
            ACC[q, 1] += sign * isle.IM[q] * fy
            ACC[q, 2] += sign * isle.II[q] * (L[i, 0] * ROWS[i, arm_n] + L[i, 1] * ROWS[i, arm_t]) / h
    INDEX = np.full(k, -1, np.int64)
    for g in range(len(groups.COMPONENT)):
        s = groups.COMPONENT[g]
        if s < 0:
            continue
        restore_joints(J, s)
        length = gather_component(A, J, s, isle.POSE, isle.V, ACC, isle.IM, isle.II, t, h)
        step_component(A, J, s, h, length, m == 0, motion.V, motion.WAY, motion.END)
        if fill != NOT_AT_ALL and is_hit(groups, P, Q, m, g):
            size = find_places(A, J, s, INDEX)
            let_slip(J, s, fill == AS_IF_SLIPPING)
            if ready(J, s, h, True):
                fill_group(J, groups, C, g, INDEX, True, P, Q, ROWS, m, np.empty((size, 3)))
            let_slip(J, s, False)
    for q in range(k):
        if groups.GROUP[q] >= 0 and groups.COMPONENT[groups.GROUP[q]] >= 0:
            continue
        for c in range(3):
            motion.V[q, c] = isle.V[q, c] + h * ACC[q, c]
            motion.WAY[q, c] = 0.5 * h * (isle.V[q, c] + motion.V[q, c])
            motion.END[q, c] = isle.POSE[q, c] + motion.WAY[q, c]


@uncounted
def farthest_apart(V: FloatArray, W: FloatArray, EXTENT: FloatArray, n: int) -> float:
    """Largest difference of two sets of velocities, of points of the bodies."""
    worst = 0.0
    for q in range(n):
        change = math.sqrt((V[q, 0] - W[q, 0]) ** 2 + (V[q, 1] - W[q, 1]) ** 2)
        worst = max(worst, change + abs(V[q, 2] - W[q, 2]) * EXTENT[q])
    return worst


@uncounted
def slip_of(P: IntArray, Q: IntArray, ROWS: FloatArray, WAY: FloatArray, i: int, h: float) -> float:
    """How far contact i slips in h while bodies go WAY: its surfaces move at a rate, bodies by ways."""
    return tangent_rate(P, Q, ROWS, WAY, i) + (h - 1.0) * ROWS[i, SURFACE]


@uncounted
def lost(P: IntArray, Q: IntArray, ROWS: FloatArray, L: FloatArray, WAY: FloatArray, m: int, h: float) -> float:
    """What contacts lose with impulses L while bodies go WAY: their part in the energy of the island, exactly."""
    total = 0.0
    for i in range(m):
        total -= (L[i, 0] * normal_rate(P, Q, ROWS, WAY, i) + L[i, 1] * slip_of(P, Q, ROWS, WAY, i, h)) / h
    return total


@uncounted
def driven(J: Joints, groups: Groups, C: Columns, P: IntArray, Q: IntArray, m: int, HELD: IntArray) -> bool:
    """HELD (m,): 1 for contacts that are left out, though joints with bounds hold against them; if there are any."""
    some = False
    for i in range(m):
        HELD[i] = 0
        for q in (P[i], Q[i]):
            g = groups.GROUP[q]
            if C.OUT[i] != 0 and g >= 0 and groups.COMPONENT[g] >= 0 and may_slip(J, groups.COMPONENT[g]):
                HELD[i] = 1
                some = True
    return some


@kernel
def overcome(
    A: Scene, J: Joints, isle: Local, groups: Groups, P: IntArray, Q: IntArray, ROWS: FloatArray, L: FloatArray, m: int,
    t: float, h: float, small: float, motion: Motion, C: Columns,
) -> None:  # fmt: skip
    """Where a motor below its max_force pushes a body into another one, no small impulse changes the body's velocity:
    the motor makes up for it. Find one that does, so that the answers C are those of a motor at its max_force.
    """
    HELD = np.empty(m, np.int64)
    if not driven(J, groups, C, P, Q, m, HELD):
        return
    START = np.zeros(m)
    waiting = 0
    for i in range(m):
        START[i] = normal_rate(P, Q, ROWS, motion.V, i)
        if not ROWS[i, TARGET] - START[i] > small:
            HELD[i] = 0
        waiting += HELD[i]
    if waiting == 0:
        return
    advance(A, J, isle, groups, P, Q, ROWS, L, m, t, h, motion, C, AS_IF_SLIPPING)
    weigh(groups, C, P, Q, ROWS, m)
    for i in range(m):
        if C.OUT[i] != 0:
            HELD[i] = 0
        if HELD[i] != 0:
            L[i, 0] += ROWS[i, K_N] * (ROWS[i, TARGET] - START[i])
    for tries in range(_TRIES):
        advance(A, J, isle, groups, P, Q, ROWS, L, m, t, h, motion, C, NOT_AT_ALL)
        waiting = 0
        for i in range(m):
            if HELD[i] == 0:
                continue
            if normal_rate(P, Q, ROWS, motion.V, i) > START[i] + 0.1 * (ROWS[i, TARGET] - START[i]):
                HELD[i] = 0
                continue
            L[i, 0] *= _MORE if tries + 1 < _TRIES else 0.0
            waiting += 1
        if waiting == 0:
            break
    advance(A, J, isle, groups, P, Q, ROWS, L, m, t, h, motion, C, AS_IT_IS)
    weigh(groups, C, P, Q, ROWS, m)


@kernel
def press(
    A: Scene, J: Joints, isle: Local, groups: Groups, P: IntArray, Q: IntArray, ROWS: FloatArray, L: FloatArray,
    EXPECTED: FloatArray, m: int, n: int, t: float, h: float, slow: float, fast: float, pull: float, owed: float,
    motion: Motion,
) -> bool:  # fmt: skip
    """Impulses L (in: guesses) of the m contacts of an island, and the motion under them; whether they have converged.

    Args:
        slow, fast, pull: speeds and acceleration of the island.  owed: energy >= 0 that it has to lose at least.
    """
    C = make_columns(groups, P, Q, m)
    fill_free(groups, C, P, Q, ROWS, isle.IM, isle.II, m)
    rates(P, Q, ROWS, isle.V, m)
    elastic = conserves(ROWS, m)
    scale = pull * h + (fast if elastic else slow)
    rests = not elastic and slow < pull * h
    agree = (_ELASTIC_AGREE if elastic else (_REST_AGREE if rests else _AGREE)) * scale
    fine = (1e-15 if elastic else (_REST_FINE if rests else _FINE)) * scale
    most = _ELASTIC_SWEEPS if elastic else (_FEW_SWEEPS if m <= _FEW else _SWEEPS)
    FORESEEN = np.empty((len(isle.IM), 3))
    converged, best, LEAST, USED = False, np.inf, L.copy(), L.copy()
    for outer in range(_ELASTIC_OUTER if elastic else _OUTER):
        anew = AS_IT_IS if outer % _CHORD == 0 else NOT_AT_ALL
        advance(A, J, isle, groups, P, Q, ROWS, L, m, t, h, motion, C, anew)
        if outer > 0:
            off = farthest_apart(motion.V, FORESEEN, isle.EXTENT, n)
            if off <= agree:
                converged = True
                break
            if off < best:
                best = off
                LEAST[:] = L
            else:
                # Too far: the components do not answer as they did.
                L[:] = 0.5 * (L + LEAST)
                advance(A, J, isle, groups, P, Q, ROWS, L, m, t, h, motion, C, anew)
        if anew != NOT_AT_ALL:
            weigh(groups, C, P, Q, ROWS, m)
        if outer == 0:
            EFFECT = motion.V.copy()
            push_columns(C, L, m, -1.0, EFFECT)
            for q in range(len(EFFECT)):
                for c in range(3):
                    EFFECT[q, c] = (EFFECT[q, c] - isle.V[q, c]) / h
            target(P, Q, ROWS, m, EFFECT, EXPECTED, pull, h)
            overcome(A, J, isle, groups, P, Q, ROWS, L, m, t, h, agree, motion, C)
        FORESEEN[:] = motion.V
        USED[:] = L
        leave_out(C, L, m, FORESEEN)
        worst = solve_columns(C, P, Q, ROWS, L, FORESEEN, m, fine, most)
        converged = worst <= 10.0 * max(fine, agree)
        if farthest_apart(motion.V, FORESEEN, isle.EXTENT, n) <= 1e-3 * agree:
            # The motion is that of the impulses before: others may do as little by these answers, and yet do much.
            L[:] = USED
            break
    else:
        advance(A, J, isle, groups, P, Q, ROWS, L, m, t, h, motion, C, NOT_AT_ALL)
        if not farthest_apart(motion.V, FORESEEN, isle.EXTENT, n) <= best:
            L[:] = LEAST
            advance(A, J, isle, groups, P, Q, ROWS, L, m, t, h, motion, C, NOT_AT_ALL)
        converged = False
    energy = 0.0
    for q in range(n):
        energy += (isle.V[q, 0] ** 2 + isle.V[q, 1] ** 2 + (pull * h) ** 2) / isle.IM[q]
    bearable = 1e-15 * energy
    for tries in range(_LOCKS + 1):
        loss = lost(P, Q, ROWS, L, motion.WAY, m, h)
        if loss >= owed - bearable and (not elastic or loss <= owed + bearable):
            break
        p, q2 = 0.0, 0.0
        FREE = motion.V.copy()
        push_columns(C, L, m, -1.0, FREE)
        for i in range(m):
            for tangent in range(2):
                before = ROWS[i, UT if tangent == 1 else UN]
                if tangent == 1:
                    free, after = tangent_rate(P, Q, ROWS, FREE, i), tangent_rate(P, Q, ROWS, motion.V, i)
                else:
                    free, after = normal_rate(P, Q, ROWS, FREE, i), normal_rate(P, Q, ROWS, motion.V, i)
                p -= 0.5 * L[i, tangent] * (before + free)
                q2 += 0.5 * L[i, tangent] * (after - free)
        # D(s) = s p - s^2 q: by its slope at s = 1.
        slope = p - 2.0 * q2
        s = 1.0 + (owed - loss) / slope if slope < 0.0 else 0.0
        if tries == _LOCKS or not 0.0 < s < 2.0:
            s = 0.0
        for i in range(m):
            L[i, 0] = s * L[i, 0] if s > 0.0 else 0.0
            L[i, 1] = s * L[i, 1] if s > 0.0 else 0.0
        advance(A, J, isle, groups, P, Q, ROWS, L, m, t, h, motion, C, NOT_AT_ALL)
        converged = False
        if s == 0.0:
            break
    return converged


@kernel
def fit(
    A: Scene, J: Joints, isle: Local, groups: Groups, P: IntArray, Q: IntArray, L: FloatArray, m: int, motion: Motion,
    end: float, h: float,
) -> None:  # fmt: skip
    """Make the velocities at the end of a lossy span fit the joints of the components that contacts push.

    Bodies that land leave velocities which violate joints, and those would ring for ever: a midpoint rule turns their
    sign in every step. What this costs is booked.
    """
    NOTHING = np.zeros_like(isle.V)
    for g in range(len(groups.COMPONENT)):
        s = groups.COMPONENT[g]
        pushed = False
        for i in range(m):
            on = groups.GROUP[P[i]] == g or groups.GROUP[Q[i]] == g
            pushed = pushed or (on and L[i, 0] > 0.0)
        if s < 0 or not pushed:
            continue
        length = gather_component(A, J, s, motion.END, motion.V, NOTHING, isle.IM, isle.II, end, h)
        J.STEPPED[s, PROJECTED] += fit_speeds(A, J, s, length)
        for w in range(J.SPAN[s, BODY_1] - J.SPAN[s, BODY_0]):
            body = J.MEMBER[J.SPAN[s, BODY_0] + w, M_BODY]
            if body < A.PLACE.shape[0] and A.PLACE[body] >= 0:
                for c in range(3):
                    motion.V[A.PLACE[body], c] = J.LOCAL[w, BEFORE + c]


@uncounted
def foresee(
    A: Scene, J: Joints, isle: Local, groups: Groups, t: float, h: float, motion: Motion, REACH: FloatArray
) -> float:
    """Add to REACH (k,) how far springs and motors move points of bodies in h; the largest such acceleration."""
    most = 0.0
    for g in range(len(groups.COMPONENT)):
        s = groups.COMPONENT[g]
        if s < 0 or not drives(J, s):
            continue
        length = gather_component(A, J, s, isle.POSE, isle.V, isle.ACC, isle.IM, isle.II, t, h)
        step_component(A, J, s, h, length, False, motion.V, motion.WAY, motion.END)
        restore_joints(J, s)
        for w in range(groups.FIRST[g], groups.FIRST[g + 1]):
            q = groups.BODY[w]
            x, y = motion.WAY[q, 0] - h * isle.V[q, 0], motion.WAY[q, 1] - h * isle.V[q, 1]
            way = math.sqrt(x * x + y * y) + abs(motion.WAY[q, 2] - h * isle.V[q, 2]) * isle.EXTENT[q]
            REACH[q] += 1.1 * way
            most = max(most, 2.0 * way / (h * h))
    return most


@kernel
def begin_span(A: Scene, J: Joints, root: int, t: float, h: float) -> int:
    """Begin a span of length h of an island with joints at instant t, at which all its bodies are.

    DONE, or PUSHES_FULL, which leaves everything as it was.
    """
    BODY, STATE, MEMBER, COUNT = A.BODY, A.STATE, A.MEMBER, A.COUNT
    n = MEMBER[root, BODIES]
    MINE = np.empty(n, np.int64)
    members(A, root, MINE)
    MINE.sort()
    lossy = False
    for q in range(n):
        A.PLACE[MINE[q]] = q
        for s in range(STATE[MINE[q], FIRST_SHAPE], STATE[MINE[q], FIRST_SHAPE] + STATE[MINE[q], SHAPES]):
            lossy = lossy or A.SHAPE[s, ELASTICITY] < 1.0
    found = pairs_of(A, root, t, lossy, A.PLACE, MINE, n)
    p = len(found)
    if COUNT[PUSHES] + 2 * p > A.PUSHED.shape[0] or 2 * (COUNT[REMEMBERED] + 2 * p) > A.KEYS.shape[0]:
        dismiss(A, MINE, n)
        return PUSHES_FULL
    isle = lay_out_island(A, MINE, n, found, t)
    k, room = len(isle.WHO), 2 * p + 1
    groups = find_groups(isle.WHO, isle.IM, J.OF)
    for g in range(len(groups.COMPONENT)):
        if groups.COMPONENT[g] >= 0:
            keep_joints(J, groups.COMPONENT[g])
    P, Q, KEY = np.empty(room, np.int64), np.empty(room, np.int64), np.empty(room, np.int64)
    ROWS, L, EXPECTED = np.empty((room, ROW_COLUMNS)), np.zeros((room, 2)), np.zeros(room)
    motion = Motion(isle.V.copy(), np.zeros((k, 3)), isle.POSE.copy())
    REACH = np.empty(k)
    slow, fast, pull = speeds(isle.V, isle.ACC, isle.EXTENT, isle.IM, n, h, REACH)
    m = 0
    if p > 0:
        pull = max(pull, foresee(A, J, isle, groups, t, h, motion, REACH))
        NOW, THEN = np.empty((2, 5)), np.empty((2, 5))
        m = gather(
            isle.PAIRS, p, A.SHAPE, A.RULE, A.LINK, A.VERTEX, A.WORK, isle.POSE, moved(isle.POSE, isle.V, 0.5 * h),
            isle.V, REACH, isle.EXTENT, isle.IM, isle.II, h, P, Q, ROWS, KEY, NOW, THEN,
        )  # fmt: skip
    if m > 0:
        recall(KEY, m, A.KEYS, A.FORCES, A.PAR[STAMP], h, L, EXPECTED)
        owed = max(-A.RESTING[root, LOST], 0.0)
        if not press(
            A, J, isle, groups, P, Q, ROWS, L, EXPECTED, m, n, t, h, slow, fast, pull, owed, motion
        ):  # fmt: skip
            COUNT[UNMET] += 1
        for i in range(m):
            stopped = max(max(ROWS[i, TARGET], 0.0) - ROWS[i, UN], 0.0) * ROWS[i, K_N]
            if L[i, 0] > 0.0:
                load = max(L[i, 0] - stopped, 0.0)
                remember(A.KEYS, A.FORCES, COUNT[REMEMBERED:], KEY[i], L[i, 0] / h, L[i, 1] / h, load / h, A.PAR[STAMP])
    if m == 0:
        C = make_columns(groups, P, Q, 0)
        advance(A, J, isle, groups, P, Q, ROWS, L, 0, t, h, motion, C, NOT_AT_ALL)
    book_turning(A, J, isle, groups, motion, n)
    if lossy and m > 0:
        budget = lost(P, Q, ROWS, L, motion.WAY, m, h) + A.RESTING[root, LOST]
        spent = lift(A, J, isle, groups, P, Q, ROWS, m, n, motion.V, motion.WAY, motion.END, t + h, h, budget)
        for g in range(len(groups.COMPONENT)):
            if groups.COMPONENT[g] >= 0:
                J.STEPPED[groups.COMPONENT[g], LIFTED] = spent
                break
        fit(A, J, isle, groups, P, Q, L, m, motion, t + h, h)
    dismiss(A, MINE, n)
    COUNT[SOLVES] += 1
    first = COUNT[PUSHES]
    open_contacts(A, isle, P, Q, ROWS, KEY, L, motion.V, m, t, h, np.zeros(k, np.uint8))
    for z in range(m):
        R = A.PUSHED[first + z]
        R[UN_BEFORE] = R[UN_AFTER] = normal_rate(P, Q, ROWS, motion.WAY, z) / h
        R[UT_BEFORE] = R[UT_AFTER] = slip_of(P, Q, ROWS, motion.WAY, z, h) / h
        A.PUSHED_BY[first + z, ROOT] = root
    COUNT[PUSHES] += m
    for q in range(n):
        i = MINE[q]
        STATE[i, KINKS] += 1
        for c in range(3):
            # A parabola from start to end; velocities at the end are others.
            BODY[i, AX + c] = 2.0 * (motion.END[q, c] - isle.POSE[q, c] - h * isle.V[q, c]) / (h * h)
            A.RESTING[i, LIFT + c] = 0.0
            A.RESTING[i, LIFT + 3 + c] = motion.V[q, c] - isle.V[q, c] - h * BODY[i, AX + c]
    MEMBER[root, OPEN] = 1
    A.RESTING[root, UNTIL] = math.inf
    return DONE


@uncounted
def book_turning(A: Scene, J: Joints, isle: Local, groups: Groups, motion: Motion, n: int) -> None:
    """Torques work along chi = h w_m, which is not quite the angle that a jointed body turns by."""
    for g in range(len(groups.COMPONENT)):
        if groups.COMPONENT[g] >= 0:
            J.STEPPED[groups.COMPONENT[g], TURNED_WORK] = 0.0
            J.STEPPED[groups.COMPONENT[g], LIFTED] = 0.0
    for q in range(n):
        s = groups.COMPONENT[groups.GROUP[q]]
        if s >= 0 and isle.II[q] > 0.0 and isle.ACC[q, 2] != 0.0:
            turned = motion.END[q, 2] - isle.POSE[q, 2]
            J.STEPPED[s, TURNED_WORK] += isle.ACC[q, 2] * (motion.WAY[q, 2] - turned) / isle.II[q]
